//! The results of a program as a table: its columns, and a row a step, made from records.

use std::cmp::Ordering;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use indexmap::IndexSet;
use mve_core::{Better, Program, Role, Scalar, Step, StepRecord, StepStatus, brief, brief_value};
use serde_json::Value as Json;

use crate::views::ColumnFormat;

/// How many outputs of one node a person reads first.
const MOST_OF_A_NODE: usize = 4;

/// What a column shows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ColumnSource {
    /// Number of the repeat.
    Repeat,
    /// A parameter that is varied, by its path.
    Param(String),
    /// An output of a node.
    Output(String, String),
    /// Seconds of the step.
    Seconds,
    /// Seconds of a node, or of a part of its work.
    NodeSeconds(String, Option<String>),
    /// What became of the step.
    Status,
}

/// A column of the table.
#[derive(Clone, Debug)]
pub struct SheetColumn {
    /// Its name, as in `results.csv`.
    pub name: String,
    /// Its name for a person, with the unit, as the program's report or the module has it; empty
    /// where its own will do.
    pub title: String,
    /// What it shows.
    pub source: ColumnSource,
    /// Whether it is worth the room among the first columns.
    pub is_chief: bool,
    /// Whether its cells are numbers.
    pub is_number: bool,
    /// Which values are better, as the program's report or the module says.
    pub better: Option<Better>,
    /// The best of its numbers.
    pub best: Option<f64>,
}

impl SheetColumn {
    /// Its name as a person reads it: `cut: target faces`.
    pub fn shown(&self) -> String {
        let words = |name: &str| name.replace('_', " ");
        if !self.title.is_empty() {
            return match &self.source {
                ColumnSource::Output(node, _) => format!("{node}: {}", self.title),
                _ => self.title.clone(),
            };
        }
        match &self.source {
            ColumnSource::Param(path) => match path.split_once('.') {
                Some((node, param)) => format!("{node}: {}", words(param)),
                None => path.clone(),
            },
            ColumnSource::Output(node, output) => format!("{node}: {}", words(output)),
            ColumnSource::NodeSeconds(node, None) => format!("seconds of {node}"),
            ColumnSource::NodeSeconds(node, Some(phase)) => {
                format!("seconds of {node}, {}", words(phase))
            }
            ColumnSource::Seconds => "seconds of the step".to_owned(),
            ColumnSource::Repeat | ColumnSource::Status => self.name.clone(),
        }
    }
}

/// A cell: what is shown, and the number that it is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SheetCell {
    /// Its text; numbers are brief.
    pub text: String,
    /// Its number, to the last digit.
    pub number: Option<f64>,
}

/// What became of a step so far.
#[derive(Clone, Debug, PartialEq)]
pub enum StepState {
    /// It has not run.
    ToDo,
    /// It runs.
    Running,
    /// It is done.
    Done,
    /// It is not done, and why.
    Failed(String),
}

/// A step.
#[derive(Clone, Debug)]
pub struct SheetRow {
    /// Its place among the steps of the program.
    pub place: usize,
    /// What became of it.
    pub state: StepState,
    /// Whether it is done and reached its target, so that it can be the best.
    pub is_comparable: bool,
    /// A cell for each column.
    pub cells: Vec<SheetCell>,
}

/// The whole table.
#[derive(Clone, Default)]
pub struct Sheet {
    /// The program whose steps these are.
    pub program: Option<Arc<Program>>,
    /// Its columns.
    pub columns: Vec<SheetColumn>,
    /// A row for each step, in the order of the program. Of two steps with one id the first.
    pub rows: Vec<SheetRow>,
}

/// Records by the id of their step.
pub type Records = HashMap<String, Arc<StepRecord>>;

impl Sheet {
    /// The table of a program, from what is known of its steps.
    pub fn new(
        program: &Arc<Program>,
        records: &Records,
        is_running: impl Fn(usize) -> bool,
    ) -> Self {
        let mut seen = HashSet::new();
        let places = 0..program.steps.len();
        let steps: Vec<_> = places
            .filter(|place| seen.insert(&program.steps[*place].id))
            .map(|place| (place, records.get(&program.steps[place].id)))
            .collect();
        let found: Vec<&StepRecord> =
            steps.iter().filter_map(|(_, record)| record.map(Arc::as_ref)).collect();
        let mut columns = columns(program, &found);
        let mut rows: Vec<SheetRow> = steps
            .iter()
            .map(|(place, record)| {
                let step = &program.steps[*place];
                let state = state(record.map(|record| &record.status), is_running(*place));
                let cell = |column: &SheetColumn| {
                    cell(&column.source, step, record.map(Arc::as_ref), &state)
                };
                let reached = record.is_some_and(|record| record.missed().next().is_none());
                SheetRow {
                    place: *place,
                    is_comparable: reached && state == StepState::Done,
                    cells: columns.iter().map(cell).collect(),
                    state: state.clone(),
                }
            })
            .collect();
        weigh(program, &mut columns, &rows);
        write_alike(&columns, &mut rows);
        Self { program: Some(Arc::clone(program)), columns, rows }
    }

