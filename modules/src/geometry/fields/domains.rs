//! Values of one domain of a mesh over another one.

use mve_mesh::data::{Domain, TriMesh};

/// What becomes of several values that meet at one element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reduction {
    /// Their mean.
    Mean,
    /// The least of them.
    Least,
    /// The largest of them.
    Largest,
}

impl Reduction {
    /// Adds a value to what is known. What is not a number makes the mean none, and is passed over
    /// by the others.
    fn with(self, known: f64, value: f64) -> f64 {
        match self {
            Self::Mean => known + value,
            Self::Least => known.min(value),
            Self::Largest => known.max(value),
        }
    }

    fn ended(self, known: f64, n: usize) -> f64 {
        match self {
            Self::Mean => known / n as f64,
            Self::Least | Self::Largest if known.is_infinite() && n == 0 => f64::NAN,
            Self::Least | Self::Largest => known,
        }
    }

    fn start(self) -> f64 {
        match self {
            Self::Mean => 0.0,
            // The neutral element: max and min pass over what is not a number.
            Self::Least | Self::Largest => f64::NAN,
        }
    }
}

/// Values over `from` as values over `to`, by the corners that both have in common: a face has
/// three, a vertex one in each of its faces. A vertex without a face has no number then.
///
/// # Panics
/// When there is not one value for each element.
pub fn converted(
    values: &[f64],
    from: Domain,
    to: Domain,
    mesh: &TriMesh,
    reduction: Reduction,
) -> Vec<f64> {
    if from == to {
        return values.to_vec();
    }
    let place = |domain: Domain, corner: usize| match domain {
        Domain::Vertex => mesh.faces[corner / 3][corner % 3].idx(),
        Domain::Corner => corner,
        Domain::Face => corner / 3,
    };
    let n_elements = mesh.n_elements(to);
    let mut found = vec![(reduction.start(), 0_usize); n_elements];
    for corner in 0..3 * mesh.faces.len() {
        let (known, n) = &mut found[place(to, corner)];
        *known = reduction.with(*known, values[place(from, corner)]);
        *n += 1;
    }
    found.into_iter().map(|(known, n)| reduction.ended(known, n)).collect()
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::mesh_of;

    use super::*;

    #[test]
    fn corners_carry_values_between_domains() {
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [9.0; 3]];
        let mesh = mesh_of(&points, &[[0, 1, 2], [0, 2, 3]]);
        let vertices = [0.0, 1.0, 5.0, 4.0, 7.0];
        let to_faces =
            |reduction| converted(&vertices, Domain::Vertex, Domain::Face, &mesh, reduction);
        assert_eq!(to_faces(Reduction::Mean), [2.0, 3.0]);
        assert_eq!(to_faces(Reduction::Least), [0.0, 0.0]);
        assert_eq!(to_faces(Reduction::Largest), [5.0, 5.0]);
        let to_vertices =
            converted(&[2.0, 4.0], Domain::Face, Domain::Vertex, &mesh, Reduction::Mean);
        assert_eq!(to_vertices[..4], [3.0, 2.0, 3.0, 4.0]);
        assert!(to_vertices[4].is_nan());
        let corners =
            converted(&vertices, Domain::Vertex, Domain::Corner, &mesh, Reduction::Largest);
        assert_eq!(corners, [0.0, 1.0, 5.0, 0.0, 5.0, 4.0]);
        assert_eq!(
            converted(&corners, Domain::Corner, Domain::Vertex, &mesh, Reduction::Least)[..4],
            vertices[..4]
        );
    }
}
