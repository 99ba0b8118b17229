//! Prices of active areas against those of whole pictures, and pictures of odd meshes.

use glam::DVec3;
use mve_mesh::data::{FaceId, VertexId};

use super::*;
use crate::cost::Squares;
use crate::geometry::generate::{VaseOptions, vase};
use crate::geometry::simplify::collapse::{
    Candidates, Contraction, DyingFace, Placement, Proposal, Seams, SimplifyOptions, Stop, Turns,
    simplify, trial,
};
use crate::picture::render::{FaceSide, NO_FACE, Visible, luminance, normal};
use crate::placement::{Endpoint, Optimal};

/// Prices by active areas, and checks some of them against whole pictures.
pub struct Checked<D: Difference> {
    active: ImageDriven<D>,
    whole: ImageDriven<D>,
    pub n_checked: Mutex<usize>,
}

impl<D: Difference> Checked<D> {
    pub fn new(mesh: &TriMesh, difference: D, options: ImageOptions) -> Self {
        let new =
            |areas| ImageDriven::new(mesh, difference.clone(), ImageOptions { areas, ..options });
        Self { active: new(Areas::Active), whole: new(Areas::Whole), n_checked: Mutex::new(0) }
    }
}

impl<D: Difference> Cost for Checked<D> {
    fn begin(&mut self, mesh: &WorkingMesh, control: Control) -> Result<(), Cancelled> {
        self.active.begin(mesh, control)?;
        self.whole.begin(mesh, control)
    }

    fn price(&self, mesh: &WorkingMesh, batch: Batch, prices: &mut [f64]) {
        self.active.price(mesh, batch, prices);
        // One of the batch is checked, another one each time.
        let mut n_checked = lock(&self.n_checked);
        let at = (*n_checked * 7) % batch.len();
        let mut expected = [0.0];
        self.whole.price(mesh, Batch::new(&batch.proposals[at..=at]), &mut expected);
        assert_eq!(
            prices[at], expected[0],
            "price {} of {:?}",
            *n_checked, batch.proposals[at].contraction
        );
        *n_checked += 1;
    }

    fn collapsed(&mut self, mesh: &WorkingMesh, collapse: &Collapse) {
        self.active.collapsed(mesh, collapse);
        self.whole.collapsed(mesh, collapse);
    }

    fn reach(&self) -> Reach {
        self.active.reach()
    }

    fn renewal(&self) -> Renewal {
        self.active.renewal()
    }
}

pub const SMALL: ImageOptions = ImageOptions {
    cameras: CameraSet::Fibonacci(3),
    resolution: 64,
    sides: Sides::Both,
    albedo: Albedo::White,
    is_lit: true,
    background: 90,
    areas: Areas::Active,
    renewal: Renewal::Lazy,
};

pub fn halve(mesh: &TriMesh, cost: &mut dyn Cost, placement: &mut dyn Placement) -> TriMesh {
    halve_with(mesh, cost, placement, Seams::Kept)
}

pub fn halve_with(
    mesh: &TriMesh,
    cost: &mut dyn Cost,
    placement: &mut dyn Placement,
    seams: Seams,
) -> TriMesh {
    let stop = Stop { ratio: Some(0.5), ..Stop::default() };
    let options = SimplifyOptions { stop, seams, ..SimplifyOptions::DEFAULT };
    simplify(mesh, cost, placement, options, Control::none()).unwrap().mesh
}

/// The picture of a mesh by the plain rasterizer.
fn draw(mesh: &TriMesh, lens: &Lens, sides: Sides, background: u8) -> Vec<u8> {
    let seen = Visible::new(mesh, lens, sides);
    let value = |&face: &u32| {
        if face == NO_FACE {
            return background;
        }
        let corners = mesh.corners(FaceId(face));
        let normal = normal(corners);
        // Which side is seen follows from the sides' rule: only the lit one is not black here.
        let front = luminance(normal, lens.camera.forward, FaceSide::Front);
        front.max(luminance(normal, lens.camera.forward, FaceSide::Back))
    };
    seen.faces.iter().map(value).collect()
}

