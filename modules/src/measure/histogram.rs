//! How often the values of a field, or of a column of a table, are.
//!
//! Bins share a range evenly; a value at the end of one belongs to the next, the last one has its
//! end, too (as numpy's `histogram`).

use mve_mesh::data::{ColumnValues, TableColumn};

use crate::geometry::surface::field_statistics::element_areas;
use crate::picture::bar_chart::BarChart;
use crate::prelude::*;

/// How much an element counts.
#[derive(Clone, Copy, Debug, PartialEq)]
enum BinWeight {
    Equal,
    Area,
}

impl Enumeration for BinWeight {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Equal", "Every value counts the same."),
        ("Area", "A value counts as much as the area around it; the mesh has to be linked."),
    ];
    const VALUES: &'static [Self] = &[Self::Equal, Self::Area];
}

const FIELD_IN: MaybeIn<Field> = MaybeIn::new("field", "The values, unless they are in a table.");
const MESH_IN: MaybeIn<TriMesh> =
    MaybeIn::new("mesh", "The mesh that the field is over, for weights by area.");
const TABLE_IN: MaybeIn<Table> =
    MaybeIn::new("table", "A table with the values in a column, where there is no field.");
const COLUMN: Param<String> = Param::text(
    "column",
    "Name of the column of the table. Empty: the first one with numbers.",
    "",
);
const BINS: Param<i64> =
    Param::integer("bins", "How many bins there are.", 64).between((1, 100_000)).mostly((8, 256));
const LOW: Param<Option<f64>> =
    Param::maybe_number("low", "Where the first bin begins. Off: at the least value.", None);
const HIGH: Param<Option<f64>> =
    Param::maybe_number("high", "Where the last bin ends. Off: at the largest value.", None);
const WEIGHTS: Param<BinWeight> = Param::one_of("weights", "How much a value counts.", "Equal");
const LOGARITHMIC: Param<bool> = Param::flag(
    "logarithmic",
    "Whether the picture shows heights by their logarithms, so that rare values are seen.",
    false,
);
const WIDTH: Param<i64> = Param::integer("width", "Pixels in a row of the picture.", 640)
    .between((BarChart::LEAST as i64, 8192))
    .unit("pixels");
const HEIGHT: Param<i64> = Param::integer("height", "Rows of the picture.", 400)
    .between((BarChart::LEAST as i64, 8192))
    .unit("pixels");

const TABLE_OUT: Out<Table> = Out::new(
    "table",
    "A row a bin: where it begins and ends, how many values it has, and its share of all in the \
     range, by the weights.",
);
const IMAGES_OUT: Out<Images> = Out::new("images", "A picture: the counts as bars.");
const OUTSIDE_OUT: Out<f64> = Out::number(Quantity::new(
    "outside",
    "Values that are not finite or lie outside of the range; they are in no bin.",
));

pub static MODULE: Module = Module {
    id: "Histogram",
    summary: "Counts how often values of a field or a column of a table are, as table and picture.",
    inputs: &[FIELD_IN.spec(), MESH_IN.spec(), TABLE_IN.spec()],
    outputs: &[TABLE_OUT.spec(), IMAGES_OUT.spec(), OUTSIDE_OUT.spec()],
    params: &[
        COLUMN.spec(),
        BINS.spec(),
        LOW.spec(),
        HIGH.spec(),
        WEIGHTS.spec(),
        LOGARITHMIC.spec(),
        WIDTH.spec(),
        HEIGHT.spec(),
    ],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let (field, table) = (io.maybe(FIELD_IN), io.maybe(TABLE_IN));
    let (name, unit, values) = match (&field, &table) {
        (Some(field), None) => (field.name.as_str(), field.unit.as_str(), field.values.as_slice()),
        (None, Some(table)) => column_of(table, &io.param(COLUMN)?)?,
        _ => {
            let found = if field.is_some() { "both" } else { "neither" };
            let message = format!("{found} of field and table are linked; link one of them");
            return Err(ModuleError::Failed(message));
        }
    };
    let weights = weights(io, field.as_deref())?;
    let range = range(io, values)?;
    let n_bins = io.param(BINS)? as usize;
    let (mut counts, mut shares) = (vec![0.0; n_bins], vec![0.0; n_bins]);
    let (mut n_outside, mut total) = (0_usize, 0.0);
    let control = io.control();
    for (place, &value) in values.iter().enumerate() {
        control.item(place, values.len())?;
        let Some(bin) = bin_of(value, range, n_bins) else {
            n_outside += 1;
            continue;
        };
        let weight = weights.as_ref().map_or(1.0, |weights| weights[place]);
        counts[bin] += 1.0;
        shares[bin] += weight;
        total += weight;
    }
    if total > 0.0 {
        shares.iter_mut().for_each(|share| *share /= total);
    } else {
        io.warn("no value is in the range, so that all bins are empty");
    }
    let chart = BarChart {
        title: &format!("{}: {} values", if name.is_empty() { "values" } else { name }, {
            values.len() - n_outside
        }),
        x_label: &if unit.is_empty() { name.to_owned() } else { format!("{name} ({unit})") },
        range,
        heights: if weights.is_some() { &shares } else { &counts },
        has_decades: io.param(LOGARITHMIC)?,
        size: [io.param(WIDTH)? as usize, io.param(HEIGHT)? as usize],
    };
    let image = chart.draw();
    let edge = |k: usize| edge(range, k, n_bins);
    let from = TableColumn::numbers("from", (0..n_bins).map(edge).collect()).in_unit(unit);
    let to = TableColumn::numbers("to", (1..=n_bins).map(edge).collect()).in_unit(unit);
    let counts = TableColumn::numbers("count", counts);
    let columns = vec![from, to, counts, TableColumn::numbers("share", shares)];
    io.put(TABLE_OUT, Table { columns });
    io.put(IMAGES_OUT, Images(vec![image]));
    io.put(OUTSIDE_OUT, n_outside as f64);
    Ok(())
}

