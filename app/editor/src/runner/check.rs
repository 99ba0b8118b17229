//! Checks a map, and finds the part of it that can run while the rest is unfinished.

use std::collections::{BTreeSet, HashMap, HashSet};

use indexmap::IndexMap;
use mve_core::{
    CommandScope, Fingerprint, MAP_INPUT, Map, Node, NodeMode, OutputScope, Plan, PlanOptions,
    PortRef, Problem, Registry, passed_on,
};

use super::{Shared, Subject, outermost};

/// Which nodes of a map are to run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Part {
    /// All.
    All,
    /// These and what they need.
    UpTo(Vec<String>),
    /// All but those that write files: for runs that a person has not asked for.
    Quiet,
}

/// What a check found.
#[derive(Default)]
pub struct MapCheck {
    /// Number of the state that was checked.
    pub revision: u64,
    /// Everything that is wrong with the map, and what is odd about it.
    pub problems: Vec<Problem>,
    /// Keys of the nodes that can run.
    pub keys: HashMap<String, Fingerprint>,
    /// The first thing that is wrong with each node that has problems of its own.
    pub faults: HashMap<String, String>,
    /// Nodes that are left out of every run, each with the reason: they are muted, take a value
    /// from outside, or need one that does.
    pub off: HashMap<String, String>,
    /// Nodes that cannot run only because of others, each with the reason.
    pub left_out: IndexMap<String, String>,
    /// Outside programs that nobody has allowed yet, each with its node. A run asks for leave.
    pub unasked: BTreeSet<(String, String)>,
    /// Whether nothing of the map runs by itself, for values come into it from the map around it.
    pub is_part: bool,
}

/// Why a node does not run whose values come from outside.
const FROM_OUTSIDE: &str = "takes a value from outside: it runs in the map around this one";

/// Checks a map. Where some nodes have problems, the plan is of those that do not need them.
pub fn check(subject: &Subject, part: Part, shared: &Shared) -> (MapCheck, Option<Plan>) {
    let mut map = (*subject.map).clone();
    map.programs.clear();
    restrict(&mut map, &part, &subject.registry);
    let mut checked = MapCheck { revision: subject.revision, ..MapCheck::default() };
    let from_outside = checked.part_off(&mut map, subject, shared);
    let mut rest = map.clone();
    let plan = checked.plan_rest(&mut map, subject, CommandScope::All, shared);
    let nodes = plan.iter().flat_map(|plan| &plan.nodes);
    checked.keys = nodes.clone().map(|node| (node.name.clone(), node.key)).collect();
    let lines = nodes.flat_map(|node| {
        let lines = node.command_lines().into_iter();
        lines.map(|(_, line)| (node.name.clone(), line.to_string()))
    });
    checked.unasked = lines.filter(|(_, line)| !subject.allowed.contains(line)).collect();
    let is_off = |(name, node): &(&String, &Node)| {
        !checked.keys.contains_key(*name) && (plan.is_some() || node.mode != NodeMode::Active)
    };
    let reason = |name: &str| {
        let of_it = |problem: &&Problem| problem.place.node.as_deref().map(outermost) == Some(name);
        let problem = checked.problems.iter().find(of_it);
        problem.map_or("is muted or bypassed".to_owned(), |problem| problem.message.clone())
    };
    let off = map.nodes.iter().filter(is_off).map(|(name, _)| (name.clone(), reason(name)));
    let outside = from_outside.iter().map(|name| (name.clone(), FROM_OUTSIDE.to_owned()));
    checked.off = off.chain(outside).collect();
    checked.is_part = !from_outside.is_empty() && rest.nodes.is_empty();
    if checked.unasked.is_empty() {
        return (checked, plan);
    }
    // What nobody has allowed is no problem of the map: it is left out, unless a person is asked.
    let allowed = CommandScope::Seen(&subject.allowed);
    let plan = MapCheck::default().plan_rest(&mut rest, subject, allowed, shared);
    (checked, plan)
}

/// The nodes by which values come into a map, and which have none where it runs alone.
fn open_inputs(map: &Map, registry: &Registry) -> HashSet<String> {
    let output = MAP_INPUT.outputs.first().map_or("", |output| output.name);
    let has_none = |name: &String| {
        let port = PortRef { node: name.clone(), port: output.to_owned() };
        passed_on(map, registry, &port).is_none()
    };
    let inputs = map.nodes.iter().filter(|(name, node)| {
        node.module == MAP_INPUT.id && node.mode == NodeMode::Active && has_none(name)
    });
    inputs.map(|(name, _)| name.clone()).collect()
}

