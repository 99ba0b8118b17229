//! The head of the panel: which program, how it runs, how far it is.

use std::collections::HashSet;

use eframe::egui::{self, Color32, ComboBox, DragValue, ProgressBar, RichText, TextEdit, Ui};
use mve_core::{Problem, ProgramSpec, Retry, Sharing};

use crate::programs::results::sheet::{StepState, label};
use crate::programs::run::job::{self, RunningStep};
use crate::programs::run::pace::{Pace, in_words};
use crate::programs::widgets::{button_if, count, icon_button, named};
use crate::programs::{ProgramAction, ProgramPanel, ProgramScene, fresh_name};

/// Problems that are listed; more would push the rest away.
const MOST_LINES: usize = 6;
/// Height of the line that says how far it is.
const BAR_HEIGHT: f32 = 18.0;

/// What the head remembers from frame to frame.
#[derive(Default)]
pub struct BarState {
    /// The new name while a program is renamed.
    new_name: Option<String>,
}

impl ProgramPanel {
    /// Shows the head.
    pub(in crate::programs) fn show_bar(
        &mut self,
        ui: &mut Ui,
        scene: &ProgramScene,
        actions: &mut Vec<ProgramAction>,
    ) {
        self.show_chooser(ui, scene, actions);
        let Some(name) = self.name(scene.map).map(str::to_owned) else { return };
        self.show_runs(ui, scene, &name);
        self.show_progress(ui, &name);
        self.show_problems(ui, actions);
    }

    fn show_chooser(
        &mut self,
        ui: &mut Ui,
        scene: &ProgramScene,
        actions: &mut Vec<ProgramAction>,
    ) {
        let name = self.name(scene.map).map(str::to_owned);
        ui.horizontal_wrapped(|ui| {
            if let Some(name) = &name {
                self.show_name(ui, scene, name, actions);
            }
            if icon_button(ui, "\u{2795} New", "New program").clicked() {
                let name = fresh_name(scene.map, "sweep");
                self.choose(&name);
                let spec = Some(ProgramSpec::default());
                actions.push(ProgramAction::SetProgram { name, spec });
            }
            let Some(name) = name else { return };
            if icon_button(ui, "\u{270f}", "Rename program").clicked() {
                self.bar.new_name = Some(name.clone());
            }
            if icon_button(ui, "\u{1f5d0}", "Duplicate program").clicked() {
                let copy = fresh_name(scene.map, &name);
                self.choose(&copy);
                let spec = scene.map.programs.get(&name).cloned();
                actions.push(ProgramAction::SetProgram { name: copy, spec });
            }
            if icon_button(ui, "\u{1f5d1}", "Remove program").clicked() {
                self.chosen = None;
                actions.push(ProgramAction::SetProgram { name: name.clone(), spec: None });
            }
            let store = scene.store_folder(&name);
            let is_there = store.is_dir();
            let text = RichText::new(store.display().to_string()).weak();
            let link = ui.add_enabled(is_there, egui::Link::new(text));
            let link = link.on_disabled_hover_text("The folder of the results; a run makes it.");
            if named(link, "Open the folder of results").on_hover_text("open the folder").clicked()
            {
                actions.push(ProgramAction::OpenFile(store));
            }
        });
    }

    /// The name of the program: to choose another, or a field while it is renamed.
    fn show_name(
        &mut self,
        ui: &mut Ui,
        scene: &ProgramScene,
        name: &str,
        actions: &mut Vec<ProgramAction>,
    ) {
        if let Some(mut new_name) = self.bar.new_name.take() {
            let field = TextEdit::singleline(&mut new_name).desired_width(160.0);
            let response = named(ui.add(field), "New name of the program");
            let is_free =
                !new_name.trim().is_empty() && !scene.map.programs.contains_key(new_name.trim());
            if response.lost_focus() {
                let to = new_name.trim().to_owned();
                if is_free && !ui.input(|input| input.key_pressed(egui::Key::Escape)) {
                    self.chosen = Some(to.clone());
                    actions.push(ProgramAction::RenameProgram { name: name.to_owned(), to });
                }
                return;
            }
            response.request_focus();
            self.bar.new_name = Some(new_name);
            return;
        }
        let combo = ComboBox::from_id_salt("program").selected_text(RichText::new(name).strong());
        let shown = combo.width(160.0).show_ui(ui, |ui| {
            for other in scene.map.programs.keys() {
                if ui.selectable_label(other == name, other.as_str()).clicked() {
                    self.choose(other);
                }
            }
        });
        named(shown.response, &format!("Program: {name}"));
    }

    /// Shows another program.
    fn choose(&mut self, name: &str) {
        if self.chosen.as_deref() != Some(name) {
            self.chosen = Some(name.to_owned());
            self.setup = crate::programs::setup::SetupState::default();
            self.plot = crate::programs::results::plot::PlotState::default();
            self.table = crate::programs::results::table::TableState::default();
            self.note = None;
        }
    }

