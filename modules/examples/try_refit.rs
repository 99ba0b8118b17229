//! Experiment.
use mve_core::Control;
use mve_modules::data::TriMesh;
use mve_modules::geometry::distance::hausdorff::{HausdorffOptions, hausdorff};
use mve_modules::geometry::simplify::collapse::{SimplifyOptions, Stop, simplify};
use mve_modules::geometry::simplify::refit::{RefitOptions, refit};
use std::time::Instant;
#[path = "../benches/models/mod.rs"]
mod models;

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let mesh = if args[1] == "torus" {
        models::bumpy_torus(1_000_000)
    } else {
        models::model(&args[1]).unwrap()
    };
    let ratio: f64 = args[2].parse().unwrap();
    for kind in ["Quadric", "LindstromTurk"] {
        let options = SimplifyOptions {
            stop: Stop { ratio: Some(ratio), ..Stop::default() },
            ..SimplifyOptions::default()
        };
        let t = Instant::now();
        let simple = if kind == "Quadric" {
            simplify(
                &mesh,
                &mut mve_modules::cost::Quadric::default(),
                &mut mve_modules::placement::Optimal::default(),
                options,
                Control::none(),
            )
        } else {
            simplify(
                &mesh,
                &mut mve_modules::cost::LindstromTurk,
                &mut mve_modules::placement::LindstromTurk,
                options,
                Control::none(),
            )
        }
        .unwrap()
        .mesh;
        println!(
            "{kind} {:.3} s, {} faces {}",
            t.elapsed().as_secs_f64(),
            simple.faces.len(),
            say(&mesh, &simple)
        );
        for n_steps in [1, 2, 6] {
            let t = Instant::now();
            let options = RefitOptions { n_steps, ..RefitOptions::DEFAULT };
            let fitted = refit(&simple, &mesh, options, Control::none()).unwrap();
            println!(
                "   refit {n_steps} {:.3} s {}",
                t.elapsed().as_secs_f64(),
                say(&mesh, &fitted.mesh)
            );
        }
    }
}

fn say(original: &TriMesh, mesh: &TriMesh) -> String {
    let h = hausdorff(
        original,
        mesh,
        &HausdorffOptions { n_samples: Some(300_000), ..HausdorffOptions::DEFAULT },
        Control::none(),
    )
    .unwrap();
    let d = h.diagonal * 1e-5;
    let both = ((h.from_original.rms.powi(2) + h.from_simplified.rms.powi(2)) / 2.0).sqrt();
    format!(
        "rms {:.2} (fwd {:.2} bwd {:.2})  max {:.0}",
        both / d,
        h.from_original.rms / d,
        h.from_simplified.rms / d,
        h.max() / d
    )
}
