//! `true` or `false`.

use serde_json::{Value as Json, json};

use super::super::{Fault, Param, ParamType, Setting};
use super::{Kind, Misfit, ParamKind};
use crate::data::{Data, DataType};

/// `true` or `false`.
#[derive(Clone, Copy, Debug)]
pub struct FlagSpec {
    /// Where a map says nothing.
    pub default: bool,
}

impl ParamKind for FlagSpec {
    fn default_json(&self) -> Option<Json> {
        Some(Json::from(self.default))
    }

    fn parse(&self, json: &Json, _: &mut Vec<Fault>) -> Result<Setting, Misfit> {
        let flag = json.as_bool().map(Setting::Flag);
        flag.ok_or_else(|| Misfit::Expected("true or false".to_owned()))
    }

    fn schema(&self) -> Json {
        json!({ "type": "boolean" })
    }

    fn noun(&self) -> String {
        "flag".to_owned()
    }

    fn examples(&self) -> Vec<Json> {
        vec![json!(true), json!(false)]
    }

    fn link_type(&self) -> Option<DataType> {
        Some(bool::TYPE)
    }

    fn another(&self, value: &Json) -> Json {
        Json::from(!value.as_bool().unwrap_or_default())
    }
}

impl Param<bool> {
    /// A flag.
    pub const fn flag(name: &'static str, doc: &'static str, default: bool) -> Self {
        Self::of_kind(name, doc, Kind::Flag(FlagSpec { default }))
    }
}

impl ParamType for bool {
    fn from_setting(setting: &Setting) -> Option<Self> {
        match setting {
            Setting::Flag(flag) => Some(*flag),
            _ => None,
        }
    }
}
