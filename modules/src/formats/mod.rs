//! File formats, without ports: what reads them from bytes and writes them.

mod file_error;
pub mod obj;
pub mod plain_file;
pub mod ply;
pub mod png;
mod save;
pub mod texture_file;

pub use file_error::{FileAction, FileError};
pub use plain_file::{ReadError, load};
pub use save::save_atomic;
