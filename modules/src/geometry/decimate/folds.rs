//! Whether faces lie folded onto each other.

use glam::DVec3;

use super::kind::is_apart;
use super::star_mesh::StarMesh;

/// cos 150°.
const FOLD_COS: f64 = -0.866_025_403_784_438_6;

/// Whether faces of these normals, as seen from one side, are folded onto each other: by more than
/// 150°.
pub fn is_fold(one: DVec3, other: DVec3) -> bool {
    is_apart(one.dot(other), one.length_squared() * other.length_squared(), FOLD_COS)
}

/// The normal of the face beyond the edge that a face has from `a` to `b`, as seen from the side of
/// that face, which also has `but`. `None` where it is not the only one.
pub fn normal_beyond(mesh: &StarMesh, [a, b]: [u32; 2], but: u32) -> Option<DVec3> {
    let mut found = None;
    let [few, many] =
        if mesh.corners_of(a).len() <= mesh.corners_of(b).len() { [a, b] } else { [b, a] };
    for &corner in mesh.corners_of(few) {
        let [next, before] = mesh.beside(corner);
        let other = match (next == many, before == many) {
            (true, _) => before,
            (_, true) => next,
            _ => continue,
        };
        if other == but {
            continue;
        }
        if found.is_some() {
            return None;
        }
        let [p, q, r] = [a, b, other].map(|v| mesh.positions[v as usize]);
        // It runs the other way along the edge.
        found = Some((r - p).cross(q - p));
    }
    found
}
