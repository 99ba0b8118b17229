//! What a window shows of a value: one view for each data type, no code for any module.
//!
//! A [`Viewer`] shows the values that are pinned to it together: meshes with one camera, pictures
//! with one zoom, measures in one table. A view is one file and one line in the list below. Work
//! that takes longer than a frame is done on threads of its own, and values stay shown as they were
//! until what replaces them is there.
//!
//! **Invariant: a mesh is uploaded once and drawn only when something changed.** So a window with a
//! large mesh in it costs nothing while the user works elsewhere, even without a GPU.

mod background;
mod camera;
mod heading;
mod images_zoom;
mod memo;
mod number;
mod picked;
mod picture;
mod sheet;
mod spread;
mod still;
mod table;
mod thumbnail;
mod wheel;

#[cfg(test)]
mod tests;

/// What `mve new view` begins with.
#[cfg(test)]
#[path = "../../templates/view.rs"]
mod template;

use std::collections::HashMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use eframe::egui::{self, Rect, pos2};
use eframe::egui_wgpu::RenderState;
use mve_core::{Data, Value};
use mve_modules::data::{Domain, TriMesh};
use sheet::SheetAction;

use crate::kept::KeptEdit;
pub use camera::{Camera, Projection, StandardView, UpAxis};
pub use mesh::{
    Arrangement, BackFaces, ColorBy, Distance, MeshLook, MeshSettings, MeshView, NamedView,
    ScaleSettings, Section, Spacing, StillOptions, VIEW_KEYS,
};
pub use number::{ColumnFormat, brief_text, count_text, number_text};
pub use picked::PickedElement;
pub use still::Still;
pub use table::{CellTable, Column, SortOrder, TableView};
pub use thumbnail::{Thumbnail, ThumbnailKey, Thumbnails};

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
#[derive(Clone, Debug, Default)]
pub struct Pinned {
    /// Node and port: `simplify.mesh`.
    pub title: String,
    /// Its value, if there is one.
    pub value: Option<Value>,
    /// How fresh it is, or why there is none.
    pub state: PortState,
    /// The mesh that a field is over, if that is known.
    pub mesh: Option<Arc<TriMesh>>,
}

/// What the user wants of whoever shows the viewer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ViewerAction {
    /// To see the value at this place of the list no longer.
    Unpin(usize),
    /// To look at another element of a mesh, or at none. The viewer does that itself.
    Pick(Option<PickedElement>),
    /// To keep something with the map, or no longer, all as one.
    Keep(Vec<KeptEdit>),
    /// To read this sentence.
    Say(String),
    /// A picture of the meshes in a file.
    TakePicture,
}

/// Where a view stands in a panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PanelPlace {
    /// Above the columns, as high as it is.
    Strip,
    /// In the column of this name. Columns share the width, and views of one column stand below
    /// each other.
    Column(&'static str),
}

/// What a view shows in one frame.
pub struct ViewInput<'a> {
    /// The values that it takes, at least one, each with its place in the list.
    pub values: Vec<(usize, &'a Pinned)>,
    /// All that is pinned.
    pub all: &'a [Pinned],
    /// Height of each part of a column that is shared, in points.
    pub height: f32,
    /// What draws on the GPU, if there is one.
    pub render: Option<&'a RenderState>,
    /// The element of a mesh that is looked at.
    pub picked: Option<&'a PickedElement>,
}

impl ViewInput<'_> {
    /// The values of a type, each with its place in the list and its title.
    pub fn of<T: Data>(&self) -> Vec<(usize, &str, Arc<T>)> {
        let mut values = Vec::new();
        for &(place, pinned) in &self.values {
            let value = pinned.value.as_ref().and_then(Value::get::<T>);
            values.extend(value.map(|value| (place, pinned.title.as_str(), value)));
        }
        values
    }
}

/// How the values of one type are shown.
pub trait ValueView {
    /// Where the view stands.
    fn place(&self) -> PanelPlace;

    /// Whether it shows a value, given all that is pinned. The first view of the list that does
    /// gets it; what no view takes is shown by its summary.
    fn takes(&self, value: &Value, all: &[Pinned]) -> bool;

    /// Whether a value of its type has nothing that could be seen.
    fn is_empty(&self, _value: &Value) -> bool {
        false
    }

    /// Shows its values.
    fn show(&mut self, ui: &mut egui::Ui, shown: &ViewInput) -> Vec<ViewerAction>;

    /// Lets go of what it holds for values: called in each frame that has none for it.
    fn forget(&mut self) {}

    /// Whether something is in the making that will change the picture.
    fn is_busy(&self) -> bool {
        false
    }

    /// How many parts of the height of its column so many values take.
    fn n_parts(&self, n_values: usize) -> usize {
        n_values.min(1)
    }
}

