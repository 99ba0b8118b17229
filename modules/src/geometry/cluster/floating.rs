//! Cells around vertices, the most important first.
//!
//! Source: K.-L. Low and T.-S. Tan, "Model simplification using vertex-clustering", I3D 1997,
//! section 3.2: a vertex that lies in no cell so far becomes the center of one. Deviation: in the
//! end a vertex goes to the nearest of all centers in whose cells it lies, not only of those that
//! are more important than itself.

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::data::TriMesh;
use mve_mesh::morton::sort_by_code;
use rayon::prelude::*;

use super::grid::{Grid, MOST_CELLS, Numbers, PIECE, key, numbered};

/// What is not there.
const NONE: u32 = u32::MAX;

/// Vertices by falling importance; of equal ones the first.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn by_importance(importance: &[f64], control: Control) -> Result<Vec<u32>, Cancelled> {
    // Importances are no less than 0, so that their bits grow with them.
    let code = |value: f64| u64::from(!(value.max(0.0) as f32).to_bits());
    let mut order: Vec<(u64, u32)> =
        importance.iter().zip(0..).map(|(&value, vertex)| (code(value), vertex)).collect();
    sort_by_code(&mut order, control)?;
    Ok(order.into_iter().map(|(_, vertex)| vertex).collect())
}

/// Cells of a grid that vertices lie in, and which of them are side by side.
pub struct Cells {
    grid: Grid,
    /// The cell of each vertex.
    of_vertex: Vec<u32>,
    /// The cells around each, itself in the middle: x fastest, then y, then z.
    around: Vec<[u32; 27]>,
}

impl Cells {
    /// The cells that vertices of a mesh lie in.
    pub fn new(mesh: &TriMesh, grid: Grid, control: Control) -> Result<Self, Cancelled> {
        let keys = grid.keys(&mesh.positions, control.part(0.0, 0.3))?;
        let (of_vertex, n_cells) = numbered(&keys, control.part(0.3, 0.7))?;
        let mut known = Numbers::default();
        let mut cells = vec![[0; 3]; n_cells];
        for (vertex, &point) in mesh.positions.iter().enumerate() {
            let number = of_vertex[vertex];
            if number as usize == known.keys.len() {
                known.number(keys[vertex]);
                cells[number as usize] = grid.cell(point);
            }
        }
        let around = cells.par_iter().map(|&cell| neighbors(cell, &known)).collect();
        control.at(1.0)?;
        Ok(Self { grid, of_vertex, around })
    }

    /// The eight cells in which the center of a cell that has this point may lie.
    #[inline]
    fn nearby(&self, vertex: usize, point: DVec3) -> impl Iterator<Item = u32> + '_ {
        let place = self.grid.place(point);
        let part = place - place.floor();
        let side = |part: f64, step: usize| if part < 0.5 { [0, step] } else { [step, 2 * step] };
        let [xs, ys, zs] = [side(part.x, 1), side(part.y, 3), side(part.z, 9)];
        let around = &self.around[self.of_vertex[vertex] as usize];
        let at = move |k: usize| around[xs[k & 1] + ys[k >> 1 & 1] + zs[k >> 2]];
        (0..8).map(at).filter(|&cell| cell != NONE)
    }
}

fn neighbors([x, y, z]: [u64; 3], known: &Numbers) -> [u32; 27] {
    let mut around = [NONE; 27];
    for (place, number) in around.iter_mut().enumerate() {
        let step = |at: u64, by: usize| (at + by as u64).checked_sub(1).filter(|&a| a < MOST_CELLS);
        let cell = (step(x, place % 3), step(y, place / 3 % 3), step(z, place / 9));
        if let (Some(x), Some(y), Some(z)) = cell {
            *number = known.get(key([x, y, z])).unwrap_or(NONE);
        }
    }
    around
}

/// The centers of cells, and in which cell of the grid each lies.
pub struct Centers<'a> {
    mesh: &'a TriMesh,
    cells: &'a Cells,
    /// The vertices that are centers, by falling importance.
    pub vertices: Vec<u32>,
    /// The last center in each cell of the grid, and the one before each center.
    last: Vec<u32>,
    before: Vec<u32>,
}

impl<'a> Centers<'a> {
    /// Goes through the vertices in the order given.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn new(
        mesh: &'a TriMesh,
        cells: &'a Cells,
        order: &[u32],
        control: Control,
    ) -> Result<Self, Cancelled> {
        let last = vec![NONE; cells.around.len()];
        let mut centers = Self { mesh, cells, vertices: Vec::new(), last, before: Vec::new() };
        for (place, &vertex) in order.iter().enumerate() {
            control.item(place, order.len())?;
            let point = mesh.positions[vertex as usize];
            // What is not finite is in no cell but its own.
            if point.is_finite() && centers.around(vertex as usize, point).next().is_some() {
                continue;
            }
            let cell = cells.of_vertex[vertex as usize] as usize;
            centers.before.push(centers.last[cell]);
            centers.last[cell] = centers.vertices.len() as u32;
            centers.vertices.push(vertex);
        }
        Ok(centers)
    }

    /// The centers in whose cells a point lies, with the squared distance to each.
    #[inline]
    fn around(&self, vertex: usize, point: DVec3) -> impl Iterator<Item = (f64, u32)> + '_ {
        let half = 0.5 * self.cells.grid.edge();
        let in_cell = |cell: u32| {
            let first = self.last[cell as usize];
            std::iter::successors((first != NONE).then_some(first), |&center| {
                let before = self.before[center as usize];
                (before != NONE).then_some(before)
            })
        };
        self.cells.nearby(vertex, point).flat_map(in_cell).filter_map(move |center| {
            let center_at = self.mesh.positions[self.vertices[center as usize] as usize];
            let apart = (point - center_at).abs();
            (apart.max_element() <= half).then(|| (apart.length_squared(), center))
        })
    }

    /// The center that each vertex goes to.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn of_vertices(&self, control: Control) -> Result<Vec<u32>, Cancelled> {
        let positions = &self.mesh.positions;
        let mut found = vec![NONE; positions.len()];
        self.vertices.iter().zip(0..).for_each(|(&v, center)| found[v as usize] = center);
        found.par_chunks_mut(PIECE).enumerate().try_for_each(|(piece, found)| {
            control.at(0.0)?;
            for (center, vertex) in found.iter_mut().zip(piece * PIECE..) {
                if *center == NONE {
                    let near = self.around(vertex, positions[vertex]);
                    let nearest = near.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
                    *center = nearest.map_or(NONE, |(_, center)| center);
                }
            }
            Ok(())
        })?;
        Ok(found)
    }
}
