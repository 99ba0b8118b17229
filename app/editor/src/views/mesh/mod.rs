//! The view of meshes: several side by side or over each other, with one camera.

mod arrays;
mod captions;
mod coarse;
mod coloring;
mod edges;
mod gpu;
mod gpu_buffers;
mod gpu_target;
mod hover;
mod item;
mod kept;
mod layout;
mod navigation;
mod overlay;
mod palette;
mod pick;
mod settings;
mod texture;
mod view;

pub use coloring::{ColorBy, PinnedField, ScaleSettings, Spacing};
pub use kept::MeshLook;
pub use overlay::histogram;
pub use settings::{Arrangement, BackFaces, Settings};
pub use view::{MeshInput, MeshView, PinnedPicture};
