//! What is under the pointer: a ray against all faces.
//!
//! There is no search structure: a million faces take some ten milliseconds on one core, off the
//! window's thread, and nothing has to be built or kept for it.

use glam::DVec3;
use mve_modules::data::{Domain, TriMesh};
use rayon::prelude::*;

use crate::views::camera::Ray;
use crate::views::mesh::look::values::Values;
use crate::views::mesh::section::Plane;
use crate::views::number::number_text;

/// The nearest face that a ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The face, from 0.
    pub face: usize,
    /// Its corner nearest to the point, 0 to 2.
    pub corner: usize,
    /// Where.
    pub point: DVec3,
    /// From the origin of the ray.
    pub distance: f64,
}

/// Finds the face (T. Möller & B. Trumbore, "Fast, minimum storage ray-triangle intersection",
/// Journal of Graphics Tools 2(1), 1997). Of several at one distance that of the lowest number.
/// What a plane cuts away is not met.
pub fn pick(mesh: &TriMesh, ray: &Ray, plane: Option<&Plane>) -> Option<Hit> {
    let of_face = |(face, corners): (usize, &[mve_modules::data::VertexId; 3])| {
        let mut points = [DVec3::ZERO; 3];
        for (point, vertex) in points.iter_mut().zip(corners) {
            *point = *mesh.positions.get(vertex.idx())?;
        }
        let distance = distance_to(points, ray)?;
        let point = ray.origin + ray.direction * distance;
        if plane.is_some_and(|plane| plane.height(point) > 0.0) {
            return None;
        }
        let far = |k: &usize| points[*k].distance_squared(point);
        let corner = (0..3).min_by(|a, b| far(a).total_cmp(&far(b)))?;
        Some(Hit { face, corner, point, distance })
    };
    mesh.faces
        .par_iter()
        .with_min_len(1 << 14)
        .enumerate()
        .filter_map(of_face)
        .min_by(|a, b| a.distance.total_cmp(&b.distance).then(a.face.cmp(&b.face)))
}

fn distance_to([a, b, c]: [DVec3; 3], ray: &Ray) -> Option<f64> {
    let (to_b, to_c) = (b - a, c - a);
    let across = ray.direction.cross(to_c);
    let determinant = to_b.dot(across);
    if determinant == 0.0 {
        return None;
    }
    let from_a = ray.origin - a;
    let u = from_a.dot(across) / determinant;
    let q = from_a.cross(to_b);
    let v = ray.direction.dot(q) / determinant;
    let distance = to_c.dot(q) / determinant;
    // What is not a number fails all of these.
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0).then_some(distance)
}

/// The hit in words: face, vertex, position, value.
pub fn describe(mesh: &TriMesh, hit: &Hit, values: Option<&Values>) -> String {
    let Some(corners) = mesh.faces.get(hit.face) else { return String::new() };
    let vertex = corners[hit.corner].idx();
    let [x, y, z] = hit.point.to_array().map(number_text);
    let mut text = format!("face {}, vertex {vertex}\nat {x}, {y}, {z}", hit.face);
    if let Some(values) = values {
        let element = match values.domain {
            Domain::Vertex => vertex,
            Domain::Corner => 3 * hit.face + hit.corner,
            Domain::Face => hit.face,
        };
        if let Some(&value) = values.values.get(element) {
            let value = number_text(values.spacing.back(value));
            text += &format!("\n{} {value} {}", values.name, values.unit);
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use mve_modules::mesh::fixtures::mesh_of;

    use super::*;

    #[test]
    fn the_nearer_of_two_faces_is_hit_at_its_nearest_corner() {
        let points = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
        let shifted = points.map(|[x, y, _]| [x, y, 1.0]);
        let all = [points, shifted].concat();
        let mut mesh = mesh_of(&all, &[[0, 1, 2], [3, 4, 5]]);
        let ray = Ray { origin: DVec3::new(0.5, 2.5, 9.0), direction: DVec3::NEG_Z };
        let hit = pick(&mesh, &ray, None).unwrap();
        assert_eq!((hit.face, hit.corner, hit.distance), (1, 2, 8.0));
        let text = describe(&mesh, &hit, None);
        assert_eq!(text, "face 1, vertex 5\nat 0.5, 2.5, 1");
        let plane = Plane { normal: DVec3::Z, offset: 0.5 };
        assert_eq!(pick(&mesh, &ray, Some(&plane)).unwrap().face, 0, "the nearer is cut away");
        let past = Ray { origin: DVec3::new(3.0, 3.0, 9.0), ..ray };
        assert_eq!(pick(&mesh, &past, None), None);
        mesh.positions[4] = DVec3::NAN;
        assert_eq!(pick(&mesh, &ray, None).unwrap().face, 0);
    }
}
