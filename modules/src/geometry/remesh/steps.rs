//! The steps of a round: long edges are split, short ones collapse, edges are flipped.
//!
//! Edges come up by their length, equal ones by their vertices, so that the result depends on the
//! mesh alone.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec3;
use mve_core::{Cancelled, Control};

use super::mesh::{FLAT, Kind, WorkMesh};

/// Faces that are narrower than this share of the longest edge are needles.
const NARROW: f64 = 0.05;

/// Edges between two looks whether the work was cancelled.
const STRIDE: usize = 1 << 10;

/// An edge in a queue, by the bits of its squared length, which have the order of the numbers.
type Entry = (u64, [u32; 2]);

fn entry(mesh: &WorkMesh, [a, b]: [u32; 2]) -> Entry {
    let edge = [a.min(b), a.max(b)];
    (mesh.length_sq(edge).to_bits(), edge)
}

/// All edges, each once, by their vertices.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub(super) fn edges(mesh: &WorkMesh, control: &Control) -> Result<Vec<[u32; 2]>, Cancelled> {
    let mut edges = Vec::with_capacity(3 * mesh.faces.len() / 2);
    let mut neighbors = Vec::new();
    for v in 0..mesh.around.len() as u32 {
        control.item(v as usize, usize::MAX)?;
        mesh.neighbors(v, &mut neighbors);
        edges.extend(neighbors.iter().filter(|w| **w > v).map(|&w| [v, w]));
    }
    Ok(edges)
}

/// Splits edges longer than `longest` in their middle, the longest first.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub(super) fn split_long(
    mesh: &mut WorkMesh,
    longest: f64,
    control: Control,
) -> Result<(), Cancelled> {
    let is_long = |mesh: &WorkMesh, edge: [u32; 2]| mesh.length_sq(edge) > longest * longest;
    let long = edges(mesh, &control)?.into_iter().filter(|&edge| is_long(mesh, edge));
    let mut queue: BinaryHeap<Entry> = long.map(|edge| entry(mesh, edge)).collect();
    let (mut n_done, mut neighbors) = (0_usize, Vec::new());
    while let Some((_, edge)) = queue.pop() {
        if n_done.is_multiple_of(STRIDE) {
            control.at(n_done as f64 / (n_done + queue.len() + 1) as f64)?;
        }
        n_done += 1;
        // Longer edges were split before, unless they may not be.
        let is_there = mesh.has_edge(edge) && mesh.may_split(edge);
        // Pieces of a needle would be needles: it collapses or goes by flips.
        if !is_there || mesh.is_within_needle(edge, NARROW * longest) {
            continue;
        }
        let middle = mesh.split(edge);
        mesh.neighbors(middle, &mut neighbors);
        let long = neighbors.iter().map(|&v| [v, middle]).filter(|&edge| is_long(mesh, edge));
        queue.extend(long.map(|edge| entry(mesh, edge)));
    }
    Ok(())
}

/// Collapses edges shorter than `shortest`, the shortest first, where no edge becomes longer than
/// `longest`, no face turns, and lines and the topology stay.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub(super) fn collapse_short(
    mesh: &mut WorkMesh,
    [shortest, longest]: [f64; 2],
    control: Control,
) -> Result<(), Cancelled> {
    let is_short = |mesh: &WorkMesh, edge: [u32; 2]| mesh.length_sq(edge) < shortest * shortest;
    let short = edges(mesh, &control)?.into_iter().filter(|&edge| is_short(mesh, edge));
    let mut queue: BinaryHeap<Reverse<Entry>> =
        short.map(|edge| Reverse(entry(mesh, edge))).collect();
    let (mut n_done, mut neighbors) = (0_usize, Vec::new());
    while let Some(Reverse(first)) = queue.pop() {
        if n_done.is_multiple_of(STRIDE) {
            control.at(n_done as f64 / (n_done + queue.len() + 1) as f64)?;
        }
        n_done += 1;
        let edge = first.1;
        // One that has moved is in the queue again.
        if !mesh.has_edge(edge) || entry(mesh, edge) != first {
            continue;
        }
        let Some((gone, kept, place)) = collapse_of(mesh, edge, longest) else { continue };
        mesh.collapse(gone, kept, place);
        mesh.neighbors(kept, &mut neighbors);
        let short = neighbors.iter().map(|&v| [v, kept]).filter(|&edge| is_short(mesh, edge));
        queue.extend(short.map(|edge| Reverse(entry(mesh, edge))));
    }
    Ok(())
}

