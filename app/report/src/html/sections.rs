//! The sections of the page that are no tables of results: summary, answers, charts, pictures,
//! correlations, failures.

use std::fmt::Write;

use mve_core::{StepStatus, brief};

use super::{Page, address, count, cut, escape};
use crate::answers::Answer;
use crate::case::Case;
use crate::change::ChangeForm;
use crate::columns::MeasureColumn;
use crate::labels;
use crate::pictures::Picture;
use crate::plots::{self, Figure};
use crate::stats::{pearson, spearman};

/// Failed steps and pairs that are listed.
const MOST_FAILED: usize = 200;
const MOST_PAIRS: usize = 500;

/// What becomes of steps that missed their target.
const WHERE_MISSED: &str = "They are marked † in tables and ringed in plots, and are not compared \
                            with others; the table of all steps says by how much.";

/// What ran, in a sentence.
pub(super) fn summary(page: &Page) -> String {
    let results = page.results;
    let (n, done, failed) = results.counts();
    let axes: Vec<String> = results
        .axes
        .iter()
        .filter_map(|axis| {
            let title = Some(&axis.title).filter(|title| !title.is_empty())?;
            Some(format!("{} of {}", count(axis.values.len(), "value"), escape(title)))
        })
        .collect();
    let product = if axes.is_empty() { String::new() } else { format!(": {}", axes.join(" × ")) };
    let seconds: f64 =
        results.cases.iter().flat_map(|case| case.records()).map(|record| record.seconds).sum();
    let mut parts = vec![format!("{done} of {} done", count(n, "step"))];
    if failed > 0 {
        parts.push(format!("<span class=\"bad\">{failed} failed</span>"));
    }
    if n > done + failed {
        parts.push(format!("{} to do", n - done - failed));
    }
    let missed = match results.missed_in_words() {
        words if words.is_empty() => words,
        words => format!("<p class=\"missed\">{} {}</p>\n", escape(&words), WHERE_MISSED),
    };
    format!(
        "{missed}<p class=\"lead\">Program <i>{}</i>{product}. {}; {} of computing, summed over \
         steps.</p>\n",
        escape(&results.plan.program),
        parts.join(", "),
        labels::duration(seconds)
    )
}

/// The questions with their answers.
pub(super) fn answers(page: &Page) -> String {
    let mut text = String::new();
    for answer in page.answers {
        let _ = write!(text, "<div class=\"answer\">\n<h3>{}</h3>\n", escape(&answer.text));
        for (place, sentence) in answer.sentences.iter().enumerate() {
            let class = if place == 0 { " class=\"first\"" } else { "" };
            let _ = writeln!(text, "<p{class}>{}</p>", escape(sentence));
        }
        if !answer.pairs.is_empty() {
            text.push_str(&pairs(page, answer));
        }
        text.push_str("</div>\n");
    }
    text
}

fn pairs(page: &Page, answer: &Answer) -> String {
    let p = answer.p_ranks.map_or("–".to_owned(), |p| labels::rounded(p, 3));
    let mut text = format!(
        "<details><summary>{}</summary>\n<p class=\"note\">Lower in {}, higher in {}, equal in {}. \
         Signed-rank test p = {p}, sign test p = {}.</p>\n<div class=\"scroll\">\
         <table class=\"sortable\"><thead><tr><th class=\"text\">pair</th><th>{}</th><th>{}</th>\
         <th>ratio</th>",
        count(answer.pairs.len(), "pair"),
        answer.n_lower,
        answer.n_higher,
        answer.pairs.len() - answer.n_lower - answer.n_higher,
        labels::rounded(answer.p_signs, 3),
        escape(&answer.names[0]),
        escape(&answer.names[1])
    );
    for column in &answer.same_titles {
        let _ = write!(text, "<th>{}</th>", escape(column));
    }
    text.push_str("</tr></thead>\n<tbody>\n");
    for pair in answer.pairs.iter().take(MOST_PAIRS) {
        let _ = write!(text, "<tr><td class=\"text\">{}</td>", escape(&pair.label));
        for value in pair.values {
            let _ = write!(text, "<td data-v=\"{value}\">{}</td>", brief(value));
        }
        match pair.ratio {
            None => text.push_str("<td></td>"),
            Some(r) => {
                let _ = write!(text, "<td data-v=\"{r}\">{}</td>", labels::rounded(r, 4));
            }
        }
        for same in &pair.same {
            let shown = match same {
                None => String::new(),
                Some([a, b]) if a == b => brief(*a),
                Some([a, b]) => format!("{} ≠ {}", brief(*a), brief(*b)),
            };
            let _ = write!(text, "<td>{shown}</td>");
        }
        text.push_str("</tr>\n");
    }
    text.push_str("</tbody></table></div>\n");
    text.push_str(&by_group(page, answer));
    text.push_str("</details>\n");
    text
}

