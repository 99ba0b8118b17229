//! Cells of space, each with the faces that pass through it: what the tree is built of where long
//! faces lie across each other in all directions, so that no boxes around faces tell them apart.
//!
//! Space is cut into cubes of one size, and a cube with many faces into smaller ones where that
//! leaves fewer in each (J. Cleary & G. Wyvill, "Analysis of an algorithm for fast ray tracing
//! using uniform space subdivision", The Visual Computer 1988; nested as in Jevans & Wyvill,
//! "Adaptive voxel subdivision for ray tracing", Graphics Interface 1989). A face is cut with the
//! cubes' walls, so it is in the lists of those that it passes through, and the box of a cell is
//! around what is in it.

use glam::{DVec3, UVec3};
use mve_core::{Cancelled, Control};

use super::boxes::EMPTY;
use super::items::Item;

/// Cells along an axis at most.
const MOST_ALONG: f64 = 128.0;
/// Cells for each face at most.
const CELLS_A_FACE: f64 = 4.0;
/// Places in lists for each face at most; half as many again for cells in cells.
const PLACES: usize = 80;
/// Places for each face of a cell when it is cut again.
const INNER_PLACES: usize = 8;
/// Cells with more faces than this are cut again, if that leaves fewer in each.
const MANY: usize = 160;
/// How often.
const MOST_DEPTH: u32 = 3;
/// A part of a face whose box has so many cells is put into all of them.
const FEW_CELLS: u32 = 6;
/// Faces between two looks whether the work was cancelled.
const STRIDE: usize = 1 << 10;

/// The faces of each cell that has any.
pub(super) struct Cells {
    /// The box around what is in a cell, and its number.
    pub items: Vec<Item>,
    /// Where the list of each begins in `faces`, and the end of all.
    pub starts: Vec<u32>,
    pub faces: Vec<u32>,
    /// The cells that space was cut into at first.
    pub grid: Option<CellGrid>,
    /// Places in lists that are left for smaller cells.
    budget: usize,
}

/// Cubes of one size, and the list of each.
#[derive(Clone, Debug)]
pub(super) struct CellGrid {
    grid: Grid,
    /// [`EMPTY`] where a cell has no list of its own.
    pub lists: Vec<u32>,
}

impl CellGrid {
    /// The list of the cell of a point, and how far its walls are at least: all faces that are
    /// nearer than that are in the list.
    #[inline]
    pub fn list_at(&self, point: DVec3) -> Option<(u32, f64)> {
        let place = (point - self.grid.block.low) * self.grid.per_size;
        let cell = place.floor();
        let is_within =
            cell.cmpge(DVec3::ZERO).all() && cell.cmple(self.grid.most.as_dvec3()).all();
        if !is_within {
            return None;
        }
        let list = self.lists[self.grid.number(cell.as_uvec3()) as usize];
        let to_wall = (place - cell).min(DVec3::ONE - (place - cell)).min_element();
        // Less what rounding moves the walls by: coordinates are about 1.
        (list != EMPTY).then_some((list, (to_wall * self.grid.size - 1e-9).max(0.0)))
    }
}

impl Cells {
    /// Cells of these faces, whose corners are within about -1 to 1.
    pub fn of(triangles: &[[DVec3; 3]], control: &Control) -> Result<Self, Cancelled> {
        let mut cells =
            Self { items: Vec::new(), starts: vec![0], faces: Vec::new(), grid: None, budget: 0 };
        cells.budget = PLACES / 2 * triangles.len();
        let mut bounds = Block::EMPTY;
        for chunk in triangles.chunks(STRIDE) {
            control.at(0.0)?;
            chunk.iter().flatten().for_each(|&p| bounds.add(p));
        }
        let faces: Vec<u32> = (0..triangles.len() as u32).collect();
        cells.add(triangles, &faces, bounds, MOST_DEPTH, control)?;
        Ok(cells)
    }

