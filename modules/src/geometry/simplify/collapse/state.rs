//! The mesh in the making: what the engine changes and costs and placements read.
//!
//! Faces are triples of vertices; each vertex has a list of its corners, so that any list of
//! triangles fits, manifold or not. Corner `3 f + k` is corner `k` of face `f`, and also stands
//! for the half-edge from that corner to the next. With quadrics and the queue, a run takes 170 to
//! 190 bytes a face of the input at its peak.

use glam::DVec3;

use super::attributes::Attributes;
use super::order::Order;
use super::pulse::Pulse;
use super::{Boundary, Ends, QuadricOptions};
use crate::data::{FaceId, TriMesh, VertexId};
use crate::mesh::quadric::Quadric;
use mve_core::Cancelled;

/// No vertex, and the first vertex of a face that is gone.
pub(super) const NONE: u32 = u32::MAX;

/// Elements between two looks at the clock while the state is built.
pub(super) const BEAT: usize = 1024;

/// Facts about a vertex that hold for the whole run, because collapses keep the topology.
pub(super) mod flag {
    /// Its link is not one closed cycle: on a border, a non-manifold edge or a bow tie.
    pub const IRREGULAR: u8 = 1;
    /// Where such places meet: its neighborhood is not that of a point within one line of them.
    pub const CORNER: u8 = 2;
    /// It must not move.
    pub const LOCKED: u8 = 4;
    /// An edge at it was put off and waits for the neighborhood to change.
    pub const PARKED: u8 = 8;
    /// A coordinate of it is not finite.
    pub const NOWHERE: u8 = 16;
}

/// The mesh in the making.
///
/// A collapse merges the vertex `gone` into `kept`; ids of vertices and faces stay the same
/// throughout. They are the engine's own, in an order that suits memory: ask
/// [`Collapsing::input_vertex`] and [`Collapsing::input_face`] for those of the input.
#[derive(Debug)]
pub struct Collapsing {
    pub(super) vertices: Vec<Vertex>,
    /// Bits of [`flag`] of each vertex.
    pub(super) flags: Vec<u8>,
    /// The lists of the corners of all vertices, and what merges have left behind.
    pub(super) corners: Vec<u32>,
    pub(super) faces: Vec<Face>,
    /// The two ends of each edge.
    pub(super) edges: Vec<[u32; 2]>,
    /// One bit an edge: whether it has other than two different opposite vertices.
    pub(super) irregular: Vec<bool>,
    pub(super) quadrics: Vec<Quadric>,
    pub(super) n_faces: usize,
    pub(super) order: Order,
}

/// A vertex; what most steps read of it lies in one place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex {
    pub position: DVec3,
    /// Where its corners start in [`Collapsing::corners`]. Corners of dead faces may stay among
    /// those of a vertex that was opposite to a collapsed edge; walks pass over them.
    pub start: u32,
    /// How many corners there are, with those of dead faces.
    pub n_corners: u32,
}

impl Vertex {
    /// Where its corners lie in [`Collapsing::corners`].
    #[inline]
    pub fn corners(&self) -> std::ops::Range<usize> {
        self.start as usize..self.start as usize + self.n_corners as usize
    }
}

/// A face at a vertex: its corner there, and its other two vertices in the order of the face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spoke {
    pub corner: u32,
    pub after: u32,
    pub before: u32,
}

impl Spoke {
    #[inline]
    pub fn has(&self, vertex: u32) -> bool {
        self.after == vertex || self.before == vertex
    }

    /// The edges from the vertex to `after` and to `before`, and the one between those.
    #[inline]
    pub fn edges(&self, faces: &[Face]) -> [u32; 3] {
        let [x, y, z] = faces[self.corner as usize / 3].edges;
        match self.corner % 3 {
            0 => [x, z, y],
            1 => [y, x, z],
            _ => [z, y, x],
        }
    }
}

/// A face and its links.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    /// The vertices; the first is [`NONE`] once the face is gone.
    pub vertices: [u32; 3],
    /// The edge of each half-edge.
    pub edges: [u32; 3],
}

impl Face {
    pub fn is_dead(&self) -> bool {
        self.vertices[0] == NONE
    }
}

/// The corner after `corner` in its face.
pub(super) fn next_in_face(corner: u32) -> u32 {
    if corner % 3 == 2 { corner - 2 } else { corner + 1 }
}

/// The corner before `corner` in its face.
pub(super) fn previous_in_face(corner: u32) -> u32 {
    if corner.is_multiple_of(3) { corner + 2 } else { corner - 1 }
}

impl Collapsing {
    /// How many faces are left.
    pub fn n_faces(&self) -> usize {
        self.n_faces
    }

