//! Records the fate of every key of a file. A key is used if its reader has asked for its value, and informative if it
//! is known to have no effect on rays. The other keys are left out by name.

use super::document::Node;
use crate::prescription::{Fate, reader::ledger::Ledger};

/// Keys without an effect, with the reason. A key is given alone, or as `Parent.Key`.
pub(super) type NoEffect = &'static [(&'static str, &'static [&'static str])];

/// The reason recorded for an unknown key.
const UNKNOWN: &str = "a key that this reader does not know";

/// Keys that only wrap the members of an object, and that statements leave out.
const WRAPPERS: [&str; 1] = ["attributes"];

/// Records the fates of all keys below `root` that have none yet.
pub(super) fn record(root: &Node, no_effect: NoEffect, ledger: &mut Ledger<'_>) {
    below(root, "", no_effect, ledger);
    ledger.close_lines();
}

fn below(node: &Node, parent: &str, no_effect: NoEffect, ledger: &mut Ledger<'_>) {
    for (key, own) in node.members() {
        let is_wrapper = WRAPPERS.contains(&key.as_str());
        let statement = if parent.is_empty() { key.clone() } else { format!("{parent}.{key}") };
        if ledger.is_noted(own.location) {
            continue;
        }
        let reason = no_effect
            .iter()
            .find(|(_, keys)| keys.contains(&key.as_str()) || keys.contains(&statement.as_str()))
            .map(|(reason, _)| *reason);
        let is_comment = key.starts_with('(') && key.ends_with(')');
        let reason = reason.or(is_comment.then_some("a comment, as its key stands in parentheses"));
        match reason {
            _ if own.is_read() && own.is_object() => {
                below(own, if is_wrapper { parent } else { key }, no_effect, ledger);
            }
            _ if own.is_read() && own.is_list() && !own.elements().is_empty() => {
                list(own, key, &statement, no_effect, ledger);
            }
            _ if own.is_read() => ledger.note(Fate::Used, own.location, &statement, None, ""),
            Some(reason) => ledger.note(Fate::Informative, own.location, &statement, None, reason),
            None => ledger.unknown(own.location, &statement, None, UNKNOWN),
        }
    }
}

/// Records the fate of a list: of the members of its objects, or of its values together.
fn list(list: &Node, key: &str, statement: &str, no_effect: NoEffect, ledger: &mut Ledger<'_>) {
    if list.elements().iter().any(Node::is_object) {
        list.elements().iter().for_each(|own| below(own, key, no_effect, ledger));
    } else {
        ledger.note(Fate::Used, list.location, statement, None, "");
    }
}
