//! Makes the faces of a mesh look the same way, those of closed parts outwards.

use crate::geometry::edit::orient::{orient, turned};
use crate::prelude::*;

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh.");
const OUTWARD: Param<bool> = Param::flag(
    "outward",
    "Whether closed components come to look outwards, by the sign of their volume. So do inner \
     walls of a hollow body: off, each component keeps the side that most of its faces have.",
    true,
);
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "The mesh with as few faces turned over as will do; values of corners go along, and normals \
     of turned faces point the other way.",
);
const TURNED_OUT: Out<f64> = Out::number(Quantity::new("turned", "Faces that were turned over."));
const TURNED_EDGES_OUT: Out<f64> = Out::number(
    Quantity::new("turned_edges", "Edges whose two faces look different ways still.").lower(),
);

pub static MODULE: Module = Module {
    id: "OrientFaces",
    summary: "Turns faces over so that neighbors look the same way, and closed parts outwards.",
    inputs: &[MESH_IN.spec()],
    outputs: &[MESH_OUT.spec(), TURNED_OUT.spec(), TURNED_EDGES_OUT.spec()],
    params: &[OUTWARD.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let mesh = io.take(MESH_IN)?;
    let control = io.control();
    let found = orient(&mesh, io.param(OUTWARD)?, control.part(0.0, 0.8))?;
    if found.n_one_sided > 0 {
        io.warn(format!(
            "{} of {} components have one side only, like a Möbius strip: {} of their edges stay \
             turned",
            found.n_one_sided, found.n_components, found.n_turned_edges
        ));
    }
    if found.n_non_manifold_edges > 0 {
        io.warn(format!(
            "{} edges have more than two faces: the parts that meet there are oriented each for \
             itself; Clean cuts them apart",
            found.n_non_manifold_edges
        ));
    }
    let n_turned = found.is_turned.iter().filter(|is| **is).count();
    io.put(MESH_OUT, turned(mesh, &found.is_turned, control.part(0.8, 1.0))?);
    io.put(TURNED_OUT, n_turned as f64);
    io.put(TURNED_EDGES_OUT, found.n_turned_edges as f64);
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;

    use mve_mesh::fixtures::{mesh_of, tetrahedron};

    #[test]
    fn a_tetrahedron_inside_out_is_turned_unless_it_may_stay() {
        let mut inside_out = tetrahedron();
        inside_out.faces.iter_mut().for_each(|face| face.swap(1, 2));
        let n_turned = |outward: bool| {
            let trial = Trial::of(&super::MODULE).input("mesh", inside_out.clone());
            *trial.set("outward", outward).run().unwrap()["turned"].get::<f64>().unwrap()
        };
        assert_eq!((n_turned(true), n_turned(false)), (4.0, 0.0));
    }

    #[test]
    fn what_cannot_be_oriented_is_said() {
        let strip: Vec<[u32; 3]> = (0..5).map(|i| [i, (i + 1) % 5, (i + 2) % 5]).collect();
        let trial = Trial::of(&super::MODULE).input("mesh", mesh_of(&[[0.0; 3]; 5], &strip));
        assert!(trial.log().unwrap()[0].contains("1 of 1 components have one side only"));
        let book = mesh_of(&[[0.0; 3]; 5], &[[0, 1, 2], [0, 1, 3], [1, 0, 4]]);
        let trial = Trial::of(&super::MODULE).input("mesh", book);
        assert!(trial.log().unwrap()[0].contains("1 edges have more than two faces"));
    }
}
