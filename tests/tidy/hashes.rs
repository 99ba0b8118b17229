//! What an edit of each kind of file does to the hashes that keys of results are made of.

use std::path::Path;

use mve_modules::{cost::COSTS, picture::cameras::CAMERA_SETS};
use mve_tests::root;
use tempfile::TempDir;

use super::sources::{SourceHashes, source_hashes, tokens, without_tests};

const CRATE: &str = "mve-modules";
const QUADRIC: &str = "mve_modules::cost::quadric";

/// A copy of what the hashes are made of.
struct Copy {
    folder: TempDir,
    before: SourceHashes,
}

impl Copy {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let crates = ["core", "mesh", "formats", "modules"];
        let manifests = crates.map(|name| format!("{name}/Cargo.toml"));
        let of_workspace = ["Cargo.toml", "Cargo.lock"].map(str::to_owned);
        for path in of_workspace.iter().chain(&manifests) {
            let target = folder.path().join(path);
            std::fs::create_dir_all(target.parent().unwrap()).unwrap();
            std::fs::copy(root().join(path), target).unwrap();
        }
        for path in crates.map(|name| format!("{name}/src")) {
            copy_folder(&root().join(&path), &folder.path().join(&path));
        }
        let before = source_hashes(folder.path(), CRATE).unwrap();
        Self { folder, before }
    }

    /// Edits a file and gives what changed: `shared`, and names of entries.
    fn changed_by(&self, path: &str, edit: impl Fn(&str) -> String) -> Vec<String> {
        let path = self.folder.path().join(path);
        let text = std::fs::read_to_string(&path).unwrap();
        let edited = edit(&text);
        assert_ne!(text, edited, "{}: the edit does nothing", path.display());
        std::fs::write(&path, edited).unwrap();
        let now = source_hashes(self.folder.path(), CRATE).unwrap();
        std::fs::write(&path, text).unwrap();
        let mut changed = Vec::new();
        if now.shared != self.before.shared {
            changed.push("shared".to_owned());
        }
        for (name, hash) in &self.before.entries {
            if now.entries.get(name) != Some(hash) {
                changed.push(name.clone());
            }
        }
        assert_eq!(now.entries.len(), self.before.entries.len());
        changed
    }
}

fn copy_folder(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap().flatten() {
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy_folder(&entry.path(), &target);
        } else {
            std::fs::copy(entry.path(), target).unwrap();
        }
    }
}

/// Code that is new in a file.
fn with_code(text: &str) -> String {
    format!("{text}\nconst ADDED: u8 = 1;\n")
}

const NOTHING: [&str; 0] = [];

#[test]
fn an_entry_changes_its_own_hash_and_shared_code_that_of_all() {
    let copy = Copy::new();
    for (name, path) in [
        (QUADRIC, "modules/src/cost/quadric.rs"),
        ("mve_modules::placement::endpoint", "modules/src/placement/endpoint.rs"),
        ("mve_modules::metric::image_rms", "modules/src/metric/image_rms.rs"),
        ("mve_modules::filters::simplificator", "modules/src/filters/simplificator.rs"),
        ("mve_modules::picture::cameras::fibonacci", "modules/src/picture/cameras/fibonacci.rs"),
    ] {
        assert_eq!(copy.changed_by(path, with_code), [name]);
    }
    for path in [
        "modules/src/geometry/distance/hausdorff.rs",
        "modules/src/metric/pictures.rs",
        "modules/src/metric/mod.rs",
        "mesh/src/data/tri_mesh.rs",
        "core/src/run.rs",
        "core/src/json.rs",
    ] {
        assert_eq!(copy.changed_by(path, with_code), ["shared"], "{path}");
    }
}

#[test]
fn tests_comments_and_line_ends_change_nothing() {
    let copy = Copy::new();
    for path in [
        "modules/src/metric/image_rms_tests.rs",
        "modules/src/geometry/simplify/collapse/tests.rs",
        "modules/src/geometry/generate/checks.rs",
        "modules/src/test_models.rs",
        "mesh/src/fixtures.rs",
        "core/src/testing.rs",
    ] {
        assert_eq!(copy.changed_by(path, with_code), NOTHING, "{path}");
    }
    let into_tests = |text: &str| text.replace("mod tests {", "mod tests {\n    const N: u8 = 1;");
    for path in ["modules/src/cost/image_mse.rs", "core/src/cache.rs"] {
        assert_eq!(copy.changed_by(path, into_tests), NOTHING, "{path}");
    }
    let edits: [fn(&str) -> String; 3] = [
        |text| text.replace('\n', "\r\n"),
        |text| format!("{text}// A remark: \"quoted\".\n/* And /* one more. */ */\n"),
        |text| text.replace(" = ", "  =  "),
    ];
    for path in ["modules/src/cost/quadric.rs", "mesh/src/quadric.rs", "core/src/run.rs"] {
        for edit in edits {
            assert_eq!(copy.changed_by(path, edit), NOTHING, "{path}");
        }
    }
    assert_eq!(copy.changed_by("Cargo.lock", |text| text.replace('\n', "\r\n")), NOTHING);
}

/// The lock file with another version of a package.
fn bump(package: &'static str) -> impl Fn(&str) -> String {
    move |lock| {
        let name = format!("name = \"{package}\"\nversion = \"");
        lock.replace(&name, &format!("{name}99."))
    }
}

