//! The materials of a glTF file as materials of a mesh.
//!
//! What MTL files have a word for stands under that word (`Kd`, `d`, `Ke`), with the words for
//! roughness and metal that many programs have added (`Pr`, `Pm`). Two pictures have no word there
//! and get one: [`METALLIC_ROUGHNESS`] and [`OCCLUSION`].

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use glam::{DVec2, DVec3};
use mve_mesh::data::{Material, Texture, TextureImage, TextureRole, name_from_bytes, shown_name};

use super::buffers::Buffers;
use super::container::Uri;
use super::document::{self, Document, TextureInfo, TextureTransform, Whole};
use super::transfer::display;
use crate::obj::textures::Pictures;
use crate::warnings::Warnings;

/// The keyword of a picture with roughness in green and metal in blue.
pub(super) const METALLIC_ROUGHNESS: &str = "map_MetallicRoughness";
/// The keyword of a picture that has in red how much light from around arrives.
pub(super) const OCCLUSION: &str = "map_Occlusion";
/// The option of a texture that is not repeated.
pub(super) const CLAMPED: &str = "-clamp on ";
/// The number of OpenGL for the same.
pub(super) const CLAMP_TO_EDGE: usize = 33_071;

/// The materials of a file.
pub(super) struct Materials {
    /// Those that say something.
    pub list: Vec<Material>,
    /// For each of the file, which of them it is.
    pub of_file: Vec<Option<u32>>,
    /// For each of the file, how its pictures lie.
    pub layouts: Vec<Layout>,
}

/// Which texture coordinates a material uses.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Layout {
    pub set: usize,
    pub transform: Option<TextureTransform>,
}

impl Layout {
    fn of(info: &TextureInfo) -> Self {
        let transform = info.extensions.transform;
        let set = transform.and_then(|transform| transform.tex_coord).unwrap_or(info.tex_coord).0;
        let is_none = |transform: &TextureTransform| {
            TextureTransform { tex_coord: None, ..*transform } == TextureTransform::default()
        };
        Self { set, transform: transform.filter(|transform| !is_none(transform)) }
    }

    /// Texture coordinates from the lower left, of those of the file, which are from the upper
    /// left.
    ///
    /// A turn is counter-clockwise as a person sees it, so against the sense that its sign has with
    /// the second coordinate pointing down (KHR_texture_transform, Khronos Group, 2018).
    pub fn place(&self, [u, v]: [f64; 2]) -> DVec2 {
        let uv = match &self.transform {
            None => DVec2::new(u, v),
            Some(TextureTransform { offset, rotation, scale, .. }) => {
                let (u, v) = (u * scale[0], v * scale[1]);
                let (sin, cos) = rotation.sin_cos();
                DVec2::new(cos * u + sin * v, cos * v - sin * u) + DVec2::from(*offset)
            }
        };
        DVec2::new(uv.x, 1.0 - uv.y)
    }
}

/// Reads the materials, and the pictures that are in the file.
pub(super) fn read(
    buffers: &Buffers,
    pictures: &mut Pictures,
    warnings: &mut Warnings,
) -> Materials {
    let mut reader = Reader { buffers, pictures, warnings, known: HashMap::new() };
    let mut all = Materials { list: Vec::new(), of_file: Vec::new(), layouts: Vec::new() };
    let mut taken = HashSet::new();
    for (number, material) in buffers.document.materials.iter().enumerate() {
        let (statements, layout) = (statements(material), layout(material, reader.warnings));
        let textures = reader.textures(material, statements.len());
        all.layouts.push(layout);
        // What a writer puts where a face has no material.
        if material.name.is_none() && statements.is_empty() && textures.is_empty() {
            all.of_file.push(None);
            continue;
        }
        let name = material.name.clone().unwrap_or_else(|| format!("material{number}"));
        let name = free_name(&name, &mut taken);
        all.of_file.push(Some(all.list.len() as u32));
        all.list.push(Material { name, statements, textures });
    }
    all
}

fn free_name(name: &str, taken: &mut HashSet<String>) -> String {
    let mut free = name_from_bytes(name.as_bytes());
    let mut number = 2;
    while !taken.insert(free.clone()) {
        free = format!("{name}-{number}");
        number += 1;
    }
    free
}

fn statements(material: &document::Material) -> Vec<(String, String)> {
    let mut all = Vec::new();
    let mut add = |keyword: &str, text: String| all.push((keyword.to_owned(), text));
    let color = |color: DVec3| {
        let DVec3 { x, y, z } = display(color);
        format!("{x} {y} {z}")
    };
    let surface = &material.pbr_metallic_roughness;
    if let Some([red, green, blue, alpha]) = surface.base_color_factor {
        add("Kd", color(DVec3::new(red, green, blue)));
        if alpha != 1.0 {
            add("d", alpha.to_string());
        }
    }
    // What is not said is 1 in glTF, and no metal in MTL.
    let is_said = surface.base_color_factor.is_some() || surface.base_color_texture.is_some();
    let metallic = surface.metallic_factor.or(is_said.then_some(1.0));
    if let Some(metallic) = metallic.filter(|metallic| *metallic != 0.0) {
        add("Pm", metallic.to_string());
    }
    if let Some(roughness) = surface.roughness_factor.filter(|roughness| *roughness != 1.0) {
        add("Pr", roughness.to_string());
    }
    if material.emissive_factor != [0.0; 3] {
        add("Ke", color(DVec3::from(material.emissive_factor)));
    }
    all
}

