//! Simplification by edge collapse: one engine, with the cost and the placement plugged in.
//!
//! The engine merges the two ends of the cheapest edge until a stop holds (the greedy scheme of
//! M. Garland and P. S. Heckbert, SIGGRAPH 1997, and H. Hoppe, SIGGRAPH 1996). It owns the queue,
//! the link condition, the flip test, the boundary policy and the attributes; [`Cost`] and
//! [`Placement`] own none of these.
//!
//! Guarantees, for any input: no panic; the surface keeps its topology (components, Euler number,
//! borders, non-manifold edges), because every collapse meets the link condition; the result is
//! bit-equal from run to run and for any number of threads. The order of the input's vertices and
//! faces matters only where price and length of two edges are equal to the last bit.
//!
//! Ordinary input that needs saying: a face that names a vertex twice and a vertex without a face
//! are left out of the result; copies of a face stay copies; vertices with a coordinate that is
//! not finite stay as they are. Vertices keep their order, so do faces.
//!
//! Time O(n log n) for n faces at bounded valence; see the bench `simplify`.

mod attributes;
mod check;
mod connectivity;
mod cost;
mod engine;
#[cfg(test)]
mod engine_tests;
mod order;
mod placement;
mod pulse;
mod queue;
mod stale;
mod state;
mod stop;
#[cfg(test)]
mod tests;

use std::f64::consts::FRAC_PI_4;

use glam::DVec3;

pub use cost::Cost;
pub use placement::Placement;
pub use state::Collapsing;
pub use stop::{Outcome, Stop};

use crate::data::{FaceId, TriMesh, VertexId};
use crate::mesh::quadric::Quadric;
use mve_core::{Cancelled, Control};

/// What the engine is to do, apart from cost and placement.
#[derive(Clone, Copy, Debug)]
pub struct SimplifyOptions {
    /// When to stop; the first that holds.
    pub stop: Stop,
    /// What may happen to borders and non-manifold edges.
    pub boundary: Boundary,
    /// What may happen to the seams of texture coordinates.
    pub seams: Seams,
    /// The largest turn of a face's normal in one collapse, in radians; `None` is no test. With a
    /// test, no collapse folds two faces at the merged vertex onto each other (150° and more
    /// between their normals) that were not folded before.
    pub flip_angle_rad: Option<f64>,
}

impl SimplifyOptions {
    /// The default.
    pub const DEFAULT: Self = Self {
        stop: Stop { faces: None, ratio: None, cost: None },
        boundary: Boundary::Weighted,
        seams: Seams::Kept,
        flip_angle_rad: Some(FRAC_PI_4),
    };
}

impl Default for SimplifyOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// What may happen to vertices on borders and non-manifold edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Boundary {
    /// They are priced and placed as any other vertex.
    Free,
    /// Quadrics hold a plane for each border edge, which keeps the shape of the border. Parts
    /// that read no quadrics see no difference from `Free`.
    #[default]
    Weighted,
    /// They do not move; an inner vertex may still merge into one.
    Locked,
}

/// What may happen where a vertex has several texture coordinates (a layer of two numbers over
/// corners).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Seams {
    /// A seam simplifies only along itself; other vertices may merge into one on it.
    #[default]
    Kept,
    /// Seams hold nothing up, and the texture may be pulled across them.
    Free,
}

/// Which planes the quadrics of the state sum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuadricOptions {
    /// Weight of the plane on a border edge relative to a face of the same size, under
    /// [`Boundary::Weighted`], and of the two on an edge of a seam under [`Seams::Kept`].
    pub boundary_weight: f64,
}

impl QuadricOptions {
    /// The default.
    pub const DEFAULT: Self = Self { boundary_weight: 10.0 };
}

impl Default for QuadricOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// How far from a collapse prices or proposals go stale, in edges from the merged vertex to the
/// nearer end of the edge in question.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Reach(pub u32);

impl Reach {
    /// Only edges at the merged vertex.
    pub const MERGED: Self = Self(0);
    /// Also the other edges of its neighbors.
    pub const NEIGHBORS: Self = Self(1);
}

