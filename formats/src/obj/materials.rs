//! Material files (MTL): statements are kept word for word, so that they survive a round trip;
//! those that name pictures as textures.

use std::collections::{HashMap, HashSet};
use std::io;

use mve_mesh::data::{Material, name_recoded, shown_name};

use super::builder::LabelTrack;
use super::cursor::{Backslash, Cursor, is_blank_char, quoted};
use super::textures::texture_of;
use super::{Companions, Warning, Warnings};

/// Words of the longest name with blanks that is looked for among other names.
const MOST_WORDS: usize = 8;

/// Words of a statement that are looked at.
const MOST_NAMES: usize = 256;

/// Reads an MTL file. Any text can be read; what belongs to no material is left out and warned
/// of. Comments on lines of their own are left out, too. Nothing is said of the content of a file
/// without a material, which may be of another kind and none of the reader's business.
pub fn parse_mtl(bytes: &[u8]) -> (Vec<Material>, Vec<Warning>) {
    let mut materials: Vec<Material> = Vec::new();
    let mut warnings = Warnings::default();
    let mut cursor = Cursor::new(bytes);
    while !cursor.is_done() {
        if !cursor.is_line_over() {
            let line = cursor.line();
            let keyword = String::from_utf8_lossy(cursor.word()).into_owned();
            match materials.last_mut() {
                _ if keyword == "newmtl" => {
                    materials.push(Material { name: cursor.name(), ..Material::default() });
                }
                Some(material) => add_statement(material, keyword, &mut cursor),
                None => {
                    let found = quoted(keyword.as_bytes());
                    warnings.add(line, &format!("{found} before the first `newmtl` is left out"));
                }
            }
        }
        cursor.next_line();
    }
    if materials.is_empty() {
        warnings = Warnings::default();
        warnings.add_general("it defines no material: is it an MTL file?".to_owned());
    }
    (materials, warnings.into_list())
}

fn add_statement(material: &mut Material, keyword: String, cursor: &mut Cursor) {
    // Whether the rest of the line is a name shows when there is one.
    let is_named = texture_of(&keyword, "a", 0).is_some();
    let backslash = if is_named { Backslash::OfName } else { Backslash::Joins };
    let text = cursor.text(backslash);
    match texture_of(&keyword, &text, material.statements.len()) {
        Some(texture) => material.textures.push(texture),
        None => material.statements.push((keyword, text)),
    }
}

/// The parts of a `mtllib` statement that may be names, in the order in which to try them.
struct Readings<'a> {
    /// All of it: as it stands, without quotation marks, without a comment.
    whole: Vec<&'a str>,
    /// The words before a comment, each with the text from it on.
    words: Vec<&'a str>,
}

impl<'a> Readings<'a> {
    fn of(text: &'a str) -> Self {
        let plain = without_comment(text);
        let mut whole = vec![text];
        for text in [text, plain] {
            let quoted = text.strip_prefix('"').and_then(|rest| rest.strip_suffix('"'));
            whole.extend(quoted.filter(|name| !name.is_empty()));
        }
        if plain != text {
            whole.push(plain);
        }
        let starts = plain.char_indices().filter(|(at, c)| {
            !is_blank_char(*c) && plain[..*at].chars().next_back().is_none_or(is_blank_char)
        });
        Self { whole, words: starts.take(MOST_NAMES).map(|(at, _)| &plain[at..]).collect() }
    }

    /// The text of some words that follow each other, with the blanks between them.
    fn run(&self, first: usize, n_words: usize) -> &'a str {
        let text = self.words[first];
        let rest = self.words.get(first + n_words).map_or(0, |rest| rest.len());
        text[..text.len() - rest].trim_end_matches(is_blank_char)
    }

    /// How many words from one on may be a name, the most first.
    fn lengths(&self, first: usize) -> impl Iterator<Item = usize> {
        (1..=MOST_WORDS.min(self.words.len() - first)).rev()
    }
}

/// A name without what stands behind a ` #`, if that leaves something.
fn without_comment(name: &str) -> &str {
    let after_blank = |(at, _): &(usize, &str)| name[..*at].ends_with(is_blank_char);
    match name.match_indices('#').find(after_blank) {
        Some((at, _)) => name[..at].trim_end_matches(is_blank_char),
        None => name,
    }
}

/// A name as it stands, and with slashes where that is another one, each also in the other
/// encoding. Some encodings have the byte of a backslash within a character, so a name may hold
/// one.
fn spellings(name: &str) -> impl Iterator<Item = String> {
    let slashes = name.replace('\\', "/");
    let other = (slashes != name).then_some(slashes);
    let names = std::iter::once(name.to_owned()).chain(other);
    names.flat_map(|name| [name_recoded(&name), Some(name)].into_iter().flatten().rev())
}

