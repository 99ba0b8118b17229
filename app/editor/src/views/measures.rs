//! Named numbers of several places as one table, so that they can be compared.

use std::sync::Arc;

use eframe::egui;
use mve_core::{Scalar, Value};
use mve_modules::data::Measures;

use super::heading::heading;
use super::memo::Same;
use super::table::{CellTable, Column, TableView};
use super::{PanelPlace, Pinned, ValueView, ViewInput, ViewerAction};

/// The view of measures, all in one table.
#[derive(Default)]
pub struct MeasuresView {
    measures: MeasuresTable,
    table: TableView,
}

impl ValueView for MeasuresView {
    fn place(&self) -> PanelPlace {
        PanelPlace::Column("tables")
    }

    fn takes(&self, value: &Value, _all: &[Pinned]) -> bool {
        value.get::<Measures>().is_some()
    }

    fn show(&mut self, ui: &mut egui::Ui, shown: &ViewInput) -> Vec<ViewerAction> {
        let (mut actions, mut inputs) = (Vec::new(), Vec::new());
        for (place, title, measures) in shown.of::<Measures>() {
            if heading(ui, title) {
                actions.push(ViewerAction::Unpin(place));
            }
            inputs.push(MeasuresInput { title: title.to_owned(), measures });
        }
        let table = self.measures.of(&inputs);
        self.table.show(ui, &table);
        actions
    }
}

/// Measures to show.
#[derive(Clone)]
struct MeasuresInput {
    /// Where they come from: `compare.measures`.
    title: String,
    /// The numbers.
    measures: Arc<Measures>,
}

/// A row for each name, in the order in which they first appear: name, unit, one column of values
/// for each input, and what is measured.
fn table_of(inputs: &[MeasuresInput]) -> CellTable {
    let named = |name: &str| Column { name: name.to_owned(), unit: String::new() };
    let mut columns = vec![named("measure")];
    columns.extend(inputs.iter().map(|input| named(&input.title)));
    columns.extend([named("unit"), named("meaning")]);
    let mut names: Vec<&mve_modules::data::Measure> = Vec::new();
    for measure in inputs.iter().flat_map(|input| &input.measures.0) {
        if names.iter().all(|known| known.name != measure.name) {
            names.push(measure);
        }
    }
    let text = |text: &str| Some(Scalar::Text(text.to_owned()));
    let row = |known: &&mve_modules::data::Measure| {
        let of_input = |input: &MeasuresInput| {
            let found = input.measures.0.iter().find(|measure| measure.name == known.name)?;
            Some(Scalar::Number(found.value))
        };
        let mut row = vec![text(&known.name)];
        row.extend(inputs.iter().map(of_input));
        row.extend([text(&known.unit), text(&known.doc)]);
        row
    };
    CellTable { columns, rows: names.iter().map(row).collect() }
}

/// What a table is made of.
type Origin = Vec<(String, Same<Measures>)>;

/// The table of the last inputs, made anew when they change.
#[derive(Default)]
struct MeasuresTable {
    made: Option<(Origin, Arc<CellTable>)>,
}

impl MeasuresTable {
    /// The table of some inputs.
    fn of(&mut self, inputs: &[MeasuresInput]) -> Arc<CellTable> {
        let key: Origin = inputs
            .iter()
            .map(|input| (input.title.clone(), Same(Arc::clone(&input.measures))))
            .collect();
        match &self.made {
            Some((known, table)) if *known == key => Arc::clone(table),
            _ => {
                let table = Arc::new(table_of(inputs));
                self.made = Some((key, Arc::clone(&table)));
                table
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use mve_core::Quantity;
    use mve_modules::data::Measure;

    use super::*;

    #[test]
    fn measures_of_one_name_share_a_row() {
        let input = |title: &str, list: &[(&'static str, f64)]| {
            let measure = |&(name, value)| Measure::of(&Quantity::new(name, "What it is."), value);
            let measures = Measures(list.iter().map(measure).collect());
            MeasuresInput { title: title.to_owned(), measures: Arc::new(measures) }
        };
        let inputs = [input("a.m", &[("max", 2.0), ("mean", 1.0)]), input("b.m", &[("max", 3.0)])];
        let table = table_of(&inputs);
        let names: Vec<_> = table.columns.iter().map(|column| column.name.as_str()).collect();
        assert_eq!(names, ["measure", "a.m", "b.m", "unit", "meaning"]);
        assert_eq!(table.rows.len(), 2);
        assert_eq!(table.cell(0, 2), Some(&Scalar::Number(3.0)));
        assert_eq!(table.cell(1, 2), None);
        let mut cached = MeasuresTable::default();
        let first = cached.of(&inputs);
        assert!(Arc::ptr_eq(&first, &cached.of(&inputs)));
        assert!(!Arc::ptr_eq(&first, &cached.of(&inputs[..1])));
    }
}
