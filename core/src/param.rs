//! Declared settings of modules: parameters, and choices that carry parameters of their own.

use std::marker::PhantomData;
use std::path::{Path, PathBuf};

use crate::data::{Data, DataType};
use crate::listed::Listed;
use crate::setting::{Setting, Settings};

/// What the runtime knows of a parameter: the one place where its default, range, unit and text
/// stand. Forms, help, documentation and checks are drawn from it.
#[derive(Clone, Copy)]
pub struct ParamSpec {
    /// Snake case, unique among the parameters and inputs of its module.
    pub name: &'static str,
    /// What it does, in a sentence or two.
    pub doc: &'static str,
    /// Unit of the number, empty where there is none.
    pub unit: &'static str,
    /// Whether `null`, off, is a value.
    pub can_be_off: bool,
    /// Type, default and range.
    pub kind: Kind,
}

/// Type, default and range of a parameter. A default of `None` is off.
#[derive(Clone, Copy)]
#[allow(missing_docs)] // The fields are what their names say, in every variant.
pub enum Kind {
    /// `true` or `false`.
    Flag { default: bool },
    /// A whole number within `hard`, both ends included; `soft` is what a slider shows.
    Integer { default: Option<i64>, hard: (i64, i64), soft: Option<(i64, i64)> },
    /// A finite number within `hard`, both ends included; `soft` is what a slider shows.
    Number { default: Option<f64>, hard: (f64, f64), soft: Option<(f64, f64)> },
    /// A text.
    Text { default: &'static str },
    /// The number that random choices start from. Repeat `r` of a step runs with the seed plus `r`.
    Seed { default: u32 },
    /// One of some names, each with its text.
    Enumeration { default: &'static str, names: &'static [(&'static str, &'static str)] },
    /// One entry of a list, with that entry's parameters nested under it.
    Choice { default: &'static str, list: &'static dyn ChoiceList },
    /// A file that is read, relative to the map's file. `also_reads` names the files that it names.
    InputFile { extensions: &'static [&'static str], also_reads: fn(&Path) -> Vec<PathBuf> },
    /// A file that is written, relative to the output folder, as a template. `also_writes` lists
    /// the extensions of the files written beside it.
    OutputFile { extensions: &'static [&'static str], also_writes: &'static [&'static str] },
}

impl ParamSpec {
    /// The data type that a link into this parameter must carry; `None` where the parameter
    /// decides what the plan looks like, and so cannot wait for a run.
    pub fn link_type(&self) -> Option<DataType> {
        match self.kind {
            Kind::Flag { .. } => Some(bool::TYPE),
            Kind::Integer { .. } | Kind::Number { .. } | Kind::Seed { .. } => Some(f64::TYPE),
            Kind::Text { .. } | Kind::Enumeration { .. } => Some(String::TYPE),
            Kind::Choice { .. } | Kind::InputFile { .. } | Kind::OutputFile { .. } => None,
        }
    }

    /// The value that it has where a map says nothing; `None` where a map must say it.
    pub fn default_setting(&self) -> Option<Setting> {
        Some(match self.kind {
            Kind::Flag { default } => Setting::Flag(default),
            Kind::Integer { default, .. } => default.map_or(Setting::Off, Setting::Integer),
            Kind::Number { default, .. } => default.map_or(Setting::Off, Setting::Number),
            Kind::Text { default } | Kind::Enumeration { default, .. } => {
                Setting::Text(default.to_owned())
            }
            Kind::Seed { default } => Setting::Integer(i64::from(default)),
            Kind::Choice { default, list } => {
                let entry = list.find(default)?;
                Setting::Choice { id: entry.id, params: Settings::defaults(entry.params)? }
            }
            Kind::InputFile { .. } | Kind::OutputFile { .. } => return None,
        })
    }
}

/// A type that a module reads a parameter as.
pub trait ParamType: Sized {
    /// The value, from a setting that the runtime has checked; `None` if it is of another kind.
    fn from_setting(setting: &Setting) -> Option<Self>;
}

macro_rules! param_type {
    ($type:ty, $pattern:pat => $value:expr) => {
        impl ParamType for $type {
            fn from_setting(setting: &Setting) -> Option<Self> {
                match setting {
                    $pattern => Some($value),
                    _ => None,
                }
            }
        }
    };
}

param_type!(bool, Setting::Flag(flag) => *flag);
param_type!(i64, Setting::Integer(number) => *number);
param_type!(f64, Setting::Number(number) => *number);
param_type!(String, Setting::Text(text) => text.clone());
param_type!(PathBuf, Setting::File { resolved, .. } => resolved.clone());
param_type!(Seed, Setting::Integer(seed) => Seed(*seed as u64));

