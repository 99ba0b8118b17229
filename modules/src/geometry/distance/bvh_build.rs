//! Building the tree of [`Bvh`]: top down, by the surface area heuristic over binned centers
//! (Wald, "On fast construction of SAH-based bounding volume hierarchies", RT 2007), four ways a
//! node by splitting the largest part again. Of faces with the same corners the tree has one.
//! Where long faces lie across each other in all directions, so that no boxes tell them apart, the
//! tree is over [cells](super::cells) of space and has each face in several.

use glam::{DVec3, Vec4};
use mve_core::{Cancelled, Control};
use mve_mesh::data::{FaceId, TriMesh};
use mve_mesh::morton::{coarse_codes, sort_by_code};
use mve_mesh::random::IndexedRandom;

use super::boxes::{BoxFrame, EMPTY, LEAF, Node, TURNED};
use super::bvh::{Bvh, is_usable};
use super::bvh_split::{Part, bounds_of, centers_of, split};
use super::items::{Bounds, Item};
use super::point_triangle::PreparedTriangle;

/// Nodes over at most so many faces turn their boxes: larger ones are few.
const MOST_TURNED: usize = 4096;
/// Trees in which a point of the box around all is in more boxes than this, on average, are built
/// anew of cells: those over a surface have it in 20 or less, long faces in all
/// directions in hundreds.
const MOST_OVERLAP: f64 = 64.0;
/// Parts of at least this many triangles look whether the work was cancelled.
const REPORT_SIZE: usize = 2048;
/// Faces or items of a long loop between two such looks: a millisecond or so.
const STRIDE: usize = 1 << 15;

/// How much care a tree is built with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Care {
    /// For many queries.
    Much,
    /// For queries about as many as faces: parts are cells of a Morton curve (C. Lauterbach et al.,
    /// "Fast BVH construction on GPUs", Eurographics 2009), and boxes are not turned. Built in a
    /// fifth of the time, asked in one and a half of it.
    Little,
}

impl Bvh {
    /// Arranges the faces, O(n log n). Faces with a corner that is not finite, or beyond 1e150, or
    /// not there are left out and counted; degenerate faces are kept as the segment or point that
    /// they are.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn build(mesh: &TriMesh, control: Control) -> Result<Self, Cancelled> {
        Self::build_with(mesh, Care::Much, control)
    }

    /// The same where there are about as many queries as faces: the tree is built sooner, and each
    /// query takes a little longer.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn build_quickly(mesh: &TriMesh, control: Control) -> Result<Self, Cancelled> {
        Self::build_with(mesh, Care::Little, control)
    }

    fn build_with(mesh: &TriMesh, care: Care, control: Control) -> Result<Self, Cancelled> {
        control.at(0.0)?;
        let whole = Self::of_faces(mesh, care, control.part(0.0, 1.0))?;
        if whole.overlap(&control)? <= MOST_OVERLAP {
            return Ok(whole);
        }
        drop(whole);
        Self::of_cells(mesh, &control.part(1.0, 1.0))
    }

    /// In how many boxes a point of the box around all is, on average.
    fn overlap(&self, control: &Control) -> Result<f64, Cancelled> {
        let mut sum = 0.0;
        for (at, node) in self.nodes.iter().enumerate() {
            control.item(at, usize::MAX)?;
            sum += node.volume();
        }
        let whole = self.nodes.first().map_or(0.0, Node::volume_around);
        Ok(if whole > 0.0 { sum / whole } else { 0.0 })
    }

    /// Arranges the faces.
    fn of_faces(mesh: &TriMesh, care: Care, control: Control) -> Result<Self, Cancelled> {
        let corners_of = |face| usable_corners(mesh, face);
        let frame = frame_of(mesh.faces.len(), corners_of, control.part(0.0, 0.0))?;
        let mut items = Vec::with_capacity(mesh.faces.len());
        for face in 0..mesh.faces.len() {
            control.item(face, usize::MAX)?;
            let Some(corners) = corners_of(face) else { continue };
            let corners = corners.map(|p| frame.local(p));
            items.push(Item::around(face as u32, &corners));
        }
        let bounds = bounds_of(&items, control.part(0.0, 0.0))?;
        let main = control.part(0.0, 0.9);
        let codes = match care {
            Care::Much => Vec::new(),
            Care::Little => sort_along_curve(&mut items, control.part(0.0, 0.0))?,
        };
        let mut builder = Builder::new(mesh, frame, codes, items.len(), main);
        let whole = Part { start: 0, end: items.len(), bounds };
        builder.node(&mut items, whole, 0)?;
        let Builder { nodes, copies, .. } = builder;
        let copies = by_slot(copies, &items, control.part(0.9, 0.9))?;
        let mut triangles = Vec::with_capacity(items.len());
        let mut faces = Vec::with_capacity(items.len());
        for chunk in items.chunks(STRIDE) {
            control.at(0.9 + 0.1 * (faces.len() as f64 / items.len() as f64))?;
            let prepared =
                |item: &Item| corners_of(item.number as usize).map(PreparedTriangle::new);
            triangles.extend(chunk.iter().filter_map(prepared));
            faces.extend(chunk.iter().map(|item| FaceId(item.number)));
        }
        let n_left_out = mesh.faces.len() - items.len();
        Ok(Self { nodes, triangles, faces, copies, frame, n_left_out, lists: None })
    }
}

