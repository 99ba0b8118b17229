//! Saves a table as a CSV or JSON file.

use mve_formats::save_atomic;
use mve_formats::table::{write_csv, write_json_columns, write_json_records};

use crate::prelude::*;

/// How JSON is laid out.
#[derive(Clone, Copy, Debug)]
enum JsonForm {
    Columns,
    Records,
}

impl Enumeration for JsonForm {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Columns", "Column by column, with titles and units: all of the table."),
        ("Records", "A list of objects, a row each, for other programs."),
    ];
    const VALUES: &'static [Self] = &[Self::Columns, Self::Records];
}

/// What stands between the cells of a line.
#[derive(Clone, Copy, Debug)]
enum CsvSeparator {
    Comma,
    Semicolon,
    Tab,
}

impl Enumeration for CsvSeparator {
    const NAMES: &'static [(&'static str, &'static str)] =
        &[("Comma", "A comma."), ("Semicolon", "A semicolon."), ("Tab", "A tab.")];
    const VALUES: &'static [Self] = &[Self::Comma, Self::Semicolon, Self::Tab];
}

const TABLE_IN: In<Table> = In::new("table", "Any table.");
const PATH: Param<PathBuf> = Param::output_file(
    "path",
    "The file; its ending says the format: CSV, CSV with tabs (tsv) or JSON.",
    &["csv", "tsv", "json"],
);
const SEPARATOR: Param<CsvSeparator> =
    Param::one_of("separator", "What stands between the cells of a line of CSV.", "Comma");
const UNITS: Param<bool> = Param::flag(
    "units",
    "Whether the name of a column in CSV says its unit, too: `length (mm)`.",
    false,
);
const JSON: Param<JsonForm> = Param::one_of("json", "How JSON is laid out.", "Columns");

pub static MODULE: Module = Module {
    id: "TableSaver",
    summary: "Saves a table as a CSV or JSON file, numbers with all their digits.",
    inputs: &[TABLE_IN.spec()],
    outputs: &[],
    params: &[PATH.spec(), SEPARATOR.spec(), UNITS.spec(), JSON.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let (table, path) = (io.get(TABLE_IN)?, io.param(PATH)?);
    let (has_units, form) = (io.param(UNITS)?, io.param(JSON)?);
    let separator = match io.param(SEPARATOR)? {
        CsvSeparator::Comma => b',',
        CsvSeparator::Semicolon => b';',
        CsvSeparator::Tab => b'\t',
    };
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    let control = io.control();
    Ok(save_atomic(&path, |out| match ending.as_deref() {
        Some("json") => match form {
            JsonForm::Columns => write_json_columns(&table, out, control),
            JsonForm::Records => write_json_records(&table, out, control),
        },
        Some("tsv") => write_csv(&table, b'\t', has_units, out, control),
        _ => write_csv(&table, separator, has_units, out, control),
    })?)
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;
    use mve_mesh::data::TableColumn;

    use crate::prelude::*;

    #[test]
    fn the_ending_says_the_format() {
        let folder = tempfile::tempdir().unwrap();
        let lengths = TableColumn::numbers("length", vec![0.5, 2.0]).in_unit("mm");
        let names = TableColumn::texts("name", vec!["a".to_owned(), "b".to_owned()]);
        let table = Table { columns: vec![lengths, names] };
        let save = |name: &str, set: &[(&str, &str)]| {
            let path = folder.path().join(name);
            let trial = Trial::of(&super::MODULE).input("table", table.clone());
            let trial = trial.set("path", path.to_str().unwrap()).set("units", true);
            let trial = set.iter().fold(trial, |trial, (name, value)| trial.set(name, *value));
            trial.run().unwrap();
            std::fs::read_to_string(path).unwrap()
        };
        assert_eq!(save("a.csv", &[]), "length (mm),name\n0.5,a\n2,b\n");
        assert_eq!(save("a.csv", &[("separator", "Semicolon")]), "length (mm);name\n0.5;a\n2;b\n");
        assert_eq!(save("a.TSV", &[]), "length (mm)\tname\n0.5\ta\n2\tb\n");
        let records = "[\n  {\"length\": 0.5, \"name\": \"a\"},\n  {\"length\": 2, \"name\": \
                       \"b\"}\n]\n";
        assert_eq!(save("a.json", &[("json", "Records")]), records);
        let columns = "{\"columns\": [\n  {\"name\": \"length\", \"title\": \"\", \"unit\": \
                       \"mm\", \"kind\": \"numbers\", \"values\": [0.5, 2]},\n  {\"name\": \
                       \"name\", \"title\": \"\", \"unit\": \"\", \"kind\": \"texts\", \
                       \"values\": [\"a\", \"b\"]}\n]}\n";
        assert_eq!(save("a.json", &[]), columns);
    }
}
