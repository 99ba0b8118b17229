//! Points that share one walk of the tree, and the faces that may be nearest to one of them.

use glam::{DVec3, Vec4};

use super::boxes::{BoxFrame, LEAF, Node, QueryBox};
use super::point_triangle::PreparedTriangle;

/// The box around some points, and how far they are from one of them.
pub(super) struct PointBox {
    low: DVec3,
    high: DVec3,
    /// The largest distance from that one.
    pub radius: f64,
}

impl PointBox {
    /// Around points, of which `middle` is one.
    pub fn of(points: &[DVec3], middle: DVec3) -> Self {
        let (mut low, mut high) = (middle, middle);
        let mut radius_sq = 0.0f64;
        for &point in points {
            low = low.min(point);
            high = high.max(point);
            radius_sq = radius_sq.max(point.distance_squared(middle));
        }
        Self { low, high, radius: radius_sq.sqrt() }
    }

    /// The box in the frame of a tree.
    pub fn query(&self, frame: &BoxFrame) -> QueryBox {
        let [low, high] = [self.low, self.high].map(|p| frame.local(p));
        QueryBox::new((low + high) * 0.5, (high - low) * 0.5)
    }
}

/// Triangles that may be nearest.
#[derive(Default)]
pub(super) struct Candidates {
    /// Nodes with such triangles, and their lanes as bits.
    pub lanes: Vec<(u32, u32)>,
    pub n: usize,
}

impl Candidates {
    pub fn clear(&mut self) {
        self.lanes.clear();
        self.n = 0;
    }

    /// The least squared distance of these triangles, or the given one if that is less.
    #[inline]
    pub fn nearest_sq(
        &self,
        (frame, nodes, triangles): (&BoxFrame, &[Node], &[PreparedTriangle]),
        point: DVec3,
        distance_sq: f64,
    ) -> f64 {
        let mut best = distance_sq;
        let mut bound = frame.bound(best);
        let query = frame.query(point);
        for &(node, lanes) in &self.lanes {
            let node = &nodes[node as usize];
            let distances = node.distances_sq(&query);
            let mut near = distances.cmple(Vec4::splat(bound)).bitmask() & lanes;
            while near != 0 {
                let lane = near.trailing_zeros() as usize & 3;
                near &= near - 1;
                let slot = (node.child[lane] & !LEAF) as usize;
                let found = triangles[slot].distance_sq(point);
                if found < best {
                    best = found;
                    bound = frame.bound(best);
                }
            }
        }
        best
    }
}
