//! Building the tree of [`Bvh`]: top down, by the surface area heuristic over binned centers
//! (Wald, "On fast construction of SAH-based bounding volume hierarchies", RT 2007), four ways a
//! node by splitting the largest part again.

use glam::{DVec3, Vec3A};
use mve_core::{Cancelled, Control};

use super::bvh::{BoxFrame, Bvh, EMPTY, LEAF, Node, is_usable};
use super::point_triangle::PreparedTriangle;
use crate::data::{FaceId, TriMesh};

/// Bins along the longest axis.
const N_BINS: usize = 16;
/// Below this depth parts are halved by count, which bounds the depth of the tree.
const SAH_DEPTH: u32 = 40;
/// Parts of at least this many triangles look whether the work was cancelled.
const REPORT_SIZE: usize = 2048;
/// Faces or items of a long loop between two such looks: a millisecond or so.
const STRIDE: usize = 1 << 15;

/// A face and its box in the tree's frame.
#[derive(Clone, Copy)]
struct Item {
    low: Vec3A,
    high: Vec3A,
    face: u32,
}

impl Item {
    /// Twice the center of the box.
    fn center(&self) -> Vec3A {
        self.low + self.high
    }
}

/// A box that grows.
#[derive(Clone, Copy)]
struct Bounds {
    low: Vec3A,
    high: Vec3A,
}

impl Bounds {
    const EMPTY: Self = Self { low: Vec3A::INFINITY, high: Vec3A::NEG_INFINITY };

    fn add(&mut self, low: Vec3A, high: Vec3A) {
        self.low = self.low.min(low);
        self.high = self.high.max(high);
    }

    /// Half the surface area; 0 when empty.
    fn half_area(&self) -> f32 {
        let d = (self.high - self.low).max(Vec3A::ZERO);
        d.x * d.y + d.y * d.z + d.z * d.x
    }
}

/// A run of items that becomes one child.
#[derive(Clone, Copy)]
struct Part {
    start: usize,
    end: usize,
    bounds: Bounds,
}

impl Part {
    fn len(&self) -> usize {
        self.end - self.start
    }
}

impl Bvh {
    /// Arranges the faces, O(n log n). Faces with a corner that is not finite, or beyond 1e150, or
    /// not there are left out and counted; degenerate faces are kept as the segment or point that
    /// they are.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn build(mesh: &TriMesh, control: Control) -> Result<Self, Cancelled> {
        control.at(0.0)?;
        let corners_of = |face: usize| -> Option<[DVec3; 3]> {
            let [a, b, c] = mesh.faces[face].map(|v| mesh.positions.get(v.idx()).copied());
            let corners = [a?, b?, c?];
            corners.iter().all(|&p| is_usable(p)).then_some(corners)
        };
        let frame = frame_of(mesh.faces.len(), corners_of, control.part(0.0, 0.0))?;
        let mut items = Vec::with_capacity(mesh.faces.len());
        for face in 0..mesh.faces.len() {
            if face % STRIDE == 0 {
                control.at(0.0)?;
            }
            if let Some(corners) = corners_of(face) {
                let mut bounds = Bounds::EMPTY;
                for corner in corners {
                    let (low, high) = frame.around(corner);
                    bounds.add(low, high);
                }
                items.push(Item { low: bounds.low, high: bounds.high, face: face as u32 });
            }
        }
        let bounds = bounds_of(&items, control.part(0.0, 0.0))?;
        let main = control.part(0.0, 0.9);
        let mut builder =
            Builder { nodes: Vec::new(), n_items: items.len(), n_placed: 0, control: main };
        let whole = Part { start: 0, end: items.len(), bounds };
        builder.node(&mut items, whole, 0)?;
        let nodes = builder.nodes;
        let mut triangles = Vec::with_capacity(items.len());
        let mut faces = Vec::with_capacity(items.len());
        for chunk in items.chunks(STRIDE) {
            control.at(0.9 + 0.1 * (faces.len() as f64 / items.len() as f64))?;
            let prepared = |item: &Item| corners_of(item.face as usize).map(PreparedTriangle::new);
            triangles.extend(chunk.iter().filter_map(prepared));
            faces.extend(chunk.iter().map(|item| FaceId(item.face)));
        }
        Ok(Self { nodes, triangles, faces, frame, n_left_out: mesh.faces.len() - items.len() })
    }
}

