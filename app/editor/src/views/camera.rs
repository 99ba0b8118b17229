//! The camera of the mesh views: a turntable around a target, and the mathematics of moving it.
//!
//! Everything is `f64` in model space, so that a model far from the origin does not tremble; only
//! the matrices for one draw call are `f32`. View space has x to the right, y up and z towards the
//! viewer; normalized coordinates go from -1 at the left and at the bottom to 1.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DMat4, DVec2, DVec3, DVec4};
use mve_modules::picture::turntable::Upright;
use serde::{Deserialize, Serialize};

/// Half of the vertical field of view, as a tangent: 35° in all, which distorts little.
const TAN_HALF_FOV: f64 = 0.315_298_788_878_983_4;

/// Space left around what is fitted, as a part of it.
const MARGIN: f64 = 0.06;

/// How depth becomes size.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Projection {
    /// What is near looks larger.
    Perspective,
    /// Parallel lines stay parallel.
    Orthographic,
}

/// The axis of the model that points up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum UpAxis {
    /// As in most OBJ files.
    Y,
    /// As in scans and drawings of machines.
    Z,
}

/// A direction to look from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StandardView {
    /// Along the axis of depth.
    Front,
    /// Against it.
    Back,
    /// From the right.
    Side,
    /// From the left.
    Left,
    /// From above.
    Top,
    /// From below.
    Bottom,
    /// From above, the front and the right.
    Corner,
}

/// A box in model space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The lowest coordinates.
    pub low: DVec3,
    /// The highest.
    pub high: DVec3,
}

impl Bounds {
    /// The box around finite points; `None` without one.
    pub fn around(points: impl IntoIterator<Item = DVec3>) -> Option<Self> {
        let mut points = points.into_iter().filter(|p| p.is_finite());
        let first = points.next()?;
        let grow = |b: Self, p: DVec3| Self { low: b.low.min(p), high: b.high.max(p) };
        Some(points.fold(Self { low: first, high: first }, grow))
    }

    /// The box around both.
    pub fn with(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// The middle.
    pub fn center(&self) -> DVec3 {
        // Halves first, as the sum may be larger than the largest number.
        0.5 * self.low + 0.5 * self.high
    }

    /// Half of the diagonal, never 0: a box without size counts as one of size 1.
    pub fn radius(&self) -> f64 {
        let half = 0.5 * self.high - 0.5 * self.low;
        let largest = half.max_element();
        if largest.is_normal() { (half / largest).length() * largest } else { 1.0 }
    }

    /// The axis that seems to point up.
    pub fn up(&self) -> UpAxis {
        match Upright::of(self.low, self.high) {
            Upright::Y => UpAxis::Y,
            Upright::Z => UpAxis::Z,
        }
    }

    /// The eight corners; bit k of the place says which end axis k has.
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let end = |axis: usize| if i >> axis & 1 == 1 { self.high } else { self.low }[axis];
            DVec3::new(end(0), end(1), end(2))
        })
    }
}

/// A camera that looks at a target from a distance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Camera {
    /// What it looks at and turns around.
    pub target: DVec3,
    /// Turn around the up axis in radians, 0 at the front.
    pub yaw_rad: f64,
    /// Height above the horizon in radians, from -π/2 to π/2.
    pub pitch_rad: f64,
    /// From the eye to the target; also says how large an orthographic picture is.
    pub distance: f64,
    /// How depth becomes size.
    pub projection: Projection,
    /// What points up.
    pub up: UpAxis,
}

/// The axes of view space in model space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewAxes {
    /// To the right of the picture.
    pub right: DVec3,
    /// To its top.
    pub up: DVec3,
    /// Towards the viewer.
    pub back: DVec3,
}

/// A half-line in model space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it begins.
    pub origin: DVec3,
    /// Where it goes, of length 1.
    pub direction: DVec3,
}

impl Default for Camera {
    fn default() -> Self {
        let mut camera = Self {
            target: DVec3::ZERO,
            yaw_rad: 0.0,
            pitch_rad: 0.0,
            distance: 4.0,
            projection: Projection::Perspective,
            up: UpAxis::Y,
        };
        camera.look_from(StandardView::Corner);
        camera
    }
}

impl Camera {
    /// Pixels that a model unit at the target takes in a picture of this height.
    pub fn pixels_per_unit(&self, height: u32) -> f64 {
        f64::from(height) / (2.0 * TAN_HALF_FOV * self.distance)
    }

