//! `realistic install`: copies of the plugin where a renderer looks for them.

use crate::failure::Failure;
use crate::host::plugin;
use realistic::camera::Model;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// What `install` can be told.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Directory that the renderer loads plugins from
    #[arg(value_name = "DIR")]
    directory: PathBuf,
    /// File name of the copy, without .so: the camera's name in scene files
    #[arg(long = "as", value_name = "NAME", default_value = "realistic", conflicts_with = "all")]
    name: String,
    /// A copy under the name of every camera model, for scenes that name these
    #[arg(long)]
    all: bool,
    /// Replace files of these names even when they are another camera's plugins
    #[arg(long)]
    force: bool,
    /// The plugin to copy [default: the one built with this program]
    #[arg(long, value_name = "FILE")]
    plugin: Option<PathBuf>,
}

/// Copies the plugin and says where to.
///
/// # Errors
/// No plugin, no directory, or a file that must not be replaced.
pub fn run(args: &Args) -> Result<(), Failure> {
    let name = args.name.strip_suffix(".so").unwrap_or(&args.name);
    if name.is_empty() || name.contains(['/', '\\']) {
        return Err(Failure::Usage(format!(
            "--as \"{}\" must be a file name without a directory",
            args.name
        )));
    }
    // A copy under the name of a model is a camera of that model.
    let models = Model::NAMES.map(|(model, _)| model);
    let names: &[&str] = if args.all { &models } else { &[name] };
    let source = plugin::find(args.plugin.as_deref())?;
    let mut text = String::new();
    for copy in install(&source, &args.directory, names, args.force)? {
        text += &format!("{} -> {}\n", source.display(), copy.display());
    }
    let directory = args.directory.canonicalize().unwrap_or_else(|_| args.directory.clone());
    text += &format!("For pbrt: export PBRT_SEARCHPATH=\"{}:$PBRT_SEARCHPATH\"\n", directory.display());
    Ok(std::io::stdout().write_all(text.as_bytes())?)
}

fn install(source: &Path, directory: &Path, names: &[&str], force: bool) -> Result<Vec<PathBuf>, Failure> {
    let failed = |path: &Path, error: std::io::Error| {
        Failure::Other(format!("{}: {error}; check the path and its permissions", path.display()))
    };
    if !directory.is_dir() {
        return Err(Failure::Other(format!(
            "there is no directory {0}; create it with `mkdir -p {0}`, or give the directory that \
             the renderer's plugins lie in",
            directory.display()
        )));
    }
    let plugin = std::fs::read(source).map_err(|error| failed(source, error))?;
    let copies: Vec<PathBuf> = names.iter().map(|name| directory.join(format!("{name}.so"))).collect();
    // All are checked before one is written: half an installation helps nobody.
    for copy in &copies {
        if copy.exists() && !force && !std::fs::read(copy).is_ok_and(|bytes| is_ours(&bytes)) {
            return Err(Failure::Other(format!(
                "{} exists and is not this plugin; move it away, install elsewhere, or give --force",
                copy.display()
            )));
        }
    }
    for copy in &copies {
        // A renderer may be running the old file: it must keep it, so the new one takes its
        // name and not its contents.
        let partial = copy.with_extension("so.partial");
        std::fs::write(&partial, &plugin)
            .and_then(|()| std::fs::rename(&partial, copy))
            .map_err(|error| failed(copy, error))?;
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

    #[test]
    fn a_missing_directory_is_not_created() {
        let dir = tempfile::tempdir().unwrap();
        let missing = dir.path().join("missing");
        let refusal = message(install(Path::new("source"), &missing, &["lens"], false));
        assert!(refusal.contains("mkdir -p"), "{refusal}");
        assert!(!missing.exists());
    }
}
