//! A checked map: every problem found at once, or nodes in an order in which they can run.

mod assign;
mod keys;
mod maps;
mod modes;
mod opened;
mod outputs;
mod series;
mod wiring;

use std::path::{Path, PathBuf};

use crate::files::FileHashes;
use crate::fingerprint::Fingerprint;
use crate::map::{Map, Until};
use crate::param::{CommandLine, CommandScope, Setting, Settings};
use crate::problem::{Problem, did_you_mean};
use crate::registry::{ModuleInfo, Registry};

pub use assign::assign;
pub use maps::{MAP_ENDS, MAP_INPUT, MAP_OUTPUT, is_of_round};
pub use modes::passed_on;
pub(crate) use modes::{Inputs, passed_on_inside, without_inactive};
pub(crate) use outputs::one_case;
pub(crate) use series::{PlanSeries, SeriesPlan};
pub(crate) use wiring::{no_such_input, nothing_linked};

/// What a plan needs to know beside the map.
#[derive(Clone, Copy, Debug)]
pub struct PlanOptions<'a> {
    /// The folder that input paths are relative to.
    pub map_folder: &'a Path,
    /// The folder that output paths are relative to; `None` where every run has a fresh one.
    pub output_folder: Option<&'a Path>,
    /// Whether savers may write outside the output folder.
    pub output_scope: OutputScope,
    /// Which outside programs it may run.
    pub command_scope: CommandScope<'a>,
    /// Number of the repeat, from 0; seeds are raised by it.
    pub repeat: u32,
    /// Fingerprints of input files.
    pub files: &'a FileHashes,
}

impl<'a> PlanOptions<'a> {
    /// Of a map in a folder, whose runs have fresh folders of outputs each: savers stay in them,
    /// and no outside program runs.
    pub fn new(map_folder: &'a Path, files: &'a FileHashes) -> Self {
        Self {
            map_folder,
            output_folder: None,
            output_scope: OutputScope::Folder,
            command_scope: CommandScope::Nothing,
            repeat: 0,
            files,
        }
    }
}

/// Where savers may write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutputScope {
    /// Within the output folder only.
    Folder,
    /// Within the folder of a program's step only, which nobody can allow to leave.
    Step,
    /// Wherever the map says: for the maps of people that one trusts.
    Anywhere,
}

impl OutputScope {
    /// Whether all that is written stays in a folder.
    pub(crate) fn is_bounded(self) -> bool {
        match self {
            Self::Folder | Self::Step => true,
            Self::Anywhere => false,
        }
    }
}

/// Nodes in the order in which they run, with all that they need.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The nodes; inputs come from earlier ones only.
    pub nodes: Vec<PlanNode>,
    /// What is odd about the map but does not stop it.
    pub warnings: Vec<Problem>,
    /// Hash of all that determines the outputs of the whole plan.
    pub id: Fingerprint,
}

/// A node, ready to run.
#[derive(Clone)]
pub struct PlanNode {
    /// Its name in the map.
    pub name: String,
    /// What it runs.
    pub info: ModuleInfo,
    /// Its parameters, all of them set. Those with a link change when it runs.
    pub settings: Settings,
    /// Files that it reads, with the fingerprints of their content; those that its files name may
    /// be missing, which has a fingerprint of its own.
    pub reads: Vec<(PathBuf, Fingerprint)>,
    /// Files that it writes, relative to the output folder unless absolute.
    pub writes: Vec<PathBuf>,
    /// Hash of all that determines its outputs.
    pub key: Fingerprint,
    /// For each declared input, where its value comes from.
    pub(crate) inputs: Vec<Option<Source>>,
    /// Links into inputs that take many: the place of the input among the declared ones, and where
    /// a value comes from.
    pub(crate) many: Vec<(usize, Source)>,
    /// Parameters with a link: their place among the declared ones, and where the value comes from.
    pub(crate) linked: Vec<(usize, Source)>,
    /// Of loops that it is in, what the round before says.
    pub(crate) gates: Vec<Gate>,
    /// Nodes that take a value from this one, each once.
    pub(crate) consumers: Vec<usize>,
}

/// An output of a node of the plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Source {
    pub node: usize,
    pub output: usize,
}

/// The number by which a loop may end: a node of a later round runs only while it says so.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Gate {
    /// What the round before gives.
    pub source: Source,
    /// When the loop is at its end.
    pub until: Until,
}

impl std::fmt::Debug for PlanNode {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {} {:?}", self.name, self.info.module.id, self.key)
    }
}

impl PlanNode {
    /// The outside programs that it runs, each with the dotted path of its parameter.
    pub fn command_lines(&self) -> Vec<(String, CommandLine)> {
        self.settings.command_lines()
    }

