//! What the numbers that modules give mean to whoever compares them.
//!
//! Declared once, where the number is made: by an output of a module, or by an entry of a choice
//! for what a module gives with it. Nothing is called better than something else without such a
//! declaration.

use serde::{Deserialize, Serialize};

/// Which values are better.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Better {
    /// Small ones, as of an error.
    Lower,
    /// Large ones, as of a likeness.
    Higher,
    /// None: a count, or what has no good end.
    #[default]
    Neither,
}

/// What a number is measured in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Nothing: a count, a share, an index.
    None,
    /// The same unit for every model: `dB`.
    Fixed(&'static str),
    /// A unit that the model brings, so that numbers of two models do not compare.
    Model(&'static str),
}

impl Unit {
    /// Lengths in the coordinates of a mesh.
    pub const LENGTH: Self = Self::Model("model units");

    /// Its name; empty for none.
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "",
            Self::Fixed(name) | Self::Model(name) => name,
        }
    }
}

/// The part that a number has in a report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// One of many, shown where it is asked for.
    #[default]
    Detail,
    /// Shown where nobody says what to show.
    Chief,
    /// How large a result is. Measures are compared only where it is the same, and plotted
    /// against it.
    Size,
}

/// The declaration of a number that a module gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quantity {
    /// In lower case with underscores, the name of a column. `#` stands for a number from 0, where
    /// there are as many as the parameters say.
    pub name: &'static str,
    /// Its name for a person; empty where the other one will do.
    pub title: &'static str,
    /// What it is, in a sentence.
    pub doc: &'static str,
    /// What it is measured in.
    pub unit: Unit,
    /// Which values are better.
    pub better: Better,
    /// Its part in a report.
    pub role: Role,
}

impl Quantity {
    /// A number of which no end is better.
    pub const fn new(name: &'static str, doc: &'static str) -> Self {
        let (better, role) = (Better::Neither, Role::Detail);
        Self { name, title: "", doc, unit: Unit::None, better, role }
    }

    /// Names it for a person.
    pub const fn titled(self, title: &'static str) -> Self {
        Self { title, ..self }
    }

    /// Says what it is measured in.
    pub const fn in_unit(self, unit: Unit) -> Self {
        Self { unit, ..self }
    }

    /// Declares that lower is better.
    pub const fn lower(self) -> Self {
        Self { better: Better::Lower, ..self }
    }

    /// Declares that higher is better.
    pub const fn higher(self) -> Self {
        Self { better: Better::Higher, ..self }
    }

    /// Shows it where nobody says what to show.
    pub const fn chief(self) -> Self {
        Self { role: Role::Chief, ..self }
    }

    /// Declares that it says how large a result is.
    pub const fn size(self) -> Self {
        Self { role: Role::Size, ..self }
    }
}

/// Which numbers an output brings into the table of results.
#[derive(Clone, Copy, Debug)]
pub enum Quantities {
    /// None that is declared; a value that fits a cell is one without a direction.
    Plain,
    /// This one.
    One(Quantity),
    /// These, in a row of measures.
    Row(&'static [Quantity]),
    /// Those of the entry that the choice of this name names.
    OfChoice(&'static str),
    /// The first of those, under the name of the output.
    FirstOfChoice(&'static str),
}

impl Quantities {
    /// The choice whose entry decides which they are.
    pub(crate) fn choice(self) -> Option<&'static str> {
        match self {
            Self::Plain | Self::One(_) | Self::Row(_) => None,
            Self::OfChoice(param) | Self::FirstOfChoice(param) => Some(param),
        }
    }
}
