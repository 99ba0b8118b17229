//! The panel of meshes: layout, what is prepared and drawn, and what the user does with it.

use std::sync::Arc;

use eframe::egui::emath::GuiRounding;
use eframe::egui::{self, Rect, Sense, Vec2, pos2};
use eframe::egui_wgpu::RenderState;
use mve_core::Value;
use mve_modules::data::{Field, Images, TriMesh};

use super::backdrop::paint_background;
use super::distance::Distance;
use super::gpu::Gpu;
use super::gpu::target::FINE;
use super::gpu::texture::GpuTexture;
use super::hand::navigation::{Moved, by_keys, by_pointer, responses};
use super::item::MeshItem;
use super::layout::{Tile, layout, part_of};
use super::look::coloring::{ColorBy, ColorSource, PinnedField, ScaleSettings, source_of};
use super::look::controls::{Controls, Offers, Wishes, controls};
use super::look::named::{NamedView, StillOptions};
use super::look::settings::{Arrangement, MeshSettings};
use super::look::stored::MeshLook;
use super::look::texture::TextureSource;
use super::look::values::Values;
use super::offers::{offers, pinned_picture};
use super::outline::outline_color;
use super::overlays::{Depth, Overlays};
use super::placing::Placing;
use super::scene::{MeshInput, MeshPicture, MeshScene, PinnedPicture, Screen, Subject};
use super::section::{Plane, Section};
use super::viewpoint::{Viewpoint, is_each_fitted, viewpoints};
use super::viewport::{Colors, ShownOutline, Viewport};
use crate::kept::{Kept, Shelf};
use crate::views::camera::{Bounds, Camera};
use crate::views::field::colors_a_mesh;
use crate::views::memo::Same;
use crate::views::{PanelPlace, PickedElement, Pinned, ValueView, ViewInput, ViewerAction};

/// The state of a panel of meshes.
#[derive(Default)]
pub struct MeshView {
    gpu: Option<Gpu>,
    /// The camera that all meshes share.
    pub camera: Camera,
    /// What is shown and how.
    pub settings: MeshSettings,
    items: Vec<MeshItem>,
    placing: Placing,
    /// The section in the frame before.
    cut_before: Section,
    /// When the camera moved last, by the clock of the window.
    moved_secs: Option<f64>,
    /// The color scale on the GPU, and how often there was another one.
    table: Option<(ScaleSettings, GpuTexture, u64)>,
    overlays: Overlays,
    controls: Controls,
    /// What is kept with the map.
    kept: Kept,
    /// Width and height of the pictures in points when they were shown last.
    size: Vec2,
    /// Where it is no part of a window, but a picture for a file.
    still: Option<StillOptions>,
}

/// Seconds after which a camera is at rest.
const REST_SECS: f64 = 0.25;

impl ValueView for MeshView {
    fn place(&self) -> PanelPlace {
        PanelPlace::Column("meshes")
    }

    fn takes(&self, value: &Value, _all: &[Pinned]) -> bool {
        value.get::<TriMesh>().is_some()
    }

    fn show(&mut self, ui: &mut egui::Ui, shown: &ViewInput) -> Vec<ViewerAction> {
        let mesh = |&(place, pinned): &(usize, &Pinned)| {
            let mesh = pinned.value.as_ref()?.get::<TriMesh>()?;
            Some(MeshInput { place, title: pinned.title.clone(), mesh })
        };
        let meshes: Vec<MeshInput> = shown.values.iter().filter_map(mesh).collect();
        let field = |pinned: &Pinned| {
            let field = pinned.value.as_ref()?.get::<Field>()?;
            let title = pinned.title.clone();
            colors_a_mesh(&field, shown.all).then_some(PinnedField { title, field })
        };
        let fields: Vec<PinnedField> = shown.all.iter().filter_map(field).collect();
        let picture = |pinned: &Pinned| {
            let images = pinned.value.as_ref()?.get::<Images>()?;
            Some(PinnedPicture { title: pinned.title.clone(), images })
        };
        let pictures: Vec<PinnedPicture> = shown.all.iter().filter_map(picture).collect();
        let (meshes, fields, pictures) = (&meshes, &fields, &pictures);
        let subject = Subject { meshes, fields, pictures, picked: shown.picked };
        self.show_meshes(ui, &subject, shown.render)
    }

