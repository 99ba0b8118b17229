//! Outside programs with their arguments: what a module runs beside mve.
//!
//! The JSON is a list with the program first. A text is split as a shell splits it, by blanks, with
//! quotes and backslashes; but there is no shell, so nothing is expanded, piped or redirected.
//! What stands in an argument as `{in.mesh:ply}` or `{out.mesh:ply}` is the path of a file that the
//! module writes beforehand or reads afterwards, and `{file:tools/fix.py}` that of a file beside
//! the map, whose content is part of the key as the program's is. A program without a slash is
//! looked for in `PATH`, one with a slash is relative to the map's file.
//!
//! A plan refuses to run it unless a person has allowed that: see [`CommandScope`].

use std::collections::BTreeSet;
use std::fmt;
use std::path::{Path, PathBuf};

use serde_json::{Value as Json, json};

use super::super::{Fault, Param, ParamSpec, ParamType, Setting, Structured};
use super::{EntrySpec, Kind, Misfit, ParamKind};
use crate::fingerprint::FingerprintBuilder;
use crate::problem::did_you_mean;

/// Longest command, in bytes of all arguments: what any system passes on.
const LONGEST: usize = 100_000;

/// What begins a place for a file beside the map.
const FILE: &str = "file:";

/// An outside program with its arguments; there is no default.
#[derive(Clone, Copy, Debug)]
pub struct CommandLineSpec {
    /// Names that `{in.NAME}` takes: what the module writes for the program.
    pub reads: &'static [&'static str],
    /// Names that `{out.NAME}` takes: what the module reads when the program has ended.
    pub writes: &'static [&'static str],
    /// Endings of files that the module writes and reads, the usual one first.
    pub endings: &'static [&'static str],
}

/// A program and its arguments.
#[derive(Clone, Debug, PartialEq)]
pub struct CommandLine {
    /// As the map says them, the program first.
    words: Vec<String>,
    arguments: Vec<Vec<Piece>>,
    /// Where the program is, once a plan has found it.
    program: PathBuf,
}

#[derive(Clone, Debug, PartialEq)]
enum Piece {
    Literal(String),
    Place(CommandPlace),
    /// As the map says it, and where it is.
    File(String, PathBuf),
}

/// A place in a command line that stands for a file of the module.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct CommandPlace {
    /// Whether the module writes it, or reads it.
    pub way: CommandWay,
    /// One of the names that are declared.
    pub name: String,
    /// One of the endings that are declared.
    pub ending: String,
}

/// Which way a file goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum CommandWay {
    /// From the module to the program.
    In,
    /// From the program to the module.
    Out,
}

impl fmt::Display for CommandPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let way = if self.way == CommandWay::In { "in" } else { "out" };
        write!(f, "{{{way}.{}:{}}}", self.name, self.ending)
    }
}

/// Which outside programs a plan may run.
#[derive(Clone, Copy, Debug, Default)]
pub enum CommandScope<'a> {
    /// None: the map may come from a stranger.
    #[default]
    Nothing,
    /// Those that a person has seen as [`CommandLine`] writes them, and allowed.
    Seen(&'a BTreeSet<String>),
    /// All: for maps that one trusts, and for plans that are never run.
    All,
}

impl CommandScope<'_> {
    /// Whether this command may run.
    pub fn allows(self, line: &CommandLine) -> bool {
        match self {
            Self::Nothing => false,
            Self::Seen(seen) => seen.contains(&line.to_string()),
            Self::All => true,
        }
    }
}

/// As a shell would take it, and as it is read again; the same for no two commands.
impl fmt::Display for CommandLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (place, word) in self.words.iter().enumerate() {
            let is_plain = |c: char| c.is_alphanumeric() || "_-./:=,+@%{}".contains(c);
            let blank = if place == 0 { "" } else { " " };
            match !word.is_empty() && word.chars().all(is_plain) {
                true => write!(f, "{blank}{word}")?,
                false => write!(f, "{blank}'{}'", word.replace('\'', "'\\''"))?,
            }
        }
        Ok(())
    }
}

impl CommandLine {
    /// The program, once a plan has found it.
    pub fn program(&self) -> &Path {
        &self.program
    }

    /// The files of the module that it names, each once.
    pub fn places(&self) -> BTreeSet<&CommandPlace> {
        let pieces = self.arguments.iter().flatten();
        let places = pieces.filter_map(|piece| match piece {
            Piece::Place(place) => Some(place),
            _ => None,
        });
        places.collect()
    }