    /// Cuts a block with these faces into cells.
    fn add(
        &mut self,
        triangles: &[[DVec3; 3]],
        faces: &[u32],
        block: Block,
        depth: u32,
        control: &Control,
    ) -> Result<(), Cancelled> {
        let is_inner = depth < MOST_DEPTH;
        let a_face = if is_inner { INNER_PLACES } else { PLACES };
        let lists = Lists::of(triangles, faces, block, a_face, control)?.filter(|lists| {
            let is_better = 2.0 * lists.crowd() <= faces.len() as f64;
            !is_inner || is_better && lists.faces.len() <= self.budget
        });
        let Some(lists) = lists else {
            self.put(faces, block);
            return Ok(());
        };
        if is_inner {
            self.budget -= lists.faces.len();
        }
        let mut of_cells = Vec::with_capacity(if is_inner { 0 } else { lists.starts.len() });
        for (cell, ends) in (0..).zip(lists.starts.windows(2)) {
            control.item(cell as usize, usize::MAX)?;
            let list = &lists.faces[ends[0] as usize..ends[1] as usize];
            let block = || lists.grid.block(cell);
            let mut of_cell = EMPTY;
            if list.len() > MANY && depth > 0 {
                self.add(triangles, list, block(), depth - 1, control)?;
            } else if !list.is_empty() {
                of_cell = self.items.len() as u32;
                self.put(list, block());
            }
            if !is_inner {
                of_cells.push(of_cell);
            }
        }
        if !is_inner {
            self.grid = Some(CellGrid { grid: lists.grid, lists: of_cells });
        }
        Ok(())
    }

    fn put(&mut self, faces: &[u32], block: Block) {
        let number = self.items.len() as u32;
        self.items.push(Item::around(number, &[block.low, block.high]));
        self.faces.extend_from_slice(faces);
        self.starts.push(self.faces.len() as u32);
    }
}

/// A box in `f64`.
#[derive(Clone, Copy, Debug)]
struct Block {
    low: DVec3,
    high: DVec3,
}

impl Block {
    const EMPTY: Self = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };

    fn add(&mut self, point: DVec3) {
        self.low = self.low.min(point);
        self.high = self.high.max(point);
    }

    fn is_within(&self, other: &Self) -> bool {
        self.low.cmpge(other.low).all() && self.high.cmple(other.high).all()
    }
}

/// The faces in each of the cells of a block.
struct Lists {
    grid: Grid,
    starts: Vec<u32>,
    faces: Vec<u32>,
}

impl Lists {
    /// `None` where the block is not worth cutting.
    fn of(
        triangles: &[[DVec3; 3]],
        faces: &[u32],
        block: Block,
        places_a_face: usize,
        control: &Control,
    ) -> Result<Option<Self>, Cancelled> {
        let extent = block.high - block.low;
        let most_places = places_a_face * faces.len();
        // Lengths of faces in the block, of all axes together.
        let mut length = 0.0;
        for chunk in faces.chunks(STRIDE) {
            control.at(0.0)?;
            for &face in chunk {
                let [a, b, c] = triangles[face as usize];
                let low = a.min(b).min(c).max(block.low);
                let high = a.max(b).max(c).min(block.high);
                length += (high - low).max(DVec3::ZERO).element_sum();
            }
        }
        let mut along = MOST_ALONG;
        while along > 1.5 {
            let size = extent.max_element() / along;
            let n_cells = (extent / size).ceil().max(DVec3::ONE).element_product();
            let is_few = n_cells <= (CELLS_A_FACE * faces.len() as f64).max(64.0);
            let places = faces.len() as f64 + length / size;
            if is_few && places <= most_places as f64 && size > 1e-9 {
                let grid = Grid::over(block, size);
                if let Some(lists) = grid.lists(triangles, faces, most_places * 2, control)? {
                    return Ok(Some(lists));
                }
            }
            along *= 0.8;
        }
        Ok(None)
    }

    /// In how long a list a place is, on average.
    fn crowd(&self) -> f64 {
        let sizes = self.starts.windows(2).map(|ends| f64::from(ends[1] - ends[0]));
        let (sum, squares) = sizes.fold((0.0, 0.0), |(sum, sq), n| (sum + n, sq + n * n));
        squares / f64::max(sum, 1.0)
    }
}

/// Cubes of one size over a block.
#[derive(Clone, Debug)]
struct Grid {
    block: Block,
    per_size: f64,
    size: f64,
    most: UVec3,
}

impl Grid {
    fn over(block: Block, size: f64) -> Self {
        let n = ((block.high - block.low) / size).ceil().max(DVec3::ONE).as_uvec3();
        Self { block, per_size: 1.0 / size, size, most: n - UVec3::ONE }
    }

