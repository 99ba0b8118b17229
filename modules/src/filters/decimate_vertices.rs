//! Simplifies a mesh by taking vertices away, the least important first.

use mve_core::{Condition, MissedTarget, Quantities};
use mve_mesh::data::Measure;
use mve_mesh::weld::finite_diagonal;

use crate::geometry::decimate::kind::VertexKind;
use crate::geometry::decimate::options::{
    DecimateOptions, EdgeChoice, ImportanceKind, Openings, RemovalKind, Sequence,
};
use crate::geometry::decimate::refusal::Refusal;
use crate::geometry::decimate::{Decimated, decimate};
use crate::prelude::*;

impl Enumeration for ImportanceKind {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        (
            "EdgeSwitching",
            "Sum over the edges at it of the distance to the edge that could be in its place \
             (Franz 2000).",
        ),
        ("MeanPlane", "Distance from the mean plane of its faces (Schroeder et al. 1992)."),
        (
            "Quadric",
            "Squared distance of the neighbor that it goes to from the planes of all faces that \
             the two stand for (Garland and Heckbert 1997): half the error of the others.",
        ),
    ];
    const VALUES: &'static [Self] = &[Self::EdgeSwitching, Self::MeanPlane, Self::Quadric];
}

impl Enumeration for EdgeChoice {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Shortest", "The shortest that passes the tests."),
        ("Quadric", "The one of least quadric error that passes the tests."),
    ];
    const VALUES: &'static [Self] = &[Self::Shortest, Self::Quadric];
}

impl Enumeration for Sequence {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        (
            "Passes",
            "By their importance at the start of a pass; vertices whose faces have changed wait \
             for the next pass.",
        ),
        ("Queue", "The one that is least important as the mesh is now."),
    ];
    const VALUES: &'static [Self] = &[Self::Passes, Self::Queue];
}

#[derive(Clone, Copy)]
enum Removing {
    Collapse,
    Retriangulate,
}

impl Enumeration for Removing {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Collapse", "It merges into a neighbor."),
        ("Retriangulate", "The hole is cut into triangles (Schroeder et al. 1992)."),
    ];
    const VALUES: &'static [Self] = &[Self::Collapse, Self::Retriangulate];
}

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh.");
const TARGET_FACES: Param<Option<i64>> =
    Param::maybe_integer("target_faces", "Stop at this many faces. Off: the ratio counts.", None)
        .between((0, 4_294_967_295))
        .mostly((10, 1_000_000))
        .unit("faces");
const RATIO: Param<Option<f64>> = Param::maybe_number(
    "ratio",
    "Stop at this part of the input's faces, where no number of faces is given. Off: no limit.",
    Some(0.5),
)
.within((0.0, 1.0))
.only_where(Condition::IsOff { param: "target_faces" });
const LARGEST_DISTANCE: Param<Option<f64>> = Param::maybe_number(
    "largest_distance",
    "No vertex goes whose importance is a larger distance, as a part of the diagonal of the \
     bounding box; for Quadric it is the root of the mean squared distance. Off: no limit.",
    None,
)
.within((0.0, 1.0))
.usually((0.0, 0.01));
const IMPORTANCE: Param<ImportanceKind> =
    Param::one_of("importance", "What says how much is lost with a vertex.", "Quadric");
const EDGE: Param<EdgeChoice> =
    Param::one_of("edge", "The edge that a vertex goes along.", "Quadric")
        .only_where(Condition::Is { param: "removal", value: "Collapse" });
const ORDER: Param<Sequence> = Param::one_of("order", "Which vertex goes next.", "Queue");
const REMOVAL: Param<Removing> =
    Param::one_of("removal", "What becomes of a vertex and the faces around it.", "Collapse");
