//! Puts tables side by side: rows with the same key become one.
//!
//! Each table of the right input is joined in turn with what the ones before it gave, so that what
//! becomes of rows without a partner holds for each.

use std::collections::HashMap;

use mve_mesh::data::{ColumnValues, TableColumn};

use crate::prelude::*;

/// Rows of a result beyond which something is wrong: keys that many rows of both tables have.
const MOST_ROWS: usize = 20_000_000;

/// What becomes of rows without a partner.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Unmatched {
    Drop,
    KeepLeft,
    KeepBoth,
}

impl Enumeration for Unmatched {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Drop", "They are left out."),
        ("KeepLeft", "Those of the left table stay; what a right one would have is missing."),
        ("KeepBoth", "Those of all tables stay; those of a right one come last."),
    ];
    const VALUES: &'static [Self] = &[Self::Drop, Self::KeepLeft, Self::KeepBoth];
}

const LEFT_IN: In<Table> = In::new("left", "The table whose columns come first.");
const RIGHT_IN: ManyIn<Table> = ManyIn::new(
    "right",
    "The tables whose columns come after them, of any number of links, in the order of the links.",
);
const COLUMN: Param<String> = Param::text(
    "column",
    "Name of the column that all tables have, whose cells are the keys. Empty: row by row, of \
     tables of one length.",
    "",
);
const UNMATCHED: Param<Unmatched> =
    Param::one_of("unmatched", "What becomes of rows whose key another table lacks.", "KeepLeft");
const TABLE_OUT: Out<Table> = Out::new(
    "table",
    "Rows in the order of the left table; a column of a right one whose name is taken has a number \
     behind it.",
);

pub static MODULE: Module = Module {
    id: "Join",
    summary: "Puts any number of tables side by side, rows with the same key together.",
    inputs: &[LEFT_IN.spec(), RIGHT_IN.spec()],
    outputs: &[TABLE_OUT.spec()],
    params: &[COLUMN.spec(), UNMATCHED.spec()],
    run,
};

/// A row of each table, if there is one.
type RowPair = [Option<usize>; 2];

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let name = io.param(COLUMN)?;
    let rights = io.all(RIGHT_IN)?;
    let mut table = Table::clone(&*io.get(LEFT_IN)?);
    for (place, right) in rights.iter().enumerate() {
        let roles = match (place, rights.len()) {
            (_, 1) => ["the left table".to_owned(), "the right one".to_owned()],
            (0, _) => ["the left table".to_owned(), "the first right one".to_owned()],
            _ => ["what was joined before".to_owned(), format!("right table {}", place + 1)],
        };
        table = joined(io, [&table, right], &name, roles)?;
    }
    io.put(TABLE_OUT, table);
    Ok(())
}

/// The columns of two tables, whose roles are said in errors.
fn joined(
    io: &Io,
    [left, right]: [&Table; 2],
    name: &str,
    roles: [String; 2],
) -> Result<Table, ModuleError> {
    let pairs = if name.is_empty() {
        let (n, m) = (left.n_rows(), right.n_rows());
        if n != m {
            let [one, other] = roles;
            let message = format!(
                "{one} has {n} rows, {other} {m}; row by row they are to have as many, or name a \
                 column of keys that all have"
            );
            return Err(ModuleError::param(&COLUMN, message));
        }
        (0..n).map(|row| [Some(row), Some(row)]).collect()
    } else {
        let [one, other] = roles;
        pairs(io, keys(left, name, &one)?, keys(right, name, &other)?)?
    };
    let mut table = Table::default();
    for column in &left.columns {
        io.check()?;
        let values = match (column.name == name).then(|| right.column(name)).flatten() {
            // Rows of the right table alone have their keys from there.
            Some(other) => both(&column.values, &other.values, &pairs),
            None => column.values.pick(pairs.iter().map(|[row, _]| *row)),
        };
        table.columns.push(TableColumn { values, ..head(column) });
    }
    for column in right.columns.iter().filter(|column| column.name != name) {
        io.check()?;
        let values = column.values.pick(pairs.iter().map(|[_, row]| *row));
        let mut column = TableColumn { values, ..head(column) };
        let first = column.name.clone();
        let mut number = 2;
        while table.column(&column.name).is_some() {
            column.name = format!("{first}_{number}");
            number += 1;
        }
        table.columns.push(column);
    }
    Ok(table)
}

/// A column without its cells.
fn head(column: &TableColumn) -> TableColumn {
    let TableColumn { name, title, unit, .. } = column;
    let values = ColumnValues::Texts(Vec::new());
    TableColumn { name: name.clone(), title: title.clone(), unit: unit.clone(), values }
}

