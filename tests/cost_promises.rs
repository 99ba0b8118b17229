//! What costs and placements promise to the engine, checked for every registered one: `reach`,
//! `only_grows` and `renewal`. A wrong promise would change results without a word.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex};

use glam::DVec3;
use mve_core::testing::settings_of;
use mve_core::{Cancelled, Control, Settings};
use mve_modules::cost::COSTS;
use mve_modules::data::{TriMesh, VertexId};
use mve_modules::geometry::simplify::collapse::{
    Batch, Candidates, Collapse, Contraction, Cost, Placement, QuadricOptions, Reach, Renewal,
    Simplified, SimplifyOptions, Stop, WorkingMesh, simplify,
};
use mve_modules::mesh::adjacency::EdgeId;
use mve_modules::mesh::fixtures::torus;
use mve_modules::picture::render::{Lens, Rect};
use mve_modules::picture::view::{ViewDefaults, ViewParams};
use mve_modules::placement::{Optimal, PLACEMENTS};

use crate::contracts::{ends, needed};

/// Pixels around the faces of an edge that its price may depend on: half a window of SSIM around
/// pixels that change, and half a window around those.
const WINDOWS: i32 = 11;

/// By how much a price may fall that only grows, relative to the largest of the mesh. Rounding, and
/// the terms that order prices of zero, are allowed to.
const ROUNDING: f64 = 1e-8;

/// Two closed tori on which no two prices are equal, far from each other and so in a line that no
/// camera sees one before the other.
fn bumpy() -> TriMesh {
    let mut mesh = torus(1.0, 0.4, 8);
    let n = mesh.positions.len() as u32;
    mesh.positions.extend_from_within(..);
    let other: Vec<_> = mesh.faces.iter().map(|face| face.map(|v| VertexId(v.0 + n))).collect();
    mesh.faces.extend(other);
    for (p, number) in mesh.positions.iter_mut().zip(0u32..) {
        let noise = |k: u32| f64::from((number * 7 + k * 3) * 2_654_435 % 1000) / 1000.0 - 0.5;
        *p += DVec3::new(noise(1), noise(2), noise(3)) * 0.05;
        p.x += if number < n { -5.0 } else { 5.0 };
    }
    mesh
}

/// Runs a cost and compares, after each collapse, every price with the one before.
struct Watched {
    cost: Box<dyn Cost>,
    /// A second one of the placement that the engine asks, which has no state.
    placement: Box<dyn Placement>,
    /// Whether the placement says that prices only grow, too.
    only_grows: bool,
    lenses: Vec<Lens>,
    before: BTreeMap<EdgeId, Prices>,
    findings: Arc<Mutex<Findings>>,
}

/// The prices of an edge, and where its faces are in the pictures.
#[derive(Clone)]
struct Prices {
    list: Vec<f64>,
    areas: Vec<Rect>,
}

#[derive(Default)]
struct Findings {
    /// Prices that were compared although they were out of reach.
    n_beyond_reach: usize,
    /// Prices that were compared because they only grow.
    n_growing: usize,
    broken: Vec<String>,
}

impl Watched {
    /// All prices of the mesh as it is.
    fn prices(&self, mesh: &WorkingMesh) -> BTreeMap<EdgeId, Prices> {
        let edges = mesh.edges();
        let contractions: Vec<Contraction> =
            edges.iter().map(|&edge| mesh.contraction(edge)).collect();
        let mut candidates = Candidates::default();
        candidates.reset(edges.len());
        self.placement.propose(mesh, &contractions, &mut candidates);
        let mut proposals = Vec::new();
        candidates.list_proposals(&contractions, &mut proposals);
        let mut prices = vec![f64::NAN; proposals.len()];
        self.cost.price(mesh, candidates.batch(&proposals), &mut prices);
        let mut all = prices.as_slice();
        let of_edge = |((edge, contraction), n): ((EdgeId, &Contraction), usize)| {
            let (list, rest) = all.split_at(n);
            all = rest;
            (edge, Prices { list: list.to_vec(), areas: self.areas(mesh, contraction) })
        };
        edges.into_iter().zip(&contractions).zip(candidates.counts()).map(of_edge).collect()
    }

