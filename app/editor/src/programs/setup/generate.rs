//! Lists of values that a person need not type: ranges of numbers, and files of a folder.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use mve_core::ParamSpec;
use serde_json::Value as Json;

/// No list that a person reads is longer.
pub const MOST_VALUES: usize = 1000;

/// How the numbers of a range follow each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progression {
    /// With equal differences.
    Arithmetic,
    /// With equal quotients; needs ends of one sign.
    Geometric,
}

/// A range of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Its first number.
    pub from: f64,
    /// Its last number.
    pub to: f64,
    /// How many there are.
    pub count: usize,
    /// How they follow each other.
    pub spacing: Progression,
}

impl Range {
    /// Its numbers, both ends included; none if there is no such range.
    pub fn numbers(&self) -> Vec<f64> {
        let Self { from, to, count, spacing } = *self;
        let is_sound = from.is_finite()
            && to.is_finite()
            && (spacing == Progression::Arithmetic || (from * to > 0.0 && (to / from).is_finite()));
        if !is_sound || count == 0 || count > MOST_VALUES {
            return Vec::new();
        }
        let last = (count - 1).max(1) as f64;
        let number = |place: usize| {
            let share = place as f64 / last;
            match spacing {
                // The ends are what was typed, to the last bit.
                _ if place == 0 => from,
                _ if place + 1 == count => to,
                Progression::Arithmetic => from + (to - from) * share,
                Progression::Geometric => from * (to / from).powf(share),
            }
        };
        (0..count).map(number).collect()
    }

    /// Its numbers as values of a parameter: whole where it wants whole ones, within its range, and
    /// each once.
    pub fn values(&self, spec: &ParamSpec) -> Vec<Json> {
        let Some(range) = spec.range() else { return Vec::new() };
        let tidied = |x: f64| range.nearest(if range.is_whole { x } else { tidy(x) });
        let mut values: Vec<Json> = self.numbers().into_iter().map(tidied).collect();
        values.dedup();
        values
    }
}

/// A number without the rounding of its computation: the shortest one within a part in 10^12.
fn tidy(number: f64) -> f64 {
    let short = format!("{number:.11e}").parse();
    short.unwrap_or(number)
}

/// Files below a folder whose names match, as paths relative to `map_folder`, sorted. `pattern` is
/// a name in which `*` stands for any text; several are separated by spaces.
pub fn files(map_folder: &Path, folder: &str, pattern: &str) -> Result<Vec<Json>, String> {
    let at = map_folder.join(folder);
    let entries = fs::read_dir(&at).map_err(|error| format!("{}: {error}", at.display()))?;
    let names: BTreeSet<String> = entries
        .flatten()
        .filter(|entry| entry.path().is_file())
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .filter(|name| pattern.split_whitespace().any(|pattern| is_match(pattern, name)))
        .collect();
    // Maps say paths with slashes on every system.
    let folder = folder.replace('\\', "/");
    let folder = folder.trim_end_matches('/');
    let path = |name: String| match folder {
        "" | "." => Json::from(name),
        _ => Json::from(format!("{folder}/{name}")),
    };
    Ok(names.into_iter().take(MOST_VALUES).map(path).collect())
}

/// Whether a name matches a pattern, whatever the case of its letters.
fn is_match(pattern: &str, name: &str) -> bool {
    let (pattern, name) = (pattern.to_lowercase(), name.to_lowercase());
    let parts: Vec<&str> = pattern.split('*').collect();
    let [first, middle @ .., last] = parts.as_slice() else { return pattern == name };
    let rest = name.strip_prefix(first).and_then(|rest| rest.strip_suffix(last));
    let Some(mut rest) = rest else { return false };
    middle.iter().all(|part| match rest.find(part) {
        Some(place) => {
            rest = &rest[place + part.len()..];
            true
        }
        None => false,
    })
}

/// The pattern of the files that a parameter takes.
pub fn pattern_of(spec: &ParamSpec) -> String {
    let extensions = spec.input_file().map_or(&[][..], |file| file.extensions);
    let patterns: Vec<_> = extensions.iter().map(|extension| format!("*.{extension}")).collect();
    if patterns.is_empty() { "*".to_owned() } else { patterns.join(" ") }
}

#[cfg(test)]
mod tests {
    use mve_core::Param;
    use serde_json::json;

    use super::*;

    fn range(from: f64, to: f64, count: usize, spacing: Progression) -> Range {
        Range { from, to, count, spacing }
    }

    #[test]
    fn ranges_include_both_ends() {
        let linear = range(0.0, 1.0, 5, Progression::Arithmetic).numbers();
        assert_eq!(linear, [0.0, 0.25, 0.5, 0.75, 1.0]);
        let faces = Param::integer("n", "", 1).between((1, 100_000)).spec();
        let geometric = range(1000.0, 10.0, 5, Progression::Geometric).values(&faces);
        assert_eq!(json!(geometric), json!([1000, 316, 100, 32, 10]));
    }

    #[test]
    fn values_are_tidy_within_range_and_each_once() {
        let number = Param::number("x", "", 0.0).within((0.0, 0.25)).spec();
        let values = range(0.0, 0.3, 4, Progression::Arithmetic).values(&number);
        assert_eq!(json!(values), json!([0.0, 0.1, 0.2, 0.25]));
        let whole = Param::integer("n", "", 0).between((0, 9)).spec();
        assert_eq!(
            json!(range(1.0, 2.0, 9, Progression::Arithmetic).values(&whole)),
            json!([1, 2])
        );
    }

    #[test]
    fn there_are_no_values_of_what_is_no_range() {
        for bad in [
            range(0.0, 1.0, 3, Progression::Geometric),
            range(-1.0, 1.0, 3, Progression::Geometric),
            range(f64::NAN, 1.0, 3, Progression::Arithmetic),
            range(0.0, 1.0, 0, Progression::Arithmetic),
            range(0.0, 1.0, MOST_VALUES + 1, Progression::Arithmetic),
        ] {
            assert!(bad.numbers().is_empty(), "{bad:?}");
        }
        assert_eq!(range(3.0, 4.0, 1, Progression::Arithmetic).numbers(), [3.0]);
    }

    #[test]
    fn patterns_match_whole_names() {
        for (pattern, name) in
            [("*", "x"), ("*.obj", "A.OBJ"), ("a*b*c", "a1b2c"), ("a.obj", "a.obj"), ("*a*", "a")]
        {
            assert!(is_match(pattern, name), "{pattern} {name}");
        }
        for (pattern, name) in
            [("*.obj", "a.obj.txt"), ("a", "ab"), ("ab*ba", "aba"), ("*x*y", "y")]
        {
            assert!(!is_match(pattern, name), "{pattern} {name}");
        }
    }

    #[test]
    fn files_are_sorted_and_relative_to_the_map() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("in")).unwrap();
        for name in ["b.obj", "a.obj", "c.txt"] {
            fs::write(folder.path().join("in").join(name), "").unwrap();
        }
        let found = files(folder.path(), "in/", "*.obj").unwrap();
        assert_eq!(json!(found), json!(["in/a.obj", "in/b.obj"]));
        assert!(files(folder.path(), "nowhere", "*").is_err());
    }
}
