//! Points in space. Say what a value means, and what cannot be seen from the types.

use glam::DVec3;
use mve_core::{Data, DataType};
use serde::{Deserialize, Serialize};

use super::TriMesh;

/// Points, in the order in which they are to be read.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Template {
    /// Where they are, in model space.
    pub points: Vec<DVec3>,
}

impl Data for Template {
    const TYPE: DataType =
        DataType { id: "Template", doc: "Points in space.", color: [120, 190, 170] };

    fn byte_size(&self) -> usize {
        size_of::<Self>() + size_of_val(self.points.as_slice())
    }

    fn summary(&self) -> String {
        format!("{} points", self.points.len())
    }
}

/// The first vertices of the mesh.
pub(super) fn sample(mesh: &TriMesh) -> Template {
    Template { points: mesh.positions.iter().take(3).copied().collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::tetrahedron;

    #[test]
    fn a_value_says_what_it_holds() {
        let points = sample(&tetrahedron());
        assert_eq!(points.summary(), "3 points");
        assert_eq!(points.byte_size() - Template::default().byte_size(), 3 * 24);
    }
}
