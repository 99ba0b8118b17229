//! The panel of meshes: layout, what is prepared and drawn, and what the user does with it.

use std::sync::Arc;

use eframe::egui::emath::GuiRounding;
use eframe::egui::{self, Rect, Sense, pos2};
use eframe::egui_wgpu::RenderState;
use mve_modules::data::{Images, TriMesh};

use super::captions::captions;
use super::coloring::{
    ColorBy, PinnedField, ScaleSettings, Source, Values, number_layers, source_of,
};
use super::gpu::{FINE, Gpu, Texture};
use super::hover::Hover;
use super::item::{Colors, Frame, Item};
use super::kept::MeshLook;
use super::layout::{Tile, layout, part_of};
use super::navigation::{by_keys, by_pointer};
use super::overlay::{
    BoxPart, Screen, histogram, paint_axes, paint_background, paint_box, paint_color_bar,
};
use super::palette::label_layers;
use super::pick::describe;
use super::settings::{Arrangement, Offers, Settings, controls};
use super::texture::TextureSource;
use crate::views::camera::{Bounds, Camera};
use crate::views::slot::Same;

/// A mesh to show.
#[derive(Clone, Debug)]
pub struct MeshInput {
    /// Where it comes from: `simplify.mesh`.
    pub title: String,
    /// The mesh.
    pub mesh: Arc<TriMesh>,
}

/// A picture that may be a texture.
#[derive(Clone, Debug)]
pub struct PinnedPicture {
    /// Where it comes from: `texture.images`.
    pub title: String,
    /// Holds the picture.
    pub images: Arc<Images>,
}

/// The state of a panel of meshes.
#[derive(Default)]
pub struct MeshView {
    gpu: Option<Gpu>,
    /// The camera that all meshes share.
    pub camera: Camera,
    /// What is shown and how.
    pub settings: Settings,
    items: Vec<Item>,
    /// What was fitted last into which aspect, and whether the user has moved since.
    fitted: Option<(Bounds, f64)>,
    has_moved: bool,
    /// When the camera moved last, by the clock of the window.
    moved_secs: Option<f64>,
    /// The color scale on the GPU, and how often there was another one.
    table: Option<(ScaleSettings, Texture, u64)>,
    bars: Option<Bar>,
    hover: Hover,
}

/// The spread of values beside a color bar, for one range.
struct Bar {
    values: Arc<Values>,
    range: [f64; 2],
    histogram: Vec<usize>,
}

/// Seconds after which a camera is at rest.
const REST_SECS: f64 = 0.25;

/// Bars of a histogram beside the color bar.
const N_BARS: usize = 64;

impl MeshView {
    /// Whether something is in the making.
    pub fn is_busy(&self) -> bool {
        self.items.iter().any(Item::is_busy)
    }

    /// How meshes are shown, for the next start or for another view.
    pub fn look(&self) -> MeshLook {
        MeshLook::of(&self.settings, &self.camera)
    }

    /// Shows meshes as another view did.
    pub fn set_look(&mut self, look: &MeshLook) {
        let up = self.settings.up;
        look.apply(&mut self.settings, &mut self.camera);
        if self.settings.up != up {
            self.fitted = None;
        }
    }

    /// Lets go of all meshes.
    pub fn forget_meshes(&mut self) {
        self.items.clear();
    }

    /// How many pictures were drawn so far.
    pub fn n_drawn(&self) -> u64 {
        self.items.iter().map(|item| item.n_drawn).sum()
    }

    /// Shows the meshes in the space that there is. Returns the place of a mesh that the user
    /// wants to see no longer.
    pub fn show(
        &mut self,
        ui: &mut egui::Ui,
        meshes: &[MeshInput],
        fields: &[PinnedField],
        pictures: &[PinnedPicture],
        render: Option<&RenderState>,
    ) -> Option<usize> {
        let Some(render) = render else {
            ui.label("There is no GPU, and no software in its place, to draw meshes with.");
            return None;
        };
        self.take_over(meshes);
        let offers = self.offers(meshes, fields, pictures);
        let wishes = controls(ui, &mut self.settings, &mut self.camera, &offers);
        let mut gpu = self.gpu.take().unwrap_or_else(|| Gpu::new(render));
        for (item, input) in self.items.iter_mut().zip(meshes) {
            let source = source_of(&item.mesh, &self.settings.color_by, fields);
            let source = source.unwrap_or(Source::Plain);
            let texture = match source {
                Source::Materials => Some(TextureSource::Materials(Same(Arc::clone(&input.mesh)))),
                Source::Picture => pinned_picture(&self.settings.color_by, pictures),
                _ => None,
            };
            item.prepare(ui.ctx(), &gpu, (source, texture), &self.settings);
        }
        let unpinned = self.panel(ui, meshes, &mut gpu, wishes.is_fit);
        self.gpu = Some(gpu);
        unpinned
    }

