//! What people think of the results of a store, and how well measures agree with them.
//!
//! As in the thesis "Image-driven simplification of triangle meshes using perceptual metrics",
//! 7.1.4: few people use the whole range, so each person's marks are spread from 0 to 1; of each
//! result the mean over people is taken, with its 95 % confidence interval; and measures are
//! correlated with these means, those of which higher is better turned around, so that 1 is full
//! agreement. Beyond the thesis there is Spearman's correlation, and both within each row of the
//! tables, as a measure in the unit of a model says nothing across models.

use std::collections::HashMap;

use mve_core::Better;

use super::Ratings;
use crate::case::Case;
use crate::columns::{MeasureColumn, is_time};
use crate::plots::{Figure, Panel, Point, Scale, series_styles};
use crate::results::Results;
use crate::stats::{Estimate, estimate, pearson, spearman};

/// What the marks are called.
const TITLE: &str = "mean mark of people, 0 to 1";

/// The name of their column.
pub const COLUMN: &str = "people.mark";

/// What some people marked.
pub struct People {
    /// How many count.
    pub n_raters: usize,
    /// What a reader must know of them.
    pub notes: Vec<String>,
    /// For each case its marks, from 0 to 1, one a person.
    marks: Vec<Vec<f64>>,
}

/// How well a measure agrees with people.
#[derive(Clone, Debug, PartialEq)]
pub struct Agreement {
    /// Name of the measure.
    pub title: String,
    /// Its column.
    pub column: String,
    /// Over all results; empty where numbers of different models cannot be compared.
    pub over_all: Correlation,
    /// The means of those within each value of the first axis; `n` counts these.
    pub within: Correlation,
}

/// Two correlations of one list of pairs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Correlation {
    /// How many pairs there are.
    pub n: usize,
    /// Pearson's.
    pub pearson: Option<f64>,
    /// Spearman's.
    pub spearman: Option<f64>,
}

impl Correlation {
    fn of((x, y): &(Vec<f64>, Vec<f64>)) -> Self {
        Self { n: x.len(), pearson: pearson(x, y), spearman: spearman(x, y) }
    }

    fn mean(all: &[Self]) -> Self {
        let mean = |of: fn(&Self) -> Option<f64>| {
            let known: Vec<f64> = all.iter().filter_map(of).collect();
            estimate(&known).map(|found| found.mean)
        };
        let n = all.iter().filter(|one| one.spearman.is_some()).count();
        Self { n, pearson: mean(|one| one.pearson), spearman: mean(|one| one.spearman) }
    }
}

impl People {
    /// Finds the results that people marked. The error lists what is wrong with the files.
    pub fn of(results: &Results, ratings: &[Ratings]) -> Result<Self, Vec<String>> {
        let mut place_of = HashMap::new();
        for (place, case) in results.cases.iter().enumerate() {
            place_of.extend(case.steps.iter().map(|step| (step.id.as_str(), place)));
        }
        let mut faults = Vec::new();
        for (place, own) in ratings.iter().enumerate() {
            faults.extend(of_another_store(results, own, &place_of));
            // Whoever saved early has saved again at the end.
            let is_same = |other: &&Ratings| other.rater == own.rater;
            if let Some(other) = ratings[..place].iter().find(is_same) {
                let (first, second, rater) = (&other.file, &own.file, &own.rater);
                faults.push(format!(
                    "{second}: is of {rater}, as {first} is; name the one that was saved last, or \
                     change \"rater\" in one of them if they are two people"
                ));
            }
        }
        if !faults.is_empty() {
            return Err(faults);
        }
        let mut people =
            Self { n_raters: 0, notes: Vec::new(), marks: vec![Vec::new(); results.cases.len()] };
        for own in ratings {
            let Some(normalized) = own.normalized() else {
                people.notes.push(format!(
                    "{} gave every result the same mark, which says nothing, and is left out.",
                    own.rater
                ));
                continue;
            };
            people.n_raters += 1;
            let mut of_case: HashMap<usize, Vec<f64>> = HashMap::new();
            for (step, mark) in normalized {
                if let Some(place) = place_of.get(step) {
                    of_case.entry(*place).or_default().push(mark);
                }
            }
            for (place, marks) in of_case {
                people.marks[place].extend(estimate(&marks).map(|found| found.mean));
            }
        }
        people.tell_of_numbers();
        Ok(people)
    }

    fn tell_of_numbers(&mut self) {
        let counts: Vec<usize> = self.marks.iter().map(Vec::len).filter(|n| *n > 0).collect();
        let (least, most) = (counts.iter().min().copied(), counts.iter().max().copied());
        if let (Some(least), Some(most)) = (least, most)
            && least < most
        {
            self.notes
                .push(format!("Not everybody marked everything: {least} to {most} a result."));
        }
        if self.n_raters == 1 {
            self.notes.push("One person's marks have no confidence interval.".to_owned());
        }
    }

