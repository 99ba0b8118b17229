//! From the nodes of an Open Inventor file to a mesh.

use std::collections::HashMap;

use glam::{DMat3, DMat4, DVec2, DVec3};
use mve_core::Control;
use mve_mesh::data::{
    Layer, LayerValues, Material, NO_VALUE, Texture, TextureImage, TextureRole, TriMesh,
};

use super::corners::{Choice, Faces, Placed};
use super::node::{Binding, Corners, Node, NodeId, Scope, Shape, ShapeKind};
use super::parse::Scene;
use crate::ReadError;
use crate::raw_mesh::{CornerLayer, RawMesh};
use crate::warnings::{Warning, Warnings};

/// Nodes that are gone through, those that are used again counted again.
const MOST_VISITS: usize = 1 << 22;
/// Points and corners that a small file may have when its nodes are used again.
const MOST_ELEMENTS: usize = 1 << 25;
/// And for a byte of the file.
const MOST_ELEMENTS_A_BYTE: usize = 64;

/// The surfaces of a scene as one mesh.
///
/// # Errors
/// Where nodes are used so often that the mesh would have no end; when `control` says so.
pub(super) fn mesh(
    scene: &Scene,
    n_bytes: usize,
    warnings: Warnings,
    control: Control,
) -> Result<(TriMesh, Vec<Warning>), ReadError> {
    let most = MOST_ELEMENTS.max(n_bytes.saturating_mul(MOST_ELEMENTS_A_BYTE));
    let mut raw = RawMesh::default();
    raw.warnings = warnings;
    let mut walk = Walk {
        scene,
        mesh: raw,
        points: HashMap::new(),
        normals: Placed::default(),
        texcoords: Placed::default(),
        colors: Placed::default(),
        has_corner_colors: false,
        materials: HashMap::new(),
        most: most.min(u32::MAX as usize / 3),
        control,
    };
    walk.go()?;
    walk.finish()
}

/// What holds where a node stands.
#[derive(Clone, Copy)]
struct State {
    transform: DMat4,
    points: Option<NodeId>,
    normals: Option<NodeId>,
    texcoords: Option<NodeId>,
    material: Option<NodeId>,
    texture: Option<NodeId>,
    material_binding: Binding,
    normal_binding: Binding,
    texcoord_binding: Binding,
    is_clockwise: bool,
}

/// What is still to be done.
enum Step {
    Visit(NodeId),
    /// Back to what held before a group.
    Restore(Scope, Box<State>),
}

struct Walk<'a> {
    scene: &'a Scene,
    mesh: RawMesh,
    /// The first vertex of the points of a node, for each place that they are moved to.
    points: HashMap<(NodeId, [u64; 16]), u32>,
    normals: Placed<DVec3>,
    texcoords: Placed<DVec2>,
    colors: Placed<DVec3>,
    /// Whether a color was said for less than a face.
    has_corner_colors: bool,
    materials: HashMap<(Option<NodeId>, Option<NodeId>), u32>,
    most: usize,
    control: Control<'a>,
}

impl<'a> Walk<'a> {
    fn go(&mut self) -> Result<(), ReadError> {
        let mut state = State {
            transform: DMat4::IDENTITY,
            points: None,
            normals: None,
            texcoords: None,
            material: None,
            texture: None,
            material_binding: Binding::Default,
            normal_binding: Binding::Default,
            texcoord_binding: Binding::Default,
            is_clockwise: false,
        };
        let mut steps: Vec<Step> = self.scene.roots.iter().rev().map(|&n| Step::Visit(n)).collect();
        let mut n_visits = 0;
        while let Some(step) = steps.pop() {
            let id = match step {
                Step::Restore(Scope::Transform, before) => {
                    state.transform = before.transform;
                    continue;
                }
                Step::Restore(_, before) => {
                    state = *before;
                    continue;
                }
                Step::Visit(id) => id,
            };
            n_visits += 1;
            self.control.item(n_visits, self.scene.nodes.len())?;
            if n_visits > MOST_VISITS {
                let message = format!("nodes are used again for more than {MOST_VISITS} in all");
                return Err(ReadError::Wrong(message));
            }
            self.visit(id, &mut state, &mut steps)?;
        }
        Ok(())
    }