/// The key of each row as a text; `None` where it is missing. Numbers are their shortest texts, so
/// that a column of them fits one of texts.
fn keys(table: &Table, name: &str, role: &str) -> Result<Vec<Option<String>>, ModuleError> {
    let Some(column) = table.column(name) else {
        let names: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
        let message = format!("{role} has no column \"{name}\"; it has {}", names.join(", "));
        return Err(ModuleError::param(&COLUMN, message));
    };
    Ok(match &column.values {
        // Adding 0 makes both zeros one.
        ColumnValues::Numbers(numbers) => {
            numbers.iter().map(|x| (!x.is_nan()).then(|| (x + 0.0).to_string())).collect()
        }
        ColumnValues::Texts(texts) => {
            texts.iter().map(|text| (!text.is_empty()).then(|| text.clone())).collect()
        }
    })
}

/// The rows that belong together, in the order of the left table.
fn pairs(
    io: &Io,
    left: Vec<Option<String>>,
    right: Vec<Option<String>>,
) -> Result<Vec<RowPair>, ModuleError> {
    let unmatched = io.param(UNMATCHED)?;
    let mut rows_of: HashMap<&str, Vec<usize>> = HashMap::new();
    for (row, key) in right.iter().enumerate() {
        if let Some(key) = key {
            rows_of.entry(key).or_default().push(row);
        }
    }
    let mut is_taken = vec![false; right.len()];
    let mut pairs: Vec<RowPair> = Vec::new();
    for (row, key) in left.iter().enumerate() {
        io.control().item(row, left.len())?;
        let partners = key.as_deref().and_then(|key| rows_of.get(key));
        for &partner in partners.into_iter().flatten() {
            is_taken[partner] = true;
            pairs.push([Some(row), Some(partner)]);
        }
        if partners.is_none() && unmatched != Unmatched::Drop {
            pairs.push([Some(row), None]);
        }
        if pairs.len() > MOST_ROWS {
            let message = format!(
                "the result would have more than {MOST_ROWS} rows, since many rows of both tables \
                 have the same key; name a column whose cells differ"
            );
            return Err(ModuleError::param(&COLUMN, message));
        }
    }
    if unmatched == Unmatched::KeepBoth {
        let alone = is_taken.iter().enumerate().filter(|(_, is_taken)| !**is_taken);
        pairs.extend(alone.map(|(row, _)| [None, Some(row)]));
    }
    Ok(pairs)
}