    /// The mean mark of a case by its place, with its interval.
    pub fn mark(&self, place: usize) -> Option<Estimate> {
        estimate(self.marks.get(place)?)
    }

    /// The ends of the interval of a mean mark, as far as there are marks: from 0 to 1.
    pub fn span(mark: &Estimate) -> Option<(f64, f64)> {
        let half = mark.half_width?;
        Some(((mark.mean - half).max(0.0), (mark.mean + half).min(1.0)))
    }

    /// How well each measure agrees with the mean marks.
    pub fn agreements(&self, results: &Results, measures: &[MeasureColumn]) -> Vec<Agreement> {
        let groups: Vec<usize> = results.cases.iter().map(|case| results.group_of(case)).collect();
        let n_groups = groups.iter().max().map_or(0, |most| most + 1);
        let of_measure = |measure: &MeasureColumn| {
            let sign = if measure.better == Better::Higher { -1.0 } else { 1.0 };
            let pairs = |is_wanted: &dyn Fn(usize) -> bool| -> (Vec<f64>, Vec<f64>) {
                let places = (0..results.cases.len()).filter(|place| is_wanted(*place));
                let pair = |place: usize| {
                    let value = measure.estimate(results, &results.cases[place])?.mean;
                    Some((sign * value, self.mark(place)?.mean))
                };
                places.filter_map(pair).unzip()
            };
            let is_sound = !measure.is_of_model || n_groups < 2;
            let over_all = is_sound.then(|| Correlation::of(&pairs(&|_| true)));
            let within = (0..n_groups).filter(|_| n_groups > 1);
            let within = within
                .map(|group| Correlation::of(&pairs(&|place| groups[place] == group)))
                .collect::<Vec<_>>();
            Agreement {
                title: measure.title.clone(),
                column: measure.column.clone(),
                over_all: over_all.unwrap_or_default(),
                within: Correlation::mean(&within),
            }
        };
        rated_by(measures).map(of_measure).collect()
    }

    /// A plot a measure: the mean marks with their intervals against it.
    pub fn figures(&self, results: &Results, measures: &[MeasureColumn]) -> Vec<Figure> {
        let figure = |measure: &MeasureColumn| {
            // What is in the unit of a model has a panel a model.
            let part_of = |case| if measure.is_of_model { results.group_of(case) } else { 0 };
            let n_parts = results.cases.iter().map(part_of).max().map_or(0, |most| most + 1);
            let panel = |part: usize| {
                let cases = results.cases.iter().enumerate();
                let points = cases.filter(|(_, case)| part_of(case) == part);
                let points = points.filter_map(|(place, case)| {
                    let (x, y) = (measure.estimate(results, case)?, self.mark(place)?);
                    let (series, name) = (results.series_of(case), name_of(results, case));
                    Some(Point { series, x, y, name, is_missed: case.missed().is_some() })
                });
                let axis = results.group_axis().filter(|_| n_parts > 1);
                let title = axis.map_or_else(String::new, |axis| axis.labels[part].clone());
                Panel { title, points: points.collect(), front: Vec::new(), is_line: false }
            };
            let panels: Vec<Panel> = (0..n_parts).map(panel).collect();
            let panels: Vec<Panel> =
                panels.into_iter().filter(|panel| panel.points.len() > 1).collect();
            Figure {
                columns: [COLUMN.to_owned(), measure.column.clone()],
                titles: [measure.title_with_unit(), TITLE.to_owned()],
                panels,
                scales: [None, Some(Scale { low: 0.0, high: 1.0, is_log: false })],
                styles: series_styles(results),
            }
        };
        rated_by(measures).map(figure).filter(|figure| !figure.panels.is_empty()).collect()
    }
}

/// A case by its row and its series.
fn name_of(results: &Results, case: &Case) -> String {
    let series = results.series_labels().get(results.series_of(case)).cloned();
    let both = [results.row_label(results.row_of(case)), series.unwrap_or_default()];
    both.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(" · ")
}

/// The measures that are compared with people: all but times.
fn rated_by(measures: &[MeasureColumn]) -> impl Iterator<Item = &MeasureColumn> {
    measures.iter().filter(|measure| measure.is_there && !is_time(&measure.column))
}

/// What is wrong where a file marks steps that a store does not have.
fn of_another_store(
    results: &Results,
    ratings: &Ratings,
    known: &HashMap<&str, usize>,
) -> Option<String> {
    let unknown = ratings.marks.keys().filter(|step| !known.contains_key(step.as_str()));
    let mut unknown: Vec<&String> = unknown.collect();
    unknown.sort();
    let first = unknown.first()?;
    let program = match ratings.program.as_str() {
        "" => String::new(),
        name => format!(", of the program \"{name}\""),
    };
    Some(format!(
        "{}: marks results of another store{program}: {} of its {} steps are not in {}, such as \
         {first}; results that ran again after a change are others, and need a new page",
        ratings.file,
        unknown.len(),
        ratings.marks.len(),
        results.folder.display()
    ))
}
