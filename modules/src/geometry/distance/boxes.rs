//! The boxes of the tree of [`Bvh`](super::bvh::Bvh): four together, turned along what they hold,
//! and distances from them that are never too long.

use glam::{DVec3, Vec3A, Vec4};

/// A child that is not there.
pub(super) const EMPTY: u32 = u32::MAX;
/// Set in a child that is a triangle.
pub(super) const LEAF: u32 = 1 << 31;
/// Marks a frame that is not that of the tree.
pub(super) const TURNED: f32 = 1.0;
/// Coordinates of a query beyond this are brought there: their squares are finite in `f32`.
const MOST_LOCAL: f64 = 1e15;

/// Up to four boxes, one a lane, and what is in them.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Node {
    /// The frame of the boxes in that of the tree: where x, y, z and the origin go. The last number
    /// is [`TURNED`] where that changes anything: it lies beside the boxes, and most nodes over
    /// small faces need no more of it.
    pub columns: [Vec4; 4],
    /// Lowest x, y, z of the four boxes.
    pub low: [Vec4; 3],
    /// Highest x, y, z.
    pub high: [Vec4; 3],
    /// Index of a node, or [`LEAF`] and the slot of a triangle, or [`EMPTY`].
    pub child: [u32; 4],
}

impl Node {
    /// A node along the axes whose lanes are all out of reach.
    pub const EMPTY: Self = Self {
        columns: [Vec4::X, Vec4::Y, Vec4::Z, Vec4::ZERO],
        low: [Vec4::INFINITY; 3],
        high: [Vec4::NEG_INFINITY; 3],
        child: [EMPTY; 4],
    };

    /// Squared distances from the point to the four boxes.
    #[inline(always)]
    pub fn distances_sq(&self, query: &QueryPoint) -> Vec4 {
        if !self.is_turned() {
            return self.gaps_sq(query.low, query.high);
        }
        let center = self.turned(&query.center);
        self.gaps_sq(axes(center - query.margin), axes(center + query.margin))
    }

    /// The same from a box.
    #[inline(always)]
    pub fn distances_sq_to_box(&self, query: &QueryBox) -> Vec4 {
        let QueryBox { center, half } = query;
        if !self.is_turned() {
            let [low, high] = [-1.0, 1.0].map(|sign| [0, 1, 2].map(|k| center[k] + half[k] * sign));
            return self.gaps_sq(low, high);
        }
        let center = self.turned(center);
        let [x, y, z, _] = self.columns;
        let half = x.abs() * half[0] + y.abs() * half[1] + z.abs() * half[2];
        self.gaps_sq(axes(center - half), axes(center + half))
    }

    #[inline(always)]
    fn is_turned(&self) -> bool {
        self.columns[3].w == TURNED
    }

    /// A point in the frame of the boxes.
    #[inline(always)]
    fn turned(&self, point: &[Vec4; 3]) -> Vec4 {
        let [x, y, z, origin] = self.columns;
        x * point[0] + y * point[1] + z * point[2] + origin
    }

    /// From a box whose corners have each coordinate in all lanes.
    #[inline(always)]
    fn gaps_sq(&self, low: [Vec4; 3], high: [Vec4; 3]) -> Vec4 {
        let mut sum = Vec4::ZERO;
        for axis in 0..3 {
            let below = self.low[axis] - high[axis];
            let above = low[axis] - self.high[axis];
            let gap = below.max(above).max(Vec4::ZERO);
            sum += gap * gap;
        }
        sum
    }

    /// The sum of the volumes of the boxes.
    pub fn volume(&self) -> f64 {
        let side =
            |axis: usize, lane: usize| f64::from(self.high[axis][lane] - self.low[axis][lane]);
        let is_there = |&lane: &usize| self.child[lane] != EMPTY;
        (0..4)
            .filter(is_there)
            .map(|lane| (0..3).map(|axis| side(axis, lane)).product::<f64>())
            .sum()
    }

    /// The volume of the box around the boxes.
    pub fn volume_around(&self) -> f64 {
        let side = |axis: usize| {
            f64::from(self.high[axis].max_element()) - f64::from(self.low[axis].min_element())
        };
        (0..3).map(side).product()
    }

    /// The children that are there.
    pub fn filled(&self) -> impl Iterator<Item = u32> {
        self.child.into_iter().filter(|&child| child != EMPTY)
    }