/// The corners of a face, if all are there and none is too far.
pub(super) fn usable_corners(mesh: &TriMesh, face: usize) -> Option<[DVec3; 3]> {
    let [a, b, c] = mesh.faces[face].map(|v| mesh.positions.get(v.idx()).copied());
    let corners = [a?, b?, c?];
    corners.iter().all(|&p| is_usable(p)).then_some(corners)
}

/// The middle of the faces' corners, and the power of two that brings them within -1 to 1.
pub(super) fn frame_of(
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

pub(super) struct Builder<'a> {
    mesh: &'a TriMesh,
    /// Whether items are cells.
    is_of_cells: bool,
    frame: BoxFrame,
    pub nodes: Vec<Node>,
    /// Faces of the tree, each with another of the same corners.
    copies: Vec<(FaceId, FaceId)>,
    /// Of items that lie along a Morton curve, the codes; otherwise none.
    codes: Vec<u64>,
    n_items: usize,
    n_placed: usize,
    control: Control<'a>,
}

impl<'a> Builder<'a> {
    /// Over faces of the mesh, as items along a curve with these codes if there are any.
    fn new(
        mesh: &'a TriMesh,
        frame: BoxFrame,
        codes: Vec<u64>,
        n_items: usize,
        control: Control<'a>,
    ) -> Self {
        let (nodes, copies) = Default::default();
        Self {
            mesh,
            is_of_cells: false,
            frame,
            nodes,
            copies,
            codes,
            n_items,
            n_placed: 0,
            control,
        }
    }

    /// Over cells along a curve.
    pub fn of_cells(
        mesh: &'a TriMesh,
        frame: BoxFrame,
        codes: Vec<u64>,
        n_items: usize,
        control: Control<'a>,
    ) -> Self {
        Self { is_of_cells: true, ..Self::new(mesh, frame, codes, n_items, control) }
    }

    /// Puts the items of `part` under a new node and returns its index.
    pub fn node(&mut self, items: &mut [Item], part: Part, depth: u32) -> Result<u32, Cancelled> {
        let done = self.n_placed as f64 / self.n_items.max(1) as f64;
        let here = self.control.part(done, done);
        if part.len() >= REPORT_SIZE {
            here.at(0.0)?;
        }
        let index = self.nodes.len();
        self.nodes.push(Node::EMPTY);
        let (parts, n_parts) = self.four_parts(items, part, depth, here)?;
        let parts = &parts[..n_parts];
        let (columns, boxes) = self.turned(items, parts);
        self.nodes[index].columns = columns;
        for (lane, (&part, bounds)) in parts.iter().zip(boxes).enumerate() {
            let child = match part.len() {
                0 => EMPTY,
                1 => {
                    self.n_placed += 1;
                    LEAF | part.start as u32
                }
                _ => self.node(items, part, depth + 2)?,
            };
            self.nodes[index].set_lane(lane, bounds.low, bounds.high, child);
        }
        Ok(index as u32)
    }

    /// The corners of an item in the tree's frame.
    fn corners(&self, item: &Item) -> [DVec3; 3] {
        self.mesh.corners(FaceId(item.number)).map(|p| self.frame.local(p))
    }

