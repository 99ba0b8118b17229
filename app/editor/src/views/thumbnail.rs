//! Small pictures of values, made one at a time on a thread and kept by the key of their result.
//!
//! A mesh is drawn by the rasterizer of modules, which needs no GPU, and never makes a frame wait.

use std::collections::HashMap;

use eframe::egui::{ColorImage, Context, TextureHandle, TextureOptions};
use mve_core::{Control, Data, DataType, Fingerprint, Value};
use mve_modules::data::{Image, Images, PixelKind, TriMesh};
use mve_modules::picture::render::{
    self, Albedo, Lens, NormalSource, PictureOptions, Shading, Sides, Surface,
};

use super::background::{Progress, Task};
use super::camera::{Bounds, Camera, StandardView};
use super::picture::color_image;

/// Pixels of the longer side.
const SIDE: usize = 288;
/// Pixels that are drawn for one that is kept, along each side.
const SAMPLES: usize = 2;
/// Pictures that are kept beside those in sight; what was in sight longest ago gives way.
const MOST: usize = 256;

/// The key of the node's result, and the output.
pub type ThumbnailKey = (Fingerprint, String);

/// The pictures that were made, and the one in the making.
#[derive(Default)]
pub struct Thumbnails {
    made: HashMap<ThumbnailKey, Made>,
    task: Option<(ThumbnailKey, Task<Option<ColorImage>>)>,
}

/// A picture that was made.
struct Made {
    /// `None` where there is nothing to be seen.
    picture: Option<TextureHandle>,
    /// The frame in which it was looked for last.
    frame: u64,
}

/// What there is to show of a value.
pub enum Thumbnail<'a> {
    /// A picture.
    Picture(&'a TextureHandle),
    /// It is in the making, or waits.
    Awaited,
    /// There is nothing to be seen.
    Nothing,
}

impl Thumbnails {
    /// Whether values of a type have pictures.
    pub fn are_of(data_type: DataType) -> bool {
        [TriMesh::TYPE.id, Images::TYPE.id].contains(&data_type.id)
    }

    /// The picture of a value; it is made where it is not there and no other one is in the making.
    pub fn of(&mut self, context: &Context, key: ThumbnailKey, value: &Value) -> Thumbnail<'_> {
        self.take_in(context);
        if !self.made.contains_key(&key) {
            if self.task.is_none() {
                let value = value.clone();
                let task = Task::spawn(context, move || thumbnail(&value));
                self.task = Some((key, task));
            }
            return Thumbnail::Awaited;
        }
        let Some(made) = self.made.get_mut(&key) else { return Thumbnail::Nothing };
        made.frame = context.cumulative_frame_nr();
        made.picture.as_ref().map_or(Thumbnail::Nothing, Thumbnail::Picture)
    }

    /// Whether one is in the making.
    pub fn is_busy(&self) -> bool {
        self.task.is_some()
    }

    fn take_in(&mut self, context: &Context) {
        let Some((key, task)) = self.task.take() else { return };
        let image = match task.poll() {
            Progress::Running => {
                self.task = Some((key, task));
                return;
            }
            Progress::Done(image) => image,
            Progress::Lost => None,
        };
        let load = |image| context.load_texture("thumbnail", image, TextureOptions::LINEAR);
        let (picture, frame) = (image.map(load), context.cumulative_frame_nr());
        self.made.insert(key, Made { picture, frame });
        // One that is in sight would be made again at once.
        let is_seen = |made: &Made| made.frame + 1 >= frame;
        while self.made.len() > MOST {
            let oldest = self.made.iter().min_by_key(|(_, made)| made.frame);
            let oldest = oldest.filter(|(_, made)| !is_seen(made)).map(|(key, _)| key.clone());
            let Some(oldest) = oldest else { break };
            self.made.remove(&oldest);
        }
    }
}

/// A picture of a mesh, or the first of several pictures; `None` where there is nothing to be seen.
fn thumbnail(value: &Value) -> Option<ColorImage> {
    if let Some(images) = value.get::<Images>() {
        let first = images.0.iter().find(|image| image.width > 0 && image.height > 0)?;
        return Some(color_image(first, SIDE));
    }
    of_mesh(&*value.get::<TriMesh>()?)
}

/// A mesh as a view shows it at first: from a corner, what stands on its feet upright.
fn of_mesh(mesh: &TriMesh) -> Option<ColorImage> {
    let used = mesh.faces.iter().flatten();
    let bounds = Bounds::around(used.map(|vertex| mesh.positions[vertex.idx()]))?;
    let distance = (bounds.high - bounds.low).length();
    let mut from = Camera { up: bounds.up(), ..Camera::default() };
    from.look_from(StandardView::Corner);
    let axes = from.axes();
    let eye = bounds.center() + distance * axes.back;
    if !(distance.is_normal() && eye.is_finite()) {
        return None;
    }
    let camera = render::Camera { eye, right: axes.right, up: axes.up, forward: -axes.back };
    let (shading, source) = (Shading::Gouraud, NormalSource::Layer);
    let surface = Surface::new(mesh, shading, source, Albedo::Colors, Control::none()).ok()?;
    let size = 2 * SIDE * SAMPLES;
    let (sides, kind) = (Sides::Both, PixelKind::Rgb);
    let options = PictureOptions { size, sides, background: 0, kind, samples: 1 };
    let lens = Lens::new(camera, size, distance);
    let image = render::picture(&surface, &lens, "", &options, || Ok(())).ok()?;
    cut_out(&image)
}

