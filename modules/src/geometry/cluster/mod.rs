//! Simplification by clusters of vertices: one vertex stands for all in a cell.
//!
//! ```text
//! importance ─┐            ┌─ of_vertex ─▶ place: a point a cluster ─┐
//! mesh ───────┴▶ grid, or ─┤                                         ├▶ build: the faces with
//!                floating  └─────────────────────────────────────────┘  corners in three clusters
//! ```
//!
//! Sources: J. Rossignac and P. Borrel, "Multi-resolution 3D approximations for rendering complex
//! scenes", 1993 (cells of a grid); K.-L. Low and T.-S. Tan, "Model simplification using
//! vertex-clustering", I3D 1997 (cells around vertices); P. Lindstrom, "Out-of-core simplification
//! of large polygonal models", SIGGRAPH 2000 (points of least quadric error).

pub mod build;
pub mod floating;
pub mod grid;
pub mod importance;
pub mod place;
pub mod search;

use std::sync::atomic::AtomicBool;
use std::sync::atomic::Ordering::Relaxed;

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::data::{FaceId, TriMesh};
use mve_mesh::union_find::UnionFind;
use rayon::prelude::*;
use thiserror::Error;

use self::build::{Duplicates, built, n_faces_left};
use self::floating::Curve;
use self::grid::{Grid, Keys, MOST_CELLS, PIECE, numbered};
use self::importance::{Weights, importance};
use self::place::{Clusters, Place, Representative};
use self::search::{TOLERANCE, size_for};
use super::edit::clean::{CleanOptions, clean};
use super::edit::manifold::Repair;

/// Which cells vertices are put into.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellKind {
    /// Those of a grid over the bounding box.
    Uniform,
    /// Cells around vertices, the most important first.
    Floating,
}

/// How large cells are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Size {
    /// Length of their edges, in model units.
    Edge(f64),
    /// So many along the longest side of the bounding box.
    PerAxis(u64),
    /// As it takes for so many faces.
    Faces(usize),
    /// As it takes for vertices to move so far in the mean, over the diagonal.
    Shift(f64),
}

/// How a mesh is clustered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClusterOptions {
    /// Which cells.
    pub cells: CellKind,
    /// How large.
    pub size: Size,
    /// Which point stands for a cluster.
    pub representative: Representative,
    /// How much the parts of importance count.
    pub weights: Weights,
    /// Rounds, each with cells twice as large as those of the one before.
    pub levels: u32,
    /// What becomes of faces with the same vertices.
    pub duplicates: Duplicates,
    /// Whether parts of the surface that share no edge within a cell stay apart, and the surface is
    /// cut open where it would not be manifold.
    pub is_manifold: bool,
}

/// A mesh after clustering.
#[derive(Clone, Debug)]
pub struct Clustered {
    /// The mesh.
    pub mesh: TriMesh,
    /// Length of the cells' edges in the last round.
    pub edge: f64,
    /// Clusters of the last round, those without a face too.
    pub n_clusters: usize,
    /// How far the vertices moved in the mean, in model units, in the last round.
    pub shift: f64,
}

/// Why a mesh cannot be clustered.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum ClusterError {
    /// The work was ended.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The cells are too small to be numbered.
    #[error("cells of {0} are too small: at most {MOST_CELLS} fit along an axis")]
    TooSmall(f64),
}

/// Faces that a first guess looks at.
const SAMPLE: usize = 1 << 13;
/// Tries of a goal after the first, where faces that go in the end were counted.
const MOST_CORRECTIONS: usize = 3;

/// Puts the vertices of a mesh into cells and gives each cell one vertex. Any heap of triangles
/// will do. What is not finite is a cluster of its own. O(n) and for floating cells O(n log n).
///
/// # Errors
/// See [`ClusterError`].
pub fn cluster(
    mesh: &TriMesh,
    options: &ClusterOptions,
    control: Control,
) -> Result<Clustered, ClusterError> {
    let n_levels = options.levels.clamp(1, 16);
    let run = Run { mesh, options, goal: None };
    if n_levels == 1 {
        return run.last(control);
    }
    let (edge, _) = Prepared::new(mesh, options, control.part(0.0, 0.2))?.edge(
        options.size,
        None,
        control.part(0.2, 0.3),
    )?;
    let mut coarser: Option<TriMesh> = None;
    for level in (1..n_levels).rev() {
        let size = Size::Edge(edge * 0.5_f64.powi(level as i32));
        let options = ClusterOptions { size, ..*options };
        let mesh = coarser.as_ref().unwrap_or(mesh);
        let share = |level: u32| 0.3 + 0.4 * f64::from(n_levels - level) / f64::from(n_levels);
        let part = control.part(share(level + 1), share(level));
        coarser = Some(Run { mesh, options: &options, goal: None }.last(part)?.mesh);
    }
    let mesh = coarser.as_ref().unwrap_or(mesh);
    Run { mesh, options, goal: None }.last(control.part(0.7, 1.0))
}

