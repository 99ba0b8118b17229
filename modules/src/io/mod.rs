//! Reading and writing files; only this folder and the applications touch the file system.

pub mod file_error;
pub mod obj;
pub mod save;

pub use file_error::FileError;
pub use save::save_atomic;
