//! Files that a plan writes: their names, and that no two are the same.

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

use super::{OutputScope, PlanNode, PlanOptions, no_such_node};
use crate::fingerprint::Fingerprint;
use crate::map::{Map, PortRef};
use crate::param::{MODULE, OutputFileSpec, ParamSpec, Setting};
use crate::problem::{HOLDS_NO_STEERING, Problem, is_steering};
use crate::template::{Piece, as_name, pieces};

/// Stands for the id of the step until it is known; no name in a file system holds it.
const STEP: char = '\0';

/// In a name, what a node's outputs come from, whichever module the node has.
const SOURCE: &str = "source";

/// The name of one output file.
pub(super) struct Name {
    node: String,
    /// Dotted path of the parameter.
    param: String,
    /// The name, with [`STEP`] where the id of the step goes.
    pub text: String,
    spec: OutputFileSpec,
}

/// The names of all output files.
pub(super) struct Names(Vec<Name>);

impl Names {
    /// Whether a node has some.
    pub fn has(&self, node: &str) -> bool {
        self.of(node).next().is_some()
    }

    /// Those of one node.
    pub fn of<'a>(&'a self, node: &'a str) -> impl Iterator<Item = &'a Name> {
        self.0.iter().filter(move |name| name.node == node)
    }
}

/// Puts parameters into the templates of the output files of `writers`, which may quote those of
/// all `nodes`. `map` is the whole map, with the nodes that are left out of the plan.
pub(super) fn names<'a>(
    map: &Map,
    writers: impl Iterator<Item = &'a PlanNode>,
    nodes: impl Iterator<Item = &'a PlanNode> + Clone,
    options: &PlanOptions,
    problems: &mut Vec<Problem>,
) -> Names {
    let mut names = Vec::new();
    let find = |name: &str| nodes.clone().find(|node| node.name == name);
    for node in writers {
        for (param, spec, written) in node.settings.files(node.info.module.params) {
            let Some(spec) = spec.output_file() else { continue };
            match expand(written, map, &find, options.repeat) {
                Ok(text) => {
                    let node = node.name.clone();
                    names.push(Name { node, param, text, spec });
                }
                Err(message) => {
                    problems.push(Problem::error(message).at(&node.name).port(&param));
                }
            }
        }
    }
    Names(names)
}

fn expand<'a>(
    template: &str,
    map: &Map,
    find: &dyn Fn(&str) -> Option<&'a PlanNode>,
    repeat: u32,
) -> Result<String, String> {
    let mut text = String::new();
    for piece in pieces(template)? {
        match piece {
            Piece::Literal(literal) if literal.contains(is_steering) => {
                return Err(format!("a path {HOLDS_NO_STEERING}"));
            }
            Piece::Literal(literal) => text.push_str(literal),
            Piece::Reference("step") => text.push(STEP),
            Piece::Reference("repeat") => text.push_str(&repeat.to_string()),
            Piece::Reference(name) => {
                let word = resolve(name, map, find).map_err(|why| format!("{{{name}}}: {why}"))?;
                text.push_str(&as_name(&word));
            }
        }
    }
    Ok(text)
}

/// The value that a reference such as `load.path.stem` or `simplify.cost` stands for.
fn resolve<'a>(
    name: &str,
    map: &Map,
    find: &dyn Fn(&str) -> Option<&'a PlanNode>,
) -> Result<String, String> {
    let form = "write {node.param}, {node.source}, {step} or {repeat}";
    let PortRef { node, port } = name.parse().map_err(|()| form.to_owned())?;
    if !map.nodes.contains_key(&node) {
        return Err(no_such_node(map, &node));
    }
    // A node of an unknown module has been reported.
    let Some(found) = find(&node) else { return Ok(String::new()) };
    if port == MODULE {
        return Ok(found.info.module.id.to_owned());
    }
    if port == SOURCE && found.settings.find(SOURCE).is_none() {
        return Ok(source(found));
    }
    let mut path = port.split('.');
    let first = path.next().unwrap_or_default();
    if map.links.iter().any(|link| link.to.node == node && link.to.port == first) {
        return Err("comes by link, so it is not known before the run".to_owned());
    }
    let mut setting = found.settings.find(first).ok_or("there is no such parameter")?;
    for part in path {
        match setting {
            Setting::File { written, .. } => {
                return file_part(written, part).ok_or_else(|| {
                    format!("a path has parts stem, name and extension, not \"{part}\"")
                });
            }
            Setting::Choice { params, .. } => {
                setting = params.find(part).ok_or("there is no such parameter")?;
            }
            _ => return Err("there is no such parameter".to_owned()),
        }
    }
    Ok(match setting {
        Setting::Choice { .. } => {
            let spec = found.info.module.params.iter().find(|spec| spec.name == first);
            spec.map_or_else(|| setting.to_word(), |spec| chosen(setting, spec))
        }
        other => other.to_word(),
    })
}

