//! Every command spells these in the same way: the lens, the parameters, the keys of JSON, files and standard output.

use super::{fails, realistic, run, succeeds};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;

fn json(arguments: &[&str]) -> Value {
    serde_json::from_str(&succeeds(arguments, "")).expect("JSON")
}

#[test]
fn every_command_takes_the_lens_as_a_word_and_as_a_flag() {
    for (command, more) in [
        ("lens", &[][..]),
        ("draw", &["-o", "-"]),
        ("focus", &["--focus-distance", "900"]),
        ("pupil", &["--film-radius", "3"]),
        ("blender", &["-o", "-"]),
        ("convert", &["-o", "-"]),
        ("render", &["--spp", "1", "--size", "6x4", "-o", "-"]),
    ] {
        let stdout_for = |lens: &[&str]| {
            let output = run(&[&[command], lens, more].concat(), "");
            assert!(output.status.success(), "{command}: {}", String::from_utf8_lossy(&output.stderr));
            assert!(!output.stdout.is_empty(), "{command}");
            output.stdout
        };
        let word = stdout_for(&["wide.22mm"]);
        for flag in
            [&["--lens", "wide.22mm"][..], &["--lens-file", "wide.22mm"], &["--param", "lensfile=wide.22mm"]]
        {
            assert!(stdout_for(flag) == word, "{command} {flag:?}");
        }
    }
    let ray = "0,0,-68,0,0,1\n";
    let word = succeeds(&["trace", "wide.22mm"], ray);
    assert_eq!(succeeds(&["trace", "--lens", "wide.22mm"], ray), word);
    // Beside a flag that gives the lens, the only word is OUT.
    let table = succeeds(&["convert", "wide.22mm", "-"], "");
    assert_eq!(succeeds(&["convert", "--lens", "wide.22mm", "-"], ""), table);
    let plan = succeeds(&["plan", "--lens", "wide.22mm"], "");
    assert_eq!(plan.lines().next(), succeeds(&["plan", "wide.22mm"], "").lines().next());
}

#[test]
fn a_parameter_has_one_name_everywhere() {
    let long =
        succeeds(&["focus", "dgauss.50mm", "--param", "focus_distance=900", "--param", "fnumber=8"], "");
    assert_eq!(succeeds(&["focus", "dgauss.50mm", "--focus-distance", "900", "--fnumber", "8"], ""), long);
    assert_eq!(
        succeeds(
            &["focus", "dgauss.50mm", "--distance", "0.9", "--mm-per-unit", "1000", "--fnumber", "8"],
            ""
        ),
        long
    );
    let picture = |more: &[&str]| {
        run(&[&["render", "--spp", "2", "--size", "24x16", "-o", "-"], more].concat(), "").stdout
    };
    let stopped = picture(&["--fnumber", "8", "--pupil", "rear"]);
    assert!(stopped.starts_with(b"\x89PNG") && stopped != picture(&[]));
    assert!(stopped == picture(&["--param", "fnumber=8", "--param", "pupil=rear"]));
    // For a lens without a camera, parameters that need a camera cause a warning.
    let output = run(&["lens", "dgauss.50mm", "--shutter", "leaf"], "");
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success() && stderr.contains("\"shutter\" changes nothing here"), "{stderr}");
    // Film that these commands would ignore is refused.
    for (command, more) in [
        ("lens", &[][..]),
        ("draw", &[]),
        ("focus", &[]),
        ("pupil", &["--film-radius", "3"]),
        ("export", &["--as", "opencv"]),
        ("blender", &[]),
        ("flare", &["--light", "10,5"]),
    ] {
        let stderr = fails(&[&[command, "dgauss.50mm", "--film-tilt-x", "5"], more].concat(), "", 2);
        assert!(stderr.contains("leave out \"film_tilt_x\""), "{command}: {stderr}");
    }
}

