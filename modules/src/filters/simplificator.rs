//! Simplifies a mesh by edge collapses.

use std::sync::Arc;
use std::time::Instant;

use crate::cost::{COSTS, MakeCost};
use crate::geometry::distance::drift::{TEXCOORD_TOLERANCE, drift};
use crate::geometry::simplify::collapse::{
    Blocked, Boundary, Cost, Outcome, Placement, SMALLEST_IN_BLOCKS, Schedule, Seams, Simplified,
    SimplifyOptions, Statistics, Stop, Turns, simplify, simplify_around,
};
use crate::geometry::simplify::optimal::Optimal;
use crate::geometry::simplify::quadric::Quadric;
use crate::geometry::simplify::refit::{RefitError, RefitOptions, needs, refit};
use crate::geometry::surface::components::{small_components, without_faces};
use crate::geometry::surface::folds::{n_folded_edges, n_slivers};
use crate::placement::{MakePlacement, PLACEMENTS};
use crate::prelude::*;

use mve_core::{Cancelled, Condition, Control, MissedTarget, Quantities};
use mve_mesh::adjacency::Adjacency;
use mve_mesh::data::Measure;
use mve_mesh::weld::{coincident_border_edges, finite_diagonal, weld};

impl Enumeration for Boundary {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Weighted", "Quadrics hold borders in place; other costs see them as Free does."),
        ("Free", "Borders are simplified as the rest of the surface."),
        ("Locked", "Vertices of borders and non-manifold edges stay where they are."),
    ];
    const VALUES: &'static [Self] = &[Self::Weighted, Self::Free, Self::Locked];
}

impl Enumeration for Seams {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Kept", "Seams of texture coordinates are simplified only along themselves."),
        ("Free", "Seams hold nothing up; the texture may be pulled across them."),
    ];
    const VALUES: &'static [Self] = &[Self::Kept, Self::Free];
}

impl Enumeration for Schedule {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Greedy", "Of all collapses the cheapest is made first."),
        (
            "Blocks",
            "Blocks of a large mesh are simplified side by side on all cores, all up to the same \
             price; then the cheapest is made first. As Greedy below 131,072 faces, without a \
             target of faces, with a largest_cost, where most faces stay, and for costs that look \
             farther than the faces around.",
        ),
    ];
    const VALUES: &'static [Self] = &[Self::Greedy, Self::Blocks];
}

/// What happens to the components of a surface that are small.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SmallComponents {
    Simplified,
    Kept,
    Removed,
}

impl Enumeration for SmallComponents {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Simplified", "As the rest; closed ones stop at four faces."),
        ("Kept", "They stay as they are, count towards the target, and `order` is Greedy."),
        ("Removed", "They go before anything else."),
    ];
    const VALUES: &'static [Self] = &[Self::Simplified, Self::Kept, Self::Removed];
}

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh.");
const TARGET_FACES: Param<Option<i64>> =
    Param::maybe_integer("target_faces", "Stop at this many faces. Off: the ratio counts.", None)
        .between((0, 4_294_967_295))
        .mostly((10, 1_000_000))
        .unit("faces");
const RATIO: Param<Option<f64>> = Param::maybe_number(
    "ratio",
    "Stop at this part of the input's faces, where no number of faces is given. Off: no limit.",
    Some(0.5),
)
.within((0.0, 1.0))
.only_where(Condition::IsOff { param: "target_faces" });
const LARGEST_COST: Param<Option<f64>> = Param::maybe_number(
    "largest_cost",
    "Stop before a collapse that costs more than this, in the unit of the cost. A price of Quadric \
     with a memory below 1 is a mixture, of squared distances from the planes so far and those \
     of the faces as they are: no measure of either alone. Off: no limit.",
    None,
)
.within((0.0, f64::MAX));
const COST: ChoiceParam<MakeCost> =
    ChoiceParam::new("cost", "The price of a collapse; the cheapest is made first.", &COSTS, {
        "Quadric"
    });
const PLACEMENT: ChoiceParam<MakePlacement> =
    ChoiceParam::new("placement", "Where the new vertex goes.", &PLACEMENTS, "Optimal");
const BOUNDARY: Param<Boundary> =
    Param::one_of("boundary", "What may happen to borders.", "Weighted");
