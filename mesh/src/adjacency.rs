//! Which faces meet at a vertex and at an edge, for any list of triangles.
//!
//! Edges may have any number of faces, faces may be doubled or name a vertex twice, vertices may
//! have no face. All lists are compact arrays in an order that depends on the mesh alone: corners
//! ascending, edges by their lower and then their higher vertex.

use mve_core::{Cancelled, Control};

use super::union_find::UnionFind;
use crate::data::{FaceId, TriMesh, VertexId};

/// Index of an edge of a mesh: in [`Adjacency::edges`], or in a working mesh of a simplification.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct EdgeId(pub u32);

impl EdgeId {
    /// The side of a face between a vertex and itself is no edge.
    pub const NONE: Self = Self(u32::MAX);

    /// The position of the edge in an array over edges.
    #[inline]
    pub fn idx(self) -> usize {
        self.0 as usize
    }
}

/// One side of one face: from a corner to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HalfEdge(u32);

impl HalfEdge {
    /// The face.
    #[inline]
    pub fn face(self) -> FaceId {
        FaceId(self.0 / 3)
    }

    /// Which side of the face, 0 to 2: it runs from that corner to the next.
    #[inline]
    pub fn corner(self) -> usize {
        self.0 as usize % 3
    }
}

/// The neighborhood lists of one mesh.
#[derive(Clone, Debug)]
pub struct Adjacency {
    /// Corners `3 f + k` of each vertex, from `corner_starts[v]` to `corner_starts[v + 1]`.
    corner_starts: Vec<u32>,
    corners: Vec<u32>,
    edges: Vec<[VertexId; 2]>,
    /// Sides of each edge, from `side_starts[e]` to `side_starts[e + 1]`.
    side_starts: Vec<u32>,
    sides: Vec<HalfEdge>,
    face_edges: Vec<[EdgeId; 3]>,
}

impl Adjacency {
    /// Builds the lists, O(n) but for sorting around each vertex.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    ///
    /// # Panics
    /// When a face names a vertex that is not there; see [`TriMesh::check`].
    pub fn new(mesh: &TriMesh, control: Control) -> Result<Self, Cancelled> {
        let n_vertices = mesh.positions.len();
        let all_corners = mesh.faces.iter().flatten().enumerate();
        let keyed = all_corners.clone().map(|(corner, v)| (v.idx(), corner as u32));
        let (corner_starts, corners) = bucket(n_vertices, keyed, control.part(0.0, 0.25))?;
        let sides = all_corners.filter_map(|(corner, &from)| {
            let to = mesh.faces[corner / 3][(corner + 1) % 3];
            (from != to).then_some((from.min(to).idx(), (from.max(to), corner as u32)))
        });
        let (starts, mut by_low) = bucket(n_vertices, sides, control.part(0.25, 0.5))?;
        let mut adjacency = Self {
            corner_starts,
            corners,
            edges: Vec::with_capacity(by_low.len() / 2),
            side_starts: Vec::with_capacity(by_low.len() / 2 + 1),
            sides: Vec::with_capacity(by_low.len()),
            face_edges: vec![[EdgeId::NONE; 3]; mesh.faces.len()],
        };
        let control = control.part(0.5, 1.0);
        for low in 0..n_vertices {
            control.item(low, n_vertices)?;
            let around = &mut by_low[starts[low] as usize..starts[low + 1] as usize];
            around.sort_unstable();
            let mut last = None;
            for &(high, corner) in around.iter() {
                if last != Some(high) {
                    adjacency.side_starts.push(adjacency.sides.len() as u32);
                    adjacency.edges.push([VertexId(low as u32), high]);
                    last = Some(high);
                }
                adjacency.sides.push(HalfEdge(corner));
                let edge = EdgeId(adjacency.edges.len() as u32 - 1);
                adjacency.face_edges[corner as usize / 3][corner as usize % 3] = edge;
            }
        }
        adjacency.side_starts.push(adjacency.sides.len() as u32);
        Ok(adjacency)
    }

