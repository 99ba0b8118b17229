//! Named numbers: what a metric or a measuring module found.

use std::borrow::Cow;

use mve_core::{Data, DataType, Scalar, brief};
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
    /// A measure that the program names itself.
    pub const fn new(
        name: &'static str,
        value: f64,
        unit: &'static str,
        doc: &'static str,
    ) -> Self {
        let [name, unit, doc] = [Cow::Borrowed(name), Cow::Borrowed(unit), Cow::Borrowed(doc)];
        Self { name, value, unit, doc }
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
    Measures(vec![Measure::new("x", 1.0, "", "A number.")])
}
