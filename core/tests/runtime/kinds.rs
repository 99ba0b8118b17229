//! Kinds of parameters whose values have parts: points, selections and formulas, from the map to
//! the module; and for every kind, that a value is what its JSON says.

use std::path::Path;

use mve_core::testing::{
    ADD, ECHO, PICK, READ, Trial, WRITE, plan_options, program_options, run_options,
};
use mve_core::{
    CancelToken, Expression, FileHashes, In, Listed, Map, MaybeIn, Module, ModuleList, Out, Param,
    ParamSpec, Plan, PointNumber, Points, Program, Registry, Seed, Selection, SelectionDomain,
    Store, assign, describe_all, run, run_program, schema,
};
use serde_json::{Value as Json, json};

const MESH: MaybeIn<f64> = MaybeIn::new("mesh", "Stands for a mesh of so many faces.");
const RADIUS: PointNumber =
    PointNumber { name: "radius", doc: "How far it reaches.", default: 1.0, hard: (0.0, 100.0) };
const MARKS: Param<Points> = Param::points("marks", "Where.", &[RADIUS]).on("mesh");
const FACES: Param<Selection> = Param::selection("faces", "Which.", SelectionDomain::Faces, "mesh");
const WEIGHT: Param<Expression> =
    Param::expression("weight", "How much.", "x", &[("x", "The distance."), ("n", "The count.")]);
const SUM: Out<f64> = Out::new("sum", "What came of it.");

/// The radii of the points that lie on the mesh, plus the number of faces, through the formula.
static MARKED: Module = Module {
    id: "Marked",
    summary: "Reads all of them.",
    inputs: &[MESH.spec()],
    outputs: &[SUM.spec()],
    params: &[MARKS.spec(), FACES.spec(), WEIGHT.spec()],
    run: |io| {
        let n_faces = io.maybe(MESH).map_or(0.0, |n| *n) as usize;
        let (marks, faces, weight) = (io.param(MARKS)?, io.param(FACES)?, io.param(WEIGHT)?);
        let on_mesh = marks.0.iter().filter(|mark| mark.place_on(n_faces).is_some());
        let reach: f64 = on_mesh.map(|mark| mark.numbers[0]).sum();
        io.put(SUM, weight.eval(&[reach, faces.len() as f64]));
        Ok(())
    },
};

const STRAY: Param<Selection> = Param::selection("faces", "Which.", SelectionDomain::Faces, "msh");
static BROKEN: Module = Module { id: "Broken", params: &[STRAY.spec()], ..MARKED };

static LIST: ModuleList = ModuleList {
    category: "test",
    modules: &[
        Listed { item: &MARKED, source: 1 },
        Listed { item: &BROKEN, source: 2 },
        Listed { item: &ECHO, source: 3 },
    ],
};

fn registry() -> Registry {
    Registry::new().with(&[&LIST], "test")
}

fn plan_of(text: &str) -> Result<Plan, Vec<String>> {
    let (map, files) = (Map::parse(text).unwrap(), FileHashes::new());
    let options = plan_options(Path::new("/nowhere"), &files);
    Plan::new(&map, &registry(), &options).map_err(|p| p.iter().map(|p| p.to_string()).collect())
}

fn plan(params: &Json) -> Result<Plan, Vec<String>> {
    let map = json!({"mve": 1, "nodes": {"a": {"module": "Marked", "params": params}}});
    plan_of(&map.to_string())
}

fn marks() -> Json {
    json!([
        { "name": "nose", "position": [0, 0, 1], "face": 7, "barycentric": [0.2, 0.3, 0.5] },
        { "name": "ear", "position": [1, 0, 1], "face": 8, "barycentric": [1, 0, 0], "radius": 4 },
        { "name": "above", "position": [0, 0, 9] },
    ])
}

#[test]
fn a_module_reads_them() {
    let sum = |n_faces: f64, weight: &str| {
        let trial = Trial::of(&MARKED).input("mesh", n_faces).set("marks", marks());
        let trial = trial.set("faces", json!([3, [10, 20]])).set("weight", weight);
        *trial.run().unwrap()["sum"].get::<f64>().unwrap()
    };
    assert_eq!(sum(9.0, "x + 100 * n"), 1205.0);
    assert_eq!(sum(8.0, "x"), 1.0); // the ear's face is not there
}