    /// The place of a column.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column.name == name)
    }

    /// The number in a cell.
    pub fn number(&self, row: usize, column: usize) -> Option<f64> {
        self.rows.get(row)?.cells.get(column)?.number
    }

    /// The step of a row.
    pub fn step(&self, row: usize) -> Option<&Step> {
        self.program.as_ref()?.steps.get(self.rows.get(row)?.place)
    }

    /// The order of rows by a column. Empty cells stand last either way, equal ones as they were.
    pub fn order(&self, column: usize, is_rising: bool) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.rows.len()).collect();
        let empty = SheetCell::default();
        let cell = |row: usize| self.rows[row].cells.get(column).unwrap_or(&empty);
        order.sort_by(|a, b| compare(cell(*a), cell(*b), is_rising));
        order
    }
}

/// The parameters of a step in a line.
pub fn label(step: &Step) -> String {
    let params = step.params.iter().map(|(path, value)| format!("{path} {}", brief_value(value)));
    let repeat = (step.repeat > 0).then(|| format!("repeat {}", step.repeat));
    let all: Vec<_> = params.chain(repeat).collect();
    if all.is_empty() { "the map as it is".to_owned() } else { all.join(", ") }
}

fn compare(a: &SheetCell, b: &SheetCell, is_rising: bool) -> Ordering {
    let turned = |order: Ordering| if is_rising { order } else { order.reverse() };
    match (a.number, b.number) {
        _ if a.text.is_empty() || b.text.is_empty() => a.text.is_empty().cmp(&b.text.is_empty()),
        (Some(a), Some(b)) => turned(a.total_cmp(&b)),
        (Some(_), None) => Ordering::Less,
        (None, Some(_)) => Ordering::Greater,
        (None, None) => turned(a.text.cmp(&b.text)),
    }
}

fn state(status: Option<&StepStatus>, is_running: bool) -> StepState {
    match status {
        Some(status) => match status.reason() {
            Some(reason) => StepState::Failed(reason.to_owned()),
            None => StepState::Done,
        },
        None if is_running => StepState::Running,
        None => StepState::ToDo,
    }
}

fn columns(program: &Program, records: &[&StepRecord]) -> Vec<SheetColumn> {
    let mut all = Vec::new();
    let mut add = |name: String, source: ColumnSource| {
        let (title, better) = declared(program, &name);
        let (is_chief, is_number, best) = (false, false, None);
        all.push(SheetColumn { name, title, source, is_chief, is_number, better, best });
    };
    if program.steps.iter().any(|step| step.repeat > 0) {
        add("repeat".to_owned(), ColumnSource::Repeat);
    }
    for path in &program.varied {
        add(path.clone(), ColumnSource::Param(path.clone()));
    }
    add("status".to_owned(), ColumnSource::Status);
    let mut outputs = IndexSet::new();
    let mut times = IndexSet::new();
    for (node, record) in records.iter().flat_map(|record| &record.nodes) {
        outputs.extend(record.scalars.keys().map(|output| (node, output)));
        times.insert((node, None));
        times.extend(record.phases.keys().map(|phase| (node, Some(phase))));
    }
    // What the program names stands first, then what modules declare as chief, then the outputs of
    // nodes that compare, which need more than one link; outputs of one node stand together, in the
    // order in which nodes run.
    let nodes: Vec<_> =
        times.iter().filter(|(_, phase)| phase.is_none()).map(|(node, _)| *node).collect();
    let rank = |node: &String| nodes.iter().position(|known| *known == node);
    let urgency = |name: &str| {
        let report = &program.report;
        let measures = report.measures.iter().map(|measure| measure.column.as_str());
        let mut said = measures.chain(report.against.iter().map(String::as_str));
        said.position(|said| said == name).unwrap_or(usize::MAX)
    };
    let links = &program.map().links;
    let compares = |node: &String| links.iter().filter(|link| link.to.node == *node).count() > 1;
    let key = |(node, output): (&String, &String)| {
        let name = format!("{node}.{output}");
        let is_chief = program.columns.role(&name) == Role::Chief;
        (urgency(&name), !is_chief, !compares(node), rank(node))
    };
    outputs.sort_by(|a, b| key(*a).cmp(&key(*b)));
    times.sort_by(|a, b| rank(a.0).cmp(&rank(b.0)));
    for (node, output) in outputs {
        let name = format!("{node}.{output}");
        if !program.varied.contains(&name) {
            add(name, ColumnSource::Output(node.clone(), output.clone()));
        }
    }
    add("seconds".to_owned(), ColumnSource::Seconds);
    for (node, phase) in times {
        let part = phase.map_or(String::new(), |phase| format!(".{phase}"));
        let source = ColumnSource::NodeSeconds(node.clone(), phase.cloned());
        add(format!("seconds.{node}{part}"), source);
    }
    all
}

