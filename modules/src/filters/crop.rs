//! Cuts away what lies outside of a box, a sphere or a plane, or inside.
//!
//! Bounds are absolute, or shares of the mesh's own bounding box. The cut stays open.

use super::regions::{RegionParams, Shape, joined};
use crate::geometry::edit::crop::{AtBorder, Keeps, crop};
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

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh.");
const REGION: Param<Shape> = Param::one_of("region", "The form of the region.", "Box");
const PLACES: RegionParams = RegionParams::of("region");
const KEEP: Param<Keeps> = Param::one_of("keep", "The side that stays.", "Inside");
const AT_BORDER: Param<AtBorder> =
    Param::one_of("at_border", "What happens to faces that the border goes through.", "Cut");
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "What is left, in its order and with its layers; neighbors are cut at the same places. \
     Vertices that lose all of their faces go.",
);

pub static MODULE: Module = Module {
    id: "Crop",
    summary: "Cuts away what lies outside of a box, a sphere or a plane, or inside of it.",
    inputs: &[MESH_IN.spec()],
    outputs: &[MESH_OUT.spec()],
    params: &joined::<20>(&[&[REGION.spec()], &PLACES.specs(), &[KEEP.spec(), AT_BORDER.spec()]]),
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let mesh = io.get(MESH_IN)?;
    let region = PLACES.region(io, &mesh, io.param(REGION)?)?;
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
