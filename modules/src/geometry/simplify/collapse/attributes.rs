//! What happens to attribute layers when vertices merge.
//!
//! When an edge collapses, each face that dies says which wedge of one end meets which of the
//! other; the two become one, interpolated by where the new vertex lies along the edge. A wedge
//! that no dying face touches keeps its value. What vertices and faces share is called a wedge
//! here, too: the number of a value in its layer.
//!
//! What a layer means is its [`Role`], by name. The seams of texture coordinates must not tear:
//! under [`Seams::Kept`] a vertex stays where it is when a wedge of it would have no partner, and
//! two such vertices do not merge. So charts keep their borders, which simplify only along
//! themselves.

use std::collections::HashMap;

use glam::DVec3;
use mve_core::Cancelled;

use super::complex::{Complex, next_in_face, previous_in_face};
use super::merging::Merging;
use super::options::Seams;
use super::order::Order;
use super::ticker::{CHUNK, Ticker};
use super::wedge::{AttributeValue, LayerId, Role, WedgeId};
use crate::data::{Domain, Layer, LayerValues, NO_VALUE, TriMesh};
use crate::mesh::adjacency::EdgeId;

/// A layer of the working mesh. Every kind of value is held as three numbers.
#[derive(Debug)]
pub(super) struct WorkingLayer {
    pub role: Role,
    pub domain: Domain,
    /// The wedge of each vertex, corner or face of the engine; [`NO_VALUE`] where it has none.
    wedges: Vec<u32>,
    values: Vec<DVec3>,
}

/// All layers of the working mesh, in the input's order.
#[derive(Debug, Default)]
pub(super) struct Attributes {
    pub layers: Vec<WorkingLayer>,
    /// Whether each vertex has several wedges in a layer whose seams are kept; empty when there
    /// is no such layer.
    on_seam: Vec<bool>,
    merging: Merging,
}

/// What seams leave to a collapse.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SeamRule {
    Anywhere,
    OnlyAtKept,
    OnlyAtGone,
    Nowhere,
}

impl Attributes {
    pub fn new(
        mesh: &TriMesh,
        complex: &Complex,
        order: &Order,
        seams: Seams,
        ticker: &mut Ticker,
    ) -> Result<Self, Cancelled> {
        let new = |layer| WorkingLayer::new(layer, complex, order, ticker);
        let layers = mesh.layers.iter().map(new).collect::<Result<Vec<_>, _>>()?;
        let mut on_seam = Vec::new();
        for layer in layers.iter().filter(|layer| seams == Seams::Kept && layer.has_seams()) {
            on_seam.resize(complex.vertices.len(), false);
            for (vertex, is_on_seam) in on_seam.iter_mut().enumerate() {
                if vertex.is_multiple_of(CHUNK) {
                    ticker.tick(0)?;
                }
                let mut wedges = complex.corners_around(vertex as u32).map(|c| layer.wedge_at(c));
                if let Some(first) = wedges.next() {
                    *is_on_seam |= wedges.any(|wedge| wedge != first);
                }
            }
        }
        Ok(Self { layers, on_seam, merging: Merging::default() })
    }

    /// Whether there are seams that are kept.
    #[inline]
    pub fn have_seams(&self) -> bool {
        !self.on_seam.is_empty()
    }

    /// Whether each edge lies on a seam that is kept; empty when there is no such seam.
    pub fn seam_edges(
        &self,
        complex: &Complex,
        ticker: &mut Ticker,
    ) -> Result<Vec<bool>, Cancelled> {
        let mut is_seam = Vec::new();
        for layer in
            self.layers.iter().filter(|layer| !self.on_seam.is_empty() && layer.has_seams())
        {
            is_seam.resize(complex.edges.len(), false);
            let mut seen = ticker.fill(complex.edges.len(), None)?;
            for corner in 0..3 * complex.faces.len() as u32 {
                if (corner as usize).is_multiple_of(3 * CHUNK) {
                    ticker.tick(0)?;
                }
                if complex.face_at(corner).is_dead() {
                    continue;
                }
                let edge = complex.edge_at(corner).idx();
                let other = next_in_face(corner);
                let mut wedges = [layer.wedge_at(corner), layer.wedge_at(other)];
                if complex.vertex_at(corner) > complex.vertex_at(other) {
                    wedges.swap(0, 1);
                }
                is_seam[edge] |= *seen[edge].get_or_insert(wedges) != wedges;
            }
        }
        Ok(is_seam)
    }

