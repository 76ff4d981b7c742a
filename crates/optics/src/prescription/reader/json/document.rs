//! A JSON text as a tree of values, each with its place in the file.
//!
//! `serde_json` checks the text. Python writes `Infinity`, `-Infinity` and `NaN` without quotes, which is no JSON;
//! strings of the same length replace them beforehand, so that places stay the same.

use std::{borrow::Cow, cell::Cell, collections::HashSet};

use crate::prescription::{
    LensFileError,
    reader::text::{Location, Text},
};
use realistic_base::message::{as_given, cut};

/// Words for numbers that JSON has not, and JSON strings of the same length.
const NOT_JSON: [(&str, &str); 3] =
    [("-Infinity", "\"-\\u221e\""), ("Infinity", "\"\\u221e\""), ("NaN", "\"~\"")];

/// A value.
#[derive(Debug)]
enum Value {
    Null,
    Flag(bool),
    Number(f64),
    Text(String),
    List(Vec<Node>),
    Object(Vec<(String, Node)>),
}

/// A value with its place: that of its key or, without a key, its own.
#[derive(Debug)]
pub(super) struct Node {
    pub location: Location,
    value: Value,
    /// Whether a reader has asked for the value.
    is_read: Cell<bool>,
}

impl Node {
    /// Parses a text.
    ///
    /// # Errors
    /// The text is not JSON, or an object has a key twice.
    pub(super) fn of(text: &Text<'_>) -> Result<Self, LensFileError> {
        let json = with_strings(text.whole());
        serde_json::from_str::<serde_json::Value>(&json).map_err(|error| {
            let location = Location { line: error.line().max(1), column: error.column().max(1) };
            let message = error.to_string();
            let message = message.split(" at line ").next().unwrap_or_default();
            text.error(location, format!("not JSON from here on: {message}"))
        })?;
        let end = if json.contains('\n') { b'\n' } else { b'\r' };
        let bytes = json.as_bytes();
        let lines = (0..bytes.len()).filter(|&i| bytes[i] == end).map(|i| i + 1);
        let mut scanner = Scanner { text, json: &json, lines: lines.collect(), offset: 0 };
        scanner.node(None)
    }

    /// Returns the member with this name; `None` if there is none or it is `null`.
    pub(super) fn get(&self, key: &str) -> Option<&Self> {
        let own = self.members().iter().find(|(own, _)| own == key).map(|(_, node)| node)?;
        own.is_read.set(true);
        Some(own).filter(|own| !matches!(own.value, Value::Null))
    }

    /// Returns whether there is a member of that name, without counting it as read.
    pub(super) fn has(&self, key: &str) -> bool {
        matches!(&self.value, Value::Object(members) if members.iter().any(|(own, _)| own == key))
    }

    /// Returns the members of an object; none for another value.
    pub(super) fn members(&self) -> &[(String, Self)] {
        self.is_read.set(true);
        match &self.value {
            Value::Object(members) => members,
            _ => &[],
        }
    }

    /// Returns the elements of a list; none for another value.
    pub(super) fn elements(&self) -> &[Self] {
        self.is_read.set(true);
        match &self.value {
            Value::List(elements) => elements,
            _ => &[],
        }
    }

    /// Returns whether the value is a list or an object, which has parts of its own.
    pub(super) fn is_list(&self) -> bool {
        matches!(self.value, Value::List(_))
    }

    pub(super) fn is_object(&self) -> bool {
        matches!(self.value, Value::Object(_))
    }

    /// Returns whether a reader has asked for the value.
    pub(super) fn is_read(&self) -> bool {
        self.is_read.get()
    }

    /// Returns the string; `None` for another value.
    pub(super) fn string(&self) -> Option<&str> {
        self.is_read.set(true);
        match &self.value {
            Value::Text(string) => Some(string),
            _ => None,
        }
    }

    /// Returns the number, which may be infinite; `None` for another value.
    pub(super) fn number(&self) -> Option<f64> {
        self.is_read.set(true);
        match &self.value {
            Value::Number(number) => Some(*number),
            Value::Text(text) => match text.as_str() {
                "Infinity" | "\u{221e}" => Some(f64::INFINITY),
                "-Infinity" | "-\u{221e}" => Some(f64::NEG_INFINITY),
                _ => None,
            },
            _ => None,
        }
    }

    /// Returns the value as messages show it.
    pub(super) fn shown(&self) -> String {
        match &self.value {
            Value::Null => "null".to_owned(),
            Value::Flag(flag) => flag.to_string(),
            Value::Number(number) => as_given(*number),
            Value::Text(text) if text == "~" => "NaN".to_owned(),
            Value::Text(text) => format!("\"{}\"", cut(&text.replace('\u{221e}', "Infinity"))),
            Value::List(_) => "a list".to_owned(),
            Value::Object(_) => "an object".to_owned(),
        }
    }

