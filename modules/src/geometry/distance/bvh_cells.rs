//! Building the tree of [`Bvh`] over cells of space, each of which has a list of faces.

use mve_core::{Cancelled, Control};
use mve_mesh::data::{FaceId, TriMesh};
use mve_mesh::morton::sort_by_code;

use super::boxes::EMPTY;
use super::bvh::Bvh;
use super::bvh_build::{
    Builder, corner_bits, corner_code, frame_of, sort_along_curve, usable_corners,
};
use super::bvh_split::{Part, bounds_of};
use super::cells::Cells;
use super::lists::{Rod, SlotLists};
use super::point_triangle::PreparedTriangle;

impl Bvh {
    /// Arranges lists of the faces that pass through cells of space.
    pub(super) fn of_cells(mesh: &TriMesh, control: &Control) -> Result<Self, Cancelled> {
        let corners_of = |face| usable_corners(mesh, face);
        let frame = frame_of(mesh.faces.len(), corners_of, control.part(0.0, 0.0))?;
        let (distinct, copies) = distinct_faces(mesh, control)?;
        let n_left_out = mesh.faces.len() - distinct.len() - copies.len();
        let mut triangles = Vec::with_capacity(distinct.len());
        let mut local = Vec::with_capacity(distinct.len());
        for (at, corners) in
            distinct.iter().filter_map(|&face| corners_of(face as usize)).enumerate()
        {
            control.item(at, usize::MAX)?;
            triangles.push(PreparedTriangle::new(corners));
            local.push(corners.map(|p| frame.local(p)));
        }
        let slot_of = |face: u32| distinct.partition_point(|&other| other < face) as u32;
        let mut copies: Vec<_> =
            copies.into_iter().map(|(first, copy)| (slot_of(first), copy)).collect();
        copies.sort_unstable_by_key(|&(slot, copy)| (slot, copy.0));

        let rods = local.iter().map(|&corners| Rod::around(corners)).collect();
        let Cells { mut items, starts, faces: lists, mut grid, .. } = Cells::of(&local, control)?;
        drop(local);
        let bounds = bounds_of(&items, *control)?;
        let codes = sort_along_curve(&mut items, *control)?;
        let mut builder = Builder::of_cells(mesh, frame, codes, items.len(), *control);
        let whole = Part { start: 0, end: items.len(), bounds };
        builder.node(&mut items, whole, 0)?;
        let nodes = builder.nodes;
        let (mut list_starts, mut slots) = (vec![0], Vec::with_capacity(lists.len()));
        let mut now_at = vec![EMPTY; items.len()];
        for (at, item) in items.iter().enumerate() {
            control.item(at, usize::MAX)?;
            now_at[item.number as usize] = at as u32;
            let [start, end] = [0, 1].map(|k| starts[item.number as usize + k] as usize);
            slots.extend_from_slice(&lists[start..end]);
            list_starts.push(slots.len() as u32);
        }
        for list in grid.iter_mut().flat_map(|grid| &mut grid.lists).filter(|list| **list != EMPTY)
        {
            *list = now_at[*list as usize];
        }
        // The others stand behind, where no list leads.
        let others = copies.iter().map(|&(_, copy)| copy);
        triangles
            .extend(others.clone().filter_map(|f| corners_of(f.idx())).map(PreparedTriangle::new));
        let faces = distinct.into_iter().map(FaceId).chain(others).collect();

        let lists = Some(SlotLists { starts: list_starts, slots, rods, grid });
        Ok(Self { nodes, triangles, faces, copies, frame, n_left_out, lists })
    }
}

/// Faces, each with another of the same corners.
type Copies = Vec<(u32, FaceId)>;

/// The usable faces in order, of those with the same corners one, and the others each behind it.
fn distinct_faces(mesh: &TriMesh, control: &Control) -> Result<(Vec<u32>, Copies), Cancelled> {
    let mut keys = Vec::new();
    for face in 0..mesh.faces.len() {
        control.item(face, usize::MAX)?;
        if usable_corners(mesh, face).is_some() {
            keys.push((corner_code(mesh, face as u32), face as u32));
        }
    }
    sort_by_code(&mut keys, *control)?;
    // Of faces with the same corners the first is in the tree.
    let (mut distinct, mut copies) = (Vec::new(), Vec::new());
    let mut last = None;
    for (at, &(code, face)) in keys.iter().enumerate() {
        control.item(at, usize::MAX)?;
        let key = (code, corner_bits(mesh, face));
        match distinct.last() {
            Some(&first) if last == Some(key) => copies.push((first, FaceId(face))),
            _ => distinct.push(face),
        }
        last = Some(key);
    }
    drop(keys);
    distinct.sort_unstable();
    Ok((distinct, copies))
}