/// The middle of the faces' corners, and the power of two that brings them within -1 to 1.
fn frame_of(
    n_faces: usize,
    corners_of: impl Fn(usize) -> Option<[DVec3; 3]>,
    control: Control,
) -> Result<BoxFrame, Cancelled> {
    let mut low = DVec3::INFINITY;
    let mut high = DVec3::NEG_INFINITY;
    for face in 0..n_faces {
        if face % STRIDE == 0 {
            control.at(0.0)?;
        }
        for point in corners_of(face).into_iter().flatten() {
            low = low.min(point);
            high = high.max(point);
        }
    }
    let radius = ((high - low) * 0.5).max_element();
    if !(radius > 1e-150 && radius.is_finite()) {
        let center = if low.is_finite() { low } else { DVec3::ZERO };
        return Ok(BoxFrame { center, scale: 1.0 });
    }
    Ok(BoxFrame { center: low * 0.5 + high * 0.5, scale: (-radius.log2().ceil()).exp2() })
}

fn bounds_of(items: &[Item], control: Control) -> Result<Bounds, Cancelled> {
    let mut bounds = Bounds::EMPTY;
    for chunk in items.chunks(STRIDE) {
        report_long(chunk, control)?;
        for item in chunk {
            bounds.add(item.low, item.high);
        }
    }
    Ok(bounds)
}

struct Builder<'a> {
    nodes: Vec<Node>,
    n_items: usize,
    n_placed: usize,
    control: Control<'a>,
}

impl Builder<'_> {
    /// Puts the items of `part` under a new node and returns its index.
    fn node(&mut self, items: &mut [Item], part: Part, depth: u32) -> Result<u32, Cancelled> {
        let done = self.n_placed as f64 / self.n_items.max(1) as f64;
        let here = self.control.part(done, done);
        if part.len() >= REPORT_SIZE {
            here.at(0.0)?;
        }
        let index = self.nodes.len();
        self.nodes.push(Node::empty());
        let (parts, n_parts) = four_parts(items, part, depth, here)?;
        for (lane, &part) in parts[..n_parts].iter().enumerate() {
            let child = match part.len() {
                0 => EMPTY,
                1 => {
                    self.n_placed += 1;
                    LEAF | part.start as u32
                }
                _ => self.node(items, part, depth + 2)?,
            };
            self.nodes[index].set_lane(lane, part.bounds.low, part.bounds.high, child);
        }
        Ok(index as u32)
    }
}

/// Splits a part in up to four, always the largest in area next; says how many there are.
fn four_parts(
    items: &mut [Item],
    part: Part,
    depth: u32,
    control: Control,
) -> Result<([Part; 4], usize), Cancelled> {
    let mut parts = [part; 4];
    let mut n_parts = 1;
    while n_parts < 4 {
        let mut chosen = None;
        let mut most = -1.0;
        for (k, part) in parts[..n_parts].iter().enumerate() {
            let area = part.bounds.half_area();
            if part.len() > 1 && area > most {
                (chosen, most) = (Some(k), area);
            }
        }
        let Some(chosen) = chosen else { break };
        let [left, right] = split(items, parts[chosen], depth, control)?;
        parts[chosen] = left;
        parts[n_parts] = right;
        n_parts += 1;
    }
    Ok((parts, n_parts))
}

