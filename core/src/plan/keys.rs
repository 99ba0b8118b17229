//! Keys: what a node's outputs are determined by, hashed.
//!
//! The fingerprint of a value is the key of the node that made it and the name of the port. Modules
//! are pure, so equal keys mean equal values; no value is ever hashed, and all keys of a plan are
//! known before anything runs. Paths, times and the machine enter no key.

use super::PlanNode;
use super::outputs::Names;
use crate::fingerprint::{Fingerprint, FingerprintBuilder};

/// Raised when the meaning of a key or the layout of a cached value changes.
const KEY_FORMAT: &str = "mve node 1";

/// What a node's module and parameters add to its key, in pieces: the module, then each parameter.
pub(super) struct OwnPieces(Vec<FingerprintBuilder>);

impl OwnPieces {
    pub fn of(node: &PlanNode) -> Self {
        let mut module = FingerprintBuilder::new(KEY_FORMAT);
        module.text(node.info.module.id);
        module.fingerprint(node.info.version);
        let params = (0..node.info.module.params.len()).map(|param| piece(node, param));
        Self(std::iter::once(module).chain(params).collect())
    }

    /// Brings the piece of one parameter up to date.
    pub fn renew(&mut self, node: &PlanNode, param: usize) {
        self.0[param + 1] = piece(node, param);
    }
}

fn piece(node: &PlanNode, param: usize) -> FingerprintBuilder {
    let mut piece = FingerprintBuilder::default();
    node.settings.write_key_at(param, node.info.module.params, &mut piece);
    piece
}

/// Gives every node its key. `nodes` are in running order.
pub(super) fn fill(nodes: &mut [PlanNode], names: &Names) {
    for place in 0..nodes.len() {
        nodes[place].key = key(nodes, place, &OwnPieces::of(&nodes[place]), names);
    }
}

/// The key of one node, where those of its sources are known.
pub(super) fn key(nodes: &[PlanNode], place: usize, own: &OwnPieces, names: &Names) -> Fingerprint {
    let node = &nodes[place];
    let mut key = FingerprintBuilder::default();
    own.0.iter().for_each(|piece| key.parts(piece));
    for (_, fingerprint) in &node.reads {
        key.fingerprint(*fingerprint);
    }
    for (input, source) in node.info.module.inputs.iter().zip(&node.inputs) {
        if let Some(source) = source {
            key.text(input.name);
            write_source(nodes, *source, &mut key);
        }
    }
    for (input, source) in &node.many {
        key.text(node.info.module.inputs[*input].name);
        write_source(nodes, *source, &mut key);
    }
    for (param, source) in &node.linked {
        key.text(node.info.module.params[*param].name);
        write_source(nodes, *source, &mut key);
    }
    for name in names.of(&node.name) {
        key.text(&name.text);
    }
    key.finish()
}

fn write_source(nodes: &[PlanNode], source: super::Source, key: &mut FingerprintBuilder) {
    let from = &nodes[source.node];
    key.fingerprint(from.key);
    key.text(from.info.module.outputs[source.output].name);
}

/// Places of the nodes in the order of their names.
pub(super) fn by_name(nodes: &[PlanNode]) -> Vec<usize> {
    let mut places: Vec<usize> = (0..nodes.len()).collect();
    places.sort_by_key(|place| &nodes[*place].name);
    places
}

/// The hash of a whole plan: all its nodes by name, and the repeat.
pub(super) fn plan_id(nodes: &[PlanNode], by_name: &[usize], repeat: u32) -> Fingerprint {
    let mut id = FingerprintBuilder::new("mve step 1");
    id.part(&repeat.to_le_bytes());
    for node in by_name.iter().map(|place| &nodes[*place]) {
        id.text(&node.name);
        id.fingerprint(node.key);
    }
    id.finish()
}
