//! Pictures: several sets side by side with one zoom, or what two of them differ by.

use std::sync::Arc;

use eframe::egui::{self, Color32, Rect, Sense, TextureHandle, Vec2, pos2, vec2};
use mve_core::Value;
use mve_modules::data::{Image, Images};

use super::heading;
use super::images_zoom::Zoom;
use super::make_room;
use super::memo::{Memo, Same};
use super::picture::{color_image, difference, rgb_at};
use super::{PanelPlace, Pinned, ValueView, ViewInput, ViewerAction};

/// Pictures to show.
#[derive(Clone, Debug)]
struct ImagesInput {
    /// Their place in the list of the viewer.
    place: usize,
    /// Where they come from: `render.images`.
    title: String,
    /// The pictures.
    images: Arc<Images>,
}

/// Which picture of which set.
type Key = (Same<Images>, usize);

/// A picture that the window has.
struct PictureTextures {
    key: Key,
    texture: TextureHandle,
    thumbnail: TextureHandle,
    /// Whether the last frame used it.
    is_used: bool,
}

/// The state of a panel of pictures.
#[derive(Default)]
pub struct ImagesView {
    zoom: Zoom,
    /// The picture of each set that is shown, by place; the last where a set has fewer.
    chosen: usize,
    /// Whether the difference of the first two sets is shown beside them.
    has_difference: bool,
    gain: Gain,
    loaded: Vec<PictureTextures>,
    difference: Memo<(Key, Key, f32), Result<Image, String>>,
    difference_texture: Option<(Same<Result<Image, String>>, TextureHandle)>,
}

/// What differences are multiplied by.
#[derive(Clone, Copy, PartialEq)]
struct Gain(f32);

impl Default for Gain {
    fn default() -> Self {
        Self(4.0)
    }
}

/// Height of the strip of small pictures.
const STRIP: f32 = 84.0;
/// Longest side of a small picture in pixels.
const THUMBNAIL: usize = 128;

/// What one tile shows.
struct ImageTile<'a> {
    title: String,
    image: &'a Image,
    texture: egui::TextureId,
    /// The set, for what can be unpinned.
    set: Option<usize>,
}

impl ValueView for ImagesView {
    fn place(&self) -> PanelPlace {
        PanelPlace::Column("images")
    }

    fn takes(&self, value: &Value, _all: &[Pinned]) -> bool {
        value.get::<Images>().is_some()
    }

    fn is_empty(&self, value: &Value) -> bool {
        value.get::<Images>().is_some_and(|images| images.0.is_empty())
    }

    fn show(&mut self, ui: &mut egui::Ui, shown: &ViewInput) -> Vec<ViewerAction> {
        let sets = shown.of::<Images>().into_iter();
        let input = |(place, title, images): (usize, &str, Arc<Images>)| ImagesInput {
            place,
            title: title.to_owned(),
            images,
        };
        let sets: Vec<ImagesInput> = sets.map(input).collect();
        let unpinned = self.show_sets(ui, &sets);
        unpinned.map(|set| ViewerAction::Unpin(sets[set].place)).into_iter().collect()
    }

    fn is_busy(&self) -> bool {
        self.difference.is_busy()
    }
}

impl ImagesView {
    /// Shows the sets. Returns the one that the user wants to see no longer, if any.
    fn show_sets(&mut self, ui: &mut egui::Ui, sets: &[ImagesInput]) -> Option<usize> {
        let most = sets.iter().map(|set| set.images.0.len()).max().unwrap_or(0);
        self.chosen = self.chosen.min(most.saturating_sub(1));
        let mut status = String::new();
        self.controls(ui, sets, most);
        let status_rect = ui.allocate_space(vec2(ui.available_width(), 18.0)).1;
        let strip = if most > 1 { STRIP } else { 0.0 };
        let mut whole = ui.available_rect_before_wrap();
        whole.max.y = (whole.max.y - strip).max(whole.min.y);
        ui.allocate_rect(whole, Sense::hover());
        self.load(ui, sets, strip > 0.0);
        let difference = self.difference(ui, sets);
        let mut unpinned = None;
        if whole.width() >= 8.0 && whole.height() >= 8.0 {
            let tiles = self.tiles(sets, difference.as_deref());
            let width = whole.width() / tiles.len().max(1) as f32;
            let zoom = &mut self.zoom;
            zoom.begin();
            for (at, tile) in tiles.iter().enumerate() {
                let corner = whole.left_top() + vec2(at as f32 * width, 0.0);
                let rect = Rect::from_min_size(corner, vec2(width, whole.height())).shrink(1.0);
                if show_tile(ui, zoom, rect, tile, (tiles[0].image, &tiles), &mut status) {
                    unpinned = tile.set;
                }
            }
        }
        if let Some(Err(message)) = difference.as_deref() {
            status.clone_from(message);
        }
        ui.painter_at(status_rect).text(
            status_rect.left_center(),
            egui::Align2::LEFT_CENTER,
            &status,
            egui::TextStyle::Monospace.resolve(ui.style()),
            ui.visuals().text_color(),
        );
        if strip > 0.0 {
            self.strip(ui, sets, most);
        }
        self.loaded.retain(|loaded| loaded.is_used);
        unpinned
    }