const LEAST_ASPECT: Param<f64> = Param::number(
    "least_aspect",
    "A hole is cut only along lines from which its vertices are so far away, over the length of \
     the line.",
    0.04,
)
.within((0.0, 1.0))
.only_where(Condition::Is { param: "removal", value: "Retriangulate" });
const FEATURE_ANGLE: Param<f64> = Param::number(
    "feature_angle",
    "Edges at which the surface turns by more are feature edges: a vertex with two goes only along \
     them, one with more is a corner.",
    60.0,
)
.within((0.0, 180.0))
.unit("degrees");
const BOUNDARY: Param<bool> = Param::flag(
    "boundary",
    "Whether vertices of borders go, too, along the border. Else they stay.",
    false,
);
const SPLIT_COMPLEX: Param<bool> = Param::flag(
    "split_complex",
    "Whether, where the target is not met otherwise, the surface parts where it is not manifold \
     (Schroeder 1997). Else such vertices stay.",
    false,
);
const SPLIT_CORNERS: Param<bool> = Param::flag(
    "split_corners",
    "Whether, where the target is not met otherwise, the surface parts along the feature edges at \
     corners (Schroeder 1997). Of use with boundary, as the copies lie on a border. Else corners \
     stay.",
    false,
);
const KEEP_SEAMS: Param<bool> = Param::flag(
    "keep_seams",
    "Whether vertices at seams of texture coordinates go only along the seam, and with \
     Retriangulate not at all. Else the texture may be pulled across.",
    true,
);
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "The mesh with fewer vertices, those that are left where they were, with all layers; vertices \
     and faces stay in order.",
);
const TYPES_OUT: Out<Field> = Out::new(
    "types",
    "The type of each vertex of the input: 0 simple, 1 complex, 2 boundary, 3 interior edge, 4 \
     corner; no number without a face.",
);
const IMPORTANCE_OUT: Out<Field> = Out::new(
    "importance",
    "The importance of each vertex of the input as a distance; no number for those that stay.",
);
const FACES: Quantity = Quantity::new("faces", "Faces of the result.").titled("faces").size();
const REMOVED: Quantity =
    Quantity::new("removed", "Vertices that went.").titled("removed vertices");
const SPLIT: Quantity =
    Quantity::new("split", "Copies of vertices that the surface was parted by.").titled("copies");
const LARGEST: Quantity = Quantity::new(
    "largest_distance",
    "The largest importance of a vertex that went, as a distance.",
)
.titled("largest distance")
.in_unit(Unit::LENGTH)
.lower();
const SIMPLE: Quantity =
    Quantity::new("simple", "Simple vertices of the input.").titled("simple vertices");
const COMPLEX: Quantity =
    Quantity::new("complex", "Complex vertices of the input.").titled("complex vertices");
const BOUNDARY_VERTICES: Quantity =
    Quantity::new("boundary", "Boundary vertices of the input.").titled("boundary vertices");
const INTERIOR_EDGE: Quantity =
    Quantity::new("interior_edge", "Interior edge vertices of the input.")
        .titled("interior edge vertices");
const CORNER: Quantity =
    Quantity::new("corner", "Corner vertices of the input.").titled("corner vertices");
const STATISTICS_OUT: Out<Measures> =
    Out::new("statistics", "Counts of the run.").giving(Quantities::Row(&[
        FACES,
        REMOVED,
        SPLIT,
        LARGEST,
        SIMPLE,
        COMPLEX,
        BOUNDARY_VERTICES,
        INTERIOR_EDGE,
        CORNER,
    ]));

pub static MODULE: Module = Module {
    id: "DecimateVertices",
    summary: "Simplifies a mesh by taking vertices away, the least important first.",
    inputs: &[MESH_IN.spec()],
    outputs: &[MESH_OUT.spec(), TYPES_OUT.spec(), IMPORTANCE_OUT.spec(), STATISTICS_OUT.spec()],
    params: &[
        TARGET_FACES.spec(),
        RATIO.spec(),
        LARGEST_DISTANCE.spec(),
        IMPORTANCE.spec(),
        EDGE.spec(),
        ORDER.spec(),
        REMOVAL.spec(),
        LEAST_ASPECT.spec(),
        FEATURE_ANGLE.spec(),
        BOUNDARY.spec(),
        SPLIT_COMPLEX.spec(),
        SPLIT_CORNERS.spec(),
        KEEP_SEAMS.spec(),
    ],
    run,
};

