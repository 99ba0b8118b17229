//! Tables of one measure: rows are what was treated, columns what it was treated with, the best of
//! each row marked where its results can be compared.

use mve_core::{Better, brief};

use crate::case::{Case, Cell, NumberForm};
use crate::columns::MeasureColumn;
use crate::results::Results;
use crate::stats::{Estimate, estimate, geometric_mean};

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
    /// Geometric means over the rows that are complete and can be compared, each with what the
    /// intervals of its values make of it, and of how many rows.
    pub means: Option<(Vec<Estimate>, usize)>,
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
    /// Of each cell the number that can be compared with others of the row.
    compared: Vec<Option<Estimate>>,
    /// Whether its results are of different sizes, so that none is the best.
    pub is_unequal: bool,
    /// Whether the interval of what would be the best overlaps that of another, so that none is.
    is_unclear: bool,
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
            let case = case.filter(|case| case.is_comparable() && !is_unequal)?;
            let number = cell.estimate()?;
            let half_width = number.half_width.or_else(|| measure.spread(case));
            Some(Estimate { half_width, ..number })
        });
        let compared: Vec<Option<Estimate>> = numbers.collect();
        let best = Best::of_ways(&compared, &ways, measure.better);
        let is_best = best.places.into_iter();
        let cells = cells.into_iter().zip(is_best).zip(cases).map(|((cell, is_best), case)| {
            let missed = case.and_then(Case::missed).filter(|_| cell != Cell::Empty);
            PivotCell { cell, is_best, missed }
        });
        PivotRow {
            names: results.row_names(at),
            cells: cells.collect(),
            compared,
            is_unequal,
            is_unclear: best.is_unclear,
            is_count: false,
        }
    };
    let mut rows: Vec<PivotRow> = results.rows().iter().map(|(at, cases)| row(at, cases)).collect();
    let mut columns: Vec<Vec<String>> =
        results.series.iter().map(|series| results.series_names(series)).collect();
    drop_empty(&mut rows, &mut columns, &mut ways);
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

/// Leaves out columns and rows without a value: what holds something else with some series, or in
/// some rows, says nothing there.
fn drop_empty(
    rows: &mut Vec<PivotRow>,
    columns: &mut Vec<Vec<String>>,
    ways: &mut Vec<Vec<usize>>,
) {
    let is_full = |column: usize| rows.iter().any(|row| row.cells[column].cell != Cell::Empty);
    let full: Vec<bool> = (0..columns.len()).map(is_full).collect();
    keep(columns, &full);
    keep(ways, &full);
    for row in rows.iter_mut() {
        keep(&mut row.cells, &full);
        keep(&mut row.compared, &full);
    }
    if full.contains(&true) && full.contains(&false) {
        rows.retain(|row| row.cells.iter().any(|cell| cell.cell != Cell::Empty));
    }
}

