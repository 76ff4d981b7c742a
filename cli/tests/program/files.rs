//! Files: behaviour on a full disk, a lens piped in, and numbers for lenses of any size.

use super::{fails, succeeds};
use std::fs;
use std::path::Path;

const SINGLET: &str = "20 5 1.5 10\n-20 0 1 10\n";

/// Runs the program where no file may grow beyond a few hundred bytes, which acts like a full disk.
#[cfg(unix)]
fn on_a_full_disk(directory: &Path, arguments: &[&str]) -> std::process::Output {
    let script = "trap '' XFSZ; ulimit -f 1; exec \"$0\" \"$@\"";
    let mut shell = std::process::Command::new("sh");
    shell.args(["-c", script, env!("CARGO_BIN_EXE_realistic")]).args(arguments);
    shell.current_dir(directory).output().unwrap()
}

#[cfg(unix)]
#[test]
fn a_full_disk_keeps_the_old_file_and_no_part_of_a_new_one() {
    let (dir, plugins) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let small = ["--size", "60x40", "--spp", "1"];
    let taken = |arguments: &[&'static str]| [arguments, &small].concat();
    for (file, arguments) in [
        ("a.png", taken(&["render", "--out", "a.png"])),
        ("a.exr", taken(&["render", "--out", "a.exr"])),
        ("focus-01.png", taken(&["focus-stack", "--from", "700", "--to", "inf", "--count", "2"])),
        ("a.svg", vec!["draw", "dgauss.50mm", "--out", "a.svg"]),
        ("b.png", vec!["draw", "dgauss.50mm", "--out", "b.png"]),
        ("c.svg", vec!["focus", "dgauss.50mm", "--distance", "2000", "--out", "c.svg"]),
        ("d.svg", vec!["pupil", "dgauss.50mm", "--film-radius", "3", "--out", "d.svg"]),
        ("disks.png", vec!["disks"]),
        ("realistic.so", vec!["install", ".", "--force"]),
    ] {
        let dir = if file == "realistic.so" { plugins.path() } else { dir.path() };
        let others = fs::read_dir(dir).unwrap().count();
        fs::write(dir.join(file), "the old one").unwrap();
        let output = on_a_full_disk(dir, &arguments);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {stderr}");
        assert!(stderr.contains(file) && stderr.contains("too large"), "{arguments:?}: {stderr}");
        assert_eq!(fs::read_to_string(dir.join(file)).unwrap(), "the old one", "{arguments:?}");
        assert_eq!(fs::read_dir(dir).unwrap().count(), others + 1, "{arguments:?}");
    }
}

#[test]
fn a_lens_is_piped_in_wherever_one_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("singlet.dat");
    fs::write(&file, SINGLET).unwrap();
    let file = file.to_str().unwrap();
    for arguments in [&["lens"][..], &["focus", "--distance", "500"], &["pupil", "--film-radius", "2"]] {
        let with = |lens| [&arguments[..1], &[lens], &arguments[1..]].concat();
        let named = succeeds(&with(file), "").replace("singlet.dat", "standard input");
        assert_eq!(succeeds(&with("-"), SINGLET), named);
    }
    let out = dir.path().join("a.png");
    let render =
        |lens| ["render", "--size", "6x4", "--spp", "1", "--lens", lens, "--out", out.to_str().unwrap()];
    succeeds(&render(file), "");
    let named = fs::read(&out).unwrap();
    succeeds(&render("-"), SINGLET);
    assert_eq!(fs::read(&out).unwrap(), named);
    succeeds(&["plan", "-"], SINGLET);

    for arguments in [&["lens", "-"][..], &render("-")] {
        let stderr = fails(arguments, "20 5 1.5 10\n-20 x 1 10\n", 1);
        assert!(stderr.contains("standard input:2:5: \"x\" is not a number"), "{stderr}");
    }
    // The program reads no more than the size limit of a lens file.
    let stderr = fails(&["lens", "-"], &"#\n".repeat(3 << 20), 1);
    assert!(
        stderr.contains("standard input:524289:1: ") && stderr.contains("at most 1048576 bytes"),
        "{stderr}"
    );
    let stderr = fails(&["trace", "-"], "", 2);
    assert!(stderr.contains("standard input has the rays"), "{stderr}");
}

#[test]
fn an_exposure_that_is_no_number_is_refused() {
    for stops in ["nan", "inf", "-inf"] {
        let stderr = fails(&["render", &format!("--compensation={stops}")], "", 2);
        assert!(stderr.contains("--compensation") && stderr.contains("write a finite number"), "{stderr}");
    }
}

#[test]
fn lenses_and_distances_of_any_size_have_a_few_digits() {
    let stdout = succeeds(&["lens", "dgauss.50mm@1e-9mm"], "");
    assert!(stdout.contains("focal length      1.0000e-9 mm"), "{stdout}");
    assert!(!stdout.contains("0.0000 mm"), "{stdout}");
    let stdout = succeeds(&["focus", "dgauss.50mm@1e-9mm", "--distance", "1e-8", "--coc", "1e-12"], "");
    assert!(!stdout.contains(" 0.000"), "{stdout}");
    let stdout = succeeds(&["focus", "dgauss.50mm", "--distance", "1e308"], "");
    assert!(stdout.contains("in focus         1.0000e308 mm from the film"), "{stdout}");
    for distance in ["1e-308", "1"] {
        let stderr = fails(&["focus", "dgauss.50mm", "--distance", distance], "", 1);
        assert!(stderr.contains(&format!("cannot focus at {distance} mm")) && stderr.len() < 200, "{stderr}");
    }
}

#[test]
fn focus_answers_for_the_requested_conjugate() {
    // Returns the film distances by exact rays and by first-order optics, mm.
    let film_distances = |film: &str| -> [f64; 2] {
        let stdout = succeeds(&["focus", "dgauss.50mm", "--film-distance", film], "");
        let line = stdout.lines().find(|line| line.starts_with("film distance")).unwrap();
        let numbers: Vec<f64> = line.split(' ').filter_map(|word| word.parse().ok()).collect();
        assert_eq!(stdout.contains("its image larger than itself"), numbers[0] > 86.4, "{stdout}");
        numbers.try_into().unwrap()
    };
    for film in ["37", "40", "50", "100", "150", "300"] {
        let [exact, paraxial] = film_distances(film);
        assert!((exact / paraxial - 1.0).abs() < 0.05, "{exact} {paraxial}");
    }
}
