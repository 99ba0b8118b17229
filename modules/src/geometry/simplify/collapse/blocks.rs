//! Simplifies blocks of a large mesh side by side, and then what they leave.
//!
//! A collapse depends on nothing but the faces around its edge, so those that cost less than some
//! price may be made block by block as well as in one queue, if each block keeps to that price and
//! leaves alone what lies in several blocks. Prices rise in steps, the same for all blocks, until
//! about as many faces are left as are wanted; the rest, across the cuts and up to the target, is
//! made by one queue over the joined mesh, whose vertices have the quadrics that the blocks gave
//! them. A block fits a core's cache, and blocks do not wait for each other.
//!
//! No step takes more than half of a block's faces, and no larger share than the whole mesh has
//! still to lose, so that the joined mesh is not coarser than what was asked for; a collapse that
//! takes very many faces at once, copies of each other, may miss that by a few.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use mve_core::{Cancelled, Control};
use mve_mesh::data::TriMesh;
use rayon::prelude::*;

use super::cost::Cost;
use super::cut::{Block, Cut};
use super::engine::{Engine, Halt};
use super::join::{Remains, join};
use super::options::SimplifyOptions;
use super::origin::Origin;
use super::outcome::{Simplified, Statistics};
use super::placement::Placement;
use super::stop::Stop;

/// Faces of a block, about.
pub(super) const BLOCK: usize = 1 << 15;
/// Meshes of fewer blocks are not cut.
const LEAST_BLOCKS: usize = 4;
/// Faces of the smallest mesh that is simplified in blocks.
pub const SMALLEST_IN_BLOCKS: usize = LEAST_BLOCKS * BLOCK;
/// Faces that the blocks leave for each face of the target. With more, the result is closer to that
/// of one queue, and less of the work is shared.
const LEFT: f64 = 1.02;
/// Where they would have to leave more than this part of their faces, cutting gains nothing.
const MOST_LEFT: f64 = 0.7;
/// The part of its faces that a block keeps in one step, at least.
const LEAST_KEPT: f64 = 0.5;
/// Steps of the price at most.
const MOST_STEPS: usize = 400;

/// A cost and a placement of a block's own.
type Parts = (Box<dyn Cost>, Box<dyn Placement>);

/// Simplifies in blocks of about so many faces; `None` where that does not fit, and nothing has
/// been done.
pub(super) fn simplify_in_blocks(
    mesh: &TriMesh,
    cost: &mut dyn Cost,
    placement: &mut dyn Placement,
    options: SimplifyOptions,
    block: usize,
    control: Control,
) -> Result<Option<Simplified>, Cancelled> {
    let start = Instant::now();
    let n_faces = mesh.faces.len();
    let Some(target) = options.stop.target_faces(n_faces) else { return Ok(None) };
    if n_faces < LEAST_BLOCKS * block || options.stop.cost.is_some() {
        return Ok(None);
    }
    let n_blocks = n_faces.div_ceil(block);
    let parts = |_| Some((cost.for_block()?, placement.for_block()?));
    let Some(mut parts) = (0..n_blocks).map(parts).collect::<Option<Vec<Parts>>>() else {
        return Ok(None);
    };
    if LEFT * target as f64 > MOST_LEFT * n_faces as f64 {
        return Ok(None);
    }
    let cut = Cut::new(mesh, n_blocks, control.part(0.0, 0.0))?;
    let at_cuts = cut.n_faces_at_cuts() as f64;
    let goal = LEFT * target as f64 * (1.0 - at_cuts / n_faces as f64) + at_cuts;
    // The last collapse of a block may take some faces more.
    let goal = goal.max((target + 4 * n_blocks) as f64);
    if goal > MOST_LEFT * n_faces as f64 {
        return Ok(None);
    }

    // Engines report together, since each knows of its own block only.
    let done = AtomicU64::new(0f64.to_bits());
    let report = |_| match control.at(f64::from_bits(done.load(Ordering::Relaxed))) {
        Ok(()) => ControlFlow::Continue(()),
        Err(Cancelled) => ControlFlow::Break(()),
    };
    let together = Control::new(&report);
    let begun = parts.par_iter_mut().enumerate().map(|(at, (cost, placement))| {
        together.at(0.0)?;
        block_engine(cut.block(mesh, at), cost.as_mut(), placement.as_mut(), options, together)
    });
    let begun = begun.collect::<Result<Vec<_>, Cancelled>>()?;
    let (blocks, mut engines): (Vec<Block>, Vec<Engine>) = begun.into_iter().unzip();
    let first_prices = start.elapsed().as_secs_f64();
    let n_to_go = (n_faces - target.min(n_faces)).max(1) as f64;
    collapse_together(&mut engines, goal, |n_left| {
        let share = (n_faces as f64 - n_left) / n_to_go;
        done.store((0.95 * share.clamp(0.0, 1.0)).to_bits(), Ordering::Relaxed);
    })?;
    let remains = engines.into_par_iter().zip(&blocks).map(|(engine, block)| {
        let (working, counts) = engine.into_block()?;
        Ok((Remains::of(working, block, together)?, counts))
    });
    let remains = remains.collect::<Result<Vec<_>, Cancelled>>()?;
    let (remains, counts): (Vec<Remains>, Vec<Statistics>) = remains.into_iter().unzip();
    drop((blocks, parts));
    let joined = join(mesh, remains, cut, together)?;

    let reached = f64::from_bits(done.load(Ordering::Relaxed));
    let stop = Stop { faces: Some(target), ..Stop::default() };
    let options = SimplifyOptions { stop, ..options };
    let origin = Origin::Joined(&joined.is_cut, &joined.quadrics);
    let control = control.part(reached, 1.0);
    let last = Engine::new(&joined.mesh, cost, placement, &mut [], options, origin, control)?;
    let mut simplified = last.run(&joined.mesh)?;
    counts.iter().for_each(|counts| simplified.statistics.add(counts));
    simplified.seconds.first_prices = first_prices;
    simplified.seconds.collapses = start.elapsed().as_secs_f64() - first_prices;
    Ok(Some(simplified))
}

