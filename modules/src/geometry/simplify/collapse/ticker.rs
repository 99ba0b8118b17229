//! Progress and cancelling, about every half millisecond.

use std::time::{Duration, Instant};

use mve_core::{Cancelled, Control};

/// Elements of one piece of a list between two ticks.
pub(super) const CHUNK: usize = 1024;

const PERIOD: Duration = Duration::from_micros(500);

/// Calls a [`Control`] by the clock, without reading the clock at every tick.
pub(super) struct Ticker<'a> {
    control: Control<'a>,
    last: Instant,
    /// Ticks from one look at the clock to the next, kept so that looks are 1/4 to 1 period apart.
    stride: u32,
    left: u32,
    target: Option<(usize, usize)>,
    /// Faces that were left at the last tick.
    n_faces: usize,
}

impl<'a> Ticker<'a> {
    pub fn new(control: Control<'a>) -> Self {
        Self { control, last: Instant::now(), stride: 1, left: 1, target: None, n_faces: 0 }
    }

    /// Says what progress is measured by: faces at the start and at the end.
    pub fn set_goal(&mut self, from: usize, to: usize) {
        self.target = Some((from, to));
        self.n_faces = from;
    }

    /// Marks a small piece of work, a few hundred microseconds at most where it can be helped.
    pub fn tick(&mut self, n_faces: usize) -> Result<(), Cancelled> {
        self.n_faces = n_faces;
        self.left -= 1;
        if self.left > 0 {
            return Ok(());
        }
        let elapsed = self.last.elapsed();
        if elapsed < PERIOD / 4 {
            self.stride = (self.stride * 2).min(64);
        } else if elapsed >= PERIOD {
            self.stride = (self.stride / 2).max(1);
        }
        self.left = self.stride;
        if elapsed < PERIOD / 2 {
            return Ok(());
        }
        self.call(n_faces)
    }

    /// Maps a list, with ticks.
    pub fn collect<T, U>(
        &mut self,
        list: &[T],
        mut map: impl FnMut(&T) -> U,
    ) -> Result<Vec<U>, Cancelled> {
        let mut out = Vec::with_capacity(list.len());
        for piece in list.chunks(CHUNK) {
            self.tick(self.n_faces)?;
            out.extend(piece.iter().map(&mut map));
        }
        Ok(out)
    }

    /// A list of `n` equal elements, made with ticks: the first touch of memory takes its time.
    pub fn fill<T: Copy>(&mut self, n: usize, value: T) -> Result<Vec<T>, Cancelled> {
        let mut list = Vec::with_capacity(n);
        while list.len() < n {
            self.tick(self.n_faces)?;
            list.resize((list.len() + CHUNK).min(n), value);
        }
        Ok(list)
    }

    /// Calls the control whatever the clock says.
    pub fn call(&mut self, n_faces: usize) -> Result<(), Cancelled> {
        self.last = Instant::now();
        let fraction = self.target.map_or(0.0, |(from, to)| {
            let done = from.saturating_sub(n_faces) as f64;
            (done / from.saturating_sub(to).max(1) as f64).min(1.0)
        });
        self.control.at(fraction)
    }
}
