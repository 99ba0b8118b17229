//! Random sequences of edits: the map stays in order, and undoing brings back its bytes.

use std::time::{Duration, Instant};

use mve_core::{Link, NodeMode, PortRef, Registry};
use mve_editor::document::{Alignment, Clip, Direction, Document, Edit, Item};
use mve_editor::kept::{KeptEdit, Shelf};
use mve_modules::registry;
use proptest::prelude::*;
use serde_json::Value as Json;

use super::{check, shipped_maps};

/// What a random edit is made of: its kind, and numbers that choose among what is there.
type Dice = (u8, usize, usize, i16, i16);

fn pick<T>(all: impl IntoIterator<Item = T>, dice: usize) -> Option<T> {
    let all: Vec<T> = all.into_iter().collect();
    let n = all.len();
    (n > 0).then(|| all.into_iter().nth(dice % n)).flatten()
}

fn items(document: &Document) -> Vec<Item> {
    let (map, extras) = (document.map(), document.extras());
    let nodes = map.nodes.keys().cloned().map(Item::Node);
    let frames = extras.frames.keys().cloned().map(Item::Frame);
    let notes = extras.notes.keys().cloned().map(Item::Note);
    let reroutes = extras.reroutes.keys().cloned().map(Item::Reroute);
    nodes.chain(frames).chain(notes).chain(reroutes).collect()
}

/// Some items, chosen by the bits of the dice.
fn some_items(document: &Document, dice: usize) -> Vec<Item> {
    let all = items(document).into_iter().enumerate();
    all.filter(|(place, _)| dice >> (place % 16) & 1 == 1).map(|(_, item)| item).collect()
}

/// A link between any two ports; most do not fit.
fn any_link(document: &Document, registry: &Registry, a: usize, b: usize) -> Option<Link> {
    let nodes = &document.map().nodes;
    let (from, to) = (pick(nodes, a)?, pick(nodes, b)?);
    let (give, take) = (registry.find(&from.1.module)?, registry.find(&to.1.module)?);
    let output = pick(give.module.outputs, b / 7)?.name;
    let inputs = take.module.inputs.iter().map(|input| input.name);
    let input = pick(inputs.chain(take.module.params.iter().map(|param| param.name)), a / 7)?;
    let end = |node: &String, port: &str| PortRef { node: node.clone(), port: port.to_owned() };
    Some(Link { from: end(from.0, output), to: end(to.0, input) })
}

fn any_param(document: &Document, registry: &Registry, (_, a, b, x, _): Dice) -> Option<Edit> {
    let (node, what) = pick(&document.map().nodes, a)?;
    if b % 9 == 0 {
        let value = Some(Json::from(pick(registry.modules(), b)?.module.id));
        return Some(Edit::SetParam { node: node.clone(), path: "module".to_owned(), value });
    }
    let spec = pick(registry.find(&what.module)?.module.params, b)?;
    let value = (x % 3 != 0).then(|| match spec.default_setting() {
        Some(setting) if x % 2 == 0 => setting.to_json(),
        _ => Json::from(format!("{{{node}.source}}-{x}")),
    });
    Some(Edit::SetParam { node: node.clone(), path: spec.name.to_owned(), value })
}

