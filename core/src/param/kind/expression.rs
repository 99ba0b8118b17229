//! Formulas over declared variables: `2 * height^2 + min(1, slope)`.
//!
//! Numbers, variables and `pi`; `+ - * /` and `^`, which binds closest and from the right (`-x^2`
//! is `-(x^2)`); parentheses; one comparison `< <= > >= == !=`, or `=` for `==`, between two sums,
//! which is 1 or 0; and the functions of [`FUNCTIONS`]. All is arithmetic of IEEE 754 doubles, so a
//! division by zero or the root of a negative number gives infinity or not a number, which the
//! module has to expect.

use serde_json::{Value as Json, json};

use super::super::{Fault, OptionSpec, Param, ParamType, Setting, Structured};
use super::{Kind, Misfit, ParamKind};
use crate::data::{Data, DataType};
use crate::port::InputSpec;
use crate::problem::did_you_mean;

/// Longest text, in bytes.
const LONGEST: usize = 1000;
/// Deepest nesting, so that reading cannot run out of stack.
const DEEPEST: usize = 64;

/// A formula.
#[derive(Clone, Copy, Debug)]
pub struct ExpressionSpec {
    /// Where a map says nothing.
    pub default: &'static str,
    /// What it may name, each with what it is; [`Expression::eval`] takes values in this order.
    pub variables: &'static [(&'static str, &'static str)],
}

/// A checked formula.
#[derive(Clone, Debug)]
pub struct Expression {
    text: String,
    root: Term,
}

#[derive(Clone, Debug)]
enum Term {
    Number(f64),
    /// By its place among the declared ones.
    Variable(usize),
    Negative(Box<Term>),
    Both(Operator, Box<(Term, Term)>),
    Call(fn(f64) -> f64, Box<Term>),
    CallBoth(fn(f64, f64) -> f64, Box<(Term, Term)>),
    CallThree(fn(f64, f64, f64) -> f64, Box<[Term; 3]>),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    Equal,
    Unequal,
    And,
    Or,
}

use Operator::*;

impl Operator {
    fn apply(self, a: f64, b: f64) -> f64 {
        match self {
            Add => a + b,
            Subtract => a - b,
            Multiply => a * b,
            Divide => a / b,
            Power => a.powf(b),
            Less => f64::from(a < b),
            LessOrEqual => f64::from(a <= b),
            Greater => f64::from(a > b),
            GreaterOrEqual => f64::from(a >= b),
            Equal => f64::from(a == b),
            Unequal => f64::from(a != b),
            And => f64::from(a != 0.0 && b != 0.0),
            Or => f64::from(a != 0.0 || b != 0.0),
        }
    }
}

/// A function by the number of its arguments.
#[derive(Clone, Copy)]
enum Function {
    One(fn(f64) -> f64),
    Two(fn(f64, f64) -> f64),
    Three(fn(f64, f64, f64) -> f64),
}

/// The functions, by name. Angles are in radians; `log` is the natural logarithm. `step(edge, x)`
/// is 0 below the edge and 1 from there on, `clamp(x, low, high)` the nearest number of the range,
/// `mod(x, y)` what is left of x by y, with the sign of y, and `if(test, then, else)` the last of
/// them where the first is 0.
const FUNCTIONS: [(&str, Function); 20] = [
    ("sqrt", Function::One(f64::sqrt)),
    ("abs", Function::One(f64::abs)),
    ("min", Function::Two(f64::min)),
    ("max", Function::Two(f64::max)),
    ("sin", Function::One(f64::sin)),
    ("cos", Function::One(f64::cos)),
    ("tan", Function::One(f64::tan)),
    ("exp", Function::One(f64::exp)),
    ("log", Function::One(f64::ln)),
    ("floor", Function::One(f64::floor)),
    ("ceil", Function::One(f64::ceil)),
    ("round", Function::One(f64::round)),
    ("sign", Function::One(|x| if x == 0.0 || x.is_nan() { x } else { x.signum() })),
    ("pow", Function::Two(f64::powf)),
    ("atan2", Function::Two(f64::atan2)),
    ("mod", Function::Two(|x, y| x - y * (x / y).floor())),
    ("not", Function::One(|x| f64::from(x == 0.0))),
    ("step", Function::Two(|edge, x| f64::from(x >= edge))),
    ("clamp", Function::Three(clamp)),
    ("if", Function::Three(|test, then, other| if test == 0.0 { other } else { then })),
];

