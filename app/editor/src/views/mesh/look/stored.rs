//! What is stored of a view of meshes from one start to the next.

use std::collections::BTreeMap;

use mve_core::Enumeration;
use mve_modules::picture::color_map::Outside;
use mve_modules::picture::color_scale::Scale;
use serde::{Deserialize, Serialize};

use crate::views::camera::{Camera, Projection};
use crate::views::mesh::arrays::Shading;
use crate::views::mesh::look::coloring::ScaleSettings;
use crate::views::mesh::look::settings::{Arrangement, BackFaces, Lines, MeshSettings};
use crate::views::mesh::look::values::Spacing;

/// How meshes are shown, apart from what belongs to the meshes themselves: what colors them, ranges
/// by hand, what is up, the box with lengths, and where the camera is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct MeshLook {
    shading: Shading,
    lines: Lines,
    back_faces: BackFaces,
    has_axes: bool,
    /// Names of what else is switched, without what is off.
    switched: BTreeMap<String, bool>,
    arrangement: Arrangement,
    projection: Projection,
    /// Name of the color scale.
    scale: String,
    is_reversed: bool,
    is_symmetric: bool,
    clip_percent: f64,
    spacing: Spacing,
    is_gray_outside: bool,
}

impl Default for MeshLook {
    fn default() -> Self {
        Self::of(&MeshSettings::default(), &Camera::default())
    }
}

impl MeshLook {
    /// The look that a view has.
    pub fn of(settings: &MeshSettings, camera: &Camera) -> Self {
        let named = Scale::VALUES.iter().zip(Scale::NAMES);
        let name = named.filter(|(scale, _)| **scale == settings.scale.scale);
        Self {
            shading: settings.shading,
            lines: settings.lines,
            back_faces: settings.back_faces,
            has_axes: settings.has_axes,
            switched: settings.switched.clone().into_iter().filter(|(_, is_on)| *is_on).collect(),
            arrangement: settings.arrangement,
            projection: camera.projection,
            scale: name.map(|(_, (name, _))| (*name).to_owned()).collect(),
            is_reversed: settings.scale.is_reversed,
            is_symmetric: settings.scale.is_symmetric,
            clip_percent: settings.scale.clip_percent,
            spacing: settings.scale.spacing,
            is_gray_outside: settings.scale.outside == Outside::Gray,
        }
    }

    /// Gives a view this look. A scale of a name that is not known leaves the colors as they are.
    pub fn apply(&self, settings: &mut MeshSettings, camera: &mut Camera) {
        let named = Scale::VALUES.iter().zip(Scale::NAMES);
        let mut scales = named.filter(|(_, (name, _))| *name == self.scale);
        settings.scale = ScaleSettings {
            scale: scales.next().map_or(settings.scale.scale, |(scale, _)| *scale),
            is_reversed: self.is_reversed,
            is_symmetric: self.is_symmetric,
            clip_percent: self.clip_percent,
            spacing: self.spacing,
            outside: if self.is_gray_outside { Outside::Gray } else { Outside::Clamp },
            ..settings.scale
        };
        settings.shading = self.shading.within_limits();
        settings.lines = self.lines;
        settings.back_faces = self.back_faces;
        settings.has_axes = self.has_axes;
        settings.switched = self.switched.clone();
        settings.arrangement = self.arrangement;
        camera.projection = self.projection;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::views::camera::UpAxis;

    #[test]
    fn a_look_comes_back_and_ranges_by_hand_do_not() {
        let mut settings = MeshSettings {
            shading: Shading::Smooth { crease_angle_rad: 0.5 },
            lines: Lines { has_wire: true, has_border: true },
            back_faces: BackFaces::Hidden,
            has_axes: false,
            arrangement: Arrangement::Wipe,
            ..MeshSettings::default()
        };
        settings.scale.scale = Scale::VALUES[1];
        settings.scale.low = Some(3.0);
        settings.scale.outside = Outside::Gray;
        settings.up = Some(UpAxis::Z);
        settings.has_box = true;
        *settings.switch("seams") = true;
        *settings.switch("points") = false;
        let camera = Camera { projection: Projection::Orthographic, ..Camera::default() };
        let look = MeshLook::of(&settings, &camera);
        let text = serde_json::to_string(&look).unwrap();
        let read: MeshLook = serde_json::from_str(&text).unwrap();
        assert_eq!(read, look);
        let (mut other, mut other_camera) = (MeshSettings::default(), Camera::default());
        read.apply(&mut other, &mut other_camera);
        assert_eq!(MeshLook::of(&other, &other_camera), look);
        assert_eq!(other.switched, [("seams".to_owned(), true)].into());
        assert_eq!((other.scale.low, other.up, other.has_box), (None, None, false));
        assert_eq!(other_camera.projection, Projection::Orthographic);
    }

    #[test]
    fn what_an_older_version_wrote_is_read_and_nonsense_does_no_harm() {
        let text = r#"{ "has_axes": false, "scale": "Gone", "shading": { "Smooth":
            { "crease_angle_rad": -1e30 } }, "new": 1 }"#;
        let read: MeshLook = serde_json::from_str(text).unwrap();
        let (mut settings, mut camera) = (MeshSettings::default(), Camera::default());
        read.apply(&mut settings, &mut camera);
        assert!(!settings.has_axes && !settings.has_box);
        assert_eq!(settings.scale, ScaleSettings::default());
        assert_eq!(settings.shading, Shading::Smooth { crease_angle_rad: 0.0 });
    }
}
