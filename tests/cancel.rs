//! A cancel is heard within a tenth of a second, also by what prepares long before it loops.

use std::time::{Duration, Instant};

use mve_core::testing::Trial;
use mve_core::{CancelToken, Control};
use mve_modules::data::{Image, Images, PixelKind};
use mve_modules::formats::obj;
use mve_modules::geometry::generate::{VaseOptions, vase};
use mve_modules::registry;

const LIMIT: Duration = Duration::from_millis(100);

/// Waits before the cancel: one for each stage of the work, and the best of them counts where the
/// machine is busy.
const WAITS_MS: [u64; 3] = [60, 200, 350];

/// How long a module goes on after a cancel: `None` where it was done before.
fn lateness(trial: Trial, wait_ms: u64) -> Option<Duration> {
    let cancel = CancelToken::new();
    std::thread::scope(|scope| {
        let run = scope.spawn(|| (trial.run_until(&cancel).is_err(), Instant::now()));
        std::thread::sleep(Duration::from_millis(wait_ms));
        let asked = Instant::now();
        cancel.cancel();
        let (is_stopped, ended) = run.join().expect("no panic");
        is_stopped.then(|| ended.saturating_duration_since(asked))
    })
}

fn stops(trial: impl Fn() -> Trial) {
    for wait in WAITS_MS {
        // What other processes do to the clock is no fault of a module.
        let late = (0..3).map(|_| lateness(trial(), wait)).min().flatten();
        let late = late.expect("the work takes longer than the wait");
        assert!(late < LIMIT, "{late:?} after {wait} ms");
    }
}

/// The tree over the mesh and its curvature come before the first price.
#[test]
fn a_perceptual_cost_stops_before_its_first_price() {
    let fine = VaseOptions { segments: 512, profile_segments: 512, ..VaseOptions::DEFAULT };
    let mesh = vase(&fine);
    let module = registry().find("Simplificator").expect("the module").module;
    stops(|| Trial::of(module).input("mesh", mesh.clone()).set("cost", "Msdm2"));
}

/// A comparison in which boxes hardly tell one face from another, with all samples that a person
/// might ask for.
#[test]
fn a_comparison_with_a_mesh_far_away_or_larger_stops() {
    let fine = VaseOptions { segments: 512, profile_segments: 512, ..VaseOptions::DEFAULT };
    let mesh = vase(&fine);
    let mapped = |map: &dyn Fn(glam::DVec3) -> glam::DVec3| {
        let mut mesh = mesh.clone();
        mesh.positions.iter_mut().for_each(|p| *p = map(*p));
        mesh
    };
    let mut copies = mesh.clone();
    copies.faces = mesh.faces[..1].repeat(500_000);
    let module = registry().find("MeshComparer").expect("the module").module;
    let samples = serde_json::json!({ "Hausdorff": { "samples": 20_000_000 } });
    for other in [mapped(&|p| p + 1e6), mapped(&|p| p * 1000.0), copies] {
        stops(|| {
            let trial = Trial::of(module).input("original", mesh.clone());
            trial.input("simplified", other.clone()).set("metric", samples.clone())
        });
    }
}

/// Curvature, trees, nearest points and windows, one after the other.
#[test]
fn a_perceptual_metric_stops() {
    let fine = VaseOptions { segments: 512, profile_segments: 512, ..VaseOptions::DEFAULT };
    let mesh = vase(&fine);
    let module = registry().find("MeshComparer").expect("the module").module;
    stops(|| {
        let trial = Trial::of(module).input("original", mesh.clone());
        trial.input("simplified", mesh.clone()).set("metric", "Msdm2")
    });
}

/// From the bytes to the layers, with polygons that are cut.
#[test]
fn loading_a_large_file_stops() {
    let fine = VaseOptions { segments: 512, profile_segments: 512, ..VaseOptions::DEFAULT };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.obj");
    obj::save(&vase(&fine), &path, Control::none()).expect("a file");
    let mut text = std::fs::read(&path).expect("the file");
    let corners: Vec<String> = (1..=100_000).map(|corner| corner.to_string()).collect();
    let polygon = format!("f {}\n", corners.join(" "));
    (0..20).for_each(|_| text.extend(polygon.as_bytes()));
    std::fs::write(&path, text).expect("the file");
    let module = registry().find("ObjLoader").expect("the module").module;
    stops(|| Trial::of(module).set("path", path.to_str().expect("a path")));
}

/// Pictures of the largest size, and what is computed of them.
#[test]
fn a_metric_on_large_pictures_stops() {
    let mesh = vase(&VaseOptions::DEFAULT);
    let module = registry().find("MeshComparer").expect("the module").module;
    for metric in ["ImageRms", "ImageSsim", "Flip"] {
        let large = serde_json::json!({ metric: { "cameras": "Direction", "resolution": 4096 } });
        stops(|| {
            let trial = Trial::of(module).input("original", mesh.clone());
            trial.input("simplified", mesh.clone()).set("metric", large.clone())
        });
    }
}

#[test]
fn packing_a_picture_stops_and_leaves_no_file() {
    let mut image = Image::filled("noise", [6000, 6000], PixelKind::Rgb, 0);
    let mut hash = 1_u32;
    for byte in &mut image.bytes {
        hash = hash.wrapping_mul(0x2c1b_3c6d).wrapping_add(0x9e37_79b9);
        *byte = (hash >> 24) as u8;
    }
    let images = Images(vec![image]);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.png");
    let module = registry().find("PngSaver").expect("the module").module;
    stops(|| {
        let trial = Trial::of(module).input("images", images.clone());
        trial.set("path", path.to_str().expect("a path"))
    });
    assert_eq!(std::fs::read_dir(folder.path()).expect("the folder").count(), 0);
}

/// The order of vertices, their importances, and their removal, by waves and by passes.
#[test]
fn a_decimation_stops() {
    let fine = VaseOptions { segments: 768, profile_segments: 768, ..VaseOptions::DEFAULT };
    let mesh = vase(&fine);
    let module = registry().find("DecimateVertices").expect("the module").module;
    for order in ["Queue", "Passes"] {
        stops(|| {
            let trial = Trial::of(module).input("mesh", mesh.clone());
            trial.set("ratio", 0.02).set("order", order)
        });
    }
}
