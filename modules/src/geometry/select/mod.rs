//! Which faces or vertices of a mesh are chosen: by values, place, component, direction and
//! neighborhood.
//!
//! A selection that goes from module to module is a [`Field`](mve_mesh::data::Field) in which what
//! is chosen has the value 1 and all else 0.

pub mod chosen;
pub mod criteria;
