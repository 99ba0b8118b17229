//! From a table to the bytes of a CSV or JSON file. Numbers have all their digits.

use std::io::{self, Write};

use csv::WriterBuilder;
use mve_core::Control;

use mve_mesh::data::{ColumnValues, Table, TableColumn, name_to_bytes};

/// Cells between two looks whether the work was cancelled.
const PAUSE: usize = 1 << 15;

/// Writes a table as CSV: a line with the names of the columns, behind them in parentheses their
/// units if these are asked for, and a line a row. A number that is missing is `NaN`.
///
/// # Errors
/// Of the writer, and [`mve_core::Cancelled`] as one.
pub fn write_csv(
    table: &Table,
    separator: u8,
    has_units: bool,
    out: &mut dyn Write,
    control: Control,
) -> io::Result<()> {
    let mut writer = WriterBuilder::new().delimiter(separator).from_writer(out);
    let head = table.columns.iter().map(|column| match has_units && !column.unit.is_empty() {
        true => format!("{} ({})", column.name, column.unit),
        false => column.name.clone(),
    });
    let n_rows = table.n_rows();
    if !table.columns.is_empty() {
        writer.write_record(head.map(|name| name_to_bytes(&name).into_owned()))?;
    }
    let mut digits = zmij::Buffer::new();
    let pause = PAUSE / table.columns.len().clamp(1, PAUSE);
    for row in 0..n_rows {
        if row.is_multiple_of(pause) {
            control.at(row as f64 / n_rows as f64).map_err(io::Error::other)?;
        }
        for column in &table.columns {
            match &column.values {
                ColumnValues::Numbers(numbers) => {
                    writer.write_field(plain(digits.format(numbers[row])))?;
                }
                ColumnValues::Texts(texts) => writer.write_field(name_to_bytes(&texts[row]))?,
            }
        }
        writer.write_record(None::<&[u8]>)?;
    }
    writer.flush()
}

/// Whole numbers without a fraction of zero.
fn plain(digits: &str) -> &str {
    digits.strip_suffix(".0").unwrap_or(digits)
}

/// Writes a table as JSON that keeps all of it: `{"columns": […]}`, each with name, title, unit,
/// kind and values.
///
/// # Errors
/// As [`write_csv`].
pub fn write_json_columns(table: &Table, out: &mut dyn Write, control: Control) -> io::Result<()> {
    out.write_all(b"{\"columns\": [")?;
    for (place, column) in table.columns.iter().enumerate() {
        out.write_all(if place == 0 { b"\n  {" } else { b",\n  {" })?;
        for (key, text) in
            [("name", &column.name), ("title", &column.title), ("unit", &column.unit)]
        {
            write!(out, "\"{key}\": {}, ", quoted(text)?)?;
        }
        let kind = match &column.values {
            ColumnValues::Numbers(_) => "numbers",
            ColumnValues::Texts(_) => "texts",
        };
        write!(out, "\"kind\": \"{kind}\", \"values\": [")?;
        for row in 0..column.values.len() {
            if row.is_multiple_of(PAUSE) {
                control.at(0.0).map_err(io::Error::other)?;
            }
            out.write_all(if row == 0 { b"" } else { b", " })?;
            write_cell(column, row, out)?;
        }
        out.write_all(b"]}")?;
    }
    out.write_all(b"\n]}\n")
}

/// Writes a table as JSON for other programs: a list of objects, a row each. What is missing is
/// null.
///
/// # Errors
/// As [`write_csv`].
pub fn write_json_records(table: &Table, out: &mut dyn Write, control: Control) -> io::Result<()> {
    let names = table.columns.iter().map(|column| quoted(&column.name));
    let names = names.collect::<io::Result<Vec<_>>>()?;
    let n_rows = table.n_rows();
    out.write_all(b"[")?;
    let pause = PAUSE / table.columns.len().clamp(1, PAUSE);
    for row in 0..n_rows {
        if row.is_multiple_of(pause) {
            control.at(row as f64 / n_rows as f64).map_err(io::Error::other)?;
        }
        out.write_all(if row == 0 { b"\n  {" } else { b",\n  {" })?;
        for (place, (name, column)) in names.iter().zip(&table.columns).enumerate() {
            write!(out, "{}{name}: ", if place == 0 { "" } else { ", " })?;
            write_cell(column, row, out)?;
        }
        out.write_all(b"}")?;
    }
    out.write_all(b"\n]\n")
}

fn write_cell(column: &TableColumn, row: usize, out: &mut dyn Write) -> io::Result<()> {
    match &column.values {
        ColumnValues::Texts(texts) => write!(out, "{}", quoted(&texts[row])?),
        ColumnValues::Numbers(numbers) => match numbers[row] {
            number if number.is_nan() => out.write_all(b"null"),
            number if number.is_infinite() => {
                write!(out, "\"{}\"", if number > 0.0 { "inf" } else { "-inf" })
            }
            number => out.write_all(plain(zmij::Buffer::new().format(number)).as_bytes()),
        },
    }
}

fn quoted(text: &str) -> io::Result<String> {
    Ok(serde_json::to_string(text)?)
}