#[test]
fn only_packages_that_results_come_from_count() {
    let copy = Copy::new();
    // glam is named by the crate, serde_core is reached through serde.
    for package in ["glam", "rayon", "serde_core", "serde_json"] {
        assert_eq!(copy.changed_by("Cargo.lock", bump(package)), ["shared"], "{package}");
    }
    for package in ["egui", "eframe", "clap", "criterion", "proptest", "tobj"] {
        assert_eq!(copy.changed_by("Cargo.lock", bump(package)), NOTHING, "{package}");
    }
    let features = |text: &str| text.replace("\"float_roundtrip\", ", "");
    assert_eq!(copy.changed_by("Cargo.toml", features), ["shared"]);
    let of_window = |text: &str| text.replace("\"wayland\", ", "");
    assert_eq!(copy.changed_by("Cargo.toml", of_window), NOTHING);
    let of_tests = |text: &str| text.replace("tobj.workspace = true\n", "");
    assert_eq!(copy.changed_by("modules/Cargo.toml", of_tests), NOTHING);
}

/// A package that the reader of the lock file does not understand must not be left out in silence.
#[test]
fn a_lock_file_that_is_not_understood_counts_as_a_whole() {
    let copy = Copy::new();
    let glam = "name = \"glam\"\n";
    let path = copy.folder.path().join("Cargo.lock");
    let text = std::fs::read_to_string(&path).unwrap().replace(glam, "name = \"other\"\n");
    std::fs::write(&path, text).unwrap();
    let before = source_hashes(copy.folder.path(), CRATE).unwrap();
    let copy = Copy { before, ..copy };
    assert_eq!(copy.changed_by("Cargo.lock", bump("egui")), ["shared"]);
}

/// Rewrites a file for good: what is compared comes after it.
fn with_file(copy: Copy, path: &str, edit: impl Fn(&str) -> String) -> Copy {
    let place = copy.folder.path().join(path);
    std::fs::create_dir_all(place.parent().unwrap()).unwrap();
    let text = std::fs::read_to_string(&place).unwrap_or_default();
    std::fs::write(&place, edit(&text)).unwrap();
    let before = source_hashes(copy.folder.path(), CRATE).unwrap();
    Copy { before, ..copy }
}

#[test]
fn manifests_in_any_form_are_followed() {
    let table = |text: &str| text.replace("glam.workspace = true\n", "") + GLAM;
    let copy = with_file(Copy::new(), "modules/Cargo.toml", table);
    assert_eq!(copy.changed_by("Cargo.lock", bump("glam")), ["shared"]);
    assert_eq!(
        copy.changed_by("modules/Cargo.toml", |text| text.replace("0.34", "0.35")),
        ["shared"]
    );

    let two_lines = |text: &str| text.replace("features = [\"serde\"", "features = [\n\"serde\"");
    let copy = with_file(Copy::new(), "Cargo.toml", two_lines);
    let more =
        |text: &str| text.replace("features = [\n\"serde\"", "features = [\n\"std\", \"serde\"");
    assert_eq!(copy.changed_by("Cargo.toml", more), ["shared"]);

    let named = "[dependencies]\nextra = { path = \"../extra\" }\n";
    let by_path = |text: &str| text.replace("[dependencies]\n", named);
    let copy =
        with_file(Copy::new(), "extra/Cargo.toml", |_| "[package]\nname = \"extra\"\n".to_owned());
    let copy = with_file(copy, "extra/src/lib.rs", |_| "pub fn one() -> u8 { 1 }\n".to_owned());
    let copy = with_file(copy, "modules/Cargo.toml", by_path);
    let edited = |text: &str| text.replace('1', "2");
    assert_eq!(copy.changed_by("extra/src/lib.rs", edited), ["shared"]);
}

const GLAM: &str = "\n[dependencies.glam]\nversion = \"0.34\"\n";

#[test]
fn the_lists_hold_the_hashes_of_their_files() {
    let hashes = source_hashes(&root(), CRATE).unwrap();
    let expected = |module: &str| mve_core::source_hash(hashes.entries[module].as_bytes());
    let quadric = COSTS.entries.iter().find(|listed| listed.item.id == "Quadric").unwrap();
    assert_eq!(quadric.source, expected(QUADRIC));
    let cameras = CAMERA_SETS.entries.iter().find(|listed| listed.item.id == "Fibonacci").unwrap();
    assert_eq!(cameras.source, expected("mve_modules::picture::cameras::fibonacci"));
    assert!(hashes.entries.len() > 30);
    for part in ["Cargo.lock", "core/src", "mesh/src", "formats/src", "modules/src"] {
        assert!(hashes.watched.contains(&root().join(part)), "{part}");
    }
}

#[test]
fn quotes_and_comments_are_told_from_code() {
    let texts = |text: &'static str| tokens(text).iter().map(|t| t.text).collect::<Vec<_>>();
    assert_eq!(texts("a/* b /* c */ */::d // e\n&&f"), ["a", "::", "d", "&", "&", "f"]);
    assert_eq!(texts(r#"'"' '\'' '\u{41}' &'a "//" b"\"""#).len(), 7);
    assert_eq!(texts(r###"r"\" r#"/*"# r#type x"###), ["r\"\\\"", "r#\"/*\"#", "r#type", "x"]);
    let code = "#[cfg(test)]\n#[path = \"x.rs\"]\npub(super) mod t;\n#[cfg(test)] fn f() -> [u8; 2] \
                { [0; 2] }\n#[cfg(test)] use a::{b, c};\nfn g() {}";
    let all = tokens(code);
    let left = without_tests(&all);
    assert_eq!(left.test_modules, [("t", Some("x.rs"))]);
    assert_eq!(left.tokens.iter().map(|t| t.text).collect::<String>(), "fng(){}");
}
