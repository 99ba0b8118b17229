//! What flows through ports: immutable, shared values of declared types.

use std::any::Any;
use std::fmt;
use std::sync::Arc;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::stored::Stored;

/// The declaration of a data type. Two are the same type when their ids are equal.
#[derive(Clone, Copy, Debug)]
pub struct DataType {
    /// CamelCase, unique: `TriMesh`.
    pub id: &'static str,
    /// What a value is, in one sentence.
    pub doc: &'static str,
    /// Color of its ports and links, red, green, blue.
    pub color: [u8; 3],
}

impl PartialEq for DataType {
    fn eq(&self, other: &Self) -> bool {
        self.id == other.id
    }
}

impl Eq for DataType {}

/// A type whose values flow through ports.
///
/// Values are never changed once they have left their module; serialization is what the disk cache
/// keeps, and must bring back an equal value.
pub trait Data: Clone + Serialize + DeserializeOwned + Send + Sync + 'static {
    /// The declaration of the type.
    const TYPE: DataType;

    /// Bytes that the value holds, heap included; what the caches count against their budgets.
    fn byte_size(&self) -> usize;

    /// One line for a person: `69,451 faces, 35,947 vertices`.
    fn summary(&self) -> String;

    /// The value as a table cell, for types that fit one.
    fn scalar(&self) -> Option<Scalar> {
        None
    }

    /// The value as several table cells with names of their own, for types that hold a row.
    fn cells(&self) -> Vec<(String, Scalar)> {
        Vec::new()
    }

    /// Tests what must hold for every value of the type, after it was read from a cache.
    fn check(&self) -> Result<(), String> {
        Ok(())
    }

    /// The files that the value is a handle to, for types whose content need not fit into memory.
    fn stored(&self) -> Vec<Stored> {
        Vec::new()
    }
}

/// A value small enough for a table cell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Scalar {
    /// True or false.
    Flag(bool),
    /// A number; whole ones print without a fraction. Numbers that JSON cannot say (infinite, not
    /// a number) are written as `null` and come back as not a number.
    Number(#[serde(deserialize_with = "number_or_nan")] f64),
    /// A text.
    Text(String),
}

fn number_or_nan<'de, D: serde::Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::<f64>::deserialize(from)?.unwrap_or(f64::NAN))
}

impl fmt::Display for Scalar {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flag(flag) => flag.fmt(f),
            Self::Number(number) => number.fmt(f),
            Self::Text(text) => text.fmt(f),
        }
    }
}

/// Why cached bytes gave no value.
#[derive(Debug, Error)]
pub enum DecodeError {
    /// The bytes are not a value of the type.
    #[error("not a {0}: {1}")]
    Format(&'static str, postcard::Error),
    /// The bytes are a value, but one that breaks the rules of its type.
    #[error("a broken {0}: {1}")]
    Content(&'static str, String),
}

/// A value of any data type, shared without copying.
#[derive(Clone)]
pub struct Value(Arc<dyn Erased>);

impl Value {
    /// Wraps a value.
    pub fn new<T: Data>(value: T) -> Self {
        Self(Arc::new(value))
    }

    /// Wraps a value that others hold too.
    pub fn from_shared<T: Data>(value: Arc<T>) -> Self {
        Self(value)
    }

    /// The value as the type that it was made with, shared; `None` if it is of another type.
    pub fn get<T: Data>(&self) -> Option<Arc<T>> {
        Arc::clone(&self.0).into_any().downcast().ok()
    }

    /// The value itself: moved out where nobody else holds it, else cloned.
    pub fn take<T: Data>(self) -> Option<T> {
        let shared: Arc<T> = self.0.into_any().downcast().ok()?;
        Some(Arc::try_unwrap(shared).unwrap_or_else(|shared| (*shared).clone()))
    }

    /// The declaration of its type.
    pub fn data_type(&self) -> DataType {
        self.0.data_type()
    }

    /// Bytes that it holds.
    pub fn byte_size(&self) -> usize {
        self.0.byte_size()
    }

    /// One line for a person.
    pub fn summary(&self) -> String {
        self.0.summary()
    }

    /// The value as a table cell, for types that fit one.
    pub fn scalar(&self) -> Option<Scalar> {
        self.0.scalar()
    }

    /// The value as several table cells with names of their own, for types that hold a row.
    pub fn cells(&self) -> Vec<(String, Scalar)> {
        self.0.cells()
    }

    /// The files that it is a handle to.
    pub(crate) fn stored(&self) -> Vec<Stored> {
        self.0.stored()
    }

    /// The value as bytes, equal for equal values.
    pub fn encode(&self) -> Result<Vec<u8>, postcard::Error> {
        self.0.encode()
    }
}

impl fmt::Debug for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}({})", self.data_type().id, self.summary())
    }
}