/// The mean ratio of each row of the tables, where it has several pairs.
fn by_group(page: &Page, answer: &Answer) -> String {
    let (Some(axis), true) =
        (page.results.group_axis(), answer.by_group.len() < answer.pairs.len())
    else {
        return String::new();
    };
    let ratios: Vec<f64> = answer.by_group.values().map(|estimate| estimate.ratio).collect();
    let form = ChangeForm::of(&ratios);
    let parts = answer.by_group.iter().filter_map(|(group, estimate)| {
        let label = escape(axis.labels.get(*group)?);
        Some(format!("{label}: {} ({})", form.change(estimate.ratio), count(estimate.n, "pair")))
    });
    let parts: Vec<_> = parts.collect();
    format!("<p class=\"note\">Averages: {}.</p>\n", parts.join("; "))
}

pub(super) fn legend(figure: &Figure) -> String {
    let mut text = "<p class=\"legend\">".to_owned();
    if figure.styles.len() > 1 {
        for style in &figure.styles {
            let _ = write!(
                text,
                "<span><b style=\"color:var(--s{})\">{}</b>{}</span>",
                style.color,
                style.character(),
                escape(&style.label)
            );
        }
    }
    if figure.panels.iter().any(|panel| panel.front.len() > 1) {
        text.push_str("<span><i class=\"front\"></i>Pareto front</span>");
    }
    if figure.panels.iter().flat_map(|panel| &panel.points).any(|point| point.is_missed) {
        text.push_str("<span><b>◎</b>ring: target not reached</span>");
    }
    text.push_str("</p>\n");
    text
}

/// The plots of all measures.
pub(super) fn plots(page: &Page) -> String {
    let (figures, n_hidden) = page.figures;
    if figures.is_empty() {
        return String::new();
    }
    let mut text = "<p class=\"note\">The Pareto front joins what nothing else beats in both \
                    directions; sizes within 1 % count as equal. Scales over more than a decade \
                    are logarithmic. Rest on a point to read it.</p>\n"
        .to_owned();
    let mut number = 0;
    for figure in figures {
        let [x, y] = &figure.titles;
        let _ = write!(
            text,
            "<h3>{} <span class=\"note\">against {}</span></h3>\n{}<div class=\"charts\">\n",
            escape(y),
            escape(x),
            legend(figure)
        );
        for panel in plots::panels(figure, &mut number) {
            let _ = writeln!(text, "<div>{panel}</div>");
        }
        text.push_str("</div>\n");
    }
    if *n_hidden > 0 {
        let n = count(*n_hidden, "more plot");
        let _ = writeln!(text, "<p class=\"note\">{n} would make the page slow to open.</p>");
    }
    text
}

/// Pictures, a row of cases a strip.
pub(super) fn pictures(page: &Page) -> String {
    let mut text = String::new();
    let labels = page.results.series_labels();
    let rows = page.results.rows();
    let rows: Vec<_> =
        rows.iter().map(|(row, cases)| (page.results.row_label(row), cases)).collect();
    let first = page.pictures.rows.iter().flat_map(|row| &row.cells).find(|(_, own)| own.len() > 1);
    if let Some((_, own)) = first {
        let nodes: Vec<_> = own.iter().map(|picture| escape(&picture.node)).collect();
        let nodes = nodes.join(", ");
        let _ = writeln!(
            text,
            "<p class=\"note\">From top to bottom: {nodes}. Click to enlarge, arrow keys to step.</p>"
        );
    }
    for row in &page.pictures.rows {
        let cases = rows.iter().find(|(label, _)| *label == row.label).map(|(_, cases)| *cases);
        let title = if row.label.is_empty() { String::new() } else { escape(&row.label) };
        let _ = write!(text, "<h3>{title}</h3>\n<div class=\"strip\">\n");
        if !row.shared.is_empty() {
            let alt = format!("{title} · the same for all");
            text.push_str(&figure(page, &row.shared, &alt, "", "the same for all"));
        }
        for (series, own) in row.cells.iter().filter(|(_, own)| !own.is_empty()) {
            let measures = page.measures.iter().filter(|measure| measure.is_there).take(4);
            let values = measures.filter_map(|measure| {
                let case = cases?.get(*series).copied().flatten()?;
                let value = measure.estimate(page.results, case)?.mean;
                Some(format!("{} {}", escape(&measure.title), labels::rounded(value, 3)))
            });
            let values = values.collect::<Vec<_>>().join("<br>");
            let name = labels.get(*series).map(|label| escape(label)).unwrap_or_default();
            text.push_str(&figure(page, own, &format!("{title} · {name}"), &name, &values));
        }
        text.push_str("</div>\n");
    }
    for note in &page.pictures.notes {
        let _ = writeln!(text, "<p class=\"note\">{}</p>", escape(note));
    }
    text
}

