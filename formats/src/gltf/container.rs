//! The parts of a glTF file: its JSON, and the bytes that a binary file has behind it.

use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use mve_mesh::data::name_from_bytes;

use super::document::Document;
use crate::ReadError;

/// How a binary file begins.
pub(super) const MAGIC: &[u8] = b"glTF";
pub(super) const JSON_CHUNK: &[u8] = b"JSON";
pub(super) const BINARY_CHUNK: &[u8] = b"BIN\0";

/// A file that is taken apart.
pub(super) struct Container<'a> {
    pub document: Document,
    /// What stands behind the JSON of a binary file.
    pub binary: Option<&'a [u8]>,
}

/// Takes a file apart, of either kind.
///
/// # Errors
/// Where it is cut off, no JSON, or of another version.
pub(super) fn open(bytes: &[u8]) -> Result<Container<'_>, ReadError> {
    let (json, binary) = if bytes.starts_with(MAGIC) { chunks(bytes)? } else { (bytes, None) };
    let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
    let document: Document = serde_json::from_slice(json).map_err(|error| {
        ReadError::Wrong(format!("its JSON is no glTF that can be read: {error}"))
    })?;
    let version = &document.asset.version;
    if !version.starts_with("2.") {
        let found = if version.is_empty() { "none" } else { version };
        return Err(ReadError::Wrong(format!(
            "its `asset` should have the version 2.0 and has {found}; save it as glTF 2.0"
        )));
    }
    Ok(Container { document, binary })
}

/// The JSON and the binary chunk of a binary file.
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), ReadError> {
    let number = |at: usize| {
        let four = bytes.get(at..).and_then(|rest| rest.first_chunk::<4>());
        four.map(|four| u32::from_le_bytes(*four))
    };
    let cut_off = || ReadError::Wrong("the file is cut off within its first part".to_owned());
    let version = number(4).ok_or_else(cut_off)?;
    if version != 2 {
        let message = format!("a binary file of version {version}; save it as glTF 2.0");
        return Err(ReadError::Wrong(message));
    }
    let (mut json, mut binary) = (None, None);
    let mut at = 12;
    while let (Some(length), Some(kind)) = (number(at), bytes.get(at + 4..at + 8)) {
        let start = at + 8;
        let chunk = start.checked_add(length as usize).and_then(|end| bytes.get(start..end));
        let Some(chunk) = chunk else {
            return Err(ReadError::Wrong(format!(
                "a part of {length} bytes begins at byte {start}, but the file has {}; it is cut off",
                bytes.len()
            )));
        };
        match kind {
            JSON_CHUNK if json.is_none() => json = Some(chunk),
            BINARY_CHUNK if binary.is_none() => binary = Some(chunk),
            _ => {}
        }
        // Parts begin at multiples of four bytes.
        at = start + chunk.len().next_multiple_of(4);
    }
    let json = json.ok_or_else(|| ReadError::Wrong("the file has no JSON part".to_owned()))?;
    Ok((json, binary))
}

/// What a URI says.
pub(super) enum Uri {
    /// The bytes themselves.
    Data(Vec<u8>),
    /// A file, relative to the folder of this one; its name may hold any bytes.
    File(String),
}

impl Uri {
    /// # Errors
    /// What is wrong with it, as the end of a sentence.
    pub fn parse(text: &str) -> Result<Self, String> {
        let Some(data) = text.strip_prefix("data:") else {
            if text.contains("://") {
                let head: String = text.chars().take(40).collect();
                return Err(format!("is at {head}, elsewhere on the net: put it beside the file"));
            }
            return Ok(Self::File(name_from_bytes(&unescaped(text))));
        };
        let (head, body) = data.split_once(',').ok_or("is a data URI without a comma")?;
        if !head.ends_with(";base64") {
            return Ok(Self::Data(unescaped(body)));
        }
        const LENIENT: GeneralPurposeConfig =
            GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent);
        let decoded = GeneralPurpose::new(&STANDARD, LENIENT).decode(body.trim());
        decoded.map(Self::Data).map_err(|error| format!("is a data URI that is damaged: {error}"))
    }
}

/// The bytes of a text with `%20` for a blank.
fn unescaped(text: &str) -> Vec<u8> {
    let bytes = text.as_bytes();
    let mut plain = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while let Some(&byte) = bytes.get(at) {
        let digits = bytes.get(at + 1..at + 3).and_then(|two| str::from_utf8(two).ok());
        let digits = digits.filter(|two| two.bytes().all(|digit| digit.is_ascii_hexdigit()));
        let code = digits.and_then(|two| u8::from_str_radix(two, 16).ok());
        match (byte, code) {
            (b'%', Some(code)) => {
                plain.push(code);
                at += 3;
            }
            _ => {
                plain.push(byte);
                at += 1;
            }
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uris_are_files_or_data() {
        let bytes = |text: &str| match Uri::parse(text).unwrap() {
            Uri::Data(bytes) => bytes,
            Uri::File(name) => panic!("{name}"),
        };
        // RFC 4648, section 10, with and without its padding.
        assert_eq!(bytes("data:application/octet-stream;base64,Zm9vYg=="), b"foob");
        assert_eq!(bytes("data:;base64,Zm9vYg"), b"foob");
        assert_eq!(bytes("data:text/plain,a%20b"), b"a b");
        let Uri::File(name) = Uri::parse("a%20b%2.bin%C3%BC").unwrap() else { panic!("a file") };
        assert_eq!(name, "a b%2.binü");
        assert!(Uri::parse("https://x/y.bin").is_err());
        assert!(Uri::parse("data:;base64,Zm9v!").is_err());
    }
}
