//! Which of many parallel rays meet a mesh.
//!
//! Rays of one direction from places near to each other go through a tree of boxes as one: a box is
//! met if a ray from anywhere in the box around their origins could meet it, which takes no longer
//! than for one ray. Faces are tried by T. Möller and B. Trumbore, "Fast, minimum storage
//! ray/triangle intersection", Journal of Graphics Tools 2(1), 1997. As all rays have one
//! direction, what they do to a face is linear in their origins, and is computed once for all faces
//! of a leaf; then each ray that meets the box of the leaf is tried with all of them. That is done
//! in `f32` with room for rounding; what passes is tried in `f64`, which alone decides.

use glam::{DVec3, Vec3A};
use mve_core::{Cancelled, Control};
use mve_mesh::data::{TriMesh, VertexId};
use pulp::{Arch, Simd, WithSimd};

use super::ray_tree::{Child, LEAF_SIZE as BLOCK, MARGIN, Node, RayTree};

/// Rays that go together at most; a set of them is a `u32`.
pub const LANES: usize = 24;

/// By how much a difference of two places in `f32` is wrong: places are within the cube from -1 to
/// 1, about.
const ROUNDING: f32 = 4e-7;
/// By how much products of a few `f32` are wrong, in parts of those of their lengths.
const RELATIVE: f32 = 1e-6;

/// Coordinates beyond this are no places.
const FARTHEST: f64 = 1e150;

/// The faces of a mesh, arranged for rays.
#[derive(Clone, Debug)]
pub struct RayScene {
    /// Its leaves are blocks.
    tree: RayTree,
    blocks: Vec<Block>,
    /// In the order of the blocks.
    triangles: Vec<Triangle>,
    /// What is moved to the origin, and by what lengths are multiplied then.
    center: DVec3,
    scale: f64,
}

/// A corner of a triangle and the ways to the two others.
#[derive(Clone, Copy, Debug)]
struct Triangle {
    corner: DVec3,
    sides: [DVec3; 2],
}

/// A number of each triangle of a block.
type Numbers = [f32; BLOCK];

/// Triangles that are tried at once, rounded.
#[derive(Clone, Debug)]
struct Block {
    /// The first of them, and how many there are.
    first: u32,
    n: u32,
    /// The box around them, a little wider.
    low: [f32; 3],
    high: [f32; 3],
    /// By axis.
    corner: [Numbers; 3],
    sides: [[Numbers; 3]; 2],
    /// The sums of the parts of each side.
    lengths: [Numbers; 2],
}

/// What a direction makes of a block: products of these with the way from its corner to the origin
/// of a ray are how far that goes along both sides of a triangle, in parts of them, and along
/// itself.
struct Slant {
    across: [[Numbers; 3]; 3],
    /// How far each of them may be wrong.
    room: [Numbers; 3],
}

/// Where rays start, near to each other.
#[derive(Clone, Debug)]
pub struct Origins {
    exact: [DVec3; LANES],
    /// The same by axis.
    rounded: [[f32; LANES]; 3],
    n: usize,
}

/// The direction that rays have, and how far they go.
#[derive(Clone, Copy, Debug)]
pub struct Beam {
    direction: DVec3,
    distance: f64,
    /// One over the direction.
    inverse: Vec3A,
}

impl Origins {
    /// None.
    pub const NONE: Self = Self { exact: [DVec3::ZERO; LANES], rounded: [[0.0; LANES]; 3], n: 0 };

    /// How many there are.
    pub fn n(&self) -> usize {
        self.n
    }

    /// Adds a place that is one of [`RayScene::local`]. There is room for [`LANES`].
    pub fn push(&mut self, place: DVec3) {
        self.exact[self.n] = place;
        for (axis, number) in self.rounded.iter_mut().zip(place.as_vec3().to_array()) {
            axis[self.n] = number;
        }
        self.n += 1;
    }

    /// The box around those of a set.
    #[inline(always)]
    fn bounds(&self, set: u32) -> [Vec3A; 2] {
        let (mut low, mut high) = (Vec3A::INFINITY, Vec3A::NEG_INFINITY);
        for lane in (0..self.n).filter(|lane| set >> lane & 1 == 1) {
            let place = Vec3A::from_array(self.rounded.map(|axis| axis[lane]));
            (low, high) = (low.min(place), high.max(place));
        }
        [low, high]
    }
}

impl Beam {
    /// How far away a side of a node begins for rays from a box; infinitely far if none meets it.
    #[inline(always)]
    fn near(&self, node: &Node, side: usize, [first, last]: [Vec3A; 2]) -> f32 {
        let one = (node.low[side] - last) * self.inverse;
        let two = (node.high[side] - first) * self.inverse;
        let (near, far) = (one.min(two).max_element(), one.max(two).min_element());
        let is_met = near <= far && far >= 0.0 && near <= self.distance as f32;
        if is_met { near } else { f32::INFINITY }
    }
}

