//! The results as a table: rows are drawn only where they are seen, so that a program may have
//! thousands of steps.

use std::time::Instant;

use eframe::egui::{
    Align2, Color32, FontId, Id, Rect, Response, RichText, ScrollArea, Sense, TextStyle, Ui, Vec2,
    WidgetInfo, WidgetType, pos2, vec2,
};
use mve_core::Better;

use crate::programs::results::sheet::{Sheet, SheetColumn, SheetRow, StepState, label};
use crate::programs::widgets::{button_if, count, icon_button};
use crate::programs::{ProgramAction, ProgramPanel, ProgramScene, load_step};

const ROW_HEIGHT: f32 = 20.0;
/// A column's name stands in two lines: the node, and what of it.
const HEAD_HEIGHT: f32 = 36.0;
const PADDING: f32 = 8.0;
const WIDEST_COLUMN: f32 = 220.0;
/// Failed steps that are listed with their reasons; the table has the others.
const MOST_FAILED: usize = 50;

/// What the table remembers from frame to frame.
#[derive(Default)]
pub struct TableState {
    /// The column that rows are sorted by, and whether its values rise.
    sort: Option<(String, bool)>,
    /// Id of the selected step.
    pub selected: Option<String>,
    /// Whether the selected row is to be brought into view.
    pub is_to_be_seen: bool,
    has_all_columns: bool,
    has_failed_only: bool,
    layout: Option<Layout>,
}

/// Where everything is, as long as nothing changes.
struct Layout {
    sheet_made: Instant,
    /// Places of the columns that are shown, and their widths.
    columns: Vec<(usize, f32)>,
    /// Places of the rows that are shown, in order.
    rows: Vec<usize>,
}

impl ProgramPanel {
    /// Rows of steps that failed.
    pub(in crate::programs) fn failed_rows(&self) -> impl Iterator<Item = &SheetRow> {
        self.sheet.rows.iter().filter(|row| matches!(row.state, StepState::Failed(_)))
    }

    /// Shows failed steps, each with its reason.
    pub(in crate::programs) fn show_failed(&self, ui: &mut Ui, actions: &mut Vec<ProgramAction>) {
        let n_failed = self.failed_rows().count();
        if n_failed == 0 {
            return;
        }
        let title = RichText::new(format!("{} failed", count(n_failed, "step")));
        let title = title.color(ui.visuals().error_fg_color);
        let header =
            eframe::egui::CollapsingHeader::new(title).id_salt("failed").default_open(true);
        header.show(ui, |ui| {
            let scroll = ScrollArea::vertical().id_salt("failed").max_height(96.0);
            scroll.auto_shrink([false, true]).show(ui, |ui| {
                for row in self.failed_rows().take(MOST_FAILED) {
                    let StepState::Failed(reason) = &row.state else { continue };
                    let step =
                        self.sheet.program.as_ref().and_then(|known| known.steps.get(row.place));
                    let Some(step) = step else { continue };
                    ui.horizontal_wrapped(|ui| {
                        let load =
                            icon_button(ui, "Load into the map", "Load failed step into the map");
                        if load.clicked() {
                            actions.push(load_step(step));
                        }
                        ui.label(RichText::new(label(step)).strong());
                        ui.label(reason);
                    });
                }
            });
        });
    }

    /// Shows the table, and above it what is selected.
    pub(in crate::programs) fn show_table(
        &mut self,
        ui: &mut Ui,
        scene: &ProgramScene,
        actions: &mut Vec<ProgramAction>,
    ) {
        if self.sheet.program.is_none() {
            ui.weak("The steps stand here once the program can run.");
            return;
        }
        ui.horizontal(|ui| {
            let mut changed = ui.checkbox(&mut self.table.has_all_columns, "all columns").changed();
            if self.failed_rows().next().is_some() || self.table.has_failed_only {
                changed |= ui.checkbox(&mut self.table.has_failed_only, "failed only").changed();
            }
            if changed {
                self.table.layout = None;
            }
            ui.separator();
            self.show_selected(ui, scene, actions);
        });
        self.table.lay_out(ui, &self.sheet, self.sheet_made);
        self.table.show(ui, &self.sheet);
    }

