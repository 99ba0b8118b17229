//! The view of meshes: several side by side or over each other, with one camera.
//!
//! `arrays/` makes what is drawn of a mesh, `gpu/` draws it, `look/` says what it looks like,
//! `hand/` is what pointer and keys do, and `overlays/` holds what lies on the pictures. `section`
//! is the plane that cuts them, `outline` where it meets them; `viewpoint` and `placing` say from
//! where they are seen.

mod arrays;
mod backdrop;
mod distance;
mod element;
mod gpu;
mod hand;
mod item;
mod layout;
mod lines;
mod look;
mod offers;
mod outline;
mod overlays;
mod placing;
mod scene;
mod section;
mod view;
mod viewpoint;
mod viewport;

pub use distance::Distance;
pub use hand::navigation::VIEW_KEYS;
pub use look::coloring::{ColorBy, ScaleSettings};
pub use look::named::{NamedView, StillOptions};
pub use look::settings::{Arrangement, BackFaces, MeshSettings};
pub use look::stored::MeshLook;
pub use look::values::Spacing;
pub use section::Section;
pub use view::MeshView;
