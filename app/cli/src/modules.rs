//! `mve modules`: the documentation of modules, drawn from their declarations.

use std::fmt::Write;
use std::path::PathBuf;

use mve_core::{ModuleInfo, Registry, describe_all, describe_module, did_you_mean};
use serde_json::{Value as Json, json};

use crate::check::count;
use crate::exit::{Exit, Stop};
use crate::out;
use crate::table::wrap;

/// List the modules, or read what one of them does
#[derive(clap::Args)]
#[command(after_help = "Examples:
  mve modules
  mve modules Simplificator
  mve modules --write docs/modules.md
  mve modules --json | jq -r .id")]
pub struct Args {
    /// Id of one module
    id: Option<String>,
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
    let chosen = args.id.as_deref().map(|id| find(&registry, id)).transpose()?;
    if let Some(path) = &args.write {
        let text = chosen.map_or_else(|| describe_all(&registry), |info| describe_module(&info));
        out::write_file(path, &text)?;
        return out::print(&format!("wrote {}\n", path.display()));
    }
    if args.json {
        let schema = mve_core::schema(&registry);
        let all = registry.modules().iter();
        for info in all.filter(|info| chosen.is_none_or(|one| one.module.id == info.module.id)) {
            out::json(&as_json(info, &schema))?;
        }
        return Ok(Exit::Done);
    }
    match chosen {
        Some(info) => out::print(&for_terminal(&describe_module(&info))),
        None => out::print(&list(&registry)),
    }
}

fn find(registry: &Registry, id: &str) -> Result<ModuleInfo, Stop> {
    registry.find(id).ok_or_else(|| {
        let hint = did_you_mean(id, registry.modules().iter().map(|info| info.module.id));
        let hint = if hint.is_empty() { "; `mve modules` lists them" } else { &hint };
        Stop::usage(format!("there is no module \"{id}\"{hint}"))
    })
}

/// Ids and summaries by category.
fn list(registry: &Registry) -> String {
    let all = registry.modules();
    let widest = all.iter().map(|info| info.module.id.len()).max().unwrap_or(0);
    let mut categories: Vec<_> = all.iter().map(|info| info.category).collect();
    categories.sort_unstable();
    categories.dedup();
    let mut text = String::new();
    for category in categories {
        let _ = writeln!(text, "{}", console::style(category).bold());
        for info in all.iter().filter(|info| info.category == category) {
            let summary = wrap(info.module.summary, out::width(), widest + 4);
            let _ = writeln!(text, "  {:widest$}  {summary}", info.module.id);
        }
        text.push('\n');
    }
    let _ = writeln!(text, "{}; `mve modules ID` tells more", count(all.len(), "module"));
    text
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
            Some(title) => text.push_str(&console::style(title).bold().to_string()),
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
    let nodes = &schema["properties"]["nodes"]["additionalProperties"]["anyOf"];
    let own = nodes.as_array().into_iter().flatten().map(|node| &node["properties"]);
    let own = own.into_iter().find(|node| node["module"]["const"] == module.id);
    json!({
        "id": module.id,
        "category": info.category,
        "summary": module.summary,
        "version": info.version,
        "inputs": inputs.collect::<Vec<_>>(),
        "outputs": outputs.collect::<Vec<_>>(),
        "params": own.map_or(Json::Null, |node| node["params"].clone()),
    })
}