/// Name, unit and values of a column.
fn column_of<'t>(
    table: &'t Table,
    name: &str,
) -> Result<(&'t str, &'t str, &'t [f64]), ModuleError> {
    let numeric = table.columns.iter().filter_map(|column| match &column.values {
        ColumnValues::Numbers(numbers) => Some((column, numbers.as_slice())),
        ColumnValues::Texts(_) => None,
    });
    let names: Vec<&str> = numeric.clone().map(|(column, _)| column.name.as_str()).collect();
    let mut fitting = numeric.filter(|(column, _)| name.is_empty() || column.name == name);
    let found = fitting
        .next()
        .map(|(column, numbers)| (column.shown_name(), column.unit.as_str(), numbers));
    found.ok_or_else(|| {
        let message = match names.as_slice() {
            [] => "the table has no column of numbers".to_owned(),
            names => format!(
                "the table has no column of numbers \"{name}\"; those of numbers are {}",
                names.join(", ")
            ),
        };
        ModuleError::param(&COLUMN, message)
    })
}

/// The area around each value, if values count by it.
fn weights(io: &Io, field: Option<&Field>) -> Result<Option<Vec<f64>>, ModuleError> {
    if io.param(WEIGHTS)? == BinWeight::Equal {
        return Ok(None);
    }
    let (Some(field), Some(mesh)) = (field, io.maybe(MESH_IN)) else {
        let message = "weights by area need a field and the mesh that it is over; link both, or \
                       set weights to Equal";
        return Err(ModuleError::param(&WEIGHTS, message));
    };
    let input = |message| ModuleError::Input { port: FIELD_IN.spec().name.to_owned(), message };
    field.check_fits(&mesh).map_err(input)?;
    Ok(Some(element_areas(&mesh, field.domain, io.control())?))
}

/// Both ends of the bins. Where all values are one, the bins reach half a unit around it.
fn range(io: &Io, values: &[f64]) -> Result<[f64; 2], ModuleError> {
    let finite = || values.iter().copied().filter(|value| value.is_finite());
    let (given_low, given_high) = (io.param(LOW)?, io.param(HIGH)?);
    let low = given_low.or_else(|| finite().reduce(f64::min));
    let high = given_high.or_else(|| finite().reduce(f64::max));
    let (low, high) = (low.unwrap_or(0.0), high.unwrap_or(1.0));
    if low > high || (low == high && given_low.is_some() && given_high.is_some()) {
        let message = format!("the bins would go from {low} to {high}; low is to be below high");
        return Err(ModuleError::param(&LOW, message));
    }
    Ok(if low == high { [low - 0.5, high + 0.5] } else { [low, high] })
}

/// Where bin `k` begins; the last one ends at the high end to the last bit.
fn edge([low, high]: [f64; 2], k: usize, n_bins: usize) -> f64 {
    let share = k as f64 / n_bins as f64;
    low * (1.0 - share) + high * share
}

