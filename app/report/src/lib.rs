//! Reports of what a program found: one HTML page that opens anywhere, or tables for a paper.
//!
//! Everything is drawn from a store (`plan.json`, the records and the files of its steps); no
//! module is known here by name. What the columns mean, and what is asked of them, the program says
//! in its `report` ([`mve_core::ReportSpec`]).

mod answers;
mod axes;
mod case;
mod change;
mod columns;
mod html;
mod labels;
mod latex;
mod pairs;
mod pictures;
mod pivot;
mod plots;
mod questions;
pub mod rating;
mod results;
pub mod stats;
mod text;
mod words;

use std::fmt;
use std::path::{Path, PathBuf};

use columns::MeasureColumn;
use mve_core::{Measure, ReportFault, ReportSpec, StoreError};
use serde_json::Value as Json;

use rating::{People, Ratings};
use results::Results;

/// What a report is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// One page with everything.
    Html,
    /// All cases, all digits.
    Csv,
    /// The answers and a table a measure.
    Markdown,
    /// The answers and a table a measure, for the packages `booktabs` and `multirow`.
    Latex,
}

/// Why there is no report.
#[derive(Debug)]
pub enum ReportError {
    /// Nothing ran in this folder, or it is not there.
    Missing(PathBuf),
    /// The folder holds other things.
    NotAStore(PathBuf),
    /// The store cannot be read.
    Store(StoreError),
    /// What is asked for does not fit the results: each fault in a sentence.
    Asked(Vec<String>),
}

/// What a report shows in place of what its program says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Asked {
    /// The `report` of a map's program.
    pub report: Option<Json>,
    /// The columns that measure.
    pub measures: Vec<String>,
    /// Parameters whose axes give rows, and part plots.
    pub rows: Vec<String>,
    /// Parameters whose axes give columns, and series.
    pub columns: Vec<String>,
}

impl fmt::Display for ReportError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Missing(folder) => write!(
                f,
                "{}: no results of a program here; `mve program` makes such a folder",
                folder.display()
            ),
            Self::NotAStore(folder) => write!(
                f,
                "{}: not a store of mve; name the folder that `mve program` wrote, such as \
                 mve-out/MAP-PROGRAM",
                folder.display()
            ),
            Self::Store(error) => error.fmt(f),
            Self::Asked(faults) => f.write_str(&faults.join("\n")),
        }
    }
}

impl std::error::Error for ReportError {}

impl From<StoreError> for ReportError {
    fn from(error: StoreError) -> Self {
        match error {
            StoreError::NotAStore(folder) => Self::NotAStore(folder),
            other => Self::Store(other),
        }
    }
}

/// The results of a store, ready to be written down.
pub struct Report {
    results: Results,
    title: String,
    measures: Vec<MeasureColumn>,
    people: Option<People>,
}

impl Report {
    /// Reads a store.
    pub fn read(folder: &Path) -> Result<Self, ReportError> {
        Self::read_for(folder, &Asked::default())
    }

    /// Reads a store, to show what is asked.
    pub fn read_for(folder: &Path, asked: &Asked) -> Result<Self, ReportError> {
        let mut results = Results::read(folder)?;
        let spec = spec_of(&results, asked).map_err(ReportError::Asked)?;
        results.ask(spec);
        let title = results.plan.map["title"].as_str().map(str::trim).unwrap_or_default();
        let title = if title.is_empty() { &results.plan.program } else { title };
        let title = labels::shortened_to(title, 300);
        let measures = columns::measures(&results);
        Ok(Self { results, title, measures, people: None })
    }

    /// Adds what people said of the results.
    ///
    /// # Errors
    /// [`ReportError::Asked`] where marks are of results that the store does not have.
    pub fn with_ratings(mut self, ratings: &[Ratings]) -> Result<Self, ReportError> {
        self.people = Some(People::of(&self.results, ratings).map_err(ReportError::Asked)?);
        Ok(self)
    }

