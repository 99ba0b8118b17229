//! The list of costs: what a collapse is worth, one file a cost.
//!
//! The trait is [`Cost`], of the engine.

mod pictures;

mve_core::registered! {
    static ENTRIES: Entry<MakeCost> =
        COST in edge_length, image_mse, image_ssim, lindstrom_turk, msdm2, quadric;
}

pub use edge_length::EdgeLength;
pub use image_mse::Squares;
pub use lindstrom_turk::LindstromTurk;
pub use msdm2::Msdm2;
use mve_core::{Choices, Entry, ModuleError, Settings};
use mve_mesh::data::TriMesh;
pub use quadric::Quadric;

use crate::geometry::simplify::collapse::Cost;

/// All costs, for the parameters of modules.
pub static COSTS: Choices<MakeCost> = Choices::new(ENTRIES);

/// Makes a cost for a mesh that is about to be simplified, from the cost's parameters.
pub type MakeCost = fn(&TriMesh, &Settings) -> Result<Box<dyn Cost>, ModuleError>;

/// What `mve new cost` begins with.
#[cfg(test)]
#[path = "../../templates/cost.rs"]
#[expect(dead_code, reason = "it stands in no list")]
mod template;

/// What `mve new image-cost` begins with.
#[cfg(test)]
#[path = "../../templates/image_cost.rs"]
mod image_template;
