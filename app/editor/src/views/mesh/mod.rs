//! The view of meshes: several side by side or over each other, with one camera.
//!
//! `arrays/` makes what is drawn of a mesh, `gpu/` draws it, `look/` says what it looks like,
//! `hand/` is what pointer and keys do, and `overlays/` holds what lies on the pictures.

mod arrays;
mod gpu;
mod hand;
mod item;
mod layout;
mod lines;
mod look;
mod overlays;
mod scene;
mod view;

pub use hand::navigation::VIEW_KEYS;
pub use look::coloring::{ColorBy, ScaleSettings};
pub use look::settings::{Arrangement, BackFaces, MeshSettings};
pub use look::stored::MeshLook;
pub use look::values::Spacing;
pub use view::{MeshView, StillOptions};
