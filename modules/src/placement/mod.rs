//! The list of placements: where the vertex of a collapse goes, one file a placement.
//!
//! The trait is [`Placement`], of the engine.

mve_core::registered! {
    static ENTRIES: Entry<MakePlacement> = PLACEMENT in endpoint, lindstrom_turk, midpoint, optimal;
}

pub use endpoint::Endpoint;
pub use lindstrom_turk::LindstromTurk;
pub use midpoint::Midpoint;
use mve_core::{Choices, Entry, ModuleError, Settings};
use mve_mesh::data::TriMesh;
pub use optimal::Optimal;

use crate::geometry::simplify::collapse::Placement;

/// All placements, for the parameters of modules.
pub static PLACEMENTS: Choices<MakePlacement> = Choices::new(ENTRIES);

/// Makes a placement for a mesh that is about to be simplified, from the placement's parameters.
pub type MakePlacement = fn(&TriMesh, &Settings) -> Result<Box<dyn Placement>, ModuleError>;

/// What `mve new placement` begins with.
#[cfg(test)]
#[path = "../../templates/placement.rs"]
#[expect(dead_code, reason = "it stands in no list")]
mod template;
