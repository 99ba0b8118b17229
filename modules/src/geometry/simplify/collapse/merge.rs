//! Merges the two ends of an edge of the complex.
//!
//! ```text
//!            vl                                  vl
//!           /  \                                 ||
//!     a    / L  \    d                     a     ||     d
//!       \ /      \ /                         \   ||   /
//!      kept =edge= gone        --->            kept
//!       / \      / \                         /   ||   \
//!     b    \ R  /    c                     b     ||     c
//!           \  /                                 ||
//!            vr                                  vr
//! ```
//!
//! `kept` and `gone` are the ends of `edge`; `kept` moves to the new position. The faces `L` and
//! `R` have both ends and die; their third vertices are `vl` and `vr`. (A border has one of them,
//! a non-manifold edge more than two.) The edge from `gone` to `vl` dies, and the one from `kept`
//! stands for both (`||`), and so at `vr`. The other faces around the two are the *ring*: those at
//! `kept` keep their links, those at `gone` become faces of `kept`.

use glam::DVec3;
use mve_mesh::adjacency::EdgeId;
use mve_mesh::data::{FaceId, VertexId};

use super::complex::Complex;
use super::marks::VertexMarks;
use super::order::NONE;
use super::rings::{RingFace, Rings};

/// A face that has died.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DyingFace {
    /// Its id.
    pub face: FaceId,
    /// Its vertices before, in its order.
    pub vertices: [VertexId; 3],
}

/// What merging two vertices did.
#[derive(Debug, Default)]
pub(super) struct Merged {
    /// The vertex that stayed.
    pub kept: u32,
    pub dying_faces: Vec<DyingFace>,
    /// The merged edge, and each edge that another one stands for now.
    pub dead_edges: Vec<EdgeId>,
    /// Each edge at the merged vertex and its other end, once for each of its faces.
    pub edges: Vec<(EdgeId, u32)>,
}

impl Complex {
    /// Merges `gone` into `kept` at `position`. The rings must be those of the mesh as it is, and
    /// keep the topology.
    pub fn merge(
        &mut self,
        rings: &Rings,
        position: DVec3,
        marks: &mut VertexMarks,
        merged: &mut Merged,
    ) {
        merged.kept = rings.kept;
        let (kept, gone) = (rings.kept as usize, rings.gone as usize);
        self.flags[kept] |= self.flags[gone];
        self.vertices[kept].position = position;
        self.kill_faces(rings, marks, merged);
        self.relink(rings, marks, merged);
        self.join_corners(rings);
    }

    /// Lists and kills the faces at the edge. The third vertex of each is marked with its edge to
    /// `kept`, which stands for the edge to `gone` too from now on.
    fn kill_faces(&mut self, rings: &Rings, marks: &mut VertexMarks, merged: &mut Merged) {
        merged.dying_faces.clear();
        merged.dead_edges.clear();
        merged.dead_edges.push(rings.edge);
        marks.clear();
        for face in rings.dying() {
            let [to_after, to_before, to_gone] = face.edges(&self.faces);
            let (third, to_kept) = if face.after == rings.gone {
                (face.before, to_before)
            } else {
                (face.after, to_after)
            };
            if marks.get(third).is_none() {
                marks.set(third, to_kept.0);
                merged.dead_edges.push(to_gone);
                self.irregular[to_kept.idx()] |= self.irregular[to_gone.idx()];
            }
            let dead = &mut self.faces[face.corner as usize / 3].vertices;
            let vertices = std::mem::replace(dead, [NONE; 3]).map(VertexId);
            merged.dying_faces.push(DyingFace { face: FaceId(face.corner / 3), vertices });
        }
        self.n_faces -= merged.dying_faces.len();
    }

    /// Gives the faces around `gone` to `kept`, as marked by [`Self::kill_faces`], and lists the
    /// edges of the merged vertex.
    fn relink(&mut self, rings: &Rings, marks: &VertexMarks, merged: &mut Merged) {
        merged.edges.clear();
        for face in rings.staying_at_kept() {
            let [to_after, to_before, _] = face.edges(&self.faces);
            merged.edges.extend([(to_after, face.after), (to_before, face.before)]);
        }
        for ring_face in rings.staying_at_gone() {
            let corner = ring_face.corner as usize;
            let [to_after, to_before, _] = ring_face.edges(&self.faces);
            let RingFace { after, before, .. } = *ring_face;
            let face = &mut self.faces[corner / 3];
            face.vertices[corner % 3] = rings.kept;
            for (side, edge, other) in
                [(corner % 3, to_after, after), ((corner + 2) % 3, to_before, before)]
            {
                let edge = match marks.get(other) {
                    Some(edge) => EdgeId(edge),
                    None => {
                        self.edges[edge.idx()] = [rings.kept, other];
                        edge
                    }
                };
                face.edges[side] = edge;
                merged.edges.push((edge, other));
            }
        }
    }

    /// Makes the list of the corners of the merged vertex.
    fn join_corners(&mut self, rings: &Rings) {
        let joined = rings.staying_at_kept().chain(rings.staying_at_gone());
        let n = joined.clone().count();
        let free = [rings.kept, rings.gone].map(|v| self.vertices[v as usize].corners());
        self.vertices[rings.gone as usize].n_corners = 0;
        let start = match free.into_iter().find(|free| free.len() >= n) {
            Some(free) => {
                for (place, face) in self.corners[free.clone()].iter_mut().zip(joined) {
                    *place = face.corner;
                }
                free.start
            }
            None => {
                self.vertices[rings.kept as usize].n_corners = 0;
                self.make_room(n);
                let start = self.corners.len();
                self.corners.extend(joined.map(|face| face.corner));
                start
            }
        };
        let kept = &mut self.vertices[rings.kept as usize];
        (kept.start, kept.n_corners) = (start as u32, n as u32);
    }

    /// Makes room for so many corners: drops what merges have left behind among the lists where
    /// that is a third of them, or takes a quarter more.
    fn make_room(&mut self, n: usize) {
        if self.corners.len() + n <= self.corners.capacity() {
            return;
        }
        let n_left: usize = self.vertices.iter().map(|vertex| vertex.n_corners as usize).sum();
        if 3 * (n_left + n) > 2 * self.corners.capacity() {
            self.corners.reserve_exact((self.corners.capacity() / 4).max(n));
            return;
        }
        let mut corners = Vec::with_capacity(n_left + n_left / 2 + n);
        for vertex in &mut self.vertices {
            let start = corners.len() as u32;
            corners.extend_from_slice(&self.corners[vertex.corners()]);
            vertex.start = start;
        }
        self.corners = corners;
    }
}
