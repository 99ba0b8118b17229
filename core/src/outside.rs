//! Outside programs: started without a shell, heard within bounds, and ended with all that they
//! started.
//!
//! On Unix a program leads a process group of its own. When it ends, is given up or runs out of
//! time, the whole group is killed, so that nothing it started goes on. What leaves its group
//! (a daemon) is not followed. On other systems the program alone is ended.

use std::collections::VecDeque;
use std::ffi::OsString;
use std::io::{self, Read};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crate::control::{Cancelled, Control};

/// Bytes that are kept of the beginning of an output, and as many of its end.
const HALF: usize = 1 << 19;
/// Longest pause between two looks whether it has ended: a cancel is heard within it.
const PAUSE: Duration = Duration::from_millis(20);
/// How long the end of an output is waited for, once the program and its group are gone.
const LAST_WORDS: Duration = Duration::from_millis(500);

/// What to run, and how.
#[derive(Clone, Copy, Debug)]
pub struct OutsideProgram<'a> {
    /// The file of the program.
    pub program: &'a Path,
    /// Its arguments, as they are.
    pub arguments: &'a [OsString],
    /// The folder in which it works and in which it makes its temporary files.
    pub folder: &'a Path,
    /// When it is killed.
    pub time_limit: Option<Duration>,
}

/// How a program ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutsideEnd {
    /// By itself, with this exit code.
    Exited(i32),
    /// By this signal.
    Signal(i32),
    /// It was killed at its time limit.
    OutOfTime,
}

/// What came of a program.
#[derive(Clone, Debug)]
pub struct OutsideOutcome {
    /// How it ended.
    pub end: OutsideEnd,
    /// What it wrote to its standard output.
    pub output: Heard,
    /// What it wrote to its standard error.
    pub errors: Heard,
}

/// What a program said: all of it, or the beginning and the end.
#[derive(Clone, Debug, Default)]
pub struct Heard {
    start: Vec<u8>,
    end: VecDeque<u8>,
    /// Bytes between the two that are not kept.
    n_lost: usize,
}

impl Heard {
    fn add(&mut self, bytes: &[u8]) {
        let (start, rest) = bytes.split_at(bytes.len().min(HALF - self.start.len()));
        self.start.extend(start);
        self.end.extend(rest);
        let n_too_many = self.end.len().saturating_sub(HALF);
        self.end.drain(..n_too_many);
        self.n_lost += n_too_many;
    }

    /// Its lines as a terminal would show them at last: of what a progress bar wrote over itself
    /// the last. A line stands for what was not kept.
    pub fn lines(&self) -> Vec<String> {
        let end: Vec<u8> = self.end.iter().copied().collect();
        let mut lines = Vec::new();
        match self.n_lost {
            0 => push_lines(&[self.start.as_slice(), &end].concat(), &mut lines),
            n => {
                push_lines(&self.start, &mut lines);
                lines.push(format!("… {n} bytes are left out …"));
                push_lines(&end, &mut lines);
            }
        }
        lines
    }
}

fn push_lines(bytes: &[u8], lines: &mut Vec<String>) {
    for line in String::from_utf8_lossy(bytes).lines() {
        let shown = line.rsplit('\r').find(|part| !part.trim().is_empty());
        lines.extend(shown.map(str::to_owned));
    }
}

/// Why a program did not come to an end.
#[derive(Debug)]
pub enum OutsideError {
    /// It could not be started or waited for.
    System(io::Error),
    /// The caller ended it.
    Cancelled,
}

impl From<Cancelled> for OutsideError {
    fn from(Cancelled: Cancelled) -> Self {
        Self::Cancelled
    }
}

/// Runs a program to its end. Its input is empty, and its messages are in English with a point in
/// numbers (`LC_ALL=C`), where it has a choice.
///
/// # Errors
/// Where it cannot be started; that `control` ended it, which kills it within 20 ms.
pub fn run_outside(
    outside: &OutsideProgram,
    control: Control,
) -> Result<OutsideOutcome, OutsideError> {
    let mut command = Command::new(outside.program);
    command.args(outside.arguments).current_dir(outside.folder);
    command.env("TMPDIR", outside.folder).env("LC_ALL", "C");
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    #[cfg(unix)]
    {
        use std::os::unix::process::CommandExt;
        command.process_group(0);
    }
    control.at(0.0)?;
    let start = Instant::now();
    let mut group = Group { child: command.spawn().map_err(OutsideError::System)?, is_over: false };
    let output = Listener::of(group.child.stdout.take());
    let errors = Listener::of(group.child.stderr.take());
    let mut pause = Duration::from_millis(1);
    let mut is_late = false;
    while !group.has_ended().map_err(OutsideError::System)? {
        // A group that is left is killed.
        control.at(0.0)?;
        is_late = outside.time_limit.is_some_and(|limit| start.elapsed() >= limit);
        if is_late {
            break;
        }
        std::thread::sleep(pause);
        pause = (pause * 2).min(PAUSE);
    }
    let status = group.end().map_err(OutsideError::System)?;
    let end = if is_late { OutsideEnd::OutOfTime } else { end_of(status) };
    let deadline = Instant::now() + LAST_WORDS;
    Ok(OutsideOutcome { end, output: output.finish(deadline), errors: errors.finish(deadline) })
}

