//! Surface materials, with the pictures that they lay on a surface.

use std::sync::Arc;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::Image;

/// A surface material as the MTL format writes it.
///
/// Statements that name no picture are kept as they stand in the file, in order and without their
/// `newmtl` line, so that a material survives a round trip whatever it says.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Material {
    /// The name that faces refer to.
    pub name: String,
    /// `(keyword, arguments)`, such as `("Kd", "0.8 0.8 0.8")`.
    pub statements: Vec<(String, String)>,
    /// The pictures, in the order of the file.
    pub textures: Vec<Texture>,
}

impl Material {
    /// The first texture of this role.
    pub fn texture(&self, role: TextureRole) -> Option<&Texture> {
        self.textures.iter().find(|texture| texture.role == role)
    }

    /// The color of diffuse reflection that it states (`Kd`): red, green and blue, 0 to 1.
    pub fn diffuse(&self) -> Option<DVec3> {
        let (_, text) = self.statements.iter().find(|(keyword, _)| keyword == "Kd")?;
        let mut numbers = text.split_whitespace().map(|word| word.parse::<f64>().ok());
        let [red, green, blue] = [numbers.next()??, numbers.next()??, numbers.next()??];
        let color = DVec3::new(red, green, blue);
        color.is_finite().then(|| color.clamp(DVec3::ZERO, DVec3::ONE))
    }
}

/// What the values of a texture mean for the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum TextureRole {
    /// Color of diffuse reflection, albedo (`map_Kd`).
    BaseColor,
    /// Color under ambient light (`map_Ka`).
    Ambient,
    /// Color of highlights (`map_Ks`).
    Specular,
    /// Sharpness of highlights (`map_Ns`).
    Shininess,
    /// Light that the surface sends out (`map_Ke`).
    Emission,
    /// Opacity (`map_d`, `map_Tr`).
    Opacity,
    /// Roughness (`map_Pr`).
    Roughness,
    /// Whether it is metal (`map_Pm`).
    Metallic,
    /// Sheen of cloth (`map_Ps`).
    Sheen,
    /// Normals in tangent space (`norm`).
    Normal,
    /// Heights that change how light falls (`bump`, `map_Bump`). Many programs write normals here.
    Bump,
    /// Heights that move the surface (`disp`).
    Displacement,
    /// Mask of a second color (`decal`).
    Decal,
    /// Surroundings that are mirrored (`refl`).
    Reflection,
    /// Anything else that begins with `map_`.
    Other,
}

/// A picture that a material names.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Texture {
    /// What it is for.
    pub role: TextureRole,
    /// The keyword as the file writes it.
    pub keyword: String,
    /// What stands before the name, such as `-s 2 2 1 `, with the blanks behind it.
    pub options: String,
    /// Name of the file: without its folders where it was read, as written where not. Its bytes are
    /// kept ([`name_from_bytes`](super::name_from_bytes)).
    pub name: String,
    /// How many of the material's statements come before it.
    pub place: usize,
    /// The picture, shared by all textures of one file; `None` where there was none to read.
    ///
    /// A [`TriMesh`](super::TriMesh) stores each picture once; a texture by itself stores none.
    #[serde(skip)]
    pub image: Option<Arc<TextureImage>>,
}

/// The pixels of a texture, and the file that they come from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TextureImage {
    pixels: Option<Image>,
    encoded: Option<Vec<u8>>,
}

impl TextureImage {
    /// A picture that stands in no file yet.
    pub fn new(pixels: Image) -> Self {
        Self { pixels: Some(pixels), encoded: None }
    }

    /// A picture with the bytes of the file that it was decoded from.
    pub fn of_file(pixels: Image, encoded: Vec<u8>) -> Self {
        Self { pixels: Some(pixels), encoded: Some(encoded) }
    }

    /// A file of a format that cannot be decoded, kept for other programs.
    pub fn of_unknown(encoded: Vec<u8>) -> Self {
        Self { pixels: None, encoded: Some(encoded) }
    }

    /// The pixels, without transparency; `None` where the file cannot be decoded.
    pub fn pixels(&self) -> Option<&Image> {
        self.pixels.as_ref()
    }

    /// The file that the pixels were decoded from: what is saved in place of them, so that nothing
    /// of it is lost.
    pub fn encoded(&self) -> Option<&[u8]> {
        self.encoded.as_deref()
    }

    fn byte_size(&self) -> usize {
        let encoded = self.encoded.as_ref().map_or(0, Vec::len);
        let pixels = self.pixels.as_ref().map_or(0, |image| image.name.len() + image.bytes.len());
        size_of::<Self>() + pixels + encoded
    }
}

/// Each picture of the materials once, in the order of its first texture.
pub(crate) fn images(materials: &[Material]) -> Vec<Arc<TextureImage>> {
    let mut known = std::collections::HashSet::new();
    let all = materials.iter().flat_map(|material| &material.textures);
    let first = all.filter_map(|texture| texture.image.as_ref());
    first.filter(|image| known.insert(Arc::as_ptr(image))).cloned().collect()
}

