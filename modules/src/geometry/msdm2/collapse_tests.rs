//! The cost: what it says on meshes whose answer is known, and how it compares.

use crate::cost::{COSTS, Cost, EdgeLength, Quadric};
use crate::data::TriMesh;
use crate::geometry::control::Control;
use crate::geometry::hausdorff::{HausdorffOptions, hausdorff};
use crate::geometry::msdm2::collapse::{CollapsePrices, Counting};
use crate::geometry::msdm2::{Msdm2Options, msdm2};
use crate::geometry::simplify::{SimplifyOptions, Stop, simplify};
use crate::mesh::test_models::model;
use crate::placement::{Endpoint, Midpoint, Optimal, Placement};

#[test]
fn experiment() {
    for name in ["cow.obj", "spot.obj", "fandisk.obj"] {
        let Some(mesh) = model(name) else { return };
        let faces = if name == "cow.obj" { 3000 } else { mesh.faces.len() / 2 };
        for place in ["optimal", "midpoint", "endpoint"] {
            for which in ["edge", "quadric", "merged", "once"] {
                let counting = if which == "once" { Counting::Once } else { Counting::Merged };
                let mut cost: Box<dyn Cost> = match which {
                    "edge" => Box::new(EdgeLength),
                    "quadric" => Box::new(Quadric::default()),
                    _ => Box::new(crate::cost::Msdm2::new(&mesh, 3, counting)),
                };
                let mut placement: Box<dyn Placement> = match place {
                    "optimal" => Box::new(Optimal::default()),
                    "midpoint" => Box::new(Midpoint),
                    _ => Box::new(Endpoint),
                };
                let stop = Stop { faces: Some(faces), ..Stop::default() };
                let options = SimplifyOptions { stop, ..SimplifyOptions::DEFAULT };
                let start = std::time::Instant::now();
                let out =
                    simplify(&mesh, cost.as_mut(), placement.as_mut(), options, Control::none())
                        .unwrap();
                let secs = start.elapsed().as_secs_f64();
                let found =
                    msdm2(&mesh, &out.mesh, &Msdm2Options::DEFAULT, Control::none()).unwrap();
                let h = hausdorff(&mesh, &out.mesh, &HausdorffOptions::DEFAULT, Control::none())
                    .unwrap();
                eprintln!(
                    "{name} {place} {which}: {} faces {secs:.2} s msdm2 {:.4} (o {:.4} s {:.4}) hausdorff {:.5} rms {:.6}",
                    out.mesh.faces.len(),
                    found.symmetric(),
                    found.from_original.value,
                    found.from_simplified.value,
                    h.max() / h.diagonal,
                    h.rms() / h.diagonal
                );
            }
        }
    }
}
