//! Plans of a series are those of single maps.

use serde_json::json;

use super::*;
use crate::files::FileHashes;
use crate::listed::Listed;
use crate::module::Module;
use crate::param::{ChoiceParam, Choices, Entry, Param, Seed};
use crate::registry::ModuleList;
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

const SEED: Param<Seed> = Param::seed("seed", "The seed.", 3);
const FROM: Param<std::path::PathBuf> = Param::input_file("from", "Where.", &["txt"]);
const MAX: Param<f64> = Param::number("max", "At most 9.", 1.0).within((0.0, 9.0));
static DRAWN: Entry<()> =
    Entry { id: "Drawn", summary: "By chance.", params: &[SEED.spec()], build: () };
static LISTED: Entry<()> =
    Entry { id: "Listed", summary: "From a file.", params: &[FROM.spec()], build: () };
static WAYS: Choices<()> =
    Choices::new(&[Listed { item: &DRAWN, source: 1 }, Listed { item: &LISTED, source: 2 }]);
const WAY: ChoiceParam<()> = ChoiceParam::new("way", "How.", &WAYS, "Drawn");
static CHANCE: Module = Module {
    id: "Chance",
    summary: "Has seeds.",
    inputs: &[],
    outputs: &[],
    params: &[WAY.spec(), MAX.spec(), SEED.spec()],
    run: |_| Ok(()),
};
static CHANCES: ModuleList =
    ModuleList { category: "test", modules: &[Listed { item: &CHANCE, source: 1 }] };

/// Plans steps one after the other as a series and each alone, and compares.
fn compare(
    (map, registry, options): (&Map, &Registry, PlanOptions),
    series: &mut PlanSeries,
    steps: &mut dyn Iterator<Item = (&Json, u32)>,
) {
    for (step, repeat) in steps {
        let params: IndexMap<String, Json> = serde_json::from_value(step.clone()).unwrap();
        let mut alone = map.clone();
        let set = in_order(&params).into_iter().try_for_each(|(path, value)| {
            assign(&mut alone, registry, path, value.clone()).map_err(|problem| vec![problem])
        });
        let options = PlanOptions { repeat, ..options };
        let expected = set.and_then(|()| Plan::new(&alone, registry, &options));
        let found = series.plan(&params, repeat).map(|planned| told(planned.plan));
        assert_eq!(found, expected.map(|plan| told(&plan)), "{step} {repeat}");
    }
}

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
    let mut twice = steps.iter().chain(&steps).flat_map(|step| [(step, 0), (step, 2)]);
    compare((&map, &registry, options), &mut series, &mut twice);
    // A second series, in which the first of two alike is the one that fails.
    let mut series = PlanSeries::new(&map, &registry, options);
    let mut is_fine = |amount: i32| {
        let params = IndexMap::from([("sum.amount".to_owned(), json!(amount))]);
        series.plan(&params, 0).is_ok()
    };
    assert_eq!([1000, 1, 1000, 2].map(&mut is_fine), [false, true, false, true]);
    assert_eq!((series.drafts.len(), series.n_drafts), (1, 1));
}

#[test]
fn any_number_of_repeats_is_of_one_draft() {
    let text = r#"{"mve": 1, "nodes": {
        "own": {"module": "Chance", "params": {"seed": 5, "max": 2}},
        "deep": {"module": "Chance", "params": {"way": {"Drawn": {"seed": 7}}}},
        "say": {"module": "Echo"},
        "write": {"module": "Write", "params": {"path": "{say.say}-{repeat}-{own.seed}.txt"}},
        "idle": {"module": "Echo", "mode": "muted"}},
        "links": ["say.text -> write.text"]}"#;
    let (map, files) = (Map::parse(text).unwrap(), FileHashes::new());
    let registry = registry().with(&[&CHANCES], "test");
    let options = plan_options(std::path::Path::new("/"), &files);
    let mut series = PlanSeries::new(&map, &registry, options);
    let steps = ["a", "b"].map(|word| json!({"say.say": word, "own.max": 3}));
    let mut repeats = steps.iter().flat_map(|step| (0..100).map(move |n| (step, n)));
    compare((&map, &registry, options), &mut series, &mut repeats);
    assert_eq!((series.drafts.len(), series.n_drafts), (1, 2));
    // Names may quote the seed of a node that does not run.
    let text = text.replace("\"Echo\", \"mode\"", "\"Chance\", \"mode\"");
    let map = Map::parse(&text.replace("{own.seed}", "{idle.seed}")).unwrap();
    let mut series = PlanSeries::new(&map, &registry, options);
    let mut repeats = steps.iter().flat_map(|step| (0..3).map(move |n| (step, n)));
    compare((&map, &registry, options), &mut series, &mut repeats);
}

#[test]
fn a_step_that_fails_leaves_no_files_to_the_next_one() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.txt"), "a").unwrap();
    let map = r#"{"mve": 1, "nodes": {"n": {"module": "Chance"}}}"#;
    let (map, files) = (Map::parse(map).unwrap(), FileHashes::new());
    let registry = registry().with(&[&CHANCES], "test");
    let options = plan_options(folder.path(), &files);
    let mut series = PlanSeries::new(&map, &registry, options);
    let of_file = json!({"Listed": {"from": "a.txt"}});
    let steps = [
        json!({"n.way": of_file, "n.max": 1}),
        json!({"n.way": "Drawn", "n.max": 100}),
        json!({"n.way": "Drawn", "n.max": 1}),
        json!({"n.way": {"Listed": {"from": "b.txt"}}, "n.max": 1}),
        json!({"n.way": "Drawn", "n.max": 2}),
    ];
    let mut steps = steps.iter().map(|step| (step, 0));
    compare((&map, &registry, options), &mut series, &mut steps);
}