const SEAMS: Param<Seams> =
    Param::one_of("seams", "What may happen to seams of texture coordinates.", "Kept");
const ORDER: Param<Schedule> =
    Param::one_of("order", "In which order collapses are made.", "Blocks");
const FLIP_ANGLE: Param<Option<f64>> = Param::maybe_number(
    "flip_angle",
    "No collapse turns a face by more than this; at 180 faces may turn over and fold. Off: 45 \
     degrees, and up to 90 where that is much cheaper, or needed to reach the target.",
    None,
)
.within((0.0, 180.0))
.unit("degrees");
const SLIVER_ANGLE: Param<Option<f64>> = Param::maybe_number(
    "sliver_angle",
    "A collapse that leaves a face with a smaller angle waits until others have gone, by how thin \
     it is; it counts with costs that are distances, such as Quadric. Off: thin faces are as good as others.",
    Some(3.0),
)
.within((0.0, 60.0))
.usually((0.0, 10.0))
.unit("degrees");
const WELD: Param<Option<f64>> = Param::maybe_number(
    "weld",
    "First joins vertices at most so far apart, as a part of the diagonal of the bounding box; 0 \
     joins those at one place. Off: faces that share no vertices part.",
    None,
)
.within((0.0, 0.1))
.usually((0.0, 1e-4));
const SMALL_COMPONENTS: Param<SmallComponents> = Param::one_of(
    "small_components",
    "What happens to parts of the surface that hang together with nothing else and are small.",
    "Simplified",
);
const COMPONENT_SIZE: Param<f64> = Param::number(
    "component_size",
    "How large small components are at most: the diagonal of their box, as a part of that of the \
     mesh. The largest component is never small. It counts unless small_components is Simplified.",
    0.02,
)
.within((0.0, 1.0));
const HEAD_START: Param<Option<f64>> = Param::maybe_number(
    "head_start",
    "Quadric with all its memory, which is fast, first takes the mesh down to this many times the \
     target, and places vertices by Optimal in place of LindstromTurk; cost and placement do the \
     rest, and see what it left as their input. 3 makes a dear \
     cost several times as fast for a little error, at 1 nothing is left for it. Counts where \
     faces are the only target. Off: 3 for Quadric with less memory; other costs do all.",
    None,
)
.within((1.0, 1e9))
.usually((1.5, 10.0));
const REFIT: Param<i64> = Param::integer(
    "refit",
    "How many steps of Refit follow, which moves vertices so that the result lies closer to the \
     input; 0 is none, 2 gain most, 6 nearly all.",
    0,
)
.between((0, 1000))
.mostly((0, 10));
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "The simplified mesh, with all layers: the topology is kept, vertices and faces stay in order.",
);
const FACES: Quantity = Quantity::new("faces", "Faces of the result.").titled("faces").size();
const DEAREST_COLLAPSE: Quantity = Quantity::new(
    "dearest_collapse",
    "Cost of the dearest collapse made, in the unit of the cost.",
)
.titled("dearest collapse")
.in_unit(Unit::Model("unit of the cost"));
const COLLAPSES: Quantity = Quantity::new("collapses", "Collapses made.").titled("collapses");
const REJECTED_BY_TOPOLOGY: Quantity =
    Quantity::new("rejected_by_topology", "Tries that the link condition ended.")
        .titled("rejected by topology");
const REJECTED_BY_FLIP: Quantity =
    Quantity::new("rejected_by_flip", "Tries that would have turned a face.")
        .titled("rejected by flip");
const REJECTED_BY_BOUNDARY: Quantity =
    Quantity::new("rejected_by_boundary", "Edges held by a policy.").titled("rejected by boundary");
const WIDE_TURNS: Quantity = Quantity::new(
    "wide_turns",
    "Collapses that turned a face by more than 45 degrees, as they may where flip_angle is off.",
)
.titled("wide turns");
const FOLDED_EDGES: Quantity = Quantity::new(
    "folded_edges",
    "Edges of the result whose two faces are folded onto each other, by more than 150 degrees.",
)
.titled("folded edges")
.lower();
const SLIVERS: Quantity =
    Quantity::new("slivers", "Faces of the result with an angle of less than 1 degree.")
        .titled("slivers")
        .lower();
