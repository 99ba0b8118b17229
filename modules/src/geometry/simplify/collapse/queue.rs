//! The queue of collapses: which edge is cheapest, while prices change.
//!
//! Most edges never come near the head before they are gone or dearer, so they are not kept in
//! order. Every waiting edge has its price in a table; the *pool* holds those up to a price below
//! which about half lies, the *run* the cheapest quarter of the pool, sorted. An edge priced below
//! the end of the run goes on a small heap beside it. Entries whose price is no longer that of the
//! table are passed over. When the run is spent, the next is drawn from the pool, and when the pool
//! is spent, that from the table. O(log n_edges) for each entry that comes to the head, but O(1)
//! for a change beyond the run.
//!
//! Entries compare by price, then by edge length, then by edge number: a total order, so what
//! comes out does not depend on how the entries went in.

use std::collections::BinaryHeap;

use mve_core::Cancelled;
use mve_mesh::adjacency::EdgeId;

use super::ticker::{CHUNK, Ticker};

/// An edge on the queue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Entry {
    /// What the collapse costs; never NaN.
    pub price: f64,
    /// Squared length of the edge, the order among equal prices; never NaN.
    pub length_squared: f32,
    /// The edge.
    pub edge: EdgeId,
}

/// An entry in one number, the greater the earlier it comes.
type Key = u128;

impl Entry {
    #[inline]
    fn key(self) -> Key {
        // The bits of a number at least 0 grow with it. Adding 0 takes the sign from −0.
        let bits = (self.price + 0.0).to_bits();
        let ascending = if bits >> 63 == 0 { bits | 1 << 63 } else { !bits };
        let length = (self.length_squared + 0.0).to_bits();
        !(u128::from(ascending) << 64 | u128::from(length) << 32 | u128::from(self.edge.0))
    }
}

/// A price doubled so often, which is exact as long as it is finite.
#[inline]
pub(super) fn doubled(price: f64, doublings: u8) -> f64 {
    // A power of two by its exponent.
    price * f64::from_bits((1023 + u64::from(doublings)) << 52)
}

/// The edge of a key.
#[inline]
fn edge_of(key: Key) -> EdgeId {
    EdgeId(!(key as u32))
}

/// What the queue knows of an edge.
#[derive(Clone, Copy, Debug)]
struct Slot {
    /// NaN while the edge does not wait.
    price: f64,
    length_squared: f32,
    choice: u8,
    is_stale: bool,
    /// How often the price was doubled to let the edge wait.
    doublings: u8,
}

impl Slot {
    const ABSENT: Self = Self::new(f64::NAN, 0.0, 0);

    #[inline]
    const fn new(price: f64, length_squared: f32, choice: u8) -> Self {
        Self { price, length_squared, choice, is_stale: false, doublings: 0 }
    }

    #[inline]
    fn entry(&self, edge: EdgeId) -> Entry {
        Entry { price: self.price, length_squared: self.length_squared, edge }
    }
}

/// About one in so many of the table goes to the pool, and of the pool to the run.
const POOL_SHARE: usize = 2;
const RUN_SHARE: usize = 4;
/// A list up to this long is taken as a whole.
const SHORT: usize = 2048;
/// A run is not meant to be longer than this: it is sorted between two looks at the control.
const LONG: usize = 1 << 17;
/// Prices that are looked at to find the price below which a share lies.
const N_SAMPLES: usize = 512;

/// Edges by price; see the file's header.
#[derive(Debug)]
pub(super) struct Queue {
    /// By edge.
    slots: Vec<Slot>,
    /// Entries above the end of the run and up to the end of the pool, in no order.
    pool: Vec<Entry>,
    /// Sorted entries, the first last.
    run: Vec<Key>,
    /// Entries that were set below the end of the run.
    late: BinaryHeap<Key>,
    /// The price at which the pool ends; all beyond is in the table alone.
    pool_end: f64,
    /// The price at which the run ends.
    run_end: f64,
}

impl Queue {
    /// An empty queue for edges `0..n_edges`.
    pub fn new(n_edges: usize, ticker: &mut Ticker) -> Result<Self, Cancelled> {
        Ok(Self {
            slots: ticker.fill(n_edges, Slot::ABSENT)?,
            pool: Vec::new(),
            run: Vec::new(),
            late: BinaryHeap::new(),
            pool_end: f64::NEG_INFINITY,
            run_end: f64::NEG_INFINITY,
        })
    }

