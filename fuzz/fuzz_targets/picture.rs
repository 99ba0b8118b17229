//! Any bytes as a PNG or JPEG file: a picture with all its pixels, or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mve_formats::png::read_png;
use mve_formats::texture_file::read_texture;

fuzz_target!(|bytes: &[u8]| {
    for picture in [read_png(bytes, "a"), read_texture(bytes)].into_iter().flatten() {
        assert!(picture.is_whole());
    }
});
