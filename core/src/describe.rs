//! Documentation of modules, drawn from their declarations, as Markdown.

use std::fmt::Write;

use serde_json::json;

use crate::param::{OptionSpec, ParamSpec, Setting};
use crate::problem::did_you_mean;
use crate::quantity::{Better, Quantities, Quantity};
use crate::registry::{ModuleInfo, Registry};

/// All modules, by category.
pub fn describe_all(registry: &Registry) -> String {
    let mut text = String::from(
        "# Modules\n\nMade by `mve modules --write docs/modules.md` from the declarations; do not \
         edit.\n",
    );
    let mut categories: Vec<_> = registry.modules().iter().map(|info| info.category).collect();
    categories.sort_unstable();
    categories.dedup();
    for category in categories {
        let _ = write!(text, "\n## {category}\n");
        for info in registry.modules().iter().filter(|info| info.category == category) {
            text.push('\n');
            text.push_str(&describe_module(info));
        }
    }
    text
}

/// One module: what it does, takes, gives, and how it is set.
pub fn describe_module(info: &ModuleInfo) -> String {
    let module = info.module;
    let mut text = format!("### {}\n\n{}\n", module.id, module.summary);
    if !module.inputs.is_empty() {
        text.push_str("\nInputs:\n\n");
        for input in module.inputs {
            let need = if input.is_required { "" } else { ", optional" };
            let _ =
                writeln!(text, "- `{}` ({}{need}): {}", input.name, input.data_type.id, input.doc);
        }
    }
    if !module.outputs.is_empty() {
        text.push_str("\nOutputs:\n\n");
        for output in module.outputs {
            let _ = writeln!(text, "- `{}` ({}): {}", output.name, output.data_type.id, output.doc);
            describe_quantities(output.quantities, &mut text);
        }
    }
    if !module.params.is_empty() {
        text.push_str("\nParameters:\n\n");
        describe_params(module.params, 0, &mut text);
    }
    text
}

/// A parameter of a module, or an entry of a choice, by its path, in which either may stand alone:
/// `MeshComparer.metric.ImageSsim`, `MeshComparer.ImageSsim`, `Simplificator.cost`. The error is the
/// part that nothing is named like, with a near name.
pub fn describe_part(info: &ModuleInfo, path: &str) -> Result<String, String> {
    let title = format!("### {}.{path}\n\n", info.module.id);
    let mut params = info.module.params;
    let mut last: Option<(ParamSpec, Option<OptionSpec>)> = None;
    for part in path.split('.') {
        let of_choice = match last {
            // Only the entries of this choice are meant.
            Some((spec, None)) => vec![spec],
            _ => params.to_vec(),
        };
        let entries =
            || of_choice.iter().flat_map(|spec| spec.options().into_iter().map(|o| (*spec, o)));
        let param =
            params.iter().find(|spec| spec.name == part && !matches!(last, Some((_, None))));
        last = match (param, entries().find(|(_, option)| option.id == part)) {
            (Some(spec), _) => Some((*spec, None)),
            (None, Some((spec, option))) => {
                params = option.params;
                Some((spec, Some(option)))
            }
            (None, None) => {
                let ids = entries().map(|(_, option)| option.id);
                let all: Vec<&str> = params.iter().map(|spec| spec.name).chain(ids).collect();
                let hint = did_you_mean(part, all.into_iter());
                let id = info.module.id;
                return Err(format!("{id} has no parameter or entry \"{part}\"{hint}"));
            }
        };
    }
    let mut text = title;
    match last {
        Some((spec, Some(option))) => {
            let _ = writeln!(text, "{}", option.summary);
            if !option.params.is_empty() {
                text.push_str("\nParameters:\n\n");
                describe_below(option.params, &mut text);
            }
            let numbers = numbers_of(&spec, option.id);
            if !numbers.is_empty() {
                text.push_str("\nGives:\n\n");
            }
            for quantity in numbers {
                let _ = writeln!(text, "- {}", line_of(quantity));
            }
        }
        Some((spec, None)) if path.contains('.') => describe_below(&[spec], &mut text),
        Some((spec, None)) => describe_params(&[spec], 0, &mut text),
        None => {}
    }
    Ok(text)
}

