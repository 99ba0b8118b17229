//! Material files (MTL): statements are kept word for word, so that they survive a round trip;
//! those that name pictures as textures.

use super::cursor::{Comments, Cursor, quoted};
use super::textures::texture_of;
use super::{Companions, Warning, Warnings};
use crate::data::Material;

/// Reads an MTL file. Any text can be read; what belongs to no material is left out and warned
/// of. Comments on lines of their own are left out, too.
pub fn parse_mtl(bytes: &[u8]) -> (Vec<Material>, Vec<Warning>) {
    let mut materials: Vec<Material> = Vec::new();
    let mut warnings = Warnings::default();
    let mut cursor = Cursor::new(bytes);
    while !cursor.is_done() {
        if !cursor.is_line_over() {
            let line = cursor.line();
            let keyword = String::from_utf8_lossy(cursor.word()).into_owned();
            let is_name = keyword == "newmtl";
            let text = cursor.text(if is_name { Comments::Cut } else { Comments::Keep });
            match materials.last_mut() {
                _ if is_name => {
                    materials.push(Material { name: text, ..Material::default() });
                }
                Some(material) => add_statement(material, keyword, text),
                None => {
                    let found = quoted(keyword.as_bytes());
                    warnings.add(line, &format!("{found} before the first `newmtl` is left out"));
                }
            }
        }
        cursor.next_line();
    }
    (materials, warnings.into_list())
}

fn add_statement(material: &mut Material, keyword: String, text: String) {
    match texture_of(&keyword, &text, material.statements.len()) {
        Some(texture) => material.textures.push(texture),
        None => material.statements.push((keyword, text)),
    }
}

/// What the text of a `mtllib` statement may mean.
pub(super) struct FileNames {
    /// All of it as one name, since names with blanks are about, in the order in which to try
    /// them: as it is written, with slashes between folders, without a comment.
    pub whole: Vec<String>,
    /// Without a comment each of its words, as the format says, if there are several.
    pub words: Vec<String>,
}

impl FileNames {
    /// Understands the text of a statement with its comment.
    pub fn of(text: &str) -> Self {
        let slashes = text.replace('\\', "/");
        let plain = without_comment(&slashes);
        let mut whole = vec![text.to_owned(), slashes.clone(), plain.to_owned()];
        whole.dedup();
        let words: Vec<_> = plain.split_whitespace().map(str::to_owned).collect();
        Self { whole, words: if words.len() > 1 { words } else { Vec::new() } }
    }
}

/// A text up to a `#` at its start or after a blank.
pub(super) fn without_comment(text: &str) -> &str {
    let is_comment = |at: &usize| text[..*at].chars().next_back().is_none_or(char::is_whitespace);
    let at = text.match_indices('#').map(|(at, _)| at).find(is_comment);
    text[..at.unwrap_or(text.len())].trim_end()
}

/// Reads the material files that an OBJ file names and warns of those that are missing, and of
/// used materials that none defines. The first definition of a name holds.
pub(super) fn read_all(
    libraries: &[String],
    used: &[String],
    companions: &mut dyn Companions,
    warnings: &mut Warnings,
) -> Vec<Material> {
    let mut materials: Vec<Material> = Vec::new();
    let mut is_complete = !libraries.is_empty();
    for library in libraries {
        let FileNames { whole, words } = FileNames::of(library);
        let mut read = whole.iter().map(|name| Some((name, companions.material_file(name).ok()?)));
        let mut found: Vec<_> = read.find_map(|read| read).into_iter().collect();
        if found.is_empty() {
            let plain = &whole[whole.len() - 1..];
            for name in if words.is_empty() { plain } else { &words } {
                match companions.material_file(name) {
                    Ok(bytes) => found.push((name, bytes)),
                    Err(error) => {
                        is_complete = false;
                        let text = format!("material file \"{name}\" is left out: {error}");
                        warnings.add_general(text);
                    }
                }
            }
        }
        for (name, bytes) in found {
            let (more, problems) = parse_mtl(&bytes);
            let known = materials.len();
            materials.extend(more);
            drop_repeated(&mut materials, known);
            companions.pictures(name, &mut materials[known..], warnings);
            for problem in problems {
                warnings.add_general(format!("{name}, {problem}"));
            }
        }
    }
    let names: std::collections::HashSet<&str> =
        materials.iter().map(|material| material.name.as_str()).collect();
    for name in used.iter().filter(|name| is_complete && !names.contains(name.as_str())) {
        warnings.add_general(format!("no material file defines \"{name}\", which faces use"));
    }
    drop(names);
    materials
}

/// Leaves out the materials from `first` on whose name came before.
fn drop_repeated(materials: &mut Vec<Material>, first: usize) {
    let mut seen = std::collections::HashSet::new();
    let mut idx = 0;
    materials.retain(|material| {
        idx += 1;
        seen.insert(material.name.clone()) || idx <= first
    });
}