    /// The axes of view space.
    pub fn axes(&self) -> ViewAxes {
        let (sin_yaw, cos_yaw) = self.yaw_rad.sin_cos();
        let (sin_pitch, cos_pitch) = self.pitch_rad.sin_cos();
        let turned = |v: DVec3| match self.up {
            UpAxis::Y => v,
            UpAxis::Z => DVec3::new(v.x, -v.z, v.y),
        };
        let back = DVec3::new(sin_yaw * cos_pitch, sin_pitch, cos_yaw * cos_pitch);
        let right = DVec3::new(cos_yaw, 0.0, -sin_yaw);
        let up = back.cross(right);
        ViewAxes { right: turned(right), up: turned(up), back: turned(back) }
    }

    /// Where the camera is.
    pub fn eye(&self) -> DVec3 {
        self.target + self.axes().back * self.distance
    }

    /// A point of the model in view space.
    pub fn view_of(&self, point: DVec3) -> DVec3 {
        let axes = self.axes();
        let p = point - self.target;
        DVec3::new(axes.right.dot(p), axes.up.dot(p), axes.back.dot(p) - self.distance)
    }

    /// Half of the width and height of the picture where the target is, in model units.
    pub fn half_size(&self, aspect: f64) -> DVec2 {
        let half = self.distance * TAN_HALF_FOV;
        DVec2::new(half * aspect, half)
    }

    /// Looks at the whole of a box from the present direction. `aspect` is width by height.
    pub fn fit(&mut self, bounds: &Bounds, aspect: f64) {
        let aspect = usable(aspect);
        self.target = bounds.center();
        let axes = self.axes();
        let tan = DVec2::new(TAN_HALF_FOV * aspect, TAN_HALF_FOV) / (1.0 + MARGIN);
        let needed = bounds.corners().map(|corner| {
            let p = corner - self.target;
            let (x, y, towards) = (axes.right.dot(p), axes.up.dot(p), axes.back.dot(p));
            let towards = match self.projection {
                Projection::Perspective => towards,
                Projection::Orthographic => 0.0,
            };
            (x.abs() / tan.x).max(y.abs() / tan.y) + towards
        });
        let needed = needed.into_iter().fold(0.0, f64::max);
        // A point or a line seen along itself gives no distance.
        let least = 1e-3 * bounds.radius();
        self.distance = if needed > least { needed } else { 3.0 * bounds.radius() };
    }

    /// Turns around the target: a whole picture to the side is half a turn.
    pub fn orbit(&mut self, moved: DVec2) {
        self.yaw_rad = (self.yaw_rad - moved.x * TAU / 2.0).rem_euclid(TAU);
        self.pitch_rad = (self.pitch_rad - moved.y * TAU / 2.0).clamp(-FRAC_PI_2, FRAC_PI_2);
    }

    /// Moves the target with the pointer; `moved` is in normalized coordinates.
    pub fn pan(&mut self, moved: DVec2, aspect: f64) {
        let (axes, half) = (self.axes(), self.half_size(usable(aspect)));
        self.target -= axes.right * (moved.x * half.x) + axes.up * (moved.y * half.y);
    }

    /// Makes things larger by `factor`; the point of the target's plane that is at `at`
    /// (normalized) stays there. The distance stays within a million radii of the scene.
    pub fn zoom(&mut self, factor: f64, at: DVec2, aspect: f64, scene_radius: f64) {
        if !(factor > 0.0 && factor.is_finite()) {
            return;
        }
        let (least, most) = (1e-6 * scene_radius, 1e6 * scene_radius);
        let distance = (self.distance / factor).clamp(least, most);
        let (axes, half) = (self.axes(), self.half_size(usable(aspect)));
        let offset = axes.right * (at.x * half.x) + axes.up * (at.y * half.y);
        self.target += offset * (1.0 - distance / self.distance);
        self.distance = distance;
    }

    /// Looks from a standard direction at the same target.
    pub fn look_from(&mut self, view: StandardView) {
        (self.yaw_rad, self.pitch_rad) = match view {
            StandardView::Front => (0.0, 0.0),
            StandardView::Back => (PI, 0.0),
            StandardView::Side => (FRAC_PI_2, 0.0),
            StandardView::Left => (PI + FRAC_PI_2, 0.0),
            StandardView::Top => (0.0, FRAC_PI_2),
            StandardView::Bottom => (0.0, -FRAC_PI_2),
            StandardView::Corner => (TAU * 0.08, TAU * 0.055),
        };
    }

    /// Looks at a point, against a direction that points towards the viewer if it has a length.
    pub fn look_at(&mut self, point: DVec3, towards: DVec3) {
        self.target = point;
        let Some(towards) = towards.try_normalize() else { return };
        let [x, y, z] = match self.up {
            UpAxis::Y => [towards.x, towards.y, towards.z],
            UpAxis::Z => [towards.x, towards.z, -towards.y],
        };
        self.pitch_rad = y.clamp(-1.0, 1.0).asin();
        // Straight from above and from below the turn stays as it is.
        if x.hypot(z) > 1e-6 {
            self.yaw_rad = x.atan2(z).rem_euclid(TAU);
        }
    }

