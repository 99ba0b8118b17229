//! From the bytes of an Open Inventor file to a mesh.

use mve_core::Control;
use mve_mesh::data::TriMesh;

use super::{parse, scene};
use crate::ReadError;
use crate::obj::cursor::quoted;
use crate::warnings::{Warning, Warnings};

/// Reads a text of Open Inventor 2.0 or 2.1, or of VRML 1.0, which has the same nodes.
///
/// # Errors
/// What is wrong with it, with the line; when `control` says so.
pub fn read_iv(bytes: &[u8], control: Control) -> Result<(TriMesh, Vec<Warning>), ReadError> {
    check_head(bytes)?;
    let mut warnings = Warnings::default();
    // The first line is a comment to what reads the rest.
    let nodes = parse::parse(bytes, &mut warnings, control.part(0.0, 0.7))?;
    scene::mesh(&nodes, bytes.len(), warnings, control.part(0.7, 1.0))
}

fn check_head(bytes: &[u8]) -> Result<(), ReadError> {
    let length = bytes.iter().take(200).position(|byte| matches!(byte, b'\n' | b'\r'));
    let head = bytes[..length.unwrap_or(bytes.len().min(200))].trim_ascii();
    let wrong = |message: String| Err(ReadError::Wrong(message));
    if let Some(version) = head.strip_prefix(b"#Inventor V") {
        let is_known = [b"2.", b"1."].iter().any(|known| version.starts_with(*known));
        if !is_known {
            return wrong(format!("the version in {} is not known; save it as 2.1", quoted(head)));
        }
        if version.windows(6).any(|word| word.eq_ignore_ascii_case(b"binary")) {
            let advice = "save it as text, for example with `ivcat -o out.iv in.iv`";
            return wrong(format!("it is a binary Open Inventor file; {advice}"));
        }
        return Ok(());
    }
    if head.starts_with(b"#VRML V1.0") {
        return Ok(());
    }
    if head.starts_with(b"#VRML") {
        return wrong("it is VRML 2.0 (97), which has other nodes; save it as Inventor".to_owned());
    }
    let found = quoted(head);
    wrong(format!("line 1: found {found}, expected `#Inventor V2.1 ascii`: no Inventor file"))
}
