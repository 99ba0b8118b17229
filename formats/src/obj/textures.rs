//! The pictures that material files name: what their statements say, and the files on the disk.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use mve_core::Control;
use mve_mesh::data::{
    Material, Texture, TextureImage, TextureRole, name_from_file, name_recoded, name_to_file,
    shown_name,
};

use super::Warnings;
use super::bounds::Bounds;
use super::write::path_text;
use crate::plain_file::read_plain;
use crate::texture_file::read_texture;

/// Bytes of the largest picture file that is read.
const MAX_FILE_BYTES: u64 = 1 << 30;

/// Bytes of all pictures of one mesh: their pixels, and the files that are kept for saving.
const MAX_TOTAL_BYTES: u64 = 4 << 30;

/// Bytes of the longest name of a file that common systems take.
const MAX_NAME_BYTES: usize = 255;

/// What a statement's keyword says of its picture; `None` where it names none.
fn role_of(keyword: &str) -> Option<TextureRole> {
    use TextureRole as Role;
    const ROLES: [(&str, TextureRole); 18] = [
        ("map_kd", Role::BaseColor),
        ("map_ka", Role::Ambient),
        ("map_ks", Role::Specular),
        ("map_ns", Role::Shininess),
        ("map_ke", Role::Emission),
        ("map_d", Role::Opacity),
        ("map_tr", Role::Opacity),
        ("map_pr", Role::Roughness),
        ("map_pm", Role::Metallic),
        ("map_ps", Role::Sheen),
        ("norm", Role::Normal),
        ("map_kn", Role::Normal),
        ("map_norm", Role::Normal),
        ("bump", Role::Bump),
        ("map_bump", Role::Bump),
        ("disp", Role::Displacement),
        ("decal", Role::Decal),
        ("refl", Role::Reflection),
    ];
    let keyword = keyword.to_ascii_lowercase();
    match ROLES.iter().find(|(known, _)| *known == keyword) {
        Some((_, role)) => Some(*role),
        // `map_aat on` switches smooth edges on.
        None if keyword.starts_with("map_") && keyword != "map_aat" => Some(Role::Other),
        None => None,
    }
}

/// A statement as a texture without its picture, if it names one.
pub(super) fn texture_of(keyword: &str, text: &str, place: usize) -> Option<Texture> {
    let role = role_of(keyword)?;
    let n_options = options_length(text);
    let (options, name) = text.split_at(n_options);
    let is_named = !name.is_empty();
    let (keyword, options, name) = (keyword.to_owned(), options.to_owned(), name.to_owned());
    is_named.then_some(Texture { role, keyword, options, name, place, image: None })
}

/// Bytes of the options before the name: of `-s 1 1 1 -clamp on ` in `-s 1 1 1 -clamp on a.png`.
/// Numbers are an option's own as long as a name is left.
fn options_length(text: &str) -> usize {
    let first_word = |text: &str| text.find(char::is_whitespace).unwrap_or(text.len());
    let mut rest = text.trim_start();
    while rest.starts_with('-') {
        let (option, after) = rest.split_at(first_word(rest));
        let after = after.trim_start();
        if after.is_empty() {
            break;
        }
        rest = after;
        let (n_most, is_numeric) = match option {
            "-o" | "-s" | "-t" => (3, true),
            "-mm" => (2, true),
            _ => (1, false),
        };
        for _ in 0..n_most {
            let (word, after) = rest.split_at(first_word(rest));
            let after = after.trim_start();
            if after.is_empty() || is_numeric && word.parse::<f64>().is_err() {
                break;
            }
            rest = after;
        }
    }
    text.len() - rest.len()
}

/// What a texture's name may mean, in the order in which to try it: as it is written, then with
/// slashes, without quotation marks, a comment or options behind it.
fn spellings(name: &str) -> Vec<String> {
    let slashes = name.replace('\\', "/");
    let slashes = slashes.trim();
    let first_of = |end: &str| slashes.split(end).next().unwrap_or_default().trim();
    let quoted = slashes.strip_prefix('"').and_then(|rest| rest.split('"').next());
    let mut names: Vec<String> = Vec::new();
    for name in [name, slashes, quoted.unwrap_or_default(), first_of(" #"), first_of(" -")] {
        if !name.is_empty() && !names.iter().any(|known| known == name) {
            names.push(name.to_owned());
        }
    }
    names
}

