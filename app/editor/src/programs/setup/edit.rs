//! Edits of a program, as data: what an edit does not name stays as the file says it.
//!
//! An axis whose lists differ in length, which only a file can say, keeps them until a row of it is
//! added, removed or moved, or [`ProgramEdit::EvenOut`] asks for it.

use indexmap::IndexMap;
use mve_core::ProgramSpec;
use serde_json::Value as Json;

/// Lists of values by the path of their parameter, which advance together.
pub type Axis = IndexMap<String, Vec<Json>>;

/// One change of a program. Places count from 0; one that is not there changes nothing.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)] // The fields are what their names say, in every variant.
pub enum ProgramEdit {
    /// A parameter varies on an axis of its own.
    AddAxis {
        path: String,
        values: Vec<Json>,
    },
    RemoveAxis {
        axis: usize,
    },
    MoveAxis {
        from: usize,
        to: usize,
    },
    /// A parameter advances together with those of an axis, with one value for every row.
    JoinAxis {
        axis: usize,
        path: String,
        value: Json,
    },
    /// A parameter leaves an axis; the last one takes the axis with it.
    RemoveParam {
        axis: usize,
        path: String,
    },
    /// The values of a parameter. The other lists of the axis are cut, or repeat their last value.
    SetList {
        axis: usize,
        path: String,
        values: Vec<Json>,
    },
    SetValue {
        axis: usize,
        path: String,
        row: usize,
        value: Json,
    },
    /// A row below this one, with its values.
    AddRow {
        axis: usize,
        row: usize,
    },
    RemoveRow {
        axis: usize,
        row: usize,
    },
    MoveRow {
        axis: usize,
        from: usize,
        to: usize,
    },
    /// Lists that are too short repeat their last value.
    EvenOut {
        axis: usize,
    },
    AddStep {
        step: IndexMap<String, Json>,
    },
    RemoveStep {
        step: usize,
    },
    MoveStep {
        from: usize,
        to: usize,
    },
    SetInStep {
        step: usize,
        path: String,
        value: Json,
    },
    /// The step leaves a parameter as the map has it.
    LeaveInStep {
        step: usize,
        path: String,
    },
    /// None and 1 are the same; the file says nothing then.
    SetRepeats {
        repeats: u32,
    },
    SetTimeLimit {
        seconds: Option<f64>,
    },
}

impl ProgramEdit {
    /// Changes a program.
    pub fn apply(self, spec: &mut ProgramSpec) {
        match self {
            Self::AddAxis { path, values } if !values.is_empty() => {
                spec.axes.push(IndexMap::from_iter([(path, values)]));
            }
            Self::AddAxis { .. } => {}
            Self::RemoveAxis { axis } => remove(&mut spec.axes, axis),
            Self::MoveAxis { from, to } => shift(&mut spec.axes, from, to),
            Self::RemoveParam { axis, path } => {
                let Some(lists) = spec.axes.get_mut(axis) else { return };
                lists.shift_remove(&path);
                if lists.is_empty() {
                    spec.axes.remove(axis);
                }
            }
            Self::RemoveRow { axis, .. } if n_rows_of(spec, axis) == 1 => {
                remove(&mut spec.axes, axis);
            }
            Self::AddStep { step } => spec.steps.push(step),
            Self::RemoveStep { step } => remove(&mut spec.steps, step),
            Self::MoveStep { from, to } => shift(&mut spec.steps, from, to),
            Self::SetInStep { step, path, value } => {
                if let Some(step) = spec.steps.get_mut(step) {
                    step.insert(path, value);
                }
            }
            Self::LeaveInStep { step, path } => {
                if let Some(step) = spec.steps.get_mut(step) {
                    step.shift_remove(&path);
                }
            }
            Self::SetRepeats { repeats } => spec.repeats = (repeats > 1).then_some(repeats),
            Self::SetTimeLimit { seconds } => spec.time_limit = seconds,
            in_axis => in_axis.apply_to_axis(spec),
        }
    }