    /// Keeps what belongs to meshes that are still there.
    fn take_over(&mut self, meshes: &[MeshInput]) {
        let mut known = std::mem::take(&mut self.items);
        for input in meshes {
            let at = known.iter().position(|item| Arc::ptr_eq(&item.mesh, &input.mesh));
            let item = at.map(|at| known.swap_remove(at));
            self.items.push(item.unwrap_or_else(|| Item::new(Arc::clone(&input.mesh))));
        }
        for at in &mut self.settings.pair {
            *at = (*at).min(meshes.len().saturating_sub(1));
        }
        if self.settings.pair[0] == self.settings.pair[1] && meshes.len() > 1 {
            self.settings.pair[1] = usize::from(self.settings.pair[0] == 0);
        }
    }

    fn offers(
        &self,
        meshes: &[MeshInput],
        fields: &[PinnedField],
        pictures: &[PinnedPicture],
    ) -> Offers {
        let mut color_by: Vec<(ColorBy, String)> = vec![
            (ColorBy::Auto, "Automatic".to_owned()),
            (ColorBy::Plain, "Plain".to_owned()),
            (ColorBy::Colors, "Colors of the mesh".to_owned()),
        ];
        for field in fields {
            color_by.push((ColorBy::Field(field.title.clone()), field.title.clone()));
        }
        for layer in meshes.iter().flat_map(|input| number_layers(&input.mesh)) {
            color_by.push((ColorBy::Layer(layer.name.clone()), format!("Layer {}", layer.name)));
        }
        for layer in meshes.iter().flat_map(|input| label_layers(&input.mesh)) {
            color_by.push((ColorBy::Labels(layer.name.clone()), format!("By {}", layer.name)));
        }
        color_by.push((ColorBy::Materials, "Texture of the material".to_owned()));
        color_by.push((ColorBy::Checker, "Squares in texture space".to_owned()));
        for picture in pictures {
            let text = format!("Texture {}", picture.title);
            color_by.push((ColorBy::Picture(picture.title.clone()), text));
        }
        let mut known: Vec<ColorBy> = Vec::new();
        color_by.retain(|(by, _)| {
            let is_first = !known.contains(by);
            known.push(by.clone());
            let has = |input: &MeshInput| source_of(&input.mesh, by, fields).is_some();
            is_first && (*by == ColorBy::Auto || meshes.iter().any(has))
        });
        Offers {
            titles: meshes.iter().map(|input| input.title.clone()).collect(),
            color_by,
            has_scalar: self.items.iter().any(|item| values_of(item).is_some()),
        }
    }

    fn panel(
        &mut self,
        ui: &mut egui::Ui,
        meshes: &[MeshInput],
        gpu: &mut Gpu,
        is_fit: bool,
    ) -> Option<usize> {
        let whole = ui.available_rect_before_wrap();
        ui.allocate_rect(whole, Sense::hover());
        // On whole pixels, as the pictures are.
        let whole = whole.round_to_pixels(ui.pixels_per_point());
        if !(whole.width() >= 4.0 && whole.height() >= 4.0) || meshes.is_empty() {
            return None;
        }
        let is_dark = ui.visuals().dark_mode;
        paint_background(&ui.painter_at(whole), whole, is_dark);
        let values: Vec<Arc<Values>> = self.items.iter().filter_map(values_of).collect();
        let range = self.settings.scale.range(values.iter().map(AsRef::as_ref));
        let (mut tiles, bar) = layout(whole, &self.settings, meshes.len(), !values.is_empty());
        for tile in &mut tiles {
            tile.rect = tile.rect.round_to_pixels(ui.pixels_per_point());
        }
        let is_overlaid = self.settings.arrangement != Arrangement::SideBySide && tiles.len() == 2;
        let bounds = self.items.iter().filter_map(Item::bounds).reduce(Bounds::with);
        let responses = self.responses(ui, meshes, &tiles, is_overlaid);
        let is_moving = match (bounds, tiles.first()) {
            (Some(bounds), Some(tile)) => self.navigate(ui, &responses, tile.rect, &bounds, is_fit),
            _ => false,
        };
        if let Some(bounds) = &bounds {
            self.color_table(gpu);
            // Pictures made by the processor are rougher in motion, and made well at rest.
            let is_rough = gpu.is_software() && self.is_in_motion(ui, &responses, is_moving);
            let samples = if is_rough { 1 } else { FINE };
            self.draw(ui, gpu, &tiles, bounds, range, samples);
        }
        self.show_hover(ui, &responses, &tiles, bounds.as_ref());
        if let (Some(bar), Some(values)) = (bar, values.first()) {
            self.show_bar(ui, bar, range, values);
        }
        captions(ui, meshes, &tiles, &self.items, &mut self.settings)
    }

