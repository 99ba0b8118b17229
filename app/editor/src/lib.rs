//! The window of mve: build a map by hand, watch it run, look at the result, run its program.
//!
//! The parts, each without knowledge of the next: `document` is the open map and its history, with
//! no window; `runner` runs it on threads; `canvas`, `forms`, `views` and `programs` draw what they
//! are given and answer with what a hand asked for; `app` holds them together.

pub mod app;
pub mod canvas;
pub mod catalog;
pub mod document;
pub mod drag;
mod forms;
pub mod kept;
pub mod programs;
pub mod runner;
pub mod views;

use std::path::PathBuf;

use app::{Editor, Settings, Start};
use eframe::egui;
use mve_core::Registry;

/// Name of the window's settings in the store of the system.
const SETTINGS: &str = "settings";

/// What the window shows first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FirstSight {
    /// The canvas, and below it what is looked at.
    Map,
    /// Only what is looked at.
    Values,
}

/// Opens the window on maps and on files that modules read, and stays until it is closed. The error
/// is a sentence for a person.
pub fn open_window(
    registry: Registry,
    files: Vec<PathBuf>,
    first: FirstSight,
) -> Result<(), String> {
    let viewport = egui::ViewportBuilder::default()
        .with_app_id("mve")
        .with_title("mve")
        .with_inner_size([1400.0, 900.0])
        .with_min_inner_size([640.0, 420.0]);
    let options = eframe::NativeOptions { viewport, ..Default::default() };
    let create: eframe::AppCreator = Box::new(move |creation| {
        let stored = creation.storage.and_then(|storage| storage.get_string(SETTINGS));
        let settings: Option<Settings> = stored.and_then(|text| serde_json::from_str(&text).ok());
        let settings = settings.unwrap_or_default();
        let before = settings.open.iter().filter(|map| map.is_file()).cloned();
        let start = Start {
            files: if files.is_empty() { before.collect() } else { files },
            is_view: first == FirstSight::Values,
            settings,
            recovery: eframe::storage_dir("mve").map(|folder| folder.join("unsaved")),
            render: creation.wgpu_render_state.clone(),
            output_folder: None,
            has_example: true,
        };
        Ok(Box::new(Editor::new(&creation.egui_ctx, registry, start)))
    });
    eframe::run_native("mve", options, create).map_err(|error| {
        format!("no window could be opened: {error}; mve needs a display and a driver for Vulkan, Metal, Direct3D 12 or OpenGL")
    })
}
