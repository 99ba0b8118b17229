//! Cuts away what lies outside of a box, a sphere or a plane, or inside.
//!
//! Bounds are absolute, or shares of the mesh's own bounding box. The cut stays open.

use glam::DVec3;
use mve_core::Condition;

use crate::geometry::edit::crop::{AtBorder, Keeps, Region, crop};
use crate::geometry::edit::place::finite_bounds;
use crate::prelude::*;

impl Enumeration for AtBorder {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Cut", "They are cut, and layers are interpolated at the new vertices."),
        ("Whole", "Those stay that lie wholly on the side that is kept."),
        ("Touching", "Those stay, too, that have a corner on it."),
    ];
    const VALUES: &'static [Self] = &[Self::Cut, Self::Whole, Self::Touching];
}

impl Enumeration for Keeps {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Inside", "What lies in the region; its border belongs to it."),
        ("Outside", "What lies outside of it."),
    ];
    const VALUES: &'static [Self] = &[Self::Within, Self::Beyond];
}

#[derive(Clone, Copy)]
enum Shape {
    Box,
    Sphere,
    Plane,
}

impl Enumeration for Shape {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Box", "Between two ends along each axis."),
        (
            "Sphere",
            "At most so far from a center. A face is cut where its corners are on both sides.",
        ),
        ("Plane", "On the side of a plane to which its normal points."),
    ];
    const VALUES: &'static [Self] = &[Self::Box, Self::Sphere, Self::Plane];
}

#[derive(Clone, Copy, PartialEq)]
enum Frame {
    Absolute,
    Relative,
}

impl Enumeration for Frame {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Absolute", "Coordinates of the mesh, in model units."),
        (
            "Relative",
            "Shares of the mesh's bounding box, 0 to 1 along each axis; the radius of a \
          sphere is a share of the diagonal.",
        ),
    ];
    const VALUES: &'static [Self] = &[Self::Absolute, Self::Relative];
}

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh.");
const REGION: Param<Shape> = Param::one_of("region", "The form of the region.", "Box");
const FRAME: Param<Frame> = Param::one_of("frame", "What numbers of places mean.", "Absolute");
const LOW_X: Param<Option<f64>> = end("low_x", "Lower end along x. Off: none.");
const HIGH_X: Param<Option<f64>> = end("high_x", "Upper end along x. Off: none.");
const LOW_Y: Param<Option<f64>> = end("low_y", "Lower end along y. Off: none.");
const HIGH_Y: Param<Option<f64>> = end("high_y", "Upper end along y. Off: none.");
const LOW_Z: Param<Option<f64>> = end("low_z", "Lower end along z. Off: none.");
const HIGH_Z: Param<Option<f64>> = end("high_z", "Upper end along z. Off: none.");
const CENTER_X: Param<f64> = number("center_x", "Center of the sphere along x.", 0.0, "Sphere");
const CENTER_Y: Param<f64> = number("center_y", "Center of the sphere along y.", 0.0, "Sphere");
const CENTER_Z: Param<f64> = number("center_z", "Center of the sphere along z.", 0.0, "Sphere");
const RADIUS: Param<f64> = number("radius", "Radius of the sphere.", 1.0, "Sphere")
    .within((0.0, f64::MAX))
    .usually((0.0, 2.0));
const POINT_X: Param<f64> = number("point_x", "A point of the plane, along x.", 0.0, "Plane");
const POINT_Y: Param<f64> = number("point_y", "A point of the plane, along y.", 0.0, "Plane");
const POINT_Z: Param<f64> = number("point_z", "A point of the plane, along z.", 0.0, "Plane");
const NORMAL_X: Param<f64> = number("normal_x", "Normal of the plane along x.", 0.0, "Plane");
const NORMAL_Y: Param<f64> = number("normal_y", "Normal of the plane along y.", 0.0, "Plane");
const NORMAL_Z: Param<f64> = number("normal_z", "Normal of the plane along z.", 1.0, "Plane");
const KEEP: Param<Keeps> = Param::one_of("keep", "The side that stays.", "Inside");
const AT_BORDER: Param<AtBorder> =
    Param::one_of("at_border", "What happens to faces that the border goes through.", "Cut");
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "What is left, in its order and with its layers; neighbors are cut at the same places. \
     Vertices that lose all of their faces go.",
);

const fn end(name: &'static str, doc: &'static str) -> Param<Option<f64>> {
    Param::maybe_number(name, doc, None)
        .usually((-1.0, 1.0))
        .only_where(Condition::Is { param: "region", value: "Box" })
}

const fn number(
    name: &'static str,
    doc: &'static str,
    default: f64,
    value: &'static str,
) -> Param<f64> {
    Param::number(name, doc, default)
        .usually((-1.0, 1.0))
        .only_where(Condition::Is { param: "region", value })
}

