//! Tables, each with its columns as they are: sorted by a click, copied, plotted.

use std::sync::Arc;

use eframe::egui;
use mve_core::Value;
use mve_modules::data::Table;

use super::heading::heading;
use super::memo::{Memo, Same};
use super::table::{CellTable, Column, TableView};
use super::{PanelPlace, Pinned, ValueView, ViewInput, ViewerAction};

/// The view of tables, one below the other.
#[derive(Default)]
pub struct TablesView {
    /// Each with its title.
    tables: Vec<(String, OneTable)>,
}

/// The state of one table on the screen.
#[derive(Default)]
struct OneTable {
    cells: Memo<Same<Table>, Arc<CellTable>>,
    view: TableView,
}

impl ValueView for TablesView {
    fn place(&self) -> PanelPlace {
        PanelPlace::Column("tables")
    }

    fn takes(&self, value: &Value, _all: &[Pinned]) -> bool {
        value.get::<Table>().is_some()
    }

    fn is_empty(&self, value: &Value) -> bool {
        value.get::<Table>().is_some_and(|table| table.columns.is_empty())
    }

    fn n_parts(&self, n_values: usize) -> usize {
        n_values
    }

    fn show(&mut self, ui: &mut egui::Ui, shown: &ViewInput) -> Vec<ViewerAction> {
        let mut actions = Vec::new();
        let is_shown = |title: &str| shown.values.iter().any(|(_, pinned)| pinned.title == title);
        self.tables.retain(|(title, _)| is_shown(title));
        for (place, title, table) in shown.of::<Table>() {
            if heading(ui, title) {
                actions.push(ViewerAction::Unpin(place));
            }
            let known = self.tables.iter().position(|(known, _)| known == title);
            let known = known.unwrap_or_else(|| {
                self.tables.push((title.to_owned(), OneTable::default()));
                self.tables.len() - 1
            });
            let size = egui::vec2(ui.available_width(), shown.height.max(60.0));
            ui.allocate_ui(size, |ui| {
                ui.push_id(title, |ui| self.tables[known].1.show(ui, &table));
            });
        }
        actions
    }

    fn forget(&mut self) {
        self.tables.clear();
    }

    fn is_busy(&self) -> bool {
        self.tables.iter().any(|(_, one)| one.cells.is_busy())
    }
}

impl OneTable {
    fn show(&mut self, ui: &mut egui::Ui, table: &Arc<Table>) {
        let job = Arc::clone(table);
        self.cells.want(ui.ctx(), Same(Arc::clone(table)), move || Arc::new(cells_of(&job)));
        match self.cells.latest() {
            Some(cells) => {
                self.view.show(ui, &cells);
            }
            None => {
                ui.weak("putting into rows…");
            }
        }
    }
}

/// The rows of a table; a text that is missing is an empty cell.
fn cells_of(table: &Table) -> CellTable {
    let column = |column: &mve_modules::data::TableColumn| Column {
        name: column.shown_name().to_owned(),
        unit: column.unit.clone(),
    };
    let row = |row| table.columns.iter().map(|column| column.values.cell(row)).collect();
    CellTable {
        columns: table.columns.iter().map(column).collect(),
        rows: (0..table.n_rows()).map(row).collect(),
    }
}

#[cfg(test)]
mod tests {
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;
    use mve_modules::data::TableColumn;

    use super::super::PortState;
    use super::*;

    #[test]
    fn two_tables_are_shown_sorted_apart_and_can_be_unpinned() {
        let pinned = |title: &str, numbers: &[f64]| {
            let lengths = TableColumn::numbers("length", numbers.to_vec()).titled("Length");
            let names = numbers.iter().map(|number| format!("edge of {number}")).collect();
            let columns = vec![lengths.in_unit("mm"), TableColumn::texts("name", names)];
            let (value, state) = (Some(Value::new(Table { columns })), PortState::Ready);
            Pinned { title: title.to_owned(), value, state, mesh: None }
        };
        let both = [pinned("a.table", &[2.5, 1.5]), pinned("b.table", &[7.5, 8.5])];
        type State = (TablesView, Vec<ViewerAction>);
        let show = |ui: &mut egui::Ui, (view, actions): &mut State| {
            let values = both.iter().enumerate().collect();
            let shown = ViewInput { values, all: &both, height: 200.0, render: None, picked: None };
            actions.extend(view.show(ui, &shown));
        };
        let size = egui::vec2(400.0, 500.0);
        let mut harness = Harness::builder().with_size(size).build_ui_state(show, State::default());
        while harness.state().0.is_busy() {
            std::thread::sleep(std::time::Duration::from_millis(2));
            harness.step();
        }
        harness.run();
        let top = |harness: &Harness<State>, text: &str| harness.get_by_label(text).rect().top();
        assert!(top(&harness, "edge of 2.5") < top(&harness, "edge of 1.5"));
        let sorts: Vec<_> = harness.query_all_by_label("Sort by Length").collect();
        assert_eq!(sorts.len(), 2, "by its name for a person");
        sorts[0].click();
        harness.run();
        assert!(top(&harness, "edge of 1.5") < top(&harness, "edge of 2.5"));
        assert!(top(&harness, "edge of 7.5") < top(&harness, "edge of 8.5"), "as it was");
        harness.get_by_label("Unpin b.table").click();
        harness.run();
        assert_eq!(harness.state().1, [ViewerAction::Unpin(1)]);
    }
}
