//! Building the connectivity of a triangle list, and merging two vertices in it.
//!
//! Order of a vertex and the conditions on it follow T. K. Dey, H. Edelsbrunner, S. Guha and
//! D. V. Nekhayev, "Topology preserving edge contraction", Publ. Inst. Math. 66, 1999.

use glam::DVec3;

use super::order::{Order, inverse};
use super::pulse::Pulse;
use super::state::{
    BEAT, Collapsing, Face, NONE, Spoke, Vertex, flag, next_in_face, previous_in_face,
};
use crate::data::{FaceId, TriMesh};
use mve_core::Cancelled;

/// The lists of corners may take up to so many times the room of those of the input.
const WASTE: usize = 8;

/// Marks on vertices that are cleared all at once.
#[derive(Debug)]
pub(super) struct Marks {
    /// When each vertex was marked, and with what.
    marks: Vec<(u32, u32)>,
    now: u32,
}

impl Marks {
    pub fn new(n: usize) -> Self {
        Self { marks: vec![(0, 0); n], now: 0 }
    }

    /// Forgets every mark.
    pub fn clear(&mut self) {
        self.now = self.now.checked_add(1).unwrap_or_else(|| {
            self.marks.fill((0, 0));
            1
        });
    }

    #[inline]
    pub fn set(&mut self, vertex: u32, value: u32) {
        self.marks[vertex as usize] = (self.now, value);
    }

    #[inline]
    pub fn get(&self, vertex: u32) -> Option<u32> {
        let (when, value) = self.marks[vertex as usize];
        (when == self.now).then_some(value)
    }

    /// Marks a vertex; whether it was not marked before.
    #[inline]
    pub fn is_new(&mut self, vertex: u32) -> bool {
        let is_new = self.marks[vertex as usize].0 != self.now;
        self.marks[vertex as usize].0 = self.now;
        is_new
    }
}

/// The faces around both ends of an edge.
#[derive(Debug, Default)]
pub(super) struct Rings {
    pub kept: Vec<Spoke>,
    pub gone: Vec<Spoke>,
}

/// What merging two vertices did.
#[derive(Debug, Default)]
pub(super) struct Merged {
    /// Faces and edges that are gone.
    pub dead_faces: Vec<FaceId>,
    pub dead_edges: Vec<u32>,
    /// Each edge at the merged vertex and its other end, once for each of its faces.
    pub spokes: Vec<(u32, u32)>,
}

impl Collapsing {
    /// Links the faces of a mesh. Faces that name a vertex twice or one that is not there are
    /// left out. O(n_faces), except at vertices of very high valence.
    pub(super) fn link(
        mesh: &TriMesh,
        marks: &mut Marks,
        pulse: &mut Pulse,
    ) -> Result<Self, Cancelled> {
        let order = Order::along_curve(mesh, pulse)?;
        let n_vertices = mesh.positions.len();
        let new_ids = inverse(&order.vertices, pulse)?;
        let mut n_faces = 0;
        let link = |&input: &u32| {
            let [a, b, c] =
                mesh.faces[input as usize].map(|v| new_ids.get(v.idx()).copied().unwrap_or(NONE));
            let is_triangle = a != b && b != c && c != a && ![a, b, c].contains(&NONE);
            n_faces += usize::from(is_triangle);
            let vertices = if is_triangle { [a, b, c] } else { [NONE; 3] };
            Face { vertices, edges: [NONE; 3] }
        };
        let faces = pulse.collect(&order.faces, link)?;
        let vertex = |&input: &u32| Vertex {
            position: mesh.positions[input as usize],
            start: 0,
            n_corners: 0,
        };
        let mut vertices = pulse.collect(&order.vertices, vertex)?;
        let corners = list_corners(&mut vertices, &faces, n_faces, pulse)?;
        let mut state = Self {
            flags: vec![0; n_vertices],
            vertices,
            corners,
            faces,
            edges: Vec::with_capacity(3 * n_faces / 2 + 3),
            irregular: Vec::new(),
            quadrics: Vec::new(),
            n_faces,
            order,
        };
        pulse.beat(n_faces)?;
        state.number_edges(marks, pulse)?;
        state.classify_vertices(marks, pulse)?;
        Ok(state)
    }

