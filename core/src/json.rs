//! JSON that reports repeated keys, which serde_json passes over in silence.

use std::cell::RefCell;
use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, MapAccess, SeqAccess, Visitor};
use serde_json::{Map as JsonMap, Number, Value as Json};

use crate::map::Step;

/// Reads JSON text; also gives the path to every key that stands twice in its object. Of two values
/// for one key the last counts.
pub(crate) fn parse(text: &str) -> Result<(Json, Vec<Vec<Step>>), serde_json::Error> {
    let repeated = RefCell::new(Vec::new());
    let mut reader = serde_json::Deserializer::from_str(text);
    let json = Strict { path: &Path::Root, repeated: &repeated }.deserialize(&mut reader)?;
    reader.end()?;
    Ok((json, repeated.into_inner()))
}

enum Path<'a> {
    Root,
    Key(&'a Path<'a>, &'a str),
    Item(&'a Path<'a>, usize),
}

impl Path<'_> {
    fn steps(&self) -> Vec<Step> {
        let (above, step) = match self {
            Self::Root => return Vec::new(),
            Self::Key(above, key) => (above, Step::from(*key)),
            Self::Item(above, place) => (above, Step::Item(*place)),
        };
        let mut steps = above.steps();
        steps.push(step);
        steps
    }
}

#[derive(Clone, Copy)]
struct Strict<'a> {
    path: &'a Path<'a>,
    repeated: &'a RefCell<Vec<Vec<Step>>>,
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
        loop {
            let path = Path::Item(self.path, array.len());
            let Some(item) = items.next_element_seed(Strict { path: &path, ..self })? else {
                break;
            };
            array.push(item);
        }
        Ok(Json::Array(array))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut items: A) -> Result<Json, A::Error> {
        let mut object = JsonMap::new();
        while let Some(key) = items.next_key::<String>()? {
            let path = Path::Key(self.path, &key);
            let value = items.next_value_seed(Strict { path: &path, ..self })?;
            if object.contains_key(&key) {
                self.repeated.borrow_mut().push(path.steps());
            }
            object.insert(key, value);
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
    fn reports_a_repeated_key_with_its_path() -> Result<(), serde_json::Error> {
        let (json, repeated) = parse(r#"{"nodes": {"a": 1, "a": 2}, "b": [0, {"c": 1, "c": 2}]}"#)?;
        assert_eq!(repeated[0], ["nodes".into(), "a".into()]);
        assert_eq!(repeated[1], ["b".into(), Step::Item(1), "c".into()]);
        assert_eq!(json["nodes"]["a"], 2);
        Ok(())
    }

    #[test]
    fn text_after_the_end_is_an_error() {
        assert!(parse("{} {}").is_err());
        assert!(parse(&"[".repeat(100_000)).is_err());
    }
}
