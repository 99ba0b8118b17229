//! Numbers in the text that a program writes, by patterns such as `RMS: {rms}`.
//!
//! A pattern is looked for anywhere in a line. `{name}` stands for a number, `{_}` for one that is
//! not kept, blanks for any number of blanks, and all else for itself. Numbers are decimal, with an
//! exponent or without, or `nan` and `inf`.

use std::collections::HashSet;

/// Patterns, each with at least one name; names are unique.
#[derive(Clone, Debug, PartialEq)]
pub struct NumberPatterns(Vec<Pattern>);

#[derive(Clone, Debug, PartialEq)]
struct Pattern {
    text: String,
    pieces: Vec<Piece>,
}

#[derive(Clone, Debug, PartialEq)]
enum Piece {
    /// No blanks in it.
    Literal(String),
    Blanks,
    /// A number, and its name if it is kept.
    Number(Option<String>),
}

impl NumberPatterns {
    /// Reads patterns, parted by ends of lines or semicolons; the error is a sentence.
    pub fn read(text: &str) -> Result<Self, String> {
        let mut names = HashSet::new();
        let mut patterns = Vec::new();
        for text in text.split(['\n', ';']).map(str::trim).filter(|text| !text.is_empty()) {
            let pieces = pieces(text).map_err(|why| format!("\"{text}\": {why}"))?;
            let own = pieces.iter().filter_map(|piece| match piece {
                Piece::Number(name) => name.as_ref(),
                _ => None,
            });
            let mut has_names = false;
            for name in own {
                has_names = true;
                if !names.insert(name.clone()) {
                    return Err(format!("{{{name}}} stands twice; give each number its own name"));
                }
            }
            if !has_names {
                return Err(format!("\"{text}\" names no number; put {{name}} where one stands"));
            }
            patterns.push(Pattern { text: text.to_owned(), pieces });
        }
        Ok(Self(patterns))
    }

    /// The numbers in some lines, in the order of the patterns: for each those of the last line
    /// that it fits. The error names the first pattern that fits none.
    pub fn find(&self, lines: &[String]) -> Result<Vec<(String, f64)>, String> {
        let mut found = Vec::new();
        for Pattern { text, pieces } in &self.0 {
            let numbers = lines.iter().rev().find_map(|line| {
                let starts = line.char_indices().map(|(start, _)| &line[start..]);
                starts.into_iter().find_map(|rest| fit(pieces, rest))
            });
            found.extend(numbers.ok_or_else(|| format!("no line of the output fits \"{text}\""))?);
        }
        Ok(found)
    }
}

/// Splits a pattern at blanks and names.
fn pieces(text: &str) -> Result<Vec<Piece>, String> {
    let mut pieces = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        if first.is_whitespace() {
            pieces.push(Piece::Blanks);
            rest = rest.trim_start();
        } else if let Some(inside) = rest.strip_prefix('{') {
            let (name, after) = inside.split_once('}').ok_or("a { has no } behind it")?;
            let is_good = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
            if name.is_empty() || !name.chars().all(is_good) {
                let form = "lower-case letters, digits and underscores, such as max_distance";
                return Err(format!("\"{name}\" is no name: write {form}"));
            }
            pieces.push(Piece::Number((name != "_").then(|| name.to_owned())));
            rest = after;
        } else {
            let end = rest.find(|c: char| c.is_whitespace() || c == '{').unwrap_or(rest.len());
            pieces.push(Piece::Literal(rest[..end].to_owned()));
            rest = &rest[end..];
        }
    }
    Ok(pieces)
}

/// The named numbers where a text begins as a pattern says.
fn fit(pieces: &[Piece], text: &str) -> Option<Vec<(String, f64)>> {
    let mut rest = text;
    let mut found = Vec::new();
    for piece in pieces {
        match piece {
            Piece::Literal(literal) => rest = rest.strip_prefix(literal.as_str())?,
            Piece::Blanks => rest = rest.trim_start(),
            Piece::Number(name) => {
                let (number, length) = number(rest)?;
                rest = &rest[length..];
                found.extend(name.clone().map(|name| (name, number)));
            }
        }
    }
    Some(found)
}

/// The longest number that a text begins with, and its length in bytes.
fn number(text: &str) -> Option<(f64, usize)> {
    let is_of_number = |c: &char| c.is_ascii_alphanumeric() || matches!(c, '+' | '-' | '.');
    let most = text.chars().take_while(is_of_number).map(char::len_utf8).sum::<usize>().min(64);
    let lengths = (1..=most).rev();
    let read = |length: usize| Some((text.get(..length)?.parse().ok()?, length));
    lengths.into_iter().find_map(read)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(patterns: &str, text: &str) -> Result<Vec<(String, f64)>, String> {
        let lines: Vec<String> = text.lines().map(str::to_owned).collect();
        NumberPatterns::read(patterns)?.find(&lines)
    }

    #[test]
    fn numbers_are_found_where_the_pattern_says() {
        // As the program Metro writes.
        let text = "Vertices: 1,234\n  max  : 0.012345 (0.001  wrt bounding box diagonal)\n\
                    mean : 1e-3\nHausdorff distance: -.5 (7 wrt x)";
        let patterns = "max : {max} ({relative} wrt bounding; mean : {mean}\nance: {h} ({_} wrt";
        let numbers = [("max", 0.012_345), ("relative", 0.001), ("mean", 1e-3), ("h", -0.5)];
        let expected: Vec<_> = numbers.map(|(name, x)| (name.to_owned(), x)).into();
        assert_eq!(found(patterns, text), Ok(expected));
        assert_eq!(found("", text), Ok(Vec::new()));
        assert!(found("max: {x}", "max: nan").unwrap()[0].1.is_nan());
        assert_eq!(found("é {x}é", "aé 3.25é").unwrap()[0].1, 3.25);
        assert_eq!(found("= {x}mm", "= 12mm").unwrap()[0].1, 12.0);
    }

    #[test]
    fn of_several_lines_the_last_counts() {
        assert_eq!(found("at {x}", "at 1\nat 2 at 3\nat x").unwrap()[0].1, 2.0);
    }

    #[test]
    fn what_is_wrong_is_quoted() {
        let cases = [
            ("max", "\"max\" names no number"),
            ("a {b", "has no }"),
            ("a {B c}", "\"B c\" is no name"),
            ("a {b}; c {b}", "{b} stands twice"),
            ("max {max}", "no line of the output fits \"max {max}\""),
        ];
        for (patterns, part) in cases {
            let message = found(patterns, "min 3").unwrap_err();
            assert!(message.contains(part), "{message}");
        }
    }
}
