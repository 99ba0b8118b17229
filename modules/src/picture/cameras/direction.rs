//! One camera in a direction that is named, near enough to fill its picture.

use glam::DVec3;
use mve_core::{Condition, Entry, Enumeration};

use super::MakeCameras;
use crate::picture::render::CameraSet;
use crate::prelude::*;

/// Where the camera is, seen from the mesh: y points up, and the front looks along z.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum From {
    Front,
    ThreeQuarter,
    Right,
    Left,
    Back,
    Top,
    Bottom,
    Vector,
}

impl Enumeration for From {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Front", "Along z, from its positive end."),
        ("ThreeQuarter", "From the front, a little from the right and from above."),
        ("Right", "From the positive end of x."),
        ("Left", "From the negative end of x."),
        ("Back", "From the negative end of z."),
        ("Top", "From the positive end of y."),
        ("Bottom", "From the negative end of y."),
        ("Vector", "From where x, y and z point."),
    ];
    const VALUES: &'static [Self] = &[
        Self::Front,
        Self::ThreeQuarter,
        Self::Right,
        Self::Left,
        Self::Back,
        Self::Top,
        Self::Bottom,
        Self::Vector,
    ];
}

const FROM: Param<From> = Param::one_of("from", "Where the camera is.", "ThreeQuarter");
const X: Param<f64> = coordinate("x", "How far the camera is to the right.");
const Y: Param<f64> = coordinate("y", "How far it is up.");
const Z: Param<f64> = coordinate("z", "How far it is to the front.");

const fn coordinate(name: &'static str, doc: &'static str) -> Param<f64> {
    let vector = Condition::Is { param: "from", value: "Vector" };
    Param::number(name, doc, 1.0).within((-1e6, 1e6)).usually((-1.0, 1.0)).only_where(vector)
}

pub static CAMERAS: Entry<MakeCameras> = Entry {
    id: "Direction",
    summary: "One camera in a direction, so near that the mesh fills the picture.",
    params: &[FROM.spec(), X.spec(), Y.spec(), Z.spec()],
    build,
};

fn build(settings: &Settings) -> Result<CameraSet, ModuleError> {
    let direction = match settings.get(&FROM)? {
        From::Front => DVec3::Z,
        From::ThreeQuarter => DVec3::new(0.6, 0.45, 1.0),
        From::Right => DVec3::X,
        From::Left => DVec3::NEG_X,
        From::Back => DVec3::NEG_Z,
        From::Top => DVec3::Y,
        From::Bottom => DVec3::NEG_Y,
        From::Vector => DVec3::new(settings.get(&X)?, settings.get(&Y)?, settings.get(&Z)?),
    };
    let unit = direction.try_normalize();
    let zero = "x, y and z are all 0, which is no direction; set one of them";
    unit.map(CameraSet::Toward).ok_or_else(|| ModuleError::param(&FROM, zero))
}

#[cfg(test)]
mod tests {
    use super::*;
    use mve_core::testing::settings_of;
    use serde_json::json;

    fn made(params: serde_json::Value) -> Result<CameraSet, String> {
        let settings = settings_of(CAMERAS.params, params.as_object().unwrap());
        (CAMERAS.build)(&settings).map_err(|error| error.to_string())
    }

    #[test]
    fn directions_are_named_or_given() {
        assert_eq!(made(json!({ "from": "Front" })), Ok(CameraSet::Toward(DVec3::Z)));
        let vector = json!({ "from": "Vector", "x": 0, "y": -4, "z": 0 });
        assert_eq!(made(vector), made(json!({ "from": "Bottom" })));
        let nowhere = made(json!({ "from": "Vector", "x": 0, "y": 0, "z": 0 })).unwrap_err();
        assert!(nowhere.contains("\"from\": x, y and z are all 0"), "{nowhere}");
        let Ok(CameraSet::Toward(usual)) = made(json!({})) else { panic!("a direction") };
        // From the front rather than from the side, and from above: each axis is seen.
        assert!(usual.z > usual.x && usual.x > usual.y && usual.y > 0.0);
        assert!((usual.length() - 1.0).abs() < 1e-15);
    }
}
