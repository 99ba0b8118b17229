//! Joins what is left of the blocks of a mesh.

use std::collections::HashMap;

use mve_core::{Cancelled, Control};
use mve_mesh::data::{Domain, Layer, LayerValues, NO_VALUE, TriMesh, VertexId};
use mve_mesh::quadric::Quadric;

use super::cut::{Block, Cut};
use super::mesh::WorkingMesh;
use super::order::NONE;
use super::ticker::Ticker;

/// What is left of a block.
pub(super) struct Remains {
    mesh: TriMesh,
    /// The whole mesh's id of each vertex and each face, ascending.
    vertices: Vec<u32>,
    faces: Vec<u32>,
    /// Of each vertex; none if there are no quadrics.
    quadrics: Vec<Quadric>,
}

impl Remains {
    pub fn of(working: WorkingMesh, block: &Block, control: Control) -> Result<Self, Cancelled> {
        let (mut vertices, mut faces) = (Vec::new(), Vec::new());
        for face in working.face_ids() {
            faces.push(working.input_face(face).0);
            vertices.extend(working.face(face).into_iter().flatten());
        }
        faces.sort_unstable();
        vertices.sort_unstable();
        vertices.dedup();
        let mut here: Vec<(u32, VertexId)> =
            vertices.into_iter().map(|v| (working.input_vertex(v).0, v)).collect();
        here.sort_unstable();
        let quadric = |(_, v): &(u32, VertexId)| working.quadrics.get(v.0).copied();
        let quadrics = here.iter().filter_map(quadric).collect();
        let vertices = here.iter().map(|(input, _)| block.vertices[*input as usize]).collect();
        let faces = faces.iter().map(|&input| block.faces[input as usize]).collect();
        let mesh = working.into_mesh(&block.mesh, &mut Ticker::new(control))?;
        Ok(Self { mesh, vertices, faces, quadrics })
    }
}

/// The blocks as one mesh again.
pub(super) struct Joined {
    pub mesh: TriMesh,
    /// Whether each vertex is of several blocks.
    pub is_cut: Vec<bool>,
    /// Of each vertex; none if there are no quadrics.
    pub quadrics: Vec<Quadric>,
}

/// Joins all blocks of a mesh; vertices and faces are in the order of the input.
pub(super) fn join(
    input: &TriMesh,
    blocks: Vec<Remains>,
    cut: Cut,
    control: Control,
) -> Result<Joined, Cancelled> {
    // By the input's ids: where each vertex and each face is in the list of all blocks.
    let mut vertex_at = vec![NONE; input.positions.len()];
    let mut face_at = vec![NONE; input.faces.len()];
    let (mut n_vertices, mut n_faces) = (0, 0);
    for block in &blocks {
        control.at(0.0)?;
        for &vertex in &block.vertices {
            vertex_at[vertex as usize] = n_vertices;
            n_vertices += 1;
        }
        for &face in &block.faces {
            face_at[face as usize] = n_faces;
            n_faces += 1;
        }
    }
    let mut new_ids = vertex_at.clone();
    let mut is_cut = cut.is_cut;
    let mut kept = vertex_at.iter().map(|&at| at != NONE);
    is_cut.retain(|_| kept.next().unwrap_or(false));
    vertex_at.retain(|&at| at != NONE);
    let ids = new_ids.iter_mut().filter(|id| **id != NONE);
    (0u32..).zip(ids).for_each(|(number, id)| *id = number);
    face_at.retain(|&at| at != NONE);
    control.at(0.0)?;

    let positions: Vec<_> =
        blocks.iter().flat_map(|block| block.mesh.positions.iter().copied()).collect();
    let positions = vertex_at.iter().map(|&at| positions[at as usize]).collect::<Vec<_>>();
    let faces: Vec<_> = blocks
        .iter()
        .flat_map(|block| {
            let new_id = |v: VertexId| VertexId(new_ids[block.vertices[v.idx()] as usize]);
            block.mesh.faces.iter().map(move |face| face.map(new_id))
        })
        .collect();
    let faces = face_at.iter().map(|&at| faces[at as usize]).collect();
    control.at(0.0)?;

    let has_quadrics = blocks.iter().any(|block| !block.quadrics.is_empty());
    let n_quadrics = if has_quadrics { positions.len() } else { 0 };
    let mut quadrics = vec![Quadric::default(); n_quadrics];
    for block in blocks.iter().filter(|block| !block.quadrics.is_empty()) {
        for (&vertex, quadric) in block.vertices.iter().zip(&block.quadrics) {
            // A vertex of several blocks has the planes of all: it has not moved.
            quadrics[new_ids[vertex as usize] as usize].add(quadric);
        }
    }
    let layers = (0..input.layers.len()).map(|at| {
        control.at(0.0)?;
        let of_blocks = blocks.iter().filter_map(|block| block.mesh.layers.get(at));
        Ok(joined_layer(&input.layers[at], of_blocks, &vertex_at, &face_at))
    });
    let layers = layers.collect::<Result<_, Cancelled>>()?;
    let mesh = TriMesh { positions, faces, layers, materials: input.materials.clone() };
    Ok(Joined { mesh, is_cut, quadrics })
}

