//! The search for modules: by what they are called, what they do, and what they link to.

use mve_core::{DataType, Module, ModuleInfo, ParamSpec, Registry, rank_of_word};
use nucleo_matcher::pattern::{Atom, AtomKind, CaseMatching, Normalization};
use nucleo_matcher::{Config, Matcher, Utf32Str};

/// What a word of the query is worth by where it is found: in the id first, in one piece before
/// letters here and there, then in the category, then in the summary, then by its beginning alone,
/// last by what is meant by it or stands in choices and ports, as `mve modules` finds it.
const WHOLE_IN_ID: u32 = 5000;
const IN_ID: u32 = 4000;
const IN_CATEGORY: u32 = 3000;
const IN_SUMMARY: u32 = 2000;
const BY_STEM: u32 = 1000;
const ELSEWHERE: [u32; 4] = [400, 300, 200, 100];

/// Fewer letters than this are in too many texts.
const SHORTEST_ELSEWHERE: usize = 3;

/// Shortest beginning that two words of one stem have in common, and the most letters that the
/// word of the query may have behind it: `simplify` finds the Simplificator.
const SHORTEST_STEM: usize = 4;
const LONGEST_ENDING: usize = 3;

/// What a link into a parameter takes off, so that modules with a fitting input come first.
const FOR_PARAM: u32 = 500;

/// What a module must link to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fit {
    /// An output that gives this type: the module must have an input that takes it.
    Output(DataType),
    /// An input that takes this type: the module must have an output that gives it.
    Input(DataType),
}

/// A module that was found, and of those of its ports that fit one.
#[derive(Clone)]
pub struct SearchHit {
    /// The module.
    pub info: ModuleInfo,
    /// The port to link to, where one was asked for.
    pub port: Option<&'static str>,
    /// The characters of the id that match, by place, sorted.
    pub id_matches: Vec<u32>,
    /// The characters of the summary that match, by place, sorted.
    pub summary_matches: Vec<u32>,
}

/// All modules, to be searched.
pub struct Catalog {
    modules: Vec<ModuleInfo>,
}

/// Colors of categories, in the order of their names: dark enough for white text on them.
const COLORS: [[u8; 3]; 8] = [
    [52, 94, 140],
    [46, 112, 96],
    [128, 84, 42],
    [112, 70, 128],
    [132, 62, 72],
    [86, 104, 52],
    [64, 108, 124],
    [104, 92, 72],
];

/// The color that stands for a category of modules: red, green, blue.
pub fn category_color(category: &str, registry: &Registry) -> [u8; 3] {
    let mut names: Vec<&str> = registry.modules().iter().map(|info| info.category).collect();
    names.sort_unstable();
    names.dedup();
    let place = names.iter().position(|name| *name == category).unwrap_or_default();
    COLORS[place % COLORS.len()]
}

impl Catalog {
    /// The modules of a registry.
    pub fn new(registry: &Registry) -> Self {
        Self { modules: registry.modules().iter().copied().chain(registry.maps()).collect() }
    }

    /// The modules that have all words of the query and fit, the best first, each with every port
    /// that fits; without a query, all that fit, sorted by id.
    pub fn search(&self, query: &str, fit: Option<&Fit>) -> Vec<SearchHit> {
        let mut matcher = Matcher::new(Config::DEFAULT);
        let words: Vec<Word> = query.split_whitespace().map(Word::new).collect();
        let mut scored: Vec<(u32, SearchHit)> = Vec::new();
        'modules: for info in &self.modules {
            let mut score = FOR_PARAM;
            let mut ports = vec![None];
            if let Some(fit) = fit {
                let (names, are_params) = fit.ports(info.module);
                ports = names.into_iter().map(Some).collect();
                score -= if are_params { FOR_PARAM } else { 0 };
            }
            let Some(&port) = ports.first() else { continue };
            let mut hit = SearchHit {
                info: *info,
                port,
                id_matches: Vec::new(),
                summary_matches: Vec::new(),
            };
            for word in &words {
                match word.find(&mut hit, &mut matcher) {
                    Some(found) => score += found,
                    None => continue 'modules,
                }
            }
            for matches in [&mut hit.id_matches, &mut hit.summary_matches] {
                matches.sort_unstable();
                matches.dedup();
            }
            scored.extend(ports.into_iter().map(|port| (score, SearchHit { port, ..hit.clone() })));
        }
        // The registry is sorted by id, and the sort keeps that order among equals.
        scored.sort_by_key(|(score, _)| std::cmp::Reverse(*score));
        scored.into_iter().map(|(_, hit)| hit).collect()
    }
}