/// Pictures side by side; `alt`, `name` and `values` are escaped.
fn figure(page: &Page, pictures: &[Picture], alt: &str, name: &str, values: &str) -> String {
    let mut text = "<figure><div class=\"pair\">".to_owned();
    for picture in pictures {
        let node = escape(&picture.node);
        if picture.data.is_empty() {
            let file = address(page.store, &picture.file);
            let _ = write!(text, "<a href=\"{file}\">{node}</a>");
        } else {
            let _ = write!(
                text,
                "<img src=\"{}\" alt=\"{alt} · {node}\" title=\"{node}\">",
                picture.data
            );
        }
    }
    let nodes: Vec<_> = pictures.iter().map(|picture| escape(&picture.node)).collect();
    let head = if name.is_empty() { nodes.join(", ") } else { name.to_owned() };
    let _ = writeln!(text, "</div><figcaption>{head}<small>{values}</small></figcaption></figure>");
    text
}

/// Correlation matrices of the measures.
pub(super) fn correlation(page: &Page) -> String {
    let measures: Vec<_> = page.measures.iter().filter(|measure| measure.is_there).collect();
    if measures.len() < 2 {
        return String::new();
    }
    // What is measured in the unit of a model cannot be compared between models.
    let across = measures.iter().all(|measure| !measure.is_of_model);
    let columns: Vec<Vec<Option<f64>>> =
        measures.iter().map(|measure| numbers(page, measure)).collect();
    let (kept, constant): (Vec<usize>, Vec<usize>) =
        (0..columns.len()).partition(|place| !is_constant(&columns[*place]));
    let names: Vec<&str> = measures.iter().map(|measure| measure.title.as_str()).collect();
    let mut text = String::new();
    if !constant.is_empty() {
        let list: Vec<_> = constant.iter().map(|place| escape(names[*place])).collect();
        let _ = writeln!(
            text,
            "<p class=\"note\">The same in every step, so without correlation: {}.</p>",
            list.join(", ")
        );
    }
    if kept.len() < 2 {
        return text;
    }
    let matrices = matrices(page, &columns, &kept, &names, across);
    // A few steps, or a few in each group, have none.
    if matrices.is_empty() {
        return text;
    }
    let _ = writeln!(text, "<div class=\"tables\">\n{matrices}");
    text.push_str(
        "</div>\n<p class=\"note\">Steps that missed their target are left out. Small: how many \
         steps, or groups, have both. Ties share their mean rank.</p>\n",
    );
    text
}

/// The matrices that have a value: over all steps, where that is sound, and within row groups.
fn matrices(
    page: &Page,
    columns: &[Vec<Option<f64>>],
    kept: &[usize],
    names: &[&str],
    across: bool,
) -> String {
    let groups: Vec<usize> =
        page.results.cases.iter().map(|case| page.results.group_of(case)).collect();
    let n_groups = groups.iter().max().map_or(0, |most| most + 1);
    let mut matrices = String::new();
    let has_value = |entry: &dyn Fn(usize, usize) -> (Option<f64>, usize)| {
        let mut pairs = kept.iter().flat_map(|a| kept.iter().map(move |b| (*a, *b)));
        pairs.any(|(a, b)| a != b && entry(a, b).0.is_some())
    };
    type Measure = fn(&[f64], &[f64]) -> Option<f64>;
    let over_all = [("Pearson", pearson as Measure), ("Spearman", spearman as Measure)];
    for (title, of) in over_all.into_iter().filter(|_| across || n_groups < 2) {
        let entry = |a: usize, b: usize| {
            let (x, y) = both(&columns[a], &columns[b], |_| true);
            (of(&x, &y), x.len())
        };
        if has_value(&entry) {
            matrices.push_str(&matrix(title, "over all steps", kept, names, &entry));
        }
    }
    if n_groups > 1 && page.results.has_series() {
        let entry = |a: usize, b: usize| {
            let within = (0..n_groups).filter_map(|group| {
                let (x, y) = both(&columns[a], &columns[b], |place| groups[place] == group);
                spearman(&x, &y)
            });
            let within: Vec<f64> = within.collect();
            let mean = within.iter().sum::<f64>() / within.len() as f64;
            ((!within.is_empty()).then_some(mean), within.len())
        };
        if has_value(&entry) {
            let about = "within each row group, averaged";
            matrices.push_str(&matrix("Spearman", about, kept, names, &entry));
        }
    }
    matrices
}

