//! The values of parameters, checked against their declarations.

use std::any::Any;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::{Map as JsonMap, Value as Json};

use super::{ChoiceParam, Chosen, CommandLine, Condition, Param, ParamSpec, ParamType};
use crate::data::Scalar;
use crate::error::ModuleError;
use crate::fingerprint::{Fingerprint, FingerprintBuilder};
use crate::problem::did_you_mean;

/// The value of one parameter.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)] // The fields are what their names say.
pub enum Setting {
    /// `null`: off.
    Off,
    /// Of a flag.
    Flag(bool),
    /// Of a whole number or a seed.
    Integer(i64),
    /// Of a number.
    Number(f64),
    /// Of a text or an enumeration.
    Text(String),
    /// Of a choice.
    Choice { id: &'static str, params: Settings },
    /// Of a file: as the map says it, and where it is on this machine.
    File { written: String, resolved: PathBuf },
    /// Of a kind whose values have parts, such as points.
    Structured(Structured),
}

/// A value with parts. Its JSON, in the one form that its kind gives it, is what it is compared by.
#[derive(Clone)]
pub struct Structured {
    json: Json,
    value: Arc<dyn Any + Send + Sync>,
}

impl Structured {
    /// A value, and the one JSON that stands for it.
    pub(crate) fn new<T: Any + Send + Sync>(json: Json, value: T) -> Self {
        Self { json, value: Arc::new(value) }
    }

    /// The value, if it is of this type.
    pub fn get<T: Any + Send + Sync>(&self) -> Option<Arc<T>> {
        Arc::clone(&self.value).downcast().ok()
    }

    /// As a map file would say it.
    pub fn json(&self) -> &Json {
        &self.json
    }
}

impl fmt::Debug for Structured {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.json.fmt(f)
    }
}

impl PartialEq for Structured {
    fn eq(&self, other: &Self) -> bool {
        self.json == other.json
    }
}

/// Values for a list of declared parameters, in its order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings(pub(crate) Vec<(&'static str, Setting)>);

/// What is wrong with one parameter: its dotted path, and a sentence.
pub(crate) struct Fault {
    pub path: String,
    pub message: String,
}

/// Why JSON is no value of a parameter.
pub(crate) enum Misfit {
    /// What was expected, after "… is not".
    Expected(String),
    /// A whole sentence.
    Sentence(String),
}

impl Settings {
    /// The defaults of these parameters; `None` if one of them has none.
    pub fn defaults(specs: &[ParamSpec]) -> Option<Self> {
        specs
            .iter()
            .map(|spec| Some((spec.name, spec.default_setting()?)))
            .collect::<Option<_>>()
            .map(Self)
    }

    /// The value of a declared parameter.
    pub fn get<T: ParamType>(&self, param: &Param<T>) -> Result<T, ModuleError> {
        self.find(param.spec.name).and_then(T::from_setting).ok_or_else(|| ModuleError::Param {
            name: param.spec.name.to_owned(),
            message: "is read but not declared in the list of parameters".to_owned(),
        })
    }

    /// The entry that a declared choice names, with its parameters.
    pub fn choice<B: Sync>(&self, param: &ChoiceParam<B>) -> Result<Chosen<B>, ModuleError> {
        let name = param.spec.name;
        let chosen = match self.find(name) {
            Some(Setting::Choice { id, params }) => {
                let entry = param.choices.entries.iter().find(|listed| listed.item.id == *id);
                entry.map(|listed| Chosen { entry: listed.item, params: params.clone() })
            }
            _ => None,
        };
        chosen.ok_or_else(|| ModuleError::Param {
            name: name.to_owned(),
            message: "is read but not declared in the list of parameters".to_owned(),
        })
    }

    /// Visits every parameter with its dotted path, those of the chosen entries of choices too.
    pub(crate) fn each_mut(
        &mut self,
        specs: &[ParamSpec],
        visit: &mut dyn FnMut(&str, &ParamSpec, &mut Setting),
    ) {
        self.each_below("", specs, visit);
    }

    fn each_below(
        &mut self,
        above: &str,
        specs: &[ParamSpec],
        visit: &mut dyn FnMut(&str, &ParamSpec, &mut Setting),
    ) {
        for (spec, (name, setting)) in specs.iter().zip(&mut self.0) {
            let path = format!("{above}{name}");
            visit(&path, spec, setting);
            let nested = spec.params_of(setting);
            if let Setting::Choice { params, .. } = setting {
                params.each_below(&format!("{path}."), nested, visit);
            }
        }
    }

    /// The files of these parameters with their dotted paths and as the map says them, those of the
    /// chosen entries of choices too.
    pub(crate) fn files(&self, specs: &[ParamSpec]) -> Vec<(String, ParamSpec, &str)> {
        let mut files = Vec::new();
        for (spec, (name, setting)) in specs.iter().zip(&self.0) {
            match setting {
                Setting::File { written, .. } => {
                    files.push(((*name).to_owned(), *spec, &**written))
                }
                Setting::Choice { params, .. } => {
                    let nested = params.files(spec.params_of(setting)).into_iter();
                    files.extend(nested.map(|(p, spec, file)| (format!("{name}.{p}"), spec, file)));
                }
                _ => {}
            }
        }
        files
    }