impl<T: ParamType> ParamType for Option<T> {
    fn from_setting(setting: &Setting) -> Option<Self> {
        match setting {
            Setting::Off => Some(None),
            other => T::from_setting(other).map(Some),
        }
    }
}

/// What random choices start from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seed(pub u64);

/// A Rust enum that is a parameter: its values by name, each with its text.
pub trait Enumeration: Copy + 'static {
    /// `(name, text)`, names in CamelCase.
    const NAMES: &'static [(&'static str, &'static str)];
    /// The values, in the order of `NAMES`.
    const VALUES: &'static [Self];
}

impl<E: Enumeration> ParamType for E {
    fn from_setting(setting: &Setting) -> Option<Self> {
        let Setting::Text(name) = setting else { return None };
        let place = E::NAMES.iter().position(|(known, _)| known == name)?;
        E::VALUES.get(place).copied()
    }
}

/// A declared parameter, typed as its module reads it.
pub struct Param<T> {
    pub(crate) spec: ParamSpec,
    of: PhantomData<fn() -> T>,
}

impl<T> Param<T> {
    const fn of_kind(name: &'static str, doc: &'static str, kind: Kind) -> Self {
        let spec = ParamSpec { name, doc, unit: "", can_be_off: false, kind };
        Self { spec, of: PhantomData }
    }

    /// The declaration, for [`crate::Module::params`] and [`Entry::params`].
    pub const fn spec(&self) -> ParamSpec {
        self.spec
    }

    /// The unit of the number: `faces`, `degrees`.
    pub const fn unit(mut self, unit: &'static str) -> Self {
        self.spec.unit = unit;
        self
    }
}

impl Param<bool> {
    /// A flag.
    pub const fn flag(name: &'static str, doc: &'static str, default: bool) -> Self {
        Self::of_kind(name, doc, Kind::Flag { default })
    }
}

macro_rules! numeric_param {
    ($type:ty, $kind:ident, $make:ident, $ends:expr, $can_be_off:expr, $($default:tt)+) => {
        impl Param<$type> {
            /// A number with its default; `None` stands for off, where the parameter can be off.
            pub const fn $make(
                name: &'static str,
                doc: &'static str,
                default: $type,
            ) -> Self {
                let default = $($default)+(default);
                let kind = Kind::$kind { default, hard: $ends, soft: None };
                let mut param = Self::of_kind(name, doc, kind);
                param.spec.can_be_off = $can_be_off;
                param
            }
        }
    };
}

const fn same<T: Copy>(value: Option<T>) -> Option<T> {
    value
}

/// Whole numbers to 2^53, which every program that reads JSON keeps exactly.
const INTEGERS: (i64, i64) = (-(1 << 53), 1 << 53);
const NUMBERS: (f64, f64) = (f64::MIN, f64::MAX);

numeric_param!(i64, Integer, integer, INTEGERS, false, Some);
numeric_param!(Option<i64>, Integer, maybe_integer, INTEGERS, true, same);
numeric_param!(f64, Number, number, NUMBERS, false, Some);
numeric_param!(Option<f64>, Number, maybe_number, NUMBERS, true, same);

/// Parameters whose values are whole numbers.
pub trait IntegerParam {}
impl IntegerParam for i64 {}
impl IntegerParam for Option<i64> {}

/// Parameters whose values are numbers.
pub trait NumberParam {}
impl NumberParam for f64 {}
impl NumberParam for Option<f64> {}

impl<T: IntegerParam> Param<T> {
    /// Both ends of what is allowed; a map outside it is refused.
    pub const fn between(mut self, ends: (i64, i64)) -> Self {
        if let Kind::Integer { default, soft, .. } = self.spec.kind {
            self.spec.kind = Kind::Integer { default, hard: ends, soft };
        }
        self
    }

    /// Both ends of what a slider shows.
    pub const fn mostly(mut self, ends: (i64, i64)) -> Self {
        if let Kind::Integer { default, hard, .. } = self.spec.kind {
            self.spec.kind = Kind::Integer { default, hard, soft: Some(ends) };
        }
        self
    }
}

impl<T: NumberParam> Param<T> {
    /// Both ends of what is allowed; a map outside it is refused.
    pub const fn within(mut self, ends: (f64, f64)) -> Self {
        if let Kind::Number { default, soft, .. } = self.spec.kind {
            self.spec.kind = Kind::Number { default, hard: ends, soft };
        }
        self
    }

