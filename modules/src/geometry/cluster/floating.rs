//! Cells around vertices, the most important first.
//!
//! Source: K.-L. Low and T.-S. Tan, "Model simplification using vertex-clustering", I3D 1997,
//! section 3.2: a vertex that lies in no cell so far becomes the center of one. Deviation: in the
//! end a vertex goes to the nearest of all centers in whose cells it lies, not only of those that
//! are more important than itself.
//!
//! A new center looks for the vertices in its cell, which are runs of a list along a Morton curve;
//! that list stands for all sizes of cells that are tried.

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::data::TriMesh;
use mve_mesh::morton::{interleave, sort_by_code};

use super::grid::{Grid, MOST_CELLS, Numbers};

/// What is not there.
const NONE: u32 = u32::MAX;

/// The finite vertices of a mesh along a Morton curve, and in the order of their importance.
pub struct Curve {
    /// Point, vertex, and the code of the finest octant, by place on the curve.
    points: Vec<DVec3>,
    vertices: Vec<u32>,
    codes: Vec<u64>,
    /// Places on the curve, that of the most important vertex first.
    by_importance: Vec<u32>,
    /// The finest octants.
    octants: Grid,
    n_vertices: usize,
}

/// The center nearest to a vertex so far: its squared distance in halves of a cell as the bits of
/// an `f32`, then its number; of two numbers the less is the nearer one.
type Nearest = u64;
/// Nearest to a vertex that is in no cell so far.
const NO_CENTER: Nearest = u64::MAX;

impl Curve {
    /// The vertices of a mesh with `bounds`, most important first where `importance` is highest; of
    /// equal ones the first in the mesh. O(n).
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn new(
        mesh: &TriMesh,
        octants: Grid,
        importance: &[f64],
        control: Control,
    ) -> Result<Self, Cancelled> {
        let n_vertices = mesh.positions.len();
        let finite = mesh.positions.iter().zip(0..).filter(|(point, _)| point.is_finite());
        let mut order: Vec<(u64, u32)> =
            finite.map(|(&point, vertex)| (interleave(octants.cell(point)), vertex)).collect();
        sort_by_code(&mut order, control.part(0.0, 0.4))?;
        let points = order.iter().map(|&(_, vertex)| mesh.positions[vertex as usize]).collect();
        let (codes, vertices): (Vec<_>, Vec<_>) = order.into_iter().unzip();
        let mut places = vec![NONE; n_vertices];
        vertices.iter().zip(0..).for_each(|(&vertex, place)| places[vertex as usize] = place);
        // Importances are no less than 0, so that their bits grow with them.
        let code = |value: f64| u64::from(!(value.max(0.0) as f32).to_bits());
        let places = importance.iter().zip(places).filter(|(_, place)| *place != NONE);
        let mut ranks: Vec<_> = places.map(|(&value, place)| (code(value), place)).collect();
        sort_by_code(&mut ranks, control.part(0.5, 1.0))?;
        let by_importance = ranks.into_iter().map(|(_, place)| place).collect();
        Ok(Self { points, vertices, codes, by_importance, octants, n_vertices })
    }

    /// The cluster of each vertex, where cells have this edge, and how many there are: numbers are
    /// in the order in which they first occur. What is not finite is a cluster of its own.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn clusters(&self, edge: f64, control: Control) -> Result<(Vec<u32>, usize), Cancelled> {
        let (nearest, n_centers) = self.nearest(edge, control)?;
        let mut of_vertex = vec![NONE; self.n_vertices];
        for (nearest, &vertex) in nearest.iter().zip(&self.vertices) {
            of_vertex[vertex as usize] = *nearest as u32;
        }
        let (mut numbers, mut n_clusters) = (vec![NONE; n_centers], 0);
        for center in &mut of_vertex {
            let mut alone = NONE;
            let number = numbers.get_mut(*center as usize).unwrap_or(&mut alone);
            if *number == NONE {
                (*number, n_clusters) = (n_clusters, n_clusters + 1);
            }
            *center = *number;
        }
        Ok((of_vertex, n_clusters as usize))
    }

    /// The nearest center of each vertex by place, and how many centers there are.
    fn nearest(&self, edge: f64, control: Control) -> Result<(Vec<Nearest>, usize), Cancelled> {
        let runs = Runs::new(self, edge);
        let mut nearest = vec![NO_CENTER; self.points.len()];
        let mut n_centers = 0;
        for (at, &place) in self.by_importance.iter().enumerate() {
            control.item(at, self.by_importance.len())?;
            if nearest[place as usize] == NO_CENTER {
                runs.claim(self, self.points[place as usize], n_centers, &mut nearest);
                n_centers += 1;
            }
        }
        Ok((nearest, n_centers as usize))
    }
}

/// The runs of a curve in octants no smaller than a cell.
struct Runs {
    /// Half the length of a cell's edge.
    half: f64,
    /// How often the finest octants are halved.
    level: u32,
    numbers: Numbers,
    /// Where the run of each octant begins, and the end of the last one.
    starts: Vec<u32>,
}

impl Runs {
    fn new(curve: &Curve, edge: f64) -> Self {
        let half = 0.5 * edge;
        let mut level = 0;
        while curve.octants.edge() * f64::from(1 << level) < edge && 1 << level < MOST_CELLS {
            level += 1;
        }
        let (mut numbers, mut starts) = (Numbers::default(), Vec::new());
        let mut last = None;
        for (&code, place) in curve.codes.iter().zip(0..) {
            let octant = code >> (3 * level);
            if last != Some(octant) {
                last = Some(octant);
                numbers.number(octant);
                starts.push(place);
            }
        }
        starts.push(curve.codes.len() as u32);
        Self { half, level, numbers, starts }
    }

    /// Gives a center the vertices in its cell that are nearer to it than to those before.
    fn claim(&self, curve: &Curve, point: DVec3, center: u32, nearest: &mut [Nearest]) {
        let corner = |side: f64| curve.octants.cell(point + side * self.half);
        let (low, high) = (corner(-1.0), corner(1.0));
        let scale = 1.0 / self.half;
        let axis = |k: usize| {
            (low[k] >> self.level..=high[k] >> self.level).map(move |at| {
                let mut cell = [0; 3];
                cell[k] = at;
                interleave(cell)
            })
        };
        for z in axis(2) {
            for y in axis(1) {
                for x in axis(0) {
                    let Some(octant) = self.numbers.get(x | y | z) else { continue };
                    let run = self.starts[octant as usize]..self.starts[octant as usize + 1];
                    let run = run.start as usize..run.end as usize;
                    for (at, nearest) in curve.points[run.clone()].iter().zip(&mut nearest[run]) {
                        // Without branches: which vertices are in the cell cannot be foretold.
                        let apart = (*at - point).abs();
                        let is_in = (apart.x <= self.half)
                            & (apart.y <= self.half)
                            & (apart.z <= self.half);
                        let distance = ((apart * scale).length_squared() as f32).to_bits();
                        let key = u64::from(distance) << 32 | u64::from(center);
                        *nearest = (*nearest).min(key | u64::from(is_in).wrapping_sub(1));
                    }
                }
            }
        }
    }
}
