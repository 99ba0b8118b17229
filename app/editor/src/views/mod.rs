//! What a window shows of a value: one view for each data type, no code for any module.
//!
//! A [`Viewer`] shows the values that are pinned to it together: meshes with one camera, pictures
//! with one zoom, measures in one table. Work that takes longer than a frame is done on threads of
//! its own, and values stay shown as they were until what replaces them is there.
//!
//! **Invariant: a mesh is uploaded once and drawn only when something changed.** So a window with a
//! large mesh in it costs nothing while the user works elsewhere, even without a GPU.

mod background;
mod camera;
mod field;
mod images;
mod images_zoom;
mod measures;
mod mesh;
mod number;
mod picture;
mod slot;
mod table;
mod table_plot;
mod values;
mod wheel;

#[cfg(test)]
mod tests;

use std::sync::Arc;
use std::time::{Duration, Instant};

use eframe::egui::{self, Rect, pos2};
use eframe::egui_wgpu::RenderState;
use mve_core::{Scalar, Value};
use mve_modules::data::{Field, Images, Measures, TriMesh};

pub use camera::{Camera, Projection, StandardView, UpAxis};
pub use mesh::{
    Arrangement, BackFaces, ColorBy, MeshLook, MeshView, ScaleSettings, Settings, Spacing,
};
pub use number::{brief_text, count_text, number_text};
pub use table::{Column, Direction, Table, TableView};

use field::FieldView;
use images::{ImagesInput, ImagesView};
use measures::{MeasuresInput, MeasuresTable};
use mesh::{MeshInput, PinnedField, PinnedPicture};

/// How long a value may be old before that is said.
const OUTDATED: Duration = Duration::from_millis(700);

/// How fresh the value of a port is, and why there is none.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum PortState {
    /// The value is that of the map as it is.
    #[default]
    Ready,
    /// The value is that of an earlier run.
    Outdated,
    /// There is no value, for this reason: `not run yet`.
    Absent(String),
}

/// A port that a viewer shows.
#[derive(Clone, Debug)]
pub struct Pinned {
    /// Node and port: `simplify.mesh`.
    pub title: String,
    /// Its value, if there is one.
    pub value: Option<Value>,
    /// How fresh it is, or why there is none.
    pub state: PortState,
}

/// What the user wants of whoever shows the viewer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ViewerAction {
    /// To see the value at this place of the list no longer.
    Unpin(usize),
}

/// The state of one panel that shows values.
#[derive(Default)]
pub struct Viewer {
    /// The meshes, for whoever wants to set camera or colors.
    pub meshes: MeshView,
    images: ImagesView,
    fields: Vec<(String, FieldView)>,
    measures: MeasuresTable,
    table: TableView,
    /// Since when some value is of an earlier run.
    outdated_since: Option<Instant>,
}

/// The pinned values by how they are shown, each with its place in the list.
#[derive(Default)]
struct Sorted {
    meshes: Vec<(usize, MeshInput)>,
    /// Fields that color one of the meshes.
    colors: Vec<(usize, PinnedField)>,
    /// Fields by themselves.
    fields: Vec<(usize, PinnedField)>,
    images: Vec<(usize, ImagesInput)>,
    measures: Vec<(usize, MeasuresInput)>,
    scalars: Vec<(usize, String, Scalar)>,
    others: Vec<(usize, String, Value)>,
    absent: Vec<(usize, String, String)>,
    outdated: Vec<String>,
}

impl Sorted {
    fn of(pinned: &[Pinned]) -> Self {
        let mut sorted = Self::default();
        for (at, pinned) in pinned.iter().enumerate() {
            sorted.add(at, pinned);
        }
        let (colors, fields) = std::mem::take(&mut sorted.fields).into_iter().partition(
            |(_, pinned): &(usize, PinnedField)| {
                let fits = |mesh: &TriMesh| pinned.field.check_fits(mesh).is_ok();
                sorted.meshes.iter().any(|(_, input)| fits(&input.mesh))
            },
        );
        (sorted.colors, sorted.fields) = (colors, fields);
        sorted
    }