fn cell(
    source: &ColumnSource,
    step: &Step,
    record: Option<&StepRecord>,
    state: &StepState,
) -> SheetCell {
    let seconds = |seconds: f64| SheetCell { text: format!("{seconds:.3}"), number: Some(seconds) };
    let of_node = |node: &String| record.and_then(|record| record.nodes.get(node));
    match source {
        ColumnSource::Repeat => number(f64::from(step.repeat)),
        ColumnSource::Param(path) => {
            step.params.get(path).map_or_else(SheetCell::default, param_cell)
        }
        ColumnSource::Output(node, output) => {
            let scalar = of_node(node).and_then(|node| node.scalars.get(output));
            scalar.map_or_else(SheetCell::default, scalar_cell)
        }
        ColumnSource::Seconds => {
            record.map_or_else(SheetCell::default, |record| seconds(record.seconds))
        }
        ColumnSource::NodeSeconds(node, phase) => {
            let found = of_node(node).and_then(|node| match phase {
                None => node.seconds,
                Some(phase) => node.phases.get(phase).copied(),
            });
            found.map_or_else(SheetCell::default, seconds)
        }
        ColumnSource::Status => {
            let text = match (state, record) {
                (StepState::Running, _) => "running".to_owned(),
                (_, None) => "to do".to_owned(),
                (_, Some(record)) => record.status.word().to_owned(),
            };
            SheetCell { text, number: None }
        }
    }
}

fn number(number: f64) -> SheetCell {
    match number.is_nan() {
        true => SheetCell::default(),
        false => SheetCell { text: brief(number), number: Some(number) },
    }
}

fn param_cell(value: &Json) -> SheetCell {
    match value.as_f64() {
        Some(exact) => number(exact),
        None => SheetCell { text: brief_value(value), number: None },
    }
}

fn scalar_cell(scalar: &Scalar) -> SheetCell {
    match scalar {
        Scalar::Number(value) => number(*value),
        other => SheetCell { text: other.to_string(), number: None },
    }
}

/// Writes the numbers of each output in one way, so that they can be compared at a glance.
fn write_alike(columns: &[SheetColumn], rows: &mut [SheetRow]) {
    for (place, column) in columns.iter().enumerate() {
        if !matches!(column.source, ColumnSource::Output(..)) {
            continue;
        }
        let numbers: Vec<f64> = rows.iter().filter_map(|row| row.cells[place].number).collect();
        let format = ColumnFormat::of(numbers.into_iter());
        for cell in rows.iter_mut().map(|row| &mut row.cells[place]) {
            if let Some(number) = cell.number {
                cell.text = format.text(number);
            }
        }
    }
}

/// Whether the results are of one size, so that the best of them says something.
fn are_alike(program: &Program, columns: &[SheetColumn], rows: &[SheetRow]) -> bool {
    let is_size = |column: &SheetColumn| program.columns.role(&column.name) == Role::Size;
    let sizes = columns.iter().enumerate().filter(|(_, column)| is_size(column));
    sizes.map(|(place, _)| place).all(|place| {
        let compared = rows.iter().filter(|row| row.is_comparable);
        mve_core::are_alike(compared.filter_map(|row| row.cells[place].number))
    })
}

/// Title with unit, and which values are better: what the program's report says, else what the
/// module declares. A column that holds different things in different steps has neither.
fn declared(program: &Program, name: &str) -> (String, Option<Better>) {
    let measure = program.report.measures.iter().find(|measure| measure.column == name);
    let known = program.columns.find(name);
    let known = if let [only] = known.as_slice() { Some(only) } else { None };
    let of_module = known.filter(|known| !known.title.is_empty()).map(|known| {
        let unit = if known.unit.is_empty() { String::new() } else { format!(" [{}]", known.unit) };
        format!("{}{unit}", known.title)
    });
    // Who names a measure says its unit as well, or wants none.
    let title = measure.map(|measure| measure.title.clone()).filter(|title| !title.is_empty());
    let better = program.better(name).or(known.map(|known| known.better));
    (title.or(of_module).unwrap_or_default(), better)
}

