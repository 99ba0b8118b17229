//! Cuts every face into four.
//!
//! Midpoint keeps the surface as it is, Loop rounds it off, Butterfly goes smoothly through all of
//! its vertices; layers are interpolated in each. There is no Catmull-Clark: it is for polygons, of
//! which a mesh has none, as loaders cut them into triangles.

use crate::geometry::surface::subdivide::{Scheme, SubdivideError, subdivide};
use crate::prelude::*;

impl Enumeration for Scheme {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Midpoint", "New vertices in the middle of edges: the same surface in smaller faces."),
        ("Loop", "The smooth scheme of Loop (1987); borders and non-manifold edges are creases."),
        (
            "Butterfly",
            "The modified butterfly scheme (Zorin et al. 1996): old vertices stay, new ones lie on \
             a smooth surface through them; creases as for Loop.",
        ),
    ];
    const VALUES: &'static [Self] = &[Self::Midpoint, Self::Loop, Self::Butterfly];
}

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh.");
const SCHEME: Param<Scheme> = Param::one_of("scheme", "Where the vertices go.", "Loop");
const LEVELS: Param<i64> = Param::integer(
    "levels",
    "How often each face is cut into four; 0 leaves the mesh as it is. A result of more than 67,108,864 faces is refused.",
    1,
)
.between((0, 13))
.mostly((1, 4));
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "The subdivided mesh with all layers; the vertices of the input come first, in their order.",
);

pub static MODULE: Module = Module {
    id: "Subdivide",
    summary: "Cuts every face into four, by midpoints or by the smooth schemes Loop or butterfly.",
    inputs: &[MESH_IN.spec()],
    outputs: &[MESH_OUT.spec()],
    params: &[SCHEME.spec(), LEVELS.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let mesh = io.take(MESH_IN)?;
    let (scheme, levels) = (io.param(SCHEME)?, io.param(LEVELS)? as u32);
    let mesh = subdivide(mesh, scheme, levels, io.control()).map_err(|e| match e {
        SubdivideError::Cancelled(cancelled) => cancelled.into(),
        too_many => ModuleError::input(&MESH_IN, too_many.to_string()),
    })?;
    io.put(MESH_OUT, mesh);
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;
    use mve_mesh::fixtures::{tetrahedron, torus};

    use crate::prelude::*;

    #[test]
    fn schemes_and_levels_are_heard() {
        let run = |scheme: &str, levels: i64| -> TriMesh {
            let trial = Trial::of(&super::MODULE).input("mesh", tetrahedron());
            let outputs = trial.set("scheme", scheme).set("levels", levels).run().unwrap();
            outputs["mesh"].clone().take().unwrap()
        };
        assert!((run("Midpoint", 3).signed_volume() - 1.0 / 6.0).abs() < 1e-15);
        assert_eq!(run("Midpoint", 3).faces.len(), 256);
        assert!(run("Loop", 1).signed_volume() < 0.1);
        assert!(run("Butterfly", 1).signed_volume() > 1.0 / 6.0);
    }

    #[test]
    fn what_would_not_fit_is_refused_with_its_number() {
        let trial = Trial::of(&super::MODULE).input("mesh", torus(1.0, 0.3, 8));
        let message = trial.set("levels", 13).run().unwrap_err().to_string();
        assert!(message.contains("13 levels would make 8589934592 faces"), "{message}");
    }
}
