//! Quadrics of vertices: squared distances to the planes of all faces that they stand for.

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::quadric::Quadric;

use super::star_mesh::StarMesh;

/// Of a border edge the plane through it, at right angles to its face, counts so many times the
/// square of its length, so that borders stay in place where they are decimated.
const BORDER_WEIGHT: f64 = 1.0;

/// The quadric of each vertex about its place: each face counts by a third of its area. With
/// borders, if these may move.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn quadrics(
    mesh: &StarMesh,
    has_borders: bool,
    control: Control,
) -> Result<Vec<Quadric>, Cancelled> {
    let mut quadrics = vec![Quadric::default(); mesh.positions.len()];
    for (place, face) in mesh.faces.iter().enumerate() {
        control.item(place, mesh.faces.len())?;
        if let Some((normal, length)) = plane_of(mesh, *face) {
            let plane = Quadric::from_plane(normal, 0.0, length / 6.0);
            face.iter().for_each(|&v| quadrics[v as usize].add(&plane));
        }
    }
    if has_borders {
        for (vertex, quadric) in quadrics.iter_mut().enumerate() {
            control.item(vertex, mesh.positions.len())?;
            add_borders(mesh, vertex as u32, quadric);
        }
    }
    Ok(quadrics)
}

/// Adds the border edges at a vertex.
pub fn add_borders(mesh: &StarMesh, vertex: u32, quadric: &mut Quadric) {
    for &corner in mesh.corners_of(vertex) {
        let Some((normal, _)) = plane_of(mesh, mesh.faces[corner as usize / 3]) else { continue };
        for end in mesh.beside(corner).into_iter().filter(|&end| mesh.is_border([vertex, end])) {
            let along = mesh.positions[end as usize] - mesh.positions[vertex as usize];
            let across = along.cross(normal).normalize_or_zero();
            let weight = BORDER_WEIGHT * along.length_squared();
            quadric.add(&Quadric::from_plane(across, 0.0, weight));
        }
    }
}

/// The unit normal of a face and twice its area; `None` without one.
fn plane_of(mesh: &StarMesh, face: [u32; 3]) -> Option<(DVec3, f64)> {
    let [a, b, c] = face.map(|v| mesh.positions[v as usize]);
    let normal = (b - a).cross(c - a);
    let length = normal.length();
    (length > 0.0 && length < f64::INFINITY).then(|| (normal / length, length))
}
