//! Stub while the panel is written.
use mve_core::{Map, ProgramSpec, Registry};
use serde_json::Value as Json;
use std::path::{Path, PathBuf};
use std::sync::Arc;
#[allow(missing_docs)]
pub struct ProgramPanel {}
#[allow(missing_docs)]
pub struct Scene<'a> {
    pub map: &'a Arc<Map>,
    pub revision: u64,
    pub folder: &'a Path,
    pub map_file: &'a str,
    pub registry: &'a Registry,
}
#[allow(missing_docs)]
pub enum Action {
    SetProgram { name: String, spec: Option<ProgramSpec> },
    RenameProgram { name: String, to: String },
    LoadStep(Vec<(String, String, Json)>),
    OpenFile(PathBuf),
    ShowNode(String),
}
#[allow(missing_docs)]
impl ProgramPanel {
    pub fn new(_wake: Arc<dyn Fn() + Send + Sync>) -> Self {
        Self {}
    }
    pub fn show(&mut self, _ui: &mut eframe::egui::Ui, _scene: &Scene) -> Vec<Action> {
        Vec::new()
    }
    pub fn vary(&mut self, _n: &str, _p: &str, _s: &Scene) -> Vec<Action> {
        Vec::new()
    }
    pub fn is_running(&self) -> bool {
        false
    }
    pub fn take_in(&mut self) {}
}
