//! Simplifies a mesh by putting its vertices into cells, one vertex for each.

use mve_core::{Condition, MissedTarget, Quantities};
use mve_mesh::data::Measure;

use crate::geometry::cluster::build::Duplicates;
use crate::geometry::cluster::importance::Weights;
use crate::geometry::cluster::place::Representative;
use crate::geometry::cluster::search::TOLERANCE;
use crate::geometry::cluster::{CellKind, ClusterError, ClusterOptions, Size, cluster};
use crate::prelude::*;

impl Enumeration for CellKind {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Uniform", "Those of a grid over the bounding box (Rossignac and Borrel 1993)."),
        (
            "Floating",
            "Cells around vertices, the most important first (Low and Tan 1997): more even, and a \
             little slower.",
        ),
    ];
    const VALUES: &'static [Self] = &[Self::Uniform, Self::Floating];
}

impl Enumeration for Representative {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Important", "The most important of its vertices: the result has none that is new."),
        ("Mean", "The mean of its vertices."),
        ("Quadric", "The point of least quadric error (Lindstrom 2000): the least error."),
    ];
    const VALUES: &'static [Self] = &[Self::Important, Self::Mean, Self::Quadric];
}

#[derive(Clone, Copy)]
enum SizeBy {
    Faces,
    Ratio,
    Cells,
    Edge,
    Shift,
}

impl Enumeration for SizeBy {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Faces", "As it takes for so many faces, within 1 % where a size of cells gives that."),
        ("Ratio", "The same for a part of the input's faces."),
        ("Cells", "So many cells along the longest side of the bounding box."),
        ("Edge", "The length of a cell's edge."),
        ("Shift", "As it takes for vertices to move so far in the mean, within 1 %."),
    ];
    const VALUES: &'static [Self] =
        &[Self::Faces, Self::Ratio, Self::Cells, Self::Edge, Self::Shift];
}

impl Enumeration for Duplicates {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Keep", "All stay."),
        ("Once", "Of those that turn the same way the first stays."),
        ("Cancel", "The same; two that turn against each other go both: a plate that became flat."),
    ];
    const VALUES: &'static [Self] = &[Self::Keep, Self::Once, Self::Cancel];
}

const MESH_IN: In<TriMesh> = In::new("mesh", "Any heap of triangles.");
const CELLS: Param<CellKind> = Param::one_of("cells", "What vertices are put into.", "Uniform");
const SIZE_BY: Param<SizeBy> = Param::one_of("size_by", "What says how large cells are.", "Faces");
const TARGET_FACES: Param<i64> = Param::integer("target_faces", "Faces to be left.", 1000)
    .between((1, i64::MAX))
    .mostly((100, 100_000))
    .only_where(Condition::Is { param: "size_by", value: "Faces" });
const RATIO: Param<f64> = Param::number("ratio", "The part of the input's faces to be left.", 0.1)
    .within((0.0, 1.0))
    .usually((0.001, 1.0))
    .only_where(Condition::Is { param: "size_by", value: "Ratio" });
const CELLS_AN_AXIS: Param<i64> =
    Param::integer("cells_an_axis", "Cells along the longest side of the bounding box.", 50)
        .between((1, 1 << 20))
        .mostly((10, 500))
        .only_where(Condition::Is { param: "size_by", value: "Cells" });
const CELL_EDGE: Param<f64> = Param::number("cell_edge", "Length of a cell's edge.", 0.1)
    .within((f64::MIN_POSITIVE, f64::MAX))
    .usually((0.001, 1.0))
    .only_where(Condition::Is { param: "size_by", value: "Edge" });
const SHIFT: Param<f64> = Param::number(
    "shift",
    "How far vertices move in the mean, as a part of the diagonal of the bounding box.",
    0.01,
)
.within((1e-9, 1.0))
.usually((0.001, 0.1))
.only_where(Condition::Is { param: "size_by", value: "Shift" });
const REPRESENTATIVE: Param<Representative> =
    Param::one_of("representative", "The point that stands for a cell.", "Quadric");
const LENGTH_WEIGHT: Param<f64> = Param::number(
    "length_weight",
    "How much the longest edge at a vertex, over the longest of the mesh, counts in the importance \
     of the vertex.",
    1.0,
)
.within((0.0, 1e6))
.usually((0.0, 10.0));
const ANGLE_WEIGHT: Param<f64> = Param::number(
    "angle_weight",
    "How much cos(φ/2) counts in it, with φ the least angle between two edges at the vertex.",
    1.0,
)
.within((0.0, 1e6))
.usually((0.0, 10.0));
const LEVELS: Param<i64> = Param::integer(
    "levels",
    "Rounds; each has cells twice as large as those of the round before, on what that one left.",
    1,
)
.between((1, 16))
.mostly((1, 4));
const DUPLICATES: Param<Duplicates> =
    Param::one_of("duplicates", "What becomes of faces with the same three vertices.", "Once");
