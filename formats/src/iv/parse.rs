//! From the text of an Open Inventor file to its nodes.

use std::collections::HashMap;

use glam::{DVec2, DVec3};
use mve_core::Control;
use mve_mesh::data::{Material, name_from_bytes};

use super::lexer::Lexer;
use super::node::{Corners, Node, NodeId, Scope, Shape, ShapeKind};
use super::properties;
use super::values::{Known, Values};
use crate::ReadError;
use crate::obj::cursor::quoted;
use crate::warnings::Warnings;

/// Nodes in nodes.
const DEEPEST: usize = 250;
/// Names of nodes that are left out which a warning lists.
const MOST_NAMES: usize = 12;

/// The nodes of a file.
#[derive(Default)]
pub(super) struct Scene {
    pub nodes: Vec<Node>,
    /// Names that files gave to nodes.
    pub names: HashMap<NodeId, String>,
    /// Those that are in no other.
    pub roots: Vec<NodeId>,
}

/// Reads the nodes behind the first line.
pub(super) fn parse(
    bytes: &[u8],
    warnings: &mut Warnings,
    control: Control,
) -> Result<Scene, ReadError> {
    let mut parser = Parser {
        values: Values { lexer: Lexer::new(bytes), control },
        scene: Scene::default(),
        defined: HashMap::new(),
        unknown: Vec::new(),
    };
    while parser.values.lexer.peek().is_some() {
        let root = parser.node(0)?;
        parser.scene.roots.extend(root);
    }
    let Parser { scene, mut unknown, .. } = parser;
    unknown.truncate(MOST_NAMES);
    if !unknown.is_empty() {
        warnings.add_general(format!("nodes of these kinds are left out: {}", unknown.join(", ")));
    }
    Ok(scene)
}

struct Parser<'a> {
    values: Values<'a>,
    scene: Scene,
    /// The node that a name stands for last.
    defined: HashMap<&'a [u8], NodeId>,
    /// Kinds of nodes that are left out.
    unknown: Vec<String>,
}

impl<'a> Parser<'a> {
    fn push(&mut self, node: Node) -> NodeId {
        self.scene.nodes.push(node);
        self.scene.nodes.len() - 1
    }

    /// The next node; `None` for one that stands for nothing.
    fn node(&mut self, depth: usize) -> Result<Option<NodeId>, ReadError> {
        if depth > DEEPEST {
            let line = self.values.lexer.line();
            let message = format!("line {line}: more than {DEEPEST} nodes in each other");
            return Err(ReadError::Wrong(message));
        }
        self.values.control.at(self.values.lexer.fraction())?;
        let mut kind = self.values.word("a node")?;
        if kind == b"USE" {
            let name = self.values.word("the name of a node")?;
            let node = self.defined.get(name).copied();
            let line = self.values.lexer.line();
            let wrong = || {
                let name = quoted(name);
                ReadError::Wrong(format!("line {line}: USE {name}, but no DEF before it"))
            };
            return Ok(Some(node.ok_or_else(wrong)?));
        }
        let mut name = None;
        if kind == b"DEF" {
            name = Some(self.values.word("the name of a node")?);
            kind = self.values.word("a node")?;
        }
        if !self.values.lexer.take_mark(b'{') {
            return Err(self.values.lexer.wrong("`{`"));
        }
        let node = self.body(kind, depth)?;
        let id = self.push(node);
        if let Some(name) = name {
            // A node is known once it is whole, so none is in itself.
            self.defined.insert(name, id);
            self.scene.names.insert(id, name_from_bytes(name));
        }
        Ok(Some(id))
    }

