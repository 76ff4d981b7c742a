//! The program finds its plugin in its own build, beside itself when installed, and at the path that a flag or an
//! environment variable gives.

use std::env::consts::{DLL_PREFIX, DLL_SUFFIX, EXE_SUFFIX};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn library() -> String {
    format!("{DLL_PREFIX}realistic{DLL_SUFFIX}")
}

/// Returns the plugin of this build.
pub(super) fn built() -> PathBuf {
    Path::new(env!("CARGO_BIN_EXE_realistic")).with_file_name("deps").join(library())
}

/// Copies the program to its own folder.
fn program_in(folder: &Path) -> PathBuf {
    fs::create_dir_all(folder).unwrap();
    let copy = folder.join(format!("realistic{EXE_SUFFIX}"));
    fs::copy(env!("CARGO_BIN_EXE_realistic"), &copy).unwrap();
    copy
}

fn put(source: impl AsRef<[u8]>, file: &Path) {
    fs::create_dir_all(file.parent().unwrap()).unwrap();
    fs::write(file, source).unwrap();
}

/// Renders a small picture.
fn render(program: &Path, variable: Option<&Path>, more: &[&str]) -> Output {
    let mut command = Command::new(program);
    let out = program.with_file_name("picture.png");
    command.args(["render", "--size", "6x4", "--spp", "1", "--out"]).arg(out).args(more);
    match variable {
        Some(path) => command.env("REALISTIC_PLUGIN", path),
        None => command.env_remove("REALISTIC_PLUGIN"),
    };
    command.output().unwrap()
}

/// Returns the path of the plugin that a rendering reports.
pub(super) fn taken(output: &Output) -> PathBuf {
    assert!(output.status.success(), "{}", refusal(output));
    let text = String::from_utf8_lossy(&output.stdout);
    let line = text.lines().find_map(|line| line.strip_prefix("plugin")).unwrap();
    PathBuf::from(line.trim().rsplit_once(", version").unwrap().0).canonicalize().unwrap()
}

fn refusal(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn a_stale_plugin_in_a_target_folder_is_not_taken() {
    let target = tempfile::tempdir().unwrap();
    let program = program_in(target.path());
    let fresh = target.path().join("deps").join(library());
    put(fs::read(built()).unwrap(), &fresh);
    // This file is written last, so the newest file is not the right one.
    put("left behind by an older build", &target.path().join(library()));
    assert_eq!(taken(&render(&program, None, &[])), fresh.canonicalize().unwrap());
}

#[test]
fn an_installed_program_takes_the_plugin_beside_it_or_in_lib() {
    let root = tempfile::tempdir().unwrap();
    let program = program_in(&root.path().join("bin"));
    let message = refusal(&render(&program, None, &[]));
    for words in ["cargo build --release -p realistic", "../lib", "--plugin", "REALISTIC_PLUGIN"] {
        assert!(message.contains(words), "{message}");
    }
    let plugin = fs::read(built()).unwrap();
    for folder in ["lib", "bin"] {
        let file = root.path().join(folder).join(library());
        put(&plugin, &file);
        assert_eq!(taken(&render(&program, None, &[])), file.canonicalize().unwrap());
    }
}

#[test]
fn the_plugin_flag_comes_before_the_variable_and_the_default_locations() {
    let root = tempfile::tempdir().unwrap();
    let program = program_in(root.path());
    put("no plugin", &root.path().join(library()));
    let [flag, variable] = ["flag.so", "variable.so"].map(|name| root.path().join(name));
    let missing = refusal(&render(&program, Some(&variable), &[]));
    assert!(missing.contains("variable.so") && !missing.contains("../lib"), "{missing}");
    for file in [&flag, &variable] {
        put(fs::read(built()).unwrap(), file);
    }
    assert_eq!(taken(&render(&program, Some(&variable), &[])), variable.canonicalize().unwrap());
    let given = ["--plugin", flag.to_str().unwrap()];
    assert_eq!(taken(&render(&program, Some(&variable), &given)), flag.canonicalize().unwrap());
    assert_eq!(taken(&render(&program, Some(Path::new("")), &given)), flag.canonicalize().unwrap());
}

#[test]
fn what_is_no_plugin_is_not_installed_over_one() {
    let root = tempfile::tempdir().unwrap();
    let [text, good] = ["text.so", "realistic.so"].map(|name| root.path().join(name));
    let plugin = fs::read(built()).unwrap();
    put(&plugin, &good);
    put("no plugin, and mentions realistic_abi_version", &text);
    let install = |source: &Path| {
        super::realistic(root.path(), &["install", ".", "--plugin", source.to_str().unwrap()])
    };
    let refused = install(&text);
    assert!(!refused.status.success() && fs::read(&good).unwrap() == plugin, "{}", refusal(&refused));
    let message = refusal(&refused);
    assert!(message.contains("cannot load the plugin") && message.contains("text.so"), "{message}");
    let done = install(&built());
    assert!(done.status.success(), "{}", refusal(&done));
}
