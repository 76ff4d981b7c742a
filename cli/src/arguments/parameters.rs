//! The parameters of the library's table as flags: each by its own name, or by `--param NAME=VALUE`.
//!
//! The flags are generated from the table: a new row adds a flag to every command.

use super::film::OwnFilm;
use clap::error::{Error, ErrorKind};
use clap::{Arg, ArgAction, ArgMatches, Command};
use realistic_base::message::cut;
use realistic_camera::{Kind, PARAMETERS, Parameter, ParameterError, Parameters};

/// Camera parameters given by the user.
#[derive(Clone, Debug, Default)]
pub struct ParameterFlags {
    parameters: Parameters,
    /// Names in the table and values as text, in the order of the table.
    given: Vec<(&'static str, String)>,
}

/// Shorter flags of some parameters.
const SHORTER: [(&str, &str); 2] = [("lens_file", "lens"), ("focus_distance", "distance")];

/// Defaults of the program that differ from the table's.
const OWN_DEFAULTS: [(&str, &str); 1] = [("film_diagonal", OwnFilm::IN_WORDS)];

/// Parameters in the short help, which has room for few; `--help` lists all.
const COMMON: [&str; 6] =
    ["lens_file", "film_distance", "focus_distance", "zoom", "fnumber", "film_diagonal"];

/// The flag that takes any parameter as NAME=VALUE.
const PARAM: &str = "param";

/// The heading of the flags in help texts.
const HEADING: &str = "Camera";

impl ParameterFlags {
    /// Returns the values, checked one by one.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// Returns the names in the table with the values as they were written, in the order of the table.
    pub fn given(&self) -> impl Iterator<Item = (&'static str, &str)> {
        self.given.iter().map(|(name, value)| (*name, value.as_str()))
    }

    /// Reads all flags of a command, each parameter at most once.
    fn read(matches: &ArgMatches) -> Result<Self, String> {
        let mut flags = Self::default();
        let long = matches.get_many::<String>(PARAM).into_iter().flatten();
        let long: Vec<(&str, &str)> = long.map(|text| name_and_value(text)).collect::<Result<_, _>>()?;
        for (name, value) in &long {
            if Parameters::find(name).is_none() {
                // The library's error suggests the nearest name.
                set(&mut flags.parameters, name, value).map_err(|error| error.to_string())?;
            }
        }
        for row in PARAMETERS {
            let own = matches.get_many::<String>(row.name).into_iter().flatten().map(String::as_str);
            let named = |name: &str| Parameters::find(name).is_some_and(|found| found.name == row.name);
            let long = long.iter().filter(|(name, _)| named(name)).map(|(_, value)| *value);
            let mut values = own.chain(long);
            let Some(value) = values.next() else { continue };
            if values.next().is_some() {
                return Err(format!("parameter \"{}\" is given twice; give it once", row.name));
            }
            set(&mut flags.parameters, row.name, value).map_err(|error| error.to_string())?;
            flags.given.push((row.name, value.to_owned()));
        }
        Ok(flags)
    }
}

fn name_and_value(text: &str) -> Result<(&str, &str), String> {
    text.split_once('=').ok_or_else(|| {
        format!("--param \"{}\" has no \"=\"; write --param NAME=VALUE, as in pupil=rear", cut(text))
    })
}

/// Sets a parameter and checks that a number is in its range. Parameters of four numbers are checked later, when the
/// camera is built.
fn set(parameters: &mut Parameters, name: &str, text: &str) -> Result<(), ParameterError> {
    parameters.set_from_text(name, text)?;
    let row = Parameters::find(name).filter(|row| row.kind == Kind::Float);
    match (row, text.parse()) {
        (Some(row), Ok(number)) => row.check(number).map(drop),
        _ => Ok(()),
    }
}

/// Returns the flag of a parameter, without the leading hyphens: `film-distance` for `film_distance`.
pub fn flag_name(name: &str) -> String {
    name.replace('_', "-")
}

/// Makes the flag of a parameter.
fn flag(row: &'static Parameter) -> Arg {
    let shorter = SHORTER.iter().filter(|(name, _)| *name == row.name).map(|(_, flag)| *flag);
    let own = OWN_DEFAULTS.iter().find(|(name, _)| *name == row.name);
    let flag = Arg::new(row.name)
        .long(flag_name(row.name))
        .visible_aliases(shorter.collect::<Vec<_>>())
        .value_name(value_name(row))
        .help(short_help(row))
        .long_help(long_help(row, own.map_or(row.default, |(_, default)| *default)))
        .help_heading(HEADING)
        .action(ArgAction::Append)
        // A value may begin with a minus sign: -1e-3, -inf and -1,1,-1,1 are values, not flags.
        .allow_hyphen_values(matches!(row.kind, Kind::Float | Kind::Four))
        .hide_short_help(!COMMON.contains(&row.name));
    match row.kind {
        // The flag alone means true.
        Kind::Bool => flag.num_args(0..=1).require_equals(true).default_missing_value("true"),
        _ => flag,
    }
}

fn value_name(row: &Parameter) -> &'static str {
    match (row.kind, row.unit) {
        (Kind::Float, "mm") => "MM",
        (Kind::Float, "nm") => "NM",
        (Kind::Float, _) => "N",
        (Kind::Four, _) => "A,B,C,D",
        (Kind::Bool, _) => "true|false",
        (Kind::Text, _) => "NAME",
    }
}

