//! A scalar field over the elements of a mesh.

use serde::{Deserialize, Serialize};

use super::Domain;

/// One number an element of some mesh, apart from the mesh so that one mesh can have many.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Field {
    /// What is measured, in lower case: `distance`.
    pub name: String,
    /// Unit of the values, for axes and color bars: `model units`.
    pub unit: String,
    /// What the values belong to.
    pub domain: Domain,
    /// One value an element, in the mesh's order.
    pub values: Vec<f64>,
}
