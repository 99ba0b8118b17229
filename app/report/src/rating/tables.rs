//! What people said, as tables: the mean marks, and how well measures agree with them.

use super::people::{Agreement, Correlation, People};
use crate::case::Case;
use crate::columns::MeasureColumn;
use crate::labels;
use crate::results::Results;
use crate::stats::Estimate;

/// A table of texts.
pub struct TextTable {
    /// What it shows.
    pub title: String,
    /// Names of the columns.
    pub header: Vec<String>,
    /// How many of the first columns are names.
    pub n_names: usize,
    /// The rows, as wide as the header.
    pub rows: Vec<Vec<String>>,
}

/// The mean marks and the agreements; tables without rows are left out.
pub fn tables(people: &People, results: &Results, measures: &[MeasureColumn]) -> Vec<TextTable> {
    let group = results.group_axis().map_or("row", |axis| axis.title.as_str());
    let agreements = agreements(&people.agreements(results, measures), group);
    let all = [marks(people, results), agreements];
    all.into_iter().filter(|table| !table.rows.is_empty()).collect()
}

/// A row for each row of the other tables, a column for each series.
fn marks(people: &People, results: &Results) -> TextTable {
    let axes = results.row_axes();
    let mut header: Vec<String> =
        axes.iter().map(|place| results.axes[*place].title.clone()).collect();
    let n_names = header.len();
    let series = results.series_labels();
    let unnamed = |label: String| if label.is_empty() { "mean mark".to_owned() } else { label };
    header.extend(series.into_iter().map(unnamed));
    let place_of = |case: &Case| results.cases.iter().position(|known| std::ptr::eq(known, case));
    let cell = |case: &Option<&Case>| {
        let mark = case.and_then(place_of).and_then(|place| people.mark(place));
        mark.map_or_else(String::new, in_words)
    };
    let row = |(row, cases): (Vec<usize>, Vec<Option<&Case>>)| {
        let names = results.row_names(&row).into_iter();
        names.chain(cases.iter().map(cell)).collect::<Vec<String>>()
    };
    let rows = results.rows().into_iter().map(row);
    let rows = rows.filter(|row| row[n_names..].iter().any(|cell| !cell.is_empty())).collect();
    let title = format!(
        "Mean mark, 0 like the original, 1 unlike, with its 95 % confidence interval; {}",
        match people.n_raters {
            1 => "1 person".to_owned(),
            n => format!("{n} people"),
        }
    );
    TextTable { title, header, n_names, rows }
}

/// A mean from 0 to 1 with the ends of its interval.
fn in_words(mark: Estimate) -> String {
    let span = People::span(&mark).map(|(low, high)| format!(" ({low:.2} to {high:.2})"));
    format!("{:.2}{}", mark.mean, span.unwrap_or_default())
}

/// A row a measure; `group` is what the first axis varies.
fn agreements(all: &[Agreement], group: &str) -> TextTable {
    let has = |of: fn(&Agreement) -> Correlation| all.iter().any(|one| of(one).spearman.is_some());
    let mut header = vec!["measure".to_owned()];
    let mut parts: Vec<fn(&Agreement) -> Correlation> = Vec::new();
    if has(|one| one.over_all) {
        header.extend(["Pearson", "Spearman", "results"].map(str::to_owned));
        parts.push(|one| one.over_all);
    }
    if has(|one| one.within) {
        let within = ["Pearson", "Spearman"].map(|name| format!("{name} within each {group}"));
        header.extend(within.into_iter().chain(["averaged over".to_owned()]));
        parts.push(|one| one.within);
    }
    let shown = |value: Option<f64>| value.map_or("–".to_owned(), |r| labels::rounded(r, 3));
    let cells = |Correlation { n, pearson, spearman }: Correlation| {
        [shown(pearson), shown(spearman), n.to_string()]
    };
    let row = |one: &Agreement| {
        let values = parts.iter().flat_map(|part| cells(part(one)));
        std::iter::once(one.title.clone()).chain(values).collect::<Vec<String>>()
    };
    let rows = if parts.is_empty() { Vec::new() } else { all.iter().map(row).collect() };
    let title = "How well measures agree with people: correlation with the mean marks, turned \
                 around where higher is better, so that 1 is full agreement"
        .to_owned();
    TextTable { title, header, n_names: 1, rows }
}
