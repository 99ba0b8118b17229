//! Where a plane meets a mesh: the outline of a section, found and uploaded on threads.

use std::sync::Arc;

use eframe::egui;
use glam::DVec3;
use mve_modules::data::TriMesh;
use rayon::prelude::*;

use super::arrays::Arrays;
use super::gpu::Gpu;
use super::gpu::outline::{Segment, SegmentBuffer};
use super::section::Plane;
use crate::views::memo::{Memo, Same};

/// Where a point lies.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    Before,
    Behind,
    /// It is not finite.
    Nowhere,
}

/// The pieces in which a plane meets the faces of a mesh, O(n); one a face at most, in the order of
/// the faces. Points on the plane count as before it, so that an edge in the plane comes once, from
/// the face behind it, and a closed mesh has closed outlines. Faces with points that are not there
/// or not finite have none.
pub fn outline(mesh: &TriMesh, plane: &Plane) -> Vec<[DVec3; 2]> {
    let side = |point: &DVec3| match plane.height(*point) {
        height if !height.is_finite() => Side::Nowhere,
        height if height >= 0.0 => Side::Before,
        _ => Side::Behind,
    };
    // A byte each: nearly all faces are passed over by these alone.
    let sides: Vec<Side> = mesh.positions.par_iter().map(side).collect();
    let of_face = |face: &[mve_modules::data::VertexId; 3]| {
        let vertices = face.map(|vertex| vertex.idx());
        let [a, b, c] = vertices.map(|at| sides.get(at).copied().unwrap_or(Side::Nowhere));
        if (a == b && b == c) || [a, b, c].contains(&Side::Nowhere) {
            return None;
        }
        // The corner that is alone on its side.
        let alone = if b == c { 0 } else { 1 + usize::from(a == b) };
        let meets = |other: usize| {
            let (a, b) = (vertices[alone], vertices[other % 3]);
            // From the lower vertex, so that the two faces of an edge find the same point.
            let (a, b) = (a.min(b), a.max(b));
            let [of_a, of_b] = [a, b].map(|at| plane.height(mesh.positions[at]));
            let share = of_a / (of_a - of_b);
            mesh.positions[a].lerp(mesh.positions[b], share)
        };
        let ends = [meets(alone + 1), meets(alone + 2)];
        (ends[0] != ends[1] && ends.iter().all(|end| end.is_finite())).then_some(ends)
    };
    mesh.faces.par_iter().with_min_len(1 << 12).filter_map(of_face).collect()
}

/// The color of the outline of a mesh, by its place: apart from those of scales and surfaces.
pub fn outline_color(place: usize) -> [f32; 4] {
    const COLORS: [[f32; 4]; 4] = [
        [1.0, 0.42, 0.05, 1.0],
        [0.05, 0.75, 1.0, 1.0],
        [1.0, 0.25, 0.75, 1.0],
        [0.45, 0.9, 0.2, 1.0],
    ];
    COLORS[place % COLORS.len()]
}

/// The outline of one mesh: looked for and uploaded when a plane is there.
#[derive(Default)]
pub struct MeshOutline {
    segments: Memo<(Same<Arrays>, Plane), Vec<Segment>>,
    /// `None` when it is more than the GPU takes.
    buffer: Memo<Same<Vec<Segment>>, Option<SegmentBuffer>>,
}

impl MeshOutline {
    /// Sees to it that it is found and uploaded.
    pub fn prepare(
        &mut self,
        context: &egui::Context,
        gpu: &Gpu,
        (mesh, arrays): (&Arc<TriMesh>, &Arc<Arrays>),
        plane: &Plane,
    ) {
        let (job, plane) = ((Arc::clone(mesh), Arc::clone(arrays)), *plane);
        self.segments.want(context, (Same(Arc::clone(arrays)), plane), move || {
            let (mesh, arrays) = job;
            let local = |p: DVec3| ((p - arrays.center) / arrays.scale).as_vec3().to_array();
            let found = outline(&mesh, &plane).into_iter();
            found.map(|ends| Segment { ends: ends.map(local) }).collect()
        });
        if let Some(segments) = self.segments.latest() {
            let (device, job) = (gpu.device().clone(), Arc::clone(&segments));
            let upload = move || SegmentBuffer::new(&device, &job).ok();
            gpu.upload(&mut self.buffer, context, Same(segments), upload);
        }
    }

    /// The latest that is on the GPU; while the plane moves, that of a moment ago.
    pub fn latest(&self) -> Option<Arc<Option<SegmentBuffer>>> {
        self.buffer.latest()
    }