    /// The arguments behind the program, with `path_of` for the files of the module.
    pub fn arguments(&self, path_of: impl Fn(&CommandPlace) -> PathBuf) -> Vec<std::ffi::OsString> {
        let text = |pieces: &Vec<Piece>| {
            let mut text = std::ffi::OsString::new();
            for piece in pieces {
                match piece {
                    Piece::Literal(literal) => text.push(literal),
                    Piece::Place(place) => text.push(path_of(place)),
                    Piece::File(_, path) => text.push(path),
                }
            }
            text
        };
        self.arguments.iter().skip(1).map(text).collect()
    }

    /// Finds the program and the files beside the map; gives their paths, the program's first. The
    /// error is a sentence.
    pub(crate) fn locate(&mut self, folder: &Path) -> Result<Vec<PathBuf>, String> {
        // Behind a link of a folder `..` leads elsewhere, so the path stays as it is written.
        let below = |path: &str| std::path::absolute(folder.join(path)).unwrap_or_default();
        for piece in self.arguments.iter_mut().flatten() {
            if let Piece::File(written, path) = piece {
                *path = below(written);
            }
        }
        let name = self.words.first().map_or("", String::as_str);
        self.program = match self.arguments.first().map(Vec::as_slice) {
            Some([Piece::File(_, path)]) => path.clone(),
            _ if name.contains(['/', std::path::MAIN_SEPARATOR]) => below(name),
            _ => find_program(name).ok_or_else(|| {
                format!(
                    "there is no program \"{name}\" in the folders of PATH; install it, or name \
                     its file with a slash, as seen from the map"
                )
            })?,
        };
        let file = |piece: &Piece| match piece {
            Piece::File(_, path) => Some(path.clone()),
            _ => None,
        };
        let files = self.arguments.iter().skip(1).flatten().filter_map(file);
        Ok(std::iter::once(self.program.clone()).chain(files).collect())
    }

    /// As a map says it.
    pub fn to_json(&self) -> Json {
        json!(self.words)
    }
}

/// The first file of this name in the folders of `PATH` that may be run.
fn find_program(name: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    let names = [name.to_owned(), format!("{name}{}", std::env::consts::EXE_SUFFIX)];
    let mut all = std::env::split_paths(&path).filter(|folder| folder.is_absolute());
    all.find_map(|folder| names.iter().map(|name| folder.join(name)).find(|file| may_run(file)))
}

/// Whether it is a file that may be run.
fn may_run(path: &Path) -> bool {
    let Ok(about) = std::fs::metadata(path) else { return false };
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        about.is_file() && about.permissions().mode() & 0o111 != 0
    }
    #[cfg(not(unix))]
    about.is_file()
}

/// Splits a text as a shell does, and expands nothing.
fn split(text: &str) -> Result<Vec<String>, String> {
    let mut words: Vec<String> = Vec::new();
    let mut letters = text.chars();
    // The word that is read, and whether some of it was quoted.
    let mut word: Option<(String, bool)> = None;
    while let Some(c) = letters.next() {
        if c.is_whitespace() {
            end_word(&mut word, &mut words)?;
            continue;
        }
        let (word, is_quoted) = word.get_or_insert_default();
        match c {
            '\'' | '"' => {
                *is_quoted = true;
                loop {
                    match letters.next() {
                        None => return Err(format!("a {c} has no other one that ends it")),
                        Some(end) if end == c => break,
                        Some('\\') if c == '"' => word.extend(letters.next()),
                        Some(inside) => word.push(inside),
                    }
                }
            }
            '\\' => {
                *is_quoted = true;
                word.push(letters.next().ok_or("a \\ stands at the end, with nothing behind it")?);
            }
            c => word.push(c),
        }
    }
    end_word(&mut word, &mut words)?;
    Ok(words)
}

/// Ends a word; refuses what only a shell could do.
fn end_word(word: &mut Option<(String, bool)>, words: &mut Vec<String>) -> Result<(), String> {
    let Some((word, is_quoted)) = word.take() else { return Ok(()) };
    let is_of_shell =
        matches!(&*word, "|" | "||" | "&" | "&&" | ";") || word.starts_with(['>', '<']);
    if is_of_shell && !is_quoted {
        return Err(format!(
            "there is no shell, so \"{word}\" joins or redirects nothing; put it into quotes if it \
             is for the program"
        ));
    }
    words.push(word);
    Ok(())
}

