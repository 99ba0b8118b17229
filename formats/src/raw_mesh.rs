//! A mesh as files have it, polygons and doubtful numbers included, on its way to a mesh.

use glam::{DVec2, DVec3};
use mve_core::Control;
use mve_mesh::data::{Domain, Layer, LayerValues, Material, NO_VALUE, TriMesh, VertexId};

use super::ReadError;
use super::polygon::Polygons;
use super::warnings::{Warning, Warnings};

/// What a reader gathers. Lists of what a file does not have are empty; those of what it has are as
/// long as their elements.
#[derive(Default)]
pub(super) struct RawMesh {
    pub positions: Vec<DVec3>,
    pub normals: Vec<DVec3>,
    pub colors: Vec<DVec3>,
    pub texcoords: Vec<DVec2>,
    /// Names and values of other numbers of vertices.
    pub numbers: Vec<(String, Vec<f64>)>,
    pub polygons: Polygons,
    pub face_colors: Vec<DVec3>,
    /// Of the corners of all polygons; NaN where a corner has none.
    pub corner_texcoords: Vec<DVec2>,
    /// Names and values of other numbers of faces.
    pub face_numbers: Vec<(String, Vec<f64>)>,
    /// Values of the corners of all polygons, each by its number in a list.
    pub corner_layers: Vec<CornerLayer>,
    /// The material of each face, by number.
    pub face_materials: Vec<u32>,
    pub materials: Vec<Material>,
    pub warnings: Warnings,
    left_out: LeftOut,
}

/// Values of corners.
pub(super) struct CornerLayer {
    pub name: &'static str,
    pub values: LayerValues,
    /// Which value each corner has; those behind the end have none.
    pub index: Vec<u32>,
    /// Whether they were said for whole faces.
    pub is_of_faces: bool,
}

/// Faces that cannot be read.
#[derive(Default)]
pub(super) struct LeftOut {
    n: usize,
    /// Where the first is, and what is wrong with it.
    first: Option<(String, String)>,
}

impl LeftOut {
    /// Counts one.
    #[cold]
    pub fn add(&mut self, place: impl FnOnce() -> String, fault: impl FnOnce() -> String) {
        self.n += 1;
        self.first.get_or_insert_with(|| (place(), fault()));
    }

    /// Warns of them; an error where no face is left.
    pub fn tell(&self, n_faces: usize, warnings: &mut Warnings) -> Result<(), ReadError> {
        let Self { n, first: Some((place, fault)) } = self else { return Ok(()) };
        let more = if *n > 1 { format!(" (and {} more like it)", n - 1) } else { String::new() };
        if n_faces == 0 {
            return Err(ReadError::Wrong(format!("{place}: {fault}{more}; no face is left")));
        }
        warnings.add_general(format!("{place}: {fault}; the face is left out{more}"));
        Ok(())
    }
}

impl RawMesh {
    /// The vertex of this number, if there are so many.
    #[inline]
    pub fn vertex(number: f64, n_vertices: u64) -> Option<VertexId> {
        let is_one = number >= 0.0 && number < n_vertices as f64 && number.fract() == 0.0;
        is_one.then_some(VertexId(number as u32))
    }

    /// Counts a face that is left out.
    #[cold]
    pub fn leave_out(&mut self, place: impl FnOnce() -> String, fault: impl FnOnce() -> String) {
        self.left_out.add(place, fault);
    }

    /// Gives the last faces a value of what only those before them have.
    fn fill_up(&mut self) {
        let (n_faces, n_corners) = (self.polygons.len(), self.polygons.n_corners());
        if !self.face_colors.is_empty() {
            self.face_colors.resize(n_faces, DVec3::ONE);
        }
        if !self.corner_texcoords.is_empty() {
            self.corner_texcoords.resize(n_corners, DVec2::NAN);
        }
        for (_, values) in &mut self.face_numbers {
            values.resize(n_faces, f64::NAN);
        }
    }