    /// Numbers the edges and finds which have other than two different opposite vertices.
    fn number_edges(&mut self, marks: &mut Marks, pulse: &mut Pulse) -> Result<(), Cancelled> {
        // The different opposite vertices of each edge: at most two are kept, `MANY` in the first
        // place says that there are more. Copies of a face count once.
        const MANY: u32 = NONE - 1;
        let mut opposite: Vec<[u32; 2]> = Vec::with_capacity(self.edges.capacity());
        for vertex in 0..self.vertices.len() as u32 {
            if (vertex as usize).is_multiple_of(BEAT) {
                pulse.beat(self.n_faces)?;
            }
            marks.clear();
            for at in self.vertices[vertex as usize].corners() {
                let corner = self.corners[at];
                let (after, before) = (next_in_face(corner), previous_in_face(corner));
                let face = &mut self.faces[corner as usize / 3];
                for (half_edge, other, third) in [(corner, after, before), (before, before, after)]
                {
                    let of = |corner: u32| face.vertices[corner as usize % 3];
                    let (other, third) = (of(other), of(third));
                    if other < vertex {
                        continue;
                    }
                    let edge = marks.get(other).unwrap_or_else(|| {
                        marks.set(other, self.edges.len() as u32);
                        self.edges.push([vertex, other]);
                        opposite.push([NONE; 2]);
                        self.edges.len() as u32 - 1
                    });
                    face.edges[half_edge as usize % 3] = edge;
                    let seen = &mut opposite[edge as usize];
                    if seen[0] == NONE {
                        seen[0] = third;
                    } else if seen[0] != third && seen[1] == NONE {
                        seen[1] = third;
                    } else if seen[0] != third && seen[1] != third {
                        seen[0] = MANY;
                    }
                }
            }
        }
        self.irregular = pulse.collect(&opposite, |o| o[1] == NONE || o[0] == MANY)?;
        Ok(())
    }

    /// Finds the order of each vertex from its link, the graph of its neighbors joined by faces.
    fn classify_vertices(&mut self, marks: &mut Marks, pulse: &mut Pulse) -> Result<(), Cancelled> {
        let mut parents: Vec<u32> = Vec::new();
        let mut degrees: Vec<u32> = Vec::new();
        for vertex in 0..self.vertices.len() as u32 {
            if (vertex as usize).is_multiple_of(BEAT) {
                pulse.beat(self.n_faces)?;
            }
            if !self.vertices[vertex as usize].position.is_finite() {
                self.flags[vertex as usize] = flag::NOWHERE;
            }
            if self.is_closed_fan(vertex) {
                continue;
            }
            marks.clear();
            parents.clear();
            degrees.clear();
            let mut n_joins = 0;
            let mut ends = [0; 2];
            let mut n_irregular = 0;
            for &corner in &self.corners[self.vertices[vertex as usize].corners()] {
                let before = previous_in_face(corner);
                let mut slots = [0; 2];
                for (slot, (other, half_edge)) in
                    slots.iter_mut().zip([(next_in_face(corner), corner), (before, before)])
                {
                    let other = self.vertex_at(other);
                    *slot = marks.get(other).unwrap_or_else(|| {
                        let new = parents.len() as u32;
                        marks.set(other, new);
                        parents.push(new);
                        degrees.push(0);
                        if self.irregular[self.edge_at(half_edge) as usize] {
                            ends[n_irregular.min(1)] = new as usize;
                            n_irregular += 1;
                        }
                        new
                    });
                    degrees[*slot as usize] += 1;
                }
                let roots = slots.map(|slot| root_of(&mut parents, slot));
                if roots[0] != roots[1] {
                    parents[roots[0].max(roots[1]) as usize] = roots[0].min(roots[1]);
                    n_joins += 1;
                }
            }
            if parents.is_empty() {
                continue;
            }
            let is_connected = n_joins + 1 == parents.len();
            self.flags[vertex as usize] |= match n_irregular {
                0 if is_connected => 0,
                2 if is_connected && degrees[ends[0]] == degrees[ends[1]] => flag::IRREGULAR,
                _ => flag::IRREGULAR | flag::CORNER,
            };
        }
        Ok(())
    }