impl Fit {
    /// The ports of the module that fit, and whether they are parameters: these stand in where no
    /// input fits.
    fn ports(&self, module: &Module) -> (Vec<&'static str>, bool) {
        match self {
            Self::Output(given) => {
                // Inputs of the very type are meant rather than those that take anything.
                let is_same = |wanted: DataType| wanted == *given;
                let takes = |wanted: DataType| wanted.takes(*given);
                let inputs = |fits: &dyn Fn(DataType) -> bool| -> Vec<&'static str> {
                    let fitting = module.inputs.iter().filter(|input| fits(input.data_type));
                    fitting.map(|input| input.name).collect()
                };
                let found = [inputs(&is_same), inputs(&takes)];
                if let Some(names) = found.into_iter().find(|names| !names.is_empty()) {
                    return (names, false);
                }
                let fits = |param: &&ParamSpec| param.link_type().is_some_and(takes);
                (module.params.iter().filter(fits).map(|param| param.name).collect(), true)
            }
            Self::Input(wanted) => {
                let fitting = module.outputs.iter().filter(|output| wanted.takes(output.data_type));
                (fitting.map(|output| output.name).collect(), false)
            }
        }
    }
}

/// A word of a query.
struct Word {
    letters: Vec<char>,
    fuzzy: Atom,
    whole: Atom,
}

impl Word {
    fn new(word: &str) -> Self {
        let atom = |kind| Atom::new(word, CaseMatching::Ignore, Normalization::Smart, kind, false);
        Self {
            letters: word.to_lowercase().chars().collect(),
            fuzzy: atom(AtomKind::Fuzzy),
            whole: atom(AtomKind::Substring),
        }
    }

    /// What the word is worth in a module; marks where it was found.
    fn find(&self, hit: &mut SearchHit, matcher: &mut Matcher) -> Option<u32> {
        let (module, mut buffer) = (hit.info.module, Vec::new());
        let id = Utf32Str::new(module.id, &mut buffer);
        if let Some(score) = self.whole.indices(id, matcher, &mut hit.id_matches) {
            return Some(WHOLE_IN_ID + u32::from(score));
        }
        if let Some(score) = self.fuzzy.indices(id, matcher, &mut hit.id_matches) {
            return Some(IN_ID + u32::from(score));
        }
        let category = Utf32Str::new(hit.info.category, &mut buffer);
        if let Some(score) = self.whole.score(category, matcher) {
            return Some(IN_CATEGORY + u32::from(score));
        }
        let summary = Utf32Str::new(module.summary, &mut buffer);
        if let Some(score) = self.whole.indices(summary, matcher, &mut hit.summary_matches) {
            return Some(IN_SUMMARY + u32::from(score));
        }
        let in_id = self.stem(module.id, &mut hit.id_matches);
        let stem = in_id.or_else(|| self.stem(module.summary, &mut hit.summary_matches));
        stem.or_else(|| {
            let word: String = self.letters.iter().collect();
            let is_long = self.letters.len() >= SHORTEST_ELSEWHERE;
            let rank = rank_of_word(module, &word, mve_modules::SYNONYMS).filter(|_| is_long)?;
            Some(ELSEWHERE[rank])
        })
    }

