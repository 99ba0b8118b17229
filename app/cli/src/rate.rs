//! `mve rate`: a page on which people mark how far results look from their originals.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::ValueEnum;
use mve_core::{
    Cache, CancelToken, Control, FileHashes, Fingerprint, Keep, Map, OutputScope, Plan, PlanFile,
    PlanOptions, PortRef, Problem, Registry, RunOptions, Step, StepStatus, Store, assign, meant,
};
use mve_modules::data::{PixelKind, TriMesh};
use mve_modules::formats::png::write_png;
use mve_modules::picture::render::{
    Albedo, Frame, NormalSource, PictureOptions, Shading, Sides, Surface,
};
use mve_modules::picture::turntable::{Upright, sheet, turntable};
use mve_report::rating::{RatingItem, RatingPage};
use serde_json::Value as Json;

use crate::check::count;
use crate::exit::{Exit, Stop};
use crate::load::CommandArgs;
use crate::machine::set_threads;
use crate::out;
use crate::program::{check_only, parse_only};
use crate::progress::Progress;
use crate::stop::Signals;

/// The page's name in a store.
const PAGE: &str = "rate.html";

/// Bytes of a page from which on a person is told.
const LARGE_PAGE: usize = 64 << 20;

/// The gray of the background.
const BACKGROUND: u8 = 220;

/// Samples along each side of a pixel.
const SAMPLES: usize = 2;

const STOPPING: &str = "stopping; nothing is written";

/// Make a page on which people mark how far results look from their originals
#[derive(clap::Args)]
#[command(after_help = "Examples:
  mve rate mve-out/vase-costs                    writes mve-out/vase-costs/rate.html
  mve rate mve-out/vase-costs --out study.html --shading smooth
  mve rate mve-out/vase-costs --only simplify.target_faces=300 --up z
  mve rate mve-out/vase-costs --original load.mesh --result simplify.mesh
  mve report mve-out/vase-costs --ratings anna.json,ben.json

The page is one file that opens in any browser, without a network: send it to whom you ask. It \
shows the original beside each result, turning, without a word of how that was made and in an \
order of its own for each person, takes marks from 0 (no difference) to 10, goes back, keeps what \
was marked when it is closed, and saves a file to send back. `mve report --ratings` takes them.

