//! Tables of one measure: rows are what was treated, columns what it was treated with, the best of
//! each row marked where its results can be compared.

use mve_core::{Better, brief};

use crate::case::{Case, Cell, NumberForm};
use crate::columns::MeasureColumn;
use crate::results::Results;
use crate::stats::{estimate, geometric_mean};

/// A table of one measure, or, where nothing is compared, of all measures.
#[derive(Default)]
pub struct Pivot {
    /// The column that it shows; none where it shows several.
    pub column: Option<String>,
    /// What it measures.
    pub title: String,
    /// Which values are better.
    pub better: Better,
    /// Names of the axes that tell rows apart.
    pub row_axes: Vec<String>,
    /// Names of the axes that tell columns apart.
    pub column_axes: Vec<String>,
    /// Of each column its name on each of these axes.
    pub columns: Vec<Vec<String>>,
    /// How each column is measured: only those measured in one way are compared.
    ways: Vec<Vec<usize>>,
    /// The rows.
    pub rows: Vec<PivotRow>,
    /// Geometric means over the rows that are complete and can be compared, and of how many.
    pub means: Option<(Vec<f64>, usize)>,
    /// In how many rows each column is the best, alone or with others.
    pub n_best: Option<Vec<usize>>,
}

/// A row of a table.
#[derive(Clone)]
pub struct PivotRow {
    /// Its name on each axis that tells rows apart.
    pub names: Vec<String>,
    /// Its cells.
    pub cells: Vec<PivotCell>,
    /// Whether its results are of different sizes, so that none is the best.
    pub is_unequal: bool,
    /// Whether it counts rows, and is not of the measure.
    is_count: bool,
}

/// A cell of a table.
#[derive(Clone)]
pub struct PivotCell {
    /// What is in it.
    pub cell: Cell,
    /// Whether it is the best of its row, as far as its digits are shown.
    pub is_best: bool,
    /// The target that its step did not reach.
    pub missed: Option<String>,
}

/// The tables of all measures that are there.
pub fn pivots(results: &Results, measures: &[MeasureColumn]) -> Vec<Pivot> {
    let measures: Vec<&MeasureColumn> = measures.iter().filter(|m| m.is_there).collect();
    if !results.has_series() {
        return plain(results, &measures).into_iter().collect();
    }
    measures.iter().map(|measure| of_measure(results, measure)).collect()
}

fn row_axes(results: &Results) -> Vec<String> {
    results.row_axes().into_iter().map(|place| results.axes[place].title.clone()).collect()
}

/// How the column of each series is measured.
fn ways(results: &Results, measure: &MeasureColumn) -> Vec<Vec<usize>> {
    let axes = results.series_axes().iter();
    let instruments: Vec<bool> = axes.map(|axis| measure.is_made_by(results, axis)).collect();
    let way = |series: &Vec<usize>| {
        let set = series.iter().zip(&instruments).filter(|(_, is_instrument)| **is_instrument);
        set.map(|(place, _)| *place).collect()
    };
    results.series.iter().map(way).collect()
}

fn of_measure(results: &Results, measure: &MeasureColumn) -> Pivot {
    let mut ways = ways(results, measure);
    let row = |at: &[usize], cases: &[Option<&Case>]| {
        let is_unequal = !results.are_alike(cases);
        let cells: Vec<Cell> = cases
            .iter()
            .map(|case| case.map_or(Cell::Empty, |case| measure.cell(results, case)))
            .collect();
        let numbers = cases.iter().zip(&cells).map(|(case, cell)| {
            let is_compared = case.is_some_and(Case::is_comparable) && !is_unequal;
            cell.number().filter(|_| is_compared)
        });
        let is_best = best_of_ways(&numbers.collect::<Vec<_>>(), &ways, measure.better);
        let cells = cells.into_iter().zip(is_best).zip(cases).map(|((cell, is_best), case)| {
            let missed = case.and_then(Case::missed).filter(|_| cell != Cell::Empty);
            PivotCell { cell, is_best, missed }
        });
        PivotRow {
            names: results.row_names(at),
            cells: cells.collect(),
            is_unequal,
            is_count: false,
        }
    };
    let mut rows: Vec<PivotRow> = results.rows().iter().map(|(at, cases)| row(at, cases)).collect();
    let mut columns: Vec<Vec<String>> =
        results.series.iter().map(|series| results.series_names(series)).collect();
    // What holds something else with some series, or in some rows, says nothing there.
    let is_full = |column: usize| rows.iter().any(|row| row.cells[column].cell != Cell::Empty);
    let full: Vec<bool> = (0..columns.len()).map(is_full).collect();
    let mut kept = full.iter();
    columns.retain(|_| kept.next().copied().unwrap_or(false));
    let mut kept = full.iter();
    ways.retain(|_| kept.next().copied().unwrap_or(false));
    for row in &mut rows {
        let mut kept = full.iter();
        row.cells.retain(|_| kept.next().copied().unwrap_or(false));
    }
    if full.contains(&true) && full.contains(&false) {
        rows.retain(|row| row.cells.iter().any(|cell| cell.cell != Cell::Empty));
    }
    let (means, n_best) = match measure.better {
        Better::Neither => (None, None),
        _ => (means(&rows, columns.len()), n_best(&rows, columns.len())),
    };
    Pivot {
        column: Some(measure.column.clone()),
        title: measure.title_with_unit(),
        better: measure.better,
        row_axes: row_axes(results),
        column_axes: results.series_axes().iter().map(|axis| axis.title.clone()).collect(),
        columns,
        ways,
        rows,
        means,
        n_best,
    }
}

