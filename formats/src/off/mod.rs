//! OFF files: polygons as lists of numbers.
//!
//! After the manual of Geomview, "OFF Files" (S. Levy, T. Munzner, M. Phillips; The Geometry
//! Center, 1996): the keyword says what a vertex has besides its position: normal (`N`), color
//! (`C`), texture coordinates (`ST`), in that order behind it. The keyword may be missing.

mod read;
mod save;
mod write;

pub use read::read_off;
pub use save::save;
pub use write::write_off;

#[cfg(test)]
mod tests;