Which outputs are shown is found from the node that compares an original with a simplified mesh; \
--original and --result name others. Values that the store keeps are taken from there, others are \
made again. A result stands for a step as it is: when modules or inputs have changed, run the \
program again first.")]
pub struct Args {
    /// Folder of a program's results
    #[arg(value_name = "STORE")]
    store: PathBuf,
    /// File to write [default: STORE/rate.html]
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Output with the original mesh
    #[arg(long, value_name = "NODE.OUTPUT", value_parser = parse_port)]
    original: Option<PortRef>,
    /// Output with the mesh to be marked
    #[arg(long, value_name = "NODE.OUTPUT", value_parser = parse_port)]
    result: Option<PortRef>,
    /// Show only steps that set a parameter so, by its value or by the id of an entry
    #[arg(long, value_name = "NODE.PARAM=VALUE", value_parser = parse_only)]
    only: Vec<(String, Json)>,
    /// Pictures around each mesh
    #[arg(long, value_name = "N", default_value_t = 24)]
    #[arg(value_parser = clap::value_parser!(u16).range(1..=90))]
    frames: u16,
    /// Pixels in a row of a picture, and rows
    #[arg(long, value_name = "N", default_value_t = 400)]
    #[arg(value_parser = clap::value_parser!(u16).range(64..=1024))]
    size: u16,
    /// How surfaces are lit
    #[arg(long, value_enum, default_value_t = ShadingName::Flat)]
    shading: ShadingName,
    /// Axis of the models that points upward [default: the one that seems to, as in the window]
    #[arg(long, value_enum)]
    up: Option<UprightName>,
    #[command(flatten)]
    commands: CommandArgs,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum ShadingName {
    /// One light a face, as metrics on pictures have it
    Flat,
    /// Interpolated between the vertices
    Smooth,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum UprightName {
    /// The y axis
    Y,
    /// The z axis
    Z,
}

fn parse_port(text: &str) -> Result<PortRef, String> {
    text.parse().map_err(|()| "write NODE.OUTPUT, such as simplify.mesh".to_owned())
}

/// Runs the command.
pub fn run(args: &Args, quiet: bool) -> Result<Exit, Stop> {
    let signals = Signals::listen(false)?;
    let threads = set_threads(None)?;
    let study = Study::open(args)?;
    let steps = study.steps()?;
    let cancel = CancelToken::new();
    let progress = Progress::new("results", steps.len(), 0, !quiet);
    signals.stop(&cancel, &progress, STOPPING);
    let cache = study.store.disk_cache(None)?;
    let cache = Cache::new(1 << 28, Some(cache));
    let page = progress.watch(|| study.page(&steps, (&cache, threads), &cancel, &progress))?;
    let path = args.out.clone().unwrap_or_else(|| args.store.join(PAGE));
    let html = page.html();
    if html.len() > LARGE_PAGE {
        out::tell(&format!(
            "{} the page has {} MB; --size and --frames make it smaller",
            out::warning_mark(),
            html.len() >> 20
        ));
    }
    out::write_file(&path, &html)?;
    out::print(&format!(
        "{} of {}, {:.1} MB\npage     {}\n",
        count(page.items.len(), "result"),
        count(page.originals.len(), "original"),
        html.len() as f64 / 1e6,
        path.display()
    ))
}

/// What is shown, and how.
struct Study<'a> {
    args: &'a Args,
    store: Store,
    plan: PlanFile,
    map: Map,
    registry: Registry,
    files: FileHashes,
    original: PortRef,
    result: PortRef,
}

impl<'a> Study<'a> {
    fn open(args: &'a Args) -> Result<Self, Stop> {
        let missing = || {
            let folder = args.store.display();
            let message = format!(
                "{folder}: no results of a program here; `mve program` makes such a folder"
            );
            Stop { exit: Exit::Files, message }
        };
        let store = Store::look(&args.store)?.ok_or_else(missing)?;
        let plan = store.plan()?;
        let map = Map::parse(&plan.map.to_string());
        let map = map.map_err(|error| Stop::refused(format!("the map of the store: {error}")))?;
        let registry = mve_modules::registry();
        let end = |asked: &Option<PortRef>, input: &str, option: &str| {
            let found = asked.clone().or_else(|| compared(&map, input));
            found.ok_or_else(|| {
                Stop::usage(format!(
                    "no node of the map compares two meshes; name what is shown with {option} \
                     NODE.OUTPUT"
                ))
            })
        };
        let original = end(&args.original, "original", "--original")?;
        let result = end(&args.result, "simplified", "--result")?;
        for (port, option) in [(&original, "--original"), (&result, "--result")] {
            if !map.nodes.contains_key(&port.node) {
                let message = format!("{option} {port}: the map has no node \"{}\"", port.node);
                return Err(Stop::usage(message));
            }
        }
        let files = FileHashes::new();
        Ok(Self { args, store, plan, map, registry, files, original, result })
    }

    /// A finished step for each assignment of parameters.
    fn steps(&self) -> Result<Vec<&Step>, Stop> {
        let mut known = HashSet::new();
        let mut steps = Vec::new();
        let only = self.args.only.iter().map(|(path, wanted)| {
            let values = self.plan.steps.iter().filter_map(|step| step.params.get(path));
            (path.as_str(), meant(wanted, values))
        });
        let only: Vec<(&str, Vec<&Json>)> = only.collect();
        check_only(&self.args.only, &self.plan.varied, &self.plan.steps)?;
        for step in &self.plan.steps {
            let is_done = self.store.record(&step.id).is_some_and(|r| r.status == StepStatus::Done);
            let mut params: Vec<String> =
                step.params.iter().map(|(path, value)| format!("{path}={value}")).collect();
            params.sort();
            let is_meant = |(path, values): &(&str, Vec<&Json>)| {
                step.params.get(*path).is_some_and(|value| values.contains(&value))
            };
            if is_done && only.iter().all(is_meant) && known.insert(params) {
                steps.push(step);
            }
        }
        match steps.is_empty() {
            true => {
                let folder = self.args.store.display();
                let which = if only.is_empty() { "no step" } else { "no such step" };
                let message = format!("{folder}: {which} is done, so there is nothing to mark");
                Err(Stop::refused(message))
            }
            false => Ok(steps),
        }
    }

