//! One entry of an open list, with that entry's parameters nested under it.

use serde_json::{Map as JsonMap, Value as Json, json};

use super::super::json::chosen;
use super::super::{Fault, OptionSpec, Param, ParamSpec, Setting, Settings};
use super::{Kind, Misfit, ParamKind};
use crate::fingerprint::FingerprintBuilder;
use crate::listed::Listed;
use crate::param::object_of;
use crate::port::InputSpec;
use crate::problem::did_you_mean;
use crate::quantity::{Quantities, Quantity};

/// One entry of a list: `"Id"`, or `{"Id": {parameters}}`.
#[derive(Clone, Copy)]
pub struct ChoiceSpec {
    /// Id of the entry where a map says nothing.
    pub default: &'static str,
    /// The entries.
    pub list: &'static dyn ChoiceList,
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
    /// The numbers that a module gives with it.
    pub quantities: &'static [Quantity],
    /// Hash of its source: see [`crate::source_hash`].
    pub source: u64,
}

/// A list of entries, as a static.
pub struct Choices<B: 'static> {
    /// The entries, sorted by id.
    pub entries: &'static [Listed<Entry<B>>],
    quantities: fn(&B) -> &'static [Quantity],
}

impl<B> Choices<B> {
    /// A list of entries that decide nothing about the numbers that a module gives.
    pub const fn new(entries: &'static [Listed<Entry<B>>]) -> Self {
        Self { entries, quantities: |_| &[] }
    }

    /// Says which numbers a module gives with an entry.
    pub const fn giving(self, quantities: fn(&B) -> &'static [Quantity]) -> Self {
        Self { quantities, ..self }
    }
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
        EntrySpec {
            id: item.id,
            summary: item.summary,
            params: item.params,
            quantities: (self.quantities)(&item.build),
            source,
        }
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
        let kind = Kind::Choice(ChoiceSpec { default, list: choices });
        Self { spec: Param::<()>::of_kind(name, doc, kind).spec, choices }
    }

    /// The declaration, for [`crate::Module::params`].
    pub const fn spec(&self) -> ParamSpec {
        self.spec
    }

    /// The numbers that a module gives with the entry that is chosen, for [`crate::Out::giving`].
    pub const fn quantities(&self) -> Quantities {
        Quantities::OfChoice(self.spec.name)
    }

    /// The first of these numbers.
    pub const fn first_quantity(&self) -> Quantities {
        Quantities::FirstOfChoice(self.spec.name)
    }
}

/// The entry that a choice names, with its parameters.
pub struct Chosen<B: 'static> {
    /// The entry.
    pub entry: &'static Entry<B>,
    /// Its parameters, all of them set.
    pub params: Settings,
}

impl ChoiceSpec {
    /// The entries, in order.
    pub fn entries(self) -> impl Iterator<Item = EntrySpec> {
        (0..self.list.len()).map(move |place| self.list.spec(place))
    }
}

impl ParamKind for ChoiceSpec {
    fn default_json(&self) -> Option<Json> {
        Some(Json::from(self.default))
    }

    fn parse(&self, json: &Json, faults: &mut Vec<Fault>) -> Result<Setting, Misfit> {
        let ids = || self.entries().map(|entry| entry.id);
        let Some((id, params)) = chosen(json) else {
            let first = ids().next().unwrap_or_default();
            return Err(Misfit::Expected(format!(
                "a choice; write \"{first}\", or {{\"{first}\": {{…its parameters…}}}}"
            )));
        };
        let Some(EntrySpec { id, params: specs, .. }) = self.list.find(id) else {
            let all = ids().collect::<Vec<_>>().join(", ");
            let hint = did_you_mean(id, ids());
            return Err(Misfit::Sentence(format!("\"{id}\" is not one of {all}{hint}")));
        };
        let empty = JsonMap::new();
        let params = Settings::parse(specs, params.unwrap_or(&empty), &[], faults);
        Ok(Setting::Choice { id, params })
    }

    fn schema(&self) -> Json {
        let named =
            self.entries().map(|entry| json!({ "const": entry.id, "description": entry.summary }));
        let with_params = self.entries().map(|entry| {
            let mut params = object_of(entry.params);
            params["description"] = Json::from(entry.summary);
            (entry.id.to_owned(), params)
        });
        // By the type of the value, so that a fault is told of the entry that was meant.
        json!({
            "type": ["string", "object"],
            "if": { "type": "string" },
            "then": { "oneOf": named.collect::<Vec<_>>() },
            "else": {
                "properties": with_params.collect::<JsonMap<_, _>>(),
                "additionalProperties": false,
                "minProperties": 1,
                "maxProperties": 1
            }
        })
    }

    fn noun(&self) -> String {
        "choice among the entries below".to_owned()
    }

    fn fault(&self, inputs: &[InputSpec]) -> Option<String> {
        if self.list.find(self.default).is_none() {
            return Some(format!("the default \"{}\" is none of its entries", self.default));
        }
        self.entries().find_map(|entry| {
            let is_same = |other: &EntrySpec| other.id == entry.id;
            if self.entries().filter(is_same).count() > 1 {
                return Some(format!("the id {} stands twice", entry.id));
            }
            let mut params = entry.params.iter();
            params.find_map(|spec| Some(format!("{}.{}", entry.id, spec.fault(inputs)?)))
        })
    }

    fn examples(&self) -> Vec<Json> {
        self.entries().map(|entry| Json::from(entry.id)).collect()
    }

    fn options(&self) -> Vec<OptionSpec> {
        let option = |e: EntrySpec| OptionSpec { id: e.id, summary: e.summary, params: e.params };
        self.entries().map(option).collect()
    }

    fn summary(&self, value: &Json) -> Option<String> {
        chosen(value).map(|(id, _)| id.to_owned())
    }

    fn write_key(&self, setting: &Setting, key: &mut FingerprintBuilder) {
        let Setting::Choice { id, params } = setting else { return setting.write_key(key) };
        key.text(id);
        if let Some(entry) = self.list.find(id) {
            key.part(&entry.source.to_le_bytes());
            params.write_key(entry.params, key);
        }
    }
}

impl ParamSpec {
    /// Whether it is an output file, or has one among the parameters of an entry.
    pub(crate) fn writes_files(&self) -> bool {
        let below = |entry: EntrySpec| entry.params.iter().any(Self::writes_files);
        self.output_file().is_some()
            || self.choice().is_some_and(|choice| choice.entries().any(below))
    }

    /// The parameters of the entry that a setting of this choice names.
    pub(crate) fn params_of(&self, setting: &Setting) -> &'static [ParamSpec] {
        match (self.choice(), setting) {
            (Some(choice), Setting::Choice { id, .. }) => {
                choice.list.find(id).map_or(&[], |entry| entry.params)
            }
            _ => &[],
        }
    }
}
