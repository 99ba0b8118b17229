//! The tables as text: CSV to compute with, Markdown and LaTeX for a paper.

use std::fmt::Write;

use mve_core::{Better, exact};

use crate::answers::Answer;
use crate::columns::{MeasureColumn, long_columns};
use crate::html::escape;
use crate::pivot::Pivot;
use crate::results::{Cell, Results};
use crate::stats::estimate;

/// Every case with the columns of the long table, all digits, rounding included; RFC 4180. A step
/// that is missing says so in the column `status`.
pub fn csv(results: &Results, measures: &[MeasureColumn]) -> String {
    let columns = long_columns(results, measures);
    let has_repeats = results.cases.iter().any(|case| case.steps.len() > 1);
    let varied = results.varied();
    let mut header = varied.clone();
    if has_repeats {
        header.extend(["repeats", "done"].map(str::to_owned));
    }
    for column in &columns {
        header.push(column.clone());
        header.extend(has_repeats.then(|| format!("{column} ±95%")));
    }
    header.push("status".to_owned());
    let mut writer = csv::Writer::from_writer(Vec::new());
    // Writing equally long rows to memory cannot fail.
    let _ = writer.write_record(&header);
    for case in &results.cases {
        let param = |path: &String| match case.params.get(path) {
            None => String::new(),
            Some(value) => value.as_str().map_or_else(|| value.to_string(), str::to_owned),
        };
        let mut row: Vec<String> = varied.iter().map(param).collect();
        if has_repeats {
            row.extend([case.steps.len(), case.n_done()].map(|n| n.to_string()));
        }
        for column in &columns {
            let (value, half) = match (estimate(&case.exact_numbers(column)), case.cell(column)) {
                (Some(found), _) => (exact(found.mean), found.half_width),
                (None, Cell::Text(text)) => (text, None),
                (None, _) => (String::new(), None),
            };
            row.push(value);
            row.extend(has_repeats.then(|| half.map_or(String::new(), exact)));
        }
        row.push(case.status().to_owned());
        let _ = writer.write_record(&row);
    }
    String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
}

/// What stands over a table: the measure and its direction.
pub fn caption(table: &Pivot) -> String {
    match table.better {
        None => table.title.clone(),
        Some(Better::Lower) => format!("{} (lower is better)", table.title),
        Some(Better::Higher) => format!("{} (higher is better)", table.title),
    }
}

/// The answers and a table a measure.
pub fn markdown(title: &str, missing: &str, answers: &[Answer], tables: &[Pivot]) -> String {
    let plain = |text: &str| {
        let mut out = String::with_capacity(text.len());
        for c in escape(text).chars() {
            match c {
                '|' | '*' | '_' | '`' | '\\' | '[' | ']' => out.extend(['\\', c]),
                c if c.is_control() => out.push(' '),
                c => out.push(c),
            }
        }
        out
    };
    let mut text = format!("# {}\n", plain(title));
    if !missing.is_empty() {
        let _ = write!(text, "\n{missing}\n");
    }
    for answer in answers {
        let _ = write!(text, "\n**{}**\n\n{}\n", plain(&answer.text), {
            plain(&answer.sentences.join(" "))
        });
    }
    for table in tables {
        let _ = write!(text, "\n## {}\n\n", plain(&caption(table)));
        let header: Vec<String> = table.columns.iter().map(|name| plain(name)).collect();
        let _ = writeln!(text, "| {} | {} |", plain(&table.corner), header.join(" | "));
        let _ = writeln!(text, "|---|{}", "---:|".repeat(header.len()));
        for row in table.shown_rows() {
            let cell = |(cell, best): (&String, &bool)| match best {
                true => format!("**{}**", plain(cell)),
                false => plain(cell),
            };
            let cells: Vec<String> = row.cells.iter().zip(&row.is_best).map(cell).collect();
            let _ = writeln!(text, "| {} | {} |", plain(&row.label), cells.join(" | "));
        }
    }
    text
}

/// A tabular a measure, for the package `booktabs`.
pub fn latex(title: &str, missing: &str, tables: &[Pivot]) -> String {
    let mut text = format!("% {}\n% Needs \\usepackage{{booktabs}}.\n", one_line(title));
    if !missing.is_empty() {
        let _ = writeln!(text, "% {missing}");
    }
    for table in tables {
        let _ = writeln!(text, "\n% {}", one_line(&caption(table)));
        let n_columns = table.columns.len();
        let _ = writeln!(text, "\\begin{{tabular}}{{l{}}}\n\\toprule", "r".repeat(n_columns));
        let header: Vec<String> = table.columns.iter().map(|name| in_latex(name)).collect();
        let _ = writeln!(text, "{} & {} \\\\", in_latex(&table.corner), header.join(" & "));
        let _ = writeln!(text, "\\midrule");
        for (place, row) in table.shown_rows().iter().enumerate() {
            if place == table.rows.len() {
                let _ = writeln!(text, "\\midrule");
            }
            let cell = |(cell, best): (&String, &bool)| match best {
                true => format!("\\textbf{{{}}}", in_latex(cell)),
                false => in_latex(cell),
            };
            let cells: Vec<String> = row.cells.iter().zip(&row.is_best).map(cell).collect();
            let _ = writeln!(text, "{} & {} \\\\", in_latex(&row.label), cells.join(" & "));
        }
        let _ = writeln!(text, "\\bottomrule\n\\end{{tabular}}");
    }
    text
}

fn one_line(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

/// A text as LaTeX shows it.
pub fn in_latex(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => out.extend(['\\', c]),
            '\\' => out.push_str("\\textbackslash{}"),
            '~' => out.push_str("\\textasciitilde{}"),
            '^' => out.push_str("\\textasciicircum{}"),
            '<' => out.push_str("\\textless{}"),
            '>' => out.push_str("\\textgreater{}"),
            '±' => out.push_str("$\\pm$"),
            '·' => out.push_str("$\\cdot$"),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn latex_takes_no_text_for_a_command() {
        assert_eq!(in_latex("50% of a_b & \\x{}"), "50\\% of a\\_b \\& \\textbackslash{}x\\{\\}");
        assert_eq!(in_latex("1 ± 0.2 <b>"), "1 $\\pm$ 0.2 \\textless{}b\\textgreater{}");
    }
}
