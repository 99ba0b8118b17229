//! Pictures of meshes in files.

use std::path::Path;

use eframe::egui::{self, DragValue, Modal, TextEdit, Ui};

use super::Editor;
use super::files::typed_path;
use crate::views::{Still, StillOptions};

/// What is asked before a picture is saved.
pub struct PictureForm {
    path: String,
    options: StillOptions,
}

impl Default for PictureForm {
    fn default() -> Self {
        // The first name that is free.
        let names = std::iter::once("view.png".to_owned());
        let mut names = names.chain((2..).map(|n| format!("view-{n}.png")));
        let path = names.find(|name| !Path::new(name).exists()).unwrap_or_default();
        Self { path, options: StillOptions { size: [1920, 1080], is_transparent: false } }
    }
}

impl Editor {
    /// Asks where to save a picture and how large; `None` once that is decided.
    pub(super) fn picture_box(
        &mut self,
        ui: &mut Ui,
        mut form: PictureForm,
    ) -> Option<PictureForm> {
        let mut is_wanted = false;
        let shown = Modal::new("picture".into()).show(ui.ctx(), |ui| {
            ui.set_width(460.0);
            ui.heading("Save a picture of the meshes");
            let PictureForm { path, options } = &mut form;
            let field = ui.add(TextEdit::singleline(path).desired_width(f32::INFINITY));
            ui.ctx().accesskit_node_builder(field.id, |node| node.set_label("path of the picture"));
            ui.horizontal(|ui| {
                for (name, side) in ["width", "height"].into_iter().zip(&mut options.size) {
                    ui.label(name);
                    let number = ui.add(DragValue::new(side).range(16..=16384).suffix(" pixels"));
                    let name = format!("{name} of the picture");
                    ui.ctx().accesskit_node_builder(number.id, |node| node.set_label(name));
                }
            });
            ui.checkbox(&mut options.is_transparent, "Transparent background");
            if typed_path(path).exists() {
                ui.colored_label(ui.visuals().warn_fg_color, "The file is there and is replaced.");
            }
            ui.horizontal(|ui| {
                is_wanted = ui.button("Save picture").clicked();
                ui.button("Cancel").clicked()
            })
            .inner
        });
        if is_wanted && !form.path.trim().is_empty() {
            self.begin_picture(ui.ctx(), &form);
            return None;
        }
        (!shown.inner && !shown.should_close()).then_some(form)
    }

    fn begin_picture(&mut self, ctx: &egui::Context, form: &PictureForm) {
        let Some(render) = self.render.clone() else {
            return self.toast("There is no GPU, and no software in its place, to draw with.");
        };
        let mut path = typed_path(&form.path);
        if path.extension().is_none() {
            path.set_extension("png");
        }
        let session = self.session();
        let (view, pinned) = (&session.viewer.meshes, session.pinned_values());
        let still = Still::new(view, pinned, ctx, &render, form.options);
        self.stills.push((path, still));
    }

    /// Draws on pictures in the making, and writes those that are done.
    pub(super) fn go_on_with_pictures(&mut self, ctx: &egui::Context) {
        let mut said = Vec::new();
        self.stills.retain_mut(|(path, still)| {
            let Some(picture) = still.step() else { return true };
            let written = picture.and_then(|picture| {
                let format = image::ImageFormat::Png;
                picture.save_with_format(&*path, format).map_err(|error| error.to_string())
            });
            let path = std::path::absolute(&*path).unwrap_or_else(|_| path.clone());
            said.push(match written {
                Ok(()) => format!("wrote {}", path.display()),
                Err(error) => format!("{}: not written: {error}", path.display()),
            });
            false
        });
        said.into_iter().for_each(|text| self.toast(text));
        if !self.stills.is_empty() {
            ctx.request_repaint();
        }
    }
}
