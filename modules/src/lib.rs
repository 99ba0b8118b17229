//! Triangle meshes, the algorithms on them, and the modules, costs and metrics of mve.
//!
//! `data` is what flows through ports, of the crate `mve-mesh`, which is `mesh` here; `formats` is
//! the crate `mve-formats`. `geometry`, `picture` and `image_driven` are free functions over plain
//! data, with no ports; the other folders hold one file per module, cost, placement or metric.
//!
//! # From another crate
//!
//! [`registry`] has the modules; the crate `mve_core` runs maps of them, as
//! `modules/examples/run_map.rs` shows. The algorithms can be called without a map, as functions
//! over a [`TriMesh`](data::TriMesh): see [`geometry`], [`formats`] and [`picture`]. A module of
//! another crate begins with [`prelude`] and stands beside those of mve in one registry:
//! `modules/examples/own_module.rs`.

pub mod cost;
pub mod filters;
pub mod generate;
pub mod geometry;
pub mod image_driven;
pub mod images;
pub mod io;
pub mod measure;
pub mod metric;
pub mod picture;
pub mod placement;
pub mod prelude;
#[cfg(test)]
mod test_models;

pub use mve_formats as formats;
pub use mve_mesh::{self as mesh, data};

use mve_core::{MAP_ENDS, ModuleList, Registry, Synonym};

/// The modules of this crate, by folder.
static LISTS: [&ModuleList; 5] =
    [&filters::LIST, &generate::LIST, &images::LIST, &io::LIST, &measure::LIST];

/// All modules of this crate.
pub fn registry() -> Registry {
    Registry::new().with(&LISTS, env!("MVE_SHARED_SOURCES")).with(&[&MAP_ENDS], "")
}

/// Words of other programs for what modules do here, and words that declarations have for it.
pub static SYNONYMS: &[Synonym] = &[
    ("bake", "nearest points"),
    ("calculator", "formula"),
    ("clip", "cuts away"),
    ("decimate", "simplif"),
    ("decimation", "simplif"),
    ("denoise", "smooth"),
    ("distance", "differs"),
    ("error", "differs"),
    ("export", "save"),
    ("image", "picture"),
    ("import", "load"),
    ("isotropic", "even size"),
    ("lod", "simplif"),
    ("open", "load"),
    ("read", "load"),
    ("reduce", "simplif"),
    ("refine", "cuts every face"),
    ("repair", "manifold"),
    ("rotate", "turns"),
    ("screenshot", "picture"),
    ("show", "picture"),
    ("statistics", "counts"),
    ("translate", "moves"),
    ("view", "picture"),
    ("write", "save"),
];
