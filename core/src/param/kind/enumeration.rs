//! One of some names.

use serde_json::{Value as Json, json};

use super::super::{Fault, OptionSpec, Param, ParamType, Setting};
use super::{Kind, Misfit, ParamKind};
use crate::data::{Data, DataType};
use crate::port::InputSpec;
use crate::problem::did_you_mean;

/// One of some names, each with its text.
#[derive(Clone, Copy, Debug)]
pub struct EnumerationSpec {
    /// Where a map says nothing.
    pub default: &'static str,
    /// The names, each with its text.
    pub names: &'static [(&'static str, &'static str)],
}

/// A Rust enum that is a parameter: its values by name, each with its text.
pub trait Enumeration: Copy + 'static {
    /// `(name, text)`, names in CamelCase.
    const NAMES: &'static [(&'static str, &'static str)];
    /// The values, in the order of `NAMES`.
    const VALUES: &'static [Self];
}

impl EnumerationSpec {
    fn ids(&self) -> impl Iterator<Item = &'static str> {
        self.names.iter().map(|(name, _)| *name)
    }
}

impl ParamKind for EnumerationSpec {
    fn default_json(&self) -> Option<Json> {
        Some(Json::from(self.default))
    }

    fn parse(&self, json: &Json, _: &mut Vec<Fault>) -> Result<Setting, Misfit> {
        match json.as_str() {
            Some(name) if self.ids().any(|id| id == name) => Ok(Setting::Text(name.to_owned())),
            other => {
                let hint = other.map(|name| did_you_mean(name, self.ids())).unwrap_or_default();
                let all = self.ids().collect::<Vec<_>>().join(", ");
                Err(Misfit::Expected(format!("one of {all}{hint}")))
            }
        }
    }

    fn schema(&self) -> Json {
        let names = self.names.iter();
        let each = names.map(|(name, doc)| json!({ "const": name, "description": doc }));
        json!({ "anyOf": each.collect::<Vec<_>>() })
    }

    fn noun(&self) -> String {
        "one of the names below".to_owned()
    }

    fn fault(&self, _: &[InputSpec]) -> Option<String> {
        let is_known = self.ids().any(|id| id == self.default);
        (!is_known).then(|| format!("the default \"{}\" is none of its names", self.default))
    }

    fn examples(&self) -> Vec<Json> {
        self.ids().map(Json::from).collect()
    }

    fn link_type(&self) -> Option<DataType> {
        Some(String::TYPE)
    }

    fn options(&self) -> Vec<OptionSpec> {
        let option = |&(id, summary)| OptionSpec { id, summary, params: &[] };
        self.names.iter().map(option).collect()
    }
}

impl<E: Enumeration> Param<E> {
    /// One of the values of `E`, by default the one of this name.
    pub const fn one_of(name: &'static str, doc: &'static str, default: &'static str) -> Self {
        Self::of_kind(name, doc, Kind::Enumeration(EnumerationSpec { default, names: E::NAMES }))
    }
}

impl<E: Enumeration> ParamType for E {
    fn from_setting(setting: &Setting) -> Option<Self> {
        let Setting::Text(name) = setting else { return None };
        let place = E::NAMES.iter().position(|(known, _)| known == name)?;
        E::VALUES.get(place).copied()
    }
}
