//! Commands with lenses that are not round: what they report, draw and write, and what they refuse by name.

use super::{export::npy, fails, succeeds};
use realistic_optics::{
    lens::{Lens, Ray},
    prescription::catalogue,
    trace::Path,
};
use serde_json::Value;

const LENSES: [&str; 3] = ["anamorphic.129mm", "anamorphic.42mm", "mirror.500mm"];

fn json(arguments: &[&str]) -> Value {
    serde_json::from_str(&succeeds(arguments, "")).expect("JSON")
}

#[test]
fn focal_lengths_of_both_meridians_are_those_of_the_patents() {
    let lengths = |name: &str| {
        let facts = json(&["lens", name, "--json"]);
        ["focal_length_x_mm", "focal_length_mm", "back_focal_distance_x_mm", "back_focal_distance_mm"]
            .map(|key| facts[key].as_f64().unwrap_or_else(|| panic!("{name}: {key}")))
    };
    for (name, expected) in [
        ("anamorphic.129mm", [65.586, 128.651, 32.886, 32.710]),
        ("anamorphic.42mm", [21.483, 42.479, 36.164, 36.053]),
    ] {
        for (own, expected) in lengths(name).iter().zip(expected) {
            assert!((own - expected).abs() < 6e-4, "{name}: {own} {expected}");
        }
        assert!(succeeds(&["lens", name], "").contains("\n  in x "), "{name}");
        // The cone of light on the film has the f-numbers of both meridians.
        let facts = json(&["lens", name, "--json"]);
        let [x, y] = ["fnumber_x", "fnumber"].map(|key| facts[key].as_f64().expect("a number"));
        let cone =
            json(&["psf", name, "--json", "--rays", "64", "--pixels", "8", "--object-distance", "inf"]);
        let widest = cone["fnumber_of_cone"].as_f64().expect("a number");
        assert!((widest / x.min(y) - 1.0).abs() < 0.02, "{name}: {x} {y} {widest}");
    }
    // RayOptics has 999.639 and 75.381 for the lens of twice the size; its index of one glass differs.
    let mirror = json(&["lens", "mirror.500mm", "--json"]);
    assert!((mirror["focal_length_mm"].as_f64().expect("a length") - 999.639 / 2.0).abs() < 2e-3);
    assert!((mirror["back_focal_distance_mm"].as_f64().expect("a length") - 75.381 / 2.0).abs() < 1e-3);
    assert!(mirror.get("focal_length_x_mm").is_none(), "a lens of revolution");
    assert_eq!((&mirror["is_round"], &mirror["mirrors"]), (&Value::from(false), &Value::from(2)));
    assert!(succeeds(&["lens", "mirror.500mm"], "").contains("not round         2 mirrors\n"));
    let round = json(&["lens", "dgauss.50mm", "--json"]);
    assert_eq!((&round["is_round"], &round["mirrors"]), (&Value::from(true), &Value::from(0)));
}

#[test]
fn tables_are_written_and_read_back() {
    for name in LENSES {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("again.dat");
        let path = file.to_str().expect("text");
        succeeds(&["convert", name, path], "");
        let [own, again] = [name, path].map(|lens| json(&["lens", lens, "--json"]));
        assert_eq!(own["focal_length_mm"], again["focal_length_mm"], "{name}");
        let ray = "2,3,-400,0.001,0.002,1\n-1,0.5,-400,0.002,0.001,1\n";
        let film = ["--film-distance", "20"];
        let [own, again] = [name, path].map(|lens| succeeds(&[&["trace", lens][..], &film].concat(), ray));
        assert_eq!(own, again, "{name}");
    }
}

#[test]
fn sections_are_drawn_in_both_meridians() {
    for name in LENSES {
        let [up, across] =
            ["y", "x"].map(|section| succeeds(&["draw", name, "--section", section, "-o", "-"], ""));
        assert!(up.starts_with("<svg") && up.contains("on the axis"), "{name}");
        assert_eq!(
            up == across,
            name.starts_with("mirror"),
            "{name}: the sections of an anamorphic lens differ"
        );
    }
}

