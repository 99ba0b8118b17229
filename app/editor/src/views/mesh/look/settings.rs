//! What a mesh view shows and how.

use std::collections::BTreeMap;

use eframe::egui;
use serde::{Deserialize, Serialize};

use crate::views::camera::UpAxis;
use crate::views::mesh::arrays::Shading;
use crate::views::mesh::distance::Distance;
use crate::views::mesh::look::coloring::{ColorBy, ScaleSettings};
use crate::views::mesh::section::Section;

/// How faces look that are seen from behind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum BackFaces {
    /// Reddish, so that holes and turned faces show.
    #[default]
    Tinted,
    /// As from the front.
    Same,
    /// Not drawn.
    Hidden,
}

/// How several meshes share the panel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Arrangement {
    /// Each has a part of its own.
    #[default]
    SideBySide,
    /// Two in one place, the first to the left of a line and the second to its right.
    Wipe,
    /// Two in one place, the second more or less transparent.
    Blend,
}

/// Which edges are drawn over the surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Lines {
    /// All edges.
    pub has_wire: bool,
    /// The edges of one face.
    pub has_border: bool,
}

/// How the user switches something that lies on the pictures.
#[derive(Clone, Copy, Debug)]
pub struct Switch {
    /// Its words.
    pub label: &'static str,
    /// What it shows.
    pub doc: &'static str,
    /// Where it is offered.
    pub home: SwitchHome,
    /// The key that does the same.
    pub key: Option<egui::Key>,
    /// Whether it is on.
    pub place: fn(&mut MeshSettings) -> &mut bool,
}

/// Where a switch is offered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SwitchHome {
    /// In the row of controls.
    Row,
    /// In the menu of the surface.
    Menu,
}

/// What is shown and how.
#[derive(Clone, Debug)]
pub struct MeshSettings {
    /// Normals.
    pub shading: Shading,
    /// Edges over the surface.
    pub lines: Lines,
    /// Faces from behind.
    pub back_faces: BackFaces,
    /// What colors it.
    pub color_by: ColorBy,
    /// How values become colors.
    pub scale: ScaleSettings,
    /// Whether a small cross of axes is in the corner.
    pub has_axes: bool,
    /// Whether the box around all is drawn, with its lengths.
    pub has_box: bool,
    /// What else is switched on or off, by name.
    pub switched: BTreeMap<String, bool>,
    /// What points up; found from the model where it is not said.
    pub up: Option<UpAxis>,
    /// How several share the panel.
    pub arrangement: Arrangement,
    /// Whether meshes side by side have one scale and place; `None`: unless they are too unlike.
    pub is_one_scale: Option<bool>,
    /// Where the line of the wipe is, or how much of the second is seen: 0 to 1.
    pub balance: f32,
    /// The first and the second of a comparison, by place.
    pub pair: [usize; 2],
    /// The plane that cuts something away.
    pub section: Section,
    /// Whether clicks measure distances.
    pub is_measuring: bool,
    /// Distances that were measured.
    pub distances: Vec<Distance>,
}

impl Default for MeshSettings {
    fn default() -> Self {
        Self {
            shading: Shading::default(),
            lines: Lines::default(),
            back_faces: BackFaces::default(),
            color_by: ColorBy::default(),
            scale: ScaleSettings::default(),
            has_axes: true,
            has_box: false,
            switched: BTreeMap::new(),
            up: None,
            arrangement: Arrangement::default(),
            is_one_scale: None,
            balance: 0.5,
            pair: [0, 1],
            section: Section::default(),
            is_measuring: false,
            distances: Vec::new(),
        }
    }
}

impl MeshSettings {
    /// Whether what has this name is on; off at first.
    pub fn switch(&mut self, name: &str) -> &mut bool {
        self.switched.entry(name.to_owned()).or_default()
    }

    /// The crease angle that arrays are made for; flat shading needs no arrays of its own.
    pub fn crease_angle_rad(&self) -> f32 {
        match (self.shading, Shading::default()) {
            (Shading::Smooth { crease_angle_rad }, _) => crease_angle_rad,
            (Shading::Flat, Shading::Smooth { crease_angle_rad }) => crease_angle_rad,
            (Shading::Flat, Shading::Flat) => 0.0,
        }
    }
}