/// A setting as a word: an entry of a choice with those of its parameters that are not as the entry
/// has them by default.
fn chosen(setting: &Setting, spec: &ParamSpec) -> String {
    let Setting::Choice { id, params } = setting else { return setting.to_word() };
    let specs = spec.params_of(setting);
    let set = specs.iter().zip(&params.0);
    let other = set.filter(|(spec, (_, setting))| spec.default_setting().as_ref() != Some(setting));
    other.fold((*id).to_owned(), |word, (spec, (name, setting))| {
        format!("{word}-{name}{}", chosen(setting, spec))
    })
}

/// What a node's outputs come from: the stem of the file that it reads, or its module.
fn source(node: &PlanNode) -> String {
    let files = node.settings.files(node.info.module.params).into_iter();
    let read = files.filter(|(_, spec, _)| spec.input_file().is_some());
    let stem = read.filter_map(|(_, _, written)| file_part(written, "stem"));
    let mut named = stem.filter(|stem| !stem.is_empty());
    named.next().unwrap_or_else(|| node.info.module.id.to_owned())
}

fn file_part(path: &str, part: &str) -> Option<String> {
    let path = Path::new(path);
    let found = match part {
        "stem" => path.file_stem(),
        "name" => path.file_name(),
        "extension" => path.extension(),
        _ => return None,
    };
    Some(found.unwrap_or_default().to_string_lossy().into_owned())
}

/// Gives every node the paths that it writes, and refuses those that meet or climb out.
pub(super) fn fill(
    nodes: &mut [PlanNode],
    names: &Names,
    id: &Fingerprint,
    options: &PlanOptions,
    problems: &mut Vec<Problem>,
) {
    let mut writers: BTreeMap<PathBuf, String> = BTreeMap::new();
    for name in &names.0 {
        let text = name.text.replace(STEP, &id.short());
        let port = || PortRef { node: name.node.clone(), port: name.param.clone() };
        let problem = |message: String| Problem::error(message).at(&name.node).port(&name.param);
        let Some(path) = tidy(&text, options.output_scope) else {
            let advice = match options.output_scope {
                OutputScope::Step => "the files of a program's steps stay in its store",
                _ => "or run the map with --allow-outside if you trust it",
            };
            problems.push(problem(format!(
                "\"{text}\" leaves the output folder; name a file inside it, {advice}"
            )));
            continue;
        };
        if let Some(why) = wrong_ending(&path, name.spec.extensions) {
            problems.push(problem(format!("\"{text}\" {why}")));
        }
        let beside = name.spec.beside(&path).iter().map(|ending| beside(&path, ending));
        let all: Vec<PathBuf> = std::iter::once(path.clone()).chain(beside).collect();
        let mut clashes = Vec::new();
        for written in &all {
            let own = port().to_string();
            match writers.insert(one_case(written), own.clone()) {
                Some(other) if other == own => clashes.push(format!(
                    "\"{}\" is the name of a file that is written beside it; give it another \
                     extension",
                    written.display()
                )),
                Some(other) => clashes.push(format!(
                    "{other} writes \"{}\" too; give each a name of its own",
                    written.display()
                )),
                None => {}
            }
        }
        // A file beside another one, such as the materials of a mesh, is no second fault.
        problems.extend(clashes.first().map(|first| problem(and_more(first, clashes.len()))));
        if let Some(node) = nodes.iter_mut().find(|node| node.name == name.node) {
            let specs = node.info.module.params;
            node.settings.each_mut(specs, &mut |param, _, setting| {
                if let Setting::File { resolved, .. } = setting
                    && param == name.param
                {
                    resolved.clone_from(&path);
                }
            });
            node.writes.extend(all);
        }
    }
    check_folders(&writers, problems);
    if let Some(folder) = options.output_folder {
        check_inputs(nodes, folder, problems);
    }
}

/// What is wrong with the ending of a file's name, where only some fit.
fn wrong_ending(path: &Path, extensions: &[&str]) -> Option<String> {
    let own = path.extension().unwrap_or_default().to_string_lossy();
    if extensions.is_empty() || extensions.iter().any(|known| own.eq_ignore_ascii_case(known)) {
        return None;
    }
    let known: Vec<String> = extensions.iter().map(|known| format!(".{known}")).collect();
    let known = known.join(" or ");
    Some(format!("is written as a {known} file; end its name in {known}"))
}

/// What is written beside a file: another one of its stem, or a folder whose name begins with it.
fn beside(path: &Path, ending: &str) -> PathBuf {
    match ending.strip_suffix('/') {
        None => path.with_extension(ending),
        Some(ending) => {
            let mut name = path.file_stem().unwrap_or_default().to_owned();
            name.push(ending);
            path.with_file_name(name)
        }
    }
}

