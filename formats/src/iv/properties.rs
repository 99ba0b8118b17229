//! Nodes of an Open Inventor file that have fields and no nodes in them.

use glam::{DMat4, DQuat, DVec3};
use mve_mesh::data::{Material, name_from_bytes};

use super::node::Node;
use super::values::Values;
use crate::ReadError;

/// A material, or colors alone.
pub(super) fn material(values: &mut Values) -> Result<Node, ReadError> {
    let (mut about, mut colors) = (Material::default(), Vec::new());
    values.fields(|me, field| {
        let keyword = match field {
            b"diffuseColor" | b"rgb" => "Kd",
            b"ambientColor" => "Ka",
            b"specularColor" => "Ks",
            b"emissiveColor" => "Ke",
            b"shininess" => "Ns",
            b"transparency" => "d",
            // Version 2.0 has red in the lowest byte, 2.1 in the highest.
            b"orderedRGBA" | b"rgba" => {
                colors = me.packed_colors(field == b"orderedRGBA")?;
                return Ok(true);
            }
            _ => return Ok(false),
        };
        let text = match keyword {
            "Ns" | "d" => {
                let mut found = Vec::new();
                me.vectors_of::<1>(field, field, &mut found)?;
                // Sharpness is a part of 128 there, and opacity what is left of 1.
                let value = found.first().map_or(0.2, |[value]| *value);
                let value = if keyword == "Ns" { 128.0 * value } else { 1.0 - value };
                value.to_string()
            }
            _ => {
                let mut found = Vec::new();
                me.vectors_of::<3>(field, field, &mut found)?;
                let [x, y, z] = found.first().copied().unwrap_or([0.8; 3]);
                if keyword == "Kd" {
                    colors = found.into_iter().map(DVec3::from).collect();
                }
                format!("{x} {y} {z}")
            }
        };
        about.statements.push((keyword.to_owned(), text));
        Ok(true)
    })?;
    Ok(Node::Material { about, colors })
}

/// A picture on what comes behind it.
pub(super) fn texture(values: &mut Values) -> Result<Node, ReadError> {
    let (mut name, mut image, mut n_clamped) = (String::new(), None, 0);
    values.fields(|me, field| {
        match field {
            b"filename" => name = name_from_bytes(&me.lexer.text()?),
            b"image" => image = me.image()?,
            b"wrapS" | b"wrapT" => n_clamped += usize::from(me.word("CLAMP")? == b"CLAMP"),
            _ => return Ok(false),
        }
        Ok(true)
    })?;
    Ok(Node::Texture { name, image, is_clamped: n_clamped == 2 })
}

/// A move of what comes behind it.
pub(super) fn transform(values: &mut Values) -> Result<Node, ReadError> {
    let (mut translation, mut scale, mut center) = (DVec3::ZERO, DVec3::ONE, DVec3::ZERO);
    let (mut turn, mut scale_turn) = (DQuat::IDENTITY, DQuat::IDENTITY);
    let (mut matrix, mut axis, mut angle) = (None, DVec3::X, None);
    values.fields(|me, field| {
        match field {
            b"translation" => translation = me.vector()?.into(),
            b"scaleFactor" => scale = me.vector()?.into(),
            b"center" => center = me.vector()?.into(),
            b"rotation" => turn = quaternion(me.vector()?),
            b"scaleOrientation" => scale_turn = quaternion(me.vector()?),
            b"matrix" => matrix = Some(me.vector::<16>()?),
            b"angle" => angle = Some(me.lexer.number()?),
            b"axis" => {
                axis = match me.word("X, Y or Z")? {
                    b"Y" => DVec3::Y,
                    b"Z" => DVec3::Z,
                    _ => DVec3::X,
                }
            }
            _ => return Ok(false),
        }
        Ok(true)
    })?;
    if let Some(matrix) = matrix {
        // Points are rows there, so rows are the columns here.
        return Ok(Node::Transform(DMat4::from_cols_array(&matrix)));
    }
    if let Some(angle) = angle {
        turn = DQuat::from_axis_angle(axis, angle);
    }
    let scaled = DMat4::from_quat(scale_turn)
        * DMat4::from_scale(scale)
        * DMat4::from_quat(scale_turn.inverse());
    let about_center = DMat4::from_translation(translation + center)
        * DMat4::from_quat(turn)
        * scaled
        * DMat4::from_translation(-center);
    Ok(Node::Transform(about_center))
}

/// Which way round faces are.
pub(super) fn shape_hints(values: &mut Values) -> Result<Node, ReadError> {
    let mut is_clockwise = false;
    values.fields(|me, field| {
        if field == b"vertexOrdering" {
            is_clockwise = me.word("an order of vertices")? == b"CLOCKWISE";
            return Ok(true);
        }
        Ok(false)
    })?;
    Ok(Node::Order { is_clockwise })
}

/// A turn around an axis of any length, by an angle in radians.
fn quaternion([x, y, z, angle]: [f64; 4]) -> DQuat {
    match DVec3::new(x, y, z).try_normalize() {
        Some(axis) => DQuat::from_axis_angle(axis, angle),
        None => DQuat::IDENTITY,
    }
}
