//! The editor's model without a window: edits, undo, clips, files, on empty and on shipped maps.

#[path = "document/random.rs"]
mod random;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use mve_core::{Link, Map, ProgramSpec, Registry};
use mve_editor::document::{
    Clip, DiskChange, Document, Edit, Extras, Item, Recovery, fits, is_many,
};
use mve_modules::registry;
use serde_json::{Value as Json, json};

fn shipped_maps() -> Vec<PathBuf> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../maps");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut maps: Vec<_> = files.filter(|p| p.extension().is_some_and(|e| e == "json")).collect();
    maps.sort();
    maps
}

/// What must hold of an open map after any edit.
fn check(document: &Document, registry: &Registry) {
    let (map, extras) = (document.map(), document.extras());
    let registry = &registry.with_maps_of(map, Path::new(""));
    for link in &map.links {
        assert_eq!(fits(map, registry, link), Ok(()), "{link}");
        let n_links = map.links.iter().filter(|other| other.to == link.to).count();
        assert!(n_links == 1 || is_many(map, registry, &link.to), "{link}");
    }
    assert!(map.layout.keys().all(|name| map.nodes.contains_key(name)), "{:?}", map.layout);
    assert!(extras.collapsed.iter().all(|name| map.nodes.contains_key(name)));
    assert!(extras.reroutes.values().all(|reroute| map.links.contains(&reroute.link)));
    assert!(map.nodes.keys().all(|name| Map::can_name_a_node(name)));
    let nodes = map.nodes.keys().cloned().map(Item::Node);
    assert!(nodes.into_iter().all(|node| document.position(&node).is_some()));
    let again = Map::parse(document.text()).unwrap();
    assert_eq!(again.problems(), []);
    assert_eq!(again.to_text(), document.text());
    assert_eq!((&again.nodes, &again.links), (&map.nodes, &map.links));
    assert_eq!(Extras::of(&again), *extras);
}

#[test]
fn opening_and_saving_changes_no_byte() {
    let folder = tempfile::tempdir().unwrap();
    for path in shipped_maps() {
        let mut document = Document::open(&path).unwrap();
        assert!(!document.is_dirty());
        let copy = folder.path().join(path.file_name().unwrap());
        document.save_as(&copy).unwrap();
        assert_eq!(std::fs::read(&copy).unwrap(), std::fs::read(&path).unwrap());
    }
}

fn link(text: &str) -> Link {
    text.parse().unwrap()
}

fn node(name: &str) -> Item {
    Item::Node(name.to_owned())
}

fn add(module: &str, name: &str) -> Edit {
    Edit::AddNode { module: module.to_owned(), name: Some(name.to_owned()), at: [0.0, 0.0] }
}

/// `load -> simplify -> compare`, and a saver named after them; with a program and a report.
fn chain() -> Document {
    let registry = registry();
    let mut document = Document::new();
    let set = |node: &str, path: &str, value: Json| Edit::SetParam {
        node: node.to_owned(),
        path: path.to_owned(),
        value: Some(value),
    };
    let spec: ProgramSpec = serde_json::from_value(json!({
        "axes": [{ "simplify.target_faces": [10, 20], "save.path": ["{simplify.cost}.obj", "b.obj"] }],
        "steps": [{ "simplify.cost": "Quadric" }],
        "report": {
            "measures": [{ "column": "seconds.simplify", "title": "simplify.x" }],
            "against": ["simplify.faces", "compare.rms"], "series": "simplify.cost",
            "questions": [{ "text": "simplify.cost?", "measure": "compare.rms",
                            "compare": { "simplify.cost": ["A", "B"] }, "same": ["simplify.faces"] }]
        }
    }))
    .unwrap();
    let edits = [
        add("ObjLoader", "load"),
        add("Simplificator", "simplify"),
        add("MeshComparer", "compare"),
        add("ObjSaver", "save"),
        set("load", "path", json!("{simplify.cost}.obj")),
        set("save", "path", json!("{load.path.stem}-{simplify.cost}.obj")),
        Edit::Connect(link("load.mesh -> simplify.mesh")),
        Edit::Connect(link("load.mesh -> compare.original")),
        Edit::Connect(link("simplify.mesh -> compare.simplified")),
        Edit::Connect(link("simplify.mesh -> save.mesh")),
        Edit::AddReroute { link: link("load.mesh -> simplify.mesh"), at: [50.0, 50.0] },
        Edit::SetProgram { name: "costs".to_owned(), spec: Some(spec) },
    ];
    document.apply(&edits, &registry).unwrap();
    document
}