/// The path as a file system that does not tell `A` from `a` sees it.
pub(crate) fn one_case(path: &Path) -> PathBuf {
    path.to_string_lossy().to_lowercase().into()
}

/// The path without `.` and `..`; `None` if it names no file, or leaves the folder where it must
/// not.
fn tidy(text: &str, scope: OutputScope) -> Option<PathBuf> {
    let mut path = PathBuf::new();
    for part in Path::new(text).components() {
        match part {
            Component::CurDir => {}
            Component::Normal(name) => path.push(name),
            Component::ParentDir if path.file_name().is_some() => drop(path.pop()),
            other if !scope.is_bounded() => path.push(other),
            _ => return None,
        }
    }
    let names_a_file = path.file_name().is_some() && !text.ends_with(['/', '\\']);
    names_a_file.then_some(path)
}

/// A path that one saver has for itself, as a file or a folder, and another needs as a folder.
fn check_folders(writers: &BTreeMap<PathBuf, String>, problems: &mut Vec<Problem>) {
    // Of each two parameters, the first such folder, and how often they meet.
    let mut clashes: BTreeMap<(&str, &str), (&Path, usize)> = BTreeMap::new();
    for (path, writer) in writers {
        for folder in path.ancestors().skip(1) {
            if let Some(other) = writers.get(folder) {
                clashes.entry((other, writer)).or_insert((folder, 0)).1 += 1;
            }
        }
    }
    problems.extend(clashes.into_iter().map(|((other, writer), (folder, n))| {
        let folder = folder.display();
        let first = format!("needs \"{folder}\" as a folder, which {other} writes alone");
        let (node, param) = writer.split_once('.').unwrap_or((writer, ""));
        Problem::error(and_more(&first, n)).at(node).port(param)
    }));
}

/// A sentence that stands for `n` of its kind.
fn and_more(first: &str, n: usize) -> String {
    match n {
        1 => first.to_owned(),
        n => format!("{first} (the first of {n} such files)"),
    }
}

/// No run overwrites what it reads.
fn check_inputs(nodes: &[PlanNode], folder: &Path, problems: &mut Vec<Problem>) {
    let absolute = |path: &Path| path.canonicalize().ok();
    for writer in nodes {
        for written in &writer.writes {
            let Some(target) = absolute(&folder.join(written)) else { continue };
            let reads_it = |node: &&PlanNode| {
                // What is written may be a folder.
                let is_inside =
                    |path: &Path| absolute(path).is_some_and(|p| p.starts_with(&target));
                node.reads.iter().any(|(path, _)| is_inside(path))
            };
            if let Some(reader) = nodes.iter().find(reads_it) {
                let message = format!(
                    "would overwrite \"{}\", which {} reads; write to another folder or name",
                    target.display(),
                    reader.name
                );
                problems.push(Problem::error(message).at(&writer.name));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_stay_in_their_folder() {
        let inside = |text| tidy(text, OutputScope::Folder);
        assert_eq!(inside("./a//b.obj"), Some(PathBuf::from("a/b.obj")));
        assert_eq!(inside("a/../ok.obj"), Some(PathBuf::from("ok.obj")));
        for bad in ["../a", "/etc/a", "a/../../b", "", ".", "a/"] {
            assert_eq!(inside(bad), None, "{bad}");
        }
        assert_eq!(tidy("/tmp/a", OutputScope::Anywhere), Some(PathBuf::from("/tmp/a")));
    }

    #[test]
    fn endings_are_those_of_the_format() {
        let wrong = |path: &str, extensions| wrong_ending(Path::new(path), extensions);
        assert_eq!(wrong("a/b.OBJ", &["obj"]), None);
        assert_eq!(wrong("b.anything", &[]), None);
        let said = "is written as a .obj file; end its name in .obj";
        for path in ["b.ply", "b", "b-0.5", "obj"] {
            assert_eq!(wrong(path, &["obj"]).as_deref(), Some(said), "{path}");
        }
        let said = "is written as a .jpg or .jpeg file; end its name in .jpg or .jpeg";
        assert_eq!(wrong("b.png", &["jpg", "jpeg"]).as_deref(), Some(said));
    }

    #[test]
    fn files_and_folders_beside_a_file() {
        let path = Path::new("out/bunny.v2.obj");
        assert_eq!(beside(path, "mtl"), Path::new("out/bunny.v2.mtl"));
        assert_eq!(beside(path, "-textures/"), Path::new("out/bunny.v2-textures"));
    }

    #[test]
    fn parts_of_a_file_name() {
        assert_eq!(file_part("m/bunny.v2.obj", "stem").as_deref(), Some("bunny.v2"));
        assert_eq!(file_part("m/bunny.obj", "name").as_deref(), Some("bunny.obj"));
        assert_eq!(file_part("m/bunny.obj", "folder"), None);
    }
}
