//! Runs an outside program on files that are made of the inputs.
//!
//! The program is started with a list of arguments and no shell (see the kind
//! [`CommandLine`]), in a folder of its own that is gone afterwards, with an empty input. When it
//! ends, all that it started is ended with it. The key of the node has the content of the program's
//! file, of files that `{file:…}` names, and all arguments; what else the program looks at (its
//! libraries, its settings, the network) is beyond mve, so a program whose results hang on that
//! gives wrong values from a cache. A plan refuses the node unless outside programs are allowed.

use std::path::Path;
use std::time::Duration;

use mve_core::{
    CommandLine, CommandLineSpec, CommandPlace, CommandWay, Heard, OutsideEnd, OutsideError,
    OutsideOutcome, OutsideProgram, printable, run_outside,
};
use mve_formats::mesh_file::{self, Reader};
use mve_formats::number_pattern::NumberPatterns;
use mve_mesh::data::Measure;

use crate::prelude::*;

/// Lines of the beginning of an output that go to the log, and as many of its end.
const HALF_OF_LINES: usize = 50;
/// Longest line in the log, in characters.
const LONGEST_LINE: usize = 500;
/// Lines that an error quotes.
const QUOTED: usize = 3;

const MESH: &str = "mesh";
const OTHER: &str = "other";

const MESH_IN: MaybeIn<TriMesh> =
    MaybeIn::new(MESH, "What {in.mesh} stands for; {in.mesh:obj} has it as an OBJ file.");
const OTHER_IN: MaybeIn<TriMesh> =
    MaybeIn::new(OTHER, "What {in.other} stands for, such as the original to compare with.");
const MESH_OUT: Out<TriMesh> = Out::new(
    MESH,
    "What the program wrote as {out.mesh}; where the command has no such place the input mesh, or \
     nothing if there is none.",
);
const MEASURES_OUT: Out<Measures> =
    Out::new("measures", "The numbers that the patterns found; each is a column of the results.");

const COMMAND: Param<CommandLine> = Param::command_line(
    "command",
    "The program and its arguments, as a list: [\"meshfix\", \"{in.mesh:off}\", \"-o\", \
     \"{out.mesh:off}\"]; a text is split at blanks. There is no shell. {in.mesh}, {in.other} and \
     {out.mesh} are paths of files, PLY if no ending is said; {file:fix.py} is a file beside the \
     map.",
    CommandLineSpec { reads: &[MESH, OTHER], writes: &[MESH], endings: &mesh_file::WRITTEN },
);
const PATTERNS: Param<String> = Param::text(
    "patterns",
    "Numbers to take from what the program writes to its standard output and error: max : {max} \
     takes the number behind max : as the measure max, from the last line that fits. More than one \
     are parted by semicolons; {_} is a number that is not kept.",
    "",
);
const TIME_LIMIT: Param<Option<f64>> = Param::maybe_number(
    "time_limit",
    "When the program and all that it started are killed. Off: never.",
    Some(600.0),
)
.within((0.001, 1e7))
.usually((1.0, 3600.0))
.unit("seconds");
const ANY_EXIT_CODE: Param<bool> = Param::flag(
    "any_exit_code",
    "Go on whatever the program's exit code, for programs that tell a result by it. Else every code \
     but 0 is an error.",
    false,
);

