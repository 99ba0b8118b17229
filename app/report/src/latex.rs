//! Tables for a paper: LaTeX with the packages `booktabs` and `multirow`.
//!
//! The numbers of a table share one exponent and a fixed count of significant digits; their decimal
//! points stand below each other. A mean of repeats is followed by half of its 95 % confidence
//! interval in units of the last digit: `8.34(8)`.

use std::fmt::Write;

use mve_core::{Better, is_steering};

use crate::answers::Answer;
use crate::case::{Cell, NumberForm};
use crate::pivot::{Pivot, PivotCell, PivotRow};
use crate::stats::Estimate;

/// Significant digits of a number without an interval.
const DIGITS: i32 = 3;

/// Powers of ten that are written out.
const PLAIN: std::ops::RangeInclusive<i32> = -2..=4;

/// The answers, and a table a measure. `notes` stand at the top.
pub fn latex(title: &str, notes: &[String], answers: &[Answer], tables: &[Pivot]) -> String {
    let mut body = String::new();
    for answer in answers {
        let sentences: Vec<String> = answer.sentences.iter().map(|s| escaped(s)).collect();
        let (question, answer) = (escaped(&answer.text), sentences.join("\n"));
        let _ = write!(body, "\n\\paragraph{{{question}}}\n{answer}\n");
    }
    for table in tables {
        body.push_str(&of_table(table));
    }
    let mut out = format!("% {}\n% Needs \\usepackage{{booktabs,multirow}}", one_line(title));
    if let Some(sign) = body.chars().find(|c| !is_of_pdflatex(*c)) {
        let _ = write!(
            out,
            ", and XeLaTeX or LuaLaTeX with a font\n% that has {sign}: pdfLaTeX does not set it. \
             \\usepackage{{fontspec}}, \\setmainfont{{…}}"
        );
    } else if !body.is_ascii() {
        out.push_str(" and \\usepackage[T1]{fontenc}");
    }
    out.push_str(".\n");
    for note in notes {
        let _ = writeln!(out, "% {}", one_line(note));
    }
    out + &body
}

/// Whether pdfLaTeX sets a sign as it stands, in its font encodings T1 and TS1: what is left of them
/// are the letters of Western and Central European languages, and some signs of text.
fn is_of_pdflatex(c: char) -> bool {
    let is_letter = ('\0'..='\u{17e}').contains(&c) || ('\u{218}'..='\u{21b}').contains(&c);
    (is_letter && !"ĦħĸĿŀŉŦŧ".contains(c)) || "–—‘’‚„‰€•".contains(c)
}

fn of_table(table: &Pivot) -> String {
    let rows = table.with_means();
    let n_names = table.row_axes.len().max(1);
    let numbers = table.rows.iter().flat_map(|row| &row.cells).filter_map(|c| c.cell.number());
    let numbers: Vec<f64> = numbers.collect();
    let digits = match numbers.iter().all(|number| *number == number.trunc()) {
        true => Digits::Whole,
        false => Digits::Significant(exponent(numbers.iter().copied())),
    };
    let mut out = format!("\n\\begin{{table}}\n\\centering\n{}", caption(table, digits));
    let columns = format!("{}{}", "l".repeat(n_names), "r".repeat(table.columns.len()));
    let _ = writeln!(out, "\\begin{{tabular}}{{{columns}}}\n\\toprule");
    out.push_str(&header(table, n_names));
    out.push_str("\\midrule\n");
    let shown = |place: usize, row: &PivotRow| {
        // The last row may count, and counts have no exponent.
        let is_count =
            place > table.rows.len() || (place == table.rows.len() && table.means.is_none());
        let digits = if is_count { Digits::Whole } else { digits };
        row.cells.iter().map(|cell| number(cell, digits)).collect::<Vec<_>>()
    };
    let cells: Vec<Vec<Shown>> =
        rows.iter().enumerate().map(|(place, row)| shown(place, row)).collect();
    let widest = |column: usize| cells.iter().map(|row| row[column].decimals()).max().unwrap_or(0);
    let widest: Vec<usize> = (0..table.columns.len()).map(widest).collect();
    for (place, (row, cells)) in rows.iter().zip(&cells).enumerate() {
        let is_first_of_group = n_names > 1
            && (1..table.rows.len()).contains(&place)
            && row.names.first() != rows[place - 1].names.first();
        if place == table.rows.len() {
            out.push_str("\\midrule\n");
        } else if is_first_of_group {
            out.push_str("\\addlinespace\n");
        }
        let mut line = names(&rows, place, n_names, table.rows.len());
        if row.is_unequal && table.better != Better::Neither {
            line.push_str("$^\\ddagger$");
        }
        for ((cell, shown), widest) in row.cells.iter().zip(cells).zip(&widest) {
            let _ = write!(line, " & {}", shown.padded(cell, *widest));
        }
        let _ = writeln!(out, "{line} \\\\");
    }
    out.push_str("\\bottomrule\n\\end{tabular}\n\\end{table}\n");
    out
}

