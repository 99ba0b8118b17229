//! A table: columns with names and units, and rows of cells, which can be put in order.

use std::cmp::Ordering;

use mve_core::Scalar;

use crate::views::number::ColumnFormat;

/// What the cells of a column are.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// Unit of its numbers, or empty.
    pub unit: String,
}

impl Column {
    /// Its name and unit.
    pub fn title(&self) -> String {
        title_of(&self.name, &self.unit)
    }
}

/// Rows of cells under columns. A row may be short; what it lacks is empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CellTable {
    /// From left to right.
    pub columns: Vec<Column>,
    /// From top to bottom.
    pub rows: Vec<Vec<Option<Scalar>>>,
}

impl CellTable {
    /// The cell, if it is there and not empty.
    pub fn cell(&self, row: usize, column: usize) -> Option<&Scalar> {
        self.rows.get(row)?.get(column)?.as_ref()
    }

    /// The number in a cell; a text that reads as a number is one.
    pub fn number(&self, row: usize, column: usize) -> Option<f64> {
        number_in(self.cell(row, column)?)
    }

    /// Whether a column has a number.
    pub fn has_numbers(&self, column: usize) -> bool {
        (0..self.rows.len()).any(|row| self.number(row, column).is_some())
    }

    /// The rows in the order of a column. Numbers come before texts, texts with numbers in them
    /// in the order of the numbers; rows that are equal keep their order. What is not a number,
    /// and empty cells, come last in both directions.
    pub fn order_by(&self, column: usize, direction: SortOrder) -> Vec<usize> {
        let mut rows: Vec<usize> = (0..self.rows.len()).collect();
        rows.sort_by(|&a, &b| {
            let (a, b) = (self.cell(a, column), self.cell(b, column));
            let by_rank = rank(a).cmp(&rank(b));
            let by_content = by_rank.then_with(|| match (a, b) {
                (Some(a), Some(b)) => compare(a, b),
                _ => Ordering::Equal,
            });
            match direction {
                SortOrder::Down if rank(a) < LAST && rank(b) < LAST => by_content.reverse(),
                _ => by_content,
            }
        });
        rows
    }

    /// All of it as tab-separated text, rows in the given order, numbers in full.
    pub fn to_tsv(&self, order: &[usize]) -> String {
        // Tabs and line ends in a cell would be taken for the table's own.
        let plain = |text: String| text.replace(['\t', '\n', '\r'], " ");
        let head = self.columns.iter().map(|column| plain(column.title()));
        let mut text = head.collect::<Vec<_>>().join("\t") + "\n";
        for &row in order {
            let cells = (0..self.columns.len()).map(|column| {
                self.cell(row, column).map_or(String::new(), |c| plain(c.to_string()))
            });
            text += &(cells.collect::<Vec<_>>().join("\t") + "\n");
        }
        text
    }
}

/// What stands above numbers: their name and unit.
pub fn title_of(name: &str, unit: &str) -> String {
    match unit.is_empty() {
        true => name.to_owned(),
        false => format!("{name} ({unit})"),
    }
}

/// Which end of a sorted column comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SortOrder {
    /// The least.
    Up,
    /// The greatest.
    Down,
}

fn number_in(cell: &Scalar) -> Option<f64> {
    match cell {
        Scalar::Number(number) => Some(*number),
        Scalar::Flag(_) => None,
        Scalar::Text(text) => text.trim().parse().ok(),
    }
}

/// The rank of cells that are last whatever the direction.
const LAST: u8 = 3;

fn rank(cell: Option<&Scalar>) -> u8 {
    match cell {
        None => LAST + 1,
        Some(Scalar::Flag(_)) => 1,
        Some(cell) => match number_in(cell) {
            Some(number) if number.is_nan() => LAST,
            Some(_) => 0,
            None => 2,
        },
    }
}

/// Cells of one rank.
fn compare(a: &Scalar, b: &Scalar) -> Ordering {
    match (number_in(a), number_in(b)) {
        // Adding 0 makes both zeros one.
        (Some(a), Some(b)) => (a + 0.0).total_cmp(&(b + 0.0)),
        _ => match (a, b) {
            (Scalar::Flag(a), Scalar::Flag(b)) => a.cmp(b),
            _ => compare_texts(&a.to_string(), &b.to_string()),
        },
    }
}