    fn cell_of(&self, point: DVec3) -> UVec3 {
        ((point - self.block.low) * self.per_size).as_uvec3().min(self.most)
    }

    /// The cell that ends, and the next that begins, at the wall before cell `k`.
    fn wall(&self, axis: usize, k: u32) -> f64 {
        self.block.low[axis] + f64::from(k) * self.size
    }

    fn lists(
        self,
        triangles: &[[DVec3; 3]],
        faces: &[u32],
        most_places: usize,
        control: &Control,
    ) -> Result<Option<Lists>, Cancelled> {
        let n = self.most + UVec3::ONE;
        let n_cells = (n.x * n.y * n.z) as usize;
        let mut places: Vec<(u32, u32)> = Vec::new();
        let mut starts = vec![0u32; n_cells + 1];
        for chunk in faces.chunks(STRIDE) {
            control.at(0.0)?;
            for &face in chunk {
                let start = places.len();
                let corners = triangles[face as usize];
                let mut found = |cell| places.push((cell, face));
                let bounds = Polygon::of(corners).bounds();
                if bounds.is_within(&self.block) {
                    self.put_by_slabs(corners, &mut found);
                } else {
                    let part = Polygon::of(corners).within(&self.block);
                    self.put(&part, [UVec3::ZERO, self.most], &mut found);
                }
                places[start..].iter().for_each(|&(cell, _)| starts[cell as usize + 1] += 1);
            }
            if places.len() > most_places {
                return Ok(None);
            }
        }
        for cell in 0..n_cells {
            starts[cell + 1] += starts[cell];
        }
        let mut next = starts.clone();
        let mut lists = vec![0; places.len()];
        for chunk in places.chunks(STRIDE << 5) {
            control.at(0.0)?;
            for &(cell, face) in chunk {
                let place = &mut next[cell as usize];
                lists[*place as usize] = face;
                *place += 1;
            }
        }
        Ok(Some(Lists { grid: self, starts, faces: lists }))
    }

    /// Finds the cells of a face, one layer of cells after the other.
    fn put_by_slabs(&self, [a, b, c]: [DVec3; 3], found: &mut impl FnMut(u32)) {
        let low = self.cell_of(a.min(b).min(c));
        let high = self.cell_of(a.max(b).max(c));
        let n = high - low + UVec3::ONE;
        let axis = n.max_position();
        let sides = [(a, b), (b, c), (c, a)].map(|(from, to)| Side::new(from, to, axis));
        let last = self.most[axis];
        for k in low[axis]..=high[axis] {
            // What is beyond the outermost walls belongs to the cells there.
            let start = if k == 0 { f64::NEG_INFINITY } else { self.wall(axis, k) };
            let end = if k == last { f64::INFINITY } else { self.wall(axis, k + 1) };
            let mut bounds = Block::EMPTY;
            sides.iter().for_each(|side| side.add_between(start, end, &mut bounds));
            if !bounds.low.is_finite() {
                continue;
            }
            let (mut low, mut high) = (self.cell_of(bounds.low), self.cell_of(bounds.high));
            (low[axis], high[axis]) = (k, k);
            let n = high - low + UVec3::ONE;
            if n.x * n.y * n.z <= FEW_CELLS {
                self.name(low, high, found);
            } else {
                let [_, above] = Polygon::of([a, b, c]).cut(axis, start.max(-1e9));
                let [part, _] = above.cut(axis, end.min(1e9));
                self.put(&part, [low, high], found);
            }
        }
    }

    /// Finds the cells, within these, of a part of a face.
    fn put(&self, polygon: &Polygon, within: [UVec3; 2], found: &mut impl FnMut(u32)) {
        if polygon.n == 0 {
            return;
        }
        let bounds = polygon.bounds();
        // What ends at a wall is not in the cell behind it.
        let cell_of = |point| self.cell_of(point).clamp(within[0], within[1]);
        let (low, high) = (cell_of(bounds.low), cell_of(bounds.high));
        let n = high - low + UVec3::ONE;
        if n.x * n.y * n.z <= FEW_CELLS || !polygon.may_be_cut() {
            return self.name(low, high, found);
        }
        let axis = n.max_position();
        let cut = low[axis] + n[axis] / 2;
        let [below, above] = polygon.cut(axis, self.wall(axis, cut));
        let (mut end, mut start) = (high, low);
        (end[axis], start[axis]) = (cut - 1, cut);
        self.put(&below, [low, end], found);
        self.put(&above, [start, high], found);
    }