/// The picture of a camera after all collapses.
pub fn picture<D: Difference>(cost: &ImageDriven<D>, camera: usize) -> Picture {
    let mut scratch = Scratch::default();
    let watched = &mut *lock(&cost.cameras[camera]);
    let (mesh, changes) = (None, &[][..]);
    CameraWork { cost, watched, scratch: &mut scratch, mesh, changes }.with_simd(pulp::Scalar);
    watched.view.picture.clone()
}

pub fn small_vase() -> TriMesh {
    vase(&VaseOptions { segments: 12, profile_segments: 18, ..VaseOptions::DEFAULT })
}

#[test]
fn active_areas_price_as_whole_pictures_do() {
    let mesh = small_vase();
    for sides in [Sides::Front, Sides::Both] {
        let options = ImageOptions { sides, ..SMALL };
        let mut cost = Checked::new(&mesh, Squares, options);
        halve(&mesh, &mut cost, &mut Optimal::default());
        assert!(*lock(&cost.n_checked) > 100);
        let mut cost = Checked::new(&mesh, Structure::default(), options);
        halve(&mesh, &mut cost, &mut Endpoint);
        assert!(*lock(&cost.n_checked) > 100);
    }
}

#[test]
fn a_face_that_merges_is_priced_as_the_mesh_without_it_is_drawn() {
    let mesh = small_vase();
    let mut n_seen = 0;
    for face in (0..mesh.faces.len() as u32).step_by(20).map(FaceId) {
        let [kept, gone, third] = mesh.faces[face.idx()];
        let mut merged = mesh.clone();
        // A face that names a vertex twice covers no pixel.
        for v in merged.faces.iter_mut().flatten().filter(|v| [gone, third].contains(v)) {
            *v = kept;
        }
        merged.positions[kept.idx()] *= 1.2;
        let place = merged.positions[kept.idx()];
        let mut cost = ImageDriven::new(&mesh, Squares, SMALL);
        let found = trial::face_price(&mesh, face, place, &mut cost);
        let drawn = |mesh: &TriMesh, lens: &Lens| draw(mesh, lens, SMALL.sides, SMALL.background);
        let growth = cost.lenses.iter().map(|lens| {
            let pixels = drawn(&mesh, lens).into_iter().zip(drawn(&merged, lens));
            pixels.map(|(a, b)| i64::from(a.abs_diff(b)).pow(2)).sum::<i64>()
        });
        let growth = growth.sum();
        assert_eq!(found, Squares.price(growth, cost.lenses.len(), SMALL.resolution));
        n_seen += usize::from(growth > 1000);
    }
    assert!(n_seen > 5, "{n_seen}");
}

#[test]
fn pictures_stay_those_of_the_mesh() {
    let mesh = small_vase();
    for sides in [Sides::Front, Sides::Both] {
        let options = ImageOptions { sides, ..SMALL };
        let mut cost = ImageDriven::new(&mesh, Squares, options);
        let lenses = cost.lenses.clone();
        let result = halve(&mesh, &mut cost, &mut Optimal::default());
        for (camera, lens) in lenses.iter().enumerate() {
            let picture = &picture(&cost, camera);
            assert!(picture.original == draw(&mesh, lens, sides, 90), "original, {camera}");
            assert!(picture.now == draw(&result, lens, sides, 90), "result, {camera}");
        }
    }
}

#[test]
fn a_smaller_margin_gives_other_prices() {
    let mesh = small_vase();
    let state_price = |margin| {
        let mut cost = ImageDriven::new(&mesh, Structure { margin }, SMALL);
        halve(&mesh, &mut cost, &mut Endpoint)
    };
    assert_eq!(state_price(5), state_price(64));
    assert_ne!(state_price(5), state_price(0));
}

#[test]
fn a_mesh_in_no_picture_has_prices_of_zero() {
    let mut point = small_vase();
    point.positions.fill(DVec3::ONE);
    let mut cost = ImageDriven::new(&point, Squares, SMALL);
    assert!(cost.lenses.is_empty());
    let stop = Stop { ratio: Some(0.5), cost: Some(0.0), ..Stop::default() };
    let options = SimplifyOptions { stop, turns: Turns::Any, ..SimplifyOptions::DEFAULT };
    let found = simplify(&point, &mut cost, &mut Endpoint, options, Control::none()).unwrap();
    assert_eq!(found.statistics.largest_cost, Some(0.0));
}

