//! Answers to the questions of a program: the steps that agree in all but one parameter are paired.
//!
//! Of a pair the ratio of its two values counts, since models differ in scale; the average of
//! ratios is their geometric mean.

use std::collections::HashSet;

use indexmap::IndexMap;
use mve_core::{Better, Question};
use serde_json::Value as Json;

use crate::case::Case;
use crate::change::ChangeForm;
use crate::columns::{self, MeasureColumn};
use crate::labels;
use crate::pairs::{Pair, order, pair, pairs, side};
use crate::results::Results;
use crate::stats::{RatioEstimate, geometric_mean, sign_test, wilcoxon};
use crate::words::{pairs_are, plural, single};

/// Changes below this share are not told as numbers.
const HARDLY: f64 = 5e-5;

/// The probability below which a difference counts as shown, as is usual.
const SHOWN: f64 = 0.05;

/// What the data say to a question.
pub struct Answer {
    /// The question.
    pub text: String,
    /// The measure's name for a person.
    pub measure: String,
    /// Which values of it are better.
    pub better: Better,
    /// Whether the two are ways to measure, of which none is the better one.
    is_instrument: bool,
    /// The two things that are compared.
    pub names: [String; 2],
    /// Titles of the columns that should be the same in both.
    pub same_titles: Vec<String>,
    /// The pairs.
    pub pairs: Vec<Pair>,
    /// Pairs of which a step did not reach its target.
    pub n_missed: usize,
    /// Other pairs whose results differ in size by more than 1 %.
    pub n_unequal: usize,
    /// Steps on either side that have no partner or no value.
    pub n_alone: usize,
    /// Pairs whose first value is lower.
    pub n_lower: usize,
    /// Pairs whose first value is higher.
    pub n_higher: usize,
    /// The geometric mean of the ratios.
    pub overall: Option<RatioEstimate>,
    /// The same of each row's own pairs.
    pub by_group: IndexMap<usize, RatioEstimate>,
    /// The same of those, each row counted once.
    pub over_groups: Option<RatioEstimate>,
    /// Probability of the ratios, if there were no difference, by Wilcoxon's test.
    pub p_ranks: Option<f64>,
    /// The same by the signs alone.
    pub p_signs: f64,
    /// The answer in plain sentences, the first the most important.
    pub sentences: Vec<String>,
}

/// Answers a question from the results.
pub fn answer(results: &Results, measures: &[MeasureColumn], question: &Question) -> Answer {
    let known = measures.iter().find(|measure| measure.column == question.measure).cloned();
    let measure = known.unwrap_or_else(|| columns::of_column(results, &question.measure).remove(0));
    let size = results.size.iter().filter(|size| **size != question.measure);
    let same = match question.same.is_empty() {
        true => size.cloned().collect(),
        false => question.same.clone(),
    };
    let (path, sides) = match question.compare.iter().next() {
        Some((path, sides)) => (path.as_str(), sides.clone()),
        None => ("", [Json::Null, Json::Null]),
    };
    let sides_of = [side(results, path, &sides[0]), side(results, path, &sides[1])];
    let found = pairs(path, &sides, &sides_of);
    let has_missed = |(a, b): &(&Case, &Case)| [a, b].iter().any(|case| case.missed().is_some());
    let (missed, found): (Vec<_>, Vec<_>) = found.into_iter().partition(has_missed);
    let (unequal, found): (Vec<_>, Vec<_>) = found.into_iter().partition(|(a, b)| {
        question.same.is_empty() && !same.is_empty() && !results.are_alike(&[Some(a), Some(b)])
    });
    // A case may be the partner of several, so that cases are counted and not twice the pairs.
    let place = |case: &Case| std::ptr::from_ref(case);
    let mut used: HashSet<*const Case> =
        missed.iter().chain(&unequal).flat_map(|(a, b)| [place(a), place(b)]).collect();
    let mut pairs: Vec<Pair> = Vec::new();
    for (a, b) in found {
        if let Some(pair) = pair(results, [a, b], path, &measure, &same) {
            pairs.push(pair);
            used.extend([place(a), place(b)]);
        }
    }
    let all: HashSet<*const Case> =
        sides_of.iter().flatten().map(|case| std::ptr::from_ref(*case)).collect();
    let n_alone = all.difference(&used).count();
    let is_instrument = measure.is_set_by(results, path);
    let mut answer = Answer {
        text: question.text.clone(),
        measure: measure.title,
        better: if is_instrument { Better::Neither } else { measure.better },
        is_instrument,
        names: sides.map(|side| results.name_of(path, &side)),
        same_titles: same.iter().map(|column| columns::title(results, measures, column)).collect(),
        n_missed: missed.len(),
        n_unequal: unequal.len(),
        n_alone,
        n_lower: pairs.iter().filter(|pair| order(pair) < 0).count(),
        n_higher: pairs.iter().filter(|pair| order(pair) > 0).count(),
        overall: None,
        by_group: IndexMap::new(),
        over_groups: None,
        p_ranks: None,
        p_signs: 1.0,
        sentences: Vec::new(),
        pairs,
    };
    answer.compute();
    answer.sentences = answer.in_words(results);
    answer
}

