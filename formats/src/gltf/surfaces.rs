//! The materials of a mesh as those of a glTF file.

use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::Arc;

use glam::DVec3;
use mve_core::Control;
use mve_mesh::data::{
    FaceMaterials, Layer, LayerValues, Material, NO_VALUE, Texture, TextureImage, TextureRole,
    TriMesh, shown_name,
};
use serde_json::{Value as Json, json};

use super::materials::{CLAMP_TO_EDGE, CLAMPED, METALLIC_ROUGHNESS, OCCLUSION};
use super::transfer::light;
use crate::png::write_png;

/// Statements of MTL that have a place.
const KNOWN: [&str; 5] = ["Kd", "d", "Pm", "Pr", "Ke"];

/// Materials, and the pictures that they name.
pub(super) struct Surfaces<'a> {
    /// For each name of the layer of materials: the name, and the material if the mesh has it.
    labels: Vec<(&'a str, Option<&'a Material>)>,
    /// Whether a face has none.
    has_none: bool,
    /// Name, kind and bytes of each picture.
    pub pictures: Vec<(String, &'static str, Cow<'a, [u8]>)>,
    pub samplers: Vec<Json>,
    pub textures: Vec<Json>,
    /// The texture of a picture that is clamped or not.
    known: HashMap<(*const TextureImage, bool), usize>,
}

impl<'a> Surfaces<'a> {
    pub fn of(mesh: &'a TriMesh, warnings: &mut Vec<String>) -> Self {
        let materials = FaceMaterials::of(mesh);
        let labels: &[String] = match mesh.layer(Layer::MATERIAL) {
            Some(Layer { values: LayerValues::Label(labels), .. }) => labels,
            _ => &[],
        };
        let n_known = materials.of_labels.len();
        let has_none = materials.of_faces.iter().any(|at| *at as usize >= n_known);
        let has_none = has_none || materials.of_faces.len() < mesh.faces.len();
        let labels = labels.iter().map(String::as_str).zip(materials.of_labels).collect();
        let mut all = Self {
            labels,
            has_none,
            pictures: Vec::new(),
            samplers: vec![json!({ "wrapS": 10_497, "wrapT": 10_497 })],
            textures: Vec::new(),
            known: HashMap::new(),
        };
        all.add_pictures(warnings);
        all
    }

    fn add_pictures(&mut self, warnings: &mut Vec<String>) {
        let mut left_out: Vec<&str> = Vec::new();
        let mut places: HashMap<*const TextureImage, usize> = HashMap::new();
        for material in self.labels.iter().filter_map(|(_, material)| *material) {
            let statements = material.statements.iter().map(|(keyword, _)| keyword.as_str());
            left_out.extend(statements.filter(|keyword| !KNOWN.contains(keyword)));
            for texture in &material.textures {
                if slot(texture).is_none() {
                    left_out.push(&texture.keyword);
                    continue;
                }
                let Some(image) = &texture.image else {
                    let name = shown_name(&texture.name);
                    warnings.push(format!("texture {name} was not read and is left out"));
                    continue;
                };
                let source = match places.get(&Arc::as_ptr(image)) {
                    Some(source) => *source,
                    None => {
                        let Some((mime_type, bytes)) = encoded(image) else {
                            let name = shown_name(&texture.name);
                            warnings.push(format!(
                                "texture {name} is neither a PNG nor a JPEG file and is left out"
                            ));
                            continue;
                        };
                        self.pictures.push((shown_name(&texture.name), mime_type, bytes));
                        places.insert(Arc::as_ptr(image), self.pictures.len() - 1);
                        self.pictures.len() - 1
                    }
                };
                let is_clamped = texture.options.contains(CLAMPED.trim_end());
                if is_clamped && self.samplers.len() == 1 {
                    let clamped = json!({ "wrapS": CLAMP_TO_EDGE, "wrapT": CLAMP_TO_EDGE });
                    self.samplers.push(clamped);
                }
                self.known.entry((Arc::as_ptr(image), is_clamped)).or_insert_with(|| {
                    let sampler = usize::from(is_clamped);
                    self.textures.push(json!({ "source": source, "sampler": sampler }));
                    self.textures.len() - 1
                });
            }
        }
        left_out.sort_unstable();
        left_out.dedup();
        if !left_out.is_empty() {
            let words = left_out.join(", ");
            warnings.push(format!("of materials there is no place for {words}"));
        }
    }

    /// The number of the material with this number in the layer.
    pub fn number(&self, label: u32) -> usize {
        if label == NO_VALUE { self.labels.len() } else { (label as usize).min(self.labels.len()) }
    }

    /// The materials; that of faces without one is the last.
    pub fn materials(&self, has_pictures: bool) -> Vec<Json> {
        let of = |(name, material): &(&str, Option<&Material>)| {
            let mut json = json!({ "name": shown_name(name), "doubleSided": true });
            json["pbrMetallicRoughness"] = json!({ "metallicFactor": 0 });
            if let Some(material) = material {
                self.fill(&mut json, material, has_pictures);
            }
            json
        };
        let mut all: Vec<Json> = self.labels.iter().map(of).collect();
        if self.has_none {
            let surface = json!({ "metallicFactor": 0 });
            all.push(json!({ "doubleSided": true, "pbrMetallicRoughness": surface }));
        }
        all
    }