    /// Where the ends of an edge may merge.
    pub fn seam_rule(&self, complex: &Complex, edge: EdgeId) -> SeamRule {
        let [kept, gone] = complex.ends(edge);
        let is_on_seam = |v: u32| self.on_seam.get(v as usize).copied().unwrap_or(false);
        if !is_on_seam(kept) && !is_on_seam(gone) {
            return SeamRule::Anywhere;
        }
        let (mut pins_kept, mut pins_gone) = (false, false);
        let mut pairs = Vec::new();
        for layer in self.layers.iter().filter(|layer| layer.has_seams()) {
            layer.find_pairs(complex, [kept, gone], &mut pairs);
            let is_paired =
                |wedge, of: fn(&(u32, u32)) -> u32| pairs.iter().any(|p| of(p) == wedge);
            pins_kept |=
                complex.corners_around(kept).any(|c| !is_paired(layer.wedge_at(c), |p| p.0));
            pins_gone |=
                complex.corners_around(gone).any(|c| !is_paired(layer.wedge_at(c), |p| p.1));
            // A seam that ends here ends in the wedge that meets both of its sides.
            for (i, p) in pairs.iter().enumerate() {
                pins_kept |= pairs[..i].iter().any(|q| q.0 == p.0 && q.1 != p.1);
                pins_gone |= pairs[..i].iter().any(|q| q.1 == p.1 && q.0 != p.0);
            }
        }
        match (pins_kept, pins_gone) {
            (false, false) => SeamRule::Anywhere,
            (true, false) => SeamRule::OnlyAtKept,
            (false, true) => SeamRule::OnlyAtGone,
            (true, true) => SeamRule::Nowhere,
        }
    }

    /// Mixes the values at the ends of an edge that is about to merge at `position`. A wedge that
    /// `given` names takes the value from there.
    pub fn merge(
        &mut self,
        complex: &Complex,
        edge: EdgeId,
        position: DVec3,
        given: &[AttributeValue],
    ) {
        if self.layers.is_empty() {
            return;
        }
        let [kept, gone] = complex.ends(edge);
        if let Ok([kept, gone]) = self.on_seam.get_disjoint_mut([kept as usize, gone as usize]) {
            *kept |= *gone;
        }
        let Self { layers, merging, .. } = self;
        for (id, layer) in (0u32..).zip(layers) {
            if layer.domain != Domain::Face {
                layer.find_merging(LayerId(id), complex, [kept, gone], position, given, merging);
                layer.apply(complex, [kept, gone], merging);
            }
        }
    }

    /// The layers of the result. `vertices` and `faces` name the engine's id of each vertex and
    /// face of the result.
    pub fn into_layers(
        self,
        mesh: &TriMesh,
        vertices: &[u32],
        faces: &[u32],
        ticker: &mut Ticker,
    ) -> Result<Vec<Layer>, Cancelled> {
        let finish = |(working, input): (WorkingLayer, &Layer)| {
            let corners = || faces.iter().flat_map(|&f| [3 * f, 3 * f + 1, 3 * f + 2]);
            match working.domain {
                Domain::Vertex => working.finish(input, vertices, ticker),
                Domain::Corner => working.finish(input, &corners().collect::<Vec<_>>(), ticker),
                Domain::Face => working.finish(input, faces, ticker),
            }
        };
        self.layers.into_iter().zip(&mesh.layers).map(finish).collect()
    }
}