    /// A line on the selected step.
    pub(in crate::programs) fn show_selected(
        &self,
        ui: &mut Ui,
        scene: &ProgramScene,
        actions: &mut Vec<ProgramAction>,
    ) {
        let selected = self.table.selected.as_deref();
        let mut rows = (0..self.sheet.rows.len()).filter_map(|row| {
            Some((row, self.sheet.step(row).filter(|step| Some(step.id.as_str()) == selected)?))
        });
        let Some((row, step)) = rows.next() else {
            ui.weak("Click a row or a point to select its step.");
            return;
        };
        if icon_button(ui, "Load into the map", "Load selected step into the map").clicked() {
            actions.push(load_step(step));
        }
        let store = scene.store_folder(&self.sheet_name());
        let folder = store.join("steps").join(&step.id);
        let row = &self.sheet.rows[row];
        let has_run = matches!(row.state, StepState::Done | StepState::Failed(_));
        let open = button_if(
            ui,
            has_run,
            "\u{1f4c2}",
            "Open the folder of the selected step",
            "not run yet",
        );
        if open.clicked() {
            actions.push(ProgramAction::OpenFile(folder));
        }
        let text = match &row.state {
            StepState::Failed(reason) => format!("{} \u{2013} {reason}", label(step)),
            _ => label(step),
        };
        ui.add(eframe::egui::Label::new(&text).truncate()).on_hover_text(&text);
    }

    fn sheet_name(&self) -> String {
        self.sheet.program.as_ref().map(|program| program.name.clone()).unwrap_or_default()
    }
}

impl TableState {
    /// Finds which rows and columns are shown, and how wide they are, if that may have changed.
    fn lay_out(&mut self, ui: &Ui, sheet: &Sheet, sheet_made: Instant) {
        if self.layout.as_ref().is_some_and(|layout| layout.sheet_made == sheet_made) {
            return;
        }
        let font = TextStyle::Body.resolve(ui.style());
        let width = |text: &str| {
            let galley = ui.painter().layout_no_wrap(text.to_owned(), font.clone(), Color32::WHITE);
            galley.size().x
        };
        let columns = sheet.columns.iter().enumerate();
        let columns = columns.filter(|(_, column)| self.has_all_columns || column.is_chief);
        let columns = columns.map(|(place, column)| {
            let cells = sheet.rows.iter().map(|row| row.cells[place].text.as_str());
            let longest = cells.max_by_key(|text| text.chars().count()).unwrap_or_default();
            let (node, name) = head(column);
            let widest = width(longest).max(width(node) + 10.0).max(width(name) + 10.0);
            (place, widest.min(WIDEST_COLUMN) + 2.0 * PADDING)
        });
        let columns = columns.collect();
        let sort = self.sort.as_ref();
        let sort = sort.and_then(|(name, rises)| Some((sheet.column(name)?, *rises)));
        let mut rows = match sort {
            Some((column, is_rising)) => sheet.order(column, is_rising),
            None => (0..sheet.rows.len()).collect(),
        };
        if self.has_failed_only {
            rows.retain(|row| matches!(sheet.rows[*row].state, StepState::Failed(_)));
        }
        self.layout = Some(Layout { sheet_made, columns, rows });
    }

