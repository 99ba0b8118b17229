//! All faces behind each pixel, the nearest first.
//!
//! A picture keeps what lies behind it, so that taking a face away shows the next one without
//! drawing the mesh again (L. Carpenter, "The A-buffer, an antialiased hidden surface method",
//! SIGGRAPH 1984, without its coverage masks). A pixel holds one fragment for each layer of the
//! surface, however many faces the mesh has. The nearest ones lie apart, in one list a quantity:
//! they are what a price reads.

use crate::picture::render::NO_FACE;

/// No further fragment.
pub(super) const END: u32 = u32::MAX;

/// A face at a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fragment {
    /// One over the depth; 0 for the background.
    pub inv_depth: f32,
    /// The face; [`NO_FACE`] for the background.
    pub face: u32,
    next: u32,
    /// The luminance of the face.
    pub value: u8,
}

impl Fragment {
    /// A fragment of a face.
    #[inline]
    pub fn new(face: u32, inv_depth: f32, value: u8) -> Self {
        Self { inv_depth, face, next: END, value }
    }

    /// Whether this one is seen of the two: the nearer, or of equally near ones the first face.
    #[inline]
    pub fn hides(&self, other: &Self) -> bool {
        self.inv_depth > other.inv_depth
            || (self.inv_depth == other.inv_depth && self.face < other.face)
    }
}

/// The fragments of a picture.
#[derive(Clone, Debug)]
pub(super) struct Layers {
    /// Of the nearest fragment of each pixel: one over its depth.
    pub inv_depths: Vec<f32>,
    /// Its face.
    pub faces: Vec<u32>,
    /// The place of the next one in `behind`, or [`END`].
    pub nexts: Vec<u32>,
    /// Its luminance.
    pub values: Vec<u8>,
    /// The ones behind, and unused places.
    behind: Vec<Fragment>,
    /// The first unused place; they are linked as fragments are.
    unused: u32,
    background: u8,
}

impl Layers {
    /// Nothing but the background.
    pub fn new(n_pixels: usize, background: u8) -> Self {
        Self {
            inv_depths: vec![0.0; n_pixels],
            faces: vec![NO_FACE; n_pixels],
            nexts: vec![END; n_pixels],
            values: vec![background; n_pixels],
            behind: Vec::new(),
            unused: END,
            background,
        }
    }

    /// The nearest fragment of a pixel.
    #[inline]
    pub fn first(&self, pixel: usize) -> Fragment {
        Fragment {
            inv_depth: self.inv_depths[pixel],
            face: self.faces[pixel],
            next: self.nexts[pixel],
            value: self.values[pixel],
        }
    }

    fn set_first(&mut self, pixel: usize, first: Fragment) {
        self.inv_depths[pixel] = first.inv_depth;
        self.faces[pixel] = first.face;
        self.nexts[pixel] = first.next;
        self.values[pixel] = first.value;
    }

    fn nothing(&self) -> Fragment {
        Fragment::new(NO_FACE, 0.0, self.background)
    }

    /// The nearest fragment of a pixel that `is_left`, or the background.
    #[inline]
    pub fn first_left(&self, pixel: usize, is_left: impl Fn(u32) -> bool) -> Fragment {
        let mut fragment = self.first(pixel);
        while !is_left(fragment.face) {
            match self.behind.get(fragment.next as usize) {
                Some(next) => fragment = *next,
                None => return self.nothing(),
            }
        }
        fragment
    }

    /// Puts a fragment in.
    pub fn insert(&mut self, pixel: usize, fragment: Fragment) {
        let first = self.first(pixel);
        if fragment.hides(&first) {
            let next = if first.face == NO_FACE { END } else { self.put_behind(first) };
            self.set_first(pixel, Fragment { next, ..fragment });
            return;
        }
        let mut before = END;
        let mut next = first.next;
        while let Some(other) = self.behind.get(next as usize) {
            if fragment.hides(other) {
                break;
            }
            (before, next) = (next, other.next);
        }
        let place = self.put_behind(Fragment { next, ..fragment });
        match self.behind.get_mut(before as usize) {
            Some(before) => before.next = place,
            None => self.nexts[pixel] = place,
        }
    }

    /// Takes the fragment of a face out.
    pub fn remove(&mut self, pixel: usize, face: u32) {
        let first = self.first(pixel);
        let mut place = first.next;
        if first.face == face {
            match self.behind.get(place as usize).copied() {
                Some(next) => {
                    self.set_first(pixel, next);
                    self.give_back(place);
                }
                None => self.set_first(pixel, self.nothing()),
            }
            return;
        }
        let mut before = END;
        while let Some(&fragment) = self.behind.get(place as usize) {
            if fragment.face == face {
                match self.behind.get_mut(before as usize) {
                    Some(before) => before.next = fragment.next,
                    None => self.nexts[pixel] = fragment.next,
                }
                self.give_back(place);
                return;
            }
            (before, place) = (place, fragment.next);
        }
    }

    /// Stores a fragment behind the first ones; its place.
    fn put_behind(&mut self, fragment: Fragment) -> u32 {
        let place = self.unused;
        match self.behind.get_mut(place as usize) {
            Some(unused) => {
                self.unused = unused.next;
                *unused = fragment;
                place
            }
            None => {
                self.behind.push(fragment);
                self.behind.len() as u32 - 1
            }
        }
    }

    fn give_back(&mut self, place: u32) {
        self.behind[place as usize].next = self.unused;
        self.unused = place;
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn the_nearest_that_is_left_is_seen(
            changes in prop::collection::vec((0..3usize, 0..12u32, 1..6u8), 0..80),
            hidden in prop::collection::hash_set(0..12u32, 0..6),
        ) {
            let mut layers = Layers::new(3, 77);
            let mut expected: [Vec<Fragment>; 3] = Default::default();
            for (pixel, face, depth) in changes {
                let there = expected[pixel].iter().position(|f| f.face == face);
                if let Some(place) = there {
                    expected[pixel].remove(place);
                    layers.remove(pixel, face);
                } else {
                    let fragment = Fragment::new(face, f32::from(depth), depth);
                    expected[pixel].push(fragment);
                    layers.insert(pixel, fragment);
                }
            }
            for (pixel, fragments) in expected.iter_mut().enumerate() {
                let by_depth = |a: &Fragment, b: &Fragment| b.inv_depth.total_cmp(&a.inv_depth);
                fragments.sort_by(|a, b| by_depth(a, b).then(a.face.cmp(&b.face)));
                let is_left = |face: u32| !hidden.contains(&face);
                let first = fragments.iter().find(|f| is_left(f.face));
                let found = layers.first_left(pixel, is_left);
                let expected = first.map_or((NO_FACE, 77), |f| (f.face, f.value));
                prop_assert_eq!((found.face, found.value), expected);
            }
            prop_assert!(layers.behind.len() <= 36, "given back places are used again");
        }
    }
}
