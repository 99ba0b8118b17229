//! Puts two tables side by side: rows with the same key become one.

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
        ("KeepLeft", "Those of the left table stay; what the right one would have is missing."),
        ("KeepBoth", "Those of both tables stay; those of the right one come last."),
    ];
    const VALUES: &'static [Self] = &[Self::Drop, Self::KeepLeft, Self::KeepBoth];
}

const LEFT_IN: In<Table> = In::new("left", "The table whose columns come first.");
const RIGHT_IN: In<Table> = In::new("right", "The table whose columns come after them.");
const COLUMN: Param<String> = Param::text(
    "column",
    "Name of the column that both tables have, whose cells are the keys. Empty: row by row, of \
     tables of one length.",
    "",
);
const UNMATCHED: Param<Unmatched> =
    Param::one_of("unmatched", "What becomes of rows whose key the other table lacks.", "KeepLeft");
const TABLE_OUT: Out<Table> = Out::new(
    "table",
    "Rows in the order of the left table; a column of the right one whose name is taken has a \
     number behind it.",
);

pub static MODULE: Module = Module {
    id: "Join",
    summary: "Puts two tables side by side, rows with the same key together.",
    inputs: &[LEFT_IN.spec(), RIGHT_IN.spec()],
    outputs: &[TABLE_OUT.spec()],
    params: &[COLUMN.spec(), UNMATCHED.spec()],
    run,
};

/// A row of each table, if there is one.
type RowPair = [Option<usize>; 2];

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let (left, right) = (io.get(LEFT_IN)?, io.get(RIGHT_IN)?);
    let name = io.param(COLUMN)?;
    let pairs = if name.is_empty() {
        let (n, m) = (left.n_rows(), right.n_rows());
        if n != m {
            let message = format!(
                "the left table has {n} rows, the right one {m}; row by row they are to have as \
                 many, or name a column of keys that both have"
            );
            return Err(ModuleError::param(&COLUMN, message));
        }
        (0..n).map(|row| [Some(row), Some(row)]).collect()
    } else {
        pairs(io, keys(&left, &name)?, keys(&right, &name)?)?
    };
    let mut table = Table::default();
    for column in &left.columns {
        io.check()?;
        let values = match (column.name == name).then(|| right.column(&name)).flatten() {
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
    io.put(TABLE_OUT, table);
    Ok(())
}

/// A column without its cells.
fn head(column: &TableColumn) -> TableColumn {
    let TableColumn { name, title, unit, .. } = column;
    let values = ColumnValues::Texts(Vec::new());
    TableColumn { name: name.clone(), title: title.clone(), unit: unit.clone(), values }
}

/// The key of each row as a text; `None` where it is missing. Numbers are their shortest texts, so
/// that a column of them fits one of texts.
fn keys(table: &Table, name: &str) -> Result<Vec<Option<String>>, ModuleError> {
    let Some(column) = table.column(name) else {
        let names: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
        let message =
            format!("one of the tables has no column \"{name}\"; it has {}", names.join(", "));
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

    #[test]
    fn what_cannot_be_joined_is_said() {
        let one = Table { columns: vec![TableColumn::numbers("a", vec![1.0])] };
        let two = Table { columns: vec![TableColumn::numbers("b", vec![1.0, 2.0])] };
        let message = joined(&one, &two, "a", "Drop").unwrap_err();
        assert!(message.contains("no column \"a\"; it has b"), "{message}");
        let message = joined(&one, &two, "", "Drop").unwrap_err();
        assert!(message.contains("1 rows, the right one 2"), "{message}");
        let same = Table { columns: vec![TableColumn::numbers("a", vec![1.0; 5000])] };
        let message = joined(&same, &same, "a", "Drop").unwrap_err();
        assert!(message.contains("more than 20000000 rows"), "{message}");
    }
}
