//! A way to look at meshes, kept by name: from where, how they are drawn, what colors them, where
//! they are cut, and how large its pictures are.

use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

use crate::views::camera::{Camera, UpAxis};
use crate::views::mesh::look::coloring::ColorBy;
use crate::views::mesh::look::settings::MeshSettings;
use crate::views::mesh::look::stored::MeshLook;
use crate::views::mesh::section::Section;

/// How a picture for a file is to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct StillOptions {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Whether there is nothing behind the meshes.
    pub is_transparent: bool,
    /// Height in points, on which the size of text hangs; `None` is as in the window.
    #[serde(default)]
    pub height: Option<u32>,
}

/// A way to look at meshes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct NamedView {
    camera: Camera,
    look: MeshLook,
    color_by: ColorBy,
    /// Ends of the range that were given by hand.
    range: [Option<f64>; 2],
    up: Option<UpAxis>,
    has_box: bool,
    is_one_scale: Option<bool>,
    balance: f32,
    pair: [usize; 2],
    section: Section,
    /// How its pictures are.
    pub picture: Option<StillOptions>,
}

impl Default for NamedView {
    fn default() -> Self {
        Self::of(&MeshSettings::default(), &Camera::default())
    }
}

impl NamedView {
    /// The way that a view looks.
    pub fn of(settings: &MeshSettings, camera: &Camera) -> Self {
        Self {
            camera: *camera,
            look: MeshLook::of(settings, camera),
            color_by: settings.color_by.clone(),
            range: [settings.scale.low, settings.scale.high],
            up: settings.up,
            has_box: settings.has_box,
            is_one_scale: settings.is_one_scale,
            balance: settings.balance,
            pair: settings.pair,
            section: settings.section,
            picture: None,
        }
    }

    /// Makes a view look so. A camera that is nowhere leaves the one that is there.
    pub fn apply(&self, settings: &mut MeshSettings, camera: &mut Camera) {
        if self.camera.is_usable() {
            *camera = self.camera;
        }
        self.look.apply(settings, camera);
        settings.color_by = self.color_by.clone();
        [settings.scale.low, settings.scale.high] = self.range;
        settings.up = self.up;
        settings.has_box = self.has_box;
        settings.is_one_scale = self.is_one_scale;
        settings.balance =
            if self.balance.is_finite() { self.balance.clamp(0.0, 1.0) } else { 0.5 };
        settings.pair = self.pair;
        settings.section = self.section;
    }

    /// As a map keeps it.
    pub fn to_json(&self) -> Json {
        // Names and numbers are plain data, which JSON can always say.
        serde_json::to_value(self).unwrap_or(Json::Null)
    }

    /// From a map; `None` where it holds something else.
    pub fn from_json(content: &Json) -> Option<Self> {
        Self::deserialize(content).ok()
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use serde_json::json;

    use super::*;
    use crate::views::camera::StandardView;
    use crate::views::mesh::look::values::Spacing;

    #[test]
    fn a_view_comes_back_as_it_was_kept() {
        let mut camera = Camera { target: DVec3::new(0.1, 2.0, -1e-9), ..Camera::default() };
        camera.look_from(StandardView::Left);
        camera.distance = 1.0 / 3.0;
        let mut settings = MeshSettings {
            color_by: ColorBy::Field("compare.distance".to_owned()),
            has_box: true,
            balance: 0.25,
            ..MeshSettings::default()
        };
        settings.scale.high = Some(0.01);
        settings.scale.spacing = Spacing::Logarithmic;
        settings.section.toggle(&camera);
        settings.section.offset = Some(0.7);
        let picture = StillOptions { size: [640, 480], is_transparent: true, height: Some(500) };
        let kept = NamedView { picture: Some(picture), ..NamedView::of(&settings, &camera) };
        let text = kept.to_json().to_string();
        let read = NamedView::from_json(&serde_json::from_str(&text).unwrap()).unwrap();
        assert_eq!(read, kept);
        let (mut other, mut other_camera) = (MeshSettings::default(), Camera::default());
        read.apply(&mut other, &mut other_camera);
        assert_eq!(other_camera, camera);
        assert_eq!(NamedView::of(&other, &other_camera), NamedView { picture: None, ..kept });
    }

    #[test]
    fn what_another_version_wrote_is_read_and_nonsense_does_no_harm() {
        let content = json!({ "camera": { "distance": -1 }, "balance": 7, "new": [1],
            "color_by": "Plain", "look": { "scale": "Gone" } });
        let read = NamedView::from_json(&content).unwrap();
        let (mut settings, mut camera) = (MeshSettings::default(), Camera::default());
        let before = camera;
        read.apply(&mut settings, &mut camera);
        assert_eq!(camera, before);
        assert_eq!((settings.balance, settings.color_by), (1.0, ColorBy::Plain));
        assert_eq!(NamedView::from_json(&json!([1])), None);
    }
}
