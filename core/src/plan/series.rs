//! Plans of one map for many values of the same parameters.
//!
//! The first of them is planned as a whole. What hangs on no parameter that is set stays for the
//! next ones; in place are settled the parameters that are, and once repeats are asked for the
//! seeds too, and then the names, keys and paths of the nodes that they reach. Where that gives any
//! problem, the map is planned as a whole once more, so that problems read the same.

use std::collections::HashMap;

use indexmap::IndexMap;
use serde_json::{Map as JsonMap, Value as Json};

use super::assign::{assign, set};
use super::keys::{self, OwnPieces};
use super::{Plan, PlanNode, PlanOptions, PlanParts, find_files, outputs, plan_parts};
use crate::map::Map;
use crate::param::{MODULE, Settings};
use crate::problem::Problem;
use crate::registry::Registry;

/// Drafts that are kept. A series with more combinations of modules plans them anew.
const MOST_DRAFTS: usize = 64;

/// Plans of one map, each with other parameters.
pub(crate) struct PlanSeries<'a> {
    map: &'a Map,
    registry: &'a Registry,
    options: PlanOptions<'a>,
    /// By what they have in common, [`likeness`].
    drafts: HashMap<String, Draft>,
    n_drafts: usize,
}

/// A plan of a series.
pub(crate) struct SeriesPlan<'a> {
    /// The plan.
    pub plan: &'a Plan,
    /// Places of the nodes that may differ from those of the last plan of this draft.
    pub changed: &'a [usize],
    /// Number of the draft.
    pub draft: usize,
}

/// A plan, and where other values of its parameters go.
struct Draft {
    number: usize,
    parts: PlanParts,
    /// The map that was planned.
    map: Map,
    varied: Vec<VariedNode>,
    /// For each parameter that is set, in order: which of `varied`, and its path there.
    targets: Vec<(usize, String)>,
    /// Whether all that is set belongs to nodes that run.
    is_of_running: bool,
    /// Of which repeats it can be.
    repeats: Repeats,
    /// Places of the nodes that are varied, write files, or take values of such.
    changed: Vec<usize>,
    /// What their modules and parameters add to their keys.
    pieces: Vec<OwnPieces>,
    /// Places of the nodes that write files, or may.
    writers: Vec<usize>,
    by_name: Vec<usize>,
}

/// The repeats that a draft can be of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Repeats {
    /// One alone.
    Only(u32),
    /// Any: its seeds are among the parameters that are set.
    All,
}

/// A node of which parameters are set.
struct VariedNode {
    place: usize,
    /// Which of `changed` it is.
    change: usize,
    /// Places of these parameters among the declared ones.
    params: Vec<usize>,
    /// What the map says of them otherwise.
    base: JsonMap<String, Json>,
}

impl<'a> PlanSeries<'a> {
    /// Plans of `map`.
    pub fn new(map: &'a Map, registry: &'a Registry, options: PlanOptions<'a>) -> Self {
        Self { map, registry, options, drafts: HashMap::new(), n_drafts: 0 }
    }

    /// The plan of the map with these parameters, just as it would be planned alone.
    pub fn plan(
        &mut self,
        params: &IndexMap<String, Json>,
        repeat: u32,
    ) -> Result<SeriesPlan<'_>, Vec<Problem>> {
        let values = in_order(params);
        let options = PlanOptions { repeat, ..self.options };
        let likeness = likeness(&values);
        let mut known = self.drafts.get_mut(&likeness);
        // Most programs have no repeats, and nothing to do with seeds.
        let repeats = match known.as_ref().map(|draft| draft.repeats) {
            None => Repeats::Only(repeat),
            Some(Repeats::Only(only)) if only == repeat => Repeats::Only(repeat),
            Some(_) => Repeats::All,
        };
        if known.as_mut().is_none_or(|draft| draft.redo(&values, &options).is_none()) {
            let draft = Draft::new(self.map, self.registry, &options, &values, repeats)?;
            if self.drafts.len() >= MOST_DRAFTS {
                self.drafts.clear();
            }
            self.n_drafts += 1;
            self.drafts.insert(likeness.clone(), Draft { number: self.n_drafts, ..draft });
        }
        let draft = &self.drafts[&likeness];
        Ok(SeriesPlan { plan: &draft.parts.plan, changed: &draft.changed, draft: draft.number })
    }
}

/// Whether a path names the module of a node.
fn is_module(path: &str) -> bool {
    path.split_once('.').is_some_and(|(_, param)| param == MODULE)
}

