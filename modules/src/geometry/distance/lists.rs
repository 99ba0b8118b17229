//! Lists of faces that are near each other, where boxes around faces do not tell them apart: what
//! is in the cells of [`Cells`](super::cells::Cells), for queries.

use glam::{DVec3, Vec4};

use super::boxes::{BoxFrame, QueryPoint};
use super::cells::CellGrid;
use super::point_triangle::PreparedTriangle;

/// Lists of slots of triangles, one for each leaf of the tree.
#[derive(Clone, Debug)]
pub(super) struct SlotLists {
    /// Where the list of each leaf begins, and the end of all.
    pub starts: Vec<u32>,
    pub slots: Vec<u32>,
    /// Around the triangle of each slot.
    pub rods: Vec<Rod>,
    /// Cells of most of the lists.
    pub grid: Option<CellGrid>,
}

/// What is no farther than a height from a line: around a long thin face there is little else. In
/// the frame of the tree.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rod {
    /// An end, and the height.
    from: Vec4,
    /// To the other end, and one over its squared length.
    side: Vec4,
}

impl Rod {
    /// Along the longest side of a face.
    pub fn around([a, b, c]: [DVec3; 3]) -> Self {
        let sides = [(a, b, c), (b, c, a), (c, a, b)];
        let length_sq = |(from, to, _): &(DVec3, DVec3, DVec3)| from.distance_squared(*to);
        let longest = sides.into_iter().max_by(|a, b| length_sq(a).total_cmp(&length_sq(b)));
        let (from, to, peak) = longest.unwrap_or(sides[0]);
        let [from, side] = [from, to - from].map(DVec3::as_vec3);
        let inverse = 1.0 / side.length_squared();
        let inverse = if inverse.is_finite() { inverse } else { 0.0 };
        // The farthest point of a triangle from a side is its third corner.
        let beside = peak - from.as_dvec3();
        let along = (beside.dot(side.as_dvec3()) * f64::from(inverse)).clamp(0.0, 1.0);
        let height = (beside - side.as_dvec3() * along).length() as f32;
        Self { from: from.extend(height), side: side.extend(inverse) }
    }

    /// Whether all of it is farther than this from a point.
    #[inline(always)]
    fn is_beyond(&self, reach: f32, point: Vec4) -> bool {
        let offset = point - self.from;
        let along = offset.truncate().dot(self.side.truncate()) * self.side.w;
        let offset = offset - self.side * along.clamp(0.0, 1.0);
        let reach = reach + self.from.w;
        offset.truncate().length_squared() > reach * reach
    }
}

impl SlotLists {
    /// The list of a leaf.
    pub fn of(&self, leaf: u32) -> &[u32] {
        let [start, end] = [0, 1].map(|k| self.starts[leaf as usize + k] as usize);
        &self.slots[start..end]
    }
}

/// The nearest of the faces in lists, so far.
pub(super) struct ListQuery<'a> {
    frame: &'a BoxFrame,
    triangles: &'a [PreparedTriangle],
    lists: &'a SlotLists,
    point: DVec3,
    /// The point in the tree's frame, and what rounding moves it by.
    place: Vec4,
    margin: f32,
    /// The least squared distance, and whose it is.
    pub best: f64,
    pub slot: u32,
    /// What boxes are compared with.
    pub bound: f32,
}

impl<'a> ListQuery<'a> {
    pub fn new(
        (frame, triangles): (&'a BoxFrame, &'a [PreparedTriangle]),
        lists: &'a SlotLists,
        point: DVec3,
        query: &QueryPoint,
        (best, slot): (f64, u32),
    ) -> Self {
        let (place, margin) = query.place();
        let bound = frame.bound(best);
        Self { frame, triangles, lists, point, place, margin, best, slot, bound }
    }

    /// Looks at the faces of a list until one is near enough.
    #[inline]
    pub fn look_through(&mut self, list: u32, enough: f64) {
        let mut reach = self.bound.sqrt() + self.margin;
        for &slot in self.lists.of(list) {
            if self.lists.rods[slot as usize].is_beyond(reach, self.place) {
                continue;
            }
            let found = self.triangles[slot as usize].distance_sq(self.point);
            if found < self.best {
                (self.best, self.slot) = (found, slot);
                self.bound = self.frame.bound(found);
                reach = self.bound.sqrt() + self.margin;
                if found <= enough {
                    return;
                }
            }
        }
    }
}