/// Leaves the items at places that are kept.
fn keep<T>(items: &mut Vec<T>, is_kept: &[bool]) {
    let mut kept = is_kept.iter();
    items.retain(|_| kept.next().copied().unwrap_or(false));
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
        PivotRow::of(results.row_names(&row), cells)
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

/// Which numbers of a row are the best.
#[derive(Debug, Default, PartialEq)]
struct Best {
    /// For each number whether it is.
    places: Vec<bool>,
    /// Whether none is, as the interval of the best one overlaps that of another.
    is_unclear: bool,
}

impl Best {
    /// The best, alone or with its equals; none where all are the same, where no end is better, or
    /// where the intervals do not tell the best from the others.
    fn of(numbers: &[Option<Estimate>], better: Better) -> Self {
        let all = || numbers.iter().flatten().map(|number| number.mean);
        let best = match better {
            Better::Lower => all().reduce(f64::min),
            Better::Higher => all().reduce(f64::max),
            Better::Neither => None,
        };
        let best = best.map(brief);
        let is_best = |number: &Option<Estimate>| {
            best.is_some() && number.map(|number| brief(number.mean)) == best
        };
        let (first, others): (Vec<_>, Vec<_>) = numbers.iter().copied().partition(&is_best);
        let overlaps = |a: &Estimate, b: &Estimate| {
            let half = |number: &Estimate| number.half_width.unwrap_or(0.0);
            (a.mean - b.mean).abs() <= half(a) + half(b)
        };
        let mut others = others.iter().flatten();
        let is_other = |other: &Estimate| first.iter().flatten().any(|best| overlaps(best, other));
        let is_unclear = best.is_some() && others.any(is_other);
        let places: Vec<bool> =
            numbers.iter().map(|number| is_best(number) && !is_unclear).collect();
        let n_marked = places.iter().filter(|is| **is).count();
        match n_marked == all().count() {
            true => Self { places: vec![false; numbers.len()], is_unclear },
            false => Self { places, is_unclear },
        }
    }

    /// The same of each way to measure alone.
    fn of_ways(numbers: &[Option<Estimate>], ways: &[Vec<usize>], better: Better) -> Self {
        let mut all = Self::default();
        for (place, way) in ways.iter().enumerate() {
            let own =
                numbers.iter().zip(ways).map(|(number, other)| number.filter(|_| other == way));
            let best = Self::of(&own.collect::<Vec<_>>(), better);
            all.places.push(best.places[place]);
            all.is_unclear |= best.is_unclear;
        }
        all
    }
}

fn means(rows: &[PivotRow], n_columns: usize) -> Option<(Vec<Estimate>, usize)> {
    let numbers = |row: &PivotRow| row.compared.iter().copied().collect::<Option<Vec<_>>>();
    let complete: Vec<Vec<Estimate>> = rows.iter().filter_map(numbers).collect();
    if complete.len() < 2 || n_columns < 2 {
        return None;
    }
    let mean = |column: usize| mean_of(complete.iter().map(|row| row[column]));
    let means: Option<Vec<Estimate>> = (0..n_columns).map(mean).collect();
    means.map(|means| (means, complete.len()))
}

/// The geometric mean of means; its interval by the propagation of theirs, as errors of independent
/// logarithms, none where they have none.
fn mean_of(values: impl Iterator<Item = Estimate>) -> Option<Estimate> {
    let values: Vec<Estimate> = values.collect();
    let means: Vec<f64> = values.iter().map(|value| value.mean).collect();
    let mean = geometric_mean(&means)?.ratio;
    let shares = values.iter().map(|value| value.half_width.unwrap_or(0.0) / value.mean);
    let share = shares.map(|share| share * share).sum::<f64>().sqrt() / values.len() as f64;
    let half_width = values.iter().any(|value| value.half_width.is_some()).then_some(mean * share);
    Some(Estimate { n: values.len(), mean, half_width })
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
            PivotRow { is_count, ..PivotRow::of(names, cells) }
        };
        if let Some((means, n)) = &self.means {
            let of = match *n {
                n if n == self.rows.len() => String::new(),
                n if n == self.n_comparable() => format!(" of {n} comparable rows"),
                n => format!(" of {n} complete rows"),
            };
            let numbers: Vec<Option<Estimate>> = means.iter().copied().map(Some).collect();
            let best = Best::of_ways(&numbers, &self.ways, self.better);
            let cells = means.iter().zip(best.places);
            let cells = cells.map(|(mean, is_best)| PivotCell::of(mean.mean, is_best));
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
        let is_comparable = |row: &&PivotRow| row.compared.iter().flatten().count() > 1;
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
        if self.rows.iter().any(|row| row.is_unclear) {
            notes.push(
                "No value of a row is the best where the 95 % confidence interval of the best one \
                 overlaps that of another: such a difference may be chance."
                    .to_owned(),
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
    /// A row of these cells that sets nothing apart.
    fn of(names: Vec<String>, cells: Vec<PivotCell>) -> Self {
        let compared = Vec::new();
        Self { names, cells, compared, is_unequal: false, is_unclear: false, is_count: false }
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

    fn best_of(numbers: &[Option<f64>], better: Better) -> Vec<bool> {
        let numbers = numbers.iter().map(|number| number.and_then(|number| estimate(&[number])));
        Best::of(&numbers.collect::<Vec<_>>(), better).places
    }

    fn with_interval(mean: f64, half: f64) -> Option<Estimate> {
        Some(Estimate { n: 3, mean, half_width: Some(half) })
    }

    #[test]
    fn what_may_be_chance_is_not_the_best() {
        let noise = [with_interval(0.024, 0.036), with_interval(0.023, 0.053)];
        let best = Best::of(&noise, Better::Lower);
        assert_eq!((best.places, best.is_unclear), (vec![false; 2], true));
        let near = [with_interval(0.0158, 0.0056), with_interval(0.0191, 0.0045)];
        assert!(Best::of(&near, Better::Lower).is_unclear);
        // A single value may as well be one of those of the other.
        let single = [with_interval(1.0, 0.5), estimate(&[1.4]), with_interval(9.0, 0.1)];
        assert!(Best::of(&single, Better::Lower).is_unclear);
        let clear = [with_interval(1.0, 0.1), with_interval(2.0, 0.1), with_interval(2.1, 0.4)];
        let best = Best::of(&clear, Better::Lower);
        assert_eq!((best.places, best.is_unclear), (vec![true, false, false], false));
        // Of the worst ones which is the worst is of no interest.
        assert!(Best::of(&clear, Better::Higher).is_unclear);
    }

    #[test]
    fn a_mean_of_noise_is_noise() {
        // Relative errors of 0.3 and 0.4 of two factors: sqrt(0.09 + 0.16) / 2 = 0.25 of 2.
        let mean =
            mean_of([with_interval(1.0, 0.3), with_interval(4.0, 1.6)].into_iter().flatten());
        let mean = mean.unwrap();
        assert!((mean.mean - 2.0).abs() < 1e-12);
        assert!((mean.half_width.unwrap() - 0.5).abs() < 1e-12, "{mean:?}");
        assert_eq!(
            mean_of([1.0, 4.0].iter().filter_map(|v| estimate(&[*v]))).unwrap().half_width,
            None
        );
    }

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