    /// The id that a vertex has in the input.
    pub fn input_vertex(&self, vertex: VertexId) -> VertexId {
        VertexId(self.order.vertices[vertex.idx()])
    }

    /// The id that a face has in the input.
    pub fn input_face(&self, face: FaceId) -> FaceId {
        FaceId(self.order.faces[face.idx()])
    }

    /// How many vertices the input has: one more than the largest id.
    pub fn n_vertices(&self) -> usize {
        self.vertices.len()
    }

    /// Where a vertex is now.
    #[inline]
    pub fn position(&self, vertex: VertexId) -> DVec3 {
        self.vertices[vertex.idx()].position
    }

    /// The corners of a face in its order; `None` once it is gone.
    pub fn face(&self, face: FaceId) -> Option<[VertexId; 3]> {
        let face = &self.faces[face.idx()];
        (!face.is_dead()).then(|| face.vertices.map(VertexId))
    }

    /// The faces that are left, by id.
    pub fn face_ids(&self) -> impl Iterator<Item = FaceId> + '_ {
        let numbered = (0u32..).zip(&self.faces);
        numbered.filter(|(_, face)| !face.is_dead()).map(|(number, _)| FaceId(number))
    }

    /// The faces around a vertex that are left, in an order that depends only on the input.
    pub fn faces_around(&self, vertex: VertexId) -> impl Iterator<Item = FaceId> + '_ {
        self.corners_around(vertex.0).map(|corner| FaceId(corner / 3))
    }

    /// The quadric of a vertex about its position; zero unless a part asked for quadrics.
    #[inline]
    pub fn quadric(&self, vertex: VertexId) -> Quadric {
        self.quadrics.get(vertex.idx()).copied().unwrap_or_default()
    }

    /// The ends of an edge, with the sum of their quadrics.
    #[inline]
    pub(super) fn ends(&self, edge: u32) -> Ends {
        let [kept, gone] = self.edges[edge as usize].map(VertexId);
        let mut quadric = Quadric::default();
        if let Some(other) = self.quadrics.get(gone.idx()) {
            quadric = other.shifted(self.position(kept) - self.position(gone));
            quadric.add(&self.quadrics[kept.idx()]);
        }
        Ends { kept, gone, quadric }
    }

    /// The corners at a vertex whose face is left.
    pub(super) fn corners_around(&self, vertex: u32) -> impl Iterator<Item = u32> + '_ {
        let corners = &self.corners[self.vertices[vertex as usize].corners()];
        corners.iter().copied().filter(|&corner| !self.face_at(corner).is_dead())
    }

    /// The vertex at a corner.
    #[inline]
    pub(super) fn vertex_at(&self, corner: u32) -> u32 {
        self.faces[corner as usize / 3].vertices[corner as usize % 3]
    }

    /// The edge of the half-edge from a corner.
    #[inline]
    pub(super) fn edge_at(&self, corner: u32) -> u32 {
        self.faces[corner as usize / 3].edges[corner as usize % 3]
    }

    /// The face of a corner.
    #[inline]
    pub(super) fn face_at(&self, corner: u32) -> &Face {
        &self.faces[corner as usize / 3]
    }

    /// Squared length of an edge; 0 where that is not a number.
    pub(super) fn length_squared(&self, edge: u32) -> f32 {
        let [from, to] = self.edges[edge as usize].map(|v| self.vertices[v as usize].position);
        (from.distance_squared(to) as f32).max(0.0)
    }

    /// The faces that are left, with the vertices that they use, both in the order of the input.
    pub(super) fn into_mesh(
        self,
        input: &TriMesh,
        attributes: Attributes,
        pulse: &mut Pulse,
    ) -> Result<TriMesh, Cancelled> {
        let Self { vertices, faces, order, corners, n_faces, .. } = self;
        drop(corners);
        // By the input's ids: where each face and each vertex that it uses is now.
        let mut alive = pulse.fill(order.faces.len(), NONE)?;
        let mut here = pulse.fill(vertices.len(), NONE)?;
        let numbered = (0u32..).step_by(BEAT).zip(faces.chunks(BEAT).zip(order.faces.chunks(BEAT)));
        for (first, (faces, inputs)) in numbered {
            pulse.beat(n_faces)?;
            for ((number, face), &input) in (first..).zip(faces).zip(inputs) {
                if !face.is_dead() {
                    alive[input as usize] = number;
                    for &v in &face.vertices {
                        here[order.vertices[v as usize] as usize] = v;
                    }
                }
            }
        }
        here.retain(|&v| v != NONE);
        pulse.beat(n_faces)?;
        alive.retain(|&face| face != NONE);
        let mut new_ids = pulse.fill(vertices.len(), NONE)?;
        let mut n_placed = 0;
        let positions = pulse.collect(&here, |&v| {
            new_ids[v as usize] = n_placed;
            n_placed += 1;
            vertices[v as usize].position
        })?;
        let new_face =
            |&face: &u32| faces[face as usize].vertices.map(|v| VertexId(new_ids[v as usize]));
        let new_faces = pulse.collect(&alive, new_face)?;
        drop(vertices);
        pulse.beat(n_faces)?;
        drop(faces);
        pulse.beat(n_faces)?;
        let layers = attributes.into_layers(input, &here, &alive, pulse)?;
        let materials = input.materials.clone();
        Ok(TriMesh { positions, faces: new_faces, layers, materials })
    }

    /// Lists the faces around a vertex and forgets those that are gone; `false` when there are more
    /// than `limit`.
    pub(super) fn gather(&mut self, vertex: u32, limit: usize, spokes: &mut Vec<Spoke>) -> bool {
        spokes.clear();
        let Some(vertex) = self.vertices.get_mut(vertex as usize) else { return true };
        let corners = &mut self.corners[vertex.corners()];
        let mut n_seen = 0;
        for &corner in corners.iter() {
            let face = &self.faces[corner as usize / 3];
            let [a, b, c] = face.vertices;
            if !face.is_dead() {
                if spokes.len() == limit {
                    break;
                }
                let (after, before) = match corner % 3 {
                    0 => (b, c),
                    1 => (c, a),
                    _ => (a, b),
                };
                spokes.push(Spoke { corner, after, before });
            }
            n_seen += 1;
        }
        // What is left of those that were seen moves up to the rest.
        let n_dead = n_seen - spokes.len();
        let is_all = n_seen == corners.len();
        if n_dead > 0 {
            for (corner, spoke) in corners[n_dead..n_seen].iter_mut().zip(spokes.iter()) {
                *corner = spoke.corner;
            }
            vertex.start += n_dead as u32;
            vertex.n_corners -= n_dead as u32;
        }
        is_all
    }

    /// Sums the quadrics of all vertices, each about its own position.
    ///
    /// A face gives each corner a third of its area (a common factor that changes no order); a
    /// border edge gives both ends the plane through it at a right angle to its face, weighted by
    /// its squared length; so does each face at an edge of which `is_seam` says so (M. Garland and
    /// P. S. Heckbert, "Simplifying surfaces with color and texture using quadric error metrics",
    /// IEEE Visualization 1998, section 5).
    pub(super) fn sum_quadrics(
        &mut self,
        options: QuadricOptions,
        boundary: Boundary,
        is_seam: &[bool],
        pulse: &mut Pulse,
    ) -> Result<(), Cancelled> {
        self.quadrics = pulse.fill(self.vertices.len(), Quadric::default())?;
        for face in 0..self.faces.len() {
            if face.is_multiple_of(BEAT) {
                pulse.beat(self.n_faces)?;
            }
            let corners = self.faces[face].vertices;
            if corners[0] == NONE {
                continue;
            }
            let [a, b, c] = corners.map(|v| self.vertices[v as usize].position);
            let twice_area = (b - a).cross(c - a);
            let length = twice_area.length();
            let normal = twice_area / length;
            if !normal.is_finite() {
                continue;
            }
            // The plane goes through all three corners, so each has it at offset zero.
            let plane = Quadric::from_plane(normal, 0.0, length / 6.0);
            for v in corners {
                self.quadrics[v as usize].add(&plane);
            }
            for k in 0..3 {
                let edge = self.faces[face].edges[k] as usize;
                let is_border = boundary == Boundary::Weighted && self.irregular[edge];
                if is_border || is_seam.get(edge).copied().unwrap_or(false) {
                    self.add_border_plane(face, k, normal, options.boundary_weight);
                }
            }
        }
        Ok(())
    }

    /// Adds the plane through edge `k` of a face at a right angle to it.
    fn add_border_plane(&mut self, face: usize, k: usize, normal: DVec3, weight: f64) {
        let Face { vertices, .. } = self.faces[face];
        let ends = [vertices[k], vertices[(k + 1) % 3]];
        let [from, to] = ends.map(|v| self.vertices[v as usize].position);
        let along = to - from;
        let Some(across) = along.cross(normal).try_normalize() else { return };
        let plane = Quadric::from_plane(across, 0.0, weight * along.length_squared());
        for v in ends {
            self.quadrics[v as usize].add(&plane);
        }
    }
}
