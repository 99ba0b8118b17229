//! Remeshing: the same surface in triangles of even size and shape.
//!
//! Source: M. Botsch and L. Kobbelt, "A remeshing approach to multiresolution modeling", Symposium
//! on Geometry Processing 2004, section 4: in each round edges longer than 4/3 of the length are
//! split, those shorter than 4/5 collapse, edges are flipped where that evens the numbers of
//! neighbors, and vertices move to the middles of their faces, by area, within the surface.
//! Departures: vertices are brought back to the nearest point of the input after each round; sharp
//! edges, borders and seams are lines whose vertices move along them and are brought back to them;
//! edges come up by their length; a collapse puts the vertex in the middle where it may; edges of
//! slivers are flipped whatever the numbers of neighbors, and those that lines hold are taken away;
//! no step turns a face by 60° or more. Faces of the input that are hardly wider than noise make no
//! edge sharp.
//!
//! Edges of more than two faces, and those at which the orientation changes, are lines whose
//! vertices stay: they are split, and nothing else is done to them.

mod build;
mod flat;
mod mesh;
pub mod patch;
mod relax;
mod steps;
#[cfg(test)]
mod tests;

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::adjacency::{Adjacency, EdgeId};
use mve_mesh::data::{Domain, FaceId, Layer, TriMesh, VertexId};
use mve_mesh::morton::morton_order;
use rayon::prelude::*;
use thiserror::Error;

use crate::geometry::distance::bvh::Bvh;
use crate::geometry::edit::rebuild::{Draft, Origin};
use crate::geometry::surface::normals::face_normals;
use crate::geometry::transfer::Places;
use crate::geometry::transfer::charts::is_seam;
use build::{LineOptions, build};
use flat::remove_flat;
use mesh::WorkMesh;
use relax::{Ground, line_tree, relax};

/// How long edges are to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EdgeTarget {
    /// So long, in model units.
    Length(f64),
    /// Such a share of the diagonal of the box around the mesh.
    OfDiagonal(f64),
    /// So long that there are about so many faces.
    Faces(usize),
}

/// How to remesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RemeshOptions {
    /// How long edges are to be; above 0.
    pub target: EdgeTarget,
    /// Rounds of the four steps.
    pub rounds: u32,
    /// The angle between the normals of two faces from which their edge is kept, in radians; `None`
    /// for no angle. Corners of borders are those that turn by more.
    pub sharp_rad: Option<f64>,
    /// Whether edges between texture charts, materials and groups are kept.
    pub keeps_seams: bool,
    /// Whether vertices are brought back to the surface.
    pub projects: bool,
}

/// A mesh that was remeshed.
#[derive(Clone, Debug)]
pub struct Remeshed {
    /// The mesh.
    pub mesh: TriMesh,
    /// The length that edges were to have, in model units.
    pub length: f64,
    /// Faces of the input that were left out: they name a vertex twice or are not finite.
    pub n_left_out: usize,
}

/// Why a mesh was not remeshed.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum RemeshError {
    /// The result would be too large.
    #[error(
        "edges of length {length} would make about {n_faces:.0} faces, more than {MOST_FACES}: ask \
         for longer ones"
    )]
    TooManyFaces {
        /// The length in model units.
        length: f64,
        /// How many there would be.
        n_faces: f64,
    },
    /// The caller ended the computation.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Most faces of a result: the work needs about 300 bytes a face.
pub const MOST_FACES: usize = 10_000_000;

/// Edges of this many times the length are split, and of this many collapse.
const LONGEST: f64 = 4.0 / 3.0;
const SHORTEST: f64 = 4.0 / 5.0;
/// Passes over edges to be flipped, in each round.
const FLIPS: usize = 3;

/// Lines of faces whose names change are kept, too.
const NAMES: [&str; 4] = [Layer::MATERIAL, Layer::GROUP, Layer::OBJECT, Layer::TEXCOORD];

