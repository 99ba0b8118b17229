//! What the faces around each vertex say as they are, kept up to date from collapse to collapse.
//!
//! All planes of the faces at a vertex go through it, so their quadric about it has neither a
//! linear nor a constant part: six numbers. What the faces around an edge say is the sum of the
//! fans of its ends, less what the faces at both gave twice; so it costs no more than those to ask.

use glam::DVec3;
use mve_core::Cancelled;
use mve_mesh::quadric::Quadric;

use super::complex::{Complex, Face, flag};
use super::marks::VertexMarks;
use super::merge::Merged;
use super::rings::MAX_VALENCE;
use super::ticker::{CHUNK, Ticker};

/// The faces around one vertex.
#[derive(Clone, Copy, Debug, Default)]
struct Fan {
    /// `Σ w n nᵀ`, the upper triangle, over the planes of the faces and of the border edges.
    planes: [f64; 6],
    /// The sum of the doubled area vectors.
    normal: DVec3,
    /// The sum of the doubled areas.
    area: f64,
}

impl Fan {
    /// Adds a plane through the vertex.
    #[inline]
    fn add_plane(&mut self, normal: DVec3, weight: f64) {
        let DVec3 { x, y, z } = normal;
        let w = normal * weight;
        let plane = [w.x * x, w.x * y, w.x * z, w.y * y, w.y * z, w.z * z];
        self.planes.iter_mut().zip(plane).for_each(|(sum, entry)| *sum += entry);
    }

    /// Adds `sign` times a face, and the border planes of its edges from the vertex at corner `k`
    /// to those that `counts` names.
    #[inline]
    fn add_face(
        &mut self,
        (complex, border_weight): (&Complex, f64),
        face: &Face,
        k: usize,
        sign: f64,
        counts: impl Fn(u32) -> bool,
    ) {
        let [a, b, c] = face.vertices.map(|v| complex.position(v));
        let twice_area = (b - a).cross(c - a);
        let length = twice_area.length();
        let normal = twice_area / length;
        if !normal.is_finite() {
            return;
        }
        self.add_plane(normal, sign * length / 6.0);
        self.normal += sign * twice_area;
        self.area += sign * length;
        let is_irregular = complex.flags[face.vertices[k] as usize] & flag::IRREGULAR != 0;
        if border_weight == 0.0 || !is_irregular {
            return;
        }
        for (side, other) in [(k, (k + 1) % 3), ((k + 2) % 3, (k + 2) % 3)] {
            let other = face.vertices[other];
            if complex.irregular[face.edges[side].idx()] && counts(other) {
                let [from, to] = [side, (side + 1) % 3].map(|k| complex.position(face.vertices[k]));
                let along = to - from;
                if let Some(across) = along.cross(normal).try_normalize() {
                    self.add_plane(across, sign * border_weight * along.length_squared());
                }
            }
        }
    }
}

/// What the faces around the ends of an edge say, about the position of the first.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Around {
    /// The planes of the faces and of the border edges at the ends.
    pub quadric: Quadric,
    /// The sum of the doubled area vectors, and of six times the volumes towards the origin.
    normal: DVec3,
    volume: f64,
    /// The sum of the doubled areas.
    area: f64,
}

/// The fans of all vertices.
#[derive(Debug, Default)]
pub(super) struct Fans {
    by_vertex: Vec<Fan>,
    border_weight: f64,
}

impl Fans {
    /// Those of the mesh as it is.
    pub fn sum(
        complex: &Complex,
        border_weight: f64,
        ticker: &mut Ticker,
    ) -> Result<Self, Cancelled> {
        let by_vertex = ticker.fill(complex.vertices.len(), Fan::default())?;
        let mut fans = Self { by_vertex, border_weight };
        for (number, face) in complex.faces.iter().enumerate() {
            if number.is_multiple_of(CHUNK) {
                ticker.tick(complex.n_faces)?;
            }
            if !face.is_dead() {
                for (k, &v) in face.vertices.iter().enumerate() {
                    let fan = &mut fans.by_vertex[v as usize];
                    fan.add_face((complex, border_weight), face, k, 1.0, |_| true);
                }
            }
        }
        Ok(fans)
    }

    /// Looks again at the faces around a merged vertex and its neighbors.
    pub fn renew(&mut self, complex: &Complex, merged: &Merged, marks: &mut VertexMarks) {
        if self.by_vertex.is_empty() {
            return;
        }
        marks.clear();
        let neighbors = merged.edges.iter().map(|&(_, other)| other);
        for v in std::iter::once(merged.kept).chain(neighbors) {
            if marks.mark(v) {
                let mut fan = Fan::default();
                // Edges at vertices with more faces do not collapse.
                for corner in complex.corners_around(v).take(MAX_VALENCE) {
                    let (face, k) = (complex.face_at(corner), corner as usize % 3);
                    fan.add_face((complex, self.border_weight), face, k, 1.0, |_| true);
                }
                self.by_vertex[v as usize] = fan;
            }
        }
    }