/// The numbers of a measure in all cases that reached their target.
fn numbers(page: &Page, measure: &MeasureColumn) -> Vec<Option<f64>> {
    let mean = |case: &Case| {
        let compared = Some(case).filter(|case| case.missed().is_none())?;
        Some(measure.estimate(page.results, compared)?.mean)
    };
    page.results.cases.iter().map(mean).collect()
}

fn is_constant(column: &[Option<f64>]) -> bool {
    let mut numbers = column.iter().flatten();
    let first = numbers.next();
    numbers.all(|number| Some(number) == first)
}

/// The numbers of two columns where both have one and the place is wanted.
fn both(
    a: &[Option<f64>],
    b: &[Option<f64>],
    is_wanted: impl Fn(usize) -> bool,
) -> (Vec<f64>, Vec<f64>) {
    let places = (0..a.len()).filter(|place| is_wanted(*place));
    places.filter_map(|place| Some((a[place]?, b[place]?))).unzip()
}

/// A matrix colored by its values: blue for agreeing, orange for opposed.
fn matrix(
    title: &str,
    about: &str,
    places: &[usize],
    names: &[&str],
    entry: &dyn Fn(usize, usize) -> (Option<f64>, usize),
) -> String {
    let mut text = format!(
        "<div class=\"scroll\"><table class=\"heat\"><caption>{title} <span>{about}</span>\
         </caption>\n<thead><tr><th></th>"
    );
    for place in places {
        let _ = write!(text, "<th>{}</th>", escape(names[*place]));
    }
    text.push_str("</tr></thead>\n<tbody>\n");
    for a in places {
        let _ = write!(text, "<tr><th>{}</th>", escape(names[*a]));
        for b in places {
            match entry(*a, *b) {
                _ if a == b => text.push_str("<td>1</td>"),
                (None, n) => {
                    let _ = write!(text, "<td>– <small class=\"note\">{n}</small></td>");
                }
                (Some(r), n) => {
                    let color = if r < 0.0 { "224,120,40" } else { "60,130,220" };
                    let _ = write!(
                        text,
                        "<td style=\"background:rgba({color},{:.2})\">{} \
                         <small class=\"note\">{n}</small></td>",
                        0.6 * r.abs(),
                        format!("{r:.2}").replace('-', "−")
                    );
                }
            }
        }
        text.push_str("</tr>\n");
    }
    text.push_str("</tbody></table></div>\n");
    text
}

/// Steps that failed, with their reasons.
pub(super) fn failed(page: &Page) -> String {
    let mut text = String::new();
    let mut n_more = 0;
    let mut n_listed = 0;
    for case in &page.results.cases {
        for record in case.records().filter(|record| record.status != StepStatus::Done) {
            if n_listed == MOST_FAILED {
                n_more += 1;
                continue;
            }
            n_listed += 1;
            let params: Vec<_> = case
                .params
                .iter()
                .map(|(path, value)| format!("{path} = {}", labels::of_value(value)))
                .collect();
            let folder = format!("steps/{}/", record.id);
            let _ = writeln!(
                text,
                "<p><a class=\"id\" href=\"{}\">{}</a> {}<br><span class=\"bad\">{}</span>: {}</p>",
                address(page.store, &folder),
                escape(&cut(&record.id, 12)),
                escape(&cut(&params.join(", "), 400)),
                record.status.word(),
                escape(&cut(record.status.reason().unwrap_or_default(), 1000))
            );
        }
    }
    let (n, done, failed) = page.results.counts();
    if n_more > 0 {
        let _ = writeln!(text, "<p class=\"note\">{n_more} more failed.</p>");
    }
    if n > done + failed {
        let n = count(n - done - failed, "step");
        let _ = writeln!(text, "<p class=\"note\">{n} to do: the same command goes on.</p>");
    }
    text
}
