//! Files that are written.

use std::path::{Path, PathBuf};

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
    /// What is written only beside files of some extension.
    pub also_writes_with: &'static [(&'static str, &'static [&'static str])],
}

impl OutputFileSpec {
    /// What is written beside a file of this name.
    pub fn beside(&self, path: &Path) -> &'static [&'static str] {
        let own = path.extension().unwrap_or_default().to_string_lossy();
        let of_own =
            self.also_writes_with.iter().find(|(known, _)| own.eq_ignore_ascii_case(known));
        of_own.map_or(self.also_writes, |(_, also)| *also)
    }
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
        let spec = OutputFileSpec { extensions, also_writes: &[], also_writes_with: &[] };
        Self::of_kind(name, doc, Kind::OutputFile(spec))
    }

    /// What is written beside an output file: see [`OutputFileSpec::also_writes`].
    pub const fn also_writes(mut self, also: &'static [&'static str]) -> Self {
        if let Kind::OutputFile(spec) = &mut self.spec.kind {
            spec.also_writes = also;
        }
        self
    }

    /// What is written beside files of each of these extensions.
    pub const fn also_writes_with(
        mut self,
        also: &'static [(&'static str, &'static [&'static str])],
    ) -> Self {
        if let Kind::OutputFile(spec) = &mut self.spec.kind {
            spec.also_writes_with = also;
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_beside_a_file_may_depend_on_its_ending() {
        let param = || Param::output_file("path", "The file.", &["a", "b"]);
        let spec = |param: Param<PathBuf>| param.spec().output_file().unwrap();
        let all = spec(param().also_writes(&["c"]));
        assert_eq!(all.beside(Path::new("x.b")), ["c"]);
        let some = spec(param().also_writes_with(&[("a", &["c"])]));
        assert_eq!(some.beside(Path::new("x.A")), ["c"]);
        assert!(some.beside(Path::new("x.b")).is_empty());
    }
}
