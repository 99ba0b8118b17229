//! How different two meshes look to people: MSDM and MSDM2.

pub mod msdm;
pub mod msdm2;
