//! The table on the screen: what is chosen above it, its rows, and what a hand does with them.

use std::sync::Arc;

use eframe::egui::{self, Event, Key, Rect, Sense, pos2, vec2};
use mve_modules::data::Domain;

use super::columns::SheetColumn;
use super::filter::Filter;
use super::row::{Form, Row, forms_of, show_row};
use super::rows::{Rows, Sheet};
use super::scroll::RowScroll;
use super::source::{SheetMaker, Source};
use crate::views::background::{Progress, Task};
use crate::views::make_room;
use crate::views::memo::{Memo, Same};
use crate::views::number::count_text;
use crate::views::picked::many_of;
use crate::views::table::{Head, Sort, SortOrder, header};
use crate::views::{PickedElement, Pinned};

/// What the user wants of the picture beside the table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SheetAction {
    /// To look at an element.
    Pick(PickedElement),
    /// To have the picked element in sight.
    BringIntoSight,
}

/// What rows are chosen and put in order for.
#[derive(Clone, PartialEq)]
struct RowsKey {
    sheet: Same<Sheet>,
    filter: String,
    sort: Sort,
}

/// An element, and the rows among which it was shown.
#[derive(PartialEq)]
struct Shown {
    element: PickedElement,
    /// Of this value and this kind.
    rows_of: (String, Domain),
    /// In this order; `None` is that of the elements.
    order: Option<Same<Vec<u32>>>,
}

/// The state of the table.
pub struct SheetView {
    /// The value that was chosen; the first one where it is not there.
    title: String,
    domain: Domain,
    maker: SheetMaker,
    filter: String,
    /// The column that rows are sorted by, by name, as another mesh may have others.
    sort: Option<(String, SortOrder)>,
    rows: Memo<RowsKey, Vec<u32>>,
    forms: Option<(Same<Sheet>, Arc<[Form]>)>,
    scroll: RowScroll,
    /// The places of the first and the last row that were chosen, in the order that is shown.
    chosen: Option<[usize; 2]>,
    /// What the table was scrolled for.
    shown: Option<Shown>,
    copying: Option<Task<String>>,
}

impl Default for SheetView {
    fn default() -> Self {
        Self {
            title: String::new(),
            domain: Domain::Face,
            maker: SheetMaker::default(),
            filter: String::new(),
            sort: None,
            rows: Memo::default(),
            forms: None,
            scroll: RowScroll::default(),
            chosen: None,
            shown: None,
            copying: None,
        }
    }
}

/// What a filter may look like, over a column that is there: the first number but that of the row.
fn hint_of(columns: &[SheetColumn]) -> String {
    let numbers = columns.iter().skip(1).filter(|column| column.is_numeric());
    let column = numbers.chain(columns).next();
    let name = column.map_or("", |column| column.name.as_str());
    if name.is_empty() { String::new() } else { format!("filter, such as {name} > 0.5") }
}

impl SheetView {
    /// Shows the elements of one of the pinned values in the space that there is, whatever it
    /// takes: a panel keeps the size that it was given.
    pub fn show(
        &mut self,
        ui: &mut egui::Ui,
        pinned: &[Pinned],
        picked: Option<&PickedElement>,
    ) -> Vec<SheetAction> {
        let actions = self.controls_and_table(ui, pinned, picked);
        let rest = ui.available_rect_before_wrap();
        ui.allocate_rect(rest.intersect(ui.max_rect()), Sense::hover());
        self.copy_when_done(ui);
        actions
    }

