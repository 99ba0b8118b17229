//! Triangle meshes, the algorithms on them, and the modules, costs and metrics of mve.
//!
//! `data` is what flows through ports; `mesh`, `geometry`, `picture`, `image_driven` and `formats`
//! are plain data and free functions over it, with no ports; the other folders hold one file per
//! module, cost, placement or metric.

pub mod cost;
pub mod data;
pub mod filters;
pub mod formats;
pub mod generate;
pub mod geometry;
pub mod image_driven;
pub mod images;
pub mod io;
pub mod measure;
pub mod mesh;
pub mod metric;
pub mod picture;
pub mod placement;
mod prelude;
#[doc(hidden)]
pub mod testing;

use mve_core::{ModuleList, Registry};

/// The modules of this crate, by folder.
static LISTS: [&ModuleList; 5] =
    [&filters::LIST, &generate::LIST, &images::LIST, &io::LIST, &measure::LIST];

/// All modules of this crate.
pub fn registry() -> Registry {
    Registry::new().with(&LISTS, env!("MVE_SHARED_SOURCES"))
}