fn any_edit(document: &Document, registry: &Registry, dice: Dice) -> Option<Edit> {
    let (kind, a, b, x, y) = dice;
    let map = document.map();
    let at = [f64::from(x) / 3.0, f64::from(y)];
    let node = || pick(map.nodes.keys().cloned(), a);
    let some = || some_items(document, b);
    Some(match kind % 25 {
        0 | 1 => Edit::AddNode {
            module: pick(registry.modules(), a)?.module.id.to_owned(),
            name: None,
            at,
        },
        2 => Edit::Remove(some_items(document, a & b)),
        3..=6 => Edit::Connect(any_link(document, registry, a, b)?),
        7 => Edit::Disconnect(pick(&map.links, a)?.clone()),
        8 | 9 => any_param(document, registry, dice)?,
        10 => Edit::Move(some().into_iter().map(|item| (item, at)).collect()),
        11 => Edit::Rename { node: node()?, to: format!("n{}", b % 5) },
        12 => Edit::SetMode {
            nodes: vec![node()?],
            mode: pick([NodeMode::Active, NodeMode::Muted, NodeMode::Bypassed], b)?,
        },
        13 => Edit::SetCollapsed { nodes: vec![node()?], is_collapsed: b % 2 == 0 },
        14 => Edit::SetText { item: pick(items(document), a)?, text: format!("text {b}") },
        15 => Edit::SetColor {
            item: pick(items(document), a)?,
            color: (b % 2 == 0).then_some([1, 2, 3]),
        },
        16 => Edit::AddFrame { title: format!("frame {a}"), at, size: [f64::from(y), 10.0] },
        17 => Edit::AddNote { text: format!("note {a}"), at },
        18 => Edit::AddReroute { link: pick(&map.links, a)?.clone(), at },
        19 => Edit::Paste { clip: Clip::copy_with_links(document, &some()), at },
        20 => Edit::Align {
            items: some(),
            to: pick([Alignment::Left, Alignment::Middle, Alignment::Bottom], a)?,
        },
        21 => Edit::Distribute {
            items: some(),
            along: pick([Direction::Across, Direction::Down], a)?,
        },
        22 => Edit::Arrange { nodes: Vec::new() },
        23 => Edit::Keep(any_kept(a, b)),
        _ if a % 3 == 0 => Edit::SetTitle(format!("title {b}")),
        _ if a % 3 == 1 => Edit::ReplaceText(document.text().replace("\n  ", "\n ")),
        _ => any_program(document, b)?,
    })
}

/// Of few names, so that some are there.
fn any_kept(a: usize, b: usize) -> KeptEdit {
    let shelf = Shelf::ALL[b % 2];
    let [name, to] = [a, b].map(|n| format!("kept {}", n % 3));
    match a % 4 {
        0 | 1 => KeptEdit::Put { shelf, name, content: Json::from(b) },
        2 => KeptEdit::Remove { shelf, name },
        _ => KeptEdit::Rename { shelf, name, to },
    }
}

fn any_program(document: &Document, b: usize) -> Option<Edit> {
    let (name, program) = pick(&document.map().programs, b)?;
    Some(match b % 3 {
        0 => Edit::SetProgram { name: format!("p{b}"), spec: Some(program.clone()) },
        1 => Edit::SetProgram { name: name.clone(), spec: None },
        _ => Edit::RenameProgram { name: name.clone(), to: format!("p{b}") },
    })
}

/// Applies random edits, then undoes and redoes them all.
fn edit_at_random(text: &str, dice: &[Dice]) {
    let registry = registry();
    let mut document = Document::from_text(text).unwrap();
    let mut now = Instant::now();
    for dice in dice {
        now += Duration::from_millis(dice.1 as u64 % 1500);
        let Some(edit) = any_edit(&document, &registry, *dice) else { continue };
        let (before, revision) = (document.text().to_owned(), document.revision());
        let result = document.apply_at(std::slice::from_ref(&edit), &registry, now);
        let has_changed = document.text() != before;
        assert!(result.is_ok() || !has_changed, "{edit:?}");
        assert!(!has_changed || document.revision() > revision);
        check(&document, &registry);
    }
    let last = document.text().to_owned();
    while document.undo().is_some() {
        check(&document, &registry);
    }
    assert_eq!(document.text(), text);
    assert!(!document.is_dirty());
    while document.redo().is_some() {}
    assert_eq!(document.text(), last);
}

fn dice() -> impl Strategy<Value = Vec<Dice>> {
    prop::collection::vec(any::<Dice>(), 1..40)
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 48,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn edits_of_an_empty_map_are_undone(dice in dice()) {
        edit_at_random(Document::new().text(), &dice);
    }

    #[test]
    fn edits_of_shipped_maps_are_undone(dice in dice(), place in any::<prop::sample::Index>()) {
        let maps = shipped_maps();
        edit_at_random(&std::fs::read_to_string(place.get(&maps)).unwrap(), &dice);
    }
}
