//! The textures of a mesh: which faces have which, and their pictures, from files or pinned ones.
//!
//! A mesh keeps of a material what its file says, with the name of a texture as text. Names are
//! relative to the file that holds them, which a mesh does not know: whoever shows it says in which
//! folders to look.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

use image::imageops::{FilterType, resize};
use image::{ImageError, ImageReader, Limits, RgbaImage};
use mve_modules::data::{Domain, Images, Layer, LayerValues, Material, TriMesh};

use crate::views::picture::{fitting_size, rgba};
use crate::views::slot::Same;

/// Bytes that the textures of one mesh may take on the GPU, smaller sizes aside.
const MOST_BYTES: usize = 256 << 20;

/// Textures of one mesh; every GPU can do as many.
const MOST_FILES: usize = 256;

/// Longest side of a picture that is read, and bytes that reading it may take.
const LIMITS: (u32, u64) = (1 << 15, 1 << 30);

/// Where textures come from.
#[derive(Clone, Debug, PartialEq)]
pub enum TextureSource {
    /// A pinned picture, for the whole mesh.
    Pinned(Same<Images>),
    /// Files that materials name, in one of these folders.
    Files(Same<TriMesh>, Vec<PathBuf>),
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

/// The texture files that the materials of a mesh name, and who has which.
#[derive(Debug, Default, PartialEq)]
pub struct TextureFiles<'a> {
    /// Names as the materials say them, each once.
    pub names: Vec<&'a str>,
    /// For each name of the layer of materials the place of its texture.
    of_labels: Vec<Option<usize>>,
    /// For each face the place of its material's name.
    of_faces: &'a [u32],
}

impl<'a> TextureFiles<'a> {
    /// Looks them up, without looking at any file.
    pub fn of(mesh: &'a TriMesh) -> Self {
        let layer = mesh.layer(Layer::MATERIAL).filter(|layer| layer.domain == Domain::Face);
        let Some(Layer { values: LayerValues::Label(labels), index, .. }) = layer else {
            return Self::default();
        };
        let mut files = Self { of_faces: index, ..Self::default() };
        let textured =
            mesh.materials.iter().filter_map(|m| Some((m.name.as_str(), diffuse_map(m)?)));
        let textured: HashMap<&str, &str> = textured.collect();
        for label in labels.iter().filter(|_| !textured.is_empty()) {
            let name = textured.get(label.as_str()).copied();
            let place = name.map(|name| {
                let known = files.names.iter().position(|known| *known == name);
                known.unwrap_or_else(|| {
                    files.names.push(name);
                    files.names.len() - 1
                })
            });
            files.of_labels.push(place);
        }
        files
    }

    /// The place of a face's texture in [`TextureFiles::names`].
    pub fn of_face(&self, face: usize) -> Option<usize> {
        *self.of_labels.get(*self.of_faces.get(face)? as usize)?
    }
}

/// The name of the picture that a material is colored by.
fn diffuse_map(material: &Material) -> Option<&str> {
    let is_map = |keyword: &str| keyword.eq_ignore_ascii_case("map_Kd");
    let (_, text) = material.statements.iter().find(|(keyword, _)| is_map(keyword))?;
    let name = without_options(text);
    (!name.is_empty()).then_some(name)
}

/// What follows the options of a texture statement: `-s 1 1 1 -clamp on wood.png`.
fn without_options(text: &str) -> &str {
    let first_word = |text: &'_ str| text.find(char::is_whitespace).unwrap_or(text.len());
    let mut rest = text.trim();
    while rest.starts_with('-') {
        let (option, after) = rest.split_at(first_word(rest));
        rest = after.trim_start();
        let is_numeric = matches!(option, "-o" | "-s" | "-t" | "-mm");
        for at in 0..3 {
            let (word, after) = rest.split_at(first_word(rest));
            let is_argument = if is_numeric { word.parse::<f64>().is_ok() } else { at == 0 };
            if !is_argument || after.is_empty() {
                break;
            }
            rest = after.trim_start();
        }
    }
    rest
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
        TextureSource::Files(mesh, folders) => {
            let names = TextureFiles::of(&mesh.0).names;
            if names.len() > MOST_FILES {
                return Err(format!("more than {MOST_FILES} textures cannot be shown"));
            }
            let read = names.iter().map(|name| read(name, folders)).collect();
            of_one_size(read, most)
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

/// Reads a texture from the first folder that has it.
fn read(name: &str, folders: &[PathBuf]) -> Result<RgbaImage, String> {
    let Some(path) = candidates(name, folders).into_iter().find(|path| path.is_file()) else {
        return Err(match folders {
            [] => format!("texture {name}: it is not known which folder it is in"),
            _ => format!("texture {name} is not there"),
        });
    };
    let message = |error: ImageError| match error {
        ImageError::IoError(error) => format!("texture {name} cannot be read: {error}"),
        ImageError::Limits(_) => format!("texture {name} is too large"),
        ImageError::Unsupported(_) => format!("texture {name} is neither a PNG nor a JPEG file"),
        error => format!("texture {name} is no picture: {error}"),
    };
    let reader = ImageReader::open(&path).and_then(ImageReader::with_guessed_format);
    let mut reader = reader.map_err(|error| message(ImageError::IoError(error)))?;
    let mut limits = Limits::no_limits();
    (limits.max_image_width, limits.max_image_height) = (Some(LIMITS.0), Some(LIMITS.0));
    limits.max_alloc = Some(LIMITS.1);
    reader.limits(limits);
    Ok(reader.decode().map_err(message)?.into_rgba8())
}

/// The paths that a name may mean, in the order in which to try them: as it is written, and its last
/// part alone, for names that hold a path of the machine where they were written.
fn candidates(name: &str, folders: &[PathBuf]) -> Vec<PathBuf> {
    let slashes = name.replace('\\', "/");
    let mut names = vec![slashes.as_str()];
    // A comment may follow; but names may hold its sign, too.
    names.extend(slashes.split_once(" #").map(|(name, _)| name.trim_end()));
    let alone: Vec<&str> = names.iter().filter_map(|name| name.rsplit('/').next()).collect();
    names.extend(alone);
    let in_folders = |name| folders.iter().map(move |folder: &PathBuf| folder.join(name));
    names.into_iter().flat_map(in_folders).collect()
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

/// The source for the pictures of a mesh's own materials.
pub fn files_of(mesh: &Arc<TriMesh>, folders: &[PathBuf]) -> TextureSource {
    TextureSource::Files(Same(Arc::clone(mesh)), folders.to_vec())
}

#[cfg(test)]
#[path = "texture_tests.rs"]
mod tests;
