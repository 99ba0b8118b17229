//! What the window remembers from one start to the next.

use std::path::{Path, PathBuf};

use eframe::egui;
use serde::{Deserialize, Serialize};

use crate::canvas::CanvasSettings;
use crate::views::MeshLook;

/// Most recent files that are kept.
const MOST_RECENT: usize = 12;

/// Seconds that the pointer rests before words appear: less gets in the way of a hand at work.
const TOOLTIP_SECS: f32 = 0.7;

/// Points on both sides of a panel's edge from which it is dragged.
const GRAB: f32 = 6.0;

/// What the window remembers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// How the canvas answers.
    pub canvas: CanvasSettings,
    /// Dark, light, or as the system has it.
    pub theme: Theme,
    /// How meshes are shown.
    pub meshes: MeshLook,
    /// Size of everything, 1 for the size that the system asks for.
    pub scale: f32,
    /// Whether what a change touches runs at once, savers excepted.
    pub runs_on_edit: bool,
    /// Whether the inspector is shown.
    pub has_inspector: bool,
    /// Maps that were open, the last one first.
    pub recent: Vec<PathBuf>,
    /// Maps that were open when the window was closed.
    pub open: Vec<PathBuf>,
    /// Whether the hint for a first start was closed.
    pub has_seen_hint: bool,
}

/// The theme of the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Theme {
    /// As the system has it.
    #[default]
    System,
    /// Dark.
    Dark,
    /// Light.
    Light,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            canvas: CanvasSettings::default(),
            theme: Theme::default(),
            meshes: MeshLook::default(),
            scale: 1.0,
            runs_on_edit: false,
            has_inspector: true,
            recent: Vec::new(),
            open: Vec::new(),
            has_seen_hint: false,
        }
    }
}

impl Settings {
    /// Puts a file in front of the recent ones.
    pub fn remember(&mut self, path: &Path) {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        self.recent.retain(|known| *known != path);
        self.recent.insert(0, path);
        self.recent.truncate(MOST_RECENT);
    }

    /// Gives the window its theme and scale.
    pub fn apply(&self, ctx: &egui::Context) {
        ctx.set_theme(match self.theme {
            Theme::System => egui::ThemePreference::System,
            Theme::Dark => egui::ThemePreference::Dark,
            Theme::Light => egui::ThemePreference::Light,
        });
        ctx.set_zoom_factor(self.scale.clamp(0.5, 3.0));
        ctx.style_mut_of(egui::Theme::Light, |style| {
            style.visuals.weak_text_color = Some(egui::Color32::from_gray(95));
        });
        ctx.style_mut_of(egui::Theme::Dark, |style| {
            style.visuals.weak_text_color = Some(egui::Color32::from_gray(150));
        });
        ctx.all_styles_mut(|style| {
            style.interaction.tooltip_delay = TOOLTIP_SECS;
            style.interaction.resize_grab_radius_side = GRAB;
        });
    }
}