impl WorkingLayer {
    fn new(
        layer: &Layer,
        complex: &Complex,
        order: &Order,
        ticker: &mut Ticker,
    ) -> Result<Self, Cancelled> {
        let (role, domain) = (Role::of(layer), layer.domain);
        let mut working = Self { role, domain, wedges: Vec::new(), values: Vec::new() };
        match layer.domain {
            Domain::Vertex => {
                let values = &mut working.values;
                working.wedges =
                    ticker.collect(&order.vertices, |&v| values.add(layer, v as usize))?;
            }
            Domain::Face => {
                let values = &mut working.values;
                working.wedges =
                    ticker.collect(&order.faces, |&f| values.add(layer, f as usize))?;
            }
            Domain::Corner => working.make_wedges(layer, complex, order, ticker)?,
        }
        Ok(working)
    }

    /// Gives each group of corners of a vertex with equal values a wedge of its own. Files that
    /// write each value once for each corner have seams only where values differ.
    fn make_wedges(
        &mut self,
        layer: &Layer,
        complex: &Complex,
        order: &Order,
        ticker: &mut Ticker,
    ) -> Result<(), Cancelled> {
        self.wedges = ticker.fill(3 * complex.faces.len(), NO_VALUE)?;
        let mut corners = Vec::new();
        for vertex in 0..complex.vertices.len() as u32 {
            if (vertex as usize).is_multiple_of(CHUNK) {
                ticker.tick(0)?;
            }
            corners.clear();
            corners.extend(complex.corners_around(vertex).map(|corner| {
                let input = 3 * order.faces[corner as usize / 3] + corner % 3;
                let value = value_of(layer, input as usize);
                (value.map(|value| value.to_array().map(f64::to_bits)), corner, input)
            }));
            corners.sort_unstable();
            let mut last = (None, NO_VALUE);
            for &(value, corner, input) in &corners {
                if value != last.0 {
                    last = (value, self.values.add(layer, input as usize));
                }
                self.wedges[corner as usize] = last.1;
            }
        }
        Ok(())
    }

    fn has_seams(&self) -> bool {
        self.domain == Domain::Corner && self.role == Role::TexCoord
    }

    /// The wedge of an element, or [`NO_VALUE`].
    pub fn wedge_at(&self, element: u32) -> u32 {
        self.wedges[element as usize]
    }

    /// The wedge of a vertex or corner, if it has a value.
    pub fn wedge(&self, element: u32) -> Option<WedgeId> {
        Some(self.wedge_at(element)).filter(|&wedge| wedge != NO_VALUE).map(WedgeId)
    }

    /// The value of a wedge.
    pub fn value(&self, wedge: WedgeId) -> DVec3 {
        self.values[wedge.0 as usize]
    }

    /// The wedges of the two ends that meet in a face at the edge, each pair once.
    pub fn find_pairs(
        &self,
        complex: &Complex,
        [kept, gone]: [u32; 2],
        pairs: &mut Vec<(u32, u32)>,
    ) {
        pairs.clear();
        for corner in complex.corners_around(kept) {
            let other = [next_in_face(corner), previous_in_face(corner)]
                .into_iter()
                .find(|&c| complex.vertex_at(c) == gone);
            let Some(other) = other else { continue };
            let pair = (self.wedge_at(corner), self.wedge_at(other));
            if !pairs.contains(&pair) {
                pairs.push(pair);
            }
        }
    }

    /// Finds what a merge of `kept` and `gone` at a position makes of the wedges. A wedge that
    /// `given` names takes the value from there.
    pub fn find_merging(
        &self,
        id: LayerId,
        complex: &Complex,
        [kept, gone]: [u32; 2],
        position: DVec3,
        given: &[AttributeValue],
        merging: &mut Merging,
    ) {
        let at = parameter(complex.position(kept), complex.position(gone), position);
        let given = |wedge: u32| {
            let name = (id, WedgeId(wedge));
            given.iter().find(|given| (given.layer, given.wedge) == name).map(|v| v.value)
        };
        match self.domain {
            Domain::Vertex => merging.of_vertices(self, [kept, gone], at, given),
            Domain::Corner => merging.of_corners(self, complex, [kept, gone], at, given),
            Domain::Face => *merging = Merging::default(),
        }
    }

