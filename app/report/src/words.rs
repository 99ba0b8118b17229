//! One and several of a thing, in sentences.

/// Several of what an axis is named for.
pub fn plural(name: &str) -> String {
    if name.ends_with('s') { format!("values of {name}") } else { format!("{name}s") }
}

/// One of what an axis is named for.
pub fn single(name: &str) -> String {
    if name.ends_with('s') { format!("value of {name}") } else { name.to_owned() }
}

/// `1 pair is`, `2 pairs are`.
pub fn pairs_are(n: usize) -> String {
    if n == 1 { "1 pair is".to_owned() } else { format!("{n} pairs are") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_group_is_named_as_one_and_as_several() {
        assert_eq!([single("model"), plural("model")], ["model", "models"]);
        assert_eq!(
            [single("segments"), plural("segments")],
            ["value of segments", "values of segments"]
        );
        assert_eq!([pairs_are(1), pairs_are(2)], ["1 pair is", "2 pairs are"]);
    }
}