    fn fill(&self, json: &mut Json, material: &Material, has_pictures: bool) {
        let text = |keyword: &str| {
            material.statements.iter().find(|(known, _)| known == keyword).map(|(_, text)| text)
        };
        let number = |keyword: &str| {
            let number: f64 = text(keyword)?.split_whitespace().next()?.parse().ok()?;
            number.is_finite().then(|| number.clamp(0.0, 1.0))
        };
        if let Some(color) = material.diffuse() {
            let DVec3 { x, y, z } = light(color);
            let alpha = number("d").unwrap_or(1.0);
            json["pbrMetallicRoughness"]["baseColorFactor"] = json!([x, y, z, alpha]);
            if alpha < 1.0 {
                json["alphaMode"] = "BLEND".into();
            }
        }
        for (keyword, field) in [("Pm", "metallicFactor"), ("Pr", "roughnessFactor")] {
            if let Some(number) = number(keyword) {
                json["pbrMetallicRoughness"][field] = number.into();
            }
        }
        let emission = text("Ke").and_then(|text| {
            let mut numbers = text.split_whitespace().map_while(|word| word.parse::<f64>().ok());
            let color = DVec3::new(numbers.next()?, numbers.next()?, numbers.next()?);
            color.is_finite().then(|| light(color.clamp(DVec3::ZERO, DVec3::ONE)))
        });
        if let Some(emission) = emission.filter(|color| *color != DVec3::ZERO) {
            json["emissiveFactor"] = json!(emission.to_array());
        }
        for texture in material.textures.iter().filter(|_| has_pictures) {
            let Some((is_of_surface, field)) = slot(texture) else { continue };
            let is_clamped = texture.options.contains(CLAMPED.trim_end());
            let image = texture.image.as_ref().map(Arc::as_ptr);
            let index = image.and_then(|image| self.known.get(&(image, is_clamped)));
            let Some(index) = index else { continue };
            let parent = if is_of_surface { &mut json["pbrMetallicRoughness"] } else { &mut *json };
            // The first of a kind counts.
            if parent[field].is_null() {
                parent[field] = json!({ "index": index });
            }
            if field == "emissiveTexture" && emission.is_none() {
                json["emissiveFactor"] = json!([1.0, 1.0, 1.0]);
            }
        }
    }
}

/// Where a material has the texture: whether in what it says of the surface, and the field.
fn slot(texture: &Texture) -> Option<(bool, &'static str)> {
    match texture.role {
        TextureRole::BaseColor => Some((true, "baseColorTexture")),
        TextureRole::Normal => Some((false, "normalTexture")),
        TextureRole::Emission => Some((false, "emissiveTexture")),
        TextureRole::Other if texture.keyword == METALLIC_ROUGHNESS => {
            Some((true, "metallicRoughnessTexture"))
        }
        TextureRole::Other if texture.keyword == OCCLUSION => Some((false, "occlusionTexture")),
        _ => None,
    }
}

/// The kind and the bytes of a picture's file, as one of the two kinds that the format has.
fn encoded(image: &TextureImage) -> Option<(&'static str, Cow<'_, [u8]>)> {
    match image.encoded() {
        Some(bytes) if bytes.starts_with(b"\x89PNG") => Some(("image/png", without_colors(bytes))),
        Some(bytes) if bytes.starts_with(b"\xff\xd8") => Some(("image/jpeg", bytes.into())),
        _ => {
            let mut bytes = Vec::new();
            write_png(image.pixels()?, &mut bytes, Control::none()).ok()?;
            Some(("image/png", bytes.into()))
        }
    }
}

/// A PNG file without what it says of color spaces, sizes of pixels and motion: the format takes
/// all pictures of colors for sRGB, and its validator warns of files that say anything else. The
/// pixels stay as they are.
fn without_colors(bytes: &[u8]) -> Cow<'_, [u8]> {
    const UNWANTED: [&[u8; 4]; 8] =
        [b"cHRM", b"gAMA", b"iCCP", b"sRGB", b"pHYs", b"acTL", b"fcTL", b"fdAT"];
    let (Some(head), mut rest) = (bytes.get(..8), bytes.get(8..).unwrap_or_default()) else {
        return bytes.into();
    };
    let mut kept = head.to_vec();
    while let Some((length, kind)) =
        rest.first_chunk::<4>().zip(rest.get(4..).and_then(|rest| rest.first_chunk::<4>()))
    {
        // Length, kind, content and a check sum.
        let n = (u32::from_be_bytes(*length) as usize).saturating_add(12);
        let Some((chunk, behind)) = rest.split_at_checked(n) else { break };
        if !UNWANTED.contains(&kind) {
            kept.extend(chunk);
        }
        rest = behind;
    }
    kept.extend(rest);
    if kept.len() == bytes.len() { bytes.into() } else { kept.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_picture_says_of_its_colors_is_left_out_and_its_pixels_stay() {
        let image = mve_mesh::data::Image::filled("a", [3, 2], mve_mesh::data::PixelKind::Rgb, 77);
        let mut plain = Vec::new();
        write_png(&image, &mut plain, Control::none()).unwrap();
        assert_eq!(*without_colors(&plain), plain);
        // Behind the head of 8 bytes and the first chunk of 25: a gamma of 1/2.2.
        let gamma = [&[0, 0, 0, 4][..], b"gAMA", &[0, 0, 0xb1, 0x8f, 0x0b, 0xfc, 0x61, 0x05]];
        let colored = [&plain[..33], &gamma.concat(), &plain[33..]].concat();
        assert_eq!(*without_colors(&colored), plain);
        for n in 0..colored.len() {
            without_colors(&colored[..n]);
        }
    }
}
