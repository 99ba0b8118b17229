//! The columns of a table of results, with what modules declare of them.

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

use super::Program;
use crate::param::{MODULE, Setting};
use crate::plan::PlanNode;
use crate::port::OutputSpec;
use crate::quantity::{Better, Quantities, Quantity, Role, Unit};

/// What is known of a column of numbers, as `plan.json` keeps it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct ColumnRecord {
    /// Its name for a person; empty where the column's own will do.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub title: String,
    /// Its unit; empty for none.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub unit: String,
    /// Whether the unit is one that the model brings.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub is_of_model: bool,
    /// Which values are better.
    pub better: Better,
    /// Its part in a report.
    pub role: Role,
    /// The parameter and the id of a module or entry with which the column holds this, where it
    /// holds something else with others.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub only_with: Option<(String, String)>,
}

impl ColumnRecord {
    fn of(quantity: &Quantity, only_with: (String, String)) -> Self {
        Self {
            title: quantity.title.to_owned(),
            unit: quantity.unit.name().to_owned(),
            is_of_model: matches!(quantity.unit, Unit::Model(_)),
            better: quantity.better,
            role: quantity.role,
            only_with: Some(only_with),
        }
    }

    /// Whether two say the same of a column, whatever they hold with.
    fn agrees(&self, other: &Self) -> bool {
        let everywhere = |record: &Self| Self { only_with: None, ..record.clone() };
        everywhere(self) == everywhere(other)
    }
}

/// All columns by name, `node.output`. `#` in a name stands for a number. A column that holds
/// different things in different steps, such as those of two metrics, has several records.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Columns(pub IndexMap<String, Vec<ColumnRecord>>);

impl Columns {
    /// Adds what a node of a plan gives.
    pub(super) fn add(&mut self, node: &PlanNode) {
        for output in node.info.module.outputs {
            for (quantity, (param, id)) in quantities(node, output) {
                let name = format!("{}.{}", node.name, quantity.name);
                let param = format!("{}.{param}", node.name);
                let record = ColumnRecord::of(&quantity, (param, id.to_owned()));
                let known = self.0.entry(name).or_default();
                if !known.contains(&record) {
                    known.push(record);
                }
            }
        }
    }

    /// Drops the conditions of columns that hold the same in all steps.
    pub(super) fn settle(&mut self) {
        for known in self.0.values_mut() {
            if known.iter().all(|record| record.agrees(&known[0])) {
                known.truncate(1);
                known.iter_mut().for_each(|record| record.only_with = None);
            }
        }
    }

    /// The part of a column in a report: the chief one that it has in some step, as what is a
    /// detail of one metric may be all that another one says.
    pub fn role(&self, column: &str) -> Role {
        let records = self.find(column);
        let has = |role: &Role| records.iter().any(|record| record.role == *role);
        [Role::Chief, Role::Size].into_iter().find(has).unwrap_or(Role::Detail)
    }

    /// What is known of a column, with its number put into its title.
    pub fn find(&self, column: &str) -> Vec<ColumnRecord> {
        if let Some(known) = self.0.get(column) {
            return known.clone();
        }
        let (name, number) = numbered(column);
        if number.is_empty() {
            return Vec::new();
        }
        let mut known = self.0.get(&name).cloned().unwrap_or_default();
        for record in &mut known {
            record.title = record.title.replace('#', number);
        }
        known
    }
}

impl Program {
    /// Which values of a column are better, where the report names it: as it says, else as the
    /// module declares.
    pub fn better(&self, column: &str) -> Option<Better> {
        let measure = self.report.measures.iter().find(|measure| measure.column == column)?;
        let declared = || match self.columns.find(column).as_slice() {
            [only] => only.better,
            _ => Better::Neither,
        };
        Some(measure.better.unwrap_or_else(declared))
    }
}

/// Sizes that differ by more than this share are not the same.
const ALIKE: f64 = 0.01;

/// Whether sizes are the same to within 1 %, so that results of these sizes can be compared.
pub fn are_alike(sizes: impl Iterator<Item = f64>) -> bool {
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for size in sizes {
        least = least.min(size);
        most = most.max(size);
    }
    most - least <= ALIKE * most.abs().max(least.abs()) || most < least
}