    /// Both ends of what a slider shows.
    pub const fn usually(mut self, ends: (f64, f64)) -> Self {
        if let Kind::Number { default, hard, .. } = self.spec.kind {
            self.spec.kind = Kind::Number { default, hard, soft: Some(ends) };
        }
        self
    }
}

impl Param<String> {
    /// A text.
    pub const fn text(name: &'static str, doc: &'static str, default: &'static str) -> Self {
        Self::of_kind(name, doc, Kind::Text { default })
    }
}

impl Param<Seed> {
    /// A seed.
    pub const fn seed(name: &'static str, doc: &'static str, default: u32) -> Self {
        Self::of_kind(name, doc, Kind::Seed { default })
    }
}

impl<E: Enumeration> Param<E> {
    /// One of the values of `E`, by default the one of this name.
    pub const fn one_of(name: &'static str, doc: &'static str, default: &'static str) -> Self {
        Self::of_kind(name, doc, Kind::Enumeration { default, names: E::NAMES })
    }
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
        Self::of_kind(name, doc, Kind::InputFile { extensions, also_reads: none })
    }

    /// The files that an input file names, which are read with it.
    pub const fn also_reads(mut self, files: fn(&Path) -> Vec<PathBuf>) -> Self {
        if let Kind::InputFile { extensions, .. } = self.spec.kind {
            self.spec.kind = Kind::InputFile { extensions, also_reads: files };
        }
        self
    }

    /// A file to write.
    pub const fn output_file(
        name: &'static str,
        doc: &'static str,
        extensions: &'static [&'static str],
    ) -> Self {
        Self::of_kind(name, doc, Kind::OutputFile { extensions, also_writes: &[] })
    }

    /// Extensions of the files that are written beside an output file.
    pub const fn also_writes(mut self, also: &'static [&'static str]) -> Self {
        if let Kind::OutputFile { extensions, .. } = self.spec.kind {
            self.spec.kind = Kind::OutputFile { extensions, also_writes: also };
        }
        self
    }
}

/// One entry of an open list: a cost function, a placement, a metric. `B` is what the entry is
/// built with, as a rule a function pointer from [`Settings`].
pub struct Entry<B: 'static> {
    /// CamelCase, unique in its list.
    pub id: &'static str,
    /// What it is, in one sentence.
    pub summary: &'static str,
    /// Its own parameters.
    pub params: &'static [ParamSpec],
    /// What makes it.
    pub build: B,
}

/// [`Entry`] without what builds it.
#[derive(Clone, Copy)]
pub struct EntrySpec {
    /// CamelCase, unique in its list.
    pub id: &'static str,
    /// What it is, in one sentence.
    pub summary: &'static str,
    /// Its own parameters.
    pub params: &'static [ParamSpec],
    /// Hash of its source: see [`crate::source_hash`].
    pub source: u64,
}

/// A list of entries, as a static.
pub struct Choices<B: 'static> {
    /// The entries, sorted by id.
    pub entries: &'static [Listed<Entry<B>>],
}

/// [`Choices`] of any kind.
pub trait ChoiceList: Sync {
    /// How many entries there are.
    fn len(&self) -> usize;

    /// Whether there is none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The entry at this place.
    fn spec(&self, place: usize) -> EntrySpec;

    /// The entry of this id.
    fn find(&self, id: &str) -> Option<EntrySpec> {
        (0..self.len()).map(|place| self.spec(place)).find(|entry| entry.id == id)
    }
}

impl<B: Sync + 'static> ChoiceList for Choices<B> {
    fn len(&self) -> usize {
        self.entries.len()
    }

    fn spec(&self, place: usize) -> EntrySpec {
        let Listed { item, source } = self.entries[place];
        EntrySpec { id: item.id, summary: item.summary, params: item.params, source }
    }
}

/// A parameter whose value names one entry of a list.
pub struct ChoiceParam<B: 'static> {
    pub(crate) spec: ParamSpec,
    pub(crate) choices: &'static Choices<B>,
}

impl<B: Sync + 'static> ChoiceParam<B> {
    /// A choice among `choices`, by default the entry of this id.
    pub const fn new(
        name: &'static str,
        doc: &'static str,
        choices: &'static Choices<B>,
        default: &'static str,
    ) -> Self {
        let kind = Kind::Choice { default, list: choices };
        Self { spec: ParamSpec { name, doc, unit: "", can_be_off: false, kind }, choices }
    }

    /// The declaration, for [`crate::Module::params`].
    pub const fn spec(&self) -> ParamSpec {
        self.spec
    }
}

/// The entry that a choice names, with its parameters.
pub struct Chosen<B: 'static> {
    /// The entry.
    pub entry: &'static Entry<B>,
    /// Its parameters, all of them set.
    pub params: Settings,
}
