//! Asks a cost or a placement about every edge of a mesh, for their tests.

use glam::DVec3;
use mve_core::Control;
use mve_mesh::data::{FaceId, TriMesh};

use super::marks::VertexMarks;
use super::options::Seams;
use super::origin::Origin;
use super::quadrics::{Planes, Quadrics};
use super::ticker::Ticker;
use super::{
    Batch, Candidates, Contraction, Cost, Placement, Proposal, QuadricOptions, WorkingMesh,
};

fn working(mesh: &TriMesh, quadrics: Option<QuadricOptions>) -> (WorkingMesh, Vec<Contraction>) {
    let mut ticker = Ticker::new(Control::none());
    let mut marks = VertexMarks::new(mesh.positions.len());
    let mut working = WorkingMesh::new(mesh, Seams::Free, &mut marks, &mut ticker).unwrap();
    if let Some(options) = quadrics {
        let planes = Planes { options, is_weighted: true, is_seam: &[], origin: Origin::Whole };
        let sum = Quadrics::sum(&working.complex, &working.order, planes, &mut ticker);
        working.quadrics = sum.unwrap();
    }
    let edges = working.edges();
    let contractions = edges.iter().map(|&edge| working.contraction(edge)).collect();
    (working, contractions)
}

/// The ends of a contraction as the input numbers them, the lower one first.
fn ends(mesh: &WorkingMesh, contraction: &Contraction) -> [u32; 2] {
    let mut ends = [contraction.kept, contraction.gone].map(|v| mesh.input_vertex(v).0);
    ends.sort_unstable();
    ends
}

/// The two ends and the least price of each edge before the first collapse, by their ids.
pub(crate) fn first_prices(
    mesh: &TriMesh,
    cost: &mut dyn Cost,
    placement: &mut dyn Placement,
) -> Vec<(u32, u32, f64)> {
    let (working, contractions) = working(mesh, cost.quadrics().or(placement.quadrics()));
    cost.begin(&working, Control::none()).unwrap();
    let mut prices: Vec<_> = contractions
        .iter()
        .map(|contraction| {
            let mut candidates = Candidates::default();
            let mut proposals = Vec::new();
            candidates.reset(1);
            placement.propose(&working, &[*contraction], &mut candidates);
            candidates.list_proposals(&[*contraction], &mut proposals);
            let mut prices = vec![f64::NAN; proposals.len()];
            cost.price(&working, candidates.batch(&proposals), &mut prices);
            let [from, to] = ends(&working, contraction);
            (from, to, prices.into_iter().fold(f64::INFINITY, f64::min))
        })
        .collect();
    prices.sort_unstable_by_key(|&(from, to, _)| (from, to));
    prices
}

/// The two ends of each edge and the places that are proposed before the first collapse.
pub(crate) fn first_places(
    mesh: &TriMesh,
    placement: &mut dyn Placement,
) -> Vec<(u32, u32, Vec<DVec3>)> {
    let (working, contractions) = working(mesh, placement.quadrics());
    let mut candidates = Candidates::default();
    let mut proposals = Vec::new();
    candidates.reset(contractions.len());
    placement.propose(&working, &contractions, &mut candidates);
    candidates.list_proposals(&contractions, &mut proposals);
    let mut places: Vec<_> = contractions
        .iter()
        .map(|contraction| {
            let [from, to] = ends(&working, contraction);
            let of_edge = proposals.iter().filter(|proposal| proposal.contraction == *contraction);
            (from, to, of_edge.map(|proposal| proposal.position).collect())
        })
        .collect();
    places.sort_unstable_by_key(|(from, to, _)| (*from, *to));
    places
}

/// The contraction of a face of the input, before the first collapse.
fn contraction_of(mesh: &WorkingMesh, face: FaceId) -> Contraction {
    let face = mesh.face_ids().find(|&own| mesh.input_face(own) == face).unwrap();
    let [kept, gone, third] = mesh.face(face).unwrap();
    let mut quadric = mesh.quadric(kept);
    for v in [gone, third] {
        quadric.add(&mesh.quadric(v).shifted(mesh.position(kept) - mesh.position(v)));
    }
    Contraction { kept, gone, also_gone: Some(third), quadric, volume_plane: None }
}

/// The price of merging the corners of a face at a place.
pub(crate) fn face_price(
    mesh: &TriMesh,
    face: FaceId,
    position: DVec3,
    cost: &mut dyn Cost,
) -> f64 {
    let (working, _) = working(mesh, cost.quadrics());
    cost.begin(&working, Control::none()).unwrap();
    let contraction = contraction_of(&working, face);
    let proposal = Proposal { contraction, position, attributes: None };
    let mut prices = [f64::NAN];
    cost.price(&working, Batch::new(&[proposal]), &mut prices);
    prices[0]
}

/// The places that are proposed for merging the corners of a face, along the space-filling curve.
pub(crate) fn face_places(
    mesh: &TriMesh,
    face: FaceId,
    placement: &mut dyn Placement,
) -> Vec<DVec3> {
    let (working, _) = working(mesh, placement.quadrics());
    let contraction = [contraction_of(&working, face)];
    let mut candidates = Candidates::default();
    let mut proposals = Vec::new();
    candidates.reset(1);
    placement.propose(&working, &contraction, &mut candidates);
    candidates.list_proposals(&contraction, &mut proposals);
    proposals.iter().map(|proposal| proposal.position).collect()
}
