//! Which rows of a table are shown: `z > 0.5 and material = "red"`.
//!
//! Conditions are joined by `and`, which binds closer, and `or`. One on a column of names compares
//! it with a text; any other is a formula over the columns of numbers (`mve_core::Expression`)
//! that holds where it is neither 0 nor not a number. A row without a number that is asked for is
//! not shown.

use std::ops::Range;

use mve_core::Expression;

use super::columns::{AND, OR, SheetColumn};

/// Longest text, in bytes.
const LONGEST: usize = 1000;
/// Deepest nesting of conditions, so that reading cannot run out of stack.
const DEEPEST: usize = 16;

/// Where a part of a filter stands.
#[derive(Clone, Copy, Default)]
struct Place {
    /// Characters before it, which its error counts along.
    n_before: usize,
    /// Parentheses around it.
    depth: usize,
}

/// A checked filter for the columns that it was made for.
#[derive(Clone, Debug)]
pub struct Filter {
    /// A row is shown where all conditions of one of these hold.
    any: Vec<Vec<Condition>>,
}

#[derive(Clone, Debug)]
enum Condition {
    /// A formula over these columns.
    Formula(Expression, Vec<usize>),
    /// Conditions in parentheses.
    Group(Filter),
    /// A column of names.
    Name { column: usize, name: String, is_equal: bool },
}

impl Filter {
    /// Reads a filter; the error says what is wrong and where.
    pub fn compile(text: &str, columns: &[SheetColumn]) -> Result<Self, String> {
        if text.len() > LONGEST {
            return Err(format!("it is longer than {LONGEST} characters"));
        }
        let marks: Vec<usize> =
            text.chars().enumerate().filter(|(_, c)| *c == '"').map(|(at, _)| at).collect();
        if let (1, Some(last)) = (marks.len() % 2, marks.last()) {
            return Err(format!("column {}: the text behind \" has no second \"", last + 1));
        }
        Self::read(text, Place::default(), columns)
    }

    /// Reads a part of a filter.
    fn read(text: &str, place: Place, columns: &[SheetColumn]) -> Result<Self, String> {
        let any = split(text, OR).into_iter().map(|(from, part)| {
            let all = split(part, AND).into_iter().map(|(at, part)| {
                let n_before = place.n_before + text[..from + at].chars().count();
                condition(part, Place { n_before, ..place }, columns)
            });
            all.collect()
        });
        Ok(Self { any: any.collect::<Result<_, _>>()? })
    }

    /// Whether a row is shown.
    pub fn keeps(&self, columns: &[SheetColumn], element: usize) -> bool {
        self.any.iter().any(|all| all.iter().all(|one| one.holds(columns, element)))
    }
}

impl Condition {
    fn holds(&self, columns: &[SheetColumn], element: usize) -> bool {
        match self {
            Self::Formula(formula, of) => {
                let number = |&column: &usize| columns[column].number(element);
                let Some(values) = of.iter().map(number).collect::<Option<Vec<f64>>>() else {
                    return false;
                };
                let value = formula.eval(&values);
                value != 0.0 && !value.is_nan()
            }
            Self::Group(filter) => filter.keeps(columns, element),
            Self::Name { column, name, is_equal } => {
                columns[*column].text(element).is_some_and(|found| (found == *name) == *is_equal)
            }
        }
    }
}

/// The parts of a text between a word, each with its place. Words in quotation marks and in
/// parentheses join nothing.
fn split<'a>(text: &'a str, word: &str) -> Vec<(usize, &'a str)> {
    let is_letter = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let (mut parts, mut start) = (Vec::new(), 0);
    let (mut depth, mut is_quoted, mut last) = (0i32, false, ' ');
    for (at, c) in text.char_indices() {
        match c {
            '"' => is_quoted = !is_quoted,
            '(' if !is_quoted => depth += 1,
            ')' if !is_quoted => depth -= 1,
            _ => {}
        }
        let rest = &text[at..];
        let ends = || !rest[word.len()..].starts_with(is_letter);
        let is_word = !is_letter(last) && rest.starts_with(word) && ends();
        if is_word && !is_quoted && depth == 0 {
            parts.push((start, &text[start..at]));
            start = at + word.len();
        }
        last = c;
    }
    parts.push((start, &text[start..]));
    parts
}