    /// All the nodes that it takes values from; a node may come more than once.
    pub(crate) fn sources(&self) -> impl Iterator<Item = Source> {
        let placed = self.many.iter().chain(&self.linked).map(|(_, source)| *source);
        let gates = self.gates.iter().map(|gate| gate.source);
        self.inputs.iter().flatten().copied().chain(placed).chain(gates)
    }
}

impl Plan {
    /// Checks a map. The error is the list of all its problems, at least one of them an error.
    pub fn new(
        map: &Map,
        registry: &Registry,
        options: &PlanOptions,
    ) -> Result<Self, Vec<Problem>> {
        plan_parts(map, registry, options).map(|parts| parts.plan)
    }

    /// The node of this name.
    pub fn find(&self, name: &str) -> Option<&PlanNode> {
        self.nodes.iter().find(|node| node.name == name)
    }
}

/// A plan, and what it takes to make parts of it again.
struct PlanParts {
    plan: Plan,
    names: outputs::Names,
    /// Nodes that do not run, whose parameters names may quote.
    left_out: Vec<PlanNode>,
    /// Whether nodes of the map stood for others.
    is_opened: bool,
}

fn plan_parts(
    map: &Map,
    registry: &Registry,
    options: &PlanOptions,
) -> Result<PlanParts, Vec<Problem>> {
    let mut problems = map.problems().to_vec();
    if map.nodes.is_empty() && problems.is_empty() {
        let message = "the map has no nodes: there is nothing to run";
        problems.push(Problem::error(message).along(["nodes".into()]));
    }
    wiring::check_names(map, &mut problems);
    let with_maps = registry.with_maps(map, options.map_folder, &mut problems);
    let registry = &with_maps;
    problems.extend(maps::parameter_warnings(map, registry));
    let whole = map;
    let active = modes::without_inactive(whole, registry, Inputs::Alone, &mut problems);
    let map = active.as_ref().map_or(whole, |active| &active.map);
    let left_out = active.as_ref().map_or(&[][..], |active| &active.left_out);
    let left_out = prepare_inactive(whole, left_out, registry, options);
    let opened = maps::open(map, registry, options.map_folder, &mut problems);
    let is_opened = opened.is_some();
    let named = opened.as_ref().map(|opened| with_idle(&opened.map, whole, &left_out));
    let whole = named.as_ref().unwrap_or(whole);
    let map = opened.as_ref().map_or(map, |opened| &opened.map);
    let wiring = wiring::wire(map, registry, opened.as_ref(), &mut problems);
    let mut nodes = Vec::with_capacity(map.nodes.len());
    for (place, (name, _)) in map.nodes.iter().enumerate() {
        if let Some(info) = wiring.modules[place] {
            let linked = &wiring.linked[place];
            let node = prepare(map, name, info, linked, options, &mut problems);
            nodes.push(Some(node));
        } else {
            nodes.push(None);
        }
    }
    let order = wiring::order(map, &wiring, &mut problems);
    let has_errors = |problems: &[Problem]| problems.iter().any(Problem::is_error);
    // Names of output files quote the parameters of other nodes, so they wait for all of them.
    let running = nodes.iter().flatten();
    let all = running.clone().chain(&left_out);
    let names = outputs::names(whole, running, all, options, &mut problems);
    if has_errors(&problems) {
        return Err(problems);
    }
    let mut nodes = wiring::arrange(nodes, &wiring, &order);
    keys::fill(&mut nodes, &names);
    let id = keys::plan_id(&nodes, &keys::by_name(&nodes), options.repeat);
    outputs::fill(&mut nodes, &names, &id, options, &mut problems);
    if has_errors(&problems) {
        return Err(problems);
    }
    Ok(PlanParts { plan: Plan { nodes, warnings: problems, id }, names, left_out, is_opened })
}

/// A map whose maps were opened, with the nodes that do not run, which names of files may quote.
fn with_idle(opened: &Map, whole: &Map, left_out: &[PlanNode]) -> Map {
    let mut named = opened.clone();
    let idle = left_out.iter().filter_map(|node| whole.nodes.get_key_value(&node.name));
    named.nodes.extend(idle.map(|(name, node)| (name.clone(), node.clone())));
    named
}

/// Nodes that do not run, with their parameters, which names of output files may quote. Whatever
/// is wrong with them stops no run.
fn prepare_inactive(
    map: &Map,
    names: &[String],
    registry: &Registry,
    options: &PlanOptions,
) -> Vec<PlanNode> {
    let node = |name: &String| {
        let info = registry.find(&map.nodes.get(name)?.module)?;
        Some(prepare(map, name, info, &[], options, &mut Vec::new()))
    };
    names.iter().filter_map(node).collect()
}

