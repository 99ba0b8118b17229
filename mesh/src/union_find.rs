//! Disjoint sets of indices, merged step by step.

/// Sets over `0..n`, each named by its smallest member.
#[derive(Clone, Debug, Default)]
pub struct UnionFind {
    parent: Vec<u32>,
}

impl UnionFind {
    /// `n` sets of one member each.
    pub fn new(n: usize) -> Self {
        Self { parent: (0..n as u32).collect() }
    }

    /// Back to `n` sets of one member each, without new memory where there is enough.
    pub fn reset(&mut self, n: usize) {
        self.parent.clear();
        self.parent.extend(0..n as u32);
    }

    /// The smallest member of the set of `member`.
    #[inline]
    pub fn find(&mut self, member: u32) -> u32 {
        let mut at = member;
        while self.parent[at as usize] != at {
            let above = self.parent[self.parent[at as usize] as usize];
            self.parent[at as usize] = above;
            at = above;
        }
        at
    }

    /// Adds a set of one new member, which it returns.
    #[inline]
    pub fn add(&mut self) -> u32 {
        let member = self.parent.len() as u32;
        self.parent.push(member);
        member
    }

    /// Merges the sets of two members; whether they were two.
    #[inline]
    pub fn union(&mut self, a: u32, b: u32) -> bool {
        let (a, b) = (self.find(a), self.find(b));
        self.parent[a.max(b) as usize] = a.min(b);
        a != b
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_are_named_by_their_smallest_member() {
        let mut sets = UnionFind::new(5);
        assert_eq!(sets.add(), 5);
        for (a, b) in [(5, 3), (3, 4), (2, 1)] {
            assert!(sets.union(a, b));
        }
        assert!(!sets.union(4, 5));
        let names: Vec<u32> = (0..6).map(|m| sets.find(m)).collect();
        assert_eq!(names, [0, 1, 1, 3, 3, 3]);
    }
}
