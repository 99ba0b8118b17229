//! A table on the screen: sorted by a click, copied as text, with a plot under it.

use std::sync::Arc;

use eframe::egui::{self, Align, Layout, vec2};
use mve_core::Scalar;

use super::data::{CellTable, Column, cell_text};
use super::head::{Head, LETTER, Sort, header};
use super::plot::TablePlot;
use crate::views::number::{ColumnFormat, count_text};

/// The state of one table on the screen.
#[derive(Default)]
pub struct TableView {
    sort: Sort,
    /// Order of rows and widths of columns, for the table that they were made for.
    laid_out: Option<(Arc<CellTable>, Sort, RowLayout)>,
    plot: TablePlot,
}

#[derive(Clone, Default)]
struct RowLayout {
    order: Arc<[usize]>,
    widths: Arc<[f32]>,
    formats: Arc<[ColumnFormat]>,
}

/// Rows that are looked at for the width of a column.
const N_SAMPLED: usize = 300;

impl TableView {
    /// Shows a table, and under it a plot if one is wanted. Another table must be another `Arc`.
    /// Returns the row that was clicked.
    pub fn show(&mut self, ui: &mut egui::Ui, table: &Arc<CellTable>) -> Option<usize> {
        let laid_out = self.arrange(table);
        ui.horizontal_wrapped(|ui| {
            let copy = ui.button("Copy").on_hover_text("Copy as tab-separated text");
            if copy.clicked() {
                ui.ctx().copy_text(table.to_tsv(&laid_out.order));
            }
            self.plot.controls(ui, table);
            let n_rows = count_text(table.rows.len());
            ui.weak(format!("{n_rows} {}", if table.rows.len() == 1 { "row" } else { "rows" }));
        });
        let height = ui.available_height();
        let table_height = if self.plot.is_open() { 0.5 * height } else { height };
        let clicked = ui
            .allocate_ui(vec2(ui.available_width(), table_height), |ui| {
                egui::ScrollArea::horizontal()
                    .id_salt("table columns")
                    .auto_shrink([false, false])
                    .show(ui, |ui| {
                        ui.vertical(|ui| {
                            let heads = table.columns.iter().zip(laid_out.widths.iter());
                            let heads = heads.map(|(column, &width)| Head {
                                name: &column.name,
                                title: column.title(),
                                doc: "",
                                width,
                            });
                            header(ui, heads, &mut self.sort);
                            rows(ui, table, &laid_out)
                        })
                        .inner
                    })
                    .inner
            })
            .inner;
        self.plot.show(ui, table, &laid_out.order);
        clicked
    }

    fn arrange(&mut self, table: &Arc<CellTable>) -> RowLayout {
        if let Some((of, sort, laid_out)) = &self.laid_out
            && Arc::ptr_eq(of, table)
            && *sort == self.sort
        {
            return laid_out.clone();
        }
        let order = match self.sort {
            Some((column, direction)) => table.order_by(column, direction),
            None => (0..table.rows.len()).collect(),
        };
        let sampled = |at: usize| {
            (0..table.rows.len().min(N_SAMPLED)).filter_map(move |row| table.cell(row, at))
        };
        let format = |at: usize| {
            ColumnFormat::of(sampled(at).filter_map(|cell| match cell {
                Scalar::Number(number) => Some(*number),
                _ => None,
            }))
        };
        let formats: Arc<[ColumnFormat]> = (0..table.columns.len()).map(format).collect();
        let width = |(at, column): (usize, &Column)| {
            let sampled = sampled(at).map(|cell| cell_text(cell, formats[at]).chars().count());
            let most = sampled.max().unwrap_or(0).max(column.title().chars().count() + 3);
            LETTER * (most as f32).clamp(5.0, 48.0)
        };
        let widths = table.columns.iter().enumerate().map(width).collect();
        let laid_out = RowLayout { order: order.into(), widths, formats: Arc::clone(&formats) };
        self.laid_out = Some((Arc::clone(table), self.sort, laid_out.clone()));
        laid_out
    }
}

fn rows(ui: &mut egui::Ui, table: &CellTable, laid_out: &RowLayout) -> Option<usize> {
    let height = ui.text_style_height(&egui::TextStyle::Body) + 4.0;
    let mut clicked = None;
    let area = egui::ScrollArea::vertical().id_salt("table rows").auto_shrink([false, false]);
    area.show_rows(ui, height, laid_out.order.len(), |ui, visible| {
        for &row in laid_out.order.get(visible).unwrap_or_default() {
            ui.horizontal(|ui| {
                let columns = laid_out.widths.iter().zip(laid_out.formats.iter()).enumerate();
                for (column, (&width, &format)) in columns {
                    let cell = table.cell(row, column);
                    let is_number = matches!(cell, Some(Scalar::Number(_)));
                    let text = cell.map_or(String::new(), |cell| cell_text(cell, format));
                    let align = if is_number { Align::Max } else { Align::Min };
                    let layout = Layout::left_to_right(Align::Center)
                        .with_main_align(align)
                        .with_main_justify(true);
                    let label = egui::Label::new(text).truncate().halign(align);
                    let shown = ui
                        .allocate_ui_with_layout(vec2(width, height), layout, |ui| ui.add(label))
                        .inner;
                    if shown.clicked() {
                        clicked = Some(row);
                    }
                }
            });
        }
    });
    clicked
}
