//! Finds the plugin: at the path that the user gives, in the build that contains the program, or where it is
//! installed.

use super::library::{PluginError, file_name};
use std::path::{Path, PathBuf};

/// The environment variable that names the plugin if `--plugin` does not.
const VARIABLE: &str = "REALISTIC_PLUGIN";

/// Returns the plugin's file: `given`, else `REALISTIC_PLUGIN`, else the first of the program's own candidates that
/// exists.
///
/// # Errors
/// No such file.
pub fn find(given: Option<&Path>) -> Result<PathBuf, PluginError> {
    let named = given.map(Path::to_path_buf);
    let variable = || std::env::var_os(VARIABLE).filter(|path| !path.is_empty()).map(PathBuf::from);
    let program = std::env::current_exe().unwrap_or_default();
    first_of(match named.or_else(variable) {
        Some(path) => vec![path],
        None => candidates(program.parent().unwrap_or(Path::new("."))),
    })
}

/// Returns the paths that a program in this folder searches. In a target folder, the copy in `deps/` comes first:
/// cargo writes it in every build of the library, but puts a copy beside the program only when the library is the
/// target.
fn candidates(folder: &Path) -> Vec<PathBuf> {
    let deps = folder.join("deps");
    let in_build = deps.is_dir().then_some(deps);
    // The program's own unit tests run in deps/.
    let installed = [folder.to_path_buf(), folder.join("../lib")];
    in_build.into_iter().chain(installed).map(|candidate| candidate.join(file_name())).collect()
}

fn first_of(candidates: Vec<PathBuf>) -> Result<PathBuf, PluginError> {
    let searched =
        || candidates.iter().map(|candidate| candidate.display().to_string()).collect::<Vec<_>>().join(", ");
    let found = candidates.iter().find(|candidate| candidate.is_file()).cloned();
    found.ok_or_else(|| PluginError::NotFound { searched: searched() })
}
