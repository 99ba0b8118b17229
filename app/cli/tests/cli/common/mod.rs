//! Running the built command in a folder of its own.

use std::path::Path;
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

/// A map of three nodes with two programs; `sweep` has 6 steps, `long` has 400.
pub fn map() -> String {
    let list = (0..20).map(|n| n.to_string()).collect::<Vec<_>>().join(", ");
    let texts = (0..20).map(|n| format!("\"{n}\"")).collect::<Vec<_>>().join(", ");
    format!(
        r#"{{"mve": 1, "title": "test",
  "nodes": {{
    "level": {{"module": "Constant", "params": {{"value": 2.5}}}},
    "print": {{"module": "Print", "params": {{"label": "level:"}}}},
    "other": {{"module": "Print"}}}},
  "links": ["level.value -> print.value", "level.value -> other.value"],
  "programs": {{
    "sweep": {{"axes": [{{"level.value": [1, 2, 3]}}, {{"print.label": ["x", "y"]}}]}},
    "long": {{"axes": [{{"level.value": [{list}]}}, {{"print.label": [{texts}]}}]}}}}}}"#
    )
}

/// A folder to work in.
pub struct Folder(pub TempDir);

impl Folder {
    /// A folder that holds `map.json`.
    pub fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        folder.write("map.json", &map());
        folder
    }

    pub fn path(&self) -> &Path {
        self.0.path()
    }

    pub fn write(&self, name: &str, text: &str) {
        let path = self.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }

    pub fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path().join(name)).unwrap()
    }

    pub fn has(&self, name: &str) -> bool {
        self.path().join(name).exists()
    }

    pub fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_mve"));
        command.args(args).current_dir(self.path()).stdin(Stdio::null());
        command
    }

    /// Runs the command, and checks what holds for every call.
    pub fn mve(&self, args: &[&str]) -> Answer {
        let answer = Answer::new(self.command(args).output().unwrap());
        assert!(!answer.err.contains("panicked"), "{args:?}: {}", answer.err);
        let controls = |text: &str| text.contains(|c: char| c.is_control() && c != '\n');
        assert!(!controls(&answer.out) && !controls(&answer.err), "{args:?}: {answer:?}");
        answer
    }
}

/// What the command answered.
#[derive(Debug)]
pub struct Answer {
    pub code: i32,
    pub out: String,
    pub err: String,
}

impl Answer {
    pub fn new(output: Output) -> Self {
        Self {
            code: output.status.code().unwrap(),
            out: String::from_utf8(output.stdout).unwrap(),
            err: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// Ends with this code, and says this on standard error.
    #[track_caller]
    pub fn fails(self, code: i32, message: &str) -> Self {
        assert_eq!(self.code, code, "{self:?}");
        assert!(self.err.contains(message), "{:?} lacks {message:?}", self.err);
        self
    }

    #[track_caller]
    pub fn succeeds(self) -> Self {
        assert_eq!(self.code, 0, "{self:?}");
        self
    }

    #[track_caller]
    pub fn says(self, text: &str) -> Self {
        assert!(self.out.contains(text), "{:?} lacks {text:?}", self.out);
        self
    }

    /// Standard output as JSON, a value a line.
    pub fn json(&self) -> Vec<serde_json::Value> {
        self.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
    }
}