    /// The outside programs of these parameters with their dotted paths.
    pub(crate) fn command_lines(&self) -> Vec<(String, CommandLine)> {
        let mut lines = Vec::new();
        for (name, setting) in &self.0 {
            if let Some(line) = setting.structured() {
                lines.push(((*name).to_owned(), line));
            }
            if let Setting::Choice { params, .. } = setting {
                let below = params.command_lines().into_iter();
                lines.extend(below.map(|(path, line)| (format!("{name}.{path}"), line)));
            }
        }
        lines
    }

    pub(crate) fn find(&self, name: &str) -> Option<&Setting> {
        self.0.iter().find(|(known, _)| *known == name).map(|(_, setting)| setting)
    }

    /// Reads `given` against `specs`. Whatever is wrong is pushed to `faults`, and the default
    /// stands in for it; names that are not declared are faults too. `linked` are the names
    /// whose values arrive by link.
    pub(crate) fn parse(
        specs: &[ParamSpec],
        given: &JsonMap<String, Json>,
        linked: &[&str],
        faults: &mut Vec<Fault>,
    ) -> Self {
        for name in given.keys() {
            if !specs.iter().any(|spec| spec.name == name) {
                let hint = did_you_mean(name, specs.iter().map(|spec| spec.name));
                let message = format!("there is no parameter of this name{hint}");
                faults.push(Fault { path: name.clone(), message });
            }
        }
        let setting = |spec: &ParamSpec| {
            let is_linked = linked.contains(&spec.name);
            (spec.name, spec.settle(given.get(spec.name), is_linked, faults))
        };
        Self(specs.iter().map(setting).collect())
    }

    /// What `given` sets to no effect, since the parameter counts only where another one is
    /// otherwise. `linked` are the names whose values arrive by link.
    pub(crate) fn idle(
        &self,
        specs: &[ParamSpec],
        given: &JsonMap<String, Json>,
        linked: &[&str],
    ) -> Vec<Fault> {
        let is_so = |condition: Condition| match condition {
            Condition::Is { param, value } => match self.find(param) {
                Some(Setting::Text(text)) => text == value,
                Some(Setting::Choice { id, .. }) => *id == value,
                _ => false,
            },
            Condition::IsOff { param } => {
                self.find(param) == Some(&Setting::Off) && !linked.contains(&param)
            }
        };
        let mut idle = Vec::new();
        for (spec, (name, setting)) in specs.iter().zip(&self.0) {
            let Some(json) = given.get(*name).filter(|json| !json.is_null()) else { continue };
            if let Some(condition) = spec.counts.filter(|condition| !is_so(*condition)) {
                let message = format!("has no effect: it counts only where {condition}");
                idle.push(Fault { path: (*name).to_owned(), message });
            }
            if let (Setting::Choice { params, .. }, Some((_, Some(inner)))) =
                (setting, super::chosen(json))
            {
                let below = params.idle(spec.params_of(setting), inner, &[]).into_iter();
                idle.extend(below.map(|f| Fault { path: format!("{name}.{}", f.path), ..f }));
            }
        }
        idle
    }

    /// The settings as a map file would say them.
    pub fn to_json(&self) -> Json {
        Json::Object(self.0.iter().map(|(name, s)| ((*name).to_owned(), s.to_json())).collect())
    }

    pub(crate) fn write_key(&self, specs: &[ParamSpec], key: &mut FingerprintBuilder) {
        (0..self.0.len()).for_each(|place| self.write_key_at(place, specs, key));
    }

    /// Adds the parameter at one place of the list to a key.
    pub(crate) fn write_key_at(
        &self,
        place: usize,
        specs: &[ParamSpec],
        key: &mut FingerprintBuilder,
    ) {
        if let (Some(spec), Some((name, setting))) = (specs.get(place), self.0.get(place)) {
            key.text(name);
            spec.kind.answers().write_key(setting, key);
        }
    }
}

impl Setting {
    /// A value with parts, if it is of this type.
    pub(crate) fn structured<T: Any + Clone + Send + Sync>(&self) -> Option<T> {
        match self {
            Self::Structured(value) => value.get::<T>().map(|shared| (*shared).clone()),
            _ => None,
        }
    }

    /// Finds the program of a command, and the files that it names, as seen from a folder; gives
    /// their paths.
    pub(crate) fn locate_program(&mut self, folder: &Path) -> Result<Vec<PathBuf>, String> {
        let Some(mut line) = self.structured::<CommandLine>() else { return Ok(Vec::new()) };
        let found = line.locate(folder);
        if let Self::Structured(value) = self {
            *value = Structured::new(value.json.clone(), line);
        }
        found
    }

    /// Whether it names a file, or an entry of a choice that does; a program is one.
    pub(crate) fn has_files(&self) -> bool {
        match self {
            Self::File { .. } => true,
            Self::Structured(value) => value.get::<CommandLine>().is_some(),
            Self::Choice { params, .. } => params.0.iter().any(|(_, below)| below.has_files()),
            _ => false,
        }
    }