/// Proposes places all over space: near, behind the cameras, far away.
struct Anywhere;

impl Placement for Anywhere {
    fn propose(&self, mesh: &WorkingMesh, batch: &[Contraction], out: &mut Candidates) {
        for (at, ends) in batch.iter().enumerate() {
            let from = mesh.position(ends.kept);
            let toward = from.cross(mesh.position(ends.gone)).normalize_or(DVec3::Y);
            let far = [0.01, 0.3, 3.0, 40.0, 1e7, 1e300][ends.gone.idx() % 6];
            out.push(at, from + far * toward);
        }
    }
}

#[test]
fn surfaces_behind_the_cameras_price_as_in_whole_pictures() {
    let mesh = small_vase();
    let stop = Stop { ratio: Some(0.7), ..Stop::default() };
    let options = SimplifyOptions { stop, turns: Turns::Any, ..SimplifyOptions::DEFAULT };
    for sides in [Sides::Front, Sides::Both] {
        let mut cost = Checked::new(&mesh, Squares, ImageOptions { sides, ..SMALL });
        simplify(&mesh, &mut cost, &mut Anywhere, options, Control::none()).unwrap();
        assert!(*lock(&cost.n_checked) > 50);
    }
}

#[test]
fn odd_meshes_are_simplified() {
    let broken = |change: &dyn Fn(&mut TriMesh)| {
        let mut mesh = small_vase();
        change(&mut mesh);
        mesh
    };
    let meshes = [
        broken(&|mesh| mesh.positions[7] = DVec3::NAN),
        broken(&|mesh| mesh.positions[7] = DVec3::splat(1e300)),
        broken(&|mesh| mesh.positions[7] = DVec3::INFINITY),
        broken(&|mesh| mesh.positions.iter_mut().for_each(|p| *p *= 1e-300)),
        broken(&|mesh| mesh.positions.iter_mut().for_each(|p| p.y = 0.0)),
        broken(&|mesh| mesh.faces.truncate(1)),
        broken(&|mesh| mesh.faces.clear()),
        broken(&|mesh| mesh.faces.iter_mut().step_by(3).for_each(|face| face.swap(0, 1))),
        broken(&|mesh| mesh.faces.extend_from_within(..)),
    ];
    for mesh in &meshes {
        let result = halve(mesh, &mut ImageDriven::new(mesh, Squares, SMALL), &mut Endpoint);
        assert!(result.faces.len() <= mesh.faces.len());
        let mut cost = ImageDriven::new(mesh, Structure::default(), SMALL);
        halve(mesh, &mut cost, &mut Optimal::default());
    }
}

/// Faces that look toward the axis of a vase: its inner wall.
fn n_inner(mesh: &TriMesh) -> usize {
    let looks_in = |face: &usize| {
        let [a, b, c] = mesh.corners(FaceId(*face as u32));
        let outward = (a + b + c) * DVec3::new(1.0, 1.0, 0.0);
        normal([a, b, c]).dot(outward) < 0.0
    };
    (0..mesh.faces.len()).filter(looks_in).count()
}

#[test]
fn what_is_hidden_is_simplified_first() {
    let mesh = vase(&VaseOptions { segments: 24, profile_segments: 40, ..VaseOptions::DEFAULT });
    let options = ImageOptions { sides: Sides::Front, resolution: 96, ..SMALL };
    let mut cost = ImageDriven::new(&mesh, Squares, options);
    let result = halve(&mesh, &mut cost, &mut Endpoint);
    let share = |mesh: &TriMesh| n_inner(mesh) as f64 / mesh.faces.len() as f64;
    let (before, after) = (share(&mesh), share(&result));
    assert!(before > 0.3, "{before}");
    assert!(after < 0.7 * before, "{before} before, {after} after");
    // Vertices stay on the walls: they are vertices of the original.
    assert!(result.positions.iter().all(|position| mesh.positions.contains(position)));
}

