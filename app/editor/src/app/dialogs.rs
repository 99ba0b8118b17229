//! The file dialogs of the system. They run beside the window, which goes on drawing.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::{Duration, Instant};

use crate::runner::Shared;

/// What a chosen file is for.
#[derive(Clone, Debug, PartialEq)]
pub enum Purpose {
    /// A map to open.
    OpenMap,
    /// Where to save the map of this number.
    SaveMap(u64),
    /// A parameter that names a file to read: number of the map, node, path of the parameter.
    Param(u64, String, String),
    /// A file to be shown by another program.
    Show(PathBuf),
}

/// What came of a dialog, or of opening a file.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer {
    /// This file was chosen.
    Chosen(PathBuf),
    /// It seems that the system has none.
    NoDialog,
    /// No program of the system opened this file.
    NotOpened(PathBuf),
}

/// A dialog that is closed sooner than this was never seen by anybody.
const TOO_SOON: Duration = Duration::from_millis(400);

/// A dialog that is open.
struct Dialog {
    purpose: Purpose,
    since: Instant,
    /// The chosen file; for a file to be shown, the file once it is.
    answer: Receiver<Option<PathBuf>>,
}

/// The dialogs that are open.
#[derive(Default)]
pub struct Dialogs {
    open: Vec<Dialog>,
}

impl Dialogs {
    /// Opens a dialog, unless one for the same purpose is open.
    pub fn ask(
        &mut self,
        purpose: Purpose,
        extensions: &[&str],
        folder: PathBuf,
        shared: &Arc<Shared>,
    ) {
        if self.open.iter().any(|open| open.purpose == purpose) {
            return;
        }
        let mut dialog = rfd::AsyncFileDialog::new();
        if folder.is_dir() {
            dialog = dialog.set_directory(&folder);
        }
        if !extensions.is_empty() {
            dialog = dialog.add_filter(extensions.join(", "), extensions);
        }
        let (sender, receiver) = channel();
        let since = Instant::now();
        let shared = Arc::clone(shared);
        let answer = move |file: Option<rfd::FileHandle>| {
            // The window may be gone; then nobody waits for the answer.
            let _ = sender.send(file.map(|file| file.path().to_owned()));
            (shared.wake)();
        };
        // On macOS the dialog must be made on the main thread; waiting for it may be anywhere.
        if matches!(purpose, Purpose::SaveMap(_)) {
            let asked = dialog.set_file_name("map.json").save_file();
            std::thread::spawn(move || answer(pollster::block_on(asked)));
        } else {
            let asked = dialog.pick_file();
            std::thread::spawn(move || answer(pollster::block_on(asked)));
        }
        self.open.push(Dialog { purpose, since, answer: receiver });
    }

    /// Has the system open a file or a folder.
    pub fn open_file(&mut self, path: PathBuf, shared: &Arc<Shared>) {
        let (sender, answer) = channel();
        let (shared, since) = (Arc::clone(shared), Instant::now());
        self.open.push(Dialog { purpose: Purpose::Show(path.clone()), since, answer });
        std::thread::spawn(move || {
            let opened = open::that(&path).is_ok();
            // The window may be gone; then nobody waits for the answer.
            let _ = sender.send(opened.then_some(path));
            (shared.wake)();
        });
    }

    /// What came of dialogs since the last call. One that a person closed gives nothing.
    pub fn answers(&mut self) -> Vec<(Purpose, Answer)> {
        let mut answers = Vec::new();
        self.open.retain(|dialog| match dialog.answer.try_recv() {
            Ok(chosen) => {
                let answer = match (chosen, &dialog.purpose) {
                    (Some(_), Purpose::Show(_)) => None,
                    (None, Purpose::Show(path)) => Some(Answer::NotOpened(path.clone())),
                    (Some(path), _) => Some(Answer::Chosen(path)),
                    (None, _) => (dialog.since.elapsed() < TOO_SOON).then_some(Answer::NoDialog),
                };
                answers.extend(answer.map(|answer| (dialog.purpose.clone(), answer)));
                false
            }
            Err(TryRecvError::Empty) => true,
            Err(TryRecvError::Disconnected) => false,
        });
        answers
    }
}