#[test]
fn maps_hold_the_exact_chief_rays_of_lenses_that_are_not_round() {
    for name in LENSES {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("rays.npy");
        let path = file.to_str().expect("text");
        let words = ["export", name, "--as", "rays", "--size", "96x64", "--json", "-o", path];
        let report = json(&words);
        assert_eq!(report["lit_share_of_film"], 1.0, "{name}");
        let (shape, values) = npy(&file);
        assert_eq!(shape, [64, 96, 6], "{name}");
        // The ray of a pixel, sent back, comes from that pixel's film point: raster x grows against x of the film.
        let prescription = catalogue::find(name).expect("listed");
        let lens = Lens::at_d_line(&prescription);
        let to_film = Path::<f64>::scene_to_film(&lens).without_edges();
        let pixel = report["pixel_mm"].as_f64().expect("a number");
        let film = lens.rear().vertex - report["film_distance"].as_f64().expect("a number");
        for (column, row) in [(20_usize, 10_usize), (75, 12), (47, 31), (60, 55), (28, 40)] {
            let ray: [f64; 6] = std::array::from_fn(|i| f64::from(values[6 * (96 * row + column) + i]));
            let [x, y, z, dx, dy, dz] = ray;
            let origin = [x + 200.0 * dx, y + 200.0 * dy, z + 200.0 * dz];
            let Ray { origin, direction } = to_film
                .trace(Ray { origin, direction: [-dx, -dy, -dz] })
                .unwrap_or_else(|why| panic!("{name} {column} {row} {ray:?}: {why}"));
            let along = (film - origin[2]) / direction[2];
            let landing = [0, 1].map(|i| origin[i] + along * direction[i]);
            let expected = [(47.5 - column as f64) * pixel, (row as f64 - 31.5) * pixel];
            let miss = (landing[0] - expected[0]).hypot(landing[1] - expected[1]);
            assert!(miss < 0.01 * pixel, "{name} {column} {row}: {miss} mm of {pixel}");
        }
    }
}

#[test]
fn st_maps_of_an_anamorphic_lens_lead_there_and_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("st.npy");
    let report = json(&[
        "export",
        "anamorphic.129mm",
        "--as",
        "st-map",
        "--size",
        "96x64",
        "--json",
        "-o",
        path.to_str().expect("text"),
    ]);
    let [x, y] =
        ["pinhole_focal_length_x_px", "pinhole_focal_length_y_px"].map(|key| report[key].as_f64().unwrap());
    // Squeezed to a half along x.
    assert!((y / x - 128.651 / 65.586).abs() < 0.02, "{x} {y}");
    let maps = ["undistort", "distort"].map(|direction| {
        let (shape, values) = npy(&path.with_extension(format!("{direction}.npy")));
        assert_eq!(shape, [64, 96, 3], "{direction}");
        values
    });
    for (column, row) in [(3_usize, 5_usize), (90, 60), (47, 31), (20, 40)] {
        // From the lens's picture to the pinhole's by one map, and back by the other, interpolated.
        let at = |map: &[f32], column: usize, row: usize| -> [f64; 2] {
            let value = &map[3 * (96 * row + column)..][..3];
            assert_eq!(value[2], 1.0, "{column} {row}");
            [96.0 * f64::from(value[0]) - 0.5, 64.0 * (1.0 - f64::from(value[1])) - 0.5]
        };
        let [u, v] = at(&maps[1], column, row);
        let (left, top) = (u.clamp(0.0, 94.0) as usize, v.clamp(0.0, 62.0) as usize);
        let (a, b) = (u - left as f64, v - top as f64);
        let back = [0, 1].map(|i| {
            let corner = |dx: usize, dy: usize| at(&maps[0], left + dx, top + dy)[i];
            (1.0 - b) * ((1.0 - a) * corner(0, 0) + a * corner(1, 0))
                + b * ((1.0 - a) * corner(0, 1) + a * corner(1, 1))
        });
        let miss = (back[0] - column as f64).hypot(back[1] - row as f64);
        assert!(miss < 0.02, "{column} {row}: {back:?}");
    }
}

#[test]
fn what_needs_a_round_lens_is_refused_by_name() {
    for name in LENSES {
        for (arguments, words) in [
            (&["convert", name, "-", "--as", "zmx"][..], "are written as the project's own table"),
            (
                &["draw", name, "--ghost", "1,2", "-o", "-"],
                "--ghost needs a lens whose surfaces are symmetric",
            ),
            (
                &["export", name, "--as", "opencv"],
                "--as opencv, which depends on the distance from the axis alone, needs a lens whose surfaces are symmetric",
            ),
        ] {
            let message = fails(arguments, "", 1);
            assert!(message.contains(words), "{arguments:?}: {message}");
        }
    }
}
