//! Finite numbers.

use serde_json::Value as Json;

use super::super::{Param, ParamType, Setting};
use super::Kind;
use super::range::{RangeSpec, RangeValue};

/// A finite number.
pub type NumberSpec = RangeSpec<f64>;

const NUMBERS: (f64, f64) = (f64::MIN, f64::MAX);

impl RangeValue for f64 {
    const NOUN: &'static str = "number";
    const JSON_TYPE: &'static str = "number";
    const IS_WHOLE: bool = false;
    const USUAL: (f64, f64) = (0.0, 1.0);

    fn to_f64(self) -> f64 {
        self
    }

    fn to_setting(self) -> Setting {
        Setting::Number(self)
    }

    fn from_json(json: &Json) -> Option<Self> {
        json.as_f64()
    }

    fn large_example(spec: &NumberSpec) -> Self {
        spec.soft.unwrap_or(spec.hard).1
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