const STATISTICS_OUT: Out<Measures> =
    Out::new("statistics", "Counts of the run.").giving(Quantities::Row(&[
        FACES,
        DEAREST_COLLAPSE,
        COLLAPSES,
        REJECTED_BY_TOPOLOGY,
        REJECTED_BY_FLIP,
        REJECTED_BY_BOUNDARY,
        WIDE_TURNS,
        FOLDED_EDGES,
        SLIVERS,
    ]));

/// What the working mesh, the queue and the quadrics take for each face, by one queue and in
/// blocks: measured from 100,000 to a million faces (docs/BENCHMARKS.md). Costs that look at
/// pictures take more.
const BYTES_A_FACE: [usize; 2] = [200, 300];

pub static MODULE: Module = Module {
    id: "Simplificator",
    summary: "Simplifies a mesh by edge collapses, the cheapest first.",
    inputs: &[MESH_IN.spec()],
    outputs: &[MESH_OUT.spec(), STATISTICS_OUT.spec()],
    params: &[
        TARGET_FACES.spec(),
        RATIO.spec(),
        LARGEST_COST.spec(),
        COST.spec(),
        PLACEMENT.spec(),
        BOUNDARY.spec(),
        SEAMS.spec(),
        ORDER.spec(),
        FLIP_ANGLE.spec(),
        SLIVER_ANGLE.spec(),
        WELD.spec(),
        SMALL_COMPONENTS.spec(),
        COMPONENT_SIZE.spec(),
        HEAD_START.spec(),
        REFIT.spec(),
    ],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let (mesh, kept_size) = prepared(io)?;
    let order = io.param(ORDER)?;
    let is_large = mesh.faces.len() >= SMALLEST_IN_BLOCKS;
    let in_blocks = order == Schedule::Blocks && is_large && kept_size < 0.0;
    io.reserve(mesh.faces.len() * BYTES_A_FACE[usize::from(in_blocks)])?;
    let (cost, placement) = (io.choice(COST)?, io.choice(PLACEMENT)?);
    let faces = io.param(TARGET_FACES)?.map(|faces| faces as usize);
    let ratio = io.param(RATIO)?.filter(|_| faces.is_none());
    let mut options = SimplifyOptions {
        stop: Stop { faces, ratio, cost: io.param(LARGEST_COST)? },
        boundary: io.param(BOUNDARY)?,
        seams: io.param(SEAMS)?,
        order,
        turns: turns(io.param(FLIP_ANGLE)?),
        sliver_angle_rad: io.param(SLIVER_ANGLE)?.map(f64::to_radians),
    };
    let n_refits = io.param(REFIT)? as usize;
    let collapses = io.control().part(0.0, if n_refits > 0 { 0.5 } else { 1.0 });
    let factor = match io.param(HEAD_START)? {
        None => (cost.entry.build)(&mesh, &cost.params)?.head_start(),
        factor => factor,
    };
    // Components that stay are told by their size, so nothing else may become as small.
    let factor = factor.filter(|_| kept_size < 0.0);
    let mut first = (placement.entry.build)(&mesh, &placement.params)?;
    if first.gives_way() {
        first = Box::new(Optimal::default());
    }
    let here = collapses.part(0.0, 0.3);
    let start = head_start(factor, &mesh, first.as_mut(), options, here)?;
    // What was the target of the input is that of what the start left.
    options.stop.faces = options.stop.target_faces(mesh.faces.len());
    options.stop.ratio = None;
    let left = start.as_ref().map_or(&*mesh, |start| &start.mesh);
    let mut cost = (cost.entry.build)(left, &cost.params)?;
    let mut placement = (placement.entry.build)(left, &placement.params)?;
    let rest = collapses.part(if start.is_some() { 0.3 } else { 0.0 }, 1.0);
    let parts = (cost.as_mut(), placement.as_mut());
    let mut simplified = collapsed(left, kept_size, parts.0, parts.1, options, rest)?;
    drop((cost, placement));
    if let Some(start) = start {
        simplified.add_start(&start);
    }
    io.phase("first_prices", simplified.seconds.first_prices);
    io.phase("collapses", simplified.seconds.collapses);
    let found = simplified.statistics;
    if let (Outcome::Exhausted, Some(target)) = (found.outcome, found.target_faces) {
        let (asked, reached) = (target as f64, found.n_faces as f64);
        let missed = MissedTarget { what: FACES.name.to_owned(), asked, reached };
        let reasons = reasons(&found.blocked.unwrap_or_default(), options.turns);
        let n_faces = found.n_faces;
        let asked_for = format!("stopped at {n_faces} faces, {target} were asked for");
        io.missed(missed, format!("{asked_for}; of the edges that are left {reasons}"));
    }
    let simplified = refitted(io, &mesh, simplified.mesh, n_refits)?;
    warn_of_drift(io, &mesh, &simplified)?;
    let mut measures = measures(&found);
    measures.0.extend(faults(&simplified, io.control().part(1.0, 1.0))?);
    io.put(MESH_OUT, simplified);
    io.put(STATISTICS_OUT, measures);
    Ok(())
}

