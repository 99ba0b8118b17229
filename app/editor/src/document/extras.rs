//! What the canvas draws beside nodes and links: frames, notes, reroutes, collapsed nodes; and what
//! views keep.
//!
//! It stands in the map's file under `canvas`, which no run reads. What is not understood there is
//! kept, and a section that was not changed is written back as it was.

use indexmap::{IndexMap, IndexSet};
use mve_core::{Link, Map};
use serde::de::{DeserializeOwned, Error};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Map as JsonMap, Value as Json};

use crate::kept::Kept;

/// The key of the section in the map's file.
const SECTION: &str = "canvas";

/// A titled rectangle behind nodes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CanvasFrame {
    /// What is in it.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub title: String,
    /// Its upper left corner.
    #[serde(with = "point")]
    pub at: [f64; 2],
    /// Width and height.
    #[serde(with = "point")]
    pub size: [f64; 2],
    /// Red, green, blue; `None` is as the theme has it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub color: Option<[u8; 3]>,
    /// Fields that this version does not know.
    #[serde(flatten)]
    pub extra: JsonMap<String, Json>,
}

/// A text on the canvas.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Note {
    /// What it says.
    pub text: String,
    /// Its upper left corner.
    #[serde(with = "point")]
    pub at: [f64; 2],
    /// Red, green, blue; `None` is as the theme has it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub color: Option<[u8; 3]>,
    /// Fields that this version does not know.
    #[serde(flatten)]
    pub extra: JsonMap<String, Json>,
}

/// A point that the wire of a link runs through. Those of one link come in the wire's order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reroute {
    /// The link.
    #[serde(serialize_with = "write_link", deserialize_with = "read_link")]
    pub link: Link,
    /// The point.
    #[serde(with = "point")]
    pub at: [f64; 2],
    /// Fields that this version does not know.
    #[serde(flatten)]
    pub extra: JsonMap<String, Json>,
}

impl CanvasFrame {
    /// Whether it holds a node of this place and size: the middle of the node is in it. So a hand
    /// that moves a node a little over the edge does not take it out.
    pub fn holds(&self, at: [f64; 2], size: [f64; 2]) -> bool {
        [0, 1].into_iter().all(|i| {
            let middle = at[i] + 0.5 * size[i];
            self.at[i] <= middle && middle <= self.at[i] + self.size[i]
        })
    }
}

/// What the canvas draws beside nodes and links, by name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Extras {
    /// Titled rectangles, the lowest first.
    pub frames: IndexMap<String, CanvasFrame>,
    /// Texts.
    pub notes: IndexMap<String, Note>,
    /// Points of wires.
    pub reroutes: IndexMap<String, Reroute>,
    /// Nodes that are drawn as their title alone.
    pub collapsed: IndexSet<String>,
    /// Nodes that show a picture of what they give.
    pub pictured: IndexSet<String>,
    /// What views of values keep.
    pub kept: Kept,
    /// What was not understood.
    rest: JsonMap<String, Json>,
}

impl Extras {
    /// Reads the section of a map.
    pub fn of(map: &Map) -> Self {
        let Some(section) = map.extra.get(SECTION) else { return Self::default() };
        // A section that is no object is none of ours; it gives way when ours is first written.
        let mut rest = section.as_object().cloned().unwrap_or_default();
        let frames = take_parts(&mut rest, "frames");
        let notes = take_parts(&mut rest, "notes");
        let reroutes = take_parts(&mut rest, "reroutes");
        let collapsed = take_names(&mut rest, "collapsed");
        let pictured = take_names(&mut rest, "pictured");
        let kept = Kept::take_from(&mut rest);
        Self { frames, notes, reroutes, collapsed, pictured, kept, rest }
    }

    /// Writes the section into a map, unless the map says the same already.
    pub(super) fn write_to(&self, map: &mut Map) {
        if Self::of(map) == *self {
            return;
        }
        let mut section = JsonMap::new();
        put_parts(&mut section, "frames", &self.frames);
        put_parts(&mut section, "notes", &self.notes);
        put_parts(&mut section, "reroutes", &self.reroutes);
        for (key, names) in [("collapsed", &self.collapsed), ("pictured", &self.pictured)] {
            if !names.is_empty() {
                section.insert(key.to_owned(), to_json(names));
            }
        }
        self.kept.write_to(&mut section);
        for (key, left) in &self.rest {
            match (section.get_mut(key), left) {
                (Some(Json::Object(parts)), Json::Object(left)) => {
                    for (name, part) in left {
                        parts.entry(name).or_insert_with(|| part.clone());
                    }
                }
                (Some(_), _) => {}
                (None, left) => {
                    section.insert(key.clone(), left.clone());
                }
            }
        }
        if section.is_empty() {
            map.extra.shift_remove(SECTION);
        } else {
            map.extra.insert(SECTION.to_owned(), Json::Object(section));
        }
    }