/// Splits a part of at least two items in two that are not empty.
fn split(
    items: &mut [Item],
    part: Part,
    depth: u32,
    control: Control,
) -> Result<[Part; 2], Cancelled> {
    let slice = &mut items[part.start..part.end];
    let mut centers = Bounds::EMPTY;
    for chunk in slice.chunks(STRIDE) {
        report_long(chunk, control)?;
        for item in chunk {
            centers.add(item.center(), item.center());
        }
    }
    let extent = centers.high - centers.low;
    let axis = extent.max_position();
    let by_bins = if extent[axis] > 0.0 && depth < SAH_DEPTH {
        split_by_area(slice, axis, centers.low[axis], extent[axis], control)?
    } else {
        None
    };
    let (count, bounds) = match by_bins {
        Some(found) => found,
        None => split_by_count(slice, axis, control)?,
    };
    let cut = part.start + count;
    let [below, above] = bounds;
    Ok([
        Part { start: part.start, end: cut, bounds: below },
        Part { start: cut, end: part.end, bounds: above },
    ])
}

/// Looks whether the work was cancelled, if the chunk of a loop is a whole one.
fn report_long(chunk: &[Item], control: Control) -> Result<(), Cancelled> {
    if chunk.len() == STRIDE { control.at(0.0) } else { Ok(()) }
}

/// Reorders the items by the median of their centers; returns as [`split_by_area`] does.
fn split_by_count(
    slice: &mut [Item],
    axis: usize,
    control: Control,
) -> Result<(usize, [Bounds; 2]), Cancelled> {
    let half = slice.len() / 2;
    slice.select_nth_unstable_by(half, |a, b| {
        a.center()[axis].total_cmp(&b.center()[axis]).then(a.face.cmp(&b.face))
    });
    let (below, above) = slice.split_at(half);
    Ok((half, [bounds_of(below, control)?, bounds_of(above, control)?]))
}

