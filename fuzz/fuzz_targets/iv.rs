//! Any bytes as a file of the format IV: a mesh that is well formed, or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mve_core::Control;
use mve_formats::iv::read_iv;

fuzz_target!(|bytes: &[u8]| {
    if let Ok((mesh, _)) = read_iv(bytes, Control::none()) {
        assert_eq!(mesh.check(), Ok(()));
    }
});
