//! The mesh while it is decimated: faces, and the corners at each vertex, for any triangles.
//!
//! Vertices are numbered along a space-filling curve and faces by their vertices, for locality and
//! so that neither the order of the input nor that of its faces decides anything.

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::data::{Domain, Layer, TriMesh, VertexId};
use mve_mesh::morton::{morton_order, sort_by_code};

use super::wedges::WedgeLayer;

/// What is not there.
pub const NONE: u32 = u32::MAX;

/// Vertices, faces and corner layers; ids stay the same throughout.
#[derive(Debug)]
pub struct StarMesh {
    /// Where each vertex is.
    pub positions: Vec<DVec3>,
    /// The vertex of the input that each is, or is a copy of.
    pub vertex_sources: Vec<u32>,
    /// The vertices of each face; the first is [`NONE`] once the face is gone.
    pub faces: Vec<[u32; 3]>,
    /// The face of the input that each has its attributes from.
    pub face_sources: Vec<u32>,
    /// Faces that are left.
    pub n_faces: usize,
    /// What layers over corners have at the corners.
    pub wedges: Vec<WedgeLayer>,
    lists: Vec<List>,
    /// The corners `3 f + k` of all vertices, and what changes have left behind.
    corners: Vec<u32>,
    /// Room to work in.
    moved: Vec<u32>,
}

/// Where the corners of a vertex lie.
#[derive(Clone, Copy, Debug, Default)]
struct List {
    start: u32,
    n: u32,
    room: u32,
}

