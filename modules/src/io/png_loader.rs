//! Loads a picture from a PNG file.

use mve_formats::png::read_png;
use mve_formats::{ReadError, load};

use crate::prelude::*;

/// Bytes of the largest file that is read.
const MAX_FILE_BYTES: u64 = 1 << 30;

const PATH: Param<PathBuf> = Param::input_file("path", "The file.", &["png"]);
const IMAGES_OUT: Out<Images> = Out::new(
    "images",
    "One picture, 8-bit gray or color as in the file; deeper ones are rounded, and transparency is \
     left out.",
);

pub static MODULE: Module = Module {
    id: "PngLoader",
    summary: "Loads a picture from a PNG file.",
    inputs: &[],
    outputs: &[IMAGES_OUT.spec()],
    params: &[PATH.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let path = io.param(PATH)?;
    // The name of the file is no part of what decides the result, so it must not enter it.
    let image = load(&path, MAX_FILE_BYTES, io.control(), |bytes, _| {
        read_png(bytes, "image").map_err(ReadError::Wrong)
    })?;
    io.put(IMAGES_OUT, Images(vec![image]));
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;
    use mve_formats::png::write_png;
    use mve_mesh::data::{Image, PixelKind};

    use crate::prelude::*;
    use mve_core::Control;

    #[test]
    fn loads_a_picture_and_names_what_is_none() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let image = Image::filled("image", [7, 3], PixelKind::Rgb, 200);
        let mut bytes = Vec::new();
        write_png(&image, &mut bytes, Control::none()).unwrap();
        let load = |bytes: &[u8]| {
            std::fs::write(&path, bytes).unwrap();
            Trial::of(&super::MODULE).set("path", path.to_str().unwrap()).run()
        };
        let outputs = load(&bytes).unwrap();
        assert_eq!(outputs["images"].get::<Images>().unwrap().0, [image]);
        let message = load(b"v 0 0 0\n").unwrap_err().to_string();
        assert!(message.contains("a.png: it is not a PNG file"), "{message}");
        assert!(load(&bytes[..bytes.len() / 2]).is_err());
    }
}
