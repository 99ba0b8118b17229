//! Points of a spiral from pole to pole, as many as are asked for.

use mve_core::Entry;

use super::MakeCameras;
use crate::picture::render::CameraSet;
use crate::prelude::*;

const N_CAMERAS: Param<i64> =
    Param::integer("n", "How many cameras.", 32).between((1, 10_000)).mostly((4, 128));

pub static CAMERAS: Entry<MakeCameras> = Entry {
    id: "Fibonacci",
    summary: "Any number of cameras, about evenly spread, on a spiral from pole to pole.",
    params: &[N_CAMERAS.spec()],
    build: |settings| Ok(CameraSet::Fibonacci(settings.get(&N_CAMERAS)? as usize)),
};
