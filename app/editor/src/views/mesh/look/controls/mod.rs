//! The row of controls of a mesh view, and its menus.

mod distances_menu;
mod section_menu;
mod view_menu;

use eframe::egui;
use mve_core::Enumeration;
use mve_modules::picture::color_map::Outside;
use mve_modules::picture::color_scale::Scale;

use crate::kept::KeptEdit;
use crate::views::camera::{Bounds, Camera};
use crate::views::make_room;
use crate::views::mesh::arrays::Shading;
use crate::views::mesh::look::coloring::{ColorBy, ScaleSettings};
use crate::views::mesh::look::named::NamedView;
use crate::views::mesh::look::range_end::RangeEnd;
use crate::views::mesh::look::settings::{
    Arrangement, BackFaces, MeshSettings, Switch, SwitchHome,
};
use crate::views::mesh::look::values::{CLIP_PERCENTS, Spacing};
use crate::views::number::number_text;
use distances_menu::distances_menu;
use section_menu::section_controls;
use view_menu::{NameFields, view_menu};

/// What the controls can offer for what is shown.
#[derive(Clone, Debug, Default)]
pub struct Offers {
    /// Titles of the meshes.
    pub titles: Vec<String>,
    /// What they can be colored by, each with the words for it.
    pub color_by: Vec<(ColorBy, String)>,
    /// The values at the ends of the color scale, where a scalar is shown.
    pub range: Option<[f64; 2]>,
    /// What can be switched.
    pub switches: Vec<Switch>,
    /// The views that are kept, each with its name.
    pub views: Vec<(String, NamedView)>,
    /// The box around all, once it is known.
    pub bounds: Option<Bounds>,
    /// Whether meshes side by side have one scale and place.
    pub is_one_scale: bool,
}

impl Offers {
    /// The choice that holds: one that none of the meshes has waits until one has it again.
    pub fn in_force(&self, chosen: &ColorBy) -> ColorBy {
        let is_offered = self.color_by.iter().any(|(by, _)| by == chosen);
        if is_offered { chosen.clone() } else { ColorBy::Auto }
    }
}

/// What the controls ask for beyond settings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wishes {
    /// To see all of it.
    pub is_fit: bool,
    /// A picture of it in a file.
    pub is_picture: bool,
    /// To look as a kept view has it.
    pub view: Option<NamedView>,
    /// To look at an element by its number.
    pub is_number: bool,
    /// To keep something, or no longer.
    pub kept: Vec<KeptEdit>,
    /// What was typed and is not taken, and why.
    pub faults: Vec<String>,
}

/// What the row of controls remembers.
#[derive(Default)]
pub struct Controls {
    names: NameFields,
}

/// The row of controls.
pub fn controls(
    ui: &mut egui::Ui,
    remembered: &mut Controls,
    (settings, camera): (&mut MeshSettings, &mut Camera),
    offers: &Offers,
) -> Wishes {
    let mut wishes = Wishes::default();
    let row = |ui: &mut egui::Ui| {
        if ui.button("Fit").on_hover_text("Show all of it (R, or double click)").clicked() {
            wishes.is_fit = true;
        }
        let names = &mut remembered.names;
        menu(ui, "View", |ui| view_menu(ui, names, (settings, camera), offers, &mut wishes))
            .on_hover_text("Direction, projection, what points up, and views kept by name");
        menu(ui, "Surface", |ui| surface_menu(ui, settings, &offers.switches))
            .on_hover_text("Shading, back faces, lines, box and axes");
        section_controls(ui, settings, camera, offers);
        let picture = ui.button("Picture…").on_hover_text("Save what is seen as a PNG of any size");
        wishes.is_picture = picture.clicked();
        for switch in offers.switches.iter().filter(|switch| switch.home == SwitchHome::Row) {
            ui.toggle_value((switch.place)(settings), switch.label).on_hover_text(switch.doc);
        }
        distances_menu(ui, &settings.distances, &mut wishes);
        color_by_box(ui, settings, offers);
        if let Some(range) = offers.range {
            menu(ui, "Range", |ui| scale_menu(ui, &mut settings.scale, range, &mut wishes))
                .on_hover_text("The color scale and the values at its ends");
        }
        if offers.titles.len() > 1 {
            comparison(ui, settings, offers);
        }
    };
    // In a low panel several rows would leave nothing for the pictures: one is scrolled then.
    match ui.available_height() < LOW {
        true => {
            let area = egui::ScrollArea::horizontal().id_salt("row of controls");
            area.show(ui, |ui| ui.horizontal(row));
        }
        false => drop(ui.horizontal_wrapped(row)),
    }
    wishes
}