/// Unlike that of the standard library it takes any range; what is not a number stays so.
fn clamp(x: f64, low: f64, high: f64) -> f64 {
    if x.is_nan() { x } else { x.max(low).min(high) }
}

/// The name of the number.
const PI: &str = "pi";
/// The words between conditions.
const AND: &str = "and";
const OR: &str = "or";

impl Expression {
    /// Reads a formula; the error is a sentence that names the column, from 1.
    pub fn compile(text: &str, variables: &[(&str, &str)]) -> Result<Self, String> {
        if text.len() > LONGEST {
            return Err(format!("is longer than {LONGEST} characters"));
        }
        let mut reader = Reader { text, place: 0, depth: 0, variables };
        let root = reader.either()?;
        match reader.peek() {
            None => Ok(Self { text: text.to_owned(), root }),
            Some(c) => {
                let hint = match c {
                    '&' => ", which is written and",
                    '|' => ", which is written or",
                    '%' => "; mod(x, y) gives what is left of a division",
                    _ => "",
                };
                Err(reader.fault(&format!("an operator is expected, not \"{c}\"{hint}")))
            }
        }
    }

    /// Its value where the declared variables have these values; a missing one is not a number.
    pub fn eval(&self, variables: &[f64]) -> f64 {
        self.root.eval(variables)
    }

    /// Whether the value depends on the variable at this place of the declared ones.
    pub fn names(&self, place: usize) -> bool {
        self.root.names(place)
    }

    /// Whether a name means something in every formula, so that no variable can have it.
    pub fn has_meaning(name: &str) -> bool {
        [PI, AND, OR].contains(&name) || FUNCTIONS.iter().any(|(known, _)| *known == name)
    }

    /// As the map says it.
    pub fn text(&self) -> &str {
        &self.text
    }
}

impl Term {
    fn eval(&self, variables: &[f64]) -> f64 {
        match self {
            Self::Number(number) => *number,
            Self::Variable(place) => variables.get(*place).copied().unwrap_or(f64::NAN),
            Self::Negative(term) => -term.eval(variables),
            Self::Both(operator, terms) => {
                operator.apply(terms.0.eval(variables), terms.1.eval(variables))
            }
            Self::Call(function, term) => function(term.eval(variables)),
            Self::CallBoth(function, terms) => {
                function(terms.0.eval(variables), terms.1.eval(variables))
            }
            Self::CallThree(function, terms) => {
                let [a, b, c] = [0, 1, 2].map(|k: usize| terms[k].eval(variables));
                function(a, b, c)
            }
        }
    }

    fn names(&self, place: usize) -> bool {
        match self {
            Self::Number(_) => false,
            Self::Variable(own) => *own == place,
            Self::Negative(term) | Self::Call(_, term) => term.names(place),
            Self::Both(_, terms) | Self::CallBoth(_, terms) => {
                terms.0.names(place) || terms.1.names(place)
            }
            Self::CallThree(_, terms) => terms.iter().any(|term| term.names(place)),
        }
    }
}

/// Reads by recursive descent, one method a level of the grammar.
struct Reader<'a> {
    text: &'a str,
    /// Bytes read.
    place: usize,
    depth: usize,
    variables: &'a [(&'a str, &'a str)],
}

