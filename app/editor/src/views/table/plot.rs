//! A plot of a column: over its rows, over another column, or how often its values are.

use eframe::egui;
use egui_plot::{Legend, Line, Plot, PlotPoints, Points};

use super::data::{CellTable, Column};
use crate::views::spread::Spread;

/// What is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum PlotKind {
    #[default]
    Line,
    Points,
    Histogram,
}

/// The state of a plot under a table.
#[derive(Default)]
pub struct TablePlot {
    /// The column that is drawn; `None`: no plot.
    column: Option<usize>,
    /// The column of the horizontal axis; `None`: the number of the row.
    over: Option<usize>,
    kind: PlotKind,
}

impl TablePlot {
    /// Whether it takes space.
    pub fn is_open(&self) -> bool {
        self.column.is_some()
    }

    /// What is drawn, as a row of controls.
    pub fn controls(&mut self, ui: &mut egui::Ui, table: &CellTable) {
        let numeric: Vec<usize> =
            (0..table.columns.len()).filter(|&column| table.has_numbers(column)).collect();
        if numeric.is_empty() || table.rows.len() < 2 {
            self.column = None;
            return;
        }
        choose(ui, "Plot", "none", &mut self.column, &numeric, table);
        if self.column.is_none() {
            return;
        }
        ui.label("as");
        let kinds = egui::ComboBox::from_id_salt("plot kind").selected_text(name_of(self.kind));
        kinds.show_ui(ui, |ui| {
            for kind in [PlotKind::Line, PlotKind::Points, PlotKind::Histogram] {
                ui.selectable_value(&mut self.kind, kind, name_of(kind));
            }
        });
        if self.kind != PlotKind::Histogram {
            choose(ui, "over", "row", &mut self.over, &numeric, table);
        }
    }

    /// Draws it in the rest of the space, rows in the given order.
    pub fn show(&self, ui: &mut egui::Ui, table: &CellTable, order: &[usize]) {
        let Some(column) = self.column.filter(|&column| column < table.columns.len()) else {
            return;
        };
        let name = table.columns[column].title();
        let over = self.over.filter(|&over| over < table.columns.len());
        let (x_label, y_label) = match (self.kind, over) {
            (PlotKind::Histogram, _) => (name.clone(), "rows".to_owned()),
            (_, Some(over)) => (table.columns[over].title(), name.clone()),
            (_, None) => ("row".to_owned(), name.clone()),
        };
        let plot = Plot::new("table plot")
            .legend(Legend::default())
            .x_axis_label(x_label)
            .y_axis_label(y_label);
        plot.show(ui, |plot| match self.kind {
            PlotKind::Histogram => {
                let values: Vec<f64> =
                    order.iter().filter_map(|&row| table.number(row, column)).collect();
                plot.bar_chart(Spread::of(&values).chart(&name));
            }
            kind => {
                let points = points(table, order, column, over);
                match kind {
                    PlotKind::Line => plot.line(Line::new(name.clone(), PlotPoints::from(points))),
                    _ => {
                        let points = Points::new(name.clone(), PlotPoints::from(points));
                        plot.points(points.radius(3.0));
                    }
                }
            }
        });
    }
}

fn name_of(kind: PlotKind) -> &'static str {
    match kind {
        PlotKind::Line => "line",
        PlotKind::Points => "points",
        PlotKind::Histogram => "histogram",
    }
}

fn choose(
    ui: &mut egui::Ui,
    label: &str,
    nothing: &str,
    chosen: &mut Option<usize>,
    columns: &[usize],
    table: &CellTable,
) {
    let named = chosen.and_then(|column| table.columns.get(column));
    let text = named.map_or(nothing.to_owned(), Column::title);
    ui.label(label);
    egui::ComboBox::from_id_salt(label).selected_text(text).show_ui(ui, |ui| {
        ui.selectable_value(chosen, None, nothing);
        for &column in columns {
            ui.selectable_value(chosen, Some(column), table.columns[column].title());
        }
    });
}

/// The points of a line. Over a column they are in its order, else in that of the rows.
fn points(table: &CellTable, order: &[usize], column: usize, over: Option<usize>) -> Vec<[f64; 2]> {
    let point = |(at, &row): (usize, &usize)| {
        let y = table.number(row, column)?;
        let x = match over {
            Some(over) => table.number(row, over)?,
            None => at as f64,
        };
        (x.is_finite() && y.is_finite()).then_some([x, y])
    };
    let mut points: Vec<[f64; 2]> = order.iter().enumerate().filter_map(point).collect();
    if over.is_some() {
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    }
    points
}

#[cfg(test)]
mod tests {
    use mve_core::Scalar;

    use super::super::data::Column;
    use super::*;

    #[test]
    fn points_over_a_column_are_in_its_order_and_finite() {
        let cell = |x: f64| Some(Scalar::Number(x));
        let columns = vec![Column::default(), Column::default()];
        let rows = [[3.0, 1.0], [1.0, 2.0], [f64::NAN, 5.0], [2.0, f64::INFINITY]];
        let rows = rows.map(|row| row.map(cell).to_vec()).to_vec();
        let table = CellTable { columns, rows };
        assert_eq!(points(&table, &[0, 1, 2, 3], 1, Some(0)), [[1.0, 2.0], [3.0, 1.0]]);
        assert_eq!(points(&table, &[2, 1, 0], 1, None), [[0.0, 5.0], [1.0, 2.0], [2.0, 1.0]]);
    }
}
