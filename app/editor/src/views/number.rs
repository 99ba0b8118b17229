//! Numbers as people read them.

use mve_core::{Scalar, Value};

/// A value in a line: a number in at most six digits, else what the value says of itself.
pub fn brief_text(value: &Value) -> String {
    match value.scalar() {
        Some(Scalar::Number(number)) => number_text(number),
        _ => value.summary(),
    }
}

/// A number in at most six digits, by powers of ten where it is very large or small.
pub fn number_text(value: f64) -> String {
    if value.is_nan() {
        return "not a number".to_owned();
    }
    if value.is_infinite() {
        return if value > 0.0 { "∞" } else { "-∞" }.to_owned();
    }
    let size = value.abs();
    if size == 0.0 {
        return "0".to_owned();
    }
    if !(1e-4..1e7).contains(&size) {
        let text = format!("{value:.4e}");
        let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
        return format!("{}e{power}", trimmed(digits));
    }
    let whole_digits = size.log10().floor() as i32 + 1;
    let decimals = (6 - whole_digits).clamp(0, 9) as usize;
    trimmed(&format!("{value:.decimals$}")).to_owned()
}

/// How the numbers of one column are written, so that they can be compared at a glance: with as
/// many decimals each, or all by powers of ten.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnFormat {
    /// So many decimals; whole numbers have none.
    Decimals(usize),
    /// `4.4748e-4`.
    Powers,
}

/// Digits of a number that are shown beside others.
const WIDEST: i32 = 12;

impl ColumnFormat {
    /// The format for some numbers: six digits of the largest and four of the smallest, if they
    /// fit into one width.
    pub fn of(numbers: impl Iterator<Item = f64> + Clone) -> Self {
        let sizes = numbers.clone().filter(|n| n.is_finite() && *n != 0.0).map(f64::abs);
        let (low, high) = sizes
            .fold((f64::INFINITY, 0.0f64), |(low, high), size| (low.min(size), high.max(size)));
        if high == 0.0 {
            return Self::Decimals(0);
        }
        let digits = |size: f64| size.log10().floor() as i32 + 1;
        let needed = numbers.clone().all(|n| n.fract() == 0.0 || !n.is_finite());
        let decimals = match needed {
            true => 0,
            false => (6 - digits(high)).max(4 - digits(low)).max(0),
        };
        if digits(high).max(1) + decimals > WIDEST {
            return Self::Powers;
        }
        // No more than some number has use for.
        let used = |n: f64| {
            let text = format!("{n:.0$}", decimals as usize);
            trimmed(&text).split_once('.').map_or(0, |(_, decimals)| decimals.len())
        };
        Self::Decimals(numbers.filter(|n| n.is_finite()).map(used).max().unwrap_or(0))
    }

    /// A number of the column. One that the format would make 0 or too long, for it was not asked
    /// when the format was found, is written by itself.
    pub fn text(self, number: f64) -> String {
        let size = number.abs();
        if size == 0.0 || !size.is_finite() {
            return number_text(number);
        }
        match self {
            Self::Powers => format!("{number:.4e}"),
            Self::Decimals(_) if number.fract() == 0.0 && size < 1e15 => format!("{number:.0}"),
            Self::Decimals(decimals) => {
                let is_fit =
                    size < 10f64.powi(WIDEST) && size >= 0.5 * 0.1f64.powi(decimals as i32);
                if is_fit { format!("{number:.decimals$}") } else { number_text(number) }
            }
        }
    }
}

fn trimmed(text: &str) -> &str {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text }
}

/// A count with its digits in groups of three: `35,947`.
pub fn count_text(n: usize) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A count with its noun: `1 face`, `2 faces`.
pub fn counted(n: usize, one: &str, many: &str) -> String {
    format!("{} {}", count_text(n), if n == 1 { one } else { many })
}

/// Round numbers within a range: three to eight multiples of 1, 2 or 5 times a power of ten. The
/// ends of a range that has none.
pub fn round_numbers([low, high]: [f64; 2]) -> Vec<f64> {
    let rough = (0.5 * high - 0.5 * low) / 2.5;
    let power = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|digit| digit * power);
    let Some(step) = step.into_iter().find(|step| *step >= 0.999 * rough && step.is_normal())
    else {
        return if low < high { vec![low, high] } else { vec![low] };
    };
    let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
    if !(last - first >= 1.0 && last - first <= 20.0) {
        return if low < high { vec![low, high] } else { vec![low] };
    }
    // Adding 0 takes the sign of a zero away.
    (0..=(last - first) as usize).map(|k| (first + k as f64) * step + 0.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_right() {
        let cases = [
            (0.0, "0"),
            (-0.0, "0"),
            (1.0, "1"),
            (0.1 + 0.2, "0.3"),
            (123_456.789, "123457"),
            (1e9, "1e9"),
            (-2.5e-7, "-2.5e-7"),
            (1200.0, "1200"),
            (f64::NAN, "not a number"),
            (f64::NEG_INFINITY, "-∞"),
        ];
        for (value, expected) in cases {
            assert_eq!(number_text(value), expected);
        }
        assert_eq!(count_text(1_234_567), "1,234,567");
        assert_eq!(counted(1, "face", "faces"), "1 face");
        assert_eq!(counted(1000, "face", "faces"), "1,000 faces");
    }

    #[test]
    fn numbers_of_a_column_are_written_alike() {
        let texts = |numbers: &[f64]| {
            let format = ColumnFormat::of(numbers.iter().copied());
            numbers.iter().map(|number| format.text(*number)).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(texts(&[4.4748e-4, 0.0015155]), "0.00044748 0.00151550");
        assert_eq!(texts(&[0.5, 0.25, 1.0, f64::NAN]), "0.50 0.25 1 not a number");
        assert_eq!(texts(&[69_451.0, 3.0, 0.0]), "69451 3 0");
        assert_eq!(texts(&[1234.5, 0.001_25]), "1234.50000 0.00125");
        assert_eq!(texts(&[4.0e-9, 2.5, 1e9]), "4.0000e-9 2.5000e0 1.0000e9");
        assert_eq!(texts(&[]), "");
        // What the format was not found for.
        assert_eq!(ColumnFormat::Decimals(2).text(1e-5), "1e-5");
        assert_eq!(ColumnFormat::Decimals(2).text(f64::INFINITY), "∞");
        assert_eq!(ColumnFormat::Decimals(2).text(1.5e13 + 0.5), "1.5e13");
    }

    #[test]
    fn round_numbers_lie_within_the_range() {
        let texts: Vec<String> = round_numbers([0.0, 1.0]).into_iter().map(number_text).collect();
        assert_eq!(texts, ["0", "0.2", "0.4", "0.6", "0.8", "1"]);
        assert_eq!(round_numbers([-3.0, 7.0]), [-2.0, 0.0, 2.0, 4.0, 6.0]);
        assert_eq!(round_numbers([5.0, 5.0]), [5.0]);
        for range in [[f64::NAN; 2], [-1e308, 1e308], [1.0, 1.0 + 1e-16], [0.0, 5e-324]] {
            assert!(round_numbers(range).len() < 25);
        }
    }
}
