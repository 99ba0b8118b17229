//! A declaration and the hash of the code that it stands for.

/// Something declared in a file of its own, with a hash of the code in that file.
///
/// The hash is a part of every result's identity, so an edited cost function, metric or module
/// never finds results of its older self in a cache or a store, and nobody has to remember to
/// raise a version number.
pub struct Listed<T: 'static> {
    /// The declaration.
    pub item: &'static T,
    /// [`source_hash`] of what its build says of its file, or of the file.
    pub source: u64,
}

impl<T> Clone for Listed<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Listed<T> {}

/// Hash at compile time: FNV-1a, 64 bits (Fowler, Noll, Vo 1991).
pub const fn source_hash(source: &[u8]) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut place = 0;
    while place < source.len() {
        hash = (hash ^ source[place] as u64).wrapping_mul(0x0100_0000_01b3);
        place += 1;
    }
    hash
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn source_hash_is_fnv_1a() {
        // From the test vectors of the authors of FNV.
        assert_eq!(source_hash(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(source_hash(b"foobar"), 0x8594_4171_f739_67e8);
    }
}