    fn show(&mut self, ui: &mut Ui, sheet: &Sheet) {
        let Some(layout) = self.layout.take() else { return };
        let width: f32 = layout.columns.iter().map(|(_, width)| width).sum();
        let height = HEAD_HEIGHT + ROW_HEIGHT * layout.rows.len() as f32;
        let mut is_sorted = false;
        let scroll = ScrollArea::both().id_salt("results").auto_shrink(false);
        scroll.show_viewport(ui, |ui, viewport| {
            ui.set_min_size(vec2(width, height));
            let origin = ui.min_rect().min;
            let size = vec2(width.max(viewport.width()), ROW_HEIGHT);
            self.bring_into_view(ui, sheet, &layout, origin);
            let first = ((viewport.min.y - HEAD_HEIGHT) / ROW_HEIGHT).floor().max(0.0) as usize;
            let last = (viewport.max.y / ROW_HEIGHT).ceil().max(0.0) as usize;
            for nth in first..last.min(layout.rows.len()) {
                let top = origin.y + HEAD_HEIGHT + ROW_HEIGHT * nth as f32;
                let rect = Rect::from_min_size(pos2(origin.x, top), size);
                self.show_row(ui, sheet, &layout, nth, rect);
            }
            // The head stays where it is while rows pass below it.
            let top = pos2(origin.x, origin.y + viewport.min.y.max(0.0));
            let head = Rect::from_min_size(top, vec2(size.x, HEAD_HEIGHT));
            is_sorted = self.show_head(ui, sheet, &layout, head);
        });
        self.layout = (!is_sorted).then_some(layout);
    }

    fn bring_into_view(
        &mut self,
        ui: &Ui,
        sheet: &Sheet,
        layout: &Layout,
        origin: eframe::egui::Pos2,
    ) {
        if !std::mem::take(&mut self.is_to_be_seen) {
            return;
        }
        let selected = self.selected.as_deref();
        let is_it = |row: &&usize| sheet.step(**row).map(|step| step.id.as_str()) == selected;
        let Some(nth) = layout.rows.iter().position(|row| is_it(&row)) else { return };
        let top = origin.y + ROW_HEIGHT * nth as f32;
        let size = vec2(1.0, HEAD_HEIGHT + ROW_HEIGHT);
        ui.scroll_to_rect(Rect::from_min_size(pos2(ui.clip_rect().left(), top), size), None);
    }

    /// The names of the columns; whether a person sorted by one.
    fn show_head(&mut self, ui: &mut Ui, sheet: &Sheet, layout: &Layout, rect: Rect) -> bool {
        ui.painter().rect_filled(rect, 0.0, ui.visuals().panel_fill);
        ui.painter().hline(
            rect.x_range(),
            rect.bottom(),
            ui.visuals().widgets.noninteractive.bg_stroke,
        );
        let mut left = rect.left();
        let mut is_sorted = false;
        for &(place, width) in &layout.columns {
            let column = &sheet.columns[place];
            let cell = Rect::from_min_size(pos2(left, rect.top()), vec2(width, HEAD_HEIGHT));
            left += width;
            let sorted = self.sort.as_ref().filter(|(name, _)| *name == column.name);
            let response = ui.interact(cell, ui.id().with(("head", &column.name)), Sense::click());
            paint_head(ui, column, cell, sorted.map(|(_, rises)| *rises), &response);
            let name = format!("Sort by {}", column.name);
            response.widget_info(|| WidgetInfo::labeled(WidgetType::Button, true, &name));
            if response.on_hover_text(about(column)).clicked() {
                self.sort = match sorted {
                    None => Some((column.name.clone(), true)),
                    Some((_, true)) => Some((column.name.clone(), false)),
                    Some((_, false)) => None,
                };
                is_sorted = true;
            }
        }
        is_sorted
    }