    /// The frame of a node over these parts, and their boxes in it: along the longest side of a
    /// face and the mean normal, or along the axes where that makes smaller boxes.
    fn turned(&self, items: &[Item], parts: &[Part]) -> ([Vec4; 4], [Bounds; 4]) {
        let mut boxes = [Bounds::EMPTY; 4];
        boxes.iter_mut().zip(parts).for_each(|(bounds, part)| *bounds = part.bounds);
        let along_axes = (Node::EMPTY.columns, boxes);
        let n_items: usize = parts.iter().map(Part::len).sum();
        if n_items > MOST_TURNED || !self.codes.is_empty() {
            return along_axes;
        }
        let Some(columns) = self.frame_along(items, parts) else { return along_axes };
        let [x, y, z, origin] = columns.map(|column| column.truncate().as_dvec3());
        let mut turned = [Bounds::EMPTY; 4];
        for (bounds, part) in turned.iter_mut().zip(parts) {
            for item in &items[part.start..part.end] {
                for p in self.corners(item) {
                    let p = (x * p.x + y * p.y + z * p.z + origin).as_vec3a();
                    bounds.add(p, p);
                }
            }
        }
        let area = |boxes: &[Bounds; 4]| boxes.iter().map(Bounds::half_area).sum::<f32>();
        if area(&turned) < area(&boxes) { (columns, turned) } else { along_axes }
    }

    /// A frame with x along the longest side of the faces and z along their mean normal.
    fn frame_along(&self, items: &[Item], parts: &[Part]) -> Option<[Vec4; 4]> {
        let (mut longest, mut normals) = (DVec3::ZERO, DVec3::ZERO);
        let mut origin = DVec3::ZERO;
        for item in parts.iter().flat_map(|part| &items[part.start..part.end]) {
            let [a, b, c] = self.corners(item);
            for side in [b - a, c - b, a - c] {
                if side.length_squared() > longest.length_squared() {
                    (longest, origin) = (side, a);
                }
            }
            let normal = (b - a).cross(c - a);
            normals += if normal.dot(normals) < 0.0 { -normal } else { normal };
        }
        let x = longest.try_normalize()?;
        let across = normals - x * normals.dot(x);
        let z = across.try_normalize().unwrap_or_else(|| x.any_orthonormal_vector());
        let rows = [x, z.cross(x), z];
        let column = |pick: fn(&DVec3) -> f64| DVec3::from(rows.each_ref().map(pick)).as_vec3();
        let [of_x, of_y, of_z] = [column(|row| row.x), column(|row| row.y), column(|row| row.z)];
        let moved = DVec3::from(rows.map(|row| -row.dot(origin))).as_vec3();
        let [of_x, of_y, of_z] = [of_x, of_y, of_z].map(|column| column.extend(0.0));
        Some([of_x, of_y, of_z, moved.extend(TURNED)])
    }

