//! Aligned tables, fitted to the terminal.

use console::{measure_text_width, truncate_str};

/// No column is made narrower.
const NARROWEST: usize = 8;

const GAP: &str = "  ";

/// A header and its rows, all equally long.
pub struct Table {
    /// Names of the columns.
    pub header: Vec<String>,
    /// The cells.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// The table as lines, columns aligned, numbers to the right. Within `width` the widest columns
    /// are trimmed, and where that is not enough, columns before the last are left out; the
    /// number of those comes with the text.
    pub fn render(&self, width: Option<usize>) -> (String, usize) {
        let mut shown: Vec<usize> = (0..self.header.len()).collect();
        let mut widths: Vec<usize> = shown.iter().map(|place| self.natural(*place)).collect();
        let limit = width.unwrap_or(usize::MAX);
        trim(&mut widths, limit);
        let n_hidden = |shown: &[usize]| self.header.len() - shown.len();
        while total(&widths) > limit && shown.len() > 2 {
            shown.remove(shown.len() - 2);
            widths = shown.iter().map(|place| self.natural(*place)).collect();
            trim(&mut widths, limit);
        }
        let is_number: Vec<bool> = shown.iter().map(|place| self.is_number(*place)).collect();
        let mut text = String::new();
        for row in std::iter::once(&self.header).chain(&self.rows) {
            let cells = shown.iter().zip(&widths).zip(&is_number).map(|((place, width), right)| {
                let cell = truncate_str(&row[*place], *width, "…");
                let pad = " ".repeat(width.saturating_sub(measure_text_width(&cell)));
                if *right { format!("{pad}{cell}") } else { format!("{cell}{pad}") }
            });
            let line = cells.collect::<Vec<_>>().join(GAP);
            text.push_str(line.trim_end());
            text.push('\n');
        }
        (text, n_hidden(&shown))
    }

    fn natural(&self, place: usize) -> usize {
        let cells = std::iter::once(&self.header).chain(&self.rows);
        cells.map(|row| measure_text_width(&row[place])).max().unwrap_or(0)
    }

    fn is_number(&self, place: usize) -> bool {
        let mut cells = self.rows.iter().map(|row| &row[place]).filter(|cell| !cell.is_empty());
        let mut any = false;
        cells.all(|cell| {
            any = true;
            cell.parse::<f64>().is_ok()
        }) && any
    }
}

fn total(widths: &[usize]) -> usize {
    widths.iter().sum::<usize>() + GAP.len() * widths.len().saturating_sub(1)
}

/// Takes from the widest columns until all fit, or all are as narrow as they get.
fn trim(widths: &mut [usize], limit: usize) {
    while total(widths) > limit {
        match widths.iter_mut().max() {
            Some(widest) if *widest > NARROWEST => *widest -= 1,
            _ => return,
        }
    }
}

/// A text in lines of at most `width` columns, all but the first after `indent` spaces.
pub fn wrap(text: &str, width: Option<usize>, indent: usize) -> String {
    let Some(width) = width.map(|width| width.saturating_sub(indent).max(20)) else {
        return text.to_owned();
    };
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let line = lines.last().map_or(0, |line| measure_text_width(line));
        if line > 0 && line + 1 + measure_text_width(word) > width {
            lines.push(String::new());
        }
        if let Some(last) = lines.last_mut() {
            if !last.is_empty() {
                last.push(' ');
            }
            last.push_str(word);
        }
    }
    lines.join(&format!("\n{}", " ".repeat(indent)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        let row = |cells: [&str; 4]| cells.map(str::to_owned).to_vec();
        Table {
            header: row(["path", "faces", "error", "status"]),
            rows: vec![
                row(["models/a-very-long-name.obj", "300", "0.1", "done"]),
                row(["b", "4000", "", "failed"]),
            ],
        }
    }

    #[test]
    fn columns_are_aligned() {
        let expected = "\
path                         faces  error  status
models/a-very-long-name.obj    300    0.1  done
b                             4000         failed
";
        assert_eq!(table().render(None), (expected.to_owned(), 0));
    }

    #[test]
    fn the_widest_column_is_trimmed_first() {
        let (text, n_hidden) = table().render(Some(36));
        assert_eq!(n_hidden, 0);
        assert!(text.lines().all(|line| measure_text_width(line) <= 36), "{text}");
        assert!(text.contains("models/a-very…    300"), "{text}");
    }

    #[test]
    fn what_does_not_fit_is_left_out_and_counted() {
        let (text, n_hidden) = table().render(Some(24));
        assert_eq!(n_hidden, 1);
        assert!(text.lines().next().unwrap().ends_with("status"), "{text}");
    }

    #[test]
    fn wrapped_lines_hang() {
        assert_eq!(wrap("one two three four five", Some(24), 2), "one two three four\n  five");
        assert_eq!(wrap("one two", None, 2), "one two");
    }
}
