//! Meshes made of elements of another one, with the layers that follow them.

use std::collections::HashMap;

use glam::{DVec2, DVec3};
use mve_core::{Cancelled, Control};

use mve_mesh::data::{Domain, Layer, LayerValues, NO_VALUE, TriMesh, VertexId};

/// Where an element of a new mesh has its values from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Origin {
    /// An element of the old mesh.
    Of(u32),
    /// A point between two of them, at this share of the way from the first to the second.
    Between(u32, u32, f64),
    /// Nowhere: it has no values.
    Nowhere,
}

/// A new mesh without its layers, and where its elements come from.
#[derive(Clone, Debug, Default)]
pub struct Draft {
    /// Positions of the vertices.
    pub positions: Vec<DVec3>,
    /// Origin of each vertex.
    pub vertices: Vec<Origin>,
    /// Vertices of the faces.
    pub faces: Vec<[VertexId; 3]>,
    /// Origin of each corner, three a face, among the corners of the old mesh.
    pub corners: Vec<[Origin; 3]>,
    /// The old face that each face comes from; [`NO_VALUE`] for none.
    pub sources: Vec<u32>,
}

impl Draft {
    /// A draft with the vertices of a mesh and no face.
    pub fn of_vertices(mesh: &TriMesh) -> Self {
        let vertices = (0..mesh.positions.len() as u32).map(Origin::Of).collect();
        Self { positions: mesh.positions.clone(), vertices, ..Self::default() }
    }

    /// Adds a face with the corners of an old one, in its order.
    pub fn push_face(&mut self, mesh: &TriMesh, face: u32) {
        self.faces.push(mesh.faces[face as usize]);
        self.corners.push([0, 1, 2].map(|k| Origin::Of(3 * face + k)));
        self.sources.push(face);
    }

    /// The mesh, with the layers and materials of the one that the draft was made of. Values
    /// between two others are interpolated; normals stay unit vectors, and a name is that of the
    /// nearer end.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn finish(self, mesh: &TriMesh, control: Control) -> Result<TriMesh, Cancelled> {
        let mut layers = Vec::with_capacity(mesh.layers.len());
        for (place, layer) in mesh.layers.iter().enumerate() {
            control.at(place as f64 / mesh.layers.len() as f64)?;
            let mut values = Values::of(layer);
            let index = match layer.domain {
                Domain::Vertex => values.index(self.vertices.iter(), control)?,
                Domain::Corner => values.index(self.corners.iter().flatten(), control)?,
                Domain::Face => self.sources.iter().map(|&f| value_at(layer, f)).collect(),
            };
            let (name, domain) = (layer.name.clone(), layer.domain);
            layers.push(Layer { name, domain, values: values.values, index });
        }
        let (positions, faces) = (self.positions, self.faces);
        Ok(TriMesh { positions, faces, layers, materials: mesh.materials.clone() })
    }
}

fn value_at(layer: &Layer, element: u32) -> u32 {
    layer.index.get(element as usize).copied().unwrap_or(NO_VALUE)
}

/// The values of a layer, which grow by those between two others.
struct Values<'a> {
    layer: &'a Layer,
    values: LayerValues,
    /// What is known between two values at a share: elements that come from equal ones share it.
    known: HashMap<(u32, u32, u64), u32>,
}

impl<'a> Values<'a> {
    fn of(layer: &'a Layer) -> Self {
        Self { layer, values: layer.values.clone(), known: HashMap::new() }
    }

    fn index<'b>(
        &mut self,
        origins: impl Iterator<Item = &'b Origin>,
        control: Control,
    ) -> Result<Vec<u32>, Cancelled> {
        let at = |(place, origin): (usize, &Origin)| {
            control.item(place, usize::MAX)?;
            Ok(match *origin {
                Origin::Of(element) => value_at(self.layer, element),
                Origin::Between(a, b, share) => {
                    self.between(value_at(self.layer, a), value_at(self.layer, b), share)
                }
                Origin::Nowhere => NO_VALUE,
            })
        };
        origins.enumerate().map(at).collect()
    }

    fn between(&mut self, one: u32, two: u32, share: f64) -> u32 {
        if one == two || one == NO_VALUE || two == NO_VALUE {
            return if one == two { one } else { NO_VALUE };
        }
        let key = (one, two, share.to_bits());
        if let Some(value) = self.known.get(&key) {
            return *value;
        }
        let (i, j) = (one as usize, two as usize);
        match &mut self.values {
            LayerValues::Number(v) => v.push((1.0 - share) * v[i] + share * v[j]),
            LayerValues::Vec2(v) => v.push(DVec2::lerp(v[i], v[j], share)),
            LayerValues::Vec3(v) => {
                let middle = DVec3::lerp(v[i], v[j], share);
                let normal = (self.layer.name == Layer::NORMAL).then(|| middle.try_normalize());
                v.push(normal.map_or(middle, |normal| normal.unwrap_or(v[i])));
            }
            LayerValues::Label(_) => return if share <= 0.5 { one } else { two },
        }
        let value = self.values.len() as u32 - 1;
        self.known.insert(key, value);
        value
    }
}

