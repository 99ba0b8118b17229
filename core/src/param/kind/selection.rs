//! Faces or vertices of a mesh.
//!
//! The JSON is a list of indices and of ranges, both ends of which belong to it, in rising order:
//! `[3, [10, 20]]`. A set has one such form: neighbors stand as a range from three of them on. As a
//! person types it, the same is `3, 10-20`.

use std::fmt;

use serde_json::{Value as Json, json};

use super::super::setting::shown;
use super::super::{Fault, Param, ParamType, Setting, Structured};
use super::points::unknown_input;
use super::{Kind, Misfit, ParamKind};
use crate::port::InputSpec;

/// Faces or vertices of the mesh at an input; none by default.
#[derive(Clone, Copy, Debug)]
pub struct SelectionSpec {
    /// Name of the input with the mesh.
    pub of: &'static str,
    /// What is selected.
    pub domain: SelectionDomain,
}

/// What a selection is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SelectionDomain {
    /// Faces.
    Faces,
    /// Vertices.
    Vertices,
}

impl SelectionDomain {
    /// In the plural.
    pub fn name(self) -> &'static str {
        match self {
            Self::Faces => "faces",
            Self::Vertices => "vertices",
        }
    }
}

/// Indices of faces or vertices, each once.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Selection {
    /// First and last of each run of neighbors, rising, with a gap between any two.
    runs: Vec<(u32, u32)>,
}

impl Selection {
    /// The selection of these indices, in any order.
    pub fn of(indices: impl IntoIterator<Item = u32>) -> Self {
        Self::of_runs(indices.into_iter().map(|index| (index, index)).collect())
    }

    /// Joins runs, in any order, that touch or overlap.
    fn of_runs(mut all: Vec<(u32, u32)>) -> Self {
        all.sort_unstable();
        let mut runs: Vec<(u32, u32)> = Vec::new();
        for (first, last) in all {
            match runs.last_mut() {
                Some((_, end)) if first <= end.saturating_add(1) => *end = last.max(*end),
                _ => runs.push((first, last)),
            }
        }
        Self { runs }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.runs.iter().map(|(first, last)| (last - first) as usize + 1).sum()
    }

    /// Whether nothing is selected.
    pub fn is_empty(&self) -> bool {
        self.runs.is_empty()
    }

    /// Whether an index is selected.
    pub fn contains(&self, index: u32) -> bool {
        let place = self.runs.partition_point(|(_, last)| *last < index);
        self.runs.get(place).is_some_and(|(first, _)| *first <= index)
    }

    /// The indices, rising.
    pub fn iter(&self) -> impl Iterator<Item = u32> + '_ {
        self.runs.iter().flat_map(|(first, last)| *first..=*last)
    }

    /// Whether all indices are below `n`, the number of faces or vertices of the mesh; the error is
    /// a sentence about the last one.
    pub fn check(&self, n: usize) -> Result<(), String> {
        match self.runs.last() {
            Some((_, last)) if *last as usize >= n => {
                Err(format!("selects {last}, but the mesh has {n}, counted from 0"))
            }
            _ => Ok(()),
        }
    }

    /// Reads what a person types: `3, 10-20`, in any order.
    pub fn from_text(text: &str) -> Result<Self, String> {
        let parts = text.split([',', ' ', ';', '\n']).filter(|part| !part.is_empty());
        let number = |text: &str| {
            let fault = || format!("\"{text}\" is no index; write indices and ranges: 3, 10-20");
            text.parse::<u32>().map_err(|_| fault())
        };
        let run = |part: &str| {
            let (first, last) = part.split_once(['-', '\u{2013}']).unwrap_or((part, part));
            let (first, last) = (number(first)?, number(last)?);
            if first > last { Err(format!("{part} runs backwards")) } else { Ok((first, last)) }
        };
        Ok(Self::of_runs(parts.map(run).collect::<Result<_, _>>()?))
    }

    /// The JSON of this selection.
    pub fn to_json(&self) -> Json {
        let run = |&(first, last): &(u32, u32)| match last - first {
            0 => vec![json!(first)],
            1 => vec![json!(first), json!(last)],
            _ => vec![json!([first, last])],
        };
        Json::Array(self.runs.iter().flat_map(run).collect())
    }

    /// Reads JSON; the error is a sentence.
    pub fn from_json(json: &Json) -> Result<Self, String> {
        let index = |json: &Json| json.as_u64().and_then(|index| u32::try_from(index).ok());
        let form = || format!("{} is no list of indices and ranges: [3, [10, 20]]", shown(json));
        let mut runs: Vec<(u32, u32)> = Vec::new();
        for part in json.as_array().ok_or_else(form)? {
            let run = match part.as_array().map(Vec::as_slice) {
                None => index(part).map(|index| (index, index)),
                Some([first, last]) => index(first).zip(index(last)),
                Some(_) => None,
            };
            let (first, last) = run.ok_or_else(|| {
                format!("{} is neither an index nor a range such as [10, 20]", shown(part))
            })?;
            if first > last {
                return Err(format!("the range {} runs backwards", shown(part)));
            }
            if let Some((_, before)) = runs.last().filter(|(_, before)| *before >= first) {
                return Err(format!(
                    "{first} stands behind {before}; indices rise, and each stands once"
                ));
            }
            runs.push((first, last));
        }
        Ok(Self::of_runs(runs))
    }
}