/// The textures of a material, with what each is for and its keyword.
fn infos(
    material: &document::Material,
) -> impl Iterator<Item = (&TextureInfo, TextureRole, &'static str)> {
    let surface = &material.pbr_metallic_roughness;
    [
        (&surface.base_color_texture, TextureRole::BaseColor, "map_Kd"),
        (&surface.metallic_roughness_texture, TextureRole::Other, METALLIC_ROUGHNESS),
        (&material.normal_texture, TextureRole::Normal, "norm"),
        (&material.occlusion_texture, TextureRole::Other, OCCLUSION),
        (&material.emissive_texture, TextureRole::Emission, "map_Ke"),
    ]
    .into_iter()
    .filter_map(|(info, role, keyword)| Some((info.as_ref()?, role, keyword)))
}

/// How the first of the material's pictures lies, which is that of its base color if it has one.
fn layout(material: &document::Material, warnings: &mut Warnings) -> Layout {
    let mut layouts = infos(material).map(|(info, ..)| Layout::of(info));
    let first = layouts.next().unwrap_or_default();
    if layouts.any(|other| other != first) {
        warnings.add_once(
            "pictures of a material lie in different ways; all are laid as that of its base color"
                .to_owned(),
        );
    }
    first
}

/// A picture of a file: its name, and the picture unless it is in another file.
type Found = Result<(String, Option<Arc<TextureImage>>), String>;

struct Reader<'a, 'b> {
    buffers: &'a Buffers<'a>,
    pictures: &'b mut Pictures,
    warnings: &'b mut Warnings,
    known: HashMap<usize, Found>,
}

impl Reader<'_, '_> {
    fn textures(&mut self, material: &document::Material, place: usize) -> Vec<Texture> {
        let mut textures = Vec::new();
        for (info, role, keyword) in infos(material) {
            match self.texture(info) {
                Err(why) => self.warnings.add_once(why),
                Ok((name, image, options)) => textures.push(Texture {
                    role,
                    keyword: keyword.to_owned(),
                    options: options.to_owned(),
                    name,
                    place,
                    image,
                }),
            }
        }
        textures
    }

    /// Name, picture and options of a texture.
    fn texture(
        &mut self,
        info: &TextureInfo,
    ) -> Result<(String, Option<Arc<TextureImage>>, &'static str), String> {
        let document = self.buffers.document;
        let number = info.index.0;
        let texture = document.textures.get(number);
        let texture = texture.ok_or_else(|| format!("texture {number} is not there"))?;
        let others = texture.extensions.values().filter_map(|other| other.source);
        let source = texture.source.into_iter().chain(others).next();
        let source = source.ok_or_else(|| format!("texture {number} has no picture"))?;
        let sampler = texture.sampler.and_then(|sampler| document.samplers.get(sampler.0));
        let is_clamped = sampler.is_some_and(|sampler| {
            [sampler.wrap_s, sampler.wrap_t].iter().all(|wrap| *wrap == Some(Whole(CLAMP_TO_EDGE)))
        });
        let found = match self.known.get(&source.0) {
            Some(found) => found.clone(),
            None => {
                let found = self.picture(document, source.0);
                self.known.insert(source.0, found.clone());
                found
            }
        };
        let (name, image) = found?;
        Ok((name, image, if is_clamped { CLAMPED } else { "" }))
    }

    fn picture(&mut self, document: &Document, number: usize) -> Found {
        let image = document.images.get(number);
        let image = image.ok_or_else(|| format!("picture {number} is not there"))?;
        let bytes = match (&image.uri, image.buffer_view) {
            (Some(uri), _) => {
                match Uri::parse(uri).map_err(|why| format!("picture {number} {why}"))? {
                    Uri::File(name) => return Ok((name, None)),
                    Uri::Data(bytes) => bytes,
                }
            }
            (None, Some(view)) => {
                let view = self.buffers.view(view);
                view.map_err(|why| format!("picture {number}: {why}"))?.1.to_vec()
            }
            (None, None) => return Err(format!("picture {number} has no bytes")),
        };
        let ending = match bytes.as_slice() {
            [0x89, b'P', b'N', b'G', ..] => ".png",
            [0xff, 0xd8, ..] => ".jpg",
            _ => "",
        };
        let name = image.name.as_deref().filter(|name| !name.is_empty());
        let name = name.map_or_else(|| format!("texture{number}"), str::to_owned);
        let name = name.rsplit(['/', '\\']).next().unwrap_or_default();
        let has_ending = name.rsplit_once('.').is_some_and(|(_, end)| (3..=4).contains(&end.len()));
        let name = format!("{name}{}", if has_ending { "" } else { ending });
        let name = name_from_bytes(name.as_bytes());
        let (picture, fault) = self
            .pictures
            .decode(bytes)
            .map_err(|why| format!("texture {} {why}", shown_name(&name)))?;
        if let Some(fault) = fault {
            let shown = shown_name(&name);
            self.warnings.add_once(format!("texture {shown} {fault}; it is kept as it is"));
        }
        Ok((name, Some(picture)))
    }
}
