//! How far the surface is from a vertex once that is gone.
//!
//! Sources: W. Schroeder, J. Zarge and W. Lorensen, "Decimation of triangle meshes", SIGGRAPH 1992,
//! section 2.2 (distance to the mean plane, distance to the line of an edge); M. Franz, 2000 (edge
//! switching: what the surface around a vertex would move by if its edges were switched).

use glam::DVec3;

use super::star::Star;

/// Sum over the edges at a vertex of the distance between the line of the edge and that through the
/// neighbors before and behind: the edge that could be in its place. 0 where all lie in a plane.
///
/// Lines `p + s d` and `q + t e` are `|(q − p) · (d × e)| / |d × e|` apart; parallel ones lie in a
/// plane and count nothing. Lines, as parts of them are apart in a plane, too, where the four
/// points are not convex.
pub fn edge_switching(star: &Star) -> f64 {
    let n = star.ring.len();
    let distance = |i: usize| {
        let before = star.spokes[if i == 0 { n - 1 } else { i - 1 }];
        let (edge, next) = (star.spokes[i], star.spokes[star.after(i)]);
        let across = edge.cross(next - before);
        let length = across.length();
        // Of lines that are parallel but for rounding what is left of the product is noise.
        let least = 1e-12 * edge.length() * (next - before).length();
        if length > least { (before.dot(across) / length).abs() } else { 0.0 * length }
    };
    (0..n).map(distance).sum()
}

/// Distance of a vertex from the mean plane of its faces: through the mean of their centers, with
/// the mean of their normals, each by its area.
pub fn mean_plane_distance(star: &Star) -> f64 {
    let (mut normal, mut center, mut area) = (DVec3::ZERO, DVec3::ZERO, 0.0);
    for (i, &of_face) in star.normals.iter().enumerate() {
        let weight = of_face.length();
        normal += of_face;
        center += weight / 3.0 * (star.spokes[i] + star.spokes[star.after(i)]);
        area += weight;
    }
    let distance = (normal.dot(center) / (area * normal.length())).abs();
    // Faces without area have all of their points on a line or at one.
    if area == 0.0 { 0.0 } else { distance }
}

/// Distance of the origin from the line through two points; from the points, where they are one.
pub fn line_distance(a: DVec3, b: DVec3) -> f64 {
    let along = b - a;
    let length = along.length();
    if length > 0.0 { a.cross(along).length() / length } else { a.length() }
}
