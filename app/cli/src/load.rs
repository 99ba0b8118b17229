//! Reading a map with the settings of the command line, and saying what is wrong with it.

use std::io::{ErrorKind, Read};
use std::path::{Component, Path, PathBuf};

use mve_core::{
    CommandScope, FileHashes, MODULE, Map, MapError, OutputScope, ParamSpec, Place, Plan,
    PlanOptions, Position, Problem, Registry, assign, chosen, declared_at,
};
use serde_json::Value as Json;

use crate::exit::{Exit, Stop, explain};
use crate::out;
use crate::out::{error_mark, warning_mark};

/// The map, and what the command line changes in it.
#[derive(clap::Args)]
pub struct MapArgs {
    /// The map's file; - for standard input
    pub map: PathBuf,
    #[command(flatten)]
    set: SetArgs,
}

/// What the command line changes in a map.
#[derive(clap::Args)]
pub struct SetArgs {
    /// Set a parameter: simplify.target_faces=300, simplify.cost.boundary_weight=5
    ///
    /// The value is read as JSON, and as a text where it is not JSON. NODE.module=Id puts another
    /// module in a node's place. Input files are relative to the working directory, output files
    /// to the output folder.
    #[arg(long, value_name = "NODE.PARAM=VALUE", value_parser = parse_assignment)]
    pub set: Vec<Assignment>,
}

/// One `--set`.
#[derive(Clone, Debug, PartialEq)]
pub struct Assignment {
    path: String,
    value: Json,
    /// The value as it was typed.
    text: String,
}

fn parse_assignment(text: &str) -> Result<Assignment, String> {
    let form = "write NODE.PARAM=VALUE, such as simplify.target_faces=300";
    let (path, value) = text.split_once('=').ok_or(form)?;
    if !path.contains('.') {
        return Err(form.to_owned());
    }
    let (path, text) = (path.trim().to_owned(), value.to_owned());
    let value = serde_json::from_str(value).unwrap_or_else(|_| Json::from(value));
    Ok(Assignment { path, value, text })
}

impl Assignment {
    /// The value for the parameter that it is meant for: a text stays one even where it looks like
    /// a number, and files are where the person who types is, not where the map is.
    fn value_for(&self, map: &Map, registry: &Registry, map_folder: &Path) -> Json {
        let Some((node, path)) = self.path.split_once('.') else { return self.value.clone() };
        let Some(node) = map.nodes.get(node) else { return self.value.clone() };
        if path == MODULE {
            let specs = |id: &str| registry.find(id).map(|info| info.module.params);
            return with_files_seen(&self.value, &specs, map_folder);
        }
        let specs = registry.find(&node.module).map_or(&[][..], |info| info.module.params);
        let Some(spec) = declared_at(specs, Some(&node.params), path) else {
            return self.value.clone();
        };
        let is_word = spec.is_text() || spec.input_file().is_some() || spec.output_file().is_some();
        match &self.value {
            Json::String(_) | Json::Null => seen(&spec, &self.value, map_folder),
            _ if is_word => seen(&spec, &self.text.clone().into(), map_folder),
            _ => seen(&spec, &self.value, map_folder),
        }
    }
}

/// The value of a parameter with its files as the map in this folder names them.
fn seen(spec: &ParamSpec, value: &Json, map_folder: &Path) -> Json {
    match value {
        Json::String(path) if spec.input_file().is_some() => {
            let seen = seen_from(map_folder, Path::new(path));
            seen.unwrap_or_else(|| path.into()).to_string_lossy().into_owned().into()
        }
        _ => {
            let options = spec.options();
            let specs = |id: &str| options.iter().find(|option| option.id == id).map(|o| o.params);
            with_files_seen(value, &specs, map_folder)
        }
    }
}

/// The same of `{id: {parameters}}`, a module or an entry of a choice; anything else as it is.
fn with_files_seen(
    value: &Json,
    specs: &dyn Fn(&str) -> Option<&'static [ParamSpec]>,
    map_folder: &Path,
) -> Json {
    let Some((id, Some(params))) = chosen(value) else { return value.clone() };
    let Some(specs) = specs(id) else { return value.clone() };
    let param = |(name, value): (&String, &Json)| {
        let spec = specs.iter().find(|spec| spec.name == name);
        let value = spec.map_or_else(|| value.clone(), |spec| seen(spec, value, map_folder));
        (name.clone(), value)
    };
    let params: serde_json::Map<String, Json> = params.iter().map(param).collect();
    serde_json::json!({ id: params })
}