/// Reads a value of type `T` from what [`Value::encode`] wrote.
pub(crate) fn decode<T: Data>(bytes: &[u8]) -> Result<Value, DecodeError> {
    let value: T =
        postcard::from_bytes(bytes).map_err(|error| DecodeError::Format(T::TYPE.id, error))?;
    value.check().map_err(|fault| DecodeError::Content(T::TYPE.id, fault))?;
    Ok(Value::new(value))
}

/// [`Data`] without the parts that need the type, so that values of all types share one pointer.
trait Erased: Send + Sync {
    fn data_type(&self) -> DataType;
    fn byte_size(&self) -> usize;
    fn summary(&self) -> String;
    fn scalar(&self) -> Option<Scalar>;
    fn cells(&self) -> Vec<(String, Scalar)>;
    fn encode(&self) -> Result<Vec<u8>, postcard::Error>;
    fn stored(&self) -> Vec<Stored>;
    fn into_any(self: Arc<Self>) -> Arc<dyn Any + Send + Sync>;
}

impl<T: Data> Erased for T {
    fn data_type(&self) -> DataType {
        T::TYPE
    }

    fn byte_size(&self) -> usize {
        Data::byte_size(self)
    }

    fn summary(&self) -> String {
        Data::summary(self)
    }

    fn scalar(&self) -> Option<Scalar> {
        Data::scalar(self)
    }

    fn cells(&self) -> Vec<(String, Scalar)> {
        Data::cells(self)
    }

    fn encode(&self) -> Result<Vec<u8>, postcard::Error> {
        postcard::to_stdvec(self)
    }

    fn stored(&self) -> Vec<Stored> {
        Data::stored(self)
    }

    fn into_any(self: Arc<Self>) -> Arc<dyn Any + Send + Sync> {
        self
    }
}

impl Data for f64 {
    const TYPE: DataType =
        DataType { id: "Number", doc: "A number, whole or not.", color: [150, 160, 170] };

    fn byte_size(&self) -> usize {
        size_of::<Self>()
    }

    fn summary(&self) -> String {
        self.to_string()
    }

    fn scalar(&self) -> Option<Scalar> {
        Some(Scalar::Number(*self))
    }
}

impl Data for bool {
    const TYPE: DataType = DataType { id: "Flag", doc: "True or false.", color: [205, 120, 150] };

    fn byte_size(&self) -> usize {
        size_of::<Self>()
    }

    fn summary(&self) -> String {
        self.to_string()
    }

    fn scalar(&self) -> Option<Scalar> {
        Some(Scalar::Flag(*self))
    }
}

impl Data for String {
    const TYPE: DataType = DataType { id: "Text", doc: "A text.", color: [110, 170, 220] };

    fn byte_size(&self) -> usize {
        size_of::<Self>() + self.len()
    }

    fn summary(&self) -> String {
        self.clone()
    }

    fn scalar(&self) -> Option<Scalar> {
        Some(Scalar::Text(self.clone()))
    }
}

impl Data for Stored {
    const TYPE: DataType =
        DataType { id: "File", doc: "The bytes of a file, of any size.", color: [140, 140, 120] };

    fn byte_size(&self) -> usize {
        self.handle_size()
    }

    fn summary(&self) -> String {
        format!("{} bytes in a file", self.n_bytes())
    }

    fn check(&self) -> Result<(), String> {
        Stored::check(self)
    }

    fn stored(&self) -> Vec<Stored> {
        vec![self.clone()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sole_owner_takes_without_copying() {
        let text = String::from("long enough to live on the heap");
        let address = text.as_ptr();
        let value = Value::new(text);
        let taken: String = value.take().unwrap();
        assert_eq!(taken.as_ptr(), address);
    }

    #[test]
    fn a_value_is_of_its_own_type_only() {
        let value = Value::new(2.5);
        assert_eq!(value.get::<f64>().as_deref(), Some(&2.5));
        assert!(value.get::<bool>().is_none());
    }

    #[test]
    fn scalars_survive_json() {
        for scalar in [Scalar::Flag(true), Scalar::Number(0.1), Scalar::Text("x".into())] {
            let text = serde_json::to_string(&scalar).unwrap();
            assert_eq!(serde_json::from_str::<Scalar>(&text).unwrap(), scalar);
        }
        // A number whose last bit a hasty reader loses.
        let number = Scalar::Number(1.489_018_613_047_592_8e-17);
        let text = serde_json::to_string(&number).unwrap();
        assert_eq!(serde_json::from_str::<Scalar>(&text).unwrap(), number);
        let nan: Scalar = serde_json::from_str("null").unwrap();
        assert!(matches!(nan, Scalar::Number(number) if number.is_nan()));
    }
}
