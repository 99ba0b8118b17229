//! Cuts a polygon in space into triangles on its own vertices.
//!
//! The plane is that of the polygon's Newell normal (Sutherland, Sproull and Schumacker, "A
//! characterization of ten hidden-surface algorithms", ACM Computing Surveys 6, 1974), looked at
//! along the axis that is nearest to it, so that coordinates stay as they are. Small polygons lose
//! their ears (Meisters, "Polygons have ears", American Mathematical Monthly 82, 1975), large ones
//! get a constrained Delaunay triangulation, and each is there for where the other one fails: the
//! ears know no corners closer than a tolerance, and the triangulation takes a corner that rounding
//! puts across an edge for a crossing. Every polygon of n vertices gives n - 2 triangles of the
//! same orientation, a large one also one more for each point where it touches an edge of its own.
//! Vertices that lie on a straight edge are kept, where earcut and its kin drop them and leave a
//! T-junction.
//!
//! A quadrilateral is cut at the diagonal from its first vertex unless only the other one lies
//! within it. The shorter diagonal would give better triangles, but then a file with bent
//! quadrilaterals would be another surface here than in MeshLab, trimesh and tobj, and rounding
//! would decide the pattern on a flat grid.

use glam::{DVec2, DVec3};
use mve_core::{Cancelled, Control};

use super::constrained;

/// Area below which a triangle is taken for a line, relative to the polygon's squared extent.
/// It is well above the rounding of the projection and far below any wanted triangle.
const FLAT: f64 = 1e-12;

/// Area below which a polygon's normal is rounding alone, relative to its squared extent.
const NOISE: f64 = 1e-15;

/// Corners up to which ears are clipped first: that takes the square of their number, but no
/// memory.
const SMALL: usize = 64;

/// Tests of a vertex against an ear for each corner, and in all for one polygon, before the rest
/// becomes a fan. Only polygons that cross themselves come near.
const MAX_TESTS: u64 = 20_000;
const MAX_ALL_TESTS: u64 = 200_000_000;

/// Such tests between two looks whether the work was cancelled.
const TESTS: u64 = 1 << 20;

/// How well a polygon was cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cut {
    /// The triangles cover the polygon.
    Exact,
    /// The polygon has no area or crosses itself: a part of it is a fan, which may overlap.
    Fan,
}

/// Cuts polygons; keeps its buffers from one to the next.
#[derive(Default)]
pub(crate) struct Triangulator {
    flat: Vec<DVec2>,
    previous: Vec<u32>,
    next: Vec<u32>,
    is_convex: Vec<bool>,
    blockers: Vec<u32>,
    n_tests: u64,
    tolerance: f64,
}

