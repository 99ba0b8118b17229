//! What a file with a module in it begins with, here and in other crates.

pub use std::path::PathBuf;

// It offers what a module may need, whether or not one here does.
#[allow(unused_imports)]
pub use mve_core::{
    AnyIn, ChoiceParam, Enumeration, In, Io, ManyAnyIn, ManyIn, MaybeIn, Module, ModuleError, Out,
    Param, Quantity, Seed, Settings, Unit,
};

#[allow(unused_imports)]
pub use mve_mesh::data::types::*;
#[allow(unused_imports)]
pub use mve_mesh::data::{Domain, Layer};
