//! What a scene of Open Inventor consists of.

use glam::{DMat4, DVec2, DVec3};

use mve_mesh::data::{Image, Material};

/// The number of a node in its scene.
pub(super) type NodeId = usize;

/// What a group keeps from what comes behind it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scope {
    /// Nothing.
    Open,
    /// How things are moved.
    Transform,
    /// All that its children say.
    All,
}

/// Which of a list of values an element has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Binding {
    /// The first, all of them.
    Overall,
    PerPart,
    PerPartIndexed,
    PerFace,
    PerFaceIndexed,
    PerVertex,
    PerVertexIndexed,
    /// As the kind of value has it.
    Default,
}

impl Binding {
    pub fn named(word: &[u8]) -> Option<Self> {
        Some(match word {
            b"DEFAULT" => Self::Default,
            b"OVERALL" | b"NONE" => Self::Overall,
            b"PER_PART" => Self::PerPart,
            b"PER_PART_INDEXED" => Self::PerPartIndexed,
            b"PER_FACE" => Self::PerFace,
            b"PER_FACE_INDEXED" => Self::PerFaceIndexed,
            b"PER_VERTEX" => Self::PerVertex,
            b"PER_VERTEX_INDEXED" => Self::PerVertexIndexed,
            _ => return None,
        })
    }
}

#[derive(Debug)]
pub(super) enum Node {
    Group {
        scope: Scope,
        children: Vec<NodeId>,
    },
    Points(Vec<DVec3>),
    Normals(Vec<DVec3>),
    Texcoords(Vec<DVec2>),
    /// A material, and the colors of parts where it has several.
    Material {
        about: Material,
        colors: Vec<DVec3>,
    },
    /// A picture: the name of its file, or what it shows; an empty one ends the one before.
    Texture {
        name: String,
        image: Option<Image>,
        is_clamped: bool,
    },
    MaterialBinding(Binding),
    NormalBinding(Binding),
    TexcoordBinding(Binding),
    /// Moves what comes behind it.
    Transform(DMat4),
    /// Takes all moves back.
    ResetTransform,
    /// Whether corners stand clockwise, seen from outside.
    Order {
        is_clockwise: bool,
    },
    Shape(Shape),
    /// Says nothing of surfaces.
    Nothing,
}

/// How corners are put together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ShapeKind {
    Polygons,
    Strips,
}

/// Faces.
#[derive(Debug)]
pub(super) struct Shape {
    pub kind: ShapeKind,
    /// Indices with -1 behind each polygon or strip; or how many corners each has, in the order of
    /// the points from the first on.
    pub corners: Corners,
    pub material_index: Vec<i32>,
    pub normal_index: Vec<i32>,
    pub texcoord_index: Vec<i32>,
    /// What holds for this shape alone.
    pub properties: Option<NodeId>,
}

#[derive(Debug)]
pub(super) enum Corners {
    Indexed(Vec<i32>),
    Counted { first: usize, counts: Vec<i32> },
}
