//! The lines of a plot: what is plotted against what unless a person says so, and which steps stand
//! on one line.

use std::collections::{HashMap, HashSet};
use std::ops::RangeInclusive;

use eframe::egui::Color32;

use crate::programs::results::sheet::{ColumnSource, Sheet, StepState};

/// Quotients of the largest and smallest number for which a logarithmic axis shows more. Beyond
/// them the smallest is a rounding error, which would take up most of the axis.
const WORTH_LOG: RangeInclusive<f64> = 20.0..=1e9;

/// Colors of lines that are told apart by eyes of all kinds (Okabe and Ito 2008), without the black
/// and the yellow, which one of the themes would hide.
const COLORS: [Color32; 7] = [
    Color32::from_rgb(86, 156, 214),
    Color32::from_rgb(230, 145, 40),
    Color32::from_rgb(0, 158, 115),
    Color32::from_rgb(204, 100, 150),
    Color32::from_rgb(213, 94, 0),
    Color32::from_rgb(140, 120, 200),
    Color32::from_rgb(130, 140, 150),
];

/// What is plotted: places of columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Choice {
    /// What goes to the right.
    pub x: usize,
    /// What goes up.
    pub y: usize,
    /// The parameter that gives the lines.
    pub series: Option<usize>,
}

/// A line, its points in the order of their x.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The value of the parameter that gives the lines.
    pub name: String,
    /// The same for all lines of one name.
    pub color: Color32,
    /// Its points.
    pub points: Vec<Spot>,
}

/// A step in the plot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Number that goes to the right.
    pub x: f64,
    /// Number that goes up.
    pub y: f64,
    /// Place of its row.
    pub row: usize,
}

/// The parameter that gives the lines: what the program says, else the last one that is no number,
/// else none.
pub fn default_series(sheet: &Sheet) -> Option<usize> {
    let program = sheet.program.as_ref()?;
    let said = program.report.series.last().and_then(|name| sheet.column(name));
    let is_name = |place: &usize| {
        let column = &sheet.columns[*place];
        matches!(column.source, ColumnSource::Param(_))
            && !column.is_number
            && n_values(sheet, *place) > 1
    };
    said.or_else(|| (0..sheet.columns.len()).rev().find(is_name))
}

/// What measures are plotted against: how many faces there are where the numbers say so, else a
/// number that is varied, else the time.
pub fn default_x(sheet: &Sheet, series: Option<usize>) -> Option<usize> {
    let is_free = |place: &usize| {
        Some(*place) != series && sheet.columns[*place].is_number && n_values(sheet, *place) > 1
    };
    let free: Vec<usize> = (0..sheet.columns.len()).filter(is_free).collect();
    let counts_faces = |place: &&usize| {
        let column = &sheet.columns[**place];
        matches!(&column.source, ColumnSource::Output(_, name) if name == "faces" || name == "n_faces")
    };
    let is_varied =
        |place: &&usize| matches!(sheet.columns[**place].source, ColumnSource::Param(_));
    let faces = free.iter().rev().find(counts_faces);
    faces.or_else(|| free.iter().find(is_varied)).copied().or_else(|| sheet.column("seconds"))
}

/// What is plotted: the first chief output, else the time.
pub fn default_y(sheet: &Sheet, x: usize) -> Option<usize> {
    let is_chief = |place: &usize| {
        let column = &sheet.columns[*place];
        let is_output = matches!(column.source, ColumnSource::Output(..));
        *place != x && is_output && column.is_number && column.is_chief
    };
    let is_free = |place: &usize| *place != x && sheet.columns[*place].is_number;
    let time = || sheet.column("seconds").filter(is_free);
    (0..sheet.columns.len()).find(is_chief).or_else(time)
}

fn n_values(sheet: &Sheet, column: usize) -> usize {
    let texts = sheet.rows.iter().map(|row| &row.cells[column].text);
    texts.filter(|text| !text.is_empty()).collect::<HashSet<_>>().len()
}

/// The lines of a plot. What is varied besides splits lines of one name, unless it changes along
/// with the number that moves along the line.
pub fn curves(sheet: &Sheet, choice: Choice) -> Vec<Curve> {
    let params: Vec<usize> = (0..sheet.columns.len())
        .filter(|place| matches!(sheet.columns[*place].source, ColumnSource::Param(_)))
        .collect();
    let along = match sheet.columns[choice.x].source {
        ColumnSource::Param(_) => Some(choice.x),
        _ => params
            .iter()
            .copied()
            .filter(|place| sheet.columns[*place].is_number && Some(*place) != choice.series)
            .max_by_key(|place| n_values(sheet, *place)),
    };
    let splits = |place: &usize| along.is_none_or(|along| !follows(sheet, along, *place));
    let splitting: Vec<usize> = params.into_iter().filter(splits).collect();
    let mut names: Vec<&str> = Vec::new();
    let mut found: HashMap<Vec<&str>, usize> = HashMap::new();
    let mut curves: Vec<Curve> = Vec::new();
    let ended = sheet.rows.iter().enumerate().filter(|(_, row)| row.state == StepState::Done);
    for (row, of_row) in ended {
        let text = |place: usize| of_row.cells[place].text.as_str();
        let (Some(x), Some(y)) = (sheet.number(row, choice.x), sheet.number(row, choice.y)) else {
            continue;
        };
        if !x.is_finite() || !y.is_finite() {
            continue;
        }
        let name = choice.series.map_or("", text);
        let nth = names.iter().position(|known| *known == name).unwrap_or_else(|| {
            names.push(name);
            names.len() - 1
        });
        let key: Vec<&str> = splitting.iter().map(|place| text(*place)).chain([name]).collect();
        let place = *found.entry(key).or_insert_with(|| {
            let color = COLORS[nth % COLORS.len()];
            curves.push(Curve { name: name.to_owned(), color, points: Vec::new() });
            curves.len() - 1
        });
        curves[place].points.push(Spot { x, y, row });
    }
    curves.iter_mut().for_each(|curve| curve.points.sort_by(|a, b| a.x.total_cmp(&b.x)));
    curves
}