    /// The buttons that start and stop, and how to run.
    fn show_runs(&mut self, ui: &mut Ui, scene: &ProgramScene, name: &str) {
        ui.horizontal_wrapped(|ui| {
            match self.job.as_ref().map(|job| (job.is_paused(), job.is_stopping())) {
                None => self.show_start(ui, scene),
                Some((is_paused, is_stopping)) => {
                    let pause = match is_paused {
                        true => button_if(ui, !is_stopping, "\u{25b6} Resume", "Resume", ""),
                        false => button_if(ui, !is_stopping, "\u{23f8} Pause", "Pause", ""),
                    };
                    let pause = pause.on_hover_text("Steps that run come to their end; no new one starts.");
                    // The second click of a double click on Run is none on Pause.
                    let is_clicked = pause.clicked() && !pause.double_clicked();
                    if let Some(job) = self.job.as_ref().filter(|_| is_clicked) {
                        job.pause(!is_paused);
                    }
                    let stop = button_if(ui, !is_stopping, "\u{23f9} Stop", "Stop", "stopping");
                    if stop.on_hover_text("Finished steps are kept; Run goes on from there.").clicked() {
                        self.stop();
                    }
                }
            }
            let is_idle = self.job.is_none();
            let is_timing = self.how.sharing == Sharing::Timing;
            ui.add_enabled_ui(is_idle && !is_timing, |ui| {
                ui.label("jobs").on_hover_text("steps that run at once");
                let drag = DragValue::new(&mut self.how.jobs).range(1..=256).speed(0.05);
                named(ui.add(drag), "Jobs");
            });
            let mut timing = is_timing;
            let switch = ui.add_enabled(is_idle, egui::Checkbox::new(&mut timing, "timing"));
            let about = format!(
                "Share nothing and run one step at a time, so that seconds can be compared. Modules \
                 still use all {} threads here; `mve program --timing` gives them one.",
                job::threads()
            );
            if switch.on_hover_text(about).changed() {
                self.how.sharing = if timing { Sharing::Timing } else { Sharing::Shared };
            }
            let store = scene.store_folder(name);
            let (name, why) = ("Open report", "nothing has run yet");
            let has_report = self.has_results() || store.is_dir();
            if button_if(ui, has_report, name, name, why).clicked() {
                self.open_report(store);
            }
        });
    }

    fn show_start(&mut self, ui: &mut Ui, scene: &ProgramScene) {
        let is_sound = self.sound_program(scene).is_some();
        let n_failed = self.failed_rows().count();
        let n_todo = self.sheet.rows.iter().filter(|row| row.state == StepState::ToDo).count();
        let is_timing = self.how.sharing == Sharing::Timing;
        let has_work = n_todo > 0 || is_timing || self.sheet.rows.is_empty();
        let why = match (is_sound, self.being_checked.is_some()) {
            (_, true) => "being checked",
            (false, _) => "the program has problems",
            (true, _) => "all steps are done",
        };
        let is_resumed = n_todo > 0 && n_todo < self.sheet.rows.len();
        // Beside it there is the button that runs the map as it is.
        let name = if is_resumed { "Resume" } else { "Run steps" };
        let text = format!("\u{25b6} {name}");
        if button_if(ui, is_sound && has_work, &text, name, why).clicked() {
            self.run(scene, Retry::Nothing);
        }
        if n_failed > 0 {
            let text = format!("\u{27f3} Run {n_failed} failed again");
            if button_if(ui, is_sound, &text, "Run failed steps again", why).clicked() {
                self.run(scene, Retry::Failed);
            }
        }
    }

