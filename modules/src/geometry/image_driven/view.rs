//! One camera: its picture, all faces behind it, and how a collapse changes it.

use super::change::{Change, Patched};
use super::layers::{Fragment, Layers};
use super::picture::{Patch, Picture};
use crate::data::{FaceId, VertexId};
use crate::geometry::control::{Cancelled, Control};
use crate::geometry::render::{Corner, Lens, Rect, Sides, Triangle, face_triangles, luminance};
use crate::geometry::simplify::Collapsing;

/// A camera of an image-driven cost.
#[derive(Debug)]
pub(super) struct View {
    lens: Lens,
    sides: Sides,
    background: u8,
    /// Where each vertex is in the picture.
    corners: Vec<Corner>,
    layers: Layers,
    pub picture: Picture,
}

/// What is drawn of a change at a pixel, before it is compared with what is there.
#[derive(Clone, Copy, Debug, Default)]
struct Drawn {
    /// 0 where nothing is drawn.
    inv_depth: f32,
    face: u32,
    value: u8,
}

/// What is drawn of a change, one fragment a pixel of its area.
#[derive(Debug, Default)]
pub(super) struct Canvas {
    pixels: Vec<Drawn>,
}

impl Canvas {
    fn clear(&mut self, n_pixels: usize) {
        self.pixels.clear();
        self.pixels.resize(n_pixels, Drawn::default());
    }

    /// Draws a face of a larger number than those before.
    #[inline(always)]
    fn draw(&mut self, area: &Rect, face: u32, triangle: &Triangle, value: u8) {
        let width = area.width();
        triangle.rows(area, |row| {
            let first = (row.y - area.y[0]) as usize * width + (row.x[0] - area.x[0]) as usize;
            let there = &mut self.pixels[first..first + (row.x[1] - row.x[0]) as usize];
            for (k, there) in there.iter_mut().enumerate() {
                let inv_depth = row.inv_depth(k);
                if inv_depth > there.inv_depth {
                    *there = Drawn { inv_depth, face, value };
                }
            }
        });
    }
}

impl View {
    /// Draws the whole mesh.
    pub fn new(
        lens: Lens,
        sides: Sides,
        background: u8,
        state: &Collapsing,
        control: Control,
    ) -> Result<Self, Cancelled> {
        let n_vertices = 0..state.n_vertices() as u32;
        let corners = n_vertices.map(|v| lens.corner(state.position(VertexId(v)))).collect();
        let n_pixels = lens.size * lens.size;
        let layers = Layers::new(n_pixels, background);
        let picture = Picture { size: lens.size, original: Vec::new(), now: Vec::new() };
        let mut view = Self { lens, sides, background, corners, layers, picture };
        for face in state.face_ids() {
            control.item(face.idx(), state.n_faces())?;
            Patched::of(state, face).iter().for_each(|face| view.insert(face));
        }
        view.picture.now = view.layers.first().iter().map(|first| first.value).collect();
        view.picture.original.clone_from(&view.picture.now);
        Ok(view)
    }

    /// Puts a face into the layers.
    fn insert(&mut self, face: &Patched) {
        let Self { lens, sides, corners, layers, .. } = self;
        let placed = face.vertices.map(|v| corners[v as usize]);
        let whole = Rect::whole(lens.size);
        face_triangles(lens, *sides, placed, face.points, |triangle| {
            let value = luminance(face.normal, lens.camera.forward, triangle.side);
            triangle.rows(&whole, |row| {
                let first = row.y as usize * lens.size + row.x[0] as usize;
                for k in 0..(row.x[1] - row.x[0]) as usize {
                    layers.insert(first + k, Fragment::new(face.face, row.inv_depth(k), value));
                }
            });
        });
    }

    /// Takes a face out of the layers.
    fn remove(&mut self, face: &Patched) {
        let Self { lens, sides, corners, layers, .. } = self;
        let placed = face.vertices.map(|v| corners[v as usize]);
        let whole = Rect::whole(lens.size);
        face_triangles(lens, *sides, placed, face.points, |triangle| {
            triangle.rows(&whole, |row| {
                let first = row.y as usize * lens.size;
                (row.x[0]..row.x[1]).for_each(|x| layers.remove(first + x as usize, face.face));
            });
        });
    }

    /// Makes a change in the layers; the picture is brought up to date by the patch of
    /// [`View::redraw`], before.
    pub fn make(&mut self, change: &Change) {
        change.old.iter().for_each(|old| self.remove(old));
        self.corners[change.kept as usize] = self.lens.corner(change.position);
        change.new.iter().for_each(|new| self.insert(new));
    }

    /// Where a vertex would be after a change.
    #[inline]
    fn corner_after(&self, change: &Change, moved: Corner, vertex: u32) -> Corner {
        if vertex == change.kept { moved } else { self.corners[vertex as usize] }
    }

