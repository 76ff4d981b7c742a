//! The example hosts in C, C++ and Rust compile without a warning, run, and produce the same
//! picture.

use super::harness;
#[path = "../../../examples/host.rs"]
mod host;

use std::ffi::OsString;
use std::path::Path;

use harness::{C99, CXX11, c_compiler, compile_with, compiler};

fn run(compiler: OsString, flags: &[&str], source: &str) -> Vec<u8> {
    let linking = harness::linking();
    let linking: Vec<&str> = linking.iter().map(String::as_str).collect();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(source);
    let name = format!("example_{}", source.replace('.', "_"));
    let program = compile_with(&compiler, flags, &path, &name, &linking);
    let directory = tempfile::tempdir().unwrap();
    let picture = directory.path().join("made.pgm");
    let output = harness::program(&program, "").arg(&picture).output().unwrap();
    assert!(output.status.success(), "{source}: {}", String::from_utf8_lossy(&output.stderr));
    std::fs::read(picture).unwrap()
}

#[test]
fn the_three_examples_make_one_picture_of_vignetting() {
    let rust = host::picture().expect("a picture");
    assert!(run(c_compiler(), &C99, "host.c") == rust, "C and Rust differ");
    assert!(run(compiler(), &CXX11, "host.cpp") == rust, "C++ and Rust differ");
    let header = b"P5\n64 48\n255\n";
    assert!(rust.starts_with(header));
    let pixels = &rust[header.len()..];
    assert_eq!(pixels.len(), 64 * 48);
    let at = |x: usize, y: usize| pixels[64 * y + x];
    assert!(at(32, 24) > 230, "bright in the middle: {}", at(32, 24));
    for (x, y) in [(0, 0), (63, 0), (0, 47), (63, 47)] {
        assert!(at(x, y) < at(32, 24) / 2 && at(x, y) > 0, "dark in the corner: {}", at(x, y));
    }
}

#[test]
fn the_middle_pixel_of_the_example_is_as_wide_as_geometry_says() {
    let width = f64::from(host::pixel_width().expect("a ray"));
    // The film is 35 mm wide in 80 pixels, behind a lens of 50 mm.
    let expected = 35.0 / 80.0 / 50.0 * 1e4;
    assert!((width / expected - 1.0).abs() < 0.02, "{width} against {expected}");
}