const MANIFOLD: Param<bool> = Param::flag(
    "manifold",
    "Whether parts of the surface that share no edge within a cell stay apart, and the surface is \
     cut open where it would not be manifold.",
    false,
);
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "The faces with corners in three cells. Corners and faces keep their attributes; a vertex has \
     those of the vertex that stands for its cell, or of the nearest one there.",
);
const FACES: Quantity = Quantity::new("faces", "Faces of the result.").titled("faces").size();
const CLUSTERS: Quantity =
    Quantity::new("clusters", "Cells that have vertices.").titled("clusters");
const EDGE: Quantity = Quantity::new("cell_edge", "Length of a cell's edge.")
    .titled("cell edge")
    .in_unit(Unit::LENGTH);
const MEAN_SHIFT: Quantity =
    Quantity::new("mean_shift", "How far vertices moved in the mean, in the last round.")
        .titled("mean shift")
        .in_unit(Unit::LENGTH)
        .lower();
const STATISTICS_OUT: Out<Measures> = Out::new("statistics", "What was done.")
    .giving(Quantities::Row(&[FACES, CLUSTERS, EDGE, MEAN_SHIFT]));

pub static MODULE: Module = Module {
    id: "ClusterVertices",
    summary: "Simplifies any heap of triangles at once: the vertices in a cell become one.",
    inputs: &[MESH_IN.spec()],
    outputs: &[MESH_OUT.spec(), STATISTICS_OUT.spec()],
    params: &[
        CELLS.spec(),
        SIZE_BY.spec(),
        TARGET_FACES.spec(),
        RATIO.spec(),
        CELLS_AN_AXIS.spec(),
        CELL_EDGE.spec(),
        SHIFT.spec(),
        REPRESENTATIVE.spec(),
        LENGTH_WEIGHT.spec(),
        ANGLE_WEIGHT.spec(),
        LEVELS.spec(),
        DUPLICATES.spec(),
        MANIFOLD.spec(),
    ],
    run,
};

/// Bytes that the work takes for a face of the input.
const BYTES_A_FACE: usize = 64;

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let mesh = io.get(MESH_IN)?;
    io.reserve(mesh.faces.len() * BYTES_A_FACE)?;
    let size = match io.param(SIZE_BY)? {
        SizeBy::Faces => {
            Size::Faces(usize::try_from(io.param(TARGET_FACES)?).unwrap_or(usize::MAX))
        }
        SizeBy::Ratio => Size::Faces((io.param(RATIO)? * mesh.faces.len() as f64).round() as usize),
        SizeBy::Cells => Size::PerAxis(io.param(CELLS_AN_AXIS)?.unsigned_abs()),
        SizeBy::Edge => Size::Edge(io.param(CELL_EDGE)?),
        SizeBy::Shift => Size::Shift(io.param(SHIFT)?),
    };
    let options = ClusterOptions {
        cells: io.param(CELLS)?,
        size,
        representative: io.param(REPRESENTATIVE)?,
        weights: Weights { length: io.param(LENGTH_WEIGHT)?, angle: io.param(ANGLE_WEIGHT)? },
        levels: io.param(LEVELS)?.clamp(1, 16) as u32,
        duplicates: io.param(DUPLICATES)?,
        is_manifold: io.param(MANIFOLD)?,
    };
    let found = cluster(&mesh, &options, io.control()).map_err(|error| match error {
        ClusterError::Cancelled(cancelled) => cancelled.into(),
        ClusterError::TooSmall(_) => ModuleError::param(&CELL_EDGE, error.to_string()),
    })?;
    let n_faces = found.mesh.faces.len();
    if let Size::Faces(asked) = size
        && asked < mesh.faces.len()
        && (n_faces as f64 / asked as f64 - 1.0).abs() > TOLERANCE
    {
        let (asked, reached) = (asked as f64, n_faces as f64);
        let missed = MissedTarget { what: FACES.name.to_owned(), asked, reached };
        io.missed(missed, format!("no size of cells gives {asked} faces; {reached} is nearest"));
    }
    let measures = [
        (FACES, n_faces as f64),
        (CLUSTERS, found.n_clusters as f64),
        (EDGE, found.edge),
        (MEAN_SHIFT, found.shift),
    ];
    let measures = measures.iter().map(|(quantity, value)| Measure::of(quantity, *value));
    io.put(STATISTICS_OUT, Measures(measures.collect()));
    io.put(MESH_OUT, found.mesh);
    Ok(())
}