/// Remeshes a surface; see the head of this file. O(n log n) a round, n being the faces of the
/// larger of input and result.
///
/// The result depends on the surface, not on the order of its vertices and faces, unless several
/// vertices lie at one place. Vertices without a face are left out. Layers are those of the nearest
/// points of the input ([`Places`]).
///
/// # Errors
/// See [`RemeshError`]; a result that is too large is refused before anything is computed.
pub fn remesh(
    mesh: &TriMesh,
    options: &RemeshOptions,
    control: Control,
) -> Result<Remeshed, RemeshError> {
    let mut source = canonical(mesh, control.part(0.0, 0.03))?;
    let n_left_out = mesh.faces.len() - source.faces.len();
    // Near 1 nothing overflows; a power of two changes no digit.
    let scale = unit_scale(&source);
    source.positions.iter_mut().for_each(|p| *p *= scale);
    let mut length = target_length(&source, options.target, scale);
    let mut n_faces = faces_at(&source, length);
    if let EdgeTarget::Faces(n) = options.target {
        // Needles have hardly an area, and sides all the same.
        while n_faces > 3.0 * n.max(source.faces.len().min(8)) as f64 && length < 4.0 {
            length *= 1.25;
            n_faces = faces_at(&source, length);
        }
    }
    if source.faces.is_empty() || source.diagonal() == 0.0 {
        // All at one place, there is nothing to divide.
        source.positions.iter_mut().for_each(|p| *p /= scale);
        return Ok(Remeshed { mesh: source, length: 0.0, n_left_out });
    }
    if n_faces.is_nan() || n_faces > MOST_FACES as f64 {
        return Err(RemeshError::TooManyFaces { length: length / scale, n_faces });
    }
    let tree = Bvh::build(&source, control.part(0.03, 0.08))?;
    let normals = face_normals(&source, control.part(0.08, 0.09))?;
    let adjacency = Adjacency::new(&source, control.part(0.09, 0.1))?;
    let seams = if options.keeps_seams { seams(&source, &adjacency) } else { Vec::new() };
    let lines = LineOptions {
        most_cos: options.sharp_rad.map(f64::cos),
        shortest: 2.0 * length,
        is_seam: &seams,
    };
    let (mut work, lines) = build(&source, &adjacency, &lines, control.part(0.1, 0.12))?;
    drop(adjacency);
    let lines = line_tree(&source, &lines, control.part(0.12, 0.13))?;
    let ground = Ground {
        tree: &tree,
        normals: &normals,
        lines: lines.as_ref(),
        projects: options.projects,
    };
    for round in 0..options.rounds {
        let share = |round: u32| 0.13 + 0.72 * f64::from(round) / f64::from(options.rounds);
        one_round(&mut work, length, &ground, control.part(share(round), share(round + 1)))?;
        if let EdgeTarget::Faces(n_wanted) = options.target
            && round + 2 < options.rounds
        {
            let n_faces = work.living().count();
            let factor = (n_faces as f64 / n_wanted.max(1) as f64).sqrt();
            length *= factor.clamp(0.8, 1.25);
        }
    }
    // What moving has made flat again goes before the last flips.
    remove_flat(&mut work, LONGEST * length, control.part(0.85, 0.855))?;
    steps::flip(&mut work, FLIPS, control.part(0.855, 0.86))?;
    let mut found = compacted(&work, control.part(0.86, 0.86))?;
    let places = Places::find((&source, &tree), &found, f64::INFINITY, control.part(0.86, 0.9))?;
    let mut layers = Vec::new();
    for layer in &source.layers {
        layers.push(places.layer(layer, control.part(0.9, 1.0))?);
    }
    found.layers = layers;
    found.materials = source.materials.clone();
    found.positions.iter_mut().for_each(|p| *p /= scale);
    Ok(Remeshed { mesh: found, length: length / scale, n_left_out })
}

fn one_round(
    work: &mut WorkMesh,
    length: f64,
    ground: &Ground,
    control: Control,
) -> Result<(), Cancelled> {
    let (shortest, longest) = (SHORTEST * length, LONGEST * length);
    steps::split_long(work, longest, control.part(0.0, 0.2))?;
    steps::collapse_short(work, [shortest, longest], control.part(0.2, 0.48))?;
    remove_flat(work, longest, control.part(0.48, 0.5))?;
    steps::flip(work, FLIPS, control.part(0.5, 0.65))?;
    relax(work, ground, control.part(0.65, 1.0))
}

