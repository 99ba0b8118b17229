//! Any bytes as a file of the format OFF: a mesh that is well formed, or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mve_core::Control;
use mve_formats::off::read_off;

fuzz_target!(|bytes: &[u8]| {
    if let Ok((mesh, _)) = read_off(bytes, Control::none()) {
        assert_eq!(mesh.check(), Ok(()));
    }
});
