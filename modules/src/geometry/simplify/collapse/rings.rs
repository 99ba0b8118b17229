//! The faces around the two ends of an edge: what a collapse checks, and what it changes.

use mve_mesh::adjacency::EdgeId;

use super::complex::{Complex, Face};

/// The most faces that a vertex may have to take part in a collapse. It bounds the time of one
/// collapse, so that a fan of a million faces around one vertex takes no quadratic time; the
/// fan shrinks from its rim until its center is within the bound.
pub const MAX_VALENCE: usize = 1024;

/// A face at a vertex: its corner there, and its other two vertices in the order of the face.
#[derive(Clone, Copy, Debug)]
pub(super) struct RingFace {
    pub corner: u32,
    pub after: u32,
    pub before: u32,
}

impl RingFace {
    #[inline]
    pub fn has(&self, vertex: u32) -> bool {
        self.after == vertex || self.before == vertex
    }

    /// The edges from the vertex to `after` and to `before`, and the one between those.
    #[inline]
    pub fn edges(&self, faces: &[Face]) -> [EdgeId; 3] {
        let [x, y, z] = faces[self.corner as usize / 3].edges;
        match self.corner % 3 {
            0 => [x, z, y],
            1 => [y, x, z],
            _ => [z, y, x],
        }
    }
}

/// The faces around both ends of an edge, for as long as the mesh does not change.
#[derive(Debug)]
pub(super) struct Rings {
    pub edge: EdgeId,
    /// The end that stays, and the end that goes.
    pub kept: u32,
    pub gone: u32,
    pub around_kept: Vec<RingFace>,
    pub around_gone: Vec<RingFace>,
}

impl Default for Rings {
    fn default() -> Self {
        let (around_kept, around_gone) = (Vec::new(), Vec::new());
        Self { edge: EdgeId::NONE, kept: 0, gone: 0, around_kept, around_gone }
    }
}

impl Rings {
    /// The faces that have both ends, and die: each by its corner at `kept`.
    pub fn dying(&self) -> impl Iterator<Item = &RingFace> {
        self.around_kept.iter().filter(|face| face.has(self.gone))
    }

    /// The faces that only `kept` has.
    pub fn staying_at_kept(&self) -> impl Iterator<Item = &RingFace> + Clone {
        self.around_kept.iter().filter(|face| !face.has(self.gone))
    }

    /// The faces that only `gone` has, which `kept` will have.
    pub fn staying_at_gone(&self) -> impl Iterator<Item = &RingFace> + Clone {
        self.around_gone.iter().filter(|face| !face.has(self.kept))
    }
}

impl Complex {
    /// Lists the faces around both ends of an edge, in memory that is given; `None` when one end
    /// has too many.
    pub fn neighborhood<'a>(&mut self, edge: EdgeId, memory: &'a mut Rings) -> Option<&'a Rings> {
        let [kept, gone] = self.ends(edge);
        (memory.edge, memory.kept, memory.gone) = (edge, kept, gone);
        let is_all = self.ring_faces(kept, MAX_VALENCE, &mut memory.around_kept)
            && self.ring_faces(gone, MAX_VALENCE, &mut memory.around_gone);
        is_all.then_some(memory)
    }

    /// Lists the faces around a vertex, up to `limit`; `false` when there are more. Corners of dead
    /// faces that it meets leave the vertex's list, which no walk can tell.
    pub fn ring_faces(&mut self, vertex: u32, limit: usize, list: &mut Vec<RingFace>) -> bool {
        list.clear();
        let Some(vertex) = self.vertices.get_mut(vertex as usize) else { return true };
        let corners = &mut self.corners[vertex.corners()];
        let mut n_read = 0;
        for &corner in corners.iter() {
            let face = &self.faces[corner as usize / 3];
            let [a, b, c] = face.vertices;
            if !face.is_dead() {
                if list.len() == limit {
                    break;
                }
                let (after, before) = match corner % 3 {
                    0 => (b, c),
                    1 => (c, a),
                    _ => (a, b),
                };
                list.push(RingFace { corner, after, before });
            }
            n_read += 1;
        }
        // What is left of those that were read moves up to the rest.
        let n_dead = n_read - list.len();
        let is_all = n_read == corners.len();
        if n_dead > 0 {
            for (corner, face) in corners[n_dead..n_read].iter_mut().zip(list.iter()) {
                *corner = face.corner;
            }
            vertex.start += n_dead as u32;
            vertex.n_corners -= n_dead as u32;
        }
        is_all
    }
}