    /// Lets go of all meshes, and of what is on the GPU.
    fn forget(&mut self) {
        self.items.clear();
        self.overlays = Overlays::default();
    }

    fn is_busy(&self) -> bool {
        self.items.iter().any(MeshItem::is_busy)
            || self.overlays.is_busy()
            || self.placing.is_busy()
    }
}

impl MeshView {
    /// How meshes are shown, for the next start or for another view.
    pub fn look(&self) -> MeshLook {
        MeshLook::of(&self.settings, &self.camera)
    }

    /// Turns an element of a mesh to the middle and the front, once its place is found.
    pub fn go_to(&mut self, context: &egui::Context, element: PickedElement, mesh: Arc<TriMesh>) {
        self.placing.go_to(context, element, mesh);
    }

    fn arrive(&mut self, context: &egui::Context, meshes: &[MeshInput]) {
        let Some((element, (point, towards))) = self.placing.arrived() else { return };
        let place = meshes.iter().position(|mesh| mesh.title == element.title);
        let own = place.and_then(|place| self.items[place].bounds()).zip(self.bounds());
        let own = own.filter(|_| is_each_fitted(&self.settings, &self.items));
        // Seen in a scale of its own, it is looked at as if it were in that of all.
        let mut camera = own.map_or(self.camera, |(own, all)| self.camera.carried(&all, &own));
        camera.look_at(point, towards);
        self.camera = own.map_or(camera, |(own, all)| camera.carried(&own, &all));
        self.placing.has_moved = true;
        context.request_repaint();
    }

    /// Height of the pictures in points when they were shown last.
    pub fn height(&self) -> f32 {
        self.size.y
    }

    /// A view of the same, or as a kept view has it, without what is there for a hand.
    pub fn for_still(&self, options: StillOptions, named: Option<&NamedView>) -> Self {
        let mut view = Self {
            camera: self.camera,
            settings: self.settings.clone(),
            placing: self.placing.for_still(named.is_some()),
            still: Some(options),
            ..Self::default()
        };
        named.into_iter().for_each(|named| view.look_as(named));
        view
    }

    /// The way that it looks, to be kept.
    pub fn named_view(&self) -> NamedView {
        NamedView::of(&self.settings, &self.camera)
    }

    /// Looks in a way that was kept.
    pub fn look_as(&mut self, named: &NamedView) {
        named.apply(&mut self.settings, &mut self.camera);
        self.placing.has_moved = true;
    }

    /// Takes over what is kept with the map.
    pub fn set_kept(&mut self, kept: &Kept) {
        if self.kept != *kept {
            self.kept.clone_from(kept);
            self.settings.distances = Distance::all(kept);
        }
    }

    /// Shows meshes as another view did.
    pub fn set_look(&mut self, look: &MeshLook) {
        look.apply(&mut self.settings, &mut self.camera);
    }

    /// How many pictures were drawn so far.
    pub fn n_drawn(&self) -> u64 {
        self.items.iter().map(|item| item.n_drawn).sum()
    }

