//! Reports of what a program found: one HTML page that opens anywhere, or tables for a paper.
//!
//! Everything is drawn from a store (`plan.json`, the records and the files of its steps); no
//! module is known here by name. What the columns mean, and what is asked of them, the program says
//! in its `report` ([`mve_core::ReportSpec`]).

mod answers;
mod columns;
mod html;
mod labels;
mod pictures;
mod pivot;
mod plots;
mod results;
pub mod stats;
mod text;

use std::fmt;
use std::path::{Path, PathBuf};

use mve_core::StoreError;

use columns::MeasureColumn;
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
    /// A table a measure, for the package `booktabs`.
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
}

impl Report {
    /// Reads a store.
    pub fn read(folder: &Path) -> Result<Self, ReportError> {
        let results = Results::read(folder)?;
        let title = results.plan.map["title"].as_str().map(str::trim).unwrap_or_default();
        let title = if title.is_empty() { &results.plan.program } else { title };
        let title = labels::shortened_to(title, 300);
        let measures = columns::measures(&results);
        Ok(Self { results, title, measures })
    }

    /// The report as text. `folder` is where it will stand, so that links from it to the store
    /// lead there; the store itself if it is not known.
    pub fn text(&self, format: Format, folder: Option<&Path>) -> String {
        let (results, measures) = (&self.results, self.measures.as_slice());
        let tables = || pivot::pivots(results, measures);
        match format {
            Format::Csv => text::csv(results, measures),
            Format::Latex => text::latex(&self.title, &self.missing(), &tables()),
            Format::Markdown => {
                text::markdown(&self.title, &self.missing(), &self.answers(), &tables())
            }
            Format::Html => {
                let store = folder.map_or(String::new(), |from| way(from, &results.folder));
                let against = columns::against(results);
                html::page(&html::Page {
                    results,
                    title: &self.title,
                    measures,
                    answers: &self.answers(),
                    tables: &tables(),
                    charts: &plots::charts(results, measures, &against),
                    pictures: &pictures::pictures(results),
                    store: &store,
                })
            }
        }
    }

    /// The answers to the questions of the program, each in plain sentences.
    pub fn answers_in_words(&self) -> Vec<(String, Vec<String>)> {
        let answers = self.answers();
        answers.into_iter().map(|answer| (answer.text, answer.sentences)).collect()
    }

    /// In a sentence, which steps are missing; empty if none is.
    pub fn missing(&self) -> String {
        self.results.missing_in_words()
    }

    fn answers(&self) -> Vec<answers::Answer> {
        let questions = self.results.spec.questions.iter();
        questions.map(|q| answers::answer(&self.results, &self.measures, q)).collect()
    }
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
