//! Whether a ray meets a mesh.
//!
//! A binary tree of boxes over the triangles, by the surface area heuristic over binned centers (I.
//! Wald, "On fast construction of SAH-based bounding volume hierarchies", RT 2007); triangles by T.
//! Möller and B. Trumbore, "Fast, minimum storage ray/triangle intersection", Journal of Graphics
//! Tools 2(1), 1997. Boxes are `f32` and a little wider than they would have to be, so that none
//! hides a triangle; triangles are `f64`. The tree of distances has turned boxes, which rays cannot
//! use.

use glam::{DVec3, Vec3};
use mve_core::{Cancelled, Control};

use mve_mesh::data::TriMesh;

/// Triangles in a leaf at most, unless their centers are at one place.
const LEAF_SIZE: usize = 4;
/// Parts of the longest axis that a cut may lie between.
const N_BINS: usize = 16;
/// Levels below which parts are halved, whatever they cost.
const DEEPEST: usize = 48;
/// By how much boxes are wider than `f32` rounds, in units of the box around all.
const MARGIN: f32 = 1e-6;

/// A box and what is in it.
#[derive(Clone, Copy, Debug)]
struct Node {
    low: Vec3,
    high: Vec3,
    /// The first triangle of a leaf, or the second child; the first child follows the node.
    next: u32,
    /// Triangles of a leaf; 0 for a node with children.
    n_triangles: u32,
}

/// A corner of a triangle and the ways to the two others.
#[derive(Clone, Copy, Debug)]
struct Triangle {
    corner: DVec3,
    sides: [DVec3; 2],
}

/// The triangles of a mesh, arranged for rays.
#[derive(Clone, Debug)]
pub struct RayTree {
    nodes: Vec<Node>,
    triangles: Vec<Triangle>,
    /// What is moved to the origin, and by what lengths are multiplied then.
    center: DVec3,
    scale: f64,
}

/// A triangle while the tree is built.
#[derive(Clone, Copy)]
struct Item {
    low: Vec3,
    high: Vec3,
    face: u32,
}

impl Item {
    fn middle(&self) -> Vec3 {
        0.5 * (self.low + self.high)
    }
}

