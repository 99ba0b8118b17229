//! Links the triangles of a mesh: corners of vertices, edges, and what kind each vertex is.
//!
//! Order of a vertex and the conditions on it follow T. K. Dey, H. Edelsbrunner, S. Guha and
//! D. V. Nekhayev, "Topology preserving edge contraction", Publ. Inst. Math. 66, 1999.

use mve_core::Cancelled;
use mve_mesh::adjacency::EdgeId;
use mve_mesh::data::TriMesh;
use mve_mesh::union_find::UnionFind;

use super::complex::{Complex, Face, Vertex, flag, next_in_face, previous_in_face};
use super::marks::VertexMarks;
use super::order::{NONE, Order, inverse};
use super::ticker::{CHUNK, Ticker};

impl Complex {
    /// Links the faces of a mesh. Faces that name a vertex twice or one that is not there are
    /// left out. O(n_faces), except at vertices of very high valence.
    pub fn link(
        mesh: &TriMesh,
        order: &Order,
        marks: &mut VertexMarks,
        ticker: &mut Ticker,
    ) -> Result<Self, Cancelled> {
        let n_vertices = mesh.positions.len();
        let new_ids = inverse(&order.vertices, ticker)?;
        let mut n_faces = 0;
        let link = |&input: &u32| {
            let [a, b, c] =
                mesh.faces[input as usize].map(|v| new_ids.get(v.idx()).copied().unwrap_or(NONE));
            let is_triangle = a != b && b != c && c != a && ![a, b, c].contains(&NONE);
            n_faces += usize::from(is_triangle);
            let vertices = if is_triangle { [a, b, c] } else { [NONE; 3] };
            Face { vertices, edges: [EdgeId::NONE; 3] }
        };
        let faces = ticker.collect(&order.faces, link)?;
        let vertex = |&input: &u32| Vertex {
            position: mesh.positions[input as usize],
            start: 0,
            n_corners: 0,
        };
        let mut vertices = ticker.collect(&order.vertices, vertex)?;
        let corners = list_corners(&mut vertices, &faces, n_faces, ticker)?;
        let mut complex = Self {
            flags: vec![0; n_vertices],
            vertices,
            corners,
            faces,
            // As many as of a closed surface, and some for borders.
            edges: Vec::with_capacity(3 * n_faces / 2 + n_faces / 32 + 3),
            irregular: Vec::new(),
            n_faces,
        };
        ticker.tick(n_faces)?;
        complex.number_edges(marks, ticker)?;
        complex.classify_vertices(marks, ticker)?;
        Ok(complex)
    }

