//! What parameters that are numbers share: a default within a range, and what a slider shows of it.

use serde_json::{Value as Json, json};

use super::super::{Fault, ParamSpec, Setting};
use super::{Misfit, ParamKind, SeedSpec};
use crate::data::{Data, DataType};
use crate::port::InputSpec;

/// A number of a range. A default of `None` is off.
#[derive(Clone, Copy, Debug)]
pub struct RangeSpec<T> {
    /// Where a map says nothing.
    pub default: Option<T>,
    /// Both ends of what is allowed.
    pub hard: (T, T),
    /// Both ends of what a slider shows.
    pub soft: Option<(T, T)>,
}

/// What whole numbers and others answer differently.
pub trait RangeValue: Copy + PartialOrd + Into<Json> {
    /// What a value is, for messages and the documentation.
    const NOUN: &'static str;
    /// What a JSON schema calls it.
    const JSON_TYPE: &'static str;
    /// Whether values are whole.
    const IS_WHOLE: bool;
    /// What is usual where neither a slider nor the range says so.
    const USUAL: (f64, f64);

    fn to_f64(self) -> f64;

    fn to_setting(self) -> Setting;

    fn from_json(json: &Json) -> Option<Self>;

    /// The larger example for tests of modules.
    fn large_example(spec: &RangeSpec<Self>) -> Self;
}

impl<T: RangeValue> RangeSpec<T> {
    /// The number that this JSON is, if it is allowed.
    pub(super) fn read(&self, json: &Json) -> Option<T> {
        T::from_json(json).filter(|number| (self.hard.0..=self.hard.1).contains(number))
    }

    pub(super) fn range(&self) -> NumericRange {
        let both = |(from, to): (T, T)| (from.to_f64(), to.to_f64());
        NumericRange { is_whole: T::IS_WHOLE, hard: both(self.hard), soft: self.soft.map(both) }
    }
}

impl<T: RangeValue> ParamKind for RangeSpec<T> {
    fn default_json(&self) -> Option<Json> {
        Some(self.default.map_or(Json::Null, Into::into))
    }

    fn parse(&self, json: &Json, _: &mut Vec<Fault>) -> Result<Setting, Misfit> {
        let number = self.read(json).map(T::to_setting);
        number.ok_or_else(|| Misfit::Expected(format!("a {}", self.noun())))
    }

    fn schema(&self) -> Json {
        let mut schema = json!({ "type": T::JSON_TYPE });
        // The ends of the number format go without saying.
        if self.hard.0.to_f64() > f64::MIN {
            schema["minimum"] = self.hard.0.into();
        }
        if self.hard.1.to_f64() < f64::MAX {
            schema["maximum"] = self.hard.1.into();
        }
        schema
    }

    fn noun(&self) -> String {
        format!("{}{}", T::NOUN, between(self.range().hard))
    }

    fn fault(&self, _: &[InputSpec]) -> Option<String> {
        let Self { default, hard: (low, high), soft } = *self;
        let is_sound = low <= high && default.is_none_or(|d| (low..=high).contains(&d));
        let soft = soft.unwrap_or((low, high));
        let is_usual = low <= soft.0 && soft.0 <= soft.1 && soft.1 <= high;
        (!is_sound || !is_usual).then(|| "the default or the slider lies out of range".to_owned())
    }

    fn examples(&self) -> Vec<Json> {
        vec![self.hard.0.into(), T::large_example(self).into()]
    }

    fn link_type(&self) -> Option<DataType> {
        Some(f64::TYPE)
    }

    fn value_when_on(&self) -> Option<Json> {
        Some(self.default.map_or_else(|| self.range().middle(T::USUAL), Into::into))
    }

    fn another(&self, value: &Json) -> Json {
        self.range().double(value.as_f64().unwrap_or_default())
    }
}

/// The range in words, without the ends that only the number format sets.
fn between((low, high): (f64, f64)) -> String {
    const ENDLESS: f64 = 9.0e15;
    match (low > -ENDLESS, high < ENDLESS) {
        (true, true) if low == f64::MIN_POSITIVE => format!(" above 0 and up to {high}"),
        (true, false) if low == f64::MIN_POSITIVE => " above 0".to_owned(),
        (true, true) => format!(" from {low} to {high}"),
        (true, false) => format!(" of {low} or more"),
        (false, true) => format!(" of {high} or less"),
        (false, false) => String::new(),
    }
}

/// Numbers of a parameter that is one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NumericRange {
    /// Whether they are whole.
    pub is_whole: bool,
    /// Both ends of what is allowed.
    pub hard: (f64, f64),
    /// Both ends of what a slider shows.
    pub soft: Option<(f64, f64)>,
}

impl NumericRange {
    /// The allowed value nearest to a number.
    pub fn nearest(&self, number: f64) -> Json {
        let number = number.clamp(self.hard.0, self.hard.1);
        if self.is_whole { Json::from(number.round() as i64) } else { Json::from(number) }
    }

    /// The middle of what is usual: the geometric one where that spans decades, as on a slider.
    fn middle(&self, otherwise: (f64, f64)) -> Json {
        let within = (self.hard.0.max(otherwise.0), self.hard.1.min(otherwise.1));
        let (from, to) = self.soft.unwrap_or(within);
        let spans_decades = from > 0.0 && to > 100.0 * from;
        let middle = if spans_decades { (from * to).sqrt() } else { from + (to - from) / 2.0 };
        self.nearest(middle)
    }

    /// The double of a number, or the half of it where that is too much.
    fn double(&self, number: f64) -> Json {
        let double = if number == 0.0 { 1.0 } else { number * 2.0 };
        if (self.hard.0..=self.hard.1).contains(&double) {
            return self.nearest(double);
        }
        // Whole numbers halve towards zero.
        let half = number / 2.0;
        self.nearest(if self.is_whole { half.trunc() } else { half })
    }
}

impl ParamSpec {
    /// The range of a parameter that is a number.
    pub fn range(&self) -> Option<NumericRange> {
        let whole = self.integer().or_else(|| self.seed().map(|_| SeedSpec::RANGE));
        whole.map(|spec| spec.range()).or_else(|| self.number().map(|spec| spec.range()))
    }
}
