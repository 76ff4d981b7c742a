//! Wrong uses that a new user might make: each message states the error and the correction.

use super::realistic;
use std::fs;

/// Arguments, exit code, and words that the answer must contain.
type WrongUse = (&'static [&'static str], i32, &'static [&'static str]);

/// Exit code 2 stands for wrong use, and 1 for an unusable lens, focus or file.
const WRONG_USES: &[WrongUse] = &[
    // Commands and flags.
    (&["rendr"], 2, &["unrecognized subcommand 'rendr'", "'render'"]),
    (&["dgauss.50mm"], 2, &["a lens follows a command", "realistic render LENS"]),
    (&["singlet.dat"], 2, &["a lens follows a command"]),
    (&["help", "rendr"], 2, &["rendr"]),
    (&["--lense", "dgauss.50mm"], 2, &["unexpected argument '--lense'", "'--lens'"]),
    (&["render", "--ssp", "3"], 2, &["unexpected argument '--ssp'", "'--spp'"]),
    (&["render", "--focusdistnace", "900"], 2, &["'--focus-distance'"]),
    (&["render", "--param", "fokusdistance=900"], 2, &["did you mean \"focus_distance\""]),
    (&["render", "--fstop", "4"], 2, &["'--fstop'", "'--fnumber'", "Usage: realistic render"]),
    (&["focus", "dgauss.50mm", "--f-stop", "4"], 2, &["'--f-stop'", "'--fnumber'", "Usage: realistic focus"]),
    (&["--aperture", "4"], 2, &["'--aperture'", "'--fnumber'"]),
    (&["render", "--Film_Distance", "40"], 2, &["'--film-distance'"]),
    (&["render", "--resolution", "6x4"], 2, &["'--size'"]),
    (&["render", "--ev", "1"], 2, &["'--compensation'"]),
    (&["render", "--param", "fstop=4"], 2, &["did you mean \"fnumber\""]),
    (&["render", "--screen-window", "-1,1,-1"], 2, &["\"screen_window\"", "four numbers", "-1,1,-1"]),
    (&["render", "--film-diagonal", "-inf"], 2, &["\"film_diagonal\" is -inf"]),
    (&["render", "--param", "focus_distance"], 2, &["has no \"=\"", "--param NAME=VALUE"]),
    (&["render", "--param", "focus_distance 900"], 2, &["has no \"=\""]),
    (&["render", "--spp"], 2, &["a value is required for '--spp <N>'"]),
    (&["completions", "tcsh"], 2, &["invalid value 'tcsh'", "bash", "zsh"]),
    // Numbers.
    (&["render", "--spp", "0"], 2, &["'0' for '--spp <N>'", "write a whole number from 1 to 16384"]),
    (&["render", "--spp", "1.5"], 2, &["'1.5'", "write a whole number from 1 to 16384"]),
    (&["render", "--spp", "-4"], 2, &["'-4'", "write a whole number from 1 to 16384"]),
    (&["render", "--spp", "many"], 2, &["'many'", "write a whole number from 1 to 16384"]),
    (&["render", "--seed", "-1"], 2, &["'-1'", "write a whole number from 0"]),
    (&["render", "--threads", "0"], 2, &["write a whole number from 1 to 1024"]),
    (&["render", "--size", "480"], 2, &["write WIDTHxHEIGHT in pixels", "480x320"]),
    (&["render", "--size", "480X320"], 2, &["write WIDTHxHEIGHT"]),
    (&["render", "--size", "0x320"], 2, &["each 1 to 16384"]),
    (&["render", "--compensation", "bright"], 2, &["write a finite number"]),
    (&["render", "--wavelengths", "2"], 2, &["write a whole number from 3 to 256"]),
    (&["draw", "dgauss.50mm", "--rays", "0"], 2, &["write a whole number from 1 to 999"]),
    (
        &["focus-stack", "--from", "500", "--to", "800", "--count", "1"],
        2,
        &["write a whole number from 2 to 999"],
    ),
    // Parameters.
    (
        &["render", "--mm-per-unit", "0"],
        2,
        &["\"mm_per_unit\" is 0", "must be positive", "from 1e-15 to 1e30 mm"],
    ),
    (&["render", "--param", "mm_per_unit=0"], 2, &["\"mm_per_unit\" is 0", "must be positive"]),
    (&["lens", "dgauss.50mm", "--mm-per-unit", "0"], 2, &["\"mm_per_unit\" is 0"]),
    (&["render", "--film-diagonal", "-35"], 2, &["\"film_diagonal\" is -35", "must be positive, in mm"]),
    (&["render", "--film-diagonal", "35mm"], 2, &["\"film_diagonal\"", "a number", "35mm"]),
    (&["render", "--film-diagonal", "nan"], 2, &["\"film_diagonal\"", "must be"]),
    (&["render", "--fnumber", "f/8"], 2, &["\"fnumber\"", "a number", "f/8"]),
    (&["render", "--wavelength", "0.55"], 2, &["\"wavelength\" is 0.55", "nm"]),
    (&["render", "--pupil", "round"], 2, &["\"pupil\" is \"round\"", "warped", "rear"]),
    (&["render", "--model", "pinhole"], 2, &["\"model\" is \"pinhole\"", "perspective"]),
    (&["render", "--crop", "0,0,5"], 2, &["\"crop\"", "four numbers"]),
    (&["render", "--crop", "0,0,9999,5", "--spp", "1"], 2, &["\"crop\"", "480"]),
    (&["render", "--film-diagonal", "35", "--film-diagonal", "36"], 2, &["\"film_diagonal\" is given twice"]),
    (
        &["render", "--fnumber", "4", "--aperture-diameter", "3"],
        2,
        &["\"fnumber\" and \"aperture_diameter\"", "give one of them"],
    ),
    (&["lens", "dgauss.50mm", "--fnumber", "4", "--aperture-diameter", "3"], 2, &["give one of them"]),
    (
        &["render", "--film-distance", "40", "--focus-distance", "900"],
        2,
        &["\"film_distance\" and \"focus_distance\"", "give one of them"],
    ),
    (&["focus", "dgauss.50mm", "--film-distance", "40", "--focus-distance", "900"], 2, &["give one of them"]),
    (
        &["flare", "dgauss.50mm", "--light", "120,0"],
        2,
        &["--light", "beside lens \"dgauss.50mm\" or behind it", "degrees"],
    ),
    (&["flare", "dgauss.50mm", "--light", "0,0,-5"], 2, &["--light", "behind it"]),
    (&["flare", "dgauss.50mm", "--light", "0,0,5"], 2, &["mm from the middle", "put the lamp farther away"]),
    (&["flare", "dgauss.50mm", "--light", "190,0"], 2, &["no direction"]),
    (&["flare", "dgauss.50mm", "--light", "5,0", "--coating", "file"], 2, &["names no coatings"]),
    (&["draw", "dgauss.50mm", "--ghost", "-1,2"], 2, &["the numbers of two surfaces"]),
    (&["focus", "dgauss.50mm", "--focus-distance", "0"], 2, &["\"focus_distance\" is 0", "must be positive"]),
    (&["focus", "dgauss.50mm"], 2, &["--focus-distance MM", "--film-distance MM"]),
    (&["plan", "dgauss.50mm", "--blades", "2"], 2, &["\"blades\"", "3"]),
    // Lenses.
    (&["draw"], 2, &["which lens?", "realistic lens --list"]),
    (&["focus", "--focus-distance", "900"], 2, &["which lens?"]),
    (
        &["lens", "dgauss.50mm", "--lens", "wide.22mm"],
        2,
        &["the lens is given twice", "dgauss.50mm", "wide.22mm"],
    ),
    (&["lens", "nowhere.dat"], 1, &["no lens file \"nowhere.dat\"", "dgauss.50mm"]),
    (&["render", "--lens", "nowhere.dat"], 1, &["no lens file \"nowhere.dat\"", "dgauss.50mm"]),
    (&["lens", "lens.json"], 1, &["lens.json:1:1: JSON", "read are a table"]),
    (&["render", "lens.json"], 1, &["lens.json:1:1: JSON", "read are a table"]),
    (&["lens", "."], 1, &["is a directory; give a file in it"]),
    (
        &["blender", "dgauss.50mm", "--stop-picture", "none.png"],
        1,
        &["\"stop_picture\": no picture \"none.png\""],
    ),
    (
        &["render", "dgauss.50mm", "--stop-picture", "none.png"],
        1,
        &["\"stop_picture\": no picture \"none.png\" in the working directory"],
    ),
    (&["lens", "picture.png"], 1, &["picture.png:1:1: "]),
    (&["draw", "singlet.dat", "--zoom", "35"], 2, &["one focal length"]),
    (&["focus", "dgauss.50mm", "--focus-distance", "60"], 1, &["cannot focus at 60 mm", "197.0"]),
    (
        &["focus", "dgauss.50mm", "--focus-distance", "900", "--focus-by", "group"],
        2,
        &["no positions for near objects"],
    ),
    (&["trace", "-"], 2, &["standard input has the rays", "give the lens as a file"]),
    (&["lens", "--list", "dgauss.50mm"], 2, &["--list shows every lens"]),
    // Files.
    (&["render", "--out", "picture.jpg"], 2, &["must end in .png", ".exr"]),
    (&["render", "--out", "picture"], 2, &["must end in .png"]),
    (&["draw", "dgauss.50mm", "--out", "lens.pdf"], 2, &["must end in .svg or .png"]),
    (&["blender", "dgauss.50mm", "--out", "singlet.dat"], 2, &["must end in .osl"]),
    (&["convert", "singlet.dat"], 2, &["where to?", "realistic convert IN OUT.dat"]),
    (&["convert", "singlet.dat", "singlet.dat"], 2, &["is the lens itself", "another name"]),
    (&["convert", "singlet.dat", "./singlet.dat", "--force"], 2, &["is the lens itself"]),
    (&["convert", "singlet.dat", "lens.pdf"], 2, &["ends in .dat, .zmx, .seq, .json"]),
    (
        &["convert", "singlet.dat", "lens.zmx", "--as", "json"],
        2,
        &["lens.zmx has the ending of another format than --as"],
    ),
    (&["convert", "odd.dat", "lens.seq"], 1, &["surface 2 has a term of r^5", "write .zmx or .json"]),
    (
        &["lens", "unknown.zmx", "--strict"],
        1,
        &["which \"strict\" demands: left out XYZW (line 1): a keyword"],
    ),
    (&["render", "unknown.zmx", "--strict"], 1, &["which \"strict\" demands"]),
    (&["lens", "unknown.zmx", "--report", "--json"], 2, &["--report", "--json"]),
    (&["convert", "dgauss.50mm", "singlet.dat"], 1, &["was not written by `convert`", "--force"]),
    (&["install", "singlet.dat"], 2, &["singlet.dat is a file; give a folder"]),
    (&["install", "plugins", "--plugin", "nothing.so"], 1, &["nothing.so"]),
    (
        &["focus-stack", "--from", "900", "--to", "950", "--out", "singlet.dat"],
        2,
        &["singlet.dat is a file; give a folder"],
    ),
    (&["report", "--out", "singlet.dat"], 2, &["singlet.dat is a file; give a folder"]),
    (&["merge", "nothing.png", "--out", "whole.png"], 1, &["cannot read nothing.png"]),
    (&["merge", "--out", "whole.png"], 2, &["<TILE>"]),
];