/// The faces that can be worked on, with vertices along a curve through space and each face
/// beginning with the first of its vertices, in the order of these: whatever the order was.
fn canonical(mesh: &TriMesh, control: Control) -> Result<TriMesh, Cancelled> {
    let is_usable = |face: &[VertexId; 3]| {
        let [a, b, c] = *face;
        let points = face.map(|v| mesh.positions[v.idx()]);
        a != b
            && b != c
            && c != a
            && points.iter().all(|p| p.abs().cmple(DVec3::splat(FARTHEST)).all())
    };
    let mut is_used = vec![false; mesh.positions.len()];
    for face in mesh.faces.iter().filter(|face| is_usable(face)) {
        face.iter().for_each(|v| is_used[v.idx()] = true);
    }
    let mut order: Vec<u32> =
        (0..mesh.positions.len() as u32).filter(|&v| is_used[v as usize]).collect();
    control.at(0.1)?;
    let at = |v: u32| mesh.positions[v as usize];
    let by_place = |a: &u32, b: &u32| {
        let (a, b) = (at(*a), at(*b));
        a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z))
    };
    order.par_sort_by(by_place);
    let places: Vec<DVec3> = order.iter().map(|&v| at(v)).collect();
    let curve = morton_order(&places, control.part(0.3, 0.5))?;
    let mut draft = Draft::default();
    let mut numbers = vec![u32::MAX; mesh.positions.len()];
    for (number, &place) in curve.iter().enumerate() {
        let v = order[place as usize];
        numbers[v as usize] = number as u32;
        draft.positions.push(at(v));
        draft.vertices.push(Origin::Of(v));
    }
    let mut faces: Vec<([VertexId; 3], u32, usize)> = Vec::with_capacity(mesh.faces.len());
    for (face, vertices) in mesh.faces.iter().enumerate().filter(|(_, face)| is_usable(face)) {
        let renamed = vertices.map(|v| VertexId(numbers[v.idx()]));
        let first = (0..3).min_by_key(|&k: &usize| renamed[k]).unwrap_or(0);
        let turned = [0, 1, 2].map(|k| renamed[(first + k) % 3]);
        faces.push((turned, face as u32, first));
    }
    control.at(0.6)?;
    faces.par_sort_unstable();
    for (vertices, face, first) in faces {
        draft.faces.push(vertices);
        draft.corners.push([0, 1, 2].map(|k| Origin::Of(3 * face + ((first + k) % 3) as u32)));
        draft.sources.push(face);
    }
    draft.finish(mesh, control.part(0.7, 1.0))
}

/// Coordinates beyond this are no places.
const FARTHEST: f64 = 1e300;

/// A power of two by which the longest side of the box comes near 1.
fn unit_scale(mesh: &TriMesh) -> f64 {
    let Some((low, high)) = mesh.bounds() else { return 1.0 };
    let half = (0.5 * high - 0.5 * low).max_element();
    let reach = low.abs().max(high.abs()).max_element();
    if half > 0.0 && half.is_finite() {
        // Far from the origin the digits that are left are few, and so is what must not overflow.
        let exponent = half.log2().floor().max(reach.log2().floor() - 60.0);
        return (-exponent).clamp(-1000.0, 1000.0).exp2();
    }
    1.0
}

/// The length of edges in the scaled mesh.
fn target_length(mesh: &TriMesh, target: EdgeTarget, scale: f64) -> f64 {
    match target {
        EdgeTarget::Length(length) => length * scale,
        EdgeTarget::OfDiagonal(share) => share * mesh.diagonal(),
        // Of an equilateral triangle of the mean area.
        // Without an area it begins with what is far too short.
        EdgeTarget::Faces(n) => {
            (4.0 * mesh.area() / (3.0_f64.sqrt() * n.max(1) as f64)).sqrt().max(1e-9)
        }
    }
}

/// About how many faces there would be: those of the area, and one a piece of each side.
fn faces_at(mesh: &TriMesh, length: f64) -> f64 {
    let of_face = |f: usize| {
        let [a, b, c] = mesh.corners(FaceId(f as u32));
        let area = 0.5 * (b - a).cross(c - a).length();
        let sides = [a.distance(b), b.distance(c), c.distance(a)];
        let pieces = sides.iter().sum::<f64>() / length;
        let is_long = sides.iter().any(|side| *side > length);
        let flat = area / (0.433 * length * length);
        // Long thin faces are cut along their sides; short ones become parts of others.
        flat + if is_long && flat < pieces { pieces } else { 0.0 }
    };
    (0..mesh.faces.len()).map(of_face).sum()
}

/// Whether each edge lies between texture charts, materials, groups or objects.
fn seams(mesh: &TriMesh, adjacency: &Adjacency) -> Vec<bool> {
    let layers: Vec<&Layer> = NAMES
        .into_iter()
        .filter_map(|name| mesh.layer(name))
        .filter(|layer| layer.domain != Domain::Vertex)
        .collect();
    let edges = 0..adjacency.edges().len() as u32;
    let of_edge = |edge| match adjacency.sides_of(EdgeId(edge)) {
        &[a, b] => layers.iter().any(|layer| is_seam(mesh, layer, [a, b])),
        _ => false,
    };
    edges.map(of_edge).collect()
}

/// What lives, in its order.
fn compacted(work: &WorkMesh, control: Control) -> Result<TriMesh, Cancelled> {
    let mut numbers = vec![u32::MAX; work.points.len()];
    let mut mesh = TriMesh::default();
    for (v, faces) in work.around.iter().enumerate() {
        control.item(v, work.points.len())?;
        if !faces.is_empty() {
            numbers[v] = mesh.positions.len() as u32;
            mesh.positions.push(work.points[v]);
        }
    }
    let number = |v: u32| VertexId(numbers[v as usize]);
    mesh.faces = work.living().map(|face| work.faces[face as usize].map(number)).collect();
    Ok(mesh)
}
