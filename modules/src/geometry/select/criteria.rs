//! What makes vertices and faces chosen, and growing what is.

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::adjacency::{Adjacency, EdgeId};
use mve_mesh::data::{Domain, TriMesh};

use super::chosen::{CornerRule, Elements, over_faces, over_vertices};
use crate::geometry::edit::crop::Region;
use crate::geometry::surface::normals::{NormalWeight, face_normals, vertex_normals};

/// Whether each value is in a range, both ends of which belong to it; what is not a number is not.
pub fn in_range(values: &[f64], low: f64, high: f64) -> Vec<bool> {
    values.iter().map(|value| low <= *value && *value <= high).collect()
}

/// Whether each vertex lies in a region, whose border belongs to it; what is not finite does not.
pub fn in_region(mesh: &TriMesh, region: &Region) -> Vec<bool> {
    mesh.positions.iter().map(|p| region.contains(*p)).collect()
}

/// Whether the normal of each vertex or face is at most so far from a direction. What has no
/// normal is not chosen.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn facing(
    mesh: &TriMesh,
    elements: Elements,
    direction: DVec3,
    most_rad: f64,
    control: Control,
) -> Result<Vec<bool>, Cancelled> {
    let normals = match elements {
        Elements::Faces => face_normals(mesh, control)?,
        Elements::Vertices => vertex_normals(mesh, NormalWeight::Angle, control)?,
    };
    let is_near = |normal: &DVec3| {
        // Exact for right and small angles, where the arc cosine of a product is not.
        let angle = normal.cross(direction).length().atan2(normal.dot(direction));
        *normal != DVec3::ZERO && angle <= most_rad
    };
    Ok(normals.iter().map(is_near).collect())
}

/// Whether each vertex lies at a border: on an edge of exactly one face.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn at_border(mesh: &TriMesh, control: Control) -> Result<Vec<bool>, Cancelled> {
    let adjacency = Adjacency::new(mesh, control)?;
    let mut found = vec![false; mesh.positions.len()];
    for (edge, ends) in adjacency.edges().iter().enumerate() {
        if adjacency.sides_of(EdgeId(edge as u32)).len() == 1 {
            ends.iter().for_each(|v| found[v.idx()] = true);
        }
    }
    Ok(found)
}

/// Grows a selection by rings of neighbors, or shrinks it where `rings` is below 0: what is not
/// chosen is grown then. Vertices are neighbors that share a face, faces those that share a vertex.
/// O(n) a ring; it ends early where nothing changes.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn grown(
    mesh: &TriMesh,
    mut is: Vec<bool>,
    elements: Elements,
    rings: i64,
    control: Control,
) -> Result<Vec<bool>, Cancelled> {
    let shrinks = rings < 0;
    if shrinks {
        is.iter_mut().for_each(|is| *is = !*is);
    }
    let n_rings = rings.unsigned_abs();
    for ring in 0..n_rings {
        control.at(ring as f64 / n_rings as f64)?;
        let next = match elements {
            Elements::Faces => {
                let vertices = over_vertices(&is, Domain::Face, mesh);
                over_faces(&vertices, Domain::Vertex, mesh, CornerRule::Any)
            }
            Elements::Vertices => {
                let faces = over_faces(&is, Domain::Vertex, mesh, CornerRule::Any);
                let mut next = over_vertices(&faces, Domain::Face, mesh);
                next.iter_mut().zip(&is).for_each(|(next, is)| *next |= *is);
                next
            }
        };
        if next == is {
            break;
        }
        is = next;
    }
    if shrinks {
        is.iter_mut().for_each(|is| *is = !*is);
    }
    Ok(is)
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::cube;

    use super::*;
    use crate::geometry::generate::{PlaneOptions, plane};

    fn count(is: &[bool]) -> usize {
        is.iter().filter(|is| **is).count()
    }

    /// On a grid of 8 by 8 squares rings around the middle are squares of odd size.
    #[test]
    fn rings_grow_and_shrink() {
        let mesh = plane(&PlaneOptions { segments: [8, 8], ..PlaneOptions::DEFAULT });
        let mut is = vec![false; 81];
        is[40] = true;
        let grown = |is: &[bool], rings, elements| {
            grown(&mesh, is.to_vec(), elements, rings, Control::none()).unwrap()
        };
        // Diagonals run one way, so that two corners of the square of nine are no neighbors.
        assert_eq!(count(&grown(&is, 1, Elements::Vertices)), 7);
        assert_eq!(count(&grown(&is, 100, Elements::Vertices)), 81);
        assert_eq!(grown(&grown(&is, 2, Elements::Vertices), -2, Elements::Vertices), is);
        assert_eq!(count(&grown(&is, -1, Elements::Vertices)), 0);
        let mut face = vec![false; 128];
        face[0] = true;
        // The first triangle lies at a corner of the grid, and six others at its three corners.
        let around = grown(&face, 1, Elements::Faces);
        assert_eq!(count(&around), 7);
        assert!(grown(&around, -1, Elements::Faces)[0]);
    }

    #[test]
    fn the_border_of_a_grid_and_the_top_of_a_cube() {
        let mesh = plane(&PlaneOptions { segments: [8, 8], ..PlaneOptions::DEFAULT });
        assert_eq!(count(&at_border(&mesh, Control::none()).unwrap()), 32);
        let cube = cube(DVec3::ZERO);
        let found = |degrees: f64| {
            let most = degrees.to_radians();
            facing(&cube, Elements::Faces, DVec3::Z, most, Control::none()).unwrap()
        };
        assert_eq!((count(&found(0.0)), count(&found(90.0)), count(&found(180.0))), (2, 10, 12));
        assert_eq!(count(&in_region(&cube, &Region::Sphere(DVec3::ZERO, 1.0))), 4);
        assert_eq!(in_range(&[0.0, f64::NAN, 1.0, 2.0], 0.0, 1.0), [true, false, true, false]);
    }
}
