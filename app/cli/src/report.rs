//! `mve report`: what a program found, as a page or as tables.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use mve_core::{Map, Measure, ReportSpec, Store, did_you_mean};
use mve_report::rating::Ratings;
use mve_report::{Asked, Format, Report, ReportError};
use serde_json::Value as Json;

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
  mve report mve-out/vase-costs --map vase.json       with what the map says now
  mve report mve-out/vase-costs --format latex        tables to paste, best of each row bold
  mve report mve-out/vase-costs --format latex --measure compare.rms --columns simplify.cost
  mve report mve-out/vase-costs --format svg          plots, into mve-out/vase-costs/plots
  mve report mve-out/vase-costs --format csv --out costs.csv
  mve report mve-out/vase-costs --ratings anna.json,ben.json   with what people say

The page needs no network and no files beside it: answers to the program's questions, tables with \
the best of each row marked, plots with the Pareto front, the pictures that steps wrote, \
correlations of the measures, and how it was made. Only its links lead to the store.

Which values of a column are better, its title and its unit are declared by modules. What is \
shown, plotted and asked can be said in the map, as \"report\" of a program; `mve schema` has the \
form. Without it the report shows what modules declare as chief measures, and asks of each thing \
that is compared whether it does better than the default.

LaTeX is for pdfLaTeX; with signs that it does not set, such as Chinese ones, the first lines say \
that it takes XeLaTeX or LuaLaTeX.")]
pub struct Args {
    /// Folder of a program's results
    #[arg(value_name = "STORE", required_unless_present = "ratings")]
    store: Option<PathBuf>,
    /// File to write, of plots the folder; - is standard output [default: STORE/report.html,
    /// STORE/plots; tables go to standard output]
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Show what the program in this map says of its report now, not what it said when it ran
    #[arg(long, value_name = "FILE")]
    map: Option<PathBuf>,
    /// Column that measures, in place of those of the program; may be repeated
    #[arg(long, value_name = "COLUMN", value_delimiter = ',')]
    measure: Vec<String>,
    /// Varied parameters that give the rows of tables, and part plots
    #[arg(long, value_name = "PARAM", value_delimiter = ',')]
    rows: Vec<String>,
    /// Varied parameters that give the columns of tables, and the series of plots
    #[arg(long, value_name = "PARAM", value_delimiter = ',')]
    columns: Vec<String>,
    /// Files that people saved on the page of `mve rate`; any number of them
    ///
    /// Each person's marks are spread from 0 to 1. The report shows the mean of each result with
    /// its 95 % confidence interval, and how well each measure agrees with the means. Who gave
    /// every result the same mark is left out.
    #[arg(long, value_name = "FILE", num_args = 1.., value_delimiter = ',')]
    ratings: Vec<PathBuf>,
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
    /// The answers, and a table a measure, for the packages booktabs and multirow
    Latex,
    /// Each plot, standing alone
    Svg,
    /// The same as PDF, where mve was built with the feature "pdf"
    Pdf,
}