    fn visit(
        &mut self,
        id: NodeId,
        state: &mut State,
        steps: &mut Vec<Step>,
    ) -> Result<(), ReadError> {
        match &self.scene.nodes[id] {
            Node::Group { scope, children } => {
                if *scope != Scope::Open {
                    steps.push(Step::Restore(*scope, Box::new(*state)));
                }
                steps.extend(children.iter().rev().map(|&child| Step::Visit(child)));
            }
            Node::Points(_) => state.points = Some(id),
            Node::Normals(_) => state.normals = Some(id),
            Node::Texcoords(_) => state.texcoords = Some(id),
            Node::Material { .. } => state.material = Some(id),
            Node::Texture { name, image, .. } => {
                state.texture = (!name.is_empty() || image.is_some()).then_some(id);
            }
            Node::MaterialBinding(binding) => state.material_binding = *binding,
            Node::NormalBinding(binding) => state.normal_binding = *binding,
            Node::TexcoordBinding(binding) => state.texcoord_binding = *binding,
            Node::Transform(transform) => state.transform *= *transform,
            Node::ResetTransform => state.transform = DMat4::IDENTITY,
            Node::Order { is_clockwise } => state.is_clockwise = *is_clockwise,
            Node::Nothing => {}
            Node::Shape(shape) => {
                let mut own = *state;
                if let Some(Node::Group { children, .. }) =
                    shape.properties.and_then(|id| self.scene.nodes.get(id))
                {
                    // They are nodes without children.
                    for &child in children {
                        self.visit(child, &mut own, &mut Vec::new())?;
                    }
                }
                self.shape(shape, &own)?;
            }
        }
        Ok(())
    }

    /// The first vertex of the points that hold, and how many there are.
    fn vertices(&mut self, state: &State) -> Result<(u32, usize), ReadError> {
        let Some((id, Node::Points(points))) = state.points.map(|id| (id, &self.scene.nodes[id]))
        else {
            return Ok((0, 0));
        };
        let key = (id, state.transform.to_cols_array().map(f64::to_bits));
        if let Some(start) = self.points.get(&key) {
            return Ok((*start, points.len()));
        }
        self.check_size(points.len())?;
        let start = self.mesh.positions.len() as u32;
        let is_still = state.transform == DMat4::IDENTITY;
        let place = |p: &DVec3| if is_still { *p } else { state.transform.transform_point3(*p) };
        self.mesh.positions.extend(points.iter().map(place));
        self.points.insert(key, start);
        Ok((start, points.len()))
    }

    fn check_size(&self, n_more: usize) -> Result<(), ReadError> {
        let n = self.mesh.positions.len() + self.mesh.polygons.n_corners();
        let n = n + self.normals.values.len() + self.texcoords.values.len();
        if n.saturating_add(n_more) <= self.most {
            return Ok(());
        }
        Err(ReadError::Wrong(format!(
            "with all nodes that are used again the scene has more than {} points and corners; split \
             the file",
            self.most
        )))
    }

    fn shape(&mut self, shape: &Shape, state: &State) -> Result<(), ReadError> {
        let (first, n_points) = self.vertices(state)?;
        let index = match &shape.corners {
            Corners::Indexed(index) => index.as_slice(),
            Corners::Counted { first, counts } => &listed(*first, counts, n_points),
        };
        let n_for_one = if shape.kind == ShapeKind::Strips { 3 } else { 1 };
        self.check_size(index.len().saturating_mul(n_for_one))?;
        let is_reversed = state.is_clockwise != (state.transform.determinant() < 0.0);
        let choices = self.choices(shape, state)?;
        let material = self.material(state, choices[2].is_some());
        let n_corners_before = self.mesh.polygons.n_corners();
        for (choice, list) in choices.iter().zip([
            &mut self.normals.index,
            &mut self.texcoords.index,
            &mut self.colors.index,
        ]) {
            if choice.is_some() {
                list.resize(n_corners_before, NO_VALUE);
            }
        }
        let mut faces = Faces {
            mesh: &mut self.mesh,
            lists: [&mut self.normals.index, &mut self.texcoords.index, &mut self.colors.index],
            choices,
            first,
            n_points,
            material,
            is_reversed,
            polygon: Vec::new(),
            n_done: 0,
        };
        faces.add_all(shape.kind, index, self.control)
    }

