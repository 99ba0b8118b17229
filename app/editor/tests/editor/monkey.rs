//! Thousands of events at random: the window must not panic, and its map must stay sound.

use std::collections::HashSet;

use crate::hand::Hand;
use eframe::egui::{Event, Key, Modifiers, MouseWheelUnit, PointerButton, Pos2, TouchPhase, Vec2};
use mve_core::Map;

/// A generator of random numbers that gives the same ones in every run (Marsaglia 2003, xorshift).
struct Chance(u64);

impl Chance {
    fn below(&mut self, end: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 % end
    }

    fn place(&mut self) -> Pos2 {
        Pos2::new(self.below(1500) as f32, self.below(950) as f32)
    }

    fn modifiers(&mut self) -> Modifiers {
        match self.below(8) {
            0 => Modifiers::SHIFT,
            1 => Modifiers::COMMAND,
            2 => Modifiers::ALT,
            _ => Modifiers::NONE,
        }
    }
}

/// Keys that the window answers to. Those that open dialogs of the system are left out.
const KEYS: &[Key] = &[
    Key::Tab,
    Key::F,
    Key::Home,
    Key::Delete,
    Key::Backspace,
    Key::D,
    Key::A,
    Key::F2,
    Key::M,
    Key::B,
    Key::H,
    Key::G,
    Key::N,
    Key::L,
    Key::Z,
    Key::Y,
    Key::Escape,
    Key::Enter,
    Key::ArrowDown,
    Key::ArrowUp,
    Key::F1,
    Key::F5,
    Key::Num1,
];

/// Texts for fields: names of modules, numbers, nothing, and what no field expects.
const TEXTS: &[&str] =
    &["Box", "simp", "compare", "info", "12", "-1e400", "NaN", "{a.b}", "ß\u{202e}", "x y.z", ""];

fn event(chance: &mut Chance) -> Vec<Event> {
    let modifiers = chance.modifiers();
    match chance.below(12) {
        0..=2 => vec![Event::PointerMoved(chance.place())],
        3 | 4 => {
            let pos = chance.place();
            let button = match chance.below(6) {
                0 => PointerButton::Secondary,
                1 => PointerButton::Middle,
                _ => PointerButton::Primary,
            };
            let press = |pressed| Event::PointerButton { pos, button, pressed, modifiers };
            vec![Event::PointerMoved(pos), press(true), press(false)]
        }
        5 | 6 => {
            let (pos, button) = (chance.place(), PointerButton::Primary);
            let pressed = chance.below(2) == 0;
            vec![Event::PointerMoved(pos), Event::PointerButton { pos, button, pressed, modifiers }]
        }
        7 | 8 => {
            let key = KEYS[chance.below(KEYS.len() as u64) as usize];
            let press =
                |pressed| Event::Key { key, physical_key: None, pressed, repeat: false, modifiers };
            vec![press(true), press(false)]
        }
        9 => vec![Event::Text(TEXTS[chance.below(TEXTS.len() as u64) as usize].to_owned())],
        10 => {
            let delta = Vec2::new(0.0, chance.below(7) as f32 - 3.0);
            let (unit, phase) = (MouseWheelUnit::Line, TouchPhase::Move);
            vec![Event::MouseWheel { unit, delta, phase, modifiers }]
        }
        _ => match chance.below(3) {
            0 => vec![Event::Copy],
            1 => vec![Event::Cut],
            _ => vec![Event::Paste(
                "{\"mve\": 1, \"nodes\": {\"b\": {\"module\": \"Box\"}}}".to_owned(),
            )],
        },
    }
}

/// What holds for every map that the window has made.
fn check(map: &Map) {
    let mut fed = HashSet::new();
    for link in &map.links {
        assert!(map.nodes.contains_key(&link.from.node), "{link} comes from nowhere");
        assert!(map.nodes.contains_key(&link.to.node), "{link} goes nowhere");
        assert!(fed.insert(&link.to), "{} has two links", link.to);
    }
    for (name, at) in &map.layout {
        assert!(map.nodes.contains_key(name), "{name} has a place and is not there");
        assert!(at.iter().all(|x| x.is_finite()), "{name} is at {at:?}");
    }
    let text = map.to_text();
    let again = Map::parse(&text).expect("what was made is a map");
    assert_eq!(again.to_text(), text);
    assert!(again.problems().is_empty(), "{:?}", again.problems());
}

/// A window that gets 1,000 events. Two of them, and more, can run side by side.
fn is_sound_after_events(seed: u64) {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let file = folder.path().join("small.json");
    let small = r#"{ "mve": 1, "nodes": { "box": { "module": "Box" },
        "simplify": { "module": "Simplificator" }, "info": { "module": "MeshInfo" } },
        "links": ["box.mesh -> simplify.mesh", "simplify.mesh -> info.mesh"] }"#;
    std::fs::write(&file, small).expect("the folder takes files");
    let mut hand = Hand::with_map(folder.path(), &file);
    let mut chance = Chance(seed);
    for round in 0..1000 {
        event(&mut chance).into_iter().for_each(|event| hand.event(event));
        hand.step_once();
        if round % 50 == 0 {
            check(&hand.map());
        }
    }
    check(&hand.map());
}

#[test]
fn events_at_random_leave_a_sound_map() {
    is_sound_after_events(0x9e37_79b9_7f4a_7c15);
}

#[test]
fn other_events_at_random_leave_a_sound_map() {
    is_sound_after_events(0xbf58_476d_1ce4_e5b9);
}

#[test]
fn a_third_row_of_events_leaves_a_sound_map() {
    is_sound_after_events(0x94d0_49bb_1331_11eb);
}