impl RayScene {
    /// Arranges the faces, O(n log n). Faces with a corner that is not finite are left out.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn build(mesh: &TriMesh, control: Control) -> Result<Self, Cancelled> {
        let usable = |face: &[VertexId; 3]| {
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
        let mut all = Vec::with_capacity(mesh.faces.len());
        let mut boxes = Vec::with_capacity(mesh.faces.len());
        for (place, face) in mesh.faces.iter().enumerate() {
            control.part(0.0, 0.2).item(place, mesh.faces.len())?;
            let Some(corners) = usable(face) else { continue };
            let [a, b, c] = corners.map(|p| (p - center) * scale);
            all.push(Triangle { corner: a, sides: [b - a, c - a] });
            boxes.push([a.min(b).min(c).as_vec3(), a.max(b).max(c).as_vec3()]);
        }
        let (mut tree, order) = RayTree::build(boxes.into_iter(), control.part(0.2, 0.9))?;
        let triangles: Vec<Triangle> = order.iter().map(|&number| all[number as usize]).collect();
        let mut blocks = Vec::with_capacity(triangles.len() / 3);
        tree.each_leaf(|leaf| {
            let first = blocks.len() as u32;
            let items = (leaf.next..leaf.next + leaf.n_items).step_by(BLOCK);
            let n_left = |start: u32| (leaf.next + leaf.n_items - start).min(BLOCK as u32);
            blocks.extend(items.map(|start| Block::of(&triangles, start, n_left(start))));
            *leaf = Child { next: first, n_items: blocks.len() as u32 - first };
        });
        control.at(1.0)?;
        Ok(Self { tree, blocks, triangles, center, scale })
    }

    /// A place as rays start from it.
    pub fn local(&self, point: DVec3) -> DVec3 {
        (point - self.center) * self.scale
    }

    /// The longest half side of the box around the faces, in model units.
    pub fn half_extent(&self) -> f64 {
        1.0 / self.scale
    }

    /// Rays of a direction, of length 1, that end so far away, in model units.
    pub fn beam(&self, direction: DVec3, distance: f64) -> Beam {
        // What is nearly 0 shall have an inverse that can be multiplied.
        let least = |x: f32| if x.abs() < 1e-12 { 1e-12_f32.copysign(x) } else { x };
        let inverse = direction.as_vec3().to_array().map(|x| 1.0 / least(x));
        let distance = distance * self.scale;
        Beam { direction, distance, inverse: Vec3A::from_array(inverse) }
    }

    /// The set of rays that meet a face, of either side: bit `k` for the `k`-th origin. `stack` is
    /// room to work in.
    pub fn blocked(&self, beam: &Beam, origins: &Origins, stack: &mut Vec<[u32; 2]>) -> u32 {
        Arch::new().dispatch(Trace { scene: self, beam, origins, stack })
    }
}

/// [`RayScene::blocked`] with the vector instructions of the machine. A closure in its place would
/// not be compiled for them.
struct Trace<'a> {
    scene: &'a RayScene,
    beam: &'a Beam,
    origins: &'a Origins,
    stack: &'a mut Vec<[u32; 2]>,
}

impl WithSimd for Trace<'_> {
    type Output = u32;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> u32 {
        let Self { scene, beam, origins, stack } = self;
        let all = (1_u32 << origins.n) - 1;
        let mut free = all;
        let mut bounds = origins.bounds(free);
        stack.clear();
        stack.push([scene.tree.root.next, scene.tree.root.n_items]);
        while let Some([next, n_items]) = stack.pop() {
            if n_items > 0 {
                let before = free;
                for block in &scene.blocks[next as usize..(next + n_items) as usize] {
                    free &= !block.met(scene, beam, origins, (free, bounds));
                }
                if free == 0 {
                    break;
                }
                if free != before {
                    bounds = origins.bounds(free);
                }
            } else if let Some(node) = scene.tree.nodes.get(next as usize) {
                let near = [0, 1].map(|side| beam.near(node, side, bounds));
                // What is nearer comes up first.
                let later = usize::from(near[0] <= near[1]);
                for side in [later, 1 - later] {
                    if near[side] < f32::INFINITY {
                        let Child { next, n_items } = node.children[side];
                        stack.push([next, n_items]);
                    }
                }
            }
        }
        all & !free
    }
}

