//! From the bytes of a CSV file to a table.
//!
//! The first line names the columns. A column whose cells all read as numbers, but for those that
//! are missing, is one of numbers; any other is one of texts. The crate csv splits lines and
//! quotation marks (RFC 4180, with any kind of line end).

use csv::{ByteRecord, ReaderBuilder};
use mve_core::Control;
use mve_mesh::data::{ColumnValues, Table, TableColumn, name_from_bytes};

use super::distinct;
use crate::ReadError;

/// Lines between two looks whether the work was cancelled.
const LINES: u64 = 1 << 12;

/// The dialect of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CsvOptions {
    /// What stands between cells; `None`: the one of tab, semicolon and comma that the first line
    /// has most of.
    pub separator: Option<u8>,
    /// Whether numbers have a comma before their fraction.
    pub has_decimal_comma: bool,
    /// Names of columns that are texts even where all cells read as numbers.
    pub text_columns: Vec<String>,
}

/// Reads a CSV file. O(bytes), in two passes: what a column is, then its cells.
///
/// # Errors
/// A line with more or fewer cells than the first one; when `control` says so.
pub fn read_csv(
    bytes: &[u8],
    options: &CsvOptions,
    control: Control,
) -> Result<(Table, Vec<String>), ReadError> {
    let separator = options.separator.unwrap_or_else(|| separator_of(bytes));
    let (heads, n_rows) = heads(bytes, separator, options, control.part(0.0, 0.5))?;
    let mut names: Vec<String> = heads.iter().map(|head| head.name.clone()).collect();
    let mut warnings = Vec::new();
    let n_changed = distinct(&mut names);
    if n_changed > 0 {
        warnings.push(format!(
            "{n_changed} columns without a name, or with that of another one, have a new one"
        ));
    }
    let column = |(head, name): (&ColumnHead, String)| {
        let is_forced = options.text_columns.contains(&head.name);
        match head.has_number && !head.has_text && !is_forced {
            true => TableColumn::numbers(name, Vec::with_capacity(n_rows)),
            false => TableColumn::texts(name, Vec::with_capacity(n_rows)),
        }
    };
    let mut columns: Vec<TableColumn> = heads.iter().zip(names).map(column).collect();
    let mut is_first = true;
    each_record(bytes, separator, control.part(0.5, 1.0), |record, _| {
        if std::mem::take(&mut is_first) {
            return Ok(());
        }
        for (cell, column) in record.iter().zip(&mut columns) {
            match &mut column.values {
                ColumnValues::Texts(texts) => texts.push(name_from_bytes(cell)),
                ColumnValues::Numbers(numbers) => {
                    let number = match Cell::of(cell, options.has_decimal_comma) {
                        Cell::Number(number) => number,
                        Cell::Missing | Cell::Text => f64::NAN,
                    };
                    numbers.push(number);
                }
            }
        }
        Ok(())
    })?;
    Ok((Table { columns }, warnings))
}

/// The name of a column, as the file has it, and what its cells are.
struct ColumnHead {
    name: String,
    has_number: bool,
    has_text: bool,
}

/// Looks through the file: its columns, and how many rows there are.
fn heads(
    bytes: &[u8],
    separator: u8,
    options: &CsvOptions,
    control: Control,
) -> Result<(Vec<ColumnHead>, usize), ReadError> {
    let mut heads: Vec<ColumnHead> = Vec::new();
    let mut n_rows = 0;
    each_record(bytes, separator, control, |record, line| {
        if heads.is_empty() {
            let name = |cell: &[u8]| name_from_bytes(cell.trim_ascii());
            let head = |cell| ColumnHead { name: name(cell), has_number: false, has_text: false };
            heads = record.iter().map(head).collect();
            return Ok(());
        }
        if record.len() != heads.len() {
            return Err(ReadError::Wrong(format!(
                "line {line} has {} cells, but the first line names {} columns (cells are split at \
                 {})",
                record.len(),
                heads.len(),
                name_of(separator)
            )));
        }
        n_rows += 1;
        for (head, cell) in heads.iter_mut().zip(record.iter()) {
            match Cell::of(cell, options.has_decimal_comma) {
                Cell::Missing => {}
                Cell::Number(_) => head.has_number = true,
                Cell::Text => head.has_text = true,
            }
        }
        Ok(())
    })?;
    Ok((heads, n_rows))
}

/// What a cell holds.
enum Cell {
    Missing,
    Number(f64),
    Text,
}

impl Cell {
    fn of(bytes: &[u8], has_decimal_comma: bool) -> Self {
        /// What other programs write for what is missing, in lower case.
        const MISSING: [&[u8]; 5] = [b"", b"nan", b"na", b"n/a", b"null"];
        /// More signs have no number but those of zeros.
        const LONGEST: usize = 2048;
        let cell = bytes.trim_ascii();
        if cell.len() > LONGEST {
            return Self::Text;
        }
        if MISSING.iter().any(|word| cell.eq_ignore_ascii_case(word)) {
            return Self::Missing;
        }
        let Ok(text) = std::str::from_utf8(cell) else { return Self::Text };
        let parsed = match has_decimal_comma && text.contains(',') {
            true => text.replacen(',', ".", 1).parse(),
            false => text.parse(),
        };
        parsed.map_or(Self::Text, Self::Number)
    }
}

/// Calls `take` with every line that is not empty, and its number.
fn each_record(
    bytes: &[u8],
    separator: u8,
    control: Control,
    mut take: impl FnMut(&ByteRecord, u64) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    let mut builder = ReaderBuilder::new();
    builder.has_headers(false).flexible(true).delimiter(separator);
    let mut reader = builder.from_reader(bytes);
    let mut record = ByteRecord::new();
    let mut count = 0;
    loop {
        let is_there = reader.read_byte_record(&mut record);
        if !is_there.map_err(|error| ReadError::Wrong(error.to_string()))? {
            return Ok(());
        }
        if count % LINES == 0 {
            control.at(reader.position().byte() as f64 / bytes.len().max(1) as f64)?;
        }
        count += 1;
        let line = record.position().map_or(0, |start| {
            // A record begins with the empty lines before it.
            let rest = bytes.get(start.byte() as usize..).unwrap_or_default();
            let ends = rest.iter().take_while(|byte| matches!(byte, b'\r' | b'\n'));
            start.line() + ends.filter(|byte| **byte == b'\n').count() as u64
        });
        take(&record, line)?;
    }
}

/// The separator that the first line has most of, outside of quotation marks.
fn separator_of(bytes: &[u8]) -> u8 {
    const KNOWN: [u8; 3] = [b'\t', b';', b','];
    let mut counts = [0_usize; 3];
    let mut is_quoted = false;
    for &byte in bytes.iter().take(1 << 20) {
        match byte {
            b'"' => is_quoted = !is_quoted,
            b'\n' | b'\r' if !is_quoted => break,
            byte if !is_quoted => {
                let counted = counts.iter_mut().zip(KNOWN).filter(|(_, known)| *known == byte);
                counted.for_each(|(count, _)| *count += 1);
            }
            _ => {}
        }
    }
    // The last of several that are most: a comma where there is none of them.
    let most = counts.iter().zip(KNOWN).max_by_key(|(count, _)| **count);
    most.map_or(b',', |(_, separator)| separator)
}

fn name_of(separator: u8) -> String {
    match separator {
        b'\t' => "tabs".to_owned(),
        b';' => "semicolons".to_owned(),
        b',' => "commas".to_owned(),
        other => format!("`{}`", char::from(other)),
    }
}
