//! Loads a table from a CSV or JSON file.
//!
//! Which of the two it is is seen from how the file begins, not from its name; see
//! [`mve_formats::table`] for the forms that are read.

use mve_formats::load_with;
use mve_formats::table::{CsvOptions, read_table};

use crate::prelude::*;

/// Two rows of a text and a number; `tests/contracts.rs` loads it, and damaged copies.
const EXAMPLE: &[u8] = b"mesh,faces\ncow,5804\n\"a, b\",NaN\n";

/// What stands between the cells of a line.
#[derive(Clone, Copy, Debug)]
enum Separator {
    Auto,
    Comma,
    Semicolon,
    Tab,
}

impl Enumeration for Separator {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Auto", "That of the three which the first line has most of."),
        ("Comma", "A comma."),
        ("Semicolon", "A semicolon."),
        ("Tab", "A tab."),
    ];
    const VALUES: &'static [Self] = &[Self::Auto, Self::Comma, Self::Semicolon, Self::Tab];
}

const PATH: Param<PathBuf> = Param::input_file(
    "path",
    "The file: CSV with a line of names first, or JSON, packed by gzip or not.",
    &["csv", "tsv", "json", "jsonl", "gz"],
)
.example(EXAMPLE);
const SEPARATOR: Param<Separator> =
    Param::one_of("separator", "What stands between the cells of a line of CSV.", "Auto");
const DECIMAL_COMMA: Param<bool> = Param::flag(
    "decimal_comma",
    "Whether numbers in CSV have a comma before their fraction.",
    false,
);
const TEXTS: Param<String> = Param::text(
    "texts",
    "Names of columns of CSV, with commas between them, that are texts even where all of their \
     cells look like numbers.",
    "",
);
const TABLE_OUT: Out<Table> = Out::new("table", "The table; numbers that are missing are not any.");

pub static MODULE: Module = Module {
    id: "TableLoader",
    summary: "Loads a table from a CSV or JSON file.",
    inputs: &[],
    outputs: &[TABLE_OUT.spec()],
    params: &[PATH.spec(), SEPARATOR.spec(), DECIMAL_COMMA.spec(), TEXTS.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let path = io.param(PATH)?;
    let separator = match io.param(SEPARATOR)? {
        Separator::Auto => None,
        Separator::Comma => Some(b','),
        Separator::Semicolon => Some(b';'),
        Separator::Tab => Some(b'\t'),
    };
    let names = io.param(TEXTS)?;
    let names = names.split(',').map(str::trim).filter(|name| !name.is_empty());
    let options = CsvOptions {
        separator,
        has_decimal_comma: io.param(DECIMAL_COMMA)?,
        text_columns: names.map(str::to_owned).collect(),
    };
    let (table, warnings) =
        load_with(&path, io.control(), |bytes, control| read_table(bytes, &options, control))?;
    for warning in warnings {
        io.warn(format!("{}: {warning}", path.display()));
    }
    for name in &options.text_columns {
        if table.column(name).is_none() {
            io.warn(format!("{}: there is no column \"{name}\"", path.display()));
        }
    }
    io.put(TABLE_OUT, table);
    Ok(())
}