/// Modules first, then shorter paths first, so that a module is there before its parameters are set
/// and a choice is made before its own.
fn in_order(params: &IndexMap<String, Json>) -> Vec<(&str, &Json)> {
    let mut sorted: Vec<_> = params.iter().map(|(path, value)| (path.as_str(), value)).collect();
    sorted.sort_by_key(|(path, _)| (!is_module(path), path.split('.').count()));
    sorted
}

/// What two assignments have in common whose plans differ in settings alone: the parameters that
/// are set, and the modules.
fn likeness(values: &[(&str, &Json)]) -> String {
    let mut likeness = String::new();
    for (path, value) in values {
        likeness.push('\n');
        likeness.push_str(path);
        if is_module(path) {
            likeness.push_str(&value.to_string());
        }
    }
    likeness
}

/// What the map says of the parameter that a path begins with.
fn said(map: &Map, path: &str) -> Option<Json> {
    let mut parts = path.split('.');
    map.nodes.get(parts.next()?)?.params.get(parts.next()?).cloned()
}

impl Draft {
    fn new(
        map: &Map,
        registry: &Registry,
        options: &PlanOptions,
        values: &[(&str, &Json)],
        repeats: Repeats,
    ) -> Result<Self, Vec<Problem>> {
        let n_modules = values.iter().take_while(|(path, _)| is_module(path)).count();
        let (modules, values) = values.split_at(n_modules);
        let mut map = map.clone();
        let all_set = |map: &mut Map, values: &[(&str, &Json)]| {
            let mut each = values.iter();
            each.try_for_each(|(path, value)| assign(map, registry, path, (*value).clone()))
                .map_err(|problem| vec![problem])
        };
        all_set(&mut map, modules)?;
        let said: Vec<_> = values.iter().map(|(path, _)| said(&map, path)).collect();
        all_set(&mut map, values)?;
        let parts = plan_parts(&map, registry, options)?;
        let nodes = &parts.plan.nodes;
        let mut draft = Self {
            number: 0,
            map,
            varied: Vec::new(),
            targets: Vec::new(),
            // What stands for other nodes may become others with each value.
            is_of_running: !parts.is_opened,
            repeats,
            changed: Vec::new(),
            pieces: Vec::new(),
            writers: Vec::new(),
            by_name: keys::by_name(nodes),
            parts,
        };
        for ((path, _), said) in values.iter().zip(said) {
            draft.aim_at(path, said);
        }
        if repeats == Repeats::All {
            draft.aim_at_seeds(options.repeat);
        }
        draft.follow();
        Ok(draft)
    }

    /// Notes where the values of this path go, and what the map says there.
    fn aim_at(&mut self, path: &str, said: Option<Json>) {
        let (name, param_path) = path.split_once('.').unwrap_or((path, ""));
        let param = param_path.split('.').next().unwrap_or_default();
        let nodes = &self.parts.plan.nodes;
        let Some(place) = nodes.iter().position(|node| node.name == name) else {
            self.is_of_running = false;
            return;
        };
        let which = self.varied_at(place);
        self.targets.push((which, param_path.to_owned()));
        let specs = self.parts.plan.nodes[place].info.module.params;
        let varied = &mut self.varied[which];
        let declared = specs.iter().position(|spec| spec.name == param);
        varied.params.extend(declared.filter(|place| !varied.params.contains(place)));
        varied.base.extend(said.map(|value| (param.to_owned(), value)));
    }

    /// Notes where seeds are, so that they can be those of another repeat. Names may quote those of
    /// nodes that do not run, which stay: then it is a draft of one repeat.
    fn aim_at_seeds(&mut self, repeat: u32) {
        if self.parts.left_out.iter().any(|node| seeded(node).next().is_some()) {
            self.repeats = Repeats::Only(repeat);
            return;
        }
        for place in 0..self.parts.plan.nodes.len() {
            let node = &self.parts.plan.nodes[place];
            let seeds: Vec<usize> = seeded(node).collect();
            if seeds.is_empty() {
                continue;
            }
            let (name, specs) = (node.name.clone(), node.info.module.params);
            let which = self.varied_at(place);
            let varied = &mut self.varied[which];
            for param in seeds {
                if varied.params.contains(&param) {
                    continue;
                }
                let path = format!("{name}.{}", specs[param].name);
                let said = said(&self.map, &path);
                varied.base.extend(said.map(|value| (specs[param].name.to_owned(), value)));
                varied.params.push(param);
            }
        }
    }

    /// Which of the varied nodes the one at this place is, from now on.
    fn varied_at(&mut self, place: usize) -> usize {
        let of_node = |varied: &VariedNode| varied.place == place;
        self.varied.iter().position(of_node).unwrap_or_else(|| {
            let (params, base) = (Vec::new(), JsonMap::new());
            self.varied.push(VariedNode { place, change: 0, params, base });
            self.varied.len() - 1
        })
    }