impl StarMesh {
    /// The faces of a mesh that name three vertices.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn new(mesh: &TriMesh, keeps_seams: bool, control: Control) -> Result<Self, Cancelled> {
        let vertex_sources = morton_order(&mesh.positions, control.part(0.0, 0.3))?;
        let mut numbers = vec![0; vertex_sources.len()];
        vertex_sources
            .iter()
            .zip(0..)
            .for_each(|(&input, number)| numbers[input as usize] = number);
        control.at(0.4)?;
        let positions = vertex_sources.iter().map(|&v| mesh.positions[v as usize]).collect();
        let face_sources = face_order(mesh, &numbers, control.part(0.4, 0.7))?;
        let face = |&face: &u32| mesh.faces[face as usize].map(|v| numbers[v.idx()]);
        let faces: Vec<[u32; 3]> = face_sources.iter().map(face).collect();
        control.at(0.8)?;
        let is_of_corners = |layer: &&Layer| layer.domain == Domain::Corner;
        let wedges = mesh.layers.iter().filter(is_of_corners);
        let wedges = wedges
            .map(|layer| WedgeLayer::new(layer, keeps_seams, &face_sources, control.part(0.8, 0.9)))
            .collect::<Result<_, _>>()?;
        let (n_faces, n_vertices) = (faces.len(), mesh.positions.len());
        let mut new = Self {
            positions,
            vertex_sources,
            faces,
            face_sources,
            n_faces,
            wedges,
            lists: vec![List::default(); n_vertices],
            corners: Vec::new(),
            moved: Vec::new(),
        };
        new.link(control.part(0.9, 1.0))?;
        Ok(new)
    }

    fn link(&mut self, control: Control) -> Result<(), Cancelled> {
        for (face, vertices) in self.faces.iter().enumerate() {
            control.item(face, self.faces.len())?;
            vertices.iter().for_each(|&v| self.lists[v as usize].room += 1);
        }
        let mut start = 0;
        for list in &mut self.lists {
            list.start = start;
            start += list.room;
        }
        // Half of it for lists that have to move.
        self.corners = Vec::with_capacity(start as usize + start as usize / 4);
        self.corners.resize(start as usize, 0);
        for (face, vertices) in self.faces.iter().enumerate() {
            control.item(face, self.faces.len())?;
            for (k, &v) in vertices.iter().enumerate() {
                let list = &mut self.lists[v as usize];
                self.corners[(list.start + list.n) as usize] = (3 * face + k) as u32;
                list.n += 1;
            }
        }
        Ok(())
    }

    /// The corners at a vertex.
    #[inline]
    pub fn corners_of(&self, vertex: u32) -> &[u32] {
        let list = self.lists[vertex as usize];
        &self.corners[list.start as usize..(list.start + list.n) as usize]
    }

    /// The vertices after and before a corner in its face.
    #[inline]
    pub fn beside(&self, corner: u32) -> [u32; 2] {
        let [a, b, c] = self.faces[corner as usize / 3];
        match corner % 3 {
            0 => [b, c],
            1 => [c, a],
            _ => [a, b],
        }
    }

    /// The corner of a face at one of its vertices.
    pub fn corner_of(&self, face: u32, vertex: u32) -> u32 {
        let [a, b, _] = self.faces[face as usize];
        3 * face
            + if vertex == a {
                0
            } else if vertex == b {
                1
            } else {
                2
            }
    }

    /// Whether a face is gone.
    #[inline]
    pub fn is_gone(&self, face: u32) -> bool {
        self.faces[face as usize][0] == NONE
    }

    /// Whether two vertices are ends of an edge.
    pub fn are_neighbors(&self, ends: [u32; 2]) -> bool {
        self.n_faces_at(ends) > 0
    }

    /// Whether an edge has one face.
    pub fn is_border(&self, ends: [u32; 2]) -> bool {
        self.n_faces_at(ends) == 1
    }

    /// How many faces have both of two vertices.
    pub fn n_faces_at(&self, [a, b]: [u32; 2]) -> usize {
        let [one, other] = [a, b].map(|v| self.corners_of(v));
        let (few, end) = if one.len() <= other.len() { (one, b) } else { (other, a) };
        few.iter().filter(|&&corner| self.beside(corner).contains(&end)).count()
    }

    /// Takes a face away.
    pub fn remove_face(&mut self, face: u32) {
        let vertices = self.faces[face as usize];
        for (k, v) in (0..).zip(vertices) {
            self.unlist(v, 3 * face + k);
        }
        self.faces[face as usize] = [NONE; 3];
        self.n_faces -= 1;
    }

    /// Puts vertices into a face that is gone.
    pub fn put_face(&mut self, face: u32, vertices: [u32; 3]) {
        self.faces[face as usize] = vertices;
        self.n_faces += 1;
        for (k, &v) in vertices.iter().enumerate() {
            self.push_corner(v, 3 * face + k as u32);
        }
    }

    /// Makes all corners of one vertex those of another one.
    pub fn merge(&mut self, from: u32, to: u32) {
        let mut moved = std::mem::take(&mut self.moved);
        moved.clear();
        moved.extend_from_slice(self.corners_of(from));
        self.lists[from as usize] = List::default();
        self.make_room(to, moved.len() as u32);
        for &corner in &moved {
            self.faces[corner as usize / 3][corner as usize % 3] = to;
            self.push_corner(to, corner);
        }
        self.moved = moved;
    }

    /// Makes some corners of one vertex those of another one.
    pub fn hand_over(&mut self, corners: &[u32], from: u32, to: u32) {
        for &corner in corners {
            self.unlist(from, corner);
            self.faces[corner as usize / 3][corner as usize % 3] = to;
            self.push_corner(to, corner);
        }
    }

    fn unlist(&mut self, vertex: u32, corner: u32) {
        let list = &mut self.lists[vertex as usize];
        let corners = &mut self.corners[list.start as usize..(list.start + list.n) as usize];
        if let Some(at) = corners.iter().position(|&other| other == corner) {
            // Those behind it keep their order, as does what is computed from them.
            corners.copy_within(at + 1.., at);
            list.n -= 1;
        }
    }

    /// A copy of a vertex, without faces.
    pub fn copy_vertex(&mut self, vertex: u32) -> u32 {
        self.positions.push(self.positions[vertex as usize]);
        self.vertex_sources.push(self.vertex_sources[vertex as usize]);
        self.lists.push(List::default());
        self.lists.len() as u32 - 1
    }

    fn push_corner(&mut self, vertex: u32, corner: u32) {
        self.make_room(vertex, 1);
        let list = &mut self.lists[vertex as usize];
        self.corners[(list.start + list.n) as usize] = corner;
        list.n += 1;
    }

    /// Makes room for so many more corners of a vertex, at the end where there is none.
    fn make_room(&mut self, vertex: u32, n_more: u32) {
        let List { n, room, .. } = self.lists[vertex as usize];
        if n + n_more <= room {
            return;
        }
        let room = n + n_more.max(n / 4);
        if self.corners.len() + room as usize > self.corners.capacity() {
            self.pack();
        }
        let start = self.lists[vertex as usize].start;
        let moved = self.corners.len();
        self.corners.extend_from_within(start as usize..(start + n) as usize);
        self.corners.resize(moved + room as usize, 0);
        self.lists[vertex as usize] = List { start: moved as u32, n, room };
    }

    /// Drops what moves have left behind, where that is worth it.
    fn pack(&mut self) {
        let n: usize = self.lists.iter().map(|list| list.n as usize).sum();
        if 2 * n > self.corners.len() {
            return;
        }
        let mut packed = Vec::with_capacity(2 * n);
        for list in &mut self.lists {
            let start = packed.len() as u32;
            packed.extend_from_slice(
                &self.corners[list.start as usize..(list.start + list.n) as usize],
            );
            *list = List { start, n: list.n, room: list.n };
        }
        self.corners = packed;
    }

    /// What is left, in the order of the input, with its layers.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn finish(&self, mesh: &TriMesh, control: Control) -> Result<TriMesh, Cancelled> {
        let all = 0..self.faces.len() as u32;
        let kept = all.filter(|&face| !self.is_gone(face));
        let kept = by_source(kept, &self.face_sources, control.part(0.0, 0.3))?;
        let mut numbers = vec![NONE; self.positions.len()];
        for &face in &kept {
            self.faces[face as usize].iter().for_each(|&v| numbers[v as usize] = 0);
        }
        let all = 0..self.positions.len() as u32;
        let used = all.filter(|&v| numbers[v as usize] == 0);
        let used = by_source(used, &self.vertex_sources, control.part(0.3, 0.5))?;
        used.iter().zip(0..).for_each(|(&v, number)| numbers[v as usize] = number);
        control.at(0.5)?;
        let vertices =
            |&face: &u32| self.faces[face as usize].map(|v| VertexId(numbers[v as usize]));
        let faces = kept.iter().map(vertices).collect();
        let positions = used.iter().map(|&v| self.positions[v as usize]).collect();
        control.at(0.7)?;
        let mut wedges = self.wedges.iter();
        let mut layers = Vec::with_capacity(mesh.layers.len());
        for layer in &mesh.layers {
            let value = |source: u32| layer.index[source as usize];
            let index = match layer.domain {
                Domain::Vertex => {
                    used.iter().map(|&v| value(self.vertex_sources[v as usize])).collect()
                }
                Domain::Face => {
                    kept.iter().map(|&f| value(self.face_sources[f as usize])).collect()
                }
                Domain::Corner => {
                    wedges.next().map_or_else(Vec::new, |layer| layer.of_faces(&kept))
                }
            };
            let (name, values) = (layer.name.clone(), layer.values.clone());
            layers.push(Layer { name, domain: layer.domain, values, index });
            control.at(0.9)?;
        }
        Ok(TriMesh { positions, faces, layers, materials: mesh.materials.clone() })
    }
}