    fn apply_to_axis(self, spec: &mut ProgramSpec) {
        let axes = &mut spec.axes;
        match self {
            Self::JoinAxis { axis, path, value } => {
                let Some(lists) = axes.get_mut(axis).filter(|lists| !lists.contains_key(&path))
                else {
                    return;
                };
                let values = vec![value; n_rows(lists)];
                lists.insert(path, values);
            }
            Self::SetList { axis, path, values } => {
                let Some(lists) = axes.get_mut(axis).filter(|_| !values.is_empty()) else { return };
                let n = values.len();
                if let Some(list) = lists.get_mut(&path) {
                    *list = values;
                    lists.values_mut().for_each(|list| fit(list, n));
                }
            }
            Self::SetValue { axis, path, row, value } => {
                let list = axes.get_mut(axis).and_then(|lists| lists.get_mut(&path));
                if let Some(known) = list.and_then(|list| list.get_mut(row)) {
                    *known = value;
                }
            }
            Self::AddRow { axis, row } => change_rows(axes.get_mut(axis), |list| {
                let row = row.min(list.len().saturating_sub(1));
                let value = list.get(row).cloned().unwrap_or_default();
                list.insert((row + 1).min(list.len()), value);
            }),
            Self::RemoveRow { axis, row } => {
                change_rows(axes.get_mut(axis), |list| remove(list, row))
            }
            Self::MoveRow { axis, from, to } => {
                change_rows(axes.get_mut(axis), |list| shift(list, from, to));
            }
            Self::EvenOut { axis } => change_rows(axes.get_mut(axis), |_| {}),
            _ => {}
        }
    }
}

/// How many rows an axis has: the length of its longest list.
pub fn n_rows(axis: &Axis) -> usize {
    axis.values().map(Vec::len).max().unwrap_or(0)
}

/// Whether all lists of an axis are equally long.
pub fn is_even(axis: &Axis) -> bool {
    axis.values().all(|list| list.len() == n_rows(axis))
}

/// The axis that varies a parameter.
pub fn axis_of(spec: &ProgramSpec, path: &str) -> Option<usize> {
    spec.axes.iter().position(|axis| axis.contains_key(path))
}

fn n_rows_of(spec: &ProgramSpec, axis: usize) -> usize {
    spec.axes.get(axis).map_or(0, n_rows)
}

/// Changes every list of an axis alike, after making them equally long.
fn change_rows(axis: Option<&mut Axis>, change: impl Fn(&mut Vec<Json>)) {
    let Some(axis) = axis else { return };
    let n = n_rows(axis);
    for list in axis.values_mut() {
        fit(list, n);
        change(list);
    }
}

/// Cuts a list, or repeats its last value.
fn fit(list: &mut Vec<Json>, n: usize) {
    let last = list.last().cloned().unwrap_or_default();
    list.resize(n, last);
}

fn remove<T>(list: &mut Vec<T>, place: usize) {
    if place < list.len() {
        list.remove(place);
    }
}

