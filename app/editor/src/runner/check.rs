//! Checks a map, and finds the part of it that can run while the rest is unfinished.

use std::collections::{BTreeSet, HashMap, HashSet};

use indexmap::IndexMap;
use mve_core::{
    CommandScope, Fingerprint, Map, Node, NodeMode, OutputScope, Plan, PlanOptions, Problem,
    Registry,
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
    /// Nodes that are left out of every run, each with the reason: they are muted, or need one that
    /// is.
    pub off: HashMap<String, String>,
    /// Nodes that cannot run only because of others, each with the reason.
    pub left_out: IndexMap<String, String>,
    /// Outside programs that nobody has allowed yet, each with its node.
    pub unasked: BTreeSet<(String, String)>,
}

/// Checks a map. Where some nodes have problems, the plan is of those that do not need them.
pub fn check(subject: &Subject, part: Part, shared: &Shared) -> (MapCheck, Option<Plan>) {
    let mut map = (*subject.map).clone();
    map.programs.clear();
    restrict(&mut map, &part, &subject.registry);
    let mut checked = MapCheck { revision: subject.revision, ..MapCheck::default() };
    if map.nodes.values().any(|node| subject.registry.runs_programs(node)) {
        let all =
            MapCheck::default().plan_rest(&mut map.clone(), subject, CommandScope::All, shared);
        let nodes = all.map_or_else(Vec::new, |plan| plan.nodes);
        let lines = nodes.iter().flat_map(|node| {
            let lines = node.command_lines().into_iter();
            lines.map(|(_, line)| (node.name.clone(), line.to_string()))
        });
        checked.unasked = lines.filter(|(_, line)| !subject.allowed.contains(line)).collect();
    }
    let plan = checked.plan_rest(&mut map, subject, CommandScope::Seen(&subject.allowed), shared);
    if let Some(plan) = &plan {
        checked.keys = plan.nodes.iter().map(|node| (node.name.clone(), node.key)).collect();
    }
    let is_off = |(name, node): &(&String, &Node)| {
        !checked.keys.contains_key(*name) && (plan.is_some() || node.mode != NodeMode::Active)
    };
    let reason = |name: &str| {
        let of_it = |problem: &&Problem| problem.place.node.as_deref().map(outermost) == Some(name);
        let problem = checked.problems.iter().find(of_it);
        problem.map_or("is muted or bypassed".to_owned(), |problem| problem.message.clone())
    };
    let off = map.nodes.iter().filter(is_off);
    checked.off = off.map(|(name, _)| (name.clone(), reason(name))).collect();
    (checked, plan)
}

impl MapCheck {
    /// Plans a map without the nodes that have problems, which are taken out of it.
    fn plan_rest(
        &mut self,
        map: &mut Map,
        subject: &Subject,
        command_scope: CommandScope,
        shared: &Shared,
    ) -> Option<Plan> {
        let options = PlanOptions {
            map_folder: &subject.folder,
            output_folder: Some(&shared.output_folder),
            output_scope: OutputScope::Folder,
            command_scope,
            repeat: 0,
            files: &shared.files,
        };
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
