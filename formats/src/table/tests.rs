//! Files of other programs, round trips, and files that are wrong.

use std::ops::ControlFlow;

use mve_mesh::data::{ColumnValues, TableColumn};

use super::*;

fn read(bytes: &[u8]) -> Result<(Table, Vec<String>), ReadError> {
    read_table(bytes, &CsvOptions::default(), Control::none())
}

fn table(bytes: &[u8]) -> Table {
    read(bytes).unwrap().0
}

fn numbers(table: &Table, name: &str) -> Vec<f64> {
    match &table.column(name).unwrap().values {
        ColumnValues::Numbers(numbers) => numbers.clone(),
        ColumnValues::Texts(texts) => panic!("{name}: {texts:?}"),
    }
}

fn texts(table: &Table, name: &str) -> Vec<String> {
    match &table.column(name).unwrap().values {
        ColumnValues::Texts(texts) => texts.clone(),
        ColumnValues::Numbers(numbers) => panic!("{name}: {numbers:?}"),
    }
}

fn strange() -> Table {
    let words = ["plain", "a, b", "\"quoted\"", "two\nlines", "", "ž ꟻ 😀"];
    let odd = vec![1.0, -0.0, 0.1 + 0.2, f64::NAN, f64::INFINITY, -1e-300];
    Table {
        columns: vec![
            TableColumn::texts("word", words.map(str::to_owned).to_vec()),
            TableColumn::numbers("x, y", odd).titled("Length").in_unit("mm"),
            TableColumn::texts("code", vec!["007".to_owned(); 6]),
        ],
    }
}

fn written(write: impl Fn(&mut dyn std::io::Write) -> std::io::Result<()>) -> Vec<u8> {
    let mut bytes = Vec::new();
    write(&mut bytes).unwrap();
    bytes
}

/// Equal but for what is not a number, which equals nothing.
fn assert_equal(a: &Table, b: &Table) {
    assert_eq!(format!("{a:?}"), format!("{b:?}"));
}

#[test]
fn json_keeps_all_of_a_table_and_csv_all_but_units() {
    let table = strange();
    let json = written(|out| write_json_columns(&table, out, Control::none()));
    assert_equal(&read(&json).unwrap().0, &table);
    let records = written(|out| write_json_records(&table, out, Control::none()));
    let back = read(&records).unwrap().0;
    assert_eq!(texts(&back, "word"), texts(&table, "word"));
    let options = CsvOptions { text_columns: vec!["code".to_owned()], ..CsvOptions::default() };
    for separator in [b',', b';', b'\t'] {
        let csv = written(|out| write_csv(&table, separator, false, out, Control::none()));
        let (back, warnings) = read_table(&csv, &options, Control::none()).unwrap();
        assert_eq!(warnings, [""; 0]);
        let mut expected = table.clone();
        expected.columns[1] = TableColumn::numbers("x, y", numbers(&table, "x, y"));
        assert_equal(&back, &expected);
        // Without being told, whole numbers are numbers.
        assert_eq!(
            numbers(
                &super::read_table(&csv, &CsvOptions::default(), Control::none()).unwrap().0,
                "code"
            ),
            [7.0; 6]
        );
    }
    let csv = written(|out| write_csv(&table, b',', true, out, Control::none()));
    assert!(csv.starts_with(b"word,\"x, y (mm)\",code\n"));
    for empty in [Table::default(), Table { columns: vec![TableColumn::numbers("x", vec![])] }] {
        let json = written(|out| write_json_columns(&empty, out, Control::none()));
        assert_equal(&self::table(&json), &empty);
    }
}

#[test]
fn csv_of_other_programs() {
    // R's write.csv, pandas' to_csv and a spreadsheet in a country of decimal commas.
    let of_r = table(b"\"\",\"mesh\",\"rms\"\n\"1\",\"cow\",1.5\n\"2\",\"cube\",NA\n");
    assert_eq!(numbers(&of_r, "column_1"), [1.0, 2.0]);
    assert_eq!(texts(&of_r, "mesh"), ["cow", "cube"]);
    assert!(numbers(&of_r, "rms")[1].is_nan());
    let of_pandas = table(b",a,a\r\n0,1e-3,x\r\n1,,\r\n");
    assert_eq!(numbers(&of_pandas, "a")[0], 0.001);
    assert_eq!(texts(&of_pandas, "a_2"), ["x", ""]);
    let options = CsvOptions { has_decimal_comma: true, ..CsvOptions::default() };
    let bytes = "\u{feff}délka;počet\n1,5;3\n-0,25;4\n".as_bytes();
    let (found, _) = read_table(bytes, &options, Control::none()).unwrap();
    assert_eq!(numbers(&found, "délka"), [1.5, -0.25]);
    assert_eq!(numbers(&found, "počet"), [3.0, 4.0]);
    // Latin-1 stays apart from what is UTF-8.
    assert_eq!(table(b"d\xe9lka\n1\n").columns.len(), 1);
    assert_eq!(table(b"x\n").n_rows(), 0);
}

#[test]
fn json_of_other_programs() {
    let records = table(br#"[{"a": 1, "b": {"c": "x"}}, {"a": null, "d": true}]"#);
    assert_eq!(numbers(&records, "a")[0], 1.0);
    assert_eq!(texts(&records, "b.c"), ["x", ""]);
    assert_eq!(texts(&records, "d"), ["", "true"]);
    let lines = table(b"{\"a\": 1}\n{\"a\": 2}\n");
    assert_eq!(numbers(&lines, "a"), [1.0, 2.0]);
    let lists = table(br#"{"a": [1, null], "b": ["x", 2]}"#);
    assert!(numbers(&lists, "a")[1].is_nan());
    assert_eq!(texts(&lists, "b"), ["x", "2"]);
}

#[test]
fn what_is_wrong_is_said_with_its_line() {
    let message = |bytes: &[u8]| read(bytes).unwrap_err().to_string();
    let found = message(b"a,b\n1,2\n\n3\n");
    assert!(found.starts_with("line 4 has 1 cells, but the first line names 2"), "{found}");
    assert_eq!(message(b" \n"), "the file is empty");
    assert!(message(b"\xff\xfea\0").contains("UTF-16"));
    assert!(message(b"{\"a\": [1,\n").contains("line 2"));
    assert!(message(b"[1]").contains("row 0 is a number"));
    assert!(message(br#"{"a": [1], "b": 2}"#).contains("\"b\" is a number"));
    assert!(message(br#"{"a": [1], "b": []}"#).contains("column \"b\" has 0 cells"));
    assert!(message(br#"{"columns": [{"name": "x"}]}"#).contains("no list of values"));
    let deep = "[".repeat(100_000);
    assert!(message(deep.as_bytes()).contains("recursion limit"));
}

#[test]
fn a_cancel_is_heard() {
    let stop = |_| ControlFlow::Break(());
    for bytes in [&b"a\n1\n"[..], b"[{}]"] {
        let stopped = read_table(bytes, &CsvOptions::default(), Control::new(&stop));
        assert!(matches!(stopped, Err(ReadError::Cancelled(_))));
    }
}
