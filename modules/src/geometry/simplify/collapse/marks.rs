//! Marks on vertices, for walks around a place of the mesh.

/// Marks on vertices that are cleared all at once.
#[derive(Debug)]
pub(super) struct VertexMarks {
    /// When each vertex was marked, and with what.
    marks: Vec<(u32, u32)>,
    now: u32,
}

impl VertexMarks {
    pub fn new(n: usize) -> Self {
        Self { marks: vec![(0, 0); n], now: 0 }
    }

    /// Forgets every mark.
    pub fn clear(&mut self) {
        self.now = self.now.checked_add(1).unwrap_or_else(|| {
            self.marks.fill((0, 0));
            1
        });
    }

    #[inline]
    pub fn set(&mut self, vertex: u32, value: u32) {
        self.marks[vertex as usize] = (self.now, value);
    }

    #[inline]
    pub fn get(&self, vertex: u32) -> Option<u32> {
        let (when, value) = self.marks[vertex as usize];
        (when == self.now).then_some(value)
    }

    /// Marks a vertex, with no value in particular; returns whether it had no mark before.
    #[inline]
    pub fn mark(&mut self, vertex: u32) -> bool {
        let before = std::mem::replace(&mut self.marks[vertex as usize].0, self.now);
        before != self.now
    }
}