/// A file as a map in this folder names it: relative to the folder, as tables then show it.
/// `None` where the system does not say where either is.
fn seen_from(folder: &Path, file: &Path) -> Option<PathBuf> {
    let file = std::path::absolute(file).ok()?;
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let folder = std::path::absolute(folder).ok()?;
    // What `..` means behind a link depends on where the link leads.
    let is_plain = |path: &Path| path.components().all(|part| part != Component::ParentDir);
    let n_same = folder.components().zip(file.components()).take_while(|(a, b)| a == b).count();
    if !is_plain(&folder) || !is_plain(&file) || n_same < 2 || folder.canonicalize().ok()? != folder
    {
        return Some(file);
    }
    let up = folder.components().skip(n_same).map(|_| Component::ParentDir);
    Some(up.chain(file.components().skip(n_same)).collect())
}

/// The folder of a file.
fn folder_of(file: &Path) -> &Path {
    file.parent().unwrap_or(Path::new(""))
}

/// What stands for the name of a map that comes from standard input.
const STDIN: &str = "stdin";

fn read_stdin() -> Result<Map, MapError> {
    let mut text = String::new();
    // As much as the largest map, and one byte more.
    let read = std::io::stdin().take(Map::LARGEST_FILE + 1).read_to_string(&mut text);
    read.map_err(|source| MapError::Io { path: STDIN.into(), source })?;
    Map::parse(&text)
}

/// A map that was read, with all that checking it needs.
pub struct Loaded {
    /// The map, `--set` applied.
    pub map: Map,
    /// What it can use.
    pub registry: Registry,
    /// Its file, as the person wrote it.
    pub path: PathBuf,
    /// What is wrong with the settings of the command line.
    pub complaints: Vec<Problem>,
}

impl MapArgs {
    /// Reads the map and sets what the command line sets.
    pub fn load(&self) -> Result<Loaded, Stop> {
        self.set.load(&self.map)
    }

    /// The paths that `--set` names.
    pub fn set_paths(&self) -> impl Iterator<Item = &str> {
        self.set.set.iter().map(|assignment| assignment.path.as_str())
    }

    /// Paths and values of what `--set` sets.
    pub fn settings(&self, loaded: &Loaded) -> Vec<(String, Json)> {
        let value = |assignment: &Assignment| {
            (
                assignment.path.clone(),
                assignment.value_for(&loaded.map, &loaded.registry, loaded.folder()),
            )
        };
        self.set.set.iter().map(value).collect()
    }
}

impl SetArgs {
    /// Reads a map and sets what the command line sets.
    pub fn load(&self, path: &Path) -> Result<Loaded, Stop> {
        let is_stdin = path == Path::new("-");
        let read = if is_stdin { read_stdin() } else { Map::load(path) };
        let mut map = read.map_err(|error| explain_map(path, error))?;
        let file = if is_stdin { PathBuf::from(STDIN) } else { path.to_owned() };
        let registry = mve_modules::registry().with_maps_of(&map, folder_of(&file));
        let mut assignments: Vec<_> = self.set.iter().collect();
        // Modules and choices are set before their own parameters, whatever the order on the line.
        let is_module = |path: &str| path.split_once('.').is_some_and(|(_, p)| p == "module");
        assignments.sort_by_key(|s| (!is_module(&s.path), s.path.split('.').count()));
        let mut complaints = Vec::new();
        for assignment in assignments {
            let path = &assignment.path;
            let value = assignment.value_for(&map, &registry, folder_of(&file));
            if let Err(problem) = assign(&mut map, &registry, path, value) {
                let message = format!("--set {path}: {}", problem.message);
                complaints.push(Problem { message, place: Place::default(), ..problem });
            }
        }
        Ok(Loaded { map, registry, path: file, complaints })
    }
}

fn explain_map(path: &Path, error: MapError) -> Stop {
    let path = path.display();
    match error {
        MapError::Io { source, .. } => {
            let what = match source.kind() {
                ErrorKind::NotFound => "there is no such map".to_owned(),
                ErrorKind::IsADirectory => "is a folder; name a map's file in it".to_owned(),
                _ => explain(&source),
            };
            Stop { exit: Exit::Files, message: format!("{path}: {what}") }
        }
        error => Stop::refused(format!("{path}: {error}")),
    }
}

impl Loaded {
    /// The folder that input paths are relative to.
    pub fn folder(&self) -> &Path {
        folder_of(&self.path)
    }