    /// Shows the meshes in the space that there is.
    fn show_meshes(
        &mut self,
        ui: &mut egui::Ui,
        subject: &Subject,
        render: Option<&RenderState>,
    ) -> Vec<ViewerAction> {
        let Some(render) = render else {
            ui.label("There is no GPU, and no software in its place, to draw meshes with.");
            return Vec::new();
        };
        self.take_over(subject.meshes);
        self.arrive(ui.ctx(), subject.meshes);
        let offers = self.offers(subject);
        let color_by = offers.in_force(&self.settings.color_by);
        let mut wishes = Wishes::default();
        if self.still.is_none() {
            let looked_at = (&mut self.settings, &mut self.camera);
            wishes = controls(ui, &mut self.controls, looked_at, &offers);
        }
        if let Some(named) = &wishes.view {
            self.look_as(named);
        }
        let mut gpu = self.gpu.take().unwrap_or_else(|| Gpu::new(render));
        self.prepare(ui, &gpu, subject, &color_by);
        let mut actions = self.panel(ui, subject, &mut gpu, &wishes);
        self.gpu = Some(gpu);
        actions.extend(wishes.is_picture.then_some(ViewerAction::TakePicture));
        if !wishes.kept.is_empty() {
            actions.push(ViewerAction::Keep(wishes.kept));
        }
        actions.extend(wishes.faults.into_iter().map(ViewerAction::Say));
        actions
    }

    /// Sees to it that what is seen of the meshes is made and uploaded.
    fn prepare(&mut self, ui: &egui::Ui, gpu: &Gpu, subject: &Subject, color_by: &ColorBy) {
        let lines = self.overlays.lines(&mut self.settings);
        let plane = self.plane();
        for (item, input) in self.items.iter_mut().zip(subject.meshes) {
            let source = source_of(&item.mesh, color_by, subject.fields);
            let source = source.unwrap_or(ColorSource::Plain);
            let texture = match source {
                ColorSource::Materials => {
                    Some(TextureSource::Materials(Same(Arc::clone(&input.mesh))))
                }
                ColorSource::Picture => pinned_picture(color_by, subject.pictures),
                _ => None,
            };
            item.prepare(ui.ctx(), gpu, (source, texture), (&self.settings, &lines));
            if let Some(plane) = &plane {
                item.prepare_outline(ui.ctx(), gpu, plane);
            }
        }
    }

    /// The box around all meshes, once it is known.
    fn bounds(&self) -> Option<Bounds> {
        self.items.iter().filter_map(MeshItem::bounds).reduce(Bounds::with)
    }

    /// The plane that cuts the meshes.
    fn plane(&self) -> Option<Plane> {
        self.settings.section.plane(&self.bounds()?)
    }

    fn offers(&self, subject: &Subject) -> Offers {
        let views = self.kept.on(Shelf::Views).iter();
        let view = |(name, it): (&String, _)| Some((name.clone(), NamedView::from_json(it)?));
        Offers {
            switches: self.overlays.switches(),
            range: self.range(),
            views: views.filter_map(view).collect(),
            bounds: self.bounds(),
            is_one_scale: !is_each_fitted(&self.settings, &self.items),
            ..offers(subject.meshes, subject.fields, subject.pictures)
        }
    }

    /// Keeps what belongs to meshes that are still there.
    fn take_over(&mut self, meshes: &[MeshInput]) {
        let mut known = std::mem::take(&mut self.items);
        for input in meshes {
            let at = known.iter().position(|item| Arc::ptr_eq(&item.mesh, &input.mesh));
            let item = at.map(|at| known.swap_remove(at));
            self.items.push(item.unwrap_or_else(|| MeshItem::new(Arc::clone(&input.mesh))));
        }
        for at in &mut self.settings.pair {
            *at = (*at).min(meshes.len().saturating_sub(1));
        }
        if self.settings.pair[0] == self.settings.pair[1] && meshes.len() > 1 {
            self.settings.pair[1] = usize::from(self.settings.pair[0] == 0);
        }
    }

    /// The values at the ends of the color scale, where some mesh is colored by values.
    pub fn range(&self) -> Option<[f64; 2]> {
        let values: Vec<Arc<Values>> = self.items.iter().filter_map(MeshItem::values).collect();
        let scale = &self.settings.scale;
        let range = scale.range(values.iter().map(AsRef::as_ref));
        (!values.is_empty()).then(|| range.map(|number| scale.spacing.back(number)))
    }