/// Bytes that materials hold on the heap.
pub(super) fn byte_size(materials: &[Material]) -> usize {
    let of_texture =
        |t: &Texture| size_of::<Texture>() + t.keyword.len() + t.options.len() + t.name.len();
    let of_material = |material: &Material| {
        let statements = material.statements.iter();
        material.name.len()
            + statements.map(|(key, text)| key.len() + text.len()).sum::<usize>()
            + material.textures.iter().map(of_texture).sum::<usize>()
    };
    materials.iter().map(of_material).sum::<usize>()
        + images(materials).iter().map(|image| image.byte_size()).sum::<usize>()
}

/// Materials in a file: the pictures once, the materials without them, and for each texture the
/// place of its picture.
pub(super) mod serial {
    use std::collections::HashMap;

    use serde::de::Error;
    use serde::{Deserializer, Serializer};

    use super::*;

    type Places = Vec<Option<u32>>;

    pub fn serialize<S: Serializer>(materials: &[Material], to: S) -> Result<S::Ok, S::Error> {
        let images = images(materials);
        let places: HashMap<_, _> =
            images.iter().zip(0_u32..).map(|(image, place)| (Arc::as_ptr(image), place)).collect();
        let textures = materials.iter().flat_map(|material| &material.textures);
        let place = |texture: &Texture| {
            texture.image.as_ref().and_then(|image| places.get(&Arc::as_ptr(image)).copied())
        };
        let of_textures: Places = textures.map(place).collect();
        (&images, materials, &of_textures).serialize(to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<Material>, D::Error> {
        let (images, mut materials, places) =
            <(Vec<Arc<TextureImage>>, Vec<Material>, Places)>::deserialize(from)?;
        let mut places = places.into_iter();
        for texture in materials.iter_mut().flat_map(|material| &mut material.textures) {
            let place = places.next().ok_or_else(|| D::Error::custom("a texture has no place"))?;
            let find = |place: u32| {
                let image = images.get(place as usize).cloned();
                image.ok_or_else(|| D::Error::custom("a texture names a picture that is missing"))
            };
            texture.image = place.map(find).transpose()?;
        }
        Ok(materials)
    }
}

#[cfg(test)]
mod tests {
    use mve_core::Data;

    use super::*;
    use crate::data::{PixelKind, TriMesh};
    use crate::fixtures::tetrahedron;

    fn texture(image: Option<&Arc<TextureImage>>) -> Texture {
        Texture {
            role: TextureRole::BaseColor,
            keyword: "map_Kd".to_owned(),
            options: String::new(),
            name: "a.png".to_owned(),
            place: 0,
            image: image.cloned(),
        }
    }

    #[test]
    fn the_diffuse_color_is_three_numbers() {
        let material = |kd: &str| Material {
            statements: vec![
                ("Ns".to_owned(), "9 9 9".to_owned()),
                ("Kd".to_owned(), kd.to_owned()),
            ],
            ..Material::default()
        };
        assert_eq!(material("1 0.5 7").diffuse(), Some(DVec3::new(1.0, 0.5, 1.0)));
        for text in ["spectral a.rfl", "1 1", "0 nan 0"] {
            assert_eq!(material(text).diffuse(), None, "{text}");
        }
    }

    #[test]
    fn a_picture_of_two_materials_is_stored_and_counted_once() {
        let pixels = Image::filled("texture", [100, 100], PixelKind::Rgb, 7);
        let image = Arc::new(TextureImage::of_file(pixels, vec![9; 5000]));
        let material = |textures| Material { textures, ..Material::default() };
        let mut mesh = tetrahedron();
        mesh.materials =
            vec![material(vec![texture(Some(&image)), texture(None)]), material(Vec::new())];
        let text = |mesh: &TriMesh| serde_json::to_string(mesh).unwrap();
        let (size, length) = (mesh.byte_size(), text(&mesh).len());
        mesh.materials[1].textures.push(texture(Some(&image)));
        assert!(mesh.byte_size() > size && mesh.byte_size() < size + 1000);
        assert!(length > 70_000 && text(&mesh).len() < length + 500);
        let again: TriMesh = serde_json::from_str(&text(&mesh)).unwrap();
        assert_eq!(again, mesh);
        let image = |m: usize| again.materials[m].textures[0].image.as_ref().unwrap();
        assert!(Arc::ptr_eq(image(0), image(1)));
    }

    #[test]
    fn a_picture_with_missing_bytes_is_a_fault() {
        let mut pixels = Image::filled("texture", [4, 3], PixelKind::Gray, 7);
        pixels.bytes.pop();
        let image = Arc::new(TextureImage::new(pixels));
        let mut mesh = tetrahedron();
        mesh.materials =
            vec![Material { textures: vec![texture(Some(&image))], ..Material::default() }];
        let message = mesh.check().unwrap_err().to_string();
        assert_eq!(message, "texture \"a.png\" is 4 × 3 but has 11 bytes");
    }
}