impl Triangulator {
    /// Cuts the polygon with these corner points and appends its triangles, as indices into
    /// `points`, to `triangles`. Mostly that takes about O(n log n) where they do not cross; the
    /// head of [`constrained`] says where not. Fewer than three points give no triangle.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn cut(
        &mut self,
        points: &[DVec3],
        triangles: &mut Vec<[u32; 3]>,
        control: Control,
    ) -> Result<Cut, Cancelled> {
        Ok(match *points {
            [] | [_] | [_, _] => Cut::Exact,
            [_, _, _] => {
                triangles.push([0, 1, 2]);
                Cut::Exact
            }
            [a, b, c, d] => {
                triangles.extend(cut_quad([a, b, c, d]));
                Cut::Exact
            }
            _ if self.flatten(points) => self.cut_flat(triangles, control)?,
            _ => {
                let corners: Vec<u32> = (0..points.len() as u32).collect();
                push_fan(&corners, triangles);
                Cut::Fan
            }
        })
    }

    fn cut_flat(
        &mut self,
        triangles: &mut Vec<[u32; 3]>,
        control: Control,
    ) -> Result<Cut, Cancelled> {
        let n_before = triangles.len();
        let is_small = self.flat.len() <= SMALL;
        if !is_small && constrained::cover(&self.flat, triangles, control)? {
            return Ok(Cut::Exact);
        }
        let cut = self.clip_ears(triangles, control)?;
        if cut == Cut::Fan && is_small {
            let mut others = Vec::new();
            if constrained::cover(&self.flat, &mut others, control)? {
                triangles.truncate(n_before);
                triangles.extend(others);
                return Ok(Cut::Exact);
            }
        }
        Ok(cut)
    }

    /// Looks at the polygon along the axis nearest to its Newell normal, from where it is
    /// counter-clockwise; `false` when it has none.
    fn flatten(&mut self, points: &[DVec3]) -> bool {
        let origin = points[0];
        let mut normal = DVec3::ZERO;
        let mut extent = 0.0_f64;
        for (i, &p) in points.iter().enumerate() {
            let q = points[(i + 1) % points.len()];
            normal += (p - origin).cross(q - origin);
            extent = extent.max((p - origin).abs().max_element());
        }
        self.tolerance = FLAT * extent * extent;
        // A polygon whose parts cancel, such as a figure of eight, has no plane to cut it in.
        if !normal.is_finite() || normal.length() <= NOISE * extent * extent {
            return false;
        }
        let axis = normal.abs().max_position();
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let (u, v) = if normal[axis] > 0.0 { (u, v) } else { (v, u) };
        self.flat.clear();
        self.flat.extend(points.iter().map(|p| DVec2::new(p[u], p[v])));
        true
    }

    fn clip_ears(
        &mut self,
        triangles: &mut Vec<[u32; 3]>,
        control: Control,
    ) -> Result<Cut, Cancelled> {
        let n = self.flat.len() as u32;
        self.start_ring(n);
        let most_tests = MAX_ALL_TESTS.min(u64::from(n) * MAX_TESTS);
        let (mut at, mut n_left, mut n_missed) = (0_u32, n, 0_u32);
        let mut n_reported = 0;
        while n_left > 3 {
            if self.n_tests - n_reported > TESTS {
                n_reported = self.n_tests;
                control.at(0.0)?;
            }
            if n_missed > n_left || self.n_tests > most_tests {
                return Ok(self.fan_rest(at, triangles));
            }
            let (before, after) = (self.previous[at as usize], self.next[at as usize]);
            if self.is_ear(before, at, after) {
                triangles.push([before, at, after]);
                self.next[before as usize] = after;
                self.previous[after as usize] = before;
                self.is_convex[before as usize] = self.turn_at(before) > self.tolerance;
                self.is_convex[after as usize] = self.turn_at(after) > self.tolerance;
                // Leaving the neighbor out for now keeps long thin fans away.
                at = self.next[after as usize];
                n_left -= 1;
                n_missed = 0;
            } else {
                at = after;
                n_missed += 1;
            }
        }
        triangles.push([self.previous[at as usize], at, self.next[at as usize]]);
        Ok(if self.turn_at(at) < -self.tolerance { Cut::Fan } else { Cut::Exact })
    }

    fn start_ring(&mut self, n: u32) {
        self.n_tests = 0;
        self.previous.clear();
        self.previous.extend((0..n).map(|i| (i + n - 1) % n));
        self.next.clear();
        self.next.extend((0..n).map(|i| (i + 1) % n));
        let is_convex = (0..n).map(|i| self.turn_at(i) > self.tolerance).collect();
        self.is_convex = is_convex;
        self.blockers.clear();
        self.blockers.extend((0..n).filter(|&i| !self.is_convex[i as usize]));
    }

    /// Twice the area of the triangle at a vertex of the ring: positive where it is convex.
    fn turn_at(&self, at: u32) -> f64 {
        let point = |i: u32| self.flat[i as usize];
        turn(point(self.previous[at as usize]), point(at), point(self.next[at as usize]))
    }

    /// Whether the triangle lies in the polygon and no other vertex of the ring is in it or on
    /// its new side. Only a vertex that is not convex can be there; one that became convex stays
    /// so, since clipping an ear only makes the angles beside it smaller.
    fn is_ear(&mut self, before: u32, at: u32, after: u32) -> bool {
        let point = |i: u32| self.flat[i as usize];
        // Of two equal neighbors one goes at once; as an ear it would never come up.
        if point(at) == point(before) || point(at) == point(after) {
            return true;
        }
        if !self.is_convex[at as usize] {
            return false;
        }
        let is_convex = &self.is_convex;
        self.blockers.retain(|&i| !is_convex[i as usize]);
        let [a, b, c] = [before, at, after].map(point);
        self.n_tests += self.blockers.len() as u64;
        let least = -self.tolerance;
        !self.blockers.iter().any(|&i| {
            let p = self.flat[i as usize];
            // Where polygons are joined to their holes, two vertices share a point.
            p != a
                && p != b
                && p != c
                && turn(c, a, p) >= least
                && turn(a, b, p) >= least
                && turn(b, c, p) >= least
        })
    }

    fn fan_rest(&self, from: u32, triangles: &mut Vec<[u32; 3]>) -> Cut {
        let mut rest = vec![from];
        let mut at = self.next[from as usize];
        while at != from {
            rest.push(at);
            at = self.next[at as usize];
        }
        push_fan(&rest, triangles);
        Cut::Fan
    }
}

fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - b)
}

fn push_fan(corners: &[u32], triangles: &mut Vec<[u32; 3]>) {
    triangles.extend(corners.windows(2).skip(1).map(|pair| [corners[0], pair[0], pair[1]]));
}

/// The two triangles of a quadrilateral.
fn cut_quad([a, b, c, d]: [DVec3; 4]) -> [[u32; 3]; 2] {
    let is_within =
        |first: [DVec3; 3], second: [DVec3; 3]| normal_of(first).dot(normal_of(second)) > 0.0;
    let at_second = !is_within([a, b, c], [a, c, d]) && is_within([a, b, d], [b, c, d]);
    if at_second { [[0, 1, 3], [1, 2, 3]] } else { [[0, 1, 2], [0, 2, 3]] }
}

fn normal_of([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

#[cfg(test)]
#[path = "triangulate_tests.rs"]
mod tests;
