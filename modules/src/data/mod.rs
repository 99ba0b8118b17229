//! What flows through ports: triangle meshes, fields on them, pictures and what was measured.

mod field;
mod images;
mod layer;
pub(crate) mod material;
mod measures;
mod tri_mesh;

pub use field::Field;
pub use images::{Image, Images, PixelKind};
pub use layer::{Domain, Layer, LayerValues, NO_VALUE};
pub use material::{Material, Texture, TextureImage, TextureRole};
pub use measures::{Measure, Measures};
pub use tri_mesh::{FaceId, MeshFault, TriMesh, VertexId};