    fn add(&mut self, at: usize, pinned: &Pinned) {
        let title = pinned.title.clone();
        let Some(value) = &pinned.value else {
            let reason = match &pinned.state {
                PortState::Absent(reason) => reason.clone(),
                PortState::Ready | PortState::Outdated => "no value".to_owned(),
            };
            self.absent.push((at, title, reason));
            return;
        };
        if pinned.state == PortState::Outdated {
            self.outdated.push(title.clone());
        }
        if let Some(mesh) = value.get::<TriMesh>() {
            self.meshes.push((at, MeshInput { title, mesh }));
        } else if let Some(field) = value.get::<Field>() {
            self.fields.push((at, PinnedField { title, field }));
        } else if let Some(images) = value.get::<Images>() {
            self.images.push((at, ImagesInput { title, images }));
        } else if let Some(measures) = value.get::<Measures>() {
            self.measures.push((at, MeasuresInput { title, measures }));
        } else if let Some(scalar) = value.scalar() {
            self.scalars.push((at, title, scalar));
        } else {
            self.others.push((at, title, value.clone()));
        }
    }
}

/// The parts of a panel that share its width.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Part {
    Meshes,
    Images,
    Tables,
}

impl Viewer {
    /// A viewer that has shown nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Whether something is in the making that will change the picture.
    pub fn is_busy(&self) -> bool {
        self.meshes.is_busy()
            || self.images.is_busy()
            || self.fields.iter().any(|(_, view)| view.is_busy())
    }

    /// Shows the values in the space that there is. Without `render` meshes cannot be drawn.
    pub fn show(
        &mut self,
        ui: &mut egui::Ui,
        pinned: &[Pinned],
        render: Option<&RenderState>,
    ) -> Option<ViewerAction> {
        if pinned.is_empty() {
            ui.centered_and_justified(|ui| {
                ui.weak("Nothing is pinned here. Pin an output of a node to see its value.");
            });
        }
        let sorted = Sorted::of(pinned);
        let mut unpinned = self.strip(ui, &sorted);
        let parts = [
            (Part::Meshes, !sorted.meshes.is_empty()),
            (Part::Images, !sorted.images.is_empty()),
            (Part::Tables, has_tables(&sorted)),
        ];
        let parts: Vec<Part> = parts.iter().filter(|part| part.1).map(|part| part.0).collect();
        let whole = ui.available_rect_before_wrap();
        let width = whole.width() / parts.len().max(1) as f32;
        for (at, part) in parts.iter().enumerate() {
            let left = whole.left() + at as f32 * width;
            let rect = Rect::from_min_max(
                pos2(left, whole.top()),
                pos2(left + width - if at + 1 < parts.len() { 6.0 } else { 0.0 }, whole.bottom()),
            );
            if !rect.is_positive() {
                continue;
            }
            let id = ["meshes", "images", "tables"][*part as usize];
            let builder = egui::UiBuilder::new().max_rect(rect).id_salt(id);
            let of_part = ui.scope_builder(builder, |ui| {
                ui.set_clip_rect(ui.clip_rect().intersect(rect));
                match part {
                    Part::Meshes => self.show_meshes(ui, &sorted, render),
                    Part::Images => self.show_images(ui, &sorted),
                    Part::Tables => self.show_tables(ui, &sorted),
                }
            });
            unpinned = unpinned.or(of_part.inner);
        }
        if sorted.meshes.is_empty() && render.is_some() {
            // Lets go of what is on the GPU.
            self.meshes.forget_meshes();
        }
        unpinned.map(ViewerAction::Unpin)
    }

