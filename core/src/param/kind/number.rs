//! Finite numbers.

use serde_json::{Value as Json, json};

use super::super::{Fault, Param, ParamType, Setting};
use super::{Kind, Misfit, NumericRange, ParamKind, between};
use crate::data::{Data, DataType};
use crate::port::InputSpec;

/// A finite number. A default of `None` is off.
#[derive(Clone, Copy, Debug)]
pub struct NumberSpec {
    /// Where a map says nothing.
    pub default: Option<f64>,
    /// Both ends of what is allowed.
    pub hard: (f64, f64),
    /// Both ends of what a slider shows.
    pub soft: Option<(f64, f64)>,
}

const NUMBERS: (f64, f64) = (f64::MIN, f64::MAX);

impl NumberSpec {
    pub(super) fn range(&self) -> NumericRange {
        NumericRange { is_whole: false, hard: self.hard, soft: self.soft }
    }
}

impl ParamKind for NumberSpec {
    fn default_json(&self) -> Option<Json> {
        Some(self.default.map_or(Json::Null, Json::from))
    }

    fn parse(&self, json: &Json, _: &mut Vec<Fault>) -> Result<Setting, Misfit> {
        let (low, high) = self.hard;
        match json.as_f64() {
            Some(number) if (low..=high).contains(&number) => Ok(Setting::Number(number)),
            _ => Err(Misfit::Expected(format!("a number{}", between(low, high)))),
        }
    }

    fn schema(&self) -> Json {
        let mut schema = json!({ "type": "number" });
        if self.hard.0 > f64::MIN {
            schema["minimum"] = Json::from(self.hard.0);
        }
        if self.hard.1 < f64::MAX {
            schema["maximum"] = Json::from(self.hard.1);
        }
        schema
    }

    fn noun(&self) -> String {
        format!("number{}", between(self.hard.0, self.hard.1))
    }

    fn fault(&self, _: &[InputSpec]) -> Option<String> {
        let Self { default, hard: (low, high), soft } = *self;
        let is_sound = low <= high && default.is_none_or(|d| (low..=high).contains(&d));
        let soft = soft.unwrap_or((low, high));
        let is_usual = low <= soft.0 && soft.0 <= soft.1 && soft.1 <= high;
        (!is_sound || !is_usual).then(|| "the default or the slider lies out of range".to_owned())
    }

    fn examples(&self) -> Vec<Json> {
        vec![json!(self.hard.0), json!(self.soft.unwrap_or(self.hard).1)]
    }

    fn link_type(&self) -> Option<DataType> {
        Some(f64::TYPE)
    }

    fn value_when_on(&self) -> Option<Json> {
        Some(self.default.map_or_else(|| self.range().middle((0.0, 1.0)), Json::from))
    }

    fn another(&self, value: &Json) -> Json {
        self.range().double(value.as_f64().unwrap_or_default())
    }
}

/// Parameters whose values are numbers.
pub trait NumberParam {}
impl NumberParam for f64 {}
impl NumberParam for Option<f64> {}

impl<T: NumberParam> Param<T> {
    const fn real(name: &'static str, doc: &'static str, default: Option<f64>) -> Self {
        Self::of_kind(name, doc, Kind::Number(NumberSpec { default, hard: NUMBERS, soft: None }))
    }

    /// Both ends of what is allowed; a map outside it is refused.
    pub const fn within(mut self, ends: (f64, f64)) -> Self {
        if let Kind::Number(spec) = &mut self.spec.kind {
            spec.hard = ends;
        }
        self
    }

    /// Both ends of what a slider shows.
    pub const fn usually(mut self, ends: (f64, f64)) -> Self {
        if let Kind::Number(spec) = &mut self.spec.kind {
            spec.soft = Some(ends);
        }
        self
    }
}

impl Param<f64> {
    /// A number with its default.
    pub const fn number(name: &'static str, doc: &'static str, default: f64) -> Self {
        Self::real(name, doc, Some(default))
    }
}

impl Param<Option<f64>> {
    /// A number that can be off, as it is by default where that is `None`.
    pub const fn maybe_number(name: &'static str, doc: &'static str, default: Option<f64>) -> Self {
        Self::real(name, doc, default).or_off()
    }
}

impl ParamType for f64 {
    fn from_setting(setting: &Setting) -> Option<Self> {
        match setting {
            Setting::Number(number) => Some(*number),
            _ => None,
        }
    }
}
