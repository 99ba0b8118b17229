//! One camera: its picture, all faces behind it, and how a collapse changes it.

use mve_core::{Cancelled, Control};
use mve_mesh::data::{FaceId, VertexId};
use wide::{f32x8, i32x8};

use super::ImageOptions;
use super::canvas::{BYTES, Block, Canvas, all};
use super::change::{Change, PatchFace};
use super::colors::{Colors, Shader, Values};
use super::layers::{END, Fragment, Layers};
use super::picture::{Patch, Picture};
use crate::geometry::simplify::collapse::WorkingMesh;
use crate::picture::render::{
    Corner, FaceColor, LANES, Lens, Rect, Sides, Triangle, face_triangles, is_placed, may_be_seen,
};

/// A camera of an image-driven cost.
#[derive(Debug)]
pub(super) struct LayeredView {
    shader: Shader,
    sides: Sides,
    background: u8,
    /// Where each vertex is in the picture.
    corners: Vec<Corner>,
    /// Pixels from one row of the layers to the next: rows are filled up with background, so that
    /// every block of lanes that begins in a row can be read.
    stride: usize,
    layers: Layers,
    pub picture: Picture,
}

impl LayeredView {
    /// Draws the whole mesh.
    pub fn new(
        lens: Lens,
        options: &ImageOptions,
        colors: Option<&Colors>,
        mesh: &WorkingMesh,
        control: Control,
    ) -> Result<Self, Cancelled> {
        let ImageOptions { sides, background, is_lit, .. } = *options;
        let n_vertices = 0..mesh.n_vertices() as u32;
        let corners = n_vertices.map(|v| lens.corner(mesh.position(VertexId(v)))).collect();
        let stride = lens.size + LANES;
        let layers = Layers::new(stride * lens.size, background);
        let picture = Picture { size: lens.size, original: Vec::new(), now: Vec::new() };
        let shader = Shader { lens, is_lit };
        let mut view = Self { shader, sides, background, corners, stride, layers, picture };
        for face in mesh.face_ids() {
            control.item(face.idx(), mesh.n_faces())?;
            let color = colors.map(|colors| (colors, colors.of_face(mesh, face)));
            PatchFace::of(mesh, face).iter().for_each(|face| view.insert(face, color));
        }
        let rows = view.layers.values.chunks_exact(stride);
        view.picture.now = rows.flat_map(|row| &row[..lens.size]).copied().collect();
        view.picture.original.clone_from(&view.picture.now);
        Ok(view)
    }

    /// Puts a face into the layers; white where it has no color.
    fn insert(&mut self, face: &PatchFace, color: Option<(&Colors, FaceColor)>) {
        let Self { shader, sides, corners, stride, layers, .. } = self;
        let placed = face.vertices.map(|v| corners[v as usize]);
        face_triangles(&shader.lens, *sides, placed, face.points, |triangle| match color {
            None => {
                let value = shader.white(face, triangle.side);
                insert(layers, (shader.lens.size, *stride), face.face, triangle, value);
            }
            Some((colors, color)) => {
                let values = shader.colored(face, triangle.side, color, colors);
                insert(layers, (shader.lens.size, *stride), face.face, triangle, values);
            }
        });
    }

    /// Takes a face out of the layers.
    fn remove(&mut self, face: &PatchFace) {
        let Self { shader: Shader { lens, .. }, sides, corners, stride, layers, .. } = self;
        let placed = face.vertices.map(|v| corners[v as usize]);
        let whole = Rect::whole(lens.size);
        face_triangles(lens, *sides, placed, face.points, |triangle| {
            triangle.rows(&whole, |row| {
                let first = row.y as usize * *stride;
                (row.x[0]..row.x[1]).for_each(|x| layers.remove(first + x as usize, face.face));
            });
        });
    }

    /// Makes a change in the layers; the picture is brought up to date by the patch of
    /// [`LayeredView::redraw`], before.
    pub fn make(&mut self, change: &Change, colors: Option<&Colors>) {
        change.old.iter().for_each(|old| self.remove(old));
        self.corners[change.kept as usize] = self.shader.lens.corner(change.position);
        for (at, new) in change.new.iter().enumerate() {
            self.insert(new, colors.zip(change.colors.get(at).copied()));
        }
    }

    /// Where a vertex would be after a change.
    #[inline]
    fn corner_after(&self, change: &Change, moved: Corner, vertex: u32) -> Corner {
        if vertex == change.kept { moved } else { self.corners[vertex as usize] }
    }

    /// The pixels that a change may touch.
    fn area(&self, change: &Change, moved: Corner) -> Rect {
        let whole = Rect::whole(self.shader.lens.size);
        let mut area = Rect::NONE;
        area.include(moved);
        let mut are_placed = moved.is_placed();
        for &vertex in &change.ring {
            let corner = self.corners[vertex as usize];
            area.include(corner);
            are_placed &= corner.is_placed();
        }
        if are_placed { area.within(&whole) } else { whole }
    }