    /// The numbers of cells.
    fn name(&self, low: UVec3, high: UVec3, found: &mut impl FnMut(u32)) {
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                (low.x..=high.x).for_each(|x| found(self.number(UVec3::new(x, y, z))));
            }
        }
    }

    fn number(&self, UVec3 { x, y, z }: UVec3) -> u32 {
        x + (self.most.x + 1) * (y + (self.most.y + 1) * z)
    }

    /// The box of a cell, within that of all.
    fn block(&self, cell: u32) -> Block {
        let n = self.most + UVec3::ONE;
        let at = UVec3::new(cell % n.x, cell / n.x % n.y, cell / (n.x * n.y));
        let low = self.block.low + at.as_dvec3() * self.size;
        let high = self.block.low + (at + UVec3::ONE).as_dvec3() * self.size;
        Block { low, high: high.min(self.block.high) }
    }
}

/// A side of a face, ready to be cut across an axis.
struct Side {
    from: DVec3,
    to: DVec3,
    slope: DVec3,
    start: f64,
    end: f64,
    origin: f64,
}

impl Side {
    fn new(from: DVec3, to: DVec3, axis: usize) -> Self {
        let along = to[axis] - from[axis];
        let slope = (to - from) / along;
        let (start, end) = (from[axis].min(to[axis]), from[axis].max(to[axis]));
        Self { from, to, slope, start, end, origin: from[axis] }
    }

    /// The box around what is between two planes grows.
    #[inline]
    fn add_between(&self, start: f64, end: f64, bounds: &mut Block) {
        let (start, end) = (start.max(self.start), end.min(self.end));
        if start > end {
            return;
        }
        if self.start == self.end {
            bounds.add(self.from);
            return bounds.add(self.to);
        }
        for at in [start, end] {
            let point = self.from + self.slope * (at - self.origin);
            bounds.add(point);
        }
    }
}

/// A convex part of a face.
#[derive(Clone, Copy)]
struct Polygon {
    points: [DVec3; Self::MOST + 1],
    n: usize,
}

impl Polygon {
    /// A triangle cut by two planes an axis.
    const MOST: usize = 11;

    fn of([a, b, c]: [DVec3; 3]) -> Self {
        let mut points = [DVec3::ZERO; Self::MOST + 1];
        (points[0], points[1], points[2]) = (a, b, c);
        Self { points, n: 3 }
    }

    fn bounds(&self) -> Block {
        let mut bounds = Block::EMPTY;
        self.points[..self.n].iter().for_each(|&p| bounds.add(p));
        bounds
    }

    /// What of it is in a block.
    fn within(self, block: &Block) -> Self {
        let mut polygon = self;
        let bounds = self.bounds();
        for axis in 0..3 {
            if bounds.low[axis] < block.low[axis] && polygon.may_be_cut() {
                [_, polygon] = polygon.cut(axis, block.low[axis]);
            }
            if bounds.high[axis] > block.high[axis] && polygon.may_be_cut() {
                [polygon, _] = polygon.cut(axis, block.high[axis]);
            }
        }
        polygon
    }

    /// Whether there is room for the corner that a cut adds; what is not cut goes into more cells.
    fn may_be_cut(&self) -> bool {
        self.n < Self::MOST
    }

    fn push(&mut self, point: DVec3) {
        self.points[self.n] = point;
        self.n += 1;
    }

    /// What is below and what is above a plane across an axis.
    fn cut(&self, axis: usize, at: f64) -> [Self; 2] {
        let empty = Self { points: [DVec3::ZERO; Self::MOST + 1], n: 0 };
        let [mut below, mut above] = [empty; 2];
        let mut from = self.points[self.n.max(1) - 1];
        for &to in &self.points[..self.n] {
            let (side, next) = (from[axis] - at, to[axis] - at);
            if (side < 0.0 && next > 0.0) || (side > 0.0 && next < 0.0) {
                let mut point = from + (to - from) * (side / (side - next));
                point[axis] = at;
                below.push(point);
                above.push(point);
            }
            if next <= 0.0 {
                below.push(to);
            }
            if next >= 0.0 {
                above.push(to);
            }
            from = to;
        }
        [below, above]
    }
}
