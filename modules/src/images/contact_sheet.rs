//! Puts many pictures on one sheet.

use crate::picture::contact_sheet::{SheetOptions, contact_sheet};
use crate::prelude::*;

const IMAGES_IN: ManyIn<Images> = ManyIn::new(
    "images",
    "One or more pictures of any number of links, put down in the order of the links.",
);
const COLUMNS: Param<Option<i64>> = Param::maybe_integer(
    "columns",
    "Pictures in a row. Off: as many as make the sheet about square.",
    None,
)
.between((1, 1_000_000))
.mostly((1, 12));
const CAPTIONS: Param<bool> =
    Param::flag("captions", "Whether the name of each picture stands below it.", true);
const IMAGES_OUT: Out<Images> =
    Out::new("images", "One picture: all of them row by row, on white.");

pub static MODULE: Module = Module {
    id: "ContactSheet",
    summary: "Puts many pictures on one sheet.",
    inputs: &[IMAGES_IN.spec()],
    outputs: &[IMAGES_OUT.spec()],
    params: &[COLUMNS.spec(), CAPTIONS.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let images = Images(io.take_all(IMAGES_IN)?.into_iter().flat_map(|images| images.0).collect());
    let columns = io.param(COLUMNS)?.map(|columns| columns as usize);
    let options = SheetOptions { columns, has_captions: io.param(CAPTIONS)? };
    let sheet = contact_sheet(&images, options)
        .map_err(|error| ModuleError::inputs(&IMAGES_IN, error.to_string()))?;
    io.put(IMAGES_OUT, Images(vec![sheet]));
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;
    use mve_mesh::data::{Image, PixelKind};

    use crate::prelude::*;

    #[test]
    fn pictures_of_all_links_are_there() {
        let images = |n: usize| Images(vec![Image::filled("a", [24, 24], PixelKind::Gray, 5); n]);
        let trial = Trial::of(&super::MODULE).input("images", images(3)).input("images", images(1));
        let outputs = trial.set("captions", false).run().unwrap();
        let sheet = &outputs["images"].get::<Images>().unwrap().0;
        assert_eq!((sheet[0].width, sheet[0].height), (72, 72));
    }

    #[test]
    fn four_pictures_make_a_square() {
        let images = Images(vec![Image::filled("a", [24, 24], PixelKind::Gray, 5); 4]);
        let trial = Trial::of(&super::MODULE).input("images", images).set("captions", false);
        let outputs = trial.run().unwrap();
        let sheet = &outputs["images"].get::<Images>().unwrap().0;
        assert_eq!((sheet.len(), sheet[0].width, sheet[0].height), (1, 72, 72));
    }
}