/// The file that a texture's name means: the first that is there of what it may mean in the folder
/// of its material file; of its last part alone in that folder, since names hold paths of the
/// machines where they were written; and of both in the other folders. Where there is no such
/// file, or it lies out of bounds, the path that is written.
pub(crate) fn find(name: &str, folders: &[PathBuf], bounds: &Bounds) -> (PathBuf, Place) {
    let names = spellings(name);
    let alone: Vec<&str> = names.iter().filter_map(|name| name.rsplit('/').next()).collect();
    let whole: Vec<&str> = names.iter().map(String::as_str).collect();
    for (at, folder) in folders.iter().enumerate() {
        for (names, is_written) in [(&whole, at == 0), (&alone, false)] {
            let spellings =
                names.iter().flat_map(|name| [Some((*name).to_owned()), name_recoded(name)]);
            let mut paths = spellings.flatten().map(|name| folder.join(name_to_file(&name)));
            if let Some(path) = paths.find(|path| path.is_file() && bounds.check(path).is_ok()) {
                return (path, if is_written { Place::AsWritten } else { Place::Elsewhere });
            }
        }
    }
    let written = folders.first().map(|folder| folder.join(name_to_file(name)));
    (written.unwrap_or_default(), Place::Nowhere)
}

/// Where the file of a texture lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// Where the material file says.
    AsWritten,
    /// Beside the material file or the mesh, though the material file says otherwise.
    Elsewhere,
    /// There is no such file.
    Nowhere,
}

/// A picture, and why its file cannot be decoded, if so.
pub(crate) type PictureFile = (Arc<TextureImage>, Option<String>);

/// Reads pictures, each file once.
pub(crate) struct Pictures {
    known: HashMap<PathBuf, Result<PictureFile, String>>,
    n_bytes_left: u64,
}

impl Default for Pictures {
    fn default() -> Self {
        Self::of_at_most(MAX_TOTAL_BYTES)
    }
}

impl Pictures {
    /// Those that take at most so many bytes together.
    pub fn of_at_most(n_bytes: u64) -> Self {
        Self { known: HashMap::new(), n_bytes_left: n_bytes }
    }

    /// Gives the textures of materials their pictures; a warning says which have none, and why.
    pub fn read_all(
        &mut self,
        materials: &mut [Material],
        folders: &[PathBuf],
        bounds: &Bounds,
        warnings: &mut Warnings,
        control: Control,
    ) {
        let textures = materials.iter_mut().flat_map(|material| &mut material.textures);
        for texture in textures.filter(|texture| texture.image.is_none()) {
            // Whoever asked for the mesh hears of a cancel from the caller.
            if control.at(1.0).is_err() {
                return;
            }
            let (path, place) = find(&texture.name, folders, bounds);
            let written = shown_name(&texture.name);
            let picture = match place {
                Place::Nowhere if path.is_file() => {
                    let why = bounds.check(&path).err().map(|why| why.to_string());
                    Err(format!("is left out: {}", why.unwrap_or_default()))
                }
                Place::Nowhere => Err("is not there".to_owned()),
                _ => self.read(&path),
            };
            match picture {
                Err(why) => warnings.add_once(format!("texture {written} {why}")),
                Ok((image, fault)) => {
                    texture.image = Some(image);
                    texture.name = name_from_file(path.file_name().unwrap_or_default());
                    if let Some(fault) = fault {
                        let text = format!("texture {written} {fault}; it is kept as it is");
                        warnings.add_once(text);
                    }
                    if place == Place::Elsewhere {
                        let found = path.display();
                        let text = format!("texture {written} is not there; {found} is taken");
                        warnings.add_once(text);
                    }
                }
            }
        }
    }

    /// The picture of a file, and why it cannot be decoded.
    fn read(&mut self, path: &Path) -> Result<PictureFile, String> {
        if let Some(known) = self.known.get(path) {
            return known.clone();
        }
        let read = || {
            let bytes = read_plain(path, MAX_FILE_BYTES);
            bytes.map_err(|error| format!("cannot be read: {error}"))
        };
        let found = read().and_then(|bytes| self.decode(bytes));
        self.known.insert(path.to_owned(), found.clone());
        found
    }