impl CommandLineSpec {
    /// Reads the JSON of a command; the error is a sentence.
    pub fn read(&self, json: &Json) -> Result<CommandLine, String> {
        let words = match json {
            Json::String(text) => split(text)?,
            Json::Array(list) => {
                let word = |json: &Json| match json {
                    Json::String(text) => Ok(text.clone()),
                    Json::Number(number) => Ok(number.to_string()),
                    other => Err(format!("{other} is no text, as arguments are")),
                };
                list.iter().map(word).collect::<Result<_, _>>()?
            }
            _ => return Err("is no list of the program and its arguments".to_owned()),
        };
        if words.iter().map(String::len).sum::<usize>() > LONGEST {
            return Err(format!("is longer than {LONGEST} bytes"));
        }
        if words.iter().any(|word| word.contains('\0')) {
            return Err("an argument cannot hold the character 0".to_owned());
        }
        let arguments: Vec<_> =
            words.iter().map(|word| self.pieces(word)).collect::<Result<_, _>>()?;
        match arguments.first().map(Vec::as_slice) {
            Some([Piece::Literal(name)]) if !name.is_empty() => {}
            Some([Piece::File(..)]) => {}
            _ => return Err("the first word must be a program".to_owned()),
        }
        Ok(CommandLine { words, arguments, program: PathBuf::new() })
    }

    /// Splits an argument at its places. Braces that hold none stay.
    fn pieces(&self, word: &str) -> Result<Vec<Piece>, String> {
        let mut pieces = Vec::new();
        let mut literal = String::new();
        let mut rest = word;
        while let Some((before, from)) = rest.split_once('{') {
            literal.push_str(before);
            match from.split_once('}').map(|(inside, after)| (self.place(inside), after)) {
                Some((Some(place), after)) => {
                    if !literal.is_empty() {
                        pieces.push(Piece::Literal(std::mem::take(&mut literal)));
                    }
                    pieces.push(place?);
                    rest = after;
                }
                _ => {
                    literal.push('{');
                    rest = from;
                }
            }
        }
        literal.push_str(rest);
        if !literal.is_empty() || pieces.is_empty() {
            pieces.push(Piece::Literal(literal));
        }
        Ok(pieces)
    }

    /// What stands in braces; `None` where it is not meant for mve.
    fn place(&self, inside: &str) -> Option<Result<Piece, String>> {
        if let Some(path) = inside.strip_prefix(FILE) {
            let file = Piece::File(path.to_owned(), PathBuf::new());
            let fault = || format!("{{{inside}}} names no file");
            return Some(if path.is_empty() { Err(fault()) } else { Ok(file) });
        }
        let (way, name) = inside.split_once('.')?;
        let (way, names) = match way {
            "in" => (CommandWay::In, self.reads),
            "out" => (CommandWay::Out, self.writes),
            _ => return None,
        };
        let usual = self.endings.first().copied().unwrap_or_default();
        let (name, ending) = name.split_once(':').unwrap_or((name, usual));
        let one_of = |what: &str, all: &[&str]| {
            let hint = did_you_mean(what, all.iter().copied());
            format!("{{{inside}}}: there is no \"{what}\"; write one of {}{hint}", all.join(", "))
        };
        Some(if !names.contains(&name) {
            Err(one_of(name, names))
        } else if !self.endings.contains(&ending) {
            Err(one_of(ending, self.endings))
        } else {
            let (name, ending) = (name.to_owned(), ending.to_owned());
            Ok(Piece::Place(CommandPlace { way, name, ending }))
        })
    }
}

impl ParamKind for CommandLineSpec {
    fn parse(&self, json: &Json, _: &mut Vec<Fault>) -> Result<Setting, Misfit> {
        let line = self.read(json).map_err(Misfit::Sentence)?;
        Ok(Setting::Structured(Structured::new(line.to_json(), line)))
    }

    fn schema(&self) -> Json {
        let word = json!({ "type": ["string", "number"] });
        json!({ "anyOf": [
            { "type": "array", "items": word, "minItems": 1 },
            { "type": "string", "minLength": 1 }
        ] })
    }

    fn noun(&self) -> String {
        "outside program with its arguments".to_owned()
    }

    fn unset(&self) -> &'static str {
        "name a program and its arguments"
    }

    fn summary(&self, value: &Json) -> Option<String> {
        self.read(value).ok()?.words.into_iter().next()
    }

    /// The key has the content of files and of the program, which the plan adds, not their paths;
    /// the name of a program stays, as some do by it what they do.
    fn write_key(&self, setting: &Setting, key: &mut FingerprintBuilder) {
        let Some(line) = setting.structured::<CommandLine>() else { return };
        for (place, pieces) in line.arguments.iter().enumerate() {
            key.part(&pieces.len().to_le_bytes());
            for piece in pieces {
                match piece {
                    Piece::File(..) => key.text(FILE),
                    Piece::Place(place) => key.text(&place.to_string()),
                    Piece::Literal(name) if place == 0 => {
                        key.text(name.rsplit('/').next().unwrap_or_default());
                    }
                    Piece::Literal(literal) => key.text(literal),
                }
            }
        }
    }
}

impl ParamSpec {
    /// Whether it is an outside program, or has one among the parameters of an entry.
    pub(crate) fn runs_programs(&self) -> bool {
        let below = |entry: EntrySpec| entry.params.iter().any(Self::runs_programs);
        self.command_line().is_some()
            || self.choice().is_some_and(|choice| choice.entries().any(below))
    }
}

