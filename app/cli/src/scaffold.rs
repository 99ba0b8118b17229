//! Files for whoever adds to mve, inside a checkout: each with its line in a list, as the formatter
//! leaves it.
//!
//! What they begin with compiles, and its tests pass, where it stands: `modules/templates` and
//! `app/editor/templates` are built with the tests of those crates.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::exit::{Exit, Stop};
use crate::out;

const MODULE: &str = include_str!("../../../modules/templates/module.rs");
const COST: &str = include_str!("../../../modules/templates/cost.rs");
const IMAGE_COST: &str = include_str!("../../../modules/templates/image_cost.rs");
const METRIC: &str = include_str!("../../../modules/templates/metric.rs");
const PLACEMENT: &str = include_str!("../../../modules/templates/placement.rs");
const LOADER: &str = include_str!("../../../modules/templates/loader.rs");
const DATA: &str = include_str!("../../../modules/templates/data.rs");
const VIEW: &str = include_str!("../../../app/editor/templates/view.rs");

/// Most signs in a line.
const WIDEST: usize = 100;

/// A file to write, and the list that names it.
struct Part {
    /// Below the checkout.
    file: String,
    text: String,
    /// The file with the list, below the checkout.
    list: String,
    /// What the list stands behind.
    before: &'static str,
    /// What enters it, and where.
    item: String,
    place: Place,
}

/// Where an item of a list goes.
#[derive(Clone, Copy, PartialEq)]
enum Place {
    Sorted,
    Last,
}

impl Part {
    /// An entry of the list in `FOLDER/mod.rs`.
    fn entry(folder: &str, id: &str, before: &'static str, template: &str) -> Result<Self, Stop> {
        let item = file_name(id)?;
        Ok(Self {
            file: format!("{folder}/{item}.rs"),
            text: template.replace("Template", id),
            list: format!("{folder}/mod.rs"),
            before,
            item,
            place: Place::Sorted,
        })
    }
}

/// Writes a module.
pub fn module(id: &str, folder: &str) -> Result<Exit, Stop> {
    let checkout = find_checkout()?;
    check_free(id)?;
    let before = "modules! {";
    let sources = checkout.join("modules/src");
    let list = fs::read_to_string(sources.join(folder).join("mod.rs"));
    if !list.is_ok_and(|text| text.contains(before)) {
        let folder = sources.join(folder);
        let message = format!("{} has no list of its own", folder.display());
        return Err(Stop::usage(format!("{message}; name one of {}", lists(&sources, before))));
    }
    let part = Part::entry(&format!("modules/src/{folder}"), id, before, MODULE)?;
    write(&checkout, &part, &test_of("mve-modules", id)?)
}

/// Writes a cost.
pub fn cost(id: &str) -> Result<Exit, Stop> {
    entry("cost", id, "COST in", COST)
}

/// Writes a cost that looks at pictures.
pub fn image_cost(id: &str) -> Result<Exit, Stop> {
    entry("cost", id, "COST in", IMAGE_COST)
}

/// Writes a placement.
pub fn placement(id: &str) -> Result<Exit, Stop> {
    entry("placement", id, "PLACEMENT in", PLACEMENT)
}

/// Writes a metric.
pub fn metric(id: &str) -> Result<Exit, Stop> {
    entry("metric", id, "METRIC in", METRIC)
}

fn entry(folder: &str, id: &str, before: &'static str, template: &str) -> Result<Exit, Stop> {
    let part = Part::entry(&format!("modules/src/{folder}"), id, before, template)?;
    write(&find_checkout()?, &part, &test_of("mve-modules", id)?)
}

/// Writes a loader, which reads the files of one format.
pub fn loader(id: &str) -> Result<Exit, Stop> {
    check_free(id)?;
    let name = file_name(id)?;
    let format = name.strip_suffix("_loader").ok_or_else(|| {
        Stop::usage(format!("\"{id}\" does not name a format; write it like GtsLoader"))
    })?;
    entry("io", id, "modules! {", &LOADER.replace("template", format))
}

/// Writes a data type.
pub fn data(id: &str) -> Result<Exit, Stop> {
    let mut part = Part::entry("mesh/src/data", id, "data_types! {", DATA)?;
    part.item = format!("{}: {id}", part.item);
    write(&find_checkout()?, &part, &test_of("mve-mesh", id)?)
}

/// Writes a view of a data type.
pub fn view(id: &str) -> Result<Exit, Stop> {
    let name = file_name(id)?;
    let part = Part {
        file: format!("app/editor/src/views/{name}.rs"),
        text: VIEW.replace("Measures", id),
        list: "app/editor/src/views/mod.rs".to_owned(),
        before: "views! {",
        item: format!("{name}::{id}View as {name}"),
        place: Place::Last,
    };
    write(&find_checkout()?, &part, &test_of("mve-editor", id)?)
}

