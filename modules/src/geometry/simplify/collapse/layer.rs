//! A layer of the working mesh: wedges and their values.

use std::collections::HashMap;

use glam::DVec3;
use mve_core::Cancelled;
use mve_mesh::data::{Domain, Layer, LayerValues, NO_VALUE};

use super::complex::{Complex, next_in_face, previous_in_face};
use super::order::Order;
use super::ticker::{CHUNK, Ticker};
use super::wedge::{Role, WedgeId};

/// See the file's header. Every kind of value is held as three numbers.
#[derive(Debug)]
pub(super) struct WorkingLayer {
    pub role: Role,
    pub domain: Domain,
    /// The wedge of each vertex, corner or face of the engine; [`NO_VALUE`] where it has none.
    wedges: Vec<u32>,
    values: Vec<DVec3>,
}

impl WorkingLayer {
    pub fn new(
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

    /// Whether its seams must not tear.
    pub fn has_seams(&self) -> bool {
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

    /// Gives a wedge a value.
    pub fn set_value(&mut self, wedge: WedgeId, value: DVec3) {
        self.values[wedge.0 as usize] = value;
    }

    /// Gives an element a wedge, or [`NO_VALUE`].
    pub fn set_wedge(&mut self, element: u32, wedge: u32) {
        self.wedges[element as usize] = wedge;
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
    pub fn finish(
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