    /// Whether a change may be seen: some face of it, before or after, may be.
    #[inline(always)]
    fn may_be_seen(&self, change: &Change, moved: Corner) -> bool {
        // Written out: a map over an array is not always inlined.
        let after = |v: u32| self.corner_after(change, moved, v);
        let before = |v: u32| self.corners[v as usize];
        let is_seen = |placed: [Corner; 3]| may_be_seen(placed, self.sides);
        change
            .new
            .iter()
            .any(|&PatchFace { vertices: [a, b, c], .. }| is_seen([after(a), after(b), after(c)]))
            || change.old.iter().any(|&PatchFace { vertices: [a, b, c], .. }| {
                is_seen([before(a), before(b), before(c)])
            })
    }

    /// Finds what the picture would be after a change, where it would differ; `false` where it
    /// would not.
    #[inline(always)]
    pub fn redraw(
        &self,
        change: &Change,
        colors: Option<&Colors>,
        canvas: &mut Canvas,
        patch: &mut Patch,
    ) -> bool {
        let moved = self.shader.lens.corner(change.position);
        if !self.may_be_seen(change, moved) {
            return false;
        }
        let area = self.area(change, moved);
        if area.is_empty() {
            return false;
        }
        canvas.clear(&area);
        if let Some(colors) = colors {
            self.draw_colored(change, moved, colors, canvas);
            return self.resolve(change, canvas, area, patch);
        }
        for new in &change.new {
            let [a, b, c] = new.vertices;
            let corner = |v: u32| self.corner_after(change, moved, v);
            let placed = [corner(a), corner(b), corner(c)];
            if !is_placed(placed) {
                self.draw_clipped(new, canvas);
            } else if let Some(triangle) = Triangle::new(placed, self.sides) {
                canvas.draw(new.face, &triangle, self.shader.white(new, triangle.side));
            }
        }
        self.resolve(change, canvas, area, patch)
    }

    /// Draws a white face of which a corner has no place.
    fn draw_clipped(&self, new: &PatchFace, canvas: &mut Canvas) {
        self.draw(new, [Corner::default(); 3], None, canvas);
    }

    /// Draws all faces of a change in their colors.
    #[inline(never)]
    fn draw_colored(&self, change: &Change, moved: Corner, colors: &Colors, canvas: &mut Canvas) {
        for (new, &color) in change.new.iter().zip(&change.colors) {
            let placed = new.vertices.map(|v| self.corner_after(change, moved, v));
            self.draw(new, placed, Some((colors, color)), canvas);
        }
    }

    /// Draws a face, white where it has no color.
    fn draw(
        &self,
        face: &PatchFace,
        placed: [Corner; 3],
        color: Option<(&Colors, FaceColor)>,
        canvas: &mut Canvas,
    ) {
        let shader = &self.shader;
        face_triangles(&shader.lens, self.sides, placed, face.points, |triangle| match color {
            None => canvas.draw(face.face, triangle, shader.white(face, triangle.side)),
            Some((colors, color)) => {
                let values = shader.colored(face, triangle.side, color, colors);
                canvas.draw(face.face, triangle, values);
            }
        });
    }

    /// Compares what was drawn with what stays.
    #[inline(always)]
    fn resolve(&self, change: &Change, canvas: &Canvas, area: Rect, patch: &mut Patch) -> bool {
        let n_across = canvas.n_across;
        patch.area = area;
        patch.changed = Rect::NONE;
        patch.stride = n_across * LANES;
        patch.values.resize(patch.stride * area.height(), 0);
        // Pixels of the last block in a row that lie in the area.
        let n_last = area.width() - (n_across - 1) * LANES;
        let (blocks, _) = patch.values.as_chunks_mut::<LANES>();
        let rows = blocks.chunks_exact_mut(n_across).zip(canvas.blocks.chunks_exact(n_across));
        for ((row, drawn), y) in rows.zip(area.y[0]..) {
            let start = y as usize * self.stride + area.x[0] as usize;
            let mut first_and_end = [i32::MAX, 0];
            for (at, (to, drawn)) in row.iter_mut().zip(drawn).enumerate() {
                let (new, now) = self.resolve_block(change, drawn, start + at * LANES);
                *to = new.to_le_bytes();
                let is_last = at + 1 == n_across;
                let mask = if is_last { u64::MAX >> (8 * (LANES - n_last)) } else { u64::MAX };
                let differ = (new ^ now) & mask;
                if differ != 0 {
                    let x = (at * LANES) as i32;
                    let first = x + differ.trailing_zeros() as i32 / 8;
                    let end = x + 8 - differ.leading_zeros() as i32 / 8;
                    first_and_end = [first_and_end[0].min(first), end];
                }
            }
            if first_and_end[1] > 0 {
                let [first, end] = first_and_end.map(|x| area.x[0] + x);
                let changed = &mut patch.changed;
                changed.x = [changed.x[0].min(first), changed.x[1].max(end)];
                changed.y = [changed.y[0].min(y), y + 1];
            }
        }
        !patch.changed.is_empty()
    }