/// As a person types it.
impl fmt::Display for Selection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (place, (first, last)) in self.runs.iter().enumerate() {
            f.write_str(if place == 0 { "" } else { ", " })?;
            match last == first {
                true => write!(f, "{first}")?,
                false => write!(f, "{first}-{last}")?,
            }
        }
        Ok(())
    }
}

impl ParamKind for SelectionSpec {
    fn default_json(&self) -> Option<Json> {
        Some(json!([]))
    }

    fn parse(&self, json: &Json, _: &mut Vec<Fault>) -> Result<Setting, Misfit> {
        let selection = Selection::from_json(json).map_err(Misfit::Sentence)?;
        Ok(Setting::Structured(Structured::new(selection.to_json(), selection)))
    }

    fn schema(&self) -> Json {
        let index = json!({ "type": "integer", "minimum": 0, "maximum": u32::MAX });
        let range = json!({ "type": "array", "items": index, "minItems": 2, "maxItems": 2 });
        json!({ "type": "array", "items": { "anyOf": [index, range] } })
    }

    fn noun(&self) -> String {
        format!("selection of {} of {}, such as [3, [10, 20]]", self.domain.name(), self.of)
    }

    fn fault(&self, inputs: &[InputSpec]) -> Option<String> {
        unknown_input(self.of, inputs)
    }

    fn examples(&self) -> Vec<Json> {
        vec![json!([]), json!([0]), json!([[0, 2], u32::MAX])]
    }

    fn summary(&self, value: &Json) -> Option<String> {
        let n = Selection::from_json(value).ok()?.len();
        let name = self.domain.name();
        Some(if n == 0 { format!("no {name}") } else { format!("{n} {name}") })
    }
}

impl Param<Selection> {
    /// Faces or vertices of the mesh at the input of this name; none by default.
    pub const fn selection(
        name: &'static str,
        doc: &'static str,
        domain: SelectionDomain,
        of: &'static str,
    ) -> Self {
        Self::of_kind(name, doc, Kind::Selection(SelectionSpec { of, domain }))
    }
}

impl ParamType for Selection {
    fn from_setting(setting: &Setting) -> Option<Self> {
        setting.structured()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbors_join_and_three_are_a_range() {
        let selection = Selection::of([7, 3, 5, 4, 9, 10, 7]);
        assert_eq!(selection.to_json(), json!([[3, 5], 7, 9, 10]));
        assert_eq!(selection.to_string(), "3-5, 7, 9-10");
        assert_eq!(selection.len(), 6);
        assert_eq!(selection.iter().collect::<Vec<_>>(), [3, 4, 5, 7, 9, 10]);
        let within: Vec<u32> = (0..12).filter(|index| selection.contains(*index)).collect();
        assert_eq!(within, [3, 4, 5, 7, 9, 10]);
        assert_eq!(selection.check(11), Ok(()));
        assert!(selection.check(10).unwrap_err().contains("selects 10"));
    }

    #[test]
    fn all_that_a_person_types_is_read() {
        let read = |text: &str| Selection::from_text(text).map(|s| s.to_json());
        assert_eq!(read("10-12, 3 , 11 4"), Ok(json!([3, 4, [10, 12]])));
        assert_eq!(read(""), Ok(json!([])));
        for bad in ["a", "-1", "3-", "5-4", "1.5", "4294967296"] {
            assert!(read(bad).is_err(), "{bad}");
        }
        let whole = Selection::from_text("0-4294967295").unwrap();
        assert_eq!(Selection::of_runs(vec![(u32::MAX, u32::MAX), (0, u32::MAX)]), whole);
    }

    #[test]
    fn each_fault_is_named() {
        let said = |json: Json| Selection::from_json(&json).unwrap_err();
        assert_eq!(said(json!([5, 3])), "3 stands behind 5; indices rise, and each stands once");
        assert!(said(json!([[1, 4], 4])).starts_with("4 stands behind 4"));
        assert_eq!(said(json!([[4, 1]])), "the range [4,1] runs backwards");
        assert_eq!(said(json!([-1])), "-1 is neither an index nor a range such as [10, 20]");
        assert!(said(json!([[1, 2, 3]])).starts_with("[1,2,3] is neither"));
        assert!(said(json!("3")).contains("is no list of indices"));
    }
}