    /// The first entry, which stays on the queue.
    pub fn first(
        &mut self,
        n_faces: usize,
        ticker: &mut Ticker,
    ) -> Result<Option<Entry>, Cancelled> {
        loop {
            while self.run.last().is_some_and(|&key| !self.is_current(key)) {
                self.run.pop();
            }
            while self.late.peek().is_some_and(|&key| !self.is_current(key)) {
                self.late.pop();
            }
            if let Some(&first) = self.run.last().max(self.late.peek()) {
                let edge = edge_of(first);
                return Ok(Some(self.slots[edge.idx()].entry(edge)));
            }
            if !self.refill(n_faces, ticker)? {
                return Ok(None);
            }
        }
    }

    /// The edges that probably follow the first, the next one first.
    pub fn coming(&self) -> impl Iterator<Item = EdgeId> + '_ {
        self.run.iter().rev().filter(|&&key| self.is_current(key)).map(|&key| edge_of(key))
    }

    /// Edges that were set below the end of the run, the earliest of them among the first.
    pub fn coming_late(&self) -> impl Iterator<Item = EdgeId> + '_ {
        self.late.iter().filter(|&&key| self.is_current(key)).map(|&key| edge_of(key))
    }

    /// Whether the edge is on the queue.
    #[inline]
    pub fn contains(&self, edge: EdgeId) -> bool {
        !self.slots[edge.idx()].price.is_nan()
    }

    /// Whether the edge was marked since its price was set.
    #[inline]
    pub fn is_stale(&self, edge: EdgeId) -> bool {
        self.slots[edge.idx()].is_stale
    }

    /// Marks an edge as one whose price is that of an earlier state.
    #[inline]
    pub fn mark_stale(&mut self, edge: EdgeId) {
        self.slots[edge.idx()].is_stale = true;
    }

    /// Lets an edge wait at a part of its price, unless it is stale already or the price is
    /// negative, and marks it as stale.
    pub fn put_off(&mut self, edge: EdgeId, share: f64) {
        let Slot { price, length_squared, choice, is_stale, .. } = self.slots[edge.idx()];
        if !is_stale && price > 0.0 {
            self.set(Entry { price: share * price, length_squared, edge }, choice);
        }
        self.mark_stale(edge);
    }

    /// The candidate that the edge was set with.
    pub fn choice(&self, edge: EdgeId) -> u8 {
        self.slots[edge.idx()].choice
    }

    /// Puts an edge in or changes its price.
    #[inline]
    pub fn set(&mut self, entry: Entry, choice: u8) {
        let Entry { price, length_squared, edge } = entry;
        self.slots[edge.idx()] = Slot::new(price, length_squared, choice);
        self.list(entry);
    }

    /// Lets an edge wait at a multiple of its price, doubled so often; then it waits for a change
    /// in its neighborhood, too.
    pub fn let_wait(&mut self, entry: Entry, choice: u8, doublings: u8) {
        let entry = Entry { price: doubled(entry.price, doublings), ..entry };
        let slot = Slot::new(entry.price, entry.length_squared, choice);
        self.slots[entry.edge.idx()] = Slot { doublings, ..slot };
        self.list(entry);
    }

    /// Whether an edge has waited at a multiple of its price.
    #[inline]
    pub fn has_waited(&self, edge: EdgeId) -> bool {
        self.slots[edge.idx()].doublings > 0
    }

    /// The price that the edge was set with, before it had to wait.
    #[inline]
    pub fn own_price(&self, edge: EdgeId) -> f64 {
        let Slot { price, doublings, .. } = self.slots[edge.idx()];
        price / doubled(1.0, doublings)
    }

    /// Whether a change in its neighborhood gives the edge another chance: it is not on the queue,
    /// or waits at a multiple of its price.
    #[inline]
    pub fn is_held_up(&self, edge: EdgeId) -> bool {
        !self.contains(edge) || self.has_waited(edge)
    }

    #[inline]
    fn list(&mut self, entry: Entry) {
        let price = entry.price;
        if price <= self.run_end {
            self.late.push(entry.key());
        } else if price <= self.pool_end {
            self.pool.push(entry);
        }
    }

    /// Takes an edge out, if it is there.
    #[inline]
    pub fn remove(&mut self, edge: EdgeId) {
        self.slots[edge.idx()] = Slot::ABSENT;
    }

    #[inline]
    fn is_current(&self, key: Key) -> bool {
        let edge = edge_of(key);
        self.slots[edge.idx()].entry(edge).key() == key
    }

    /// Draws the next run; whether there is one.
    fn refill(&mut self, n_faces: usize, ticker: &mut Ticker) -> Result<bool, Cancelled> {
        while self.run.is_empty() {
            if self.pool.is_empty() && !self.fill_pool(n_faces, ticker)? {
                return Ok(false);
            }
            let prices = self.pool.iter().map(|entry| entry.price);
            let share = RUN_SHARE.max(self.pool.len() / LONG);
            self.run_end = end_of_share(prices, self.pool.len(), share).min(self.pool_end);
            let mut n_left = 0;
            for at in 0..self.pool.len() {
                if at.is_multiple_of(CHUNK) {
                    ticker.tick(n_faces)?;
                }
                let entry = self.pool[at];
                if entry.price > self.run_end {
                    self.pool[n_left] = entry;
                    n_left += 1;
                } else if self.slots[entry.edge.idx()].price == entry.price {
                    self.run.push(entry.key());
                }
            }
            self.pool.truncate(n_left);
            ticker.tick(n_faces)?;
            self.run.sort_unstable();
            ticker.tick(n_faces)?;
        }
        Ok(true)
    }

    /// Draws the next pool; whether there is one.
    fn fill_pool(&mut self, n_faces: usize, ticker: &mut Ticker) -> Result<bool, Cancelled> {
        // Edges that do not wait are NaN, which is no price of a sample and not up to any end.
        let prices = self.slots.iter().map(|slot| slot.price);
        self.pool_end = end_of_share(prices, self.slots.len(), POOL_SHARE);
        for (piece, first) in self.slots.chunks(CHUNK).zip((0u32..).step_by(CHUNK)) {
            ticker.tick(n_faces)?;
            for (slot, edge) in piece.iter().zip(first..) {
                if slot.price <= self.pool_end {
                    self.pool.push(slot.entry(EdgeId(edge)));
                }
            }
        }
        Ok(!self.pool.is_empty())
    }
}