/// Which end of an edge goes, which stays, and where, if it may collapse.
fn collapse_of(mesh: &WorkMesh, [a, b]: [u32; 2], longest: f64) -> Option<(u32, u32, DVec3)> {
    use Kind::{Border, Fixed, Free, Line};
    let (one, two) = (mesh.points[a as usize], mesh.points[b as usize]);
    let middle = one.midpoint(two);
    let n_sides = mesh.sides([a, b]).count();
    let is_line = mesh.is_line([a, b]);
    let along = match n_sides {
        1 => Border,
        _ => Line,
    };
    let ways: &[(u32, u32, DVec3)] = match (mesh.kinds[a as usize], mesh.kinds[b as usize]) {
        _ if n_sides > 2 => &[],
        (Free, Free) => &[(b, a, middle), (b, a, one), (a, b, two)],
        (Free, _) => &[(a, b, two)],
        (_, Free) => &[(b, a, one)],
        (first, second) if is_line && first == along && second == along => {
            &[(b, a, middle), (b, a, one), (a, b, two)]
        }
        (first, Fixed) if is_line && first == along => &[(a, b, two)],
        (Fixed, second) if is_line && second == along => &[(b, a, one)],
        _ => &[],
    };
    // It is the same whichever end goes.
    let mut keeps_topology = None;
    ways.iter().copied().find(|&(gone, kept, place)| {
        stays_near(mesh, (gone, kept, place), longest)
            && *keeps_topology.get_or_insert_with(|| mesh.keeps_topology(gone, kept))
            && keeps_shape(mesh, (gone, kept, place))
    })
}

/// Whether no edge becomes longer.
pub(super) fn stays_near(
    mesh: &WorkMesh,
    (gone, kept, place): (u32, u32, DVec3),
    longest: f64,
) -> bool {
    let is_near = |v: u32| mesh.points[v as usize].distance_squared(place) <= longest * longest;
    let all_near = |v: u32| {
        let faces = mesh.around[v as usize].iter();
        faces.flat_map(|&face| mesh.faces[face as usize]).all(is_near)
    };
    all_near(gone) && (place == mesh.points[kept as usize] || all_near(kept))
}

/// Whether no line folds and no face turns.
fn keeps_shape(mesh: &WorkMesh, (gone, kept, place): (u32, u32, DVec3)) -> bool {
    // A line from the vertex that goes to an apex would fold onto the one that stays.
    let folds = mesh
        .sides([gone, kept])
        .any(|(face, k)| mesh.is_line([gone, mesh.faces[face as usize][(k + 2) % 3]]));
    let keeps = |v: u32, other: u32| {
        mesh.keeps_sides(v, place, |corners: [u32; 3]| corners.contains(&other))
    };
    let moves = place != mesh.points[kept as usize];
    !folds && keeps(gone, kept) && (!moves || keeps(kept, gone))
}

/// Flips edges where the numbers of neighbors come closer to six within the surface and on lines
/// and four at borders, or where a sliver goes; so many passes at most. A later pass looks at the
/// edges alone of which a flip before it can have changed what is to be done.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub(super) fn flip(
    mesh: &mut WorkMesh,
    n_passes: usize,
    control: Control,
) -> Result<(), Cancelled> {
    let mut edges = edges(mesh, &control)?;
    for pass in 0..n_passes {
        let control = control.part(pass as f64 / n_passes as f64, 1.0);
        let flipped = flip_once(mesh, &edges, control)?;
        if flipped.is_empty() || pass + 1 == n_passes {
            break;
        }
        edges = edges_around(mesh, flipped);
    }
    Ok(())
}