/// Elements by where they are from, and those of one origin in their order.
fn by_source(
    elements: impl Iterator<Item = u32>,
    sources: &[u32],
    control: Control,
) -> Result<Vec<u32>, Cancelled> {
    let mut keys: Vec<(u64, u32)> =
        elements.map(|element| (u64::from(sources[element as usize]), element)).collect();
    sort_by_code(&mut keys, control)?;
    Ok(keys.into_iter().map(|(_, element)| element).collect())
}

/// The faces that name three vertices, by the numbers of these.
fn face_order(mesh: &TriMesh, numbers: &[u32], control: Control) -> Result<Vec<u32>, Cancelled> {
    let key = |face: u32| {
        let mut vertices = mesh.faces[face as usize].map(|v| numbers[v.idx()]);
        let whole = vertices;
        vertices.sort_unstable();
        let is_face = vertices[0] != vertices[1] && vertices[1] != vertices[2];
        is_face.then_some((vertices, whole, face))
    };
    // By the lowest vertex in one pass, then the few at each.
    let mut starts = vec![0_u32; numbers.len() + 1];
    for face in 0..mesh.faces.len() as u32 {
        control.part(0.0, 0.3).item(face as usize, mesh.faces.len())?;
        if let Some((vertices, ..)) = key(face) {
            starts[vertices[0] as usize + 1] += 1;
        }
    }
    (0..numbers.len()).for_each(|v| starts[v + 1] += starts[v]);
    let mut next = starts.clone();
    let mut order = vec![0; starts[numbers.len()] as usize];
    for face in 0..mesh.faces.len() as u32 {
        control.part(0.3, 0.6).item(face as usize, mesh.faces.len())?;
        if let Some((vertices, ..)) = key(face) {
            order[next[vertices[0] as usize] as usize] = face;
            next[vertices[0] as usize] += 1;
        }
    }
    for v in 0..numbers.len() {
        control.part(0.6, 1.0).item(v, numbers.len())?;
        order[starts[v] as usize..starts[v + 1] as usize].sort_unstable_by_key(|&face| key(face));
    }
    Ok(order)
}
