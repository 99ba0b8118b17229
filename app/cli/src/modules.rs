//! `mve modules`: the documentation of modules, drawn from their declarations.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use mve_core::{
    ModuleInfo, describe_all, describe_module, describe_part, did_you_mean, entries_with, search,
};
use serde_json::{Value as Json, json};

use crate::check::count;
use crate::exit::{Exit, Stop};
use crate::out;
use crate::table::wrap;

/// List the modules, search them, or read what one of them does
#[derive(clap::Args)]
#[command(after_help = "Examples:
  mve modules
  mve modules Simplificator
  mve modules MeshComparer.ImageSsim    one entry of a choice, or one parameter
  mve modules hausdorff                 those that have to do with it
  mve modules --write docs/modules.md
  mve modules --json | jq -r .id")]
pub struct Args {
    /// Id of one module, with a parameter or an entry behind a point; or words to search for in what
    /// modules and entries say of themselves
    #[arg(value_name = "ID|WORDS")]
    words: Vec<String>,
    /// Write the documentation as Markdown to a file: of all modules, or of the one named
    #[arg(long, value_name = "FILE", conflicts_with = "json")]
    write: Option<PathBuf>,
    /// Print a line of JSON a module
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Exit, Stop> {
    let registry = mve_modules::registry();
    let query = args.words.join(" ");
    let part = query.split_once('.').and_then(|(id, path)| Some((registry.find(id)?, path)));
    if let Some((info, path)) = part.filter(|_| !args.json) {
        let text = describe_part(&info, path).map_err(Stop::usage)?;
        return match &args.write {
            Some(file) => write(file, &text),
            None => out::print(&for_terminal(&text)),
        };
    }
    let chosen = registry.find(&query);
    let found = match chosen {
        Some(info) => vec![info],
        None => search(&registry, &query, mve_modules::SYNONYMS),
    };
    if found.is_empty() {
        let hint = did_you_mean(&query, registry.modules().iter().map(|info| info.module.id));
        let hint = if hint.is_empty() { "; `mve modules` lists them" } else { &hint };
        return Err(Stop::usage(format!("no module has to do with \"{query}\"{hint}")));
    }
    if let Some(path) = &args.write {
        let text = match found.len() == registry.modules().len() {
            true => describe_all(&registry),
            false => found.iter().map(describe_module).collect::<Vec<_>>().join("\n"),
        };
        return write(path, &text);
    }
    if args.json {
        let schema = mve_core::schema(&registry);
        for info in &found {
            out::json(&as_json(info, &schema))?;
        }
        return Ok(Exit::Done);
    }
    match chosen {
        Some(info) => out::print(&for_terminal(&describe_module(&info))),
        None => out::print(&list(&found, &args.words)),
    }
}

fn write(file: &Path, text: &str) -> Result<Exit, Stop> {
    out::write_file(file, text)?;
    out::print(&format!("wrote {}\n", file.display()))
}

/// Ids and summaries by category, with the entries that have all of some words.
fn list(all: &[ModuleInfo], words: &[String]) -> String {
    let widest = all.iter().map(|info| info.module.id.len()).max().unwrap_or(0);
    let mut categories: Vec<_> = all.iter().map(|info| info.category).collect();
    categories.sort_unstable();
    categories.dedup();
    let mut text = String::new();
    for category in categories {
        let _ = writeln!(text, "{}", out::styled(category, out::Style::Bold));
        for info in all.iter().filter(|info| info.category == category) {
            let summary = wrap(info.module.summary, out::width(), widest + 4);
            let _ = writeln!(text, "  {:widest$}  {summary}", info.module.id);
            let entries = entries_of(info, words).join(", ");
            if !entries.is_empty() {
                let entries = wrap(&format!("in {entries}"), out::width(), widest + 4);
                let _ = writeln!(text, "  {:widest$}  {entries}", "");
            }
        }
        text.push('\n');
    }
    let _ = writeln!(text, "{}; `mve modules ID` tells more", count(all.len(), "module"));
    text
}

/// The entries of a module that have all words, where its id and summary have not.
fn entries_of(info: &ModuleInfo, words: &[String]) -> Vec<String> {
    let words = words.iter().flat_map(|word| word.split_whitespace());
    let is_told = |word: &str| {
        let own = format!("{} {}", info.module.id, info.module.summary).to_lowercase();
        own.contains(&word.to_lowercase())
    };
    let mut lists = words
        .filter(|word| !is_told(word))
        .map(|word| entries_with(info.module, word, mve_modules::SYNONYMS));
    let first = lists.next().unwrap_or_default();
    lists.fold(first, |all, list| all.into_iter().filter(|entry| list.contains(entry)).collect())
}

/// Markdown with its titles bold and its lists wrapped, where standard output is a terminal.
fn for_terminal(markdown: &str) -> String {
    let width = out::width();
    if width.is_none() {
        return markdown.to_owned();
    }
    let mut text = String::new();
    for line in markdown.lines() {
        let indent = line.len() - line.trim_start().len();
        match line.strip_prefix("### ") {
            Some(title) => text.push_str(&out::styled(title, out::Style::Bold)),
            None => {
                let rest = line.trim_start().replace('`', "");
                let hang = if rest.starts_with("- ") { indent + 2 } else { indent };
                let _ = write!(text, "{}{}", &line[..indent], wrap(&rest, width, hang));
            }
        }
        text.push('\n');
    }
    text
}

fn as_json(info: &ModuleInfo, schema: &Json) -> Json {
    let module = info.module;
    let inputs = module.inputs.iter().map(|input| {
        json!({
            "name": input.name, "type": input.data_type.id, "required": input.is_required,
            "doc": input.doc
        })
    });
    let outputs = module.outputs.iter().map(
        |output| json!({ "name": output.name, "type": output.data_type.id, "doc": output.doc }),
    );
    let nodes = &schema["properties"]["nodes"]["additionalProperties"]["allOf"];
    let is_own = |rule: &&Json| rule["if"]["properties"]["module"]["const"] == module.id;
    let own = nodes.as_array().into_iter().flatten().find(is_own);
    json!({
        "id": module.id,
        "category": info.category,
        "summary": module.summary,
        "version": info.version,
        "inputs": inputs.collect::<Vec<_>>(),
        "outputs": outputs.collect::<Vec<_>>(),
        "params": own.map_or(Json::Null, |rule| rule["then"]["properties"]["params"].clone()),
    })
}