    /// The rectangles of the pictures that the faces around an edge span.
    fn areas(&self, mesh: &WorkingMesh, contraction: &Contraction) -> Vec<Rect> {
        let ends = [contraction.kept, contraction.gone];
        let faces = || ends.iter().flat_map(|&v| mesh.faces_around(v)).filter_map(|f| mesh.face(f));
        let points: BTreeSet<VertexId> = faces().flatten().collect();
        let area = |lens: &Lens| {
            let mut area = Rect::NONE;
            points.iter().for_each(|&v| area.include(lens.corner(mesh.position(v))));
            area
        };
        self.lenses.iter().map(area).collect()
    }

    fn compare(&self, mesh: &WorkingMesh, collapse: &Collapse) -> BTreeMap<EdgeId, Prices> {
        let now = self.prices(mesh);
        let mut findings = self.findings.lock().expect("no panic");
        let distances = distances(mesh, collapse.kept);
        let reach = self.cost.exact_reach().map(|reach| reach.max(self.placement.reach()));
        let largest = now.values().filter_map(least).fold(0.0, f64::max);
        // What was around the edge, and what is around the merged vertex.
        let touched: Vec<Rect> = self.touched(mesh, collapse);
        for (&edge, prices) in &now {
            let Some(before) = self.before.get(&edge) else { continue };
            let contraction = mesh.contraction(edge);
            let ends = [contraction.kept, contraction.gone];
            let far = ends.map(|v| distances.get(&v).copied().unwrap_or(u32::MAX));
            let is_beyond = match reach {
                Some(reach) => far.into_iter().all(|far| far > reach.0),
                None => before
                    .areas
                    .iter()
                    .zip(&touched)
                    .all(|(area, touched)| area.grown(WINDOWS).within(touched).is_empty()),
            };
            if is_beyond {
                findings.n_beyond_reach += 1;
                let bits = |list: &[f64]| list.iter().map(|p| p.to_bits()).collect::<Vec<_>>();
                if bits(&before.list) != bits(&prices.list) {
                    let change = (&before.list, &prices.list);
                    findings.broken.push(format!("reach: {far:?} edges away, {change:?}"));
                }
            }
            if self.cost.only_grows() && self.only_grows {
                findings.n_growing += 1;
                let (old, new) = (least(before), least(prices));
                if old.zip(new).is_some_and(|(old, new)| new < old - ROUNDING * largest) {
                    findings.broken.push(format!("only_grows: {old:?} became {new:?}"));
                }
            }
        }
        now
    }

    /// The rectangles of the pictures in which a collapse may have changed something.
    fn touched(&self, mesh: &WorkingMesh, collapse: &Collapse) -> Vec<Rect> {
        let around = mesh.faces_around(collapse.kept).filter_map(|face| mesh.face(face)).flatten();
        let dying = collapse.dying_faces.iter().flat_map(|dying| dying.vertices);
        let staying = around.chain(dying).filter(|&v| !collapse.has(v));
        let mut points: Vec<DVec3> = staying.map(|v| mesh.position(v)).collect();
        points.extend(collapse.merged().map(|(_, place)| place));
        points.push(collapse.position);
        let area = |lens: &Lens| {
            let mut area = Rect::NONE;
            points.iter().for_each(|&p| area.include(lens.corner(p)));
            area
        };
        self.lenses.iter().map(area).collect()
    }
}

fn least(prices: &Prices) -> Option<f64> {
    prices.list.iter().copied().filter(|price| !price.is_nan()).reduce(f64::min)
}

/// How many edges each vertex is away from one.
fn distances(mesh: &WorkingMesh, from: VertexId) -> BTreeMap<VertexId, u32> {
    let mut distances = BTreeMap::from([(from, 0)]);
    let mut ring = vec![from];
    for distance in 1.. {
        let faces = ring.iter().flat_map(|&v| mesh.faces_around(v)).filter_map(|f| mesh.face(f));
        let next: BTreeSet<VertexId> =
            faces.flatten().filter(|v| !distances.contains_key(v)).collect();
        if next.is_empty() {
            break;
        }
        distances.extend(next.iter().map(|&v| (v, distance)));
        ring = next.into_iter().collect();
    }
    distances
}

