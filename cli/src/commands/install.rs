//! `realistic install`: copies the plugin to the folder that a renderer searches.
//!
//! `realistic.so` is always installed. Copies under other names are made only on request: if a renderer finds a copy
//! under the name of one of its own cameras, it loads the copy instead.

use crate::console;
use crate::failure::Failure;
use crate::files;
use crate::host::plugin::{self, Plugin};
use realistic_camera::Model;
use std::path::{Path, PathBuf};

/// The camera's name in scene files, without `.so`.
const OWN_NAME: &str = "realistic";

/// The cameras that pbrt 1.0x ships as plugins.
const STOCK_CAMERAS: [&str; 3] = ["perspective", "orthographic", "environment"];

/// The options of `install`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Directory that the renderer loads plugins from; realistic.so is copied there, and a missing directory is created
    #[arg(value_name = "DIR")]
    directory: PathBuf,
    /// Also install a copy under this name, without .so: the camera's name in scene files
    #[arg(long = "as", value_name = "NAME", conflicts_with = "all")]
    name: Option<String>,
    /// Also install a copy under the name of every camera model; three of them are pbrt's own cameras
    #[arg(long)]
    all: bool,
    /// Replace files of these names even if they are plugins of other cameras
    #[arg(long)]
    force: bool,
    /// The plugin to copy [default: the one built with this program]
    #[arg(long, value_name = "FILE")]
    plugin: Option<PathBuf>,
}

/// Copies the plugin and reports the paths.
///
/// # Errors
/// There is no plugin or no directory, or a file must not be replaced.
pub fn run(args: &Args) -> Result<(), Failure> {
    let names = names(args)?;
    let source = plugin::find(args.plugin.as_deref())?;
    // A plugin that this program cannot load cannot be loaded by any renderer.
    Plugin::load(&source)?;
    let mut text = String::new();
    for copy in install(&source, &args.directory, &names, args.force)? {
        text += &format!("{} -> {}\n", source.display(), copy.display());
    }
    let directory = args.directory.canonicalize().unwrap_or_else(|_| args.directory.clone());
    text += &advice(&directory, &names);
    Ok(console::report(&text, &args.directory)?)
}

/// Returns the names of the copies without `.so`, each name once.
fn names(args: &Args) -> Result<Vec<&str>, Failure> {
    let mut names = vec![OWN_NAME];
    if args.all {
        // A copy under the name of a model becomes a camera of that model.
        names.extend(Model::NAMES.map(|(model, _)| model));
    }
    if let Some(given) = &args.name {
        let name = given.strip_suffix(".so").unwrap_or(given);
        if name.is_empty() || name.contains(['/', '\\']) {
            return Err(Failure::Usage(format!("--as \"{given}\" must be a file name without a directory")));
        }
        if name != OWN_NAME {
            names.push(name);
        }
    }
    Ok(names)
}

/// Returns notes on the copies, which state the cameras of pbrt that they replace and how pbrt finds them.
///
/// pbrt uses the first file of a given name along its path, so the directory goes to the end of the path, where it
/// replaces nothing. An empty path variable adds no empty entry.
fn advice(directory: &Path, names: &[&str]) -> String {
    let mut text = String::new();
    let replaced: Vec<&str> = names.iter().copied().filter(|name| STOCK_CAMERAS.contains(name)).collect();
    if !replaced.is_empty() {
        text += &format!(
            "Replaces pbrt's own {} for scenes that name {}, where {} stands before pbrt's plugins in the path; \
             after them, as below, pbrt's own are taken\n",
            replaced.join(", "),
            if replaced.len() == 1 { "it" } else { "them" },
            directory.display()
        );
    }
    text + &format!(
        "For pbrt: export PBRT_SEARCHPATH=\"${{PBRT_SEARCHPATH:+$PBRT_SEARCHPATH:}}{}\"\n",
        directory.display()
    )
}

/// Largest plugin that is read, bytes; a plugin with full debugging information has a tenth of this size.
const LARGEST: u64 = 1 << 30;

fn install(source: &Path, directory: &Path, names: &[&str], force: bool) -> Result<Vec<PathBuf>, Failure> {
    let failed = |path: &Path, error: std::io::Error| {
        Failure::Other(format!("{}: {error}; check the path and its permissions", path.display()))
    };
    files::make_folder(directory)?;
    let plugin = files::read(source, LARGEST).map_err(|error| failed(source, error))?;
    let copies: Vec<PathBuf> = names.iter().map(|name| directory.join(format!("{name}.so"))).collect();
    // All copies are checked before any is written, because half an installation is useless.
    for copy in &copies {
        if copy.exists() && !force && !files::read(copy, LARGEST).is_ok_and(|bytes| is_ours(&bytes)) {
            return Err(Failure::Other(format!(
                "{} exists and is not this plugin; move it away, install elsewhere, or give --force",
                copy.display()
            )));
        }
    }
    for copy in &copies {
        // A running renderer keeps the old file: the new file replaces the old one's name and not its contents.
        files::save(copy, &plugin).map_err(|error| failed(copy, error))?;
    }
    Ok(copies)
}

