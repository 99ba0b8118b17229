//! What meshes look like: settings, colors and textures.

pub mod coloring;
pub mod controls;
pub mod named;
mod palette;
pub mod range_end;
pub mod settings;
pub mod stored;
pub mod texture;
pub mod values;

pub use palette::label_layers;
