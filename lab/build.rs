//! Passes the compiler's version and flags to the laboratory's reports.

use std::env;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let value = |key: &str| env::var(key).unwrap_or_default();
    let version = std::process::Command::new(value("RUSTC")).arg("--version").output();
    let version =
        version.map(|output| String::from_utf8_lossy(&output.stdout).trim().to_owned()).unwrap_or_default();
    println!("cargo::rustc-env=REALISTIC_RUSTC={version}");
    println!(
        "cargo::rustc-env=REALISTIC_RUSTFLAGS={}",
        value("CARGO_ENCODED_RUSTFLAGS").replace('\x1f', " ")
    );
    println!("cargo::rustc-env=REALISTIC_OPT_LEVEL={}", value("OPT_LEVEL"));
    println!("cargo::rustc-env=REALISTIC_TARGET={}", value("TARGET"));
}