    /// The ends of each edge, the lower first.
    #[inline]
    pub fn edges(&self) -> &[[VertexId; 2]] {
        &self.edges
    }

    /// The sides of faces that lie on an edge, by face: one at a border, two where the mesh is
    /// manifold, more elsewhere. A face that names three vertices has each edge once.
    #[inline]
    pub fn sides_of(&self, edge: EdgeId) -> &[HalfEdge] {
        &self.sides
            [self.side_starts[edge.idx()] as usize..self.side_starts[edge.idx() + 1] as usize]
    }

    /// Whether an edge is none within a surface: all but those of two different faces.
    #[inline]
    pub fn is_crease(&self, edge: EdgeId) -> bool {
        match self.sides_of(edge) {
            [one, two] => one.face() == two.face(),
            _ => true,
        }
    }

    /// The edges of a face: entry `k` from corner `k` to the next, [`EdgeId::NONE`] where both are
    /// the same vertex.
    #[inline]
    pub fn edges_of(&self, face: FaceId) -> [EdgeId; 3] {
        self.face_edges[face.idx()]
    }

    /// The corners `3 f + k` at a vertex, ascending.
    #[inline]
    pub fn corners_of(&self, vertex: VertexId) -> &[u32] {
        let starts = &self.corner_starts;
        &self.corners[starts[vertex.idx()] as usize..starts[vertex.idx() + 1] as usize]
    }

    /// The faces at a vertex, ascending, each once.
    #[inline]
    pub fn faces_of(&self, vertex: VertexId) -> impl Iterator<Item = FaceId> + '_ {
        let corners = self.corners_of(vertex);
        let is_first = |at: &usize| *at == 0 || corners[at - 1] / 3 != corners[*at] / 3;
        (0..corners.len()).filter(is_first).map(|at| FaceId(corners[at] / 3))
    }

    /// Whether the faces of a two-sided edge run along it in opposite directions, as they do on an
    /// oriented surface. `false` for edges with another number of sides.
    #[inline]
    pub fn is_oriented(&self, mesh: &TriMesh, edge: EdgeId) -> bool {
        match self.sides_of(edge) {
            [a, b] => start_of(mesh, *a) != start_of(mesh, *b),
            _ => false,
        }
    }

    /// How many sides run along the edge from its lower end, less those from its higher end.
    #[inline]
    pub fn winding(&self, mesh: &TriMesh, edge: EdgeId) -> i64 {
        let low = self.edges[edge.idx()][0];
        let sign = |side: &HalfEdge| if start_of(mesh, *side) == low { 1 } else { -1 };
        self.sides_of(edge).iter().map(sign).sum()
    }

    /// Groups the corners at a vertex: two are together when their faces share an edge at the
    /// vertex that `is_link` allows, or through others.
    ///
    /// Writes into `fans`, a group for each of [`Adjacency::corners_of`].
    pub fn fans(&self, vertex: VertexId, mut is_link: impl FnMut(EdgeId) -> bool, fans: &mut Fans) {
        let corners = self.corners_of(vertex);
        fans.sets.reset(corners.len());
        fans.spokes.clear();
        for (at, &corner) in corners.iter().enumerate() {
            let edges = self.face_edges[corner as usize / 3];
            let k = corner as usize % 3;
            for edge in [edges[k], edges[(k + 2) % 3]] {
                if edge != EdgeId::NONE {
                    fans.spokes.push((edge, at as u32));
                }
            }
        }
        fans.spokes.sort_unstable();
        for pair in fans.spokes.windows(2) {
            if pair[0].0 == pair[1].0 && is_link(pair[0].0) {
                fans.sets.union(pair[0].1, pair[1].1);
            }
        }
    }
}

/// The groups of the corners at one vertex, and room to work in.
#[derive(Clone, Debug, Default)]
pub struct Fans {
    sets: UnionFind,
    /// Edges at the vertex with the place of a corner that has it, sorted.
    spokes: Vec<(EdgeId, u32)>,
}