    /// Plans a map as its program did.
    fn planned(&self, map: &Map, step: &Step) -> Result<Plan, Stop> {
        let folder = self.plan.map_path.parent().unwrap_or(Path::new("."));
        let options = PlanOptions {
            output_scope: OutputScope::Step,
            command_scope: self.args.commands.scope(),
            repeat: step.repeat,
            ..PlanOptions::new(folder, &self.files)
        };
        Plan::new(map, &self.registry, &options).map_err(|problems| {
            let errors = problems.iter().filter(|problem| problem.is_error());
            let lines: Vec<String> = errors.map(Problem::to_string).collect();
            Stop::refused(format!("step {}: {}", step.id, lines.join("\n")))
        })
    }

    /// The plan of what a step shows.
    fn plan_of(&self, step: &Step) -> Result<Plan, Stop> {
        let mut map = self.map.clone();
        let mut params: Vec<_> = step.params.iter().collect();
        let is_module = |path: &str| path.split_once('.').is_some_and(|(_, p)| p == "module");
        params.sort_by_key(|(path, _)| (!is_module(path), path.split('.').count()));
        for (path, value) in params {
            assign(&mut map, &self.registry, path, value.clone())
                .map_err(|problem| Stop::refused(format!("step {}: {problem}", step.id)))?;
        }
        if self.planned(&map, step)?.id.short() != step.id {
            return Err(Stop::refused(format!(
                "step {} would be another one now: modules or inputs have changed since it ran; run \
                 `mve program` again, then make the page",
                step.id
            )));
        }
        keep_needed(&mut map, [&self.original, &self.result]);
        self.planned(&map, step)
    }

    /// Takes the pictures.
    fn page(
        &self,
        steps: &[&Step],
        (cache, threads): (&Cache, usize),
        cancel: &CancelToken,
        progress: &Progress,
    ) -> Result<RatingPage, Stop> {
        let n_frames = usize::from(self.args.frames);
        let mut page = RatingPage {
            program: self.plan.program.clone(),
            frames: n_frames,
            columns: (n_frames as f64).sqrt().ceil() as usize,
            size: usize::from(self.args.size),
            ..RatingPage::default()
        };
        let mut originals: HashMap<(Fingerprint, String), (usize, Frame)> = HashMap::new();
        for step in steps {
            progress.start(&step.id, crate::program_report::label(step));
            let plan = self.plan_of(step)?;
            let scratch =
                tempfile::tempdir().map_err(|error| Stop::file(Path::new("."), &error))?;
            let options = RunOptions {
                threads,
                cache: Some(cache),
                keep: Keep::All,
                output_scope: OutputScope::Step,
                ..RunOptions::new(scratch.path(), cancel)
            };
            let outcome = mve_core::run(&plan, &options);
            if cancel.is_cancelled() {
                return Err(Stop { exit: Exit::Interrupted, message: "stopped".to_owned() });
            }
            let failure = |why: String| Stop { exit: Exit::Failed, message: why };
            if let Some((node, error)) = outcome.failures().next() {
                return Err(failure(format!("step {}: {node}: {error}", step.id)));
            }
            let mesh = |port: &PortRef| {
                let value = outcome.value(&port.node, &port.port);
                let mesh = value.and_then(|value| value.get::<TriMesh>());
                mesh.ok_or_else(|| Stop::usage(format!("{port} is no output with a mesh")))
            };
            let (original, result) = (mesh(&self.original)?, mesh(&self.result)?);
            let key = plan.find(&self.original.node).map(|node| node.key);
            let key = (key.unwrap_or(Fingerprint::of(b"")), self.original.port.clone());
            if !originals.contains_key(&key) {
                let frame =
                    turntable(&original, self.upright(&original), n_frames).ok_or_else(|| {
                        failure(format!("step {}: the original has no finite extent", step.id))
                    })?;
                page.originals.push(self.sheet(&original, &frame, page.columns, cancel)?);
                originals.insert(key.clone(), (page.originals.len() - 1, frame));
            }
            if let Some((original, frame)) = originals.get(&key) {
                let sheet = self.sheet(&result, frame, page.columns, cancel)?;
                let (step, original) = (step.id.clone(), *original);
                page.items.push(RatingItem { step, original, sheet });
            }
            progress.end(&step.id, false, |ended, total| format!("[{ended}/{total}] {}", step.id));
        }
        Ok(page)
    }

