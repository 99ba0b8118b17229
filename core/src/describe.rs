//! Documentation of modules, drawn from their declarations, as Markdown.

use std::fmt::Write;

use serde_json::json;

use crate::param::{ParamSpec, Setting};
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
            let entry = spec.choice().and_then(|choice| choice.list.find(part.id));
            let numbers = entry.map_or(&[][..], |entry| entry.quantities);
            for quantity in numbers {
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
    if depth == 0
        && let Some(data_type) = spec.link_type()
    {
        facts.push(format!("takes a link from {}", data_type.id));
    }
    facts.join("; ")
}