pub static MODULE: Module = Module {
    id: "Command",
    summary: "Runs an outside program on the meshes, and takes a mesh and numbers from it.",
    inputs: &[MESH_IN.spec(), OTHER_IN.spec()],
    outputs: &[MESH_OUT.spec(), MEASURES_OUT.spec()],
    params: &[COMMAND.spec(), PATTERNS.spec(), TIME_LIMIT.spec(), ANY_EXIT_CODE.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let line = io.param(COMMAND)?;
    let patterns = NumberPatterns::read(&io.param(PATTERNS)?);
    let patterns = patterns.map_err(|why| ModuleError::param(&PATTERNS, why))?;
    let scratch = tempfile::Builder::new().prefix("mve-command-").tempdir().map_err(|error| {
        let folder = std::env::temp_dir();
        ModuleError::io(&folder, format!("cannot make a folder here: {error}; set TMPDIR"))
    })?;
    let path_of = |place: &CommandPlace| {
        let way = if place.way == CommandWay::In { "in" } else { "out" };
        scratch.path().join(format!("{way}-{}.{}", place.name, place.ending))
    };
    let places = line.places();
    for place in places.iter().filter(|place| place.way == CommandWay::In) {
        let port = if place.name == OTHER { OTHER_IN } else { MESH_IN };
        let mesh = io.maybe(port).ok_or_else(|| ModuleError::Input {
            port: place.name.clone(),
            message: format!("nothing is linked here, and the command names {place}"),
        })?;
        let control = io.control().part(0.0, 0.1);
        let changes = mesh_file::save(mesh, &path_of(place), Reader::Program, control)?;
        changes.iter().for_each(|change| io.warn(format!("{place}: {change}")));
    }
    let outcome = run_program(io, &line, &line.arguments(path_of), scratch.path())?;
    let lines = [outcome.output.lines(), outcome.errors.lines()].concat();
    let found = patterns.find(&lines).map_err(|why| {
        let said = quoted(&outcome);
        ModuleError::param(&PATTERNS, format!("{why}; what the program wrote ends so: {said}"))
    })?;
    let measure = |(name, value): (String, f64)| Measure {
        doc: format!("The number {name} that the program wrote.").into(),
        name: name.into(),
        value,
        unit: "".into(),
    };
    io.put(MEASURES_OUT, Measures(found.into_iter().map(measure).collect()));
    match places.iter().find(|place| place.way == CommandWay::Out) {
        Some(place) => {
            let mesh = read_back(io, place, &path_of(place), &outcome)?;
            io.put(MESH_OUT, mesh);
        }
        None => io.put_shared(MESH_OUT, io.maybe(MESH_IN).unwrap_or_default()),
    }
    Ok(())
}

/// Runs the program, logs what it said, and refuses a bad end.
fn run_program(
    io: &Io,
    line: &CommandLine,
    arguments: &[std::ffi::OsString],
    folder: &Path,
) -> Result<OutsideOutcome, ModuleError> {
    let seconds = io.param(TIME_LIMIT)?;
    let program = line.program();
    let outside = OutsideProgram {
        program,
        arguments,
        folder,
        time_limit: seconds.map(Duration::from_secs_f64),
    };
    let outcome =
        run_outside(&outside, io.control().part(0.1, 0.9)).map_err(|error| match error {
            OutsideError::Cancelled => ModuleError::Cancelled,
            OutsideError::System(error) => ModuleError::io(
                program,
                format!("cannot be started: {error}; is it a program of this system?"),
            ),
        })?;
    log(io, &outcome.output);
    log(io, &outcome.errors);
    let said = || match quoted(&outcome) {
        said if said.is_empty() => "it said nothing".to_owned(),
        said => format!("it said: {said}"),
    };
    match outcome.end {
        OutsideEnd::Exited(code) => {
            io.log(format!("exit code {code}"));
            if code != 0 && !io.param(ANY_EXIT_CODE)? {
                let message = format!("the program ended with exit code {code}; {}", said());
                return Err(ModuleError::Failed(message));
            }
        }
        OutsideEnd::Signal(signal) => {
            let message = format!("the program was ended by signal {signal}; {}", said());
            return Err(ModuleError::Failed(message));
        }
        OutsideEnd::OutOfTime => {
            let seconds = seconds.unwrap_or_default();
            let message = format!("the program did not end within {seconds} seconds; {}", said());
            return Err(ModuleError::param(&TIME_LIMIT, message));
        }
    }
    Ok(outcome)
}

/// A line as a log can show it.
fn shown(line: &str) -> String {
    match line.char_indices().nth(LONGEST_LINE) {
        Some((end, _)) => printable(&line[..end]).into_owned() + "…",
        None => printable(line).into_owned(),
    }
}

/// Logs an output, of a long one both ends.
fn log(io: &Io, heard: &Heard) {
    let lines = heard.lines();
    if lines.len() <= 2 * HALF_OF_LINES {
        lines.iter().for_each(|line| io.log(shown(line)));
        return;
    }
    lines[..HALF_OF_LINES].iter().for_each(|line| io.log(shown(line)));
    io.log(format!("… {} lines are left out …", lines.len() - 2 * HALF_OF_LINES));
    lines[lines.len() - HALF_OF_LINES..].iter().for_each(|line| io.log(shown(line)));
}

/// The last lines that a program said, of its errors if it had any.
fn quoted(outcome: &OutsideOutcome) -> String {
    let errors = outcome.errors.lines();
    let lines = if errors.is_empty() { outcome.output.lines() } else { errors };
    let last = &lines[lines.len().saturating_sub(QUOTED)..];
    last.iter().map(|line| shown(line.trim())).collect::<Vec<_>>().join(" / ")
}

/// Reads the mesh that the program wrote.
fn read_back(
    io: &Io,
    place: &CommandPlace,
    path: &Path,
    outcome: &OutsideOutcome,
) -> Result<TriMesh, ModuleError> {
    if !path.exists() {
        let message = format!(
            "the program wrote no file {place}; look at its arguments, and at what it said: {}",
            quoted(outcome)
        );
        return Err(ModuleError::Failed(message));
    }
    let read = mesh_file::load_by_ending(path, io.control().part(0.9, 1.0));
    let (mesh, warnings) = read.map_err(|error| match error {
        // The path is one of a folder that is gone when the message is read.
        ModuleError::Io { message, .. } => {
            ModuleError::Failed(format!("what the program wrote as {place}: {message}"))
        }
        other => other,
    })?;
    warnings.iter().for_each(|warning| io.warn(format!("{place}: {warning}")));
    Ok(mesh)
}

#[cfg(test)]
#[cfg(unix)]
#[path = "command_tests.rs"]
mod tests;
