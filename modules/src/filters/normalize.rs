//! Brings a mesh to a standard place, size and orientation.

use crate::geometry::edit::place::{Center, Extent, Placing, placing};
use crate::geometry::edit::transform::{matrix_to_text, transformed};
use crate::prelude::*;

impl Enumeration for Center {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Box", "The middle of the bounding box."),
        ("Area", "The center of the surface, by area; it does not depend on the triangles."),
        (
            "Ground",
            "The middle of the bounding box along x and y and its lowest z: the mesh stands.",
        ),
        ("Kept", "Nothing: the mesh is turned and scaled around the origin."),
    ];
    const VALUES: &'static [Self] = &[Self::Box, Self::Area, Self::Ground, Self::Kept];
}

impl Enumeration for Extent {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Diagonal", "The diagonal of the bounding box."),
        ("LongestSide", "The longest side of the bounding box."),
        ("SizeX", "Its length along x."),
        ("SizeY", "Its length along y."),
        ("SizeZ", "Its length along z: the height."),
        ("Kept", "Nothing: the mesh keeps its size."),
    ];
    const VALUES: &'static [Self] = &[
        Self::Diagonal,
        Self::LongestSide,
        Self::Along(0),
        Self::Along(1),
        Self::Along(2),
        Self::Kept,
    ];
}

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh.");
const ALIGN: Param<bool> = Param::flag(
    "align",
    "Whether the principal axes of the surface are turned to x, y and z, the longest to x (PCA). \
     They are those of the area, whatever the triangles; along x and y the heavier tail comes to \
     the positive side. A surface that is as long in two directions has no axes of its own there.",
    false,
);
const CENTER: Param<Center> = Param::one_of("center", "What comes to the origin.", "Box");
const EXTENT: Param<Extent> =
    Param::one_of("extent", "What comes to the size that is given.", "Diagonal");
const SIZE: Param<f64> =
    Param::number("size", "The size; without an effect where it is kept.", 1.0)
        .within((1e-9, 1e9))
        .usually((0.1, 100.0))
        .unit("model units");
const MESH_OUT: Out<TriMesh> =
    Out::new("mesh", "The mesh; all sides are scaled alike, and normals go along.");
const MATRIX_OUT: Out<String> = Out::new(
    "matrix",
    "The map as 16 numbers row by row, which Transform takes to do the same to another mesh.",
);

pub static MODULE: Module = Module {
    id: "Normalize",
    summary: "Centers a mesh, scales it to a size and turns it to its principal axes.",
    inputs: &[MESH_IN.spec()],
    outputs: &[MESH_OUT.spec(), MATRIX_OUT.spec()],
    params: &[ALIGN.spec(), CENTER.spec(), EXTENT.spec(), SIZE.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let mesh = io.take(MESH_IN)?;
    let how = Placing {
        is_aligned: io.param(ALIGN)?,
        center: io.param(CENTER)?,
        extent: io.param(EXTENT)?,
        size: io.param(SIZE)?,
    };
    let control = io.control();
    let (map, has_size) = placing(&mesh, &how, control.part(0.0, 0.6))?;
    if !has_size {
        io.warn("the mesh has no extent to scale: its size is kept");
    }
    io.put(MESH_OUT, transformed(mesh, &map, control.part(0.6, 1.0))?);
    io.put(MATRIX_OUT, matrix_to_text(&map));
    Ok(())
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use mve_core::testing::Trial;
    use mve_mesh::fixtures::{cube, mesh_of};

    use crate::prelude::*;

    #[test]
    fn a_cube_gets_its_height_and_stands() {
        let trial = Trial::of(&super::MODULE).input("mesh", cube(DVec3::splat(7.0)));
        let trial = trial.set("center", "Ground").set("extent", "SizeZ").set("size", 4.0);
        let outputs = trial.run().unwrap();
        let bounds = outputs["mesh"].get::<TriMesh>().unwrap().bounds();
        assert_eq!(bounds, Some((DVec3::new(-2.0, -2.0, 0.0), DVec3::new(2.0, 2.0, 4.0))));
        let matrix = outputs["matrix"].get::<String>().unwrap();
        assert_eq!(*matrix, "4 0 0 -30\n0 4 0 -30\n0 0 4 -28\n0 0 0 1");
    }

    #[test]
    fn one_point_is_centered_and_has_no_size() {
        let trial = || Trial::of(&super::MODULE).input("mesh", mesh_of(&[[3.0; 3]], &[]));
        let outputs = trial().run().unwrap();
        assert_eq!(outputs["mesh"].get::<TriMesh>().unwrap().positions, [DVec3::ZERO]);
        assert!(trial().log().unwrap()[0].contains("no extent"));
        assert!(trial().set("extent", "Kept").log().unwrap().is_empty());
    }
}
