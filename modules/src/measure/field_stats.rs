//! The values of a field in a few numbers.
//!
//! See [`crate::geometry::surface::field_statistics`] for what counts how much.

use mve_mesh::data::TableColumn;

use crate::geometry::surface::field_statistics::{FieldStatistics, element_areas};
use crate::prelude::*;

/// How much an element counts.
#[derive(Clone, Copy, Debug, PartialEq)]
enum ElementWeight {
    Equal,
    Area,
}

impl Enumeration for ElementWeight {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Equal", "Every value counts the same."),
        ("Area", "A value counts as much as the area around it; the mesh has to be linked."),
    ];
    const VALUES: &'static [Self] = &[Self::Equal, Self::Area];
}

const FIELD_IN: In<Field> = In::new("field", "Any field.");
const MESH_IN: MaybeIn<TriMesh> =
    MaybeIn::new("mesh", "The mesh that the field is over, for weights by area.");
const WEIGHTS: Param<ElementWeight> = Param::one_of("weights", "How much a value counts.", "Equal");

macro_rules! numbers {
    ($($port:ident: $name:literal, $doc:literal;)+) => {
        $(const $port: Out<f64> = Out::number(Quantity::new($name, $doc));)+
    };
}

numbers! {
    COUNT: "count", "Values that are finite and have a weight.";
    LEFT_OUT: "left_out", "Values that are not finite or have no weight; they do not count below.";
    MINIMUM: "minimum", "The least value.";
    MAXIMUM: "maximum", "The largest value.";
    MEAN: "mean", "The mean; by area it is that over the surface.";
    RMS: "rms", "The root of the mean square.";
    DEVIATION: "deviation", "The standard deviation, by n and not n less 1.";
    P1: "p1", "The value that 1 % lie below.";
    P5: "p5", "The value that 5 % lie below.";
    P25: "p25", "The value that a quarter lies below.";
    MEDIAN: "median", "The value that half lies below.";
    P75: "p75", "The value that three quarters lie below.";
    P95: "p95", "The value that 95 % lie below.";
    P99: "p99", "The value that 99 % lie below.";
}

const TABLE_OUT: Out<Table> = Out::new("table", "The same as a table, a row a number.");

pub static MODULE: Module = Module {
    id: "FieldStats",
    summary: "Least, largest, mean, RMS, deviation and percentiles of a field, by area or not.",
    inputs: &[FIELD_IN.spec(), MESH_IN.spec()],
    outputs: &[
        COUNT.spec(),
        LEFT_OUT.spec(),
        MINIMUM.spec(),
        MAXIMUM.spec(),
        MEAN.spec(),
        RMS.spec(),
        DEVIATION.spec(),
        P1.spec(),
        P5.spec(),
        P25.spec(),
        MEDIAN.spec(),
        P75.spec(),
        P95.spec(),
        P99.spec(),
        TABLE_OUT.spec(),
    ],
    params: &[WEIGHTS.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let (field, mesh) = (io.get(FIELD_IN)?, io.maybe(MESH_IN));
    let control = io.control();
    let weights = match (io.param(WEIGHTS)?, &mesh) {
        (ElementWeight::Equal, _) => None,
        (ElementWeight::Area, None) => {
            let message = "weights by area need the mesh that the field is over; link it, or set \
                           weights to Equal";
            return Err(ModuleError::param(&WEIGHTS, message));
        }
        (ElementWeight::Area, Some(mesh)) => {
            field.check_fits(mesh).map_err(|message| ModuleError::input(&FIELD_IN, message))?;
            Some(element_areas(mesh, field.domain, control.part(0.0, 0.3))?)
        }
    };
    let found = FieldStatistics::of(&field.values, weights.as_deref(), control.part(0.3, 1.0))?;
    if found.n == 0 {
        io.warn("the field has no finite value with a weight, so there is nothing to say of it");
    }
    let numbers = [
        (COUNT, found.n as f64),
        (LEFT_OUT, found.n_left_out as f64),
        (MINIMUM, found.minimum()),
        (MAXIMUM, found.maximum()),
        (MEAN, found.mean),
        (RMS, found.rms),
        (DEVIATION, found.deviation),
        (P1, found.percentile(0.01)),
        (P5, found.percentile(0.05)),
        (P25, found.percentile(0.25)),
        (MEDIAN, found.percentile(0.5)),
        (P75, found.percentile(0.75)),
        (P95, found.percentile(0.95)),
        (P99, found.percentile(0.99)),
    ];
    let names = numbers.iter().map(|(port, _)| port.spec().name.to_owned()).collect();
    let values = numbers.iter().map(|(_, number)| *number).collect();
    let values = TableColumn::numbers("value", values).titled(field.name.clone());
    let columns = vec![TableColumn::texts("statistic", names), values.in_unit(field.unit.clone())];
    io.put(TABLE_OUT, Table { columns });
    for (port, number) in numbers {
        io.put(port, number);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;
    use mve_mesh::fixtures::mesh_of;

    use crate::prelude::*;

    #[test]
    fn a_large_face_counts_more_by_area() {
        // Areas of 3 and 1.
        let points = [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 1.0]];
        let mesh = mesh_of(&points, &[[0, 1, 2], [0, 1, 3]]);
        let (name, unit) = ("quality".to_owned(), "mm".to_owned());
        let field = Field { name, unit, domain: Domain::Face, values: vec![1.0, 5.0] };
        let trial = || Trial::of(&super::MODULE).input("field", field.clone());
        let outputs = trial().run().unwrap();
        let number = |name: &str| *outputs[name].get::<f64>().unwrap();
        assert_eq!([number("mean"), number("median"), number("deviation")], [3.0, 3.0, 2.0]);
        let outputs = trial().input("mesh", mesh.clone()).set("weights", "Area").run().unwrap();
        let number = |name: &str| *outputs[name].get::<f64>().unwrap();
        assert_eq!([number("mean"), number("median"), number("p95")], [2.0, 1.0, 5.0]);
        assert_eq!(number("rms"), 7.0_f64.sqrt());
        let table = outputs["table"].get::<Table>().unwrap();
        assert_eq!((table.n_rows(), table.columns[1].unit.as_str()), (14, "mm"));
        let message = trial().set("weights", "Area").run().unwrap_err().to_string();
        assert!(message.contains("link it"), "{message}");
        let mut other = mesh;
        other.faces.pop();
        let refused = trial().input("mesh", other).set("weights", "Area").run();
        assert!(refused.unwrap_err().to_string().contains("2 values"));
    }
}