#[test]
fn a_key_has_the_same_value_in_all_reports() {
    let commands: [&[&str]; 4] = [
        &["lens", "planar.50mm", "--focus-distance", "900", "--json"],
        &["focus", "planar.50mm", "--focus-distance", "900", "--json"],
        &["pupil", "planar.50mm", "--film-radius", "3", "--focus-distance", "900", "--json"],
        &["plan", "planar.50mm", "--focus-distance", "900", "--json"],
    ];
    let mut known: BTreeMap<String, Vec<Value>> = BTreeMap::new();
    for arguments in commands {
        let report = json(arguments);
        for key in ["name", "wavelength", "film_distance", "film_diagonal"] {
            assert!(!report[key].is_null(), "{key} of {arguments:?}");
        }
        for (key, value) in report.as_object().unwrap() {
            known.entry(key.clone()).or_default().push(value.clone());
        }
    }
    for (key, values) in &known {
        let close = |value: &Value| match (value.as_f64(), values[0].as_f64()) {
            (Some(a), Some(b)) => (a - b).abs() <= 1e-9 * b.abs(),
            _ => *value == values[0],
        };
        assert!(values.iter().all(close), "{key}: {values:?}");
    }
    assert_eq!((known["fnumber"].len(), known["focus_distance_mm"].len()), (2, 2));
    let list = json(&["lens", "--list", "--json"]);
    let planar = list.as_array().unwrap().iter().find(|lens| lens["name"] == "planar.50mm").unwrap();
    for key in ["name", "title", "focal_length_mm", "fnumber", "stated_focal_length_mm"] {
        assert_eq!(planar[key], known.get(key).map_or(Value::Null, |values| values[0].clone()), "{key}");
    }
}

#[test]
fn traced_rays_are_objects_with_the_values_of_the_columns() {
    let rays = "x,y,z,dx,dy,dz\n1,2,-70,0,0,1\n0,90,-70,0,0,1\n";
    let csv = succeeds(&["trace", "dgauss.50mm"], rays);
    let lines = succeeds(&["trace", "dgauss.50mm", "--json"], rays);
    assert_eq!(lines.lines().count(), 2);
    for (object, line) in lines.lines().zip(csv.lines().skip(1)) {
        let object: Value = serde_json::from_str(object).unwrap();
        let cells: Vec<&str> = line.split(',').collect();
        for (key, cell) in ["x_mm", "y_mm", "z_mm", "dx", "dy", "dz"].iter().zip(&cells) {
            let (own, column): (f64, f64) = (object[key].as_f64().unwrap(), cell.parse().unwrap());
            // serde_json may read the last digit of a number one unit too high or too low.
            assert!((own - column).abs() <= 1e-15 * column.abs(), "{key}: {own} {column}");
        }
        assert_eq!(object["status"], cells[6]);
    }
}

#[test]
fn every_commands_film_fits_the_lens_unless_given() {
    let note = "film diagonal 6.1";
    let small = ["--spp", "1", "--size", "48x32"];
    for arguments in [
        &["lens", "phone.4mm"][..],
        &["draw", "phone.4mm", "-o", "-"],
        &["plan", "phone.4mm", "--pupil", "disk"],
        &["focus", "phone.4mm", "--focus-distance", "900"],
        &["pupil", "phone.4mm", "--film-radius", "1"],
        &[&["render", "phone.4mm", "-o", "-"], &small[..]].concat(),
    ] {
        let output = run(arguments, "");
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success() && stderr.contains(note), "{arguments:?}: {stderr}");
        assert!(
            stderr.contains("the 74 degrees that the lens file states") && stderr.contains("--film-diagonal"),
            "{stderr}"
        );
        let given = run(&[arguments, &["--film-diagonal", "6"]].concat(), "");
        assert!(!String::from_utf8(given.stderr).unwrap().contains(note), "{arguments:?}");
    }
    // The picture has light up to its edges.
    let got = |more: &[&str]| -> f64 {
        let output = run(&[&["render", "phone.4mm", "-o", "-"], &small[..], more].concat(), "");
        let stderr = String::from_utf8(output.stderr).unwrap();
        let share =
            stderr.split("% of the rays got through").next().unwrap().trim_end().rsplit(' ').next().unwrap();
        assert_eq!(stderr.contains("most of the film is dark"), !more.is_empty(), "{stderr}");
        share.parse().unwrap()
    };
    assert!(got(&[]) > 95.0 && got(&["--film-diagonal", "35"]) < 10.0);
}

#[test]
fn wavelengths_of_a_lens_without_dispersion_are_warned_of() {
    let stderr_for = |lens: &str| {
        let words = ["render", lens, "--wavelengths", "3", "--spp", "1", "--size", "6x4", "-o", "-"];
        String::from_utf8(run(&words, "").stderr).unwrap()
    };
    assert!(stderr_for("dgauss.50mm").contains("rays of all 3 wavelengths take the same way"));
    assert!(!stderr_for("dgauss.100mm").contains("warning"));
}

