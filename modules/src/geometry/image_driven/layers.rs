//! All faces behind each pixel, the nearest first.
//!
//! A picture keeps what lies behind it, so that taking a face away shows the next one without
//! drawing the mesh again (L. Carpenter, "The A-buffer, an antialiased hidden surface method",
//! SIGGRAPH 1984, without its coverage masks). A pixel holds one fragment for each layer of the
//! surface, however many faces the mesh has.

use crate::geometry::render::NO_FACE;

/// No further fragment.
const END: u32 = u32::MAX;

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
    /// The nearest fragment of each pixel.
    first: Vec<Fragment>,
    /// The ones behind, and unused places.
    behind: Vec<Fragment>,
    /// The first unused place; they are linked as fragments are.
    unused: u32,
    background: Fragment,
}

impl Layers {
    /// Nothing but the background.
    pub fn new(n_pixels: usize, background: u8) -> Self {
        let background = Fragment::new(NO_FACE, 0.0, background);
        Self { first: vec![background; n_pixels], behind: Vec::new(), unused: END, background }
    }

    /// The nearest fragments, by pixel.
    #[inline]
    pub fn first(&self) -> &[Fragment] {
        &self.first
    }

    /// The nearest fragment of a pixel that `is_left`, or the background.
    #[inline]
    pub fn first_left(&self, pixel: usize, is_left: impl Fn(u32) -> bool) -> Fragment {
        let mut fragment = &self.first[pixel];
        while !is_left(fragment.face) {
            match self.behind.get(fragment.next as usize) {
                Some(next) => fragment = next,
                None => return self.background,
            }
        }
        *fragment
    }

    /// Puts a fragment in.
    pub fn insert(&mut self, pixel: usize, fragment: Fragment) {
        let first = self.first[pixel];
        if fragment.hides(&first) {
            let next = if first.face == NO_FACE { END } else { self.put_behind(first) };
            self.first[pixel] = Fragment { next, ..fragment };
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
            None => self.first[pixel].next = place,
        }
    }

    /// Takes the fragment of a face out.
    pub fn remove(&mut self, pixel: usize, face: u32) {
        let first = &mut self.first[pixel];
        let mut place = first.next;
        if first.face == face {
            match self.behind.get(place as usize) {
                Some(next) => {
                    *first = *next;
                    self.give_back(place);
                }
                None => *first = self.background,
            }
            return;
        }
        let mut before = END;
        while let Some(&fragment) = self.behind.get(place as usize) {
            if fragment.face == face {
                match self.behind.get_mut(before as usize) {
                    Some(before) => before.next = fragment.next,
                    None => self.first[pixel].next = fragment.next,
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
                fragments.sort_by(|a, b| if a.hides(b) { std::cmp::Ordering::Less } else { std::cmp::Ordering::Greater });
                let is_left = |face: u32| !hidden.contains(&face);
                let first = fragments.iter().find(|f| is_left(f.face));
                let found = layers.first_left(pixel, is_left);
                prop_assert_eq!((found.face, found.value), first.map_or((NO_FACE, 77), |f| (f.face, f.value)));
            }
            let n: usize = expected.iter().map(Vec::len).sum();
            prop_assert!(layers.behind.len() <= 36, "{} for {}", layers.behind.len(), n);
        }
    }
}
