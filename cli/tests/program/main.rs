//! Tests of the built program, which they run as a user does.

mod export;
mod files;
mod gallery;
mod lenses;
mod osl;
mod pages;
mod pictures;
mod plugin;
#[cfg(target_os = "linux")]
mod release;
mod reports;
mod spellings;
mod tiles;
mod unsymmetric;
mod waves;
mod wrong_uses;

use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

/// Runs the program in a folder.
fn realistic(directory: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_realistic")).current_dir(directory).args(arguments).output().unwrap()
}

fn run(arguments: &[&str], input: &str) -> Output {
    run_in(Path::new("."), arguments, input)
}

/// Runs the program in a folder, with a text on its standard input.
fn run_in(directory: &Path, arguments: &[&str], input: &str) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_realistic"))
        .current_dir(directory)
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut pipe = child.stdin.take().expect("a pipe");
    // A separate thread writes the input, so that the two sides never wait for each other with full pipes.
    let input = input.to_owned();
    let writer = std::thread::spawn(move || {
        // A program that needs no input may have ended already.
        let _ = pipe.write_all(input.as_bytes());
    });
    let output = child.wait_with_output().expect("the program ends");
    writer.join().expect("the input is written");
    output
}

fn succeeds(arguments: &[&str], input: &str) -> String {
    let output = run(arguments, input);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

/// Returns the standard error of a command that must fail with this code.
fn fails(arguments: &[&str], input: &str, code: i32) -> String {
    let output = run(arguments, input);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}");
    String::from_utf8(output.stderr).expect("text")
}
