//! Building the connectivity of a triangle list, and merging two vertices in it.
//!
//! Order of a vertex and the conditions on it follow T. K. Dey, H. Edelsbrunner, S. Guha and
//! D. V. Nekhayev, "Topology preserving edge contraction", Publ. Inst. Math. 66, 1999.

use glam::DVec3;

use super::order::Order;
use super::pulse::Pulse;
use super::state::{BEAT, Collapsing, Face, NONE, Vertex, flag, next_in_face, previous_in_face};
use crate::data::TriMesh;
use crate::geometry::control::Cancelled;

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

/// What merging two vertices took away.
#[derive(Debug, Default)]
pub(super) struct Removed {
    pub faces: Vec<u32>,
    pub edges: Vec<u32>,
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
        let mut new_ids = vec![0; n_vertices];
        for (new, &old) in order.vertices.iter().enumerate() {
            new_ids[old as usize] = new as u32;
        }
        let mut n_faces = 0;
        let link = |&input: &u32| {
            let [a, b, c] =
                mesh.faces[input as usize].map(|v| new_ids.get(v.idx()).copied().unwrap_or(NONE));
            let is_triangle = a != b && b != c && c != a && ![a, b, c].contains(&NONE);
            n_faces += usize::from(is_triangle);
            let vertices = if is_triangle { [a, b, c] } else { [NONE; 3] };
            Face { vertices, next: [NONE; 3], edges: [NONE; 3] }
        };
        let mut faces: Vec<Face> = order.faces.iter().map(link).collect();
        pulse.beat(n_faces)?;
        let vertex = |&input: &u32| Vertex {
            position: mesh.positions[input as usize],
            first: NONE,
            flags: 0,
        };
        let mut vertices: Vec<Vertex> = order.vertices.iter().map(vertex).collect();
        // Backwards, so that each list ascends.
        for (f, face) in faces.iter_mut().enumerate().rev().filter(|(_, face)| !face.is_dead()) {
            if f.is_multiple_of(BEAT) {
                pulse.beat(n_faces)?;
            }
            for k in (0..3).rev() {
                let first = &mut vertices[face.vertices[k] as usize].first;
                face.next[k] = std::mem::replace(first, (3 * f + k) as u32);
            }
        }
        let mut state = Self {
            vertices,
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
            let mut corner = self.vertices[vertex as usize].first;
            while corner != NONE {
                let (after, before) = (next_in_face(corner), previous_in_face(corner));
                for (half_edge, other, third) in [(corner, after, before), (before, before, after)]
                {
                    let (other, third) = (self.vertex_at(other), self.vertex_at(third));
                    if other < vertex {
                        continue;
                    }
                    let edge = marks.get(other).unwrap_or_else(|| {
                        marks.set(other, self.edges.len() as u32);
                        self.edges.push([vertex, other]);
                        opposite.push([NONE; 2]);
                        self.edges.len() as u32 - 1
                    });
                    self.set_edge(half_edge, edge);
                    let seen = &mut opposite[edge as usize];
                    if seen[0] == NONE {
                        seen[0] = third;
                    } else if seen[0] != third && seen[1] == NONE {
                        seen[1] = third;
                    } else if seen[0] != third && seen[1] != third {
                        seen[0] = MANY;
                    }
                }
                corner = self.next_at(corner);
            }
        }
        self.irregular = opposite.iter().map(|o| o[1] == NONE || o[0] == MANY).collect();
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
            marks.clear();
            parents.clear();
            degrees.clear();
            let mut n_joins = 0;
            let mut ends = [0; 2];
            let mut n_irregular = 0;
            let mut corner = self.vertices[vertex as usize].first;
            while corner != NONE {
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
                corner = self.next_at(corner);
            }
            if parents.is_empty() {
                continue;
            }
            let is_connected = n_joins + 1 == parents.len();
            self.vertices[vertex as usize].flags = match n_irregular {
                0 if is_connected => 0,
                2 if is_connected && degrees[ends[0]] == degrees[ends[1]] => flag::IRREGULAR,
                _ => flag::IRREGULAR | flag::CORNER,
            };
        }
        Ok(())
    }

    /// Merges `gone` into `kept` along `edge` at `position`. The link condition must hold.
    pub(super) fn merge(
        &mut self,
        edge: u32,
        position: DVec3,
        marks: &mut Marks,
        removed: &mut Removed,
    ) {
        let [kept, gone] = self.edges[edge as usize];
        self.find_dying(edge, marks, removed);
        self.relink(kept, gone, marks);
        self.vertices[kept as usize].flags |= self.vertices[gone as usize].flags;
        if !self.quadrics.is_empty() {
            let to_position = |v: u32| position - self.vertices[v as usize].position;
            let mut sum = self.quadrics[kept as usize].shifted(to_position(kept));
            sum.add(&self.quadrics[gone as usize].shifted(to_position(gone)));
            self.quadrics[kept as usize] = sum;
        }
        self.vertices[kept as usize].position = position;
    }

    /// Lists and kills the faces at an edge. The third vertex of each is marked with its edge to
    /// `kept`, which stands for the edge to `gone` too from now on.
    fn find_dying(&mut self, edge: u32, marks: &mut Marks, removed: &mut Removed) {
        let [kept, gone] = self.edges[edge as usize];
        removed.faces.clear();
        removed.edges.clear();
        removed.edges.push(edge);
        marks.clear();
        let mut corner = self.vertices[kept as usize].first;
        while corner != NONE {
            let face = corner as usize / 3;
            if self.faces[face].vertices.contains(&gone) && !self.faces[face].is_dead() {
                let across = if self.vertex_at(next_in_face(corner)) == gone {
                    previous_in_face(corner)
                } else {
                    next_in_face(corner)
                };
                let third = self.vertex_at(across);
                let (out, into) = (across, previous_in_face(across));
                let (to_kept, to_gone) = if self.vertex_at(next_in_face(across)) == kept {
                    (self.edge_at(out), self.edge_at(into))
                } else {
                    (self.edge_at(into), self.edge_at(out))
                };
                if marks.is_new(third) {
                    marks.set(third, to_kept);
                    removed.edges.push(to_gone);
                    self.irregular[to_kept as usize] |= self.irregular[to_gone as usize];
                }
                removed.faces.push(face as u32);
            }
            corner = self.next_at(corner);
        }
        for &face in &removed.faces {
            self.faces[face as usize].vertices = [NONE; 3];
        }
        self.n_faces -= removed.faces.len();
    }

    /// Gives the faces around `gone` to `kept`, as marked by [`Self::find_dying`].
    fn relink(&mut self, kept: u32, gone: u32, marks: &Marks) {
        let mut corner = self.vertices[gone as usize].first;
        self.vertices[gone as usize].first = NONE;
        while corner != NONE {
            let next = self.next_at(corner);
            if !self.face_at(corner).is_dead() {
                self.faces[corner as usize / 3].vertices[corner as usize % 3] = kept;
                let (after, before) = (next_in_face(corner), previous_in_face(corner));
                for (half_edge, other) in [(corner, after), (before, before)] {
                    let other = self.vertex_at(other);
                    match marks.get(other) {
                        Some(edge) => self.set_edge(half_edge, edge),
                        None => {
                            let edge = self.edge_at(half_edge);
                            self.edges[edge as usize] = [kept, other];
                        }
                    }
                }
                self.set_next(corner, self.vertices[kept as usize].first);
                self.vertices[kept as usize].first = corner;
            }
            corner = next;
        }
    }
}

fn root_of(parents: &mut [u32], mut slot: u32) -> u32 {
    while parents[slot as usize] != slot {
        let up = parents[parents[slot as usize] as usize];
        parents[slot as usize] = up;
        slot = up;
    }
    slot
}
