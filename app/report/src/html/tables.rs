//! The tables of the page: one a measure with the best of each row marked, and all steps.

use std::fmt::Write;

use mve_core::Better;

use super::{Page, address, count, cut, escape};
use crate::case::{Case, Cell, NumberForm};
use crate::columns;
use crate::pivot::{Pivot, PivotCell, PivotRow};

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
    let columns: Vec<&str> = page.measures.iter().map(|m| m.column.as_str()).collect();
    if page.results.has_rounding(&columns) {
        text.push_str(
            "<p class=\"note\">Values of a measure below 10⁻¹² of its largest, of 1 where it has no \
             unit, or of the size of the model are rounding and count as 0.</p>\n",
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
        Better::Neither => "",
        Better::Lower => "<span>; lower is better</span>",
        Better::Higher => "<span>; higher is better</span>",
    };
    let caption = escape(&table.title);
    let by = match table.column_axes.join(", ") {
        axes if axes.is_empty() => axes,
        axes => format!(" <span>by {}</span>", escape(&axes)),
    };
    let mut text = format!(
        "<div class=\"scroll\"><table>\n<caption>{caption}{by}{better}</caption>\n<thead>{}</thead>\n\
         <tbody>\n",
        head(table)
    );
    let (rows, forms) = (table.with_means(), table.forms());
    let n_own = table.rows.len();
    let n_shown = n_own.min(MOST_ROWS);
    let own = rows[..n_shown].iter().enumerate();
    for (place, row) in own {
        let mark = if row.is_unequal && table.better != Better::Neither { "‡" } else { "" };
        let _ = write!(text, "<tr>{}", names(&rows[..n_shown], place, mark));
        text.push_str(&cells(row, &forms));
    }
    for row in &rows[n_own..] {
        let span = table.row_axes.len().max(1);
        let name = escape(row.names.first().map_or("", String::as_str));
        let _ = write!(text, "<tr class=\"sum\"><th class=\"h0\" colspan=\"{span}\">{name}</th>");
        text.push_str(&cells(row, &forms));
    }
    text.push_str("</tbody></table>");
    for mark in table.marks() {
        let _ = write!(text, "<p class=\"note\">{}</p>", escape(&mark));
    }
    if n_own > MOST_ROWS {
        let n = n_own - MOST_ROWS;
        let _ = write!(text, "<p class=\"note\">{} not shown here.</p>", count(n, "more row"));
    }
    text.push_str("</div>\n");
    text
}

/// A line for each axis of the columns, with equal neighbors merged; the last one names the rows.
fn head(table: &Pivot) -> String {
    let n_lines = table.columns.first().map_or(1, Vec::len).max(1);
    let n_names = table.row_axes.len().max(1);
    let mut text = String::new();
    for line in 0..n_lines {
        text.push_str("<tr>");
        for place in (0..n_names).filter(|_| line == 0) {
            let name = escape(table.row_axes.get(place).map_or("", String::as_str));
            let _ = write!(text, "<th class=\"text h{place}\" rowspan=\"{n_lines}\">{name}</th>");
        }
        let mut place = 0;
        while place < table.columns.len() {
            let own = &table.columns[place];
            let is_last = line + 1 == n_lines;
            let same = |other: &&Vec<String>| !is_last && other[..=line] == own[..=line];
            let n = table.columns[place..].iter().take_while(same).count().max(1);
            let name = own.get(line).map_or(String::new(), |name| escape(name));
            let class = if is_last { "" } else { " class=\"over\"" };
            let _ = write!(text, "<th{class} colspan=\"{n}\">{name}</th>");
            place += n;
        }
        text.push_str("</tr>");
    }
    text
}

/// The names of a row; those that the rows below it share reach over them.
fn names(rows: &[PivotRow], place: usize, mark: &str) -> String {
    let row = &rows[place];
    let n_names = row.names.len();
    let mut text = String::new();
    for (depth, name) in row.names.iter().enumerate() {
        let own = &row.names[..=depth];
        let is_last = depth + 1 == n_names;
        let same = |other: &&PivotRow| !is_last && other.names[..=depth] == *own;
        if place > 0 && same(&&rows[place - 1]) {
            continue;
        }
        let n = rows[place..].iter().take_while(same).count().max(1);
        let mark = if is_last { mark } else { "" };
        let _ = write!(text, "<th class=\"h{depth}\" rowspan=\"{n}\">{}{mark}</th>", escape(name));
    }
    if n_names == 0 {
        let _ = write!(text, "<th class=\"h0\">{mark}</th>");
    }
    text
}

