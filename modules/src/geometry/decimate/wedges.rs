//! What becomes of layers over corners while vertices go.
//!
//! When a vertex merges into a neighbor, each face that dies says which value of one meets which of
//! the other; corners that had the first take the second. At the seams of texture coordinates a
//! vertex goes only along the seam, where they are kept: each of its values has one to go to.

use std::collections::HashMap;

use mve_core::{Cancelled, Control};
use mve_mesh::data::{Layer, LayerValues, NO_VALUE};

/// One layer.
#[derive(Debug)]
pub struct WedgeLayer {
    /// The value of each corner; equal values have one number.
    index: Vec<u32>,
    is_kept: bool,
}

impl WedgeLayer {
    /// The values at the corners of faces of the input.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn new(
        layer: &Layer,
        keeps_seams: bool,
        faces: &[u32],
        control: Control,
    ) -> Result<Self, Cancelled> {
        let n_values = layer.values.len();
        let mut known: HashMap<[u64; 3], u32> = HashMap::new();
        let mut numbers = Vec::with_capacity(n_values);
        for value in 0..n_values {
            control.part(0.0, 0.5).item(value, n_values)?;
            let bits = |number: f64| number.to_bits();
            let key = match &layer.values {
                LayerValues::Number(v) => [bits(v[value]), 0, 0],
                LayerValues::Vec2(v) => [bits(v[value].x), bits(v[value].y), 0],
                LayerValues::Vec3(v) => v[value].to_array().map(bits),
                LayerValues::Label(_) => [value as u64, 0, 0],
            };
            numbers.push(*known.entry(key).or_insert(value as u32));
        }
        let corners = faces.iter().flat_map(|&face| [0, 1, 2].map(|k| 3 * face as usize + k));
        let mut index = Vec::with_capacity(3 * faces.len());
        for corner in corners {
            control.part(0.5, 1.0).item(index.len(), 3 * faces.len())?;
            let value = layer.index[corner];
            index.push(numbers.get(value as usize).copied().unwrap_or(NO_VALUE));
        }
        Ok(Self { index, is_kept: keeps_seams && layer.name == Layer::TEXCOORD })
    }

    /// The values at the corners of faces.
    pub fn of_faces(&self, faces: &[u32]) -> Vec<u32> {
        let corners = faces.iter().flat_map(|&face| [0, 1, 2].map(|k| 3 * face as usize + k));
        corners.map(|corner| self.index[corner]).collect()
    }

    /// The value at a corner.
    pub fn value(&self, corner: u32) -> u32 {
        self.index[corner as usize]
    }

    /// Sets the value at a corner.
    pub fn set(&mut self, corner: u32, value: u32) {
        self.index[corner as usize] = value;
    }

    /// Whether the values of a vertex may go to its neighbor. `dying` has the corners of both in
    /// each face that they share, `staying` the corners of the vertex in its other faces.
    pub fn may_merge(&self, dying: &[[u32; 2]], staying: &[u32]) -> bool {
        if !self.is_kept {
            return true;
        }
        let values = |pair: &[u32; 2]| pair.map(|corner| self.value(corner));
        let is_one = dying.iter().all(|pair| {
            let [from, to] = values(pair);
            dying.iter().map(values).all(|[other, goal]| other != from || goal == to)
        });
        let has_goal = |own: u32| dying.iter().any(|pair| self.value(pair[0]) == own);
        is_one && staying.iter().all(|&corner| has_goal(self.value(corner)))
    }

    /// Gives the corners of a vertex, but for those in dying faces, the values of its neighbor.
    pub fn merge(&mut self, dying: &[[u32; 2]], staying: &[u32]) {
        for &corner in staying {
            let own = self.value(corner);
            let pair = dying.iter().find(|pair| self.value(pair[0]) == own).or(dying.first());
            if let Some(&[_, to]) = pair {
                self.index[corner as usize] = self.value(to);
            }
        }
    }

    /// Whether corners at one vertex have different values that are to be kept.
    pub fn is_seam(&self, corners: &[u32]) -> bool {
        let is_equal = |pair: &[u32]| self.value(pair[0]) == self.value(pair[1]);
        self.is_kept && !corners.windows(2).all(is_equal)
    }
}
