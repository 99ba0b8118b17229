//! A table: columns of numbers or of texts, all of one length.

use std::collections::{HashMap, HashSet};

use mve_core::{Data, DataType, Quantity, Scalar};
use serde::{Deserialize, Serialize};

use super::TriMesh;

/// Columns under names that differ; row `i` is the `i`-th cell of each.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Table {
    /// From left to right; all of one length.
    pub columns: Vec<TableColumn>,
}

/// A column of a table: its name and what is in its cells.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TableColumn {
    /// By which maps and files know it, `max_relative`; not empty.
    pub name: String,
    /// Its name for a person; empty where the other one will do.
    pub title: String,
    /// Unit of its numbers: `model units`, or empty.
    pub unit: String,
    /// Its cells, from top to bottom.
    pub values: ColumnValues,
}

/// What is in the cells of a column.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ColumnValues {
    /// Numbers; what is missing is not a number.
    Numbers(Vec<f64>),
    /// Texts; what is missing is empty.
    Texts(Vec<String>),
}

impl ColumnValues {
    /// How many cells there are.
    pub fn len(&self) -> usize {
        match self {
            Self::Numbers(numbers) => numbers.len(),
            Self::Texts(texts) => texts.len(),
        }
    }

    /// Whether there is no cell.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A cell; `None` below the last one.
    pub fn cell(&self, row: usize) -> Option<Scalar> {
        match self {
            Self::Numbers(numbers) => numbers.get(row).map(|number| Scalar::Number(*number)),
            Self::Texts(texts) => texts.get(row).map(|text| Scalar::Text(text.clone())),
        }
    }

    /// The cells of some rows, in that order; what is missing where a row is not there.
    pub fn pick(&self, rows: impl IntoIterator<Item = Option<usize>>) -> Self {
        match self {
            Self::Numbers(numbers) => {
                let number = |row: Option<usize>| row.and_then(|row| numbers.get(row)).copied();
                Self::Numbers(rows.into_iter().map(|row| number(row).unwrap_or(f64::NAN)).collect())
            }
            Self::Texts(texts) => {
                let text = |row: Option<usize>| row.and_then(|row| texts.get(row)).cloned();
                Self::Texts(rows.into_iter().map(|row| text(row).unwrap_or_default()).collect())
            }
        }
    }

    fn byte_size(&self) -> usize {
        match self {
            Self::Numbers(numbers) => size_of_val(numbers.as_slice()),
            Self::Texts(texts) => {
                size_of_val(texts.as_slice()) + texts.iter().map(String::len).sum::<usize>()
            }
        }
    }
}

impl TableColumn {
    /// A column of numbers without unit.
    pub fn numbers(name: impl Into<String>, numbers: Vec<f64>) -> Self {
        Self::new(name.into(), ColumnValues::Numbers(numbers))
    }

    /// A column of texts.
    pub fn texts(name: impl Into<String>, texts: Vec<String>) -> Self {
        Self::new(name.into(), ColumnValues::Texts(texts))
    }

    /// A column of values of a declared quantity.
    pub fn of(quantity: &Quantity, numbers: Vec<f64>) -> Self {
        Self::numbers(quantity.name, numbers).titled(quantity.title).in_unit(quantity.unit.name())
    }

    fn new(name: String, values: ColumnValues) -> Self {
        Self { name, title: String::new(), unit: String::new(), values }
    }

    /// Names it for a person.
    pub fn titled(self, title: impl Into<String>) -> Self {
        Self { title: title.into(), ..self }
    }

    /// Says what its numbers are measured in.
    pub fn in_unit(self, unit: impl Into<String>) -> Self {
        Self { unit: unit.into(), ..self }
    }

    /// Its name for a person.
    pub fn shown_name(&self) -> &str {
        if self.title.is_empty() { &self.name } else { &self.title }
    }
}

impl Table {
    /// The table of rows of named cells: a column for each name, in the order in which names first
    /// appear. What a row lacks is missing. One text makes its column one of texts, in which
    /// numbers are written in full; flags are texts. Of two cells of one name in a row the last one
    /// counts.
    pub fn of_rows(rows: &[Vec<(String, Scalar)>]) -> Self {
        let mut places = HashMap::new();
        let mut columns: Vec<(&str, Vec<Option<&Scalar>>)> = Vec::new();
        for (row, cells) in rows.iter().enumerate() {
            for (name, cell) in cells {
                let place = *places.entry(name.as_str()).or_insert_with(|| {
                    columns.push((name, vec![None; rows.len()]));
                    columns.len() - 1
                });
                columns[place].1[row] = Some(cell);
            }
        }
        let column = |(name, cells): (&str, Vec<Option<&Scalar>>)| {
            let number = |cell: &Option<&Scalar>| match cell {
                None => Some(f64::NAN),
                Some(Scalar::Number(number)) => Some(*number),
                Some(Scalar::Flag(_) | Scalar::Text(_)) => None,
            };
            match cells.iter().map(number).collect() {
                Some(numbers) => TableColumn::numbers(name, numbers),
                None => {
                    let text =
                        |cell: Option<&Scalar>| cell.map_or(String::new(), Scalar::to_string);
                    TableColumn::texts(name, cells.into_iter().map(text).collect())
                }
            }
        };
        Self { columns: columns.into_iter().map(column).collect() }
    }