/// Height of a panel in points below which its controls have one row.
const LOW: f32 = 240.0;

/// A menu that stays open until something else is clicked: what it holds are settings.
pub fn menu(ui: &mut egui::Ui, label: &str, content: impl FnOnce(&mut egui::Ui)) -> egui::Response {
    let stays = egui::PopupCloseBehavior::CloseOnClickOutside;
    let config = egui::containers::menu::MenuConfig::new().close_behavior(stays);
    egui::containers::menu::MenuButton::new(label).config(config).ui(ui, content).0
}

fn surface_menu(ui: &mut egui::Ui, settings: &mut MeshSettings, switches: &[Switch]) {
    let is_flat = settings.shading == Shading::Flat;
    if ui.radio(!is_flat, "Smooth").on_hover_text("Faces share normals").clicked() && is_flat {
        settings.shading = Shading::default();
    }
    if let Shading::Smooth { crease_angle_rad } = &mut settings.shading {
        let mut degrees = crease_angle_rad.to_degrees().round();
        ui.label("Crease angle");
        let slider = egui::Slider::new(&mut degrees, 0.0..=180.0).suffix("°");
        let response = ui.add(slider).on_hover_text("Edges sharper than this stay edges");
        if response.changed() {
            *crease_angle_rad = degrees.to_radians();
        }
    }
    if ui.radio(is_flat, "Flat").on_hover_text("Every face by itself").clicked() {
        settings.shading = Shading::Flat;
    }
    ui.separator();
    ui.label("Back faces");
    ui.radio_value(&mut settings.back_faces, BackFaces::Tinted, "Tinted")
        .on_hover_text("Reddish, so that holes and turned faces show");
    ui.radio_value(&mut settings.back_faces, BackFaces::Same, "As the front");
    ui.radio_value(&mut settings.back_faces, BackFaces::Hidden, "Hidden");
    ui.separator();
    for switch in switches.iter().filter(|switch| switch.home == SwitchHome::Menu) {
        ui.checkbox((switch.place)(settings), switch.label).on_hover_text(switch.doc);
    }
}

fn color_by_box(ui: &mut egui::Ui, settings: &mut MeshSettings, offers: &Offers) {
    let current = offers.in_force(&settings.color_by);
    let named = offers.color_by.iter().find(|(by, _)| *by == current);
    let text = named.map_or("", |(_, text)| text.as_str()).to_owned();
    make_room(ui, 190.0);
    ui.label("Color");
    let shown = egui::ComboBox::from_id_salt("color by").selected_text(&text).show_ui(ui, |ui| {
        for (by, text) in &offers.color_by {
            if ui.selectable_label(*by == current, text).clicked() {
                settings.color_by = by.clone();
            }
        }
    });
    let name = format!("color by: {text}");
    shown
        .response
        .on_hover_text("What the surface is colored by")
        .widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::ComboBox, true, &name));
}