    /// Whether something is in the making.
    pub fn is_busy(&self) -> bool {
        self.segments.is_busy() || self.buffer.is_busy()
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use mve_modules::data::VertexId;
    use mve_modules::mesh::fixtures::{cube, mesh_of, torus};

    use super::*;

    fn length(outline: &[[DVec3; 2]]) -> f64 {
        outline.iter().map(|[a, b]| a.distance(*b)).sum()
    }

    /// Each point is an end of exactly two pieces.
    fn is_closed(outline: &[[DVec3; 2]]) -> bool {
        let mut ends: Vec<_> =
            outline.iter().flatten().map(|p| p.to_array().map(f64::to_bits)).collect();
        ends.sort_unstable();
        ends.chunk_by(|a, b| a == b).all(|same| same.len() == 2)
    }

    #[test]
    fn a_cube_through_its_middle_has_a_square() {
        let cube = cube(DVec3::ONE);
        let (low, high) = cube.bounds().unwrap();
        for axis in 0..3 {
            let normal = DVec3::AXES[axis];
            let plane = Plane { normal, offset: normal.dot(0.5 * (low + high)) };
            let square = outline(&cube, &plane);
            assert!((length(&square) - 4.0 * (high - low)[axis]).abs() < 1e-12);
            assert!(is_closed(&square) && square.len() == 8, "a diagonal in each side");
            for point in square.iter().flatten() {
                assert!(plane.height(*point).abs() < 1e-12);
                let on_side = (0..3).filter(|&k| point[k] == low[k] || point[k] == high[k]);
                assert!(on_side.count() >= 1, "{point}");
            }
        }
        // Through the edges of one side and its opposite: a rectangle of 1 × √2.
        let normal = DVec3::new(1.0, 1.0, 0.0).normalize();
        let plane = Plane { normal, offset: normal.dot(0.5 * (low + high)) };
        let across = outline(&cube, &plane);
        assert!((length(&across) - (2.0 + 2.0 * 2f64.sqrt())).abs() < 1e-12, "{across:?}");
    }

    #[test]
    fn a_side_in_the_plane_is_met_once_along_its_edges() {
        let cube = cube(DVec3::ONE);
        let (low, high) = cube.bounds().unwrap();
        // What is behind is all of the cube; the side counts as before.
        let top = Plane { normal: DVec3::Z, offset: high.z };
        assert_eq!(length(&outline(&cube, &top)), 4.0);
        let bottom = Plane { normal: DVec3::Z, offset: low.z };
        assert_eq!(length(&outline(&cube, &bottom)), 0.0, "nothing is behind it");
    }

    #[test]
    fn a_ball_has_a_circle_and_a_ring_two() {
        let ball = ball(1.5, 200);
        let plane = Plane { normal: DVec3::new(2.0, 1.0, -2.0) / 3.0, offset: 0.9 };
        let circle = outline(&ball, &plane);
        // The circle at height 0.9 of a sphere of radius 1.5.
        let radius = (1.5f64.powi(2) - 0.9f64.powi(2)).sqrt();
        assert!((length(&circle) / (TAU * radius) - 1.0).abs() < 1e-3, "{}", length(&circle));
        let middle = plane.normal * 0.9;
        for point in circle.iter().flatten() {
            assert!((point.distance(middle) / radius - 1.0).abs() < 1e-3);
        }
        let ring = torus(3.0, 1.0, 96);
        let (low, high) = ring.bounds().unwrap();
        let size = high - low;
        let flat = DVec3::AXES[(0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).unwrap()];
        let circles = outline(&ring, &Plane { normal: flat, offset: 0.011 });
        assert!(is_closed(&circles));
        assert!((length(&circles) / (2.0 * TAU) - 1.0).abs() < 2e-3, "{}", length(&circles));
    }

    /// A sphere of so many rings, each of twice as many squares.
    fn ball(radius: f64, n: u32) -> TriMesh {
        let point = |i: u32, j: u32| {
            let (polar, around) =
                (PI * f64::from(i) / f64::from(n), PI * f64::from(j) / f64::from(n));
            let flat = radius * polar.sin();
            [flat * around.cos(), flat * around.sin(), radius * polar.cos()]
        };
        let at = |i: u32, j: u32| i * 2 * n + j % (2 * n);
        let points: Vec<_> = (0..=n).flat_map(|i| (0..2 * n).map(move |j| point(i, j))).collect();
        let squares = (0..n).flat_map(|i| (0..2 * n).map(move |j| (i, j)));
        let faces = squares.flat_map(|(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        });
        mesh_of(&points, &faces.collect::<Vec<_>>())
    }

    #[test]
    fn what_is_not_there_or_not_finite_is_left_out() {
        let mut mesh = cube(DVec3::ONE);
        let plane = Plane { normal: DVec3::Z, offset: mesh.bounds().unwrap().0.z + 0.5 };
        mesh.faces.push([VertexId(0), VertexId(1), VertexId(99)]);
        assert_eq!(outline(&mesh, &plane).len(), 8);
        mesh.positions[0] = DVec3::NAN;
        let left = outline(&mesh, &plane);
        assert!(!left.is_empty() && left.len() < 8);
        assert!(left.iter().flatten().all(|point| point.is_finite()));
        assert_eq!(outline(&TriMesh::default(), &plane), Vec::<[DVec3; 2]>::new());
    }
}
