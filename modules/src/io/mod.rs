//! Reading and writing files; only this folder and the applications touch the file system.

mod file_error;
pub mod obj;
mod plain_file;
pub mod ply;
pub mod png;
mod save;

pub use file_error::FileError;
pub use save::save_atomic;

mve_core::modules! { "io": obj_loader, obj_saver, ply_saver, png_loader, png_saver }
