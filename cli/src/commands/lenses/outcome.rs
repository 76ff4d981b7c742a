//! The outcome of reading a file of a collection.

use super::row::facts;
use realistic_optics::prescription::{CollectionFile, GlassLibrary, MAX_ARCHIVE_BYTES, MAX_FILE_BYTES};
use serde_json::{Map, Value};

/// The kind of a file, with the facts of a lens.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// A lens, with the facts of its row.
    Lens(Map<String, Value>),
    /// A file that has the name of a lens file and cannot be read as one, with the reason.
    Unreadable(String),
    /// Another file.
    NoLens,
}

impl Outcome {
    /// Returns the maximum number of bytes that are read of a file. A large file without the name of a lens file is not
    /// read.
    pub fn cost(file: &CollectionFile) -> u64 {
        match file.is_named_as_lens() {
            true => file.size.clamp(1, MAX_ARCHIVE_BYTES),
            false if file.size > MAX_FILE_BYTES => 0,
            false => file.size,
        }
    }

    /// Reads a file. A file without the name of a lens file is a lens if it can be read as one.
    pub fn of(file: &CollectionFile, library: &GlassLibrary) -> Self {
        let is_named = file.is_named_as_lens();
        if Self::cost(file) == 0 {
            return Self::NoLens;
        }
        let lens = file.lens(library).map_err(|error| error.to_string());
        match lens.and_then(|lens| facts(&lens)) {
            Ok(facts) => Self::Lens(facts),
            Err(why) if is_named => Self::Unreadable(why),
            Err(_) => Self::NoLens,
        }
    }

    /// Returns the outcome as JSON, for a cache.
    pub fn json(&self) -> Value {
        match self {
            Self::Lens(facts) => facts.clone().into(),
            Self::Unreadable(why) => why.clone().into(),
            Self::NoLens => Value::Null,
        }
    }

    /// Returns the outcome that [`json`](Self::json) wrote.
    pub fn of_json(value: &Value) -> Option<Self> {
        match value {
            Value::Object(facts) => Some(Self::Lens(facts.clone())),
            Value::String(why) => Some(Self::Unreadable(why.clone())),
            Value::Null => Some(Self::NoLens),
            _ => None,
        }
    }
}