    /// The mesh and the warnings.
    ///
    /// # Errors
    /// Where a face has a vertex that is nowhere, where all faces are left out, or when `control`
    /// says so.
    pub fn finish(mut self, control: Control) -> Result<(TriMesh, Vec<Warning>), ReadError> {
        self.left_out.tell(self.polygons.len(), &mut self.warnings)?;
        if self.positions.len() >= u32::MAX as usize / 3 {
            return Err(ReadError::Wrong("more than 1.4 billion vertices; split the file".into()));
        }
        self.fill_up();
        let cut = self.polygons.cut(&self.positions, &mut self.warnings, control)?;
        let n_corners = 3 * cut.faces.len() as u64;
        let cut_corners = cut.corners;
        if n_corners >= u64::from(u32::MAX) {
            return Err(ReadError::Wrong("more than 1.4 billion faces; split the file".into()));
        }
        settle_points(&mut self.positions, &cut.faces, &mut self.warnings)?;
        let mut mesh = TriMesh::new(self.positions, cut.faces);
        let (n_vertices, n_faces) = (mesh.positions.len(), mesh.faces.len());
        let of_faces = || cut.polygons.clone().unwrap_or_else(|| (0..n_faces as u32).collect());
        let of_vertices = || (0..n_vertices as u32).collect();
        let mut put = |name: &str, domain, values: LayerValues, index: Vec<u32>| {
            mesh.set_layer(Layer { name: name.to_owned(), domain, values, index });
        };
        if !self.corner_texcoords.is_empty() {
            let sources = cut_corners.clone().unwrap_or_else(|| (0..n_corners as u32).collect());
            let has = |at: u32| self.corner_texcoords[at as usize].is_finite();
            let index = sources.into_iter().map(|at| if has(at) { at } else { NO_VALUE }).collect();
            let (values, index) = joined(self.corner_texcoords, index);
            put(Layer::TEXCOORD, Domain::Corner, LayerValues::Vec2(values), index);
        }
        if !self.normals.is_empty() {
            put(Layer::NORMAL, Domain::Vertex, LayerValues::Vec3(self.normals), of_vertices());
        }
        let over_vertices = !self.colors.is_empty();
        for (colors, domain) in [(self.colors, Domain::Vertex), (self.face_colors, Domain::Face)] {
            if !colors.is_empty() && (domain == Domain::Vertex || !over_vertices) {
                let index = if domain == Domain::Vertex { of_vertices() } else { of_faces() };
                put(Layer::COLOR, domain, LayerValues::Vec3(colors), index);
            } else if !colors.is_empty() {
                let text = "colors of faces are left out, as the vertices have colors";
                self.warnings.add_general(text.to_owned());
            }
        }
        if !self.materials.is_empty() {
            let names = self.materials.iter().map(|material| material.name.clone()).collect();
            let of_polygon = |at: u32| self.face_materials.get(at as usize).copied();
            let index = of_faces().into_iter().map(|at| of_polygon(at).unwrap_or(NO_VALUE));
            put(Layer::MATERIAL, Domain::Face, LayerValues::Label(names), index.collect());
        }
        for (name, values) in self.numbers {
            put(&name, Domain::Vertex, LayerValues::Number(values), of_vertices());
        }
        for (name, values) in self.face_numbers {
            put(&name, Domain::Face, LayerValues::Number(values), of_faces());
        }
        put_corner_layers(&mut mesh, self.corner_layers, cut_corners.as_deref());
        if mesh.layer(Layer::TEXCOORD).is_none() && !self.texcoords.is_empty() {
            let index = mesh.faces.iter().flatten().map(|v| v.0).collect();
            let (name, values) = (Layer::TEXCOORD.to_owned(), LayerValues::Vec2(self.texcoords));
            mesh.set_layer(Layer { name, domain: Domain::Corner, values, index });
        }
        mesh.materials = self.materials;
        Ok((mesh, self.warnings.into_list()))
    }
}

/// Puts the values of corners in, where each is that of the corner of a polygon.
fn put_corner_layers(mesh: &mut TriMesh, layers: Vec<CornerLayer>, sources: Option<&[u32]>) {
    for layer in layers.into_iter().filter(|layer| !layer.index.is_empty()) {
        let CornerLayer { name, values, index, is_of_faces } = layer;
        let value = |at: usize| index.get(at).copied().unwrap_or(NO_VALUE);
        let of_corners: Vec<u32> = match sources {
            Some(sources) => sources.iter().map(|at| value(*at as usize)).collect(),
            None => (0..3 * mesh.faces.len()).map(value).collect(),
        };
        let is_pair = matches!(values, LayerValues::Vec2(_));
        let (domain, index) = match is_pair {
            true => (Domain::Corner, of_corners),
            false => smallest_domain(mesh, of_corners, is_of_faces),
        };
        mesh.set_layer(Layer { name: name.to_owned(), domain, values, index });
    }
}

/// Values of corners as those of vertices, if each vertex has one, or of faces.
fn smallest_domain(mesh: &TriMesh, index: Vec<u32>, is_of_faces: bool) -> (Domain, Vec<u32>) {
    let of_faces = || {
        let faces = index.as_chunks::<3>().0;
        let is_single = faces.iter().all(|[a, b, c]| a == b && b == c);
        is_single.then(|| faces.iter().map(|[a, ..]| *a).collect())
    };
    if is_of_faces && let Some(index) = of_faces() {
        return (Domain::Face, index);
    }
    let mut of_vertices = vec![None; mesh.positions.len()];
    let corners = mesh.faces.iter().flatten().zip(&index);
    let is_single =
        corners.into_iter().all(|(v, at)| *of_vertices[v.idx()].get_or_insert(*at) == *at);
    if !is_single {
        return (Domain::Corner, index);
    }
    (Domain::Vertex, of_vertices.into_iter().map(|at| at.unwrap_or(NO_VALUE)).collect())
}

/// Gives corners of equal values one number, so that no seam runs between them.
fn joined(values: Vec<DVec2>, mut index: Vec<u32>) -> (Vec<DVec2>, Vec<u32>) {
    let mut known = std::collections::HashMap::new();
    let mut kept = Vec::new();
    for at in index.iter_mut().filter(|at| **at != NO_VALUE) {
        let value = values[*at as usize];
        *at = *known.entry(value.to_array().map(f64::to_bits)).or_insert_with(|| {
            kept.push(value);
            kept.len() as u32 - 1
        });
    }
    (kept, index)
}

/// Refuses faces at points that are nowhere; other such points are set to 0.
pub(super) fn settle_points(
    positions: &mut [DVec3],
    faces: &[[VertexId; 3]],
    warnings: &mut Warnings,
) -> Result<(), ReadError> {
    if positions.iter().all(|point| point.is_finite()) {
        return Ok(());
    }
    for (number, face) in faces.iter().enumerate() {
        if let Some(v) = face.iter().find(|v| !positions[v.idx()].is_finite()) {
            let DVec3 { x, y, z } = positions[v.idx()];
            return Err(ReadError::Wrong(format!(
                "vertex {} of face {number} is at {x} {y} {z}; coordinates must be finite numbers",
                v.0
            )));
        }
    }
    let nowhere = positions.iter_mut().filter(|point| !point.is_finite());
    let n = nowhere.map(|point| *point = DVec3::ZERO).count();
    warnings
        .add_general(format!("{n} vertices are not finite; as no face uses them, they are at 0"));
    Ok(())
}
