//! The rows of a table: which are shown, in which order, and as text.

use std::sync::Arc;

use mve_modules::data::{Domain, TriMesh};
use rayon::prelude::*;

use super::columns::{Cells, SheetColumn};
use super::filter::Filter;
use crate::views::table::{Sort, SortOrder};

/// A table of elements.
pub struct Sheet {
    /// Where its value comes from: `simplify.mesh`.
    pub title: String,
    /// What its rows are.
    pub domain: Domain,
    /// Elements that there are.
    pub n_elements: usize,
    /// What it says of each; the first column is its number.
    pub columns: Vec<SheetColumn>,
    /// Whose elements they are; a field by itself has none.
    pub mesh: Option<Arc<TriMesh>>,
}

impl Sheet {
    /// The elements that a filter keeps, in the order of a column; those without a value come last
    /// in both directions, and equal ones keep their order. O(n log n), on all threads.
    pub fn rows(&self, filter: Option<&Filter>, sort: Sort) -> Vec<u32> {
        let n_elements = u32::try_from(self.n_elements).unwrap_or(u32::MAX);
        let all = (0..n_elements).into_par_iter().with_min_len(1 << 12);
        let is_kept = |element: &u32| {
            filter.is_none_or(|filter| filter.keeps(&self.columns, *element as usize))
        };
        let kept = all.filter(is_kept);
        let Some((column, direction)) = sort else { return kept.collect() };
        match self.columns.get(column).map(|column| &column.cells) {
            None => kept.collect(),
            Some(Cells::Numbers(read)) => in_order(kept, read, direction),
            Some(Cells::Names(names)) => in_order(kept, names.ranks(), direction),
        }
    }

    /// The place of a column among all.
    pub fn place_of(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column.name == name)
    }

    /// Rows as tab-separated text below the names of the columns.
    pub fn to_tsv(&self, rows: impl Iterator<Item = usize>) -> String {
        let head = self.columns.iter().map(SheetColumn::title).collect::<Vec<_>>();
        let mut text = head.join("\t") + "\n";
        for element in rows {
            let cells = self.columns.iter().map(|column| column.copied(element));
            text += &(cells.collect::<Vec<_>>().join("\t") + "\n");
        }
        text
    }
}

/// The rows that are shown: all in their order, or those that were found.
#[derive(Clone)]
pub struct Rows {
    /// How many there are.
    pub n: usize,
    /// Their elements, where these were found.
    pub found: Option<Arc<Vec<u32>>>,
}

impl Rows {
    /// The element of a row.
    pub fn element(&self, place: usize) -> usize {
        let found = self.found.as_ref().and_then(|found| found.get(place));
        found.map_or(place, |element| *element as usize)
    }

    /// Where an element stands; where rows are filtered or sorted O(n), on all threads.
    pub fn place(&self, element: usize) -> Option<usize> {
        match &self.found {
            None => (element < self.n).then_some(element),
            Some(found) => found.par_iter().position_any(|one| *one as usize == element),
        }
    }
}

fn in_order(
    kept: impl ParallelIterator<Item = u32>,
    number: impl Fn(usize) -> Option<f64> + Sync,
    direction: SortOrder,
) -> Vec<u32> {
    let keyed = |element: u32| {
        let number = number(element as usize).filter(|number| !number.is_nan());
        // Adding 0 makes one of the two zeros.
        (number.is_none(), number.unwrap_or(0.0) + 0.0, element)
    };
    let mut keyed: Vec<(bool, f64, u32)> = kept.map(keyed).collect();
    keyed.par_sort_unstable_by(|a, b| {
        let by_number = match direction {
            SortOrder::Up => a.1.total_cmp(&b.1),
            SortOrder::Down => b.1.total_cmp(&a.1),
        };
        a.0.cmp(&b.0).then(by_number).then(a.2.cmp(&b.2))
    });
    keyed.into_par_iter().map(|(.., element)| element).collect()
}

#[cfg(test)]
mod tests {
    use mve_modules::data::Field;

    use super::super::columns::field_columns;
    use super::*;

    fn sheet(values: &[f64]) -> Sheet {
        let field = Field {
            name: "height".to_owned(),
            unit: "mm".to_owned(),
            domain: Domain::Vertex,
            values: values.to_vec(),
        };
        let columns = field_columns("a.field", &Arc::new(field));
        let title = "a.field".to_owned();
        Sheet { title, domain: Domain::Vertex, n_elements: values.len(), columns, mesh: None }
    }

    #[test]
    fn rows_are_filtered_and_sorted_and_what_is_no_number_is_last() {
        let sheet = sheet(&[3.0, f64::NAN, 1.0, 3.0, -0.0, 0.0, f64::INFINITY]);
        let by = |direction| Some((1, direction));
        assert_eq!(sheet.rows(None, None), [0, 1, 2, 3, 4, 5, 6]);
        assert_eq!(sheet.rows(None, by(SortOrder::Up)), [4, 5, 2, 0, 3, 6, 1]);
        assert_eq!(sheet.rows(None, by(SortOrder::Down)), [6, 0, 3, 2, 4, 5, 1]);
        let filter = Filter::compile("height >= 1 and vertex != 3", &sheet.columns).unwrap();
        assert_eq!(sheet.rows(Some(&filter), by(SortOrder::Down)), [6, 0, 2]);
        // A column that is no longer there puts nothing in order.
        assert_eq!(sheet.rows(Some(&filter), Some((7, SortOrder::Up))), [0, 2, 6]);
    }

    #[test]
    fn copied_rows_have_numbers_in_full_below_names_and_units() {
        let sheet = sheet(&[0.5, 1.0 / 3.0]);
        let text = sheet.to_tsv([1, 0].into_iter());
        assert_eq!(text, "vertex\theight (mm)\n1\t0.3333333333333333\n0\t0.5\n");
    }
}
