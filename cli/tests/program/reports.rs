//! Tests of every command that reports on a lens.

use super::{fails, succeeds};
use serde_json::Value;
use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Stdio};

const LENSES: [&str; 7] =
    ["dgauss.50mm", "wide.22mm", "telephoto.250mm", "fisheye.10mm", "dgauss.100mm", "planar", "crossed"];

fn json(arguments: &[&str]) -> Value {
    serde_json::from_str(&succeeds(arguments, "")).expect("JSON")
}

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("{key} in {value}"))
}

fn golden(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../tests/golden").join(name)
}

/// Returns the command-line argument for a golden lens.
fn lens(name: &str) -> String {
    let file = golden(&format!("{name}.dat"));
    if file.is_file() { file.to_str().expect("text").to_owned() } else { name.to_owned() }
}

fn rows(text: &str) -> Vec<Vec<String>> {
    text.lines().skip(1).map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

fn numbers(fields: &[String]) -> Vec<f64> {
    fields.iter().map(|field| field.parse().expect("a number")).collect()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// Returns a header line and ray lines, from rows that begin with the six numbers of a ray.
fn input(rows: &[Vec<String>]) -> String {
    let lines: Vec<String> = rows.iter().map(|row| row[..6].join(",")).collect();
    format!("x,y,z,dx,dy,dz\n{}\n", lines.join("\n"))
}

#[test]
fn traced_rays_are_the_exact_ones_in_both_directions() {
    for name in LENSES {
        for (prefix, side) in [("truth_", "film"), ("truth_scene_", "scene")] {
            let text = std::fs::read_to_string(golden(&format!("{prefix}{name}.csv"))).expect("a table");
            let expected = rows(&text);
            let output = succeeds(&["trace", &lens(name), "--from", side], &input(&expected));
            assert!(output.starts_with("x,y,z,dx,dy,dz,status\n"));
            let got = rows(&output);
            assert_eq!(got.len(), expected.len());
            for (got, expected) in got.iter().zip(&expected) {
                assert_eq!(got[6], expected[12], "{name} {expected:?}");
                assert!(!got.concat().contains("NaN"));
                if got[6] == "ok" {
                    let (got, expected) = (numbers(&got[..6]), numbers(&expected[6..12]));
                    let (p, d) = (distance(&got[..3], &expected[..3]), distance(&got[3..], &expected[3..]));
                    assert!(p < 1e-12 && d < 1e-14, "{prefix}{name}: {p:e} mm, {d:e} rad");
                }
            }
        }
    }
}

#[test]
fn every_method_agrees_with_the_exact_rays_as_far_as_it_claims() {
    let text = std::fs::read_to_string(golden("truth_dgauss.50mm.csv")).expect("a table");
    let table: Vec<_> = rows(&text).into_iter().filter(|row| row[12] == "ok").collect();
    let worst = |method: &str| {
        let got = rows(&succeeds(&["trace", "dgauss.50mm", "--method", method], &input(&table)));
        got.iter().zip(&table).filter(|(got, _)| got[6] == "ok").fold(0.0_f64, |worst, (got, row)| {
            worst.max(distance(&numbers(&got[3..6]), &numbers(&row[9..12])))
        })
    };
    for (method, least, most) in [
        ("f64", 0.0, 1e-14),
        ("heckbert", 0.0, 1e-14),
        ("whitted", 0.0, 1e-14),
        ("other", 0.0, 1e-14),
        ("f32", 1e-9, 5e-6),
        ("thick", 1e-3, 0.3),
        ("thin", 1e-3, 0.3),
    ] {
        let worst = worst(method);
        assert!((least..most).contains(&worst), "{method}: {worst:e} rad");
    }
}

#[test]
fn a_ray_traced_out_and_back_returns_to_its_film_point() {
    let mut sent = Vec::new();
    for i in 0..400 {
        let (a, b) = (f64::from(i % 20) - 9.5, f64::from(i / 20) - 9.5);
        sent.push([1.2 * a, 0.4 * b, (0.3 * b - 1.1 * a) / 36.0, 0.7 * a / 36.0]);
    }
    let lines: String = sent.iter().map(|[x, y, dx, dy]| format!("{x},{y},,{dx},{dy},1\n")).collect();
    let film = ["--film-distance", "36.25"];
    for method in ["f64", "thick", "thin"] {
        let out = succeeds(&["trace", "dgauss.50mm", "--method", method, film[0], film[1]], &lines);
        let back: String = out
            .lines()
            .map(|line| {
                let fields: Vec<String> = line.split(',').map(str::to_owned).collect();
                let [x, y, z, dx, dy, dz] = numbers(&fields[..6])[..] else { panic!("six numbers") };
                if fields[6] == "ok" {
                    format!("{x},{y},{z},{},{},{}\n", -dx, -dy, -dz)
                } else {
                    "#\n".to_owned()
                }
            })
            .collect();
        let returned = succeeds(&["trace", "dgauss.50mm", "--method", method, "--from", "scene"], &back);
        let passed: Vec<_> = out.lines().zip(&sent).filter(|(line, _)| line.ends_with("ok")).collect();
        assert!(passed.len() > 150, "{method}: {}", passed.len());
        assert_eq!(passed.len(), returned.lines().count());
        for ((_, [x, y, ..]), line) in passed.iter().zip(returned.lines()) {
            let fields: Vec<String> = line.split(',').map(str::to_owned).collect();
            assert_eq!(fields[6], "ok", "{method}: {line}");
            let got = numbers(&fields[..6]);
            let t = (-32.04 - 36.25 - got[2]) / got[5];
            let error = distance(&[got[0] + t * got[3], got[1] + t * got[4]], &[*x, *y]);
            assert!(error < 1e-11, "{method}: {error:e} mm");
        }
    }
}

#[test]
fn lines_that_are_no_rays_are_named_with_what_was_expected() {
    let trace = ["trace", "dgauss.50mm"];
    let message = fails(&trace, "0,0,-70,0,0,1\n0,0,-70,0,0\n", 1);
    assert!(message.contains("standard input:2:12: ") && message.contains("dz"), "{message}");
    let message = fails(&trace, "0,0,,0,0,1\n", 1);
    assert!(message.contains(":1:5: ") && message.contains("--film-distance"), "{message}");
    let message = fails(&["trace", "dgauss.50mm", "--method", "f16"], "", 2);
    assert!(message.contains("heckbert"), "{message}");
    let message = fails(&["trace", "dgauss.50mm", "--from", "scene", "--film-distance", "3"], "", 2);
    assert!(message.contains("--from scene"), "{message}");
    let message = fails(&["trace", "dgaus.50mm"], "", 1);
    assert!(message.contains("dgauss.50mm"), "{message}");
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_realistic"))
        .args(["trace", "dgauss.50mm"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    drop(child.stdout.take());
    let mut pipe = child.stdin.take().expect("a pipe");
    let lines = "0,0,-68,0,0,1\n".repeat(20_000);
    let _ = pipe.write_all(lines.as_bytes());
    drop(pipe);
    let output = child.wait_with_output().expect("the program ends");
    assert!(output.status.success() && output.stderr.is_empty(), "{output:?}");
}

#[test]
fn the_report_agrees_with_other_programs() {
    let text = std::fs::read_to_string(golden("first_order.csv")).expect("a table");
    let mut compared = 0;
    for row in text.lines().filter(|line| !line.starts_with('#')).skip(1) {
        let fields: Vec<&str> = row.split(',').collect();
        let [name, wavelength, "optiland", _, quantity, value] = fields[..] else { continue };
        let key = match quantity {
            "focal_length" => "focal_length_mm",
            "back_focal_distance" => "back_focal_distance_mm",
            _ => continue,
        };
        let mut arguments = vec!["lens", name, "--json"];
        // The other lenses have no V-numbers, and report this if a wavelength is requested.
        if name == "dgauss.100mm" {
            arguments.extend(["--wavelength", wavelength]);
        }
        let expected: f64 = value.parse().expect("a number");
        let error = (number(&json(&arguments), key) - expected).abs() / expected;
        assert!(error < 1e-12, "{row}: {error:e}");
        compared += 1;
    }
    assert!(compared >= 10, "{compared}");
}

#[test]
fn the_report_follows_the_stop_and_the_film() {
    let open = json(&["lens", "dgauss.50mm", "--json"]);
    let stopped = json(&["lens", "dgauss.50mm", "--json", "--fnumber", "8"]);
    assert!((number(&stopped, "fnumber") - 8.0).abs() < 1e-12);
    assert_eq!(number(&stopped, "limiting_row"), 6.0);
    assert_eq!(number(&open, "focal_length_mm"), number(&stopped, "focal_length_mm"));
    let field = |arguments: &[&str]| number(&json(arguments), "field_of_view_deg");
    let wide = field(&["lens", "dgauss.50mm", "--json", "--film-diagonal", "40"]);
    assert!(wide > field(&["lens", "dgauss.50mm", "--json"]));
    let fisheye = json(&["lens", "fisheye.10mm", "--film-diagonal", "35", "--json"]);
    assert_eq!(fisheye["field_of_view_deg"], Value::Null);
    assert!(succeeds(&["lens", "fisheye.10mm", "--film-diagonal", "35"], "").contains("the corner is dark"));
    assert_eq!(open["rows"].as_array().map(Vec::len), Some(11));
    let scaled = json(&["lens", "dgauss.50mm@35mm", "--json"]);
    assert!((number(&scaled, "focal_length_mm") - 35.0).abs() < 1e-12);
    let message = fails(&["lens", "dgauss.50mm", "--fnumber", "4", "--aperture-diameter", "3"], "", 2);
    assert!(message.contains("\"aperture_diameter\""), "{message}");
}

#[test]
fn focusing_there_and_back_gives_the_same_distance() {
    for object in ["300", "1000", "100000"] {
        let there = json(&["focus", "dgauss.50mm", "--distance", object, "--json"]);
        let film = number(&there, "film_distance").to_string();
        let back = json(&["focus", "dgauss.50mm", "--film-distance", &film, "--json"]);
        let distance: f64 = object.parse().expect("a number");
        assert!((number(&back, "focus_distance_mm") / distance - 1.0).abs() < 1e-8, "{back}");
        let near = number(&there, "near_limit_mm");
        assert!(near < distance && there["far_limit_mm"].as_f64().is_none_or(|far| far > distance));
    }
    let hyperfocal = json(&["focus", "dgauss.50mm", "--distance", "inf", "--coc", "0.03", "--json"]);
    let at = number(&hyperfocal, "hyperfocal_distance_mm").to_string();
    let deep = json(&["focus", "dgauss.50mm", "--distance", &at, "--coc", "0.0301", "--json"]);
    assert_eq!(deep["far_limit_mm"], Value::Null);
    // The default is 0.03 mm on 24 x 36 mm, by the photographers' convention, and is proportional to the diagonal of
    // other films.
    for (film, confusion) in [("43.27", 0.03), ("35", 0.024_27)] {
        let report =
            json(&["focus", "dgauss.50mm", "--focus-distance", "inf", "--film-diagonal", film, "--json"]);
        assert!((number(&report, "circle_of_confusion_mm") / confusion - 1.0).abs() < 1e-3, "{report}");
    }
}

#[test]
fn a_distance_out_of_reach_names_the_nearest() {
    let message = fails(&["focus", "dgauss.50mm", "--distance", "60"], "", 1);
    assert!(message.contains("nearest it reaches is 197.0"), "{message}");
    assert!(fails(&["focus", "dgauss.50mm"], "", 2).contains("--focus-distance"));
    assert!(fails(&["focus", "dgauss.50mm", "--distance", "-3"], "", 2).contains("positive"));
    let message = fails(&["focus", "dgauss.50mm", "--film-distance", "5000"], "", 1);
    assert!(message.contains("nothing in front of the lens is in focus"), "{message}");
}

#[test]
fn a_pupil_is_measured_and_drawn() {
    let axis = json(&["pupil", "dgauss.50mm", "--film-radius", "0", "--json"]);
    // The pupil of an axial point is a circle, so area and outline agree.
    let points = axis["outline_mm"].as_array().expect("points");
    let radius = |point: &Value| point[0].as_f64().expect("x").hypot(point[1].as_f64().expect("y"));
    for point in points {
        let area = std::f64::consts::PI * radius(point).powi(2);
        assert!((area / number(&axis, "area_mm2") - 1.0).abs() < 1e-6);
    }
    // The disk is as wide as the beam of exact rays.
    assert!((0.0..1e-4).contains(&number(&axis, "missed_by_disk")), "{axis:#}");
    let corner = json(&["pupil", "dgauss.50mm", "--film-radius", "17.5", "--json"]);
    assert!(number(&corner, "area_mm2") < 0.6 * number(&axis, "area_mm2"));
    let irradiance = |value: &Value| number(value, "irradiance_for_unit_radiance");
    assert!(irradiance(&corner) < 0.6 * irradiance(&axis));
    for point in [&axis, &corner] {
        assert!(number(&point["acceptance"], "warped") > 0.99, "{point:#}");
    }
    let rear = number(&corner["acceptance"], "rear");
    assert!(rear > 0.1 && rear < number(&axis["acceptance"], "rear"));

    let directory = tempfile::tempdir().expect("a directory");
    let file = directory.path().join("pupil.svg");
    let path = file.to_str().expect("text");
    let words = succeeds(&["pupil", "fisheye.10mm", "--film-radius", "40", "--out", path], "");
    assert!(words.contains("empty: no light reaches"), "{words}");
    assert!(std::fs::read_to_string(&file).expect("drawn").contains("no light gets through"));
    // The rear surface is concave toward the film: its edge reaches 0.64 mm behind its vertex.
    let hollow = directory.path().join("hollow.dat");
    std::fs::write(&hollow, "15 3 1.5 10\n20 0 1 10\n").expect("written");
    let hollow = hollow.to_str().expect("text");
    for command in [&["pupil", hollow, "--film-radius", "3"][..], &["draw", hollow, "--out", path]] {
        let message = fails(&[command, &["--film-distance", "0.1"]].concat(), "", 2);
        assert!(message.contains("0.63") && message.contains("\"film_distance\""), "{message}");
    }
}

#[test]
fn drawings_are_written_in_the_format_of_their_extension() {
    let directory = tempfile::tempdir().expect("a directory");
    let at = |name: &str| directory.path().join(name).to_str().expect("text").to_owned();
    succeeds(&["draw", "wide.22mm", "--out", &at("a.svg")], "");
    let svg = std::fs::read_to_string(at("a.svg")).expect("drawn");
    assert!(svg.starts_with("<svg") && svg.contains("entrance pupil") && svg.contains("wide.22mm"));
    succeeds(&["draw", "wide.22mm", "--rays", "3", "--out", &at("a.png")], "");
    let png = std::fs::read(at("a.png")).expect("drawn");
    assert!(png.starts_with(b"\x89PNG"));
    assert!(fails(&["draw", "wide.22mm", "--out", &at("a.jpg")], "", 2).contains(".png"));
    // A missing folder is made, but a file is not a folder.
    succeeds(&["draw", "wide.22mm", "-o", &at("made/too/a.svg")], "");
    assert_eq!(std::fs::read_to_string(at("made/too/a.svg")).expect("drawn"), svg);
    let message = fails(&["draw", "wide.22mm", "--out", &at("a.svg/b.svg")], "", 1);
    assert!(message.contains("a.svg/b.svg") && message.contains("give another path"), "{message}");
    assert_eq!(succeeds(&["draw", "wide.22mm", "-o", "-"], ""), svg);
}

#[test]
fn the_plan_names_what_was_chosen_and_measures_what_it_saves() {
    let plan = json(&["plan", "dgauss.100mm", "--fnumber", "8", "--tolerance", "0.5", "--json"]);
    let items = plan["items"].as_array().expect("items");
    assert!(items.iter().any(|item| item["kept"] == true) && items.iter().any(|item| item["kept"] == false));
    let candidates = plan["choice"]["candidates"].as_array().expect("candidates");
    for entry in ["one_by_one", "in_batches"] {
        let chosen: Vec<_> =
            candidates.iter().filter(|candidate| candidate["chosen"][entry] == true).collect();
        assert_eq!(chosen.len(), 1);
        assert!(number(chosen[0], "error_999_pixels") <= 0.5);
        let cost = |candidate: &Value| number(&candidate["ordered_by_ns_per_ray"], entry);
        let exact = candidates.iter().find(|candidate| candidate["model"] == "exact, f64");
        assert!(cost(chosen[0]) <= cost(exact.expect("always one")), "{candidates:?}");
    }
    let measured = plan["measured"].as_array().expect("cameras");
    let names: Vec<&str> = measured.iter().filter_map(|camera| camera["camera"].as_str()).collect();
    assert_eq!(names[..3], ["this camera", "without the tolerance", "with a wavelength each"]);
    for left_out in items.iter().filter(|item| item["kept"] == false).filter_map(|item| item["what"].as_str())
    {
        let what = if left_out == "dispersion" { "wavelength" } else { left_out };
        let is_made_on_request =
            ["dispersion", "differentials", "importance", "transmission", "ghosts"].contains(&left_out);
        assert!(!is_made_on_request || names.iter().any(|name| name.contains(what)), "{left_out}: {names:?}");
    }
    for camera in measured {
        for key in ["in_batches_ns_per_ray", "one_by_one_ns_per_ray", "build_ms"] {
            assert!(number(camera, key) > 0.0, "{camera}");
        }
    }
    // Each glass has one index, so wavelengths change nothing. With "none", the camera leaves out transmission and
    // ghosts; with a transmission, it leaves out only ghosts.
    for (transmission, expected) in
        [("none", &["with transmission", "with transmission, ghosts"] as &[&str]), ("bare", &["with ghosts"])]
    {
        let coated = format!("transmission={transmission}");
        let plan = json(&["plan", "dgauss.50mm", "--param", &coated, "--json"]);
        let measured = plan["measured"].as_array().expect("cameras");
        let names: Vec<&str> = measured.iter().filter_map(|camera| camera["camera"].as_str()).collect();
        let (before, rest) = names.split_at(3);
        assert_eq!(before, ["this camera", "with differentials", "with importance"]);
        assert_eq!(&rest[..expected.len()], expected);
        assert_eq!(rest[expected.len()..], ["turned and moved", "moving"]);
    }
    let text = succeeds(&["plan", "telephoto.250mm", "--param", "pupil=rear"], "");
    assert!(text.contains("left out  pupil table") && !text.contains("tolerance 0"), "{text}");
    assert!(fails(&["plan", "dgauss.50mm", "--tolerance", "-1"], "", 2).contains("\"tolerance\" is -1"));
    assert!(fails(&["plan", "dgauss.50mm", "--param", "pupil"], "", 2).contains("NAME=VALUE"));
}

#[test]
fn install_always_leaves_the_plugin_under_its_own_name() {
    let directory = tempfile::tempdir().expect("a directory");
    let plugin = super::plugin::built();
    let plugin = plugin.to_str().expect("a plain name");
    for (more, expected) in [
        (&[] as &[&str], &["realistic"] as &[&str]),
        (&["--as", "orthographic"], &["orthographic", "realistic"]),
        (&["--all"], &["environment", "lens", "orthographic", "perspective", "realistic", "thick", "thin"]),
    ] {
        let into = directory.path().join(format!("plugins{}", more.len() + expected.len()));
        std::fs::create_dir(&into).expect("a directory");
        let arguments =
            [&["install", into.to_str().expect("a plain name"), "--plugin", plugin], more].concat();
        let stdout = succeeds(&arguments, "");
        let entries = into.read_dir().expect("a directory").map(|entry| entry.expect("an entry").path());
        let mut names: Vec<_> =
            entries.map(|path| path.file_stem().expect("a name").to_string_lossy().into_owned()).collect();
        names.sort();
        assert_eq!(names, expected, "{more:?}");
        assert_eq!(stdout.contains("Replaces pbrt's own"), !more.is_empty(), "{stdout}");
        let export = stdout.lines().last().expect("text").to_owned();
        assert!(
            export.ends_with(&format!("{}\"", into.canonicalize().expect("there").display())),
            "{export}"
        );
        assert!(
            export.contains("export PBRT_SEARCHPATH=\"${PBRT_SEARCHPATH:+$PBRT_SEARCHPATH:}"),
            "{export}"
        );
    }
}