    /// Numbers the edges and finds which have other than two different opposite vertices.
    fn number_edges(
        &mut self,
        marks: &mut VertexMarks,
        ticker: &mut Ticker,
    ) -> Result<(), Cancelled> {
        // The different opposite vertices of each edge: at most two are kept, `MANY` in the first
        // place says that there are more. Copies of a face count once.
        const MANY: u32 = NONE - 1;
        let mut opposite: Vec<[u32; 2]> = Vec::with_capacity(self.edges.capacity());
        for vertex in 0..self.vertices.len() as u32 {
            if (vertex as usize).is_multiple_of(CHUNK) {
                ticker.tick(self.n_faces)?;
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
                    face.edges[half_edge as usize % 3] = EdgeId(edge);
                    let opposite = &mut opposite[edge as usize];
                    if opposite[0] == NONE {
                        opposite[0] = third;
                    } else if opposite[0] != third && opposite[1] == NONE {
                        opposite[1] = third;
                    } else if opposite[0] != third && opposite[1] != third {
                        opposite[0] = MANY;
                    }
                }
            }
        }
        self.irregular = ticker.collect(&opposite, |o| o[1] == NONE || o[0] == MANY)?;
        Ok(())
    }

    /// Finds the order of each vertex from its link, the graph of its neighbors joined by faces.
    fn classify_vertices(
        &mut self,
        marks: &mut VertexMarks,
        ticker: &mut Ticker,
    ) -> Result<(), Cancelled> {
        // The neighbors of a vertex, numbered as they come up: those that faces join are a set.
        let mut joined = UnionFind::default();
        let mut degrees: Vec<u32> = Vec::new();
        for vertex in 0..self.vertices.len() as u32 {
            if (vertex as usize).is_multiple_of(CHUNK) {
                ticker.tick(self.n_faces)?;
            }
            if !self.vertices[vertex as usize].position.is_finite() {
                self.flags[vertex as usize] = flag::NOWHERE;
            }
            if self.is_closed_fan(vertex) {
                continue;
            }
            marks.clear();
            joined.reset(0);
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
                        let new = joined.add();
                        marks.set(other, new);
                        degrees.push(0);
                        if self.irregular[self.edge_at(half_edge).idx()] {
                            ends[n_irregular.min(1)] = new as usize;
                            n_irregular += 1;
                        }
                        new
                    });
                    degrees[*slot as usize] += 1;
                }
                n_joins += usize::from(joined.union(slots[0], slots[1]));
            }
            if degrees.is_empty() {
                continue;
            }
            let is_connected = n_joins + 1 == degrees.len();
            self.flags[vertex as usize] |= match n_irregular {
                0 if is_connected => 0,
                2 if is_connected && degrees[ends[0]] == degrees[ends[1]] => flag::IRREGULAR,
                _ => flag::IRREGULAR | flag::SINGULAR,
            };
        }
        Ok(())
    }

    /// Whether the faces around a vertex are one closed fan, which is what nearly all are. It may
    /// miss some: those of many faces and those that are not oriented alike.
    fn is_closed_fan(&self, vertex: u32) -> bool {
        const MAX: usize = 12;
        let corners = &self.corners[self.vertices[vertex as usize].corners()];
        let mut fan = [(0, 0); MAX];
        let Some(fan) = fan.get_mut(..corners.len()) else { return false };
        for (sides, &corner) in fan.iter_mut().zip(corners) {
            let face = self.face_at(corner);
            let k = corner as usize % 3;
            if self.irregular[face.edges[k].idx()] || self.irregular[face.edges[(k + 2) % 3].idx()]
            {
                return false;
            }
            *sides = (face.vertices[(k + 1) % 3], face.vertices[(k + 2) % 3]);
        }
        let Some(&(start, mut at)) = fan.first() else { return false };
        let mut n = 1;
        while at != start && n < fan.len() {
            let Some(&(_, before)) = fan.iter().find(|sides| sides.0 == at) else {
                return false;
            };
            at = before;
            n += 1;
        }
        at == start && n == fan.len()
    }
}

/// The lists of corners of all vertices, each ascending.
fn list_corners(
    vertices: &mut [Vertex],
    faces: &[Face],
    n_faces: usize,
    ticker: &mut Ticker,
) -> Result<Vec<u32>, Cancelled> {
    let alive = |face: &&Face| !face.is_dead();
    for piece in faces.chunks(CHUNK) {
        ticker.tick(n_faces)?;
        for &v in piece.iter().filter(alive).flat_map(|face| &face.vertices) {
            vertices[v as usize].n_corners += 1;
        }
    }
    let mut n_corners = 0;
    for piece in vertices.chunks_mut(CHUNK) {
        ticker.tick(n_faces)?;
        for vertex in piece {
            vertex.start = n_corners;
            n_corners += std::mem::take(&mut vertex.n_corners);
        }
    }
    let mut corners = vec![0; n_corners as usize];
    for (f, face) in faces.iter().enumerate() {
        if f.is_multiple_of(CHUNK) {
            ticker.tick(n_faces)?;
        }
        for (corner, &v) in (3 * f as u32..).zip(&face.vertices).filter(|_| !face.is_dead()) {
            let vertex = &mut vertices[v as usize];
            corners[vertex.corners().end] = corner;
            vertex.n_corners += 1;
        }
    }
    Ok(corners)
}