impl Cost for Watched {
    fn begin(&mut self, mesh: &WorkingMesh, control: Control) -> Result<(), Cancelled> {
        self.cost.begin(mesh, control)?;
        self.before = self.prices(mesh);
        Ok(())
    }

    fn price(&self, mesh: &WorkingMesh, batch: Batch, prices: &mut [f64]) {
        self.cost.price(mesh, batch, prices);
    }

    fn collapsed(&mut self, mesh: &WorkingMesh, collapse: &Collapse) {
        self.cost.collapsed(mesh, collapse);
        self.before = self.compare(mesh, collapse);
    }

    fn reach(&self) -> Reach {
        self.cost.reach()
    }

    fn renewal(&self) -> Renewal {
        self.cost.renewal()
    }

    fn waiting_share(&self) -> f64 {
        self.cost.waiting_share()
    }

    fn quadrics(&self) -> Option<QuadricOptions> {
        self.cost.quadrics()
    }
}

fn to_faces(n: usize) -> SimplifyOptions {
    SimplifyOptions { stop: Stop { faces: Some(n), ..Stop::default() }, ..Default::default() }
}

/// The parameters by which costs say what pictures they look at.
const VIEW: ViewParams = ViewParams::new(ViewDefaults {
    cameras: "Dodecahedron",
    resolution: 256,
    shading: "Flat",
    sides: "Front",
    background: 255,
    albedo: "White",
});

/// The cameras of a cost; none where it has no such parameters.
fn lenses(mesh: &TriMesh, settings: &Settings) -> Vec<Lens> {
    let bounds = mesh.bounds().expect("a mesh");
    let Ok(cameras) = VIEW.read_cameras(settings) else { return Vec::new() };
    let resolution = settings.get(&VIEW.resolution).expect("a view has it") as usize;
    let distance = (bounds.1 - bounds.0).length();
    let cameras = cameras.around(bounds, &mesh.positions).into_iter();
    cameras.map(|camera| Lens::new(camera, resolution, distance)).collect()
}

/// What a run of a cost with a placement shows.
fn watch(
    mesh: &TriMesh,
    cost: Box<dyn Cost>,
    lenses: Vec<Lens>,
    mut placements: [Box<dyn Placement>; 2],
    only_grows: bool,
    n_collapses: usize,
) -> Findings {
    let findings = Arc::default();
    let [asked, placement] = &mut placements;
    let placement = std::mem::replace(placement, Box::new(Middle));
    let mut watched = Watched {
        cost,
        placement,
        only_grows,
        lenses,
        before: BTreeMap::new(),
        findings: Arc::clone(&findings),
    };
    let options = to_faces(mesh.faces.len() - 2 * n_collapses);
    simplify(mesh, &mut watched, asked.as_mut(), options, Control::none()).expect("no cancel");
    drop(watched);
    Arc::into_inner(findings).expect("one owner").into_inner().expect("no panic")
}

/// Calls with every registered cost and placement; those that need files get them.
fn each_pair(mesh: &TriMesh, mut check: impl FnMut(&str, Vec<Lens>, MakeParts)) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let settings = |id: &str, params| settings_of(params, &needed(id, params, folder.path()));
    for cost in COSTS.entries {
        let of_cost = settings(cost.item.id, cost.item.params);
        for placement in PLACEMENTS.entries {
            let own = settings(placement.item.id, placement.item.params);
            let make = || {
                let cost = (cost.item.build)(mesh, &of_cost).expect("a cost");
                let placement = || (placement.item.build)(mesh, &own).expect("a placement");
                (cost, [placement(), placement()])
            };
            let name = format!("{} with {}", cost.item.id, placement.item.id);
            check(&name, lenses(mesh, &of_cost), &make);
        }
    }
}

