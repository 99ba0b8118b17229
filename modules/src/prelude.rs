//! What a file with a module in it begins with.

pub use std::path::PathBuf;

pub use mve_core::{
    AnyIn, ChoiceParam, Enumeration, In, Io, MaybeIn, Module, ModuleError, Out, Param, Seed,
    Settings,
};

pub use crate::data::{Field, TriMesh};