    /// What is understood alone, without what views keep.
    pub(super) fn without_rest(self) -> Self {
        Self { kept: Kept::default(), rest: JsonMap::new(), ..self }
    }

    /// The points that the wire of a link runs through, in its order.
    pub fn points_of<'a>(&'a self, link: &'a Link) -> impl Iterator<Item = (&'a str, [f64; 2])> {
        let of_link = self.reroutes.iter().filter(move |(_, reroute)| reroute.link == *link);
        of_link.map(|(name, reroute)| (name.as_str(), reroute.at))
    }
}

/// Takes a list of names out of the section; what is none stays.
fn take_names(rest: &mut JsonMap<String, Json>, key: &str) -> IndexSet<String> {
    let names = rest.get(key).and_then(from_json);
    if names.is_some() {
        rest.shift_remove(key);
    }
    names.unwrap_or_default()
}

/// Takes what is understood out of a part of the section.
fn take_parts<T: DeserializeOwned>(
    rest: &mut JsonMap<String, Json>,
    key: &str,
) -> IndexMap<String, T> {
    let mut parts = IndexMap::new();
    if let Some(Json::Object(object)) = rest.get_mut(key) {
        object.retain(|name, json| match from_json(json) {
            Some(part) => {
                parts.insert(name.clone(), part);
                false
            }
            None => true,
        });
        if object.is_empty() {
            rest.shift_remove(key);
        }
    }
    parts
}

fn put_parts<T: Serialize>(
    section: &mut JsonMap<String, Json>,
    key: &str,
    parts: &IndexMap<String, T>,
) {
    if !parts.is_empty() {
        section.insert(key.to_owned(), to_json(parts));
    }
}

fn from_json<T: DeserializeOwned>(json: &Json) -> Option<T> {
    T::deserialize(json).ok()
}

fn to_json<T: Serialize>(value: &T) -> Json {
    // Names, texts and finite numbers are plain data, which JSON can always say.
    serde_json::to_value(value).unwrap_or(Json::Null)
}

fn write_link<S: Serializer>(link: &Link, to: S) -> Result<S::Ok, S::Error> {
    to.collect_str(link)
}

fn read_link<'de, D: Deserializer<'de>>(from: D) -> Result<Link, D::Error> {
    let text = String::deserialize(from)?;
    text.parse().map_err(|()| D::Error::custom("expected \"node.output -> node.input\""))
}

/// A point whose whole coordinates stand without a fraction.
mod point {
    use super::*;

    pub(super) fn serialize<S: Serializer>(point: &[f64; 2], to: S) -> Result<S::Ok, S::Error> {
        let number = |x: f64| match x.fract() == 0.0 && x.abs() < 1e15 {
            true => Json::from(x as i64),
            false => Json::from(x),
        };
        point.map(number).serialize(to)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<[f64; 2], D::Error> {
        <[f64; 2]>::deserialize(from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ODD: &str = r#"{"mve": 1, "nodes": {"a": {"module": "X"}}, "canvas": {
        "frames": {"f": {"title": "in", "at": [0, 0.5], "size": [2, 1], "depth": 3}, "g": 7},
        "reroutes": {"r": {"link": "a.x -> b.y", "at": [1, 2]}, "s": {"link": "?", "at": [1, 2]}},
        "collapsed": ["a"], "views": {"front": {"new": 1}}, "camera": {"zoom": 2}}}"#;

    #[test]
    fn what_is_not_understood_is_kept() {
        let mut map = Map::parse(ODD).unwrap();
        let mut extras = Extras::of(&map);
        assert_eq!(extras.frames["f"].extra["depth"], 3);
        assert_eq!((extras.frames.len(), extras.reroutes.len()), (1, 1));
        extras.write_to(&mut map);
        assert_eq!(map.to_text(), ODD);
        let mut expected = map.extra["canvas"].clone();
        extras.collapsed.clear();
        extras.write_to(&mut map);
        expected.as_object_mut().unwrap().remove("collapsed");
        assert_eq!(map.extra["canvas"], expected);
        assert_eq!(Extras::of(&map), extras);
    }

    #[test]
    fn nothing_to_say_is_no_section() {
        let mut map = Map::default();
        let mut extras = Extras::default();
        extras.collapsed.insert("a".to_owned());
        extras.write_to(&mut map);
        assert!(map.to_text().contains("\"canvas\""));
        Extras::default().write_to(&mut map);
        assert_eq!(map, Map::default());
    }
}