impl Reader<'_> {
    fn rest(&self) -> &str {
        &self.text[self.place..]
    }

    fn peek(&mut self) -> Option<char> {
        let rest = self.rest();
        self.place += rest.len() - rest.trim_start().len();
        self.rest().chars().next()
    }

    fn fault(&self, why: &str) -> String {
        self.fault_at(self.place, why)
    }

    fn fault_at(&self, place: usize, why: &str) -> String {
        format!("column {}: {why}", self.text[..place].chars().count() + 1)
    }

    /// Takes the first of these signs that stands here.
    fn take(&mut self, signs: &[(&str, Operator)]) -> Option<Operator> {
        self.peek()?;
        let found = signs.iter().find(|(sign, _)| self.rest().starts_with(sign))?;
        self.place += found.0.len();
        Some(found.1)
    }

    fn expect(&mut self, sign: char, behind: &str) -> Result<(), String> {
        match self.peek() {
            Some(found) if found == sign => self.place += 1,
            Some(found) => {
                return Err(
                    self.fault(&format!("\"{sign}\" is expected {behind}, not \"{found}\""))
                );
            }
            None => return Err(self.fault(&format!("\"{sign}\" is missing {behind}"))),
        }
        Ok(())
    }

    /// Takes a word, if it stands here as a whole.
    fn take_word(&mut self, word: &str) -> bool {
        self.peek();
        let is_end = |c: char| !(c.is_ascii_alphanumeric() || c == '_');
        let is_here =
            self.rest().strip_prefix(word).is_some_and(|r| r.chars().next().is_none_or(is_end));
        self.place += if is_here { word.len() } else { 0 };
        is_here
    }

    fn either(&mut self) -> Result<Term, String> {
        let mut left = self.both()?;
        while self.take_word(OR) {
            left = Term::Both(Or, Box::new((left, self.both()?)));
        }
        Ok(left)
    }

    fn both(&mut self) -> Result<Term, String> {
        let mut left = self.comparison()?;
        while self.take_word(AND) {
            left = Term::Both(And, Box::new((left, self.comparison()?)));
        }
        Ok(left)
    }

    fn comparison(&mut self) -> Result<Term, String> {
        const SIGNS: [(&str, Operator); 7] = [
            ("<=", LessOrEqual),
            (">=", GreaterOrEqual),
            ("==", Equal),
            ("=", Equal),
            ("!=", Unequal),
            ("<", Less),
            (">", Greater),
        ];
        let left = self.sum()?;
        let Some(operator) = self.take(&SIGNS) else { return Ok(left) };
        let right = self.sum()?;
        self.peek();
        let behind = self.place;
        if self.take(&SIGNS).is_some() {
            return Err(self.fault_at(behind, "put one of two comparisons into parentheses"));
        }
        Ok(Term::Both(operator, Box::new((left, right))))
    }

    fn sum(&mut self) -> Result<Term, String> {
        let mut left = self.product()?;
        // A chain is evaluated as deep as it is long, which the length of the text bounds.
        while let Some(operator) = self.take(&[("+", Add), ("-", Subtract)]) {
            left = Term::Both(operator, Box::new((left, self.product()?)));
        }
        Ok(left)
    }

    fn product(&mut self) -> Result<Term, String> {
        let mut left = self.signed()?;
        while let Some(operator) = self.take(&[("*", Multiply), ("/", Divide)]) {
            left = Term::Both(operator, Box::new((left, self.signed()?)));
        }
        Ok(left)
    }

    fn signed(&mut self) -> Result<Term, String> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.fault(&format!("is nested deeper than {DEEPEST} levels")));
        }
        let term = match self.take(&[("-", Subtract), ("+", Add)]) {
            Some(Subtract) => Term::Negative(Box::new(self.signed()?)),
            Some(_) => self.signed()?,
            None => self.power()?,
        };
        self.depth -= 1;
        Ok(term)
    }

    fn power(&mut self) -> Result<Term, String> {
        let base = self.operand()?;
        match self.take(&[("^", Power)]) {
            Some(operator) => Ok(Term::Both(operator, Box::new((base, self.signed()?)))),
            None => Ok(base),
        }
    }

    fn operand(&mut self) -> Result<Term, String> {
        match self.peek() {
            Some('(') => {
                self.place += 1;
                let inside = self.either()?;
                self.expect(')', "behind what is in parentheses")?;
                Ok(inside)
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if c.is_ascii_alphabetic() || c == '_' => self.name(),
            Some('*') if self.text[..self.place].trim_end().ends_with('*') => {
                Err(self.fault("a value is expected, not \"*\"; a power is written x^y"))
            }
            Some(c) => Err(self.fault(&format!("a value is expected, not \"{c}\""))),
            None => Err(self.fault("a value is missing at the end")),
        }
    }

    fn number(&mut self) -> Result<Term, String> {
        let rest = self.rest().as_bytes();
        let digits = |from: usize| rest[from..].iter().take_while(|b| b.is_ascii_digit()).count();
        let mut end = digits(0);
        if rest.get(end) == Some(&b'.') {
            end += 1 + digits(end + 1);
        }
        if matches!(rest.get(end), Some(b'e' | b'E')) {
            let sign = usize::from(matches!(rest.get(end + 1), Some(b'+' | b'-')));
            let n = digits((end + 1 + sign).min(rest.len()));
            end += if n > 0 { 1 + sign + n } else { 0 };
        }
        let text = &self.rest()[..end];
        let number = text.parse().ok().filter(|number: &f64| number.is_finite());
        let number = number.ok_or_else(|| self.fault(&format!("\"{text}\" is no number")))?;
        self.place += end;
        Ok(Term::Number(number))
    }

    fn name(&mut self) -> Result<Term, String> {
        let start = self.place;
        let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let end = self.rest().find(|c| !is_part(c)).unwrap_or(self.rest().len());
        let name = self.rest()[..end].to_owned();
        self.place += end;
        if let Some((_, function)) = FUNCTIONS.iter().find(|(known, _)| *known == name) {
            return self.call(&name, *function);
        }
        if let Some(place) = self.variables.iter().position(|(known, _)| *known == name) {
            return Ok(Term::Variable(place));
        }
        if name == PI {
            return Ok(Term::Number(std::f64::consts::PI));
        }
        let known = || self.variables.iter().map(|(name, _)| *name);
        // What stands before a parenthesis is meant as a function, and nothing else is.
        let hint = match self.peek() {
            Some('(') => did_you_mean(&name, FUNCTIONS.iter().map(|(name, _)| *name)),
            _ => did_you_mean(&name, known()),
        };
        let all = match self.peek() {
            Some('(') => FUNCTIONS.map(|(name, _)| name).join(", "),
            _ => known().collect::<Vec<_>>().join(", "),
        };
        let all = if all.is_empty() { String::new() } else { format!("; there are {all}") };
        Err(self.fault_at(start, &format!("\"{name}\" is not known{all}{hint}")))
    }

    fn call(&mut self, name: &str, function: Function) -> Result<Term, String> {
        self.expect('(', &format!("behind {name}"))?;
        let first = self.either()?;
        let term = match function {
            Function::One(function) => Term::Call(function, Box::new(first)),
            Function::Two(function) => {
                self.expect(',', &format!("between the two values of {name}"))?;
                Term::CallBoth(function, Box::new((first, self.either()?)))
            }
            Function::Three(function) => {
                self.expect(',', &format!("behind the first value of {name}"))?;
                let second = self.either()?;
                self.expect(',', &format!("behind the second value of {name}"))?;
                Term::CallThree(function, Box::new([first, second, self.either()?]))
            }
        };
        self.expect(')', &format!("behind the values of {name}"))?;
        Ok(term)
    }
}