    /// Changes the wedges.
    fn apply(&mut self, complex: &Complex, [kept, gone]: [u32; 2], merging: &Merging) {
        for &(wedge, value) in merging.values() {
            self.values[wedge as usize] = value;
        }
        if self.domain == Domain::Vertex {
            self.wedges[kept as usize] = merging.now(self.wedge_at(kept));
            return;
        }
        for corner in complex.corners_around(kept).chain(complex.corners_around(gone)) {
            self.wedges[corner as usize] = merging.now(self.wedge_at(corner));
        }
    }

    /// The value between two: the first at 0, the second at 1, bit for bit.
    pub fn mix(&self, from: DVec3, to: DVec3, at: f64) -> DVec3 {
        if at == 0.0 || from == to {
            return from;
        }
        if at == 1.0 {
            return to;
        }
        let nearer = if at > 0.5 { to } else { from };
        match self.role {
            Role::Label => nearer,
            Role::Normal => from.lerp(to, at).try_normalize().unwrap_or(nearer),
            _ => from.lerp(to, at),
        }
    }

    /// The layer of the result; values that are equal bit for bit are stored once.
    fn finish(
        self,
        input: &Layer,
        elements: &[u32],
        ticker: &mut Ticker,
    ) -> Result<Layer, Cancelled> {
        let mut numbers: HashMap<[u64; 3], u32> = HashMap::new();
        let mut values: Vec<DVec3> = Vec::new();
        let index = ticker.collect(elements, |&element| {
            let wedge = self.wedge_at(element);
            if wedge == NO_VALUE {
                return NO_VALUE;
            }
            let value = self.values[wedge as usize];
            *numbers.entry(value.to_array().map(f64::to_bits)).or_insert_with(|| {
                values.push(value);
                values.len() as u32 - 1
            })
        })?;
        let values = match &input.values {
            LayerValues::Number(_) => LayerValues::Number(values.iter().map(|v| v.x).collect()),
            LayerValues::Vec2(_) => {
                LayerValues::Vec2(values.iter().map(|v| v.truncate()).collect())
            }
            LayerValues::Vec3(_) => LayerValues::Vec3(values),
            LayerValues::Label(names) => {
                LayerValues::Label(values.iter().map(|v| names[v.x as usize].clone()).collect())
            }
        };
        Ok(Layer { name: input.name.clone(), domain: input.domain, values, index })
    }
}

/// The value of an element of a layer as three numbers.
fn value_of(layer: &Layer, element: usize) -> Option<DVec3> {
    let number = layer.index.get(element).copied().unwrap_or(NO_VALUE) as usize;
    match &layer.values {
        LayerValues::Number(v) => v.get(number).map(|&x| DVec3::new(x, 0.0, 0.0)),
        LayerValues::Vec2(v) => v.get(number).map(|p| p.extend(0.0)),
        LayerValues::Vec3(v) => v.get(number).copied(),
        LayerValues::Label(v) => v.get(number).map(|_| DVec3::new(number as f64, 0.0, 0.0)),
    }
}

/// A list of values that takes copies of those of a layer.
trait AddValue {
    /// Appends the value of an element of the layer and returns its wedge.
    fn add(&mut self, layer: &Layer, element: usize) -> u32;
}

impl AddValue for Vec<DVec3> {
    fn add(&mut self, layer: &Layer, element: usize) -> u32 {
        value_of(layer, element).map_or(NO_VALUE, |value| {
            self.push(value);
            self.len() as u32 - 1
        })
    }
}

/// Where a point lies along an edge: 0 at its start, 1 at its end, exactly so at the ends.
fn parameter(from: DVec3, to: DVec3, point: DVec3) -> f64 {
    if point == from {
        return 0.0;
    }
    if point == to {
        return 1.0;
    }
    let along = to - from;
    let at = (point - from).dot(along) / along.length_squared();
    if at.is_nan() { 0.5 } else { at.clamp(0.0, 1.0) }
}