    /// Checks the map, together with the settings of the command line.
    pub fn plan(
        &self,
        out: Option<&Path>,
        scope: OutputScope,
        command_scope: CommandScope,
    ) -> Result<Plan, Vec<Problem>> {
        let options = PlanOptions {
            map_folder: self.folder(),
            output_folder: out,
            output_scope: scope,
            command_scope,
            repeat: 0,
            files: &FileHashes::new(),
        };
        let plan = Plan::new(&self.map, &self.registry, &options);
        if self.complaints.is_empty() {
            return plan;
        }
        let others = plan.map_or_else(|problems| problems, |plan| plan.warnings);
        Err(self.complaints.iter().cloned().chain(others).collect())
    }

    /// Says all problems on standard error, and as JSON on standard output where that is asked
    /// for; the error counts them.
    pub fn refuse(&self, problems: &[Problem], json: bool) -> Stop {
        self.report(problems, json);
        let n_errors = problems.iter().filter(|problem| problem.is_error()).count();
        if json {
            // The refusal itself is told by the exit code, should this line not arrive.
            let last = serde_json::json!({
                "event": "finished", "status": "refused", "errors": n_errors
            });
            let _ = out::event(&last);
        }
        let path = self.path.display();
        let count = if n_errors == 1 { "1 problem".into() } else { format!("{n_errors} problems") };
        Stop::refused(format!("{path}: {count}; nothing was run"))
    }

    /// Says problems, one line each.
    pub fn report(&self, problems: &[Problem], json: bool) {
        for problem in problems {
            if json {
                // A reader that is gone reads no more problems.
                let _ = out::event(&self.problem_line(problem));
            }
            let mark = if problem.is_error() { error_mark() } else { warning_mark() };
            out::tell(&format!("{mark} {}: {problem}", self.place_of(problem)));
        }
    }

    /// The map's file, and line and column of a problem where they are known, as text editors and
    /// terminals open them.
    pub fn place_of(&self, problem: &Problem) -> String {
        let path = self.path.display();
        match self.map.position_of(problem) {
            Some(Position { line, column }) => format!("{path}:{line}:{column}"),
            None => path.to_string(),
        }
    }

    /// A problem as an event.
    pub fn problem_line<'a>(&self, problem: &'a Problem) -> ProblemLine<'a> {
        ProblemLine { event: "problem", problem, position: self.map.position_of(problem) }
    }
}

/// Whether a person allows outside programs, on the command line.
#[derive(Clone, Copy, clap::Args)]
pub struct CommandArgs {
    /// Let the map run outside programs, which can do whatever you can: for maps that you trust.
    /// `mve check` lists them
    #[arg(long)]
    allow_commands: bool,
}

impl CommandArgs {
    /// What a plan may run.
    pub fn scope(self) -> CommandScope<'static> {
        if self.allow_commands { CommandScope::All } else { CommandScope::Nothing }
    }
}

/// A problem among events.
#[derive(serde::Serialize)]
pub struct ProblemLine<'a> {
    event: &'static str,
    #[serde(flatten)]
    problem: &'a Problem,
    #[serde(flatten)]
    position: Option<Position>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_json_or_text() {
        let value = |text: &str| parse_assignment(text).unwrap().value;
        assert_eq!(value("a.x=5"), Json::from(5));
        assert_eq!(value("a.x=null"), Json::Null);
        assert_eq!(value("a.x=Quadric"), Json::from("Quadric"));
        assert_eq!(value("a.x=\"5\""), Json::from("5"));
        assert_eq!(value("a.x={\"Q\": {\"w\": 1}}")["Q"]["w"], Json::from(1));
        assert_eq!(value("a.x=b=c"), Json::from("b=c"));
        assert_eq!(value("a.x="), Json::from(""));
        assert!(parse_assignment("a.x").is_err() && parse_assignment("x=5").is_err());
    }

    #[cfg(unix)]
    #[test]
    fn a_file_is_named_as_seen_from_the_map() {
        let base = tempfile::tempdir().unwrap();
        let base = base.path().canonicalize().unwrap();
        let maps = base.join("maps");
        std::fs::create_dir(&maps).unwrap();
        let seen = |folder: &Path, file: &str| seen_from(folder, &base.join(file)).unwrap();
        assert_eq!(seen(&maps, "maps/a.obj"), Path::new("a.obj"));
        assert_eq!(seen(&maps, "scans/b/a.obj"), Path::new("../scans/b/a.obj"));
        // Behind a link `..` leads elsewhere.
        std::os::unix::fs::symlink(&maps, base.join("link")).unwrap();
        assert_eq!(seen(&base.join("link"), "scans/a.obj"), base.join("scans/a.obj"));
        // Nothing in common but the root.
        let other = seen_from(&maps, Path::new("/elsewhere/a.obj")).unwrap();
        assert_eq!(other, Path::new("/elsewhere/a.obj"));
    }
}