fn caption(table: &Pivot, digits: Digits) -> String {
    let mut sentences = vec![format!("{}.", escaped(&table.caption()))];
    if !table.column_axes.is_empty() {
        sentences.push(format!("Columns: {}.", escaped(&table.column_axes.join(", "))));
    }
    if let Digits::Significant(exponent) = digits
        && exponent != 0
    {
        sentences.push(format!("All values are to be multiplied by $10^{{{exponent}}}$."));
    }
    let cells = || table.rows.iter().flat_map(|row| &row.cells);
    if cells().any(|cell| cell.is_best) {
        sentences.push("The best of each row is bold.".to_owned());
    }
    let has_interval = |cell: &PivotCell| match cell.cell {
        Cell::Number(estimate) => estimate.half_width.is_some_and(|half| half > 0.0),
        _ => false,
    };
    if cells().any(has_interval) {
        let what = "In parentheses: half of the 95\\,\\% confidence interval of the mean over \
                    repeats, in units of the last digit.";
        sentences.push(what.to_owned());
    }
    sentences.extend(table.marks().iter().map(|mark| escaped(mark)));
    let name = table.column.as_deref().unwrap_or("measures");
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
    let label: String = name.chars().map(plain).collect();
    // Classes that are made for captions below leave no room behind one.
    format!("\\caption{{{}}}\n\\label{{tab:{label}}}\n\\smallskip\n", sentences.join(" "))
}

/// A line for each axis of the columns, with equal neighbors merged; the last one names the rows.
fn header(table: &Pivot, n_names: usize) -> String {
    let n_lines = table.columns.first().map_or(1, Vec::len).max(1);
    let mut out = String::new();
    for line in 0..n_lines {
        let is_last = line + 1 == n_lines;
        let own = (0..n_names).map(|place| match table.row_axes.get(place) {
            Some(name) if is_last => escaped(name),
            _ => String::new(),
        });
        let mut parts: Vec<String> = own.collect();
        let mut rules = String::new();
        let mut place = 0;
        while place < table.columns.len() {
            let same = |other: &&Vec<String>| other[..=line] == table.columns[place][..=line];
            let n = table.columns[place..].iter().take_while(same).count().max(1);
            let name = escaped(&table.columns[place][line]);
            let from = n_names + place + 1;
            if is_last {
                parts.extend(table.columns[place..place + n].iter().map(|c| escaped(&c[line])));
            } else {
                parts.push(format!("\\multicolumn{{{n}}}{{c}}{{{name}}}"));
                let _ = write!(rules, "\\cmidrule(lr){{{from}-{}}}", from + n - 1);
            }
            place += n;
        }
        let _ = writeln!(out, "{} \\\\", parts.join(" & "));
        if !rules.is_empty() {
            let _ = writeln!(out, "{rules}");
        }
    }
    out
}

/// The names of a row, with those that the rows before it share left out.
fn names(rows: &[PivotRow], place: usize, n_names: usize, n_own: usize) -> String {
    let row = &rows[place];
    if place >= n_own {
        let name = escaped(row.names.first().map_or("", String::as_str));
        return if n_names > 1 {
            format!("\\multicolumn{{{n_names}}}{{l}}{{{name}}}")
        } else {
            name
        };
    }
    let start = |row: &PivotRow, depth: usize| row.names.get(..=depth).map(<[String]>::to_vec);
    let parts = (0..n_names).map(|depth| {
        let own = start(row, depth);
        let name = escaped(row.names.get(depth).map_or("", String::as_str));
        let is_same = |other: &&PivotRow| start(other, depth) == own;
        if depth + 1 == n_names {
            return name;
        }
        if place > 0 && is_same(&&rows[place - 1]) {
            return String::new();
        }
        match rows[place..n_own].iter().take_while(is_same).count() {
            1 => name,
            n => format!("\\multirow{{{n}}}{{*}}{{{name}}}"),
        }
    });
    parts.collect::<Vec<_>>().join(" & ")
}

/// The power of ten that the numbers of a table share: that of their geometric middle; 0 where they
/// can be written out.
fn exponent(numbers: impl Iterator<Item = f64>) -> i32 {
    let logarithms = numbers.filter(|number| *number != 0.0).map(|number| number.abs().log10());
    let logarithms: Vec<f64> = logarithms.collect();
    let (Some(low), Some(high)) =
        (logarithms.iter().copied().reduce(f64::min), logarithms.iter().copied().reduce(f64::max))
    else {
        return 0;
    };
    if PLAIN.contains(&(low.floor() as i32)) && PLAIN.contains(&(high.floor() as i32)) {
        return 0;
    }
    (0.5 * (low + high)).floor() as i32
}