impl FormatName {
    /// What the report is written as; `None` of plots.
    fn format(self) -> Option<Format> {
        match self {
            Self::Html => Some(Format::Html),
            Self::Csv => Some(Format::Csv),
            Self::Markdown => Some(Format::Markdown),
            Self::Latex => Some(Format::Latex),
            Self::Svg | Self::Pdf => None,
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
            ReportError::Asked(_) => Self::refused(error.to_string()),
        }
    }
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Exit, Stop> {
    let (store, files) = store_of(args)?;
    check_asked(args, &store)?;
    let asked = Asked {
        report: args.map.as_deref().map(|map| report_in(map, &store)).transpose()?,
        measures: args.measure.clone(),
        rows: args.rows.clone(),
        columns: args.columns.clone(),
    };
    let mut report = Report::read_for(&store, &asked)?;
    if !files.is_empty() {
        report = report.with_ratings(&ratings(&files)?)?;
        if args.format == FormatName::Latex {
            out::tell("note: LaTeX has no table of ratings; take Markdown, CSV or the page");
        }
    }
    let Some(format) = args.format.format() else {
        return plots(args, &store, &report);
    };
    // Tables may be read by a program: what they lack is said beside them.
    if args.format != FormatName::Html {
        report.notes().iter().for_each(|note| out::tell(&format!("note: {note}")));
    }
    let page = (args.format == FormatName::Html).then(|| store.join(PAGE));
    let file = match &args.out {
        Some(path) if path == Path::new("-") => None,
        Some(path) => Some(path.clone()),
        None => page,
    };
    let Some(path) = file else { return out::print(&report.text(format, None)) };
    write(&report, format, &path)?;
    let mut text = answers(&report);
    text.push_str(&format!("report   {}\n", path.display()));
    out::print(&text)
}

/// The store, and the files of ratings. A folder behind `--ratings` is the store, which that option
/// takes as well when it stands before it.
fn store_of(args: &Args) -> Result<(PathBuf, Vec<PathBuf>), Stop> {
    let mut files = args.ratings.clone();
    if let Some(store) = &args.store {
        return Ok((store.clone(), files));
    }
    let place = files.iter().position(|path| path.is_dir()).ok_or_else(|| {
        Stop::usage("name the folder of the results: mve report STORE --ratings FILE")
    })?;
    let store = files.remove(place);
    Ok((store, files))
}

/// Refuses what options name and the results do not have, by the names of the options.
fn check_asked(args: &Args, store: &Path) -> Result<(), Stop> {
    let names = || args.rows.iter().chain(&args.columns).chain(&args.measure);
    let Some(found) = Store::look(store).map_err(ReportError::from)? else { return Ok(()) };
    if names().next().is_none() {
        return Ok(());
    }
    let plan = found.plan().map_err(ReportError::from)?;
    let (none, one) = (ReportSpec::default, |path: &String| vec![path.clone()]);
    let rows = args.rows.iter().map(|path| ReportSpec { group: one(path), ..none() });
    let columns = args.columns.iter().map(|path| ReportSpec { series: one(path), ..none() });
    let measures = args.measure.iter();
    let measures =
        measures.map(|column| ReportSpec { measures: vec![Measure::new(column)], ..none() });
    let faults = rows.chain(columns).chain(measures).flat_map(|spec| plan.faults(&spec));
    let options = [
        ("\"report.group\"", "--rows"),
        ("\"report.series\"", "--columns"),
        ("\"report.measures[0].column\"", "--measure"),
    ];
    let in_words = |fault: String| {
        let named = options
            .iter()
            .find_map(|(place, option)| Some(format!("{option}{}", fault.strip_prefix(place)?)));
        named.unwrap_or(fault)
    };
    let faults: Vec<String> = faults.map(|fault| in_words(fault.to_string())).collect();
    if faults.is_empty() { Ok(()) } else { Err(Stop::refused(faults.join("\n"))) }
}

/// Most bytes of a file of ratings.
const LARGEST_RATINGS: u64 = 16 << 20;

/// Reads files of ratings; every fault is told.
fn ratings(files: &[PathBuf]) -> Result<Vec<Ratings>, Stop> {
    let mut all = Vec::new();
    let mut faults = Vec::new();
    for path in files {
        let about = std::fs::metadata(path).map_err(|error| Stop::file(path, &error))?;
        if about.len() > LARGEST_RATINGS {
            faults.push(format!("{}: is too large for a file of ratings", path.display()));
            continue;
        }
        let bytes = std::fs::read(path).map_err(|error| Stop::file(path, &error))?;
        let text = String::from_utf8_lossy(&bytes);
        match Ratings::parse(&path.display().to_string(), &text) {
            Ok(ratings) => all.push(ratings),
            Err(fault) => faults.push(fault),
        }
    }
    if faults.is_empty() { Ok(all) } else { Err(Stop::refused(faults.join("\n"))) }
}

/// What the program of a store says of its report in a map.
fn report_in(map: &Path, store: &Path) -> Result<Json, Stop> {
    let missing = || ReportError::Missing(store.to_owned());
    let found = Store::look(store).map_err(ReportError::from)?.ok_or_else(missing)?;
    let name = found.plan().map_err(ReportError::from)?.program;
    let text = std::fs::read_to_string(map).map_err(|error| Stop::file(map, &error))?;
    let read = Map::parse(&text);
    let map = map.display();
    let read = read.map_err(|error| Stop::refused(format!("{map}: {error}")))?;
    let names = read.programs.keys().map(String::as_str);
    let spec = read.programs.get(&name).ok_or_else(|| {
        let hint = did_you_mean(&name, names);
        Stop::refused(format!(
            "{map}: there is no program \"{name}\", of which this is a store{hint}"
        ))
    })?;
    Ok(spec.report.clone().unwrap_or_else(|| serde_json::json!({})))
}

/// Writes each plot into a file of its own.
fn plots(args: &Args, store: &Path, report: &Report) -> Result<Exit, Stop> {
    if args.out.as_deref() == Some(Path::new("-")) {
        return Err(Stop::usage("plots are files of their own; name a folder for them"));
    }
    let folder = args.out.clone().unwrap_or_else(|| store.join("plots"));
    std::fs::create_dir_all(&folder).map_err(|error| Stop::file(&folder, &error))?;
    let mut text = String::new();
    for plot in report.plots() {
        let (drawn, ending) = match args.format {
            FormatName::Pdf => (plot.pdf(), "pdf"),
            _ => (plot.svg(), "svg"),
        };
        let path = folder.join(format!("{}.{ending}", plot.name()));
        let drawn = drawn.map_err(|why| Stop {
            exit: Exit::Failed,
            message: format!("{}: {why}", plot.name()),
        })?;
        out::write_file(&path, drawn)?;
        text.push_str(&format!("plot     {}\n", path.display()));
    }
    if text.is_empty() {
        text = "no plots: no measure differs over a size or a time\n".to_owned();
    }
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
    out::write_file(path, report.text(format, Some(folder)))
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
