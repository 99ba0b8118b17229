//! The plane that meshes are cut by: what lies before it is not seen. All meshes share one.

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

use crate::views::camera::{Bounds, Camera};

/// A plane in model space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Where it faces, of length 1: what lies there is cut away.
    pub normal: DVec3,
    /// From the origin to the plane along the normal, in model units.
    pub offset: f64,
}

impl Plane {
    /// How far a point lies before the plane; below 0 behind it, where it is seen.
    pub fn height(&self, point: DVec3) -> f64 {
        self.normal.dot(point) - self.offset
    }
}

/// How meshes are cut.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Section {
    /// Whether they are.
    pub is_on: bool,
    /// Where the plane faces; zero until it is first used.
    pub normal: DVec3,
    /// From the origin to the plane along the normal; `None` goes through the middle of all.
    pub offset: Option<f64>,
    /// Whether each picture has the outlines of all meshes.
    pub has_all_outlines: bool,
}

impl Default for Section {
    fn default() -> Self {
        Self { is_on: false, normal: DVec3::ZERO, offset: None, has_all_outlines: true }
    }
}

/// Part of the way through a scene that a key moves the plane by.
const KEY_STEP: f64 = 0.01;

impl Section {
    /// Switches it; a plane that was never placed faces the viewer along an axis.
    pub fn toggle(&mut self, camera: &Camera) {
        self.is_on ^= true;
        if self.normal == DVec3::ZERO {
            let back = camera.axes().back;
            let size = back.abs();
            let axis = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).unwrap_or(2);
            self.face([DVec3::X, DVec3::Y, DVec3::Z][axis] * back[axis].signum());
        }
    }

    /// Turns the plane, which goes through the middle then.
    pub fn face(&mut self, normal: DVec3) {
        (self.normal, self.offset) = (normal, None);
    }

    /// Cuts the other side away.
    pub fn flip(&mut self) {
        self.normal = -self.normal;
        self.offset = self.offset.map(|offset| -offset);
    }

    /// Whether the plane is one across this axis, on either side.
    pub fn is_across(&self, axis: DVec3) -> bool {
        self.normal == axis || self.normal == -axis
    }

    /// The plane for what is within a box; `None` while nothing is cut.
    pub fn plane(&self, bounds: &Bounds) -> Option<Plane> {
        let normal = self.normal.try_normalize().filter(|_| self.is_on)?;
        let middle = normal.dot(bounds.center());
        let offset = self.offset.filter(|offset| offset.is_finite()).unwrap_or(middle);
        Some(Plane { normal, offset })
    }

    /// The offsets between which the plane meets a box.
    pub fn range(&self, bounds: &Bounds) -> [f64; 2] {
        let normal = self.normal.normalize_or_zero();
        let along = bounds.corners().map(|corner| normal.dot(corner));
        let low = along.into_iter().fold(f64::INFINITY, f64::min);
        [low, along.into_iter().fold(f64::NEG_INFINITY, f64::max)]
    }

    /// Moves the plane along its normal, not farther than out of the box.
    pub fn move_by(&mut self, by: f64, bounds: &Bounds) {
        let [low, high] = self.range(bounds);
        if let Some(plane) = self.plane(bounds) {
            self.offset = Some((plane.offset + by).max(low).min(high));
        }
    }

    /// Moves the plane a step towards where it faces, or away.
    pub fn step(&mut self, sign: f64, bounds: &Bounds) {
        let [low, high] = self.range(bounds);
        self.move_by(sign * KEY_STEP * (high - low), bounds);
    }

    /// Moves the plane as far along its normal as a pointer has moved along the normal's picture;
    /// up is towards where it faces when that is where the viewer is. `moved` is in model units.
    pub fn drag(&mut self, moved: DVec2, camera: &Camera, bounds: &Bounds) {
        let axes = camera.axes();
        let normal = self.normal.normalize_or_zero();
        let seen = DVec2::new(normal.dot(axes.right), normal.dot(axes.up));
        // A normal that points at the viewer has no direction in the picture.
        let by = match seen.length() > 0.25 {
            true => moved.dot(seen) / seen.length_squared(),
            false => moved.y * normal.dot(axes.back).signum(),
        };
        self.move_by(by, bounds);
    }

    /// A plane that all of another scene lies on one side of goes through its middle.
    pub fn fit(&mut self, bounds: &Bounds) {
        let [low, high] = self.range(bounds);
        self.offset = self.offset.filter(|offset| (low..=high).contains(offset));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::views::camera::StandardView;

    const BOX: Bounds =
        Bounds { low: DVec3::new(-1.0, 2.0, 10.0), high: DVec3::new(3.0, 4.0, 11.0) };

    #[test]
    fn a_plane_begins_in_the_middle_before_the_viewer_and_stays_within_the_box() {
        let mut camera = Camera::default();
        camera.look_from(StandardView::Top);
        let mut section = Section::default();
        assert_eq!(section.plane(&BOX), None);
        section.toggle(&camera);
        let plane = section.plane(&BOX).unwrap();
        assert_eq!((plane.normal, plane.offset), (DVec3::Y, 3.0));
        assert_eq!(section.range(&BOX), [2.0, 4.0]);
        assert_eq!(plane.height(DVec3::new(9.0, 5.0, 9.0)), 2.0);
        section.step(1.0, &BOX);
        assert!((section.offset.unwrap() - 3.02).abs() < 1e-12);
        section.flip();
        assert!((section.plane(&BOX).unwrap().offset + 3.02).abs() < 1e-12);
        assert!(section.is_across(DVec3::Y));
        section.move_by(-99.0, &BOX);
        assert_eq!(section.offset, Some(-4.0));
        section.face(DVec3::X);
        assert_eq!(section.plane(&BOX).unwrap().offset, 1.0);
    }

    #[test]
    fn a_drag_moves_the_plane_with_the_pointer_and_another_scene_is_cut_in_its_middle() {
        let mut camera = Camera::default();
        camera.look_from(StandardView::Front);
        let mut section = Section { is_on: true, normal: DVec3::X, ..Section::default() };
        section.drag(DVec2::new(0.5, 7.0), &camera, &BOX);
        assert_eq!(section.offset, Some(1.5));
        // The plane faces the viewer: up is nearer.
        section.face(DVec3::Z);
        section.drag(DVec2::new(7.0, 0.25), &camera, &BOX);
        assert_eq!(section.offset, Some(10.75));
        section.fit(&BOX);
        assert_eq!(section.offset, Some(10.75));
        section.fit(&Bounds { low: DVec3::ZERO, high: DVec3::ONE });
        assert_eq!(section.offset, None);
    }

    #[test]
    fn nonsense_cuts_nothing_or_in_the_middle() {
        let nan = Section { is_on: true, normal: DVec3::NAN, ..Section::default() };
        assert_eq!(nan.plane(&BOX), None);
        let far = Section { is_on: true, normal: DVec3::X, offset: Some(f64::NAN), ..nan };
        assert_eq!(far.plane(&BOX).unwrap().offset, 1.0);
    }
}
