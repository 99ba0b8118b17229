//! JSON that reports repeated keys, which serde_json passes over in silence.

use std::cell::RefCell;
use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, MapAccess, SeqAccess, Visitor};
use serde_json::{Map as JsonMap, Number, Value as Json};

/// Reads JSON text; also gives the dotted path of every key that stands twice in its object. Of
/// two values for one key the last counts.
pub(crate) fn parse(text: &str) -> Result<(Json, Vec<String>), serde_json::Error> {
    let repeated = RefCell::new(Vec::new());
    let mut reader = serde_json::Deserializer::from_str(text);
    let json = Strict { path: &Path::Root, repeated: &repeated }.deserialize(&mut reader)?;
    reader.end()?;
    Ok((json, repeated.into_inner()))
}

enum Path<'a> {
    Root,
    Key(&'a Path<'a>, &'a str),
}

impl fmt::Display for Path<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Root => Ok(()),
            Self::Key(Self::Root, key) => f.write_str(key),
            Self::Key(above, key) => write!(f, "{above}.{key}"),
        }
    }
}

#[derive(Clone, Copy)]
struct Strict<'a> {
    path: &'a Path<'a>,
    repeated: &'a RefCell<Vec<String>>,
}

impl<'de> DeserializeSeed<'de> for Strict<'_> {
    type Value = Json;

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<Json, D::Error> {
        from.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Strict<'_> {
    type Value = Json;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("JSON")
    }

    fn visit_bool<E>(self, flag: bool) -> Result<Json, E> {
        Ok(Json::Bool(flag))
    }

    fn visit_i64<E>(self, number: i64) -> Result<Json, E> {
        Ok(Json::from(number))
    }

    fn visit_u64<E>(self, number: u64) -> Result<Json, E> {
        Ok(Json::from(number))
    }

    fn visit_f64<E>(self, number: f64) -> Result<Json, E> {
        Ok(Number::from_f64(number).map_or(Json::Null, Json::Number))
    }

    fn visit_str<E>(self, text: &str) -> Result<Json, E> {
        Ok(Json::from(text))
    }

    fn visit_unit<E>(self) -> Result<Json, E> {
        Ok(Json::Null)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Json, A::Error> {
        let mut array = Vec::new();
        while let Some(item) = items.next_element_seed(self)? {
            array.push(item);
        }
        Ok(Json::Array(array))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut items: A) -> Result<Json, A::Error> {
        let mut object = JsonMap::new();
        while let Some(key) = items.next_key::<String>()? {
            let path = Path::Key(self.path, &key);
            let value = items.next_value_seed(Strict { path: &path, ..self })?;
            let name = path.to_string();
            if object.insert(key, value).is_some() {
                self.repeated.borrow_mut().push(name);
            }
        }
        Ok(Json::Object(object))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_what_serde_json_reads() {
        let text = r#"{"a": [1, -2, 2.5, 1e300, true, null, "x\u00e9"], "b": {"c": {}}}"#;
        let (json, repeated) = parse(text).unwrap();
        assert_eq!(json, serde_json::from_str::<Json>(text).unwrap());
        assert!(repeated.is_empty());
    }

    #[test]
    fn reports_a_repeated_key_with_its_path() {
        let (json, repeated) = parse(r#"{"nodes": {"a": 1, "a": 2}}"#).unwrap();
        assert_eq!(repeated, ["nodes.a"]);
        assert_eq!(json["nodes"]["a"], 2);
    }

    #[test]
    fn text_after_the_end_is_an_error() {
        assert!(parse("{} {}").is_err());
        assert!(parse(&"[".repeat(100_000)).is_err());
    }
}