impl Block {
    /// So many triangles from one on.
    fn of(triangles: &[Triangle], first: u32, n: u32) -> Self {
        let zero = [0.0; BLOCK];
        let (corner, sides, lengths) = ([zero; 3], [[zero; 3]; 2], [zero; 2]);
        let (low, high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        let mut block = Self { first, n, low, high, corner, sides, lengths };
        let own = &triangles[first as usize..(first + n) as usize];
        for (k, triangle) in own.iter().enumerate() {
            let corner = triangle.corner.as_vec3().to_array();
            let sides = triangle.sides.map(|side| side.as_vec3().to_array());
            for axis in 0..3 {
                let at = corner[axis];
                let ends = [at, at + sides[0][axis], at + sides[1][axis]];
                let low = ends.into_iter().fold(block.low[axis], |low, at| low.min(at - MARGIN));
                let high =
                    ends.into_iter().fold(block.high[axis], |high, at| high.max(at + MARGIN));
                (block.low[axis], block.high[axis]) = (low, high);
                block.corner[axis][k] = at;
                for (side, way) in sides.iter().enumerate() {
                    block.sides[side][axis][k] = way[axis];
                    block.lengths[side][k] += way[axis].abs();
                }
            }
        }
        block
    }

    /// The set of rays that meet one of the triangles, among those of a set, which start in a box.
    #[inline(always)]
    fn met(
        &self,
        scene: &RayScene,
        beam: &Beam,
        origins: &Origins,
        (free, bounds): (u32, [Vec3A; 2]),
    ) -> u32 {
        let mut left = self.reached(beam, origins) & free;
        if left == 0 {
            return 0;
        }
        let slant = self.slant(beam, bounds);
        let mut met = 0;
        while left != 0 {
            let lane = left.trailing_zeros() as usize;
            left &= left - 1;
            let near = self.near(lane, &slant, beam, origins);
            if near.iter().any(|is_near| *is_near != 0) {
                let own = &scene.triangles[self.first as usize..(self.first + self.n) as usize];
                let mut tried = own.iter().zip(near).filter(|(_, is_near)| *is_near != 0);
                let is_met = tried.any(|(triangle, _)| triangle.is_met(origins.exact[lane], beam));
                met |= u32::from(is_met) << lane;
            }
        }
        met
    }

    /// The rays that meet the box.
    #[inline(always)]
    fn reached(&self, beam: &Beam, origins: &Origins) -> u32 {
        let inverse = beam.inverse.to_array();
        let sides = [0, 1, 2].map(|axis| match inverse[axis] < 0.0 {
            true => [self.high[axis], self.low[axis]],
            false => [self.low[axis], self.high[axis]],
        });
        let most = beam.distance as f32;
        let [x, y, z] = &origins.rounded;
        let mut is_met = [0_u32; LANES];
        for lane in 0..LANES {
            let at = [x[lane], y[lane], z[lane]];
            let way = |side: usize, axis: usize| (sides[axis][side] - at[axis]) * inverse[axis];
            let larger = |a: f32, b: f32| if a > b { a } else { b };
            let smaller = |a: f32, b: f32| if a < b { a } else { b };
            let near = larger(larger(way(0, 0), way(0, 1)), way(0, 2));
            let far = smaller(smaller(way(1, 0), way(1, 1)), way(1, 2));
            is_met[lane] = u32::from((near <= far) & (far >= 0.0) & (near <= most)) << lane;
        }
        is_met.iter().fold(0, |set, lane| set | lane)
    }

    /// What the direction makes of it, for rays from a box.
    #[inline(always)]
    fn slant(&self, beam: &Beam, [first, last]: [Vec3A; 2]) -> Slant {
        let [x, y, z] = beam.direction.as_vec3().to_array();
        let middle = (0.5 * (first + last)).to_array();
        let half: f32 = (0.5 * (last - first)).to_array().into_iter().sum();
        let zero = [0.0; BLOCK];
        let mut slant = Slant { across: [[zero; 3]; 3], room: [zero; 3] };
        let [one, two] = &self.sides;
        for k in 0..BLOCK {
            let [a, b, c] = [one[0][k], one[1][k], one[2][k]];
            let [d, e, f] = [two[0][k], two[1][k], two[2][k]];
            let normal = [b * f - c * e, c * d - a * f, a * e - b * d];
            let inverse = -1.0 / (normal[0] * x + normal[1] * y + normal[2] * z);
            let across = [
                [f * y - e * z, d * z - f * x, e * x - d * y],
                [b * z - c * y, c * x - a * z, a * y - b * x],
                normal,
            ];
            let way = (middle[0] - self.corner[0][k]).abs()
                + (middle[1] - self.corner[1][k]).abs()
                + (middle[2] - self.corner[2][k]).abs();
            let [one, two] = [self.lengths[0][k], self.lengths[1][k]];
            let size = inverse.abs();
            let error = (ROUNDING + RELATIVE * (way + half)) * size;
            let rest = RELATIVE * size * one * two;
            let room = [error * two + rest, error * one + rest, error * one * two];
            for (part, (across, room)) in across.iter().zip(room).enumerate() {
                for (axis, number) in across.iter().enumerate() {
                    slant.across[part][axis][k] = number * inverse;
                }
                slant.room[part][k] = room;
            }
        }
        slant
    }

    /// Which triangles a ray comes near to.
    #[inline(always)]
    fn near(&self, lane: usize, slant: &Slant, beam: &Beam, origins: &Origins) -> [u32; BLOCK] {
        let at = [origins.rounded[0][lane], origins.rounded[1][lane], origins.rounded[2][lane]];
        let most = beam.distance as f32;
        let mut is_near = [0; BLOCK];
        for k in 0..BLOCK {
            let a = at[0] - self.corner[0][k];
            let b = at[1] - self.corner[1][k];
            let c = at[2] - self.corner[2][k];
            let [u, v, t] = &slant.across;
            let u = a * u[0][k] + b * u[1][k] + c * u[2][k];
            let v = a * v[0][k] + b * v[1][k] + c * v[2][k];
            let t = a * t[0][k] + b * t[1][k] + c * t[2][k];
            let [of_u, of_v, of_t] = [slant.room[0][k], slant.room[1][k], slant.room[2][k]];
            // What is not a number is tried.
            let is_past = (u < -of_u)
                | (v < -of_v)
                | (u + v > 1.0 + of_u + of_v)
                | (t < -of_t)
                | (t > most + of_t);
            is_near[k] = u32::from(!is_past);
        }
        is_near
    }
}

impl Triangle {
    fn is_met(&self, origin: DVec3, beam: &Beam) -> bool {
        let [one, two] = self.sides;
        let across = beam.direction.cross(two);
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
        let v = beam.direction.dot(along) * inverse;
        let t = two.dot(along) * inverse;
        v >= 0.0 && u + v <= 1.0 && t >= 0.0 && t <= beam.distance
    }
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::{cube, torus};
    use mve_mesh::random::IndexedRandom;

