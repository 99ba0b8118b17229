//! The result of a run: what is left of the working mesh, as a mesh in the order of the input.

use mve_core::Cancelled;
use mve_mesh::data::{TriMesh, VertexId};

use super::complex::Complex;
use super::mesh::WorkingMesh;
use super::order::NONE;
use super::ticker::{CHUNK, Ticker};

impl WorkingMesh {
    /// The faces that are left, with the vertices that they use, both in the order of the input.
    pub(super) fn into_mesh(
        self,
        input: &TriMesh,
        ticker: &mut Ticker,
    ) -> Result<TriMesh, Cancelled> {
        let Self { complex, attributes, order, .. } = self;
        let Complex { vertices, faces, corners, n_faces, .. } = complex;
        drop(corners);
        // By the input's ids: where each face and each vertex that it uses is now.
        let mut alive = ticker.fill(order.faces.len(), NONE)?;
        let mut here = ticker.fill(vertices.len(), NONE)?;
        let numbered =
            (0u32..).step_by(CHUNK).zip(faces.chunks(CHUNK).zip(order.faces.chunks(CHUNK)));
        for (first, (faces, inputs)) in numbered {
            ticker.tick(n_faces)?;
            for ((number, face), &input) in (first..).zip(faces).zip(inputs) {
                if !face.is_dead() {
                    alive[input as usize] = number;
                    for &v in &face.vertices {
                        here[order.vertices[v as usize] as usize] = v;
                    }
                }
            }
        }
        here.retain(|&v| v != NONE);
        ticker.tick(n_faces)?;
        alive.retain(|&face| face != NONE);
        let mut new_ids = ticker.fill(vertices.len(), NONE)?;
        let mut n_placed = 0;
        let positions = ticker.collect(&here, |&v| {
            new_ids[v as usize] = n_placed;
            n_placed += 1;
            vertices[v as usize].position
        })?;
        let new_face =
            |&face: &u32| faces[face as usize].vertices.map(|v| VertexId(new_ids[v as usize]));
        let new_faces = ticker.collect(&alive, new_face)?;
        drop(vertices);
        ticker.tick(n_faces)?;
        drop(faces);
        ticker.tick(n_faces)?;
        let layers = attributes.into_layers(input, &here, &alive, ticker)?;
        let materials = input.materials.clone();
        Ok(TriMesh { positions, faces: new_faces, layers, materials })
    }
}
