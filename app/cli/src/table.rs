//! Aligned tables, fitted to the terminal.

use std::borrow::Cow;

use console::{measure_text_width, truncate_str};
use mve_core::printable;

/// No column is made narrower, and no number is ever cut.
const NARROWEST: usize = 12;

const GAP: &str = "  ";

/// A header and its rows, all equally long.
pub struct TextTable {
    /// Names of the columns; those of a node are `node.name`.
    pub header: Vec<String>,
    /// The cells.
    pub rows: Vec<Vec<String>>,
    /// How many of the first columns are left out last.
    pub n_fixed: usize,
}

impl TextTable {
    /// The table as lines, columns aligned, numbers to the right.
    ///
    /// Within `width`, names stand below those of their nodes and the widest columns are trimmed.
    /// Where that is not enough columns are left out, of the node with the most; the number of
    /// those comes with the text.
    pub fn render(mut self, width: Option<usize>) -> (String, usize) {
        // A cell is one line, whatever a map says in it.
        for cell in self.rows.iter_mut().flatten().chain(&mut self.header) {
            if let Cow::Owned(safe) = printable(cell) {
                *cell = safe;
            }
        }
        let Some(limit) = width else {
            let shown: Vec<_> = (0..self.header.len()).collect();
            let widths: Vec<_> = shown.iter().map(|place| self.natural(*place)).collect();
            let lines = std::iter::once(&self.header).chain(&self.rows);
            return (self.lines(lines, &shown, &widths), 0);
        };
        let split: Vec<_> =
            self.header.iter().map(|name| name.split_once('.').unwrap_or(("", name))).collect();
        let above = split.iter().map(|(node, _)| (*node).to_owned()).collect();
        let below = split.iter().map(|(_, name)| (*name).to_owned()).collect();
        let split = Self {
            header: below,
            rows: std::iter::once(above).chain(self.rows.iter().cloned()).collect(),
            n_fixed: self.n_fixed,
        };
        let mut shown: Vec<usize> = (0..self.header.len()).collect();
        let mut widths = split.fitted(&shown, &self, limit);
        while total(&widths) > limit && shown.len() > 1 {
            shown.remove(self.least_missed(&shown));
            widths = split.fitted(&shown, &self, limit);
        }
        let above = split.rows.iter().take(1).filter(|row| row.iter().any(|c| !c.is_empty()));
        let lines = above.chain([&split.header]).chain(&self.rows);
        (self.lines(lines, &shown, &widths), self.header.len() - shown.len())
    }

    fn lines<'a>(
        &self,
        rows: impl Iterator<Item = &'a Vec<String>>,
        shown: &[usize],
        widths: &[usize],
    ) -> String {
        let is_number: Vec<bool> = shown.iter().map(|place| self.is_number(*place)).collect();
        let mut text = String::new();
        for row in rows {
            let cells = shown.iter().zip(widths).zip(&is_number).map(|((place, width), right)| {
                let cell = truncate_str(&row[*place], *width, "…");
                let pad = " ".repeat(width.saturating_sub(measure_text_width(&cell)));
                if *right { format!("{pad}{cell}") } else { format!("{cell}{pad}") }
            });
            let line = cells.collect::<Vec<_>>().join(GAP);
            text.push_str(line.trim_end());
            text.push('\n');
        }
        text
    }

    /// The place in `shown` of the column to leave out next: the last one of the node with the
    /// most, or where no node has any left, the last but one.
    fn least_missed(&self, shown: &[usize]) -> usize {
        let node = |place: usize| self.header[place].split_once('.').map(|(node, _)| node);
        let of_nodes = shown.iter().enumerate().filter(|(_, place)| **place >= self.n_fixed);
        let of_nodes: Vec<_> = of_nodes.filter_map(|(i, place)| Some((i, node(*place)?))).collect();
        let n_of = |name: &str| of_nodes.iter().filter(|(_, node)| *node == name).count();
        let most = of_nodes.iter().max_by_key(|(i, node)| (n_of(node), *i));
        most.map_or(shown.len() - 2, |(i, _)| *i)
    }

    /// Widths of the columns, trimmed as far as may be. `whole` tells which hold numbers.
    fn fitted(&self, shown: &[usize], whole: &Self, limit: usize) -> Vec<usize> {
        let mut widths: Vec<_> = shown.iter().map(|place| self.natural(*place)).collect();
        let least = |place: &usize| match whole.is_number(*place) {
            true => whole.widest_cell(*place).max(NARROWEST),
            false => NARROWEST,
        };
        let least: Vec<_> = shown.iter().map(least).collect();
        while total(&widths) > limit {
            let wide = widths.iter_mut().zip(&least).filter(|(width, least)| **width > **least);
            let Some((widest, _)) = wide.max() else { break };
            *widest -= 1;
        }
        widths
    }

    fn natural(&self, place: usize) -> usize {
        self.widest_cell(place).max(measure_text_width(&self.header[place]))
    }

    fn widest_cell(&self, place: usize) -> usize {
        self.rows.iter().map(|row| measure_text_width(&row[place])).max().unwrap_or(0)
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

    fn table() -> TextTable {
        let row = |cells: [&str; 5]| cells.map(str::to_owned).to_vec();
        TextTable {
            header: row(["load.path", "fit.faces", "fit.error", "compare.max", "status"]),
            rows: vec![
                row(["models/a-very-long-name.obj", "300", "0.1", "0.123456789012345", "done"]),
                row(["b", "4000", "", "1e-9", "failed"]),
            ],
            n_fixed: 1,
        }
    }

    #[test]
    fn columns_are_aligned() {
        let expected = "\
load.path                    fit.faces  fit.error        compare.max  status
models/a-very-long-name.obj        300        0.1  0.123456789012345  done
b                                 4000                          1e-9  failed
";
        assert_eq!(table().render(None), (expected.to_owned(), 0));
    }

    #[test]
    fn on_a_terminal_the_widest_text_is_trimmed_and_no_number() {
        let expected = "\
load                   fit    fit            compare
path                 faces  error                max  status
models/a-very-long…    300    0.1  0.123456789012345  done
b                     4000                      1e-9  failed
";
        assert_eq!(table().render(Some(60)), (expected.to_owned(), 0));
    }

    #[test]
    fn what_does_not_fit_is_left_out_of_the_node_with_the_most() {
        let (text, n_hidden) = table().render(Some(46));
        assert_eq!(n_hidden, 1);
        assert!(text.lines().all(|line| measure_text_width(line) <= 46), "{text}");
        assert!(!text.contains("error") && text.contains("0.123456789012345"), "{text}");
        assert_eq!(table().render(Some(3)).1, 4);
    }

    #[test]
    fn wrapped_lines_hang() {
        assert_eq!(wrap("one two three four five", Some(24), 2), "one two three four\n  five");
        assert_eq!(wrap("one two", None, 2), "one two");
    }
}