impl RayTree {
    /// Arranges the faces, O(n log n). Faces with a corner that is not finite are left out.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn build(mesh: &TriMesh, control: Control) -> Result<Self, Cancelled> {
        let usable = |face: &[mve_mesh::data::VertexId; 3]| {
            let corners = face.map(|v| mesh.positions[v.idx()]);
            let is_place = |p: &DVec3| p.abs().cmplt(DVec3::splat(FARTHEST)).all();
            corners.iter().all(is_place).then_some(corners)
        };
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for corners in mesh.faces.iter().filter_map(usable) {
            for p in corners {
                (low, high) = (low.min(p), high.max(p));
            }
        }
        let half = (0.5 * (high - low)).max_element();
        let scale = if half > 0.0 && half.is_finite() { 1.0 / half } else { 1.0 };
        let scale = if scale.is_finite() { scale } else { 1.0 };
        let center = if half.is_finite() { low + 0.5 * (high - low) } else { DVec3::ZERO };
        let mut tree = Self { nodes: Vec::new(), triangles: Vec::new(), center, scale };
        let (mut items, mut triangles) = (Vec::new(), Vec::new());
        for (place, face) in mesh.faces.iter().enumerate() {
            control.part(0.0, 0.2).item(place, mesh.faces.len())?;
            let Some(corners) = usable(face) else { continue };
            let [a, b, c] = corners.map(|p| tree.local(p));
            let (low, high) = (a.min(b).min(c).as_vec3(), a.max(b).max(c).as_vec3());
            items.push(Item { low, high, face: triangles.len() as u32 });
            triangles.push(Triangle { corner: a, sides: [b - a, c - a] });
        }
        let mut n_done = 0;
        tree.node(&mut items, [0, 0], &mut n_done, &control.part(0.2, 1.0))?;
        tree.triangles = items.iter().map(|item| triangles[item.face as usize]).collect();
        Ok(tree)
    }

    fn local(&self, point: DVec3) -> DVec3 {
        (point - self.center) * self.scale
    }

    /// The longest half side of the box around the faces, in model units.
    pub fn half_extent(&self) -> f64 {
        1.0 / self.scale
    }

    /// Adds the node of some items, the first of which is at `start` of all, so deep in the tree.
    fn node(
        &mut self,
        items: &mut [Item],
        [start, depth]: [usize; 2],
        n_done: &mut usize,
        control: &Control,
    ) -> Result<(), Cancelled> {
        // Without a face of which all corners are places there is no node: a node of no faces is
        // one of two others.
        if items.is_empty() {
            return Ok(());
        }
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let (mut first, mut last) = (low, high);
        for item in items.iter() {
            (low, high) = (low.min(item.low), high.max(item.high));
            (first, last) = (first.min(item.middle()), last.max(item.middle()));
        }
        let place = self.nodes.len();
        let margin = Vec3::splat(MARGIN);
        let (low, high) = (low - margin, high + margin);
        self.nodes.push(Node { low, high, next: start as u32, n_triangles: items.len() as u32 });
        let extent = last - first;
        if items.len() <= LEAF_SIZE || extent.max_element() <= 0.0 {
            *n_done += items.len();
            control.item(*n_done / LEAF_SIZE, usize::MAX)?;
            return Ok(());
        }
        if items.len() > 4096 {
            control.at(0.0)?;
        }
        let axis = extent.max_position();
        let bin = |item: &Item| {
            let share = (item.middle()[axis] - first[axis]) / extent[axis];
            ((share * N_BINS as f32) as usize).min(N_BINS - 1)
        };
        // Deeper, halves end soon.
        let cut = if depth < DEEPEST { best_cut(items, bin) } else { None };
        let mut n_first = 0;
        if let Some(cut) = cut {
            // Keeps no order within the parts, but always the same.
            for at in 0..items.len() {
                if bin(&items[at]) < cut {
                    items.swap(at, n_first);
                    n_first += 1;
                }
            }
        }
        if n_first == 0 || n_first == items.len() {
            n_first = items.len() / 2;
            items.select_nth_unstable_by(n_first, |a, b| {
                a.middle()[axis].total_cmp(&b.middle()[axis]).then(a.face.cmp(&b.face))
            });
        }
        let (left, right) = items.split_at_mut(n_first);
        self.node(left, [start, depth + 1], n_done, control)?;
        self.nodes[place].next = self.nodes.len() as u32;
        self.nodes[place].n_triangles = 0;
        self.node(right, [start + n_first, depth + 1], n_done, control)
    }

    /// Whether a ray meets a triangle, of either side, at most so far away. `direction` has length
    /// 1; `stack` is room to work in.
    pub fn is_blocked(
        &self,
        origin: DVec3,
        direction: DVec3,
        distance: f64,
        stack: &mut Vec<u32>,
    ) -> bool {
        let origin = self.local(origin);
        let distance = distance * self.scale;
        let (from, inverse) = (origin.as_vec3(), direction.as_vec3().recip());
        let most = distance.min(1e30) as f32;
        stack.clear();
        stack.push(0);
        while let Some(place) = stack.pop() {
            let Some(node) = self.nodes.get(place as usize) else { continue };
            let (one, two) = ((node.low - from) * inverse, (node.high - from) * inverse);
            // What is not a number, 0 times infinity, does not count in `min` and `max` of the
            // other operand; a ray within a side of a box stays in it.
            let near = near_of(one, two);
            let far = far_of(one, two) * (1.0 + 1e-6);
            if near > far || far < 0.0 || near > most {
                continue;
            }
            if node.n_triangles == 0 {
                stack.push(node.next);
                stack.push(place + 1);
                continue;
            }
            let first = node.next as usize;
            let triangles = &self.triangles[first..first + node.n_triangles as usize];
            if triangles.iter().any(|triangle| triangle.is_met(origin, direction, distance)) {
                return true;
            }
        }
        false
    }
}

/// Coordinates beyond this are no places.
const FARTHEST: f64 = 1e150;

fn near_of(one: Vec3, two: Vec3) -> f32 {
    one.x.min(two.x).max(one.y.min(two.y)).max(one.z.min(two.z))
}

fn far_of(one: Vec3, two: Vec3) -> f32 {
    one.x.max(two.x).min(one.y.max(two.y)).min(one.z.max(two.z))
}

