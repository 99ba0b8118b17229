//! A module that takes as long as it is told to, so that no test depends on how fast a machine is.

use std::time::{Duration, Instant};

use mve_core::{Listed, ModuleList, Registry, source_hash};
use mve_modules::prelude::*;

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh.");
const SECONDS: Param<f64> =
    Param::number("seconds", "How long it takes.", 0.0).within((0.0, 600.0));
const MESH_OUT: Out<TriMesh> = Out::new("mesh", "The same mesh.");

static WAIT: Module = Module {
    id: "Wait",
    summary: "Gives its mesh on after a while.",
    inputs: &[MESH_IN.spec()],
    outputs: &[MESH_OUT.spec()],
    params: &[SECONDS.spec()],
    run: |io| {
        let end = Instant::now() + Duration::from_secs_f64(io.param(SECONDS)?);
        while Instant::now() < end {
            io.check()?;
            std::thread::sleep(Duration::from_millis(5));
        }
        let mesh = io.take(MESH_IN)?;
        io.put(MESH_OUT, mesh);
        Ok(())
    },
};

static LIST: ModuleList = ModuleList {
    category: "tests",
    modules: &[Listed { item: &WAIT, source: source_hash(include_bytes!("wait.rs")) }],
};

/// What a hand's window knows.
pub fn registry() -> Registry {
    mve_modules::registry().with(&[&LIST], "tests")
}