/// A price up to which about one in `share` of `n` prices lies, but at least one.
fn end_of_share(prices: impl Iterator<Item = f64> + Clone, n: usize, share: usize) -> f64 {
    if n <= SHORT {
        return f64::INFINITY;
    }
    let is_price = |price: &f64| !price.is_nan();
    let mut sample: Vec<f64> =
        prices.clone().step_by(n.div_ceil(N_SAMPLES)).filter(is_price).collect();
    if sample.len() < 2 * share {
        // Few are left, and the sample has missed them.
        let n_left = prices.clone().filter(is_price).count();
        if n_left <= SHORT {
            return f64::INFINITY;
        }
        sample = prices.filter(is_price).step_by(n_left.div_ceil(N_SAMPLES)).collect();
    }
    sample.sort_unstable_by(f64::total_cmp);
    sample[sample.len() / share]
}

#[cfg(test)]
mod tests {
    use super::*;
    use mve_core::Control;
    use proptest::prelude::*;

    fn drain(mut queue: Queue) -> Vec<Entry> {
        let mut out = Vec::new();
        let mut ticker = Ticker::new(Control::none());
        while let Some(entry) = queue.first(0, &mut ticker).unwrap() {
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
            let mut queue = Queue::new(40, &mut Ticker::new(Control::none())).unwrap();
            let mut expected = std::collections::BTreeMap::new();
            for (number, price) in changes {
                let edge = EdgeId(number);
                match price {
                    Some(price) => {
                        queue.set(Entry { price: price.into(), length_squared: 1.0, edge }, 0);
                        expected.insert(number, price);
                    }
                    None => {
                        queue.remove(edge);
                        expected.remove(&number);
                    }
                }
                prop_assert_eq!(queue.contains(edge), price.is_some());
            }
            let mut expected: Vec<_> =
                expected.into_iter().map(|(edge, price)| (f64::from(price), edge)).collect();
            expected.sort_by(|x, y| x.partial_cmp(y).unwrap());
            let found: Vec<_> = drain(queue).iter().map(|e| (e.price, e.edge.0)).collect();
            prop_assert_eq!(found, expected);
        }
    }

    #[test]
    fn equal_prices_come_out_by_length_then_number() {
        let mut queue = Queue::new(6, &mut Ticker::new(Control::none())).unwrap();
        for (edge, length_squared) in [(5, 2.0), (3, 1.0), (4, 1.0), (0, 3.0)] {
            let edge = EdgeId(edge);
            queue.set(Entry { price: 0.0, length_squared, edge }, 0);
        }
        let edges: Vec<_> = drain(queue).iter().map(|e| e.edge.0).collect();
        assert_eq!(edges, [3, 4, 5, 0]);
    }
}