    /// Returns whether the value is `true`; `None` if it is no truth value.
    pub(super) fn flag(&self) -> Option<bool> {
        self.is_read.set(true);
        match &self.value {
            Value::Flag(flag) => Some(*flag),
            _ => None,
        }
    }
}

/// Returns the text with JSON strings for the words that are not JSON, outside strings.
fn with_strings(text: &str) -> Cow<'_, str> {
    if NOT_JSON.iter().all(|(word, _)| !text.contains(word)) {
        return Cow::Borrowed(text);
    }
    let mut json = String::with_capacity(text.len());
    let (mut rest, mut in_string) = (text, false);
    while let Some(first) = rest.chars().next() {
        let word = NOT_JSON.iter().find(|(word, _)| !in_string && rest.starts_with(word));
        let length = match (word, first) {
            (Some((word, string)), _) => {
                json.push_str(string);
                rest = &rest[word.len()..];
                continue;
            }
            // An escaped character does not end the string.
            (None, '\\') if in_string => 1 + rest[1..].chars().next().map_or(0, char::len_utf8),
            (None, _) => first.len_utf8(),
        };
        in_string ^= first == '"';
        json.push_str(&rest[..length]);
        rest = &rest[length..];
    }
    Cow::Owned(json)
}

/// Builds the tree of a text that `serde_json` accepted.
struct Scanner<'t> {
    text: &'t Text<'t>,
    json: &'t str,
    /// The offsets at which the lines behind the first begin.
    lines: Vec<usize>,
    offset: usize,
}

impl Scanner<'_> {
    /// Returns the next value. Its place is `key` or, without a key, its own.
    fn node(&mut self, key: Option<Location>) -> Result<Node, LensFileError> {
        let first = self.peek();
        let location = key.unwrap_or_else(|| self.location());
        let value = match first {
            b'{' => Value::Object(self.members()?),
            b'[' => Value::List(self.list()?),
            _ => self.scalar(),
        };
        Ok(Node { location, value, is_read: Cell::new(false) })
    }

    fn members(&mut self) -> Result<Vec<(String, Node)>, LensFileError> {
        let mut members = Vec::new();
        let mut keys = HashSet::new();
        self.offset += 1;
        while self.peek() != b'}' {
            let location = self.location();
            let Value::Text(key) = self.scalar() else { break };
            if !keys.insert(key.clone()) {
                let message = format!("a second \"{}\" in the same object; expected one", cut(&key));
                return Err(self.text.error(location, message));
            }
            self.skip(b':');
            members.push((key, self.node(Some(location))?));
            self.skip(b',');
        }
        self.skip(b'}');
        Ok(members)
    }

    fn list(&mut self) -> Result<Vec<Node>, LensFileError> {
        let mut elements = Vec::new();
        self.offset += 1;
        while self.peek() != b']' {
            elements.push(self.node(None)?);
            self.skip(b',');
        }
        self.skip(b']');
        Ok(elements)
    }

    /// Returns the next value, which is neither a list nor an object.
    fn scalar(&mut self) -> Value {
        let rest = &self.json[self.offset..];
        let length = if rest.starts_with('"') {
            let mut is_escaped = false;
            let end = rest.bytes().skip(1).position(|byte| {
                let is_end = byte == b'"' && !is_escaped;
                is_escaped = byte == b'\\' && !is_escaped;
                is_end
            });
            end.map_or(rest.len(), |end| end + 2)
        } else {
            rest.find([',', ']', '}', ' ', '\t', '\r', '\n', ':']).unwrap_or(rest.len()).max(1)
        };
        let word = rest.get(..length).unwrap_or(rest);
        self.offset += word.len();
        match serde_json::from_str(word) {
            Ok(serde_json::Value::Bool(flag)) => Value::Flag(flag),
            Ok(serde_json::Value::Number(number)) => number.as_f64().map_or(Value::Null, Value::Number),
            Ok(serde_json::Value::String(text)) => Value::Text(text),
            _ => Value::Null,
        }
    }

    /// Returns the next byte that is not white space, without passing it. At the end of the text this is a bracket,
    /// which ends every loop.
    fn peek(&mut self) -> u8 {
        let bytes = self.json.as_bytes();
        while bytes.get(self.offset).is_some_and(u8::is_ascii_whitespace) {
            self.offset += 1;
        }
        bytes.get(self.offset).copied().unwrap_or(b']')
    }

    /// Passes this byte, if it comes next.
    fn skip(&mut self, byte: u8) {
        if self.peek() == byte && self.offset < self.json.len() {
            self.offset += 1;
        }
    }

    fn location(&self) -> Location {
        let line = self.lines.partition_point(|&start| start <= self.offset);
        let start = line.checked_sub(1).map_or(0, |before| self.lines[before]);
        Location { line: line + 1, column: self.offset - start + 1 }
    }
}