#[test]
fn what_is_worth_knowing_is_no_warning() {
    let faces = "60 5 1.5 30\n-70.25 0 1 30\n-70.15 2 1.6 30\n-300 60 1 30\n";
    let stderr = String::from_utf8(run(&["lens", "-", "--film-diagonal", "5"], faces).stderr).unwrap();
    assert!(
        stderr.contains("rows 2 and 3 touch and overlap by up to 0.0") && !stderr.contains("warning"),
        "{stderr}"
    );
}

#[test]
fn quiet_leaves_errors_and_the_requested_output() {
    let dir = tempfile::tempdir().unwrap();
    for arguments in [
        &["render", "phone.4mm", "--spp", "1", "--size", "6x4", "--wavelengths", "3", "--quiet"][..],
        &["draw", "phone.4mm", "-q"],
        &["blender", "dgauss.50mm", "--quiet"],
        &["convert", "dgauss.50mm", "a.dat", "--quiet"],
        &["install", "plugins", "--quiet"],
        &["disks", "--quiet", "--out", "disks.png"],
    ] {
        let output = realistic(dir.path(), arguments);
        let is_table = arguments[0] == "disks";
        assert!(output.status.success() && output.stderr.is_empty(), "{arguments:?}: {output:?}");
        assert_eq!(output.stdout.is_empty(), !is_table, "{arguments:?}");
    }
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 6);
    assert!(succeeds(&["lens", "dgauss.50mm", "-q"], "").contains("focal length"));
    assert!(fails(&["lens", "nowhere", "-q"], "", 1).contains("no lens file"));
}

#[test]
fn a_table_written_by_hand_is_kept_unless_forced() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("a.dat");
    let hand = "# mine\n20 5   1.5 10\n-20 0 1 10\n";
    fs::write(&file, hand).unwrap();
    let convert = |more: &[&str]| realistic(dir.path(), &[&["convert", "wide.22mm", "a.dat"], more].concat());
    assert_eq!(convert(&[]).status.code(), Some(1));
    assert_eq!(fs::read_to_string(&file).unwrap(), hand);
    assert!(convert(&["--force"]).status.success());
    let table = fs::read(&file).unwrap();
    // A table that `convert` wrote may be overwritten by `convert`.
    assert!(convert(&[]).status.success() && fs::read(&file).unwrap() == table);
}

#[test]
fn a_lens_is_written_in_the_format_of_its_ending() {
    let dir = tempfile::tempdir().unwrap();
    let focal_length = |lens: &str| {
        let output = realistic(dir.path(), &["lens", lens, "--json", "--strict"]);
        let json: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        json["focal_length_mm"].as_f64().expect("a number")
    };
    let own = focal_length("tessar.50mm");
    // Every format that is read, too.
    for format in ["dat", "zmx", "json"] {
        let file = format!("a.{format}");
        let convert = || realistic(dir.path(), &["convert", "tessar.50mm", &file]);
        assert!(convert().status.success(), "{format}");
        assert!((focal_length(&file) - own).abs() < 1e-9 * own, "{format}");
        let written = fs::read(dir.path().join(&file)).unwrap();
        let piped = run(&["convert", "tessar.50mm", "-", "--as", format], "").stdout;
        assert!(piped == written, "{format}");
        // What `convert` wrote may be overwritten by `convert`; with another line in it, it is kept.
        assert!(convert().status.success(), "{format}");
        fs::write(dir.path().join(&file), [&written[..], b"\n"].concat()).unwrap();
        assert_eq!(convert().status.code(), Some(1), "{format}");
    }
    let output = realistic(dir.path(), &["convert", "tessar.50mm", "a.seq"]);
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(stderr.contains("warning: ") && stderr.contains("without effect on rays: the year"), "{stderr}");
    assert!(fs::read_to_string(dir.path().join("a.seq")).unwrap().contains("\nS "));
}

#[test]
fn the_report_lists_every_statement_of_a_file() {
    let text = "# x\n20 5 1.5 10\n-20 0 1 10\n";
    let report = succeeds(&["lens", "-", "--report"], text);
    let rows: Vec<&str> = report.lines().collect();
    assert_eq!(rows.len(), 4, "{report}");
    assert!(
        rows[0].starts_with("place  fate") && rows[1].starts_with("1      informative  comment"),
        "{report}"
    );
    assert!(rows[2].starts_with("2      used") && rows[3].starts_with("3      used"), "{report}");
}
