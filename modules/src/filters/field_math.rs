//! Computes a field by a formula over others, and over the places of a mesh.

use std::sync::Arc;

use mve_core::Expression;

use crate::geometry::fields::domains::{Reduction, converted};
use crate::geometry::fields::formula::{VARIABLES, evaluated};
use crate::prelude::*;

#[derive(Clone, Copy)]
enum Over {
    Fields,
    Vertices,
    Faces,
    Corners,
}

impl Enumeration for Over {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Fields", "What the first field that is linked is over; vertices without one."),
        ("Vertices", "Vertices."),
        ("Faces", "Faces."),
        ("Corners", "Corners of faces."),
    ];
    const VALUES: &'static [Self] = &[Self::Fields, Self::Vertices, Self::Faces, Self::Corners];
}

#[derive(Clone, Copy)]
enum Conversion {
    Refused,
    Mean,
    Least,
    Largest,
}

impl Enumeration for Conversion {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Refused", "It is an error."),
        ("Mean", "A face has the mean of its corners, a vertex that of its faces."),
        ("Least", "The least of these."),
        ("Largest", "The largest of these."),
    ];
    const VALUES: &'static [Self] = &[Self::Refused, Self::Mean, Self::Least, Self::Largest];
}

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh.");
const A_IN: MaybeIn<Field> = MaybeIn::new("a", "A field on the mesh, a in the formula.");
const B_IN: MaybeIn<Field> = MaybeIn::new("b", "A field on the mesh, b in the formula.");
const C_IN: MaybeIn<Field> = MaybeIn::new("c", "A field on the mesh, c in the formula.");
const FORMULA: Param<Expression> = Param::expression(
    "formula",
    "The value at each element, by fields, places and normals. It may have + - * / ^, < <= > >= = \
     !=, and, or, parentheses, pi, and the functions sqrt, abs, min, max, sin, cos, tan, exp, log, \
     floor, ceil, round, sign, pow, atan2, mod, not, step(edge, x), clamp(x, low, high) and \
     if(test, then, else). Comparisons give 1 or 0, so that a formula can be a selection.",
    "z",
    VARIABLES,
);
const OVER: Param<Over> = Param::one_of("over", "What the new field is over.", "Fields");
const CONVERSION: Param<Conversion> =
    Param::one_of("conversion", "What becomes of a field that is over something else.", "Refused");
const NAME: Param<String> = Param::text("name", "Name of the new field. Empty: the formula.", "");
const UNIT: Param<String> = Param::text("unit", "Unit of the new field.", "");
const FIELD_OUT: Out<Field> = Out::new("field", "The value of the formula at each element.");

