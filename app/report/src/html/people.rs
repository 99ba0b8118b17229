//! The section of what people said of the results.

use std::fmt::Write;

use super::{Page, escape, sections};
use crate::plots;
use crate::rating::tables;

/// Plots before these have smaller numbers.
const FIRST_PLOT: usize = 100_000;

/// Mean marks, agreement with measures, and a plot a measure.
pub(super) fn people(page: &Page) -> String {
    let Some(people) = page.people else { return String::new() };
    let mut text = String::new();
    for note in &people.notes {
        let _ = writeln!(text, "<p class=\"note\">{}</p>", escape(note));
    }
    for table in tables(people, page.results, page.measures) {
        let title = escape(&table.title);
        let _ = write!(text, "<p>{title}.</p>\n<div class=\"scroll\"><table>\n<thead><tr>");
        let class = |place: usize| if place < table.n_names { " class=\"text\"" } else { "" };
        for (place, name) in table.header.iter().enumerate() {
            let _ = write!(text, "<th{}>{}</th>", class(place), escape(name));
        }
        text.push_str("</tr></thead>\n<tbody>\n");
        for row in &table.rows {
            text.push_str("<tr>");
            for (place, cell) in row.iter().enumerate() {
                let _ = write!(text, "<td{}>{}</td>", class(place), escape(cell));
            }
            text.push_str("</tr>\n");
        }
        text.push_str("</tbody></table></div>\n");
    }
    let mut number = FIRST_PLOT;
    let figures = people.figures(page.results, page.measures);
    if let Some(first) = figures.first() {
        text.push_str(&sections::legend(first));
    }
    text.push_str("<div class=\"charts\">\n");
    for figure in &figures {
        for panel in plots::panels(figure, &mut number) {
            let _ = writeln!(text, "<div>{panel}</div>");
        }
    }
    text.push_str("</div>\n");
    text
}
