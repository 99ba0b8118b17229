//! The pictures of the textures of a mesh: its own, or a pinned one.

use image::RgbaImage;
use image::imageops::{FilterType, resize};
use mve_modules::data::{Images, Texture, TextureImage, TriMesh};

use crate::views::memo::Same;
use crate::views::mesh::arrays::textures::FaceTextures;
use crate::views::picture::{fitting_size, rgba};

/// Bytes that the textures of one mesh may take on the GPU, smaller sizes aside.
const MOST_BYTES: usize = 256 << 20;

/// Textures of one mesh; every GPU can do as many.
const MOST_PICTURES: usize = 256;

/// Where textures come from.
#[derive(Clone, Debug, PartialEq)]
pub enum TextureSource {
    /// A pinned picture, for the whole mesh.
    Pinned(Same<Images>),
    /// The mesh's own pictures, which its materials name.
    Materials(Same<TriMesh>),
}

/// Pictures of one size, four bytes a pixel.
#[derive(Debug)]
pub struct Pictures {
    /// Width and height.
    pub size: [u32; 2],
    /// The pixels of each.
    pub layers: Vec<RgbaImage>,
    /// Smaller and smaller versions of each, the last a single pixel.
    pub smaller: Vec<Vec<RgbaImage>>,
    /// What went wrong, in a line.
    pub problem: Option<String>,
}

impl Pictures {
    fn new(layers: Vec<RgbaImage>, problem: Option<String>) -> Self {
        let size = layers.first().map_or([1, 1], |layer| layer.dimensions().into());
        let smaller = layers.iter().map(smaller).collect();
        Self { size, layers, smaller, problem }
    }

    /// One that nobody looks at.
    pub fn none() -> Self {
        Self::new(vec![RgbaImage::new(1, 1)], None)
    }
}

/// Makes the pictures, none of them with a side longer than `most`.
///
/// # Errors
/// A line that says why there is none.
pub fn pictures(source: &TextureSource, most: u32) -> Result<Pictures, String> {
    match source {
        TextureSource::Pinned(images) => {
            let image = images.0.0.first().ok_or("there is no picture")?;
            let [width, height] = fitting_size(image, most as usize);
            let pixels = rgba(image, [width, height]);
            let picture = RgbaImage::from_raw(width as u32, height as u32, pixels);
            Ok(Pictures::new(vec![picture.ok_or("the picture has no pixels")?], None))
        }
        TextureSource::Materials(mesh) => {
            let textures = FaceTextures::of(&mesh.0).list;
            if textures.len() > MOST_PICTURES {
                return Err(format!("more than {MOST_PICTURES} textures cannot be shown"));
            }
            of_one_size(textures.into_iter().map(picture_of).collect(), most)
        }
    }
}

/// Brings pictures to the size of the largest, for they lie in one array.
fn of_one_size(read: Vec<Result<RgbaImage, String>>, most: u32) -> Result<Pictures, String> {
    let problem = read.iter().find_map(|picture| picture.as_ref().err()).cloned();
    let n_lost = read.iter().filter(|picture| picture.is_err()).count();
    let problem = problem.map(|first| match n_lost {
        1 => first,
        n => format!("{first}; {} more textures are missing", n - 1),
    });
    let sizes = || read.iter().flatten().map(RgbaImage::dimensions);
    let Some((width, height)) = sizes().reduce(|a, b| (a.0.max(b.0), a.1.max(b.1))) else {
        return Err(problem.unwrap_or_else(|| "no material names a texture".to_owned()));
    };
    let mut size = [width, height].map(|side| side.max(1));
    let fits = |[w, h]: [u32; 2]| {
        let bytes = 4 * u64::from(w) * u64::from(h) * read.len() as u64;
        w.max(h) <= most && (bytes <= MOST_BYTES as u64 || w.max(h) <= 16)
    };
    while !fits(size) {
        size = size.map(|side| side.div_ceil(2));
    }
    let [width, height] = size;
    let layer = |picture: Result<RgbaImage, String>| match picture {
        Ok(picture) if picture.dimensions() == (width, height) => picture,
        Ok(picture) => resize(&picture, width, height, FilterType::Triangle),
        Err(_) => RgbaImage::from_pixel(width, height, image::Rgba([190, 190, 190, 255])),
    };
    Ok(Pictures::new(read.into_iter().map(layer).collect(), problem))
}

/// The picture of a texture, as the GPU takes it.
fn picture_of(texture: &Texture) -> Result<RgbaImage, String> {
    let name = &texture.name;
    let Some(pixels) = texture.image.as_deref().and_then(TextureImage::pixels) else {
        let message = "is not there or cannot be read: see the warnings of its loader";
        return Err(format!("texture {name} {message}"));
    };
    let (width, height) = (pixels.width, pixels.height);
    let picture = RgbaImage::from_raw(width as u32, height as u32, rgba(pixels, [width, height]));
    let picture = picture.filter(|picture| !picture.is_empty());
    picture.ok_or_else(|| format!("texture {name} has no pixels"))
}

/// Smaller and smaller versions of a picture, the last a single pixel.
fn smaller(picture: &RgbaImage) -> Vec<RgbaImage> {
    let mut made: Vec<RgbaImage> = Vec::new();
    loop {
        let last = made.last().unwrap_or(picture);
        let (width, height) = last.dimensions();
        if width.max(height) <= 1 {
            return made;
        }
        let half = |side: u32| (side / 2).max(1);
        made.push(resize(last, half(width), half(height), FilterType::Triangle));
    }
}

#[cfg(test)]
#[path = "texture_tests.rs"]
mod tests;
