//! The kinds of parameters: what each must answer, and the table of them.
//!
//! A kind is one file of this folder and one line of the table. All that is asked of a parameter
//! (its JSON, default, place in keys, links, schema, documentation, examples) is asked here;
//! nothing else in the runtime looks at which kind a parameter is of. The window draws each kind in
//! `app/editor/src/forms/field.rs`.

mod range;

pub use range::{NumericRange, RangeSpec};
use serde_json::Value as Json;

use super::{Fault, Misfit, OptionSpec, ParamSpec, Setting};
use crate::data::DataType;
use crate::fingerprint::FingerprintBuilder;
use crate::port::InputSpec;

/// What every kind of parameter answers for itself.
pub(crate) trait ParamKind {
    /// The default as a map would say it, in its shortest form; `None` where a map must say it.
    fn default_json(&self) -> Option<Json> {
        None
    }

    /// Reads JSON that is not off. Faults of parts, such as the parameters of a choice's entry, are
    /// pushed to `faults`, with paths below this parameter; what can stand is given all the same.
    fn parse(&self, json: &Json, faults: &mut Vec<Fault>) -> Result<Setting, Misfit>;

    /// Its JSON schema, without text, default and `null`.
    fn schema(&self) -> Json;

    /// What it is, for the documentation: `number from 0 to 1`.
    fn noun(&self) -> String;

    /// What is wrong with its declaration, in a module with these inputs.
    fn fault(&self, _: &[InputSpec]) -> Option<String> {
        None
    }

    /// Values at the ends of what it allows, for tests of modules; none where they need files.
    fn examples(&self) -> Vec<Json> {
        Vec::new()
    }

    /// The type that a link must carry; `None` where its value cannot wait for a run.
    fn link_type(&self) -> Option<DataType> {
        None
    }

    /// What is said where a map must say it and does not.
    fn unset(&self) -> &'static str {
        "must be set: there is no default"
    }

    /// The names that a value may be, each with the parameters below it.
    fn options(&self) -> Vec<OptionSpec> {
        Vec::new()
    }

    /// What the documentation lists below it.
    fn parts(&self) -> Vec<OptionSpec> {
        self.options()
    }

    /// A value for one that was off.
    fn value_when_on(&self) -> Option<Json> {
        self.default_json()
    }

    /// Another value worth comparing with this one.
    fn another(&self, value: &Json) -> Json {
        value.clone()
    }

    /// The value in a few characters, where its JSON does not do.
    fn summary(&self, _: &Json) -> Option<String> {
        None
    }

    /// Adds a value to a key.
    fn write_key(&self, setting: &Setting, key: &mut FingerprintBuilder) {
        setting.write_key(key);
    }

    /// Changes a value for a repeat, from 0.
    fn repeat(&self, _: &mut Setting, _: u32) {}
}

/// Declares the files of the kinds, [`Kind`] over them, and what tells of which a parameter is.
macro_rules! kinds {
    ($($(#[$doc:meta])* $kind:ident($spec:ident) in $file:ident,)+) => {
        $(mod $file;)+
        $(pub use $file::*;)+

        /// Type, default and range of a parameter.
        #[derive(Clone, Copy)]
        pub enum Kind {
            $($(#[$doc])* $kind($spec),)+
        }

        impl Kind {
            /// The kind, as what answers for it.
            pub(crate) fn answers(&self) -> &dyn ParamKind {
                match self {
                    $(Self::$kind(spec) => spec,)+
                }
            }
        }

        impl ParamSpec {
            $(
                /// What is declared of a parameter of this kind:
                $(#[$doc])*
                pub fn $file(&self) -> Option<$spec> {
                    match self.kind {
                        Kind::$kind(spec) => Some(spec),
                        _ => None,
                    }
                }
            )+
        }
    };
}

kinds! {
    /// `true` or `false`.
    Flag(FlagSpec) in flag,
    /// A whole number.
    Integer(IntegerSpec) in integer,
    /// A finite number.
    Number(NumberSpec) in number,
    /// A text.
    Text(TextSpec) in text,
    /// The number that random choices start from.
    Seed(SeedSpec) in seed,
    /// One of some names, each with its text.
    Enumeration(EnumerationSpec) in enumeration,
    /// One entry of a list, with that entry's parameters nested under it.
    Choice(ChoiceSpec) in choice,
    /// A file that is read.
    InputFile(InputFileSpec) in input_file,
    /// A file that is written.
    OutputFile(OutputFileSpec) in output_file,
    /// Named points, on a mesh or free in space.
    Points(PointsSpec) in points,
    /// Faces or vertices of a mesh.
    Selection(SelectionSpec) in selection,
    /// A formula over declared variables.
    Expression(ExpressionSpec) in expression,
    /// An outside program with its arguments.
    CommandLine(CommandLineSpec) in command_line,
}