/// Whether one column is known where another is: they are one, or advance together.
fn follows(sheet: &Sheet, leader: usize, follower: usize) -> bool {
    let mut known = HashMap::new();
    sheet.rows.iter().all(|row| {
        let (from, to) = (&row.cells[leader].text, &row.cells[follower].text);
        known.insert(from, to).is_none_or(|before| before == to)
    })
}

/// Whether a logarithmic axis shows more of these numbers.
pub fn is_wide(curves: &[Curve], of: fn(&Spot) -> f64) -> bool {
    let numbers = || curves.iter().flat_map(|curve| &curve.points).map(of);
    let (least, most) = (numbers().fold(f64::MAX, f64::min), numbers().fold(0.0, f64::max));
    least > 0.0 && WORTH_LOG.contains(&(most / least))
}

/// Whether all numbers are above 0.
pub fn can_be_log(curves: &[Curve], of: fn(&Spot) -> f64) -> bool {
    curves.iter().flat_map(|curve| &curve.points).all(|spot| of(spot) > 0.0)
}

/// What an axis must show besides its numbers, where they differ by no more than rounding: a plot
/// of nothing else would magnify that, or have no extent at all.
pub fn room(numbers: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let (from, to) = numbers.fold((f64::INFINITY, f64::NEG_INFINITY), |(from, to), number| {
        (from.min(number), to.max(number))
    });
    let size = from.abs().max(to.abs());
    let margin = if size == 0.0 { 1.0 } else { size * 1e-3 };
    (from <= to && to - from < size * 1e-6 + f64::MIN_POSITIVE)
        .then_some((from - margin, to + margin))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::programs::results::sheet::{SheetCell, SheetColumn, SheetRow, StepState};

    fn sheet(columns: &[(&str, ColumnSource)], rows: &[&[&str]]) -> Sheet {
        let cell = |text: &&str| SheetCell { text: (*text).to_owned(), number: text.parse().ok() };
        let rows: Vec<SheetRow> = (0..rows.len())
            .map(|place| {
                let cells = rows[place].iter().map(cell).collect();
                SheetRow { place, state: StepState::Done, is_comparable: true, cells }
            })
            .collect();
        let column = |(place, (name, source)): (usize, &(&str, ColumnSource))| SheetColumn {
            name: (*name).to_owned(),
            source: source.clone(),
            title: String::new(),
            is_chief: true,
            is_number: rows.iter().all(|row| row.cells[place].number.is_some()),
            better: None,
            best: None,
        };
        Sheet { program: None, columns: columns.iter().enumerate().map(column).collect(), rows }
    }

    fn param(name: &'static str) -> (&'static str, ColumnSource) {
        (name, ColumnSource::Param(name.to_owned()))
    }

    fn output(name: &'static str) -> (&'static str, ColumnSource) {
        let (node, output) = name.split_once('.').unwrap();
        (name, ColumnSource::Output(node.to_owned(), output.to_owned()))
    }

    #[test]
    fn a_line_for_each_value_and_each_other_axis() {
        let columns =
            [param("a.file"), param("b.n"), param("b.way"), output("c.faces"), output("c.rms")];
        let rows: [&[&str]; 6] = [
            &["p", "2", "A", "20", "1"],
            &["p", "1", "A", "10", "2"],
            &["p", "1", "B", "10", "3"],
            &["p", "2", "B", "20", "2"],
            &["q", "1", "A", "11", "5"],
            &["q", "2", "A", "21", "4"],
        ];
        let sheet = sheet(&columns, &rows);
        let choice = Choice { x: 3, y: 4, series: Some(2) };
        let found: Vec<_> = curves(&sheet, choice)
            .iter()
            .map(|curve| {
                (curve.name.clone(), curve.points.iter().map(|spot| spot.row).collect::<Vec<_>>())
            })
            .collect();
        let expected = [("A", vec![1, 0]), ("B", vec![2, 3]), ("A", vec![4, 5])];
        assert_eq!(found, expected.map(|(name, rows)| (name.to_owned(), rows)));
        assert_eq!(default_x(&sheet, Some(2)), Some(3));
        assert_eq!(default_y(&sheet, 3), Some(4));
    }

    #[test]
    fn parameters_that_advance_together_do_not_split_a_line() {
        let columns = [param("a.n"), param("b.m"), output("c.rms")];
        let rows: [&[&str]; 3] = [&["1", "10", "3"], &["2", "20", "2"], &["3", "30", "1"]];
        let sheet = sheet(&columns, &rows);
        assert_eq!(curves(&sheet, Choice { x: 0, y: 2, series: None }).len(), 1);
    }

    #[test]
    fn numbers_that_differ_by_rounding_get_room() {
        assert_eq!(room([0.0, 0.0].into_iter()), Some((-1.0, 1.0)));
        let (from, to) = room([2.0, 2.0 + 1e-12].into_iter()).unwrap();
        assert!(from < 1.999 && to > 2.001);
        assert_eq!(room([2.0, 2.1].into_iter()), None);
        assert_eq!(room(std::iter::empty()), None);
    }
}