    /// Puts a box and its content into a lane.
    pub fn set_lane(&mut self, lane: usize, low: Vec3A, high: Vec3A, child: u32) {
        for axis in 0..3 {
            self.low[axis][lane] = low[axis];
            self.high[axis][lane] = high[axis];
        }
        self.child[lane] = child;
    }
}

/// What rounding moves a query or the boxes of a node by, at most, along any axis of any frame: the
/// frame's numbers are about 1 where nodes are, and the query's as large as it is far.
///
/// Let `m` be the largest coordinate of the query, and `u` half the distance of `f32` numbers at 1,
/// 6e-8. Turned, the query is at most `1.8 m` long. Its coordinates and the three products round by
/// `1.8 m u` each, their sums by `3.2 m u`, the sum with the origin and the margin off or on by
/// `1.8 (m + 1) u` each, and a corner of a box by `1.8 u`: together less than `11 (m + 1) u`. A
/// wider margin costs much where many faces are about as far, as all within it are looked at.
fn margin(center: DVec3) -> f64 {
    7e-7 * (1.0 + center.abs().max_element())
}

/// What is brought nearer to a box around all is no farther from any box within.
#[inline]
fn brought_near(point: DVec3) -> DVec3 {
    point.clamp(DVec3::splat(-MOST_LOCAL), DVec3::splat(MOST_LOCAL))
}

/// Each coordinate in all lanes.
#[inline(always)]
fn axes(point: Vec4) -> [Vec4; 3] {
    [0, 1, 2].map(|axis| Vec4::splat(point[axis]))
}

fn in_all_lanes(point: DVec3) -> [Vec4; 3] {
    point.as_vec3a().to_array().map(Vec4::splat)
}

/// A point in the tree's frame, each coordinate in all four lanes.
pub(super) struct QueryPoint {
    center: [Vec4; 3],
    margin: Vec4,
    /// The center less and more the margin.
    low: [Vec4; 3],
    high: [Vec4; 3],
}

impl QueryPoint {
    #[inline]
    pub fn new(center: DVec3) -> Self {
        let center = brought_near(center);
        let margin = Vec4::splat(margin(center) as f32);
        let center = in_all_lanes(center);
        let [low, high] = [center.map(|c| c - margin), center.map(|c| c + margin)];
        Self { center, margin, low, high }
    }

    /// The point, and what rounding moves it by at most.
    pub fn place(&self) -> (Vec4, f32) {
        let [x, y, z] = self.center.map(|c| c.x);
        (Vec4::new(x, y, z, 0.0), self.margin.x)
    }
}

/// A box in the tree's frame: middle and half of each side, each in all four lanes.
pub(super) struct QueryBox {
    center: [Vec4; 3],
    half: [Vec4; 3],
}

impl QueryBox {
    /// The box that is wider than rounding moves it or the boxes of a node.
    pub fn new(center: DVec3, half: DVec3) -> Self {
        let center = brought_near(center);
        let half = half.min(DVec3::splat(MOST_LOCAL));
        let margin = margin(center) + 1e-6 * half.max_element();
        Self { center: in_all_lanes(center), half: in_all_lanes(half + margin) }
    }
}

/// The frame of the boxes: the mesh within about -1 to 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct BoxFrame {
    pub center: DVec3,
    /// A power of two, so that scaling is exact.
    pub scale: f64,
}

impl BoxFrame {
    /// The image of a point.
    #[inline]
    pub fn local(&self, point: DVec3) -> DVec3 {
        (point - self.center) * self.scale
    }

    #[inline]
    pub fn query(&self, point: DVec3) -> QueryPoint {
        QueryPoint::new(self.local(point))
    }

    /// The frame's squared distance that is no shorter than `distance_sq`, allowing for the
    /// rounding of [`Node::distances_sq`] and of the turns of the boxes.
    #[inline]
    pub fn bound(&self, distance_sq: f64) -> f32 {
        (distance_sq * (self.scale * self.scale) * (1.0 + 2e-6)) as f32 + f32::MIN_POSITIVE
    }

    /// The same of a distance, allowing for the rounding of the sum that it is.
    pub fn reach(&self, distance: f64) -> f32 {
        self.bound(distance * distance * (1.0 + 1e-12))
    }
}
