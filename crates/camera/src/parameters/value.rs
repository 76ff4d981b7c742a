//! The values that a host gives to parameters: their kinds, reading them from text, and converting them to
//! the parameter's type.

use super::{error::ParameterError, range::Range};
use realistic_base::message::{as_given, cut};

/// The kind of a parameter's value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// One number.
    Float,
    /// One string.
    Text,
    /// `true` or `false`.
    Bool,
    /// Four numbers.
    Four,
}

impl Kind {
    /// Returns the name of this kind, for messages.
    pub fn words(self) -> &'static str {
        match self {
            Self::Float => "a number",
            Self::Text => "a string",
            Self::Bool => "true or false",
            Self::Four => "four numbers",
        }
    }
}

/// A value for [`Parameters::set`](super::Parameters::set).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value<'a> {
    /// For [`Kind::Float`].
    Float(f64),
    /// For [`Kind::Text`].
    Text(&'a str),
    /// For [`Kind::Bool`].
    Bool(bool),
    /// For [`Kind::Four`].
    Four([f64; 4]),
}

impl<'a> Value<'a> {
    /// Reads a text as a value of a kind, with commas between four numbers; returns the text itself if it is
    /// not such a value.
    pub(super) fn from_text(kind: Kind, text: &'a str) -> Self {
        let value = match kind {
            Kind::Float => text.parse().ok().map(Value::Float),
            Kind::Bool => text.parse().ok().map(Value::Bool),
            Kind::Four => {
                let numbers: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
                numbers.ok().and_then(|numbers| numbers.try_into().ok()).map(Value::Four)
            }
            Kind::Text => None,
        };
        value.unwrap_or(Value::Text(text))
    }

    pub(super) fn has_nan(&self) -> bool {
        match self {
            Value::Float(number) => number.is_nan(),
            Value::Four(numbers) => numbers.iter().any(|number| number.is_nan()),
            Value::Text(_) | Value::Bool(_) => false,
        }
    }

    /// Returns the error of a value whose kind the parameter does not accept.
    pub(super) fn refused(self, name: &'static str, kind: Kind) -> ParameterError {
        let given = match self {
            Value::Float(number) => format!("the number {}", as_given(number)),
            Value::Text(text) => format!("the string \"{}\"", cut(text)),
            Value::Bool(truth) => format!("the boolean {truth}"),
            Value::Four(numbers) => format!("the numbers {numbers:?}"),
        };
        ParameterError::Kind { name, expected: kind.words(), given }
    }
}

/// A type of parameter values.
pub(super) trait Setting: Sized {
    /// The kind of value from which the type is converted.
    const KIND: Kind;
    /// The accepted values of that kind.
    const RANGE: Range = Range::Any;

    /// Converts a value of parameter `name`.
    ///
    /// # Errors
    /// The value is of another kind, or out of range.
    fn of(name: &'static str, value: Value<'_>) -> Result<Self, ParameterError>;
}

/// A parameter type of the kind [`Kind::Text`] that can be written as the text from which it is read.
pub trait Written {
    /// Returns the text that converts to this value.
    fn written(&self) -> String;
}

impl Written for String {
    fn written(&self) -> String {
        self.clone()
    }
}

macro_rules! settings {
    ($($type:ty: $kind:ident($value:ident) => $made:expr;)*) => {$(
        impl Setting for $type {
            const KIND: Kind = Kind::$kind;

            fn of(name: &'static str, value: Value<'_>) -> Result<Self, ParameterError> {
                match value {
                    Value::$kind($value) => Ok($made),
                    other => Err(other.refused(name, Self::KIND)),
                }
            }
        }
    )*};
}

settings! {
    f64: Float(number) => number;
    String: Text(text) => text.to_owned();
    bool: Bool(truth) => truth;
    [f64; 4]: Four(numbers) => numbers;
}
