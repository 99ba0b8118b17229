//! The types of vertices (W. Schroeder, J. Zarge and W. Lorensen, "Decimation of triangle meshes",
//! SIGGRAPH 1992, section 2.1).
//!
//! Deviation: a vertex at which one feature edge ends is simple, where the paper has it a corner;
//! else no vertex on a noisy surface is simple.

use super::star::{Form, Star};

/// What a vertex is, by the faces around it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VertexKind {
    /// Its faces are a disk around it, and fold at no more than one edge.
    Simple,
    /// Its faces are neither a disk nor half a disk.
    Complex,
    /// Its faces are half a disk.
    Boundary,
    /// Two feature edges of a disk meet there.
    InteriorEdge,
    /// Three or more do.
    Corner,
}

impl VertexKind {
    /// All, in the order of their numbers in a field.
    pub const ALL: [Self; 5] =
        [Self::Simple, Self::Complex, Self::Boundary, Self::InteriorEdge, Self::Corner];

    /// Its number in a field.
    pub fn number(self) -> f64 {
        f64::from(self as u8)
    }
}

/// The kind of the vertex of a star, and the places in its ring of the two ends of its line: those
/// of two feature edges, or of the border.
///
/// A feature edge is one whose faces have normals apart by an angle of a smaller cosine. A face
/// without area makes none.
pub fn kind_of(star: &Star, form: Form, feature_cos: f64) -> (VertexKind, [usize; 2]) {
    match form {
        Form::Other => (VertexKind::Complex, [0, 0]),
        Form::Open => (VertexKind::Boundary, [0, star.ring.len().saturating_sub(1)]),
        Form::Closed => {
            let (mut n_features, mut ends) = (0, [0, 0]);
            for edge in feature_edges(star, feature_cos) {
                if let Some(end) = ends.get_mut(n_features) {
                    *end = edge;
                }
                n_features += 1;
            }
            let kind = match n_features {
                0 | 1 => VertexKind::Simple,
                2 => VertexKind::InteriorEdge,
                _ => VertexKind::Corner,
            };
            (kind, ends)
        }
    }
}

/// The feature edges of a closed star, by the places of their ends in its ring: face `i` lies
/// behind edge `i`.
pub fn feature_edges(star: &Star, feature_cos: f64) -> impl Iterator<Item = usize> {
    let n = star.normals.len();
    (0..n).filter(move |&i| {
        let (one, other) = (star.normals[(i + n - 1) % n], star.normals[i]);
        is_apart(one.dot(other), one.length_squared() * other.length_squared(), feature_cos)
    })
}

/// Whether vectors of this product, and this product of squared lengths, are apart by an angle of a
/// smaller cosine.
#[inline]
pub fn is_apart(dot: f64, squares: f64, cos: f64) -> bool {
    dot < cos * squares.sqrt()
}