/// Keys: from the left table where it has the row, else from the right one.
fn both(left: &ColumnValues, right: &ColumnValues, pairs: &[RowPair]) -> ColumnValues {
    if let (ColumnValues::Numbers(left), ColumnValues::Numbers(right)) = (left, right) {
        let number = |&[a, b]: &RowPair| match (a, b) {
            (Some(row), _) => left[row],
            (None, Some(row)) => right[row],
            (None, None) => f64::NAN,
        };
        return ColumnValues::Numbers(pairs.iter().map(number).collect());
    }
    let text = |&[a, b]: &RowPair| {
        let cell = a.map_or_else(|| b.and_then(|row| right.cell(row)), |row| left.cell(row));
        cell.map_or(String::new(), |cell| cell.to_string())
    };
    match (left, pairs.iter().all(|[row, _]| row.is_some())) {
        (ColumnValues::Numbers(_), true) => left.pick(pairs.iter().map(|[row, _]| *row)),
        _ => ColumnValues::Texts(pairs.iter().map(text).collect()),
    }
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;
    use mve_mesh::data::TableColumn;

    use crate::prelude::*;

    fn texts(name: &str, words: &[&str]) -> TableColumn {
        TableColumn::texts(name, words.iter().map(|word| (*word).to_owned()).collect())
    }

    fn joined(left: &Table, right: &Table, column: &str, unmatched: &str) -> Result<Table, String> {
        let trial = Trial::of(&super::MODULE).set("column", column).set("unmatched", unmatched);
        let outputs = trial.input("left", left.clone()).input("right", right.clone()).run();
        let outputs = outputs.map_err(|error| error.to_string())?;
        Ok((*outputs["table"].get::<Table>().unwrap()).clone())
    }

    /// The rows as texts; what is missing is empty.
    fn rows(table: &Table) -> Vec<String> {
        let cell = |column: &TableColumn, row| match column.values.cell(row).unwrap().to_string() {
            text if text == "NaN" => String::new(),
            text => text,
        };
        let row = |row| table.columns.iter().map(|column| cell(column, row)).collect::<Vec<_>>();
        (0..table.n_rows()).map(|at| row(at).join(" ")).collect()
    }

    #[test]
    fn rows_with_the_same_key_come_together() {
        let faces = TableColumn::numbers("faces", vec![12.0, 5804.0, 7.0, 9.0]);
        let left = Table { columns: vec![texts("mesh", &["cube", "cow", "", "cube"]), faces] };
        let rms = TableColumn::numbers("rms", vec![0.5, 0.25, 1.0, 2.0]).in_unit("mm");
        let more = texts("faces", &["x", "y", "z", "w"]);
        let right = Table { columns: vec![rms, texts("mesh", &["cow", "cube", "vase", ""]), more] };
        let table = joined(&left, &right, "mesh", "Drop").unwrap();
        assert_eq!(rows(&table), ["cube 12 0.25 y", "cow 5804 0.5 x", "cube 9 0.25 y"]);
        let names: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
        assert_eq!(names, ["mesh", "faces", "rms", "faces_2"]);
        assert_eq!(table.columns[2].unit, "mm");
        let table = joined(&left, &right, "mesh", "KeepLeft").unwrap();
        assert_eq!(rows(&table)[2], " 7  ");
        let table = joined(&left, &right, "mesh", "KeepBoth").unwrap();
        assert_eq!(rows(&table)[4..], ["vase  1 z", "  2 w"]);
    }

    #[test]
    fn numbers_are_keys_of_texts_and_rows_pair_by_their_place() {
        let left = Table { columns: vec![TableColumn::numbers("k", vec![1.0, 0.5, -0.0])] };
        let right =
            Table { columns: vec![texts("k", &["0.5", "0", "x"]), texts("v", &["a", "b", "c"])] };
        let table = joined(&left, &right, "k", "Drop").unwrap();
        assert_eq!(rows(&table), ["0.5 a", "-0 b"]);
        let table = joined(&left, &right, "k", "KeepBoth").unwrap();
        assert_eq!(rows(&table), ["1 ", "0.5 a", "-0 b", "x c"]);
        let table = joined(&left, &right, "", "Drop").unwrap();
        assert_eq!(rows(&table), ["1 0.5 a", "0.5 0 b", "-0 x c"]);
        assert_eq!(table.columns[1].name, "k_2");
    }

    /// A row of three tables, and of those that lack its key.
    #[test]
    fn as_many_tables_are_joined_as_are_linked() {
        let table = |keys: &[&str], values: &[f64]| {
            let values = TableColumn::numbers("v", values.to_vec());
            Table { columns: vec![texts("k", keys), values] }
        };
        let tables = [
            table(&["a", "b"], &[1.0, 2.0]),
            table(&["b", "a", "c"], &[20.0, 10.0, 30.0]),
            table(&["c", "b"], &[300.0, 200.0]),
        ];
        let join = |unmatched: &str| {
            let trial = Trial::of(&super::MODULE).set("column", "k").set("unmatched", unmatched);
            let trial = trial.input("left", tables[0].clone());
            let rights = tables[1..].iter();
            let trial = rights.fold(trial, |trial, table| trial.input("right", table.clone()));
            let outputs = trial.run().unwrap();
            let table = outputs["table"].get::<Table>().unwrap();
            let names: Vec<&str> = table.columns.iter().map(|c| c.name.as_str()).collect();
            assert_eq!(names, ["k", "v", "v_2", "v_3"]);
            rows(&table)
        };
        assert_eq!(join("Drop"), ["b 2 20 200"]);
        assert_eq!(join("KeepLeft"), ["a 1 10 ", "b 2 20 200"]);
        assert_eq!(join("KeepBoth"), ["a 1 10 ", "b 2 20 200", "c  30 300"]);
        let trial = Trial::of(&super::MODULE).input("left", tables[0].clone());
        let trial = trial.input("right", tables[2].clone()).input("right", tables[1].clone());
        let message = trial.run().unwrap_err().to_string();
        assert!(message.contains("joined before has 2 rows, right table 2 3;"), "{message}");
    }

    #[test]
    fn what_cannot_be_joined_is_said() {
        let one = Table { columns: vec![TableColumn::numbers("a", vec![1.0])] };
        let two = Table { columns: vec![TableColumn::numbers("b", vec![1.0, 2.0])] };
        let message = joined(&one, &two, "a", "Drop").unwrap_err();
        assert!(message.contains("the right one has no column \"a\"; it has b"), "{message}");
        let message = joined(&one, &two, "", "Drop").unwrap_err();
        assert!(message.contains("1 rows, the right one 2"), "{message}");
        let same = Table { columns: vec![TableColumn::numbers("a", vec![1.0; 5000])] };
        let message = joined(&same, &same, "a", "Drop").unwrap_err();
        assert!(message.contains("more than 20000000 rows"), "{message}");
    }
}