/// Moves an entry so that it stands at `to` afterwards.
fn shift<T>(list: &mut Vec<T>, from: usize, to: usize) {
    if from < list.len() && to < list.len() {
        let entry = list.remove(from);
        list.insert(to, entry);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use serde_json::json;

    use super::*;

    fn spec() -> ProgramSpec {
        serde_json::from_value(json!({
            "axes": [{"a.x": [1, 2, 3], "a.y": ["p", "q", "r"]}, {"b.z": [5]}],
            "steps": [{"a.x": 9}],
            "report": {"against": ["a.x"]},
            "note": "of a person",
        }))
        .unwrap()
    }

    fn after(edit: ProgramEdit) -> ProgramSpec {
        let mut spec = spec();
        edit.apply(&mut spec);
        spec
    }

    #[test]
    fn rows_of_an_axis_move_as_one() {
        let moved = after(ProgramEdit::MoveRow { axis: 0, from: 0, to: 2 });
        assert_eq!(json!(moved.axes[0]), json!({"a.x": [2, 3, 1], "a.y": ["q", "r", "p"]}));
        let removed = after(ProgramEdit::RemoveRow { axis: 0, row: 1 });
        assert_eq!(json!(removed.axes[0]), json!({"a.x": [1, 3], "a.y": ["p", "r"]}));
        let added = after(ProgramEdit::AddRow { axis: 0, row: 0 });
        assert_eq!(json!(added.axes[0]["a.x"]), json!([1, 1, 2, 3]));
    }

    #[test]
    fn the_last_value_and_the_last_parameter_take_the_axis_with_them() {
        assert_eq!(after(ProgramEdit::RemoveRow { axis: 1, row: 0 }).axes.len(), 1);
        assert_eq!(after(ProgramEdit::RemoveParam { axis: 1, path: "b.z".into() }).axes.len(), 1);
        assert_eq!(after(ProgramEdit::RemoveParam { axis: 0, path: "a.y".into() }).axes.len(), 2);
    }

    #[test]
    fn a_generated_list_takes_the_others_along() {
        let set = |values| ProgramEdit::SetList { axis: 0, path: "a.x".into(), values };
        let longer = after(set(vec![json!(0); 5]));
        assert_eq!(json!(longer.axes[0]["a.y"]), json!(["p", "q", "r", "r", "r"]));
        let shorter = after(set(vec![json!(0)]));
        assert_eq!(json!(shorter.axes[0]["a.y"]), json!(["p"]));
    }

    #[test]
    fn uneven_lists_stay_until_their_rows_change() {
        let mut uneven: ProgramSpec =
            serde_json::from_value(json!({"axes": [{"a.x": [1, 2], "a.y": [1]}]})).unwrap();
        ProgramEdit::SetValue { axis: 0, path: "a.x".into(), row: 1, value: json!(7) }
            .apply(&mut uneven);
        assert_eq!(json!(uneven.axes[0]), json!({"a.x": [1, 7], "a.y": [1]}));
        ProgramEdit::EvenOut { axis: 0 }.apply(&mut uneven);
        assert_eq!(json!(uneven.axes[0]), json!({"a.x": [1, 7], "a.y": [1, 1]}));
    }

    fn edits() -> impl Strategy<Value = ProgramEdit> {
        let path = prop_oneof![Just("a.x"), Just("a.y"), Just("b.z"), Just("c.w")];
        let path = path.prop_map(str::to_owned);
        let values = prop::collection::vec((0..9).prop_map(Json::from), 0..5);
        let place = 0..5_usize;
        let all = (path, values, place.clone(), place.clone(), place, 0..15);
        all.prop_map(|(path, values, axis, from, to, kind)| match kind {
            0 => ProgramEdit::AddAxis { path, values },
            1 => ProgramEdit::RemoveAxis { axis },
            2 => ProgramEdit::MoveAxis { from, to },
            3 => ProgramEdit::JoinAxis { axis, path, value: json!(0) },
            4 => ProgramEdit::RemoveParam { axis, path },
            5 => ProgramEdit::SetList { axis, path, values },
            6 => ProgramEdit::SetValue { axis, path, row: from, value: json!(8) },
            7 => ProgramEdit::AddRow { axis, row: from },
            8 => ProgramEdit::RemoveRow { axis, row: from },
            9 => ProgramEdit::MoveRow { axis, from, to },
            10 => ProgramEdit::EvenOut { axis },
            11 => ProgramEdit::AddStep { step: IndexMap::from_iter([(path, json!(1))]) },
            12 => ProgramEdit::RemoveStep { step: axis },
            13 => ProgramEdit::SetInStep { step: axis, path, value: json!(2) },
            _ => ProgramEdit::SetRepeats { repeats: axis as u32 },
        })
    }

    proptest! {
        #[test]
        fn axes_stay_equally_long_and_the_rest_stays(
            edits in prop::collection::vec(edits(), 0..40),
        ) {
            let mut spec = spec();
            for edit in edits {
                edit.apply(&mut spec);
                for axis in &spec.axes {
                    prop_assert!(is_even(axis) && n_rows(axis) > 0, "{axis:?}");
                }
                prop_assert_eq!(&spec.extra, &self::spec().extra);
                prop_assert_eq!(&spec.report, &self::spec().report);
            }
        }
    }
}
