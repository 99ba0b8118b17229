//! Short names of parameters' values, and short numbers.

use std::collections::HashSet;

use indexmap::IndexMap;
use serde_json::Value as Json;

/// Longest name of a value, in characters.
const LONGEST: usize = 60;

/// A value in few words: `ImageMse (resolution 256)`, `cow.obj`, `off`.
pub fn of_value(value: &Json) -> String {
    shortened(&mve_core::brief_value(value))
}

/// A value without quotes where it is a text, `off` where it is none: for tables to compute with.
pub fn word(value: &Json) -> String {
    match value {
        Json::Null => of_value(value),
        Json::String(text) => text.clone(),
        other => other.to_string(),
    }
}

/// Names of the values of an axis, as short as they can be and still be told apart.
pub fn of_axis(values: &[Vec<Option<Json>>]) -> Vec<String> {
    let n_paths = values.first().map_or(0, Vec::len);
    let shown = |value: &Option<Json>| value.as_ref().map(of_value).unwrap_or_default();
    let one = |place: usize| values.iter().map(|value| shown(&value[place])).collect::<Vec<_>>();
    let is_telling = |place: &usize| {
        values.iter().all(|value| value[*place].is_some()) && are_distinct(&one(*place))
    };
    let last_text = |value: &Vec<Option<Json>>| {
        let last = value.iter().rev().flatten().find(|part| part.is_string());
        last.map_or_else(String::new, |part| file_name(&of_value(part)))
    };
    let last_texts: Vec<String> = values.iter().map(last_text).collect();
    let mut labels = match (0..n_paths).find(is_telling) {
        Some(place) => one(place),
        None if are_distinct(&last_texts) && !last_texts.contains(&String::new()) => last_texts,
        None => values.iter().map(|value| joined(value)).collect(),
    };
    let names: Vec<String> = labels.iter().map(|label| file_name(label)).collect();
    if are_distinct(&names) {
        labels = names;
    }
    if !are_distinct(&labels) {
        labels = labels.iter().enumerate().map(|(i, l)| format!("{l} ({})", i + 1)).collect();
    }
    labels
}

/// The values that a step sets; one that is off says so, one that is not set is the map's.
fn joined(value: &[Option<Json>]) -> String {
    let parts = value.iter().flatten().map(|part| file_name(&of_value(part)));
    let parts: Vec<_> = parts.collect();
    if parts.is_empty() { "as in the map".to_owned() } else { shortened(&parts.join(", ")) }
}

/// Without the folder, where the text looks like a path.
fn file_name(text: &str) -> String {
    let name = text.rsplit(['/', '\\']).next().filter(|name| !name.trim().is_empty());
    name.unwrap_or(text).to_owned()
}

fn are_distinct(names: &[String]) -> bool {
    names.iter().collect::<HashSet<_>>().len() == names.len()
}

/// A text cut to what a heading of a table can hold.
pub fn shortened(text: &str) -> String {
    shortened_to(text, LONGEST)
}

/// A text cut to so many characters.
pub fn shortened_to(text: &str, longest: usize) -> String {
    match text.char_indices().nth(longest) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

/// Parameters as one text, the same for the same ones in any order.
pub fn canonical(params: &IndexMap<String, Json>) -> String {
    let mut parts: Vec<_> = params.iter().map(|(path, value)| format!("{path}={value}")).collect();
    parts.sort();
    parts.join("\n")
}

/// A number to a few significant digits, without an exponent where that is short.
pub fn rounded(value: f64, digits: usize) -> String {
    let text = format!("{value:.*e}", digits.saturating_sub(1));
    text.parse::<f64>().map_or(text, mve_core::brief)
}

/// A number to a few significant digits, with an exponent.
pub fn with_exponent(value: f64, digits: usize) -> String {
    let text = format!("{value:.*e}", digits.saturating_sub(1));
    match text.split_once('e') {
        _ if value == 0.0 => "0".to_owned(),
        Some((number, e)) if number.contains('.') => {
            format!("{}e{e}", number.trim_end_matches('0').trim_end_matches('.'))
        }
        _ => text,
    }
}

/// A probability: `0.031`, `< 0.001`.
pub fn probability(p: f64) -> String {
    if p < 0.001 { "< 0.001".to_owned() } else { format!("= {}", rounded(p, 2)) }
}

/// Seconds for a person: `0.12 s`, `3 min 20 s`.
pub fn duration(seconds: f64) -> String {
    if seconds < 60.0 {
        return format!("{} s", rounded(seconds, 3));
    }
    let whole = seconds.round() as u64;
    let (hours, minutes, rest) = (whole / 3600, whole / 60 % 60, whole % 60);
    if hours > 0 { format!("{hours} h {minutes} min") } else { format!("{minutes} min {rest} s") }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn values_are_short() {
        assert_eq!(
            of_value(&json!({ "ImageMse": { "resolution": 256 } })),
            "ImageMse (resolution 256)"
        );
        let two = json!({ "Msdm2": { "scales": 3, "mode": "fast" } });
        assert_eq!(of_value(&two), "Msdm2 (scales 3, mode fast)");
        assert_eq!(of_value(&json!("Quadric")), "Quadric");
        assert_eq!(of_value(&json!(null)), "off");
        assert_eq!(of_value(&json!("ä".repeat(99))).chars().count(), LONGEST + 1);
    }

    #[test]
    fn axes_are_told_apart() {
        let axis = |values: Json| -> Vec<String> {
            let value = |json: &Json| (json != "none").then(|| json.clone());
            let values = values.as_array().unwrap().iter();
            let values = values.map(|v| v.as_array().unwrap().iter().map(value).collect());
            of_axis(&values.collect::<Vec<_>>())
        };
        assert_eq!(axis(json!([["Box", 300], ["Vase", 300]])), ["Box", "Vase"]);
        let files = json!([["L", "m/cow.obj"], ["L", "m/spot.obj"]]);
        assert_eq!(axis(files), ["cow.obj", "spot.obj"]);
        assert_eq!(axis(json!([["Box", "none"], ["L", "m/cow.obj"]])), ["Box", "L"]);
        let more = json!([["Box", "none"], ["L", "m/cow.obj"], ["L", "m/spot.obj"]]);
        assert_eq!(axis(more), ["Box", "cow.obj", "spot.obj"]);
        let same = json!([["L", "a/cow.obj"], ["L", "b/cow.obj"]]);
        assert_eq!(axis(same), ["a/cow.obj", "b/cow.obj"]);
        let twins = json!([["L", "none"], ["L", "m/cow.obj"]]);
        assert_eq!(axis(twins), ["L", "cow.obj"]);
    }

    #[test]
    fn off_is_off_and_what_is_not_set_is_the_maps() {
        let angle = [vec![Some(json!(10))], vec![Some(json!(null))]];
        assert_eq!(of_axis(&angle), ["10", "off"]);
        let angle = [vec![Some(json!(10))], vec![Some(json!(null))], vec![None]];
        assert_eq!(of_axis(&angle), ["10", "off", "as in the map"]);
    }

    #[test]
    fn times_and_probabilities() {
        assert_eq!(duration(0.01234), "0.0123 s");
        assert_eq!((duration(200.0), duration(7260.0)), ("3 min 20 s".into(), "2 h 1 min".into()));
        assert_eq!((probability(1e-9), probability(0.0312)), ("< 0.001".into(), "= 0.031".into()));
    }
}
