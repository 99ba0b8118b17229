//! A cancel is heard within a tenth of a second, also by what prepares long before it loops.

use std::time::{Duration, Instant};

use mve_core::CancelToken;
use mve_core::testing::Trial;
use mve_modules::data::{Image, Images, PixelKind};
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