    fn panel(
        &mut self,
        ui: &mut egui::Ui,
        subject: &Subject,
        gpu: &mut Gpu,
        wishes: &Wishes,
    ) -> Vec<ViewerAction> {
        let meshes = subject.meshes;
        let whole = ui.available_rect_before_wrap();
        ui.allocate_rect(whole, Sense::hover());
        // On whole pixels, as the pictures are.
        let whole = whole.round_to_pixels(ui.pixels_per_point());
        if !(whole.width() >= 4.0 && whole.height() >= 4.0) || meshes.is_empty() {
            return Vec::new();
        }
        self.size = whole.size();
        if self.still.is_none_or(|still| !still.is_transparent) {
            paint_background(&ui.painter_at(whole), whole, ui.visuals().dark_mode);
        }
        let values: Vec<Arc<Values>> = self.items.iter().filter_map(MeshItem::values).collect();
        let range = self.settings.scale.range(values.iter().map(AsRef::as_ref));
        let (mut tiles, bar) = layout(whole, &self.settings, meshes.len(), !values.is_empty());
        let points = ui.pixels_per_point();
        tiles.iter_mut().for_each(|tile| tile.rect = tile.rect.round_to_pixels(points));
        let is_overlaid = self.settings.arrangement != Arrangement::SideBySide && tiles.len() == 2;
        let bounds = self.bounds();
        let responses = responses(ui, meshes, &tiles, is_overlaid);
        let moved = match (bounds, tiles.first()) {
            (Some(bounds), Some(tile)) => {
                self.navigate(ui, &responses, (&tiles, tile.rect), &bounds, wishes.is_fit)
            }
            _ => Moved::default(),
        };
        let mut seen_from = Vec::new();
        if let Some(bounds) = &bounds {
            self.color_table(gpu);
            // Pictures made by the processor are rougher in motion, and made well at rest.
            let is_moving = self.is_in_motion(ui, &responses, moved.is_moving);
            let is_rough = is_moving && gpu.is_software() && self.still.is_none();
            let samples = if is_rough { 1 } else { FINE };
            seen_from = viewpoints(&tiles, &self.items, &self.settings, (self.camera, *bounds));
            self.draw(ui, gpu, (&tiles, &seen_from), range, samples);
        }
        let plane = self.plane();
        let mut scene = MeshScene {
            meshes,
            items: &self.items,
            tiles: &tiles,
            responses: &responses,
            viewpoints: &seen_from,
            settings: &mut self.settings,
            bar,
            values: &values,
            range,
            fields: subject.fields,
            plane,
            picked: subject.picked,
            is_number: moved.is_number || wishes.is_number,
            kept: &self.kept,
            is_still: self.still.is_some(),
            look_at: None,
            actions: Vec::new(),
        };
        self.overlays.show(ui, &mut scene);
        let (look_at, actions) = (scene.look_at, scene.actions);
        if let Some((element, mesh)) = look_at {
            self.go_to(ui.ctx(), element, mesh);
        }
        actions
    }

    /// Takes in what pointer and keys do.
    fn navigate(
        &mut self,
        ui: &egui::Ui,
        responses: &[egui::Response],
        (tiles, rect): (&[Tile], Rect),
        bounds: &Bounds,
        is_fit: bool,
    ) -> Moved {
        let aspect = Screen { rect }.aspect();
        if self.placing.is_other_scene(bounds, aspect) {
            self.fit(bounds, aspect);
            self.settings.section.fit(bounds);
        }
        let before = self.camera;
        let (camera, settings) = (&mut self.camera, &mut self.settings);
        let switches = self.overlays.switches();
        let mut moved = by_keys(ui, responses, aspect, camera, bounds, (settings, &switches));
        let seen_from = viewpoints(tiles, &self.items, &self.settings, (self.camera, *bounds));
        for (response, seen) in responses.iter().zip(seen_from) {
            let screen = Screen { rect: response.rect };
            let unit = seen.bounds.radius() / bounds.radius();
            let plane = (bounds, &mut self.settings.section, unit);
            let by = by_pointer(ui, response, &screen, &mut self.camera, plane);
            moved.is_fit |= by.is_fit;
            moved.is_moving |= by.is_moving;
        }
        let cut_before = std::mem::replace(&mut self.cut_before, self.settings.section);
        moved.is_moving |= self.camera != before || self.settings.section != cut_before;
        self.placing.has_moved |= self.camera != before;
        if moved.is_fit || is_fit {
            self.fit(bounds, aspect);
        }
        moved
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
        self.placing.fit(&mut self.camera, bounds, aspect);
    }

