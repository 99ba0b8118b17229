//! The image-driven costs: seconds of a run, evaluations a second, and how much drawing whole
//! pictures would take.
//!
//! `cargo bench -p mve-modules --bench image_costs [-- WORD]` runs the cases whose name has the
//! word. An evaluation prices one collapse in all 20 cameras. The models are those of the folder
//! `MVE_MODELS`; without it, only the generated torus is measured.

use std::cell::Cell;
use std::time::{Duration, Instant};

use glam::DVec2;
use mve_core::{Cancelled, Control};
use mve_modules::cost::Squares;
use mve_modules::data::{Domain, Image, Layer, LayerValues, PixelKind, TriMesh};
use mve_modules::geometry::simplify::collapse::{
    Batch, Collapse, Cost, Reach, Renewal, SimplifyOptions, Stop, WorkingMesh, simplify,
};
use mve_modules::image_driven::{Areas, Difference, ImageDriven, ImageOptions, Structure};
use mve_modules::mesh::fixtures::{textured, torus};
use mve_modules::picture::render::Albedo;
use mve_modules::placement::Optimal;

/// Whole pictures are drawn for one in so many batches, to have a time to compare with.
const WHOLE_EACH: usize = 200;

/// A cost that counts and times what it is asked.
struct Counted<D: Difference> {
    active: ImageDriven<D>,
    whole: Option<ImageDriven<D>>,
    n_batches: Cell<usize>,
    n_active: Cell<usize>,
    n_whole: Cell<usize>,
    in_active: Cell<Duration>,
    in_whole: Cell<Duration>,
}

fn add<T: Copy + std::ops::Add<Output = T>>(cell: &Cell<T>, more: T) {
    cell.set(cell.get() + more);
}

impl<D: Difference> Cost for Counted<D> {
    fn begin(&mut self, mesh: &WorkingMesh, control: Control) -> Result<(), Cancelled> {
        if let Some(whole) = &mut self.whole {
            whole.begin(mesh, control)?;
        }
        self.active.begin(mesh, control)
    }

    fn price(&self, mesh: &WorkingMesh, batch: Batch, prices: &mut [f64]) {
        let start = Instant::now();
        self.active.price(mesh, batch, prices);
        add(&self.in_active, start.elapsed());
        add(&self.n_active, batch.len());
        add(&self.n_batches, 1);
        let whole = self.whole.as_ref().filter(|_| self.n_batches.get().is_multiple_of(WHOLE_EACH));
        if let (Some(whole), Some(first)) = (whole, batch.proposals.first()) {
            let mut price = [0.0];
            let start = Instant::now();
            whole.price(mesh, Batch::new(&[*first]), &mut price);
            add(&self.in_whole, start.elapsed());
            add(&self.n_whole, 1);
            assert_eq!(price[0], prices[0]);
        }
    }

    fn collapsed(&mut self, mesh: &WorkingMesh, collapse: &Collapse) {
        self.active.collapsed(mesh, collapse);
        if let Some(whole) = &mut self.whole {
            whole.collapsed(mesh, collapse);
        }
    }

    fn renewal(&self) -> Renewal {
        self.active.renewal()
    }

    fn uses_threads(&self) -> bool {
        self.active.uses_threads()
    }

    fn reach(&self) -> Reach {
        self.active.reach()
    }
}

