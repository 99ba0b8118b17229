//! Loops: a node put in once a round, what goes from round to round, and what comes out.

use std::path::Path;

use indexmap::IndexMap;
use serde_json::{Map as JsonMap, Value as Json, json};

use super::interface::{NEW, NEWER, OLD, newer};
use super::level::Level;
use super::open::{MOST_NODES, Opener, Supply, port};
use crate::made::{COLLECT, TABLE, has_numbers};
use crate::map::{Axis, Link, Node, PortRef, Repeat, Until};
use crate::module::Module;
use crate::param::declared_at;
use crate::port::OutputSpec;
use crate::problem::{Problem, did_you_mean};
use crate::quantity::Quantities;
use crate::registry::ModuleInfo;
use crate::spread::Spreader;

/// The rounds of a loop: what each sets.
type Rounds = Vec<JsonMap<String, Json>>;

impl Opener<'_> {
    /// Puts a node in once a round; what the first round sets.
    pub(super) fn rounds(
        &mut self,
        full: &str,
        node: &Node,
        repeat: &Repeat,
        module: &'static Module,
        level: &Level,
    ) -> JsonMap<String, Json> {
        let folder = self.map_folder.join(&level.folder);
        let found = rounds_of(repeat, module, &folder, &level.folder)
            .and_then(|rounds| Ok((rounds, fed(repeat, module)?)))
            .and_then(|found| check_until(repeat, module).map(|()| found));
        let (rounds, fed) = match found {
            Ok(found) => found,
            Err(message) => {
                let problem = Problem::error(message).at(full).port("repeat");
                self.problems.push(problem);
                return JsonMap::new();
            }
        };
        let first = rounds.first().cloned().unwrap_or_default();
        let name = |round: usize| format!("{full}/{}", round + 1);
        for (round, values) in rounds.iter().enumerate() {
            if self.is_full(full) {
                return first;
            }
            let mut gates = level.gates.clone();
            if let (Some(until), 1..) = (&repeat.until, round) {
                gates.push((port(&name(round - 1), until.port().0), until.clone()));
            }
            let mut node = Node { repeat: None, ..node.clone() };
            node.params.extend(values.clone());
            match node.is_map() {
                true => self.inside(&name(round), &node, level, &gates),
                false => self.put(name(round), node, None, &gates),
            }
        }
        let inputs = module.inputs.iter().map(|input| input.name);
        for to in inputs.chain(module.params.iter().map(|param| param.name)) {
            let from = fed.iter().find(|(_, input)| input == to).map(|(output, _)| output);
            for round in 0..rounds.len() {
                let own = port(&name(round), to);
                let plain = || vec![Supply::Link(own.clone())];
                let supplies = match node.is_map() {
                    true => self.supplies.get(&own).cloned().unwrap_or_default(),
                    false => plain(),
                };
                match (from, round) {
                    (Some(output), 1..) => {
                        let from = port(&name(round - 1), output);
                        supplies.into_iter().for_each(|to| self.supply(from.clone(), to));
                    }
                    _ => self.supplies.entry(port(full, to)).or_default().extend(supplies),
                }
            }
        }
        for output in module.outputs.iter().filter(|output| output.name != TABLE) {
            let all: Vec<PortRef> =
                (0..rounds.len()).map(|round| port(&name(round), output.name)).collect();
            self.give(full, output, all, repeat, level);
        }
        self.table(full, &rounds, module, level);
        first
    }

    /// Says what an output of a loop is: those of all rounds, or that of the last one.
    fn give(
        &mut self,
        full: &str,
        output: &OutputSpec,
        all: Vec<PortRef>,
        repeat: &Repeat,
        level: &Level,
    ) {
        let own = port(full, output.name);
        if repeat.each.is_some() {
            self.lists.insert(own, all);
            return;
        }
        let mut rounds = all.into_iter();
        let Some(mut last) = rounds.next() else { return };
        for (round, from) in rounds.enumerate() {
            if repeat.until.is_none() {
                last = from;
                continue;
            }
            // No name of a node has such a sign.
            let name = format!("{full}/{}>{}", round + 2, output.name);
            let version = crate::Fingerprint::of(b"mve: the newer of two");
            let module = newer(output, level.registry);
            let made = ModuleInfo { module, category: "structure", version };
            let node = Node { module: module.id.to_owned(), ..Node::default() };
            self.put(name.clone(), node, Some(made), &level.gates);
            self.links.push(Link { from: last, to: port(&name, OLD) });
            self.links.push(Link { from, to: port(&name, NEW) });
            last = port(&name, NEWER);
        }
        self.aliases.insert(own, last);
    }

    /// Puts the node in that makes a table of the numbers of all rounds, where there is its module.
    fn table(&mut self, full: &str, rounds: &Rounds, module: &Module, level: &Level) {
        let Some(collect) = level.registry.find(COLLECT).map(|info| info.module) else { return };
        let (Some(into), Some(table)) = (collect.inputs.first(), collect.outputs.first()) else {
            return;
        };
        let outputs: Vec<_> = module.outputs.iter().filter(|output| has_numbers(output)).collect();
        if outputs.is_empty() {
            return;
        }
        let name = format!("{full}/>{TABLE}");
        let numbered = rounds.iter().enumerate().map(|(round, values)| {
            let mut row = JsonMap::from_iter([("round".to_owned(), Json::from(round + 1))]);
            row.extend(values.clone());
            Json::Object(row)
        });
        let names = outputs.iter().map(|output| output.name).collect::<Vec<_>>().join(", ");
        let rows: Json = numbered.collect();
        let params = json!({ "names": names, "rows": rows.to_string() });
        let params = params.as_object().cloned().unwrap_or_default();
        let node = Node { module: COLLECT.to_owned(), params, ..Node::default() };
        self.put(name.clone(), node, None, &level.gates);
        for round in 1..=rounds.len() {
            for output in &outputs {
                let from = port(&format!("{full}/{round}"), output.name);
                self.links.push(Link { from, to: port(&name, into.name) });
            }
        }
        self.aliases.insert(port(full, TABLE), port(&name, table.name));
    }
}