/// The command that runs the tests of an id's file.
fn test_of(package: &str, id: &str) -> Result<String, Stop> {
    Ok(format!("cargo test -p {package} {}", file_name(id)?))
}

/// Refuses the id of a module that there is.
fn check_free(id: &str) -> Result<(), Stop> {
    let registry = mve_modules::registry();
    match registry.modules().iter().any(|info| info.module.id.eq_ignore_ascii_case(id)) {
        true => Err(Stop::usage(format!("there is a module \"{id}\" already"))),
        false => Ok(()),
    }
}

/// Writes the file and the line that names it: both, or none where one is in the way.
fn write(checkout: &Path, part: &Part, test: &str) -> Result<Exit, Stop> {
    let (file, list) = (checkout.join(&part.file), checkout.join(&part.list));
    if file.exists() {
        return Err(Stop::file(&file, &std::io::ErrorKind::AlreadyExists.into()));
    }
    let old = fs::read_to_string(&list).map_err(|error| Stop::file(&list, &error))?;
    let entered = enter(&old, part.before, &part.item, part.place).ok_or_else(|| {
        let (list, item) = (list.display(), &part.item);
        Stop::usage(format!("{list}: cannot read its list; add `{item}` by hand"))
    })?;
    out::write_file(&file, formatted(&part.text, checkout))?;
    out::write_file(&list, &entered)?;
    let then = match part.file.starts_with("app/") {
        true => "",
        false => "then document it: cargo run -p mve -- modules --write docs/modules.md\n",
    };
    let (file, list, item) = (file.display(), list.display(), &part.item);
    out::print(&format!("wrote {file}\nentered {item} in {list}\ntest it with: {test}\n{then}"))
}

/// The text as `rustfmt` leaves it, since lines are longer or shorter by the id; as it is where
/// there is no `rustfmt`.
fn formatted(text: &str, checkout: &Path) -> String {
    let format = || -> Option<String> {
        let mut command = Command::new("rustfmt");
        command.arg("--config-path").arg(checkout);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
        let mut child = command.spawn().ok()?;
        // Taken, so that it is closed behind the text.
        child.stdin.take()?.write_all(text.as_bytes()).ok()?;
        let output = child.wait_with_output().ok()?;
        output.status.success().then(|| String::from_utf8(output.stdout).ok())?
    };
    format().unwrap_or_else(|| text.to_owned())
}

