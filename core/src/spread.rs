//! Values of axes that are not written one by one: files of a pattern, and numbers between two.

use std::path::Path;
use std::time::Duration;

use indexmap::{IndexMap, IndexSet};
use serde_json::Value as Json;

use crate::map::Axis;
use crate::pattern::{self, Bounds};

/// No table that a person reads is longer; it stops a slip from filling the memory.
pub(crate) const MOST_STEPS: usize = 1_000_000;

/// How far the search for the files of a pattern goes.
const BOUNDS: Bounds = Bounds { entries: MOST_STEPS, time: Duration::from_secs(10) };

/// The most digits of a number that is computed, so that it reads well and is the same everywhere.
const DIGITS: usize = 6;

/// What axes are spread with.
pub(crate) struct Spreader<'a> {
    /// Where files are looked for, and from where they are named.
    pub folder: &'a Path,
    /// Whether the parameter of this path takes whole numbers alone.
    pub is_whole: &'a dyn Fn(&str) -> bool,
}

/// An axis with every value written out.
pub(crate) struct SpreadAxis {
    pub axis: Axis,
    /// What a person should know of it: the parameter and a sentence.
    pub remarks: Vec<(String, String)>,
}

impl Spreader<'_> {
    /// An axis with every value written out, files in the order of their names. Numbers that are
    /// computed for a parameter of whole ones are rounded, and those of them that are then the same
    /// are one. The error is a parameter with a sentence for a person.
    pub fn spread(&self, axis: &Axis) -> Result<SpreadAxis, (String, String)> {
        let mut whole = IndexMap::new();
        let mut remarks = Vec::new();
        for (path, values) in axis {
            let mut all = Vec::with_capacity(values.len());
            let mut rounded = Vec::new();
            for value in values {
                let mut remark = None;
                let spread = made(value, self.folder, &mut remark);
                let spread = spread.map_err(|why| (path.clone(), format!("{path}: {why}")))?;
                remarks.extend(remark.map(|remark| (path.clone(), format!("{path}: {remark}"))));
                match spread {
                    Some(numbers) if (self.is_whole)(path) => {
                        let fractions = numbers.iter().filter(|number| number.is_f64()).cloned();
                        rounded.extend(fractions);
                        all.extend(numbers.iter().map(to_whole));
                    }
                    Some(mut made) => all.append(&mut made),
                    None => all.push(value.clone()),
                }
            }
            if !rounded.is_empty() {
                // Values of several parameters that advance together are counted together.
                let n_all = all.len();
                if axis.len() == 1 {
                    let mut known = IndexSet::new();
                    all.retain(|value| known.insert(value.to_string()));
                }
                remarks.push((path.clone(), of_rounding(path, &rounded, (n_all, all.len()))));
            }
            whole.insert(path.clone(), all);
        }
        Ok(SpreadAxis { axis: whole, remarks })
    }
}

/// The whole number next to a number.
fn to_whole(number: &Json) -> Json {
    match number.as_f64().filter(|_| number.is_f64()) {
        Some(fraction) => Json::from(fraction.round() as i64),
        None => number.clone(),
    }
}

/// What is said where values were rounded.
fn of_rounding(path: &str, rounded: &[Json], (n_before, n): (usize, usize)) -> String {
    let shown = rounded.iter().take(3).map(|value| format!("{value} to {}", to_whole(value)));
    let shown = shown.collect::<Vec<_>>().join(", ");
    let more = if rounded.len() > 3 { ", …" } else { "" };
    let doubles = match n_before - n {
        0 => String::new(),
        left => format!("; {left} of {n_before} are then the same as others and left out"),
    };
    format!("{path} takes whole numbers, so values are rounded: {shown}{more}{doubles}")
}