/// One pass over some edges; the vertices at those that were flipped, and across them.
fn flip_once(
    mesh: &mut WorkMesh,
    edges: &[[u32; 2]],
    control: Control,
) -> Result<Vec<u32>, Cancelled> {
    let mut flipped = Vec::new();
    for (place, &edge) in edges.iter().enumerate() {
        if place.is_multiple_of(STRIDE) {
            control.at(place as f64 / edges.len() as f64)?;
        }
        let Some(sides) = mesh.two_sides(edge) else { continue };
        let least = |faces: [[u32; 3]; 2]| {
            let [one, two] = faces.map(|corners| mesh.flatness(corners));
            one.min(two)
        };
        let was = least(sides.map(|(face, _)| mesh.faces[face as usize]));
        let evens = evens_valences(mesh, edge, sides);
        // Good faces stay, unless the numbers of neighbors are evened.
        if was >= SLIVER && !evens || !mesh.can_flip(sides) {
            continue;
        }
        let after = new_faces(mesh, sides);
        let will_be = least(after);
        let is_better = if was.min(will_be) < SLIVER { will_be > 1.5 * was } else { evens };
        if is_better && is_gentle(mesh, sides, after) {
            flipped.extend(edge);
            flipped.extend(apexes(mesh, sides));
            mesh.flip(sides);
        }
    }
    Ok(flipped)
}

/// The edges of all faces at some vertices, each once, by their vertices.
fn edges_around(mesh: &WorkMesh, mut vertices: Vec<u32>) -> Vec<[u32; 2]> {
    vertices.sort_unstable();
    vertices.dedup();
    let mut edges = Vec::with_capacity(8 * vertices.len());
    for &face in vertices.iter().flat_map(|&v| &mesh.around[v as usize]) {
        let [a, b, c] = mesh.faces[face as usize];
        edges.extend([[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)]));
    }
    edges.sort_unstable();
    edges.dedup();
    edges
}

fn apexes(mesh: &WorkMesh, sides: [(u32, usize); 2]) -> [u32; 2] {
    sides.map(|(face, k)| mesh.faces[face as usize][(k + 2) % 3])
}

fn evens_valences(mesh: &WorkMesh, [a, b]: [u32; 2], sides: [(u32, usize); 2]) -> bool {
    let excess = |v: u32, change: i64| -> i64 {
        let n_faces = mesh.around[v as usize].len() as i64 + change;
        match mesh.kinds[v as usize] {
            Kind::Free | Kind::Line => (n_faces - 6).pow(2),
            // One neighbor more than faces.
            Kind::Border => (n_faces - 3).pow(2),
            Kind::Fixed => 0,
        }
    };
    let [c, d] = apexes(mesh, sides);
    let sum = |ends: i64, others: i64| {
        excess(a, ends) + excess(b, ends) + excess(c, others) + excess(d, others)
    };
    sum(-1, 1) < sum(0, 0)
}

fn new_faces(mesh: &WorkMesh, sides: [(u32, usize); 2]) -> [[u32; 3]; 2] {
    let [c, d] = apexes(mesh, sides);
    let (face, k) = sides[0];
    let corners = mesh.faces[face as usize];
    let (from, to) = (corners[k], corners[(k + 1) % 3]);
    [[from, d, c], [d, to, c]]
}

/// Whether the two new faces have a side and look the way of the old ones, within 45°.
fn is_gentle(mesh: &WorkMesh, sides: [(u32, usize); 2], after: [[u32; 3]; 2]) -> bool {
    let old = sides.map(|(face, _)| {
        let is_flat = mesh.flatness(mesh.faces[face as usize]) < FLAT;
        if is_flat { DVec3::ZERO } else { mesh.normal(face).normalize_or_zero() }
    });
    after.iter().all(|corners| {
        let [a, b, c] = corners.map(|v| mesh.points[v as usize]);
        let new = (b - a).cross(c - a).normalize_or_zero();
        let is_same = |old: &DVec3| *old == DVec3::ZERO || old.dot(new) > SAME_SIDE;
        new != DVec3::ZERO && old.iter().all(is_same)
    })
}

/// cos 45°.
const SAME_SIDE: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// Faces flatter than this are slivers.
const SLIVER: f64 = 0.15;
