//! The page on which people mark how far results look from their originals.
//!
//! One file without network: the pictures are in it, marks are kept by the browser until they are
//! saved as a file, which [`Ratings`](super::Ratings) reads. Nothing on it tells which method made
//! a result but the id of its step; the order is drawn by the name of the rater.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use mve_core::Fingerprint;
use serde_json::json;

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");
const BODY: &str = include_str!("page.html");

/// The name of every page: nothing tells what is compared.
const TITLE: &str = "How far does it look from the original?";

/// What is to be rated.
#[derive(Clone, Debug, Default)]
pub struct RatingPage {
    /// Name of the program.
    pub program: String,
    /// Pictures of a mesh, one for each angle.
    pub frames: usize,
    /// Pictures in a row of a sheet.
    pub columns: usize,
    /// Pixels in a row of a picture, and rows.
    pub size: usize,
    /// Sheets of the originals, PNG files: all pictures of a mesh in rows.
    pub originals: Vec<Vec<u8>>,
    /// What is rated.
    pub items: Vec<RatingItem>,
}

/// A result beside its original.
#[derive(Clone, Debug)]
pub struct RatingItem {
    /// Id of the step that made it.
    pub step: String,
    /// Its original, by place.
    pub original: usize,
    /// Its sheet.
    pub sheet: Vec<u8>,
}

impl RatingPage {
    /// The page.
    pub fn html(&self) -> String {
        let base64 = |bytes: &Vec<u8>| STANDARD.encode(bytes);
        let items = self.items.iter();
        let shown = |item: &RatingItem| json!({ "step": item.step, "original": item.original });
        let data = json!({
            "page": self.id(),
            "program": self.program,
            "frames": self.frames,
            "columns": self.columns,
            "size": self.size,
            "items": items.clone().map(shown).collect::<Vec<_>>(),
            "originals": self.originals.iter().map(base64).collect::<Vec<_>>(),
            "results": items.map(|item| base64(&item.sheet)).collect::<Vec<_>>(),
        });
        // Nothing in it may end the element that it stands in.
        let data = data.to_string().replace('<', "\\u003c");
        let policy = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; \
                      script-src 'unsafe-inline'";
        format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta name=\"generator\" content=\"mve {}\">\n<title>{TITLE}</title>\n\
             <style>\n{STYLE}</style>\n</head>\n<body>\n{BODY}\
             <script type=\"application/json\" id=\"data\">{data}</script>\n\
             <script>\n{SCRIPT}</script>\n</body>\n</html>\n",
            mve_core::VERSION,
        )
    }

    /// A name for the page, the same for one that shows the same.
    fn id(&self) -> String {
        let mut bytes = format!("{} {}", self.program, self.frames).into_bytes();
        for sheet in self.originals.iter().chain(self.items.iter().map(|item| &item.sheet)) {
            bytes.extend(Fingerprint::of(sheet).to_string().into_bytes());
        }
        bytes.extend(self.items.iter().flat_map(|item| item.step.bytes()));
        Fingerprint::of(&bytes).short()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page(program: &str, sheet: &[u8]) -> RatingPage {
        let item = RatingItem { step: "0123".to_owned(), original: 0, sheet: sheet.to_vec() };
        let (originals, items) = (vec![b"png".to_vec()], vec![item]);
        RatingPage { program: program.to_owned(), frames: 4, columns: 2, size: 8, originals, items }
    }

    #[test]
    fn nothing_of_the_program_ends_an_element() {
        let html = page("</script><b>", b"png").html();
        assert_eq!(html.matches("</script>").count(), 2);
        assert!(html.contains(r"\u003c/script>\u003cb>") && html.contains("default-src 'none'"));
        // No address leads out of the page.
        assert!(!html.contains("http://") && !html.contains("https://"));
    }

    #[test]
    fn a_page_is_another_one_when_it_shows_something_else() {
        assert_eq!(page("p", b"a").id(), page("p", b"a").id());
        assert_ne!(page("p", b"a").id(), page("p", b"b").id());
        assert_ne!(page("p", b"a").id(), page("q", b"a").id());
    }
}
