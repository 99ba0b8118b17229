//! The canonical text of a map: made to be read and reviewed line by line.

use serde_json::Value as Json;

/// Longest line; what fits stands on one.
const WIDTH: usize = 100;

/// Sections are broken down to one entry a line, so that a change of a node is a change of a line.
const ALWAYS_BROKEN: usize = 2;

/// The text of a map's JSON, with one newline at its end.
pub(super) fn canonical(json: &Json) -> String {
    let mut text = String::new();
    write(json, 0, 0, &mut text);
    text.push('\n');
    text
}

/// Writes `json` at nesting `depth`; `used` columns of its first line are taken.
fn write(json: &Json, depth: usize, used: usize, text: &mut String) {
    let flat = flat(json);
    let is_scalar = !(json.is_object() || json.is_array());
    let is_short = used + flat.chars().count() < WIDTH;
    if is_scalar || flat == "{}" || flat == "[]" || (depth >= ALWAYS_BROKEN && is_short) {
        return text.push_str(&flat);
    }
    let indent = "  ".repeat(depth + 1);
    let entry = |key: String, value: &Json, is_first: bool, text: &mut String| {
        text.push_str(if is_first { "\n" } else { ",\n" });
        text.push_str(&indent);
        text.push_str(&key);
        write(value, depth + 1, indent.len() + key.chars().count() + 1, text);
    };
    let close = match json {
        Json::Array(items) => {
            text.push('[');
            for (place, item) in items.iter().enumerate() {
                entry(String::new(), item, place == 0, text);
            }
            ']'
        }
        Json::Object(fields) => {
            text.push('{');
            for (place, (name, value)) in fields.iter().enumerate() {
                entry(format!("{}: ", Json::from(name.as_str())), value, place == 0, text);
            }
            '}'
        }
        _ => return,
    };
    text.push('\n');
    text.push_str(&"  ".repeat(depth));
    text.push(close);
}

/// The JSON on one line, with spaces where a person would put them.
fn flat(json: &Json) -> String {
    match json {
        Json::Array(items) => {
            format!("[{}]", items.iter().map(flat).collect::<Vec<_>>().join(", "))
        }
        Json::Object(fields) if fields.is_empty() => "{}".to_owned(),
        Json::Object(fields) => {
            let fields = fields
                .iter()
                .map(|(name, value)| format!("{}: {}", Json::from(name.as_str()), flat(value)));
            format!("{{ {} }}", fields.collect::<Vec<_>>().join(", "))
        }
        scalar => scalar.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_node_is_a_line() {
        let json = serde_json::json!({
            "mve": 1,
            "nodes": { "a": { "module": "Box", "params": { "size": [1.0, 2] } }, "b": {} },
            "links": []
        });
        let expected = "{\n  \"mve\": 1,\n  \"nodes\": {\n    \
            \"a\": { \"module\": \"Box\", \"params\": { \"size\": [1.0, 2] } },\n    \
            \"b\": {}\n  },\n  \"links\": []\n}\n";
        assert_eq!(canonical(&json), expected);
    }
}
