//! The question before outside programs run that a map names: it may come from a stranger.

use std::collections::BTreeSet;

use eframe::egui::{Modal, RichText, ScrollArea, Ui};
use mve_core::{Retry, printable};

use super::Editor;
use crate::runner::Part;

/// What is said beforehand of a map that runs outside programs.
pub const ASKS_FIRST: &str = "asks before it runs an outside program";

/// A run that waits for an answer.
#[derive(Clone, Debug, PartialEq)]
pub struct CommandQuestion {
    /// The nodes, each with the command that it would run.
    pub commands: BTreeSet<(String, String)>,
    /// What was to run.
    pub run: WaitingRun,
}

/// What waits for an answer.
#[derive(Clone, Debug, PartialEq)]
pub enum WaitingRun {
    /// A part of the map.
    Map(Part),
    /// The program that is shown.
    Program(Retry),
}

impl Editor {
    /// Asks whether outside programs may run, where a run waits for that.
    pub(super) fn command_box(&mut self, ui: &mut Ui) {
        let Some(question) = self.session_mut().question.take() else { return };
        let mut answer = None;
        let shown = Modal::new("outside programs".into()).show(ui.ctx(), |ui| {
            ui.set_width(520.0);
            ui.heading("Run outside programs?");
            ui.label(
                "This map runs other programs. They can do whatever you can: read, change and \
                 delete your files, and use the network. Allow them only if you know what they do \
                 and trust who made the map.",
            );
            ui.add_space(6.0);
            ScrollArea::vertical().max_height(260.0).show(ui, |ui| {
                for (node, command) in &question.commands {
                    ui.strong(printable(node));
                    ui.label(RichText::new(printable(command)).monospace());
                    ui.add_space(4.0);
                }
            });
            ui.horizontal(|ui| {
                if ui.button("Cancel").clicked() {
                    answer = Some(Answer::Nothing);
                }
                if matches!(question.run, WaitingRun::Map(_))
                    && ui.button("Run the rest without them").clicked()
                {
                    answer = Some(Answer::Without);
                }
                if ui.button("Run them").clicked() {
                    answer = Some(Answer::Allow);
                }
            });
        });
        match answer {
            Some(Answer::Allow) => self.run_allowed(question),
            Some(Answer::Without) => {
                if let WaitingRun::Map(part) = question.run {
                    self.session_mut().run_without_commands(part);
                }
            }
            Some(Answer::Nothing) => {}
            None if shown.should_close() => {}
            None => self.session_mut().question = Some(question),
        }
    }

    fn run_allowed(&mut self, question: CommandQuestion) {
        let lines = question.commands.into_iter().map(|(_, command)| command);
        self.session_mut().allow_commands(lines);
        match question.run {
            WaitingRun::Map(part) => self.session_mut().run(part),
            WaitingRun::Program(retry) => {
                let Self { sessions, active, shared, .. } = self;
                let (panel, scene) = sessions[*active].programs(shared);
                panel.run(&scene, retry);
            }
        }
    }
}

enum Answer {
    Nothing,
    Without,
    Allow,
}
