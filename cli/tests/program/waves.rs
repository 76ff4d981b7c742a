//! `realistic psf` and `realistic mtf`: against the closed form of a perfect lens, their files against their reports, and
//! what they refuse.

use super::{fails, run, succeeds};
use realistic_waves::airy_mtf;
use serde_json::Value;
use std::fs;

fn report(words: &[&str]) -> Value {
    serde_json::from_str(&succeeds(&[words, &["--json", "--quiet"]].concat(), "")).expect("JSON")
}

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("{key} in {value}"))
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("an array").iter().map(|number| number.as_f64().expect("a number")).collect()
}

#[test]
fn a_stopped_down_lens_is_limited_by_diffraction() {
    let frequencies = "10,20,40,60,80,100";
    let found = report(&["mtf", "dgauss.50mm", "--fnumber", "16", "--frequencies", frequencies]);
    let fnumber = number(&found, "fnumber_of_cone");
    assert!((fnumber - 16.0).abs() < 0.1, "{fnumber}");
    let table = &found["tables"][0];
    let parts = ["mtf", "geometric", "perfect_lens"].map(|part| numbers(&table["tangential"][part]));
    for (i, frequency) in numbers(&found["frequencies_per_mm"]).into_iter().enumerate() {
        let limit = airy_mtf(frequency * 587.56e-6 * fnumber);
        let [own, rays, perfect] = [&parts[0], &parts[1], &parts[2]].map(|part| part[i]);
        assert!((perfect - limit).abs() < 2e-3, "{frequency}: {perfect} {limit}");
        assert!(own <= perfect + 2e-3 && rays > 0.9, "{frequency}: {own} {perfect} {rays}");
    }
    // Rays alone promise contrast where there is none: 1 for 0.0174 at f/16 and 100 cycles per mm.
    assert!(parts[1][5] > 50.0 * parts[0][5]);
    assert!(number(table, "error") < 0.01);
}

#[test]
fn files_hold_the_energy_that_the_report_states() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name).to_str().expect("text").to_owned();
    let words = ["psf", "telephoto.300mm", "--rays", "64", "--pixels", "32", "--at", "0,5"];
    let with = |name: &str| report(&[&words[..], &["--out", &path(name)]].concat());
    let energy = number(&with("psf.csv"), "energy_on_pixels");
    let text = fs::read_to_string(path("psf.csv")).expect("written");
    let sum: f64 = text
        .lines()
        .skip(1)
        .map(|line| line.rsplit_once(',').expect("columns").1.parse::<f64>().expect("a number"))
        .sum();
    assert!((sum - energy).abs() < 1e-6 && energy > 0.5 && energy < 1.0, "{sum} {energy}");
    with("psf.exr");
    let image = exr::prelude::read_first_flat_layer_from_file(path("psf.exr")).expect("an EXR file");
    let exr::prelude::FlatSamples::F32(values) = &image.layer_data.channel_data.list[0].sample_data else {
        panic!("32-bit floats")
    };
    assert!((values.iter().map(|value| f64::from(*value)).sum::<f64>() - energy).abs() < 1e-5);
    with("psf.npy");
    assert!(fs::metadata(path("psf.npy")).expect("written").len() > 4 * 32 * 32);
    with("psf.png");
    assert!(fs::read(path("psf.png")).expect("written").starts_with(b"\x89PNG"));
}

#[test]
fn wavelengths_are_added_and_lenses_that_are_not_round_have_wavefronts() {
    let one = report(&["psf", "dgauss.100mm", "--fnumber", "8", "--rays", "64", "--pixels", "16"]);
    let three = report(&[
        "psf",
        "dgauss.100mm",
        "--fnumber",
        "8",
        "--rays",
        "64",
        "--pixels",
        "16",
        "--spectrum",
        "486:1,588:2,656:1",
    ]);
    let peak = |found: &Value| number(found, "peak_per_mm2") / number(found, "peak_of_perfect_lens_per_mm2");
    assert!(peak(&three) < peak(&one), "colours do not meet: {} {}", peak(&three), peak(&one));
    for name in ["anamorphic.129mm", "mirror.500mm"] {
        let found = report(&["psf", name, "--rays", "48", "--pixels", "16", "--at", "1,0.5"]);
        let image = numbers(&found["image_point_mm"]);
        assert!((image[0] - 1.0).abs() < 1e-6 && (image[1] - 0.5).abs() < 1e-6, "{name}: {image:?}");
        assert!(number(&found, "rms_waves") > 0.0 && number(&found, "strehl") <= 1.0, "{name}");
    }
}