    /// Takes in what pointer and keys do; whether the camera moves.
    fn navigate(
        &mut self,
        ui: &egui::Ui,
        responses: &[egui::Response],
        rect: Rect,
        bounds: &Bounds,
        is_fit: bool,
    ) -> bool {
        let aspect = Screen { rect }.aspect();
        if self.is_other_scene(bounds, aspect) {
            self.fit(bounds, aspect);
        }
        let before = self.camera;
        let (camera, settings) = (&mut self.camera, &mut self.settings);
        let mut moved = by_keys(ui, responses, aspect, camera, bounds, settings);
        for response in responses {
            let screen = Screen { rect: response.rect };
            let by = by_pointer(ui, response, &screen, &mut self.camera, bounds);
            moved.is_fit |= by.is_fit;
            moved.is_moving |= by.is_moving;
        }
        moved.is_moving |= self.camera != before;
        self.has_moved |= self.camera != before;
        if moved.is_fit || is_fit {
            self.fit(bounds, aspect);
        }
        moved.is_moving
    }

    /// Whether the camera moves, or has moved so shortly ago that it may do so again.
    fn is_in_motion(
        &mut self,
        ui: &egui::Ui,
        responses: &[egui::Response],
        is_moving: bool,
    ) -> bool {
        let now = ui.input(|input| input.time);
        if is_moving || responses.iter().any(egui::Response::dragged) {
            self.moved_secs = Some(now);
        }
        let is_in_motion = self.moved_secs.is_some_and(|moved| now - moved < REST_SECS);
        if is_in_motion {
            ui.ctx().request_repaint_after(std::time::Duration::from_secs_f64(REST_SECS));
        }
        is_in_motion
    }

    fn fit(&mut self, bounds: &Bounds, aspect: f64) {
        self.camera.up = self.settings.up.unwrap_or_else(|| bounds.up());
        self.camera.fit(bounds, aspect);
        self.fitted = Some((*bounds, aspect));
        self.has_moved = false;
    }

    /// Whether what is shown is too different from what was fitted for the camera to stay. One
    /// that the user has placed stays for results of another run.
    fn is_other_scene(&self, bounds: &Bounds, aspect: f64) -> bool {
        let Some((fitted, fitted_aspect)) = &self.fitted else { return true };
        if !self.has_moved {
            return fitted != bounds || *fitted_aspect != aspect;
        }
        let (old, new) = (fitted.radius(), bounds.radius());
        let moved = (fitted.center() - bounds.center()).abs().max_element();
        moved > old || new > 2.0 * old || old > 2.0 * new
    }