/// The first bin behind the cut with the least cost: areas of both boxes by their numbers.
fn best_cut(items: &[Item], bin: impl Fn(&Item) -> usize) -> Option<usize> {
    let empty = (Vec3::INFINITY, Vec3::NEG_INFINITY, 0_usize);
    let mut bins = [empty; N_BINS];
    for item in items {
        let (low, high, n) = &mut bins[bin(item)];
        (*low, *high) = (low.min(item.low), high.max(item.high));
        *n += 1;
    }
    let area = |(low, high, n): (Vec3, Vec3, usize)| {
        let size = (high - low).max(Vec3::ZERO);
        n as f32 * (size.x * size.y + size.y * size.z + size.z * size.x)
    };
    let joined =
        |a: (Vec3, Vec3, usize), b: (Vec3, Vec3, usize)| (a.0.min(b.0), a.1.max(b.1), a.2 + b.2);
    let mut costs = [0.0; N_BINS];
    let (mut left, mut right) = (empty, empty);
    for cut in 1..N_BINS {
        left = joined(left, bins[cut - 1]);
        costs[cut] += area(left);
        right = joined(right, bins[N_BINS - cut]);
        costs[N_BINS - cut] += area(right);
    }
    (1..N_BINS).min_by(|&a, &b| f32::total_cmp(&costs[a], &costs[b]))
}

impl Triangle {
    fn is_met(&self, origin: DVec3, direction: DVec3, distance: f64) -> bool {
        let [one, two] = self.sides;
        let across = direction.cross(two);
        let determinant = one.dot(across);
        if determinant == 0.0 {
            return false;
        }
        let inverse = 1.0 / determinant;
        let from = origin - self.corner;
        let u = from.dot(across) * inverse;
        if !(0.0..=1.0).contains(&u) {
            return false;
        }
        let along = from.cross(one);
        let v = direction.dot(along) * inverse;
        let t = two.dot(along) * inverse;
        v >= 0.0 && u + v <= 1.0 && t >= 0.0 && t <= distance
    }
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::{cube, torus};
    use mve_mesh::random::IndexedRandom;

    use super::*;

    #[test]
    fn rays_into_and_past_a_cube() {
        let tree = RayTree::build(&cube(DVec3::splat(100.0)), Control::none()).unwrap();
        let mut stack = Vec::new();
        let mut is_blocked = |from: [f64; 3], to: DVec3, distance: f64| {
            let origin = DVec3::from(from) + 100.0;
            tree.is_blocked(origin, to, distance, &mut stack)
        };
        assert!(is_blocked([0.3, 0.4, 5.0], DVec3::NEG_Z, f64::INFINITY));
        assert!(!is_blocked([0.3, 0.4, 5.0], DVec3::NEG_Z, 3.9));
        assert!(is_blocked([0.3, 0.4, 5.0], DVec3::NEG_Z, 4.1));
        assert!(!is_blocked([0.3, 0.4, 5.0], DVec3::Z, f64::INFINITY));
        assert!(!is_blocked([1.3, 0.4, 5.0], DVec3::NEG_Z, f64::INFINITY));
        assert!(is_blocked([0.3, 0.4, 0.5], DVec3::X, f64::INFINITY));
    }

    /// The tree finds what a look at every triangle does.
    #[test]
    fn no_triangle_is_hidden() {
        let mesh = torus(2.0, 0.7, 20);
        let tree = RayTree::build(&mesh, Control::none()).unwrap();
        let random = IndexedRandom::new(1);
        let mut stack = Vec::new();
        let mut n_blocked = 0;
        for ray in 0..3000_u64 {
            let number = |k: u64| 2.0 * random.unit(6 * ray + k) - 1.0;
            let origin = 3.0 * DVec3::new(number(0), number(1), number(2));
            let Some(direction) = DVec3::new(number(3), number(4), number(5)).try_normalize()
            else {
                continue;
            };
            let local = tree.local(origin);
            let slow = tree.triangles.iter().any(|t| t.is_met(local, direction, 1e9));
            assert_eq!(tree.is_blocked(origin, direction, f64::INFINITY, &mut stack), slow);
            n_blocked += usize::from(slow);
        }
        assert!((500..2500).contains(&n_blocked), "{n_blocked}");
    }
}
