//! No line is wider than the formatter would make it, which leaves comments and prose alone.

use mve_tests::root;

use super::files;

/// Most signs in a line.
const WIDEST: usize = 100;

#[test]
fn lines_are_within_the_width() {
    let mut wrong = Vec::new();
    for path in files("rs") {
        let text = std::fs::read_to_string(&path).unwrap();
        for (place, line) in text.lines().enumerate() {
            // A text that is data or a sentence is easier to read in one piece.
            let is_text = line.contains('"') && !line.trim_start().starts_with("//");
            if !is_text && line.chars().count() > WIDEST {
                wrong.push(format!("{}:{}", path.display(), place + 1));
            }
        }
    }
    // The pages of modules are written by the program.
    for path in files("md").iter().filter(|path| !path.ends_with("docs/modules.md")) {
        let text = std::fs::read_to_string(path).unwrap();
        let mut is_code = false;
        for (place, line) in text.lines().enumerate() {
            is_code ^= line.trim_start().starts_with("```");
            // Tables, links and code cannot be wrapped.
            let is_whole = is_code || line.starts_with('|') || line.contains("](");
            if !is_whole && line.chars().count() > WIDEST {
                wrong.push(format!("{}:{}", path.display(), place + 1));
            }
        }
    }
    let architecture = std::fs::read_to_string(root().join("docs/ARCHITECTURE.md")).unwrap();
    assert!(architecture.lines().count() < 250, "docs/ARCHITECTURE.md: 250 lines or more");
    assert!(wrong.is_empty(), "{} lines are too wide:\n{}", wrong.len(), wrong.join("\n"));
}
