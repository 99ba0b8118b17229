//! Simplification by edge collapse: one engine, with the cost and the placement plugged in.
//!
//! The engine merges the two ends of the cheapest edge until a stop holds (the greedy scheme of
//! M. Garland and P. S. Heckbert, SIGGRAPH 1997, and H. Hoppe, SIGGRAPH 1996). It owns the queue,
//! the link condition, the flip test, the boundary policy and the attributes; [`Cost`] and
//! [`Placement`] own none of these. An [`Observer`] is told of each collapse.
//!
//! Where to read on: `engine.rs` is the loop; `merge.rs` has a drawing of a collapse with the names
//! that all files use; `complex.rs` holds the triangles, `mesh.rs` what costs see of them.
//!
//! Guarantees, for any input: no panic; the surface keeps its topology (components, Euler number,
//! borders, non-manifold edges), because every collapse meets the link condition; the result is
//! bit-equal from run to run and for any number of threads. The order of the input's vertices and
//! faces matters only where price and length of two edges are equal to the last bit, and for where
//! blocks are cut.
//!
//! Ordinary input that needs saying: a face that names a vertex twice and a vertex without a face
//! are left out of the result; copies of a face stay copies; vertices with a coordinate that is
//! not finite stay as they are. Vertices keep their order, so do faces.
//!
//! Time O(n log n) for n faces at bounded valence; see the bench `simplify`.

mod attributes;
mod blocked;
mod blocks;
mod build;
mod complex;
mod cost;
mod cut;
mod engine;
#[cfg(test)]
mod engine_tests;
mod fans;
#[cfg(test)]
mod guard_tests;
mod join;
mod layer;
#[cfg(test)]
mod limit_tests;
mod link;
mod marks;
mod merge;
mod merging;
mod mesh;
mod observer;
#[cfg(test)]
mod observer_tests;
mod options;
mod order;
mod origin;
mod outcome;
mod placement;
mod pricer;
mod proposal;
mod quadrics;
mod queue;
mod renewal;
mod result;
mod rings;
mod shape;
mod stop;
#[cfg(test)]
mod tests;
mod ticker;
#[cfg(test)]
pub(crate) mod trial;
mod wedge;

pub use blocked::Blocked;
pub use blocks::SMALLEST_IN_BLOCKS;
pub use cost::Cost;
pub use merge::DyingFace;
pub use merging::Merging;
pub use mesh::WorkingMesh;
pub use observer::{Collapse, Element, MovedCorner, Observer, WedgeChange};
pub use options::{Boundary, QuadricOptions, Schedule, Seams, SimplifyOptions, Turns};
pub use outcome::{Seconds, Simplified, Statistics};
pub use placement::Placement;
pub use proposal::{AttributeRow, Batch, Candidates, Contraction, Proposal, Reach, Renewal};
pub use rings::MAX_VALENCE;
pub use stop::{Outcome, Stop};
pub use wedge::{AttributeValue, LayerId, Role, WedgeId};

use engine::Engine;
use mve_core::{Cancelled, Control};
use mve_mesh::data::TriMesh;
use origin::Origin;

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
    simplify_observed(mesh, cost, placement, &mut [], options, control)
}

/// Simplifies a mesh by one queue, but for the edges at some vertices, which stay where they are.
///
/// # Errors
/// As [`simplify`].
pub fn simplify_around(
    mesh: &TriMesh,
    stays: &[bool],
    cost: &mut dyn Cost,
    placement: &mut dyn Placement,
    options: SimplifyOptions,
    control: Control,
) -> Result<Simplified, Cancelled> {
    let origin = Origin::Block(stays);
    Engine::new(mesh, cost, placement, &mut [], options, origin, control)?.run(mesh)
}

/// Simplifies a mesh as [`simplify`] does, while observers follow the run.
///
/// # Errors
/// As [`simplify`].
pub fn simplify_observed<'a>(
    mesh: &'a TriMesh,
    cost: &'a mut dyn Cost,
    placement: &'a mut dyn Placement,
    observers: &'a mut [&'a mut dyn Observer],
    options: SimplifyOptions,
    control: Control<'a>,
) -> Result<Simplified, Cancelled> {
    if options.order == Schedule::Blocks && observers.is_empty() {
        let block = blocks::BLOCK;
        // All of it on threads of the pool: allocators give each thread an arena of its own, and
        // what the blocks leave in those of the pool is what the last queue takes.
        let found = rayon::scope(|_| {
            blocks::simplify_in_blocks(mesh, cost, placement, options, block, control)
        });
        if let Some(simplified) = found? {
            return Ok(simplified);
        }
    }
    // Threads that are called together for each of many short batches should not have to be woken
    // each time. A pool of its own keeps the work of others out of the waits between.
    let is_shared = cost.uses_threads()
        && rayon::current_num_threads() > 1
        && rayon::current_thread_index().is_none();
    let n_threads = rayon::current_num_threads();
    let pool = || rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().ok();
    let parts = (cost, placement, observers);
    let run = move || {
        let (cost, placement, observers) = parts;
        let origin = Origin::Whole;
        Engine::new(mesh, cost, placement, observers, options, origin, control)?.run(mesh)
    };
    match is_shared.then(pool).flatten() {
        Some(pool) => pool.install(run),
        None => run(),
    }
}
