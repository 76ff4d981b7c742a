//! Suggestions for an unknown flag: clap's own guess compares letters alone and may be far off.

use crate::arguments::flag_name;
use clap::error::{ContextKind, ContextValue, Error, ErrorKind};
use clap::{Arg, Command};
use realistic_base::message::nearest;
use realistic_camera::Parameters;
use std::ffi::OsString;

/// Other programs' words for flags that are not parameters of the library.
const OTHER_WORDS: [(&str, &str); 6] = [
    ("samples", "spp"),
    ("samplesperpixel", "spp"),
    ("resolution", "size"),
    ("output", "out"),
    ("ev", "compensation"),
    ("jobs", "threads"),
];

/// Returns the error of an unknown flag, with the flag that the user may have intended and the usage of the given
/// command.
pub fn corrected(error: Error, mut all: Command, words: &[OsString]) -> Error {
    let Some(ContextValue::String(given)) = error.get(ContextKind::InvalidArg).cloned() else { return error };
    all.build();
    let named = words
        .iter()
        .skip(1)
        .filter_map(|word| word.to_str())
        .find(|word| all.find_subcommand(word).is_some());
    let command = match named {
        Some(name) => all.find_subcommand_mut(name).expect("found before"),
        None => &mut all,
    };
    let mut suggestion = Error::new(ErrorKind::UnknownArgument).with_cmd(command);
    if let Some(flag) = intended_flag(&given, command) {
        suggestion.insert(ContextKind::SuggestedArg, ContextValue::String(flag));
    }
    suggestion.insert(ContextKind::InvalidArg, ContextValue::String(given));
    suggestion.insert(ContextKind::Usage, ContextValue::StyledStr(command.render_usage()));
    suggestion
}

/// Returns the flag of a command that has the meaning of the given flag, or almost the same spelling.
fn intended_flag(given: &str, command: &Command) -> Option<String> {
    let shown = command.get_arguments().filter(|arg| !arg.is_hide_set());
    let names = |arg: &Arg| {
        let aliases = arg.get_visible_aliases().into_iter().flatten();
        arg.get_long().into_iter().chain(aliases).map(|name| format!("--{name}")).collect::<Vec<_>>()
    };
    let flags: Vec<String> = shown.flat_map(names).collect();
    let word = given.trim_start_matches('-');
    let letters = word.replace(['-', '_'], "").to_ascii_lowercase();
    let known = OTHER_WORDS.iter().filter(|(other, _)| *other == letters).map(|(_, name)| *name);
    let mut by_meaning = known
        .map(str::to_owned)
        .chain(Parameters::nearest(word).map(flag_name))
        .map(|name| format!("--{name}"));
    by_meaning
        .find(|flag| flags.contains(flag))
        .or_else(|| nearest(given, flags.iter().map(String::as_str)).map(str::to_owned))
}