/// The mesh that is simplified, and how large components are at most that stay; below 0 none do.
fn prepared(io: &Io) -> Result<(Arc<TriMesh>, f64), ModuleError> {
    let mut mesh = io.get(MESH_IN)?;
    match io.param(WELD)? {
        Some(tolerance) => {
            mesh = Arc::new(weld(&mesh, tolerance, io.control().part(0.0, 0.0))?.mesh)
        }
        None => warn_of_seams(io, &mesh)?,
    }
    let size = io.param(COMPONENT_SIZE)? * finite_diagonal(&mesh);
    match io.param(SMALL_COMPONENTS)? {
        SmallComponents::Simplified => Ok((mesh, -1.0)),
        SmallComponents::Kept => Ok((mesh, size)),
        SmallComponents::Removed => {
            let is_small = small_components(&mesh, size, io.control().part(0.0, 0.0))?;
            let n_gone = is_small.iter().filter(|is_small| **is_small).count();
            io.log(format!("{n_gone} faces of small components are removed"));
            Ok((Arc::new(without_faces(&mesh, &is_small)), -1.0))
        }
    }
}

/// What quadrics leave for the cost that was asked for, if they are to begin.
fn head_start(
    factor: Option<f64>,
    mesh: &TriMesh,
    placement: &mut dyn Placement,
    options: SimplifyOptions,
    control: Control,
) -> Result<Option<Simplified>, Cancelled> {
    let (Some(factor), Some(target)) = (factor, options.stop.target_faces(mesh.faces.len())) else {
        return Ok(None);
    };
    let left = (factor * target as f64).ceil();
    if left >= mesh.faces.len() as f64 || options.stop.cost.is_some() {
        return Ok(None);
    }
    let stop = Stop { faces: Some(left as usize), ..Stop::default() };
    let options = SimplifyOptions { stop, ..options };
    simplify(mesh, &mut Quadric::default(), placement, options, control).map(Some)
}

/// The mesh simplified, but for components of at most this size.
fn collapsed(
    mesh: &TriMesh,
    kept_size: f64,
    cost: &mut dyn Cost,
    placement: &mut dyn Placement,
    options: SimplifyOptions,
    control: Control,
) -> Result<Simplified, Cancelled> {
    if kept_size < 0.0 {
        return simplify(mesh, cost, placement, options, control);
    }
    let is_small = small_components(mesh, kept_size, control.part(0.0, 0.0))?;
    let mut stays = vec![false; mesh.positions.len()];
    let kept = mesh.faces.iter().zip(is_small).filter(|(_, is_small)| *is_small);
    kept.for_each(|(face, _)| face.iter().for_each(|v| stays[v.idx()] = true));
    simplify_around(mesh, &stays, cost, placement, options, control)
}

/// The result after the steps of Refit that are asked for; as it is where it has no surface.
fn refitted(
    io: &mut Io,
    input: &TriMesh,
    mesh: TriMesh,
    n_steps: usize,
) -> Result<TriMesh, ModuleError> {
    if n_steps == 0 {
        return Ok(mesh);
    }
    io.reserve(needs(&mesh, input))?;
    let options = RefitOptions { n_steps, measures_result: false, ..RefitOptions::DEFAULT };
    let start = Instant::now();
    let fitted = refit(&mesh, input, options, io.control().part(0.5, 1.0));
    io.phase("refit", start.elapsed().as_secs_f64());
    match fitted {
        Ok(fitted) => Ok(fitted.mesh),
        Err(RefitError::NoSurface(_)) => Ok(mesh),
        Err(RefitError::Cancelled(cancelled)) => Err(cancelled.into()),
    }
}

