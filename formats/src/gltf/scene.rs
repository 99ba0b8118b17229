//! Where the meshes of a glTF file stand: nodes in nodes, each with a transform.

use glam::{DMat4, DQuat, DVec3};
use mve_core::Control;

use super::document::{Document, Node, Whole};
use crate::ReadError;
use crate::warnings::Warnings;

/// A mesh that stands somewhere.
pub(super) struct Instance<'a> {
    pub mesh: Whole,
    pub name: Option<&'a str>,
    pub transform: DMat4,
}

/// The meshes of the scene that the file shows first; of all nodes where it has no scene; and all
/// meshes, as they are, where it has no node.
///
/// # Errors
/// Where a node is not there, or is reached twice: that would be a circle or a web, and the
/// standard asks for trees. When `control` says so.
pub(super) fn instances<'a>(
    document: &'a Document,
    warnings: &mut Warnings,
    control: Control,
) -> Result<Vec<Instance<'a>>, ReadError> {
    let nodes = &document.nodes;
    if nodes.is_empty() {
        let all = document.meshes.iter().enumerate().map(|(number, mesh)| Instance {
            mesh: Whole(number),
            name: mesh.name.as_deref(),
            transform: DMat4::IDENTITY,
        });
        return Ok(all.collect());
    }
    let mut found = Vec::new();
    let mut is_reached = vec![false; nodes.len()];
    // The last one is the next: children go on in the order of the file.
    let mut left: Vec<(Whole, DMat4)> =
        roots(document)?.into_iter().rev().map(|node| (node, DMat4::IDENTITY)).collect();
    while let Some((number, around)) = left.pop() {
        control.at(0.0)?;
        let node = nodes.get(number.0);
        let node = node.ok_or_else(|| wrong(number, "is not there"))?;
        if std::mem::replace(&mut is_reached[number.0], true) {
            return Err(wrong(number, "is in the scene twice; nodes must form trees"));
        }
        let transform = around * local(node);
        if let Some(mesh) = node.mesh {
            let mesh_name = document.meshes.get(mesh.0).and_then(|mesh| mesh.name.as_deref());
            let name = node.name.as_deref().or(mesh_name);
            // Where joints move a mesh, its own node does not.
            let transform = if node.skin.is_some() { DMat4::IDENTITY } else { transform };
            found.push(Instance { mesh, name, transform });
        }
        if node.skin.is_some() {
            warnings.add_once("joints are left out: meshes stand as they were bound".to_owned());
        }
        if node.extensions.instancing.is_some() {
            let text = "copies by EXT_mesh_gpu_instancing are left out but for the first";
            warnings.add_once(text.to_owned());
        }
        left.extend(node.children.iter().rev().map(|&child| (child, transform)));
    }
    let n_elsewhere = nodes.iter().zip(&is_reached).filter(|(n, is)| n.mesh.is_some() && !**is);
    let n_elsewhere = n_elsewhere.count();
    if n_elsewhere > 0 {
        warnings.add_general(format!("{n_elsewhere} mesh node(s) of other scenes are left out"));
    }
    Ok(found)
}

fn wrong(number: Whole, what: &str) -> ReadError {
    ReadError::Wrong(format!("node {} {what}", number.0))
}

fn roots(document: &Document) -> Result<Vec<Whole>, ReadError> {
    if document.scenes.is_empty() {
        let mut is_child = vec![false; document.nodes.len()];
        for child in document.nodes.iter().flat_map(|node| &node.children) {
            *is_child.get_mut(child.0).ok_or_else(|| wrong(*child, "is not there"))? = true;
        }
        let all = (0..document.nodes.len()).filter(|&node| !is_child[node]);
        return Ok(all.map(Whole).collect());
    }
    let number = document.scene.unwrap_or_default().0;
    let scene = document.scenes.get(number);
    let scene = scene.ok_or_else(|| ReadError::Wrong(format!("scene {number} is not there")))?;
    Ok(scene.nodes.clone())
}

fn local(node: &Node) -> DMat4 {
    if let Some(matrix) = &node.matrix {
        return DMat4::from_cols_array(matrix);
    }
    let scale = DVec3::from(node.scale.unwrap_or([1.0; 3]));
    let quaternion = DQuat::from_array(node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]));
    let length = quaternion.length();
    // Programs round the length; what has none turns nothing.
    let is_turn = length > 0.0 && length.is_finite();
    let turn = if is_turn { quaternion / length } else { DQuat::IDENTITY };
    DMat4::from_scale_rotation_translation(
        scale,
        turn,
        DVec3::from(node.translation.unwrap_or_default()),
    )
}