    fn controls_and_table(
        &mut self,
        ui: &mut egui::Ui,
        pinned: &[Pinned],
        picked: Option<&PickedElement>,
    ) -> Vec<SheetAction> {
        let sources = Source::all(pinned);
        // What is picked in a picture is what is looked at.
        let shown = self.shown.as_ref().map(|shown| &shown.element);
        if let Some(picked) = picked.filter(|picked| shown != Some(picked)) {
            self.title.clone_from(&picked.title);
            // A corner stands for its face.
            if (self.domain, picked.domain) != (Domain::Corner, Domain::Face) {
                self.domain = picked.domain;
            }
        }
        let source = sources.iter().find(|source| source.title() == self.title);
        let Some(source) = source.or(sources.first()) else {
            ui.weak(
                "Nothing with elements is shown. Click an output that gives a mesh or a field.",
            );
            return Vec::new();
        };
        let domains = source.domains();
        if domains.iter().all(|(domain, _)| *domain != self.domain) {
            self.domain = domains[0].0;
        }
        let sheet = self.maker.sheet(ui.ctx(), source, self.domain);
        let filter = match self.filter.trim().is_empty() {
            true => Ok(None),
            false => Filter::compile(&self.filter, &sheet.columns).map(Some),
        };
        let fault = filter.as_ref().err().cloned();
        let rows = self.rows(ui, &sheet, filter.unwrap_or_default());
        let mut actions = Vec::new();
        let before = self.domain;
        ui.horizontal_wrapped(|ui| {
            self.choices(ui, &sources, &sheet, &domains);
            self.filter_field(ui, &sheet, fault.as_deref());
            self.buttons(ui, &sheet, &rows, picked, &mut actions);
            self.say_counts(ui, &sheet, &rows, fault);
        });
        if before != self.domain {
            // The same place as another kind of element.
            self.chosen = None;
            let seen = picked.zip(sheet.mesh.as_ref());
            let seen = seen.and_then(|(picked, mesh)| picked.seen_as(self.domain, mesh));
            actions.extend(seen.map(SheetAction::Pick));
            ui.ctx().request_repaint();
            return actions;
        }
        self.follow(&sheet, &rows, picked);
        actions.extend(self.table(ui, &sheet, &rows, picked));
        actions
    }

    /// Whether rows or columns are in the making.
    pub fn is_busy(&self) -> bool {
        self.rows.is_busy() || self.maker.is_busy() || self.copying.is_some()
    }

    /// The order that holds in a table: none where it lacks the column.
    fn sort_in(&self, sheet: &Sheet) -> Sort {
        self.sort.as_ref().and_then(|(name, by)| Some((sheet.place_of(name)?, *by)))
    }

    /// The rows that are shown: of the last filter and order that are done, for this table.
    fn rows(&mut self, ui: &egui::Ui, sheet: &Arc<Sheet>, filter: Option<Filter>) -> Rows {
        let sort = self.sort_in(sheet);
        let all = Rows { n: sheet.n_elements, found: None };
        if filter.is_none() && sort.is_none() {
            // Nobody waits for rows that are being looked for.
            self.rows = Memo::default();
            return all;
        }
        let text = if filter.is_some() { self.filter.clone() } else { String::new() };
        let key = RowsKey { sheet: Same(Arc::clone(sheet)), filter: text, sort };
        let job = Arc::clone(sheet);
        self.rows.want(ui.ctx(), key, move || job.rows(filter.as_ref(), sort));
        match self.rows.latest_with_key() {
            Some((key, found)) if Arc::ptr_eq(&key.sheet.0, sheet) => {
                Rows { n: found.len(), found: Some(Arc::clone(found)) }
            }
            _ => all,
        }
    }

