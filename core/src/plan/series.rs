//! Plans of one map for many values of the same parameters.
//!
//! The first of them is planned as a whole. What hangs on no parameter that is set stays for the
//! next ones; in place are settled the parameters that are, and then the names, keys and paths of
//! the nodes that they reach. Where that gives any problem, the map is planned as a whole once
//! more, so that problems read the same.

use std::collections::HashMap;

use indexmap::IndexMap;
use serde_json::{Map as JsonMap, Value as Json};

use super::assign::{assign, set};
use super::keys::{self, OwnPieces};
use super::{DrawnUp, Plan, PlanNode, PlanOptions, draw_up, find_files, outputs};
use crate::map::Map;
use crate::param::{MODULE, Settings};
use crate::problem::Problem;
use crate::registry::Registry;

/// Drafts that are kept. A series with more combinations of modules and repeats plans them anew.
const MOST_DRAFTS: usize = 64;

/// Plans of one map, each with other parameters.
pub(crate) struct PlanSeries<'a> {
    map: &'a Map,
    registry: &'a Registry,
    options: PlanOptions<'a>,
    /// By what they have in common, [`likeness`].
    drafts: HashMap<String, Draft>,
    n_drawn: usize,
}

/// A plan of a series.
pub(crate) struct Planned<'a> {
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
    drawn: DrawnUp,
    /// The map that was planned.
    map: Map,
    touched: Vec<Touched>,
    /// For each parameter that is set, in order: which of `touched`, and its path there.
    targets: Vec<(usize, String)>,
    /// Whether all that is set belongs to nodes that run.
    is_of_running: bool,
    /// Places of the nodes that are touched, write files, or take values of such.
    changed: Vec<usize>,
    /// What their modules and parameters add to their keys.
    pieces: Vec<OwnPieces>,
    /// Places of the nodes that write files, or may.
    writers: Vec<usize>,
    by_name: Vec<usize>,
}

