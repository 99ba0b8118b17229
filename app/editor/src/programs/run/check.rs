//! Checks a program on a thread: how many steps it has, what is wrong with it, and which steps its
//! store has already.

use std::path::PathBuf;
use std::sync::Arc;

use mve_core::{CommandScope, Map, Problem, Program, Registry, StepRecord, Store};

/// A program of a map, to be checked.
#[derive(Clone)]
pub struct ProgramSubject {
    /// The map.
    pub map: Arc<Map>,
    /// Name of the program.
    pub name: String,
    /// The folder that input paths are relative to.
    pub folder: PathBuf,
    /// The map's file; none before it has one.
    pub map_file: Option<PathBuf>,
    /// The modules.
    pub registry: Registry,
    /// The folder of the program's results.
    pub store: PathBuf,
}

impl ProgramSubject {
    /// Whether a check of one answers for the other: where nodes are drawn does not matter.
    pub fn asks_the_same_as(&self, other: &Self) -> bool {
        let same_map = Arc::ptr_eq(&self.map, &other.map)
            || (self.map.title == other.map.title
                && self.map.nodes == other.map.nodes
                && self.map.links == other.map.links
                && self.map.programs.get(&self.name) == other.map.programs.get(&self.name));
        same_map
            && self.name == other.name
            && self.folder == other.folder
            && self.map_file == other.map_file
            && self.store == other.store
    }
}

/// What a check found.
pub struct ProgramCheck {
    /// What was checked.
    pub subject: ProgramSubject,
    /// The program, if it can run.
    pub program: Option<Arc<Program>>,
    /// What is wrong with it, and what is odd about it.
    pub problems: Vec<Problem>,
    /// The steps that its store has.
    pub records: Vec<Arc<StepRecord>>,
    /// Why the store cannot be used.
    pub trouble: Option<String>,
}

/// What is wrong where the store holds the results of another map of this name.
pub fn of_other_map(program: &Program, store: &Store) -> Option<String> {
    // A map that was not saved yet has no name that another one could have.
    let has_file = !program.map_file.is_empty();
    let other = has_file.then(|| store.other_map(&program.map_path)).flatten()?;
    Some(format!(
        "{}: holds the results of another map of this name, {}; save this map under another name, \
         or move that folder",
        store.folder().display(),
        other.display()
    ))
}

/// Checks a program, and looks into its store without changing it.
pub fn check(subject: ProgramSubject) -> ProgramCheck {
    let ProgramSubject { map, name, folder, map_file, registry, store } = &subject;
    let mut problems: Vec<Problem> = map.problems().to_vec();
    let mut program = None;
    // What it may run is asked when it is to run.
    match Program::allowing(CommandScope::All, map, name, registry, folder) {
        Ok(mut sound) => {
            problems.extend(sound.warnings.iter().cloned());
            if let Some(file) = map_file {
                let name = file.file_name().unwrap_or_default();
                sound.map_file = name.to_string_lossy().into_owned();
                // As the window has it, seen from where that was started.
                sound.map_path = std::path::absolute(file).unwrap_or_default();
            }
            program = Some(Arc::new(sound));
        }
        Err(found) => problems.extend(found),
    }
    if problems.iter().any(Problem::is_error) {
        program = None;
    }
    let (mut records, mut trouble) = (Vec::new(), None);
    match (&program, Store::look(store)) {
        (_, Err(error)) => trouble = Some(error.to_string()),
        (Some(program), Ok(Some(store))) => {
            trouble = of_other_map(program, &store);
            let places = 0..program.steps.len();
            records = places.filter_map(|place| program.record(&store, place)).collect();
        }
        _ => {}
    }
    ProgramCheck { subject, program, problems, records, trouble }
}