/// When prices that went stale are asked for again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Renewal {
    /// All of them at once, after each collapse.
    #[default]
    AtOnce,
    /// Those of edges at the merged vertex at once. An edge farther off waits at a third of its
    /// earlier price, or at that price if it is negative, and is priced again when it comes up or
    /// a little before: so a price that falls is noticed in time unless it falls below a third.
    ///
    /// After the lazy queue of J. Cohen, D. Manocha and M. Olano, "Simplifying polygonal models using
    /// successive mappings", IEEE Visualization 1997, where edges wait at the earlier price itself.
    Lazy,
}

/// The ends of an edge that may collapse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ends {
    /// The vertex that stays.
    pub kept: VertexId,
    /// The vertex that merges into it.
    pub gone: VertexId,
    /// The sum of the quadrics of both about the position of `kept`; zero unless a part asked for
    /// quadrics.
    pub quadric: Quadric,
}

/// One way to collapse an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proposal {
    /// The edge.
    pub ends: Ends,
    /// Where the merged vertex goes.
    pub position: DVec3,
}

/// A collapse that was made.
#[derive(Clone, Copy, Debug)]
pub struct Collapse<'a> {
    /// The vertex that stayed; it moved to `position`.
    pub kept: VertexId,
    /// The vertex that is gone.
    pub gone: VertexId,
    /// Where `kept` is now.
    pub position: DVec3,
    /// Where `kept` and `gone` were.
    pub before: [DVec3; 2],
    /// The faces that are gone.
    pub dead_faces: &'a [FaceId],
    /// The price that it was made at.
    pub price: f64,
}

/// Up to [`Candidates::MAX`] positions.
#[derive(Clone, Copy, Debug, Default)]
pub struct Candidates {
    positions: [DVec3; Self::MAX],
    n: usize,
}

impl Candidates {
    /// How many positions a placement may propose for one edge.
    pub const MAX: usize = 3;

    /// Adds a position; beyond [`Candidates::MAX`] it is ignored.
    pub fn push(&mut self, position: DVec3) {
        if let Some(place) = self.positions.get_mut(self.n) {
            *place = position;
            self.n += 1;
        }
    }

    /// Takes all positions out.
    pub fn clear(&mut self) {
        self.n = 0;
    }

    /// The positions, as proposed.
    pub fn as_slice(&self) -> &[DVec3] {
        &self.positions[..self.n]
    }
}

/// A simplified mesh and how it came about.
#[derive(Clone, Debug)]
pub struct Simplified {
    /// The result.
    pub mesh: TriMesh,
    /// Counts of the run.
    pub statistics: Statistics,
    /// How long its two parts took.
    pub seconds: Seconds,
}

/// How long the parts of a run took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seconds {
    /// To link the mesh, let the cost look at it, and price every edge.
    pub first_prices: f64,
    /// To collapse edges and price their neighbors again, and to put the result together.
    pub collapses: f64,
}

/// Counts of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    /// Faces of the result.
    pub n_faces: usize,
    /// The number of faces that the stops asked for, if they did.
    pub target_faces: Option<usize>,
    /// Why the run ended.
    pub outcome: Outcome,
    /// Collapses made.
    pub n_collapses: usize,
    /// Attempts that would have changed the topology. An edge may be tried again after its
    /// neighborhood has changed, and counts each time.
    pub n_rejected_link: usize,
    /// Attempts that would have turned a face too far or made it degenerate.
    pub n_rejected_flip: usize,
    /// Edges that the boundary policy, seams or a coordinate that is not finite forbids.
    pub n_rejected_boundary: usize,
    /// Price of the dearest collapse made, if there was one.
    pub largest_cost: Option<f64>,
}

/// Simplifies a mesh; see the file's header.
///
/// # Errors
/// [`Cancelled`] when `control` says so, within about a millisecond or one batch of the cost.
pub fn simplify(
    mesh: &TriMesh,
    cost: &mut dyn Cost,
    placement: &mut dyn Placement,
    options: SimplifyOptions,
    control: Control,
) -> Result<Simplified, Cancelled> {
    // Threads that are called together for each of many short batches should not have to be woken
    // each time. A pool of its own keeps the work of others out of the waits between.
    let is_shared = cost.uses_threads()
        && rayon::current_num_threads() > 1
        && rayon::current_thread_index().is_none();
    let n_threads = rayon::current_num_threads();
    let pool = || rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().ok();
    let mut run = || engine::Engine::new(mesh, cost, placement, options, control)?.run();
    match is_shared.then(pool).flatten() {
        Some(pool) => pool.install(run),
        None => run(),
    }
}
