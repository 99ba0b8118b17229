//! Tests of formulas.

use super::*;

const XY: &[(&str, &str)] = &[("x", "One."), ("height", "Two.")];

fn value(text: &str) -> f64 {
    Expression::compile(text, XY).unwrap_or_else(|e| panic!("{text}: {e}")).eval(&[3.0, 0.5])
}

#[test]
fn formulas_have_the_values_of_school() {
    let cases = [
        ("1 + 2 * 3", 7.0),
        ("(1 + 2) * 3", 9.0),
        ("2 ^ 3 ^ 2", 512.0),
        ("-x^2", -9.0),
        ("2^-1", 0.5),
        ("7 - 2 - 1", 4.0),
        ("8 / 4 / 2", 1.0),
        ("--x + +1", 4.0),
        ("1.5e1 + .5 + 2.", 17.5),
        ("min(x, 1) + max(height, 2)", 3.0),
        ("sqrt(abs(-16)) + floor(2.7)", 6.0),
        ("cos(pi) + sin(0) + exp(0) + log(1)", 0.0),
        ("ceil(height) + round(2.5) + tan(0)", 4.0),
        ("(x > 2) * 10 + (x <= 2)", 10.0),
        ("height == 0.5", 1.0),
        ("height = 0.5", 1.0),
        ("1 + 1 != 2", 0.0),
        ("x >= 3", 1.0),
        ("1 < 0.5", 0.0),
        ("pow(x, 2) + atan2(0, 1)", 9.0),
        ("step(3, x) + 10 * step(3.5, x)", 1.0),
        ("clamp(x, 0, 1) + clamp(-x, 0, 1) + clamp(height, 0, 1)", 1.5),
        ("if(x > 2, height, 1 / 0) + sign(-x) + sign(0)", -0.5),
    ];
    for (text, expected) in cases {
        assert_eq!(value(text), expected, "{text}");
    }
    assert!(value("sqrt(-1)").is_nan());
    assert_eq!(value("1 / 0"), f64::INFINITY);
    assert!(Expression::compile("x", XY).unwrap().eval(&[]).is_nan());
    let names = |text| [0, 1].map(|place| Expression::compile(text, XY).unwrap().names(place));
    assert_eq!(names("if(1, 2, -(x + 1))"), [true, false]);
    assert_eq!(names("max(1, sqrt(height))"), [false, true]);
    assert!(value("clamp(0 / 0, 0, 1)").is_nan());
}

#[test]
fn each_fault_names_its_column() {
    let said = |text: &str| Expression::compile(text, XY).unwrap_err();
    assert_eq!(said("1 +"), "column 4: a value is missing at the end");
    assert_eq!(said(""), "column 1: a value is missing at the end");
    assert_eq!(said("1 + * 2"), "column 5: a value is expected, not \"*\"");
    assert_eq!(said("2 x"), "column 3: an operator is expected, not \"x\"");
    assert!(said("1 + heigth").starts_with("column 5: \"heigth\" is not known; there are x"));
    assert!(said("heigth").ends_with("did you mean \"height\"?"));
    assert!(said("sqrtt(2)").ends_with("did you mean \"sqrt\"?"));
    // A function is not meant where nothing is called.
    assert!(!said("floo > 1").contains("did you mean"));
    assert!(said("(1 + 2").starts_with("column 7: \")\" is missing"));
    assert!(said("1 + 2)").starts_with("column 6: an operator is expected"));
    assert!(said("sqrt 4").starts_with("column 6: \"(\" is expected behind sqrt"));
    assert!(said("min(1)").starts_with("column 6: \",\" is expected between"));
    assert!(said("abs(1, 2)").starts_with("column 6: \")\" is expected"));
    assert!(said("1 < 2 < 3").starts_with("column 7: put one of two"));
    assert_eq!(said("1e999"), "column 1: \"1e999\" is no number");
    assert_eq!(said("."), "column 1: \".\" is no number");
    assert!(said("é").starts_with("column 1: a value is expected"));
    assert!(said("1 é").starts_with("column 3: "));
}

#[test]
fn depth_and_length_are_bounded() {
    let nested = |n: usize| format!("{}1{}", "(".repeat(n), ")".repeat(n));
    assert_eq!(value(&nested(60)), 1.0);
    let said = |text: &str| Expression::compile(text, XY).unwrap_err();
    assert!(said(&nested(200)).contains("deeper than 64 levels"));
    assert!(said(&"-".repeat(900)).contains("deeper than 64 levels"));
    assert!(said(&"2^".repeat(400)).contains("deeper than 64 levels"));
    assert!(said(&" ".repeat(2000)).contains("longer than 1000"));
    assert_eq!(value(&["1"; 400].join("+")), 400.0);
}

#[test]
fn no_variable_has_the_name_of_a_function_or_of_pi() {
    let fault = |variables| ExpressionSpec { default: "1", variables }.fault(&[]);
    assert_eq!(fault(XY), None);
    for variables in [&[("x", "One."), ("min", "Two.")], &[("x", "One."), ("pi", "Three.")]] {
        assert!(fault(variables).unwrap().contains("of a variable is taken"));
    }
}

#[test]
fn conditions_are_joined_by_words() {
    let at =
        |text: &str, x: f64| Expression::compile(text, &[("x", "A number.")]).unwrap().eval(&[x]);
    for (x, expected) in [(-1.0, 1.0), (0.5, 0.0), (1.5, 1.0), (3.0, 0.0)] {
        assert_eq!(at("x < 0 or x > 1 and not(x > 2)", x), expected, "{x}");
    }
    assert_eq!((at("mod(x, 3)", 7.5), at("mod(x, 3)", -1.0)), (1.5, 2.0));
    let said = |text| Expression::compile(text, &[("x", ""), ("android", "")]).unwrap_err();
    assert!(said("x & 1").ends_with("not \"&\", which is written and"));
    assert!(said("x ** 2").ends_with("a power is written x^y"));
    assert!(said("sqroot(x)").contains("there are sqrt, abs,"));
    assert!(Expression::compile("android > 1 and x > 0", &[("x", ""), ("android", "")]).is_ok());
}
