//! A scalar field over the elements of a mesh.

use mve_core::{Data, DataType, brief};
use serde::{Deserialize, Serialize};

use super::{Domain, TriMesh};

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

impl Field {
    /// Tests whether there is one value for each element of the mesh; the message names both
    /// counts.
    pub fn check_fits(&self, mesh: &TriMesh) -> Result<(), String> {
        let (found, expected) = (self.values.len(), mesh.n_elements(self.domain));
        let elements = match self.domain {
            Domain::Vertex => "vertices",
            Domain::Corner => "corners",
            Domain::Face => "faces",
        };
        if found == expected {
            return Ok(());
        }
        Err(format!(
            "the field \"{}\" has {found} values, but the mesh has {expected} {elements}; it \
             belongs to another mesh",
            self.name
        ))
    }
}

impl Data for Field {
    const TYPE: DataType = DataType {
        id: "Field",
        doc: "One number for each vertex, corner or face of a mesh.",
        color: [225, 170, 80],
    };

    fn byte_size(&self) -> usize {
        size_of::<Self>() + size_of_val(self.values.as_slice())
    }

    fn summary(&self) -> String {
        let finite = || self.values.iter().filter(|value| value.is_finite());
        let low = finite().copied().fold(f64::INFINITY, f64::min);
        let high = finite().copied().fold(f64::NEG_INFINITY, f64::max);
        if self.values.is_empty() {
            return "no field".to_owned();
        }
        let range = match low <= high {
            true => format!(" from {} to {}", brief(low), brief(high)),
            false => String::new(),
        };
        let name = if self.name.is_empty() { "unnamed" } else { &self.name };
        let n = match self.values.len() {
            1 => "1 value".to_owned(),
            n => format!("{n} values"),
        };
        format!("{name}, {n}{range}")
    }
}

/// The x coordinates of a mesh.
pub(super) fn sample(mesh: &TriMesh) -> Field {
    let values = mesh.positions.iter().map(|position| position.x).collect();
    Field { name: "x".to_owned(), unit: String::new(), domain: Domain::Vertex, values }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_says_what_there_is() {
        let field = |name: &str, values: &[f64]| {
            let (name, unit) = (name.to_owned(), String::new());
            Field { name, unit, domain: Domain::Vertex, values: values.to_vec() }.summary()
        };
        assert_eq!(field("", &[]), "no field");
        assert_eq!(field("distance", &[1e-9, f64::NAN, 2.0]), "distance, 3 values from 1e-9 to 2");
        assert_eq!(field("", &[f64::NAN]), "unnamed, 1 value");
    }
}