/// What is not black in a picture, with nothing behind it, as large as a thumbnail.
fn cut_out(image: &Image) -> Option<ColorImage> {
    let is_seen = |x: usize, y: usize| {
        let at = 3 * (y * image.width + x);
        image.bytes.get(at..at + 3).is_some_and(|pixel| pixel.iter().any(|byte| *byte > 0))
    };
    let (mut low, mut high) = ([usize::MAX; 2], [0; 2]);
    for y in 0..image.height {
        for x in (0..image.width).filter(|x| is_seen(*x, y)) {
            low = [low[0].min(x), low[1].min(y)];
            high = [high[0].max(x + 1), high[1].max(y + 1)];
        }
    }
    if low[0] == usize::MAX {
        return None;
    }
    let side = [high[0] - low[0], high[1] - low[1]];
    let step = side[0].max(side[1]).div_ceil(SIDE).max(1);
    let size = side.map(|side| side.div_ceil(step));
    let mut pixels = Vec::with_capacity(4 * size[0] * size[1]);
    for y in 0..size[1] {
        for x in 0..size[0] {
            pixels.extend(mean(image, [low[0] + x * step, low[1] + y * step], step, &is_seen));
        }
    }
    Some(ColorImage::from_rgba_unmultiplied(size, &pixels))
}

/// The color of a square of pixels, and how much of it is seen.
fn mean(
    image: &Image,
    [left, top]: [usize; 2],
    step: usize,
    is_seen: &dyn Fn(usize, usize) -> bool,
) -> [u8; 4] {
    let (mut sums, mut n_seen) = ([0usize; 3], 0);
    for y in top..(top + step).min(image.height) {
        for x in (left..(left + step).min(image.width)).filter(|x| is_seen(*x, y)) {
            let at = 3 * (y * image.width + x);
            (0..3).for_each(|k| sums[k] += usize::from(image.bytes[at + k]));
            n_seen += 1;
        }
    }
    let [r, g, b] = sums.map(|sum| sum.checked_div(n_seen).unwrap_or(0) as u8);
    [r, g, b, (255 * n_seen / (step * step)) as u8]
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use mve_modules::mesh::fixtures::{cube, mesh_of};

    use super::*;

    #[test]
    fn a_mesh_fills_its_picture_and_nothing_has_none() {
        let picture = thumbnail(&Value::new(cube(DVec3::ZERO))).unwrap();
        let [width, height] = picture.size;
        assert!(width.max(height) > SIDE / 2 && width.max(height) <= SIDE, "{width} × {height}");
        let middle = picture.pixels[height / 2 * width + width / 2];
        assert!(middle.a() == 255 && middle.r() > 60, "{middle:?}");
        // A corner of the picture is beside the cube, which is seen from one of its corners.
        assert_eq!(picture.pixels[0].a(), 0);
        let flat = mesh_of(&[[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]], &[[0, 1, 2]]);
        let unplaced = mesh_of(&[[f64::NAN; 3], [0.0; 3], [1.0; 3]], &[[0, 1, 2]]);
        let huge = mesh_of(&[[-1e308; 3], [1e308, 0.0, 0.0], [0.0, 1e308, 0.0]], &[[0, 1, 2]]);
        for mesh in [TriMesh::default(), flat, unplaced, huge] {
            assert!(thumbnail(&Value::new(mesh)).is_none());
        }
        assert!(thumbnail(&Value::new(Images(Vec::new()))).is_none());
    }

    #[test]
    fn each_is_made_once_and_one_at_a_time() {
        let context = Context::default();
        let mut thumbnails = Thumbnails::default();
        let value = Value::new(cube(DVec3::ZERO));
        let key = |name: &str| (Fingerprint::of(name.as_bytes()), "mesh".to_owned());
        assert!(matches!(thumbnails.of(&context, key("a"), &value), Thumbnail::Awaited));
        assert!(matches!(thumbnails.of(&context, key("b"), &value), Thumbnail::Awaited));
        while matches!(thumbnails.of(&context, key("a"), &value), Thumbnail::Awaited) {
            std::thread::yield_now();
        }
        assert!(!thumbnails.is_busy(), "the other one is made once it is looked for again");
        let empty = Value::new(TriMesh::default());
        while matches!(thumbnails.of(&context, key("b"), &empty), Thumbnail::Awaited) {
            std::thread::yield_now();
        }
        assert!(matches!(thumbnails.of(&context, key("b"), &empty), Thumbnail::Nothing));
        assert!(matches!(thumbnails.of(&context, key("a"), &empty), Thumbnail::Picture(_)));
    }

    #[test]
    fn what_is_in_sight_stays_and_what_was_longest_ago_gives_way() {
        let context = Context::default();
        let mut thumbnails = Thumbnails::default();
        let nothing = Value::new(TriMesh::default());
        let key = |n: usize| (Fingerprint::of(&n.to_le_bytes()), "mesh".to_owned());
        let frame = |thumbnails: &mut Thumbnails, seen: std::ops::Range<usize>| {
            let mut n_awaited = 0;
            let mut output = context.run_ui(Default::default(), |_| {
                let is_awaited = |n: &usize| {
                    matches!(thumbnails.of(&context, key(*n), &nothing), Thumbnail::Awaited)
                };
                n_awaited = seen.clone().filter(is_awaited).count();
            });
            output.textures_delta.clear();
            n_awaited
        };
        // More than are kept beside those in sight: all of them are made once, and stay.
        while frame(&mut thumbnails, 0..MOST + 40) > 0 {
            std::thread::yield_now();
        }
        assert_eq!(frame(&mut thumbnails, 0..MOST + 40), 0);
        // The first is looked at, all others are not; then a new one comes.
        (0..3).for_each(|_| assert_eq!(frame(&mut thumbnails, 0..1), 0));
        while frame(&mut thumbnails, MOST + 40..MOST + 41) > 0 {
            std::thread::yield_now();
        }
        assert!(thumbnails.made.contains_key(&key(0)));
        assert!(thumbnails.made.len() <= MOST);
    }
}