/// One table of all measures.
fn plain(results: &Results, measures: &[&MeasureColumn]) -> Option<Pivot> {
    let row = |(row, cases): (Vec<usize>, Vec<Option<&Case>>)| {
        let case = cases.first().copied().flatten();
        let cell = |measure: &&MeasureColumn| PivotCell {
            cell: case.map_or(Cell::Empty, |case| measure.cell(results, case)),
            is_best: false,
            missed: case.and_then(Case::missed),
        };
        let cells = measures.iter().map(cell).collect();
        PivotRow { names: results.row_names(&row), cells, is_unequal: false, is_count: false }
    };
    let table = Pivot {
        column: None,
        title: "All measures".to_owned(),
        better: Better::Neither,
        row_axes: row_axes(results),
        column_axes: Vec::new(),
        columns: measures.iter().map(|measure| vec![measure.title_with_unit()]).collect(),
        ways: Vec::new(),
        rows: results.rows().into_iter().map(row).collect(),
        means: None,
        n_best: None,
    };
    (!measures.is_empty()).then_some(table)
}

/// Which of the numbers are the best; none where all are the same, or no end is better.
pub fn best_of(numbers: &[Option<f64>], better: Better) -> Vec<bool> {
    let all = || numbers.iter().flatten().copied();
    let best = match better {
        Better::Lower => all().reduce(f64::min),
        Better::Higher => all().reduce(f64::max),
        Better::Neither => None,
    };
    let best = best.map(brief);
    let is_best = |number: &Option<f64>| number.map(brief) == best && best.is_some();
    let marked: Vec<bool> = numbers.iter().map(is_best).collect();
    let n_marked = marked.iter().filter(|is| **is).count();
    if n_marked == all().count() { vec![false; numbers.len()] } else { marked }
}

/// The same of each way to measure alone.
fn best_of_ways(numbers: &[Option<f64>], ways: &[Vec<usize>], better: Better) -> Vec<bool> {
    let marked = |(place, way): (usize, &Vec<usize>)| {
        let own = numbers.iter().zip(ways).map(|(number, other)| number.filter(|_| other == way));
        best_of(&own.collect::<Vec<_>>(), better)[place]
    };
    ways.iter().enumerate().map(marked).collect()
}

fn means(rows: &[PivotRow], n_columns: usize) -> Option<(Vec<f64>, usize)> {
    let numbers = |row: &PivotRow| row.compared().collect::<Option<Vec<f64>>>();
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
    let of_column = |column: usize| rows.iter().filter(|row| row.cells[column].is_best).count();
    let counts: Vec<usize> = (0..n_columns).map(of_column).collect();
    (n_columns > 1 && rows.len() > 1 && counts.iter().any(|n| *n > 0)).then_some(counts)
}

