//! The pictures of the window in README: `cargo run --release -p mve-editor --example screenshots
//! -- docs/pictures`. They are drawn without a display, by the same hand that the tests have. Maps
//! named after the folder are drawn in their place.

#[allow(dead_code)] // A part of what tests need.
#[path = "../tests/editor/hand/mod.rs"]
mod hand;

use std::path::{Path, PathBuf};

use eframe::egui::Key;
use hand::Hand;

const MAP: &str = r#"{ "mve": 1,
  "title": "Where does a simplified vase differ?",
  "nodes": {
    "model": { "module": "Vase" },
    "simplify": { "module": "Simplificator", "params": { "target_faces": 800 } },
    "compare": { "module": "MeshComparer" },
    "save": { "module": "ObjSaver", "params": { "path": "vase-{simplify.target_faces}-{simplify.cost}.obj" } }
  },
  "links": [
    "model.mesh -> simplify.mesh", "model.mesh -> compare.original",
    "simplify.mesh -> compare.simplified", "simplify.mesh -> save.mesh"
  ],
  "programs": { "costs": { "axes": [
    { "simplify.target_faces": [4000, 2000, 1000, 500] },
    { "simplify.cost": ["EdgeLength", "Quadric"] } ] } }
}"#;

fn main() {
    let folder = std::env::args_os().nth(1).map_or_else(|| PathBuf::from("."), PathBuf::from);
    std::fs::create_dir_all(&folder).expect("the folder can be made");
    let folder = folder.canonicalize().expect("the folder is there");
    let maps: Vec<PathBuf> = std::env::args_os().skip(2).map(PathBuf::from).collect();
    if !maps.is_empty() {
        maps.iter().for_each(|map| draw(map, &folder));
        return;
    }
    let scratch = tempfile::tempdir().expect("there is a folder for temporary files");
    // The pictures show paths, which are the same on all machines if they are relative.
    std::env::set_current_dir(scratch.path()).expect("the folder is there");
    std::fs::write("vase.json", MAP).expect("the folder takes files");
    let mut hand = Hand::with_map(Path::new(""), Path::new("vase.json"));

    hand.point_at("canvas");
    hand.press(Key::L);
    hand.click("\u{25b6} Run");
    hand.wait_for_the_run();
    hand.unpin_all();
    hand.click_at("node simplify", 0.5, 0.05);
    save(&mut hand, &folder, "map.png");

    hand.pin("simplify", "mesh");
    hand.pin("compare", "simplified_field");
    hand.wait_for_the_views();
    hand.click_at("node compare", 0.5, 0.05);
    hand.wait_for_the_views();
    save(&mut hand, &folder, "error_field.png");

    hand.click("Spreadsheet");
    hand.replace_text("filter the rows", "least_angle < 12 and z > 0.5");
    hand.wait_for_the_views();
    hand.click("Sort by area");
    hand.wait_for_the_views();
    hand.point_within("rows of the table", 0.3, 0.2);
    hand.click_at("rows of the table", 0.1, 0.2);
    hand.wait_for_the_views();
    save(&mut hand, &folder, "spreadsheet.png");

    hand.unpin_all();
    hand.click("Program");
    hand.wait_for_the_program();
    hand.click("Run steps");
    hand.wait_for_the_program();
    hand.click("Plot");
    save(&mut hand, &folder, "program.png");
}

/// A picture of the whole of a map.
fn draw(map: &Path, folder: &Path) {
    let mut hand = Hand::with_map(folder, map);
    hand.press(Key::Home);
    let name = Path::new(map.file_name().expect("a map is a file")).with_extension("png");
    save(&mut hand, folder, &name.to_string_lossy());
}

fn save(hand: &mut Hand, folder: &Path, name: &str) {
    let path = folder.join(name);
    hand.picture().save(&path).expect("the picture can be written");
    println!("{}", path.display());
}
