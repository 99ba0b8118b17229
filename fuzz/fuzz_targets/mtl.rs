//! Any bytes as a material file: materials, whatever they say.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mve_formats::obj::{parse_mtl, write_mtl};

fuzz_target!(|bytes: &[u8]| {
    let (materials, _) = parse_mtl(bytes);
    let mut written = Vec::new();
    write_mtl(&materials, &mut written).expect("memory takes all");
});