fn turns(flip_angle: Option<f64>) -> Turns {
    match flip_angle {
        None => Turns::Adaptive,
        Some(angle) if angle < 180.0 => Turns::UpTo(angle.to_radians()),
        Some(_) => Turns::Any,
    }
}

/// Which limits hold how many edges, and what to set.
fn reasons(blocked: &Blocked, turns: Turns) -> String {
    let limit = match turns {
        Turns::UpTo(angle) => format!("flip_angle {:.0}", angle.to_degrees()),
        _ => "90 degrees, the most while flip_angle is off".to_owned(),
    };
    let reasons = [
        (blocked.turn, format!("would turn a face by more than {limit} (set flip_angle higher)")),
        (blocked.fold, "would fold faces onto each other (flip_angle 180 allows it)".to_owned()),
        (blocked.topology, "would change the topology".to_owned()),
        (
            blocked.rules,
            "are held by boundary, by seams, by small_components or by odd coordinates".to_owned(),
        ),
        (blocked.price, "have no price".to_owned()),
    ];
    let named = reasons.iter().filter(|(n, _)| *n > 0);
    let list: Vec<String> = named.map(|(n, reason)| format!("{n} {reason}")).collect();
    if list.is_empty() { "there are none".to_owned() } else { list.join(", ") }
}

/// Says where the surface looks whole and is not.
fn warn_of_seams(io: &Io, mesh: &TriMesh) -> Result<(), ModuleError> {
    let n_edges = coincident_border_edges(mesh, io.control().part(0.0, 0.0))?;
    if n_edges > 0 {
        io.warn(format!(
            "{n_edges} border edges lie on another one: faces share no vertices there, so they part \
             or stay as they are; set weld to 0, or join them with Weld"
        ));
    }
    Ok(())
}

/// Says how much of the surface carries another name or another part of the texture than before.
fn warn_of_drift(io: &Io, before: &TriMesh, after: &TriMesh) -> Result<(), ModuleError> {
    /// Less of it is within what a border of names takes anyway.
    const LEAST: f64 = 0.01;
    let drift = drift(before, after, io.control().part(1.0, 1.0))?;
    for (layer, share) in drift.names.iter().filter(|(_, share)| *share > LEAST) {
        let share = 100.0 * share;
        io.warn(format!("{share:.1} % of the area has another {layer} than before"));
    }
    if drift.texcoords > LEAST {
        io.warn(format!(
            "the texture slid on {:.1} % of the area, by more than {TEXCOORD_TOLERANCE} of its size",
            100.0 * drift.texcoords
        ));
    }
    Ok(())
}

fn measures(found: &Statistics) -> Measures {
    let count = |quantity: &Quantity, n: usize| Measure::of(quantity, n as f64);
    Measures(vec![
        count(&FACES, found.n_faces),
        Measure::of(&DEAREST_COLLAPSE, found.largest_cost.unwrap_or(f64::NAN)),
        count(&COLLAPSES, found.n_collapses),
        count(&REJECTED_BY_TOPOLOGY, found.n_rejected_link),
        count(&REJECTED_BY_FLIP, found.n_rejected_flip),
        count(&REJECTED_BY_BOUNDARY, found.n_rejected_boundary),
        count(&WIDE_TURNS, found.n_wide_turns),
    ])
}

/// What the result has that no distance tells.
fn faults(mesh: &TriMesh, control: Control) -> Result<[Measure; 2], Cancelled> {
    let adjacency = Adjacency::new(mesh, control)?;
    let n_folded = n_folded_edges(mesh, &adjacency, control)?;
    let n_slivers = n_slivers(mesh, control)?;
    Ok([(FOLDED_EDGES, n_folded), (SLIVERS, n_slivers)].map(|(q, n)| Measure::of(&q, n as f64)))
}

#[cfg(test)]
#[path = "simplificator_tests.rs"]
mod tests;
