//! The values of parameters, checked against their declarations.

use std::path::PathBuf;

use serde_json::{Map as JsonMap, Value as Json};

use crate::data::Scalar;
use crate::fingerprint::FingerprintBuilder;
use crate::module::ModuleError;
use crate::param::{ChoiceList, ChoiceParam, Chosen, EntrySpec, Kind, Param, ParamSpec, ParamType};
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
}

/// Values for a list of declared parameters, in its order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings(pub(crate) Vec<(&'static str, Setting)>);

/// What is wrong with one parameter: its dotted path, and a sentence.
pub(crate) struct Fault {
    pub path: String,
    pub message: String,
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
        let mut settings = Vec::with_capacity(specs.len());
        for spec in specs {
            let default = spec.default_setting();
            let setting = match given.get(spec.name) {
                Some(_) if linked.contains(&spec.name) => default,
                Some(json) => spec.parse(json, faults).or(default),
                None if default.is_none() && matches!(spec.kind, Kind::Choice { .. }) => {
                    // The entry that is chosen by default needs a parameter: that one is named.
                    spec.default_id().and_then(|id| spec.parse(&Json::from(id), faults))
                }
                None => {
                    if default.is_none() {
                        let message = match spec.kind {
                            Kind::InputFile { .. } => "choose a file: there is no default",
                            _ => "must be set: there is no default",
                        };
                        let message = message.to_owned();
                        faults.push(Fault { path: spec.name.to_owned(), message });
                    }
                    default
                }
            };
            settings.push((spec.name, setting.unwrap_or(Setting::Off)));
        }
        Self(settings)
    }

    /// The settings as a map file would say them.
    pub fn to_json(&self) -> Json {
        Json::Object(self.0.iter().map(|(name, s)| ((*name).to_owned(), s.to_json())).collect())
    }

    pub(crate) fn write_key(&self, specs: &[ParamSpec], key: &mut FingerprintBuilder) {
        for (spec, (name, setting)) in specs.iter().zip(&self.0) {
            key.text(name);
            setting.write_key(spec, key);
        }
    }
}

impl Setting {
    /// The setting as a map file would say it.
    pub fn to_json(&self) -> Json {
        match self {
            Self::Off => Json::Null,
            Self::Flag(flag) => Json::from(*flag),
            Self::Integer(number) => Json::from(*number),
            Self::Number(number) => Json::from(*number),
            Self::Text(text) => Json::from(text.as_str()),
            Self::File { written, .. } => Json::from(written.as_str()),
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
        }
    }

    /// Raises a seed, so that a repeat differs from the next.
    pub(crate) fn shift_seed(&mut self, spec: &ParamSpec, repeat: u32) {
        if let (Self::Integer(seed), Kind::Seed { .. }) = (self, spec.kind) {
            *seed += i64::from(repeat);
        }
    }

    /// Input files are left out: the key has their content, not their name.
    fn write_key(&self, spec: &ParamSpec, key: &mut FingerprintBuilder) {
        match (self, spec.kind) {
            (Self::File { .. }, Kind::InputFile { .. }) => {}
            (Self::Choice { id, params }, Kind::Choice { list, .. }) => {
                key.text(id);
                if let Some(entry) = list.find(id) {
                    key.part(&entry.source.to_le_bytes());
                    params.write_key(entry.params, key);
                }
            }
            (Self::Number(number), _) => key.part(&number.to_bits().to_le_bytes()),
            _ => key.text(&self.to_json().to_string()),
        }
    }
}