    /// What the faces around both ends of an edge say, about the position of the first.
    #[inline]
    pub fn around(&self, complex: &Complex, [kept, gone]: [u32; 2]) -> Around {
        let offset = complex.position(gone) - complex.position(kept);
        let mut around = Around::default();
        for (v, at) in [(kept, DVec3::ZERO), (gone, offset)] {
            around.add(&self.by_vertex[v as usize], at);
        }
        // The faces at both ends go through both, so either end finds them.
        let n_corners = |v: u32| complex.vertices[v as usize].n_corners;
        let is_kept = n_corners(kept) < n_corners(gone);
        let (v, other, at) = if is_kept { (kept, gone, DVec3::ZERO) } else { (gone, kept, offset) };
        let mut twice = Fan::default();
        for corner in complex.corners_around(v).take(MAX_VALENCE) {
            let (face, k) = (complex.face_at(corner), corner as usize % 3);
            if face.vertices.contains(&other) {
                twice.add_face((complex, self.border_weight), face, k, -1.0, |v| v == other);
            }
        }
        around.add(&twice, at);
        around
    }
}

impl Around {
    /// Adds the fan of a vertex so far from the origin.
    #[inline]
    fn add(&mut self, fan: &Fan, offset: DVec3) {
        let planes = Quadric { a: fan.planes, b: DVec3::ZERO, c: 0.0 };
        self.quadric.add(&planes.shifted(-offset));
        self.normal += fan.normal;
        self.volume += fan.normal.dot(offset);
        self.area += fan.area;
    }

    /// The plane of the places that keep the volume: its unit normal, and how far along it from the
    /// origin. `None` where there is no such plane.
    #[inline]
    pub fn volume_plane(&self) -> Option<(DVec3, f64)> {
        /// Of area vectors that cancel each other but for less than this, what is left is rounding.
        const LEAST: f64 = 1e-9;
        let length = self.normal.length();
        let (normal, offset) = (self.normal / length, self.volume / length);
        let is_plane = length > LEAST * self.area && normal.is_finite() && offset.is_finite();
        is_plane.then_some((normal, offset))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cost::Quadric as Cost;
    use crate::geometry::simplify::collapse::observer::{Collapse, Observer};
    use crate::geometry::simplify::collapse::tests::{grid, to_faces};
    use crate::geometry::simplify::collapse::{QuadricOptions, WorkingMesh, simplify_observed};
    use crate::placement::Optimal;
    use mve_core::Control;

    const BORDER_WEIGHT: f64 = 10.0;

    /// What [`Fans::around`] should say: a look at each face at one of the ends, and at each of its
    /// border edges there.
    fn looked_up(complex: &Complex, ends: [u32; 2]) -> Around {
        let origin = complex.position(ends[0]);
        let mut around = Around::default();
        for face in complex.faces.iter().filter(|face| !face.is_dead()) {
            if !ends.iter().any(|end| face.vertices.contains(end)) {
                continue;
            }
            let corners = face.vertices.map(|v| complex.position(v) - origin);
            let twice_area = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            let (length, normal) = (twice_area.length(), twice_area.normalize());
            around.quadric.add(&Quadric::from_plane(normal, normal.dot(corners[0]), length / 6.0));
            around.normal += twice_area;
            around.volume += twice_area.dot(corners[0]);
            around.area += length;
            for k in 0..3 {
                let side = [face.vertices[k], face.vertices[(k + 1) % 3]];
                let is_at_end = side.iter().any(|v| ends.contains(v));
                if is_at_end && complex.irregular[face.edges[k].idx()] {
                    let along = corners[(k + 1) % 3] - corners[k];
                    let across = along.cross(normal).normalize();
                    let weight = BORDER_WEIGHT * along.length_squared();
                    around.quadric.add(&Quadric::from_plane(
                        across,
                        across.dot(corners[k]),
                        weight,
                    ));
                }
            }
        }
        around
    }

    /// Compares all edges that are left after each collapse.
    #[derive(Default)]
    struct Watch {
        n_edges: usize,
        n_at_border: usize,
    }

    impl Observer for Watch {
        fn collapsed(&mut self, mesh: &WorkingMesh, _collapse: &Collapse) {
            for edge in mesh.edges() {
                let ends = mesh.complex.ends(edge);
                let found = mesh.quadrics.fans.around(&mesh.complex, ends);
                let expected = looked_up(&mesh.complex, ends);
                let numbers = |around: &Around| {
                    let Around { quadric, normal, volume, area } = around;
                    let mut numbers = quadric.a.to_vec();
                    numbers.extend(quadric.b.to_array());
                    numbers.extend(normal.to_array());
                    numbers.extend([quadric.c, *volume, *area]);
                    numbers
                };
                for (found, expected) in numbers(&found).into_iter().zip(numbers(&expected)) {
                    assert!((found - expected).abs() < 1e-11, "{ends:?}: {found}, not {expected}");
                }
                self.n_edges += 1;
                self.n_at_border += usize::from(mesh.complex.irregular[edge.idx()]);
            }
        }
    }

    #[test]
    fn fans_say_what_the_faces_around_an_edge_do() {
        let mesh = grid(9, |x, y| 0.3 * (1.7 * (x + 10.0 * y)).sin());
        let options = QuadricOptions { memory: 0.5, boundary_weight: BORDER_WEIGHT };
        let mut watch = Watch::default();
        let mut cost = Cost { options };
        let (mut place, to) = (Optimal::default(), to_faces(mesh.faces.len() / 3));
        let observers: &mut [&mut dyn Observer] = &mut [&mut watch];
        let run = simplify_observed(&mesh, &mut cost, &mut place, observers, to, Control::none());
        assert!(run.unwrap().statistics.n_collapses > 20);
        assert!(watch.n_edges > 1000 && watch.n_at_border > 100);
    }
}
