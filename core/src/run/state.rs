//! How far a run is: what is ready, what waits, and the values that somebody still needs.

use super::NodeOutcome;
use crate::data::Value;
use crate::plan::{Plan, Source};

/// How far a run is.
pub(super) struct State {
    /// Nodes that can start; the last one starts first, so that values find their consumers soon.
    pub ready: Vec<usize>,
    /// For each node, how many nodes it still waits for.
    pub waiting: Vec<usize>,
    /// For each node and output, the value while somebody needs it, and for how many it still is.
    pub values: Vec<Vec<(Option<Value>, usize)>>,
    pub outcomes: Vec<Option<NodeOutcome>>,
    pub n_ended: usize,
    /// Whether a node failed on a value whose file was damaged.
    pub is_damaged: bool,
}

impl State {
    pub fn new(plan: &Plan) -> Self {
        let mut values: Vec<Vec<_>> = Vec::with_capacity(plan.nodes.len());
        let mut waiting = vec![0; plan.nodes.len()];
        for node in &plan.nodes {
            values.push(vec![(None, 0); node.info.module.outputs.len()]);
            node.sources().for_each(|source| values[source.node][source.output].1 += 1);
            node.consumers.iter().for_each(|consumer| waiting[*consumer] += 1);
        }
        let ready = (0..plan.nodes.len()).rev().filter(|place| waiting[*place] == 0).collect();
        let outcomes = plan.nodes.iter().map(|_| None).collect();
        Self { ready, waiting, values, outcomes, n_ended: 0, is_damaged: false }
    }

    /// Tells the consumers of a node that it has ended: those that waited for it alone are ready.
    pub fn release(&mut self, consumers: &[usize]) {
        for consumer in consumers.iter().rev() {
            self.waiting[*consumer] -= 1;
            if self.waiting[*consumer] == 0 && self.outcomes[*consumer].is_none() {
                self.ready.push(*consumer);
            }
        }
    }

    /// The value of an output; the last one to ask owns it alone.
    pub fn fetch(&mut self, source: Source) -> Option<Value> {
        let (value, needed) = &mut self.values[source.node][source.output];
        *needed -= 1;
        if *needed == 0 { value.take() } else { value.clone() }
    }
}