/// What each round sets; the error is a sentence.
fn rounds_of(
    repeat: &Repeat,
    module: &Module,
    folder: &Path,
    seen: &Path,
) -> Result<Rounds, String> {
    let most = MOST_NODES;
    match (repeat.times, &repeat.each) {
        (Some(0), _) => Err("\"times\" is 0: nothing would run".to_owned()),
        (Some(times), None) if times as usize > most => {
            Err(format!("\"times\" is {times}; the most is {most}"))
        }
        (Some(times), None) => Ok(vec![JsonMap::new(); times as usize]),
        (None, Some(each)) => rounds_over(each, module, folder, seen),
        (Some(_), Some(_)) => {
            let message =
                "has both \"times\" and \"each\", whose list says how many rounds there are";
            Err(message.to_owned())
        }
        (None, None) => {
            Err("says neither \"times\" nor \"each\": how many rounds are there?".to_owned())
        }
    }
}

/// The rounds of a loop over values, one a round. Files are found from `folder`, and named as seen
/// from that of the outermost map, from which the map's is `seen`.
fn rounds_over(
    each: &IndexMap<String, Json>,
    module: &Module,
    folder: &Path,
    seen: &Path,
) -> Result<Rounds, String> {
    let mut axis = Axis::new();
    for (path, values) in each {
        let spec = declared_at(module.params, None, path).ok_or_else(|| {
            let hint = did_you_mean(path, module.params.iter().map(|param| param.name));
            format!("\"each\": {} has no parameter \"{path}\"{hint}", module.id)
        })?;
        if path.contains('.') {
            return Err(format!(
                "\"each\": name the parameter {} alone, and give whole values, such as \
                         {{\"Entry\": {{…}}}}",
                spec.name
            ));
        }
        let list = match values {
            Json::Array(list) => list.clone(),
            spread => vec![spread.clone()],
        };
        axis.insert(path.clone(), list);
    }
    let is_whole = |path: &str| {
        let spec = module.params.iter().find(|param| param.name == path);
        spec.is_some_and(|spec| spec.integer().is_some() || spec.seed().is_some())
    };
    let spreader = Spreader { folder, is_whole: &is_whole };
    let axis = spreader.spread(&axis).map_err(|(_, why)| format!("\"each\": {why}"))?.axis;
    let n_rounds = axis.values().map(Vec::len).max().unwrap_or(0);
    if axis.values().any(|list| list.len() != n_rounds) {
        return Err("\"each\": the lists must be equally long".to_owned());
    }
    if n_rounds == 0 {
        return Err("\"each\" gives no values: nothing would run".to_owned());
    }
    let is_file = |path: &str| {
        let spec = module.params.iter().find(|param| param.name == path);
        spec.is_some_and(|spec| spec.input_file().is_some())
    };
    let value = |path: &String, json: &Json| match json.as_str() {
        Some(text) if is_file(path) && Path::new(text).is_relative() => {
            Json::from(seen.join(text).to_string_lossy().replace('\\', "/"))
        }
        _ => json.clone(),
    };
    let of_round = |round: usize| {
        axis.iter().map(|(path, list)| (path.clone(), value(path, &list[round]))).collect()
    };
    Ok((0..n_rounds).map(of_round).collect())
}