impl Pivot {
    /// The rows, and behind them what sums them up.
    pub fn with_means(&self) -> Vec<PivotRow> {
        let mut rows = self.rows.clone();
        let sum = |name: String, cells: Vec<PivotCell>, is_count: bool| {
            let mut names = vec![name];
            names.resize(self.row_axes.len().max(1), String::new());
            PivotRow { names, cells, is_unequal: false, is_count }
        };
        if let Some((means, n)) = &self.means {
            let of = match *n {
                n if n == self.rows.len() => String::new(),
                n if n == self.n_comparable() => format!(" of {n} comparable rows"),
                n => format!(" of {n} complete rows"),
            };
            let numbers: Vec<Option<f64>> = means.iter().copied().map(Some).collect();
            let cells = means.iter().zip(best_of_ways(&numbers, &self.ways, self.better));
            let cells = cells.map(|(mean, is_best)| PivotCell::of(*mean, is_best));
            rows.push(sum(format!("Geometric mean{of}"), cells.collect(), false));
        }
        if let Some(counts) = &self.n_best {
            let cells = counts.iter().map(|n| PivotCell::of(*n as f64, false)).collect();
            let n = self.n_comparable();
            let what = if n == self.rows.len() { "" } else { " comparable rows" };
            rows.push(sum(format!("Best in, of {n}{what}"), cells, true));
        }
        rows
    }

    /// How many rows have several numbers that can be compared: the others have no best.
    fn n_comparable(&self) -> usize {
        let is_comparable = |row: &&PivotRow| row.compared().flatten().count() > 1;
        self.rows.iter().filter(is_comparable).count()
    }

    /// How the numbers of each column are written: those of one measure in one way.
    pub fn forms(&self) -> Vec<NumberForm> {
        let rows = self.with_means();
        let rows = || rows.iter().filter(|row| !row.is_count);
        let of_column = |column: usize| NumberForm::of(rows().map(|row| &row.cells[column].cell));
        let of_all = || NumberForm::of(rows().flat_map(|row| &row.cells).map(|cell| &cell.cell));
        match self.column {
            None => (0..self.columns.len()).map(of_column).collect(),
            Some(_) => vec![of_all(); self.columns.len()],
        }
    }

    /// What stands over a table: the measure and its direction.
    pub fn caption(&self) -> String {
        match self.better {
            Better::Neither => self.title.clone(),
            Better::Lower => format!("{} (lower is better)", self.title),
            Better::Higher => format!("{} (higher is better)", self.title),
        }
    }

    /// What the marks in a table mean.
    pub fn marks(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if self.has_missed() {
            notes.push("† did not reach its target, and is not compared.".to_owned());
        }
        if self.better != Better::Neither && self.has_unequal_rows() {
            notes.push(
                "‡ the results differ in size by more than 1 %, so none is the best.".to_owned(),
            );
        }
        if self.better != Better::Neither && self.ways.iter().any(|way| *way != self.ways[0]) {
            notes.push("Columns that are measured in different ways are not compared.".to_owned());
        }
        notes
    }

    /// Whether the results of some row are of different sizes.
    pub fn has_unequal_rows(&self) -> bool {
        self.rows.iter().any(|row| row.is_unequal)
    }

    /// Whether some step did not reach its target.
    pub fn has_missed(&self) -> bool {
        self.rows.iter().flat_map(|row| &row.cells).any(|cell| cell.missed.is_some())
    }
}

impl PivotRow {
    /// The number of each cell that can be compared with others of the row.
    fn compared(&self) -> impl Iterator<Item = Option<f64>> {
        let is_compared = |cell: &PivotCell| !self.is_unequal && cell.missed.is_none();
        self.cells.iter().map(move |cell| cell.cell.number().filter(|_| is_compared(cell)))
    }

    /// Its cells for reading, by the forms of the table's columns.
    pub fn shown(&self, forms: &[NumberForm]) -> Vec<String> {
        let shown = |(cell, form): (&PivotCell, &NumberForm)| {
            cell.cell.shown(if self.is_count { NumberForm::Plain } else { *form })
        };
        self.cells.iter().zip(forms).map(shown).collect()
    }
}

impl PivotCell {
    fn of(number: f64, is_best: bool) -> Self {
        let cell = estimate(&[number]).map_or(Cell::Empty, Cell::Number);
        Self { cell, is_best, missed: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_of_a_row_is_marked_with_its_equals() {
        let row = [Some(0.123456), Some(0.123457), None, Some(0.2)];
        assert_eq!(best_of(&row, Better::Lower), [true, true, false, false]);
        assert_eq!(best_of(&row, Better::Higher), [false, false, false, true]);
        assert_eq!(best_of(&row, Better::Neither), [false; 4]);
        assert_eq!(best_of(&[Some(1.0), Some(1.0)], Better::Lower), [false, false]);
        assert_eq!(best_of(&[None], Better::Lower), [false]);
    }
}
