//! The inverse of a run, from what an observer is told; and values that a placement gives.

use glam::{DVec2, DVec3};
use mve_mesh::data::{Domain, FaceId, Layer, LayerValues, NO_VALUE, VertexId};

use super::tests::{grid, textured, to_faces};
use super::*;
use crate::cost::Quadric;
use crate::placement::Optimal;

/// What it takes to undo a collapse, as an observer may keep it.
struct Split {
    kept: VertexId,
    gone: VertexId,
    before: [DVec3; 3],
    sides: [Option<VertexId>; 2],
    dying_faces: Vec<DyingFace>,
    moved_corners: Vec<MovedCorner>,
    wedges: Vec<WedgeChange>,
}

/// The working mesh as an observer knows it, in the engine's ids.
#[derive(Default)]
struct Recorder {
    splits: Vec<Split>,
    positions: Vec<DVec3>,
    faces: Vec<Option<[VertexId; 3]>>,
    /// The value of each corner in the first layer, by face.
    values: Vec<CornerValues>,
    input_vertices: Vec<VertexId>,
    input_faces: Vec<FaceId>,
}

const TEXCOORD: LayerId = LayerId(0);

/// The value of each corner of a face, if it has one.
type CornerValues = [Option<DVec3>; 3];

fn corner_values(mesh: &WorkingMesh, face: FaceId) -> CornerValues {
    let wedge = |k| mesh.wedge_of_corner(face, k, TEXCOORD);
    [0, 1, 2].map(|k| wedge(k).map(|wedge| mesh.value(wedge, TEXCOORD)))
}

impl Observer for Recorder {
    fn begin(&mut self, mesh: &WorkingMesh) {
        let vertices = (0..mesh.n_vertices() as u32).map(VertexId);
        self.input_vertices = vertices.map(|v| mesh.input_vertex(v)).collect();
        self.input_faces = mesh.face_ids().map(|f| mesh.input_face(f)).collect();
    }

    fn collapsed(&mut self, mesh: &WorkingMesh, collapse: &Collapse) {
        assert_eq!(mesh.position(collapse.kept), collapse.position);
        self.splits.push(Split {
            kept: collapse.kept,
            gone: collapse.gone,
            before: collapse.before,
            sides: [collapse.vl(), collapse.vr()],
            dying_faces: collapse.dying_faces.to_vec(),
            moved_corners: collapse.moved_corners.to_vec(),
            wedges: collapse.wedges.to_vec(),
        });
    }

    fn finished(&mut self, mesh: &WorkingMesh) {
        let vertices = (0..mesh.n_vertices() as u32).map(VertexId);
        self.positions = vertices.map(|v| mesh.position(v)).collect();
        let faces = || (0..self.input_faces.len() as u32).map(FaceId);
        self.faces = faces().map(|f| mesh.face(f)).collect();
        self.values = faces().map(|f| corner_values(mesh, f)).collect();
    }
}

impl Recorder {
    /// Undoes the last collapse.
    fn undo(&mut self) -> bool {
        let Some(split) = self.splits.pop() else { return false };
        self.positions[split.kept.idx()] = split.before[0];
        self.positions[split.gone.idx()] = split.before[1];
        for MovedCorner { face, k, was_at } in split.moved_corners {
            let corners = self.faces[face.idx()].as_mut().unwrap();
            assert_eq!(std::mem::replace(&mut corners[k], was_at), split.kept);
        }
        for DyingFace { face, vertices } in split.dying_faces {
            assert_eq!(self.faces[face.idx()].replace(vertices), None);
        }
        for change in split.wedges.iter().filter(|change| change.layer == TEXCOORD) {
            let Element::Corner(face, k) = change.element else { panic!("a layer over corners") };
            self.values[face.idx()][k] = change.before.map(|(_, value)| value);
        }
        true
    }

    #[allow(clippy::type_complexity)] // Positions, faces and values, each once.
    /// The mesh in the input's ids, with the value of each corner.
    fn mesh(&self) -> (Vec<DVec3>, Vec<[VertexId; 3]>, Vec<CornerValues>) {
        let mut positions = vec![DVec3::NAN; self.positions.len()];
        for (&p, input) in self.positions.iter().zip(&self.input_vertices) {
            positions[input.idx()] = p;
        }
        let mut faces = vec![([VertexId(0); 3], [None; 3]); self.faces.len()];
        for ((face, values), input) in self.faces.iter().zip(&self.values).zip(&self.input_faces) {
            faces[input.idx()] = (face.unwrap().map(|v| self.input_vertices[v.idx()]), *values);
        }
        let (faces, values) = faces.into_iter().unzip();
        (positions, faces, values)
    }
}

