//! Which values the corners of a shape have, and its faces on their way into a mesh.

use std::collections::HashMap;

use mve_core::Control;
use mve_mesh::data::{NO_VALUE, VertexId};

use super::node::{Binding, NodeId, ShapeKind};
use crate::ReadError;
use crate::raw_mesh::RawMesh;

/// Polygons or strips between two looks whether the work was cancelled.
const PARTS: usize = 1 << 15;

/// Values of corners, those of each node once for each way in which it is turned.
pub(super) struct Placed<T> {
    pub values: Vec<T>,
    pub starts: HashMap<(NodeId, [u64; 9]), u32>,
    pub index: Vec<u32>,
}

impl<T> Default for Placed<T> {
    fn default() -> Self {
        Self { values: Vec::new(), starts: HashMap::new(), index: Vec::new() }
    }
}

impl<T> Placed<T> {
    /// The number of the first value of a node, which are put in if they are not there.
    pub fn start(&mut self, key: (NodeId, [u64; 9]), values: impl FnOnce() -> Vec<T>) -> u32 {
        *self.starts.entry(key).or_insert_with(|| {
            let start = self.values.len() as u32;
            self.values.extend(values());
            start
        })
    }
}

/// Values of which each corner of a shape has one.
pub(super) struct Choice<'a> {
    pub binding: Binding,
    pub index: &'a [i32],
    /// The number of the first value, and how many there are.
    pub start: u32,
    pub n: usize,
}

/// A corner of a shape: its part, face, place among corners, place in the list, and point.
struct CornerPlace {
    part: usize,
    face: usize,
    corner: usize,
    entry: usize,
    point: i32,
}

impl Choice<'_> {
    /// The number of the value of a corner.
    fn value(&self, at: &CornerPlace) -> u32 {
        let listed = |place: usize, otherwise: usize| match self.index.is_empty() {
            true => i32::try_from(otherwise).unwrap_or(-1),
            false => self.index.get(place).copied().unwrap_or(-1),
        };
        let number = match self.binding {
            Binding::Overall => 0,
            Binding::PerPart => at.part as i32,
            Binding::PerPartIndexed => listed(at.part, at.part),
            Binding::PerFace => at.face as i32,
            Binding::PerFaceIndexed => listed(at.face, at.face),
            Binding::PerVertex => at.corner as i32,
            Binding::PerVertexIndexed | Binding::Default => match self.index.is_empty() {
                true => at.point,
                false => listed(at.entry, at.entry),
            },
        };
        match usize::try_from(number) {
            Ok(number) if number < self.n => self.start + number as u32,
            _ => NO_VALUE,
        }
    }
}

/// The faces of a shape on their way into the mesh.
pub(super) struct Faces<'m, 's> {
    pub mesh: &'m mut RawMesh,
    /// Of normals, texture coordinates and colors, as the choices.
    pub lists: [&'m mut Vec<u32>; 3],
    pub choices: [Option<Choice<'s>>; 3],
    pub first: u32,
    pub n_points: usize,
    pub material: u32,
    pub is_reversed: bool,
    pub polygon: Vec<VertexId>,
    pub n_done: usize,
}

impl Faces<'_, '_> {
    /// Adds the polygons or strips of a list with -1 behind each.
    pub fn add_all(
        &mut self,
        kind: ShapeKind,
        index: &[i32],
        control: Control,
    ) -> Result<(), ReadError> {
        let (mut part, mut corner, mut entry) = (0, 0, 0);
        for run in index.split(|point| *point < 0) {
            if part % PARTS == 0 {
                control.at(0.5)?;
            }
            // What ends behind the last -1 is no part.
            if run.is_empty() && entry == index.len() {
                break;
            }
            let place = |at: usize, face: usize| CornerPlace {
                part,
                face,
                corner: corner + at,
                entry: entry + at,
                point: run[at],
            };
            match kind {
                ShapeKind::Polygons => self.add((0..run.len()).map(|at| place(at, part))),
                ShapeKind::Strips => {
                    for at in 0..run.len().saturating_sub(2) {
                        let turned = [[at, at + 1, at + 2], [at + 1, at, at + 2]][at % 2];
                        let face = self.n_done;
                        self.add(turned.into_iter().map(|at| place(at, face)));
                    }
                }
            }
            corner += run.len();
            entry += run.len() + 1;
            part += 1;
        }
        Ok(())
    }

    fn add(&mut self, places: impl DoubleEndedIterator<Item = CornerPlace> + Clone) {
        let number = self.n_done;
        self.n_done += 1;
        self.polygon.clear();
        let mut fault = None;
        let mut each = |place: CornerPlace| match usize::try_from(place.point) {
            Ok(point) if point < self.n_points => {
                self.polygon.push(VertexId(self.first + place.point as u32));
            }
            _ => fault = Some(place.point),
        };
        match self.is_reversed {
            true => places.clone().rev().for_each(&mut each),
            false => places.clone().for_each(&mut each),
        }
        if let Some(point) = fault {
            let last = self.n_points as i64 - 1;
            let text = || match last {
                ..0 => "it has no points before it".to_owned(),
                _ => format!("found point {point}, expected 0 to {last}"),
            };
            return self.mesh.leave_out(|| format!("face {number} of a shape"), text);
        }
        let n = self.polygon.len();
        if n < 3 {
            let text = || format!("it has {n} corners, fewer than 3");
            return self.mesh.leave_out(|| format!("face {number} of a shape"), text);
        }
        self.mesh.polygons.push(&self.polygon);
        self.mesh.face_materials.push(self.material);
        for (choice, list) in self.choices.iter().zip(&mut self.lists) {
            let Some(choice) = choice else { continue };
            match self.is_reversed {
                true => list.extend(places.clone().rev().map(|place| choice.value(&place))),
                false => list.extend(places.clone().map(|place| choice.value(&place))),
            }
        }
    }
}
