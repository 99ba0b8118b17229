//! Whole numbers.

use serde_json::{Value as Json, json};

use super::super::{Fault, Param, ParamType, Setting};
use super::{Kind, Misfit, NumericRange, ParamKind, between};
use crate::data::{Data, DataType};
use crate::port::InputSpec;

/// A whole number. A default of `None` is off.
#[derive(Clone, Copy, Debug)]
pub struct IntegerSpec {
    /// Where a map says nothing.
    pub default: Option<i64>,
    /// Both ends of what is allowed.
    pub hard: (i64, i64),
    /// Both ends of what a slider shows.
    pub soft: Option<(i64, i64)>,
}

/// Whole numbers to 2^53, which every program that reads JSON keeps exactly.
const INTEGERS: (i64, i64) = (-(1 << 53), 1 << 53);

impl IntegerSpec {
    pub(super) fn range(&self) -> NumericRange {
        let both = |(from, to): (i64, i64)| (from as f64, to as f64);
        NumericRange { is_whole: true, hard: both(self.hard), soft: self.soft.map(both) }
    }
}

/// A whole number, also where it is written as `300.0`.
pub(super) fn parse_whole(json: &Json, (low, high): (i64, i64)) -> Result<Setting, Misfit> {
    let whole = |x: &f64| x.fract() == 0.0 && x.abs() <= 9_007_199_254_740_992.0;
    let found = json.as_i64().or_else(|| json.as_f64().filter(whole).map(|x| x as i64));
    match found {
        Some(number) if (low..=high).contains(&number) => Ok(Setting::Integer(number)),
        _ => Err(Misfit::Expected(format!("a whole number{}", between(low as f64, high as f64)))),
    }
}

impl ParamKind for IntegerSpec {
    fn default_json(&self) -> Option<Json> {
        Some(self.default.map_or(Json::Null, Json::from))
    }

    fn parse(&self, json: &Json, _: &mut Vec<Fault>) -> Result<Setting, Misfit> {
        parse_whole(json, self.hard)
    }

    fn schema(&self) -> Json {
        json!({ "type": "integer", "minimum": self.hard.0, "maximum": self.hard.1 })
    }

    fn noun(&self) -> String {
        format!("whole number{}", between(self.hard.0 as f64, self.hard.1 as f64))
    }

    fn fault(&self, _: &[InputSpec]) -> Option<String> {
        let Self { default, hard: (low, high), soft } = *self;
        let is_sound = low <= high && default.is_none_or(|d| (low..=high).contains(&d));
        let soft = soft.unwrap_or((low, high));
        let is_usual = low <= soft.0 && soft.0 <= soft.1 && soft.1 <= high;
        (!is_sound || !is_usual).then(|| "the default or the slider lies out of range".to_owned())
    }

    fn examples(&self) -> Vec<Json> {
        let Self { hard, soft, .. } = *self;
        // Generators fill the memory at the upper end of what is allowed.
        vec![json!(hard.0), json!(soft.map_or(hard.0.max(0), |soft| soft.1.min(256)))]
    }

    fn link_type(&self) -> Option<DataType> {
        Some(f64::TYPE)
    }

    fn value_when_on(&self) -> Option<Json> {
        Some(self.default.map_or_else(|| self.range().middle((0.0, 1000.0)), Json::from))
    }

    fn another(&self, value: &Json) -> Json {
        self.range().double(value.as_f64().unwrap_or_default())
    }
}

/// Parameters whose values are whole numbers.
pub trait IntegerParam {}
impl IntegerParam for i64 {}
impl IntegerParam for Option<i64> {}

impl<T: IntegerParam> Param<T> {
    const fn whole(name: &'static str, doc: &'static str, default: Option<i64>) -> Self {
        Self::of_kind(name, doc, Kind::Integer(IntegerSpec { default, hard: INTEGERS, soft: None }))
    }

    /// Both ends of what is allowed; a map outside it is refused.
    pub const fn between(mut self, ends: (i64, i64)) -> Self {
        if let Kind::Integer(spec) = &mut self.spec.kind {
            spec.hard = ends;
        }
        self
    }

    /// Both ends of what a slider shows.
    pub const fn mostly(mut self, ends: (i64, i64)) -> Self {
        if let Kind::Integer(spec) = &mut self.spec.kind {
            spec.soft = Some(ends);
        }
        self
    }
}

impl Param<i64> {
    /// A whole number with its default.
    pub const fn integer(name: &'static str, doc: &'static str, default: i64) -> Self {
        Self::whole(name, doc, Some(default))
    }
}

impl Param<Option<i64>> {
    /// A whole number that can be off, as it is by default where that is `None`.
    pub const fn maybe_integer(
        name: &'static str,
        doc: &'static str,
        default: Option<i64>,
    ) -> Self {
        Self::whole(name, doc, default).or_off()
    }
}

impl ParamType for i64 {
    fn from_setting(setting: &Setting) -> Option<Self> {
        match setting {
            Setting::Integer(number) => Some(*number),
            _ => None,
        }
    }
}
