//! The tables of the page: one a measure with the best of each row marked, and all steps.

use std::fmt::Write;

use mve_core::Better;

use super::{Page, address, count, cut, escape};
use crate::columns;
use crate::pivot::Pivot;
use crate::results::Cell;

/// Rows of the long table, and of a table of one measure; the page stays quick to open.
const MOST_STEPS: usize = 2000;
const MOST_ROWS: usize = 300;

/// Columns of the long table behind the parameters.
const MOST_COLUMNS: usize = 24;

/// Tables of the measures.
pub(super) fn pivots(page: &Page) -> String {
    let mut text = String::new();
    let missing = page.measures.iter().filter(|measure| !measure.is_there);
    let missing: Vec<_> = missing.map(|measure| escape(&measure.column)).collect();
    if !missing.is_empty() {
        let _ = writeln!(
            text,
            "<p class=\"note bad\">No step gave a number for {}.</p>",
            missing.join(", ")
        );
    }
    if page.tables.is_empty() {
        return text;
    }
    let has_repeats = page.results.cases.iter().any(|case| case.steps.len() > 1);
    if has_repeats {
        text.push_str(
            "<p class=\"note\">Means over the repeats, ± half of the 95 % confidence interval \
             (Student’s t).</p>\n",
        );
    }
    if page.results.has_rounding() {
        text.push_str(
            "<p class=\"note\">Values of a measure below 10⁻¹² of its largest are rounding and \
             count as 0.</p>\n",
        );
    }
    text.push_str("<div class=\"tables\">\n");
    for table in page.tables {
        text.push_str(&pivot(table));
    }
    text.push_str("</div>\n");
    text
}

fn pivot(table: &Pivot) -> String {
    let better = match table.better {
        None => "",
        Some(Better::Lower) => " <span>lower is better</span>",
        Some(Better::Higher) => " <span>higher is better</span>",
    };
    let mut text = format!(
        "<div class=\"scroll\"><table>\n<caption>{}{better}</caption>\n<thead><tr>\
         <th class=\"text\">{}</th>",
        escape(&table.title),
        escape(&table.corner)
    );
    for name in &table.columns {
        let _ = write!(text, "<th>{}</th>", escape(name));
    }
    text.push_str("</tr></thead>\n<tbody>\n");
    let rows = table.shown_rows();
    let n_own = table.rows.len();
    for (place, row) in rows.iter().enumerate() {
        if place >= MOST_ROWS && place < n_own {
            continue;
        }
        let class = if place >= n_own { " class=\"sum\"" } else { "" };
        let _ = write!(text, "<tr{class}><th>{}</th>", escape(&row.label));
        for (cell, is_best) in row.cells.iter().zip(&row.is_best) {
            let class = if *is_best { " class=\"best\"" } else { "" };
            let _ = write!(text, "<td{class}>{}</td>", escape(cell));
        }
        text.push_str("</tr>\n");
    }
    text.push_str("</tbody></table>");
    if n_own > MOST_ROWS {
        let n = n_own - MOST_ROWS;
        let _ = write!(text, "<p class=\"note\">{} not shown here.</p>", count(n, "more row"));
    }
    text.push_str("</div>\n");
    text
}

/// The table of all cases, to sort.
pub(super) fn steps(page: &Page) -> String {
    let results = page.results;
    if results.cases.is_empty() {
        return String::new();
    }
    let mut columns = columns::long_columns(results, page.measures);
    let n_hidden = columns.len().saturating_sub(MOST_COLUMNS);
    columns.truncate(MOST_COLUMNS);
    let varied = results.varied();
    let mut text = String::new();
    if !results.is_timed() {
        text.push_str(
            "<p class=\"note\">Seconds were measured while other steps ran or shared their work; \
             run the program with <code>--timing</code> to compare them.</p>\n",
        );
    }
    text.push_str("<div class=\"scroll\"><table class=\"sortable\">\n<thead><tr>");
    for path in &varied {
        let _ = write!(text, "<th class=\"text\">{}</th>", escape(path));
    }
    for column in &columns {
        let title = columns::title(page.measures, column);
        let _ = write!(text, "<th title=\"{}\">{}</th>", escape(column), escape(&title));
    }
    text.push_str("<th class=\"text\">status</th><th class=\"text\">step</th></tr></thead>\n");
    text.push_str("<tbody>\n");
    for case in results.cases.iter().take(MOST_STEPS) {
        text.push_str("<tr>");
        for path in &varied {
            let label = case.params.get(path).map(crate::labels::of_value).unwrap_or_default();
            let full = case.params.get(path).map(|value| cut(&value.to_string(), 400));
            let full = escape(&full.unwrap_or_default());
            let label = escape(&label);
            let _ = write!(text, "<td class=\"text\" title=\"{full}\">{label}</td>");
        }
        for column in &columns {
            text.push_str(&number_cell(&case.cell(column)));
        }
        let _ = write!(text, "<td class=\"text\">{}</td><td class=\"text id\">", case.status());
        for step in &case.steps {
            let id = escape(&cut(&step.id, 8)).replace(" …", "");
            match step.record {
                None => text.push_str(&id),
                Some(_) => {
                    let path = format!("steps/{}/record.json", step.id);
                    let _ = write!(text, "<a href=\"{}\">{id}</a> ", address(page.store, &path));
                }
            }
        }
        text.push_str("</td></tr>\n");
    }
    text.push_str("</tbody></table></div>\n");
    let n_rows = results.cases.len().saturating_sub(MOST_STEPS);
    let hidden = [(n_rows, "more row"), (n_hidden, "more column")];
    for (n, what) in hidden.iter().filter(|(n, _)| *n > 0) {
        let (file, n) = (address(page.store, "results.csv"), count(*n, what));
        let _ = writeln!(text, "<p class=\"note\">{n} in <a href=\"{file}\">results.csv</a>.</p>");
    }
    text
}

fn number_cell(cell: &Cell) -> String {
    let shown = escape(&cut(&cell.shown(), 80));
    match cell {
        Cell::Number(estimate) => format!("<td data-v=\"{}\">{shown}</td>", estimate.mean),
        _ => format!("<td>{shown}</td>"),
    }
}
