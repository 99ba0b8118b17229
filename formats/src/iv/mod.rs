//! Open Inventor files, the text of versions 2.0 and 2.1, and VRML 1.0, which came from it.
//!
//! After J. Wernecke, "The Inventor Mentor", Addison-Wesley, 1994, and "The Inventor Toolmaker",
//! 1994 (file format); fields and their defaults as the reference pages of Coin have them.
//! `lexer.rs` and `values.rs` read words and values, `parse.rs` makes nodes of them, `scene.rs`
//! goes through these with the state that each leaves to those behind it.
//!
//! Read are face sets and triangle strips, indexed or not, where transforms put them, with
//! materials, colors, normals and texture coordinates by any binding, and the pictures of textures.
//! A switch gives the child that it names, a level of detail its first. Where a transform mirrors,
//! faces are turned, so that what was outside stays outside. All else is stepped over by its braces
//! and named in a warning.

mod corners;
mod file;
mod lexer;
mod node;
mod parse;
mod properties;
mod read;
mod scene;
mod values;
mod write;

pub use file::{companions, load, save};
pub use read::read_iv;
pub use write::write_iv;

#[cfg(test)]
mod tests;
