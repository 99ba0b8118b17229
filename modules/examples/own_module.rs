//! A module of one's own, outside of mve, beside those of mve in a map that is built in code.
//!
//! ```text
//! cargo run -p mve-modules --example own_module
//! ```
//!
//! In a crate with more than one module each has a file, as here in mve, and
//! `mve_core::modules! { "own": twist, untwist }` in `lib.rs` declares their list, `LIST`.

use std::error::Error;
use std::path::Path;

use mve_core::{
    CancelToken, FileHashes, Keep, Listed, Map, ModuleList, Node, Plan, PlanOptions, RunOptions,
    assign, run, source_hash,
};
use mve_modules::prelude::*;
use serde_json::json;

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh.");
const TURNS: Param<f64> =
    Param::number("turns", "Whole turns from z = 0 to z = 1.", 0.25).within((-100.0, 100.0));
const MESH_OUT: Out<TriMesh> = Out::new("mesh", "The mesh, turned about the z axis by its height.");

static TWIST: Module = Module {
    id: "Twist",
    summary: "Turns every vertex about the z axis, the more the higher it is.",
    inputs: &[MESH_IN.spec()],
    outputs: &[MESH_OUT.spec()],
    params: &[TURNS.spec()],
    run: |io| {
        let turns = io.param(TURNS)?;
        let mut mesh = io.take(MESH_IN)?;
        let n_vertices = mesh.positions.len();
        for (place, position) in mesh.positions.iter_mut().enumerate() {
            // This is also what makes cancelling work.
            io.control().item(place, n_vertices)?;
            let (sin, cos) = (std::f64::consts::TAU * turns * position.z).sin_cos();
            let (x, y) = (position.x, position.y);
            (position.x, position.y) = (cos * x - sin * y, sin * x + cos * y);
        }
        io.put(MESH_OUT, mesh);
        Ok(())
    },
};

/// The hash of the source is part of every key: edited code never finds results of its older self.
static OWN: ModuleList = ModuleList {
    category: "own",
    modules: &[Listed { item: &TWIST, source: source_hash(include_bytes!("own_module.rs")) }],
};

fn main() -> Result<(), Box<dyn Error>> {
    // The text stands for the code that the modules of the list share: a version will do.
    let registry =
        mve_modules::registry().with(&[&OWN], concat!("own ", env!("CARGO_PKG_VERSION")));

    let mut map = Map::default();
    for (name, module) in [("model", "Box"), ("twist", "Twist"), ("info", "MeshInfo")] {
        let node = Node { module: module.to_owned(), ..Node::default() };
        map.nodes.insert(name.to_owned(), node);
    }
    for link in ["model.mesh -> twist.mesh", "twist.mesh -> info.mesh"] {
        map.links.push(link.parse().map_err(|()| "write node.output -> node.input")?);
    }
    for (path, value) in [("model.segments", json!(64)), ("twist.turns", json!(0.125))] {
        assign(&mut map, &registry, path, value).map_err(|problem| problem.to_string())?;
    }

    let files = FileHashes::new();
    let plan = Plan::new(&map, &registry, &PlanOptions::new(Path::new("."), &files));
    let plan = plan.map_err(|problems| format!("{problems:#?}"))?;
    let cancel = CancelToken::new();
    let options = RunOptions { keep: Keep::All, ..RunOptions::new(Path::new("mve-out"), &cancel) };
    let outcome = run(&plan, &options);
    if let Some((node, error)) = outcome.failures().next() {
        return Err(format!("{node}: {error}").into());
    }
    let value = outcome.value("twist", "mesh").and_then(|value| value.get::<TriMesh>());
    let mesh = value.ok_or("twist gave no mesh")?;
    // A twist keeps the volume of a solid; that of its triangles comes close to it.
    println!("{} faces, volume {:.4}", mesh.faces.len(), mesh.signed_volume());
    Ok(())
}
