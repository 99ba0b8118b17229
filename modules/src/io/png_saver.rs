//! Saves a picture as a PNG file, or many on one sheet.

use std::borrow::Cow;

use mve_formats::png::write_png;
use mve_formats::save_atomic;

use crate::picture::contact_sheet::{SheetOptions, contact_sheet};
use crate::prelude::*;

const IMAGES_IN: In<Images> = In::new("images", "One or more pictures.");
const PATH: Param<PathBuf> = Param::output_file("path", "The file.", &["png"]);
const IMAGE: Param<Option<i64>> = Param::maybe_integer(
    "image",
    "Which picture, from 0. Off: all of them, on one sheet if there is more than one.",
    None,
)
.between((0, u32::MAX as i64))
.mostly((0, 23));
const COLUMNS: Param<Option<i64>> = Param::maybe_integer(
    "columns",
    "Pictures in a row of the sheet. Off: as many as make it about square.",
    None,
)
.between((1, 1_000_000))
.mostly((1, 12));
const CAPTIONS: Param<bool> = Param::flag(
    "captions",
    "Whether the name of each picture stands below it on the sheet.",
    false,
);

pub static MODULE: Module = Module {
    id: "PngSaver",
    summary: "Saves a picture as a PNG file, or many on one sheet.",
    inputs: &[IMAGES_IN.spec()],
    outputs: &[],
    params: &[PATH.spec(), IMAGE.spec(), COLUMNS.spec(), CAPTIONS.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let (images, path) = (io.get(IMAGES_IN)?, io.param(PATH)?);
    let columns = io.param(COLUMNS)?.map(|columns| columns as usize);
    let options = SheetOptions { columns, has_captions: io.param(CAPTIONS)? };
    let image = match (io.param(IMAGE)?, images.0.as_slice()) {
        (Some(place), images) => {
            let message = || format!("there is no image {place}; there are {}", images.len());
            let image = images.get(place as usize);
            Cow::Borrowed(image.ok_or_else(|| ModuleError::param(&IMAGE, message()))?)
        }
        (None, [one]) => Cow::Borrowed(one),
        (None, _) => {
            let sheet = contact_sheet(&images, options);
            Cow::Owned(sheet.map_err(|e| ModuleError::input(&IMAGES_IN, e.to_string()))?)
        }
    };
    io.check()?;
    Ok(save_atomic(&path, |out| write_png(&image, out, io.control()))?)
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;
    use mve_formats::png::read_png;
    use mve_mesh::data::{Image, PixelKind};

    use crate::prelude::*;

    #[test]
    fn one_picture_is_saved_as_it_is_and_many_on_a_sheet() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let image = |value| Image::filled("camera", [16, 16], PixelKind::Gray, value);
        let images = Images(vec![image(3), image(4), image(5)]);
        let trial = || {
            let trial = Trial::of(&super::MODULE).input("images", images.clone());
            trial.set("path", path.to_str().unwrap())
        };
        let saved = || read_png(&std::fs::read(&path).unwrap(), "camera").unwrap();
        trial().set("image", 1).run().unwrap();
        assert_eq!(saved(), image(4));
        trial().set("columns", 3).run().unwrap();
        assert_eq!((saved().width, saved().height), (3 * 24 + 8, 24 + 8));
        let message = trial().set("image", 3).run().unwrap_err().to_string();
        assert!(message.contains("no image 3; there are 3"), "{message}");
    }
}