/// Bytes that the work takes for a face of the input.
const BYTES_A_FACE: usize = 130;

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let mesh = io.get(MESH_IN)?;
    io.reserve(mesh.faces.len() * BYTES_A_FACE)?;
    let ratio = io.param(RATIO)?.map(|ratio| (ratio * mesh.faces.len() as f64) as usize);
    let target = io.param(TARGET_FACES)?.map(|faces| faces as usize).or(ratio);
    let diagonal = finite_diagonal(&mesh);
    let options = DecimateOptions {
        target_faces: target.unwrap_or(0),
        largest_distance: io.param(LARGEST_DISTANCE)?.map(|part| part * diagonal),
        importance: io.param(IMPORTANCE)?,
        edge: io.param(EDGE)?,
        sequence: io.param(ORDER)?,
        removal: match io.param(REMOVAL)? {
            Removing::Collapse => RemovalKind::Collapse,
            Removing::Retriangulate => {
                RemovalKind::Retriangulate { least_aspect: io.param(LEAST_ASPECT)? }
            }
        },
        feature_angle_rad: io.param(FEATURE_ANGLE)?.to_radians(),
        openings: Openings {
            boundary: io.param(BOUNDARY)?,
            complex: io.param(SPLIT_COMPLEX)?,
            corners: io.param(SPLIT_CORNERS)?,
        },
        keeps_seams: io.param(KEEP_SEAMS)?,
    };
    let found = decimate(&mesh, &options, io.control())?;
    if let (Some(asked), Some(refusals)) = (target, found.refusals) {
        let (asked, reached) = (asked as f64, found.mesh.faces.len() as f64);
        let missed = MissedTarget { what: FACES.name.to_owned(), asked, reached };
        let reasons = reasons(&refusals);
        let line = format!("stopped at {reached} faces, {asked} were asked for; {reasons}");
        // A distance that ends the work is what was asked for.
        if refusals[Refusal::Distance.place()] > 0 { io.log(line) } else { io.missed(missed, line) }
    }
    let kind = |kind: &Option<VertexKind>| kind.map_or(f64::NAN, VertexKind::number);
    let field = |name: &str, unit: &str, values| {
        let (name, unit) = (name.to_owned(), unit.to_owned());
        Field { name, unit, domain: Domain::Vertex, values }
    };
    io.put(TYPES_OUT, field("vertex type", "", found.kinds.iter().map(kind).collect()));
    io.put(STATISTICS_OUT, measures(&found));
    io.put(IMPORTANCE_OUT, field("importance", "model units", found.distances));
    io.put(MESH_OUT, found.mesh);
    Ok(())
}

/// How many vertices stay for which reason, and what to set.
fn reasons(counts: &[usize; 6]) -> String {
    let reason = |refusal| match refusal {
        Refusal::Kind => "stay by their type (see boundary, split_complex, feature_angle)",
        Refusal::Odd => "have too many faces around them, or odd coordinates",
        Refusal::Distance => "are farther from the surface than largest_distance",
        Refusal::Shape => "would turn or fold a face, or leave a hole that cannot be filled",
        Refusal::Topology => "would change the topology",
        Refusal::Seam => "would tear a seam (see keep_seams)",
    };
    let named = Refusal::ALL.iter().zip(counts).filter(|(_, n)| **n > 0);
    let list: Vec<String> = named.map(|(refusal, n)| format!("{n} {}", reason(*refusal))).collect();
    let list = if list.is_empty() { "there are none".to_owned() } else { list.join(", ") };
    format!("of the vertices that are left {list}")
}

fn measures(found: &Decimated) -> Measures {
    let kinds = [SIMPLE, COMPLEX, BOUNDARY_VERTICES, INTERIOR_EDGE, CORNER];
    let mut rows = vec![
        (FACES, found.mesh.faces.len() as f64),
        (REMOVED, found.n_removed as f64),
        (SPLIT, found.n_split as f64),
        (LARGEST, found.largest_distance),
    ];
    rows.extend(kinds.into_iter().zip(VertexKind::ALL).map(|(quantity, kind)| {
        (quantity, found.kinds.iter().filter(|found| **found == Some(kind)).count() as f64)
    }));
    Measures(rows.iter().map(|(quantity, value)| Measure::of(quantity, *value)).collect())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;
    use mve_mesh::fixtures::{cube, mesh_of};

    use super::*;

    #[test]
    fn what_is_missed_is_said_and_types_are_given() {
        let mesh = cube(glam::DVec3::ZERO);
        let outputs = Trial::of(&MODULE).input("mesh", mesh).set("target_faces", 4).run();
        let outputs = outputs.expect("a result");
        let types = outputs["types"].get::<Field>().expect("a field");
        assert_eq!(types.values, [4.0; 8]);
        let left = outputs["mesh"].get::<TriMesh>().expect("a mesh");
        assert_eq!(left.faces.len(), 12);
    }

    #[test]
    fn a_distance_alone_ends_the_work() {
        // The vertex in the middle of a square lies 0.1 above it; the diagonal is √2.01.
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.5, 0.1]];
        let mesh = mesh_of(&points, &[[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]);
        for (part, n_faces) in [(0.04, 4), (0.06, 2)] {
            let trial = Trial::of(&MODULE).input("mesh", mesh.clone()).set("ratio", None::<f64>);
            let trial = trial.set("importance", "MeanPlane").set("largest_distance", part);
            let outputs = trial.run().expect("a result");
            let left = outputs["mesh"].get::<TriMesh>().expect("a mesh");
            assert_eq!(left.faces.len(), n_faces, "{part}");
        }
    }
}