    fn choices(
        &mut self,
        ui: &mut egui::Ui,
        sources: &[Source],
        sheet: &Sheet,
        domains: &[(Domain, usize)],
    ) {
        ui.label("Table of");
        let shown = egui::ComboBox::from_id_salt("table of").selected_text(&sheet.title);
        let shown = shown.show_ui(ui, |ui| {
            for source in sources {
                let is_it = source.title() == sheet.title;
                if ui.selectable_label(is_it, source.title()).clicked() {
                    self.title = source.title().to_owned();
                }
            }
        });
        let name = format!("table of {}", sheet.title);
        shown
            .response
            .widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::ComboBox, true, &name));
        for &(domain, n) in domains {
            let label = format!("{} {}", count_text(n), many_of(domain));
            ui.selectable_value(&mut self.domain, domain, label)
                .on_hover_text(format!("A row for each of the {}", many_of(domain)));
        }
    }

    fn filter_field(&mut self, ui: &mut egui::Ui, sheet: &Sheet, fault: Option<&str>) {
        make_room(ui, 280.0);
        ui.label("Filter");
        let field = egui::TextEdit::singleline(&mut self.filter)
            .hint_text(egui::RichText::new(hint_of(&sheet.columns)).weak().italics())
            .desired_width(220.0);
        let field = match fault {
            Some(_) => field.text_color(ui.visuals().error_fg_color),
            None => field,
        };
        let field = ui.add(field).on_hover_text(
            "Shows the rows for which this holds: a formula over the names of the columns, texts \
             in quotation marks, joined by and and or",
        );
        ui.ctx().accesskit_node_builder(field.id, |node| node.set_label("filter the rows"));
    }

    fn buttons(
        &mut self,
        ui: &mut egui::Ui,
        sheet: &Arc<Sheet>,
        rows: &Rows,
        picked: Option<&PickedElement>,
        actions: &mut Vec<SheetAction>,
    ) {
        let n = self.chosen.map_or(rows.n, |[first, last]| first.abs_diff(last) + 1);
        let label = if self.chosen.is_some() { "Copy rows" } else { "Copy all" };
        let copy = ui.add_enabled(self.copying.is_none() && n > 0, egui::Button::new(label));
        let tip = format!("Copy {} as tab-separated text (Ctrl+C)", counted_rows(n));
        if copy.on_hover_text(tip).clicked() {
            self.copy(ui, sheet, rows);
        }
        let is_there = picked.is_some_and(|picked| picked.title == sheet.title);
        let sight = egui::Button::new("Show in view");
        let sight = ui.add_enabled(is_there && sheet.mesh.is_some(), sight);
        let tip = "Moves the camera to the picked element (double click a row)";
        if sight.on_hover_text(tip).clicked() {
            actions.push(SheetAction::BringIntoSight);
        }
    }

    fn say_counts(&self, ui: &mut egui::Ui, sheet: &Sheet, rows: &Rows, fault: Option<String>) {
        if let Some(fault) = fault {
            ui.colored_label(ui.visuals().error_fg_color, format!("Filter: {fault}"));
        } else if self.rows.is_busy() {
            ui.spinner();
            ui.weak(format!("looking through {}…", counted_rows(sheet.n_elements)));
        } else if self.rows.is_lost() {
            ui.colored_label(ui.visuals().error_fg_color, "The rows could not be put in order.");
        } else if rows.n != sheet.n_elements {
            let all = count_text(sheet.n_elements);
            ui.weak(format!("{} of {all} {}", count_text(rows.n), many_of(sheet.domain)));
        }
    }

    /// Scrolls to what was picked elsewhere, and again when rows have another order.
    fn follow(&mut self, sheet: &Sheet, rows: &Rows, picked: Option<&PickedElement>) {
        // A table that has become shorter has no such rows.
        self.chosen = self.chosen.filter(|chosen| chosen.iter().all(|place| *place < rows.n));
        let Some(picked) = picked else {
            if self.shown.take().is_some() {
                self.chosen = None;
            }
            return;
        };
        let rows_of = (sheet.title.clone(), sheet.domain);
        let order = rows.found.clone().map(Same);
        let now = Some(Shown { element: picked.clone(), rows_of, order });
        if self.shown == now {
            return;
        }
        self.shown = now;
        let place = sheet.row_of(picked).and_then(|element| rows.place(element));
        self.chosen = place.map(|place| [place, place]);
        if let Some(place) = place {
            self.scroll.center(place);
        }
    }

    fn table(
        &mut self,
        ui: &mut egui::Ui,
        sheet: &Arc<Sheet>,
        rows: &Rows,
        picked: Option<&PickedElement>,
    ) -> Vec<SheetAction> {
        let forms = self.forms(sheet);
        let whole = ui.available_rect_before_wrap();
        let inner = RowScroll::space_of_rows(whole);
        let mut actions = Vec::new();
        let mut child = ui.new_child(egui::UiBuilder::new().max_rect(inner).id_salt("columns"));
        child.set_clip_rect(inner.intersect(ui.clip_rect()));
        let area = egui::ScrollArea::horizontal().id_salt("sheet columns").auto_shrink(false);
        area.show(&mut child, |ui| {
            self.head(ui, sheet, &forms);
            let space = ui.available_rect_before_wrap();
            // The bar stays beside the rows however far columns are scrolled.
            let bar_and_rows = Rect::from_min_max(pos2(whole.left(), space.top()), whole.max);
            let row_height = ui.text_style_height(&egui::TextStyle::Body) + 4.0;
            let mut bar = ui.new_child(egui::UiBuilder::new().max_rect(bar_and_rows));
            bar.set_clip_rect(whole);
            let (seen, above) = self.scroll.show(&bar, bar_and_rows, (rows.n, row_height));
            let width = forms.iter().map(|form| form.width + ui.spacing().item_spacing.x).sum();
            let size = vec2(width, space.height().max(0.0));
            let (space, response) = ui.allocate_exact_size(size, Sense::click());
            let mut rows_ui = ui.new_child(egui::UiBuilder::new().max_rect(space));
            let clip = Rect::from_min_max(pos2(inner.left(), space.top()), inner.max);
            rows_ui.set_clip_rect(clip.intersect(ui.clip_rect()));
            actions.extend(self.keys(ui, &response, sheet, rows));
            for (nth, place) in seen.enumerate() {
                let top = space.top() - above + nth as f32 * row_height;
                let min = pos2(space.left(), top);
                let rect = Rect::from_min_size(min, vec2(size.x.max(clip.width()), row_height));
                let row = Row { place, element: rows.element(place), rect };
                let element = self.row(&rows_ui, sheet, &forms, &row, &response);
                actions.extend(element);
            }
        });
        // A click on a row that is picked already changes nothing.
        actions.retain(|action| match action {
            SheetAction::Pick(element) => picked != Some(element),
            SheetAction::BringIntoSight => true,
        });
        actions
    }

    fn head(&mut self, ui: &mut egui::Ui, sheet: &Sheet, forms: &[Form]) {
        let heads = sheet.columns.iter().zip(forms).map(|(column, form)| Head {
            name: &column.name,
            title: column.title(),
            doc: &column.doc,
            width: form.width,
        });
        let known = self.sort_in(sheet);
        let mut sort = known;
        header(ui, heads, &mut sort);
        if sort != known {
            self.sort = sort.map(|(at, by)| (sheet.columns[at].name.clone(), by));
        }
    }

    /// Width and format of each column.
    fn forms(&mut self, sheet: &Arc<Sheet>) -> Arc<[Form]> {
        let key = Same(Arc::clone(sheet));
        if let Some((_, forms)) = self.forms.as_ref().filter(|(known, _)| *known == key) {
            return Arc::clone(forms);
        }
        let forms = forms_of(sheet);
        self.forms = Some((key, Arc::clone(&forms)));
        forms
    }

    /// Shows a row, and answers a click on it.
    fn row(
        &mut self,
        ui: &egui::Ui,
        sheet: &Sheet,
        forms: &[Form],
        row: &Row,
        table: &egui::Response,
    ) -> Vec<SheetAction> {
        let chosen = self.chosen.map(|[a, b]| a.min(b)..=a.max(b));
        let is_chosen = chosen.is_some_and(|chosen| chosen.contains(&row.place));
        let response = show_row(ui, sheet, forms, row, is_chosen);
        if !response.clicked() && !response.double_clicked() {
            return Vec::new();
        }
        table.request_focus();
        let has_shift = ui.input(|input| input.modifiers.shift);
        match &mut self.chosen {
            Some([_, last]) if has_shift => {
                *last = row.place;
                return Vec::new();
            }
            chosen => *chosen = Some([row.place; 2]),
        }
        let mut actions = vec![self.pick(sheet, row.element)];
        if response.double_clicked() {
            actions.push(SheetAction::BringIntoSight);
        }
        actions
    }

    /// Picks a row that is in sight already.
    fn pick(&mut self, sheet: &Sheet, element: usize) -> SheetAction {
        let element = sheet.element(element);
        if let Some(shown) = &mut self.shown {
            shown.element.clone_from(&element);
        }
        SheetAction::Pick(element)
    }

    /// Moves the choice by keys, and copies it, while the table has the focus.
    fn keys(
        &mut self,
        ui: &egui::Ui,
        table: &egui::Response,
        sheet: &Arc<Sheet>,
        rows: &Rows,
    ) -> Option<SheetAction> {
        table.widget_info(|| {
            egui::WidgetInfo::labeled(egui::WidgetType::Other, true, "rows of the table")
        });
        if table.clicked() {
            table.request_focus();
        }
        if !table.has_focus() || rows.n == 0 {
            return None;
        }
        let filter = egui::EventFilter { vertical_arrows: true, ..egui::EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(table.id, filter));
        let is_copied = ui.input_mut(|input| {
            let n_before = input.events.len();
            input.events.retain(|event| *event != Event::Copy);
            input.events.len() < n_before
        });
        if is_copied {
            self.copy(ui, sheet, rows);
        }
        let (page, end) = (self.scroll.page() as isize, isize::MAX);
        let moves = [
            (Key::ArrowUp, -1),
            (Key::ArrowDown, 1),
            (Key::PageUp, -page),
            (Key::PageDown, page),
            (Key::Home, -end),
            (Key::End, end),
        ];
        let pressed = |key| {
            ui.input_mut(|input| {
                input.consume_key(egui::Modifiers::NONE, key)
                    || input.consume_key(egui::Modifiers::SHIFT, key)
            })
        };
        let has_shift = ui.input(|input| input.modifiers.shift);
        let (_, by) = moves.into_iter().find(|(key, _)| pressed(*key))?;
        let [first, last] = self.chosen.unwrap_or([0, 0]);
        let last = last.saturating_add_signed(by).min(rows.n - 1);
        self.chosen = Some([if has_shift { first } else { last }, last]);
        self.scroll.reveal(last);
        (!has_shift).then(|| self.pick(sheet, rows.element(last)))
    }

    /// Begins to write the chosen rows, or all, as text.
    fn copy(&mut self, ui: &egui::Ui, sheet: &Arc<Sheet>, rows: &Rows) {
        let chosen = self.chosen.map_or(0..rows.n, |[a, b]| a.min(b)..a.max(b) + 1);
        let (sheet, rows) = (Arc::clone(sheet), rows.clone());
        self.copying = Some(Task::spawn(ui.ctx(), move || {
            sheet.to_tsv(chosen.map(|place| rows.element(place)))
        }));
    }

    fn copy_when_done(&mut self, ui: &egui::Ui) {
        match self.copying.as_ref().map(Task::poll) {
            Some(Progress::Done(text)) => {
                ui.ctx().copy_text(text);
                self.copying = None;
            }
            Some(Progress::Lost) => self.copying = None,
            Some(Progress::Running) | None => {}
        }
    }
}

fn counted_rows(n: usize) -> String {
    format!("{} {}", count_text(n), if n == 1 { "row" } else { "rows" })
}

#[cfg(test)]
#[path = "view_tests.rs"]
mod tests;