/// The values that `{"glob": …}`, `{"range": …}` or `{"log": …}` stands for; any other value stands
/// for itself.
fn made(
    value: &Json,
    folder: &Path,
    remark: &mut Option<String>,
) -> Result<Option<Vec<Json>>, String> {
    let fields = value.as_object().filter(|fields| fields.len() == 1);
    match fields.and_then(|fields| fields.iter().next()) {
        Some((key, pattern)) if key == "glob" => files(pattern, folder, remark).map(Some),
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

fn files(pattern: &Json, folder: &Path, remark: &mut Option<String>) -> Result<Vec<Json>, String> {
    let form = || format!("{pattern} is not a pattern of files, such as \"scans/*.obj\"");
    let text = pattern.as_str().ok_or_else(form)?;
    let found = pattern::files(text, folder, BOUNDS)
        .map_err(|error| format!("{}: {}", form(), pattern::fault(&error)))?;
    if let Some(n) = found.given_up_at {
        return Err(format!(
            "the search for {pattern} was given up after {n} files and folders: it goes on for at \
             most {} s; name a folder nearer to the files",
            BOUNDS.time.as_secs()
        ));
    }
    if found.files.len() > MOST_STEPS {
        return Err(format!(
            "{pattern} fits {} files; the most is {MOST_STEPS}",
            found.files.len()
        ));
    }
    if found.n_nameless > 0 {
        let files = if found.n_nameless == 1 { "file is" } else { "files are" };
        let why = "left out, as the name is not UTF-8, which a map is";
        *remark = Some(format!("{} {files} {why}", found.n_nameless));
    }
    if folder.join(text).is_dir() {
        return Err(format!("{pattern} is a folder; its files are \"{text}/*\""));
    }
    match found.closed {
        Some(why) if found.files.is_empty() => {
            Err(format!("no file is named like {pattern}; {why}"))
        }
        None if found.files.is_empty() => Err(format!("no file is named like {pattern}")),
        _ => Ok(found.files.iter().map(|file| Json::from(file.to_string_lossy())).collect()),
    }
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
        let spread = Spreader { folder, is_whole: &|_| false }.spread(&axis);
        spread.map(|spread| json!(spread.axis["a.x"])).map_err(|(_, why)| why)
    }

    #[test]
    fn whole_numbers_are_rounded_and_each_is_there_once() {
        let of = |axis: Json| {
            let axis: Axis = serde_json::from_value(axis).unwrap();
            let is_whole = |path: &str| path == "a.faces";
            let spread = Spreader { folder: Path::new(""), is_whole: &is_whole }.spread(&axis);
            let SpreadAxis { axis, remarks } = spread.ok().unwrap();
            (json!(axis), remarks.into_iter().map(|(_, text)| text).collect::<Vec<_>>())
        };
        let (axis, said) = of(json!({"a.faces": [{"log": [1, 4, 5]}, 2.5]}));
        assert_eq!(axis, json!({"a.faces": [1, 2, 3, 4, 2.5]}));
        let expected = "a.faces takes whole numbers, so values are rounded: 1.41421 to 1, 2.82843 \
                        to 3; 1 of 6 are then the same as others and left out";
        assert_eq!(said, [expected]);
        let (axis, said) = of(json!({"a.faces": [{"log": [1, 4, 3]}]}));
        assert_eq!((axis, said.len()), (json!({"a.faces": [1, 2, 4]}), 0));
        // Advancing with others they stay as many.
        let (axis, said) =
            of(json!({"a.faces": [{"range": [1, 2, 3]}], "a.x": [{"range": [1, 2, 3]}]}));
        assert_eq!(axis, json!({"a.faces": [1, 2, 2], "a.x": [1, 1.5, 2]}));
        assert!(said[0].ends_with("rounded: 1.5 to 2"), "{said:?}");
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
        assert!(why.starts_with("a.x: no file is named like \"scan/*.obj\"; "), "{why}");
        let why = values(json!({"glob": "scans"}), folder.path()).unwrap_err();
        assert_eq!(why, "a.x: \"scans\" is a folder; its files are \"scans/*\"");
        let why = values(json!({"glob": "scans/[.obj"}), folder.path()).unwrap_err();
        assert!(why.contains(": a [ is not closed"), "{why}");
    }
}