fn end_of(status: ExitStatus) -> OutsideEnd {
    #[cfg(unix)]
    {
        use std::os::unix::process::ExitStatusExt;
        if let Some(signal) = status.signal() {
            return OutsideEnd::Signal(signal);
        }
    }
    OutsideEnd::Exited(status.code().unwrap_or(-1))
}

/// A program and all that it started, which end when this is dropped.
struct Group {
    child: Child,
    is_over: bool,
}

impl Group {
    /// Whether the program has ended. Its number stays taken, so that no other group can have it.
    #[cfg(unix)]
    fn has_ended(&mut self) -> io::Result<bool> {
        use rustix::process::{Pid, WaitId, WaitIdOptions, waitid};
        let how = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
        match waitid(WaitId::Pid(Pid::from_child(&self.child)), how) {
            Ok(status) => Ok(status.is_some()),
            Err(rustix::io::Errno::INTR) => Ok(false),
            Err(error) => Err(error.into()),
        }
    }

    #[cfg(not(unix))]
    fn has_ended(&mut self) -> io::Result<bool> {
        Ok(self.child.try_wait()?.is_some())
    }

    /// Kills what is left of the group; how the program ended.
    fn end(&mut self) -> io::Result<ExitStatus> {
        self.is_over = true;
        // What is gone already cannot be killed, which is as well.
        #[cfg(unix)]
        let _ = rustix::process::kill_process_group(
            rustix::process::Pid::from_child(&self.child),
            rustix::process::Signal::KILL,
        );
        #[cfg(not(unix))]
        let _ = self.child.kill();
        self.child.wait()
    }
}

impl Drop for Group {
    fn drop(&mut self) {
        if !self.is_over {
            // Nobody is left to hear of it.
            let _ = self.end();
        }
    }
}

/// Reads an output on a thread of its own, so that the program never waits for its reader.
struct Listener {
    heard: Arc<Mutex<Heard>>,
    thread: JoinHandle<()>,
}

impl Listener {
    fn of(pipe: Option<impl Read + Send + 'static>) -> Self {
        let heard = Arc::new(Mutex::new(Heard::default()));
        let shared = Arc::clone(&heard);
        let thread = std::thread::spawn(move || {
            let Some(mut pipe) = pipe else { return };
            let mut bytes = vec![0; 1 << 16];
            loop {
                match pipe.read(&mut bytes) {
                    Ok(0) => return,
                    Ok(n) => shared.lock().unwrap_or_else(PoisonError::into_inner).add(&bytes[..n]),
                    Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                    Err(_) => return,
                }
            }
        });
        Self { heard, thread }
    }