    /// The setting as a map file would say it.
    pub fn to_json(&self) -> Json {
        match self {
            Self::Off => Json::Null,
            Self::Flag(flag) => Json::from(*flag),
            Self::Integer(number) => Json::from(*number),
            Self::Number(number) => Json::from(*number),
            Self::Text(text) => Json::from(text.as_str()),
            Self::File { written, .. } => Json::from(written.as_str()),
            Self::Structured(value) => value.json.clone(),
            Self::Choice { id, params } if params.0.is_empty() => Json::from(*id),
            Self::Choice { id, params } => {
                Json::Object(JsonMap::from_iter([((*id).to_owned(), params.to_json())]))
            }
        }
    }

    /// The setting as a word for a file name: a choice is its id.
    pub(crate) fn to_word(&self) -> String {
        match self {
            Self::Off => "off".to_owned(),
            Self::Flag(flag) => flag.to_string(),
            Self::Integer(number) => number.to_string(),
            Self::Number(number) => number.to_string(),
            Self::Text(text) | Self::File { written: text, .. } => text.clone(),
            Self::Choice { id, .. } => (*id).to_owned(),
            Self::Structured(Structured { json: Json::String(text), .. }) => text.clone(),
            // A list is too long for a name; equal ones get equal names.
            Self::Structured(value) => {
                Fingerprint::of(value.json.to_string().as_bytes()).short()[..8].to_owned()
            }
        }
    }

    /// Adds the value to a key as most kinds do it.
    pub(crate) fn write_key(&self, key: &mut FingerprintBuilder) {
        match self {
            Self::Number(number) => key.part(&number.to_bits().to_le_bytes()),
            _ => key.text(&self.to_json().to_string()),
        }
    }
}

impl ParamSpec {
    /// The value of this parameter where a map gives it this JSON, or nothing. Whatever is wrong is
    /// pushed to `faults`, and the default stands in for it.
    pub(crate) fn settle(
        &self,
        given: Option<&Json>,
        is_linked: bool,
        faults: &mut Vec<Fault>,
    ) -> Setting {
        let default = || self.default_setting();
        let setting = match given {
            Some(_) if is_linked => default(),
            Some(json) => self.parse(json, faults).or_else(default),
            // The entry that a choice has by default may need a parameter: that one is named.
            None => default().or_else(|| match self.default_json() {
                Some(json) => self.parse(&json, faults),
                None => {
                    let message = self.kind.answers().unset().to_owned();
                    faults.push(Fault { path: self.name.to_owned(), message });
                    None
                }
            }),
        };
        setting.unwrap_or(Setting::Off)
    }

    /// Reads a JSON value as this parameter; `None`, and a fault, if it does not fit.
    pub(crate) fn parse(&self, json: &Json, faults: &mut Vec<Fault>) -> Option<Setting> {
        if json.is_null() && self.can_be_off {
            return Some(Setting::Off);
        }
        let mut nested = Vec::new();
        let parsed = self.kind.answers().parse(json, &mut nested);
        faults.extend(nested.into_iter().map(|fault| Fault {
            path: format!("{}.{}", self.name, fault.path),
            message: fault.message,
        }));
        let message = match parsed {
            Ok(setting) => return Some(setting),
            Err(Misfit::Sentence(message)) => message,
            Err(Misfit::Expected(expected)) => {
                let unit = if self.unit.is_empty() {
                    String::new()
                } else {
                    format!(" (in {})", self.unit)
                };
                let off = if self.can_be_off { ", or null for off" } else { "" };
                let without = json.as_str().and_then(|text| serde_json::from_str(text).ok());
                let fits = |json: &Json| self.kind.answers().parse(json, &mut Vec::new()).is_ok();
                let quotes = match without.as_ref().is_some_and(fits) {
                    true => "; write it without quotes",
                    false => "",
                };
                format!("{} is not {expected}{unit}{off}{quotes}", shown(json))
            }
        };
        faults.push(Fault { path: self.name.to_owned(), message });
        None
    }

    /// Reads a value that arrived by link.
    pub(crate) fn parse_linked(&self, scalar: &Scalar) -> Result<Setting, ModuleError> {
        let json = match scalar {
            Scalar::Flag(flag) => Json::from(*flag),
            Scalar::Text(text) => Json::from(text.as_str()),
            Scalar::Number(number) => Json::from(*number),
        };
        self.read(&json).map_err(|why| ModuleError::Param {
            name: self.name.to_owned(),
            message: format!("by link: {why}"),
        })
    }

    /// Changes a value for a repeat, so that it differs from the next: seeds rise.
    pub(crate) fn repeat(&self, setting: &mut Setting, repeat: u32) {
        self.kind.answers().repeat(setting, repeat);
    }
}

/// A JSON value for a message, cut short.
pub(crate) fn shown(json: &Json) -> String {
    let text = json.to_string();
    match text.char_indices().nth(60) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text,
    }
}
