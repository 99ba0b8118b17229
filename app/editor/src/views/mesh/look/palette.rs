//! Colors for names: materials, groups, objects.

use mve_modules::data::{Layer, LayerValues, TriMesh};

/// Twelve colors that can be told apart and are about equally light, after "Set3" of C. Brewer and
/// M. Harrower, ColorBrewer, 2003; its two palest are darker here, so that they stand out.
const PALETTE: [[u8; 3]; 12] = [
    [127, 177, 211],
    [253, 180, 98],
    [141, 211, 199],
    [251, 128, 114],
    [190, 186, 218],
    [179, 222, 105],
    [252, 205, 229],
    [204, 190, 140],
    [188, 128, 189],
    [160, 205, 160],
    [255, 237, 111],
    [170, 170, 175],
];

/// The layers of names of a mesh.
pub fn label_layers(mesh: &TriMesh) -> impl Iterator<Item = &Layer> {
    mesh.layers.iter().filter(|layer| matches!(layer.values, LayerValues::Label(_)))
}

/// A color for each name of a layer: the diffuse one of a material where it states one, else the
/// next of the palette.
pub fn colors_of_labels(mesh: &TriMesh, layer: &Layer) -> Vec<[u8; 3]> {
    let LayerValues::Label(names) = &layer.values else { return Vec::new() };
    let color = |(at, name): (usize, &String)| {
        let stated = (layer.name == Layer::MATERIAL).then(|| diffuse_of(mesh, name)).flatten();
        stated.unwrap_or(PALETTE[at % PALETTE.len()])
    };
    names.iter().enumerate().map(color).collect()
}

/// The diffuse color that a material states.
pub fn diffuse_of(mesh: &TriMesh, name: &str) -> Option<[u8; 3]> {
    let material = mesh.materials.iter().find(|material| material.name == name)?;
    material.diffuse().map(mve_modules::data::bytes_of)
}

#[cfg(test)]
mod tests {
    use mve_modules::data::{Domain, Material};

    use super::*;

    #[test]
    fn a_material_has_the_color_that_it_states() {
        let layer = Layer {
            name: Layer::MATERIAL.to_owned(),
            domain: Domain::Face,
            values: LayerValues::Label(vec!["red".to_owned(), "spectral".to_owned()]),
            index: Vec::new(),
        };
        let material = |name: &str, kd: &str| Material {
            name: name.to_owned(),
            statements: vec![("Kd".to_owned(), kd.to_owned())],
            textures: Vec::new(),
        };
        let materials = vec![material("red", "1 0 0.2"), material("spectral", "spectral a.rfl")];
        let mesh = TriMesh { materials, ..TriMesh::default() };
        assert_eq!(colors_of_labels(&mesh, &layer), [[255, 0, 51], PALETTE[1]]);
    }
}
