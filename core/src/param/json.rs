//! The JSON of parameters, as maps and programs have it: the one place that knows its form.

use serde_json::{Map as JsonMap, Value as Json};

use super::ParamSpec;

/// What stands for a node's module among its parameters; no parameter has this name.
pub const MODULE: &str = "module";

/// The id in the JSON of a choice or of a module, `"Id"` or `{"Id": {parameters}}`, and the
/// parameters where it says some. Anything else is no choice.
pub fn chosen(json: &Json) -> Option<(&str, Option<&JsonMap<String, Json>>)> {
    match json {
        Json::String(id) => Some((id, None)),
        Json::Object(object) if object.len() == 1 => {
            let (id, params) = object.iter().next()?;
            Some((id, Some(params.as_object()?)))
        }
        _ => None,
    }
}

/// A choice's JSON with one parameter of its entry set, or left to its default.
pub fn with_param(choice: &Json, name: &str, value: Option<Json>) -> Json {
    let Some((id, params)) = chosen(choice) else { return choice.clone() };
    let mut params = params.cloned().unwrap_or_default();
    match value {
        Some(value) => drop(params.insert(name.to_owned(), value)),
        None => drop(params.shift_remove(name)),
    }
    if params.is_empty() {
        return Json::from(id);
    }
    Json::Object(JsonMap::from_iter([(id.to_owned(), Json::Object(params))]))
}

/// What a map gives the parameter at a dotted path; `None` where it leaves it to its default.
pub fn given_at<'a>(given: &'a JsonMap<String, Json>, path: &str) -> Option<&'a Json> {
    let Some((name, nested)) = path.split_once('.') else { return given.get(path) };
    let (_, inner) = chosen(given.get(name)?)?;
    given_at(inner?, nested)
}

/// The declaration of the parameter at a dotted path, under the entries that a map chooses or, as a
/// program may choose another, under the first entry that has it.
pub fn declared_at(
    specs: &'static [ParamSpec],
    given: Option<&JsonMap<String, Json>>,
    path: &str,
) -> Option<ParamSpec> {
    let (name, nested) = path.split_once('.').map_or((path, None), |(n, rest)| (n, Some(rest)));
    let spec = specs.iter().find(|spec| spec.name == name)?;
    let Some(nested) = nested else { return Some(*spec) };
    let choice = spec.choice()?;
    let value = given.and_then(|given| given.get(name)).and_then(chosen);
    let (id, inner) = value.unwrap_or((choice.default, None));
    let entry = choice.list.find(id);
    let of_map = entry.and_then(|entry| declared_at(entry.params, inner, nested));
    of_map.or_else(|| choice.entries().find_map(|entry| declared_at(entry.params, None, nested)))
}

/// All that a map gives of these parameters, those of the entries of choices too, with dotted
/// paths.
pub fn all_given<'a>(
    specs: &'static [ParamSpec],
    given: &'a JsonMap<String, Json>,
) -> Vec<(String, ParamSpec, &'a Json)> {
    let mut all = Vec::new();
    for (name, value) in given {
        let Some(spec) = specs.iter().find(|spec| spec.name == name) else { continue };
        all.push((name.clone(), *spec, value));
        let Some((id, Some(inner))) = chosen(value) else { continue };
        let entry = spec.choice().and_then(|choice| choice.list.find(id));
        let nested = entry.map_or_else(Vec::new, |entry| all_given(entry.params, inner));
        all.extend(nested.into_iter().map(|(path, s, value)| (format!("{name}.{path}"), s, value)));
    }
    all
}

/// [`given_at`], to be changed.
pub fn given_at_mut<'a>(given: &'a mut JsonMap<String, Json>, path: &str) -> Option<&'a mut Json> {
    let Some((name, nested)) = path.split_once('.') else { return given.get_mut(path) };
    let choice = given.get_mut(name)?;
    chosen(choice)?;
    given_at_mut(choice.as_object_mut()?.values_mut().next()?.as_object_mut()?, nested)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::testing::PICK;

    #[test]
    fn a_choice_is_an_id_or_one_id_with_its_parameters() {
        assert_eq!(chosen(&json!("A")), Some(("A", None)));
        let some = json!({"A": {"x": 1}});
        assert_eq!(chosen(&some), Some(("A", some["A"].as_object())));
        for json in [json!({"A": {}, "B": {}}), json!({}), json!({"A": 3}), json!(1), json!(null)] {
            assert_eq!(chosen(&json), None, "{json}");
        }
    }

    #[test]
    fn nested_parameters_leave_no_empty_objects() {
        let set = with_param(&json!("A"), "x", Some(json!(1)));
        assert_eq!(set, json!({"A": {"x": 1}}));
        assert_eq!(with_param(&set, "x", None), json!("A"));
        assert_eq!(with_param(&json!(3), "x", Some(json!(1))), json!(3));
    }

    #[test]
    fn paths_lead_through_the_chosen_entry() {
        let given = json!({"how": {"Scaled": {"by": 5}}});
        let given = given.as_object().unwrap();
        assert_eq!(given_at(given, "how.by"), Some(&json!(5)));
        assert_eq!(given_at(given, "how.no"), None);
        let all = all_given(PICK.params, given);
        let all: Vec<_> = all.iter().map(|(path, _, value)| (path.as_str(), *value)).collect();
        assert_eq!(all, [("how", &given["how"]), ("how.by", &json!(5))]);
        let mut changed = given.clone();
        *given_at_mut(&mut changed, "how.by").unwrap() = json!(6);
        assert_eq!(json!(changed), json!({"how": {"Scaled": {"by": 6}}}));
        assert_eq!(declared_at(PICK.params, Some(given), "how.by").unwrap().name, "by");
        let zero = json!({"how": "Zero"});
        assert!(declared_at(PICK.params, zero.as_object(), "how.by").is_some());
        assert!(declared_at(PICK.params, None, "how.no").is_none());
    }
}
