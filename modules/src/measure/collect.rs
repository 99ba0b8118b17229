//! Puts numbers of any number of links into one table.

use mve_core::{Scalar, Value};
use mve_mesh::data::Table;
use serde_json::Value as Json;

use crate::prelude::*;

const VALUES_IN: ManyAnyIn = ManyAnyIn::new(
    "values",
    "Numbers, texts, and rows of measures, in the order of the links. What fits no cell of a table \
     is told in its line of summary.",
);
const NAMES: Param<String> = Param::text(
    "names",
    "Names of the columns, separated by commas: so many values make a row. Empty: each value is a \
     row of its own.",
    "",
);
const ROWS: Param<String> = Param::text(
    "rows",
    "What stands before the values of each row, as JSON: a list of objects, such as \
     [{\"scan\": \"cow\"}, {\"scan\": \"bunny\"}]. Empty: nothing.",
    "",
);
const TABLE_OUT: Out<Table> = Out::new("table", "A row for each group of values.");

pub static MODULE: Module = Module {
    id: "Collect",
    summary: "Puts numbers of any number of links into one table.",
    inputs: &[VALUES_IN.spec()],
    outputs: &[TABLE_OUT.spec()],
    params: &[NAMES.spec(), ROWS.spec()],
    run,
};

type Cells = Vec<(String, Scalar)>;

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let (names, values) = (io.param(NAMES)?, io.all_any(VALUES_IN));
    let names: Vec<&str> =
        names.split(',').map(str::trim).filter(|name| !name.is_empty()).collect();
    let before = rows(&io.param(ROWS)?).map_err(|why| ModuleError::param(&ROWS, why))?;
    let mut before = before.into_iter();
    let mut table = Vec::new();
    for group in values.chunks(names.len().max(1)) {
        io.check()?;
        let mut row = before.next().unwrap_or_default();
        // A round of a loop that did not run is no row.
        if group.iter().all(Option::is_none) {
            continue;
        }
        for (place, value) in group.iter().enumerate() {
            let name = names.get(place).copied().unwrap_or("value");
            row.extend(value.iter().flat_map(|value| cells(name, value, names.len())));
        }
        table.push(row);
    }
    io.put(TABLE_OUT, Table::of_rows(&table));
    Ok(())
}

/// The cells of a value. Those of a row of measures have names of their own; where several values
/// stand in one row, they begin with that of the value.
fn cells(name: &str, value: &Value, n_names: usize) -> Cells {
    if let Some(scalar) = value.scalar() {
        return vec![(name.to_owned(), scalar)];
    }
    let cells = value.cells();
    match (cells.is_empty(), n_names > 1) {
        (true, _) => vec![(name.to_owned(), Scalar::Text(value.summary()))],
        (false, false) => cells,
        (false, true) => {
            cells.into_iter().map(|(cell, scalar)| (format!("{name}.{cell}"), scalar)).collect()
        }
    }
}

/// What stands before the values of each row.
fn rows(text: &str) -> Result<Vec<Cells>, String> {
    if text.trim().is_empty() {
        return Ok(Vec::new());
    }
    let rows: Vec<serde_json::Map<String, Json>> = serde_json::from_str(text)
        .map_err(|error| format!("is not a list of JSON objects: {error}"))?;
    let cell = |(name, value): (String, Json)| {
        let scalar = match value {
            Json::Number(number) => Scalar::Number(number.as_f64().unwrap_or(f64::NAN)),
            Json::Bool(flag) => Scalar::Flag(flag),
            Json::String(text) => Scalar::Text(text),
            other => Scalar::Text(other.to_string()),
        };
        (name, scalar)
    };
    Ok(rows.into_iter().map(|row| row.into_iter().map(cell).collect()).collect())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;
    use mve_mesh::data::{ColumnValues, Measure, Measures};

    use super::*;

    fn table(trial: Trial) -> Vec<(String, ColumnValues)> {
        let outputs = trial.run().unwrap();
        let table = outputs["table"].get::<Table>().unwrap();
        table.columns.iter().map(|column| (column.name.clone(), column.values.clone())).collect()
    }

    fn numbers(name: &str, numbers: &[f64]) -> (String, ColumnValues) {
        (name.to_owned(), ColumnValues::Numbers(numbers.to_vec()))
    }

    #[test]
    fn numbers_make_a_column_and_rows_of_measures_several() {
        let trial = Trial::of(&MODULE).input("values", 1.0).input("values", 2.5);
        assert_eq!(table(trial), [numbers("value", &[1.0, 2.5])]);
        let measures =
            |rms: f64| Measures(vec![Measure::of(&Quantity::new("rms", "An error."), rms)]);
        let trial = Trial::of(&MODULE)
            .set("names", "faces, error")
            .set("rows", r#"[{"scan": "cow"}, {"scan": "owl"}]"#);
        let trial = trial.input("values", 10.0).input("values", measures(0.5));
        let trial = trial.input("values", 20.0).input("values", measures(0.25));
        let scans = ColumnValues::Texts(vec!["cow".to_owned(), "owl".to_owned()]);
        let expected = [
            ("scan".to_owned(), scans),
            numbers("faces", &[10.0, 20.0]),
            numbers("error.rms", &[0.5, 0.25]),
        ];
        assert_eq!(table(trial), expected);
    }

    #[test]
    fn rows_that_are_no_json_are_told_of() {
        let error = Trial::of(&MODULE).input("values", 1.0).set("rows", "cow").run().unwrap_err();
        assert!(error.to_string().contains("is not a list of JSON objects"), "{error}");
    }
}