fn measure<D: Difference>(
    name: &str,
    mesh: &TriMesh,
    to: usize,
    difference: D,
    options: ImageOptions,
) {
    let run = |with_whole: bool| {
        let new =
            |areas| ImageDriven::new(mesh, difference.clone(), ImageOptions { areas, ..options });
        let mut cost = Counted {
            active: new(Areas::Active),
            whole: with_whole.then(|| new(Areas::Whole)),
            n_batches: Cell::default(),
            n_active: Cell::default(),
            n_whole: Cell::default(),
            in_active: Cell::default(),
            in_whole: Cell::default(),
        };
        let stop = Stop { faces: Some(to), ..Stop::default() };
        let options = SimplifyOptions { stop, ..SimplifyOptions::DEFAULT };
        let start = Instant::now();
        let placement = &mut Optimal::default();
        let found = simplify(mesh, &mut cost, placement, options, Control::none());
        let found = found.expect("nothing cancels it");
        (start.elapsed().as_secs_f64(), cost, found.statistics.n_faces)
    };
    let (seconds, cost, n_faces) = run(false);
    let micros = |time: Duration, n: usize| time.as_secs_f64() * 1e6 / n.max(1) as f64;
    let n = cost.n_active.get();
    let each = micros(cost.in_active.get(), n);
    let (_, sampled, _) = run(true);
    let whole = micros(sampled.in_whole.get(), sampled.n_whole.get());
    println!(
        "{name:28} {:>6} -> {n_faces:>6} faces: {seconds:7.2} s, {n:>8} evaluations, {:>7.0} a \
         second, {each:7.1} us each, whole pictures {whole:8.0} us ({:.0}x)",
        mesh.faces.len(),
        n as f64 / seconds,
        whole / each,
    );
}

fn model(name: &str) -> Option<TriMesh> {
    let text = std::fs::read(mve_modules::mesh::testing::model(name)?).ok()?;
    let mut no_mtl = |_: &str| Err(std::io::ErrorKind::NotFound.into());
    mve_modules::formats::obj::parse(&text, &mut no_mtl, Control::none()).ok().map(|found| found.0)
}

/// The mesh with a color a vertex, and a texture laid on along z.
fn painted(mesh: TriMesh) -> TriMesh {
    let (positions, faces) = (mesh.positions.clone(), mesh.faces.clone());
    let picture = Image {
        name: String::new(),
        width: 64,
        height: 64,
        kind: PixelKind::Rgb,
        bytes: (0..64 * 64 * 3).map(|k: u32| (k * 7919 % 251) as u8).collect(),
    };
    let mut mesh = textured(mesh, picture, |face, k| {
        let at = positions[faces[face.idx()][k].idx()];
        DVec2::new(at.x, at.y)
    });
    let colors = positions.iter().map(|at| (*at + 1.5) / 3.0).collect();
    let (name, domain) = (Layer::COLOR.to_owned(), Domain::Vertex);
    let index = (0..positions.len() as u32).collect();
    mesh.set_layer(Layer { name, domain, values: LayerValues::Vec3(colors), index });
    mesh
}

fn main() {
    let word = std::env::args().skip(1).find(|word| !word.starts_with('-')).unwrap_or_default();
    let both = |name: &str, mesh: &TriMesh, to: usize, size: usize| {
        let options = ImageOptions { resolution: size, ..ImageOptions::DEFAULT };
        let mse = format!("{name} ImageMse {size}");
        if mse.contains(&word) {
            measure(&mse, mesh, to, Squares, options);
        }
        let ssim = format!("{name} ImageSsim {size}");
        if ssim.contains(&word) {
            measure(&ssim, mesh, to, Structure::default(), options);
        }
    };
    if let Some(cow) = model("cow.obj") {
        both("cow", &cow, 3000, 256);
        both("cow", &cow, 3000, 512);
    }
    if let Some(bunny) = model("stanford-bunny.obj") {
        both("bunny", &bunny, 6945, 256);
    }
    // What colors take: the same surface white, with a color a vertex, and textured.
    let painted = painted(torus(1.0, 0.4, 50));
    for albedo in [Albedo::White, Albedo::Colors, Albedo::Textures] {
        let name = format!("{albedo:?} ImageMse");
        if name.contains(&word) {
            let to = painted.faces.len() - 1000;
            measure(&name, &painted, to, Squares, ImageOptions { albedo, ..ImageOptions::DEFAULT });
        }
    }
    // The same number of collapses in meshes of 4 and 64 times the size.
    for n in [50, 100, 400] {
        let mesh = torus(1.0, 0.4, n);
        both(&format!("torus {}", mesh.faces.len()), &mesh, mesh.faces.len() - 1000, 256);
    }
}
