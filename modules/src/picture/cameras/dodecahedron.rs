//! The vertices of a regular dodecahedron.

use mve_core::Entry;

use super::MakeCameras;
use crate::picture::render::CameraSet;

pub static CAMERAS: Entry<MakeCameras> = Entry {
    id: "Dodecahedron",
    summary: "The 20 vertices of a dodecahedron.",
    params: &[],
    build: |_| Ok(CameraSet::Dodecahedron),
};
