//! What flows through ports: triangle meshes and fields on them.

mod field;
mod layer;
mod tri_mesh;

pub use field::Field;
pub use layer::{Domain, Layer, LayerValues, NO_VALUE};
pub use tri_mesh::{FaceId, Material, MeshFault, TriMesh, VertexId};