/// Merges the corners of one face in two steps, and compares what they were together with what was
/// proposed for all three.
struct InTwoSteps {
    corners: [VertexId; 3],
    place: DVec3,
    /// The face contraction as proposed, by the corner that stays.
    proposed: Vec<Change>,
    faces: Vec<[u32; 3]>,
    first: Option<(VertexId, Vec<DyingFace>)>,
    places: [DVec3; 3],
    n_compared: usize,
}

impl Cost for InTwoSteps {
    fn begin(&mut self, mesh: &WorkingMesh, _: Control) -> Result<(), Cancelled> {
        let face = mesh.face_ids().find(|&face| mesh.input_face(face) == FaceId(200)).unwrap();
        self.corners = mesh.face(face).unwrap();
        self.places = self.corners.map(|v| mesh.position(v));
        self.place = self.places.iter().sum::<DVec3>() / 3.0;
        self.faces = mesh.face_ids().map(|f| mesh.face(f).unwrap().map(|v| v.0)).collect();
        let [a, b, c] = self.corners;
        self.proposed = [[a, b, c], [b, c, a], [c, a, b]]
            .map(|[kept, gone, third]| {
                let (also_gone, quadric) = (Some(third), Default::default());
                let contraction =
                    Contraction { kept, gone, also_gone, quadric, volume_plane: None };
                let proposal = Proposal { contraction, position: self.place, attributes: None };
                Change::proposed(mesh, &proposal)
            })
            .into();
        Ok(())
    }

    fn price(&self, _: &WorkingMesh, batch: Batch, prices: &mut [f64]) {
        for (price, proposal) in prices.iter_mut().zip(batch) {
            let is_among = proposal.contraction.vertices().all(|v| self.corners.contains(&v));
            *price = if is_among { 1.0 } else { f64::NAN };
        }
    }

    fn collapsed(&mut self, mesh: &WorkingMesh, collapse: &Collapse) {
        let Some((also_gone, mut dying)) = self.first.take() else {
            self.first = Some((collapse.gone, collapse.dying_faces.to_vec()));
            return;
        };
        dying.extend_from_slice(collapse.dying_faces);
        let place = |v| self.places[self.corners.iter().position(|&w| w == v).unwrap()];
        let before = [collapse.kept, collapse.gone, also_gone].map(place);
        let also_gone = Some(also_gone);
        let whole = Collapse { also_gone, before, dying_faces: &dying, ..*collapse };
        assert!(self.corners.iter().all(|&v| whole.has(v)));
        let made = Change::made(mesh, &whole, |face| self.faces[face as usize]);
        let proposed = self.proposed.iter().find(|change| change.kept == collapse.kept.0).unwrap();
        assert_eq!((made.position, &made.ring), (proposed.position, &proposed.ring));
        assert_eq!((made.old, made.new), (proposed.old.clone(), proposed.new.clone()));
        self.n_compared += 1;
    }
}

/// The middle of the face.
struct InTheMiddle(DVec3);

impl Placement for InTheMiddle {
    fn propose(&self, _: &WorkingMesh, batch: &[Contraction], out: &mut Candidates) {
        (0..batch.len()).for_each(|at| out.push(at, self.0));
    }
}

#[test]
fn a_face_that_merged_changed_what_was_proposed() {
    let mesh = small_vase();
    let place = mesh.corners(FaceId(200)).iter().sum::<DVec3>() / 3.0;
    let (faces, places) = (Vec::new(), [DVec3::ZERO; 3]);
    let corners = [VertexId(0); 3];
    let (proposed, first, n_compared) = (Vec::new(), None, 0);
    let mut cost = InTwoSteps { corners, place, proposed, faces, first, places, n_compared };
    let stop = Stop { faces: Some(mesh.faces.len() - 4), ..Stop::default() };
    let options = SimplifyOptions { stop, turns: Turns::Any, ..SimplifyOptions::DEFAULT };
    simplify(&mesh, &mut cost, &mut InTheMiddle(place), options, Control::none()).unwrap();
    assert_eq!(cost.n_compared, 1);
}