/// The mesh with only some of its faces, and without the vertices that lose all of theirs to it.
/// What is left keeps its order; vertices that had no face stay where `isolated` says so.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn with_faces(
    mesh: &TriMesh,
    is_kept: impl Fn(usize) -> bool,
    isolated: Isolated,
    control: Control,
) -> Result<TriMesh, Cancelled> {
    control.at(0.0)?;
    let mut is_used = vec![false; mesh.positions.len()];
    if isolated == Isolated::Kept {
        is_used.fill(true);
        mesh.faces.iter().flatten().for_each(|v| is_used[v.idx()] = false);
    }
    let kept: Vec<u32> = (0..mesh.faces.len() as u32).filter(|&f| is_kept(f as usize)).collect();
    for &face in &kept {
        mesh.faces[face as usize].iter().for_each(|v| is_used[v.idx()] = true);
    }
    let mut draft = Draft::default();
    let mut numbers = vec![u32::MAX; mesh.positions.len()];
    for vertex in (0..mesh.positions.len()).filter(|&vertex| is_used[vertex]) {
        numbers[vertex] = draft.positions.len() as u32;
        draft.positions.push(mesh.positions[vertex]);
        draft.vertices.push(Origin::Of(vertex as u32));
    }
    for (place, &face) in kept.iter().enumerate() {
        control.part(0.0, 0.5).item(place, kept.len())?;
        draft.push_face(mesh, face);
    }
    draft.faces.iter_mut().flatten().for_each(|v| *v = VertexId(numbers[v.idx()]));
    draft.finish(mesh, control.part(0.5, 1.0))
}

/// What becomes of vertices without a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Isolated {
    /// They stay.
    Kept,
    /// They go.
    Removed,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::edit::checks::layered_square;

    #[test]
    fn elements_take_their_values_along() {
        let mesh = layered_square();
        let found = with_faces(&mesh, |f| f == 1, Isolated::Removed, Control::none()).unwrap();
        assert_eq!(found.check(), Ok(()));
        assert_eq!(found.faces, [[0, 1, 2].map(VertexId)]);
        assert_eq!(found.positions, [mesh.positions[0], mesh.positions[2], mesh.positions[3]]);
        let index = |name: &str| found.layer(name).unwrap().index.clone();
        assert_eq!(index("height"), [0, 2, 3]);
        assert_eq!(index(Layer::TEXCOORD), [3, 4, 5]);
        assert_eq!(index(Layer::MATERIAL), [1]);
    }

    #[test]
    fn what_lies_between_is_interpolated_and_shared() {
        let mesh = layered_square();
        let mut draft = Draft::of_vertices(&mesh);
        draft.positions.push(DVec3::ZERO);
        draft.vertices.push(Origin::Between(0, 1, 0.25));
        for _ in 0..2 {
            draft.push_face(&mesh, 0);
        }
        draft.corners[0][0] = Origin::Between(0, 1, 0.25);
        draft.corners[1][0] = Origin::Between(0, 1, 0.25);
        draft.corners[1][1] = Origin::Nowhere;
        let found = draft.finish(&mesh, Control::none()).unwrap();
        assert_eq!(found.check(), Ok(()));
        let LayerValues::Number(heights) = &found.layer("height").unwrap().values else { panic!() };
        assert_eq!(heights[4], 0.25);
        let texcoord = found.layer(Layer::TEXCOORD).unwrap();
        assert_eq!(texcoord.index, [6, 1, 2, 6, NO_VALUE, 2]);
        let LayerValues::Vec2(values) = &texcoord.values else { panic!() };
        assert_eq!(values[6], DVec2::new(0.25, 0.0));
    }
}