    /// Uploads the color scale when it has changed.
    fn color_table(&mut self, gpu: &Gpu) {
        let scale = self.settings.scale;
        let same_colors =
            |old: &ScaleSettings| (old.scale, old.is_reversed) == (scale.scale, scale.is_reversed);
        if !self.table.as_ref().is_some_and(|(old, ..)| same_colors(old)) {
            let number = self.table.as_ref().map_or(0, |(.., number)| number + 1);
            self.table = Some((
                scale,
                GpuTexture::of_colors(gpu.device(), gpu.queue(), &scale.table()),
                number,
            ));
        }
    }

    fn draw(
        &mut self,
        ui: &egui::Ui,
        gpu: &mut Gpu,
        (tiles, viewpoints): (&[Tile], &[Viewpoint]),
        range: [f64; 2],
        samples: u32,
    ) {
        let Some((_, table, table_number)) = &self.table else { return };
        let colors = Colors { table: (table, *table_number), range };
        let points = ui.ctx().pixels_per_point();
        let most = gpu.max_texture_side() as f32;
        let line_color = ui.visuals().weak_text_color();
        let plane = self.plane();
        for (at, (tile, Viewpoint { camera, bounds })) in tiles.iter().zip(viewpoints).enumerate() {
            let pixels = |length: f32| (length * points).round().clamp(1.0, most) as u32;
            let size = [pixels(tile.rect.width()), pixels(tile.rect.height())];
            let viewport = Viewport {
                camera,
                bounds,
                size,
                samples,
                pixels_per_point: points,
                plane,
                outlines: &self.outlines(tile.item),
            };
            let item = &mut self.items[tile.item];
            let (clip, tint) = part_of(tile.rect, &self.settings, at, tiles.len());
            let picture = MeshPicture {
                painter: ui.painter_at(clip),
                screen: Screen { rect: tile.rect },
                camera,
                bounds: item.bounds(),
                line_color,
                is_above: self.settings.arrangement == Arrangement::Blend
                    && tiles.len() == 2
                    && at == 1,
            };
            self.overlays.paint(Depth::Behind, &picture, &mut self.settings);
            if let Some(target) = item.picture(gpu, &self.settings, &colors, &viewport) {
                let all = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
                picture.painter.image(target.id(), tile.rect, all, tint);
            }
            if item.is_drawing() {
                ui.ctx().request_repaint();
            }
            self.overlays.paint(Depth::Ahead, &picture, &mut self.settings);
        }
    }

    /// The outlines in the picture of a mesh; where it is by itself, its own over the others.
    fn outlines(&self, own: usize) -> Vec<ShownOutline> {
        let section = &self.settings.section;
        if !section.is_on {
            return Vec::new();
        }
        let is_beside = self.settings.arrangement == Arrangement::SideBySide;
        let mut all: Vec<usize> = (0..self.items.len()).collect();
        all.retain(|at| *at == own || section.has_all_outlines);
        // Over each other pictures have them in one order, for they are seen as one.
        all.sort_by_key(|at| is_beside && *at == own);
        let all = all.into_iter();
        all.filter_map(|at| self.items[at].outline(outline_color(at))).collect()
    }
}