impl Answer {
    fn compute(&mut self) {
        let ratios: Vec<f64> = self.pairs.iter().filter_map(|pair| pair.ratio).collect();
        self.overall = geometric_mean(&ratios);
        let mut groups: IndexMap<usize, Vec<f64>> = IndexMap::new();
        for pair in &self.pairs {
            groups.entry(pair.group).or_default().extend(pair.ratio);
        }
        let means = groups.iter().filter_map(|(group, r)| Some((*group, geometric_mean(r)?)));
        self.by_group = means.collect();
        let means: Vec<f64> = self.by_group.values().map(|estimate| estimate.ratio).collect();
        self.over_groups = geometric_mean(&means);
        let logarithms: Vec<f64> = self
            .pairs
            .iter()
            .filter_map(|pair| pair.ratio.map(|r| if order(pair) == 0 { 0.0 } else { r.ln() }))
            .collect();
        self.p_ranks = wilcoxon(&logarithms);
        self.p_signs = sign_test(self.n_lower, self.n_higher);
    }

    /// Whether the data show a difference, by the interval and by the test.
    pub fn is_shown(&self) -> bool {
        // Where the pairs of one group are not independent, their averages must show it as well.
        let is_off_over_groups =
            self.over_groups.is_none_or(|over| over.interval.is_none() || is_off(over));
        self.is_shown_by_pairs() && is_off_over_groups
    }

    /// The same, were all pairs independent.
    fn is_shown_by_pairs(&self) -> bool {
        let p = self.p_ranks.unwrap_or(self.p_signs);
        self.overall.is_some_and(is_off) && p < SHOWN
    }

    fn in_words(&self, results: &Results) -> Vec<String> {
        let [a, b] = &self.names;
        let n = self.pairs.len();
        let mut sentences = Vec::new();
        match self.overall {
            _ if n == 0 && self.n_missed + self.n_unequal > 0 => {
                sentences.push(format!("No two steps with {a} and with {b} can be compared."));
            }
            _ if n == 0 => {
                sentences.push(format!("No two steps with {a} and with {b} can be paired yet."));
            }
            None => sentences.push(self.without_average()),
            Some(overall) => sentences.push(self.lead(results, overall)),
        }
        let n_ratios = self.n_ratios();
        if self.overall.is_some() && n_ratios < n {
            let left = n - n_ratios;
            sentences.push(format!(
                "{} without a ratio, as a value is 0 or below, counted among the lower and higher \
                 ones only.",
                pairs_are(left)
            ));
        }
        if let Some(over) = self.averaged().filter(|over| self.is_added(*over)) {
            sentences.push(format!(
                "With the pairs of each {} averaged first, since they are not independent: {} \
                 (geometric mean of {}{}).",
                single(&group_name(results)),
                self.form().change(over.ratio),
                over.n,
                self.interval(over)
            ));
        }
        if self.is_instrument {
            sentences.push(format!(
                "{a} and {b} are ways to measure it, so none of them is the better one."
            ));
        }
        sentences.extend(self.same_in_words());
        sentences.extend(self.left_out_in_words());
        sentences
    }

    /// The most important sentence where no pair has a ratio.
    fn without_average(&self) -> String {
        let ([a, b], m, n) = (&self.names, &self.measure, self.pairs.len());
        if self.n_lower + self.n_higher == 0 {
            return self.equal();
        }
        format!(
            "“{m}” is lower with {a} than with {b} in {} of {n} pairs and higher in {} (p {} by the \
             sign test); values of 0 have no ratio, so there is no average.",
            self.n_lower,
            self.n_higher,
            labels::probability(self.p_signs)
        )
    }