#[test]
fn film_that_is_not_flat_is_the_plane_that_touches_it_at_the_point() {
    let words = ["mtf", "planar.50mm", "--fnumber", "8", "--rays", "128", "--frequencies", "40"];
    let of = |more: &[&str]| report(&[&words[..], more].concat());
    let contrast = |found: &Value, part: &str| numbers(&found["tables"][0][part]["mtf"])[0];
    let focused = number(&of(&["--object-distance", "inf"]), "film_distance");
    let at = |film_distance: f64, more: &[&str]| {
        let film = format!("--film-distance={film_distance}");
        of(&[&["--object-distance", "inf", &film], more].concat())
    };
    // The point 8 mm up on film that is tilted by 2 degrees about x lies nearer the lens by 8 sin 2°. Its distance from the
    // axis is 8 cos 2°.
    let (sin, cos) = 2.0_f64.to_radians().sin_cos();
    let tilted = at(focused, &["--film-tilt-x", "2", "--at", "0,8"]);
    let flat = at(focused - 8.0 * sin, &["--at", &format!("0,{}", 8.0 * cos)]);
    let image = numbers(&tilted["image_point_mm"]);
    assert!(image[0].abs() < 1e-6 && (image[1] - 8.0).abs() < 1e-6, "{image:?}");
    let rms = |found: &Value| number(found, "rms_waves");
    assert!((rms(&tilted) / rms(&flat) - 1.0).abs() < 0.02, "{} {}", rms(&tilted), rms(&flat));
    let away = (contrast(&tilted, "sagittal") - contrast(&flat, "sagittal")).abs();
    assert!(away < 1e-3 && rms(&flat) > 0.15, "{away} {}", rms(&flat));
    // A curved film lies behind its middle by R (1 - √(1 - r²/R²)), and shifted film has the image of another point.
    let (radius, height) = (400.0_f64, 10.0);
    let behind = radius - (radius * radius - height * height).sqrt();
    let curved = at(focused, &["--film-curvature-radius", "400", "--at", "10,0"]);
    let flat = at(focused + behind, &["--at", "10,0"]);
    assert!((rms(&curved) / rms(&flat) - 1.0).abs() < 0.03, "{} {}", rms(&curved), rms(&flat));
    let shifted = at(focused, &["--film-shift-y", "6", "--at", "0,4"]);
    let centred = at(focused, &["--at", "0,10"]);
    assert!((rms(&shifted) / rms(&centred) - 1.0).abs() < 1e-9);
    assert!((numbers(&shifted["image_point_mm"])[1] - 4.0).abs() < 1e-6);
    let message = fails(&["psf", "planar.50mm", "--film-curvature-radius", "9", "--at", "0,10"], "", 1);
    assert!(message.contains("beyond the sphere"), "{message}");
    let message = fails(&["psf", "planar.50mm", "--film-tilt-x", "60", "--at", "0,60"], "", 1);
    assert!(message.contains("lies in the lens"), "{message}");
}

#[test]
fn tilted_film_is_in_focus_at_another_distance_at_each_point() {
    let distance = |at: &str| {
        let words = ["psf", "planar.50mm", "--focus-distance", "3000", "--film-tilt-x", "1", "--rays", "64"];
        let found = report(&[&words[..], &["--pixels", "16", "--at", at]].concat());
        (number(&found, "object_distance_mm"), number(&found, "strehl"))
    };
    // On the axis the film is focused as requested; where it lies nearer the lens, on what is farther away.
    let [(below, _), (middle, _), (above, _)] = ["0,-8", "0,0", "0,8"].map(distance);
    assert!(
        (middle - 3000.0).abs() < 1e-6 * 3000.0 && below < 2950.0 && above > 3050.0,
        "{below} {middle} {above}"
    );
    // Newton's equation, x x' = f². The front focal point is about two focal lengths in front of the film.
    let focal_length = number(&report(&["lens", "planar.50mm"]), "focal_length_mm");
    let image = |object: f64| focal_length.powi(2) / (object - 2.0 * focal_length);
    let moved = image(below) - image(above);
    let expected = 16.0 * 1.0_f64.to_radians().sin();
    assert!((moved / expected - 1.0).abs() < 0.05, "{moved} {expected}");
}

#[test]
fn what_has_no_answer_is_refused_or_called_out() {
    let message = fails(&["psf", "dgauss.50mm", "--at", "400,0"], "", 1);
    assert!(message.contains("nearer the axis"), "{message}");
    let message = fails(&["psf", "dgauss.50mm", "--object-distance", "20"], "", 1);
    assert!(message.contains("is not in front of the lens"), "{message}");
    let message = fails(&["mtf", "dgauss.50mm", "--spectrum", "486:0"], "", 2);
    assert!(message.contains("NM:WEIGHT"), "{message}");
    let message = fails(&["psf", "dgauss.50mm", "--out", "psf.jpg"], "", 2);
    assert!(message.contains(".exr"), "{message}");
    // Far out of focus the path differences change faster than the rays sample them.
    let output = run(&["mtf", "dgauss.50mm", "--defocus", "3", "--rays", "32"], "");
    let warning = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success() && warning.contains("not valid"), "{warning}");
}