    /// The picture in the bytes of a file, and why it cannot be decoded.
    pub fn decode(&mut self, bytes: Vec<u8>) -> Result<PictureFile, String> {
        let pixels = read_texture(&bytes);
        let n_pixel_bytes = pixels.as_ref().map_or(0, |pixels| pixels.bytes.len());
        let n_bytes = (n_pixel_bytes + bytes.len()) as u64;
        let n_left = self.n_bytes_left.checked_sub(n_bytes);
        self.n_bytes_left = n_left.ok_or("is too large together with those before it")?;
        let (image, fault) = match pixels {
            Ok(pixels) => (TextureImage::of_file(pixels, bytes), None),
            Err(fault) => (TextureImage::of_unknown(bytes), Some(fault)),
        };
        Ok((Arc::new(image), fault))
    }
}

/// Materials as they stand in a file, and the pictures that lie in a folder beside it.
pub(super) struct TextureFolder {
    /// The materials; their textures are named with the folder.
    pub materials: Vec<Material>,
    /// Name and content of each file in the folder.
    pub files: Vec<(String, Arc<TextureImage>)>,
}

/// Names each picture that was read as a file in this folder.
pub(super) fn named(materials: &[Material], folder: &str) -> Vec<Material> {
    let mut materials = materials.to_vec();
    for texture in materials.iter_mut().flat_map(|material| &mut material.textures) {
        if texture.image.is_some() {
            texture.name = path_text(&format!("{folder}/{}", texture.name));
        }
    }
    materials
}

/// Gives each picture a file name of its own in a folder of this name.
pub(super) fn texture_folder(materials: &[Material], folder: &str) -> TextureFolder {
    let mut materials = materials.to_vec();
    let mut files: Vec<(String, Arc<TextureImage>)> = Vec::new();
    let mut places: HashMap<*const TextureImage, usize> = HashMap::new();
    let mut taken = HashSet::new();
    for texture in materials.iter_mut().flat_map(|material| &mut material.textures) {
        let Some(image) = &texture.image else { continue };
        let place = *places.entry(Arc::as_ptr(image)).or_insert_with(|| {
            let name = free_name(&file_name(&texture.name, image), &mut taken);
            files.push((name, Arc::clone(image)));
            files.len() - 1
        });
        texture.name = path_text(&format!("{folder}/{}", files[place].0));
    }
    TextureFolder { materials, files }
}

/// A texture's name as any system can have it for a file, but for its length.
fn file_name(name: &str, image: &TextureImage) -> String {
    let is_bad = |c: char| {
        c.is_control() || matches!(c, '/' | '\\' | ':' | '*' | '?' | '"' | '<' | '>' | '|')
    };
    let plain: String = name.chars().map(|c| if is_bad(c) { '_' } else { c }).collect();
    let plain = plain.trim_matches(|c: char| c.is_whitespace() || c == '.');
    let plain = if plain.is_empty() { "texture" } else { plain };
    let mark = if is_device(plain) { "_" } else { "" };
    let is_png = Path::new(plain).extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
    let end = if image.encoded().is_none() && !is_png { ".png" } else { "" };
    format!("{mark}{plain}{end}")
}

/// Whether Windows takes the name for that of a device, whatever stands behind its first dot.
fn is_device(name: &str) -> bool {
    let stem = name.split('.').next().unwrap_or_default().trim_end().to_ascii_uppercase();
    let is_port = |port: &str| {
        let number = stem.strip_prefix(port).unwrap_or_default();
        matches!(
            number,
            "0" | "1" | "2" | "3" | "4" | "5" | "6" | "7" | "8" | "9" | "¹" | "²" | "³"
        )
    };
    matches!(&*stem, "CON" | "PRN" | "AUX" | "NUL") || is_port("COM") || is_port("LPT")
}

/// The name, with a number where another file has it, in capitals or not; cut before its extension
/// where it is too long.
fn free_name(name: &str, taken: &mut HashSet<String>) -> String {
    // What is longer is no extension.
    const LONGEST_EXTENSION: usize = 16;
    let parts = name.rsplit_once('.').filter(|(_, end)| end.len() <= LONGEST_EXTENSION);
    let (stem, extension) = match parts {
        Some((stem, extension)) => (stem, format!(".{extension}")),
        None => (name, String::new()),
    };
    let mut number = 1;
    loop {
        let end = if number == 1 { extension.clone() } else { format!("-{number}{extension}") };
        let stem = &stem[..stem.floor_char_boundary(MAX_NAME_BYTES - end.len())];
        // A cut may have left these at its end.
        let stem = if end.is_empty() { stem.trim_end_matches([' ', '.']) } else { stem };
        let free = format!("{stem}{end}");
        if taken.insert(free.to_lowercase()) {
            return free;
        }
        number += 1;
    }
}