/// Lists the views in the order in which they stand in a panel.
macro_rules! views {
    ($($file:ident::$view:ident as $values:ident,)*) => {
        $(mod $file;)*

        /// The state of one panel that shows values.
        #[derive(Default)]
        pub struct Viewer {
            $(
                #[doc = concat!("The view of ", stringify!($values), ".")]
                pub $values: $file::$view,
            )*
            /// The table of elements.
            sheet: sheet::SheetView,
            /// The element of a mesh that is looked at.
            pub picked: Option<PickedElement>,
            /// The view of each value, by title, as it was when the value was last fresh.
            places: HashMap<String, usize>,
            /// Since when some value is of an earlier run.
            outdated_since: Option<Instant>,
        }

        impl Viewer {
            fn views(&self) -> Vec<&dyn ValueView> {
                vec![$(&self.$values,)*]
            }

            fn views_mut(&mut self) -> Vec<&mut dyn ValueView> {
                vec![$(&mut self.$values,)*]
            }
        }
    };
}

views! {
    scalars::ScalarsView as scalars,
    field_titles::FieldTitlesView as field_titles,
    mesh::MeshView as meshes,
    images::ImagesView as images,
    field::FieldsView as fields,
    measures::MeasuresView as measures,
    tables::TablesView as tables,
}

/// The column of values that no view takes, before what else is there.
const OTHERS: &str = "tables";

impl Viewer {
    /// A viewer that has shown nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Whether something is in the making that will change the picture.
    pub fn is_busy(&self) -> bool {
        self.views().iter().any(|view| view.is_busy()) || self.sheet.is_busy()
    }

    /// Shows the elements of a value as a table, linked with its picture.
    pub fn show_sheet(&mut self, ui: &mut egui::Ui, pinned: &[Pinned]) {
        for action in self.sheet.show(ui, pinned, self.picked.as_ref()) {
            match action {
                SheetAction::Pick(picked) => self.picked = Some(picked),
                SheetAction::BringIntoSight => {
                    let Some(picked) = &self.picked else { continue };
                    if let Some(mesh) = mesh_of(pinned, &picked.title) {
                        self.meshes.go_to(ui.ctx(), picked.clone(), mesh);
                    }
                }
            }
        }
    }

    /// Shows the values in the space that there is. Without `render` meshes cannot be drawn.
    pub fn show(
        &mut self,
        ui: &mut egui::Ui,
        pinned: &[Pinned],
        render: Option<&RenderState>,
    ) -> Vec<ViewerAction> {
        if pinned.is_empty() {
            ui.centered_and_justified(|ui| {
                ui.weak("Nothing is pinned here. Pin an output of a node to see its value.");
            });
        }
        let mut actions = self.show_absences(ui, pinned);
        self.show_outdated(ui, pinned);
        let (values, others) = self.sorted(pinned);
        let picked = self.picked.clone();
        let shown = |values: &[usize], height: f32| {
            let values = values.iter().map(|&place| (place, &pinned[place])).collect();
            ViewInput { values, all: pinned, height, render, picked: picked.as_ref() }
        };
        for (view, values) in self.views_mut().into_iter().zip(&values) {
            if values.is_empty() {
                view.forget();
            } else if view.place() == PanelPlace::Strip {
                actions.extend(view.show(ui, &shown(values, ui.available_height())));
            }
        }
        let columns = self.columns(&values, &others);
        let whole = ui.available_rect_before_wrap();
        for (at, column) in columns.iter().enumerate() {
            let rect = rect_of_column(whole, at, columns.len());
            if !rect.is_positive() {
                continue;
            }
            let builder = egui::UiBuilder::new().max_rect(rect).id_salt(column);
            ui.scope_builder(builder, |ui| {
                ui.set_clip_rect(ui.clip_rect().intersect(rect));
                if *column == OTHERS {
                    actions.extend(show_others(ui, pinned, &others));
                }
                let views = self.views_mut().into_iter().zip(&values);
                let views = views.filter(|(view, values)| {
                    view.place() == PanelPlace::Column(column) && !values.is_empty()
                });
                let views: Vec<_> = views.collect();
                let n_parts: usize = views.iter().map(|(v, values)| v.n_parts(values.len())).sum();
                let height = ui.available_height() / n_parts.max(1) as f32 - 30.0;
                for (view, values) in views {
                    actions.extend(view.show(ui, &shown(values, height)));
                }
            });
        }
        actions.retain(|action| match action {
            ViewerAction::Pick(picked) => {
                self.picked.clone_from(picked);
                false
            }
            _ => true,
        });
        actions
    }

    /// Whether a value has nothing that could be seen.
    pub fn is_empty(&self, value: &Value) -> bool {
        self.views().iter().any(|view| view.is_empty(value))
    }