impl ParamSpec {
    /// The id that a choice has by default.
    pub(crate) fn default_id(&self) -> Option<&'static str> {
        match self.kind {
            Kind::Choice { default, .. } => Some(default),
            _ => None,
        }
    }

    /// The parameters of the entry that a setting of this choice names.
    pub(crate) fn params_of(&self, setting: &Setting) -> &'static [ParamSpec] {
        match (self.kind, setting) {
            (Kind::Choice { list, .. }, Setting::Choice { id, .. }) => {
                list.find(id).map_or(&[], |entry| entry.params)
            }
            _ => &[],
        }
    }

    /// Whether it is an output file, or has one among the parameters of an entry.
    pub(crate) fn writes_files(&self) -> bool {
        match self.kind {
            Kind::OutputFile { .. } => true,
            Kind::Choice { list, .. } => {
                (0..list.len()).any(|place| list.spec(place).params.iter().any(Self::writes_files))
            }
            _ => false,
        }
    }

    /// Reads a JSON value as this parameter; `None`, and a fault, if it does not fit.
    pub(crate) fn parse(&self, json: &Json, faults: &mut Vec<Fault>) -> Option<Setting> {
        let parsed = match self.kind {
            Kind::Choice { list, .. } => return self.parse_choice(list, json, faults),
            Kind::Flag { .. } => json.as_bool().map(Setting::Flag).ok_or("true or false".into()),
            Kind::Integer { hard, .. } => integer(json, self.can_be_off, hard),
            Kind::Number { hard, .. } => number(json, self.can_be_off, hard),
            Kind::Seed { .. } => integer(json, false, (0, i64::from(u32::MAX))),
            Kind::Text { .. } => {
                json.as_str().map(|text| Setting::Text(text.to_owned())).ok_or("a text".into())
            }
            Kind::Enumeration { names, .. } => enumeration(json, names),
            Kind::InputFile { .. } | Kind::OutputFile { .. } => match json.as_str() {
                Some("") | None => Err("the path of a file".to_owned()),
                Some(path) => {
                    Ok(Setting::File { written: path.to_owned(), resolved: PathBuf::new() })
                }
            },
        };
        parsed
            .map_err(|expected| {
                let unit = if self.unit.is_empty() {
                    String::new()
                } else {
                    format!(" (in {})", self.unit)
                };
                let off = if self.can_be_off { ", or null for off" } else { "" };
                let message = format!("{} is not {expected}{unit}{off}", shown(json));
                faults.push(Fault { path: self.name.to_owned(), message });
            })
            .ok()
    }

    /// A choice is `"Id"`, or `{"Id": {parameters}}`.
    fn parse_choice(
        &self,
        list: &'static dyn ChoiceList,
        json: &Json,
        faults: &mut Vec<Fault>,
    ) -> Option<Setting> {
        let empty = JsonMap::new();
        let named = match json {
            Json::String(id) => Some((id, &empty)),
            Json::Object(object) if object.len() == 1 => object
                .iter()
                .next()
                .and_then(|(id, params)| params.as_object().map(|params| (id, params))),
            _ => None,
        };
        let ids = || (0..list.len()).map(|place| list.spec(place).id);
        let Some((id, params)) = named else {
            let message = format!(
                "{} is not a choice; write \"{}\", or {{\"{}\": {{…its parameters…}}}}",
                shown(json),
                ids().next().unwrap_or_default(),
                ids().next().unwrap_or_default()
            );
            faults.push(Fault { path: self.name.to_owned(), message });
            return None;
        };
        let Some(EntrySpec { id, params: specs, .. }) = list.find(id) else {
            let all = ids().collect::<Vec<_>>().join(", ");
            let hint = did_you_mean(id, ids());
            let message = format!("\"{id}\" is not one of {all}{hint}");
            faults.push(Fault { path: self.name.to_owned(), message });
            return None;
        };
        let mut nested = Vec::new();
        let params = Settings::parse(specs, params, &[], &mut nested);
        faults.extend(nested.into_iter().map(|fault| Fault {
            path: format!("{}.{}", self.name, fault.path),
            message: fault.message,
        }));
        Some(Setting::Choice { id, params })
    }

    /// Reads a value that arrived by link.
    pub(crate) fn parse_linked(&self, scalar: &Scalar) -> Result<Setting, ModuleError> {
        let json = match scalar {
            Scalar::Flag(flag) => Json::from(*flag),
            Scalar::Text(text) => Json::from(text.as_str()),
            Scalar::Number(number) => Json::from(*number),
        };
        let mut faults = Vec::new();
        self.parse(&json, &mut faults).ok_or_else(|| ModuleError::Param {
            name: self.name.to_owned(),
            message: faults.pop().map_or_else(String::new, |f| format!("by link: {}", f.message)),
        })
    }
}

/// A whole number, also where it is written as `300.0`.
fn integer(json: &Json, can_be_off: bool, (low, high): (i64, i64)) -> Result<Setting, String> {
    let whole = |x: &f64| x.fract() == 0.0 && x.abs() <= 9_007_199_254_740_992.0;
    let found = json.as_i64().or_else(|| json.as_f64().filter(whole).map(|x| x as i64));
    match found {
        Some(number) if (low..=high).contains(&number) => Ok(Setting::Integer(number)),
        None if json.is_null() && can_be_off => Ok(Setting::Off),
        _ => Err(format!("a whole number{}", between(low as f64, high as f64))),
    }
}

fn number(json: &Json, can_be_off: bool, (low, high): (f64, f64)) -> Result<Setting, String> {
    match json.as_f64() {
        Some(number) if (low..=high).contains(&number) => Ok(Setting::Number(number)),
        None if json.is_null() && can_be_off => Ok(Setting::Off),
        _ => Err(format!("a number{}", between(low, high))),
    }
}

fn enumeration(json: &Json, names: &[(&'static str, &str)]) -> Result<Setting, String> {
    let ids = || names.iter().map(|(name, _)| *name);
    match json.as_str() {
        Some(name) if ids().any(|id| id == name) => Ok(Setting::Text(name.to_owned())),
        other => {
            let hint = other.map(|name| did_you_mean(name, ids())).unwrap_or_default();
            Err(format!("one of {}{hint}", ids().collect::<Vec<_>>().join(", ")))
        }
    }
}

/// The range in words, without the ends that only the number format sets.
pub(crate) fn between(low: f64, high: f64) -> String {
    const ENDLESS: f64 = 9.0e15;
    match (low > -ENDLESS, high < ENDLESS) {
        (true, true) => format!(" from {low} to {high}"),
        (true, false) => format!(" of {low} or more"),
        (false, true) => format!(" of {high} or less"),
        (false, false) => String::new(),
    }
}

/// A JSON value for a message, cut short.
fn shown(json: &Json) -> String {
    let text = json.to_string();
    match text.char_indices().nth(60) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text,
    }
}