/// One round.
struct Run<'a> {
    mesh: &'a TriMesh,
    options: &'a ClusterOptions,
    /// Faces to look for in place of those asked for, and where the search begins.
    goal: Option<(f64, f64)>,
}

impl Run<'_> {
    fn last(mut self, control: Control) -> Result<Clustered, ClusterError> {
        let prepared = Prepared::new(self.mesh, self.options, control.part(0.0, 0.3))?;
        let mut clustered = self.once(&prepared, control.part(0.3, 0.9))?;
        let Size::Faces(asked) = self.options.size else { return Ok(clustered) };
        // Faces that went since others are the same, or came since parts stay apart.
        for _ in 0..MOST_CORRECTIONS {
            let n_faces = clustered.mesh.faces.len() as f64;
            let off = n_faces / asked as f64;
            if (off - 1.0).abs() <= TOLERANCE || n_faces == 0.0 {
                break;
            }
            let goal = self.goal.map_or(asked as f64, |(goal, _)| goal) / off;
            self.goal = Some((goal, clustered.edge * off.sqrt()));
            let again = self.once(&prepared, control.part(0.9, 1.0))?;
            let is_nearer = |other: &Clustered| other.mesh.faces.len().abs_diff(asked);
            if is_nearer(&again) >= is_nearer(&clustered) {
                break;
            }
            clustered = again;
        }
        Ok(clustered)
    }

    fn once(&self, prepared: &Prepared, control: Control) -> Result<Clustered, ClusterError> {
        let (size, first) = match (self.options.size, self.goal) {
            (Size::Faces(_), Some((goal, first))) => {
                (Size::Faces(goal.round() as usize), Some(first))
            }
            (size, _) => (size, None),
        };
        let (edge, made) = prepared.edge(size, first, control.part(0.0, 0.5))?;
        let (mut of_vertex, mut n_clusters) = match made {
            Some(made) => made,
            None => prepared.clusters(edge, control.part(0.5, 0.7))?,
        };
        if self.options.is_manifold {
            (of_vertex, n_clusters) = parted(self.mesh, &of_vertex, control.part(0.7, 0.8))?;
        }
        let clusters = Clusters { mesh: self.mesh, of_vertex: &of_vertex, n_clusters };
        let places = prepared.places(&clusters, edge, control.part(0.8, 0.9))?;
        let shift = mean_shift(self.mesh, &of_vertex, &places);
        let part = control.part(0.9, 0.95);
        let mut mesh = built(self.mesh, &of_vertex, &places, self.options.duplicates, part)?;
        if self.options.is_manifold {
            let cut = CleanOptions {
                non_finite: false,
                degenerate: false,
                duplicate: false,
                edges: Repair::Split,
                vertices: Repair::Split,
                unreferenced: false,
            };
            mesh = clean(mesh, &cut, control.part(0.95, 1.0))?.0;
        }
        Ok(Clustered { mesh, edge, n_clusters, shift })
    }
}

/// What is known of a mesh before the size of the cells is.
struct Prepared<'a> {
    mesh: &'a TriMesh,
    options: &'a ClusterOptions,
    /// The box around the finite vertices of faces.
    bounds: (DVec3, DVec3),
    importance: Vec<f64>,
    /// For floating cells.
    curve: Option<Curve>,
}

/// The cluster of each vertex, and how many there are.
type Made = (Vec<u32>, usize);

impl<'a> Prepared<'a> {
    fn new(
        mesh: &'a TriMesh,
        options: &'a ClusterOptions,
        control: Control,
    ) -> Result<Self, ClusterError> {
        let is_floating = options.cells == CellKind::Floating;
        let is_important = is_floating || options.representative == Representative::Important;
        let importance = match is_important {
            true => importance(mesh, options.weights, control.part(0.0, 0.7))?,
            false => Vec::new(),
        };
        let mut prepared = Self { mesh, options, bounds: bounds(mesh), importance, curve: None };
        if is_floating {
            let octants = prepared.grid(prepared.least())?;
            let part = control.part(0.7, 1.0);
            prepared.curve = Some(Curve::new(mesh, octants, &prepared.importance, part)?);
        }
        Ok(prepared)
    }