/// A layer of the joined mesh from those of the blocks; the lists say where each of its vertices
/// and faces is in the list of all blocks.
fn joined_layer<'a>(
    input: &Layer,
    blocks: impl Iterator<Item = &'a Layer>,
    vertex_at: &[u32],
    face_at: &[u32],
) -> Layer {
    let mut values = match &input.values {
        LayerValues::Number(_) => LayerValues::Number(Vec::new()),
        LayerValues::Vec2(_) => LayerValues::Vec2(Vec::new()),
        LayerValues::Vec3(_) => LayerValues::Vec3(Vec::new()),
        LayerValues::Label(_) => LayerValues::Label(Vec::new()),
    };
    let mut all: Vec<u32> = Vec::new();
    // A name has one number, since faces of different numbers have a border between them.
    let mut names: HashMap<String, u32> = HashMap::new();
    for layer in blocks {
        let numbers: Vec<u32> = match (&mut values, &layer.values) {
            (LayerValues::Number(all), LayerValues::Number(of_block)) => append(all, of_block),
            (LayerValues::Vec2(all), LayerValues::Vec2(of_block)) => append(all, of_block),
            (LayerValues::Vec3(all), LayerValues::Vec3(of_block)) => append(all, of_block),
            (LayerValues::Label(all), LayerValues::Label(of_block)) => {
                let number = |name: &String| {
                    *names.entry(name.clone()).or_insert_with(|| {
                        all.push(name.clone());
                        all.len() as u32 - 1
                    })
                };
                of_block.iter().map(number).collect()
            }
            // The blocks' layers are of the input's kinds.
            _ => Vec::new(),
        };
        let number = |&value: &u32| numbers.get(value as usize).copied().unwrap_or(NO_VALUE);
        all.extend(layer.index.iter().map(number));
    }
    let at = |element: u32| all.get(element as usize).copied().unwrap_or(NO_VALUE);
    let index = match input.domain {
        Domain::Vertex => vertex_at.iter().map(|&v| at(v)).collect(),
        Domain::Face => face_at.iter().map(|&face| at(face)).collect(),
        Domain::Corner => {
            face_at.iter().flat_map(|&face| [0, 1, 2].map(|k| at(3 * face + k))).collect()
        }
    };
    Layer { name: input.name.clone(), domain: input.domain, values, index }
}

/// Appends values; the numbers that they have then.
fn append<T: Clone>(all: &mut Vec<T>, more: &[T]) -> Vec<u32> {
    let first = all.len() as u32;
    all.extend_from_slice(more);
    (first..all.len() as u32).collect()
}