/// A node of which parameters are set.
struct Touched {
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
        Self { map, registry, options, drafts: HashMap::new(), n_drawn: 0 }
    }

    /// The plan of the map with these parameters, just as it would be planned alone.
    pub fn plan(
        &mut self,
        params: &IndexMap<String, Json>,
        repeat: u32,
    ) -> Result<Planned<'_>, Vec<Problem>> {
        let values = in_order(params);
        let options = PlanOptions { repeat, ..self.options };
        let likeness = likeness(&values, repeat);
        let known = self.drafts.get_mut(&likeness);
        if known.is_none_or(|draft| draft.redo(&values, &options).is_none()) {
            let drawn = Draft::new(self.map, self.registry, &options, &values)?;
            if self.drafts.len() >= MOST_DRAFTS {
                self.drafts.clear();
            }
            self.n_drawn += 1;
            self.drafts.insert(likeness.clone(), Draft { number: self.n_drawn, ..drawn });
        }
        let draft = &self.drafts[&likeness];
        Ok(Planned { plan: &draft.drawn.plan, changed: &draft.changed, draft: draft.number })
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
/// are set, the modules, and the repeat.
fn likeness(values: &[(&str, &Json)], repeat: u32) -> String {
    let mut likeness = repeat.to_string();
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
        let drawn = draw_up(&map, registry, options)?;
        let nodes = &drawn.plan.nodes;
        let mut draft = Self {
            number: 0,
            map,
            touched: Vec::new(),
            targets: Vec::new(),
            is_of_running: true,
            changed: Vec::new(),
            pieces: Vec::new(),
            writers: Vec::new(),
            by_name: keys::by_name(nodes),
            drawn,
        };
        for ((path, _), said) in values.iter().zip(said) {
            draft.aim_at(path, said);
        }
        draft.follow();
        Ok(draft)
    }

    /// Notes where the values of this path go, and what the map says there.
    fn aim_at(&mut self, path: &str, said: Option<Json>) {
        let (name, param_path) = path.split_once('.').unwrap_or((path, ""));
        let param = param_path.split('.').next().unwrap_or_default();
        let nodes = &self.drawn.plan.nodes;
        let Some(place) = nodes.iter().position(|node| node.name == name) else {
            self.is_of_running = false;
            return;
        };
        let of_node = |touched: &Touched| touched.place == place;
        let which = self.touched.iter().position(of_node).unwrap_or_else(|| {
            let (params, base) = (Vec::new(), JsonMap::new());
            self.touched.push(Touched { place, change: 0, params, base });
            self.touched.len() - 1
        });
        self.targets.push((which, param_path.to_owned()));
        let specs = nodes[place].info.module.params;
        let touched = &mut self.touched[which];
        let declared = specs.iter().position(|spec| spec.name == param);
        touched.params.extend(declared.filter(|place| !touched.params.contains(place)));
        touched.base.extend(said.map(|value| (param.to_owned(), value)));
    }

    /// Finds the nodes that values reach.
    fn follow(&mut self) {
        let nodes = &self.drawn.plan.nodes;
        let is_touched = |place: usize| self.touched.iter().any(|node| node.place == place);
        for (place, node) in nodes.iter().enumerate() {
            let writes = self.drawn.names.has(&node.name);
            // An entry that is chosen may bring files with it.
            if writes || is_touched(place) {
                self.writers.push(place);
            }
            let is_behind = node.sources().any(|source| self.changed.contains(&source.node));
            if writes || is_touched(place) || is_behind {
                self.changed.push(place);
                self.pieces.push(OwnPieces::of(node));
            }
        }
        for touched in &mut self.touched {
            let found = self.changed.iter().position(|place| *place == touched.place);
            touched.change = found.unwrap_or_default();
        }
    }

    /// Plans other values of the same parameters; `None` where that must be done as a whole.
    fn redo(&mut self, values: &[(&str, &Json)], options: &PlanOptions) -> Option<()> {
        if !self.is_of_running {
            return None;
        }
        self.settle(values, options)?;
        let mut problems = Vec::new();
        let DrawnUp { plan, left_out, names } = &mut self.drawn;
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

    /// Reads the values, and finds the files that they name.
    fn settle(&mut self, values: &[(&str, &Json)], options: &PlanOptions) -> Option<()> {
        let mut given: Vec<_> = self.touched.iter().map(|touched| touched.base.clone()).collect();
        let values = values.iter().filter(|(path, _)| !is_module(path));
        for ((_, value), (which, path)) in values.zip(&self.targets) {
            let node = &self.drawn.plan.nodes[self.touched[*which].place];
            let specs = node.info.module.params;
            set(&mut given[*which], Some(specs), path, (*value).clone()).ok()?;
        }
        for (touched, given) in self.touched.iter().zip(&given) {
            let node = &mut self.drawn.plan.nodes[touched.place];
            let mut has_files = false;
            for &param in &touched.params {
                has_files |= settle_one(node, param, given, options.repeat)?;
                self.pieces[touched.change].renew(node, param);
            }
            if has_files {
                let mut problems = Vec::new();
                find_files(node, options, &mut problems);
                problems.is_empty().then_some(())?;
            }
        }
        Some(())
    }
}

