//! Texts.

use serde_json::{Value as Json, json};

use super::super::{Fault, Param, ParamSpec, ParamType, Setting};
use super::{Kind, Misfit, ParamKind};
use crate::data::{Data, DataType};

/// A text.
#[derive(Clone, Copy, Debug)]
pub struct TextSpec {
    /// Where a map says nothing.
    pub default: &'static str,
}

impl ParamKind for TextSpec {
    fn default_json(&self) -> Option<Json> {
        Some(Json::from(self.default))
    }

    fn parse(&self, json: &Json, _: &mut Vec<Fault>) -> Result<Setting, Misfit> {
        let text = json.as_str().map(|text| Setting::Text(text.to_owned()));
        text.ok_or_else(|| Misfit::Expected("a text".to_owned()))
    }

    fn schema(&self) -> Json {
        json!({ "type": "string" })
    }

    fn noun(&self) -> String {
        "text".to_owned()
    }

    fn examples(&self) -> Vec<Json> {
        vec![json!(""), json!("é\n\u{1F600}")]
    }

    fn link_type(&self) -> Option<DataType> {
        Some(String::TYPE)
    }
}

impl ParamSpec {
    /// Whether its value is a text, whatever that looks like: `300` typed for it is no number.
    pub fn is_text(&self) -> bool {
        self.text().is_some() || self.expression().is_some()
    }
}

impl Param<String> {
    /// A text.
    pub const fn text(name: &'static str, doc: &'static str, default: &'static str) -> Self {
        Self::of_kind(name, doc, Kind::Text(TextSpec { default }))
    }
}

impl ParamType for String {
    fn from_setting(setting: &Setting) -> Option<Self> {
        match setting {
            Setting::Text(text) => Some(text.clone()),
            _ => None,
        }
    }
}