    /// The pixels that a change may touch.
    fn area(&self, change: &Change, moved: Corner) -> Rect {
        let whole = Rect::whole(self.lens.size);
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

    /// Whether a face that goes may be seen: it has area and shows its drawn side.
    #[inline]
    fn may_be_seen(&self, old: &Patched) -> bool {
        let [a, b, c] = old.vertices.map(|v| self.corners[v as usize]);
        let wide = |from: i32, to: i32| i64::from(to - from);
        let across = wide(a.x, b.x) * wide(a.y, c.y) - wide(a.y, b.y) * wide(a.x, c.x);
        let are_placed = a.is_placed() && b.is_placed() && c.is_placed();
        !are_placed || if self.sides == Sides::Front { across < 0 } else { across != 0 }
    }

    /// Finds what the picture would be after a change, where it would differ; `false` where it
    /// would not.
    pub fn redraw(&self, change: &Change, canvas: &mut Canvas, patch: &mut Patch) -> bool {
        let moved = self.lens.corner(change.position);
        let area = self.area(change, moved);
        if area.is_empty() {
            return false;
        }
        let mut is_clear = false;
        for new in &change.new {
            let placed = new.vertices.map(|v| self.corner_after(change, moved, v));
            face_triangles(&self.lens, self.sides, placed, new.points, |triangle| {
                if !is_clear {
                    canvas.clear(area.width() * area.height());
                    is_clear = true;
                }
                let value = luminance(new.normal, self.lens.camera.forward, triangle.side);
                canvas.draw(&area, new.face, triangle, value);
            });
        }
        if !is_clear {
            if !change.old.iter().any(|old| self.may_be_seen(old)) {
                return false;
            }
            canvas.clear(area.width() * area.height());
        }
        self.resolve(change, canvas, area, patch)
    }

    /// Compares what was drawn with what stays, pixel by pixel.
    fn resolve(&self, change: &Change, canvas: &Canvas, area: Rect, patch: &mut Patch) -> bool {
        let (width, size) = (area.width(), self.lens.size);
        patch.area = area;
        patch.changed = Rect::NONE;
        patch.values.resize(width * area.height(), 0);
        let drawn = canvas.pixels.chunks_exact(width);
        for ((row, drawn), y) in patch.values.chunks_exact_mut(width).zip(drawn).zip(area.y[0]..) {
            let start = y as usize * size + area.x[0] as usize;
            let there = &self.layers.first()[start..start + width];
            let (mut first, mut last) = (usize::MAX, 0);
            for (x, ((value, there), drawn)) in row.iter_mut().zip(there).zip(drawn).enumerate() {
                let goes = change.removes(there.face);
                *value = there.value;
                if !goes && drawn.inv_depth < there.inv_depth {
                    continue;
                }
                let left = if goes {
                    self.layers.first_left(start + x, |face| !change.removes(face))
                } else {
                    *there
                };
                *value = left.value;
                if drawn.inv_depth > 0.0
                    && Fragment::new(drawn.face, drawn.inv_depth, 0).hides(&left)
                {
                    *value = drawn.value;
                }
                if *value != there.value {
                    first = first.min(x);
                    last = x + 1;
                }
            }
            if first < last {
                let x = [first, last].map(|x| area.x[0] + x as i32);
                let changed = &mut patch.changed;
                changed.x = [changed.x[0].min(x[0]), changed.x[1].max(x[1])];
                changed.y = [changed.y[0].min(y), y + 1];
            }
        }
        !patch.changed.is_empty()
    }

    /// Draws the whole picture as it would be after a change, from nothing; all of it counts as
    /// changed. What [`View::redraw`] must agree with.
    pub fn redraw_whole(
        &self,
        state: &Collapsing,
        change: &Change,
        canvas: &mut Canvas,
        patch: &mut Patch,
    ) {
        let whole = Rect::whole(self.lens.size);
        let moved = self.lens.corner(change.position);
        canvas.clear(self.lens.size * self.lens.size);
        let mut draw = |face: &Patched| {
            let placed = face.vertices.map(|v| self.corner_after(change, moved, v));
            face_triangles(&self.lens, self.sides, placed, face.points, |triangle| {
                let value = luminance(face.normal, self.lens.camera.forward, triangle.side);
                canvas.draw(&whole, face.face, triangle, value);
            });
        };
        for face in state.face_ids() {
            let FaceId(number) = face;
            if !change.removes(number) {
                Patched::of(state, face).iter().for_each(&mut draw);
            } else if let Ok(at) = change.new.binary_search_by_key(&number, |new| new.face) {
                draw(&change.new[at]);
            }
        }
        patch.area = whole;
        patch.changed = whole;
        let value = |d: &Drawn| if d.inv_depth > 0.0 { d.value } else { self.background };
        patch.values.clear();
        patch.values.extend(canvas.pixels.iter().map(value));
    }
}