fn cells(row: &PivotRow, forms: &[NumberForm]) -> String {
    let cell = |(cell, shown): (&PivotCell, &String)| {
        let shown = escape(shown);
        match &cell.missed {
            Some(missed) => format!("<td title=\"{}\">{shown}†</td>", escape(missed)),
            None if cell.is_best => format!("<td class=\"best\">{shown}</td>"),
            None => format!("<td>{shown}</td>"),
        }
    };
    row.cells.iter().zip(&row.shown(forms)).map(cell).collect::<String>() + "</tr>\n"
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
    let mut text = String::new();
    if !results.is_timed() {
        text.push_str(
            "<p class=\"note\">Seconds were measured while other steps ran or shared their work; \
             run the program with <code>--timing</code> to compare them.</p>\n",
        );
    }
    let form = |column: &String| {
        let cells: Vec<Cell> =
            results.cases.iter().take(MOST_STEPS).map(|case| case.cell(column)).collect();
        NumberForm::of(cells.iter())
    };
    let shown = ShownColumns {
        forms: columns.iter().map(form).collect(),
        varied: results.varied(),
        columns,
        has_missed: results.cases.iter().any(|case| case.missed().is_some()),
        has_warnings: results.cases.iter().any(|case| !case.warnings().is_empty()),
    };
    text.push_str("<div class=\"scroll\"><table class=\"sortable\">\n<thead><tr>");
    text.push_str(&shown.head(page));
    text.push_str("</tr></thead>\n<tbody>\n");
    for case in results.cases.iter().take(MOST_STEPS) {
        text.push_str(&shown.row(page, case));
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

/// The columns of the table of all cases.
struct ShownColumns {
    varied: Vec<String>,
    columns: Vec<String>,
    forms: Vec<NumberForm>,
    has_missed: bool,
    has_warnings: bool,
}

impl ShownColumns {
    fn head(&self, page: &Page) -> String {
        let mut text = String::new();
        for (place, path) in self.varied.iter().enumerate() {
            let _ = write!(text, "<th class=\"text h{place}\">{}</th>", escape(path));
        }
        let title = |column: &String| columns::title(page.results, page.measures, column);
        let titles: Vec<String> = self.columns.iter().map(title).collect();
        for (column, title) in self.columns.iter().zip(&titles) {
            let title = match titles.iter().filter(|other| *other == title).count() {
                1 => escape(title),
                _ => escape(&format!("{title}, {column}")),
            };
            let _ = write!(text, "<th title=\"{}\">{title}</th>", escape(column));
        }
        if self.has_missed {
            text.push_str("<th class=\"text\">target missed</th>");
        }
        if self.has_warnings {
            text.push_str("<th>warnings</th>");
        }
        text.push_str("<th class=\"text\">status</th><th class=\"text\">step</th>");
        text
    }

    fn row(&self, page: &Page, case: &Case) -> String {
        let mut text = "<tr>".to_owned();
        for (place, path) in self.varied.iter().enumerate() {
            let label = case.params.get(path).map(crate::labels::of_value).unwrap_or_default();
            let full = case.params.get(path).map(|value| cut(&value.to_string(), 400));
            let full = escape(&full.unwrap_or_default());
            let label = escape(&label);
            let _ = write!(text, "<td class=\"text h{place}\" title=\"{full}\">{label}</td>");
        }
        for (column, form) in self.columns.iter().zip(&self.forms) {
            text.push_str(&number_cell(&case.cell(column), *form));
        }
        text.push_str(&self.troubles(case));
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
        text
    }

    /// What a case missed, and how much its steps warned of, where some case has such a cell.
    fn troubles(&self, case: &Case) -> String {
        let mut text = String::new();
        if self.has_missed {
            let missed = case.missed().map(|missed| format!("† {}", escape(&missed)));
            let _ = write!(text, "<td class=\"text\">{}</td>", missed.unwrap_or_default());
        }
        if self.has_warnings {
            let warnings = case.warnings();
            let n = warnings.len();
            let shown = if n == 0 { String::new() } else { n.to_string() };
            let about = escape(&cut(&warnings.join("\n"), 1000));
            let _ = write!(text, "<td data-v=\"{n}\" title=\"{about}\">{shown}</td>");
        }
        text
    }
}

fn number_cell(cell: &Cell, form: NumberForm) -> String {
    let shown = escape(&cut(&cell.shown(form), 80));
    match cell {
        Cell::Number(estimate) => format!("<td data-v=\"{}\">{shown}</td>", estimate.mean),
        _ => format!("<td>{shown}</td>"),
    }
}
