//! Declarations of modules that are made while mve runs: of maps as nodes, and of loops.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use serde_json::Value as Json;

use crate::error::ModuleError;
use crate::module::{Io, Module};
use crate::param::ParamSpec;
use crate::port::{InputSpec, OutputSpec};
use crate::quantity::{Quantities, Quantity};

/// The output of a loop with a row for each of its rounds.
pub(crate) const TABLE: &str = "table";

/// The module that puts values into a table, where there is one.
pub(crate) const COLLECT: &str = "Collect";

/// Declarations that were made while mve runs. Each is made once and then stays, as those of
/// modules do; two that are equal are one.
#[derive(Clone, Default)]
pub(crate) struct Interner(Arc<Mutex<HashMap<String, &'static Module>>>);

/// A declaration in the making. Names and texts of the specs are those beside them.
pub(crate) struct Draft {
    pub id: String,
    pub summary: String,
    pub inputs: Vec<(String, InputSpec)>,
    pub outputs: Vec<(String, OutputSpec)>,
    pub params: Vec<(String, &'static str, ParamSpec, Option<Json>)>,
    pub run: fn(&mut Io) -> Result<(), ModuleError>,
}

fn kept(text: &str) -> &'static str {
    Box::leak(text.to_owned().into_boxed_str())
}

impl Interner {
    pub fn intern(&self, draft: Draft) -> &'static Module {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        known.entry(draft.text()).or_insert_with(|| draft.keep())
    }
}

impl Draft {
    /// What tells it from all others.
    fn text(&self) -> String {
        let inputs = self.inputs.iter().map(|(name, spec)| format!("{name} {spec:?}"));
        let outputs = self.outputs.iter().map(|(name, spec)| format!("{name} {spec:?}"));
        // A declaration of a parameter is a static: where it stands tells which it is.
        let params = self.params.iter().map(|(name, doc, spec, preset)| {
            format!("{name} {doc:p} {:?} {preset:?}", spec.kind.answers().schema())
        });
        let ports: Vec<String> = inputs.chain(["->".to_owned()]).chain(outputs).collect();
        let params: Vec<String> = params.collect();
        let run = self.run as usize;
        format!("{}\n{}\n{ports:?}\n{params:?}\n{run}", self.id, self.summary)
    }

    fn keep(self) -> &'static Module {
        let inputs = self.inputs.into_iter();
        let inputs = inputs.map(|(name, spec)| InputSpec { name: kept(&name), ..spec }).collect();
        let outputs = self.outputs.into_iter();
        let outputs = outputs.map(|(name, spec)| named(kept(&name), spec)).collect();
        let params = self.params.into_iter().map(|(name, doc, spec, preset)| {
            let preset = preset.map(|json| &*Box::leak(Box::new(json)));
            ParamSpec { name: kept(&name), doc, preset, counts: None, ..spec }
        });
        Box::leak(Box::new(Module {
            id: kept(&self.id),
            summary: kept(&self.summary),
            inputs: Vec::leak(inputs),
            outputs: Vec::leak(outputs),
            params: Vec::leak(params.collect()),
            run: self.run,
        }))
    }
}

/// An output under another name, which is that of its number, too.
fn named(name: &'static str, spec: OutputSpec) -> OutputSpec {
    let quantities = match spec.quantities {
        Quantities::One(quantity) => Quantities::One(Quantity { name, ..quantity }),
        other => other,
    };
    OutputSpec { name, quantities, ..spec }
}

/// Whether an output gives numbers that a table can hold.
pub(crate) fn has_numbers(output: &OutputSpec) -> bool {
    let is_row = !matches!(output.quantities, Quantities::Plain);
    output.name != TABLE && (output.is_cell || is_row)
}

/// The declaration of a node that runs more than once: what it is otherwise, and a table.
pub(crate) fn repeated(
    module: &'static Module,
    table: Option<&OutputSpec>,
    interner: &Interner,
) -> &'static Module {
    let own = module.outputs.iter().map(|spec| (spec.name.to_owned(), *spec));
    let is_free = module.outputs.iter().all(|spec| spec.name != TABLE);
    let is_made = is_free && module.outputs.iter().any(has_numbers);
    let table = table.filter(|_| is_made).map(|spec| {
        let doc = "A row of numbers for each round.";
        (TABLE.to_owned(), OutputSpec { doc, ..*spec })
    });
    interner.intern(Draft {
        id: module.id.to_owned(),
        summary: module.summary.to_owned(),
        inputs: module.inputs.iter().map(|spec| (spec.name.to_owned(), *spec)).collect(),
        outputs: own.chain(table).collect(),
        params: params_of(module),
        run: module.run,
    })
}

pub(crate) fn params_of(module: &Module) -> Vec<(String, &'static str, ParamSpec, Option<Json>)> {
    let param = |spec: &ParamSpec| (spec.name.to_owned(), spec.doc, *spec, spec.preset.cloned());
    module.params.iter().map(param).collect()
}