/// Reorders the items by the cheapest plane between bins; returns how many lie before it, and the
/// boxes of both sides.
fn split_by_area(
    slice: &mut [Item],
    axis: usize,
    low: f32,
    extent: f32,
    control: Control,
) -> Result<Option<(usize, [Bounds; 2])>, Cancelled> {
    let n_bins = if slice.len() < 2 * N_BINS { N_BINS / 2 } else { N_BINS };
    let per_extent = n_bins as f32 * (1.0 - 1e-6) / extent;
    let bin_of =
        |item: &Item| (((item.center()[axis] - low) * per_extent) as i32 as usize).min(n_bins - 1);
    let mut bins = [(Bounds::EMPTY, 0usize); N_BINS];
    for chunk in slice.chunks(STRIDE) {
        report_long(chunk, control)?;
        for item in chunk {
            let (bounds, count) = &mut bins[bin_of(item)];
            bounds.add(item.low, item.high);
            *count += 1;
        }
    }
    let mut above = [(Bounds::EMPTY, 0); N_BINS];
    for cut in (1..n_bins).rev() {
        let mut sum = if cut + 1 < n_bins { above[cut + 1] } else { (Bounds::EMPTY, 0) };
        sum.0.add(bins[cut].0.low, bins[cut].0.high);
        sum.1 += bins[cut].1;
        above[cut] = sum;
    }
    let cost = |(bounds, count): (Bounds, usize)| bounds.half_area() * count as f32;
    let mut below = (Bounds::EMPTY, 0);
    let mut best: Option<(f32, usize, [Bounds; 2])> = None;
    for cut in 1..n_bins {
        below.0.add(bins[cut - 1].0.low, bins[cut - 1].0.high);
        below.1 += bins[cut - 1].1;
        let total = cost(below) + cost(above[cut]);
        let is_cut = below.1 > 0 && below.1 < slice.len();
        if is_cut && best.is_none_or(|(least, ..)| total < least) {
            best = Some((total, cut, [below.0, above[cut].0]));
        }
    }
    let Some((_, cut, bounds)) = best else { return Ok(None) };
    let mut n_before = 0;
    for k in 0..slice.len() {
        if k % STRIDE == STRIDE - 1 {
            control.at(0.0)?;
        }
        if bin_of(&slice[k]) < cut {
            slice.swap(n_before, k);
            n_before += 1;
        }
    }
    Ok(Some((n_before, bounds)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::fixtures::mesh_of;
    use proptest::prelude::*;

    fn brute_force(mesh: &TriMesh, point: DVec3) -> f64 {
        (0..mesh.faces.len())
            .map(|f| mesh.corners(FaceId(f as u32)))
            .filter(|corners| corners.iter().all(|p| p.is_finite()))
            .map(|corners| PreparedTriangle::new(corners).distance_sq(point))
            .fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn empty_and_non_finite_meshes_find_nothing() {
        let none = Bvh::build(&TriMesh::default(), Control::none()).unwrap();
        assert_eq!(none.closest(DVec3::ZERO), None);
        let bad =
            mesh_of(&[[f64::NAN, 0.0, 0.0], [1.0, 0.0, 0.0], [f64::INFINITY; 3]], &[[0, 1, 2]]);
        let bvh = Bvh::build(&bad, Control::none()).unwrap();
        assert_eq!((bvh.n_faces(), bvh.n_left_out()), (0, 1));
        assert_eq!(bvh.closest(DVec3::ZERO), None);
    }

    #[test]
    fn a_query_that_is_not_finite_finds_nothing() {
        let bvh = Bvh::build(&crate::mesh::fixtures::tetrahedron(), Control::none()).unwrap();
        assert_eq!(bvh.closest(DVec3::NAN), None);
        assert_eq!(bvh.closest(DVec3::INFINITY), None);
        assert!(bvh.closest(DVec3::splat(1e149)).is_some());
    }

    #[test]
    fn a_thousand_copies_of_one_face_build() {
        let faces = vec![[0, 1, 2]; 1000];
        let mesh = mesh_of(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &faces);
        let bvh = Bvh::build(&mesh, Control::none()).unwrap();
        assert_eq!(bvh.closest(DVec3::new(0.2, 0.2, -3.0)).unwrap().distance_sq, 9.0);
    }

    fn any_point() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-1.0..1.0f64).prop_map(DVec3::from)
    }

    proptest! {
        /// Single queries, seeded or not, and batches agree with the least over all faces, far
        /// from the origin and for large and small models too.
        #[test]
        fn agrees_with_brute_force(
            corners in prop::collection::vec(any_point(), 3..120),
            picks in prop::collection::vec(prop::array::uniform3(0u32..120), 1..120),
            queries in prop::collection::vec(any_point(), 3..24),
            shift in prop::sample::select(vec![0.0, 1.0, 1e6]),
            scale in prop::sample::select(vec![1e-30, 1e-3, 1.0, 1e40]),
            spread in prop::sample::select(vec![0.01, 1.0, 50.0]),
        ) {
            let place = |p: DVec3| (p + DVec3::splat(shift)) * scale;
            let n = corners.len() as u32;
            let points: Vec<[f64; 3]> = corners.iter().map(|&p| place(p).to_array()).collect();
            let faces: Vec<[u32; 3]> = picks.iter().map(|f| f.map(|v| v % n)).collect();
            let mesh = mesh_of(&points, &faces);
            let bvh = Bvh::build(&mesh, Control::none()).unwrap();
            let queries: Vec<DVec3> = queries.iter().map(|&q| place(q * spread)).collect();
            let expected: Vec<f64> = queries.iter().map(|&q| brute_force(&mesh, q)).collect();
            let mut walker = bvh.walker();
            let mut batch = Vec::new();
            bvh.walker().distances_sq(&queries, &mut batch);
            prop_assert_eq!(&batch, &expected);
            for (&query, &expected) in queries.iter().zip(&expected) {
                prop_assert_eq!(bvh.closest(query).unwrap().distance_sq, expected);
                prop_assert_eq!(walker.closest(query).unwrap().distance_sq, expected);
            }
        }
    }
}
