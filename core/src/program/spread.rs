//! Values of axes that are not written one by one: files of a pattern, and numbers between two.

use std::path::Path;

use glob::{MatchOptions, Pattern, glob_with};
use indexmap::IndexMap;
use serde_json::Value as Json;

use crate::map::Axis;

/// No table that a person reads is longer; it stops a slip from filling the memory.
pub(super) const MOST_STEPS: usize = 1_000_000;

/// The most digits of a number that is computed, so that it reads well and is the same everywhere.
const DIGITS: usize = 6;

/// An axis with every value written out; the error is a sentence for a person. Files are named
/// from `folder`, in the order of their names.
pub(super) fn spread(axis: &Axis, folder: &Path) -> Result<Axis, String> {
    let mut whole = IndexMap::new();
    for (path, values) in axis {
        let mut all = Vec::with_capacity(values.len());
        for value in values {
            match made(value, folder).map_err(|why| format!("{path}: {why}"))? {
                Some(mut made) => all.append(&mut made),
                None => all.push(value.clone()),
            }
        }
        whole.insert(path.clone(), all);
    }
    Ok(whole)
}

/// The values that `{"glob": …}`, `{"range": …}` or `{"log": …}` stands for; any other value stands
/// for itself.
fn made(value: &Json, folder: &Path) -> Result<Option<Vec<Json>>, String> {
    let fields = value.as_object().filter(|fields| fields.len() == 1);
    match fields.and_then(|fields| fields.iter().next()) {
        Some((key, pattern)) if key == "glob" => files(pattern, folder).map(Some),
        Some((key, ends)) if key == "range" => {
            numbers(ends, |from, to, share| from + (to - from) * share)
                .map(Some)
                .map_err(|why| format!("{value}: {why}"))
        }
        Some((key, ends)) if key == "log" => {
            let is_positive = |end: &Json| end.as_f64().is_some_and(|end| end > 0.0);
            let ends_of = ends.as_array().map_or(&[][..], Vec::as_slice);
            if !ends_of.iter().take(2).all(is_positive) {
                return Err(format!("{value}: both ends of a logarithmic range are above 0"));
            }
            numbers(ends, |from, to, share| from * (to / from).powf(share))
                .map(Some)
                .map_err(|why| format!("{value}: {why}"))
        }
        _ => Ok(None),
    }
}

fn files(pattern: &Json, folder: &Path) -> Result<Vec<Json>, String> {
    let form = || format!("{pattern} is not a pattern of files, such as \"scans/*.obj\"");
    let text = pattern.as_str().ok_or_else(form)?;
    let base = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    // An absolute pattern takes the place of the folder, as a path does.
    let whole = Path::new(&Pattern::escape(&base.to_string_lossy())).join(text);
    let options = MatchOptions { require_literal_leading_dot: true, ..MatchOptions::new() };
    let found = glob_with(&whole.to_string_lossy(), options)
        .map_err(|error| format!("{}: {}", form(), error.msg))?;
    let found = found.flatten().filter(|path| path.is_file()).take(MOST_STEPS + 1);
    let name = |path: &Path| match Path::new(text).is_absolute() {
        true => path.to_owned(),
        false => path.strip_prefix(base).unwrap_or(path).to_owned(),
    };
    let mut names: Vec<_> = found.map(|path| name(&path)).collect();
    names.sort();
    if names.is_empty() {
        return Err(format!("no file is named like {pattern}"));
    }
    Ok(names.iter().map(|name| Json::from(name.to_string_lossy())).collect())
}

/// `n` numbers from one end to the other, both among them; whole where they are.
fn numbers(ends: &Json, at: impl Fn(f64, f64, f64) -> f64) -> Result<Vec<Json>, String> {
    let form = "write [from, to, how many], such as [0.1, 0.5, 5]".to_owned();
    let Some([from, to, n]) = ends.as_array().map(Vec::as_slice) else { return Err(form) };
    let (Some(from), Some(to), Some(n)) = (from.as_f64(), to.as_f64(), n.as_u64()) else {
        return Err(form);
    };
    if n < 2 || n > MOST_STEPS as u64 || from == to {
        return Err(format!("from 2 to {MOST_STEPS} different numbers"));
    }
    let number = |place: u64| {
        let value = match place {
            0 => from,
            place if place == n - 1 => to,
            place => rounded(at(from, to, place as f64 / (n - 1) as f64)),
        };
        match value.fract() == 0.0 && value.abs() < 1e15 {
            true => Json::from(value as i64),
            false => Json::from(value),
        }
    };
    Ok((0..n).map(number).collect())
}

fn rounded(value: f64) -> f64 {
    let digits = DIGITS - 1;
    format!("{value:.digits$e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn values(json: Json, folder: &Path) -> Result<Json, String> {
        let axis = Axis::from_iter([("a.x".to_owned(), vec![json])]);
        spread(&axis, folder).map(|axis| json!(axis["a.x"]))
    }

    #[test]
    fn ranges_hold_both_ends_and_whole_numbers_are_whole() {
        let none = Path::new("");
        let of = |json| values(json, none).unwrap();
        assert_eq!(of(json!({"range": [0.1, 0.5, 5]})), json!([0.1, 0.2, 0.3, 0.4, 0.5]));
        assert_eq!(of(json!({"range": [10, 40, 4]})), json!([10, 20, 30, 40]));
        assert_eq!(of(json!({"range": [1, 0, 3]})), json!([1, 0.5, 0]));
        assert_eq!(of(json!({"log": [0.01, 100, 5]})), json!([0.01, 0.1, 1, 10, 100]));
        // 0.02 to 0.5 by the fourth root of 25, which is the square root of 5.
        let ratios = json!([0.02, 0.0447214, 0.1, 0.223607, 0.5]);
        assert_eq!(of(json!({"log": [0.02, 0.5, 5]})), ratios);
        assert_eq!(of(json!({"Quadric": {"range": [1, 2, 3]}}))[0]["Quadric"]["range"][2], 3);
        for bad in [
            json!({"range": [1, 2]}),
            json!({"range": [1, 2, 1]}),
            json!({"range": [2, 2, 3]}),
            json!({"range": [1, 2, 1e9]}),
            json!({"log": [0, 1, 3]}),
            json!({"log": 3}),
            json!({"glob": 3}),
        ] {
            assert!(values(bad.clone(), none).is_err(), "{bad}");
        }
    }

    #[test]
    fn files_come_by_name_from_the_folder_of_the_map() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("scans")).unwrap();
        for name in ["b.obj", "a.obj", ".hidden.obj", "c.txt"] {
            std::fs::write(folder.path().join("scans").join(name), "").unwrap();
        }
        let found = values(json!({"glob": "scans/*.obj"}), folder.path()).unwrap();
        assert_eq!(found, json!(["scans/a.obj", "scans/b.obj"]));
        let why = values(json!({"glob": "scan/*.obj"}), folder.path()).unwrap_err();
        assert_eq!(why, "a.x: no file is named like \"scan/*.obj\"");
    }
}
