//! What a reader says of a file besides its mesh.

/// Something in a file that is left out or doubtful; the rest was read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// The first line that it is about, from 1; `None` when it is about the whole file.
    pub line: Option<usize>,
    /// How many lines it is about.
    pub n_lines: usize,
    /// What it is.
    pub text: String,
}

impl std::fmt::Display for Warning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.line {
            Some(line) => write!(f, "line {line}: {}", self.text)?,
            None => f.write_str(&self.text)?,
        }
        match self.n_lines {
            0 | 1 => Ok(()),
            n => write!(f, " (and {} more like it)", n - 1),
        }
    }
}

/// Warnings of one file, those of the same text gathered into one.
#[derive(Default)]
pub(crate) struct Warnings {
    list: Vec<Warning>,
}

impl Warnings {
    /// Kinds of warning that are told apart; files of noise have no end of them.
    pub(crate) const MOST: usize = 64;

    /// Adds one about a line.
    pub fn add(&mut self, line: usize, text: &str) {
        match self.list.iter_mut().find(|warning| warning.text == text) {
            Some(warning) => warning.n_lines += 1,
            None => self.push(Warning { line: Some(line), n_lines: 1, text: text.to_owned() }),
        }
    }

    /// Adds one about the whole file.
    pub fn add_general(&mut self, text: String) {
        self.push(Warning { line: None, n_lines: 1, text });
    }

    /// Adds one about the whole file that may come up again and again.
    pub fn add_once(&mut self, text: String) {
        if !self.list.iter().any(|warning| warning.text == text) {
            self.add_general(text);
        }
    }

    /// Adds one whose text is not there yet.
    pub fn push(&mut self, warning: Warning) {
        const MORE: &str = "more kinds of lines are left out";
        if self.list.len() < Self::MOST {
            self.list.push(warning);
        } else if let Some(last) = self.list.last_mut() {
            if last.text == MORE {
                last.n_lines += warning.n_lines;
            } else {
                *last = Warning { text: MORE.to_owned(), ..warning };
            }
        }
    }

    /// The warnings in the order in which they came up.
    pub fn into_list(self) -> Vec<Warning> {
        self.list
    }
}