/// The folders that have a list of the kind.
fn lists(sources: &Path, before: &str) -> String {
    let folders = fs::read_dir(sources).into_iter().flatten().flatten();
    let mut names: Vec<_> = folders
        .filter(|folder| {
            let text = fs::read_to_string(folder.path().join("mod.rs"));
            text.is_ok_and(|text| text.contains(before))
        })
        .map(|folder| folder.file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names.join(", ")
}

/// The checkout that the working directory is in.
fn find_checkout() -> Result<PathBuf, Stop> {
    let here = std::env::current_dir().map_err(|error| Stop::file(Path::new("."), &error))?;
    let is_checkout = |folder: &&Path| {
        folder.join("modules/src/lib.rs").is_file() && folder.join("core/Cargo.toml").is_file()
    };
    here.ancestors()
        .find(is_checkout)
        .map(Path::to_owned)
        .ok_or_else(|| Stop::usage("this is not a checkout of mve; change into one first"))
}

/// The name of the file for an id: `FillHoles` becomes `fill_holes`.
fn file_name(id: &str) -> Result<String, Stop> {
    let is_camel = id.starts_with(|c: char| c.is_ascii_uppercase())
        && id.chars().all(|c| c.is_ascii_alphanumeric());
    if !is_camel {
        let message = format!("\"{id}\" is no id; write it in CamelCase, such as FillHoles");
        return Err(Stop::usage(message));
    }
    let mut name = String::new();
    let letters: Vec<char> = id.chars().collect();
    for (place, c) in letters.iter().enumerate() {
        let is_lower = |place: usize| letters.get(place).is_some_and(char::is_ascii_lowercase);
        // A word begins at a capital behind what is none, or at the last one of several.
        let begins = c.is_ascii_uppercase()
            && place > 0
            && (!letters[place - 1].is_ascii_uppercase() || is_lower(place + 1));
        if begins {
            name.push('_');
        }
        name.push(c.to_ascii_lowercase());
    }
    // All strict and reserved words of the language, up to the edition of 2024.
    const KEYWORDS: &str = "abstract as async await become box break const continue crate do dyn \
        else enum extern false final fn for gen if impl in let loop macro match mod move mut \
        override priv pub ref return self static struct super trait true try type typeof unsafe \
        unsized use virtual where while yield";
    match KEYWORDS.split_whitespace().any(|word| word == name) {
        true => Err(Stop::usage(format!("\"{name}\" is a word of Rust; add a word to the id"))),
        false => Ok(name),
    }
}

/// The text with an item entered in the list behind `before`.
fn enter(text: &str, before: &str, item: &str, place: Place) -> Option<String> {
    let mut start = text.find(before)? + before.len();
    // The list of modules names its category first.
    let head = &text[start..];
    if let Some((category, _)) = head.split_once(':').filter(|_| head.trim_start().starts_with('"'))
    {
        start += category.len() + 1;
    }
    let end = start + text[start..].find(['}', ';'])?;
    let mut items: Vec<&str> = text[start..end].split(',').map(str::trim).collect();
    items.retain(|item| !item.is_empty());
    let is_item =
        |item: &&str| item.chars().all(|c| c.is_alphanumeric() || matches!(c, '_' | ':' | ' '));
    if items.contains(&item) || !items.iter().all(is_item) {
        return None;
    }
    items.push(item);
    if place == Place::Sorted {
        items.sort_unstable();
    }
    let ends_item = text[end..].starts_with(';');
    let short = format!(" {}{}", items.join(", "), if ends_item { "" } else { " " });
    let line = text[..start].rfind('\n').map_or(0, |end| end + 1);
    let width = (text[line..start].to_owned() + &short).chars().count() + 1;
    let list = if text[start..end].contains('\n') || width > WIDEST {
        let n_blanks = text[line..].chars().take_while(|c| *c == ' ').count();
        let gap = format!("\n{}", " ".repeat(n_blanks + 4));
        let last = if ends_item { String::new() } else { format!(",\n{}", " ".repeat(n_blanks)) };
        format!("{gap}{}{last}", items.join(&format!(",{gap}")))
    } else {
        short
    };
    Some(format!("{}{list}{}", &text[..start], &text[end..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_become_file_names() {
        let names = [
            ("FillHoles", "fill_holes"),
            ("ObjLoader", "obj_loader"),
            ("QEM", "qem"),
            ("HTTPThing", "http_thing"),
            ("Msdm2", "msdm2"),
            ("SSIMOf", "ssim_of"),
        ];
        for (id, name) in names {
            assert_eq!(file_name(id).ok().as_deref(), Some(name));
        }
        for bad in ["", "fillHoles", "Fill Holes", "Fill-Holes", "../Evil", "1st", "Box"] {
            assert!(file_name(bad).is_err(), "{bad}");
        }
    }

    fn sorted(text: &str, before: &str, item: &str) -> Option<String> {
        enter(text, before, item, Place::Sorted)
    }

    #[test]
    fn a_name_is_entered_in_its_place() {
        let text = "mve_core::modules! { \"measure\": print }\n";
        let once = sorted(text, "modules! {", "volume").unwrap();
        assert_eq!(once, "mve_core::modules! { \"measure\": print, volume }\n");
        let twice = sorted(&once, "modules! {", "area").unwrap();
        assert_eq!(twice, "mve_core::modules! { \"measure\": area, print, volume }\n");
        assert_eq!(sorted(&twice, "modules! {", "print"), None);
    }

    #[test]
    fn long_lists_and_lists_of_entries_keep_their_form() {
        let long = "mve_core::modules! { \"io\":\n    a,\n    c,\n}\n";
        let expected = "mve_core::modules! { \"io\":\n    a,\n    b,\n    c,\n}\n";
        assert_eq!(sorted(long, "modules! {", "b").as_deref(), Some(expected));
        let costs =
            "registered! {\n    /// Costs.\n    static COSTS: Entry<B> = COST in a, c;\n}\n";
        let expected = costs.replace("a, c;", "a, b, c;");
        assert_eq!(sorted(costs, "COST in", "b").as_deref(), Some(&*expected));
        let views = "views! {\n    b::B as b,\n    a::A as a,\n}\n";
        let expected = views.replace("as a,\n", "as a,\n    a_b::C as a_b,\n");
        let entered = enter(views, "views! {", "a_b::C as a_b", Place::Last);
        assert_eq!(entered.as_deref(), Some(&*expected));
    }

    #[test]
    fn a_list_beyond_the_width_gets_a_line_an_item() {
        // With b the first list is 100 signs wide, with cc it would be 101.
        let name = "a".repeat(WIDEST - "modules! { \"io\": , b }".len());
        let text = format!("modules! {{ \"io\": {name} }}");
        let one = format!("modules! {{ \"io\": {name}, b }}");
        assert_eq!(sorted(&text, "modules! {", "b"), Some(one));
        let lines = format!("modules! {{ \"io\":\n    {name},\n    cc,\n}}");
        assert_eq!(sorted(&text, "modules! {", "cc"), Some(lines));
        let entries = format!("x {{\n    static E: T =\n        ITEM in {name}, bbbb;\n}}\n");
        let lines = entries.replace(" a", "\n            a").replace(", b", ",\n            b");
        let text = entries.replace(", bbbb", "");
        assert_eq!(sorted(&text, "ITEM in", "bbbb"), Some(lines));
    }
}
