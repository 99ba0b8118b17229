//! The walk over the surface within a sphere around a vertex, for several radii in turn.
//!
//! From the center the walk passes along edges that lead outward and lie wholly within the sphere,
//! and lists those that the sphere cuts. A larger radius goes on from there: the edges that were
//! cut are looked at again, and nothing else. The order of the walk does not change which edges and
//! vertices it meets.

use mve_core::{Cancelled, Control};

use super::curvature_mesh::CurvatureMesh;

/// A length fraction below this is rounding; the program that is followed takes 0.01 in its place.
const LEAST_CUT: f64 = 1e-16;
/// Squared length of an edge below which it has no direction, relative to the squared size of the
/// mesh.
pub(super) const NO_LENGTH_SQ: f64 = 2.2e-16;
/// Edges between two looks whether the work was cancelled.
const STRIDE: u32 = 1 << 14;

/// An edge that the sphere cuts, from the end within.
#[derive(Clone, Copy, Debug)]
pub(in crate::geometry) struct Cut {
    pub from: u32,
    pub to: u32,
    pub edge: u32,
    /// The part of the edge within the sphere, 0 to 1.
    pub part: f64,
    /// (to − from) · (from − center)
    outward: f64,
    /// |to − from|²
    length_sq: f64,
    /// |from − center|²
    from_sq: f64,
}

impl Cut {
    /// The squared distance from the center of the point where the sphere cuts.
    pub fn distance_sq(&self) -> f64 {
        self.from_sq + self.part * (2.0 * self.outward + self.part * self.length_sq)
    }

    /// Where the sphere meets the line of the edge, as a multiple of the edge.
    ///
    /// The larger root of |from + t e − center|² = radius², in the form without cancellation.
    #[inline]
    fn meets(&self, radius_sq: f64) -> f64 {
        let room = radius_sq - self.from_sq;
        let root = (self.outward * self.outward + self.length_sq * room).sqrt();
        room / (self.outward + root)
    }
}

/// The state of a walk, to be used for one center after the other.
#[derive(Debug)]
pub(in crate::geometry) struct Walk {
    /// The number of the walk that met each vertex last.
    met: Vec<u32>,
    number: u32,
    /// Vertices within the sphere, in the order in which they were met; the first is the center.
    reached: Vec<u32>,
    /// How many of them have had their edges looked at.
    n_done: usize,
    cuts: Vec<Cut>,
    /// Edges wholly within the sphere that have been passed.
    whole: Vec<u32>,
    n_seen: u32,
}

impl Walk {
    /// Room for walks on a mesh of `n_vertices`.
    pub fn new(n_vertices: usize) -> Self {
        Self {
            met: vec![0; n_vertices],
            number: 0,
            reached: Vec::new(),
            n_done: 0,
            cuts: Vec::new(),
            whole: Vec::new(),
            n_seen: 0,
        }
    }

    /// Begins at a vertex, with radius 0.
    pub fn start(&mut self, center: u32) {
        if self.number == u32::MAX {
            self.met.fill(0);
            self.number = 0;
        }
        self.number += 1;
        self.met[center as usize] = self.number;
        self.reached.clear();
        self.reached.push(center);
        self.n_done = 0;
        self.cuts.clear();
        self.whole.clear();
    }

    /// The vertices within the sphere; the first is the center.
    pub fn reached(&self) -> &[u32] {
        &self.reached
    }

    /// The edges that the sphere cuts.
    pub fn cuts(&self) -> &[Cut] {
        &self.cuts
    }

    /// The edges wholly within the sphere; a larger radius adds at the end.
    pub fn whole(&self) -> &[u32] {
        &self.whole
    }

    /// Goes on to a radius no smaller than before.
    pub fn grow(
        &mut self,
        surface: &CurvatureMesh,
        radius: f64,
        control: &Control,
    ) -> Result<(), Cancelled> {
        let radius_sq = radius * radius;
        let mut n_kept = 0;
        for at in 0..self.cuts.len() {
            let mut cut = self.cuts[at];
            if self.is_cut(&mut cut, radius_sq) {
                self.cuts[n_kept] = cut;
                n_kept += 1;
            }
        }
        self.cuts.truncate(n_kept);
        let no_length_sq = NO_LENGTH_SQ * surface.longest_side * surface.longest_side;
        let center = self.reached[0];
        let origin = surface.position(center);
        while let Some(&from) = self.reached.get(self.n_done) {
            self.n_done += 1;
            let position = surface.position(from);
            let away = position - origin;
            let from_sq = away.length_squared();
            let neighbors = surface.neighbors_of(from);
            self.n_seen += neighbors.len() as u32;
            if self.n_seen >= STRIDE {
                self.n_seen = 0;
                control.at(0.0)?;
            }
            for neighbor in neighbors {
                let along = surface.position(neighbor.vertex) - position;
                let outward = along.dot(away);
                if from != center && outward <= 0.0 {
                    continue;
                }
                let length_sq = along.length_squared();
                let (to, edge) = (neighbor.vertex, neighbor.edge);
                let mut cut = Cut { from, to, edge, part: 1.0, outward, length_sq, from_sq };
                if length_sq <= no_length_sq {
                    self.pass(&cut);
                } else if self.is_cut(&mut cut, radius_sq) {
                    self.cuts.push(cut);
                }
            }
        }
        Ok(())
    }

    /// Whether the sphere cuts the edge, and where; an edge wholly within is passed.
    #[inline]
    fn is_cut(&mut self, cut: &mut Cut, radius_sq: f64) -> bool {
        let part = cut.meets(radius_sq);
        if part >= 1.0 {
            self.pass(cut);
            return false;
        }
        // Rounding may put the inner end outside of the sphere: its edges end where they start.
        cut.part = if part.abs() < LEAST_CUT {
            0.01
        } else if part > 0.0 {
            part
        } else {
            1.0
        };
        true
    }

    #[inline]
    fn pass(&mut self, cut: &Cut) {
        self.whole.push(cut.edge);
        let met = &mut self.met[cut.to as usize];
        if *met != self.number {
            *met = self.number;
            self.reached.push(cut.to);
        }
    }
}