    /// The normals, texture coordinates and colors that corners of a shape choose from.
    fn choices<'s>(
        &mut self,
        shape: &'s Shape,
        state: &State,
    ) -> Result<[Option<Choice<'s>>; 3], ReadError> {
        let node = |id: Option<NodeId>| id.map(|id| (id, &self.scene.nodes[id]));
        let linear = DMat3::from_mat4(state.transform);
        let mut found = [None, None, None];
        if let Some((id, Node::Normals(normals))) = node(state.normals) {
            self.check_size(normals.len())?;
            let [x, y, z] = [linear.x_axis, linear.y_axis, linear.z_axis];
            let turn = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
            let turn = if linear.determinant() < 0.0 { -turn } else { turn };
            let is_still = linear == DMat3::IDENTITY;
            let place = |n: &DVec3| if is_still { *n } else { (turn * *n).normalize_or_zero() };
            let key = (id, linear.to_cols_array().map(f64::to_bits));
            let start = self.normals.start(key, || normals.iter().map(place).collect());
            let (binding, index) = (state.normal_binding, shape.normal_index.as_slice());
            found[0] = Some(Choice { binding, index, start, n: normals.len() });
        }
        if let Some((id, Node::Texcoords(texcoords))) = node(state.texcoords) {
            self.check_size(texcoords.len())?;
            let start = self.texcoords.start((id, [0; 9]), || texcoords.clone());
            let (binding, index) = (state.texcoord_binding, shape.texcoord_index.as_slice());
            found[1] = Some(Choice { binding, index, start, n: texcoords.len() });
        }
        let binding = state.material_binding;
        let is_overall = matches!(binding, Binding::Overall | Binding::Default);
        if let Some((id, Node::Material { colors, .. })) = node(state.material)
            && !is_overall
            && !colors.is_empty()
        {
            self.has_corner_colors |=
                matches!(binding, Binding::PerVertex | Binding::PerVertexIndexed);
            let start = self.colors.start((id, [0; 9]), || colors.clone());
            let index = shape.material_index.as_slice();
            found[2] = Some(Choice { binding, index, start, n: colors.len() });
        }
        Ok(found)
    }

    /// The number of the material that holds; where faces have colors, of its picture alone.
    fn material(&mut self, state: &State, has_colors: bool) -> u32 {
        let material = state.material.filter(|_| !has_colors);
        let key = (material, state.texture);
        if key == (None, None) {
            return NO_VALUE;
        }
        if let Some(number) = self.materials.get(&key) {
            return *number;
        }
        let scene = self.scene;
        let mut about = match material.map(|id| &scene.nodes[id]) {
            Some(Node::Material { about, .. }) => about.clone(),
            _ => Material::default(),
        };
        let names = [material, state.texture].into_iter().flatten();
        let name = names.filter_map(|id| scene.names.get(&id)).next().cloned();
        let number = self.mesh.materials.len();
        let name = name.unwrap_or_else(|| format!("material{number}"));
        let is_taken = self.mesh.materials.iter().any(|other| other.name == name);
        about.name = if is_taken { format!("{name}-{number}") } else { name };
        if let Some(Node::Texture { name, image, is_clamped }) =
            state.texture.map(|id| &scene.nodes[id])
        {
            let image = image.clone().filter(|_| name.is_empty()).map(TextureImage::new);
            let file = if name.is_empty() { format!("texture{number}.png") } else { name.clone() };
            about.textures.push(Texture {
                role: TextureRole::BaseColor,
                keyword: "map_Kd".to_owned(),
                options: if *is_clamped { "-clamp on ".to_owned() } else { String::new() },
                name: file,
                place: about.statements.len(),
                image: image.map(std::sync::Arc::new),
            });
        }
        self.mesh.materials.push(about);
        self.materials.insert(key, number as u32);
        number as u32
    }

    fn finish(self) -> Result<(TriMesh, Vec<Warning>), ReadError> {
        let mut mesh = self.mesh;
        let layer =
            |name, values, index, is_of_faces| CornerLayer { name, values, index, is_of_faces };
        let texcoords = LayerValues::Vec2(self.texcoords.values);
        let colors = LayerValues::Vec3(self.colors.values);
        mesh.corner_layers = vec![
            layer(Layer::TEXCOORD, texcoords, self.texcoords.index, false),
            layer(Layer::NORMAL, LayerValues::Vec3(self.normals.values), self.normals.index, false),
            layer(Layer::COLOR, colors, self.colors.index, !self.has_corner_colors),
        ];
        mesh.finish(self.control.part(0.8, 1.0))
    }
}

/// Corners that are counted, as a list with -1 behind each polygon. A count of -1 takes all points
/// that are left, and one that goes beyond them is left out.
fn listed(first: usize, counts: &[i32], n_points: usize) -> Vec<i32> {
    let mut list = Vec::new();
    let mut next = first.min(n_points);
    for &count in counts {
        let n = usize::try_from(count).unwrap_or(n_points - next).min(n_points - next);
        list.extend((next..next + n).map(|point| point as i32));
        list.push(-1);
        next += n;
    }
    list
}
