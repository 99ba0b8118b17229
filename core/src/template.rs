//! Names of output files: templates over the parameters of the map.
//!
//! `{load.path.stem}-{simplify.cost}.obj` becomes `bunny-Quadric.obj`. A reference names a node and
//! a dotted path of its parameters; behind the path of a file, `stem`, `name` and `extension` take
//! a part of it. A choice is named with those parameters of its entry that are not its defaults,
//! and `{load.source}` is the stem of the file that the node reads, or else its module. `{step}` is
//! the id of the step and `{repeat}` its repeat. What is put in never
//! adds a folder: slashes in it become dashes.

use crate::problem::is_steering;

/// A piece of a template.
#[derive(Debug, PartialEq)]
pub(crate) enum Piece<'a> {
    /// Copied as it is.
    Literal(&'a str),
    /// Replaced.
    Reference(&'a str),
}

/// Splits a template into pieces; the error says what is wrong with it.
pub(crate) fn pieces(template: &str) -> Result<Vec<Piece<'_>>, String> {
    let mut pieces = Vec::new();
    let mut rest = template;
    while let Some(place) = rest.find(['{', '}']) {
        let (before, from) = rest.split_at(place);
        if !before.is_empty() {
            pieces.push(Piece::Literal(before));
        }
        let inside = from.strip_prefix('{').and_then(|inside| inside.split_once('}'));
        let Some((name, after)) = inside.filter(|(name, _)| !name.contains('{')) else {
            return Err(format!("the braces in \"{template}\" do not pair"));
        };
        pieces.push(Piece::Reference(name));
        rest = after;
    }
    if !rest.is_empty() {
        pieces.push(Piece::Literal(rest));
    }
    Ok(pieces)
}

/// A value as a part of a file name: without slashes, control characters and the like.
pub(crate) fn as_name(word: &str) -> String {
    let is_bad = |c: char| is_steering(c) || "/\\:*?\"<>|".contains(c);
    let name: String = word.chars().map(|c| if is_bad(c) { '-' } else { c }).collect();
    if name.chars().all(|c| c == '.') { "-".repeat(name.len().max(1)) } else { name }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splits_into_literals_and_references() {
        use Piece::{Literal, Reference};
        let expected = [Reference("a.b"), Literal("-x."), Reference("step")];
        assert_eq!(pieces("{a.b}-x.{step}").unwrap(), expected);
        assert_eq!(pieces("").unwrap(), []);
    }

    #[test]
    fn braces_that_do_not_pair_are_errors() {
        for template in ["{a", "a}", "{a{b}}", "{"] {
            assert!(pieces(template).is_err(), "{template}");
        }
    }

    #[test]
    fn a_name_never_climbs() {
        assert_eq!(as_name("../../etc/passwd"), "..-..-etc-passwd");
        assert_eq!(as_name(".."), "--");
        assert_eq!(as_name(""), "-");
    }
}