/// Whether the program's report names a column.
fn is_named(program: &Program, name: &str) -> bool {
    let measures = program.report.measures.iter().map(|measure| &measure.column);
    measures.chain(&program.report.against).any(|named| named == name)
}

/// Finds which columns hold numbers, which are worth the room, and the best of each: as the report
/// does, what the program names and what modules declare as chief or as a size; where they declare
/// nothing, a few columns of each node.
fn weigh(program: &Program, columns: &mut [SheetColumn], rows: &[SheetRow]) {
    let mut n_of_node: HashMap<String, usize> = HashMap::new();
    let cells = |place: usize| rows.iter().map(move |row| &row.cells[place]);
    let are_alike = are_alike(program, columns, rows);
    let role = |column: &SheetColumn| match column.source {
        ColumnSource::Output(..) => program.columns.role(&column.name),
        _ => Role::Detail,
    };
    let is_declared = columns.iter().any(|column| role(column) != Role::Detail);
    for (place, column) in columns.iter_mut().enumerate() {
        let full = || cells(place).filter(|cell| !cell.text.is_empty());
        let is_number = full().next().is_some() && full().all(|cell| cell.number.is_some());
        let differs = full().any(|cell| Some(cell) != full().next());
        let is_new = || (0..place).all(|other| cells(other).ne(cells(place)));
        let is_named = is_named(program, &column.name);
        let role = role(column);
        column.is_number = is_number;
        let compared = rows.iter().filter(|row| are_alike && row.is_comparable);
        let numbers = compared.filter_map(|row| row.cells[place].number);
        column.best = match column.better {
            Some(Better::Lower) => numbers.min_by(f64::total_cmp),
            Some(Better::Higher) => numbers.max_by(f64::total_cmp),
            Some(Better::Neither) | None => None,
        };
        column.is_chief = match &column.source {
            ColumnSource::Output(..) if is_named || is_declared => is_named || role != Role::Detail,
            ColumnSource::Output(node, _) => {
                let n = n_of_node.entry(node.clone()).or_default();
                let is_chief = *n < MOST_OF_A_NODE && (differs || rows.len() < 2) && is_new();
                *n += usize::from(is_chief);
                is_chief
            }
            ColumnSource::NodeSeconds(..) => is_named,
            _ => true,
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_cells_stand_last_whichever_way_rows_are_sorted() {
        let cell = |text: &str| SheetCell { text: text.to_owned(), number: text.parse().ok() };
        let texts = ["10", "", "9", "odd"];
        let rows = texts.iter().enumerate().map(|(place, text)| SheetRow {
            place,
            state: StepState::Done,
            is_comparable: true,
            cells: vec![cell(text)],
        });
        let sheet = Sheet { rows: rows.collect(), ..Sheet::default() };
        assert_eq!(sheet.order(0, true), [2, 0, 3, 1]);
        assert_eq!(sheet.order(0, false), [0, 2, 3, 1]);
    }

    #[test]
    fn columns_have_names_for_a_person() {
        let column = |title: &str, source: ColumnSource| {
            let (name, title, better, best) = ("raw.name".to_owned(), title.to_owned(), None, None);
            SheetColumn { name, title, source, is_chief: true, is_number: true, better, best }
        };
        let texts = |node: &str, part: &str| (node.to_owned(), part.to_owned());
        let (node, output) = texts("compare", "rms_relative");
        let output = ColumnSource::Output(node.clone(), output);
        let param = ColumnSource::Param("cut.cost.weight_of".to_owned());
        let phase = ColumnSource::NodeSeconds(node, Some("first_prices".to_owned()));
        for (column, shown) in [
            (column("RMS [%]", output.clone()), "compare: RMS [%]"),
            (column("", output), "compare: rms relative"),
            (column("", param), "cut: cost.weight of"),
            (column("", phase), "seconds of compare, first prices"),
            (column("Best", ColumnSource::Seconds), "Best"),
        ] {
            assert_eq!(column.shown(), shown);
        }
    }

    #[test]
    fn a_step_is_named_by_what_it_sets() {
        let params = [("a.way", Json::from("A")), ("b.n", Json::from(3))];
        let params = params.into_iter().map(|(path, value)| (path.to_owned(), value)).collect();
        let step = Step { id: String::new(), repeat: 2, params };
        assert_eq!(label(&step), "a.way A, b.n 3, repeat 2");
    }
}
