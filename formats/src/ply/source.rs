//! Where the numbers of a PLY file's rows come from.

use super::fixed::Rows;
use super::header::Kind;
use crate::ReadError;
use crate::words::Words;

/// Where numbers come from.
pub(super) trait Source {
    fn number(&mut self, kind: Kind) -> Result<f64, ReadError>;
    /// Bytes that are left.
    fn n_left(&self) -> u64;
    fn fraction(&self) -> f64;
    fn place(&self) -> String;
    /// The next rows, if they are binary and each has so many bytes.
    fn rows(&self, n_rows: u64, stride: usize) -> Option<Rows<'_>>;
    /// Steps over bytes that were read as rows.
    fn advance(&mut self, n_bytes: usize);
}

/// Rows of words.
pub(super) struct Text<'a>(pub Words<'a>);

impl Source for Text<'_> {
    fn number(&mut self, _: Kind) -> Result<f64, ReadError> {
        self.0.number("a number")
    }

    fn n_left(&self) -> u64 {
        self.0.n_left() as u64
    }

    fn fraction(&self) -> f64 {
        self.0.fraction()
    }

    fn place(&self) -> String {
        format!("line {}", self.0.line())
    }

    fn rows(&self, _: u64, _: usize) -> Option<Rows<'_>> {
        None
    }

    fn advance(&mut self, _: usize) {}
}

/// Rows of bytes, the highest of a number first or last.
pub(super) struct Binary<'a, const BIG: bool> {
    pub bytes: &'a [u8],
    pub pos: usize,
}

impl<const BIG: bool> Binary<'_, BIG> {
    #[inline]
    fn take<const N: usize>(&mut self) -> Result<[u8; N], ReadError> {
        let bytes = self.bytes.get(self.pos..).and_then(|rest| rest.first_chunk::<N>());
        let mut bytes = *bytes.ok_or_else(ends)?;
        self.pos += N;
        // Numbers are read with the lowest byte first.
        if BIG {
            bytes.reverse();
        }
        Ok(bytes)
    }
}

#[cold]
fn ends() -> ReadError {
    ReadError::Wrong("the file ends before all rows that its header promises".to_owned())
}

impl<const BIG: bool> Source for Binary<'_, BIG> {
    #[inline]
    fn number(&mut self, kind: Kind) -> Result<f64, ReadError> {
        Ok(match kind {
            Kind::F32 => f64::from(f32::from_le_bytes(self.take()?)),
            Kind::I32 => f64::from(i32::from_le_bytes(self.take()?)),
            Kind::U8 => f64::from(u8::from_le_bytes(self.take()?)),
            Kind::F64 => f64::from_le_bytes(self.take()?),
            Kind::U32 => f64::from(u32::from_le_bytes(self.take()?)),
            Kind::I8 => f64::from(i8::from_le_bytes(self.take()?)),
            Kind::I16 => f64::from(i16::from_le_bytes(self.take()?)),
            Kind::U16 => f64::from(u16::from_le_bytes(self.take()?)),
        })
    }

    fn n_left(&self) -> u64 {
        self.bytes.len().saturating_sub(self.pos) as u64
    }

    fn fraction(&self) -> f64 {
        self.pos as f64 / self.bytes.len().max(1) as f64
    }

    fn place(&self) -> String {
        format!("byte {} of the rows", self.pos)
    }

    fn rows(&self, n_rows: u64, stride: usize) -> Option<Rows<'_>> {
        let n_bytes = usize::try_from(n_rows).ok()?.checked_mul(stride)?;
        let end = self.pos.checked_add(n_bytes)?;
        let bytes = self.bytes.get(self.pos..end).filter(|_| stride > 0)?;
        Some(Rows { bytes, stride, is_big: BIG })
    }

    fn advance(&mut self, n_bytes: usize) {
        self.pos += n_bytes;
    }
}