#[test]
fn what_is_wrong_with_them_is_said_at_the_parameter() {
    let twice = json!([marks()[2].clone(), marks()[2].clone()]);
    let problems = plan(&json!({"marks": twice, "faces": [5, 3], "weight": "x +"})).unwrap_err();
    let expected = [
        "a.marks: point 2 (\"above\"): another point has this name",
        "a.faces: 3 stands behind 5; indices rise, and each stands once",
        "a.weight: column 4: a value is missing at the end",
    ];
    assert_eq!(problems, expected);
    let wrong = plan(&json!({"weight": 3})).unwrap_err();
    assert_eq!(wrong, ["a.weight: 3 is not a formula, as a text"]);
    let stray = plan_of(r#"{"mve": 1, "nodes": {"a": {"module": "Broken"}}}"#).unwrap_err();
    let expected = "a: this is a bug in the module: faces: the module has no input \"msh\"; did \
                    you mean \"mesh\"?";
    assert_eq!(stray, [expected]);
}

#[test]
fn they_are_part_of_the_key_by_what_they_mean() {
    let key = |params: Json| plan(&params).unwrap().nodes[0].key;
    let plain = key(json!({}));
    assert_eq!(plain, key(json!({"marks": [], "faces": [], "weight": "x"})));
    for other in [json!({"marks": marks()}), json!({"faces": [1]}), json!({"weight": "n"})] {
        assert_ne!(plain, key(other.clone()), "{other}");
    }
    assert_eq!(key(json!({"faces": [4, 5, 6]})), key(json!({"faces": [[4, 6]]})));
    let point = |json: Json| key(json!({ "marks": [json] }));
    let short = point(json!({"name": "a", "position": [0, 0, 0]}));
    assert_eq!(short, point(json!({"radius": 1, "position": [0.0, 0.0, 0.0], "name": "a"})));
}

#[test]
fn a_formula_takes_a_link_and_the_others_do_not() {
    let linked = |to: &str| {
        plan_of(&format!(
            r#"{{"mve": 1, "nodes": {{"e": {{"module": "Echo", "params": {{"say": "n + 7"}}}},
                "a": {{"module": "Marked"}}}}, "links": ["e.text -> a.{to}"]}}"#
        ))
    };
    let (folder, cancel) = (tempfile::tempdir().unwrap(), CancelToken::new());
    let outcome = run(&linked("weight").unwrap(), &run_options(folder.path(), &cancel));
    assert_eq!(outcome.nodes["a"].record.scalars["sum"].to_string(), "7");
    for to in ["marks", "faces"] {
        assert!(linked(to).unwrap_err()[0].contains("must be set in the map, not linked"));
    }
}

#[test]
fn programs_vary_them() {
    let mut map = Map::parse(r#"{"mve": 1, "nodes": {"a": {"module": "Marked"}}}"#).unwrap();
    assign(&mut map, &registry(), "a.faces", json!([[1, 9]])).unwrap();
    assert_eq!(json!(map.nodes["a"].params), json!({"faces": [[1, 9]]}));
    assert!(assign(&mut map, &registry(), "a.marks.nose", json!(1)).is_err());
    let text = r#"{"mve": 1, "nodes": {"a": {"module": "Marked"}}, "programs": {"p": {"axes": [
        {"a.faces": [[], [[1, 9]]]}, {"a.weight": ["n", "2 * n", "n^2"]}]}}}"#;
    let map = Map::parse(text).unwrap();
    let program = Program::new(&map, "p", &registry(), Path::new("/")).unwrap_or_else(|problems| {
        panic!("{problems:#?}");
    });
    let (folder, cancel) = (tempfile::tempdir().unwrap(), CancelToken::new());
    let store = Store::open(folder.path()).unwrap();
    run_program(&program, &store, &program_options(&cancel)).unwrap();
    let table = std::fs::read_to_string(folder.path().join("results.csv")).unwrap();
    let sums: Vec<&str> = table.lines().skip(1).collect();
    assert_eq!(sums.len(), 6, "{table}");
    assert!(sums[5].contains(",81"), "{table}"); // n^2 of nine faces
}

