//! Axes as a file says them: a list of values, or one value that stands for many.

use indexmap::IndexMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::Value as Json;

use crate::param::shown;
use crate::problem::did_you_mean;

/// Lists of values by the dotted paths of their parameters.
pub type Axis = IndexMap<String, Vec<Json>>;

/// The keys of values that stand for many.
const KEYS: [&str; 3] = ["glob", "range", "log"];

#[derive(Deserialize, Serialize)]
#[serde(untagged)]
enum Values {
    List(Vec<Json>),
    Spread(Json),
}

fn is_spread(value: &Json) -> bool {
    let fields = value.as_object().filter(|fields| fields.len() == 1);
    fields.is_some_and(|fields| fields.keys().all(|key| KEYS.contains(&key.as_str())))
}

/// What is wrong with an axis that cannot be read: its place, its key if it is one, a sentence.
pub(super) fn misfit(axes: &Json) -> Option<(usize, Option<String>, String)> {
    let axes = axes.as_array()?.iter().enumerate();
    axes.into_iter().find_map(|(place, axis)| {
        let n = place + 1;
        let Some(lists) = axis.as_object() else {
            let form = "an axis, such as {\"simplify.ratio\": [0.5, 0.2]}";
            return Some((place, None, format!("axis {n}: {} is not {form}", shown(axis))));
        };
        let (path, value) =
            lists.iter().find(|(_, value)| !value.is_array() && !is_spread(value))?;
        let mut keys = value.as_object().filter(|fields| fields.len() == 1).into_iter().flatten();
        let hint = keys.next().map(|(key, _)| did_you_mean(key, KEYS.into_iter()));
        let hint = hint.unwrap_or_default();
        let form = "a list of values, such as [0.5, 0.2], or what stands for many: \
                    {\"range\": [0.1, 0.5, 5]}, {\"log\": [0.02, 0.5, 5]} or \
                    {\"glob\": \"scans/*.obj\"}";
        let message = format!("axis {n}: {path}: {} is not {form}{hint}", shown(value));
        Some((place, Some(path.clone()), message))
    })
}

pub(super) fn serialize<S: Serializer>(axes: &[Axis], to: S) -> Result<S::Ok, S::Error> {
    let values = |list: &Vec<Json>| match list.as_slice() {
        [alone] if is_spread(alone) => Values::Spread(alone.clone()),
        list => Values::List(list.to_vec()),
    };
    let axis = |axis: &Axis| -> IndexMap<String, Values> {
        axis.iter().map(|(path, list)| (path.clone(), values(list))).collect()
    };
    axes.iter().map(axis).collect::<Vec<_>>().serialize(to)
}

pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<Axis>, D::Error> {
    let axes = Vec::<IndexMap<String, Values>>::deserialize(from)?;
    let list = |values: Values| match values {
        Values::List(list) => Ok(list),
        Values::Spread(value) if is_spread(&value) => Ok(vec![value]),
        Values::Spread(_) => Err(serde::de::Error::custom("neither a list nor what makes one")),
    };
    let axis = |axis: IndexMap<String, Values>| {
        axis.into_iter().map(|(path, values)| Ok((path, list(values)?))).collect()
    };
    axes.into_iter().map(axis).collect()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use crate::map::ProgramSpec;

    #[test]
    fn a_value_that_stands_for_many_is_kept_as_it_was_written() {
        let written = json!({"axes": [{"a.x": {"range": [0, 1, 5]}, "a.y": [1, 2]},
            {"a.z": {"glob": "*.obj"}}, {"b.x": [{"log": [1, 2, 3]}, 7]}]});
        let spec: ProgramSpec = serde_json::from_value(written.clone()).unwrap();
        assert_eq!(spec.axes[0]["a.x"], [json!({"range": [0, 1, 5]})]);
        assert_eq!(json!(spec), written);
        let odd = json!({"axes": [{"a.x": {"from": 3}}]});
        assert!(serde_json::from_value::<ProgramSpec>(odd).is_err());
        let odd = json!([{"a.x": [1]}, {"a.y": [2], "a.x": {"lg": 3}}]);
        let (place, key, message) = super::misfit(&odd).unwrap();
        assert_eq!((place, key.as_deref()), (1, Some("a.x")));
        assert!(
            message.starts_with("axis 2: a.x: {\"lg\":3} is not a list of values"),
            "{message}"
        );
        assert!(message.ends_with("did you mean \"log\"?"), "{message}");
    }
}