/// Calls with every registered cost once for each end of each of its parameters, and each name or
/// entry that it may have, beside the default of the others. Pictures are small.
fn each_variant(mesh: &TriMesh, mut check: impl FnMut(&str, Box<dyn Cost>, Vec<Lens>)) {
    const LARGEST: i64 = 64;
    let folder = tempfile::tempdir().expect("a temporary folder");
    for cost in COSTS.entries {
        let (id, params) = (cost.item.id, cost.item.params);
        let mut base = needed(id, params, folder.path());
        if params.iter().any(|spec| spec.name == VIEW.resolution.spec().name) {
            base.insert(VIEW.resolution.spec().name.to_owned(), LARGEST.into());
        }
        for spec in params {
            for value in ends(spec, folder.path()) {
                let is_picture = spec.name == VIEW.resolution.spec().name;
                if is_picture && value.as_i64().is_some_and(|n| n > LARGEST) {
                    continue;
                }
                let mut given = base.clone();
                given.insert(spec.name.to_owned(), value.clone());
                let settings = settings_of(params, &given);
                // A mesh without colors is an error for a cost that is to look at them.
                let Ok(made) = (cost.item.build)(mesh, &settings) else { continue };
                check(&format!("{id} with {} = {value}", spec.name), made, lenses(mesh, &settings));
            }
        }
    }
}

type MakeParts<'a> = &'a dyn Fn() -> (Box<dyn Cost>, [Box<dyn Placement>; 2]);

#[test]
fn no_price_changes_beyond_the_reach_and_none_falls_that_only_grows() {
    let mesh = bumpy();
    each_pair(&mesh, |name, lenses, make| {
        let (cost, placements) = make();
        let only_grows = placements[0].only_grows();
        let claims = cost.only_grows() && only_grows;
        let found = watch(&mesh, cost, lenses, placements, only_grows, 6);
        assert_eq!(found.broken.first(), None, "{name}: {} broken", found.broken.len());
        assert!(found.n_beyond_reach > 50, "{name}: {} compared", found.n_beyond_reach);
        assert_eq!(found.n_growing > 300, claims, "{name}");
    });
}

#[test]
fn promises_hold_whatever_the_parameters_are() {
    let mesh = bumpy();
    let (mut n_variants, mut n_compared) = (0, 0);
    each_variant(&mesh, |name, cost, lenses| {
        let placements: [Box<dyn Placement>; 2] =
            [Box::new(Optimal::DEFAULT), Box::new(Optimal::DEFAULT)];
        let found = watch(&mesh, cost, lenses, placements, true, 2);
        assert_eq!(found.broken.first(), None, "{name}: {} broken", found.broken.len());
        n_compared += usize::from(found.n_beyond_reach > 0);
        n_variants += 1;
    });
    // The least that the costs of today have.
    assert!(n_variants >= 25, "{n_variants}");
    // Of many cameras one sees both tori behind each other, so that each change is in its picture.
    assert!(n_compared + 6 >= n_variants, "{n_compared} of {n_variants}");
}

/// A cost with some of its promises replaced.
struct Renewed {
    cost: Box<dyn Cost>,
    renewal: Renewal,
    only_grows: bool,
    /// The prices of all collapses together.
    paid: f64,
}

impl Cost for Renewed {
    fn begin(&mut self, mesh: &WorkingMesh, control: Control) -> Result<(), Cancelled> {
        self.cost.begin(mesh, control)
    }

    fn price(&self, mesh: &WorkingMesh, batch: Batch, prices: &mut [f64]) {
        self.cost.price(mesh, batch, prices);
    }

    fn collapsed(&mut self, mesh: &WorkingMesh, collapse: &Collapse) {
        self.paid += collapse.price;
        self.cost.collapsed(mesh, collapse);
    }

    fn reach(&self) -> Reach {
        self.cost.reach()
    }

    fn renewal(&self) -> Renewal {
        self.renewal
    }

    fn waiting_share(&self) -> f64 {
        self.cost.waiting_share()
    }

    fn only_grows(&self) -> bool {
        self.only_grows
    }

    fn quadrics(&self) -> Option<QuadricOptions> {
        self.cost.quadrics()
    }
}