fn is_ours(bytes: &[u8]) -> bool {
    const MARK: &[u8] = b"realistic_abi_version";
    bytes.windows(MARK.len()).any(|window| window == MARK)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MODELS: [&str; 2] = ["lens", "perspective"];

    fn message(result: Result<Vec<PathBuf>, Failure>) -> String {
        match result {
            Err(Failure::Other(message)) => message,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn copies_are_real_and_replace_only_their_own_kind() {
        let dir = tempfile::tempdir().unwrap();
        let source = dir.path().join("source");
        std::fs::write(&source, "new realistic_abi_version").unwrap();
        let plugins = dir.path().join("plugins");
        std::fs::create_dir(&plugins).unwrap();
        std::fs::write(plugins.join("lens.so"), "old realistic_abi_version").unwrap();

        let copies = install(&source, &plugins, &MODELS, false).unwrap();
        assert_eq!(copies.len(), MODELS.len());
        for copy in &copies {
            assert!(copy.symlink_metadata().unwrap().is_file());
            assert_eq!(std::fs::read(copy).unwrap(), std::fs::read(&source).unwrap());
        }
        assert_eq!(std::fs::read_dir(&plugins).unwrap().count(), MODELS.len());

        let other = plugins.join("perspective.so");
        std::fs::write(&other, "another camera").unwrap();
        let refusal = message(install(&source, &plugins, &MODELS, false));
        assert!(refusal.contains("perspective.so") && refusal.contains("--force"), "{refusal}");
        install(&source, &plugins, &["perspective"], true).unwrap();
        assert_eq!(std::fs::read(&other).unwrap(), std::fs::read(&source).unwrap());
    }

    /// Parses the command line of `install`.
    fn args(words: &[&str]) -> Args {
        #[derive(clap::Parser)]
        struct Command {
            #[command(flatten)]
            args: Args,
        }
        let words = ["install", "plugins"].iter().chain(words);
        <Command as clap::Parser>::try_parse_from(words).unwrap().args
    }

    #[test]
    fn the_plugin_has_its_own_name_whatever_else_it_is_called() {
        assert_eq!(names(&args(&[])).unwrap(), ["realistic"]);
        assert_eq!(names(&args(&["--as", "lens.so"])).unwrap(), ["realistic", "lens"]);
        assert_eq!(names(&args(&["--as", "realistic"])).unwrap(), ["realistic"]);
        let all = args(&["--all"]);
        let all = names(&all).unwrap();
        assert_eq!(all[0], "realistic");
        assert!(Model::NAMES.iter().all(|(model, _)| all.contains(model)), "{all:?}");
        assert!(matches!(names(&args(&["--as", "a/b"])), Err(Failure::Usage(_))));
    }

    #[test]
    fn install_states_what_it_replaces_in_one_line() {
        let advice = |words: &[&str]| advice(Path::new("/plugins"), &names(&args(words)).unwrap());
        let plain = advice(&[]);
        assert_eq!(plain.lines().count(), 1, "{plain}");
        let all = advice(&["--all"]);
        let (first, rest) = all.split_once('\n').unwrap();
        assert!(first.contains("perspective, orthographic, environment"), "{first}");
        assert!(first.contains("before pbrt's plugins"), "{first}");
        assert_eq!(rest, plain);
        assert!(advice(&["--as", "environment"]).contains("own environment for scenes that name it"));

        // Runs the printed line in a shell.
        let export = plain.strip_prefix("For pbrt: ").unwrap();
        for (before, after) in [(None, "/plugins"), (Some(""), "/plugins"), (Some("/pbrt"), "/pbrt:/plugins")]
        {
            let mut shell = std::process::Command::new("sh");
            shell
                .arg("-c")
                .arg(format!("{export}printf %s \"$PBRT_SEARCHPATH\""))
                .env_remove("PBRT_SEARCHPATH");
            let output = shell.envs(before.map(|path| ("PBRT_SEARCHPATH", path))).output().unwrap();
            assert_eq!(String::from_utf8(output.stdout).unwrap(), after);
        }
    }

    #[test]
    fn a_missing_directory_is_made_and_a_file_is_none() {
        let dir = tempfile::tempdir().unwrap();
        let source = dir.path().join("source");
        std::fs::write(&source, "new realistic_abi_version").unwrap();
        let missing = dir.path().join("pbrt/plugins");
        install(&source, &missing, &["lens"], false).unwrap();
        assert!(missing.join("lens.so").is_file());
        let refusal = format!("{:?}", install(&source, &source, &["lens"], false));
        assert!(refusal.contains("source is a file; give a folder"), "{refusal}");
    }
}
