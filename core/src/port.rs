//! Typed, named inputs and outputs of modules.

use std::marker::PhantomData;

use crate::data::{Data, DataType, DecodeError, Value, decode};
use crate::quantity::{Quantities, Quantity};

/// A required input: the plan refuses a map that leaves it unlinked.
#[derive(Debug)]
pub struct In<T> {
    pub(crate) name: &'static str,
    doc: &'static str,
    of: PhantomData<fn() -> T>,
}

/// An optional input.
#[derive(Debug)]
pub struct MaybeIn<T> {
    pub(crate) name: &'static str,
    doc: &'static str,
    of: PhantomData<fn() -> T>,
}

/// A required input that takes a value of any type.
#[derive(Clone, Copy, Debug)]
pub struct AnyIn {
    pub(crate) name: &'static str,
    doc: &'static str,
}

/// An input that takes as many links as a map gives it, at least one. Values come in the order of
/// the links in the map.
#[derive(Debug)]
pub struct ManyIn<T> {
    pub(crate) name: &'static str,
    doc: &'static str,
    of: PhantomData<fn() -> T>,
}

/// A [`ManyIn`] of values of any type.
#[derive(Clone, Copy, Debug)]
pub struct ManyAnyIn {
    pub(crate) name: &'static str,
    doc: &'static str,
}

/// What an [`AnyIn`] takes.
pub(crate) const ANY: DataType =
    DataType { id: "Any", doc: "A value of any type.", color: [200, 200, 200] };

impl DataType {
    /// Whether an input of this type takes a value of the type `given`. What comes into a map from
    /// outside may be of any type; once the map is opened it is known.
    pub fn takes(self, given: Self) -> bool {
        self == given || self == ANY || given == ANY
    }
}

/// An output. A module that finishes has put a value into each.
#[derive(Debug)]
pub struct Out<T> {
    pub(crate) name: &'static str,
    doc: &'static str,
    quantities: Quantities,
    of: PhantomData<fn() -> T>,
}

/// What the runtime knows of an input.
#[derive(Clone, Copy, Debug)]
pub struct InputSpec {
    /// Snake case, unique among the inputs and parameters of its module.
    pub name: &'static str,
    /// What it takes, in a sentence.
    pub doc: &'static str,
    /// The type that it takes.
    pub data_type: DataType,
    /// Whether the module runs only with it.
    pub is_required: bool,
    /// Whether it takes any number of links.
    pub is_many: bool,
}

impl InputSpec {
    const fn of(name: &'static str, doc: &'static str, data_type: DataType) -> Self {
        Self { name, doc, data_type, is_required: true, is_many: false }
    }
}

/// What the runtime knows of an output.
#[derive(Clone, Copy, Debug)]
pub struct OutputSpec {
    /// Snake case, unique among the outputs of its module.
    pub name: &'static str,
    /// What it gives, in a sentence.
    pub doc: &'static str,
    /// The type that it gives.
    pub data_type: DataType,
    /// Which numbers it brings into the table of results.
    pub quantities: Quantities,
    /// Whether a value is one cell of a table.
    pub(crate) is_cell: bool,
    pub(crate) decode: fn(&[u8]) -> Result<Value, DecodeError>,
}

impl<T: Data> In<T> {
    /// Declares the input.
    pub const fn new(name: &'static str, doc: &'static str) -> Self {
        Self { name, doc, of: PhantomData }
    }

    /// The declaration, for [`crate::Module::inputs`].
    pub const fn spec(&self) -> InputSpec {
        InputSpec::of(self.name, self.doc, T::TYPE)
    }
}

impl AnyIn {
    /// Declares the input.
    pub const fn new(name: &'static str, doc: &'static str) -> Self {
        Self { name, doc }
    }

    /// The declaration, for [`crate::Module::inputs`].
    pub const fn spec(&self) -> InputSpec {
        InputSpec::of(self.name, self.doc, ANY)
    }
}

impl<T: Data> ManyIn<T> {
    /// Declares the input.
    pub const fn new(name: &'static str, doc: &'static str) -> Self {
        Self { name, doc, of: PhantomData }
    }

    /// The declaration, for [`crate::Module::inputs`].
    pub const fn spec(&self) -> InputSpec {
        InputSpec { is_many: true, ..InputSpec::of(self.name, self.doc, T::TYPE) }
    }
}

impl ManyAnyIn {
    /// Declares the input.
    pub const fn new(name: &'static str, doc: &'static str) -> Self {
        Self { name, doc }
    }

    /// The declaration, for [`crate::Module::inputs`].
    pub const fn spec(&self) -> InputSpec {
        InputSpec { is_many: true, ..InputSpec::of(self.name, self.doc, ANY) }
    }
}

impl<T: Data> MaybeIn<T> {
    /// Declares the input.
    pub const fn new(name: &'static str, doc: &'static str) -> Self {
        Self { name, doc, of: PhantomData }
    }

    /// The declaration, for [`crate::Module::inputs`].
    pub const fn spec(&self) -> InputSpec {
        InputSpec { is_required: false, ..InputSpec::of(self.name, self.doc, T::TYPE) }
    }
}

impl<T: Data> Out<T> {
    /// Declares the output.
    pub const fn new(name: &'static str, doc: &'static str) -> Self {
        Self { name, doc, quantities: Quantities::Plain, of: PhantomData }
    }

    /// Declares which numbers its value brings into the table of results.
    pub const fn giving(self, quantities: Quantities) -> Self {
        Self { quantities, ..self }
    }

    /// The declaration, for [`crate::Module::outputs`].
    pub const fn spec(&self) -> OutputSpec {
        OutputSpec {
            name: self.name,
            doc: self.doc,
            data_type: T::TYPE,
            quantities: self.quantities,
            is_cell: T::IS_CELL,
            decode: decode::<T>,
        }
    }
}

impl Out<f64> {
    /// Declares an output that is a number, under the name of what it is.
    pub const fn number(quantity: Quantity) -> Self {
        let (name, doc) = (quantity.name, quantity.doc);
        Self { name, doc, quantities: Quantities::One(quantity), of: PhantomData }
    }
}