    /// Whether the faces around a vertex are one closed fan, which is what nearly all are. It may
    /// miss some: those of many faces and those that are not oriented alike.
    fn is_closed_fan(&self, vertex: u32) -> bool {
        const MAX: usize = 12;
        let corners = &self.corners[self.vertices[vertex as usize].corners()];
        let mut spokes = [(0, 0); MAX];
        let Some(spokes) = spokes.get_mut(..corners.len()) else { return false };
        for (spoke, &corner) in spokes.iter_mut().zip(corners) {
            let face = self.face_at(corner);
            let k = corner as usize % 3;
            if self.irregular[face.edges[k] as usize]
                || self.irregular[face.edges[(k + 2) % 3] as usize]
            {
                return false;
            }
            *spoke = (face.vertices[(k + 1) % 3], face.vertices[(k + 2) % 3]);
        }
        let Some(&(start, mut at)) = spokes.first() else { return false };
        let mut n = 1;
        while at != start && n < spokes.len() {
            let Some(&(_, before)) = spokes.iter().find(|spoke| spoke.0 == at) else {
                return false;
            };
            at = before;
            n += 1;
        }
        at == start && n == spokes.len()
    }

    /// Merges `gone` into `kept` along `edge` at `position`. The link condition must hold, and
    /// have found the rings.
    pub(super) fn merge(
        &mut self,
        edge: u32,
        position: DVec3,
        rings: &Rings,
        marks: &mut Marks,
        merged: &mut Merged,
    ) {
        let [kept, gone] = self.edges[edge as usize];
        if !self.quadrics.is_empty() {
            let to_position = |v: u32| position - self.vertices[v as usize].position;
            let mut sum = self.quadrics[kept as usize].shifted(to_position(kept));
            sum.add(&self.quadrics[gone as usize].shifted(to_position(gone)));
            self.quadrics[kept as usize] = sum;
        }
        self.flags[kept as usize] |= self.flags[gone as usize];
        self.vertices[kept as usize].position = position;
        self.find_dying(edge, rings, marks, merged);
        self.relink(kept, gone, rings, marks, merged);
        self.join_corners(kept, gone, rings);
    }

    /// Lists and kills the faces at an edge. The third vertex of each is marked with its edge to
    /// `kept`, which stands for the edge to `gone` too from now on.
    fn find_dying(&mut self, edge: u32, rings: &Rings, marks: &mut Marks, merged: &mut Merged) {
        let gone = self.edges[edge as usize][1];
        merged.dead_faces.clear();
        merged.dead_edges.clear();
        merged.dead_edges.push(edge);
        marks.clear();
        for spoke in rings.kept.iter().filter(|spoke| spoke.has(gone)) {
            let [to_after, to_before, to_gone] = spoke.edges(&self.faces);
            let (third, to_kept) = if spoke.after == gone {
                (spoke.before, to_before)
            } else {
                (spoke.after, to_after)
            };
            if marks.is_new(third) {
                marks.set(third, to_kept);
                merged.dead_edges.push(to_gone);
                self.irregular[to_kept as usize] |= self.irregular[to_gone as usize];
            }
            self.faces[spoke.corner as usize / 3].vertices = [NONE; 3];
            merged.dead_faces.push(FaceId(spoke.corner / 3));
        }
        self.n_faces -= merged.dead_faces.len();
    }