/// A node of a text, for readers: finds members, and reports errors with their place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part<'j> {
    pub text: &'j Text<'j>,
    pub node: &'j Node,
}

impl<'j> Part<'j> {
    pub(super) fn error(&self, message: impl Into<String>) -> LensFileError {
        self.text.error(self.node.location, message)
    }

    fn with(&self, node: &'j Node) -> Self {
        Self { text: self.text, node }
    }

    /// Returns the member with this name; `None` if there is none or it is `null`.
    pub(super) fn get(&self, key: &str) -> Option<Self> {
        self.node.get(key).map(|node| self.with(node))
    }

    /// Returns the member with this name.
    ///
    /// # Errors
    /// There is none.
    pub(super) fn need(&self, key: &str, what: &str) -> Result<Self, LensFileError> {
        self.get(key).ok_or_else(|| self.error(format!("no \"{key}\" here; expected {what}")))
    }

    /// Returns the elements of the list of that name; none if there is no such member.
    ///
    /// # Errors
    /// The member is no list.
    pub(super) fn list(&self, key: &str) -> Result<Vec<Self>, LensFileError> {
        let Some(list) = self.get(key) else { return Ok(Vec::new()) };
        if !list.node.is_list() {
            return Err(list.error(format!("\"{key}\" is {}; expected a list", list.node.shown())));
        }
        Ok(list.node.elements().iter().map(|node| self.with(node)).collect())
    }

    /// Returns the members of an object.
    pub(super) fn members(&self) -> impl Iterator<Item = (&'j str, Self)> {
        let text = self.text;
        self.node.members().iter().map(move |(key, node)| (key.as_str(), Self { text, node }))
    }

    /// Returns the number of that name, which may be infinite; `None` if there is no such member.
    ///
    /// # Errors
    /// The member is no number.
    pub(super) fn number_or_infinity(&self, key: &str) -> Result<Option<f64>, LensFileError> {
        self.get(key).map(|part| part.own_number(key)).transpose()
    }

    fn own_number(&self, key: &str) -> Result<f64, LensFileError> {
        let none = || self.error(format!("\"{key}\" is {}; expected a number", self.node.shown()));
        self.node.number().ok_or_else(none)
    }

    /// Returns the finite number with this name; `None` if there is no such member.
    ///
    /// # Errors
    /// The member is no finite number.
    pub(super) fn number(&self, key: &str) -> Result<Option<f64>, LensFileError> {
        self.get(key).map(|part| part.finite(key)).transpose()
    }

    /// Returns the finite number with this name.
    ///
    /// # Errors
    /// There is none, or it is no finite number.
    pub(super) fn needed_number(&self, key: &str, what: &str) -> Result<f64, LensFileError> {
        self.need(key, what)?.finite(key)
    }

    /// Returns the number that this part is. `key` is its name in messages.
    ///
    /// # Errors
    /// The part is no finite number.
    pub(super) fn finite(&self, key: &str) -> Result<f64, LensFileError> {
        let number = self.own_number(key)?;
        if number.is_finite() {
            return Ok(number);
        }
        Err(self.error(format!("\"{key}\" is {}; expected a finite number", self.node.shown())))
    }

    /// Returns the numbers of the list of that name; none if there is no such member.
    ///
    /// # Errors
    /// The member is no list of finite numbers.
    pub(super) fn numbers(&self, key: &str) -> Result<Vec<f64>, LensFileError> {
        self.list(key)?.iter().map(|part| part.finite(key)).collect()
    }

    /// Returns the string with this name; `None` if there is no such member.
    ///
    /// # Errors
    /// The member is no string.
    pub(super) fn string(&self, key: &str) -> Result<Option<&'j str>, LensFileError> {
        let Some(part) = self.get(key) else { return Ok(None) };
        let none = || part.error(format!("\"{key}\" is {}; expected a string", part.node.shown()));
        part.node.string().map(Some).ok_or_else(none)
    }

    /// Returns the truth value of that name; `false` if there is no such member.
    ///
    /// # Errors
    /// The member is no truth value.
    pub(super) fn flag(&self, key: &str) -> Result<bool, LensFileError> {
        let Some(part) = self.get(key) else { return Ok(false) };
        let none = || part.error(format!("\"{key}\" is {}; expected true or false", part.node.shown()));
        part.node.flag().ok_or_else(none)
    }
}