/// A lens with a statement that no reader knows.
const UNKNOWN: &str = "XYZW 1\nSURF 0\n  DISZ INFINITY\nSURF 1\n  STOP\n  CURV 0.02\n  DISZ 4\n  GLAS N-BK7 0 0\n  DIAM 5 1\n\
                       SURF 2\n  CURV -0.02\n  DISZ 48\n  DIAM 5 1\nSURF 3\n";

#[test]
fn messages_of_wrong_uses_state_the_error_and_the_correction() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("singlet.dat"), "# my own\n20 5 1.5 10\n-20 0 1 10\n").unwrap();
    fs::write(dir.path().join("odd.dat"), "20 5 1.5 10\n-20 30 1 10\nasphere 2 conic=0 A5=1e-6\n").unwrap();
    fs::write(dir.path().join("unknown.zmx"), UNKNOWN).unwrap();
    fs::write(dir.path().join("lens.json"), "{\"surfaces\": []}\n").unwrap();
    fs::write(dir.path().join("picture.png"), b"\x89PNG\r\n\x1a\n\0\0").unwrap();
    let files = || {
        let mut all: Vec<_> = fs::read_dir(dir.path()).unwrap().map(|entry| entry.unwrap().path()).collect();
        all.retain(|path| path.is_file());
        all.sort();
        all.into_iter().map(|path| (fs::read(&path).unwrap(), path)).collect::<Vec<_>>()
    };
    let before = files();
    let mut table = String::new();
    let mut wrong = Vec::new();
    for (arguments, code, words) in WRONG_USES {
        let output = realistic(dir.path(), arguments);
        let answer = String::from_utf8_lossy(&output.stderr);
        let first = answer.lines().find(|line| !line.contains("warning:")).unwrap_or_default();
        table += &format!("| `{}` | {code} | {first} |\n", arguments.join(" "));
        let is_complete = words.iter().all(|word| answer.contains(word)) && answer.starts_with("realistic: ");
        let is_complete = is_complete && !answer.contains("error: error");
        if output.status.code() != Some(*code) || !is_complete || !output.stdout.is_empty() {
            wrong.push(format!("{arguments:?} {:?}: {answer}", output.status.code()));
        }
    }
    println!("{table}");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(WRONG_USES.len() >= 60 && files() == before, "no file is written or changed");
}