    /// The camera that sees one box as this one sees another.
    pub fn carried(&self, from: &Bounds, to: &Bounds) -> Self {
        if from == to {
            return *self;
        }
        let scale = to.radius() / from.radius();
        let target = to.center() + scale * (self.target - from.center());
        Self { target, distance: scale * self.distance, ..*self }
    }

    /// Whether it can look at anything: files may say that it is nowhere.
    pub fn is_usable(&self) -> bool {
        let angles = [self.yaw_rad, self.pitch_rad];
        let is_placed = self.target.is_finite() && angles.iter().all(|angle| angle.is_finite());
        is_placed && self.distance.is_normal() && self.distance > 0.0
    }

    /// From view space to clip space with depth 0 near and 1 far, for a scene within `bounds`.
    pub fn clip_from_view(&self, aspect: f64, bounds: &Bounds) -> DMat4 {
        let (center_z, radius) = (self.view_of(bounds.center()).z, 1.01 * bounds.radius());
        let half = self.half_size(usable(aspect));
        match self.projection {
            Projection::Perspective => {
                let far = (radius - center_z).max(1e-3 * self.distance);
                let near = (-center_z - radius).max(1e-4 * far);
                let far = far.max(1.001 * near);
                let depth = far / (near - far);
                DMat4::from_cols(
                    DVec4::new(self.distance / half.x, 0.0, 0.0, 0.0),
                    DVec4::new(0.0, self.distance / half.y, 0.0, 0.0),
                    DVec4::new(0.0, 0.0, depth, -1.0),
                    DVec4::new(0.0, 0.0, near * depth, 0.0),
                )
            }
            Projection::Orthographic => {
                // The eye may be within the model: what is behind it is seen all the same.
                let (near_z, far_z) = (center_z + radius, center_z - radius);
                let depth = 1.0 / (far_z - near_z);
                DMat4::from_cols(
                    DVec4::new(1.0 / half.x, 0.0, 0.0, 0.0),
                    DVec4::new(0.0, 1.0 / half.y, 0.0, 0.0),
                    DVec4::new(0.0, 0.0, depth, 0.0),
                    DVec4::new(0.0, 0.0, -near_z * depth, 1.0),
                )
            }
        }
    }

    /// From the space of a mesh, whose points are `center + local * scale`, to view space.
    pub fn view_from_local(&self, center: DVec3, scale: f64) -> DMat4 {
        let axes = self.axes();
        let row = |axis: DVec3| axis * scale;
        let (x, y, z) = (row(axes.right), row(axes.up), row(axes.back));
        DMat4::from_cols(
            DVec4::new(x.x, y.x, z.x, 0.0),
            DVec4::new(x.y, y.y, z.y, 0.0),
            DVec4::new(x.z, y.z, z.z, 0.0),
            self.view_of(center).extend(1.0),
        )
    }

    /// Where a point is in the picture, normalized; `None` behind the eye.
    pub fn project(&self, point: DVec3, aspect: f64) -> Option<DVec2> {
        let view = self.view_of(point);
        let half = self.half_size(usable(aspect));
        let plane = DVec2::new(view.x, view.y) / half;
        match self.projection {
            Projection::Orthographic => Some(plane),
            Projection::Perspective if view.z < -1e-6 * self.distance => {
                Some(plane * (self.distance / -view.z))
            }
            Projection::Perspective => None,
        }
    }

    /// What is seen at a place of the picture lies on this ray. It begins so far back that all of
    /// a scene with `bounds` is ahead when the projection is orthographic.
    pub fn ray(&self, at: DVec2, aspect: f64, bounds: &Bounds) -> Ray {
        let (axes, half) = (self.axes(), self.half_size(usable(aspect)));
        let offset = axes.right * (at.x * half.x) + axes.up * (at.y * half.y);
        match self.projection {
            Projection::Perspective => {
                let direction = (offset - axes.back * self.distance).normalize();
                Ray { origin: self.eye(), direction }
            }
            Projection::Orthographic => {
                let ahead = axes.back.dot(bounds.center() - self.target) + 2.0 * bounds.radius();
                let origin = self.target + offset + axes.back * ahead;
                Ray { origin, direction: -axes.back }
            }
        }
    }
}

/// A panel without size has no aspect.
fn usable(aspect: f64) -> f64 {
    if aspect.is_normal() && aspect > 0.0 { aspect.clamp(1e-3, 1e3) } else { 1.0 }
}

#[cfg(test)]
#[path = "camera_tests.rs"]
mod tests;