pub static MODULE: Module = Module {
    id: "FieldMath",
    summary: "Computes a field by a formula over other fields, places and normals.",
    inputs: &[MESH_IN.spec(), A_IN.spec(), B_IN.spec(), C_IN.spec()],
    outputs: &[FIELD_OUT.spec()],
    params: &[FORMULA.spec(), OVER.spec(), CONVERSION.spec(), NAME.spec(), UNIT.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let mesh = io.get(MESH_IN)?;
    let formula = io.param(FORMULA)?;
    let linked = [(io.maybe(A_IN), A_IN), (io.maybe(B_IN), B_IN), (io.maybe(C_IN), C_IN)];
    let first = linked.iter().find_map(|(field, _)| field.as_ref().map(|field| field.domain));
    let domain = match io.param(OVER)? {
        Over::Fields => first.unwrap_or(Domain::Vertex),
        Over::Vertices => Domain::Vertex,
        Over::Faces => Domain::Face,
        Over::Corners => Domain::Corner,
    };
    let mut fields = [const { Vec::new() }; 3];
    for (place, (field, port)) in linked.iter().enumerate() {
        match field {
            Some(field) => fields[place] = values(io, &mesh, field, port, domain)?,
            None if formula.names(place) => {
                let name = VARIABLES[place].0;
                let message = format!("the formula names {name}, and nothing is linked to it");
                return Err(ModuleError::maybe_input(port, message));
            }
            None => {}
        }
    }
    let values = evaluated(&formula, &mesh, domain, &fields, io.control())?;
    let n_undefined = values.iter().filter(|value| !value.is_finite()).count();
    if n_undefined > 0 {
        io.warn(format!("{n_undefined} of {} values are not finite numbers", values.len()));
    }
    let name = io.param(NAME)?;
    let name = if name.is_empty() { formula.text().to_owned() } else { name };
    io.put(FIELD_OUT, Field { name, unit: io.param(UNIT)?, domain, values });
    Ok(())
}

/// The values of a field over the domain of the new one.
fn values(
    io: &Io,
    mesh: &TriMesh,
    field: &Arc<Field>,
    port: &MaybeIn<Field>,
    domain: Domain,
) -> Result<Vec<f64>, ModuleError> {
    field.check_fits(mesh).map_err(|message| ModuleError::maybe_input(port, message))?;
    let reduction = match io.param(CONVERSION)? {
        Conversion::Refused if field.domain != domain => {
            let [found, wanted] = [field.domain, domain].map(name_of);
            let message = format!(
                "\"{}\" is over {found}, and the new field is over {wanted}: set \"over\" to the \
                 other, or let \"conversion\" say how it is converted",
                field.name
            );
            return Err(ModuleError::maybe_input(port, message));
        }
        Conversion::Refused | Conversion::Mean => Reduction::Mean,
        Conversion::Least => Reduction::Least,
        Conversion::Largest => Reduction::Largest,
    };
    Ok(converted(&field.values, field.domain, domain, mesh, reduction))
}

fn name_of(domain: Domain) -> &'static str {
    match domain {
        Domain::Vertex => "vertices",
        Domain::Corner => "corners",
        Domain::Face => "faces",
    }
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;
    use mve_mesh::fixtures::tetrahedron;

    use crate::prelude::*;

    fn field(domain: Domain, values: &[f64]) -> Field {
        let (name, unit) = ("height".to_owned(), String::new());
        Field { name, unit, domain, values: values.to_vec() }
    }

    fn trial(formula: &str) -> Trial {
        Trial::of(&super::MODULE).input("mesh", tetrahedron()).set("formula", formula)
    }

    fn values(trial: Trial) -> Vec<f64> {
        trial.run().unwrap()["field"].get::<Field>().unwrap().values.clone()
    }

    #[test]
    fn fields_and_places_are_computed_with() {
        let vertices = || field(Domain::Vertex, &[1.0, 2.0, 3.0, 4.0]);
        assert_eq!(values(trial("x + 2 * y + 3 * z")), [0.0, 1.0, 2.0, 3.0]);
        let both = trial("a * b - 1").input("a", vertices()).input("b", vertices());
        assert_eq!(values(both), [0.0, 3.0, 8.0, 15.0]);
        let clamped = trial("clamp(c, 2, 3) + step(3, c)").input("c", vertices());
        assert_eq!(values(clamped), [2.0, 2.0, 4.0, 4.0]);
        let outputs = trial("z").set("name", "height").set("unit", "m").run().unwrap();
        let named = outputs["field"].get::<Field>().unwrap();
        assert_eq!((named.name.as_str(), named.unit.as_str()), ("height", "m"));
    }

    #[test]
    fn domains_are_converted_when_that_is_asked_for() {
        // Faces 0 2 1, 0 1 3, 0 3 2 and 1 2 3.
        let vertices = || field(Domain::Vertex, &[0.0, 3.0, 6.0, 9.0]);
        let over_faces = || trial("a").input("a", vertices()).set("over", "Faces");
        let message = over_faces().run().unwrap_err().to_string();
        assert!(message.contains("over vertices, and the new field is over faces"), "{message}");
        let mean = values(over_faces().set("conversion", "Mean"));
        assert_eq!(mean, [3.0, 4.0, 5.0, 6.0]);
        assert_eq!(values(over_faces().set("conversion", "Largest")), [6.0, 9.0, 9.0, 9.0]);
        let faces = field(Domain::Face, &[1.0, 2.0, 3.0, 4.0]);
        assert_eq!(values(trial("a").input("a", faces)), [1.0, 2.0, 3.0, 4.0]);
    }

    #[test]
    fn what_is_missing_or_undefined_is_said() {
        let message = trial("b + 1").run().unwrap_err().to_string();
        assert!(message.contains("names b, and nothing is linked"), "{message}");
        assert!(trial("log(z)").log().unwrap()[0].contains("3 of 4 values are not finite"));
        let message = trial("a").input("a", field(Domain::Face, &[0.0])).run().unwrap_err();
        assert!(message.to_string().contains("1 values"), "{message}");
    }
}