    fn show_row(&mut self, ui: &mut Ui, sheet: &Sheet, layout: &Layout, nth: usize, rect: Rect) {
        let place = layout.rows[nth];
        let (row, Some(step)) = (&sheet.rows[place], sheet.step(place)) else { return };
        let is_selected = self.selected.as_deref() == Some(step.id.as_str());
        let response = ui.interact(rect, Id::new(("result", ui.id(), row.place)), Sense::click());
        let visuals = ui.visuals();
        let fill = match (is_selected, response.hovered(), nth % 2) {
            (true, ..) => visuals.selection.bg_fill,
            (_, true, _) => visuals.widgets.hovered.weak_bg_fill,
            (.., 1) => visuals.faint_bg_color,
            _ => Color32::TRANSPARENT,
        };
        ui.painter().rect_filled(rect, 0.0, fill);
        let mut left = rect.left();
        for &(column, width) in &layout.columns {
            let cell = Rect::from_min_size(pos2(left, rect.top()), vec2(width, ROW_HEIGHT));
            left += width;
            paint_cell(ui, &sheet.columns[column], row, column, cell, is_selected);
        }
        response.widget_info(|| {
            let said = layout.columns.iter().map(|&(column, _)| {
                format!("{} {}", sheet.columns[column].name, row.cells[column].text)
            });
            let said = said.collect::<Vec<_>>().join(", ");
            WidgetInfo::selected(WidgetType::SelectableLabel, true, is_selected, said)
        });
        if let StepState::Failed(reason) = &row.state {
            response.clone().on_hover_text(reason);
        }
        if response.clicked() {
            self.selected = (!is_selected).then(|| step.id.clone());
        }
    }
}

/// The two lines of a column's name: the node, and what of it.
fn head(column: &SheetColumn) -> (&str, &str) {
    let (node, name) = column.name.split_once('.').unwrap_or(("", &column.name));
    (node, if column.title.is_empty() { name } else { &column.title })
}

fn about(column: &SheetColumn) -> String {
    let better = match column.better {
        Some(Better::Lower) => "\nLower is better; the best is bold.",
        Some(Better::Higher) => "\nHigher is better; the best is bold.",
        Some(Better::Neither) | None => "",
    };
    format!("{}\nClick to sort.{better}", column.name)
}

fn font_of(ui: &Ui) -> FontId {
    TextStyle::Body.resolve(ui.style())
}

fn paint_head(
    ui: &Ui,
    column: &SheetColumn,
    rect: Rect,
    sorted: Option<bool>,
    response: &Response,
) {
    let (node, name) = head(column);
    let arrow = match sorted {
        Some(true) => " \u{2b06}",
        Some(false) => " \u{2b07}",
        None => "",
    };
    let visuals = ui.visuals();
    let strong = match response.hovered() {
        true => visuals.hyperlink_color,
        false => visuals.strong_text_color(),
    };
    let painter = ui.painter().with_clip_rect(rect.intersect(ui.clip_rect()));
    let (align, x) = match column.is_number {
        true => (Align2::RIGHT_CENTER, rect.right() - PADDING),
        false => (Align2::LEFT_CENTER, rect.left() + PADDING),
    };
    let small = TextStyle::Small.resolve(ui.style());
    painter.text(pos2(x, rect.top() + 10.0), align, node, small, visuals.weak_text_color());
    let name = format!("{name}{arrow}");
    painter.text(pos2(x, rect.bottom() - 12.0), align, name, font_of(ui), strong);
}

fn paint_cell(
    ui: &Ui,
    column: &SheetColumn,
    row: &SheetRow,
    place: usize,
    rect: Rect,
    is_selected: bool,
) {
    let cell = &row.cells[place];
    let visuals = ui.visuals();
    let is_best = cell.number.is_some() && cell.number == column.best;
    let color = match &row.state {
        _ if is_selected => visuals.selection.stroke.color,
        StepState::Failed(_) => visuals.error_fg_color,
        StepState::ToDo => visuals.weak_text_color(),
        StepState::Running => visuals.hyperlink_color,
        StepState::Done if is_best => visuals.strong_text_color(),
        StepState::Done => visuals.text_color(),
    };
    let painter = ui.painter().with_clip_rect(rect.intersect(ui.clip_rect()));
    let (align, x) = match column.is_number {
        true => (Align2::RIGHT_CENTER, rect.right() - PADDING),
        false => (Align2::LEFT_CENTER, rect.left() + PADDING),
    };
    let at = pos2(x, rect.center().y);
    painter.text(at, align, &cell.text, font_of(ui), color);
    if is_best {
        // There is no bold face: the text is drawn once more, half a point aside.
        painter.text(at + Vec2::new(0.5, 0.0), align, &cell.text, font_of(ui), color);
    }
}