/// The scale and the ends of its range.
fn scale_menu(ui: &mut egui::Ui, scale: &mut ScaleSettings, range: [f64; 2], wishes: &mut Wishes) {
    ui.label("Colors");
    ui.horizontal_wrapped(|ui| {
        for (&value, (name, doc)) in Scale::VALUES.iter().zip(Scale::NAMES) {
            ui.selectable_value(&mut scale.scale, value, *name).on_hover_text(*doc);
        }
    });
    ui.checkbox(&mut scale.is_reversed, "Reverse the colors");
    ui.separator();
    ui.horizontal(|ui| {
        ui.label("Leave out at each end").on_hover_text(
            "So many of the values may lie beyond each end, so that a few extremes do not take \
             all colors",
        );
        for percent in CLIP_PERCENTS {
            ui.selectable_value(&mut scale.clip_percent, percent, format!("{percent} %"));
        }
    });
    for ((end, label), present) in RangeEnd::ALL.into_iter().zip(["Minimum", "Maximum"]).zip(range)
    {
        end_of_range(ui, scale, (end, label), present, wishes);
    }
    ui.checkbox(&mut scale.is_symmetric, "Symmetric around 0");
    let mut is_log = scale.spacing == Spacing::Logarithmic;
    if ui.checkbox(&mut is_log, "Logarithmic").on_hover_text("Values above 0 only").changed() {
        scale.spacing = if is_log { Spacing::Logarithmic } else { Spacing::Linear };
    }
    let mut is_gray = scale.outside == Outside::Gray;
    if ui.checkbox(&mut is_gray, "Gray outside of the range").changed() {
        scale.outside = if is_gray { Outside::Gray } else { Outside::Clamp };
    }
}

/// An end that is from the data or given by hand, which begins with the one that is there.
fn end_of_range(
    ui: &mut egui::Ui,
    scale: &mut ScaleSettings,
    (end, label): (RangeEnd, &str),
    present: f64,
    wishes: &mut Wishes,
) {
    ui.horizontal(|ui| {
        let mut is_given = end.given(scale).is_some();
        if ui.checkbox(&mut is_given, label).changed() {
            *end.given(scale) = is_given.then_some(present);
        }
        if end.given(scale).is_none() {
            ui.weak(number_text(present));
            return;
        }
        let speed = (0.01 * present.abs()).max(1e-6);
        let (_, fault) = end.show(ui, scale, present, |field| field.speed(speed).max_decimals(9));
        wishes.faults.extend(fault);
    });
}

fn comparison(ui: &mut egui::Ui, settings: &mut MeshSettings, offers: &Offers) {
    ui.separator();
    let choices = [
        (Arrangement::SideBySide, "Side by side", "Each mesh in a part of its own, one camera"),
        (Arrangement::Wipe, "Wipe", "The first to the left of a line, the second to its right"),
        (Arrangement::Blend, "Blend", "The second over the first, more or less transparent"),
    ];
    for (value, label, tip) in choices {
        ui.selectable_value(&mut settings.arrangement, value, label).on_hover_text(tip);
    }
    if settings.arrangement == Arrangement::SideBySide {
        let mut is_one_scale = offers.is_one_scale;
        let switch = ui.toggle_value(&mut is_one_scale, "One scale");
        let tip = "Meshes in one scale and place; else each fills its picture, and its caption \
                   says how large it is";
        if switch.on_hover_text(tip).changed() {
            settings.is_one_scale = Some(is_one_scale);
        }
        return;
    }
    make_room(ui, 190.0);
    ui.label("Balance");
    let slider = egui::Slider::new(&mut settings.balance, 0.0..=1.0).show_value(false);
    ui.add(slider).on_hover_text("From the first mesh to the second");
    if offers.titles.len() > 2 {
        for (at, label) in settings.pair.iter_mut().zip(["first", "second"]) {
            let selected = offers.titles.get(*at).cloned().unwrap_or_default();
            make_room(ui, 190.0);
            ui.label(label);
            egui::ComboBox::from_id_salt(label).selected_text(selected).show_ui(ui, |ui| {
                for (i, title) in offers.titles.iter().enumerate() {
                    ui.selectable_value(at, i, title);
                }
            });
        }
    }
}
