//! Binary triangles, wherever they are: in memory, or in a file, of which only so much is in memory
//! as somebody works on.

#[cfg(unix)]
use std::fs::File;
use std::io;
use std::ops::Range;

use mve_core::Cancelled;
use thiserror::Error;

use super::RECORD;
use crate::ReadError;

/// Why there is no mesh of triangles.
#[derive(Debug, Error)]
pub(super) enum Trouble {
    #[error(transparent)]
    System(#[from] io::Error),
    #[error(transparent)]
    Content(#[from] ReadError),
}

impl From<Cancelled> for Trouble {
    fn from(cancelled: Cancelled) -> Self {
        Self::Content(cancelled.into())
    }
}

/// The triangles of a binary file.
#[derive(Clone, Copy)]
pub(super) enum Records<'a> {
    Memory(&'a [[u8; RECORD]]),
    /// As many as a file has behind its head.
    #[cfg(unix)]
    File(&'a File, usize),
}

impl<'a> Records<'a> {
    pub fn len(&self) -> usize {
        match self {
            Self::Memory(records) => records.len(),
            #[cfg(unix)]
            Self::File(_, n) => *n,
        }
    }

    /// Those of these numbers, read into the buffer if they are in a file.
    pub fn read<'b>(
        &self,
        range: Range<usize>,
        buffer: &'b mut Vec<u8>,
    ) -> io::Result<&'b [[u8; RECORD]]>
    where
        'a: 'b,
    {
        match self {
            Self::Memory(records) => Ok(&records[range]),
            #[cfg(unix)]
            Self::File(file, _) => {
                use std::os::unix::fs::FileExt;
                buffer.resize(range.len() * RECORD, 0);
                file.read_exact_at(buffer, (super::HEAD + range.start * RECORD) as u64)?;
                Ok(buffer.as_chunks().0)
            }
        }
    }
}
