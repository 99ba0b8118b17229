//! The list of sets of cameras: from where pictures are taken, one file a set.

mve_core::registered! {
    static ENTRIES: Entry<MakeCameras> =
        CAMERAS in direction, dodecahedron, fibonacci, rhombicuboctahedron;
}

use mve_core::{Choices, Entry, ModuleError, Settings};

use crate::picture::render::CameraSet;

/// All sets of cameras, for the parameters of modules, costs and metrics.
pub static CAMERA_SETS: Choices<MakeCameras> = Choices::new(ENTRIES);

/// Makes a set of cameras from its parameters.
pub type MakeCameras = fn(&Settings) -> Result<CameraSet, ModuleError>;