/// The bin of a value, if it is within the range.
fn bin_of(value: f64, [low, high]: [f64; 2], n_bins: usize) -> Option<usize> {
    if !(low..=high).contains(&value) {
        return None;
    }
    // Halves do not overflow where the whole does.
    let share = (0.5 * value - 0.5 * low) / (0.5 * high - 0.5 * low);
    let mut bin = ((share * n_bins as f64) as usize).min(n_bins - 1);
    // Rounding may name a neighbor.
    if bin > 0 && value < edge([low, high], bin, n_bins) {
        bin -= 1;
    } else if bin + 1 < n_bins && value >= edge([low, high], bin + 1, n_bins) {
        bin += 1;
    }
    Some(bin)
}

#[cfg(test)]
mod tests {
    use mve_core::testing::{Outputs, Trial};
    use mve_mesh::data::{ColumnValues, TableColumn};
    use mve_mesh::fixtures::mesh_of;

    use crate::prelude::*;

    fn numbers(outputs: &Outputs, name: &str) -> Vec<f64> {
        let table = outputs["table"].get::<Table>().unwrap();
        match &table.column(name).unwrap().values {
            ColumnValues::Numbers(numbers) => numbers.clone(),
            ColumnValues::Texts(_) => panic!("numbers"),
        }
    }

    fn field(values: &[f64]) -> Field {
        let (name, unit) = ("distance".to_owned(), "mm".to_owned());
        Field { name, unit, domain: Domain::Face, values: values.to_vec() }
    }

    #[test]
    fn values_are_counted_as_numpy_does() {
        // numpy.histogram([0, 1, 1, 2.5, 4], bins=4) is [1, 2, 1, 1].
        let values = field(&[0.0, 1.0, f64::NAN, 1.0, 2.5, 4.0]);
        let trial = || Trial::of(&super::MODULE).input("field", values.clone()).set("bins", 4);
        let outputs = trial().run().unwrap();
        assert_eq!(numbers(&outputs, "count"), [1.0, 2.0, 1.0, 1.0]);
        assert_eq!(numbers(&outputs, "from"), [0.0, 1.0, 2.0, 3.0]);
        assert_eq!(numbers(&outputs, "to"), [1.0, 2.0, 3.0, 4.0]);
        assert_eq!(numbers(&outputs, "share"), [0.2, 0.4, 0.2, 0.2]);
        assert_eq!(*outputs["outside"].get::<f64>().unwrap(), 1.0);
        let image = &outputs["images"].get::<Images>().unwrap().0[0];
        assert_eq!((image.width, image.height), (640, 400));
        let outputs = trial().set("low", 1.0).set("high", 2.0).run().unwrap();
        assert_eq!(numbers(&outputs, "count"), [2.0, 0.0, 0.0, 0.0]);
        assert_eq!(*outputs["outside"].get::<f64>().unwrap(), 4.0);
        let message = trial().set("low", 5.0).run().unwrap_err().to_string();
        assert!(message.contains("from 5 to 4"), "{message}");
    }

    #[test]
    fn faces_count_by_their_area() {
        let points = [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 1.0]];
        let mesh = mesh_of(&points, &[[0, 1, 2], [0, 1, 3]]);
        let trial = Trial::of(&super::MODULE).input("field", field(&[1.0, 5.0])).set("bins", 2);
        let outputs = trial.input("mesh", mesh).set("weights", "Area").run().unwrap();
        assert_eq!(numbers(&outputs, "share"), [0.75, 0.25]);
        assert_eq!(numbers(&outputs, "count"), [1.0, 1.0]);
    }

    #[test]
    fn a_column_of_a_table_is_counted_and_what_is_missing_is_said() {
        let names = TableColumn::texts("name", vec!["a".to_owned(); 3]);
        let columns = vec![names, TableColumn::numbers("rms", vec![2.0; 3])];
        let trial = || Trial::of(&super::MODULE).input("table", Table { columns: columns.clone() });
        let outputs = trial().set("bins", 3).run().unwrap();
        assert_eq!(numbers(&outputs, "count"), [0.0, 3.0, 0.0]);
        assert_eq!(numbers(&outputs, "from")[0], 1.5);
        let message = trial().set("column", "name").run().unwrap_err().to_string();
        assert!(message.contains("those of numbers are rms"), "{message}");
        let message = trial().input("field", field(&[1.0])).run().unwrap_err().to_string();
        assert!(message.contains("both of field and table"), "{message}");
        assert!(Trial::of(&super::MODULE).run().unwrap_err().to_string().contains("neither"));
        assert!(trial().set("weights", "Area").run().is_err());
    }
}
