//! The tables as text: CSV to compute with, and Markdown.

use std::fmt::Write;

use mve_core::{Better, csv_table, exact, is_steering};

use crate::answers::Answer;
use crate::case::{Case, Cell};
use crate::columns::{MeasureColumn, long_columns};
use crate::labels;
use crate::pivot::{Pivot, PivotCell};
use crate::rating::{COLUMN, People, TextTable};
use crate::results::Results;
use crate::stats::estimate;

/// Every case with the columns of the long table, all digits, rounding included, as a
/// [`csv_table`]. A step that is missing says so in the column `status`; what people said stands
/// behind the measures.
pub fn csv(results: &Results, measures: &[MeasureColumn], people: Option<&People>) -> String {
    let columns = long_columns(results, measures);
    let has_repeats = results.cases.iter().any(|case| case.steps.len() > 1);
    let has_interval = |column: &String| {
        let of = |case: &Case| estimate(&case.exact_numbers(column))?.half_width;
        results.cases.iter().filter_map(of).any(|half| half > 0.0)
    };
    let intervals: Vec<bool> = columns.iter().map(has_interval).collect();
    let varied = results.varied();
    let mut header = varied.clone();
    if has_repeats {
        header.extend(["repeats", "done"].map(str::to_owned));
    }
    for (column, has_interval) in columns.iter().zip(&intervals) {
        header.push(column.clone());
        header.extend(has_interval.then(|| format!("{column}.half_width_95")));
    }
    if people.is_some() {
        header.extend([
            COLUMN.to_owned(),
            format!("{COLUMN}.low_95"),
            format!("{COLUMN}.high_95"),
            "people.n".to_owned(),
        ]);
    }
    header.extend(["missed", "warnings", "status"].map(str::to_owned));
    let row_of = |(place, case): (usize, &Case)| {
        let param = |path: &String| case.params.get(path).map(labels::word).unwrap_or_default();
        let mut row: Vec<String> = varied.iter().map(param).collect();
        if has_repeats {
            row.extend([case.steps.len(), case.n_done()].map(|n| n.to_string()));
        }
        for (column, has_interval) in columns.iter().zip(&intervals) {
            let (value, half) = match (estimate(&case.exact_numbers(column)), case.cell(column)) {
                (Some(found), _) => (exact(found.mean), found.half_width),
                (None, Cell::Text(text)) => (text, None),
                (None, _) => (String::new(), None),
            };
            row.push(value);
            row.extend(has_interval.then(|| half.map_or(String::new(), exact)));
        }
        if let Some(people) = people {
            let mark = people.mark(place);
            let span = mark.as_ref().and_then(People::span);
            let [low, high] = [span.map(|(low, _)| low), span.map(|(_, high)| high)];
            let numbers = [mark.map(|mark| mark.mean), low, high];
            row.extend(numbers.map(|number| number.map_or_else(String::new, exact)));
            row.push(mark.map_or(0, |mark| mark.n).to_string());
        }
        row.push(case.missed().unwrap_or_default());
        row.push(case.warnings().len().to_string());
        row.push(case.status().to_owned());
        row
    };
    let rows: Vec<Vec<String>> = results.cases.iter().enumerate().map(row_of).collect();
    csv_table(&header, &rows)
}

/// The answers and a table a measure. `notes` stand at the top.
pub fn markdown(title: &str, notes: &[String], answers: &[Answer], tables: &[Pivot]) -> String {
    let mut text = format!("# {}\n", plain(title));
    for note in notes {
        let _ = write!(text, "\n{note}\n");
    }
    for answer in answers {
        let _ = write!(text, "\n**{}**\n\n{}\n", plain(&answer.text), {
            plain(&answer.sentences.join(" "))
        });
    }
    for table in tables {
        let _ = write!(text, "\n## {}\n\n", plain(&table.caption()));
        let names = |names: &[String]| {
            let names: Vec<String> = names.iter().map(|name| plain(name)).collect();
            if names.is_empty() { " ".to_owned() } else { names.join(" | ") }
        };
        let columns: Vec<String> =
            table.columns.iter().map(|names| plain(&names.join(" · "))).collect();
        let n_names = table.row_axes.len().max(1);
        let _ = writeln!(text, "| {} | {} |", names(&table.row_axes), columns.join(" | "));
        let _ = writeln!(text, "|{}{}", "---|".repeat(n_names), "---:|".repeat(columns.len()));
        let forms = table.forms();
        for row in table.with_means() {
            let mark = if row.is_unequal && table.better != Better::Neither { "‡" } else { "" };
            let shown = row.shown(&forms);
            let cells: Vec<String> = row.cells.iter().zip(&shown).map(in_markdown).collect();
            let _ = writeln!(text, "| {}{mark} | {} |", names(&row.names), cells.join(" | "));
        }
        for note in table.marks() {
            let _ = write!(text, "\n{note}\n");
        }
    }
    text
}

/// What people said: notes and tables.
pub fn people(people: &People, tables: &[TextTable]) -> String {
    let mut text = "\n## People\n".to_owned();
    for note in &people.notes {
        let _ = write!(text, "\n{}\n", plain(note));
    }
    for table in tables {
        let shown = |row: &[String]| row.iter().map(|cell| plain(cell)).collect::<Vec<_>>();
        let line = |place: usize| if place < table.n_names { ":--" } else { "--:" };
        let lines: Vec<&str> = (0..table.header.len()).map(line).collect();
        let _ = write!(text, "\n{}:\n\n", plain(&table.title));
        let _ = writeln!(text, "| {} |", shown(&table.header).join(" | "));
        let _ = writeln!(text, "| {} |", lines.join(" | "));
        for row in &table.rows {
            let _ = writeln!(text, "| {} |", shown(row).join(" | "));
        }
    }
    text
}

fn in_markdown((cell, shown): (&PivotCell, &String)) -> String {
    let shown = plain(shown);
    let mark = if cell.missed.is_some() { "†" } else { "" };
    if cell.is_best { format!("**{shown}**") } else { format!("{shown}{mark}") }
}

/// A text that Markdown takes for nothing but a text.
fn plain(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '|' | '*' | '_' | '`' | '\\' | '[' | ']' | '<' | '&' => out.extend(['\\', c]),
            c if is_steering(c) => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markdown_takes_no_text_for_markup() {
        assert_eq!(plain("p < 0.001 & <b> a_b\u{7}\u{202e}"), "p \\< 0.001 \\& \\<b> a\\_b  ");
    }
}
