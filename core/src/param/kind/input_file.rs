//! Files that are read.

use std::path::{Path, PathBuf};

use serde_json::{Value as Json, json};

use super::super::{Fault, Param, ParamType, Setting};
use super::{Kind, Misfit, ParamKind};
use crate::fingerprint::FingerprintBuilder;

/// A file that is read, relative to the map's file.
#[derive(Clone, Copy, Debug)]
pub struct InputFileSpec {
    /// Extensions that fit, without dots; none where all do.
    pub extensions: &'static [&'static str],
    /// The files that it names, which are read with it.
    pub also_reads: fn(&Path) -> Vec<PathBuf>,
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
        Self::of_kind(name, doc, Kind::InputFile(InputFileSpec { extensions, also_reads: none }))
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
