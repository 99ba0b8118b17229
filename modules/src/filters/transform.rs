//! Moves, turns, scales and mirrors a mesh.
//!
//! Unlike in MeshLab, normals go along, and a map that mirrors turns the faces over too.

use glam::{DAffine3, DMat3, DVec3};
use mve_core::Condition;

use crate::geometry::edit::place::{bounds_of_points, finite_bounds};
use crate::geometry::edit::transform::{
    AxisOrder, matrix_from_text, transformed, transformed_part, turn_around, turn_by_angles,
};
use crate::geometry::select::chosen::chosen_vertices;
use crate::prelude::*;

impl Enumeration for AxisOrder {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("XYZ", "Around x, then y, then z."),
        ("XZY", "Around x, then z, then y."),
        ("YXZ", "Around y, then x, then z."),
        ("YZX", "Around y, then z, then x."),
        ("ZXY", "Around z, then x, then y."),
        ("ZYX", "Around z, then y, then x."),
    ];
    const VALUES: &'static [Self] =
        &[Self::Xyz, Self::Xzy, Self::Yxz, Self::Yzx, Self::Zxy, Self::Zyx];
}

#[derive(Clone, Copy)]
enum Turn {
    Angles,
    Axis,
}

impl Enumeration for Turn {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        (
            "Angles",
            "By an angle around each of the fixed axes, one after the other (Euler angles).",
        ),
        ("Axis", "By one angle around an axis of any direction."),
    ];
    const VALUES: &'static [Self] = &[Self::Angles, Self::Axis];
}

#[derive(Clone, Copy)]
enum Pivot {
    Origin,
    Box,
    Point,
}

impl Enumeration for Pivot {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Origin", "The origin."),
        ("Box", "The middle of the bounding box."),
        ("Point", "The point that is given."),
    ];
    const VALUES: &'static [Self] = &[Self::Origin, Self::Box, Self::Point];
}

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh.");
const SELECTION_IN: MaybeIn<Field> = MaybeIn::new(
    "selection",
    "The vertices that move, or faces whose vertices do; all without a link. Normals are computed \
     anew then.",
);
const SCALE: Param<f64> = Param::number("scale", "Factor of all lengths; below 0 it mirrors.", 1.0)
    .within((-1e9, 1e9))
    .usually((0.0, 10.0));
const SCALE_X: Param<f64> = factor("scale_x", "Factor along x, beside that of all lengths.");
const SCALE_Y: Param<f64> = factor("scale_y", "Factor along y, beside that of all lengths.");
const SCALE_Z: Param<f64> = factor("scale_z", "Factor along z, beside that of all lengths.");
const TURN: Param<Turn> =
    Param::one_of("turn", "How the mesh is turned, after it is scaled.", "Angles");
const TURN_X: Param<f64> = angle("turn_x", "Angle around x.", "Angles");
const TURN_Y: Param<f64> = angle("turn_y", "Angle around y.", "Angles");
const TURN_Z: Param<f64> = angle("turn_z", "Angle around z.", "Angles");
const ORDER: Param<AxisOrder> =
    Param::one_of("order", "The order of the three turns; Blender's is XYZ.", "XYZ")
        .only_where(Condition::Is { param: "turn", value: "Angles" });
const AXIS_X: Param<f64> = axis("axis_x", "The axis along x.", 0.0);
const AXIS_Y: Param<f64> = axis("axis_y", "The axis along y.", 0.0);
const AXIS_Z: Param<f64> = axis("axis_z", "The axis along z.", 1.0);
const ANGLE: Param<f64> =
    angle("angle", "Angle around the axis, counter-clockwise seen against it.", "Axis");
const PIVOT: Param<Pivot> =
    Param::one_of("pivot", "What stays in place while the mesh is scaled and turned.", "Origin");
const PIVOT_X: Param<f64> = pivot("pivot_x", "The point along x.");
const PIVOT_Y: Param<f64> = pivot("pivot_y", "The point along y.");
const PIVOT_Z: Param<f64> = pivot("pivot_z", "The point along z.");
const MOVE_X: Param<f64> = length("move_x", "Way along x, after the turn.");
const MOVE_Y: Param<f64> = length("move_y", "Way along y, after the turn.");
const MOVE_Z: Param<f64> = length("move_z", "Way along z, after the turn.");
const MATRIX: Param<String> = Param::text(
    "matrix",
    "A matrix that is applied last: 16 numbers row by row, of which the last four are 0 0 0 1, or \
     the first 12 alone; points are columns. Empty: none. Normalize puts out such a text.",
    "",
);
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "The mesh with its layers; normals and principal directions go along and stay unit vectors. \
     Where the mesh is mirrored, faces are turned over, so that their outer side stays outside.",
);