impl Fans {
    /// The group of the `at`-th corner: the place of the first corner of the group.
    #[inline]
    pub fn group(&mut self, at: usize) -> usize {
        self.sets.find(at as u32) as usize
    }

    /// The edges at the vertex, sorted, each with the place of a corner whose face has it.
    #[inline]
    pub fn spokes(&self) -> &[(EdgeId, u32)] {
        &self.spokes
    }
}

/// The vertex that a side starts from.
fn start_of(mesh: &TriMesh, side: HalfEdge) -> VertexId {
    mesh.faces[side.face().idx()][side.corner()]
}

/// Sorts items into `n` buckets, keeping their order: starts of the buckets, and the items.
fn bucket<T: Copy + Default>(
    n: usize,
    items: impl Iterator<Item = (usize, T)> + Clone,
    control: Control,
) -> Result<(Vec<u32>, Vec<T>), Cancelled> {
    let mut starts = vec![0u32; n + 1];
    for (place, (key, _)) in items.clone().enumerate() {
        control.item(place, usize::MAX)?;
        starts[key + 1] += 1;
    }
    for key in 0..n {
        starts[key + 1] += starts[key];
    }
    let mut next = starts.clone();
    let mut sorted = vec![T::default(); starts[n] as usize];
    for (place, (key, item)) in items.enumerate() {
        control.item(place, sorted.len())?;
        sorted[next[key] as usize] = item;
        next[key] += 1;
    }
    Ok((starts, sorted))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{mesh_of, tetrahedron};

    #[test]
    fn a_tetrahedron() {
        let mesh = tetrahedron();
        let adjacency = Adjacency::new(&mesh, Control::none()).unwrap();
        let ends: Vec<[u32; 2]> = adjacency.edges().iter().map(|e| e.map(|v| v.0)).collect();
        assert_eq!(ends, [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]);
        for edge in (0..6).map(EdgeId) {
            assert!(adjacency.is_oriented(&mesh, edge));
            assert_eq!(adjacency.winding(&mesh, edge), 0);
        }
        let faces: Vec<u32> = adjacency.faces_of(VertexId(1)).map(|f| f.0).collect();
        assert_eq!(faces, [0, 1, 3]);
        assert_eq!(adjacency.edges_of(FaceId(3)).map(|e| e.0), [3, 5, 4]);
    }

    /// Three faces on the edge 0–1, one of them doubled, a face naming 1 twice, and vertex 5 alone.
    #[test]
    fn what_is_not_manifold_stands() {
        let faces = [[0, 1, 2], [0, 1, 3], [1, 0, 4], [0, 1, 2], [1, 1, 4]];
        let mesh = mesh_of(&[[0.0; 3]; 6], &faces);
        let adjacency = Adjacency::new(&mesh, Control::none()).unwrap();
        let edge = EdgeId(0);
        assert_eq!(adjacency.edges()[edge.idx()], [VertexId(0), VertexId(1)]);
        let faces: Vec<u32> = adjacency.sides_of(edge).iter().map(|s| s.face().0).collect();
        assert_eq!(faces, [0, 1, 2, 3]);
        assert_eq!(adjacency.winding(&mesh, edge), 2);
        assert_eq!(adjacency.edges_of(FaceId(4))[0], EdgeId::NONE);
        assert_eq!(adjacency.faces_of(VertexId(1)).count(), 5);
        assert_eq!(adjacency.faces_of(VertexId(5)).count(), 0);
    }

    #[test]
    fn two_triangles_at_a_point_are_two_fans() {
        let mesh = mesh_of(&[[0.0; 3]; 5], &[[0, 1, 2], [0, 3, 4]]);
        let adjacency = Adjacency::new(&mesh, Control::none()).unwrap();
        let mut fans = Fans::default();
        adjacency.fans(VertexId(0), |_| true, &mut fans);
        assert_eq!((fans.group(0), fans.group(1)), (0, 1));
    }
}
