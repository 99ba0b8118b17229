//! Declared settings of modules: parameters, and choices that carry parameters of their own.
//!
//! [`ParamSpec`] is the declaration and [`Param`] the same, typed; `kind/` has what each kind of
//! parameter is, `json` the form that maps write it in, and `setting` the checked values.

mod json;
mod kind;
mod object_schema;
mod setting;

use std::fmt;
use std::marker::PhantomData;

use serde_json::Value as Json;

pub use json::{MODULE, all_given, chosen, declared_at, given_at, given_at_mut, with_param};
pub use kind::*;
pub(crate) use object_schema::object_of;
pub(crate) use setting::{Fault, Misfit, shown};
pub use setting::{Setting, Settings, Structured};

use crate::data::DataType;
use crate::port::InputSpec;

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
    /// Where alone it counts; `None` for everywhere.
    pub counts: Option<Condition>,
    /// The value where a map says nothing, in place of that of its kind: what a map as a node of
    /// another one says inside.
    pub preset: Option<&'static Json>,
    /// Type, default and range.
    pub kind: Kind,
}

/// What another parameter beside it must be for a parameter to count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Condition {
    /// This name.
    Is {
        /// The other parameter.
        param: &'static str,
        /// An entry, or a value of an enumeration.
        value: &'static str,
    },
    /// Off.
    IsOff {
        /// The other parameter.
        param: &'static str,
    },
}

impl fmt::Display for Condition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Is { param, value } => write!(f, "{param} is {value}"),
            Self::IsOff { param } => write!(f, "{param} is off"),
        }
    }
}

/// A name that a value may be: an entry of a choice, one of an enumeration, or a module.
#[derive(Clone, Copy)]
pub struct OptionSpec {
    /// What a map says.
    pub id: &'static str,
    /// What it is.
    pub summary: &'static str,
    /// Its own parameters.
    pub params: &'static [ParamSpec],
}

impl ParamSpec {
    /// The data type that a link into this parameter must carry; `None` where the parameter
    /// decides what the plan looks like, and so cannot wait for a run.
    pub fn link_type(&self) -> Option<DataType> {
        self.kind.answers().link_type()
    }

    /// The value that it has where a map says nothing, as a map would say it in the shortest form:
    /// a choice by its id alone. `None` where a map must say it.
    pub fn default_json(&self) -> Option<Json> {
        self.preset.cloned().or_else(|| self.kind.answers().default_json())
    }

    /// The value that it has where a map says nothing; `None` where a map must say it, or must say
    /// a parameter of the entry that a choice has by default.
    pub fn default_setting(&self) -> Option<Setting> {
        let mut faults = Vec::new();
        let setting = self.parse(&self.default_json()?, &mut faults);
        setting.filter(|_| faults.is_empty())
    }

    /// Whether it is off where a map says nothing.
    pub fn is_off_by_default(&self) -> bool {
        self.default_json().is_some_and(|json| json.is_null())
    }

    /// A value for a parameter that was off: its default, or the middle of what is usual.
    pub fn value_when_on(&self) -> Option<Json> {
        self.kind.answers().value_when_on()
    }

    /// Another value worth comparing with this one; the same where none suggests itself.
    pub fn another(&self, value: &Json) -> Json {
        match value {
            Json::Null => self.value_when_on().unwrap_or_default(),
            _ => self.kind.answers().another(value),
        }
    }

    /// Values at the ends of what it allows, for tests of modules; none for files.
    pub fn examples(&self) -> Vec<Json> {
        self.kind.answers().examples()
    }

    /// The names that a value may be, each with the parameters below it; empty for most kinds.
    pub fn options(&self) -> Vec<OptionSpec> {
        self.kind.answers().options()
    }

    /// The value in a few characters, where its JSON does not do: a choice is its id.
    pub fn summary(&self, value: &Json) -> Option<String> {
        self.kind.answers().summary(value)
    }

    /// What is wrong with the declaration, in a module with these inputs.
    pub fn fault(&self, inputs: &[InputSpec]) -> Option<String> {
        let fault = self.kind.answers().fault(inputs)?;
        Some(format!("{}: {fault}", self.name))
    }

    /// Reads JSON as this parameter; the error says what is wrong, with the dotted path where that
    /// is below this parameter.
    pub fn read(&self, json: &Json) -> Result<Setting, String> {
        let mut faults = Vec::new();
        let setting = self.parse(json, &mut faults);
        let text = |fault: Fault| match fault.path == self.name {
            true => fault.message,
            false => format!("{}: {}", fault.path, fault.message),
        };
        match (setting, faults.into_iter().next()) {
            (Some(setting), None) => Ok(setting),
            (_, fault) => Err(fault.map(text).unwrap_or_default()),
        }
    }
}

/// A type that a module reads a parameter as.
pub trait ParamType: Sized {
    /// The value, from a setting that the runtime has checked; `None` if it is of another kind.
    fn from_setting(setting: &Setting) -> Option<Self>;
}

impl<T: ParamType> ParamType for Option<T> {
    fn from_setting(setting: &Setting) -> Option<Self> {
        match setting {
            Setting::Off => Some(None),
            other => T::from_setting(other).map(Some),
        }
    }
}

/// A declared parameter, typed as its module reads it.
pub struct Param<T> {
    pub(crate) spec: ParamSpec,
    of: PhantomData<fn() -> T>,
}

impl<T> Clone for Param<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Param<T> {}

impl<T> Param<T> {
    const fn of_kind(name: &'static str, doc: &'static str, kind: Kind) -> Self {
        let (unit, can_be_off, counts, preset) = ("", false, None, None);
        let spec = ParamSpec { name, doc, unit, can_be_off, counts, preset, kind };
        Self { spec, of: PhantomData }
    }

    /// The declaration, for [`crate::Module::params`] and [`Entry::params`].
    pub const fn spec(&self) -> ParamSpec {
        self.spec
    }

    const fn or_off(mut self) -> Self {
        self.spec.can_be_off = true;
        self
    }

    /// Counts only under this condition: who sets it elsewhere is told that it has no effect.
    pub const fn only_where(mut self, condition: Condition) -> Self {
        self.spec.counts = Some(condition);
        self
    }

    /// The unit of the number: `faces`, `degrees`.
    pub const fn unit(mut self, unit: &'static str) -> Self {
        self.spec.unit = unit;
        self
    }
}