    /// Gives the faces around `gone` to `kept`, as marked by [`Self::find_dying`], and lists the
    /// edges of the merged vertex.
    fn relink(&mut self, kept: u32, gone: u32, rings: &Rings, marks: &Marks, merged: &mut Merged) {
        merged.spokes.clear();
        for spoke in rings.kept.iter().filter(|spoke| !spoke.has(gone)) {
            let [to_after, to_before, _] = spoke.edges(&self.faces);
            merged.spokes.extend([(to_after, spoke.after), (to_before, spoke.before)]);
        }
        for spoke in rings.gone.iter().filter(|spoke| !spoke.has(kept)) {
            let corner = spoke.corner as usize;
            let [to_after, to_before, _] = spoke.edges(&self.faces);
            let face = &mut self.faces[corner / 3];
            face.vertices[corner % 3] = kept;
            for (side, edge, other) in
                [(corner % 3, to_after, spoke.after), ((corner + 2) % 3, to_before, spoke.before)]
            {
                let edge = match marks.get(other) {
                    Some(edge) => edge,
                    None => {
                        self.edges[edge as usize] = [kept, other];
                        edge
                    }
                };
                face.edges[side] = edge;
                merged.spokes.push((edge, other));
            }
        }
    }

    /// Makes the list of the corners of a merged vertex.
    fn join_corners(&mut self, kept: u32, gone: u32, rings: &Rings) {
        let mine = rings.kept.iter().filter(|spoke| !spoke.has(gone));
        let joined = mine.chain(rings.gone.iter().filter(|spoke| !spoke.has(kept)));
        let n = joined.clone().count();
        let free = [kept, gone].map(|v| self.vertices[v as usize].corners());
        self.vertices[gone as usize].n_corners = 0;
        let start = match free.into_iter().find(|free| free.len() >= n) {
            Some(free) => {
                for (place, spoke) in self.corners[free.clone()].iter_mut().zip(joined) {
                    *place = spoke.corner;
                }
                free.start
            }
            None => {
                self.vertices[kept as usize].n_corners = 0;
                self.make_room(n);
                let start = self.corners.len();
                self.corners.extend(joined.map(|spoke| spoke.corner));
                start
            }
        };
        let kept = &mut self.vertices[kept as usize];
        (kept.start, kept.n_corners) = (start as u32, n as u32);
    }

    /// Drops what merges have left behind among the lists of corners when it is most of it.
    fn make_room(&mut self, n: usize) {
        let most = (WASTE * 3 * self.faces.len()).min(u32::MAX as usize);
        if self.corners.len() + n <= most {
            return;
        }
        let mut corners = Vec::with_capacity(3 * self.faces.len() + n);
        for vertex in &mut self.vertices {
            let start = corners.len() as u32;
            corners.extend_from_slice(&self.corners[vertex.corners()]);
            vertex.start = start;
        }
        self.corners = corners;
    }
}

/// The lists of corners of all vertices, each ascending.
fn list_corners(
    vertices: &mut [Vertex],
    faces: &[Face],
    n_faces: usize,
    pulse: &mut Pulse,
) -> Result<Vec<u32>, Cancelled> {
    let alive = |face: &&Face| !face.is_dead();
    for piece in faces.chunks(BEAT) {
        pulse.beat(n_faces)?;
        for &v in piece.iter().filter(alive).flat_map(|face| &face.vertices) {
            vertices[v as usize].n_corners += 1;
        }
    }
    let mut n_corners = 0;
    for piece in vertices.chunks_mut(BEAT) {
        pulse.beat(n_faces)?;
        for vertex in piece {
            vertex.start = n_corners;
            n_corners += std::mem::take(&mut vertex.n_corners);
        }
    }
    let mut corners = vec![0; n_corners as usize];
    for (f, face) in faces.iter().enumerate() {
        if f.is_multiple_of(BEAT) {
            pulse.beat(n_faces)?;
        }
        for (corner, &v) in (3 * f as u32..).zip(&face.vertices).filter(|_| !face.is_dead()) {
            let vertex = &mut vertices[v as usize];
            corners[vertex.corners().end] = corner;
            vertex.n_corners += 1;
        }
    }
    Ok(corners)
}

fn root_of(parents: &mut [u32], mut slot: u32) -> u32 {
    while parents[slot as usize] != slot {
        let up = parents[parents[slot as usize] as usize];
        parents[slot as usize] = up;
        slot = up;
    }
    slot
}