    /// What does not count, and why.
    fn left_out_in_words(&self) -> Vec<String> {
        let mut sentences = Vec::new();
        let left_out = [
            (self.n_missed, "a step did not reach its target"),
            (self.n_unequal, "the results differ in size by more than 1\u{a0}%"),
        ];
        for (n, why) in left_out.into_iter().filter(|(n, _)| *n > 0) {
            sentences.push(format!("{} left out, as {why}.", pairs_are(n)));
        }
        if self.n_alone > 0 {
            let n = self.n_alone;
            sentences.push(match n {
                1 => "1 case has no partner or no value and does not count.".to_owned(),
                n => format!("{n} cases have no partner or no value and do not count."),
            });
        }
        sentences
    }

    fn n_ratios(&self) -> usize {
        self.pairs.iter().filter(|pair| pair.ratio.is_some()).count()
    }

    /// The mean over the groups, where there are several and it is not that of the pairs.
    fn averaged(&self) -> Option<RatioEstimate> {
        let n = self.by_group.len();
        self.over_groups.filter(|_| n > 1 && n < self.n_ratios())
    }

    /// How all changes of this answer are said.
    fn form(&self) -> ChangeForm {
        let all = self.overall.into_iter().chain(self.averaged());
        ChangeForm::of_estimates(&all.collect::<Vec<_>>())
    }

    /// The interval of a mean, to stand behind it.
    fn interval(&self, estimate: RatioEstimate) -> String {
        estimate.interval.map_or(String::new(), |(low, high)| {
            format!(", 95\u{a0}% confidence interval {}", self.form().span(low, high))
        })
    }

    /// Whether the pairs show a difference that the averages of the groups do not.
    fn is_by_groups_alone(&self, over: RatioEstimate) -> bool {
        let over_groups = over.interval.is_some() && !is_off(over);
        over_groups && self.is_shown_by_pairs() && self.overall.is_some()
    }

    /// Whether the mean over the groups stands behind the most important sentence.
    fn is_added(&self, over: RatioEstimate) -> bool {
        let is_tested = self.overall.is_some_and(|overall| self.without_test(overall).is_none());
        is_tested && !self.is_by_groups_alone(over)
    }

    /// The most important sentence where the two values of each pair are equal, or where there is
    /// but one pair: then there is nothing to test.
    fn without_test(&self, overall: RatioEstimate) -> Option<String> {
        let ([a, b], m) = (&self.names, &self.measure);
        let most = self.pairs.iter().map(|pair| (pair.ratio.unwrap_or(0.0) - 1.0).abs());
        let most = most.fold(0.0, f64::max);
        if self.n_lower + self.n_higher == 0 {
            return Some(self.equal());
        }
        if most < HARDLY {
            let pairs = all_pairs(self.pairs.len());
            let percent = labels::rounded(100.0 * HARDLY, 1);
            return Some(format!(
                "“{m}” differs by less than {percent}\u{a0}% with {a} and with {b} in {pairs}."
            ));
        }
        let is_only = self.pairs.len() == 1;
        is_only.then(|| {
            let change = self.form().change(overall.ratio);
            format!(
                "“{m}” is {change} with {a} than with {b} in the only pair; one pair does not tell \
                 whether others would be alike."
            )
        })
    }

    /// That the values of all pairs are equal.
    fn equal(&self) -> String {
        let ([a, b], pairs) = (&self.names, all_pairs(self.pairs.len()));
        format!("“{}” is equal with {a} and with {b} in {pairs}.", self.measure)
    }

    /// The most important sentence. Why nothing is shown stands first, where nothing is.
    fn lead(&self, results: &Results, overall: RatioEstimate) -> String {
        if let Some(sentence) = self.without_test(overall) {
            return sentence;
        }
        let ([a, b], m) = (&self.names, &self.measure);
        let pairs = if overall.n == 1 { "1 pair".into() } else { format!("{} pairs", overall.n) };
        let change = self.form().change(overall.ratio);
        let (interval, counts) = (self.interval(overall), self.counts(overall));
        if let Some(over) = self.averaged().filter(|over| self.is_by_groups_alone(*over)) {
            let group = group_name(results);
            let reason = match over.n {
                2..=5 => format!(
                    "{} {} are too few to tell",
                    ["Two", "Three", "Four", "Five"][over.n - 2],
                    plural(&group)
                ),
                _ => "The data do not show a difference".to_owned(),
            };
            let interval = interval.trim_start_matches(", ");
            return format!(
                "{reason}: with the pairs of each {} averaged first, since they are not \
                 independent, “{m}” is {} with {a} than with {b} (geometric mean of {}{}). Over \
                 all {pairs} it is {change} ({interval}), and {counts}.",
                single(&group),
                self.form().change(over.ratio),
                over.n,
                self.interval(over)
            );
        }
        let start = match (overall.n, self.is_shown()) {
            (1, _) => "One ratio alone shows little:",
            (_, true) => "On average",
            // Were all pairs to differ the same way, the signed-rank test would give 2 / 2ⁿ.
            (2..=5, false) => "Too few pairs to tell: on average",
            (_, false) => "The data do not show a difference: on average",
        };
        let verdict = match (self.is_shown(), self.better, overall.ratio > 1.0) {
            (false, ..) | (_, Better::Neither, _) => String::new(),
            (_, Better::Lower, false) | (_, Better::Higher, true) => {
                format!(" By this measure {a} is the better one.")
            }
            _ => format!(" By this measure {b} is the better one."),
        };
        format!(
            "{start} “{m}” is {change} with {a} than with {b} (geometric mean of {pairs}{interval}); it is \
             {counts}.{verdict}"
        )
    }