/// A run to three quarters of the faces, and what it paid.
fn renewed(mesh: &TriMesh, make: MakeParts, renewal: Renewal, lazy: bool) -> (Simplified, f64) {
    let (cost, [mut placement, _]) = make();
    let only_grows = lazy && cost.only_grows();
    let mut cost = Renewed { cost, renewal, only_grows, paid: 0.0 };
    let options = to_faces(mesh.faces.len() * 3 / 4);
    let result = simplify(mesh, &mut cost, placement.as_mut(), options, Control::none());
    (result.expect("no cancel"), cost.paid)
}

#[test]
fn lazy_and_at_once_agree() {
    let mesh = bumpy();
    each_pair(&mesh, |name, _, make| {
        let (cost, [placement, _]) = make();
        let claims = cost.only_grows() && placement.only_grows();
        if claims {
            let [(at_once, _), (as_it_comes_up, _)] =
                [false, true].map(|lazy| renewed(&mesh, make, Renewal::AtOnce, lazy));
            assert_eq!(as_it_comes_up.mesh, at_once.mesh, "{name}");
        }
        // One placement is enough where nothing is claimed.
        if claims || !name.ends_with("Midpoint") {
            return;
        }
        let [(at_once, paid), (lazy, paid_lazily)] =
            [Renewal::AtOnce, Renewal::Lazy].map(|renewal| renewed(&mesh, make, renewal, false));
        if cost.reach() == Reach::MERGED {
            // Edges at the merged vertex are never put off, and there are no others.
            assert_eq!(lazy.mesh, at_once.mesh, "{name}");
        }
        // A waiting price stands for one that is less, see `Cost::waiting_share`. A
        // cost that asks for that has found it to change little.
        let bound = if cost.renewal() == Renewal::Lazy { 1.1 } else { 3.0 };
        let ratio = paid_lazily / paid;
        assert!((1.0 / bound..=bound).contains(&ratio), "{name}: {paid_lazily} for {paid}");
        assert_eq!(lazy.mesh.faces.len(), at_once.mesh.faces.len(), "{name}");
    });
}

/// The middle of the edge.
struct Middle;

impl Placement for Middle {
    fn propose(&self, mesh: &WorkingMesh, batch: &[Contraction], out: &mut Candidates) {
        for (at, Contraction { kept, gone, .. }) in batch.iter().enumerate() {
            out.push(at, mesh.position(*kept).midpoint(mesh.position(*gone)));
        }
    }
}

/// Prices an edge by the number of faces around its ends' neighbors, so that a collapse changes and
/// lowers prices one edge farther than `reach` says.
struct Liar {
    reach: Reach,
    only_grows: bool,
}

impl Cost for Liar {
    fn price(&self, mesh: &WorkingMesh, batch: Batch, prices: &mut [f64]) {
        for (price, proposal) in prices.iter_mut().zip(batch) {
            let ends = [proposal.contraction.kept, proposal.contraction.gone];
            let faces = ends.into_iter().flat_map(|v| mesh.faces_around(v));
            let around = faces.filter_map(|face| mesh.face(face)).flatten();
            let lengths = around.map(|v| mesh.position(v).distance(mesh.position(ends[0])));
            *price = lengths.sum();
        }
    }

    fn reach(&self) -> Reach {
        self.reach
    }

    fn only_grows(&self) -> bool {
        self.only_grows
    }
}

#[test]
fn false_promises_are_found() {
    let mesh = bumpy();
    let middle = || -> [Box<dyn Placement>; 2] { [Box::new(Middle), Box::new(Middle)] };
    let broken = |reach, only_grows| {
        watch(&mesh, Box::new(Liar { reach, only_grows }), Vec::new(), middle(), true, 6).broken
    };
    assert_eq!(broken(Reach::NEIGHBORS, false), Vec::<String>::new());
    assert!(broken(Reach::MERGED, false).iter().all(|found| found.starts_with("reach")));
    assert!(broken(Reach::MERGED, false).len() > 20);
    let falls = broken(Reach::NEIGHBORS, true);
    assert!(falls.len() > 20 && falls.iter().all(|found| found.starts_with("only_grows")));
}
