//! The pictures that material files name: what their statements say, and the files on the disk.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use mve_core::Control;

use super::Warnings;
use crate::data::{Material, Texture, TextureImage, TextureRole};
use crate::formats::plain_file::read_plain;
use crate::formats::texture_file::read_texture;

/// Bytes of the largest picture file that is read.
const MAX_FILE_BYTES: u64 = 1 << 30;

/// Bytes of pixels of all pictures of one mesh.
const MAX_TOTAL_BYTES: u64 = 4 << 30;

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
/// file, the path that is written.
pub(super) fn find(name: &str, folders: &[PathBuf]) -> (PathBuf, Place) {
    let names = spellings(name);
    let alone: Vec<&str> = names.iter().filter_map(|name| name.rsplit('/').next()).collect();
    let whole: Vec<&str> = names.iter().map(String::as_str).collect();
    for (at, folder) in folders.iter().enumerate() {
        for (names, is_written) in [(&whole, at == 0), (&alone, false)] {
            let mut paths = names.iter().map(|name| folder.join(name));
            if let Some(path) = paths.find(|path| path.is_file()) {
                return (path, if is_written { Place::AsWritten } else { Place::Elsewhere });
            }
        }
    }
    (folders.first().map(|folder| folder.join(name)).unwrap_or_default(), Place::Nowhere)
}

/// Where the file of a texture lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// Where the material file says.
    AsWritten,
    /// Beside the material file or the mesh, though the material file says otherwise.
    Elsewhere,
    /// There is no such file.
    Nowhere,
}

/// Reads pictures, each file once.
#[derive(Default)]
pub(super) struct Pictures {
    known: HashMap<PathBuf, Result<Arc<TextureImage>, String>>,
    n_bytes: u64,
}

impl Pictures {
    /// Gives the textures of materials their pictures; a warning says which have none, and why.
    pub fn read_all(
        &mut self,
        materials: &mut [Material],
        folders: &[PathBuf],
        warnings: &mut Warnings,
        control: Control,
    ) {
        for texture in materials.iter_mut().flat_map(|material| &mut material.textures) {
            // Whoever asked for the mesh hears of a cancel from the caller.
            if control.at(1.0).is_err() {
                return;
            }
            let (path, place) = find(&texture.name, folders);
            let written = texture.name.clone();
            let picture = match place {
                Place::Nowhere => Err("is not there".to_owned()),
                _ => self.read(&path),
            };
            match picture {
                Err(why) => warnings.add_once(format!("texture {written} {why}")),
                Ok(image) => {
                    texture.image = Some(image);
                    let name = path.file_name().unwrap_or_default();
                    texture.name = name.to_string_lossy().into_owned();
                    if place == Place::Elsewhere {
                        let found = path.display();
                        let text = format!("texture {written} is not there; {found} is taken");
                        warnings.add_once(text);
                    }
                }
            }
        }
    }

    fn read(&mut self, path: &Path) -> Result<Arc<TextureImage>, String> {
        if let Some(known) = self.known.get(path) {
            return known.clone();
        }
        let read = || {
            let bytes = read_plain(path, MAX_FILE_BYTES);
            let bytes = bytes.map_err(|error| format!("cannot be read: {error}"))?;
            let image = TextureImage::of_file(read_texture(&bytes)?, bytes);
            let n_bytes = self.n_bytes + image.pixels().bytes.len() as u64;
            if n_bytes > MAX_TOTAL_BYTES {
                return Err("is too large together with those before it".to_owned());
            }
            Ok((Arc::new(image), n_bytes))
        };
        let found = read().map(|(image, n_bytes)| {
            self.n_bytes = n_bytes;
            image
        });
        self.known.insert(path.to_owned(), found.clone());
        found
    }
}

/// Materials as they stand in a file, and the pictures that lie in a folder beside it.
pub(super) struct TextureFolder {
    /// The materials; their textures are named with the folder.
    pub materials: Vec<Material>,
    /// Name and content of each file in the folder.
    pub files: Vec<(String, Arc<TextureImage>)>,
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
        texture.name = format!("{folder}/{}", files[place].0);
    }
    TextureFolder { materials, files }
}

/// A texture's name as any system can have it for a file.
fn file_name(name: &str, image: &TextureImage) -> String {
    let is_bad = |c: char| {
        c.is_control() || matches!(c, '/' | '\\' | ':' | '*' | '?' | '"' | '<' | '>' | '|')
    };
    let plain: String = name.chars().map(|c| if is_bad(c) { '_' } else { c }).collect();
    let plain = plain.trim_matches(|c: char| c.is_whitespace() || c == '.');
    let plain = if plain.is_empty() { "texture" } else { plain };
    let is_png = Path::new(plain).extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
    match image.encoded() {
        None if !is_png => format!("{plain}.png"),
        _ => plain.to_owned(),
    }
}

/// The name, with a number where another file has it, in capitals or not.
fn free_name(name: &str, taken: &mut HashSet<String>) -> String {
    let (stem, extension) = name.rsplit_once('.').unwrap_or((name, ""));
    let dot = if extension.is_empty() { "" } else { "." };
    let mut free = name.to_owned();
    let mut number = 2;
    while !taken.insert(free.to_lowercase()) {
        free = format!("{stem}-{number}{dot}{extension}");
        number += 1;
    }
    free
}