    use super::*;

    #[test]
    fn rays_into_and_past_a_cube() {
        let scene = RayScene::build(&cube(DVec3::splat(100.0)), Control::none()).unwrap();
        let is_blocked = |from: [f64; 3], to: DVec3, distance: f64| {
            let mut origins = Origins::NONE;
            origins.push(scene.local(DVec3::from(from) + 100.0));
            scene.blocked(&scene.beam(to, distance), &origins, &mut Vec::new()) == 1
        };
        assert!(is_blocked([0.3, 0.4, 5.0], DVec3::NEG_Z, f64::INFINITY));
        assert!(!is_blocked([0.3, 0.4, 5.0], DVec3::NEG_Z, 3.9));
        assert!(is_blocked([0.3, 0.4, 5.0], DVec3::NEG_Z, 4.1));
        assert!(!is_blocked([0.3, 0.4, 5.0], DVec3::Z, f64::INFINITY));
        assert!(!is_blocked([1.3, 0.4, 5.0], DVec3::NEG_Z, f64::INFINITY));
        assert!(is_blocked([0.3, 0.4, 0.5], DVec3::X, f64::INFINITY));
    }

    /// The tree finds what a look at every triangle does, for rays near to each other and far.
    #[test]
    fn no_triangle_is_hidden() {
        let mesh = torus(2.0, 0.7, 20);
        let scene = RayScene::build(&mesh, Control::none()).unwrap();
        let random = IndexedRandom::new(1);
        let mut stack = Vec::new();
        let mut n_blocked = 0;
        for packet in 0..1000_u64 {
            let number = |k: u64| 2.0 * random.unit(64 * packet + k) - 1.0;
            let vector = |k: u64| DVec3::new(number(k), number(k + 1), number(k + 2));
            let Some(direction) = vector(0).try_normalize() else { continue };
            let beam = scene.beam(direction, if packet % 5 == 0 { 1.5 } else { f64::INFINITY });
            let spread = if packet % 2 == 0 { 0.1 } else { 3.0 };
            let mut origins = Origins::NONE;
            for lane in 0..1 + packet % LANES as u64 {
                let origin = 3.0 * vector(3) + spread * vector(6 + 3 * lane);
                origins.push(scene.local(origin));
            }
            let found = scene.blocked(&beam, &origins, &mut stack);
            for lane in 0..origins.n() {
                let origin = origins.exact[lane];
                let slow = scene.triangles.iter().any(|t| t.is_met(origin, &beam));
                assert_eq!(found >> lane & 1 == 1, slow);
                n_blocked += usize::from(slow);
            }
            assert_eq!(found >> origins.n(), 0);
        }
        assert!((1000..7000).contains(&n_blocked), "{n_blocked}");
    }
}
