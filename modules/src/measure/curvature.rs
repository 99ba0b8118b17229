//! Measures the curvature of a surface at its vertices.
//!
//! Convex is positive where faces are counter-clockwise from outside.

use glam::DVec3;
use mve_mesh::data::{LayerValues, NO_VALUE};

use crate::geometry::curvature::{Curvature, FitOptions, discrete, quadric_fit};
use crate::prelude::*;

#[derive(Clone, Copy)]
enum Method {
    Discrete,
    QuadricFit,
}

impl Enumeration for Method {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        (
            "Discrete",
            "Angle defects and cotangents over mixed Voronoi areas (Meyer et al. 2003): exact in \
             sum, and no value at borders and where the surface is not manifold.",
        ),
        (
            "QuadricFit",
            "A polynomial fitted to the rings around the vertex (Cazals & Pouget 2005): smooth, \
             and with values at borders.",
        ),
    ];
    const VALUES: &'static [Self] = &[Self::Discrete, Self::QuadricFit];
}

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh.");
const METHOD: Param<Method> = Param::one_of("method", "How to measure.", "QuadricFit");
const RING: Param<i64> = Param::integer(
    "ring",
    "Rings of neighbors that the fit of QuadricFit looks at: more smooth noise away, and detail.",
    2,
)
.between((1, 10))
.mostly((1, 4))
.unit("edges");
const DEGREE: Param<i64> = Param::integer(
    "degree",
    "Degree of the polynomial of QuadricFit: 2 is the quadric, steady on noise; 4 follows a \
     smooth surface more closely. Where the points are too few it is less.",
    4,
)
.between((2, 4));
const MEAN_OUT: Out<Field> = Out::new("mean", "Half the sum of the principal curvatures.");
const GAUSSIAN_OUT: Out<Field> = Out::new("gaussian", "The product of the principal curvatures.");
const MAXIMUM_OUT: Out<Field> = Out::new("maximum", "The larger principal curvature, signed.");
const MINIMUM_OUT: Out<Field> = Out::new("minimum", "The smaller principal curvature, signed.");
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "The mesh with the principal directions as layers \"principal_max\" and \"principal_min\" of \
     unit vectors over vertices; their signs mean nothing.",
);

pub static MODULE: Module = Module {
    id: "Curvature",
    summary: "Measures mean, Gaussian and principal curvature at the vertices, convex positive.",
    inputs: &[MESH_IN.spec()],
    outputs: &[
        MEAN_OUT.spec(),
        GAUSSIAN_OUT.spec(),
        MAXIMUM_OUT.spec(),
        MINIMUM_OUT.spec(),
        MESH_OUT.spec(),
    ],
    params: &[METHOD.spec(), RING.spec(), DEGREE.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let mut mesh = io.take(MESH_IN)?;
    let options = FitOptions { ring: io.param(RING)? as u32, degree: io.param(DEGREE)? as usize };
    let method = io.param(METHOD)?;
    let control = io.control();
    let found = match method {
        Method::Discrete => discrete(&mesh, control),
        Method::QuadricFit => quadric_fit(&mesh, options, control),
    };
    let found = found?;
    let n_undefined = found.iter().filter(|curvature| curvature.mean.is_nan()).count();
    if n_undefined > 0 {
        io.warn(format!("{n_undefined} of {} vertices have no curvature", found.len()));
    }
    let field = |name: &str, unit: &str, value: fn(&Curvature) -> f64| Field {
        name: name.to_owned(),
        unit: unit.to_owned(),
        domain: Domain::Vertex,
        values: found.iter().map(value).collect(),
    };
    const UNIT: &str = "1 / model unit";
    io.put(MEAN_OUT, field("mean curvature", UNIT, |c| c.mean));
    io.put(GAUSSIAN_OUT, field("Gaussian curvature", "1 / model unit²", |c| c.gaussian));
    io.put(MAXIMUM_OUT, field("maximum curvature", UNIT, |c| c.maximum));
    io.put(MINIMUM_OUT, field("minimum curvature", UNIT, |c| c.minimum));
    mesh.set_layer(directions("principal_max", found.iter().map(|c| c.max_direction)));
    mesh.set_layer(directions("principal_min", found.iter().map(|c| c.min_direction)));
    io.put(MESH_OUT, mesh);
    Ok(())
}

fn directions(name: &str, directions: impl Iterator<Item = DVec3>) -> Layer {
    let (mut values, mut index) = (Vec::new(), Vec::new());
    for direction in directions {
        let is_known = direction != DVec3::ZERO;
        index.push(if is_known { values.len() as u32 } else { NO_VALUE });
        values.extend(is_known.then_some(direction));
    }
    let (name, values) = (name.to_owned(), LayerValues::Vec3(values));
    Layer { name, domain: Domain::Vertex, values, index }
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;
    use mve_mesh::fixtures::torus;

    use crate::prelude::*;

    #[test]
    fn a_torus_bends_most_around_its_tube() {
        for method in ["Discrete", "QuadricFit"] {
            let trial = Trial::of(&super::MODULE).input("mesh", torus(1.0, 0.25, 64));
            let outputs = trial.set("method", method).run().unwrap();
            let maximum = outputs["maximum"].get::<Field>().unwrap();
            assert!(maximum.values.iter().all(|k| (k - 4.0).abs() < 0.04), "{method}");
            // The first vertex lies on the outer equator, at a distance of 1.25 from the axis.
            let minimum = outputs["minimum"].get::<Field>().unwrap().values[0];
            assert!((minimum - 0.8).abs() < 0.008, "{method}: {minimum}");
            let mesh = outputs["mesh"].get::<TriMesh>().unwrap();
            assert_eq!(mesh.layer("principal_max").unwrap().values.len(), 64 * 64);
        }
    }
}