#[test]
fn a_rename_reaches_programs_reports_and_names_of_files() {
    let registry = registry();
    let mut document = chain();
    let rename = Edit::Rename { node: "simplify".to_owned(), to: "cut".to_owned() };
    let applied = document.apply(&[rename], &registry).unwrap();
    assert_eq!(applied.renamed, [("simplify".to_owned(), "cut".to_owned())]);
    let map = document.map();
    assert_eq!(map.nodes.get_index_of("cut"), Some(1));
    assert_eq!(map.nodes["save"].params["path"], "{load.path.stem}-{cut.cost}.obj");
    // The path of a file that is read is no template.
    assert_eq!(map.nodes["load"].params["path"], "{simplify.cost}.obj");
    let program = serde_json::to_value(&map.programs["costs"]).unwrap();
    assert_eq!(
        program,
        json!({
            "axes": [{ "cut.target_faces": [10, 20], "save.path": ["{cut.cost}.obj", "b.obj"] }],
            "steps": [{ "cut.cost": "Quadric" }],
            "report": {
                "measures": [{ "column": "seconds.cut", "title": "simplify.x" }],
                "against": ["cut.faces", "compare.rms"], "series": "cut.cost",
                "questions": [{ "text": "simplify.cost?", "measure": "compare.rms",
                                "compare": { "cut.cost": ["A", "B"] }, "same": ["cut.faces"] }]
            }
        })
    );
    check(&document, &registry);
    let to_taken = Edit::Rename { node: "cut".to_owned(), to: "load".to_owned() };
    let error = document.apply(&[to_taken], &registry).unwrap_err();
    assert_eq!(error.to_string(), "\"load\" cannot be the name: another node has it");
}

#[test]
fn links_that_make_no_sense_are_refused_with_the_reason() {
    let registry = registry();
    let mut document = chain();
    document.apply(&[add("MeshInfo", "info"), add("Simplificator", "again")], &registry).unwrap();
    let mut refuse = |text: &str| {
        document.apply(&[Edit::Connect(link(text))], &registry).unwrap_err().to_string()
    };
    assert_eq!(
        refuse("info.faces -> simplify.mesh"),
        "simplify.mesh takes a TriMesh, and info.faces is a Number"
    );
    assert!(refuse("simplify.mesh -> simplify.mesh").ends_with("would make a loop"));
    assert!(refuse("load.mesh -> save.path").contains("must be set in the map"));
    assert!(refuse("load.mash -> simplify.mesh").contains("no output \"mash\""));
    // An input takes one link; the one that it has gives way, and the points of its wire with it.
    document.apply(&[Edit::Connect(link("load.mesh -> again.mesh"))], &registry).unwrap();
    document.apply(&[Edit::Connect(link("again.mesh -> simplify.mesh"))], &registry).unwrap();
    assert!(document.extras().reroutes.is_empty());
    let back = Edit::Connect(link("simplify.mesh -> again.mesh"));
    assert!(document.apply(&[back], &registry).unwrap_err().to_string().contains("loop"));
    check(&document, &registry);
}

#[test]
fn edits_together_are_one_step_or_none() {
    let registry = registry();
    let mut document = chain();
    let before = document.text().to_owned();
    let bad = [add("MeshInfo", "info"), Edit::Disconnect(link("a.b -> c.d"))];
    assert!(document.apply(&bad, &registry).is_err());
    assert_eq!(document.text(), before);
    document.undo().unwrap();
    assert_eq!(document.text(), Document::new().text());
    assert_eq!(document.redo_label(), Some("Add ObjLoader and more"));
}

#[test]
fn a_drag_is_one_step() {
    let registry = registry();
    let mut document = chain();
    let start = Instant::now() + Duration::from_secs(60);
    let mut set = |faces: u32, seconds: f64| {
        let value = Some(json!(faces));
        let edit = Edit::SetParam { node: "simplify".into(), path: "target_faces".into(), value };
        let now = start + Duration::from_secs_f64(seconds);
        document.apply_at(&[edit], &registry, now).unwrap();
    };
    // Each within a second of the one before, then a pause.
    for (faces, seconds) in [(10, 0.0), (11, 0.9), (12, 1.8), (13, 9.0)] {
        set(faces, seconds);
    }
    let faces =
        |document: &Document| document.map().nodes["simplify"].params.get("target_faces").cloned();
    assert_eq!(document.undo(), Some("Set simplify.target_faces"));
    assert_eq!(faces(&document), Some(json!(12)));
    document.undo().unwrap();
    assert_eq!(faces(&document), None);
}

#[test]
fn a_parameter_goes_back_to_its_default() {
    let registry = registry();
    let mut document = chain();
    let mut set = |path: &str, value: Option<Json>| {
        let edit = Edit::SetParam { node: "simplify".into(), path: path.into(), value };
        document.apply(&[edit], &registry).unwrap();
        json!(document.map().nodes["simplify"].params)
    };
    assert_eq!(set("cost", Some(json!("Quadric"))), json!({ "cost": "Quadric" }));
    let nested = set("cost.boundary_weight", Some(json!(3.0)));
    assert_eq!(nested, json!({ "cost": { "Quadric": { "boundary_weight": 3.0 } } }));
    assert_eq!(set("cost.boundary_weight", None)["cost"].as_object(), None);
    assert_eq!(set("cost", None), json!({}));
}