    /// The new and the present values of eight pixels from `pixel` on, a byte each.
    #[inline(always)]
    fn resolve_block(&self, change: &Change, drawn: &Block, pixel: usize) -> (u64, u64) {
        let layers = &self.layers;
        let now = u64::from_le_bytes(lanes(&layers.values, pixel));
        let goes = change.removes_lanes(lanes(&layers.faces, pixel));
        let is_drawn = drawn.inv_depths.simd_gt(f32x8::splat(0.0)).to_bitmask();
        if goes | is_drawn == 0 {
            return (now, now);
        }
        let inv_depths = f32x8::new(lanes(&layers.inv_depths, pixel));
        let nexts = lanes(&layers.nexts, pixel);
        let nexts = i32x8::new(std::array::from_fn(|lane| nexts[lane] as i32));
        let is_nearer = drawn.inv_depths.simd_gt(inv_depths).to_bitmask();
        let bytes = |bits: u32| BYTES[bits as usize & 0xFF];
        let (over, changes) = (bytes(is_drawn), bytes(goes | is_nearer));
        let over = (drawn.values & over) | (all(self.background) & !over);
        let new = (over & changes) | (now & !changes);
        // What lies behind a face that goes, and which of two equally near faces is seen, is not
        // known yet.
        let is_last = nexts.simd_eq(i32x8::splat(END as i32)).to_bitmask();
        let is_even = drawn.inv_depths.simd_eq(inv_depths).to_bitmask() & is_drawn & !goes;
        let open = ((goes & !is_last) | is_even) & 0xFF;
        let new = if open == 0 { new } else { self.resolve_open(change, drawn, pixel, open, new) };
        (new, now)
    }

    /// Puts in the values of the pixels `open`, of which more must be known than the first
    /// fragments.
    fn resolve_open(
        &self,
        change: &Change,
        drawn: &Block,
        pixel: usize,
        mut open: u32,
        new: u64,
    ) -> u64 {
        let mut new = new.to_le_bytes();
        while open != 0 {
            let lane = open.trailing_zeros() as usize;
            open &= open - 1;
            let left = self.layers.first_left(pixel + lane, |face| !change.removes(face));
            let (face, inv_depth) =
                (drawn.faces.as_array()[lane] as u32, drawn.inv_depths.as_array()[lane]);
            let over = Fragment::new(face, inv_depth, (drawn.values >> (8 * lane)) as u8);
            let is_seen = inv_depth > 0.0 && over.hides(&left);
            new[lane] = if is_seen { over.value } else { left.value };
        }
        u64::from_le_bytes(new)
    }

    /// Draws the whole picture as it would be after a change, from nothing; all of it counts as
    /// changed. What [`LayeredView::redraw`] must agree with.
    pub fn redraw_whole(
        &self,
        mesh: &WorkingMesh,
        change: &Change,
        colors: Option<&Colors>,
        canvas: &mut Canvas,
        patch: &mut Patch,
    ) {
        let whole = Rect::whole(self.shader.lens.size);
        let moved = self.shader.lens.corner(change.position);
        canvas.clear(&whole);
        let mut draw = |face: &PatchFace, color: Option<FaceColor>| {
            let placed = face.vertices.map(|v| self.corner_after(change, moved, v));
            self.draw(face, placed, colors.zip(color), canvas);
        };
        for face in mesh.face_ids() {
            let FaceId(number) = face;
            if !change.removes(number) {
                let color = colors.map(|colors| colors.of_face(mesh, face));
                PatchFace::of(mesh, face).iter().for_each(|face| draw(face, color));
            } else if let Ok(at) = change.new.binary_search_by_key(&number, |new| new.face) {
                draw(&change.new[at], change.colors.get(at).copied());
            }
        }
        patch.area = whole;
        patch.changed = whole;
        patch.stride = canvas.n_across * LANES;
        patch.values.clear();
        for block in &canvas.blocks {
            let is_drawn = block.inv_depths.simd_gt(f32x8::splat(0.0)).to_bitmask();
            let over = BYTES[is_drawn as usize & 0xFF];
            let values = (block.values & over) | (all(self.background) & !over);
            patch.values.extend(values.to_le_bytes());
        }
    }
}

/// Puts the pixels of a triangle into the layers of a picture of this size and stride.
fn insert(
    layers: &mut Layers,
    (size, stride): (usize, usize),
    face: u32,
    triangle: &Triangle,
    values: impl Values,
) {
    triangle.rows(&Rect::whole(size), |row| {
        let first = row.y as usize * stride + row.x[0] as usize;
        for (k, x) in (row.x[0]..row.x[1]).enumerate() {
            let value = values.of_pixel(x, row.y);
            layers.insert(first + k, Fragment::new(face, row.inv_depth(k), value));
        }
    });
}

/// The lanes from a place on.
#[inline(always)]
fn lanes<T: Copy>(list: &[T], from: usize) -> [T; LANES] {
    let part = &list[from..from + LANES];
    std::array::from_fn(|lane| part[lane])
}
