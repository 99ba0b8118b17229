//! Any bytes as a glTF file, of either kind: a mesh that is well formed, or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mve_core::Control;
use mve_formats::gltf::{Vertices, read_gltf};

fuzz_target!(|bytes: &[u8]| {
    for vertices in [Vertices::Welded, Vertices::AsInFile] {
        if let Ok((mesh, _)) = read_gltf(bytes, vertices, Control::none()) {
            assert_eq!(mesh.check(), Ok(()));
        }
    }
});