    /// What is in the braces of a node of this kind, the second of which is taken.
    fn body(&mut self, kind: &[u8], depth: usize) -> Result<Node, ReadError> {
        match kind {
            b"Separator" | b"Annotation" | b"Selection" | b"WWWAnchor" | b"Anchor" => {
                self.group(Scope::All, depth)
            }
            b"TransformSeparator" => self.group(Scope::Transform, depth),
            b"Group" => self.group(Scope::Open, depth),
            b"Switch" => self.switch(depth),
            b"LOD" | b"LevelOfDetail" => {
                // The first child is the finest.
                let Node::Group { mut children, .. } = self.group(Scope::All, depth)? else {
                    return Ok(Node::Nothing);
                };
                children.truncate(1);
                Ok(Node::Group { scope: Scope::All, children })
            }
            b"Coordinate3" | b"Normal" | b"TextureCoordinate2" => self.vectors(kind),
            b"MaterialBinding" => Ok(Node::MaterialBinding(self.values.binding()?)),
            b"NormalBinding" => Ok(Node::NormalBinding(self.values.binding()?)),
            b"TextureCoordinateBinding" => Ok(Node::TexcoordBinding(self.values.binding()?)),
            b"Material" | b"BaseColor" | b"PackedColor" => properties::material(&mut self.values),
            b"Texture2" => properties::texture(&mut self.values),
            b"Transform" | b"Translation" | b"Rotation" | b"Scale" | b"RotationXYZ"
            | b"MatrixTransform" => properties::transform(&mut self.values),
            b"ResetTransform" => self.skipped(Node::ResetTransform),
            b"ShapeHints" => properties::shape_hints(&mut self.values),
            b"VertexProperty" => self.vertex_property(),
            b"IndexedFaceSet" => self.shape(ShapeKind::Polygons, true, depth),
            b"IndexedTriangleStripSet" => self.shape(ShapeKind::Strips, true, depth),
            b"FaceSet" => self.shape(ShapeKind::Polygons, false, depth),
            b"TriangleStripSet" => self.shape(ShapeKind::Strips, false, depth),
            // They say how a picture is made, not what is in it.
            b"Info"
            | b"Label"
            | b"Environment"
            | b"Complexity"
            | b"DrawStyle"
            | b"LightModel"
            | b"PerspectiveCamera"
            | b"OrthographicCamera"
            | b"DirectionalLight"
            | b"PointLight"
            | b"SpotLight"
            | b"PickStyle"
            | b"Font"
            | b"RenderCaching"
            | b"PolygonOffset" => self.skipped(Node::Nothing),
            other => {
                let name = quoted(other);
                if self.unknown.len() <= MOST_NAMES && !self.unknown.contains(&name) {
                    self.unknown.push(name);
                }
                self.skipped(Node::Nothing)
            }
        }
    }

    /// A node that is a list of vectors.
    fn vectors(&mut self, kind: &[u8]) -> Result<Node, ReadError> {
        if kind == b"TextureCoordinate2" {
            let mut pairs = Vec::new();
            self.values.fields(|me, field| me.vectors_of(field, b"point", &mut pairs))?;
            return Ok(Node::Texcoords(pairs.into_iter().map(DVec2::from).collect()));
        }
        let name: &[u8] = if kind == b"Normal" { b"vector" } else { b"point" };
        let mut vectors = Vec::new();
        self.values.fields(|me, field| me.vectors_of(field, name, &mut vectors))?;
        let vectors = vectors.into_iter().map(DVec3::from).collect();
        Ok(if kind == b"Normal" { Node::Normals(vectors) } else { Node::Points(vectors) })
    }

    fn skipped(&mut self, node: Node) -> Result<Node, ReadError> {
        self.values.lexer.skip_to_end(b'}')?;
        Ok(node)
    }

    fn group(&mut self, scope: Scope, depth: usize) -> Result<Node, ReadError> {
        let mut children = Vec::new();
        self.children(depth, &mut children, &mut |_, _| Ok(false))?;
        Ok(Node::Group { scope, children })
    }

    /// Reads the children of a group, and its fields through a reader.
    fn children(
        &mut self,
        depth: usize,
        children: &mut Vec<NodeId>,
        read: &mut dyn FnMut(&mut Values, &[u8]) -> Known,
    ) -> Result<(), ReadError> {
        while !self.values.lexer.take_mark(b'}') {
            let is_field = match self.values.lexer.look() {
                // Kinds of nodes begin with a capital, fields with a small letter.
                Some([first, ..]) => first.is_ascii_lowercase(),
                _ => false,
            };
            if is_field {
                let field = self.values.word("a field")?;
                if !read(&mut self.values, field)? {
                    self.values.skip_value()?;
                }
                self.values.skip_marks()?;
            } else {
                let child = self.node(depth + 1)?;
                children.extend(child);
            }
        }
        Ok(())
    }