#[test]
fn the_map_has_a_point_on_a_line() {
    let mut map = Map::parse(r#"{"mve": 1, "nodes": {"a": {"module": "Marked"}}}"#).unwrap();
    assign(&mut map, &registry(), "a.marks", marks()).unwrap();
    let text = map.to_text();
    let lines: Vec<&str> = text.lines().filter(|line| line.contains("position")).collect();
    assert_eq!(lines.len(), 3, "{text}");
    assert_eq!(json!(Map::parse(&text).unwrap().nodes["a"].params["marks"]), marks());
}

#[test]
fn schema_and_help_tell_of_them() {
    let schema = schema(&registry());
    let modules =
        schema["properties"]["nodes"]["additionalProperties"]["allOf"].as_array().unwrap();
    let of_module = |m: &&Json| m["if"]["properties"]["module"]["const"] == "Marked";
    let module = modules.iter().find(of_module).unwrap();
    let params = &module["then"]["properties"]["params"]["properties"];
    let point = &params["marks"]["items"]["properties"];
    assert_eq!(point["radius"]["default"], 1.0);
    assert_eq!(
        (&point["radius"]["minimum"], &point["radius"]["maximum"]),
        (&json!(0.0), &json!(100.0))
    );
    assert_eq!(point["barycentric"]["maxItems"], 3);
    assert_eq!(params["faces"]["default"], json!([]));
    assert_eq!(params["weight"]["type"], "string");
    let help = describe_all(&registry());
    for line in [
        "- `marks` (named points on mesh or free in space; default empty): Where.\n  - `radius`: How",
        "- `faces` (selection of faces of mesh, such as [3, [10, 20]]; default empty): Which.",
        "- `weight` (formula over the variables below; default x; takes a link from Text): How",
        "  - `n`: The count.",
    ] {
        assert!(help.contains(line), "{line}\nis not in\n{help}");
    }
}

const OFF: Param<Option<i64>> = Param::maybe_integer("off", "Off.", None);
const RATIO: Param<Option<f64>> = Param::maybe_number("ratio", "Ratio.", Some(0.25));
const ON: Param<bool> = Param::flag("on", "On.", true);
const SEED: Param<Seed> = Param::seed("seed", "Seed.", 3);
const SOLE: In<f64> = In::new("mesh", "Stands for a mesh.");

/// One parameter of every kind, and some that can be off.
fn every_kind() -> Vec<ParamSpec> {
    let known = [MARKED.params, PICK.params, ECHO.params, ADD.params, READ.params, WRITE.params];
    let mut all = known.concat();
    all.extend([OFF.spec(), RATIO.spec(), ON.spec(), SEED.spec()]);
    all
}

/// What the JSON of a value says is the value, and its JSON again.
fn check(spec: &ParamSpec, json: &Json) {
    let setting = spec.read(json).unwrap_or_else(|why| panic!("{} {json}: {why}", spec.name));
    let written = setting.to_json();
    let again = spec.read(&written).unwrap();
    assert_eq!((&again, again.to_json()), (&setting, written.clone()), "{}", spec.name);
    // A map's text keeps it too.
    let text: Json = serde_json::from_str(&written.to_string()).unwrap();
    assert_eq!(text, written, "{}", spec.name);
}

#[test]
fn a_value_is_what_its_json_says() {
    for spec in every_kind() {
        assert_eq!(spec.fault(&[SOLE.spec()]), None, "{}", spec.name);
        for json in spec.examples() {
            check(&spec, &json);
            check(&spec, &spec.another(&json));
        }
        match spec.default_json() {
            Some(json) => {
                check(&spec, &json);
                assert_eq!(spec.default_setting(), spec.read(&json).ok(), "{}", spec.name);
            }
            None => check(&spec, &json!("a/b.txt")),
        }
        if spec.can_be_off {
            check(&spec, &Json::Null);
            assert!(!spec.another(&Json::Null).is_null());
        }
    }
}

/// The numbers of a linear congruential generator (Knuth's MMIX constants).
fn numbers(mut state: u64) -> impl FnMut(u64) -> u64 {
    move |below| {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % below
    }
}

#[test]
fn random_values_come_back_from_their_json() {
    let mut next = numbers(1);
    for _ in 0..500 {
        let selection = Selection::of((0..next(30)).map(|_| next(40) as u32).collect::<Vec<_>>());
        let json = selection.to_json();
        assert_eq!(FACES.spec().read(&json).unwrap().to_json(), json);
        assert_eq!(Selection::from_text(&selection.to_string()), Ok(selection.clone()));
        assert_eq!(Selection::of(selection.iter()), selection);
        check(&RATIO.spec(), &json!(f64::from_bits(next(1 << 30) << 32 | next(1 << 30))));
        let point = |n: u64, next: &mut dyn FnMut(u64) -> u64| {
            let [a, b] = [next(100) as f64 / 300.0, next(100) as f64 / 300.0];
            let position = [a, -b, a * 1e9];
            match next(2) {
                0 => json!({"name": format!("p{n}"), "position": position, "radius": next(100)}),
                _ => json!({"name": format!("p{n}"), "position": position, "face": next(9),
                            "barycentric": [a, b, 1.0 - a - b]}),
            }
        };
        let n = next(6);
        check(&MARKS.spec(), &Json::Array((0..n).map(|n| point(n, &mut next)).collect()));
    }
}