/// How the numbers of a table are written.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Digits {
    /// As whole numbers.
    Whole,
    /// By their first digits, in units of this power of ten.
    Significant(i32),
}

/// A cell in words, its decimal point at a known place.
enum Shown {
    /// The number, and the interval in parentheses or nothing.
    Number(String, String),
    Text(String),
}

fn number(cell: &PivotCell, digits: Digits) -> Shown {
    let Cell::Number(Estimate { mean, half_width, .. }) = cell.cell else {
        return Shown::Text(escaped(&cell.cell.shown(NumberForm::Plain)));
    };
    let scale = match digits {
        Digits::Whole => 1.0,
        Digits::Significant(exponent) => 10f64.powi(exponent),
    };
    let (mean, half) = (mean / scale, half_width.unwrap_or(0.0) / scale);
    let magnitude = |value: f64| value.abs().log10().floor() as i32;
    if half > 0.0 && half.is_finite() {
        // One digit of the interval; two where the first would be a coarse 1.
        let first = (half / 10f64.powi(magnitude(half))).floor();
        let decimals = (i32::from(first < 2.0) - magnitude(half)).max(0);
        let units = (half * 10f64.powi(decimals)).round();
        return Shown::Number(format!("{mean:.*}", decimals as usize), format!("({units})"));
    }
    if mean == 0.0 || (digits == Digits::Whole && mean == mean.trunc()) {
        return Shown::Number(mean.to_string(), String::new());
    }
    // Rounding may raise the first digit: 9.996 is 10.0, not 10.00.
    let places = DIGITS - 1 - magnitude(mean);
    let rounded = (mean * 10f64.powi(places)).round() / 10f64.powi(places);
    let decimals = (DIGITS - 1 - magnitude(rounded)).max(0);
    Shown::Number(format!("{mean:.*}", decimals as usize), String::new())
}

impl Shown {
    /// Characters behind the decimal point, the interval included.
    fn decimals(&self) -> usize {
        match self {
            Self::Text(_) => 0,
            Self::Number(number, interval) => {
                number.split_once('.').map_or(0, |(_, decimals)| decimals.len() + 1)
                    + interval.len()
            }
        }
    }

    /// With room behind it, so that decimal points stand below each other.
    fn padded(&self, cell: &PivotCell, widest: usize) -> String {
        let Self::Number(number, interval) = self else {
            let Self::Text(text) = self else { return String::new() };
            return text.clone();
        };
        let number = format!("{}{interval}", number.replace('-', "$-$"));
        let missing = widest - self.decimals();
        // A point is narrower than a digit.
        let room = match (missing, number.contains('.')) {
            (0, _) => String::new(),
            (n, true) => format!("\\phantom{{{}}}", "0".repeat(n)),
            (n, false) => format!("\\phantom{{.{}}}", "0".repeat(n - 1)),
        };
        let mark = if cell.missed.is_some() { "\\rlap{$^\\dagger$}" } else { "" };
        match cell.is_best {
            true => format!("\\textbf{{{number}}}{mark}{room}"),
            false => format!("{number}{mark}{room}"),
        }
    }
}

fn one_line(text: &str) -> String {
    text.chars().map(|c| if is_steering(c) { ' ' } else { c }).collect()
}

/// A text as LaTeX shows it.
fn escaped(text: &str) -> String {
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
            '×' => out.push_str("$\\times$"),
            '−' => out.push_str("$-$"),
            '²' => out.push_str("$^2$"),
            '³' => out.push_str("$^3$"),
            '†' => out.push_str("$^\\dagger$"),
            '‡' => out.push_str("$^\\ddagger$"),
            '“' => out.push_str("``"),
            '”' => out.push_str("''"),
            '…' => out.push_str("\\ldots{}"),
            '\u{a0}' => out.push('~'),
            c if symbol(c).is_some() => match symbol(c).unwrap_or_default() {
                command if command.starts_with('\\') => out.extend(["$", command, "$"]),
                letter => out.push_str(letter),
            },
            c if is_steering(c) => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// A sign that pdfLaTeX does not know outside of formulas: its command in one. Greek letters that
/// look like Latin ones have none, and are those.
fn symbol(c: char) -> Option<&'static str> {
    Some(match c {
        '≤' => "\\le",
        '≥' => "\\ge",
        '≠' => "\\ne",
        '≈' => "\\approx",
        '∞' => "\\infty",
        '→' => "\\to",
        '←' => "\\leftarrow",
        '√' => "\\surd",
        '∆' => "\\Delta",
        '∑' => "\\Sigma",
        'µ' => "\\mu",
        'Α'..='Ω' => CAPITALS[c as usize - 'Α' as usize],
        'α'..='ω' => LETTERS[c as usize - 'α' as usize],
        _ => return None,
    })
}

