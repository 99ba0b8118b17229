//! The vertices of a rhombicuboctahedron.

use mve_core::Entry;

use super::MakeCameras;
use crate::picture::render::CameraSet;

pub static CAMERAS: Entry<MakeCameras> = Entry {
    id: "Rhombicuboctahedron",
    summary: "The 24 vertices of a rhombicuboctahedron; none is one of the dodecahedron's.",
    params: &[],
    build: |_| Ok(CameraSet::Rhombicuboctahedron),
};