pub static MODULE: Module = Module {
    id: "Crop",
    summary: "Cuts away what lies outside of a box, a sphere or a plane, or inside of it.",
    inputs: &[MESH_IN.spec()],
    outputs: &[MESH_OUT.spec()],
    params: &[
        REGION.spec(),
        FRAME.spec(),
        LOW_X.spec(),
        HIGH_X.spec(),
        LOW_Y.spec(),
        HIGH_Y.spec(),
        LOW_Z.spec(),
        HIGH_Z.spec(),
        CENTER_X.spec(),
        CENTER_Y.spec(),
        CENTER_Z.spec(),
        RADIUS.spec(),
        POINT_X.spec(),
        POINT_Y.spec(),
        POINT_Z.spec(),
        NORMAL_X.spec(),
        NORMAL_Y.spec(),
        NORMAL_Z.spec(),
        KEEP.spec(),
        AT_BORDER.spec(),
    ],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let mesh = io.get(MESH_IN)?;
    let (origin, size) = match (io.param(FRAME)?, finite_bounds(&mesh)) {
        (Frame::Relative, Some((low, high))) => (low, high - low),
        _ => (DVec3::ZERO, DVec3::ONE),
    };
    let diagonal = if io.param(FRAME)? == Frame::Relative { size.length() } else { 1.0 };
    let vector = |[x, y, z]: [Param<f64>; 3]| -> Result<DVec3, ModuleError> {
        Ok(DVec3::new(io.param(x)?, io.param(y)?, io.param(z)?))
    };
    let ends = |[x, y, z]: [Param<Option<f64>>; 3], none: f64| -> Result<DVec3, ModuleError> {
        let at = |param: Param<Option<f64>>, k: usize| -> Result<f64, ModuleError> {
            Ok(io.param(param)?.map_or(none, |share| origin[k] + share * size[k]))
        };
        Ok(DVec3::new(at(x, 0)?, at(y, 1)?, at(z, 2)?))
    };
    let region = match io.param(REGION)? {
        Shape::Box => Region::Box(
            ends([LOW_X, LOW_Y, LOW_Z], f64::NEG_INFINITY)?,
            ends([HIGH_X, HIGH_Y, HIGH_Z], f64::INFINITY)?,
        ),
        Shape::Sphere => {
            let center = origin + vector([CENTER_X, CENTER_Y, CENTER_Z])? * size;
            Region::Sphere(center, io.param(RADIUS)? * diagonal)
        }
        Shape::Plane => {
            let normal = vector([NORMAL_X, NORMAL_Y, NORMAL_Z])?;
            // Scaled first, so that its square neither vanishes nor overflows.
            let normal =
                (normal / normal.abs().max_element()).try_normalize().ok_or_else(|| {
                    ModuleError::param(&NORMAL_X, "the normal (0, 0, 0) has no direction")
                })?;
            Region::Plane(origin + vector([POINT_X, POINT_Y, POINT_Z])? * size, normal)
        }
    };
    let found = crop(&mesh, &region, io.param(KEEP)?, io.param(AT_BORDER)?, io.control())?;
    if found.faces.is_empty() && !mesh.faces.is_empty() {
        io.warn("nothing is left: all faces lie on the other side");
    }
    io.put(MESH_OUT, found);
    Ok(())
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use mve_core::testing::Trial;
    use mve_mesh::fixtures::cube;

    use crate::prelude::*;

    fn trial() -> Trial {
        Trial::of(&super::MODULE).input("mesh", cube(DVec3::splat(4.0)))
    }

    fn area(trial: Trial) -> f64 {
        trial.run().unwrap()["mesh"].get::<TriMesh>().unwrap().area()
    }

    #[test]
    fn regions_and_frames_are_heard() {
        assert_eq!(area(trial()), 6.0);
        assert_eq!(area(trial().set("high_z", 4.5)), 3.0);
        let half = || trial().set("frame", "Relative").set("high_z", 0.5);
        assert_eq!(area(half()), 3.0);
        assert_eq!(area(half().set("at_border", "Whole")), 1.0);
        assert_eq!(area(half().set("keep", "Outside").set("low_z", 0.25)), 5.0);
        let plane = trial().set("region", "Plane").set("frame", "Relative");
        assert_eq!(area(plane.set("point_z", 0.75).set("normal_z", 1e-200)), 2.0);
        let sphere = || trial().set("region", "Sphere").set("frame", "Relative");
        assert_eq!(area(sphere().set("radius", 1.0)), 6.0);
        assert_eq!(area(sphere().set("radius", 0.9).set("at_border", "Whole")), 3.0);
    }

    #[test]
    fn a_normal_without_direction_and_an_empty_result_are_said() {
        let plane = trial().set("region", "Plane").set("normal_z", 0.0);
        let message = plane.run().unwrap_err().to_string();
        assert!(message.contains("normal_x") && message.contains("no direction"), "{message}");
        assert!(trial().set("high_x", 0.0).log().unwrap()[0].contains("nothing is left"));
    }
}
