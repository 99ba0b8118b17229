//! What random choices start from.

use serde_json::{Value as Json, json};

use super::super::{Fault, Param, ParamType, Setting};
use super::{IntegerSpec, Kind, Misfit, ParamKind};
use crate::data::{Data, DataType};

/// The number that random choices start from. Repeat `r` of a step runs with the seed plus `r`.
#[derive(Clone, Copy, Debug)]
pub struct SeedSpec {
    /// Where a map says nothing.
    pub default: u32,
}

/// What random choices start from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seed(pub u64);

impl SeedSpec {
    /// The numbers that a seed may be.
    pub(super) const RANGE: IntegerSpec =
        IntegerSpec { default: None, hard: (0, u32::MAX as i64), soft: None };
}

impl ParamKind for SeedSpec {
    fn default_json(&self) -> Option<Json> {
        Some(Json::from(self.default))
    }

    fn parse(&self, json: &Json, faults: &mut Vec<Fault>) -> Result<Setting, Misfit> {
        Self::RANGE.parse(json, faults)
    }

    fn schema(&self) -> Json {
        Self::RANGE.schema()
    }

    fn noun(&self) -> String {
        "seed".to_owned()
    }

    fn examples(&self) -> Vec<Json> {
        vec![json!(0), json!(u32::MAX)]
    }

    fn link_type(&self) -> Option<DataType> {
        Some(f64::TYPE)
    }

    fn another(&self, value: &Json) -> Json {
        Json::from(value.as_u64().unwrap_or_default().saturating_add(1) % (1 << 32))
    }

    fn repeat(&self, setting: &mut Setting, repeat: u32) {
        if let Setting::Integer(seed) = setting {
            *seed += i64::from(repeat);
        }
    }
}

impl Param<Seed> {
    /// A seed.
    pub const fn seed(name: &'static str, doc: &'static str, default: u32) -> Self {
        Self::of_kind(name, doc, Kind::Seed(SeedSpec { default }))
    }
}

impl ParamType for Seed {
    fn from_setting(setting: &Setting) -> Option<Self> {
        match setting {
            Setting::Integer(seed) => Some(Self(*seed as u64)),
            _ => None,
        }
    }
}