/// Returns the parameter's name in words and its unit.
fn short_help(row: &Parameter) -> String {
    let (words, _) = row.help.split_once(", ").unwrap_or((row.help, ""));
    let unit = if row.unit.is_empty() { String::new() } else { format!(", in {}", row.unit) };
    capitalised(words) + &unit
}

/// Returns the table's description of a parameter, with this default in words.
pub(super) fn long_help(row: &Parameter, default: &'static str) -> String {
    capitalised(&Parameter { default, ..*row }.description())
}

/// Capitalises a sentence of the table for a help text.
pub(super) fn capitalised(text: &str) -> String {
    let text = text.replace('`', "");
    let (first, rest) = text.split_at(1);
    first.to_uppercase() + rest
}

impl clap::Args for ParameterFlags {
    fn augment_args(command: Command) -> Command {
        let param = Arg::new(PARAM)
            .long(PARAM)
            .value_name("NAME=VALUE")
            .help("A camera parameter by its name; repeat the flag for others")
            .help_heading(HEADING)
            .action(ArgAction::Append)
            .hide_short_help(true);
        PARAMETERS.iter().fold(command, |command, row| command.arg(flag(row))).arg(param)
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl clap::FromArgMatches for ParameterFlags {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        Self::read(matches).map_err(|message| {
            let text = format!("{message}\n\nFor more information, try '--help'.\n");
            Error::raw(ErrorKind::ValueValidation, text)
        })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::FromArgMatches as _;
    use realistic_camera::Pupil;

    fn read(words: &[&str]) -> Result<ParameterFlags, String> {
        let command = <ParameterFlags as clap::Args>::augment_args(Command::new("test"));
        let matches =
            command.try_get_matches_from([&["test"], words].concat()).map_err(|error| error.to_string())?;
        ParameterFlags::from_arg_matches(&matches).map_err(|error| error.to_string())
    }

    #[test]
    fn every_parameter_is_a_flag_equal_to_its_long_form() {
        for row in PARAMETERS {
            let known = [row.default, "1", "true", "1,2,3,4", "500"];
            let taken =
                |text: &&&str| !text.is_empty() && set(&mut Parameters::default(), row.name, text).is_ok();
            let value = known.iter().find(taken);
            let value = value.expect("a value that it takes");
            let long = read(&["--param", &format!("{}={value}", row.name)]).unwrap();
            let shorter =
                SHORTER.iter().filter(|(name, _)| *name == row.name).map(|(_, own)| (*own).to_owned());
            for name in std::iter::once(flag_name(row.name)).chain(shorter) {
                let flag = read(&[&format!("--{name}={value}")]).unwrap();
                assert_eq!(flag.parameters, long.parameters, "{name}");
                assert_eq!(flag.given().collect::<Vec<_>>(), [(row.name, *value)]);
            }
            for alias in row.aliases {
                let by_alias = read(&["--param", &format!("{alias}={value}")]).unwrap();
                assert_eq!(by_alias.given().collect::<Vec<_>>(), [(row.name, *value)], "{alias}");
            }
        }
    }

    #[test]
    fn a_parameter_is_given_once_and_in_its_range() {
        let refusal = |words: &[&str]| read(words).unwrap_err();
        let flags = read(&["--film-distance", "40.5", "--param", "pupil=disk"]).unwrap();
        assert_eq!((flags.parameters.film_distance, flags.parameters.pupil), (Some(40.5), Some(Pupil::Disk)));
        assert!(refusal(&["--param", "fokus=3"]).contains("focus_distance"));
        assert!(refusal(&["--param", "film_diagonal"]).contains("NAME=VALUE"));
        assert!(refusal(&["--param", "film_diagonal=large"]).contains("a number"));
        for twice in [
            &["--film-diagonal", "35", "--film-diagonal", "36"][..],
            &["--film-diagonal", "35", "--param", "film_diagonal=36"],
            &["--lens", "a.dat", "--param", "lensfile=b.dat"],
        ] {
            assert!(refusal(twice).contains("twice"), "{twice:?}");
        }
        for (name, value) in [("mm_per_unit", "0"), ("film_diagonal", "-35")] {
            let message = refusal(&[&format!("--{}", flag_name(name)), value]);
            assert!(message.contains(name) && message.contains("must be"), "{message}");
        }
    }
}
