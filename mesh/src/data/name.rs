//! Names from files, whatever their bytes are.
//!
//! Files from before UTF-8 hold names in Latin-1, GBK, Shift-JIS and others, and nothing in them
//! says which. So that two such names stay two and are written as they were read, each byte that is
//! not UTF-8 stands in the text as one code point that no text uses: the byte plus `U+10FF00`, at
//! the end of the last private use plane. (Python's `surrogateescape`, PEP 383, has surrogates in
//! their place, which Rust's text cannot hold; MirBSD's OPTU-8 has `U+EF80` to `U+EFFF`.) Where a
//! file holds such a code point itself, its bytes are kept in the same way, so nothing is lost.

use std::borrow::Cow;
use std::ffi::{OsStr, OsString};

/// What a byte that is not UTF-8 is added to.
const FIRST: u32 = 0x10_ff00;

/// The byte that a character stands for, if it is none of text.
fn byte_of(c: char) -> Option<u8> {
    u8::try_from((c as u32).checked_sub(FIRST)?).ok().filter(|byte| *byte >= 0x80)
}

/// The name with these bytes.
pub fn name_from_bytes(bytes: &[u8]) -> String {
    let mut name = String::with_capacity(bytes.len());
    let kept = |byte: &u8| char::from_u32(FIRST + u32::from(*byte)).unwrap_or_default();
    for chunk in bytes.utf8_chunks() {
        for c in chunk.valid().chars() {
            match byte_of(c) {
                None => name.push(c),
                Some(_) => name.extend(c.encode_utf8(&mut [0; 4]).as_bytes().iter().map(kept)),
            }
        }
        name.extend(chunk.invalid().iter().map(kept));
    }
    name
}

/// The bytes of a name: those that it was made from.
pub fn name_to_bytes(name: &str) -> Cow<'_, [u8]> {
    if !name.contains(|c| byte_of(c).is_some()) {
        return Cow::Borrowed(name.as_bytes());
    }
    let mut bytes = Vec::with_capacity(name.len());
    for c in name.chars() {
        match byte_of(c) {
            Some(byte) => bytes.push(byte),
            None => bytes.extend_from_slice(c.encode_utf8(&mut [0; 4]).as_bytes()),
        }
    }
    Cow::Owned(bytes)
}

/// The name of a file or folder. Where the system has no names of bytes, they are written in UTF-8.
pub fn name_from_file(name: &OsStr) -> String {
    name_from_bytes(name.as_encoded_bytes())
}

/// The file or folder of this name, or the path.
pub fn name_to_file(name: &str) -> OsString {
    #[cfg(unix)]
    {
        use std::os::unix::ffi::OsStringExt;
        OsString::from_vec(name_to_bytes(name).into_owned())
    }
    #[cfg(not(unix))]
    OsString::from(name)
}

/// The name as it would be in the other one of UTF-8 and Latin-1, in which a file may have it that
/// is named in the first; `None` where there is no such name.
pub fn name_recoded(name: &str) -> Option<String> {
    let bytes = name_to_bytes(name);
    match std::str::from_utf8(&bytes) {
        Err(_) => Some(bytes.iter().map(|&byte| char::from(byte)).collect()),
        Ok(text) if text.is_ascii() => None,
        Ok(text) => {
            let bytes: Option<Vec<u8>> = text.chars().map(|c| u8::try_from(c).ok()).collect();
            bytes.map(|bytes| name_from_bytes(&bytes))
        }
    }
}

/// A name as a person reads it: what is not UTF-8 in angle brackets, `T<fc>r`.
pub fn shown_name(name: &str) -> String {
    name.chars()
        .map(|c| byte_of(c).map_or_else(|| c.to_string(), |byte| format!("<{byte:02x}>")))
        .collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn bytes_of_other_encodings_stay_apart_and_are_shown() {
        let latin_1 = name_from_bytes(b"T\xfcr");
        assert_ne!(latin_1, name_from_bytes(b"T\xf6r"));
        assert_eq!(*name_to_bytes(&latin_1), *b"T\xfcr");
        assert_eq!(shown_name(&latin_1), "T<fc>r");
        assert_eq!(name_from_bytes("Tür 門".as_bytes()), "Tür 門");
        assert_eq!(shown_name("Tür 門"), "Tür 門");
        assert_eq!(name_recoded(&latin_1).as_deref(), Some("Tür"));
        assert_eq!(name_recoded("Tür"), Some(latin_1.clone()));
        assert_eq!([name_recoded("Tur"), name_recoded("門")], [None, None]);
        assert_eq!(name_from_file(&name_to_file(&latin_1)), latin_1);
    }

    proptest! {
        #[test]
        fn any_bytes_come_back(
            bytes in prop::collection::vec(any::<u8>(), 0..40),
            text in any::<String>(),
            own in 0x80_u32..0x100,
        ) {
            // A file may hold the code points that stand for bytes.
            let own = char::from_u32(FIRST + own).expect("a character");
            for bytes in [bytes, format!("{text}{own}").into_bytes()] {
                let name = name_from_bytes(&bytes);
                prop_assert_eq!(&*name_to_bytes(&name), &bytes[..]);
            }
            if !text.contains(|c| byte_of(c).is_some()) {
                prop_assert_eq!(name_from_bytes(text.as_bytes()), text);
            }
        }
    }
}
