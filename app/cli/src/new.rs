//! `mve new`: a map to start from, and files for whoever adds to mve.

use std::path::{Path, PathBuf};

use clap::Subcommand;

use crate::exit::{Exit, Stop};
use crate::{out, scaffold};

const MAP: &str = include_str!("templates/map.json");

/// Start a map, a module, a cost, a placement, a metric, a loader, a data type or a view
#[derive(clap::Args)]
#[command(after_help = "Examples:
  mve new map first.json
  mve new module Extrude --folder filters
  mve new cost CurvatureWeighted
  mve new image-cost ImageAbsolute
  mve new placement Centroid
  mve new metric Roundness
  mve new loader GtsLoader
  mve new data Landmarks
  mve new view Landmarks")]
pub struct Args {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand)]
enum What {
    /// Write a small map that runs
    Map {
        /// The file to write; must not exist
        file: PathBuf,
    },
    /// Write a module, with a test, and enter it in the list of its folder
    ///
    /// Works inside a checkout of mve: writes modules/src/FOLDER/NAME.rs.
    Module {
        /// Id in CamelCase: verbs change a mesh (FillHoles), nouns make or measure one (Volume)
        name: String,
        /// Folder of modules/src: filters, generate, images, io, measure
        #[arg(long, default_value = "filters")]
        folder: String,
    },
    /// Write a cost function, with a test, and enter it in the list of costs
    ///
    /// Works inside a checkout of mve: writes modules/src/cost/NAME.rs.
    Cost {
        /// Id in CamelCase, such as CurvatureWeighted
        name: String,
    },
    /// Write a cost that looks at pictures, with a test, and enter it in the list of costs
    ///
    /// Works inside a checkout of mve: writes modules/src/cost/NAME.rs.
    ImageCost {
        /// Id in CamelCase, such as ImageAbsolute
        name: String,
    },
    /// Write a placement, with a test, and enter it in the list of placements
    ///
    /// Works inside a checkout of mve: writes modules/src/placement/NAME.rs.
    Placement {
        /// Id in CamelCase, such as Centroid
        name: String,
    },
    /// Write a metric, with a test, and enter it in the list of metrics
    ///
    /// Works inside a checkout of mve: writes modules/src/metric/NAME.rs.
    Metric {
        /// Id in CamelCase, such as Roundness
        name: String,
    },
    /// Write a loader of a file format, with a test, and enter it in the list of its folder
    ///
    /// Works inside a checkout of mve: writes modules/src/io/NAME.rs.
    Loader {
        /// Id in CamelCase, the format first: GtsLoader
        name: String,
    },
    /// Write a type of data, with a test, and enter it in the list of types
    ///
    /// Works inside a checkout of mve: writes mesh/src/data/NAME.rs.
    Data {
        /// The type in CamelCase, such as Landmarks
        name: String,
    },
    /// Write the view of a type of data, with a test, and enter it in the list of views
    ///
    /// Works inside a checkout of mve: writes app/editor/src/views/NAME.rs.
    View {
        /// The type in CamelCase, such as Landmarks
        name: String,
    },
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Exit, Stop> {
    match &args.what {
        What::Map { file } => new_map(file),
        What::Module { name, folder } => scaffold::module(name, folder),
        What::Cost { name } => scaffold::cost(name),
        What::ImageCost { name } => scaffold::image_cost(name),
        What::Placement { name } => scaffold::placement(name),
        What::Metric { name } => scaffold::metric(name),
        What::Loader { name } => scaffold::loader(name),
        What::Data { name } => scaffold::data(name),
        What::View { name } => scaffold::view(name),
    }
}

fn new_map(path: &Path) -> Result<Exit, Stop> {
    if path.symlink_metadata().is_ok() {
        let error = std::io::ErrorKind::AlreadyExists.into();
        return Err(Stop::file(path, &error));
    }
    out::write_file(path, MAP)?;
    let path = path.display();
    out::print(&format!("wrote {path}; run it with: mve run {path}\n"))
}

#[cfg(test)]
mod tests {
    use mve_core::testing::plan_options;
    use mve_core::{FileHashes, Map, Plan, Program};

    use super::*;

    #[test]
    fn the_example_is_a_map_that_runs() {
        let map = Map::parse(MAP).unwrap();
        assert!(map.problems().is_empty());
        let mut changed = map.clone();
        changed.title.push('.');
        let canonical = changed.to_text().replace(&changed.title, &map.title);
        assert_eq!(canonical, MAP);
        let registry = mve_modules::registry();
        let files = FileHashes::new();
        Plan::new(&map, &registry, &plan_options(Path::new("."), &files)).unwrap();
        for name in map.programs.keys() {
            assert!(Program::new(&map, name, &registry, Path::new(".")).is_ok());
        }
    }
}
