//! What flows through ports: triangle meshes, fields on them, pictures, tables and what was
//! measured.

/// Declares the files of data types, hands the types on, and lists them.
macro_rules! data_types {
    ($($file:ident: $type:ident),+ $(,)?) => {
        $(mod $file;)+
        $(pub use $file::$type;)+

        /// The data types of this crate.
        pub static DATA_TYPES: &[DataTypeEntry] = &[$(DataTypeEntry {
            data_type: <$type as Data>::TYPE,
            sample: |mesh| Value::new($file::sample(mesh)),
        }),+];

        /// The types alone, for the files of modules; one may be new, and no module use it yet.
        #[allow(unused_imports)]
        pub mod types {
            $(pub use super::$type;)+
        }
    };
}

data_types! {
    field: Field,
    images: Images,
    measures: Measures,
    table: Table,
    tri_mesh: TriMesh,
}

mod face_materials;
mod layer;
pub(crate) mod material;
mod name;

pub use face_materials::FaceMaterials;
pub use images::{Image, PixelKind, bytes_of};
pub use layer::{Domain, Layer, LayerValues, NO_VALUE};
pub use material::{Material, Texture, TextureImage, TextureRole};
pub use measures::Measure;
pub use name::{
    name_from_bytes, name_from_file, name_recoded, name_to_bytes, name_to_file, shown_name,
};
pub use table::{ColumnValues, TableColumn};
pub use tri_mesh::{FaceId, MeshFault, VertexId};

use mve_core::{Data, DataType, Value};

/// A data type, and how tests that go through all types get a value of it.
pub struct DataTypeEntry {
    /// The declaration.
    pub data_type: DataType,
    /// A small value that goes with a mesh.
    pub sample: fn(&TriMesh) -> Value,
}

/// What `mve new data` begins with.
#[cfg(test)]
#[path = "../../../modules/templates/data.rs"]
mod template;