/// `cow2` before `cow10`: runs of digits compare as numbers, all else by letters.
pub fn compare_texts(a: &str, b: &str) -> Ordering {
    let (mut a, mut b) = (a, b);
    loop {
        let (Some(first_a), Some(first_b)) = (a.chars().next(), b.chars().next()) else {
            return a.len().cmp(&b.len());
        };
        if first_a.is_ascii_digit() && first_b.is_ascii_digit() {
            let digits = |text: &str| text.chars().take_while(char::is_ascii_digit).count();
            let (run_a, rest_a) = a.split_at(digits(a));
            let (run_b, rest_b) = b.split_at(digits(b));
            let [value_a, value_b] = [run_a, run_b].map(|run| run.trim_start_matches('0'));
            let order = value_a.len().cmp(&value_b.len()).then(value_a.cmp(value_b));
            if order != Ordering::Equal {
                return order;
            }
            (a, b) = (rest_a, rest_b);
        } else {
            let order = first_a.cmp(&first_b);
            if order != Ordering::Equal {
                return order;
            }
            (a, b) = (&a[first_a.len_utf8()..], &b[first_b.len_utf8()..]);
        }
    }
}

/// A cell in few letters; numbers as those of their column.
pub fn cell_text(cell: &Scalar, format: ColumnFormat) -> String {
    match cell {
        Scalar::Number(number) => format.text(*number),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column_of(cells: Vec<Option<Scalar>>) -> CellTable {
        let columns = vec![Column { name: "a".to_owned(), unit: String::new() }];
        CellTable { columns, rows: cells.into_iter().map(|cell| vec![cell]).collect() }
    }

    fn text(text: &str) -> Option<Scalar> {
        Some(Scalar::Text(text.to_owned()))
    }

    #[test]
    fn numbers_then_texts_then_what_is_no_number_then_nothing() {
        let number = |x: f64| Some(Scalar::Number(x));
        let table = column_of(vec![
            text("cow10"),
            number(f64::NAN),
            number(2.0),
            None,
            text("cow2"),
            number(-1.5),
            text("10"),
            number(f64::INFINITY),
        ]);
        assert_eq!(table.order_by(0, SortOrder::Up), [5, 2, 6, 7, 4, 0, 1, 3]);
        assert_eq!(table.order_by(0, SortOrder::Down), [0, 4, 7, 6, 2, 5, 1, 3]);
        assert_eq!(table.order_by(9, SortOrder::Up), [0, 1, 2, 3, 4, 5, 6, 7]);
    }

    #[test]
    fn equal_rows_keep_their_order_in_both_directions() {
        let cells = [3.0, 0.0, 3.0, -0.0].map(|x| Some(Scalar::Number(x)));
        let table = column_of(cells.to_vec());
        assert_eq!(table.order_by(0, SortOrder::Up), [1, 3, 0, 2]);
        assert_eq!(table.order_by(0, SortOrder::Down), [0, 2, 1, 3]);
    }

    #[test]
    fn digits_in_texts_count_as_numbers() {
        assert_eq!(compare_texts("a9", "a10"), Ordering::Less);
        assert_eq!(compare_texts("a007", "a7"), Ordering::Equal);
        assert_eq!(compare_texts("a7b", "a7c"), Ordering::Less);
        assert_eq!(compare_texts("ä", "äb"), Ordering::Less);
        let long = "123456789012345678901234567890";
        assert_eq!(compare_texts(long, "99"), Ordering::Greater);
    }

    #[test]
    fn tab_separated_text_has_numbers_in_full_and_no_strange_tabs() {
        let mut table = column_of(vec![Some(Scalar::Number(1.0 / 3.0)), text("x\ty"), None]);
        table.columns[0].unit = "mm".to_owned();
        assert_eq!(table.to_tsv(&[1, 0, 2]), "a (mm)\nx y\n0.3333333333333333\n\n");
    }
}
