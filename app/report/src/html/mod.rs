//! The report as one HTML page: no network, no files beside it, light and dark, fit to print.
//!
//! Everything that comes from a map or a store is escaped; a content security policy keeps even a
//! slip from loading anything.

mod made;
mod people;
mod sections;
mod tables;

use std::fmt::Write;

use mve_core::is_steering;

use crate::answers::Answer;
use crate::columns::MeasureColumn;
use crate::pictures::Pictures;
use crate::pivot::Pivot;
use crate::plots::Figure;
use crate::rating::People;
use crate::results::Results;

const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("script.js");

/// Everything that a page shows.
pub struct Page<'a> {
    /// The results.
    pub results: &'a Results,
    /// Title of the page.
    pub title: &'a str,
    /// The measures.
    pub measures: &'a [MeasureColumn],
    /// Answers to the program's questions.
    pub answers: &'a [Answer],
    /// Tables of the measures.
    pub tables: &'a [Pivot],
    /// Plots, and how many panels were left out.
    pub figures: &'a (Vec<Figure>, usize),
    /// What people said of the results.
    pub people: Option<&'a People>,
    /// Pictures.
    pub pictures: &'a Pictures,
    /// The store as seen from the page's folder, with a `/` at its end, or empty.
    pub store: &'a str,
}

/// The page.
pub fn page(page: &Page) -> String {
    let sections = [
        ("plots", "Plots", sections::plots(page)),
        ("tables", "Results", tables::pivots(page)),
        ("people", "People", people::people(page)),
        ("pictures", "Pictures", sections::pictures(page)),
        ("correlation", "Correlation of the measures", sections::correlation(page)),
        ("steps", "All steps", tables::steps(page)),
        ("failed", "Steps that are not done", sections::failed(page)),
        ("made", "How it was made", made::made(page)),
    ];
    let sections: Vec<_> = sections.iter().filter(|(.., body)| !body.is_empty()).collect();
    let title = escape(page.title);
    let policy = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; \
                  script-src 'unsafe-inline'";
    let mut text = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"generator\" content=\"mve {}\">\n<title>{title}</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n<header>\n<h1>{title}</h1>\n{}",
        mve_core::VERSION,
        sections::summary(page)
    );
    text.push_str("<nav>");
    for (id, name, _) in &sections {
        let _ = write!(text, "<a href=\"#{id}\">{name}</a>");
    }
    text.push_str("</nav>\n</header>\n<main>\n");
    text.push_str(&sections::answers(page));
    for (id, name, body) in &sections {
        let _ = write!(text, "<section id=\"{id}\">\n<h2>{name}</h2>\n{body}</section>\n");
    }
    let _ = write!(
        text,
        "</main>\n<dialog><img alt=\"\"><p></p></dialog>\n<script>\n{SCRIPT}</script>\n</body>\n\
         </html>\n"
    );
    text
}

/// A text as HTML shows it, in content and in attributes.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            // What would steer a reader, or is no character of HTML.
            c if is_steering(c) && !"\n\t".contains(c) => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// A path as an address relative to the page.
fn address(store: &str, path: &str) -> String {
    let mut out = String::new();
    for byte in format!("{store}{path}").bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'/' | b'.' | b'-' | b'_' | b'~' => {
                out.push(char::from(byte));
            }
            byte => {
                let _ = write!(out, "%{byte:02X}");
            }
        }
    }
    // A colon would make a scheme of the first part; it is escaped above.
    out
}

/// A count with its noun.
fn count(n: usize, what: &str) -> String {
    let s = if n == 1 { "" } else { "s" };
    format!("{n} {what}{s}")
}

/// A text of a reasonable length.
fn cut(text: &str, longest: usize) -> String {
    match text.char_indices().nth(longest) {
        Some((end, _)) => format!("{} …", &text[..end]),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_escapes() {
        let text = escape("<script>alert('x & \"y\"')</script>\u{7}\u{202e}");
        assert_eq!(
            text,
            "&lt;script&gt;alert(&#39;x &amp; &quot;y&quot;&#39;)&lt;/script&gt;\u{fffd}\u{fffd}"
        );
        assert_eq!(address("../s t/", "steps/a\"b:c.png"), "../s%20t/steps/a%22b%3Ac.png");
    }
}