/// The file names that a `mtllib` statement may mean: all of its text, since names with blanks are
/// about; and each run of its words.
pub(super) fn candidates(text: &str) -> Vec<String> {
    let readings = Readings::of(text);
    let n_words = readings.words.len();
    let runs = (0..n_words).flat_map(|at| readings.lengths(at).map(move |n| (at, n)));
    let runs = runs.map(|(at, n)| readings.run(at, n));
    let mut known = HashSet::new();
    let all = readings.whole.iter().copied().chain(runs).flat_map(spellings);
    all.filter(|name| known.insert(name.clone())).collect()
}

/// A material file that was found: its name and content.
type Library = (String, Vec<u8>);

fn open(name: &str, companions: &mut dyn Companions) -> io::Result<Library> {
    let mut error = None;
    for name in spellings(name) {
        match companions.material_file(&name) {
            Ok(bytes) => return Ok((name, bytes)),
            Err(why) => error = Some(why),
        }
    }
    Err(error.unwrap_or_else(|| io::ErrorKind::NotFound.into()))
}

/// The material files that a statement names: the one whose name it is as a whole, or else those
/// whose names are words of it, the longest first. What is left are names of missing files, which
/// end with the word that ends in `.mtl`.
fn find_libraries(
    text: &str,
    companions: &mut dyn Companions,
) -> (Vec<Library>, Vec<(String, io::Error)>) {
    let readings = Readings::of(text);
    if let Some(found) = readings.whole.iter().find_map(|name| open(name, companions).ok()) {
        return (vec![found], Vec::new());
    }
    let (mut found, mut missing) = (Vec::new(), Vec::new());
    let mut report = |first: usize, n_words: usize, companions: &mut dyn Companions| {
        let name = if n_words == 0 { "" } else { readings.run(first, n_words) };
        if let (false, Err(error)) = (name.is_empty(), open(name, companions)) {
            missing.push((name.replace('\\', "/"), error));
        }
    };
    let (mut at, mut n_gone) = (0, 0);
    while at < readings.words.len() {
        let longest = readings
            .lengths(at)
            .find_map(|n| Some((n, open(readings.run(at, n), companions).ok()?)));
        match longest {
            Some((n_words, library)) => {
                report(at - n_gone, n_gone, companions);
                found.push(library);
                (at, n_gone) = (at + n_words, 0);
            }
            None => {
                let word = readings.run(at, 1);
                (at, n_gone) = (at + 1, n_gone + 1);
                let is_end = word.to_ascii_lowercase().ends_with(".mtl");
                if is_end || at == readings.words.len() {
                    report(at - n_gone, n_gone, companions);
                    n_gone = 0;
                }
            }
        }
    }
    (found, missing)
}

/// The materials that files define.
pub(super) struct Libraries {
    /// The first definition of each name.
    pub materials: Vec<Material>,
    /// Whether there is a statement that names a file, and each of them is there.
    is_complete: bool,
}

/// Reads the material files that an OBJ file names and warns of those that are missing.
pub(super) fn read_all(
    statements: &[String],
    companions: &mut dyn Companions,
    warnings: &mut Warnings,
) -> Libraries {
    let mut materials: Vec<Material> = Vec::new();
    let mut is_complete = !statements.is_empty();
    for statement in statements {
        let (found, missing) = find_libraries(statement, companions);
        for (name, error) in missing {
            is_complete = false;
            let name = shown_name(&name);
            warnings.add_general(format!("material file \"{name}\" is left out: {error}"));
        }
        for (name, bytes) in found {
            let (more, problems) = parse_mtl(&bytes);
            let known = materials.len();
            materials.extend(more);
            drop_repeated(&mut materials, known);
            companions.pictures(&name, &mut materials[known..], warnings);
            for problem in problems {
                warnings.add_general(format!("{}, {problem}", shown_name(&name)));
            }
        }
    }
    Libraries { materials, is_complete }
}

impl Libraries {
    /// Gives faces the names of materials that are theirs but for a comment behind the one or the
    /// other, and warns of names that no file defines.
    pub fn match_names(&self, used: &mut LabelTrack, warnings: &mut Warnings) {
        let names: HashSet<&str> = self.materials.iter().map(|m| m.name.as_str()).collect();
        let plain = self.materials.iter().rev().map(|m| (without_comment(&m.name), &m.name));
        let plain: HashMap<&str, &String> = plain.collect();
        used.rename(|name| {
            let short = without_comment(name);
            let same = names.get(short).map(|same| (*same).to_owned());
            same.or_else(|| plain.get(name).map(|same| (*same).clone()))
                .filter(|_| !names.contains(name))
        });
        for name in used.labels() {
            if self.is_complete && !names.contains(name.as_str()) {
                let name = shown_name(name);
                let text = format!("no material file defines \"{name}\", which faces use");
                warnings.add_general(text);
            }
        }
    }
}

/// Leaves out the materials from `first` on whose name came before.
fn drop_repeated(materials: &mut Vec<Material>, first: usize) {
    let mut seen = HashSet::new();
    let mut idx = 0;
    materials.retain(|material| {
        idx += 1;
        seen.insert(material.name.clone()) || idx <= first
    });
}