/// From alpha to omega. Among the capitals, no sign stands at the place of the final sigma.
#[rustfmt::skip]
const CAPITALS: [&str; 25] = [
    "A", "B", "\\Gamma", "\\Delta", "E", "Z", "H", "\\Theta", "I", "K", "\\Lambda", "M", "N",
    "\\Xi", "O", "\\Pi", "P", "", "\\Sigma", "T", "\\Upsilon", "\\Phi", "X", "\\Psi", "\\Omega",
];
#[rustfmt::skip]
const LETTERS: [&str; 25] = [
    "\\alpha", "\\beta", "\\gamma", "\\delta", "\\epsilon", "\\zeta", "\\eta", "\\theta",
    "\\iota", "\\kappa", "\\lambda", "\\mu", "\\nu", "\\xi", "o", "\\pi", "\\rho", "\\varsigma",
    "\\sigma", "\\tau", "\\upsilon", "\\phi", "\\chi", "\\psi", "\\omega",
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::estimate;

    #[test]
    fn no_text_is_taken_for_a_command() {
        assert_eq!(escaped("50% of a_b & \\x{}"), "50\\% of a\\_b \\& \\textbackslash{}x\\{\\}");
        assert_eq!(escaped("σ ≤ ω, α → μ"), "$\\sigma$ $\\le$ $\\omega$, $\\alpha$ $\\to$ $\\mu$");
        assert_eq!(escaped("ΑΒΓ Ωο"), "AB$\\Gamma$ $\\Omega$o");
        let greek = ('Α'..='Ω').chain('α'..='ω').filter(|c| *c != '\u{3a2}');
        assert!(escaped(&greek.collect::<String>()).is_ascii());
        assert_eq!(escaped("1 ± 0.2 <b>"), "1 $\\pm$ 0.2 \\textless{}b\\textgreater{}");
    }

    #[test]
    fn what_pdflatex_cannot_set_is_said_at_the_top() {
        let head = |text: &str| {
            let mut table = Pivot::default();
            table.title = text.to_owned();
            table.columns = vec![vec!["a".to_owned()]];
            let tables = [table];
            let latex = latex("t", &[], &[], &tables);
            latex.lines().take_while(|line| line.starts_with('%')).collect::<Vec<_>>().join("\n")
        };
        assert_eq!(head("σ ≤ 2"), "% t\n% Needs \\usepackage{booktabs,multirow}.");
        assert!(head("Łódź").ends_with("multirow} and \\usepackage[T1]{fontenc}."));
        let said = head("兎 and Łódź");
        assert!(said.contains("XeLaTeX or LuaLaTeX with a font\n% that has 兎:"), "{said}");
    }

    fn shown(mean: f64, half_width: Option<f64>, exponent: i32) -> String {
        let estimate = Estimate { n: 1, mean, half_width };
        let cell = PivotCell { cell: Cell::Number(estimate), is_best: false, missed: None };
        let number = number(&cell, Digits::Significant(exponent));
        let widest = number.decimals();
        number.padded(&cell, widest)
    }

    #[test]
    fn numbers_have_three_digits_or_those_that_the_interval_leaves() {
        assert_eq!(shown(8.3385e-4, Some(8.3e-6), -4), "8.34(8)");
        assert_eq!(shown(8.3385e-4, Some(1.2e-6), -4), "8.338(12)");
        assert_eq!(shown(4.2004e-4, None, -4), "4.20");
        assert_eq!(shown(9.996e-4, None, -4), "10.0");
        assert_eq!(shown(0.0012752, None, -4), "12.8");
        assert_eq!(shown(600.0, None, 0), "600");
        assert_eq!(shown(-0.5, None, 0), "$-$0.500");
        assert_eq!(shown(1234.0, Some(56.0), 0), "1234(56)");
    }

    #[test]
    fn a_table_shares_one_exponent() {
        assert_eq!(exponent([4.2e-4, 1.2e-3].into_iter()), -4);
        assert_eq!(exponent([0.5, 120.0].into_iter()), 0);
        assert_eq!(exponent([0.0].into_iter()), 0);
    }

    #[test]
    fn decimal_points_stand_below_each_other() {
        let cell = |mean: f64| PivotCell {
            cell: estimate(&[mean]).map_or(Cell::Empty, Cell::Number),
            is_best: true,
            missed: Some("faces".to_owned()),
        };
        let padded = |mean: f64| number(&cell(mean), Digits::Significant(0)).padded(&cell(mean), 5);
        assert_eq!(padded(0.0834), "\\textbf{0.0834}\\rlap{$^\\dagger$}");
        assert_eq!(padded(83.4), "\\textbf{83.4}\\rlap{$^\\dagger$}\\phantom{000}");
        assert_eq!(padded(834.0), "\\textbf{834}\\rlap{$^\\dagger$}\\phantom{.0000}");
    }
}