    /// Finds the beginning of the word at the beginning of a word of the text.
    fn stem(&self, text: &str, matches: &mut Vec<u32>) -> Option<u32> {
        let letters: Vec<char> = text.chars().collect();
        let begins = |place: usize| {
            let before = place.checked_sub(1).map(|before| letters[before]);
            before.is_none_or(|before| {
                !before.is_alphanumeric()
                    || (before.is_lowercase() && letters[place].is_uppercase())
            })
        };
        let needed = SHORTEST_STEM.max(self.letters.len().saturating_sub(LONGEST_ENDING));
        for place in (0..letters.len()).filter(|place| begins(*place)) {
            let pairs = letters[place..].iter().zip(&self.letters);
            let n_common = pairs.take_while(|(a, b)| a.to_lowercase().eq([**b])).count();
            if n_common >= needed {
                matches.extend((place..place + n_common).map(|place| place as u32));
                return Some(BY_STEM + n_common as u32);
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use mve_core::{Data, testing::registry};

    use super::*;

    fn ids(query: &str, fit: Option<Fit>) -> Vec<&'static str> {
        let hits = Catalog::new(&registry()).search(query, fit.as_ref());
        hits.iter().map(|hit| hit.info.module.id).collect()
    }

    #[test]
    fn ids_come_first_and_all_words_count() {
        assert_eq!(ids("", None), ["Add", "Echo", "Pick", "Read", "Write"]);
        // In the id of Read, in the summaries of Echo ("a text") and Write.
        assert_eq!(ids("rea", None), ["Read"]);
        assert_eq!(ids("text", None), ["Echo", "Read", "Write"]);
        assert_eq!(ids("text wri", None), ["Write"]);
        assert_eq!(ids("test", None).len(), 5); // the category
        assert_eq!(ids("wrt", None), ["Write"]);
        // Letters in one piece before the same ones here and there.
        let all = Catalog::new(&mve_modules::registry()).search("comp", None);
        let first: Vec<&str> = all.iter().take(3).map(|hit| hit.info.module.id).collect();
        assert!(first.iter().all(|id| id.to_lowercase().contains("comp")), "{first:?}");
        assert_eq!(ids("zzz", None), [""; 0]);
    }

    #[test]
    fn words_of_one_stem_are_found() {
        assert_eq!(ids("writing", None), ["Write"]);
        assert_eq!(ids("numbering", None), ["Pick"]);
        let hits = Catalog::new(&registry()).search("writing", None);
        assert_eq!(hits[0].id_matches, [0, 1, 2, 3]);
    }

    #[test]
    fn what_a_person_calls_it_is_found() {
        let first = |query: &str| {
            let hits = Catalog::new(&mve_modules::registry()).search(query, None);
            hits.first().map(|hit| hit.info.module.id)
        };
        let hits = Catalog::new(&mve_modules::registry()).search("decimate", None);
        let ids: Vec<&str> = hits.iter().take(2).map(|hit| hit.info.module.id).collect();
        assert_eq!(ids, ["DecimateVertices", "Simplificator"]);
        assert_eq!(first("hausdorff"), Some("MeshComparer"));
        assert_eq!(first("decimate zzz"), None);
        let all = |query: &str| Catalog::new(&mve_modules::registry()).search(query, None);
        assert!(all("view").iter().any(|hit| hit.info.module.summary.contains("picture")));
    }

    #[test]
    fn matches_are_marked() {
        let hits = Catalog::new(&registry()).search("wt tex", None);
        assert_eq!(hits[0].id_matches, [0, 3]);
        let summary = hits[0].info.module.summary;
        let marked: String = hits[0]
            .summary_matches
            .iter()
            .filter_map(|i| summary.chars().nth(*i as usize))
            .collect();
        assert_eq!(marked, "tex");
    }

    #[test]
    fn modules_that_fit_tell_their_port() {
        let hits = |fit| {
            let hits = Catalog::new(&registry()).search("", Some(&fit));
            hits.iter().map(|hit| (hit.info.module.id, hit.port.unwrap())).collect::<Vec<_>>()
        };
        assert_eq!(hits(Fit::Output(f64::TYPE)), [("Add", "a")]);
        let mesh = Fit::Output(mve_modules::data::TriMesh::TYPE);
        let comparers = Catalog::new(&mve_modules::registry()).search("comparer", Some(&mesh));
        let comparers = comparers.iter().filter(|hit| hit.info.module.id == "MeshComparer");
        let ports: Vec<_> = comparers.filter_map(|hit| hit.port).collect();
        assert_eq!(ports, ["original", "simplified"]);
        // A real input before a parameter.
        assert_eq!(hits(Fit::Output(String::TYPE)), [("Write", "text"), ("Echo", "say")]);
        assert_eq!(hits(Fit::Input(f64::TYPE)), [("Add", "sum"), ("Pick", "number")]);
        assert!(hits(Fit::Input(bool::TYPE)).is_empty());
    }
}