impl MapCheck {
    /// Takes out of a map what another one runs: where values come in from there, and what needs
    /// them. Their own problems are told, as if the values were there. The names of what was taken.
    fn part_off(&mut self, map: &mut Map, subject: &Subject, shared: &Shared) -> HashSet<String> {
        let inputs = open_inputs(map, &subject.registry);
        if inputs.is_empty() {
            return inputs;
        }
        let mut given = map.clone();
        keep_nodes(&mut given, |name| !inputs.contains(name));
        let ends = map.links.iter().filter(|link| inputs.contains(&link.from.node));
        let ends: HashSet<(&str, &str)> =
            ends.map(|link| (link.to.node.as_str(), link.to.port.as_str())).collect();
        let options = subject.plan_options(CommandScope::All, shared);
        if !given.nodes.is_empty() {
            let found = Plan::new(&given, &subject.registry, &options);
            let mut found = found.map_or_else(|found| found, |plan| plan.warnings);
            found.retain(|problem| {
                let place = (problem.place.node.as_deref(), problem.place.port.as_deref());
                !matches!(place, (Some(node), Some(port)) if ends.contains(&(node, port)))
            });
            self.add(&found);
        }
        let before: HashSet<String> = map.nodes.keys().cloned().collect();
        let mut part = Self::default();
        part.leave_out(map, inputs);
        before.into_iter().filter(|name| !map.nodes.contains_key(name)).collect()
    }

    /// Plans a map without the nodes that have problems, which are taken out of it.
    fn plan_rest(
        &mut self,
        map: &mut Map,
        subject: &Subject,
        command_scope: CommandScope,
        shared: &Shared,
    ) -> Option<Plan> {
        let options = subject.plan_options(command_scope, shared);
        while !map.nodes.is_empty() {
            match Plan::new(map, &subject.registry, &options) {
                Ok(plan) => {
                    self.add(&plan.warnings);
                    return Some(plan);
                }
                Err(found) => {
                    self.add(&found);
                    let errors = found.iter().filter(|problem| problem.is_error());
                    let faulty = errors.filter_map(|problem| problem.place.node.as_deref());
                    let faulty = faulty.map(|node| outermost(node).to_owned());
                    if self.leave_out(map, faulty.collect()) == 0 {
                        return None;
                    }
                }
            }
        }
        None
    }

    fn add(&mut self, problems: &[Problem]) {
        for problem in problems {
            if self.problems.contains(problem) {
                continue;
            }
            self.problems.push(problem.clone());
            if let Some(node) = problem.place.node.clone().filter(|_| problem.is_error()) {
                let port = problem.place.port.as_ref().map(|port| format!("{port}: "));
                let own = outermost(&node);
                let inside = (own != node).then(|| format!("{node}: "));
                let before = inside.unwrap_or_default() + &port.unwrap_or_default();
                let text = || before + &problem.message;
                self.faults.entry(own.to_owned()).or_insert_with(text);
            }
        }
    }

    /// Takes nodes and all that hang on them out of the map; how many.
    fn leave_out(&mut self, map: &mut Map, faulty: HashSet<String>) -> usize {
        let before = map.nodes.len();
        let mut gone = faulty.clone();
        let mut open: Vec<String> = faulty.into_iter().collect();
        while let Some(name) = open.pop() {
            for link in map.links.iter().filter(|link| link.from.node == name) {
                if gone.insert(link.to.node.clone()) {
                    let why = format!("needs {name}, which cannot run");
                    self.left_out.insert(link.to.node.clone(), why);
                    open.push(link.to.node.clone());
                }
            }
        }
        keep_nodes(map, |name| !gone.contains(name));
        before - map.nodes.len()
    }
}

impl Subject {
    fn plan_options<'a>(
        &'a self,
        command_scope: CommandScope<'a>,
        shared: &'a Shared,
    ) -> PlanOptions<'a> {
        PlanOptions {
            map_folder: &self.folder,
            output_folder: Some(&shared.output_folder),
            output_scope: OutputScope::Folder,
            command_scope,
            repeat: 0,
            files: &shared.files,
        }
    }
}

/// Keeps the nodes that are to run.
fn restrict(map: &mut Map, part: &Part, registry: &Registry) {
    match part {
        Part::All => {}
        Part::UpTo(ends) => {
            let mut needed: HashSet<String> = ends.iter().cloned().collect();
            let mut open = ends.clone();
            while let Some(name) = open.pop() {
                for link in map.links.iter().filter(|link| link.to.node == name) {
                    if needed.insert(link.from.node.clone()) {
                        open.push(link.from.node.clone());
                    }
                }
            }
            keep_nodes(map, |name| needed.contains(name));
        }
        Part::Quiet => {
            let writers: HashSet<String> = map
                .nodes
                .iter()
                .filter(|(_, node)| registry.writes_files(node))
                .map(|(name, _)| name.clone())
                .collect();
            keep_nodes(map, |name| !writers.contains(name));
        }
    }
}

fn keep_nodes(map: &mut Map, keep: impl Fn(&str) -> bool) {
    map.nodes.retain(|name, _| keep(name));
    map.links.retain(|link| keep(&link.from.node) && keep(&link.to.node));
}