/// Settles one parameter of a node anew. Whether it names files, or did before.
fn settle_one(
    node: &mut PlanNode,
    param: usize,
    given: &JsonMap<String, Json>,
    repeat: u32,
) -> Option<bool> {
    let spec = &node.info.module.params[param];
    let is_linked = node.linked.iter().any(|(linked, _)| *linked == param);
    let mut faults = Vec::new();
    let setting = spec.settle(given.get(spec.name), is_linked, &mut faults);
    let mut settled = Settings(vec![(spec.name, setting)]);
    settled.each_mut(std::slice::from_ref(spec), &mut |_, spec, setting| {
        spec.repeat(setting, repeat);
    });
    let (_, fresh) = settled.0.pop()?;
    let setting = &mut node.settings.0[param].1;
    let has_files = fresh.has_files() || setting.has_files();
    *setting = fresh;
    faults.is_empty().then_some(has_files)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::files::FileHashes;
    use crate::testing::{plan_options, registry};

    const MAP: &str = r#"{"mve": 1, "nodes": {
        "read": {"module": "Read", "params": {"path": "a.txt"}},
        "add": {"module": "Add", "params": {"amount": 7}},
        "sum": {"module": "Add"},
        "pick": {"module": "Pick", "params": {"how": {"Scaled": {"by": 4.0}}}},
        "far": {"module": "Add", "params": {"amount": 3}},
        "write": {"module": "Write", "params": {"path": "{sum.amount}-{pick.how}-{read.source}.txt"}},
        "idle": {"module": "Echo", "mode": "muted"}},
      "links": ["pick.number -> sum.a", "sum.sum -> far.a", "read.text -> write.text"]}"#;

    /// All that a plan says, with its paths.
    fn told(plan: &Plan) -> String {
        let nodes = plan.nodes.iter().map(|node| {
            let PlanNode { name, info, settings, reads, writes, key, inputs, .. } = node;
            let sources = (inputs, &node.linked, &node.consumers);
            let id = info.module.id;
            format!("{name} {id} {settings:?} {reads:?} {writes:?} {key} {sources:?}\n")
        });
        let nodes: String = nodes.collect();
        format!("{nodes}{} {:?}", plan.id, plan.warnings)
    }

    #[test]
    fn plans_of_a_series_are_those_of_single_maps() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a", "b"] {
            std::fs::write(folder.path().join(name).with_extension("txt"), name).unwrap();
        }
        let map = Map::parse(MAP).unwrap();
        let (registry, files) = (registry(), FileHashes::new());
        let options = plan_options(folder.path(), &files);
        let mut series = PlanSeries::new(&map, &registry, options);
        let steps = [
            json!({"sum.amount": 1}),
            json!({"sum.amount": 2}),
            json!({"sum.amount": 1000}),
            json!({"sum.amount": 3}),
            json!({"pick.how": "Zero"}),
            json!({"pick.how": "Scaled"}),
            json!({"pick.how": {"Scaled": {"by": 5.5}}}),
            json!({"pick.how.by": 8, "sum.amount": 2}),
            json!({"pick.how.by": 9, "sum.amount": 5}),
            json!({"pick.how.by": "x", "sum.amount": 5}),
            json!({"pick.how.nothing": 1}),
            json!({"read.path": "b.txt", "write.path": "{step}.txt"}),
            json!({"read.path": "a.txt", "write.path": "q/{read.path.name}-{repeat}.txt"}),
            json!({"read.path": "c.txt", "write.path": "c.txt"}),
            json!({"read.path": "a.txt", "write.path": "../c.txt"}),
            json!({"sum.module": "Pick"}),
            json!({"add.module": "Pick", "add.how.by": 2}),
            json!({"add.module": {"Pick": {}}, "add.how.by": 3}),
            json!({"add.module": {"Pick": {}}, "add.how.by": 4}),
            json!({"idle.say": "a"}),
            json!({"idle.say": "b"}),
            json!({"nobody.x": 1}),
            json!({}),
        ];
        // Twice, so that each draft is taken up again after others.
        for (step, repeat) in steps.iter().chain(&steps).flat_map(|step| [(step, 0), (step, 2)]) {
            let params: IndexMap<String, Json> = serde_json::from_value(step.clone()).unwrap();
            let mut alone = map.clone();
            let set = in_order(&params).into_iter().try_for_each(|(path, value)| {
                assign(&mut alone, &registry, path, value.clone()).map_err(|problem| vec![problem])
            });
            let options = PlanOptions { repeat, ..options };
            let expected = set.and_then(|()| Plan::new(&alone, &registry, &options));
            let found = series.plan(&params, repeat).map(|planned| told(planned.plan));
            assert_eq!(found, expected.map(|plan| told(&plan)), "{step}");
        }
        // A second series, in which the first of two alike is the one that fails.
        let mut series = PlanSeries::new(&map, &registry, options);
        let mut is_fine = |amount: i32| {
            let params = IndexMap::from([("sum.amount".to_owned(), json!(amount))]);
            series.plan(&params, 0).is_ok()
        };
        assert_eq!([1000, 1, 1000, 2].map(&mut is_fine), [false, true, false, true]);
        assert_eq!((series.drafts.len(), series.n_drawn), (1, 1));
    }
}