    fn grid(&self, edge: f64) -> Result<Grid, ClusterError> {
        // A box without extent has one cell of any size.
        let edge = if self.largest() > 0.0 { edge } else { 1.0 };
        Grid::new(self.bounds, edge).ok_or(ClusterError::TooSmall(edge))
    }

    /// An edge with which all vertices are in one cell, or 0.
    fn largest(&self) -> f64 {
        2.0 * (self.bounds.1 - self.bounds.0).max_element()
    }

    /// The smallest edge that is tried.
    fn least(&self) -> f64 {
        self.largest() / MOST_CELLS as f64
    }

    /// The length of the cells' edges for what was asked, and the clusters, where these were made
    /// on the way; a search begins at `first`.
    fn edge(
        &self,
        size: Size,
        first: Option<f64>,
        control: Control,
    ) -> Result<(f64, Option<Made>), ClusterError> {
        let (low, high) = self.bounds;
        let diagonal = (high - low).length();
        let side = (high - low).max_element();
        match size {
            Size::Edge(edge) => Ok((edge, None)),
            // A little more, so that the last vertex is in the last of them.
            Size::PerAxis(n) => {
                let edge = (side / n.max(1) as f64).max(f64::MIN_POSITIVE) * (1.0 + 1e-12);
                Ok((edge, None))
            }
            Size::Faces(n_faces) => {
                let goal = n_faces.max(1) as f64;
                let first = match first {
                    Some(first) => first,
                    None => self.guess(goal, diagonal)?,
                };
                let (edge, made) = self
                    .search((goal, TOLERANCE), -2.0, first, |edge| self.n_faces(edge, control))?;
                Ok((edge, made.flatten()))
            }
            Size::Shift(shift) => {
                self.search((shift, TOLERANCE), 1.0, 4.0 * shift * diagonal, |edge| {
                    let made = self.clusters(edge, control)?;
                    let clusters =
                        Clusters { mesh: self.mesh, of_vertex: &made.0, n_clusters: made.1 };
                    let places = self.places(&clusters, edge, control)?;
                    Ok((mean_shift(self.mesh, &made.0, &places) / diagonal, made))
                })
            }
        }
    }

    /// An edge that gives about so many faces, from a sample of the faces.
    fn guess(&self, goal: f64, diagonal: f64) -> Result<f64, ClusterError> {
        /// How much larger floating cells are than those of a grid that leave as many faces.
        const FLOATING: f64 = 1.18;
        let step = self.mesh.faces.len().div_ceil(SAMPLE).max(1);
        let sample: Vec<[DVec3; 3]> = (0..self.mesh.faces.len() as u32)
            .step_by(step)
            .map(|face| self.mesh.corners(FaceId(face)))
            .collect();
        let first = diagonal / goal.sqrt();
        let (edge, _) = self.search((goal / step as f64, 0.02), -2.0, first, |edge| {
            let grid = self.grid(edge)?;
            let is_left = |corners: &&[DVec3; 3]| {
                let [a, b, c] = corners.map(|point| grid.key(point));
                (a != b) & (b != c) & (c != a)
            };
            Ok((sample.iter().filter(is_left).count() as f64, ()))
        })?;
        Ok(if self.options.cells == CellKind::Floating { FLOATING * edge } else { edge })
    }

    fn search<T>(
        &self,
        goal: (f64, f64),
        power: f64,
        first: f64,
        measure: impl Fn(f64) -> Result<(f64, T), ClusterError>,
    ) -> Result<(f64, Option<T>), ClusterError> {
        let largest = self.largest();
        if largest <= 0.0 {
            return Ok((1.0, None));
        }
        let least = self.least();
        let measured = |edge: f64| match measure(edge.max(least)) {
            Ok((found, made)) => Ok((found, Some(made))),
            Err(ClusterError::Cancelled(cancelled)) => Err(cancelled),
            // As if nothing were clustered.
            Err(ClusterError::TooSmall(_)) => Ok((if power < 0.0 { f64::MAX } else { 0.0 }, None)),
        };
        let (edge, made) = size_for(goal, power, (first.max(least), largest), measured)?;
        Ok((edge.max(least), made.flatten()))
    }