    /// Finds the nodes that values reach.
    fn follow(&mut self) {
        let nodes = &self.parts.plan.nodes;
        let is_varied = |place: usize| self.varied.iter().any(|node| node.place == place);
        for (place, node) in nodes.iter().enumerate() {
            let writes = self.parts.names.has(&node.name);
            // An entry that is chosen may bring files with it.
            if writes || is_varied(place) {
                self.writers.push(place);
            }
            let is_behind = node.sources().any(|source| self.changed.contains(&source.node));
            if writes || is_varied(place) || is_behind {
                self.changed.push(place);
                self.pieces.push(OwnPieces::of(node));
            }
        }
        for varied in &mut self.varied {
            let found = self.changed.iter().position(|place| *place == varied.place);
            varied.change = found.unwrap_or_default();
        }
    }

    /// Plans other values of the same parameters; `None` where that must be done as a whole.
    fn redo(&mut self, values: &[(&str, &Json)], options: &PlanOptions) -> Option<()> {
        let is_of_repeat = match self.repeats {
            Repeats::Only(only) => only == options.repeat,
            Repeats::All => true,
        };
        if !self.is_of_running || !is_of_repeat {
            return None;
        }
        self.settle(values, options)?;
        let mut problems = Vec::new();
        let PlanParts { plan, left_out, names, .. } = &mut self.parts;
        for place in &self.writers {
            plan.nodes[*place].writes.clear();
        }
        let writers = self.writers.iter().map(|place| &plan.nodes[*place]);
        let all = plan.nodes.iter().chain(&*left_out);
        *names = outputs::names(&self.map, writers, all, options, &mut problems);
        for (place, own) in self.changed.iter().zip(&self.pieces) {
            plan.nodes[*place].key = keys::key(&plan.nodes, *place, own, names);
        }
        plan.id = keys::plan_id(&plan.nodes, &self.by_name, options.repeat);
        outputs::fill(&mut plan.nodes, names, &plan.id, options, &mut problems);
        problems.is_empty().then_some(())
    }

    /// Reads the values, and finds the files that they name. Where some are at fault, all others
    /// are read nonetheless: the next values stand on what these leave.
    fn settle(&mut self, values: &[(&str, &Json)], options: &PlanOptions) -> Option<()> {
        let mut given: Vec<_> = self.varied.iter().map(|varied| varied.base.clone()).collect();
        let values = values.iter().filter(|(path, _)| !is_module(path));
        for ((_, value), (which, path)) in values.zip(&self.targets) {
            let node = &self.parts.plan.nodes[self.varied[*which].place];
            let specs = node.info.module.params;
            set(&mut given[*which], Some(specs), path, (*value).clone()).ok()?;
        }
        let mut is_fine = true;
        for (varied, given) in self.varied.iter().zip(&given) {
            let node = &mut self.parts.plan.nodes[varied.place];
            let mut has_files = false;
            for &param in &varied.params {
                has_files |= settle_one(node, param, given, options.repeat, &mut is_fine);
                self.pieces[varied.change].renew(node, param);
            }
            if has_files {
                let mut problems = Vec::new();
                find_files(node, options, &mut problems);
                is_fine &= problems.is_empty();
            }
        }
        is_fine.then_some(())
    }
}

/// Places of the parameters of a node whose values are other ones in other repeats.
fn seeded(node: &PlanNode) -> impl Iterator<Item = usize> {
    let mut next = node.settings.clone();
    let specs = node.info.module.params;
    next.each_mut(specs, &mut |_, spec, setting| spec.repeat(setting, 1));
    let pairs = next.0.into_iter().zip(&node.settings.0).enumerate();
    pairs.filter(|(_, (next, now))| next != *now).map(|(place, _)| place)
}

/// Settles one parameter of a node anew. Whether it names files, or did before.
fn settle_one(
    node: &mut PlanNode,
    param: usize,
    given: &JsonMap<String, Json>,
    repeat: u32,
    is_fine: &mut bool,
) -> bool {
    let spec = &node.info.module.params[param];
    let is_linked = node.linked.iter().any(|(linked, _)| *linked == param);
    let mut faults = Vec::new();
    let setting = spec.settle(given.get(spec.name), is_linked, &mut faults);
    let mut settled = Settings(vec![(spec.name, setting)]);
    settled.each_mut(std::slice::from_ref(spec), &mut |_, spec, setting| {
        spec.repeat(setting, repeat);
    });
    *is_fine &= faults.is_empty();
    let had_files = node.settings.0[param].1.has_files();
    node.settings.0[param] = settled.0.remove(0);
    had_files || node.settings.0[param].1.has_files()
}

#[cfg(test)]
#[path = "series_tests.rs"]
mod tests;
