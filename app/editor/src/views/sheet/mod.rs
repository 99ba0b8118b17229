//! The table of a value's elements: a row for each vertex, corner or face, sorted and filtered,
//! and linked with the element that is picked in the picture of the mesh.

mod columns;
mod filter;
mod row;
mod rows;
mod scroll;
mod source;
mod view;

pub use columns::{SheetColumn, mesh_columns};
pub use view::{SheetAction, SheetView};