    /// The faces that cells of this edge leave, and for floating cells the clusters.
    fn n_faces(&self, edge: f64, control: Control) -> Result<(f64, Option<Made>), ClusterError> {
        let duplicates = self.options.duplicates;
        let grid = self.grid(edge)?;
        let (n_faces, made) = match &self.curve {
            None => {
                let n_faces = match grid.cells(&self.mesh.positions, control)? {
                    Keys::Few(keys, _) => n_faces_left(self.mesh, &keys, duplicates, control)?,
                    Keys::Many(keys) => n_faces_left(self.mesh, &keys, duplicates, control)?,
                };
                (n_faces, None)
            }
            Some(curve) => {
                let made = curve.clusters(edge, control)?;
                (n_faces_left(self.mesh, &made.0, duplicates, control)?, Some(made))
            }
        };
        Ok((n_faces as f64, made))
    }

    /// The cluster of each vertex, and how many there are.
    fn clusters(&self, edge: f64, control: Control) -> Result<Made, ClusterError> {
        let grid = self.grid(edge)?;
        if let Some(curve) = &self.curve {
            return Ok(curve.clusters(edge, control)?);
        }
        let cells = grid.cells(&self.mesh.positions, control.part(0.0, 0.3))?;
        Ok(cells.numbered(control.part(0.3, 1.0))?)
    }

    fn places(
        &self,
        clusters: &Clusters,
        edge: f64,
        control: Control,
    ) -> Result<Vec<Place>, Cancelled> {
        match self.options.representative {
            Representative::Important => Ok(clusters.most_important(&self.importance)),
            Representative::Mean => Ok(clusters.means()),
            Representative::Quadric => clusters.quadric_points(3.0_f64.sqrt() * edge, control),
        }
    }
}

/// The box around the finite vertices of faces; one of no size where there are none.
fn bounds(mesh: &TriMesh) -> (DVec3, DVec3) {
    let is_used: Vec<AtomicBool> = mesh.positions.iter().map(|_| AtomicBool::new(false)).collect();
    mesh.faces.par_chunks(PIECE).for_each(|faces| {
        faces.iter().flatten().for_each(|vertex| is_used[vertex.idx()].store(true, Relaxed));
    });
    let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let boxes = mesh.positions.par_chunks(PIECE).zip(is_used.par_chunks(PIECE));
    let boxes = boxes.map(|(points, is_used)| {
        let used = points.iter().zip(is_used).filter(|(_, is_used)| is_used.load(Relaxed));
        let finite = used.map(|(point, _)| *point).filter(|point| point.is_finite());
        finite.fold(none, |(low, high), p| (low.min(p), high.max(p)))
    });
    let (low, high) = boxes.reduce(|| none, |a, b| (a.0.min(b.0), a.1.max(b.1)));
    if low.x > high.x { (DVec3::ZERO, DVec3::ZERO) } else { (low, high) }
}

/// Clusters whose vertices edges within them join.
fn parted(
    mesh: &TriMesh,
    of_vertex: &[u32],
    control: Control,
) -> Result<(Vec<u32>, usize), Cancelled> {
    let mut parts = UnionFind::new(mesh.positions.len());
    for (place, face) in mesh.faces.iter().enumerate() {
        control.item(place, mesh.faces.len())?;
        for (a, b) in [(0, 1), (1, 2), (2, 0)].map(|(a, b)| (face[a], face[b])) {
            if of_vertex[a.idx()] == of_vertex[b.idx()] {
                parts.union(a.0, b.0);
            }
        }
    }
    let roots: Vec<u32> = (0..mesh.positions.len() as u32).map(|v| parts.find(v)).collect();
    numbered(&roots, control)
}

/// How far the finite vertices of a mesh are from those of their clusters, in the mean.
fn mean_shift(mesh: &TriMesh, of_vertex: &[u32], places: &[Place]) -> f64 {
    let pieces = mesh.positions.par_chunks(PIECE).zip(of_vertex.par_chunks(PIECE));
    let sums = pieces.map(|(points, of_vertex)| {
        let (mut sum, mut n) = (0.0, 0_usize);
        for (&point, &cluster) in points.iter().zip(of_vertex) {
            let distance = point.distance(places[cluster as usize].point);
            if distance.is_finite() {
                (sum, n) = (sum + distance, n + 1);
            }
        }
        (sum, n)
    });
    // Added in their order, so that threads change nothing.
    let sums: Vec<(f64, usize)> = sums.collect();
    let (sum, n) = sums.iter().fold((0.0, 0), |all, one| (all.0 + one.0, all.1 + one.1));
    sum / n.max(1) as f64
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