#[test]
fn another_module_keeps_what_fits() {
    let registry = registry();
    let mut document = chain();
    let set = |node: &str, id: &str| Edit::SetParam {
        node: node.to_owned(),
        path: "module".to_owned(),
        value: Some(json!(id)),
    };
    document.apply(&[set("load", "Box")], &registry).unwrap();
    assert!(document.map().nodes["load"].params.is_empty());
    assert_eq!(document.map().links.len(), 4);
    document.apply(&[set("simplify", "MeshInfo")], &registry).unwrap();
    let links: Vec<String> = document.map().links.iter().map(Link::to_string).collect();
    assert_eq!(links, ["load.mesh -> simplify.mesh", "load.mesh -> compare.original"]);
    check(&document, &registry);
}

#[test]
fn clips_are_texts_of_maps_and_go_from_map_to_map() {
    let registry = registry();
    let source = chain();
    let copied = [node("simplify"), node("save")];
    for clip in [Clip::copy(&source, &copied), Clip::copy_with_links(&source, &copied)] {
        assert_eq!(Clip::parse(&clip.to_text()).unwrap().to_text(), clip.to_text());
        assert_eq!(Map::parse(&clip.to_text()).unwrap().problems(), []);
    }
    // A duplicate takes from the same node as the first.
    let mut document = chain();
    let clip = Clip::parse(&Clip::copy_with_links(&source, &copied).to_text()).unwrap();
    let applied = document.apply(&[Edit::Paste { clip, at: [300.0, 10.0] }], &registry).unwrap();
    assert_eq!(applied.new_items, [node("simplify-2"), node("save-2")]);
    let links = &document.map().links;
    assert!(links.contains(&link("load.mesh -> simplify-2.mesh")));
    assert!(links.contains(&link("simplify-2.mesh -> save-2.mesh")));
    let path = &document.map().nodes["save-2"].params["path"];
    assert_eq!(path, "{load.path.stem}-{simplify-2.cost}.obj");
    assert_eq!(document.position(&node("simplify-2")), Some([300.0, 10.0]));
    // Another map has no node to take from; a whole map is a clip, and brings its programs.
    let mut other = Document::new();
    let clip = Clip::copy_with_links(&source, &copied);
    other.apply(&[Edit::Paste { clip, at: [0.0, 0.0] }], &registry).unwrap();
    assert_eq!(other.map().links, [link("simplify.mesh -> save.mesh")]);
    let mut whole = Document::new();
    let clip = Clip::parse(source.text()).unwrap();
    whole.apply(&[Edit::Paste { clip, at: [0.0, 0.0] }], &registry).unwrap();
    assert_eq!(whole.map().nodes, source.map().nodes);
    assert_eq!(whole.map().programs, source.map().programs);
    assert_eq!(whole.extras().reroutes.len(), 1);
    assert!(
        ["", "text", "{}", "[1]", "{\"mve\": 1, \"nodes\": {}}"]
            .iter()
            .all(|t| Clip::parse(t).is_none())
    );
    check(&document, &registry);
    check(&whole, &registry);
}

#[test]
fn unknown_parts_live_through_edits() {
    let registry = registry();
    let text = r#"{ "mve": 1, "nodes": { "a": { "module": "NotYetWritten", "hue": 3 }, "b": 7 },
        "links": ["a.x -> b.y", "nonsense"], "canvas": { "camera": [1], "frames": { "f": 9 } },
        "future": { "z": [1] } }"#;
    let mut document = Document::from_text(text).unwrap();
    let edits = [
        Edit::AddNode { module: "Box".to_owned(), name: Some("b".to_owned()), at: [1.0, 2.0] },
        Edit::AddNote { text: "hello".to_owned(), at: [3.0, 4.0] },
    ];
    let applied = document.apply(&edits, &registry).unwrap();
    assert_eq!(applied.new_items[0], node("b-2"));
    let json: Json = serde_json::from_str(document.text()).unwrap();
    assert_eq!(json["nodes"]["a"], json!({ "module": "NotYetWritten", "hue": 3 }));
    assert_eq!((&json["nodes"]["b"], &json["links"][1]), (&json!(7), &json!("nonsense")));
    assert_eq!(
        (&json["canvas"]["camera"], &json["canvas"]["frames"]["f"]),
        (&json!([1]), &json!(9))
    );
    assert_eq!(json["future"], json!({ "z": [1] }));
    // The node, the link, and warnings of "hue" and "future".
    assert_eq!(document.map().problems().len(), 4);
    document.undo().unwrap();
    assert_eq!(document.text(), text);
}

