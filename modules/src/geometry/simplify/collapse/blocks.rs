//! Simplifies blocks of a large mesh side by side, and then what they leave.
//!
//! A collapse depends on nothing but the faces around its edge, so those that cost less than some
//! price may be made block by block as well as in one queue, if each block keeps to that price and
//! leaves alone what lies in several blocks. Prices rise in steps, the same for all blocks, until
//! about as many faces are left as are wanted; the rest, across the cuts and up to the target, is
//! made by one queue over the joined mesh, whose vertices have the quadrics that the blocks gave
//! them. A block fits a core's cache, and blocks do not wait for each other.
//!
//! No step takes more than half of a block's faces, nor more of it than of the whole mesh until the
//! goal, so that the joined mesh is never coarser than what was asked for.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use mve_core::{Cancelled, Control};
use rayon::prelude::*;

use super::cost::Cost;
use super::cut::Cut;
use super::engine::{Engine, Halt, Origin};
use super::join::{Remains, join};
use super::options::SimplifyOptions;
use super::outcome::{Simplified, Statistics};
use super::placement::Placement;
use super::stop::Stop;
use crate::data::TriMesh;

/// Faces of a block, about.
pub(super) const BLOCK: usize = 1 << 15;
/// Smaller meshes are not cut.
const LEAST_BLOCKS: usize = 4;
/// Faces that the blocks leave for each face of the target.
const LEFT: f64 = 1.1;
/// Where they would have to leave more than this part of their faces, cutting gains nothing.
const MOST_LEFT: f64 = 0.7;
/// The part of its faces that a block keeps in one step, at least.
const LEAST_KEPT: f64 = 0.5;
/// Steps of the price at most.
const MOST_STEPS: usize = 400;

/// Simplifies block by block; `None` where that does not fit, and nothing has been done.
pub(super) fn simplify_in_blocks(
    mesh: &TriMesh,
    cost: &mut dyn Cost,
    placement: &mut dyn Placement,
    options: SimplifyOptions,
    control: Control,
) -> Result<Option<Simplified>, Cancelled> {
    let n_faces = mesh.faces.len();
    let Some(target) = options.stop.target_faces(n_faces) else { return Ok(None) };
    let is_large = n_faces >= LEAST_BLOCKS * BLOCK;
    if !is_large || options.stop.cost.is_some() || target as f64 > MOST_LEFT * n_faces as f64 {
        return Ok(None);
    }
    let parts = |_| Some((cost.for_block()?, placement.for_block()?));
    let n_blocks = n_faces.div_ceil(BLOCK);
    let Some(mut parts) = (0..n_blocks).map(parts).collect::<Option<Vec<_>>>() else {
        return Ok(None);
    };
    let start = Instant::now();
    let cut = Cut::new(mesh, n_blocks, control.part(0.0, 0.0))?;
    let n_at_cuts = cut.n_faces_at_cuts() as f64;
    let goal = LEFT * target as f64 * (1.0 - n_at_cuts / n_faces as f64) + n_at_cuts;
    if goal > MOST_LEFT * n_faces as f64 {
        return Ok(None);
    }

    // All engines say the same of how far the work is, since they cannot know.
    let done = AtomicU64::new(0f64.to_bits());
    let report = |_| match control.at(f64::from_bits(done.load(Ordering::Relaxed))) {
        Ok(()) => ControlFlow::Continue(()),
        Err(Cancelled) => ControlFlow::Break(()),
    };
    let together = Control::new(&report);
    let inputs: Vec<_> = (0..n_blocks).into_par_iter().map(|at| cut.block(mesh, at)).collect();
    let options_of_block = SimplifyOptions { stop: Stop::default(), ..options };
    let mut engines: Vec<Engine> = inputs
        .par_iter()
        .zip(&mut parts)
        .map(|(input, (cost, placement))| {
            let origin = Origin::Block(&input.is_cut);
            let (cost, placement) = (cost.as_mut(), placement.as_mut());
            let observers = &mut [];
            let mut engine = Engine::new(
                &input.mesh,
                cost,
                placement,
                observers,
                options_of_block,
                origin,
                together,
            )?;
            engine.fill_queue()?;
            Ok(engine)
        })
        .collect::<Result<_, Cancelled>>()?;
    let first_prices = start.elapsed().as_secs_f64();

    let n_left = |engines: &[Engine]| engines.iter().map(Engine::n_faces).sum::<usize>() as f64;
    let mut price = 0.0;
    for _ in 0..MOST_STEPS {
        let left = n_left(&engines);
        let share = (n_faces as f64 - left) / (n_faces as f64 - target as f64);
        done.store((0.95 * share.clamp(0.0, 1.0)).to_bits(), Ordering::Relaxed);
        if left <= goal {
            break;
        }
        let kept = (goal / left).max(LEAST_KEPT);
        let halts: Vec<Halt> = engines
            .par_iter_mut()
            .map(|engine| {
                let least = (kept * engine.n_faces() as f64).ceil() as usize;
                engine.advance(Some(least), Some(price))
            })
            .collect::<Result<_, Cancelled>>()?;
        let Some(next) = next_price(&halts, price, left / goal) else { break };
        price = next;
    }

    let blocks = engines.into_par_iter().map(Engine::into_block);
    let blocks = blocks.collect::<Result<Vec<_>, Cancelled>>()?;
    let statistics: Vec<Statistics> = blocks.iter().map(|(_, counts)| *counts).collect();
    let remains: Vec<Remains> = blocks
        .into_par_iter()
        .zip(&inputs)
        .map(|((working, _), input)| Remains::of(working, input, together))
        .collect::<Result<_, Cancelled>>()?;
    drop((inputs, parts));
    let joined = join(mesh, remains, cut, together)?;
    let reached = f64::from_bits(done.load(Ordering::Relaxed));
    let stop = Stop { faces: Some(target), ..Stop::default() };
    let mut simplified = Engine::new(
        &joined.mesh,
        cost,
        placement,
        &mut [],
        SimplifyOptions { stop, ..options },
        Origin::Joined(&joined.is_cut, &joined.quadrics),
        control.part(reached, 1.0),
    )?
    .run()?;
    for of_block in statistics {
        simplified.statistics.add(&of_block);
    }
    simplified.seconds.first_prices = first_prices;
    simplified.seconds.collapses = start.elapsed().as_secs_f64() - first_prices;
    Ok(Some(simplified))
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
