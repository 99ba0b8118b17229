//! The search for modules by what a person calls them.

use crate::module::Module;
use crate::param::ParamSpec;
use crate::registry::{ModuleInfo, Registry};

/// A word that people search by, and one that declarations have for it.
pub type Synonym = (&'static str, &'static str);

/// The modules that have every word of a query: in the id first, then in the summary, then in the
/// entries of their choices, then in the texts of ports and parameters, those of entries too.
pub fn search(registry: &Registry, query: &str, synonyms: &[Synonym]) -> Vec<ModuleInfo> {
    let words: Vec<&str> = query.split_whitespace().collect();
    let rank = |module: &Module| {
        let ranks = words.iter().map(|word| rank_of_word(module, word, synonyms));
        ranks.into_iter().try_fold(0, |worst, rank| Some(rank?.max(worst)))
    };
    let ranked = registry.modules().iter().map(|info| (rank(info.module), *info));
    let mut found: Vec<_> = ranked.filter_map(|(rank, info)| Some((rank?, info))).collect();
    found.sort_by_key(|(rank, _)| *rank);
    found.into_iter().map(|(_, info)| info).collect()
}

/// Where a module has a word or one that is meant by it: 0 for its id, 1 for the summary, 2 for the
/// entries of its choices, 3 for the texts of ports and parameters, those of entries too.
pub fn rank_of_word(module: &Module, word: &str, synonyms: &[Synonym]) -> Option<usize> {
    texts_of(module).iter().position(|text| has_word(text, word, synonyms))
}

/// The entries of a module's choices that have a word in what they say of themselves, of their
/// parameters or of the numbers that they give, each by its path: `metric.ImageSsim`.
pub fn entries_with(module: &Module, word: &str, synonyms: &[Synonym]) -> Vec<String> {
    let mut found = Vec::new();
    for spec in module.params {
        for option in spec.options().iter().filter(|_| spec.choice().is_some()) {
            let mut text = format!("{} {}\n", option.id, option.summary);
            add_params(option.params, &mut text);
            let entry = spec.choice().and_then(|choice| choice.list.find(option.id));
            for quantity in entry.map_or(&[][..], |entry| entry.quantities) {
                text += &format!("{} {} {}\n", quantity.name, quantity.title, quantity.doc);
            }
            if has_word(&text, word, synonyms) {
                found.push(format!("{}.{}", spec.name, option.id));
            }
        }
    }
    found
}

/// Whether a text has a word, or one that is meant by it.
fn has_word(text: &str, word: &str, synonyms: &[Synonym]) -> bool {
    let (text, word) = (text.to_lowercase(), word.to_lowercase());
    let meant = synonyms.iter().filter(|(name, _)| *name == word).map(|(_, meant)| *meant);
    std::iter::once(word.as_str()).chain(meant).any(|form| text.contains(form))
}

/// What parameters say of themselves, with those of the entries that they may name.
fn add_params(params: &[ParamSpec], text: &mut String) {
    for spec in params {
        *text += &format!("{} {}\n", spec.name, spec.doc);
        for option in spec.options() {
            *text += &format!("{} {}\n", option.id, option.summary);
            add_params(option.params, text);
        }
    }
}

/// What a module says of itself, the most telling first.
fn texts_of(module: &Module) -> [String; 4] {
    let mut entries = String::new();
    let mut others = String::new();
    for spec in module.params {
        for option in spec.options() {
            entries += &format!("{} {}\n", option.id, option.summary);
        }
    }
    add_params(module.params, &mut others);
    module.inputs.iter().for_each(|input| others += &format!("{} {}\n", input.name, input.doc));
    module.outputs.iter().for_each(|output| others += &format!("{} {}\n", output.name, output.doc));
    [module.id.to_owned(), module.summary.to_owned(), entries, others]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::registry;

    #[test]
    fn a_module_is_found_by_id_summary_choices_and_other_words() {
        let ids = |query: &str| -> Vec<_> {
            let found = search(&registry(), query, &[("glyphs", "text")]);
            found.iter().map(|info| info.module.id).collect()
        };
        assert_eq!(ids("READ")[0], "Read");
        assert_eq!(ids("scaled"), ["Pick"]); // an entry of its choice
        assert_eq!(ids("glyphs"), ids("text"));
        assert_eq!(ids("text no-such-word"), [""; 0]);
        // A parameter of an entry.
        assert_eq!(ids("factor"), ["Pick"]);
        let pick = registry().find("Pick").unwrap().module;
        assert_eq!(entries_with(pick, "factor", &[]), ["how.Scaled"]);
        assert_eq!(entries_with(pick, "nothing", &[]), ["how.Zero"]);
    }
}
