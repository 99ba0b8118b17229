//! Cuts a mesh into blocks of neighboring faces.

use mve_core::{Cancelled, Control};
use mve_mesh::data::{Domain, Layer, LayerValues, NO_VALUE, TriMesh, VertexId};
use mve_mesh::morton::{coarse_codes, sort_by_code};

use super::order::NONE;

/// Which faces are in which block; see [`Cut::new`].
pub(super) struct Cut {
    /// The faces of all blocks, block by block, each in the order of the input.
    faces: Vec<u32>,
    /// Where each block starts in them, and the end.
    starts: Vec<usize>,
    /// Whether each vertex has faces in several blocks.
    pub is_cut: Vec<bool>,
    n_faces_at_cuts: usize,
}

/// A block as a mesh of its own.
pub(super) struct Block {
    pub mesh: TriMesh,
    /// Whether each of its vertices has faces in other blocks, too.
    pub is_cut: Vec<bool>,
    /// The whole mesh's id of each vertex and each face, ascending.
    pub vertices: Vec<u32>,
    pub faces: Vec<u32>,
}

impl Cut {
    /// Cuts the faces into so many runs of equal length along a space-filling curve, by where the
    /// first of their vertices on it lies. Faces that name a vertex that is not there are in none.
    pub fn new(mesh: &TriMesh, n_blocks: usize, control: Control) -> Result<Self, Cancelled> {
        let codes = coarse_codes(&mesh.positions, control)?;
        let code = |face: &[VertexId; 3]| {
            let [a, b, c] = face.map(|v| codes.get(v.idx()).copied());
            Some(a?.min(b?).min(c?))
        };
        let numbered = (0u32..).zip(&mesh.faces);
        let mut keys: Vec<(u64, u32)> =
            numbered.filter_map(|(number, face)| Some((code(face)?, number))).collect();
        sort_by_code(&mut keys, control)?;
        let mut faces: Vec<u32> = keys.into_iter().map(|(_, number)| number).collect();
        let starts: Vec<usize> = (0..=n_blocks).map(|at| at * faces.len() / n_blocks).collect();
        let mut owners = vec![NONE; mesh.positions.len()];
        let mut is_cut = vec![false; mesh.positions.len()];
        for (block, ends) in (0u32..).zip(starts.windows(2)) {
            control.at(0.0)?;
            let faces = &mut faces[ends[0]..ends[1]];
            faces.sort_unstable();
            for v in faces.iter().flat_map(|&face| mesh.faces[face as usize]) {
                let owner = &mut owners[v.idx()];
                is_cut[v.idx()] |= *owner != NONE && *owner != block;
                *owner = block;
            }
        }
        let is_at_cut = |face: &&u32| mesh.faces[**face as usize].iter().any(|v| is_cut[v.idx()]);
        let n_faces_at_cuts = faces.iter().filter(is_at_cut).count();
        Ok(Self { faces, starts, is_cut, n_faces_at_cuts })
    }

    /// How many faces have a vertex with faces in several blocks.
    pub fn n_faces_at_cuts(&self) -> usize {
        self.n_faces_at_cuts
    }

    /// A block of the mesh that was cut.
    pub fn block(&self, mesh: &TriMesh, at: usize) -> Block {
        let faces = self.faces[self.starts[at]..self.starts[at + 1]].to_vec();
        let mut vertices: Vec<u32> =
            faces.iter().flat_map(|&face| mesh.faces[face as usize].map(|v| v.0)).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let local = |v: VertexId| VertexId(vertices.partition_point(|&other| other < v.0) as u32);
        let positions = vertices.iter().map(|&v| mesh.positions[v as usize]).collect();
        let is_cut = vertices.iter().map(|&v| self.is_cut[v as usize]).collect();
        let new_faces = faces.iter().map(|&face| mesh.faces[face as usize].map(local)).collect();
        let layer = |layer: &Layer| of_block(layer, &vertices, &faces);
        let layers = mesh.layers.iter().map(layer).collect();
        let mesh = TriMesh { positions, faces: new_faces, layers, materials: Default::default() };
        Block { mesh, is_cut, vertices, faces }
    }
}

/// What a layer says of the elements of a block.
fn of_block(layer: &Layer, vertices: &[u32], faces: &[u32]) -> Layer {
    let index_of = |element: u32| layer.index.get(element as usize).copied().unwrap_or(NO_VALUE);
    let mut index: Vec<u32> = match layer.domain {
        Domain::Vertex => vertices.iter().map(|&v| index_of(v)).collect(),
        Domain::Face => faces.iter().map(|&face| index_of(face)).collect(),
        Domain::Corner => {
            let corners = faces.iter().flat_map(|&face| [0, 1, 2].map(|k| 3 * face + k));
            corners.map(index_of).collect()
        }
    };
    let mut used: Vec<u32> = index.clone();
    used.sort_unstable();
    used.dedup();
    let n_values = layer.values.len();
    used.retain(|&value| (value as usize) < n_values);
    for value in &mut index {
        *value = used.binary_search(value).map_or(NO_VALUE, |number| number as u32);
    }
    Layer {
        name: layer.name.clone(),
        domain: layer.domain,
        values: picked(&layer.values, &used),
        index,
    }
}

/// The values of these numbers.
fn picked(values: &LayerValues, numbers: &[u32]) -> LayerValues {
    fn pick<T: Clone>(values: &[T], numbers: &[u32]) -> Vec<T> {
        numbers.iter().map(|&number| values[number as usize].clone()).collect()
    }
    match values {
        LayerValues::Number(values) => LayerValues::Number(pick(values, numbers)),
        LayerValues::Vec2(values) => LayerValues::Vec2(pick(values, numbers)),
        LayerValues::Vec3(values) => LayerValues::Vec3(pick(values, numbers)),
        LayerValues::Label(values) => LayerValues::Label(pick(values, numbers)),
    }
}
