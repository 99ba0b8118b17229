//! What the tree is built of: faces, or cells with faces, each with its box.

use glam::{DVec3, Vec3A};

/// A face or a cell, and its box in the tree's frame.
#[derive(Clone, Copy)]
pub(super) struct Item {
    pub low: Vec3A,
    pub high: Vec3A,
    pub number: u32,
}

impl Item {
    /// Twice the center of the box.
    pub fn center(&self) -> Vec3A {
        self.low + self.high
    }

    /// Around the face or cell of this number.
    pub fn around(number: u32, points: &[DVec3]) -> Self {
        let mut bounds = Bounds::EMPTY;
        for point in points {
            // Wider by the rounding of the conversion.
            let point = point.as_vec3a();
            let margin = point.abs() * f32::EPSILON + Vec3A::splat(f32::MIN_POSITIVE);
            bounds.add(point - margin, point + margin);
        }
        Self { low: bounds.low, high: bounds.high, number }
    }
}

/// A box that grows.
#[derive(Clone, Copy)]
pub(super) struct Bounds {
    pub low: Vec3A,
    pub high: Vec3A,
}

impl Bounds {
    pub const EMPTY: Self = Self { low: Vec3A::INFINITY, high: Vec3A::NEG_INFINITY };

    pub fn add(&mut self, low: Vec3A, high: Vec3A) {
        self.low = self.low.min(low);
        self.high = self.high.max(high);
    }

    /// Half the surface area; 0 when empty.
    pub fn half_area(&self) -> f32 {
        let d = (self.high - self.low).max(Vec3A::ZERO);
        d.x * d.y + d.y * d.z + d.z * d.x
    }
}
