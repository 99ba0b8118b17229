//! Files that are written.

use std::path::PathBuf;

use serde_json::{Value as Json, json};

use super::super::{Fault, Param, Setting};
use super::input_file::{ending, parse_path};
use super::{Kind, Misfit, ParamKind};

/// A file that is written, relative to the output folder, as a template.
#[derive(Clone, Copy, Debug)]
pub struct OutputFileSpec {
    /// Extensions that fit, without dots; none where all do.
    pub extensions: &'static [&'static str],
    /// What is written beside it: the extension of a file; or, where it ends in `/`, what follows
    /// the stem in the name of a folder for any files, into which nothing else may write.
    pub also_writes: &'static [&'static str],
}

impl ParamKind for OutputFileSpec {
    fn parse(&self, json: &Json, _: &mut Vec<Fault>) -> Result<Setting, Misfit> {
        parse_path(json)
    }

    fn schema(&self) -> Json {
        json!({ "type": "string", "minLength": 1 })
    }

    fn noun(&self) -> String {
        format!("output file{}", ending(self.extensions))
    }
}

impl Param<PathBuf> {
    /// A file to write.
    pub const fn output_file(
        name: &'static str,
        doc: &'static str,
        extensions: &'static [&'static str],
    ) -> Self {
        Self::of_kind(name, doc, Kind::OutputFile(OutputFileSpec { extensions, also_writes: &[] }))
    }

    /// What is written beside an output file: see [`OutputFileSpec::also_writes`].
    pub const fn also_writes(mut self, also: &'static [&'static str]) -> Self {
        if let Kind::OutputFile(spec) = &mut self.spec.kind {
            spec.also_writes = also;
        }
        self
    }
}
