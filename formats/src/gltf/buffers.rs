//! The bytes that a glTF file has or names, and the views of them.

use std::collections::HashMap;
use std::sync::Arc;

use mve_core::Control;

use super::container::Uri;
use super::document::{BufferView, Document, Whole};
use super::meshopt;
use crate::ReadError;

/// What unpacked views may take, if the file is small.
const MOST_UNPACKED: usize = 1 << 28;
/// And for a byte of the file.
const MOST_UNPACKED_A_BYTE: usize = 64;

/// Reads the file that a buffer names.
pub(super) type BufferSource<'a> = dyn FnMut(&str) -> Result<Vec<u8>, String> + 'a;

/// The bytes of a file.
pub(super) struct Buffers<'a> {
    pub document: &'a Document,
    buffers: Vec<Bytes<'a>>,
    /// Views that were packed.
    unpacked: HashMap<usize, Vec<u8>>,
    n_bytes: usize,
}

enum Bytes<'a> {
    Here(&'a [u8]),
    Read(Arc<Vec<u8>>),
    /// Only views that are packed stand for it.
    None,
}

impl<'a> Buffers<'a> {
    /// Reads the buffers, and unpacks the views that are packed.
    ///
    /// # Errors
    /// Where bytes are missing or damaged, and when `control` says so.
    pub fn read(
        document: &'a Document,
        binary: Option<&'a [u8]>,
        source: &mut BufferSource,
        control: Control,
    ) -> Result<Self, ReadError> {
        let mut known: HashMap<&str, Arc<Vec<u8>>> = HashMap::new();
        let mut buffers = Vec::with_capacity(document.buffers.len());
        for (number, buffer) in document.buffers.iter().enumerate() {
            control.at(0.0)?;
            let bytes = match (&buffer.uri, binary) {
                (Some(uri), _) => match known.get(uri.as_str()) {
                    Some(bytes) => Bytes::Read(Arc::clone(bytes)),
                    None => {
                        let parsed = Uri::parse(uri).and_then(|parsed| match parsed {
                            Uri::Data(bytes) => Ok(bytes),
                            Uri::File(name) => source(&name),
                        });
                        // A source that was cancelled has an error of its own.
                        control.at(0.0)?;
                        let wrong = |why| ReadError::Wrong(format!("buffer {number} {why}"));
                        let bytes = parsed.map_err(wrong)?;
                        let bytes = Arc::new(bytes);
                        known.insert(uri, Arc::clone(&bytes));
                        Bytes::Read(bytes)
                    }
                },
                (None, Some(binary)) if number == 0 => Bytes::Here(binary),
                (None, _) => Bytes::None,
            };
            buffers.push(bytes);
        }
        let mut all = Self { document, buffers, unpacked: HashMap::new(), n_bytes: 0 };
        all.n_bytes = (0..all.buffers.len()).filter_map(|at| all.buffer(at)).map(<[u8]>::len).sum();
        all.unpack(control)?;
        Ok(all)
    }

    fn unpack(&mut self, control: Control) -> Result<(), ReadError> {
        let most = self.n_bytes.saturating_mul(MOST_UNPACKED_A_BYTE).max(MOST_UNPACKED);
        let mut n_bytes = 0_usize;
        for (number, view) in self.document.buffer_views.iter().enumerate() {
            let Some(about) = &view.extensions.meshopt else { continue };
            control.at(0.0)?;
            let wrong = |why: String| ReadError::Wrong(format!("buffer view {number} {why}"));
            n_bytes = n_bytes.saturating_add(about.count.0.saturating_mul(about.byte_stride.0));
            if n_bytes > most {
                let most = most >> 20;
                return Err(wrong(format!("and those before it unpack to more than {most} MB")));
            }
            let packed = self.part(about.buffer, about.byte_offset, about.byte_length);
            let bytes = packed.and_then(|packed| meshopt::unpack(packed, about)).map_err(wrong)?;
            self.unpacked.insert(number, bytes);
        }
        Ok(())
    }

    /// Bytes of all buffers together.
    pub fn n_bytes(&self) -> usize {
        self.n_bytes
    }

    fn buffer(&self, number: usize) -> Option<&[u8]> {
        match self.buffers.get(number)? {
            Bytes::Here(bytes) => Some(bytes),
            Bytes::Read(bytes) => Some(bytes),
            Bytes::None => None,
        }
    }

    fn part(&self, buffer: Whole, offset: Whole, length: Whole) -> Result<&[u8], String> {
        let number = buffer.0;
        let Some(bytes) = self.buffer(number) else {
            return Err(format!("is in buffer {number}, which is not there"));
        };
        let part = offset.0.checked_add(length.0).and_then(|end| bytes.get(offset.0..end));
        part.ok_or_else(|| {
            format!(
                "asks for {} bytes from byte {} of buffer {number}, which has {}",
                length.0,
                offset.0,
                bytes.len()
            )
        })
    }

    /// A view and its bytes.
    ///
    /// # Errors
    /// What is wrong, as a sentence.
    pub fn view(&self, number: Whole) -> Result<(&BufferView, &[u8]), String> {
        let view = self.document.buffer_views.get(number.0);
        let view = view.ok_or_else(|| format!("buffer view {} is not there", number.0))?;
        if let Some(bytes) = self.unpacked.get(&number.0) {
            return Ok((view, bytes));
        }
        let bytes = self.part(view.buffer, view.byte_offset, view.byte_length);
        Ok((view, bytes.map_err(|why| format!("buffer view {} {why}", number.0))?))
    }
}