    /// The report as text. `folder` is where it will stand, so that links from it to the store
    /// lead there; the store itself if it is not known.
    pub fn text(&self, format: Format, folder: Option<&Path>) -> String {
        let (results, measures) = (&self.results, self.measures.as_slice());
        let tables = || pivot::pivots(results, measures);
        match format {
            Format::Csv => text::csv(results, measures, self.people.as_ref()),
            Format::Latex => latex::latex(&self.title, &self.notes(), &self.answers(), &tables()),
            Format::Markdown => {
                let mut text =
                    text::markdown(&self.title, &self.notes(), &self.answers(), &tables());
                if let Some(people) = &self.people {
                    let tables = rating::tables(people, results, measures);
                    text.push_str(&text::people(people, &tables));
                }
                text
            }
            Format::Html => {
                let store = folder.map_or(String::new(), |from| way(from, &results.folder));
                html::page(&html::Page {
                    results,
                    title: &self.title,
                    measures,
                    answers: &self.answers(),
                    tables: &tables(),
                    figures: &plots::figures(results, measures),
                    people: self.people.as_ref(),
                    pictures: &pictures::pictures(results),
                    store: &store,
                })
            }
        }
    }

    /// The plots, each standing alone, with a name for its file.
    pub fn plots(&self) -> Vec<Plot> {
        let (mut figures, _) = plots::figures(&self.results, &self.measures);
        if let Some(people) = &self.people {
            figures.extend(people.figures(&self.results, &self.measures));
        }
        figures.into_iter().map(|figure| Plot { figure }).collect()
    }

    /// The answers to the questions of the program, each in plain sentences.
    pub fn answers_in_words(&self) -> Vec<(String, Vec<String>)> {
        let answers = self.answers();
        answers.into_iter().map(|answer| (answer.text, answer.sentences)).collect()
    }

    /// What a reader must know first, in sentences: steps that are missing, those that did not
    /// reach their target, and that nothing differs.
    pub fn notes(&self) -> Vec<String> {
        let equal = columns::equal_in_words(&self.results, &self.measures);
        let notes = [self.results.missing_in_words(), self.results.missed_in_words(), equal];
        notes.into_iter().filter(|note| !note.is_empty()).collect()
    }

    fn answers(&self) -> Vec<answers::Answer> {
        let questions = questions::questions(&self.results, &self.measures);
        let answer = |q| answers::answer(&self.results, &self.measures, q);
        questions.iter().map(answer).collect()
    }
}

/// A plot of a report.
pub struct Plot {
    figure: plots::Figure,
}

impl Plot {
    /// A name for its file, without an ending.
    pub fn name(&self) -> String {
        self.figure.file_name()
    }

    /// The plot as SVG.
    pub fn svg(&self) -> Result<Vec<u8>, String> {
        plots::draw(&self.figure, false)
    }

    /// The plot as PDF.
    pub fn pdf(&self) -> Result<Vec<u8>, String> {
        plots::draw(&self.figure, true)
    }
}

/// What the report shows: what is asked, else what the store holds.
fn spec_of(results: &Results, asked: &Asked) -> Result<ReportSpec, Vec<String>> {
    let mut spec = match &asked.report {
        Some(json) => ReportSpec::parse(json).map_err(|faults| in_words(&faults))?,
        None => results.spec.clone(),
    };
    if !asked.measures.is_empty() {
        let known = std::mem::take(&mut spec.measures);
        spec.measures = asked
            .measures
            .iter()
            .map(|column| {
                let named = known.iter().find(|measure| measure.column == *column);
                named.cloned().unwrap_or_else(|| Measure::new(column))
            })
            .collect();
    }
    if !asked.rows.is_empty() {
        spec.group.clone_from(&asked.rows);
        spec.series.retain(|path| !asked.rows.contains(path));
    }
    if !asked.columns.is_empty() {
        spec.series.clone_from(&asked.columns);
        spec.group.retain(|path| !asked.columns.contains(path));
    }
    // An old store does not say which columns it has.
    let faults = match *asked == Asked::default() {
        true => Vec::new(),
        false => results.plan.faults(&spec),
    };
    if faults.is_empty() { Ok(spec) } else { Err(in_words(&faults)) }
}

fn in_words(faults: &[ReportFault]) -> Vec<String> {
    faults.iter().map(ReportFault::to_string).collect()
}

/// The way from one folder to another, with `/` at its end; empty if they are one, or not known.
fn way(from: &Path, to: &Path) -> String {
    let whole = |path: &Path| {
        let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
        path.canonicalize().ok()
    };
    let (Some(from), Some(to)) = (whole(from), whole(to)) else { return String::new() };
    let n_common = from.iter().zip(to.iter()).take_while(|(a, b)| a == b).count();
    let mut text = "../".repeat(from.iter().count() - n_common);
    for part in to.iter().skip(n_common) {
        text.push_str(&part.to_string_lossy());
        text.push('/');
    }
    text
}