    /// What is small: absences, scalars, the fields that color meshes.
    fn strip(&mut self, ui: &mut egui::Ui, sorted: &Sorted) -> Option<usize> {
        let mut unpinned = None;
        for (at, title, reason) in &sorted.absent {
            if values::show_absence(ui, title, reason) {
                unpinned = Some(*at);
            }
        }
        // While a run follows each edit, values are old for moments only, and nothing is to jump.
        let is_outdated = !sorted.outdated.is_empty();
        self.outdated_since =
            self.outdated_since.or_else(|| Some(Instant::now())).filter(|_| is_outdated);
        if is_outdated {
            ui.ctx().request_repaint_after(OUTDATED);
        }
        if self.outdated_since.is_some_and(|since| since.elapsed() > OUTDATED) {
            ui.weak(format!("From an earlier run: {}", sorted.outdated.join(", ")));
        }
        if !sorted.scalars.is_empty() {
            ui.horizontal_wrapped(|ui| {
                for (at, title, scalar) in &sorted.scalars {
                    if values::show_scalar(ui, title, scalar) {
                        unpinned = Some(*at);
                    }
                }
            });
        }
        if !sorted.colors.is_empty() {
            ui.horizontal_wrapped(|ui| {
                for (at, pinned) in &sorted.colors {
                    if values::heading(ui, &pinned.title) {
                        unpinned = Some(*at);
                    }
                }
            });
        }
        unpinned
    }

    fn show_meshes(
        &mut self,
        ui: &mut egui::Ui,
        sorted: &Sorted,
        render: Option<&RenderState>,
    ) -> Option<usize> {
        let meshes: Vec<MeshInput> = sorted.meshes.iter().map(|(_, mesh)| mesh.clone()).collect();
        let fields: Vec<PinnedField> = sorted.colors.iter().map(|(_, f)| f.clone()).collect();
        let picture = |(_, input): &(usize, ImagesInput)| PinnedPicture {
            title: input.title.clone(),
            images: Arc::clone(&input.images),
        };
        let pictures: Vec<PinnedPicture> = sorted.images.iter().map(picture).collect();
        let unpinned = self.meshes.show(ui, &meshes, &fields, &pictures, render)?;
        Some(sorted.meshes[unpinned].0)
    }

    fn show_images(&mut self, ui: &mut egui::Ui, sorted: &Sorted) -> Option<usize> {
        let images: Vec<ImagesInput> = sorted.images.iter().map(|(_, i)| i.clone()).collect();
        let unpinned = self.images.show(ui, &images)?;
        Some(sorted.images[unpinned].0)
    }

    fn show_tables(&mut self, ui: &mut egui::Ui, sorted: &Sorted) -> Option<usize> {
        let mut unpinned = None;
        for (at, title, value) in &sorted.others {
            if values::show_summary(ui, title, value) {
                unpinned = Some(*at);
            }
        }
        let n_parts = sorted.fields.len() + usize::from(!sorted.measures.is_empty());
        let height = ui.available_height() / n_parts.max(1) as f32 - 30.0;
        self.fields.retain(|(title, _)| sorted.fields.iter().any(|(_, f)| f.title == *title));
        for (at, pinned) in &sorted.fields {
            if values::heading(ui, &pinned.title) {
                unpinned = Some(*at);
            }
            let known = self.fields.iter().position(|(title, _)| *title == pinned.title);
            let known = known.unwrap_or_else(|| {
                self.fields.push((pinned.title.clone(), FieldView::default()));
                self.fields.len() - 1
            });
            self.fields[known].1.show(ui, &pinned.title, &pinned.field, height);
        }
        if !sorted.measures.is_empty() {
            for (at, input) in &sorted.measures {
                if values::heading(ui, &input.title) {
                    unpinned = Some(*at);
                }
            }
            let inputs: Vec<_> = sorted.measures.iter().map(|(_, input)| input.clone()).collect();
            let table = self.measures.of(&inputs);
            self.table.show(ui, &table);
        }
        unpinned
    }
}

/// Goes to the next row where less room than this is left: lists and sliders do not wrap by
/// themselves.
pub fn make_room(ui: &mut egui::Ui, width: f32) {
    if ui.available_size_before_wrap().x < width {
        ui.end_row();
    }
}

fn has_tables(sorted: &Sorted) -> bool {
    !(sorted.fields.is_empty() && sorted.measures.is_empty() && sorted.others.is_empty())
}
