//! How costs, placements and observers name attribute values: layers, their roles, wedges.
//!
//! A layer over vertices has one value a vertex, a layer over corners one a *wedge*: the corners of
//! a vertex with equal values (H. Hoppe, "Efficient implementation of progressive meshes",
//! Computers & Graphics 22, 1998).

use glam::DVec3;

use mve_mesh::data::{Layer, LayerValues};

/// What the values of a layer mean, which says how they mix and what its seams are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Texture coordinates: [`Layer::TEXCOORD`] of two numbers.
    TexCoord,
    /// Unit normals: [`Layer::NORMAL`] of three numbers.
    Normal,
    /// Colors: [`Layer::COLOR`] of three numbers.
    Color,
    /// Names, which do not mix.
    Label,
    /// Any other numbers.
    Other,
}

impl Role {
    /// The role of a layer.
    pub fn of(layer: &Layer) -> Self {
        match (&layer.values, layer.name.as_str()) {
            (LayerValues::Label(_), _) => Self::Label,
            (LayerValues::Vec2(_), Layer::TEXCOORD) => Self::TexCoord,
            (LayerValues::Vec3(_), Layer::NORMAL) => Self::Normal,
            (LayerValues::Vec3(_), Layer::COLOR) => Self::Color,
            _ => Self::Other,
        }
    }
}

/// The number of a layer in the input's list of layers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LayerId(pub u32);

/// A value that vertices or corners of one layer share: over corners, a wedge. Ids stay the same
/// throughout a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct WedgeId(pub u32);

/// The value that one wedge gets by a collapse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AttributeValue {
    /// The layer.
    pub layer: LayerId,
    /// The wedge of the vertex that stays, which takes the value.
    pub wedge: WedgeId,
    /// The value; numbers beyond those of the layer are 0.
    pub value: DVec3,
}

#[cfg(test)]
mod tests {
    use mve_mesh::data::Domain;

    use super::*;

    #[test]
    fn roles_come_from_names_and_need_their_kind_of_value() {
        let role = |name: &str, values| {
            Role::of(&Layer { name: name.into(), domain: Domain::Corner, values, index: vec![] })
        };
        let (two, three) = (LayerValues::Vec2(vec![]), LayerValues::Vec3(vec![]));
        assert_eq!(role(Layer::TEXCOORD, two.clone()), Role::TexCoord);
        assert_eq!(role("lightmap", two.clone()), Role::Other);
        assert_eq!(role(Layer::NORMAL, three.clone()), Role::Normal);
        assert_eq!(role(Layer::NORMAL, two), Role::Other);
        assert_eq!(role(Layer::COLOR, three), Role::Color);
        assert_eq!(role(Layer::TEXCOORD, LayerValues::Label(vec![])), Role::Label);
    }
}