    /// Says which values are not there or have nothing to be seen, and why.
    fn show_absences(&self, ui: &mut egui::Ui, pinned: &[Pinned]) -> Vec<ViewerAction> {
        let mut actions = Vec::new();
        for (place, pinned) in pinned.iter().enumerate() {
            let reason = match (&pinned.value, &pinned.state) {
                (Some(value), _) if self.is_empty(value) => value.summary(),
                (Some(_), _) => continue,
                (None, PortState::Absent(reason)) => reason.clone(),
                (None, PortState::Ready | PortState::Outdated) => "no value".to_owned(),
            };
            if heading::show_absence(ui, &pinned.title, &reason) {
                actions.push(ViewerAction::Unpin(place));
            }
        }
        actions
    }

    /// The places of the values of each view, and of those that no view takes; without those that
    /// have nothing to be seen. A value of an earlier run stays with its view: while a run gives
    /// new values one by one, what colored a mesh is not to become a picture of its own.
    fn sorted(&mut self, pinned: &[Pinned]) -> (Vec<Vec<usize>>, Vec<usize>) {
        let views = self.views();
        let mut places = HashMap::new();
        let (mut sorted, mut others) = (vec![Vec::new(); views.len()], Vec::new());
        for (place, pin) in pinned.iter().enumerate() {
            let known = self.places.get(&pin.title).copied();
            let Some(value) = pin.value.as_ref().filter(|value| !self.is_empty(value)) else {
                places.extend(known.map(|view| (pin.title.clone(), view)));
                continue;
            };
            let kept = known.filter(|_| pin.state == PortState::Outdated);
            match kept.or_else(|| views.iter().position(|view| view.takes(value, pinned))) {
                Some(view) => {
                    sorted[view].push(place);
                    places.insert(pin.title.clone(), view);
                }
                None => others.push(place),
            }
        }
        self.places = places;
        (sorted, others)
    }

    /// The columns that have something to show, from left to right.
    fn columns(&self, values: &[Vec<usize>], others: &[usize]) -> Vec<&'static str> {
        let mut columns = Vec::new();
        for (view, values) in self.views().iter().zip(values) {
            match view.place() {
                PanelPlace::Column(name) if !values.is_empty() && !columns.contains(&name) => {
                    columns.push(name);
                }
                PanelPlace::Column(_) | PanelPlace::Strip => {}
            }
        }
        if !others.is_empty() && !columns.contains(&OTHERS) {
            columns.push(OTHERS);
        }
        columns
    }

    /// Says which values are of an earlier run. While a run follows each edit, they are old for
    /// moments only, and nothing is to jump.
    fn show_outdated(&mut self, ui: &mut egui::Ui, pinned: &[Pinned]) {
        let is_outdated =
            |pinned: &&Pinned| pinned.value.is_some() && pinned.state == PortState::Outdated;
        let titles: Vec<&str> =
            pinned.iter().filter(is_outdated).map(|pinned| pinned.title.as_str()).collect();
        if titles.is_empty() {
            self.outdated_since = None;
            return;
        }
        let since = *self.outdated_since.get_or_insert_with(Instant::now);
        ui.ctx().request_repaint_after(OUTDATED);
        if since.elapsed() > OUTDATED {
            ui.weak(format!("From an earlier run: {}", titles.join(", ")));
        }
    }
}

/// How many of each kind of its elements a value has, by their nouns.
pub fn counts_of(value: &Value) -> Vec<(&'static str, usize)> {
    let counts = |mesh: Arc<TriMesh>| {
        let domains = [Domain::Face, Domain::Vertex];
        domains.map(|domain| (picked::many_of(domain), mesh.n_elements(domain))).to_vec()
    };
    value.get::<TriMesh>().map(counts).unwrap_or_default()
}

/// The mesh that is shown under a title.
fn mesh_of(pinned: &[Pinned], title: &str) -> Option<Arc<TriMesh>> {
    pinned.iter().find(|pinned| pinned.title == title)?.value.as_ref()?.get::<TriMesh>()
}

/// Shows what values that no view takes say of themselves.
fn show_others(ui: &mut egui::Ui, pinned: &[Pinned], others: &[usize]) -> Vec<ViewerAction> {
    let mut actions = Vec::new();
    for &place in others {
        let Pinned { title, value: Some(value), .. } = &pinned[place] else { continue };
        if heading::show_summary(ui, title, value) {
            actions.push(ViewerAction::Unpin(place));
        }
    }
    actions
}

/// The part of a panel that one of its columns has.
fn rect_of_column(whole: Rect, at: usize, n_columns: usize) -> Rect {
    let width = whole.width() / n_columns.max(1) as f32;
    let left = whole.left() + at as f32 * width;
    let gap = if at + 1 < n_columns { 6.0 } else { 0.0 };
    Rect::from_min_max(pos2(left, whole.top()), pos2(left + width - gap, whole.bottom()))
}

/// Goes to the next row where less room than this is left: lists and sliders do not wrap by
/// themselves.
pub fn make_room(ui: &mut egui::Ui, width: f32) {
    if ui.available_size_before_wrap().x < width {
        ui.end_row();
    }
}
