//! The triangles of the working mesh and how they are linked.
//!
//! Faces are triples of vertices; each vertex has a list of its corners, so that any list of
//! triangles fits, manifold or not. Corner `3 f + k` is corner `k` of face `f`, and also stands
//! for the half-edge from that corner to the next.

use glam::DVec3;
use mve_mesh::adjacency::EdgeId;

use super::order::NONE;

/// Facts about a vertex that hold for the whole run, because collapses keep the topology.
pub(super) mod flag {
    /// Its link is not one closed cycle: on a border, a non-manifold edge or a bow tie.
    pub const IRREGULAR: u8 = 1;
    /// Where such places meet: its neighborhood is not that of a point within one line of them.
    pub const SINGULAR: u8 = 2;
    /// It must not move.
    pub const LOCKED: u8 = 4;
    /// An edge at it was put off and waits for the neighborhood to change.
    pub const PARKED: u8 = 8;
    /// A coordinate of it is not finite.
    pub const NOWHERE: u8 = 16;
}

/// Vertices, edges and faces; collapses change them in place, and ids stay the same throughout.
#[derive(Debug)]
pub(super) struct Complex {
    pub vertices: Vec<Vertex>,
    /// Bits of [`flag`] of each vertex.
    pub flags: Vec<u8>,
    /// The lists of the corners of all vertices, and what merges have left behind.
    pub corners: Vec<u32>,
    pub faces: Vec<Face>,
    /// The two ends of each edge: `kept` and `gone` of its collapse.
    pub edges: Vec<[u32; 2]>,
    /// Whether each edge has other than two different opposite vertices.
    pub irregular: Vec<bool>,
    /// Faces that are left.
    pub n_faces: usize,
}

/// A vertex; what most steps read of it lies in one place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex {
    pub position: DVec3,
    /// Where its corners start in [`Complex::corners`]. Corners of dead faces may stay among
    /// those of a vertex that was opposite to a collapsed edge; walks pass over them.
    pub start: u32,
    /// How many corners there are, with those of dead faces.
    pub n_corners: u32,
}

impl Vertex {
    /// Where its corners lie in [`Complex::corners`].
    #[inline]
    pub fn corners(&self) -> std::ops::Range<usize> {
        self.start as usize..self.start as usize + self.n_corners as usize
    }
}

/// A face and its links.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    /// The vertices; the first is [`NONE`] once the face is gone.
    pub vertices: [u32; 3],
    /// The edge of each half-edge.
    pub edges: [EdgeId; 3],
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

impl Complex {
    /// The two ends of an edge: the one that stays when it collapses, and the one that goes.
    #[inline]
    pub fn ends(&self, edge: EdgeId) -> [u32; 2] {
        self.edges[edge.idx()]
    }

    /// Where a vertex is now.
    #[inline]
    pub fn position(&self, vertex: u32) -> DVec3 {
        self.vertices[vertex as usize].position
    }

    /// The corners at a vertex whose face is left.
    pub fn corners_around(&self, vertex: u32) -> impl Iterator<Item = u32> + '_ {
        let corners = &self.corners[self.vertices[vertex as usize].corners()];
        corners.iter().copied().filter(|&corner| !self.face_at(corner).is_dead())
    }

    /// The vertex at a corner.
    #[inline]
    pub fn vertex_at(&self, corner: u32) -> u32 {
        self.faces[corner as usize / 3].vertices[corner as usize % 3]
    }

    /// The edge of the half-edge from a corner.
    #[inline]
    pub fn edge_at(&self, corner: u32) -> EdgeId {
        self.faces[corner as usize / 3].edges[corner as usize % 3]
    }

    /// The face of a corner.
    #[inline]
    pub fn face_at(&self, corner: u32) -> &Face {
        &self.faces[corner as usize / 3]
    }

    /// Squared length of an edge; 0 where that is not a number.
    pub fn length_squared(&self, edge: EdgeId) -> f32 {
        let [from, to] = self.ends(edge).map(|v| self.position(v));
        (from.distance_squared(to) as f32).max(0.0)
    }
}
