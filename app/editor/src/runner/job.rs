//! One run, on a thread of its own.

use std::sync::mpsc::Sender;

use mve_core::{CancelToken, Event, EventKind, Keep, OutputScope, RunOptions, run};

use super::check::{Part, check};
use super::log::{Line, Loudness};
use super::{Message, NodeResult, PART_OF_ANOTHER, Shared, Subject};

/// Plans a part of the map and runs it. Everything that happens is told; nothing is returned.
pub fn run_job(
    subject: &Subject,
    part: &Part,
    shared: &Shared,
    outbox: &Sender<Message>,
    cancel: &CancelToken,
) {
    // A window that was closed hears nothing, and the run is cancelled then.
    let tell = |message| {
        let _ = outbox.send(message);
        (shared.wake)();
    };
    let (of_part, plan) = check(subject, part.clone(), shared);
    // The check above was of a part; the window shows the problems of the whole.
    let (checked, _) = check(subject, Part::All, shared);
    tell(Message::Checked(Box::new(checked)));
    if subject.asks && *part != Part::Quiet && !of_part.unasked.is_empty() {
        tell(Message::Asks(of_part.unasked, part.clone()));
        tell(Message::Finished);
        return;
    }
    let Some(plan) = plan else {
        let text = match of_part.is_part {
            true => PART_OF_ANOTHER,
            false => "nothing can run: the map is empty, or its nodes have problems",
        };
        tell(Message::Said(Line::of(None, Loudness::Error, text)));
        tell(Message::Finished);
        return;
    };
    tell(Message::Planned(plan.nodes.iter().map(|node| (node.name.clone(), node.key)).collect()));
    let observer = |event: &Event| {
        let node = event.node;
        let said = |loudness, text: &str| Message::Said(Line::of(Some(node), loudness, text));
        tell(match event.kind {
            EventKind::Started => Message::Started(node.to_owned()),
            EventKind::Progress { share } => Message::Progress(node.to_owned(), share.min(0.999)),
            EventKind::Log { text } => said(Loudness::Note, text),
            EventKind::Warning { text } => said(Loudness::Warning, text),
            EventKind::Ended { record, outputs } => {
                let module = plan.find(node).map(|node| node.info.module);
                let specs = module.filter(|_| !outputs.is_empty()).map(|module| module.outputs);
                let names = specs.into_iter().flatten().map(|output| output.name).collect();
                let (record, outputs) = (record.clone(), outputs.to_vec());
                let ended = NodeResult { record, outputs, names };
                Message::Ended(node.to_owned(), Box::new(ended))
            }
        });
    };
    if let Err(error) = std::fs::create_dir_all(&shared.output_folder) {
        let folder = shared.output_folder.display();
        let text = format!("the output folder {folder} cannot be made: {error}");
        tell(Message::Said(Line::of(None, Loudness::Warning, text)));
    }
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
    let options = RunOptions {
        output_folder: &shared.output_folder,
        threads,
        cache: Some(&shared.cache),
        cancel,
        observer: &observer,
        keep: Keep::Scalars,
        memory: None,
        output_scope: OutputScope::Folder,
    };
    run(&plan, &options);
    tell(Message::Finished);
}
