//! What flows through ports: triangle meshes, fields on them, pictures and what was measured.

mod field;
mod images;
mod layer;
mod measures;
mod tri_mesh;

pub use field::Field;
pub use images::{Image, Images, PixelKind};
pub use layer::{Domain, Layer, LayerValues, NO_VALUE};
pub use measures::{Measure, Measures};
pub use tri_mesh::{FaceId, Material, MeshFault, TriMesh, VertexId};