#[test]
fn unknown_flags_have_no_tip_and_wrong_values_no_usage() {
    let dir = tempfile::tempdir().unwrap();
    let refusal = |arguments: &[&str]| {
        let output = realistic(dir.path(), arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        String::from_utf8(output.stderr).unwrap()
    };
    for flag in ["--nonsense", "--flatness", "--mode7", "--xyz"] {
        let answer = refusal(&["lens", "dgauss.50mm", flag, "4"]);
        assert!(!answer.contains("tip") && answer.contains("Usage: realistic lens"), "{answer}");
    }
    for command in ["render", "lens", "focus", "plan"] {
        let answer = refusal(&[command, "dgauss.50mm", "--fnumber", "x"]);
        assert!(
            answer.ends_with("not the string \"x\"\n\nFor more information, try '--help'.\n"),
            "{answer}"
        );
    }
}

#[test]
fn values_may_begin_with_a_minus() {
    let dir = tempfile::tempdir().unwrap();
    for values in [
        &["--model", "perspective", "--screen-window", "-1,1,-1,1"][..],
        &["--shutter-open", "-1e-3"],
        &["--compensation", "-.5"],
    ] {
        let arguments =
            [&["render", "--scene", "day", "--spp", "1", "--size", "6x4", "-o", "-"], values].concat();
        let output = realistic(dir.path(), &arguments);
        assert!(output.status.success(), "{values:?}: {}", String::from_utf8_lossy(&output.stderr));
    }
}

/// For the system, file names are bytes.
#[cfg(unix)]
#[test]
fn names_that_are_not_utf_8_are_refused() {
    use std::os::unix::ffi::OsStrExt as _;
    let name = std::ffi::OsStr::from_bytes(b"b\xff.dat");
    for command in ["lens", "render", "convert"] {
        let mut program = std::process::Command::new(env!("CARGO_BIN_EXE_realistic"));
        let output = program.arg(command).arg(name).output().unwrap();
        let answer = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{answer}");
        assert!(
            answer.contains(r#""b\xFF.dat" is not UTF-8"#) && answer.contains("rename the file"),
            "{answer}"
        );
    }
}

#[test]
fn short_help_fits_a_screen_and_long_help_is_complete() {
    let dir = tempfile::tempdir().unwrap();
    let help = |arguments: &[&str]| {
        let output = realistic(dir.path(), arguments);
        assert!(output.status.success() && output.stderr.is_empty(), "{arguments:?}");
        String::from_utf8(output.stdout).unwrap()
    };
    for command in
        ["render", "lens", "convert", "blender", "draw", "trace", "focus", "pupil", "plan", "focus-stack"]
    {
        let short = help(&[command, "-h"]);
        assert!(
            (10..=40).contains(&short.lines().count()),
            "{command}: {} lines\n{short}",
            short.lines().count()
        );
        let long = help(&[command, "--help"]);
        let words: Vec<&str> = long.split_whitespace().collect();
        assert!(
            long.contains("--focus-distance") && words.join(" ").contains("in units of camera space"),
            "{long}"
        );
        assert_eq!(long, help(&["help", command]));
    }
    assert!((24..=40).contains(&help(&["render", "-h"]).lines().count()));
    assert!(help(&["-h"]).lines().count() <= 40);
    let long = help(&["render", "--help"]);
    for row in realistic_camera::PARAMETERS {
        let flag = format!("--{}", row.name.replace('_', "-"));
        let has_value = |sign: &str| long.contains(&format!("{flag}{sign}<"));
        assert!(has_value(" ") || has_value("[="), "{}", row.name);
    }
    // The defaults are those that the command uses, as `pictures` and `spellings` test.
    let joined = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let long = joined(&long);
    for words in [
        "units of camera space; default focused on the scene's subject",
        "in mm; default focused on the scene's subject",
        "Diagonal of the film: positive, in mm; default that of the lens's own image",
    ] {
        assert!(long.contains(words) && joined(&help(&["--help"])).contains(words), "{words}");
    }
    assert!(joined(&help(&["lens", "--help"])).contains("default that of the lens's own image"));
    // Parameters that need a camera are not listed for a lens.
    assert!(!help(&["lens", "--help"]).contains("--shutter-open"));
    // Each command lists what it uses beyond the parameters of every lens.
    for (command, used, unused) in [
        ("psf", "--film-tilt-x", "--iso"),
        ("mtf", "--transmission", "--iso"),
        ("flare", "--blades", "--film-tilt-x"),
        ("blender", "--stop-picture", "--iso"),
        ("export", "--iso", "--film-tilt-x"),
        ("focus", "--fnumber", "--blades"),
    ] {
        let long = help(&[command, "--help"]);
        assert!(long.contains(used) && !long.contains(unused), "{command}: {long}");
    }
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let completions = help(&["completions", shell]);
        assert!(completions.contains("focus-distance") && completions.contains("focus-stack"), "{shell}");
    }
}
