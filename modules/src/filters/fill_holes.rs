//! Closes holes of a surface.
//!
//! Unlike in MeshLab, the best of all triangulations of a hole is found, and what is filled can go
//! on as smoothly as the surface around it.

use crate::geometry::edit::holes::{HoleWeight, fill_holes};
use crate::geometry::remesh::patch::smooth_patches;
use crate::prelude::*;

impl Enumeration for HoleWeight {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        (
            "Angle",
            "Least bent: the sharpest edge counts first, those to the surface around the hole among \
             them, then the area (Liepa 2003).",
        ),
        ("Area", "Least area, as a soap film would be (Barequet & Sharir 1995)."),
    ];
    const VALUES: &'static [Self] = &[Self::Angle, Self::Area];
}

#[derive(Clone, Copy)]
enum Fill {
    Flat,
    Smooth,
}

impl Enumeration for Fill {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Flat", "Triangles between the vertices of the border alone."),
        (
            "Smooth",
            "As fine as the surface around the hole, and going on as smoothly (Liepa 2003).",
        ),
    ];
    const VALUES: &'static [Self] = &[Self::Flat, Self::Smooth];
}

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh.");
const MAX_EDGES: Param<i64> = Param::integer(
    "max_edges",
    "Holes with more edges stay, such as the rim of an open surface. The time grows with the cube \
     of the edges of a hole: a thousand take many seconds.",
    100,
)
.between((3, 2000))
.mostly((3, 200))
.unit("edges");
const WEIGHT: Param<HoleWeight> =
    Param::one_of("weight", "Which triangles fill a hole best.", "Angle");
const FILL: Param<Fill> = Param::one_of("fill", "How holes are filled.", "Flat");
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "The mesh, its new faces behind its own and looking the same way. Corners of new faces have \
     the values of the faces around the hole, and faces their material and group.",
);
const FILLED_OUT: Out<f64> = Out::number(Quantity::new("filled", "Holes that were filled."));
const LEFT_OUT: Out<f64> = Out::number(Quantity::new(
    "left",
    "Holes that stay: those with too many edges, and those that cannot be filled.",
));

pub static MODULE: Module = Module {
    id: "FillHoles",
    summary: "Closes holes, flat or as smoothly as the surface around them.",
    inputs: &[MESH_IN.spec()],
    outputs: &[MESH_OUT.spec(), FILLED_OUT.spec(), LEFT_OUT.spec()],
    params: &[MAX_EDGES.spec(), WEIGHT.spec(), FILL.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let mesh = io.get(MESH_IN)?;
    let (max_edges, weight) = (io.param(MAX_EDGES)? as usize, io.param(WEIGHT)?);
    let control = io.control();
    let (end, fill) = match io.param(FILL)? {
        Fill::Flat => (1.0, None),
        Fill::Smooth => (0.5, Some(control.part(0.5, 1.0))),
    };
    let found = fill_holes(&mesh, max_edges, weight, control.part(0.0, end))?;
    if found.n_too_long > 0 {
        io.warn(format!("{} holes stay: they have more than {max_edges} edges", found.n_too_long));
    }
    if found.n_unfillable > 0 {
        io.warn(format!(
            "{} borders cannot be filled: they run into edges of three faces or turned ones, have \
             points that are not finite, or are the outline of a face alone; Clean and OrientFaces \
             help",
            found.n_unfillable
        ));
    }
    let filled = match fill {
        None => found.mesh,
        Some(part) => {
            let patched = smooth_patches(found.mesh, mesh.faces.len(), part)?;
            if !patched.is_solved {
                io.warn("a hole is too large to be smoothed to the end; it is nearly smooth");
            }
            patched.mesh
        }
    };
    io.put(MESH_OUT, filled);
    io.put(FILLED_OUT, found.n_filled as f64);
    io.put(LEFT_OUT, (found.n_too_long + found.n_unfillable) as f64);
    Ok(())
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use mve_core::testing::Trial;
    use mve_mesh::fixtures::cube;

    use crate::prelude::*;

    #[test]
    fn a_cube_without_its_lid_is_closed_unless_the_hole_is_too_long() {
        let mut mesh = cube(DVec3::ZERO);
        mesh.faces.drain(2..4);
        let trial = || Trial::of(&super::MODULE).input("mesh", mesh.clone());
        let outputs = trial().run().unwrap();
        assert_eq!(outputs["mesh"].get::<TriMesh>().unwrap().signed_volume(), 1.0);
        assert_eq!(outputs["filled"].get::<f64>().as_deref(), Some(&1.0));
        let outputs = trial().set("max_edges", 3).run().unwrap();
        assert_eq!(outputs["left"].get::<f64>().as_deref(), Some(&1.0));
        assert!(trial().set("max_edges", 3).log().unwrap()[0].contains("1 holes stay"));
    }
}
