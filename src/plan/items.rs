//! The plan as people read it: what is kept and left out, why, and what that changes.

use std::fmt;

use super::choice::Choice;

/// One thing that was decided.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Item {
    /// What it is about.
    pub what: String,
    /// Whether it was kept; else it was left out.
    pub kept: bool,
    /// Why.
    pub why: String,
    /// What that changes.
    pub effect: String,
}

/// What a camera keeps and leaves out.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    items: Vec<Item>,
    choice: Option<Choice>,
}

impl Plan {
    /// Everything that was decided, in the order of the data's way.
    pub fn items(&self) -> &[Item] {
        &self.items
    }

    /// How the model of the lens was chosen; `None` without a tolerance.
    pub fn choice(&self) -> Option<&Choice> {
        self.choice.as_ref()
    }

    pub(crate) fn kept(&mut self, what: &str, why: impl Into<String>, effect: impl Into<String>) {
        self.decide(what, true, why.into(), effect.into());
    }

    pub(crate) fn left_out(&mut self, what: &str, why: impl Into<String>, effect: impl Into<String>) {
        self.decide(what, false, why.into(), effect.into());
    }

    fn decide(&mut self, what: &str, kept: bool, why: String, effect: String) {
        self.items.push(Item { what: what.to_owned(), kept, why, effect });
    }

    pub(crate) fn set_choice(&mut self, choice: Choice) {
        self.choice = Some(choice);
    }
}

/// Two lines an item; then how the model of the lens was chosen.
impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for Item { what, kept, why, effect } in &self.items {
            let verdict = if *kept { "kept" } else { "left out" };
            writeln!(f, "{verdict:<10}{what}\n{:10}{why}; {effect}", "")?;
        }
        self.choice.as_ref().map_or(Ok(()), |choice| write!(f, "\n{choice}"))
    }
}
