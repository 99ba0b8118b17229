//! Recognizes files that are no OBJ files by how they begin.

use super::ObjError;

/// Recognizes at once what is not text.
pub(super) fn check_kind(bytes: &[u8]) -> Result<(), ObjError> {
    const KINDS: [(&[u8], &str); 11] = [
        (b"ply\n", "it looks like a PLY file"),
        (b"ply\r", "it looks like a PLY file"),
        (b"solid ", "it looks like an STL file"),
        (b"OFF", "it looks like an OFF file"),
        (b"glTF", "it looks like a binary glTF file"),
        (b"#Inventor V", "it looks like an Open Inventor file"),
        (b"#VRML V", "it looks like a VRML file"),
        (b"PK\x03\x04", "it looks like a ZIP archive; unpack it first"),
        (b"\x1f\x8b", "it looks like a gzip archive; unpack it first"),
        (b"\xff\xfe", "it is UTF-16; save it as UTF-8"),
        (b"\xfe\xff", "it is UTF-16; save it as UTF-8"),
    ];
    if let Some(&(_, kind)) = KINDS.iter().find(|(magic, _)| bytes.starts_with(magic)) {
        return Err(ObjError::NotObj { line: 1, kind });
    }
    match bytes[..bytes.len().min(4096)].contains(&0) {
        true => Err(ObjError::NotObj { line: 1, kind: "it holds binary data" }),
        false => Ok(()),
    }
}
