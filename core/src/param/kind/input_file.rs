//! Files that are read.

use std::path::{Path, PathBuf};

use serde_json::{Value as Json, json};

use super::super::{Fault, Param, ParamType, Setting};
use super::{Kind, Misfit, ParamKind};
use crate::fingerprint::FingerprintBuilder;
use crate::port::InputSpec;

/// A file that is read, relative to the map's file.
#[derive(Clone, Copy, Debug)]
pub struct InputFileSpec {
    /// Extensions that fit, without dots; none where all do.
    pub extensions: &'static [&'static str],
    /// The files that it names, which are read with it.
    pub also_reads: fn(&Path) -> Vec<PathBuf>,
    /// The content of a small one, for tests of modules; empty where they have a file.
    pub example: &'static [u8],
}

/// The path of a file, read or written.
pub(super) fn parse_path(json: &Json) -> Result<Setting, Misfit> {
    match json.as_str() {
        Some("") | None => Err(Misfit::Expected("the path of a file".to_owned())),
        Some(path) => Ok(Setting::File { written: path.to_owned(), resolved: PathBuf::new() }),
    }
}

pub(super) fn ending(extensions: &[&str]) -> String {
    if extensions.is_empty() { String::new() } else { format!(" .{}", extensions.join(", .")) }
}

impl ParamKind for InputFileSpec {
    fn parse(&self, json: &Json, _: &mut Vec<Fault>) -> Result<Setting, Misfit> {
        parse_path(json)
    }

    fn schema(&self) -> Json {
        json!({ "type": "string", "minLength": 1 })
    }

    fn noun(&self) -> String {
        format!("input file{}", ending(self.extensions))
    }

    fn unset(&self) -> &'static str {
        "choose a file"
    }

    fn summary(&self, value: &Json) -> Option<String> {
        value.as_str()?.rsplit(['/', '\\']).next().map(str::to_owned)
    }

    /// Who looks for the reader of a file puts its ending into small letters first.
    fn fault(&self, _: &[InputSpec]) -> Option<String> {
        let is_plain = |ending: &&&str| {
            !ending.is_empty()
                && !ending.starts_with('.')
                && !ending.contains(|c: char| c.is_uppercase() || c.is_whitespace())
        };
        let wrong = self.extensions.iter().find(|ending| !is_plain(ending))?;
        Some(format!("\"{wrong}\" is no ending in small letters without its dot"))
    }

    /// The key has the content of the file, not its name.
    fn write_key(&self, _: &Setting, _: &mut FingerprintBuilder) {}
}

impl Param<PathBuf> {
    /// A file to read. Its content is part of what determines the module's outputs.
    pub const fn input_file(
        name: &'static str,
        doc: &'static str,
        extensions: &'static [&'static str],
    ) -> Self {
        fn none(_: &Path) -> Vec<PathBuf> {
            Vec::new()
        }
        let spec = InputFileSpec { extensions, also_reads: none, example: &[] };
        Self::of_kind(name, doc, Kind::InputFile(spec))
    }

    /// The content of a small file of the format: tests call the module on it, whole and damaged.
    pub const fn example(mut self, content: &'static [u8]) -> Self {
        if let Kind::InputFile(spec) = &mut self.spec.kind {
            spec.example = content;
        }
        self
    }

    /// The files that an input file names, which are read with it.
    pub const fn also_reads(mut self, files: fn(&Path) -> Vec<PathBuf>) -> Self {
        if let Kind::InputFile(spec) = &mut self.spec.kind {
            spec.also_reads = files;
        }
        self
    }
}

impl ParamType for PathBuf {
    fn from_setting(setting: &Setting) -> Option<Self> {
        match setting {
            Setting::File { resolved, .. } => Some(resolved.clone()),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endings_are_declared_as_they_are_looked_for() {
        let fault = |endings: &'static [&'static str]| {
            Param::input_file("path", "The file.", endings).spec().fault(&[])
        };
        assert_eq!(fault(&["obj", "tar.gz"]), None);
        assert_eq!(fault(&[]), None);
        for (wrong, endings) in [(".off", &["off", ".off"]), ("OFF", &["off", "OFF"])] {
            let said = fault(endings).unwrap();
            assert!(said.contains(&format!("\"{wrong}\"")), "{said}");
        }
    }
}