#[test]
fn a_recorded_run_is_undone_to_the_last_bit() {
    for seams in [Seams::Kept, Seams::Free] {
        let mut mesh = textured();
        mesh.layers[0].index[7] = NO_VALUE;
        let mut recorder = Recorder::default();
        let (mut cost, mut placement) = (Quadric::default(), Optimal::default());
        let options = SimplifyOptions { seams, ..to_faces(20) };
        let mut observers: [&mut dyn Observer; 1] = [&mut recorder];
        let (cost, placement): (&mut dyn Cost, &mut dyn Placement) = (&mut cost, &mut placement);
        let control = Control::none();
        let result = simplify_observed(&mesh, cost, placement, &mut observers, options, control);
        assert!(result.unwrap().statistics.n_collapses > 30);
        // A collapse inside the surface has both sides, one at the border has one of them.
        let n_sides = |split: &Split| split.sides.iter().flatten().count();
        assert!(recorder.splits.iter().all(|split| n_sides(split) == split.dying_faces.len()));
        assert!(recorder.splits.iter().any(|split| n_sides(split) == 2));
        while recorder.undo() {}
        let (positions, faces, values) = recorder.mesh();
        let bits = |list: &[DVec3]| -> Vec<_> {
            list.iter().flat_map(|p| p.to_array()).map(f64::to_bits).collect()
        };
        assert_eq!(bits(&positions), bits(&mesh.positions));
        assert_eq!(faces, mesh.faces);
        let LayerValues::Vec2(input) = &mesh.layers[0].values else { panic!("Vec2") };
        let expected = mesh.layers[0].index.iter().map(|&i| input.get(i as usize));
        let found = values.iter().flatten();
        assert!(found.eq(&expected.map(|v| v.map(|v| v.extend(0.0))).collect::<Vec<_>>()));
    }
}

/// Proposes the middle of the edge, with texture coordinates that are those of the place where the
/// surface is parametrized by `x² / 64, y / 8`: no interpolation finds them.
struct Exact;

impl Placement for Exact {
    fn propose(&self, mesh: &WorkingMesh, batch: &[Contraction], out: &mut Candidates) {
        for (at, Contraction { kept, gone, .. }) in batch.iter().enumerate() {
            let position = mesh.position(*kept).midpoint(mesh.position(*gone));
            let value = curved(position).extend(0.0);
            let wedges = mesh.wedges_around(*kept, TEXCOORD);
            let values: Vec<_> =
                wedges.map(|wedge| AttributeValue { layer: TEXCOORD, wedge, value }).collect();
            out.push_with(at, position, &values);
        }
    }
}

fn curved(p: DVec3) -> DVec2 {
    DVec2::new(p.x * p.x / 64.0, p.y / 8.0)
}

/// The same without values.
struct Interpolated;

impl Placement for Interpolated {
    fn propose(&self, mesh: &WorkingMesh, batch: &[Contraction], out: &mut Candidates) {
        for (at, Contraction { kept, gone, .. }) in batch.iter().enumerate() {
            out.push(at, mesh.position(*kept).midpoint(mesh.position(*gone)));
        }
    }
}

/// The length of the edge, for proposals that must have so many values.
struct LengthCost {
    n_values: usize,
}

impl Cost for LengthCost {
    fn price(&self, mesh: &WorkingMesh, batch: Batch, prices: &mut [f64]) {
        for (price, proposal) in prices.iter_mut().zip(batch) {
            let [kept, gone] = [proposal.contraction.kept, proposal.contraction.gone];
            assert_eq!(batch.attributes(proposal).len(), self.n_values);
            *price = mesh.position(kept).distance(mesh.position(gone));
        }
    }
}

#[test]
fn values_of_a_proposal_are_taken_and_others_interpolated() {
    let mut mesh = grid(8, |x, y| 0.3 * (x * 0.5).sin() + 0.2 * (y * 0.8).cos());
    let values = mesh.positions.iter().map(|&p| curved(p)).collect();
    let index = mesh.faces.iter().flatten().map(|v| v.0).collect();
    mesh.layers = vec![Layer {
        name: Layer::TEXCOORD.into(),
        domain: Domain::Corner,
        values: LayerValues::Vec2(values),
        index,
    }];
    let error = |placement: &mut dyn Placement, n_values| {
        let control = Control::none();
        let (mut cost, options) = (LengthCost { n_values }, to_faces(50));
        let result = simplify(&mesh, &mut cost, placement, options, control).unwrap().mesh;
        assert!(result.faces.len() <= 50);
        let LayerValues::Vec2(values) = &result.layers[0].values else { panic!("Vec2") };
        let corners = result.faces.iter().flatten().zip(&result.layers[0].index);
        let errors = corners
            .map(|(v, &value)| values[value as usize].distance(curved(result.positions[v.idx()])));
        errors.fold(0.0, f64::max)
    };
    assert_eq!(error(&mut Exact, 1), 0.0);
    assert!(error(&mut Interpolated, 0) > 0.001);
}