    /// In how many pairs the values differ as the average does, and how likely that is.
    fn counts(&self, overall: RatioEstimate) -> String {
        let n = self.pairs.len();
        let (n_side, side) = match overall.ratio > 1.0 {
            true => (self.n_higher, "higher"),
            false => (self.n_lower, "lower"),
        };
        let ties = match n.saturating_sub(self.n_lower + self.n_higher) {
            0 => String::new(),
            n_equal => format!(", equal in {n_equal}"),
        };
        let test = match self.p_ranks {
            Some(p) => format!("p {} by the signed-rank test", labels::probability(p)),
            None => "no pair differs".to_owned(),
        };
        format!("{side} in {n_side} of {n}{ties}; {test}")
    }

    fn same_in_words(&self) -> Vec<String> {
        let words = self.same_titles.iter().enumerate().map(|(place, column)| {
            let both: Vec<[f64; 2]> =
                self.pairs.iter().filter_map(|pair| pair.same.get(place).copied()?).collect();
            let off = |[a, b]: &[f64; 2]| (a - b).abs() / a.abs().max(b.abs()).max(1e-300);
            let n_off = both.iter().filter(|both| both[0] != both[1]).count();
            let most = both.iter().map(off).fold(0.0, f64::max);
            match (both.len(), n_off) {
                (0, _) => format!("Whether {column} is the same in both is not known."),
                (n, 0) if n == self.pairs.len() => {
                    format!("Both steps of every pair have the same {column}.")
                }
                (n, 0) => format!("Both steps of the {n} pairs that tell have the same {column}."),
                (n, off) => format!(
                    "In {off} of {n} pairs {column} is not the same, by up to {}\u{a0}%.",
                    labels::rounded(100.0 * most, 2)
                ),
            }
        });
        if self.pairs.is_empty() { Vec::new() } else { words.collect() }
    }
}

/// All of so many pairs.
fn all_pairs(n: usize) -> String {
    match n {
        1 => "the only pair".to_owned(),
        2 => "both pairs".to_owned(),
        _ => format!("all {n} pairs"),
    }
}

/// Whether an interval leaves out that nothing differs.
fn is_off(estimate: RatioEstimate) -> bool {
    estimate.interval.is_some_and(|(low, high)| low > 1.0 || high < 1.0)
}

/// What the pairs of one row have in common.
fn group_name(results: &Results) -> String {
    results.group_axis().map_or("group", |axis| axis.title.as_str()).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sentence_says_its_changes_in_one_form() {
        let said = |low: f64, high: f64| ChangeForm::of(&[low, high]).span(low, high);
        assert_eq!(said(0.24, 0.8), "20 to 76\u{a0}% lower");
        assert_eq!(said(1.05, 1.5), "5 to 50\u{a0}% higher");
        assert_eq!(said(0.9, 1.2), "10\u{a0}% lower to 20\u{a0}% higher");
        // 1 / 0.24 and 1 / 0.05.
        assert_eq!(said(0.05, 0.24), "4.2 to 20 times lower");
        assert_eq!(said(0.05, 1.2), "20 times lower to 1.2 times higher");
        assert_eq!(said(1.0, 3.0), "no different to 3 times higher");
        let change = |ratio: f64| ChangeForm::of(&[ratio]).change(ratio);
        assert_eq!([change(0.05), change(0.5)], ["20 times lower", "50\u{a0}% lower"]);
        assert_eq!([change(1.0), change(31.0)], ["no different", "31 times higher"]);
        let estimate = RatioEstimate { ratio: 0.2, interval: Some((0.05, 0.8)), n: 9 };
        let form = ChangeForm::of_estimates(&[estimate]);
        assert_eq!(form.change(estimate.ratio), "5 times lower");
        assert_eq!(form.span(0.05, 0.8), "1.25 to 20 times lower");
    }
}