/// The engine of a block, with its first prices. Of the block's mesh only what the result needs is
/// left: the layers.
fn block_engine<'a>(
    mut block: Block,
    cost: &'a mut dyn Cost,
    placement: &'a mut dyn Placement,
    options: SimplifyOptions,
    control: Control<'a>,
) -> Result<(Block, Engine<'a>), Cancelled> {
    let options = SimplifyOptions { stop: Stop::default(), ..options };
    let origin = Origin::Block(&block.is_cut);
    let mut engine = Engine::new(&block.mesh, cost, placement, &mut [], options, origin, control)?;
    engine.fill_queue()?;
    block.mesh = TriMesh { layers: block.mesh.layers, ..TriMesh::default() };
    Ok((block, engine))
}

/// Lets all blocks collapse what costs up to the same price, and raises it until no more faces than
/// `goal` are left; tells `report` how many are.
fn collapse_together(
    engines: &mut [Engine],
    goal: f64,
    report: impl Fn(f64),
) -> Result<(), Cancelled> {
    let (mut price, mut before) = (0.0, (f64::INFINITY, false));
    for _ in 0..MOST_STEPS {
        let n_left = engines.iter().map(Engine::n_faces).sum::<usize>() as f64;
        report(n_left);
        if n_left <= goal || before == (n_left, true) {
            break;
        }
        let kept = (goal / n_left).max(LEAST_KEPT);
        let advance = |engine: &mut Engine| {
            let least = (kept * engine.n_faces() as f64).ceil() as usize;
            // A block that has nothing to give holds up no other.
            if least >= engine.n_faces() {
                return Ok(Halt::Exhausted);
            }
            engine.advance(Some(least), Some(price))
        };
        let halts = engines.par_iter_mut().map(advance).collect::<Result<Vec<_>, Cancelled>>()?;
        before = (n_left, halts.contains(&Halt::Faces));
        match next_price(&halts, price, n_left / goal) {
            Some(next) => price = next,
            None => break,
        }
    }
    Ok(())
}

/// The price of the next step: the same where a block was held back by its number of faces;
/// otherwise more, the less the closer the goal. `None` where no collapse is left.
fn next_price(halts: &[Halt], price: f64, ratio: f64) -> Option<f64> {
    /// The most that a price grows by.
    const MOST: f64 = 4.0;
    const LEAST: f64 = 1.1;
    if halts.contains(&Halt::Faces) {
        return Some(price);
    }
    let mut coming: Vec<f64> = halts
        .iter()
        .filter_map(|halt| if let Halt::Price(price) = halt { Some(*price) } else { None })
        .collect();
    coming.sort_unstable_by(f64::total_cmp);
    let middle = *coming.get(coming.len() / 2)?;
    // Of a smooth surface, prices fall with the third power of the number of faces.
    Some((price * ratio.powi(3).clamp(LEAST, MOST)).max(middle))
}

#[cfg(test)]
#[path = "blocks_tests.rs"]
mod tests;
