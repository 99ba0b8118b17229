//! Any bytes as an OBJ file that finds no material files: a mesh that is well formed, or an error.
#![no_main]

use std::io;

use libfuzzer_sys::fuzz_target;
use mve_core::Control;
use mve_formats::obj::parse;

fuzz_target!(|bytes: &[u8]| {
    let mut none = |_: &str| Err(io::Error::from(io::ErrorKind::NotFound));
    if let Ok((mesh, _)) = parse(bytes, &mut none, Control::none()) {
        assert_eq!(mesh.check(), Ok(()));
    }
});