    /// How many rows there are.
    pub fn n_rows(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }

    /// The column of a name.
    pub fn column(&self, name: &str) -> Option<&TableColumn> {
        self.columns.iter().find(|column| column.name == name)
    }
}

impl Data for Table {
    const TYPE: DataType = DataType {
        id: "Table",
        doc: "Named columns of numbers or texts, all of one length.",
        color: [150, 190, 110],
    };

    fn byte_size(&self) -> usize {
        let of_column = |column: &TableColumn| {
            let words = column.name.len() + column.title.len() + column.unit.len();
            size_of::<TableColumn>() + words + column.values.byte_size()
        };
        size_of::<Self>() + self.columns.iter().map(of_column).sum::<usize>()
    }

    fn summary(&self) -> String {
        let n_rows = self.n_rows();
        let names = self.columns.iter().take(4).map(|column| column.name.as_str());
        let names = names.collect::<Vec<_>>().join(", ");
        let more = if self.columns.len() > 4 { ", …" } else { "" };
        match self.columns.len() {
            0 => "no columns".to_owned(),
            n => format!(
                "{n_rows} {} of {n} {}: {names}{more}",
                if n_rows == 1 { "row" } else { "rows" },
                if n == 1 { "column" } else { "columns" }
            ),
        }
    }

    fn check(&self) -> Result<(), String> {
        let mut names = HashSet::new();
        let n_rows = self.n_rows();
        for column in &self.columns {
            let (name, n) = (&column.name, column.values.len());
            if name.is_empty() {
                return Err("a column has no name".to_owned());
            }
            if !names.insert(name) {
                return Err(format!("two columns have the name \"{name}\""));
            }
            if n != n_rows {
                return Err(format!(
                    "column \"{name}\" has {n} cells, but the first one has {n_rows}"
                ));
            }
        }
        Ok(())
    }
}

/// A row for each of the first vertices: a name, and its x coordinate.
pub(super) fn sample(mesh: &TriMesh) -> Table {
    let x = || mesh.positions.iter().take(3).map(|position| position.x);
    let names = x().enumerate().map(|(at, _)| format!("v{at}")).collect();
    let numbers = TableColumn::numbers("x", x().collect()).in_unit("model units");
    Table { columns: vec![TableColumn::texts("vertex", names), numbers] }
}

#[cfg(test)]
mod tests {
    use mve_core::Unit;

    use super::*;

    #[test]
    fn rows_of_cells_become_columns() {
        let cell = |name: &str, cell: Scalar| (name.to_owned(), cell);
        let rows = [
            vec![cell("faces", Scalar::Number(12.0)), cell("cost", Scalar::Number(0.5))],
            vec![cell("closed", Scalar::Flag(true)), cell("cost", Scalar::Text("Quadric".into()))],
            vec![cell("faces", Scalar::Number(1.0)), cell("faces", Scalar::Number(4.0))],
        ];
        let table = Table::of_rows(&rows);
        assert_eq!(table.check(), Ok(()));
        assert_eq!(table.summary(), "3 rows of 3 columns: faces, cost, closed");
        let ColumnValues::Numbers(faces) = &table.columns[0].values else { panic!("numbers") };
        assert_eq!((faces[0], faces[1].is_nan(), faces[2]), (12.0, true, 4.0));
        let texts = |words: [&str; 3]| ColumnValues::Texts(words.map(str::to_owned).to_vec());
        assert_eq!(table.column("cost").unwrap().values, texts(["0.5", "Quadric", ""]));
        assert_eq!(table.column("closed").unwrap().values, texts(["", "true", ""]));
    }

    #[test]
    fn picked_rows_may_be_missing() {
        let texts = ColumnValues::Texts(vec!["a".to_owned(), "b".to_owned()]);
        let picked = texts.pick([Some(1), None, Some(0), Some(7)]);
        assert_eq!(picked, ColumnValues::Texts(["b", "", "a", ""].map(str::to_owned).to_vec()));
        let numbers = ColumnValues::Numbers(vec![1.0, 2.0]).pick([None, Some(1)]);
        assert!(matches!(numbers.cell(0), Some(Scalar::Number(x)) if x.is_nan()));
        assert_eq!(numbers.cell(1), Some(Scalar::Number(2.0)));
        assert_eq!(numbers.cell(2), None);
    }

    #[test]
    fn a_table_that_is_none_is_found() {
        const LENGTH: Quantity = Quantity::new("length", "Of an edge.").in_unit(Unit::LENGTH);
        let column = |n: usize| TableColumn::of(&LENGTH.titled("Length"), vec![0.5; n]);
        let mut table = Table { columns: vec![column(2), column(2)] };
        assert_eq!(table.columns[0].unit, "model units");
        assert_eq!(table.columns[0].shown_name(), "Length");
        assert_eq!(table.check().unwrap_err(), "two columns have the name \"length\"");
        table.columns[1] = TableColumn::texts("name", Vec::new());
        let message = "column \"name\" has 0 cells, but the first one has 2";
        assert_eq!(table.check().unwrap_err(), message);
        table.columns.truncate(1);
        table.columns[0].name.clear();
        assert_eq!(table.check().unwrap_err(), "a column has no name");
    }
}
