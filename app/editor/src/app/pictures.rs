//! Pictures of meshes in files.

use std::path::Path;

use eframe::egui::{self, ComboBox, DragValue, Modal, TextEdit, Ui, WidgetInfo, WidgetType};

use super::Editor;
use super::files::typed_path;
use crate::document::Edit;
use crate::kept::{KeptEdit, Shelf};
use crate::views::{NamedView, Still, StillOptions};

/// What is asked before a picture is saved.
pub struct PictureForm {
    path: String,
    options: StillOptions,
    /// The kept view that it shows; `None` is what is seen.
    view: Option<String>,
    /// The name under which the view, with the size of its picture, is to be kept.
    keep_as: String,
}

impl Default for PictureForm {
    fn default() -> Self {
        // The first name that is free.
        let names = std::iter::once("view.png".to_owned());
        let mut names = names.chain((2..).map(|n| format!("view-{n}.png")));
        let path = names.find(|name| !Path::new(name).exists()).unwrap_or_default();
        let options = StillOptions { size: [1920, 1080], is_transparent: false, height: None };
        Self { path, options, view: None, keep_as: String::new() }
    }
}

impl PictureForm {
    /// Turns to a kept view, with the size that its pictures have.
    fn turn_to(&mut self, name: &str, view: &NamedView) {
        (self.view, self.keep_as) = (Some(name.to_owned()), name.to_owned());
        self.options = view.picture.unwrap_or(self.options);
        // What no system takes in a name of a file.
        let is_safe = |c: char| !c.is_control() && !r#"/\:*?"<>|"#.contains(c);
        let file: String = name.chars().map(|c| if is_safe(c) { c } else { '_' }).collect();
        self.path = format!("{}.png", file.trim_start_matches('.'));
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
            self.view_box(ui, &mut form);
            let PictureForm { path, options, keep_as, .. } = &mut form;
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
            ui.horizontal(|ui| {
                ui.label("Keep as view");
                let field = TextEdit::singleline(keep_as).hint_text("no name: not kept");
                let field = ui.add(field).on_hover_text(
                    "Camera, colors, section and size stay in the map under this name, so that the \
                     same figure can be made of other results",
                );
                ui.ctx().accesskit_node_builder(field.id, |node| node.set_label("keep as view"));
            });
            let warn = ui.visuals().warn_fg_color;
            if let Some(text) = self.of_kept_view(&form) {
                ui.colored_label(warn, text);
            }
            if typed_path(&form.path).exists() {
                ui.colored_label(warn, "The file is there and is replaced.");
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

    /// What becomes of a kept view that has the name already.
    fn of_kept_view(&self, form: &PictureForm) -> Option<String> {
        let name = form.keep_as.trim();
        let kept = self.session().document.extras().kept.on(Shelf::Views).get(name)?;
        if form.view.as_deref() != Some(name) {
            return Some(format!("The view {name} is there and is replaced."));
        }
        let known = NamedView::from_json(kept).and_then(|view| view.picture);
        let is_another = known.is_none_or(|known| {
            (known.size, known.is_transparent) != (form.options.size, form.options.is_transparent)
        });
        is_another.then(|| format!("The view {name} has pictures like this one from now on."))
    }

    /// The list of views to show.
    fn view_box(&self, ui: &mut Ui, form: &mut PictureForm) {
        let kept = self.session().document.extras().kept.on(Shelf::Views);
        let views = kept.iter().filter_map(|(name, it)| Some((name, NamedView::from_json(it)?)));
        let views: Vec<_> = views.collect();
        if views.is_empty() {
            return;
        }
        const AS_SEEN: &str = "as it is seen";
        let chosen = form.view.clone().unwrap_or_else(|| AS_SEEN.to_owned());
        ui.horizontal(|ui| {
            ui.label("View");
            let list = ComboBox::from_id_salt("view of the picture").selected_text(&chosen);
            let list = list.show_ui(ui, |ui| {
                if ui.selectable_label(form.view.is_none(), AS_SEEN).clicked() {
                    form.view = None;
                }
                for (name, view) in &views {
                    let is_chosen = form.view.as_ref() == Some(*name);
                    if ui.selectable_label(is_chosen, name.as_str()).clicked() {
                        form.turn_to(name, view);
                    }
                }
            });
            let label = format!("view of the picture: {chosen}");
            list.response.widget_info(|| WidgetInfo::labeled(WidgetType::ComboBox, true, &label));
        });
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
        let kept = session.document.extras().kept.on(Shelf::Views);
        let named = form.view.as_ref().and_then(|name| NamedView::from_json(kept.get(name)?));
        // So high that text is as large as it is now, also tomorrow in another window.
        let height = form.options.height.unwrap_or(view.height().round() as u32);
        let options = StillOptions { height: Some(height), ..form.options };
        let still = Still::new(view, pinned, ctx, &render, (options, named.as_ref()));
        let name = form.keep_as.trim().to_owned();
        if !name.is_empty() {
            let mut kept = named.unwrap_or_else(|| view.named_view());
            kept.picture = Some(options);
            let content = kept.to_json();
            let is_new =
                session.document.extras().kept.on(Shelf::Views).get(&name) != Some(&content);
            if is_new {
                self.edit(&[Edit::Keep(KeptEdit::Put { shelf: Shelf::Views, name, content })]);
            }
        }
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