impl ParamKind for ExpressionSpec {
    fn default_json(&self) -> Option<Json> {
        Some(Json::from(self.default))
    }

    fn parse(&self, json: &Json, _: &mut Vec<Fault>) -> Result<Setting, Misfit> {
        let text = json.as_str();
        let text = text.ok_or_else(|| Misfit::Expected("a formula, as a text".to_owned()))?;
        let formula = Expression::compile(text, self.variables).map_err(Misfit::Sentence)?;
        Ok(Setting::Structured(Structured::new(Json::from(text), formula)))
    }

    fn schema(&self) -> Json {
        json!({ "type": "string", "minLength": 1, "maxLength": LONGEST })
    }

    fn noun(&self) -> String {
        "formula over the variables below".to_owned()
    }

    fn fault(&self, _: &[InputSpec]) -> Option<String> {
        let mut names = self.variables.iter().map(|(name, _)| *name);
        if let Some(name) = names.find(|name| Expression::has_meaning(name)) {
            return Some(format!("the name \"{name}\" of a variable is taken"));
        }
        Expression::compile(self.default, self.variables).err()
    }

    fn examples(&self) -> Vec<Json> {
        let variables = self.variables.iter();
        let of_variables = variables.map(|(name, _)| json!(format!("{name} - 1")));
        [json!("0"), json!("-1 / 0"), json!("sqrt(-1)")].into_iter().chain(of_variables).collect()
    }

    fn link_type(&self) -> Option<DataType> {
        Some(String::TYPE)
    }

    fn parts(&self) -> Vec<OptionSpec> {
        let part = |&(id, summary)| OptionSpec { id, summary, params: &[] };
        self.variables.iter().map(part).collect()
    }
}

impl Param<Expression> {
    /// A formula over these variables, each with what it is.
    pub const fn expression(
        name: &'static str,
        doc: &'static str,
        default: &'static str,
        variables: &'static [(&'static str, &'static str)],
    ) -> Self {
        Self::of_kind(name, doc, Kind::Expression(ExpressionSpec { default, variables }))
    }
}

impl ParamType for Expression {
    fn from_setting(setting: &Setting) -> Option<Self> {
        setting.structured()
    }
}

#[cfg(test)]
#[path = "expression_tests.rs"]
mod tests;
