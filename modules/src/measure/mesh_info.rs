//! Counts, topology, area, volume and bounds of a mesh.

use glam::DVec3;

use crate::geometry::surface::mesh_info::mesh_info;
use crate::prelude::*;

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh.");

const SQUARED: Unit = Unit::Model("model units²");
const CUBED: Unit = Unit::Model("model units³");

macro_rules! numbers {
    ($($port:ident: $name:literal, $doc:literal $(, $more:ident($($unit:expr)?))?;)+) => {
        $(const $port: Out<f64> =
            Out::number(Quantity::new($name, $doc)$(.$more($($unit)?))?);)+
    };
}

numbers! {
    FACES: "faces", "Faces, degenerate and doubled ones included.", size();
    VERTICES: "vertices", "Vertices, with and without faces.";
    EDGES: "edges", "Pairs of different vertices that are a side of some face.";
    COMPONENTS: "components", "Parts of the surface, faces being together over shared edges.";
    BORDER_EDGES: "border_edges", "Edges of one face.";
    BORDER_LOOPS: "border_loops", "Runs of border edges.";
    NON_MANIFOLD_EDGES: "non_manifold_edges", "Edges of more than two faces.";
    NON_MANIFOLD_VERTICES: "non_manifold_vertices", "Vertices where parts of the surface touch.";
    TURNED_EDGES: "turned_edges", "Edges of two faces that do not have the same side outside.";
    DOUBLED_VERTICES: "doubled_vertices", "Vertices at the place of an earlier one.";
    ISOLATED_VERTICES: "isolated_vertices", "Vertices without a face.";
    DUPLICATE_FACES: "duplicate_faces", "Faces with the vertices of an earlier one.";
    FLAT_FACES: "flat_faces", "Faces without area.";
    FOLDED_EDGES: "folded_edges", "Edges of two faces folded onto each other, by over 150°.", lower();
    SLIVERS: "slivers", "Faces with an angle of less than 1°, flat ones among them.", lower();
    EULER: "euler", "Euler characteristic: vertices with faces, less edges, plus faces.";
    GENUS: "genus", "Handles; not a number unless the mesh is manifold and oriented.";
    AREA: "area", "Sum over the faces.", in_unit(SQUARED);
    VOLUME: "volume", "Not a number unless the surface bounds one.", in_unit(CUBED);
    DIAGONAL: "diagonal", "Diagonal of the bounding box.", in_unit(Unit::LENGTH);
    SIZE_X: "size_x", "Extent along x.", in_unit(Unit::LENGTH);
    SIZE_Y: "size_y", "Extent along y.", in_unit(Unit::LENGTH);
    SIZE_Z: "size_z", "Extent along z.", in_unit(Unit::LENGTH);
}

const CLOSED: Out<bool> = Out::new("closed", "Whether there are faces and no border edges.");
const MANIFOLD: Out<bool> =
    Out::new("manifold", "Whether each point has a neighborhood like a disk or half a disk.");

pub static MODULE: Module = Module {
    id: "MeshInfo",
    summary: "Counts, topology, area, volume and bounds of a mesh.",
    inputs: &[MESH_IN.spec()],
    outputs: &[
        FACES.spec(),
        VERTICES.spec(),
        EDGES.spec(),
        COMPONENTS.spec(),
        CLOSED.spec(),
        MANIFOLD.spec(),
        BORDER_EDGES.spec(),
        BORDER_LOOPS.spec(),
        NON_MANIFOLD_EDGES.spec(),
        NON_MANIFOLD_VERTICES.spec(),
        TURNED_EDGES.spec(),
        DOUBLED_VERTICES.spec(),
        ISOLATED_VERTICES.spec(),
        DUPLICATE_FACES.spec(),
        FLAT_FACES.spec(),
        FOLDED_EDGES.spec(),
        SLIVERS.spec(),
        EULER.spec(),
        GENUS.spec(),
        AREA.spec(),
        VOLUME.spec(),
        DIAGONAL.spec(),
        SIZE_X.spec(),
        SIZE_Y.spec(),
        SIZE_Z.spec(),
    ],
    params: &[],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let mesh = io.get(MESH_IN)?;
    let info = mesh_info(&mesh, io.control())?;
    let size = info.bounds.map_or(DVec3::ZERO, |(low, high)| high - low);
    let numbers = [
        (FACES, info.n_faces as f64),
        (VERTICES, info.n_vertices as f64),
        (EDGES, info.n_edges as f64),
        (COMPONENTS, info.n_components_by_edge as f64),
        (BORDER_EDGES, info.n_border_edges as f64),
        (BORDER_LOOPS, info.n_border_loops as f64),
        (NON_MANIFOLD_EDGES, info.n_non_manifold_edges as f64),
        (NON_MANIFOLD_VERTICES, info.n_non_manifold_vertices as f64),
        (TURNED_EDGES, info.n_inconsistent_edges as f64),
        (DOUBLED_VERTICES, info.n_doubled_vertices as f64),
        (ISOLATED_VERTICES, info.n_isolated_vertices as f64),
        (DUPLICATE_FACES, info.n_duplicate_faces as f64),
        (FLAT_FACES, info.n_zero_area_faces as f64),
        (FOLDED_EDGES, info.n_folded_edges as f64),
        (SLIVERS, info.n_slivers as f64),
        (EULER, info.euler_characteristic as f64),
        (GENUS, info.genus.map_or(f64::NAN, |genus| genus as f64)),
        (AREA, info.area),
        (VOLUME, info.volume.unwrap_or(f64::NAN)),
        (DIAGONAL, info.diagonal()),
        (SIZE_X, size.x),
        (SIZE_Y, size.y),
        (SIZE_Z, size.z),
    ];
    if info.n_coincident_border_edges > 0 {
        io.warn(format!(
            "{} of {} border edges lie on another one: the surface looks whole there, but its faces \
             share no vertices; Weld joins them",
            info.n_coincident_border_edges, info.n_border_edges
        ));
    }
    for (port, number) in numbers {
        io.put(port, number);
    }
    io.put(CLOSED, info.is_closed());
    io.put(MANIFOLD, info.is_manifold());
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;

    use mve_mesh::fixtures::tetrahedron;

    #[test]
    fn a_tetrahedron_by_hand() {
        let trial = Trial::of(&super::MODULE).input("mesh", tetrahedron());
        let outputs = trial.run().unwrap();
        let number = |name: &str| *outputs[name].get::<f64>().unwrap();
        assert_eq!([number("faces"), number("edges"), number("euler")], [4.0, 6.0, 2.0]);
        assert_eq!(number("genus"), 0.0);
        assert!((number("volume") - 1.0 / 6.0).abs() < 1e-15);
        assert_eq!(outputs["closed"].get::<bool>().as_deref(), Some(&true));
    }
}