/// Reads one condition.
fn condition(text: &str, place: Place, columns: &[SheetColumn]) -> Result<Condition, String> {
    if let Some(inside) = in_parentheses(text) {
        if place.depth == DEEPEST {
            return Err(format!("parentheses nest deeper than {DEEPEST} levels"));
        }
        let n_before = place.n_before + text[..inside.start].chars().count();
        let place = Place { n_before, depth: place.depth + 1 };
        let group = Filter::read(&text[inside], place, columns)?;
        return Ok(Condition::Group(group));
    }
    let is_letter = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let begun = text.trim_start();
    let name = begun.split(|c| !is_letter(c)).next().unwrap_or_default();
    let column = columns.iter().position(|column| column.name == name);
    if let Some(column) = column.filter(|at| !columns[*at].is_numeric()) {
        return name_condition(column, name, begun[name.len()..].trim());
    }
    let words = text.split(|c| !is_letter(c));
    let mut of: Vec<usize> = Vec::new();
    for word in words {
        let is_it = |column: &SheetColumn| column.name == word;
        let column = columns.iter().position(is_it).filter(|at| !of.contains(at));
        of.extend(column.filter(|at| columns[*at].is_numeric()));
    }
    // Blanks in the place of what stands before, so that an error names the right column.
    let text = format!("{}{text}", " ".repeat(place.n_before));
    let named: Vec<_> = of.iter().map(|&at| (columns[at].name.as_str(), "")).collect();
    let formula = Expression::compile(&text, &named).or_else(|_| {
        // An error lists all that there is.
        let numbers = columns.iter().filter(|column| column.is_numeric());
        let all: Vec<_> = numbers.map(|column| (column.name.as_str(), "")).collect();
        Expression::compile(&text, &all)
    })?;
    Ok(Condition::Formula(formula, of))
}

/// What the parentheses around a whole condition hold, where that is more than a formula.
fn in_parentheses(text: &str) -> Option<Range<usize>> {
    let start = text.len() - text.trim_start().len();
    let inside = text.trim().strip_prefix('(')?.strip_suffix(')')?;
    let mut depth = 0i32;
    // The first parenthesis is to be closed by the last one.
    let closes = |c: char| {
        depth += i32::from(c == '(') - i32::from(c == ')');
        depth < 0
    };
    if inside.chars().any(closes) {
        return None;
    }
    Some(start + 1..start + 1 + inside.len())
}