    fn controls(&mut self, ui: &mut egui::Ui, sets: &[ImagesInput], most: usize) {
        ui.horizontal_wrapped(|ui| {
            if ui.button("Fit").on_hover_text("Show all of it (double click)").clicked() {
                self.zoom.fit();
            }
            if ui
                .button("1:1")
                .on_hover_text("One pixel of the picture a pixel of the screen")
                .clicked()
            {
                self.zoom.one_to_one();
            }
            if most > 1 {
                let mut number = self.chosen + 1;
                let drag = egui::DragValue::new(&mut number).range(1..=most);
                ui.add(drag.prefix("picture ").suffix(format!(" of {most}")))
                    .on_hover_text("Which picture of each set");
                self.chosen = number.clamp(1, most) - 1;
            }
            if sets.len() > 1 {
                ui.toggle_value(&mut self.has_difference, "Difference")
                    .on_hover_text("What the first two differ by, without sign");
                if self.has_difference {
                    make_room(ui, 190.0);
                    let slider = egui::Slider::new(&mut self.gain.0, 1.0..=64.0).logarithmic(true);
                    ui.label("Multiplied by");
                    ui.add(slider).on_hover_text("What differences are multiplied by");
                }
            }
        });
    }

    /// The picture that is shown of a set.
    fn image_of<'a>(&self, set: &'a ImagesInput) -> Option<(Key, &'a Image)> {
        let at = self.chosen.min(set.images.0.len().checked_sub(1)?);
        Some(((Same(Arc::clone(&set.images)), at), &set.images.0[at]))
    }

    /// Gives the window the pictures that are shown, and of a strip the small ones too.
    fn load(&mut self, ui: &egui::Ui, sets: &[ImagesInput], has_strip: bool) {
        for loaded in &mut self.loaded {
            loaded.is_used = false;
        }
        let most = ui.input(|input| input.max_texture_side);
        for set in sets {
            let chosen = self.image_of(set).map(|(key, _)| key.1);
            for (at, image) in set.images.0.iter().enumerate() {
                let key = (Same(Arc::clone(&set.images)), at);
                let is_chosen = chosen == Some(at);
                let known = self.loaded.iter_mut().find(|loaded| loaded.key == key);
                if let Some(known) = known {
                    known.is_used = true;
                    // Pictures that are large are given over when they are chosen.
                    if is_chosen && known.texture.id() == known.thumbnail.id() {
                        known.texture = load_texture(ui, image, most);
                    }
                    continue;
                }
                if !(is_chosen || has_strip) {
                    continue;
                }
                let thumbnail = load_texture(ui, image, THUMBNAIL);
                let texture = match is_chosen {
                    true => load_texture(ui, image, most),
                    false => thumbnail.clone(),
                };
                self.loaded.push(PictureTextures { key, texture, thumbnail, is_used: true });
            }
        }
    }

    fn difference(
        &mut self,
        ui: &egui::Ui,
        sets: &[ImagesInput],
    ) -> Option<Arc<Result<Image, String>>> {
        let [first, second, ..] = sets else { return None };
        if !self.has_difference {
            return None;
        }
        let ((a, _), (b, _)) = (self.image_of(first)?, self.image_of(second)?);
        let gain = self.gain.0;
        let job = (a.clone(), b.clone());
        self.difference.want(ui.ctx(), (a, b, gain), move || {
            let ((a, at_a), (b, at_b)) = job;
            difference(&a.0.0[at_a], &b.0.0[at_b], gain)
        });
        let made = self.difference.latest()?;
        let is_loaded = |(of, _): &(Same<_>, TextureHandle)| Arc::ptr_eq(&of.0, &made);
        if let Ok(image) = made.as_ref()
            && !self.difference_texture.as_ref().is_some_and(is_loaded)
        {
            let most = ui.input(|input| input.max_texture_side);
            let texture = load_texture(ui, image, most);
            self.difference_texture = Some((Same(Arc::clone(&made)), texture));
        }
        Some(made)
    }

    fn tiles<'a>(
        &self,
        sets: &'a [ImagesInput],
        difference: Option<&'a Result<Image, String>>,
    ) -> Vec<ImageTile<'a>> {
        let mut tiles = Vec::new();
        for (set, input) in sets.iter().enumerate() {
            let Some((key, image)) = self.image_of(input) else { continue };
            let Some(loaded) = self.loaded.iter().find(|loaded| loaded.key == key) else {
                continue;
            };
            let title = format!("{}: {}", input.title, image.name);
            tiles.push(ImageTile { title, image, texture: loaded.texture.id(), set: Some(set) });
        }
        if let (Some(Ok(image)), Some((_, texture))) = (difference, &self.difference_texture) {
            let title = format!("difference × {}", self.gain.0.round());
            tiles.push(ImageTile { title, image, texture: texture.id(), set: None });
        }
        tiles
    }

    /// All pictures of the first set, small.
    fn strip(&mut self, ui: &mut egui::Ui, sets: &[ImagesInput], most: usize) {
        let Some(set) = sets.iter().find(|set| set.images.0.len() == most) else { return };
        egui::ScrollArea::horizontal().id_salt("strip").show(ui, |ui| {
            ui.horizontal(|ui| {
                for (at, image) in set.images.0.iter().enumerate() {
                    let key = (Same(Arc::clone(&set.images)), at);
                    let Some(loaded) = self.loaded.iter().find(|known| known.key == key) else {
                        continue;
                    };
                    let sized = egui::load::SizedTexture::from_handle(&loaded.thumbnail);
                    let image_button =
                        egui::Image::from_texture(sized).max_size(vec2(96.0, STRIP - 24.0));
                    let button = egui::Button::image(image_button).selected(at == self.chosen);
                    let response = ui.add(button).on_hover_text(&image.name);
                    let label = format!("Show {}", image.name);
                    response.widget_info(|| {
                        egui::WidgetInfo::labeled(egui::WidgetType::Button, true, &label)
                    });
                    if response.clicked() {
                        self.chosen = at;
                    }
                }
            });
        });
    }
}