    fn responses(
        &self,
        ui: &egui::Ui,
        meshes: &[MeshInput],
        tiles: &[Tile],
        is_overlaid: bool,
    ) -> Vec<egui::Response> {
        let shown = if is_overlaid { &tiles[..1] } else { tiles };
        let respond = |tile: &Tile| {
            let id = ui.id().with(("mesh picture", tile.item));
            let response = ui.interact(tile.rect, id, Sense::click_and_drag());
            let title = &meshes[tile.item].title;
            let label =
                format!("3D view of {title}: drag turns, shift and drag moves, wheel zooms");
            response
                .widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::Image, true, &label));
            response
        };
        shown.iter().map(respond).collect()
    }

    /// Uploads the color scale when it has changed.
    fn color_table(&mut self, gpu: &Gpu) {
        let scale = self.settings.scale;
        let same_colors =
            |old: &ScaleSettings| (old.scale, old.is_reversed) == (scale.scale, scale.is_reversed);
        if !self.table.as_ref().is_some_and(|(old, ..)| same_colors(old)) {
            let number = self.table.as_ref().map_or(0, |(.., number)| number + 1);
            self.table = Some((scale, gpu.table(&scale.table()), number));
        }
    }

    fn draw(
        &mut self,
        ui: &egui::Ui,
        gpu: &mut Gpu,
        tiles: &[Tile],
        bounds: &Bounds,
        range: [f64; 2],
        samples: u32,
    ) {
        let Some((_, table, table_number)) = &self.table else { return };
        let colors = Colors { table: (table, *table_number), range };
        let points = ui.ctx().pixels_per_point();
        let most = gpu.max_texture_side() as f32;
        let line_color = ui.visuals().weak_text_color();
        for (at, tile) in tiles.iter().enumerate() {
            let pixels = |length: f32| (length * points).round().clamp(1.0, most) as u32;
            let size = [pixels(tile.rect.width()), pixels(tile.rect.height())];
            let frame = Frame { camera: &self.camera, bounds, size, samples };
            let item = &mut self.items[tile.item];
            let screen = Screen { rect: tile.rect };
            let (clip, tint) = part_of(tile.rect, &self.settings, at, tiles.len());
            let painter = ui.painter_at(clip);
            let has_box = self.settings.has_box && item.bounds().is_some();
            let around = item.bounds().unwrap_or(*bounds);
            if has_box {
                let part = BoxPart::Behind;
                paint_box(&painter, &screen, &self.camera, &around, part, line_color);
            }
            if let Some(target) = item.picture(gpu, &self.settings, &colors, &frame) {
                let all = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
                painter.image(target.id(), tile.rect, all, tint);
            }
            if item.is_drawing() {
                ui.ctx().request_repaint();
            }
            if has_box {
                let part = BoxPart::Ahead;
                paint_box(&painter, &screen, &self.camera, &around, part, line_color);
            }
        }
        if let (true, Some(tile)) = (self.settings.has_axes, tiles.first()) {
            paint_axes(&ui.painter_at(tile.rect), tile.rect, &self.camera);
        }
    }

    fn show_bar(&mut self, ui: &egui::Ui, rect: Rect, range: [f64; 2], values: &Arc<Values>) {
        let is_known = |bar: &Bar| Arc::ptr_eq(&bar.values, values) && bar.range == range;
        if !self.bars.as_ref().is_some_and(is_known) {
            let histogram = histogram(&values.values, range, N_BARS);
            self.bars = Some(Bar { values: Arc::clone(values), range, histogram });
        }
        if let Some(bar) = &self.bars {
            paint_color_bar(ui, rect, &self.settings.scale, range, values, &bar.histogram);
        }
    }

    /// Says what is under a pointer at rest.
    fn show_hover(
        &mut self,
        ui: &egui::Ui,
        responses: &[egui::Response],
        tiles: &[Tile],
        bounds: Option<&Bounds>,
    ) {
        let place = responses.iter().enumerate().find_map(|(at, response)| {
            let place = response.hover_pos().filter(|_| response.hovered())?;
            Some((at, place))
        });
        let (Some((at, place)), Some(bounds)) = (place, bounds) else {
            self.hover.forget();
            return;
        };
        let item = self.visible_item(tiles, at, place);
        let screen = Screen { rect: responses[at].rect };
        let ray = self.camera.ray(screen.normalized(place), screen.aspect(), bounds);
        let item = &self.items[item];
        let Some(hit) = self.hover.at(ui, &item.mesh, ray) else { return };
        let text = describe(&item.mesh, &hit, values_of(item).as_deref());
        let (id, anchor) = (responses[at].id.with("read-out"), egui::PopupAnchor::Pointer);
        egui::Tooltip::always_open(ui.ctx().clone(), ui.layer_id(), id, anchor)
            .gap(14.0)
            .show(|ui| ui.label(text));
    }

    /// The item that is seen at a place of a picture.
    fn visible_item(&self, tiles: &[Tile], at: usize, place: egui::Pos2) -> usize {
        let is_wipe = self.settings.arrangement == Arrangement::Wipe && tiles.len() == 2;
        let rect = tiles[at].rect;
        let is_right = place.x > rect.left() + self.settings.balance * rect.width();
        tiles[if is_wipe && is_right { 1 } else { at }].item
    }
}

/// The picture that is chosen as a texture.
fn pinned_picture(by: &ColorBy, pictures: &[PinnedPicture]) -> Option<TextureSource> {
    let is_chosen = |picture: &&PinnedPicture| *by == ColorBy::Picture(picture.title.clone());
    let picture = pictures.iter().find(is_chosen)?;
    Some(TextureSource::Pinned(Same(Arc::clone(&picture.images))))
}

fn values_of(item: &Item) -> Option<Arc<Values>> {
    let prepared = item.prepared()?;
    prepared.as_ref().as_ref().ok()?.values.clone()
}
