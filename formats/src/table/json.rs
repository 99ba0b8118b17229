//! From the bytes of a JSON file to a table.
//!
//! Four forms are read: columns as mve writes them, which keep titles and units
//! (`{"columns": [{"name": "x", "kind": "numbers", "values": [1, 2]}]}`); lists by name
//! (`{"x": [1, 2]}`); a list of objects, a row each; and an object a line, such as `results.jsonl`
//! of a program. Objects in a row become columns of their own: `{"a": {"b": 1}}` is a column `a.b`.

use std::io::{self, Read};

use mve_core::{Cancelled, Control, Data, Scalar};
use mve_mesh::data::{Table, TableColumn};
use serde_json::{Deserializer, Map, Value as Json};

use super::distinct;
use crate::ReadError;

/// Reads a JSON file. O(bytes).
///
/// # Errors
/// Where it is no JSON, with the line, or none of the forms; when `control` says so.
pub fn read_json(bytes: &[u8], control: Control) -> Result<Table, ReadError> {
    let reader = Watched { bytes, n_bytes: bytes.len().max(1), control: control.part(0.0, 0.9) };
    let reader = io::BufReader::with_capacity(1 << 16, reader);
    let mut values = Vec::new();
    for value in Deserializer::from_reader(reader).into_iter::<Json>() {
        values.push(value.map_err(of_json)?);
    }
    control.at(0.95)?;
    let table = match values.as_mut_slice() {
        [Json::Array(rows)] => of_rows(std::mem::take(rows))?,
        [Json::Object(object)] => match object.remove("columns") {
            Some(Json::Array(columns)) => of_columns(columns)?,
            Some(other) => return Err(wrong_columns(&other)),
            None if object.values().any(Json::is_array) => of_lists(std::mem::take(object))?,
            None => of_rows(values)?,
        },
        _ => of_rows(values)?,
    };
    table.check().map_err(ReadError::Wrong)?;
    Ok(table)
}

/// A slice that looks whether the work was cancelled when it is read.
struct Watched<'a> {
    bytes: &'a [u8],
    n_bytes: usize,
    control: Control<'a>,
}

impl Read for Watched<'_> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let share = 1.0 - self.bytes.len() as f64 / self.n_bytes as f64;
        self.control.at(share).map_err(io::Error::other)?;
        self.bytes.read(out)
    }
}

fn of_json(error: serde_json::Error) -> ReadError {
    match error.is_io() {
        true => ReadError::Cancelled(Cancelled),
        false => ReadError::Wrong(format!("it is no JSON: {error}")),
    }
}

/// A list of objects, a row each.
fn of_rows(rows: Vec<Json>) -> Result<Table, ReadError> {
    let row = |(place, value): (usize, Json)| match value {
        Json::Object(object) => {
            let mut cells = Vec::new();
            flatten("", object, &mut cells);
            Ok(cells)
        }
        other => Err(ReadError::Wrong(format!(
            "row {place} is {}, but each row is to be an object, `{{\"name\": 1.5}}`",
            kind_of(&other)
        ))),
    };
    let rows: Vec<_> = rows.into_iter().enumerate().map(row).collect::<Result<_, _>>()?;
    let mut table = Table::of_rows(&rows);
    rename(&mut table);
    Ok(table)
}

/// The cells of an object, and of those in it under names behind a dot. What is null is no cell.
fn flatten(before: &str, object: Map<String, Json>, cells: &mut Vec<(String, Scalar)>) {
    for (name, value) in object {
        let name = if before.is_empty() { name } else { format!("{before}.{name}") };
        match value {
            // Rows know a column by its missing cells, too.
            Json::Null => cells.push((name, Scalar::Number(f64::NAN))),
            Json::Bool(flag) => cells.push((name, Scalar::Flag(flag))),
            Json::Number(number) => {
                cells.push((name, Scalar::Number(number.as_f64().unwrap_or(f64::NAN))));
            }
            Json::String(text) => cells.push((name, Scalar::Text(text))),
            Json::Object(object) => flatten(&name, object, cells),
            list @ Json::Array(_) => cells.push((name, Scalar::Text(list.to_string()))),
        }
    }
}

/// Lists by name, a column each.
fn of_lists(object: Map<String, Json>) -> Result<Table, ReadError> {
    let column = |(name, values): (String, Json)| match values {
        Json::Array(values) => Ok(column_of(name, values)),
        other => Err(ReadError::Wrong(format!(
            "\"{name}\" is {}, but beside lists each name is to have a list",
            kind_of(&other)
        ))),
    };
    let columns = object.into_iter().map(column).collect::<Result<_, _>>()?;
    let mut table = Table { columns };
    rename(&mut table);
    Ok(table)
}

fn wrong_columns(found: &Json) -> ReadError {
    ReadError::Wrong(format!(
        "\"columns\" is {}, but it is to be the list of columns",
        kind_of(found)
    ))
}

/// Columns as mve writes them.
fn of_columns(columns: Vec<Json>) -> Result<Table, ReadError> {
    let column = |(place, column): (usize, Json)| {
        let lacks = |what: &str| ReadError::Wrong(format!("column {place} has no {what}"));
        let Json::Object(mut column) = column else { return Err(lacks("name")) };
        let mut text = |key: &str| match column.remove(key) {
            Some(Json::String(text)) => Some(text),
            _ => None,
        };
        let (name, kind) = (text("name"), text("kind"));
        let (title, unit) = (text("title").unwrap_or_default(), text("unit").unwrap_or_default());
        let name = name.ok_or_else(|| lacks("name"))?;
        let Some(Json::Array(values)) = column.remove("values") else {
            return Err(lacks("list of values"));
        };
        let found = match kind.as_deref() {
            Some("numbers") => TableColumn::numbers(name, values.iter().map(number_in).collect()),
            Some("texts") => TableColumn::texts(name, values.into_iter().map(text_in).collect()),
            _ => column_of(name, values),
        };
        Ok(found.titled(title).in_unit(unit))
    };
    let columns = columns.into_iter().enumerate().map(column).collect::<Result<_, _>>()?;
    Ok(Table { columns })
}

/// A column of numbers, unless there is something else among the values.
fn column_of(name: String, values: Vec<Json>) -> TableColumn {
    match values.iter().all(|value| value.is_number() || value.is_null()) {
        true => TableColumn::numbers(name, values.iter().map(number_in).collect()),
        false => TableColumn::texts(name, values.into_iter().map(text_in).collect()),
    }
}

/// The number; infinite ones are words, since JSON has none.
fn number_in(value: &Json) -> f64 {
    match value {
        Json::Number(number) => number.as_f64().unwrap_or(f64::NAN),
        Json::String(text) => text.parse().unwrap_or(f64::NAN),
        _ => f64::NAN,
    }
}

fn text_in(value: Json) -> String {
    match value {
        Json::String(text) => text,
        Json::Null => String::new(),
        other => other.to_string(),
    }
}

fn rename(table: &mut Table) {
    let mut names: Vec<String> = table.columns.iter().map(|column| column.name.clone()).collect();
    distinct(&mut names);
    table.columns.iter_mut().zip(names).for_each(|(column, name)| column.name = name);
}

fn kind_of(value: &Json) -> &'static str {
    match value {
        Json::Null => "nothing",
        Json::Bool(_) => "true or false",
        Json::Number(_) => "a number",
        Json::String(_) => "a text",
        Json::Array(_) => "a list",
        Json::Object(_) => "an object",
    }
}
