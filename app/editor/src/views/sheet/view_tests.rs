//! Tests of the table without a window.

use mve_core::Value;
use mve_modules::data::Field;

use super::*;

fn shown(view: &mut SheetView, context: &egui::Context, pinned: &[Pinned]) {
    let mut output = context.run_ui(egui::RawInput::default(), |ui| {
        view.show(ui, pinned, None);
    });
    output.textures_delta.clear();
}

#[test]
fn the_hint_of_a_filter_names_a_column_that_is_there() {
    let (name, unit, domain) = ("bend".to_owned(), String::new(), Domain::Vertex);
    let field = Field { name, unit, domain, values: vec![0.5; 3] };
    let columns = crate::views::sheet::columns::field_columns("bend", &Arc::new(field));
    let hint = hint_of(&columns);
    let filter = hint.strip_prefix("filter, such as ").expect("it says that it is none");
    assert!(Filter::compile(filter, &columns).is_ok(), "{hint}");
}

#[test]
fn a_filter_that_is_taken_back_is_not_waited_for() {
    let (name, unit, domain) = ("height".to_owned(), String::new(), Domain::Vertex);
    let values = (0..100_000).map(f64::from).collect();
    let value = Some(Value::new(Field { name, unit, domain, values }));
    let pinned = [Pinned { title: "a.field".to_owned(), value, ..Pinned::default() }];
    let context = egui::Context::default();
    let mut view = SheetView::default();
    shown(&mut view, &context, &pinned);
    view.filter = "sqrt(height) > 3".to_owned();
    shown(&mut view, &context, &pinned);
    assert!(view.is_busy());
    view.filter.clear();
    shown(&mut view, &context, &pinned);
    assert!(!view.is_busy());
    // Nor is one that cannot be read.
    view.filter = "height > 3".to_owned();
    shown(&mut view, &context, &pinned);
    view.filter += " and";
    shown(&mut view, &context, &pinned);
    assert!(!view.is_busy());
}