fn load_texture(ui: &egui::Ui, image: &Image, most: usize) -> TextureHandle {
    let options = egui::TextureOptions {
        magnification: egui::TextureFilter::Nearest,
        minification: egui::TextureFilter::Linear,
        ..egui::TextureOptions::default()
    };
    ui.ctx().load_texture(&image.name, color_image(image, most), options)
}

/// Shows one picture, with the zoom of all; whether it is to be unpinned.
fn show_tile(
    ui: &mut egui::Ui,
    zoom: &mut Zoom,
    rect: Rect,
    tile: &ImageTile,
    (first, tiles): (&Image, &[ImageTile]),
    status: &mut String,
) -> bool {
    let id = ui.id().with(("picture", &tile.title));
    let response = ui.interact(rect, id, Sense::click_and_drag());
    let label = format!("Picture {}: drag moves, wheel zooms", tile.title);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::Image, true, &label));
    let size = vec2(tile.image.width.max(1) as f32, tile.image.height.max(1) as f32);
    // All are as wide as the first, so that pictures of one thing lie over each other.
    let relative = first.width.max(1) as f32 / size.x;
    zoom.interact(ui, &response, size, relative);
    let place = zoom.place(ui, rect, size, relative);
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 0.0, ui.visuals().extreme_bg_color);
    let all = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
    painter.image(tile.texture, place, all, Color32::WHITE);
    if let Some(pointer) = response.hover_pos().filter(|at| place.contains(*at)) {
        let at: Vec2 = (pointer - place.min) / place.size() * size;
        *status = pixel_text(tiles, tile.image, [at.x as usize, at.y as usize]);
    }
    let text = format!("{}, {} × {}", tile.title, tile.image.width, tile.image.height);
    heading::caption(ui, rect, &text, tile.set.map(|_| tile.title.as_str()))
}

/// The place of a pixel and its values in all pictures of that size.
fn pixel_text(tiles: &[ImageTile], under: &Image, [x, y]: [usize; 2]) -> String {
    let mut text = format!("x {x}, y {y}");
    for tile in tiles {
        if (tile.image.width, tile.image.height) != (under.width, under.height) {
            continue;
        }
        let [r, g, b] = rgb_at(tile.image, x, y);
        let values = match tile.image.kind {
            mve_modules::data::PixelKind::Gray => r.to_string(),
            mve_modules::data::PixelKind::Rgb => format!("{r} {g} {b}"),
        };
        text += &format!("   {values}");
    }
    text
}
