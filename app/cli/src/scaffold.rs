//! Files for new modules, costs and metrics inside a checkout of mve: one file, and one name in a
//! list.

use std::fs;
use std::path::{Path, PathBuf};

use crate::exit::{Exit, Stop};
use crate::out;

const MODULE: &str = include_str!("templates/module.rs.txt");
const COST: &str = include_str!("templates/cost.rs.txt");
const IMAGE_COST: &str = include_str!("templates/image_cost.rs.txt");
const METRIC: &str = include_str!("templates/metric.rs.txt");

/// Where a new file goes, and how its list begins.
struct Target<'a> {
    /// Folder of `modules/src`.
    folder: &'a str,
    /// What stands before the names in the folder's `mod.rs`.
    before: &'static str,
    /// What the file holds; `@ID@` stands for the id.
    template: &'static str,
}

/// Writes a module.
pub fn module(id: &str, folder: &str) -> Result<Exit, Stop> {
    let registry = mve_modules::registry();
    let is_taken = registry.modules().iter().any(|info| info.module.id.eq_ignore_ascii_case(id));
    if is_taken {
        return Err(Stop::usage(format!("there is a module \"{id}\" already")));
    }
    let before = "modules! {";
    write(&find_checkout()?, id, &Target { folder, before, template: MODULE })
}

/// Writes a cost.
pub fn cost(id: &str) -> Result<Exit, Stop> {
    let before = "COST in";
    write(&find_checkout()?, id, &Target { folder: "cost", before, template: COST })
}

/// Writes a cost that looks at pictures.
pub fn image_cost(id: &str) -> Result<Exit, Stop> {
    let before = "COST in";
    write(&find_checkout()?, id, &Target { folder: "cost", before, template: IMAGE_COST })
}

/// Writes a metric.
pub fn metric(id: &str) -> Result<Exit, Stop> {
    let before = "METRIC in";
    write(&find_checkout()?, id, &Target { folder: "metric", before, template: METRIC })
}

fn write(checkout: &Path, id: &str, target: &Target) -> Result<Exit, Stop> {
    let name = file_name(id).map_err(Stop::usage)?;
    let sources = checkout.join("modules").join("src");
    let folder = sources.join(target.folder);
    let (list, file) = (folder.join("mod.rs"), folder.join(format!("{name}.rs")));
    let text = fs::read_to_string(&list).ok().filter(|text| text.contains(target.before));
    let Some(text) = text else {
        let message = format!("{} has no list of its own", folder.display());
        return Err(Stop::usage(format!("{message}; name one of {}", lists(&sources, target))));
    };
    if file.exists() {
        return Err(Stop::file(&file, &std::io::ErrorKind::AlreadyExists.into()));
    }
    let entered = enter(&text, target.before, &name).ok_or_else(|| {
        Stop::usage(format!("{}: cannot read its list; add {name} by hand", list.display()))
    })?;
    out::write_file(&file, &target.template.replace("@ID@", id))?;
    out::write_file(&list, &entered)?;
    out::print(&format!(
        "wrote {}\nentered {name} in {}\ntest it with: cargo test -p mve-modules {name}\n",
        file.display(),
        list.display()
    ))
}

/// The folders that have a list of the kind.
fn lists(sources: &Path, target: &Target) -> String {
    let folders = fs::read_dir(sources).into_iter().flatten().flatten();
    let mut names: Vec<_> = folders
        .filter(|folder| {
            let text = fs::read_to_string(folder.path().join("mod.rs"));
            text.is_ok_and(|text| text.contains(target.before))
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
fn file_name(id: &str) -> Result<String, String> {
    let is_camel = id.starts_with(|c: char| c.is_ascii_uppercase())
        && id.chars().all(|c| c.is_ascii_alphanumeric());
    if !is_camel {
        return Err(format!("\"{id}\" is no id; write it in CamelCase, such as FillHoles"));
    }
    let mut name = String::new();
    let mut before = 'A';
    for c in id.chars() {
        if c.is_ascii_uppercase() && !before.is_ascii_uppercase() {
            name.push('_');
        }
        name.push(c.to_ascii_lowercase());
        before = c;
    }
    // All strict and reserved words of the language, up to the edition of 2024.
    const KEYWORDS: &str = "abstract as async await become box break const continue crate do dyn \
        else enum extern false final fn for gen if impl in let loop macro match mod move mut \
        override priv pub ref return self static struct super trait true try type typeof unsafe \
        unsized use virtual where while yield";
    match KEYWORDS.split_whitespace().any(|word| word == name) {
        true => Err(format!("\"{name}\" is a word of Rust; add a word to the id")),
        false => Ok(name),
    }
}

/// The text of a `mod.rs` with a name entered in its list, sorted.
fn enter(text: &str, before: &str, name: &str) -> Option<String> {
    let mut start = text.find(before)? + before.len();
    // The list of modules names its category first.
    let head = &text[start..];
    if let Some((category, _)) = head.split_once(':').filter(|_| head.trim_start().starts_with('"'))
    {
        start += category.len() + 1;
    }
    let end = start + text[start..].find(['}', ';'])?;
    let mut names: Vec<&str> = text[start..end].split(',').map(str::trim).collect();
    names.retain(|name| !name.is_empty());
    let is_name = |name: &&str| name.chars().all(|c| c.is_alphanumeric() || c == '_');
    if names.contains(&name) || !names.iter().all(is_name) {
        return None;
    }
    names.push(name);
    names.sort_unstable();
    let is_long = text[start..end].contains('\n');
    let list = match is_long {
        true => format!("\n    {},\n", names.join(",\n    ")),
        false if text[end..].starts_with('}') => format!(" {} ", names.join(", ")),
        false => format!(" {}", names.join(", ")),
    };
    Some(format!("{}{list}{}", &text[..start], &text[end..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_become_file_names() {
        let names = [("FillHoles", "fill_holes"), ("ObjLoader", "obj_loader"), ("QEM", "qem")];
        names.iter().for_each(|(id, name)| assert_eq!(file_name(id).as_deref(), Ok(*name)));
        for bad in ["", "fillHoles", "Fill Holes", "Fill-Holes", "../Evil", "1st", "Box"] {
            assert!(file_name(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn a_name_is_entered_in_its_place() {
        let text = "mve_core::modules! { \"measure\": print }\n";
        let once = enter(text, "modules! {", "volume").unwrap();
        assert_eq!(once, "mve_core::modules! { \"measure\": print, volume }\n");
        let twice = enter(&once, "modules! {", "area").unwrap();
        assert_eq!(twice, "mve_core::modules! { \"measure\": area, print, volume }\n");
        assert_eq!(enter(&twice, "modules! {", "print"), None);
    }

    #[test]
    fn long_lists_and_lists_of_entries_keep_their_form() {
        let long = "mve_core::modules! { \"io\":\n    a,\n    c,\n}\n";
        let expected = "mve_core::modules! { \"io\":\n    a,\n    b,\n    c,\n}\n";
        assert_eq!(enter(long, "modules! {", "b").as_deref(), Some(expected));
        let costs =
            "registered! {\n    /// Costs.\n    static COSTS: Entry<B> = COST in a, c;\n}\n";
        let expected = costs.replace("a, c;", "a, b, c;");
        assert_eq!(enter(costs, "COST in", "b").as_deref(), Some(&*expected));
    }
}
