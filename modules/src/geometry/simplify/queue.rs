//! The queue of collapses: a heap over edges whose prices change in place.
//!
//! Four children a node, so that sifting touches few cache lines; every operation is
//! O(log n_edges). Entries compare by price, then by edge length, then by edge number: a total
//! order, so what comes out does not depend on how the entries went in.

/// An edge on the queue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Entry {
    /// What the collapse costs; never NaN.
    pub price: f64,
    /// Squared length of the edge, the order among equal prices; never NaN.
    pub length_squared: f32,
    /// Number of the edge.
    pub edge: u32,
}

impl Entry {
    #[inline]
    fn is_before(&self, other: &Self) -> bool {
        self.price < other.price
            || (self.price == other.price
                && (self.length_squared, self.edge) < (other.length_squared, other.edge))
    }
}

const ABSENT: u32 = u32::MAX;
const ARITY: usize = 4;

/// A heap of [`Entry`], with the place of every edge.
#[derive(Debug)]
pub(super) struct Queue {
    heap: Vec<Entry>,
    place: Vec<u32>,
}

impl Queue {
    /// An empty queue for edges `0..n_edges`.
    pub fn new(n_edges: usize) -> Self {
        Self { heap: Vec::with_capacity(n_edges), place: vec![ABSENT; n_edges] }
    }

    /// The first entry.
    pub fn first(&self) -> Option<Entry> {
        self.heap.first().copied()
    }

    /// The edges near the head, those of the topmost levels of the heap.
    pub fn near_head(&self) -> impl Iterator<Item = u32> + '_ {
        self.heap.iter().take(1 + ARITY + ARITY * ARITY).map(|entry| entry.edge)
    }

    /// Whether the edge is on the queue.
    pub fn contains(&self, edge: u32) -> bool {
        self.place[edge as usize] != ABSENT
    }

    /// Puts an entry in without ordering; [`Queue::order`] must follow before anything else.
    pub fn append(&mut self, entry: Entry) {
        self.place[entry.edge as usize] = self.heap.len() as u32;
        self.heap.push(entry);
    }

    /// Orders the whole heap in linear time.
    pub fn order(&mut self) {
        if self.heap.len() > 1 {
            for at in (0..=(self.heap.len() - 2) / ARITY).rev() {
                self.sink(at, self.heap[at]);
            }
        }
    }

    /// Puts an edge in or changes its price.
    pub fn set(&mut self, entry: Entry) {
        let at = self.place[entry.edge as usize];
        if at == ABSENT {
            self.heap.push(entry);
            self.rise(self.heap.len() - 1, entry);
        } else if entry.is_before(&self.heap[at as usize]) {
            self.rise(at as usize, entry);
        } else {
            self.sink(at as usize, entry);
        }
    }

    /// Takes an edge out, if it is there.
    pub fn remove(&mut self, edge: u32) {
        let at = self.place[edge as usize] as usize;
        if at == ABSENT as usize {
            return;
        }
        self.place[edge as usize] = ABSENT;
        if let Some(last) = self.heap.pop()
            && at < self.heap.len()
        {
            if last.is_before(&self.heap[at]) {
                self.rise(at, last);
            } else {
                self.sink(at, last);
            }
        }
    }

    /// Moves `entry` from the hole `at` towards the root.
    fn rise(&mut self, mut at: usize, entry: Entry) {
        while at > 0 {
            let parent = (at - 1) / ARITY;
            if !entry.is_before(&self.heap[parent]) {
                break;
            }
            self.put(at, self.heap[parent]);
            at = parent;
        }
        self.put(at, entry);
    }

    /// Moves `entry` from the hole `at` towards the leaves.
    fn sink(&mut self, mut at: usize, entry: Entry) {
        loop {
            let start = at * ARITY + 1;
            let end = (start + ARITY).min(self.heap.len());
            let Some(children) = self.heap.get(start..end) else { break };
            let mut least = (entry, at);
            for (child, place) in children.iter().zip(start..) {
                if child.is_before(&least.0) {
                    least = (*child, place);
                }
            }
            if least.1 == at {
                break;
            }
            self.put(at, least.0);
            at = least.1;
        }
        self.put(at, entry);
    }

    fn put(&mut self, at: usize, entry: Entry) {
        self.heap[at] = entry;
        self.place[entry.edge as usize] = at as u32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn drain(mut queue: Queue) -> Vec<Entry> {
        let mut out = Vec::new();
        while let Some(entry) = queue.first() {
            queue.remove(entry.edge);
            out.push(entry);
        }
        out
    }

    proptest! {
        #[test]
        fn comes_out_sorted_after_changes(
            changes in prop::collection::vec((0u32..40, prop::option::of(0u8..9)), 0..200)
        ) {
            let mut queue = Queue::new(40);
            let mut expected = std::collections::BTreeMap::new();
            for (edge, price) in changes {
                match price {
                    Some(price) => {
                        queue.set(Entry { price: price.into(), length_squared: 1.0, edge });
                        expected.insert(edge, price);
                    }
                    None => {
                        queue.remove(edge);
                        expected.remove(&edge);
                    }
                }
                prop_assert_eq!(queue.contains(edge), price.is_some());
            }
            let mut expected: Vec<_> =
                expected.into_iter().map(|(edge, price)| (f64::from(price), edge)).collect();
            expected.sort_by(|x, y| x.partial_cmp(y).unwrap());
            let found: Vec<_> = drain(queue).iter().map(|e| (e.price, e.edge)).collect();
            prop_assert_eq!(found, expected);
        }
    }

    #[test]
    fn equal_prices_come_out_by_length_then_number() {
        let mut queue = Queue::new(6);
        for (edge, length_squared) in [(5, 2.0), (3, 1.0), (4, 1.0), (0, 3.0)] {
            queue.append(Entry { price: 0.0, length_squared, edge });
        }
        queue.order();
        let edges: Vec<_> = drain(queue).iter().map(|e| e.edge).collect();
        assert_eq!(edges, [3, 4, 5, 0]);
    }
}