impl Param<CommandLine> {
    /// An outside program and its arguments.
    pub const fn command_line(
        name: &'static str,
        doc: &'static str,
        spec: CommandLineSpec,
    ) -> Self {
        Self::of_kind(name, doc, Kind::CommandLine(spec))
    }
}

impl ParamType for CommandLine {
    fn from_setting(setting: &Setting) -> Option<Self> {
        setting.structured()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPEC: CommandLineSpec =
        CommandLineSpec { reads: &["mesh", "other"], writes: &["mesh"], endings: &["ply", "obj"] };

    fn said(json: Json) -> String {
        SPEC.read(&json).unwrap_err()
    }

    #[test]
    fn a_text_is_split_as_a_shell_splits_it() {
        let words = |text: &str| SPEC.read(&json!(text)).unwrap().words;
        assert_eq!(words(r#"a  b\ c 'd "e' "f 'g\"" ''"#), ["a", "b c", "d \"e", "f 'g\"", ""]);
        assert_eq!(words("awk '{print $1 > \"x\"}' '|'"), ["awk", "{print $1 > \"x\"}", "|"]);
        for (text, part) in [("a 'b", "a ' has no"), ("a \\", "a \\ stands"), ("a | b", "no shell")]
        {
            assert!(said(json!(text)).contains(part), "{text}");
        }
        assert!(said(json!("a >x")).contains("\">x\" joins or redirects nothing"));
        for none in [json!(""), json!([]), json!("{in.mesh} a"), json!([""])] {
            assert!(said(none.clone()).contains("must be a program"), "{none}");
        }
    }

    #[test]
    fn what_is_shown_is_read_again_and_is_of_one_command() {
        let hard = json!(["a b", "it's", "", "{in.mesh}", "\u{1b}[31m", "x;y", "\\"]);
        let line = SPEC.read(&hard).unwrap();
        assert_eq!(SPEC.read(&json!(line.to_string())), Ok(line.clone()));
        assert_eq!(line.to_json(), hard);
        let shown = SPEC.read(&json!(["a", "b c"])).unwrap().to_string();
        assert_ne!(shown, SPEC.read(&json!(["a", "b", "c"])).unwrap().to_string());
        assert_eq!(shown, "a 'b c'");
    }

    #[test]
    fn places_are_those_that_are_declared() {
        let line =
            json!(["p", "-i={in.mesh}", "{out.mesh:obj}", "{in.mesh}", "{print}", "{in}", 5]);
        let line = SPEC.read(&line).unwrap();
        let shown: Vec<String> = line.places().iter().map(ToString::to_string).collect();
        assert_eq!(shown, ["{in.mesh:ply}", "{out.mesh:obj}"]);
        let path = |place: &CommandPlace| PathBuf::from(format!("/s/{}", place.ending));
        let all = ["-i=/s/ply", "/s/obj", "/s/ply", "{print}", "{in}", "5"];
        assert_eq!(line.arguments(path), all);
        let unknown = said(json!(["p", "{in.meshh}"]));
        assert!(unknown.contains("no \"meshh\"; write one of mesh, other; did you"), "{unknown}");
        assert!(said(json!(["p", "{out.mesh:blend}"])).contains("one of ply, obj"));
        assert!(said(json!(["p", "{out.other}"])).contains("no \"other\""));
        assert!(said(json!(["p", null])).contains("null is no text"));
    }

    #[test]
    fn files_are_beside_the_map_and_programs_in_the_path() {
        let mut line = SPEC.read(&json!(["tools/a", "{file:b.py}"])).unwrap();
        let found = line.locate(Path::new("/maps")).unwrap();
        assert_eq!(found, [Path::new("/maps/tools/a"), Path::new("/maps/b.py")]);
        assert_eq!(line.arguments(|_| PathBuf::new()), ["/maps/b.py"]);
        let mut line = SPEC.read(&json!("no-program-has-this-name x")).unwrap();
        let missing = line.locate(Path::new("/maps")).unwrap_err();
        assert!(missing.contains("no program \"no-program-has-this-name\""), "{missing}");
    }

    #[test]
    fn only_what_was_seen_may_run() {
        let line = SPEC.read(&json!(["a", "b c"])).unwrap();
        let seen = BTreeSet::from(["a 'b c'".to_owned()]);
        assert!(CommandScope::Seen(&seen).allows(&line) && CommandScope::All.allows(&line));
        let other = SPEC.read(&json!(["a", "b", "c"])).unwrap();
        assert!(!CommandScope::Seen(&seen).allows(&other) && !CommandScope::Nothing.allows(&line));
    }
}
