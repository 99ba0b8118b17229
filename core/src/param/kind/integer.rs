//! Whole numbers.

use serde_json::Value as Json;

use super::super::{Param, ParamType, Setting};
use super::Kind;
use super::range::{RangeSpec, RangeValue};

/// A whole number.
pub type IntegerSpec = RangeSpec<i64>;

/// Whole numbers to 2^53, which every program that reads JSON keeps exactly.
const INTEGERS: (i64, i64) = (-(1 << 53), 1 << 53);

impl RangeValue for i64 {
    const NOUN: &'static str = "whole number";
    const JSON_TYPE: &'static str = "integer";
    const IS_WHOLE: bool = true;
    const USUAL: (f64, f64) = (0.0, 1000.0);

    fn to_f64(self) -> f64 {
        self as f64
    }

    fn to_setting(self) -> Setting {
        Setting::Integer(self)
    }

    /// Also where it is written as `300.0`.
    fn from_json(json: &Json) -> Option<Self> {
        let is_whole = |x: &f64| x.fract() == 0.0 && x.abs() <= INTEGERS.1 as f64;
        json.as_i64().or_else(|| json.as_f64().filter(is_whole).map(|x| x as Self))
    }

    /// Generators fill the memory at the upper end of what is allowed.
    fn large_example(spec: &IntegerSpec) -> Self {
        spec.soft.map_or(spec.hard.0.max(0), |soft| soft.1.min(256))
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