/// Reads what stands behind the name of a column of names.
fn name_condition(column: usize, name: &str, rest: &str) -> Result<Condition, String> {
    let signs = [("==", true), ("=", true), ("!=", false)];
    let found = signs
        .iter()
        .find_map(|(sign, is_equal)| Some((rest.strip_prefix(sign)?.trim(), *is_equal)));
    match found {
        Some((text, is_equal)) => {
            let quoted = text.strip_prefix('"').and_then(|text| text.strip_suffix('"'));
            let name = quoted.unwrap_or(text).to_owned();
            match name.contains('"') {
                true => Err(format!("{text} is not one text in quotation marks")),
                false => Ok(Condition::Name { column, name, is_equal }),
            }
        }
        None => Err(format!("\"{name}\" is a name: write {name} = \"…\" or {name} != \"…\"")),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use mve_modules::data::{Domain, Layer, LayerValues, NO_VALUE};
    use mve_modules::mesh::fixtures::mesh_of;

    use super::super::columns::mesh_columns;
    use super::*;

    /// Three triangles over x = 0, 3 and 6; the first is red, the second dark red, the third has no
    /// material.
    fn columns() -> Vec<SheetColumn> {
        let triangle = |x: f64| [[x, 0.0, 0.0], [x + 3.0, 0.0, 0.0], [x, 3.0, 0.0]];
        let points = [triangle(-1.0), triangle(2.0), triangle(5.0)].concat();
        let mut mesh = mesh_of(&points, &[[0, 1, 2], [3, 4, 5], [6, 7, 8]]);
        mesh.set_layer(Layer {
            name: "material".to_owned(),
            domain: Domain::Face,
            values: LayerValues::Label(vec!["red".to_owned(), "dark red and gold".to_owned()]),
            index: vec![0, 1, NO_VALUE],
        });
        mesh_columns(&Arc::new(mesh), Domain::Face, &[], None)
    }

    fn kept(text: &str) -> Vec<usize> {
        let columns = columns();
        let filter = Filter::compile(text, &columns).unwrap_or_else(|why| panic!("{text}: {why}"));
        (0..3).filter(|face| filter.keeps(&columns, *face)).collect()
    }

    #[test]
    fn conditions_on_numbers_and_names_are_joined() {
        let cases: [(&str, &[usize]); 18] = [
            ("x > 0", &[1, 2]),
            ("x = 3", &[1]),
            ("x == 3", &[1]),
            ("x>=3 and x<=3", &[1]),
            ("face = 0 or face = 2 and x < 0", &[0]),
            ("x < 1 or x > 4", &[0, 2]),
            ("(x < 1) + (x > 4)", &[0, 2]),
            ("material = \"red\"", &[0]),
            ("material = red", &[0]),
            ("material=\"dark red and gold\"", &[1]),
            // A face without a material is in neither.
            ("material != \"red\"", &[1]),
            ("material = \"red\" or x = 6", &[0, 2]),
            ("area", &[0, 1, 2]),
            ("(x < 1 or x > 4) and (material = red)", &[0]),
            (" ( x > 0 and ( y > 9 or x > 4 ) ) ", &[2]),
            ("(x) * (x - 3) = 0", &[0, 1]),
            ("((x > 0))", &[1, 2]),
            ("sqrt(-area) > 0", &[]),
        ];
        for (text, expected) in cases {
            assert_eq!(kept(text), expected, "{text}");
        }
    }

    #[test]
    fn an_error_says_where_and_what_there_is() {
        let columns = columns();
        let said = |text: &str| Filter::compile(text, &columns).unwrap_err();
        assert!(said("x > 0 and y >").starts_with("column 14: a value is missing"));
        assert!(said("x > 0 or hight > 1").starts_with("column 10: \"hight\" is not known"));
        assert!(said("hight").contains("there are face, a, b, c, x, y, z, area"));
        assert!(said("").starts_with("column 1: a value is missing"));
        assert!(said("material > 3").starts_with("\"material\" is a name: write"));
        assert!(said("x > 0 and").contains("column 10: a value is missing"));
        assert!(said("(x > 0 and y > )").starts_with("column 16: a value is missing"));
        assert!(said(&"(".repeat(100_000)).contains("longer than 1000"));
        let nested = |n: usize| format!("{}x{}", "(".repeat(n), ")".repeat(n));
        assert!(said(&nested(400)).contains("deeper than 16 levels"));
        assert!(Filter::compile(&nested(16), &columns).is_ok());
        assert!(said("(x > 0").starts_with("column 7: \")\" is missing"));
        assert!(said("x = 1 and y = 2 and z >").starts_with("column 24: a value is missing"));
        let two = said("material = \"red\" \"gold\"");
        assert!(two.ends_with("is not one text in quotation marks"), "{two}");
        let open = "x > 0 and material = \"red or x > 4";
        assert_eq!(said(open), "column 22: the text behind \" has no second \"");
    }
}
