//! Tables of one measure: rows are what was treated, columns what it was treated with, the best of
//! each row marked.

use mve_core::{Better, brief};

use crate::columns::MeasureColumn;
use crate::results::{Cell, Results};
use crate::stats::geometric_mean;

/// A table of one measure, or, where nothing is compared, of all measures.
pub struct Pivot {
    /// What it measures.
    pub title: String,
    /// Which values are better; `None` where the columns are different measures.
    pub better: Option<Better>,
    /// What the rows are.
    pub corner: String,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// The rows.
    pub rows: Vec<PivotRow>,
    /// Geometric means over the rows that are complete, and of how many.
    pub means: Option<(Vec<f64>, usize)>,
    /// In how many rows each column is the best, alone or with others.
    pub n_best: Option<Vec<usize>>,
}

/// A row of a table.
pub struct PivotRow {
    /// Its name.
    pub label: String,
    /// Its cells.
    pub cells: Vec<Cell>,
    /// Whether each is the best of the row, as far as its digits are shown.
    pub is_best: Vec<bool>,
}

/// A row of a table as it is shown.
pub struct ShownRow {
    /// Its name.
    pub label: String,
    /// Its cells.
    pub cells: Vec<String>,
    /// Whether each is the best.
    pub is_best: Vec<bool>,
}

impl Pivot {
    /// The rows, and what sums them up.
    pub fn shown_rows(&self) -> Vec<ShownRow> {
        let shown = |row: &PivotRow| ShownRow {
            label: row.label.clone(),
            cells: row.cells.iter().map(Cell::shown).collect(),
            is_best: row.is_best.clone(),
        };
        let mut rows: Vec<ShownRow> = self.rows.iter().map(shown).collect();
        if let (Some((means, n)), Some(better)) = (&self.means, self.better) {
            let n_rows = self.rows.len();
            let of = if *n == n_rows { String::new() } else { format!(" of {n} complete rows") };
            rows.push(ShownRow {
                label: format!("Geometric mean{of}"),
                cells: means.iter().map(|mean| brief(*mean)).collect(),
                is_best: best_mean(means, better),
            });
        }
        if let Some(counts) = &self.n_best {
            rows.push(ShownRow {
                label: format!("Best in, of {}", self.rows.len()),
                cells: counts.iter().map(usize::to_string).collect(),
                is_best: vec![false; counts.len()],
            });
        }
        rows
    }
}

/// The tables of all measures that are there.
pub fn pivots(results: &Results, measures: &[MeasureColumn]) -> Vec<Pivot> {
    let measures: Vec<&MeasureColumn> = measures.iter().filter(|m| m.is_there).collect();
    let path = |place: usize| results.axes[place].paths.first().cloned();
    let corner = results.row_axes().into_iter().filter_map(path).collect::<Vec<_>>();
    let corner = corner.join(" · ");
    if !results.has_series {
        return plain(results, &measures, corner).into_iter().collect();
    }
    let one = |measure: &&MeasureColumn| {
        let row = |(row, cases): (Vec<usize>, Vec<Option<&crate::results::Case>>)| {
            let cell = |case: &Option<&crate::results::Case>| {
                case.map_or(Cell::Empty, |case| case.cell(&measure.column))
            };
            let cells: Vec<Cell> = cases.iter().map(cell).collect();
            let is_best = best_of(&cells, measure.better);
            PivotRow { label: results.row_label(&row), cells, is_best }
        };
        let rows: Vec<PivotRow> = results.rows().into_iter().map(row).collect();
        let columns = results.series_labels();
        Pivot {
            title: measure.title.clone(),
            better: Some(measure.better),
            corner: corner.clone(),
            means: means(&rows, columns.len()),
            n_best: n_best(&rows, columns.len()),
            columns,
            rows,
        }
    };
    measures.iter().map(one).collect()
}

/// One table of all measures.
fn plain(results: &Results, measures: &[&MeasureColumn], corner: String) -> Option<Pivot> {
    let row = |(row, cases): (Vec<usize>, Vec<Option<&crate::results::Case>>)| {
        let case = cases.first().copied().flatten();
        let cell =
            |measure: &&MeasureColumn| case.map_or(Cell::Empty, |case| case.cell(&measure.column));
        let cells: Vec<Cell> = measures.iter().map(cell).collect();
        let is_best = vec![false; cells.len()];
        PivotRow { label: results.row_label(&row), cells, is_best }
    };
    let rows: Vec<PivotRow> = results.rows().into_iter().map(row).collect();
    let columns = measures.iter().map(|measure| measure.title.clone()).collect();
    let title = "All measures".to_owned();
    let table = Pivot { title, better: None, corner, columns, rows, means: None, n_best: None };
    (!measures.is_empty()).then_some(table)
}

fn best_of(cells: &[Cell], better: Better) -> Vec<bool> {
    let numbers: Vec<Option<f64>> = cells.iter().map(Cell::number).collect();
    let all = || numbers.iter().flatten().copied();
    let best = match better {
        Better::Lower => all().reduce(f64::min),
        Better::Higher => all().reduce(f64::max),
    };
    let best = best.map(brief);
    let is_best = |number: &Option<f64>| number.map(brief) == best && best.is_some();
    let marked: Vec<bool> = numbers.iter().map(is_best).collect();
    // Where all are the same none is better.
    let n_marked = marked.iter().filter(|is| **is).count();
    if n_marked == all().count() { vec![false; cells.len()] } else { marked }
}

fn means(rows: &[PivotRow], n_columns: usize) -> Option<(Vec<f64>, usize)> {
    let numbers = |row: &PivotRow| row.cells.iter().map(Cell::number).collect::<Option<Vec<f64>>>();
    let complete: Vec<Vec<f64>> = rows.iter().filter_map(numbers).collect();
    if complete.len() < 2 || n_columns < 2 {
        return None;
    }
    let mean = |column: usize| {
        let values: Vec<f64> = complete.iter().map(|row| row[column]).collect();
        geometric_mean(&values).map(|estimate| estimate.ratio)
    };
    let means: Option<Vec<f64>> = (0..n_columns).map(mean).collect();
    means.map(|means| (means, complete.len()))
}

fn n_best(rows: &[PivotRow], n_columns: usize) -> Option<Vec<usize>> {
    let of_column = |column: usize| rows.iter().filter(|row| row.is_best[column]).count();
    let counts: Vec<usize> = (0..n_columns).map(of_column).collect();
    (n_columns > 1 && rows.len() > 1 && counts.iter().any(|n| *n > 0)).then_some(counts)
}

/// Which of the means is the best, to mark it.
fn best_mean(means: &[f64], better: Better) -> Vec<bool> {
    let cell = |mean: &f64| crate::stats::estimate(&[*mean]).map_or(Cell::Empty, Cell::Number);
    best_of(&means.iter().map(cell).collect::<Vec<_>>(), better)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_of_a_row_is_marked_with_its_equals() {
        let cell = |value: f64| crate::stats::estimate(&[value]).map_or(Cell::Empty, Cell::Number);
        let cells = [cell(0.123456), cell(0.123457), Cell::Empty, cell(0.2)];
        assert_eq!(best_of(&cells, Better::Lower), [true, true, false, false]);
        assert_eq!(best_of(&cells, Better::Higher), [false, false, false, true]);
        assert_eq!(best_of(&[cell(1.0), cell(1.0)], Better::Lower), [false, false]);
        assert_eq!(best_of(&[Cell::Empty], Better::Lower), [false]);
    }
}