/// Parameters of an entry, which no link leads to, as a list of their own.
fn describe_below(params: &[ParamSpec], text: &mut String) {
    let mut indented = String::new();
    describe_params(params, 1, &mut indented);
    for line in indented.lines() {
        let _ = writeln!(text, "{}", line.strip_prefix("  ").unwrap_or(line));
    }
}

/// The numbers that an entry of a choice gives.
fn numbers_of(spec: &ParamSpec, id: &str) -> &'static [Quantity] {
    let entry = spec.choice().and_then(|choice| choice.list.find(id));
    entry.map_or(&[][..], |entry| entry.quantities)
}

/// What the numbers of an output are measured in, and which are better; those of a row by name.
fn describe_quantities(quantities: Quantities, text: &mut String) {
    let row = match quantities {
        Quantities::One(quantity) if facts_of(&quantity).is_empty() => return,
        Quantities::One(quantity) => {
            let _ = writeln!(text, "  - {}", facts_of(&quantity));
            return;
        }
        Quantities::Row(row) => row,
        Quantities::Plain | Quantities::OfChoice(_) | Quantities::FirstOfChoice(_) => return,
    };
    for quantity in row {
        let _ = writeln!(text, "  - {}", line_of(quantity));
    }
}

/// A number by its name, with its title, unit and direction.
fn line_of(quantity: &Quantity) -> String {
    let title = Some(quantity.title).filter(|title| !title.is_empty()).map(str::to_owned);
    let facts = Some(facts_of(quantity)).filter(|facts| !facts.is_empty());
    let facts: Vec<_> = title.into_iter().chain(facts).collect();
    let facts = if facts.is_empty() { String::new() } else { format!(" ({})", facts.join("; ")) };
    format!("`{}`{facts}: {}", quantity.name, quantity.doc)
}

fn facts_of(quantity: &Quantity) -> String {
    let unit = Some(quantity.unit.name()).filter(|unit| !unit.is_empty());
    let better = match quantity.better {
        Better::Lower => Some("lower is better"),
        Better::Higher => Some("higher is better"),
        Better::Neither => None,
    };
    unit.map(|unit| format!("in {unit}"))
        .into_iter()
        .chain(better.map(str::to_owned))
        .collect::<Vec<_>>()
        .join("; ")
}

fn describe_params(params: &[ParamSpec], depth: usize, text: &mut String) {
    let indent = "  ".repeat(depth);
    for spec in params {
        let _ = writeln!(text, "{indent}- `{}` ({}): {}", spec.name, facts(spec, depth), spec.doc);
        for part in spec.kind.answers().parts() {
            let _ = writeln!(text, "{indent}  - `{}`: {}", part.id, part.summary);
            describe_params(part.params, depth + 2, text);
            for quantity in numbers_of(spec, part.id) {
                let _ = writeln!(text, "{indent}    - gives {}", line_of(quantity));
            }
        }
    }
}

/// Type, range, unit, default, and whether a link can set it.
fn facts(spec: &ParamSpec, depth: usize) -> String {
    let mut facts = vec![spec.kind.answers().noun()];
    if !spec.unit.is_empty() {
        facts.push(format!("in {}", spec.unit));
    }
    if spec.can_be_off {
        facts.push("or off (null)".to_owned());
    }
    facts.push(match spec.default_setting() {
        None => "required".to_owned(),
        Some(Setting::Off) => "default off".to_owned(),
        Some(Setting::Text(text)) if text.is_empty() => "default empty".to_owned(),
        Some(default) if default.to_json() == json!([]) => "default empty".to_owned(),
        Some(default) => format!("default {}", default.to_word()),
    });
    if let Some(condition) = spec.counts {
        facts.push(format!("only where {condition}"));
    }
    if depth == 0
        && let Some(data_type) = spec.link_type()
    {
        facts.push(format!("takes a link from {}", data_type.id));
    }
    facts.join("; ")
}