    fn upright(&self, original: &TriMesh) -> Upright {
        match self.args.up {
            Some(UprightName::Y) => Upright::Y,
            Some(UprightName::Z) => Upright::Z,
            None => original.bounds().map_or(Upright::Y, |(low, high)| Upright::of(low, high)),
        }
    }

    /// All pictures of a mesh, as a PNG file.
    fn sheet(
        &self,
        mesh: &Arc<TriMesh>,
        frame: &Frame,
        columns: usize,
        cancel: &CancelToken,
    ) -> Result<Vec<u8>, Stop> {
        let stopped = || Stop { exit: Exit::Interrupted, message: "stopped".to_owned() };
        let goes_on = |_: f64| match cancel.is_cancelled() {
            true => std::ops::ControlFlow::Break(()),
            false => std::ops::ControlFlow::Continue(()),
        };
        let control = Control::new(&goes_on);
        let shading = match self.args.shading {
            ShadingName::Flat => Shading::Flat,
            ShadingName::Smooth => Shading::Gouraud,
        };
        let surface = Surface::new(mesh, shading, NormalSource::Faces, Albedo::Textures, control);
        let surface = surface.map_err(|_| stopped())?;
        let options = PictureOptions {
            size: usize::from(self.args.size),
            sides: Sides::Both,
            background: BACKGROUND,
            kind: if surface.is_colored() { PixelKind::Rgb } else { PixelKind::Gray },
            samples: SAMPLES,
        };
        let images = frame.pictures(&surface, &options, control).map_err(|_| stopped())?;
        let mut bytes = Vec::new();
        if let Some(sheet) = sheet(&images, columns) {
            write_png(&sheet, &mut bytes, control).map_err(|_| stopped())?;
        }
        Ok(bytes)
    }
}

/// What comes to an input of this name at the first node that compares an original with a
/// simplified mesh.
fn compared(map: &Map, input: &str) -> Option<PortRef> {
    let link = |node: &str, port: &str| {
        map.links.iter().find(|link| link.to.node == node && link.to.port == port)
    };
    let mut nodes = map.nodes.keys();
    let node = nodes
        .find(|node| link(node, "original").is_some() && link(node, "simplified").is_some())?;
    link(node, input).map(|link| link.from.clone())
}

/// Leaves what these outputs need.
fn keep_needed(map: &mut Map, ports: [&PortRef; 2]) {
    let mut needed: HashSet<String> = HashSet::new();
    let mut open: Vec<String> = ports.iter().map(|port| port.node.clone()).collect();
    while let Some(node) = open.pop() {
        if needed.insert(node.clone()) {
            let into = map.links.iter().filter(|link| link.to.node == node);
            open.extend(into.map(|link| link.from.node.clone()));
        }
    }
    map.nodes.retain(|name, _| needed.contains(name));
    map.links.retain(|link| needed.contains(&link.from.node) && needed.contains(&link.to.node));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_shown_is_found_from_what_compares() {
        let text = r#"{"mve": 1, "nodes": {"a": {"module": "Vase"}, "b": {"module": "Simplificator"},
            "c": {"module": "MeshComparer"}, "d": {"module": "MeshInfo"}},
            "links": ["a.mesh -> b.mesh", "a.mesh -> c.original", "b.mesh -> c.simplified",
                "b.mesh -> d.mesh"]}"#;
        let mut map = Map::parse(text).unwrap();
        let port = |input: &str| compared(&map, input).unwrap().to_string();
        assert_eq!([port("original"), port("simplified")], ["a.mesh", "b.mesh"]);
        let ends = [parse_port("a.mesh").unwrap(), parse_port("b.mesh").unwrap()];
        keep_needed(&mut map, [&ends[0], &ends[1]]);
        assert_eq!(map.nodes.keys().collect::<Vec<_>>(), ["a", "b"]);
        assert_eq!(map.links.len(), 1);
    }
}