#[test]
fn what_is_selected_goes_with_the_map() {
    let registry = registry();
    let mut document = chain();
    document.select([node("save"), node("load"), node("nobody")]);
    assert_eq!(document.selection().len(), 2);
    document.apply(&[Edit::Remove(vec![node("save")])], &registry).unwrap();
    assert_eq!(document.selection().iter().collect::<Vec<_>>(), [&node("load")]);
}

#[test]
fn maps_without_a_layout_are_drawn_and_not_changed() {
    let registry = registry();
    let text = chain().text().replace("\"layout\"", "\"layout of old\"");
    let mut document = Document::from_text(&text).unwrap();
    let place = |document: &Document, name: &str| document.position(&node(name)).unwrap();
    assert!(place(&document, "load")[0] < place(&document, "simplify")[0]);
    assert!(place(&document, "simplify")[0] < place(&document, "save")[0]);
    assert_eq!(document.text(), text);
    // Moving one node moves no other.
    let before = place(&document, "save");
    document.apply(&[Edit::Move(vec![(node("load"), [-900.4, 0.0])])], &registry).unwrap();
    assert_eq!((place(&document, "load"), place(&document, "save")), ([-900.0, 0.0], before));
}

#[test]
fn changes_on_disk_are_noticed() {
    let registry = registry();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.json");
    let mut document = chain();
    assert!(document.save().is_err());
    document.save_as(&path).unwrap();
    assert_eq!((document.path(), document.is_dirty()), (Some(path.as_path()), false));
    assert_eq!(document.disk_change(), None);
    let ours = document.text().to_owned();
    std::fs::write(&path, &ours).unwrap(); // a later time, the same content
    assert_eq!(document.disk_change(), None);
    let theirs = ours.replace("target_faces", "target_edges");
    std::fs::write(&path, &theirs).unwrap();
    assert_eq!(document.disk_change(), Some(DiskChange::Changed));
    document.keep_mine();
    assert_eq!((document.disk_change(), document.is_dirty()), (None, true));
    document.reload().unwrap();
    assert_eq!((document.text(), document.is_dirty()), (theirs.as_str(), false));
    document.undo().unwrap();
    assert_eq!((document.text(), document.is_dirty()), (ours.as_str(), true));
    std::fs::remove_file(&path).unwrap();
    assert_eq!(document.disk_change(), Some(DiskChange::Removed));
    document.apply(&[Edit::SetTitle("new".to_owned())], &registry).unwrap();
    document.save().unwrap();
    assert_eq!((document.disk_change(), document.is_dirty()), (None, false));
}

fn files_in(folder: &Path) -> usize {
    std::fs::read_dir(folder).unwrap().count()
}

#[test]
fn what_was_not_saved_outlives_a_crash() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("recovery");
    let mut first = Recovery::new(&place).unwrap();
    let (mut document, clean) = (chain(), Document::new());
    first.autosave(&document).unwrap();
    first.autosave(&clean).unwrap();
    assert_eq!(files_in(&place), 2); // the session and one copy
    let mut second = Recovery::new(&place).unwrap();
    assert_eq!(second.found().unwrap(), []); // the first still lives
    drop(first);
    let found = second.found().unwrap();
    assert_eq!(found.len(), 1);
    let recovered = found[0].open().unwrap();
    assert_eq!((recovered.text(), recovered.is_dirty()), (document.text(), true));
    // It belongs to the second session now, until that ends too.
    let mut third = Recovery::new(&place).unwrap();
    assert_eq!(third.found().unwrap(), []);
    second.autosave(&recovered).unwrap();
    second.discard(&found[0]).unwrap();
    document.save_as(&folder.path().join("map.json")).unwrap();
    second.autosave(&document).unwrap();
    second.forget(&recovered).unwrap();
    drop(second);
    assert_eq!(third.found().unwrap(), []);
    drop(third);
    assert_eq!(files_in(&place), 0);
}

#[test]
fn a_frame_stays_around_what_is_arranged() {
    let registry = registry();
    let mut document = chain();
    let names: Vec<String> = document.map().nodes.keys().cloned().collect();
    let last = names.last().unwrap().clone();
    let moved = vec![(Item::Node(last.clone()), [3000.0, 2000.0])];
    let frame =
        Edit::AddFrame { title: "around".to_owned(), at: [2900.0, 1900.0], size: [900.0, 900.0] };
    document.apply(&[Edit::Move(moved), frame], &registry).unwrap();
    document.apply(&[Edit::Arrange { nodes: Vec::new() }], &registry).unwrap();
    let [x, y] = document.position(&Item::Node(last)).unwrap();
    let frame = document.extras().frames.values().next().unwrap();
    assert_eq!(frame.at, [x - 20.0, y - 40.0]);
}