    /// What was heard by the end, or by the deadline: what left the group may hold the pipe open.
    fn finish(self, deadline: Instant) -> Heard {
        while !self.thread.is_finished() && Instant::now() < deadline {
            std::thread::sleep(Duration::from_millis(1));
        }
        std::mem::take(&mut *self.heard.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;

    fn run(words: &[&str], seconds: f64) -> Result<OutsideOutcome, OutsideError> {
        run_until(words, seconds, Control::none())
    }

    fn run_until(
        words: &[&str],
        seconds: f64,
        control: Control,
    ) -> Result<OutsideOutcome, OutsideError> {
        let folder = tempfile::tempdir().unwrap();
        let arguments: Vec<OsString> = words[1..].iter().map(OsString::from).collect();
        let outside = OutsideProgram {
            program: Path::new(words[0]),
            arguments: &arguments,
            folder: folder.path(),
            time_limit: Some(Duration::from_secs_f64(seconds)),
        };
        run_outside(&outside, control)
    }

    /// Whether a program runs that was started with these arguments.
    #[cfg(target_os = "linux")]
    fn runs(words: &[&str]) -> bool {
        let line = words.join("\0") + "\0";
        let of = |entry: std::fs::DirEntry| std::fs::read(entry.path().join("cmdline"));
        let all = std::fs::read_dir("/proc").unwrap().flatten();
        all.filter_map(|entry| of(entry).ok()).any(|found| found == line.as_bytes())
    }

    /// Waits until none does: who is killed needs a moment to die.
    #[cfg(target_os = "linux")]
    fn ends(words: &[&str]) -> bool {
        let deadline = Instant::now() + Duration::from_secs(20);
        while runs(words) && Instant::now() < deadline {
            std::thread::sleep(Duration::from_millis(5));
        }
        !runs(words)
    }

    #[test]
    fn the_end_and_both_outputs_are_told() {
        let done = run(&["/bin/echo", "a", "b c", "$HOME"], 60.0).unwrap();
        assert_eq!(
            (done.end, done.output.lines()),
            (OutsideEnd::Exited(0), vec!["a b c $HOME".into()])
        );
        let failed = run(&["/bin/ls", "/no-such-folder"], 60.0).unwrap();
        assert!(matches!(failed.end, OutsideEnd::Exited(1..)) && failed.output.lines().is_empty());
        let said = failed.errors.lines().join("\n");
        assert!(said.contains("/no-such-folder") && said.contains("No such file"), "{said}");
        let missing = run(&["/no/such/program"], 60.0).unwrap_err();
        assert!(matches!(missing, OutsideError::System(e) if e.kind() == io::ErrorKind::NotFound));
    }

    #[test]
    fn its_folder_is_its_own_and_its_input_is_empty() {
        let folder = tempfile::tempdir().unwrap();
        let arguments = ["TMPDIR", "LC_ALL"].map(OsString::from);
        let program = Path::new("/usr/bin/printenv");
        let outside = OutsideProgram {
            program,
            arguments: &arguments,
            folder: folder.path(),
            time_limit: None,
        };
        let lines = |outside| run_outside(&outside, Control::none()).unwrap().output.lines();
        assert_eq!(lines(outside), [folder.path().to_str().unwrap(), "C"]);
        let pwd = OutsideProgram { program: Path::new("/bin/pwd"), arguments: &[], ..outside };
        assert_eq!(lines(pwd), [folder.path().canonicalize().unwrap().to_str().unwrap()]);
        assert_eq!(run(&["/bin/cat"], 60.0).unwrap().end, OutsideEnd::Exited(0));
    }

    #[test]
    fn of_a_huge_output_both_ends_are_kept() {
        let mut heard = Heard::default();
        (0..300_000).for_each(|n| heard.add(format!("{n}\n").as_bytes()));
        let lines = heard.lines();
        assert_eq!((lines[0].as_str(), lines.last().unwrap().as_str()), ("0", "299999"));
        let left_out = lines.iter().find(|line| line.starts_with('…')).unwrap();
        // 10 + 180 + 2,700 + 36,000 + 450,000 digits, 1,200,000 in the last 200,000, and the ends.
        let n_bytes = 10 + 180 + 2_700 + 36_000 + 450_000 + 1_200_000 + 300_000;
        assert!(left_out.contains(&(n_bytes - (1 << 20)).to_string()), "{left_out}");
        let mut bar = Heard::default();
        bar.add(b"10 %\r20 %\r100 %\r\ndone\r\n\xff");
        assert_eq!(bar.lines(), ["100 %", "done", "\u{fffd}"]);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn at_the_time_limit_what_it_started_ends_too() {
        let sleep = ["sleep", "4711.25"];
        let start = Instant::now();
        let late = run(&["/usr/bin/timeout", "--foreground", "4712", sleep[0], sleep[1]], 0.3);
        assert_eq!(late.unwrap().end, OutsideEnd::OutOfTime);
        assert!(start.elapsed() < Duration::from_secs(20));
        assert!(ends(&sleep));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_cancel_ends_all_at_once_and_so_does_a_program_that_leaves_its_own_behind() {
        let sleep = ["sleep", "4713.25"];
        let (start, has_started) = (Instant::now(), || runs(&sleep));
        let stop =
            |_: f64| if has_started() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        let words = ["/usr/bin/timeout", "--foreground", "4714", sleep[0], sleep[1]];
        let stopped = run_until(&words, 600.0, Control::new(&stop));
        assert!(matches!(stopped, Err(OutsideError::Cancelled)) && ends(&sleep));
        // It ends and leaves a child that holds its output open.
        let left = run(&["/bin/sh", "-c", "sleep 4715.25 & echo started"], 600.0).unwrap();
        assert_eq!(
            (left.end, left.output.lines()),
            (OutsideEnd::Exited(0), vec!["started".into()])
        );
        assert!(ends(&["sleep", "4715.25"]) && start.elapsed() < Duration::from_secs(60));
    }
}
