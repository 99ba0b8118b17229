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

/// Gives every node its key. `nodes` are in running order.
pub(super) fn fill(nodes: &mut [PlanNode], names: &Names) {
    for place in 0..nodes.len() {
        let node = &nodes[place];
        let mut key = FingerprintBuilder::new(KEY_FORMAT);
        key.text(node.info.module.id);
        key.fingerprint(node.info.version);
        node.settings.write_key(node.info.module.params, &mut key);
        for (_, fingerprint) in &node.reads {
            key.fingerprint(*fingerprint);
        }
        for (input, source) in node.info.module.inputs.iter().zip(&node.inputs) {
            if let Some(source) = source {
                key.text(input.name);
                write_source(nodes, *source, &mut key);
            }
        }
        for (param, source) in &node.linked {
            key.text(node.info.module.params[*param].name);
            write_source(nodes, *source, &mut key);
        }
        for name in names.of(&node.name) {
            key.text(&name.text);
        }
        nodes[place].key = key.finish();
    }
}

fn write_source(nodes: &[PlanNode], source: super::Source, key: &mut FingerprintBuilder) {
    let from = &nodes[source.node];
    key.fingerprint(from.key);
    key.text(from.info.module.outputs[source.output].name);
}

/// The hash of a whole plan: all its nodes by name, and the repeat.
pub(super) fn plan_id(nodes: &[PlanNode], repeat: u32) -> Fingerprint {
    let mut sorted: Vec<_> = nodes.iter().map(|node| (&node.name, node.key)).collect();
    sorted.sort();
    let mut id = FingerprintBuilder::new("mve step 1");
    id.part(&repeat.to_le_bytes());
    for (name, key) in sorted {
        id.text(name);
        id.fingerprint(key);
    }
    id.finish()
}
