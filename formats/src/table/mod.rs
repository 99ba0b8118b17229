//! Tables as text: CSV in its many dialects, and JSON.

mod csv;
mod json;
mod write;

pub use csv::{CsvOptions, read_csv};
pub use json::read_json;
pub use write::{write_csv, write_json_columns, write_json_records};

use std::collections::HashSet;

use mve_core::Control;
use mve_mesh::data::Table;

use super::ReadError;

/// Reads a table of either format: JSON where the first sign is a bracket, else CSV. What was
/// mended comes with it, as sentences.
///
/// # Errors
/// What is wrong with it, with the line; when `control` says so.
pub fn read_table(
    bytes: &[u8],
    options: &CsvOptions,
    control: Control,
) -> Result<(Table, Vec<String>), ReadError> {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if text.starts_with(b"\xff\xfe") || text.starts_with(b"\xfe\xff") {
        let message = "it is text in UTF-16, as Excel's \"Unicode text\"; save it as UTF-8";
        return Err(ReadError::Wrong(message.to_owned()));
    }
    match text.trim_ascii_start().first() {
        None => Err(ReadError::Wrong("the file is empty".to_owned())),
        Some(b'{' | b'[') => Ok((read_json(text, control)?, Vec::new())),
        Some(_) => read_csv(text, options, control),
    }
}

/// Names of columns as a table needs them: none empty, no two the same. Says how many it changed.
fn distinct(names: &mut [String]) -> usize {
    let mut known = HashSet::new();
    let mut n_changed = 0;
    for (place, name) in names.iter_mut().enumerate() {
        let first = if name.is_empty() { format!("column_{}", place + 1) } else { name.clone() };
        let mut free = first.clone();
        let mut number = 2;
        while known.contains(&free) {
            free = format!("{first}_{number}");
            number += 1;
        }
        known.insert(free.clone());
        n_changed += usize::from(free != *name);
        *name = free;
    }
    n_changed
}

#[cfg(test)]
mod tests;
