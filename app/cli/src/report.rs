//! `mve report`: what a program found, as a page or as tables.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use mve_report::{Format, Report, ReportError};

use crate::exit::{Exit, Stop};
use crate::out;
use crate::table::wrap;

/// The page's name in a store.
pub const PAGE: &str = "report.html";

/// Write what a program found as one HTML page, or as tables for a paper
#[derive(clap::Args)]
#[command(after_help = "Examples:
  mve report mve-out/vase-costs                       writes mve-out/vase-costs/report.html
  mve report mve-out/vase-costs --out costs.html
  mve report mve-out/vase-costs --format latex        tables to paste, best of each row bold
  mve report mve-out/vase-costs --format csv --out costs.csv

The page needs no network and no files beside it: answers to the program's questions, tables with \
the best of each row marked, plots with the Pareto front, the pictures that steps wrote, \
correlations of the measures, and how it was made. Only its links lead to the store.

What the columns mean is said in the map, as \"report\" of a program: its measures and which way \
each is better, what they are plotted against, and questions that compare two values of a \
parameter; `mve schema` has the form. Without it the report chooses, and takes lower as better.")]
pub struct Args {
    /// Folder of a program's results
    #[arg(value_name = "STORE")]
    store: PathBuf,
    /// File to write [default: STORE/report.html; other formats go to standard output]
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// What to write
    #[arg(short, long, value_enum, default_value_t = FormatName::Html)]
    format: FormatName,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum FormatName {
    /// One page with everything
    Html,
    /// Every case with the chief columns, all digits
    Csv,
    /// The answers, and a table a measure
    Markdown,
    /// A table a measure, for the package booktabs
    Latex,
}

impl From<FormatName> for Format {
    fn from(kind: FormatName) -> Self {
        match kind {
            FormatName::Html => Self::Html,
            FormatName::Csv => Self::Csv,
            FormatName::Markdown => Self::Markdown,
            FormatName::Latex => Self::Latex,
        }
    }
}

impl From<ReportError> for Stop {
    fn from(error: ReportError) -> Self {
        match error {
            ReportError::Store(error) => error.into(),
            ReportError::Missing(_) | ReportError::NotAStore(_) => {
                Self { exit: Exit::Files, message: error.to_string() }
            }
        }
    }
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Exit, Stop> {
    let report = Report::read(&args.store)?;
    // Tables may be read by a program: what they lack is said beside them.
    if args.format != FormatName::Html && !report.missing().is_empty() {
        out::tell(&format!("note: {}", report.missing()));
    }
    let page = (args.format == FormatName::Html).then(|| args.store.join(PAGE));
    let Some(path) = args.out.clone().or(page) else {
        return out::print(&report.text(args.format.into(), None));
    };
    write(&report, args.format.into(), &path)?;
    let mut text = answers(&report);
    text.push_str(&format!("report   {}\n", path.display()));
    out::print(&text)
}

/// Writes the page of a store, as `mve program` does at its end.
pub fn write_page(store: &Path) -> Result<Report, Stop> {
    let report = Report::read(store)?;
    write(&report, Format::Html, &store.join(PAGE))?;
    Ok(report)
}

fn write(report: &Report, format: Format, path: &Path) -> Result<(), Stop> {
    let folder = path.parent().unwrap_or(Path::new(""));
    // The links of the page start from its folder.
    std::fs::create_dir_all(if folder.as_os_str().is_empty() { Path::new(".") } else { folder })
        .map_err(|error| Stop::file(folder, &error))?;
    out::write_file(path, &report.text(format, Some(folder)))
}

/// The answers to a program's questions, for a terminal.
pub fn answers(report: &Report) -> String {
    let mut text = String::new();
    for (question, sentences) in report.answers_in_words() {
        let lines = [question, sentences.join(" ")];
        for (place, line) in lines.iter().enumerate() {
            let indent = 2 * place;
            let plain: String =
                line.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
            let plain = wrap(&plain, out::width(), indent);
            text.push_str(&format!("{}{plain}\n", " ".repeat(indent)));
        }
        text.push('\n');
    }
    text
}