    /// How far the program is, and which steps run: two lines, whether it runs or not, so that a
    /// click below meets what it was meant for.
    fn show_progress(&mut self, ui: &mut Ui, name: &str) {
        let Some(job) = &self.job else {
            let size = egui::vec2(ui.available_width(), BAR_HEIGHT);
            let left = egui::Layout::left_to_right(egui::Align::Center);
            ui.allocate_ui_with_layout(size, left, |ui| {
                ui.set_min_size(size);
                ui.add(egui::Label::new(self.state_in_words(name)).truncate());
            });
            let visuals = ui.visuals();
            let (text, color) = match &self.note {
                Some(note) if note.is_trouble => (note.text.as_str(), visuals.error_fg_color),
                Some(note) => (note.text.as_str(), visuals.weak_text_color()),
                None => (" ", visuals.weak_text_color()),
            };
            ui.add(egui::Label::new(RichText::new(text).small().color(color)).truncate());
            return;
        };
        let pace = self.pace();
        let total = job.program.steps.iter().map(|step| &step.id).collect::<HashSet<_>>().len();
        let n_ended = total - pace.left;
        let mut words = Vec::new();
        if job.program.name != name {
            words.push(format!("\u{201c}{}\u{201d} is running", job.program.name));
        }
        words.push(format!("{n_ended} of {}", count(total, "step")));
        let n_failed = self.failed_rows().count();
        words.extend((n_failed > 0).then(|| format!("{n_failed} failed")));
        words.push(match (job.is_stopping(), job.is_paused(), pace.time_left()) {
            (true, ..) => "stopping".to_owned(),
            (_, true, _) => "paused".to_owned(),
            (.., Some(left)) => format!("about {} left", in_words(left)),
            (.., None) => "time left not known yet".to_owned(),
        });
        let text = words.join(" \u{b7} ");
        let share = n_ended as f32 / total.max(1) as f32;
        let bar = ui.add(ProgressBar::new(share).desired_height(BAR_HEIGHT).text(text.as_str()));
        named(bar, &format!("Progress: {text}"));
        let line = |(place, running): (&usize, &RunningStep)| {
            let share = running.share.map(|share| format!(" {:.0} %", share * 100.0));
            let (share, time) = (share.unwrap_or_default(), in_words(running.since.elapsed()));
            let step = label(job.program.steps.get(*place)?);
            Some(format!("{step}  \u{2013}  {}{share}, {time}", running.node))
        };
        let lines: Vec<String> = self.running.iter().filter_map(line).collect();
        let text = match lines.as_slice() {
            [] => " ".to_owned(),
            [one] => one.clone(),
            [first, others @ ..] => format!("{first}, and {} more", others.len()),
        };
        let shown = ui.add(egui::Label::new(RichText::new(text).small().weak()).truncate());
        shown.on_hover_text(lines.join("\n"));
        ui.ctx().request_repaint_after(std::time::Duration::from_millis(250));
    }

    /// How many steps the shown program has, and what became of them.
    fn state_in_words(&self, name: &str) -> String {
        let rows = &self.sheet.rows;
        if self.sheet.program.as_ref().is_none_or(|program| program.name != name) {
            let is_checked = self.being_checked.is_none();
            return if is_checked { "no steps yet" } else { "being checked" }.to_owned();
        }
        if self.checked.as_ref().is_some_and(|checked| checked.program.is_none()) {
            return "cannot run as it stands; below are the results of before".to_owned();
        }
        let n_failed = self.failed_rows().count();
        let n_done = rows.iter().filter(|row| row.state == StepState::Done).count();
        let mut words = vec![count(rows.len(), "step")];
        words.extend((n_done > 0).then(|| format!("{n_done} done")));
        words.extend((n_failed > 0).then(|| format!("{n_failed} failed")));
        let n_steps = self.sheet.program.as_ref().map_or(0, |program| program.steps.len());
        let n_same = n_steps.saturating_sub(rows.len());
        words.extend((n_same > 0).then(|| {
            format!(
                "{} the same as another and counted once",
                if n_same == 1 { "1 is".to_owned() } else { format!("{n_same} are") }
            )
        }));
        words.join(" \u{b7} ")
    }

    /// How fast the program under way is.
    fn pace(&self) -> Pace {
        let Some(job) = &self.job else { return Pace::default() };
        let ids: HashSet<&String> = job.program.steps.iter().map(|step| &step.id).collect();
        let records: Vec<_> = ids.iter().filter_map(|id| self.records.get(*id)).collect();
        Pace {
            left: ids.len() - records.len(),
            ended: records.iter().map(|record| record.seconds).collect(),
            running: self.running.values().map(|step| step.since.elapsed().as_secs_f64()).collect(),
            jobs: if job.how.sharing == Sharing::Timing { 1 } else { job.how.jobs },
        }
    }

    fn show_problems(&self, ui: &mut Ui, actions: &mut Vec<ProgramAction>) {
        let Some(checked) = &self.checked else { return };
        if let Some(trouble) = &checked.trouble {
            ui.colored_label(ui.visuals().error_fg_color, trouble);
        }
        for problem in checked.problems.iter().take(MOST_LINES) {
            show_problem(ui, problem, actions);
        }
        if let Some(n_more) = checked.problems.len().checked_sub(MOST_LINES + 1) {
            ui.weak(format!("{} more", n_more + 1));
        }
    }
}

fn show_problem(ui: &mut Ui, problem: &Problem, actions: &mut Vec<ProgramAction>) {
    let color: Color32 = match problem.is_error() {
        true => ui.visuals().error_fg_color,
        false => ui.visuals().warn_fg_color,
    };
    let mut shown = problem.clone();
    // Which program is meant stands above.
    shown.place.program = None;
    let text = RichText::new(format!("\u{26a0} {shown}")).color(color);
    let response = ui.add(egui::Label::new(text).wrap().sense(egui::Sense::click()));
    if let Some(node) = &problem.place.node
        && response.on_hover_text("show the node").clicked()
    {
        actions.push(ProgramAction::ShowNode(node.clone()));
    }
}