/// What a round takes from the one before: outputs and inputs.
fn fed(repeat: &Repeat, module: &Module) -> Result<Vec<(String, String)>, String> {
    let find_output = |name: &str| module.outputs.iter().find(|output| output.name == name);
    let Some(feed) = &repeat.feed else {
        if repeat.each.is_some() {
            return Ok(Vec::new());
        }
        let alike = module.inputs.iter().filter(|input| {
            find_output(input.name).is_some_and(|output| input.data_type.takes(output.data_type))
        });
        return Ok(alike.map(|input| (input.name.to_owned(), input.name.to_owned())).collect());
    };
    for (input, output) in feed {
        let is_param =
            |param: &crate::ParamSpec| param.name == input && param.link_type().is_some();
        let is_input = module.inputs.iter().any(|known| known.name == input);
        if !is_input && !module.params.iter().any(is_param) {
            let hint = did_you_mean(input, module.inputs.iter().map(|input| input.name));
            return Err(format!("\"feed\": {} has no input \"{input}\"{hint}", module.id));
        }
        if find_output(output).is_none() {
            return Err(no_output("feed", output, module));
        }
    }
    Ok(feed.iter().map(|(input, output)| (output.clone(), input.clone())).collect())
}

fn no_output(key: &str, name: &str, module: &Module) -> String {
    // A number among those of an output is named by both.
    let within = module.outputs.iter().find(|output| {
        matches!(output.quantities, Quantities::Row(row) if row.iter().any(|q| q.name == name))
    });
    let hint = match within {
        Some(output) => format!("; did you mean \"{}.{name}\"?", output.name),
        None => did_you_mean(name, module.outputs.iter().map(|output| output.name)),
    };
    format!("\"{key}\": {} has no output \"{name}\"{hint}", module.id)
}

/// Whether the end of a loop makes sense.
fn check_until(repeat: &Repeat, module: &Module) -> Result<(), String> {
    let Some(until) = &repeat.until else { return Ok(()) };
    let (name, cell) = until.port();
    let Until { below, above, .. } = until;
    let Some(output) = module.outputs.iter().find(|output| output.name == name) else {
        return Err(no_output("until", name, module));
    };
    if below.is_none() && above.is_none() {
        return Err("\"until\" says neither \"below\" nor \"above\"".to_owned());
    }
    if cell.is_none() && !output.is_cell {
        return Err(format!(
            "\"until\": \"{name}\" gives a {}, no number; name one of its numbers, such as \
             \"{name}.rms\"",
            output.data_type.id
        ));
    }
    Ok(())
}
