//! Takes out of a mesh what makes trouble for other programs, and says how much there was.

use mve_core::Quantities;
use mve_mesh::data::Measure;

use crate::geometry::edit::clean::{CleanOptions, clean};
use crate::geometry::edit::manifold::Repair;
use crate::prelude::*;

impl Enumeration for Repair {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        (
            "Split",
            "The surface is cut open there: each part gets vertices of its own (Guéziec et \
          al. 2001). No face is lost.",
        ),
        (
            "Removed",
            "Faces are left out until it is manifold: the smallest ones at an edge, all \
          but the largest group at a vertex.",
        ),
        ("Kept", "They are counted and stay."),
    ];
    const VALUES: &'static [Self] = &[Self::Split, Self::Removed, Self::Kept];
}

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh.");
const NON_FINITE: Param<bool> = Param::flag(
    "non_finite",
    "Whether faces with a corner that is not a finite point are left out.",
    true,
);
const DEGENERATE: Param<bool> = Param::flag(
    "degenerate",
    "Whether faces that name a vertex twice, or have no area at all, are left out. One with three \
     corners in a line leaves a slit where it was.",
    true,
);
const DUPLICATE: Param<bool> = Param::flag(
    "duplicate",
    "Whether faces with the same three vertices as an earlier one are left out, turned or not.",
    true,
);
const EDGES: Param<Repair> =
    Param::one_of("edges", "What happens at edges of more than two faces.", "Split");
const VERTICES: Param<Repair> = Param::one_of(
    "vertices",
    "What happens at vertices where parts of the surface touch that share no edge there.",
    "Split",
);
const UNREFERENCED: Param<bool> =
    Param::flag("unreferenced", "Whether vertices without a face are left out.", true);
const MESH_OUT: Out<TriMesh> =
    Out::new("mesh", "The cleaned mesh; what is left keeps its order and its layers.");

const NON_FINITE_FACES: Quantity =
    Quantity::new("non_finite_faces", "Faces with a corner that is not a finite point.");
const DEGENERATE_FACES: Quantity =
    Quantity::new("degenerate_faces", "Faces that name a vertex twice, or have no area.");
const DUPLICATE_FACES: Quantity =
    Quantity::new("duplicate_faces", "Faces with the vertices of an earlier one.");
const NON_MANIFOLD_EDGES: Quantity =
    Quantity::new("non_manifold_edges", "Edges of more than two faces.");
const NON_MANIFOLD_VERTICES: Quantity =
    Quantity::new("non_manifold_vertices", "Vertices where parts of the surface touch.");
const COPIED_VERTICES: Quantity =
    Quantity::new("copied_vertices", "Copies of vertices, made where the surface was cut open.");
const REMOVED_FACES: Quantity =
    Quantity::new("removed_faces", "Faces left out to make edges and vertices manifold.");
const UNREFERENCED_VERTICES: Quantity =
    Quantity::new("unreferenced_vertices", "Vertices without a face, at the end.");
const FOUND_OUT: Out<Measures> = Out::new(
    "found",
    "How many of each there were, in the order of the steps; each looks at what those before it \
     have left.",
)
.giving(Quantities::Row(&[
    NON_FINITE_FACES,
    DEGENERATE_FACES,
    DUPLICATE_FACES,
    NON_MANIFOLD_EDGES,
    NON_MANIFOLD_VERTICES,
    COPIED_VERTICES,
    REMOVED_FACES,
    UNREFERENCED_VERTICES,
]));

pub static MODULE: Module = Module {
    id: "Clean",
    summary: "Removes degenerate and duplicate faces and loose vertices, and makes a mesh manifold.",
    inputs: &[MESH_IN.spec()],
    outputs: &[MESH_OUT.spec(), FOUND_OUT.spec()],
    params: &[
        NON_FINITE.spec(),
        DEGENERATE.spec(),
        DUPLICATE.spec(),
        EDGES.spec(),
        VERTICES.spec(),
        UNREFERENCED.spec(),
    ],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let mesh = io.take(MESH_IN)?;
    let options = CleanOptions {
        non_finite: io.param(NON_FINITE)?,
        degenerate: io.param(DEGENERATE)?,
        duplicate: io.param(DUPLICATE)?,
        edges: io.param(EDGES)?,
        vertices: io.param(VERTICES)?,
        unreferenced: io.param(UNREFERENCED)?,
    };
    let (mesh, counts) = clean(mesh, &options, io.control())?;
    let found = [
        (NON_FINITE_FACES, counts.n_non_finite),
        (DEGENERATE_FACES, counts.n_degenerate),
        (DUPLICATE_FACES, counts.n_duplicate),
        (NON_MANIFOLD_EDGES, counts.n_edges),
        (NON_MANIFOLD_VERTICES, counts.n_vertices),
        (COPIED_VERTICES, counts.n_copies),
        (REMOVED_FACES, counts.n_removed),
        (UNREFERENCED_VERTICES, counts.n_unreferenced),
    ];
    let measures = found.iter().map(|(quantity, n)| Measure::of(quantity, *n as f64));
    io.put(FOUND_OUT, Measures(measures.collect()));
    io.put(MESH_OUT, mesh);
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;
    use mve_mesh::fixtures::mesh_of;

    use crate::prelude::*;

    /// Three faces at an edge, one of them doubled, and a vertex alone.
    fn trial() -> Trial {
        let points = [
            [0.0; 3],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 2.0],
            [0.0, -3.0, 0.0],
            [9.0; 3],
        ];
        let mesh = mesh_of(&points, &[[0, 1, 2], [0, 1, 3], [1, 0, 4], [3, 1, 0]]);
        Trial::of(&super::MODULE).input("mesh", mesh)
    }

    #[test]
    fn what_was_found_is_counted() {
        let outputs = trial().run().unwrap();
        let counts = |outputs: &mve_core::testing::Outputs| -> Vec<f64> {
            outputs["found"].get::<Measures>().unwrap().0.iter().map(|m| m.value).collect()
        };
        assert_eq!(counts(&outputs), [0.0, 0.0, 1.0, 1.0, 0.0, 4.0, 0.0, 1.0]);
        let mesh = outputs["mesh"].get::<TriMesh>().unwrap();
        assert_eq!((mesh.positions.len(), mesh.area()), (9, 3.0));
        let outputs = trial().set("edges", "Removed").run().unwrap();
        assert_eq!(counts(&outputs), [0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 2.0]);
        assert_eq!(outputs["mesh"].get::<TriMesh>().unwrap().area(), 2.5);
    }
}