const fn factor(name: &'static str, doc: &'static str) -> Param<f64> {
    Param::number(name, doc, 1.0).within((-1e9, 1e9)).usually((-2.0, 2.0))
}

const fn length(name: &'static str, doc: &'static str) -> Param<f64> {
    Param::number(name, doc, 0.0).usually((-10.0, 10.0)).unit("model units")
}

const fn pivot(name: &'static str, doc: &'static str) -> Param<f64> {
    length(name, doc).only_where(Condition::Is { param: "pivot", value: "Point" })
}

const fn angle(name: &'static str, doc: &'static str, value: &'static str) -> Param<f64> {
    Param::number(name, doc, 0.0)
        .usually((-180.0, 180.0))
        .unit("degrees")
        .only_where(Condition::Is { param: "turn", value })
}

const fn axis(name: &'static str, doc: &'static str, default: f64) -> Param<f64> {
    Param::number(name, doc, default)
        .usually((-1.0, 1.0))
        .only_where(Condition::Is { param: "turn", value: "Axis" })
}

pub static MODULE: Module = Module {
    id: "Transform",
    summary: "Moves, turns, scales and mirrors a mesh, or applies a matrix to it.",
    inputs: &[MESH_IN.spec(), SELECTION_IN.spec()],
    outputs: &[MESH_OUT.spec()],
    params: &[
        SCALE.spec(),
        SCALE_X.spec(),
        SCALE_Y.spec(),
        SCALE_Z.spec(),
        TURN.spec(),
        TURN_X.spec(),
        TURN_Y.spec(),
        TURN_Z.spec(),
        ORDER.spec(),
        AXIS_X.spec(),
        AXIS_Y.spec(),
        AXIS_Z.spec(),
        ANGLE.spec(),
        PIVOT.spec(),
        PIVOT_X.spec(),
        PIVOT_Y.spec(),
        PIVOT_Z.spec(),
        MOVE_X.spec(),
        MOVE_Y.spec(),
        MOVE_Z.spec(),
        MATRIX.spec(),
    ],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let mesh = io.take(MESH_IN)?;
    let chosen = io.maybe(SELECTION_IN).map(|selection| chosen_vertices(&selection, &mesh));
    let chosen = chosen.transpose().map_err(|why| ModuleError::maybe_input(&SELECTION_IN, why))?;
    let vector = |[x, y, z]: [Param<f64>; 3]| -> Result<DVec3, ModuleError> {
        Ok(DVec3::new(io.param(x)?, io.param(y)?, io.param(z)?))
    };
    let turn = match io.param(TURN)? {
        Turn::Angles => turn_by_angles(vector([TURN_X, TURN_Y, TURN_Z])?, io.param(ORDER)?),
        Turn::Axis => turn_around(vector([AXIS_X, AXIS_Y, AXIS_Z])?, io.param(ANGLE)?)
            .ok_or_else(|| ModuleError::param(&AXIS_X, "the axis (0, 0, 0) has no direction"))?,
    };
    let bounds = || match &chosen {
        None => finite_bounds(&mesh),
        Some(chosen) => bounds_of_points(&mesh, chosen),
    };
    let pivot = match io.param(PIVOT)? {
        Pivot::Origin => DVec3::ZERO,
        Pivot::Box => bounds().map_or(DVec3::ZERO, |(low, high)| low.midpoint(high)),
        Pivot::Point => vector([PIVOT_X, PIVOT_Y, PIVOT_Z])?,
    };
    let scale = io.param(SCALE)? * vector([SCALE_X, SCALE_Y, SCALE_Z])?;
    let linear = turn * DMat3::from_diagonal(scale);
    let by = vector([MOVE_X, MOVE_Y, MOVE_Z])?;
    // About the origin this must be exactly the linear map.
    let shift = if pivot == DVec3::ZERO { by } else { pivot - linear * pivot + by };
    let mut map = DAffine3::from_mat3_translation(linear, shift);
    let matrix = io.param(MATRIX)?;
    if !matrix.trim().is_empty() {
        let read = matrix_from_text(&matrix).map_err(|why| ModuleError::param(&MATRIX, why))?;
        map = read * map;
    }
    if map.matrix3.determinant() == 0.0 {
        io.warn("the map flattens the mesh: directions and volume are lost");
    }
    let mesh = match chosen {
        None => transformed(mesh, &map, io.control())?,
        Some(chosen) => transformed_part(mesh, &map, &chosen, io.control())?,
    };
    io.put(MESH_OUT, mesh);
    Ok(())
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use mve_core::testing::Trial;
    use mve_mesh::fixtures::{cube, mesh_of};

    use crate::prelude::*;

    fn trial() -> Trial {
        Trial::of(&super::MODULE).input("mesh", mesh_of(&[[1.0, 2.0, 3.0], [3.0; 3]], &[]))
    }

    fn first(trial: Trial) -> DVec3 {
        trial.run().unwrap()["mesh"].get::<TriMesh>().unwrap().positions[0]
    }

    #[test]
    fn scaled_then_turned_then_moved_then_by_the_matrix() {
        let trial = trial().set("scale", 2.0).set("scale_x", -1.0).set("turn_z", 90.0);
        // (1, 2, 3) → (-2, 4, 6) → (-4, -2, 6) → (-4, -2, 7) → doubled.
        let matrix = "2 0 0 0  0 2 0 0  0 0 2 0";
        let found = first(trial.set("move_z", 1.0).set("matrix", matrix));
        assert_eq!(found, DVec3::new(-8.0, -4.0, 14.0));
    }

    #[test]
    fn a_pivot_stays_in_place() {
        let by = |pivot: &str| {
            first(trial().set("turn", "Axis").set("angle", 180.0).set("pivot", pivot))
        };
        assert_eq!(by("Origin"), DVec3::new(-1.0, -2.0, 3.0));
        assert_eq!(by("Box"), DVec3::new(3.0, 3.0, 3.0));
        assert_eq!(by("Point"), DVec3::new(-1.0, -2.0, 3.0));
        let around = trial().set("turn", "Axis").set("angle", 180.0).set("pivot", "Point");
        assert_eq!(first(around.set("pivot_x", 1.0)), DVec3::new(1.0, -2.0, 3.0));
    }

    #[test]
    fn only_what_is_selected_moves_around_its_own_middle() {
        let mut mesh = cube(DVec3::ZERO);
        mesh.positions[7].z = 2.0;
        let values = mesh.positions.iter().map(|p| f64::from(p.z > 0.5)).collect();
        let (name, unit) = ("s".to_owned(), String::new());
        let selection = Field { name, unit, domain: Domain::Vertex, values };
        let trial = Trial::of(&super::MODULE).input("mesh", mesh).input("selection", selection);
        let outputs = trial.set("pivot", "Box").set("scale", 0.5).run().unwrap();
        let found = outputs["mesh"].get::<TriMesh>().unwrap();
        assert_eq!(found.positions[..4], cube(DVec3::ZERO).positions[..4]);
        // The middle of what is selected is (1/2, 1/2, 3/2).
        assert_eq!(found.positions[4], DVec3::new(0.25, 0.25, 1.25));
        assert_eq!(found.positions[7], DVec3::new(0.75, 0.75, 1.75));
    }

    #[test]
    fn a_mirrored_cube_keeps_its_volume() {
        let trial = Trial::of(&super::MODULE).input("mesh", cube(DVec3::ZERO));
        let outputs = trial.set("scale", -1.0).run().unwrap();
        assert_eq!(outputs["mesh"].get::<TriMesh>().unwrap().signed_volume(), 1.0);
    }

    #[test]
    fn what_is_no_axis_or_matrix_is_named() {
        let message = |trial: Trial| trial.run().unwrap_err().to_string();
        let no_axis = message(trial().set("turn", "Axis").set("axis_z", 0.0));
        assert!(no_axis.contains("axis_x") && no_axis.contains("no direction"), "{no_axis}");
        let short = message(trial().set("matrix", "1 2 3"));
        assert!(short.contains("matrix") && short.contains("3 numbers"), "{short}");
    }
}
