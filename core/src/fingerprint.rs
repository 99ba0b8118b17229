//! 256-bit names of content.

use std::fmt;
use std::path::Path;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// A BLAKE3 hash: of a file's content, or of everything that determines a value.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Fingerprint([u8; 32]);

impl Fingerprint {
    /// The fingerprint of some bytes.
    pub fn of(bytes: &[u8]) -> Self {
        Self(*blake3::hash(bytes).as_bytes())
    }

    /// The fingerprint of a file's content, read in pieces.
    pub fn of_file(path: &Path) -> std::io::Result<Self> {
        let mut hasher = blake3::Hasher::new();
        hasher.update_reader(std::fs::File::open(path)?)?;
        Ok(Self(*hasher.finalize().as_bytes()))
    }

    /// The first 16 hexadecimal digits: enough to tell a billion apart, short enough for a name.
    pub fn short(&self) -> String {
        blake3::Hash::from(self.0).to_hex()[..16].to_owned()
    }
}

impl fmt::Display for Fingerprint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&blake3::Hash::from(self.0).to_hex())
    }
}

impl fmt::Debug for Fingerprint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.short())
    }
}

impl FromStr for Fingerprint {
    type Err = blake3::HexError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(Self(*blake3::Hash::from_hex(text)?.as_bytes()))
    }
}

impl Serialize for Fingerprint {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for Fingerprint {
    fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let text = String::deserialize(from)?;
        text.parse().map_err(serde::de::Error::custom)
    }
}

/// Gathers the parts of a fingerprint. Each part is written with its length, so that no two lists
/// of parts give the same bytes. The bytes are hashed at the end, all at once: they are few, and
/// the hasher is slow at small pieces.
#[derive(Default)]
pub(crate) struct FingerprintBuilder(Vec<u8>);

impl FingerprintBuilder {
    /// Starts one, for a kind of thing: fingerprints of two kinds never meet.
    pub fn new(kind: &str) -> Self {
        let mut builder = Self::default();
        builder.part(kind.as_bytes());
        builder
    }

    pub fn part(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(&(bytes.len() as u64).to_le_bytes());
        self.0.extend_from_slice(bytes);
    }

    pub fn text(&mut self, text: &str) {
        self.part(text.as_bytes());
    }

    pub fn fingerprint(&mut self, fingerprint: Fingerprint) {
        self.part(&fingerprint.0);
    }

    /// Parts that another builder gathered, as if they had come to this one.
    pub fn parts(&mut self, gathered: &Self) {
        self.0.extend_from_slice(&gathered.0);
    }

    pub fn finish(self) -> Fingerprint {
        Fingerprint::of(&self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_do_not_run_together() {
        let of = |parts: &[&str]| {
            let mut builder = FingerprintBuilder::new("test");
            parts.iter().for_each(|part| builder.text(part));
            builder.finish()
        };
        assert_ne!(of(&["ab", "c"]), of(&["a", "bc"]));
        assert_eq!(of(&["ab", "c"]).to_string().parse::<Fingerprint>().unwrap(), of(&["ab", "c"]));
    }

    #[test]
    fn agrees_with_the_published_hash_of_nothing() {
        // BLAKE3 of no bytes, from the test vectors of its authors.
        assert!(Fingerprint::of(b"").to_string().starts_with("af1349b9f5f9a1a6a0404dea36dcc949"));
    }
}
