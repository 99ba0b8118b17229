//! Named numbers: what a metric or a measuring module found.

use std::borrow::Cow;

use mve_core::{Data, DataType, Quantity, Scalar, brief};
use serde::{Deserialize, Serialize};

use super::TriMesh;

/// A number with its name and unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measure {
    /// In lower case with underscores, the name of a column: `max_relative`.
    pub name: Cow<'static, str>,
    /// What was measured; not a number where it is not defined.
    pub value: f64,
    /// `model units`, or empty for a number without unit.
    pub unit: Cow<'static, str>,
    /// One sentence.
    pub doc: Cow<'static, str>,
}

impl Measure {
    /// The value of a declared quantity.
    pub const fn of(quantity: &Quantity, value: f64) -> Self {
        let [name, doc] = [Cow::Borrowed(quantity.name), Cow::Borrowed(quantity.doc)];
        Self { name, value, unit: Cow::Borrowed(quantity.unit.name()), doc }
    }

    /// The value of one of several that are declared together, by its number.
    pub fn nth(quantity: &Quantity, number: usize, value: f64) -> Self {
        let named = |text: &str| Cow::Owned(text.replace('#', &number.to_string()));
        let (name, doc) = (named(quantity.name), named(quantity.doc));
        Self { name, doc, ..Self::of(quantity, value) }
    }
}

/// Measures in the order in which they are to be read; names are unique. Each is a column of a
/// results table.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Measures(pub Vec<Measure>);

impl Data for Measures {
    const TYPE: DataType = DataType {
        id: "Measures",
        doc: "Named numbers with units; each is a column of a results table.",
        color: [170, 140, 220],
    };

    fn byte_size(&self) -> usize {
        size_of::<Self>() + size_of_val(self.0.as_slice())
    }

    fn summary(&self) -> String {
        let shown = self.0.iter().take(4).map(|m| format!("{} {}", m.name, brief(m.value)));
        let more = if self.0.len() > 4 { ", …" } else { "" };
        shown.collect::<Vec<_>>().join(", ") + more
    }

    fn cells(&self) -> Vec<(String, Scalar)> {
        self.0.iter().map(|m| (m.name.to_string(), Scalar::Number(m.value))).collect()
    }
}

/// One number, whatever the mesh.
pub(super) fn sample(_: &TriMesh) -> Measures {
    Measures(vec![Measure::of(&Quantity::new("x", "A number."), 1.0)])
}
