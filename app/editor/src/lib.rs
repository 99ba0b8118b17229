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

use std::path::{Path, PathBuf};

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
    files.iter().try_for_each(|file| can_be_opened(file))?;
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
        let why = without_place(&error.to_string());
        format!("no window could be opened: {why}; mve needs a display and a driver for Vulkan, Metal, Direct3D 12 or OpenGL")
    })
}

/// Refuses a file that cannot be read, in a sentence; a window that shows something else in its
/// place would seem to show the file.
fn can_be_opened(path: &Path) -> Result<(), String> {
    let told = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let is_map = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"));
    let file = std::fs::File::open(path).map_err(|error| told(&error))?;
    if file.metadata().is_ok_and(|about| about.is_dir()) {
        return Err(told(&"is a folder"));
    }
    match is_map {
        true => mve_core::Map::load(path).map(drop).map_err(|error| told(&error)),
        false => Ok(()),
    }
}

/// An error of the window system without the place in the source of winit that found it.
fn without_place(error: &str) -> String {
    let Some((before, place)) = error.split_once("os error at ") else { return error.to_owned() };
    let why = place.split_once(": ").map_or("the window system refused", |(_, why)| why);
    format!("{before}{}", why.trim_end_matches('.'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_cannot_be_read_opens_no_window() {
        let folder = tempfile::tempdir().unwrap();
        let broken = folder.path().join("broken.json");
        std::fs::write(&broken, "{").unwrap();
        for file in [folder.path().join("nothere.json"), folder.path().to_owned(), broken] {
            let error = can_be_opened(&file).unwrap_err();
            assert!(error.starts_with(&file.display().to_string()), "{error}");
        }
        let fine = folder.path().join("fine.json");
        std::fs::write(&fine, "{\"mve\": 1}").unwrap();
        assert_eq!(can_be_opened(&fine), Ok(()));
    }

    #[test]
    fn no_path_of_the_machine_that_built_it_is_told() {
        let of_winit = "os error at /home/a/.cargo/registry/src/winit-0.30/src/linux/mod.rs:766: \
                        neither WAYLAND_DISPLAY nor WAYLAND_SOCKET nor DISPLAY is set.";
        let told = "winit: neither WAYLAND_DISPLAY nor WAYLAND_SOCKET nor DISPLAY is set";
        assert_eq!(without_place(&format!("winit: {of_winit}")), told);
        assert_eq!(without_place("no adapter was found"), "no adapter was found");
    }
}
