//! Scrolling over any number of rows, of which only those in sight are asked for.
//!
//! The place is a row and a part of it, as a number of 64 bits: the areas of egui count points in
//! 32 bits, in which the rows of a large mesh can no longer be told from each other.

use std::ops::Range;

use eframe::egui::{self, Rect, Sense, pos2};

/// Width of the bar in points.
const BAR: f32 = 12.0;
/// The least height of what is dragged.
const HANDLE: f32 = 24.0;

/// How far a table is scrolled.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RowScroll {
    /// The row at the top; a part of it may be above.
    top: f64,
    /// Rows in sight when it was shown last.
    n_seen: f64,
}

impl RowScroll {
    /// The space for rows within that for rows and bar.
    pub fn space_of_rows(whole: Rect) -> Rect {
        Rect::from_min_max(whole.min, pos2(whole.max.x - BAR, whole.max.y))
    }

    /// Takes in the wheel over a table and a hand at its bar, and paints the bar. Returns the rows
    /// in sight, and how far the first of them begins above the space, in points.
    pub fn show(
        &mut self,
        ui: &egui::Ui,
        whole: Rect,
        (n_rows, row_height): (usize, f32),
    ) -> (Range<usize>, f32) {
        self.n_seen = f64::from(whole.height() / row_height);
        let most = (n_rows as f64 - self.n_seen).max(0.0);
        if ui.rect_contains_pointer(whole) {
            let wheel = ui.input(|input| input.smooth_scroll_delta().y);
            self.top -= f64::from(wheel / row_height);
        }
        if most > 0.0 {
            self.bar(ui, Rect::from_min_max(pos2(whole.max.x - BAR, whole.min.y), whole.max), most);
        }
        self.top = self.top.clamp(0.0, most);
        let first = self.top.floor();
        let last = ((self.top + self.n_seen).ceil() as usize).min(n_rows);
        (first as usize..last, ((self.top - first) * f64::from(row_height)) as f32)
    }

    fn bar(&mut self, ui: &egui::Ui, rect: Rect, most: f64) {
        let id = ui.id().with("row bar");
        let response = ui.interact(rect, id, Sense::click_and_drag());
        let label = "scroll the rows";
        response.widget_info(|| {
            egui::WidgetInfo::slider(ui.is_enabled(), self.top.clamp(0.0, most), label)
        });
        let share = (self.n_seen / (most + self.n_seen)) as f32;
        let height = (rect.height() * share).max(HANDLE).min(rect.height());
        let free = f64::from(rect.height() - height).max(1e-3);
        if response.dragged() {
            self.top += f64::from(response.drag_delta().y) / free * most;
        } else if response.clicked()
            && let Some(at) = response.interact_pointer_pos()
        {
            // To the place that was pressed.
            self.top = f64::from(at.y - rect.top() - 0.5 * height) / free * most;
        }
        self.top = self.top.clamp(0.0, most);
        let y = rect.top() + (self.top / most * free) as f32;
        let handle = Rect::from_min_max(pos2(rect.left() + 3.0, y), pos2(rect.right(), y + height));
        let painter = ui.painter();
        painter.rect_filled(rect, 3.0, ui.visuals().extreme_bg_color);
        painter.rect_filled(handle, 3.0, ui.style().interact(&response).fg_stroke.color);
    }

    /// Scrolls no farther than needed for a row to be in sight.
    pub fn reveal(&mut self, row: usize) {
        let row = row as f64;
        if row < self.top {
            self.top = row;
        } else if row + 1.0 > self.top + self.n_seen {
            self.top = row + 1.0 - self.n_seen;
        }
    }

    /// Scrolls a row to the middle, unless it is in sight.
    pub fn center(&mut self, row: usize) {
        let row = row as f64;
        if row < self.top || row + 1.0 > self.top + self.n_seen {
            self.top = row + 0.5 - 0.5 * self.n_seen;
        }
    }

    /// Whole rows in sight, at least one.
    pub fn page(&self) -> usize {
        (self.n_seen.floor() as usize).max(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_scrolled_into_sight_and_no_farther() {
        let mut scroll = RowScroll { top: 10.0, n_seen: 5.5 };
        scroll.reveal(12);
        assert_eq!(scroll.top, 10.0);
        scroll.reveal(3);
        assert_eq!(scroll.top, 3.0);
        scroll.reveal(100_000_000);
        assert_eq!(scroll.top, 99_999_995.5);
        scroll.center(99_999_998);
        assert_eq!(scroll.top, 99_999_995.5);
        scroll.center(50);
        assert_eq!(scroll.top, 47.75);
        assert_eq!(scroll.page(), 5);
    }
}