/// Reads a node's parameters, and finds its input files.
fn prepare(
    map: &Map,
    name: &str,
    info: ModuleInfo,
    linked: &[(usize, wiring::From)],
    options: &PlanOptions,
    problems: &mut Vec<Problem>,
) -> PlanNode {
    let specs = info.module.params;
    let by_link: Vec<&str> = linked.iter().map(|(place, _)| specs[*place].name).collect();
    let mut faults = Vec::new();
    let empty = serde_json::Map::new();
    let given = map.nodes.get(name).map_or(&empty, |node| &node.params);
    let mut settings = Settings::parse(specs, given, &by_link, &mut faults);
    if faults.is_empty() {
        let idle = settings.idle(specs, given, &by_link).into_iter();
        problems.extend(idle.map(|f| Problem::warning(f.message).at(name).port(&f.path)));
    }
    problems.extend(faults.into_iter().map(|f| Problem::error(f.message).at(name).port(&f.path)));
    for link in &by_link {
        if given.contains_key(*link) {
            let message = "is set and linked; the link counts";
            problems.push(Problem::warning(message).at(name).port(link));
        }
    }
    // Only the module's author can mend these, but a run would read another parameter than
    // declared.
    for fault in specs.iter().filter_map(|spec| spec.fault(info.module.inputs)) {
        let message = format!("this is a bug in the module: {fault}");
        problems.push(Problem::error(message).at(name));
    }
    settings.each_mut(specs, &mut |_, spec, setting| spec.repeat(setting, options.repeat));
    let mut node = PlanNode {
        name: name.to_owned(),
        info,
        settings,
        reads: Vec::new(),
        writes: Vec::new(),
        key: Fingerprint::of(b""),
        inputs: Vec::new(),
        many: Vec::new(),
        linked: Vec::new(),
        gates: Vec::new(),
        consumers: Vec::new(),
    };
    find_files(&mut node, options, problems);
    node
}

/// Finds and fingerprints the input files of a node.
fn find_files(node: &mut PlanNode, options: &PlanOptions, problems: &mut Vec<Problem>) {
    let PlanNode { name, info, settings, reads, .. } = node;
    reads.clear();
    settings.each_mut(info.module.params, &mut |path, spec, setting| {
        if spec.command_line().is_some() {
            find_program(setting, options, reads).unwrap_or_else(|message| {
                problems.push(Problem::error(message).at(name).port(path));
            });
            return;
        }
        let (Some(file), Setting::File { written, resolved }) = (spec.input_file(), setting) else {
            return;
        };
        *resolved = options.map_folder.join(written.as_str());
        if let Err(message) = read(resolved, file.also_reads, options.files, reads) {
            let hint = match Path::new(written.as_str()).is_relative() {
                true => "; paths in a map are relative to its folder",
                false => "",
            };
            problems.push(Problem::error(format!("{message}{hint}")).at(name).port(path));
        }
    });
}

/// Finds and fingerprints an outside program and the files that are named to it, and refuses what
/// nobody has allowed.
fn find_program(
    setting: &mut Setting,
    options: &PlanOptions,
    reads: &mut Vec<(PathBuf, Fingerprint)>,
) -> Result<(), String> {
    let Some(line) = setting.structured::<CommandLine>() else { return Ok(()) };
    if !options.command_scope.allows(&line) {
        return Err(format!(
            "would run an outside program, which can do whatever you can: {line}; if you trust the \
             map, allow it with --allow-commands, or press Run in the window, which asks"
        ));
    }
    for path in setting.locate_program(options.map_folder)? {
        let fingerprint = options.files.fingerprint(&path);
        let fingerprint = fingerprint.map_err(|why| format!("{}: {why}", path.display()))?;
        reads.push((path, fingerprint));
    }
    Ok(())
}

/// Fingerprints an input file and the files that it names.
fn read(
    path: &Path,
    also_reads: fn(&Path) -> Vec<PathBuf>,
    files: &FileHashes,
    reads: &mut Vec<(PathBuf, Fingerprint)>,
) -> Result<(), String> {
    let fingerprint = files.fingerprint(path);
    let fingerprint = fingerprint.map_err(|why| format!("{}: {why}", path.display()))?;
    reads.push((path.to_owned(), fingerprint));
    // What a file names may be missing; the module says so when it matters. Which of them is
    // missing decides the result as well.
    for path in also_reads(path) {
        let fingerprint = files.fingerprint(&path).unwrap_or_else(|_| no_file());
        reads.push((path, fingerprint));
    }
    Ok(())
}

/// The fingerprint of a file that another one names and that is not there.
pub(crate) fn no_file() -> Fingerprint {
    Fingerprint::of(b"mve: no such file")
}

/// A problem about a name that no node has.
fn no_such_node(map: &Map, name: &str) -> String {
    if map.has_unread_node(name) {
        return format!("the node \"{name}\" could not be read");
    }
    let hint = did_you_mean(name, map.nodes.keys().map(String::as_str));
    format!("there is no node \"{name}\"{hint}")
}