    /// Splits a part in up to four, always the largest in area next; says how many there are.
    fn four_parts(
        &mut self,
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
            let part = parts[chosen];
            // What lies in one cell of the curve is split as it is without a curve.
            if self.codes.get(part.start) != self.codes.get(part.end - 1) {
                [parts[chosen], parts[n_parts]] = self.split_along_curve(items, part, control)?;
                n_parts += 1;
                continue;
            }
            let centers = centers_of(&items[part.start..part.end], control)?;
            if centers.low == centers.high && !self.is_of_cells {
                let distinct = self.without_copies(items, part, control)?;
                self.n_placed += part.len() - distinct.len();
                parts[chosen] = distinct;
                if distinct.len() == 1 {
                    continue;
                }
            }
            let [left, right] = split(items, parts[chosen], centers, depth, control)?;
            parts[chosen] = left;
            parts[n_parts] = right;
            n_parts += 1;
        }
        Ok((parts, n_parts))
    }

    /// Splits a part of several cells of the curve where the largest of them ends.
    fn split_along_curve(
        &self,
        items: &[Item],
        part: Part,
        control: Control,
    ) -> Result<[Part; 2], Cancelled> {
        let codes = &self.codes[part.start..part.end];
        let bit = (codes[0] ^ codes[codes.len() - 1]).checked_ilog2().unwrap_or(0);
        let n_below = codes.partition_point(|code| code >> bit & 1 == 0);
        let cut = part.start + n_below;
        let below = bounds_of(&items[part.start..cut], control)?;
        let above = bounds_of(&items[cut..part.end], control)?;
        Ok([
            Part { start: part.start, end: cut, bounds: below },
            Part { start: cut, end: part.end, bounds: above },
        ])
    }

    /// Moves one of the faces with the same corners, each, to the front of a part, and ends the
    /// part behind them.
    fn without_copies(
        &mut self,
        items: &mut [Item],
        part: Part,
        control: Control,
    ) -> Result<Part, Cancelled> {
        let slice = &mut items[part.start..part.end];
        let mut keys = Vec::with_capacity(slice.len());
        for (at, item) in (0u32..).zip(slice.iter()) {
            control.item(at as usize, usize::MAX)?;
            keys.push((corner_code(self.mesh, item.number), at));
        }
        sort_by_code(&mut keys, control)?;
        let (mut distinct, mut copies): (Vec<Item>, Vec<Item>) = (Vec::new(), Vec::new());
        let mut last: Option<(u64, [[u64; 3]; 3])> = None;
        for (at, &(code, item)) in keys.iter().enumerate() {
            control.item(at, usize::MAX)?;
            let item = slice[item as usize];
            let corners = corner_bits(self.mesh, item.number);
            if let (Some(first), true) = (distinct.last(), last == Some((code, corners))) {
                self.copies.push((FaceId(first.number), FaceId(item.number)));
                copies.push(item);
            } else {
                last = Some((code, corners));
                distinct.push(item);
            }
        }
        let (front, back) = slice.split_at_mut(distinct.len());
        front.copy_from_slice(&distinct);
        back.copy_from_slice(&copies);
        Ok(Part { end: part.start + distinct.len(), ..part })
    }
}

/// The corners of a face as they are stored, in an order that does not depend on the face.
pub(super) fn corner_bits(mesh: &TriMesh, face: u32) -> [[u64; 3]; 3] {
    // Both zeros are one place.
    let bits = |p: DVec3| (p + 0.0).to_array().map(f64::to_bits);
    let mut corners = mesh.corners(FaceId(face)).map(bits);
    corners.sort_unstable();
    corners
}

/// A number that faces of the same corners share, and hardly any others.
pub(super) fn corner_code(mesh: &TriMesh, face: u32) -> u64 {
    let bits = corner_bits(mesh, face);
    bits.as_flattened().iter().fold(0, |code, &bits| IndexedRandom::new(code).bits(bits))
}

/// The copies by the slot of the face that the tree has.
fn by_slot(
    copies: Vec<(FaceId, FaceId)>,
    items: &[Item],
    control: Control,
) -> Result<Vec<(u32, FaceId)>, Cancelled> {
    if copies.is_empty() {
        return Ok(Vec::new());
    }
    let mut slots = vec![0; items.iter().map(|item| item.number as usize + 1).max().unwrap_or(0)];
    for (slot, item) in (0u32..).zip(items) {
        control.item(slot as usize, items.len())?;
        slots[item.number as usize] = slot;
    }
    let mut by_slot: Vec<_> =
        copies.into_iter().map(|(face, copy)| (slots[face.idx()], copy)).collect();
    by_slot.sort_unstable_by_key(|&(slot, copy)| (slot, copy.0));
    by_slot.dedup();
    Ok(by_slot)
}

/// Sorts items along a Morton curve; their codes.
pub(super) fn sort_along_curve(
    items: &mut Vec<Item>,
    control: Control,
) -> Result<Vec<u64>, Cancelled> {
    let centers: Vec<DVec3> = items.iter().map(|item| item.center().as_dvec3()).collect();
    let codes = coarse_codes(&centers, control)?;
    let mut keys: Vec<(u64, u32)> = codes.into_iter().zip(0..).collect();
    sort_by_code(&mut keys, control)?;
    *items = keys.iter().map(|&(_, at)| items[at as usize]).collect();
    Ok(keys.into_iter().map(|(code, _)| code).collect())
}

#[cfg(test)]
#[path = "bvh_build_tests.rs"]
mod tests;
