//! What modules and the window said, in the order in which it was said.

use std::collections::VecDeque;
use std::time::SystemTime;

/// Lines beyond this push the oldest out.
const MOST_LINES: usize = 10_000;

/// How a line matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Loudness {
    /// Good to know.
    Note,
    /// Trouble that did not stop the module.
    Warning,
    /// Trouble that did.
    Error,
}

/// A line of the log.
#[derive(Clone, Debug)]
pub struct Line {
    /// When it was said.
    pub at: SystemTime,
    /// The node that said it; none for the window itself.
    pub node: Option<String>,
    /// How it matters.
    pub loudness: Loudness,
    /// What was said.
    pub text: String,
}

impl Line {
    /// A line that is said now.
    pub fn of(node: Option<&str>, loudness: Loudness, text: impl Into<String>) -> Self {
        let node = node.map(str::to_owned);
        Self { at: SystemTime::now(), node, loudness, text: text.into() }
    }
}

/// The last lines that were said.
#[derive(Debug, Default)]
pub struct Log {
    lines: VecDeque<Line>,
}

impl Log {
    /// Adds a line.
    pub fn add(&mut self, line: Line) {
        if self.lines.len() == MOST_LINES {
            self.lines.pop_front();
        }
        self.lines.push_back(line);
    }

    /// Forgets all lines.
    pub fn clear(&mut self) {
        self.lines.clear();
    }

    /// The lines, oldest first.
    pub fn lines(&self) -> impl DoubleEndedIterator<Item = &Line> {
        self.lines.iter()
    }
}
