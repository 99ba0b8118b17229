//! The list of points in a form: a row each, with its name, place and numbers.

use eframe::egui::{self, DragValue, Id, Ui};
use mve_core::{OnFace, Point, Points, PointsSpec};

use super::widgets::{line, name_it};

/// Width of the name of a point, in points of the screen.
const NAME_WIDTH: f32 = 80.0;

/// Shows the points; what they are changed to.
pub fn edit_points(
    ui: &mut Ui,
    id: Id,
    name: &str,
    spec: &PointsSpec,
    points: &Points,
) -> Option<Points> {
    let mut changed = points.clone();
    ui.vertical(|ui| {
        let mut removed = None;
        for (place, point) in changed.0.iter_mut().enumerate() {
            let name = format!("{name} {}", place + 1);
            ui.horizontal_wrapped(|ui| {
                if show_point(ui, id.with(place), &name, spec, point) {
                    removed = Some(place);
                }
            });
        }
        if let Some(place) = removed {
            changed.0.remove(place);
        }
        let add = ui.small_button("\u{2795} Point");
        name_it(&add, &format!("Add to {name}"), 0);
        if add.clicked() {
            changed.0.push(spec.another_point(&changed));
        }
    });
    if changed == *points {
        return None;
    }
    keep_names_apart(&mut changed, points);
    Some(changed)
}

/// A name that another point has is not taken.
fn keep_names_apart(changed: &mut Points, before: &Points) {
    for place in 0..changed.0.len() {
        let name = &changed.0[place].name;
        let is_taken = changed.0.iter().filter(|point| point.name == *name).count() > 1;
        let old = before.0.get(place).filter(|_| changed.0.len() == before.0.len());
        if let Some(old) = old.filter(|old| (is_taken || name.is_empty()) && old.name != *name) {
            changed.0[place].name.clone_from(&old.name);
        }
    }
}

/// A row; whether the point is to go.
fn show_point(ui: &mut Ui, id: Id, name: &str, spec: &PointsSpec, point: &mut Point) -> bool {
    let named = |point: &Point| (point.name.clone(), ("name", NAME_WIDTH));
    let (written, look) = named(point);
    if let (Some(text), _) = line(ui, id, &format!("{name} name"), &written, look) {
        point.name = text;
    }
    for (axis, number) in ["x", "y", "z"].iter().zip(&mut point.position) {
        drag(ui, &format!("{name} {axis}"), axis, number, (f64::MIN, f64::MAX));
    }
    if let Some(input) = spec.on {
        show_place(ui, name, input, point);
    }
    for (number, value) in spec.numbers.iter().zip(&mut point.numbers) {
        let title = number.name.replace('_', " ");
        drag(ui, &format!("{name} {title}"), &title, value, number.hard);
    }
    let remove = ui.small_button("\u{2716}");
    name_it(&remove, &format!("Remove {name}"), 0);
    remove.on_hover_text("Remove this point").clicked()
}

/// Whether the point lies on a face, on which, and where: the weights of two corners, as the third
/// is what is left of 1.
fn show_place(ui: &mut Ui, name: &str, input: &str, point: &mut Point) {
    let mut is_on = point.place.is_some();
    let switch = ui.checkbox(&mut is_on, "on");
    name_it(&switch, &format!("{name} lies on {input}"), 0);
    if switch.on_hover_text(format!("whether it lies on a face of {input}")).changed() {
        let middle = OnFace { face: 0, barycentric: [0.25, 0.25, 0.5] };
        point.place = is_on.then_some(middle);
    }
    let Some(OnFace { face, barycentric: [a, b, c] }) = &mut point.place else { return };
    let drag_face = ui.add(DragValue::new(face).prefix("face "));
    name_it(&drag_face, &format!("{name} face"), 0);
    let before = (*a, *b);
    drag(ui, &format!("{name} first weight"), "", a, (0.0, 1.0));
    drag(ui, &format!("{name} second weight"), "", b, (0.0, 1.0));
    if before != (*a, *b) {
        *c = 1.0 - *a - *b;
    }
}

/// A number to drag, behind its title.
fn drag(ui: &mut Ui, name: &str, title: &str, number: &mut f64, hard: (f64, f64)) {
    let speed = (number.abs() / 100.0).max(1e-3);
    let before = *number;
    let prefix = if title.is_empty() { String::new() } else { format!("{title} ") };
    let field = DragValue::new(number).range(hard.0..=hard.1).speed(speed).prefix(prefix);
    let response: egui::Response = ui.add(field.update_while_editing(false).max_decimals(12));
    name_it(&response, name, 0);
    if !number.is_finite() {
        *number = before;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_that_is_taken_or_empty_is_put_back() {
        let spec = PointsSpec { on: None, numbers: &[] };
        let first = spec.another_point(&Points::default());
        let second = spec.another_point(&Points(vec![first.clone()]));
        let before = Points(vec![first, second]);
        for name in ["point 1", ""] {
            let mut changed = before.clone();
            changed.0[1].name = name.to_owned();
            keep_names_apart(&mut changed, &before);
            assert_eq!(changed, before);
        }
        let mut changed = before.clone();
        changed.0[1].name = "nose".to_owned();
        keep_names_apart(&mut changed, &before);
        assert_eq!(changed.0[1].name, "nose");
    }
}