/// The declared name of one of several columns, `rms_#` of `rms_12`, and its number.
fn numbered(column: &str) -> (String, &str) {
    let start = column.trim_end_matches(|c: char| c.is_ascii_digit());
    (format!("{start}#"), &column[start.len()..])
}

/// The entries of choices that decide which columns a node has.
pub(super) fn deciders(node: &PlanNode) -> Vec<&'static str> {
    let outputs = node.info.module.outputs.iter();
    outputs.filter_map(|output| entry_of(node, output.quantities.choice()?)).collect()
}

/// The id of the entry that a choice of a node names.
fn entry_of(node: &PlanNode, param: &str) -> Option<&'static str> {
    match node.settings.find(param)? {
        Setting::Choice { id, .. } => Some(id),
        _ => None,
    }
}

/// The numbers that an output gives, each with the parameter that decides it and its value.
fn quantities(
    node: &PlanNode,
    output: &OutputSpec,
) -> Vec<(Quantity, (&'static str, &'static str))> {
    let module = node.info.module;
    let own = |quantity: Quantity| (quantity, (MODULE, module.id));
    match output.quantities {
        Quantities::Plain if !output.is_cell => Vec::new(),
        Quantities::Plain => vec![own(Quantity::new(output.name, output.doc))],
        Quantities::One(quantity) => vec![own(quantity)],
        Quantities::Row(row) => row.iter().copied().map(own).collect(),
        Quantities::OfChoice(param) | Quantities::FirstOfChoice(param) => {
            let Some(id) = entry_of(node, param) else { return Vec::new() };
            let choice = module.params.iter().find(|spec| spec.name == param);
            let entry = choice.and_then(|spec| spec.choice()?.list.find(id));
            let all = entry.map_or(&[][..], |entry| entry.quantities);
            let with = |quantity: Quantity| (quantity, (param, id));
            if let Quantities::OfChoice(_) = output.quantities {
                return all.iter().copied().map(with).collect();
            }
            let first = all.first().map(|first| Quantity {
                name: output.name,
                role: Role::Detail,
                ..*first
            });
            first.into_iter().map(with).collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(title: &str, id: &str) -> ColumnRecord {
        let only_with = Some(("compare.metric".to_owned(), id.to_owned()));
        ColumnRecord { title: title.to_owned(), only_with, ..ColumnRecord::default() }
    }

    #[test]
    fn a_column_that_holds_two_things_keeps_their_conditions() {
        let two = vec![record("RMS distance", "Hausdorff"), record("RMS of pictures", "ImageRms")];
        let same = vec![record("MSDM", "A"), record("MSDM", "B")];
        let all = [("compare.rms".to_owned(), two.clone()), ("compare.msdm".to_owned(), same)];
        let mut columns = Columns(all.into_iter().collect());
        columns.settle();
        assert_eq!(columns.find("compare.rms"), two);
        let msdm = columns.find("compare.msdm");
        assert_eq!((msdm.len(), &msdm[0].only_with), (1, &None));
    }

    #[test]
    fn sizes_within_a_hundredth_are_alike() {
        for (sizes, expected) in [(&[][..], true), (&[100.0, 101.0], true), (&[600.0], true)] {
            assert_eq!(are_alike(sizes.iter().copied()), expected, "{sizes:?}");
        }
        assert!(!are_alike([600.0, 2734.0].into_iter()) && !are_alike([100.0, 102.0].into_iter()));
    }

    #[test]
    fn a_detail_of_one_metric_may_be_the_chief_of_another() {
        let chief = ColumnRecord { role: Role::Chief, ..record("RMS of pictures", "ImageRms") };
        let two = vec![record("RMS distance", "Hausdorff"), chief];
        let columns = Columns([("compare.rms".to_owned(), two)].into_iter().collect());
        assert_eq!(columns.role("compare.rms"), Role::Chief);
        assert_eq!(columns.role("compare.max"), Role::Detail);
    }

    #[test]
    fn numbers_in_names_are_those_in_titles() {
        let all = [("compare.rms_#".to_owned(), vec![record("RMS from camera #", "X")])];
        let columns = Columns(all.into_iter().collect());
        assert_eq!(columns.find("compare.rms_12")[0].title, "RMS from camera 12");
        assert_eq!(columns.find("compare.rms_"), []);
        assert_eq!(columns.find("compare.psnr"), []);
    }
}