    /// Of its children the one that it names, or all, or none, which is what it says by itself.
    fn switch(&mut self, depth: usize) -> Result<Node, ReadError> {
        let (mut children, mut which) = (Vec::new(), -1);
        self.children(depth, &mut children, &mut |me, field| {
            if field != b"whichChild" {
                return Ok(false);
            }
            which = match me.lexer.look() {
                Some(b"SO_SWITCH_ALL") => -3,
                Some(word) if word.starts_with(b"SO_SWITCH") => -1,
                _ => return me.lexer.whole().map(|number| which = number).map(|()| true),
            };
            me.lexer.next();
            Ok(true)
        })?;
        match usize::try_from(which) {
            Ok(one) => children = children.get(one).copied().into_iter().collect(),
            Err(_) if which == -3 => {}
            Err(_) => children.clear(),
        }
        Ok(Node::Group { scope: Scope::Open, children })
    }

    /// What several nodes say in other files.
    fn vertex_property(&mut self) -> Result<Node, ReadError> {
        let mut found = Vec::new();
        self.values.fields(|me, field| {
            let node = match field {
                b"vertex" | b"normal" => {
                    let mut vectors = Vec::new();
                    me.vectors_of::<3>(field, field, &mut vectors)?;
                    let vectors = vectors.into_iter().map(DVec3::from).collect();
                    if field == b"vertex" { Node::Points(vectors) } else { Node::Normals(vectors) }
                }
                b"texCoord" => {
                    let mut vectors = Vec::new();
                    me.vectors_of::<2>(field, field, &mut vectors)?;
                    Node::Texcoords(vectors.into_iter().map(DVec2::from).collect())
                }
                b"orderedRGBA" => {
                    let colors = me.packed_colors(true)?;
                    Node::Material { about: Material::default(), colors }
                }
                b"materialBinding" => Node::MaterialBinding(me.binding_word()?),
                b"normalBinding" => Node::NormalBinding(me.binding_word()?),
                _ => return Ok(false),
            };
            found.push(node);
            Ok(true)
        })?;
        let children = found.into_iter().map(|node| self.push(node)).collect();
        Ok(Node::Group { scope: Scope::Open, children })
    }

    fn shape(
        &mut self,
        kind: ShapeKind,
        is_indexed: bool,
        depth: usize,
    ) -> Result<Node, ReadError> {
        let (mut index, mut counts, mut first) = (Vec::new(), vec![-1], 0);
        let mut shape = Shape {
            kind,
            corners: Corners::Indexed(Vec::new()),
            material_index: Vec::new(),
            normal_index: Vec::new(),
            texcoord_index: Vec::new(),
            properties: None,
        };
        while !self.values.lexer.take_mark(b'}') {
            let values = &mut self.values;
            match values.word("a field or `}`")? {
                b"coordIndex" => index = values.wholes()?,
                b"numVertices" => counts = values.wholes()?,
                b"startIndex" => first = values.lexer.whole()?,
                b"materialIndex" => shape.material_index = values.wholes()?,
                b"normalIndex" => shape.normal_index = values.wholes()?,
                b"textureCoordIndex" => shape.texcoord_index = values.wholes()?,
                b"vertexProperty" if values.lexer.look() != Some(b"NULL") => {
                    shape.properties = self.node(depth + 1)?;
                }
                _ => values.skip_value()?,
            }
            self.values.skip_marks()?;
        }
        // A list of one -1 is what a field holds that says nothing.
        for list in [&mut shape.material_index, &mut shape.normal_index, &mut shape.texcoord_index]
        {
            if list.as_slice() == [-1] {
                list.clear();
            }
        }
        shape.corners = match is_indexed {
            true => Corners::Indexed(index),
            false => Corners::Counted { first: usize::try_from(first).unwrap_or(0), counts },
        };
        Ok(Node::Shape(shape))
    }
}
