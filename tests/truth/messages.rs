//! Messages offer a solution in few words: the intended name, the unit, or the row.

use super::support;

use ::realistic_camera::{Camera, Host, Level, Parameters, Raster, Value};
use support::{build, host, host_with};

#[test]
fn a_metre_taken_for_a_millimetre_names_the_unit() {
    let message = |given: &[(&str, &str)]| build(&host(), given).expect_err("too near");
    let text = message(&[("focus_distance", "1")]);
    let hint = "\"focus_distance\" 1 is in units of camera space, each of 1 mm here: if the scene's are others, give \
                \"mm_per_unit\", 1000 for metres";
    assert!(
        text.starts_with("lens \"dgauss.50mm\" cannot focus at 1 mm from the film;") && text.ends_with(hint),
        "{text}"
    );
    let text = message(&[("focus_distance", "1"), ("mm_per_unit", "1")]);
    assert!(!text.contains("mm_per_unit"), "{text}");
    build(&host(), &[("focus_distance", "1"), ("mm_per_unit", "1000")]).expect("a metre");
}

#[test]
fn a_file_that_states_a_wrong_focal_length_warns() {
    let warnings = |text: &str| build(&host_with(text), &[]).expect("a camera").1;
    // 1/f = (n - 1) (1/R1 - 1/R2 + (n - 1) d/(n R1 R2)): 20.87 mm.
    let rows = "20 5 1.5 10\n-20 18 1 10\n";
    assert_eq!(
        warnings(&format!("50\n{rows}")),
        ["lens \"own.dat\": the file states a focal length of 50 mm, and its surfaces have one of 20.870 mm"]
    );
    for near in ["20.67\n", "focal 21.07\n", ""] {
        assert_eq!(warnings(&format!("{near}{rows}")), [""; 0]);
    }
    assert!(warnings(&format!("21.1\n{rows}"))[0].contains("21.1 mm"));
    // The first misstated position is reported. The lens is two thin lenses of 50 mm, for which 1/f = 2/50 - gap/50².
    let zoom = "positions a b c\ngap 2 10 20 30\nfocal 27.8 31.3 31.3\n50 0 1.5 9\n-50 10 1 9\n50 0 1.5 9\n-50 9 1 9\n";
    let messages = warnings(zoom);
    assert!(
        messages.iter().any(|text| text.contains("at position 3 the file states a focal length of 31.3 mm")),
        "{messages:?}"
    );
    assert!(
        !messages.iter().any(|text| text.contains("position 1") || text.contains("position 2")),
        "{messages:?}"
    );
}

#[test]
fn a_misspelt_parameter_is_reported_with_the_nearest_name() {
    for (given, meant) in
        [("focus_distence", "focus_distance"), ("apperture_diameter", "aperture_diameter"), ("fov2", "fov")]
    {
        let end = format!("no parameter is called \"{given}\"; did you mean \"{meant}\"?");
        let message =
            Parameters::default().set(given, Value::Float(1.0)).expect_err("no such name").to_string();
        assert!(message.starts_with(&end), "{message}");
    }
    let far = Parameters::default().set_from_text("saturation", "1").expect_err("no such name").to_string();
    assert!(far.starts_with("no parameter is called \"saturation\"; the names are "), "{far}");
}

#[test]
fn no_message_repeats_a_long_text_or_number() {
    let long = "x".repeat(900_000);
    let number = format!("1{}", "0".repeat(300));
    for given in [
        [("pupil", long.as_str())],
        [("film_diagonal", &long)],
        [(long.as_str(), "1")],
        [("mm_per_unit", "-1e308")],
        [("film_distance", "1e308")],
        [("focus_distance", "1e-300")],
        [("lens_file", &long)],
        [("glass_catalog", &long)],
        [("glass_catalog", &format!("/{}", "x/".repeat(2000)))],
        [("crop", &long)],
        [("pupil", &number)],
    ] {
        let mut parameters = Parameters::default();
        let message = given
            .iter()
            .try_for_each(|(name, text)| parameters.set_from_text(name, text))
            .map_err(|error| error.to_string())
            .and_then(|()| build(&host(), &given).map(drop).map_err(|error| error.to_string()))
            .expect_err("refused");
        assert!(message.len() < 700, "{} bytes: {message:.300}", message.len());
    }
    let fast = build(&host(), &[("fnumber", "1e-300")]).expect("a camera").1;
    assert!(fast[0].contains("\"fnumber\" 1e-300 is faster"), "{fast:?}");
    let wide = build(&host(), &[("aperture_diameter", "1e308")]).expect("a camera").1;
    assert!(wide[0].contains("\"aperture_diameter\" 1e308 mm is wider"), "{wide:?}");
}

#[test]
fn film_that_only_a_filter_reaches_is_no_warning() {
    // A filter of three pixels reaches 24 % beyond the corner of 30 x 20 pixels.
    let host = Host::new(Raster { xres: 30, yres: 20 }, None);
    for (lens, diagonal) in [("fisheye.6mm", 20.0), ("fisheye.6mm", 22.0), ("fisheye.16mm", 43.3)] {
        let given = Parameters {
            lens_file: Some(lens.into()),
            film_diagonal: Some(diagonal),
            ..Parameters::default()
        };
        let mut warnings = Vec::new();
        let mut log = |level, text: &str| warnings.extend((level != Level::Info).then(|| text.to_owned()));
        Camera::build(&given, &host, &mut log).expect("a camera");
        assert_eq!(warnings, [""; 0], "{lens} {diagonal}");
    }
}

#[test]
fn a_mount_wider_than_its_sphere_is_a_warning() {
    let host = host_with("0.8146 0.5 1.5 1.64\n-20 0 1 1\n");
    let (camera, warnings) = build(&host, &[("film_diagonal", "1")]).expect("a camera");
    assert_eq!(camera.facts().expect("a lens").lens.front().semi_diameter, 0.8146);
    let warning = "own.dat:1:1: clear diameter 1.64 mm on a sphere of radius 0.8146 mm; 1.6292 mm is used, the whole sphere";
    assert_eq!(warnings, [warning]);
}

/// Returns the warnings of a camera of any model.
fn warnings(given: &[(&str, &str)]) -> Vec<String> {
    let mut parameters = Parameters::default();
    for (name, text) in given {
        parameters.set_from_text(name, text).expect("in range");
    }
    let mut messages = Vec::new();
    Camera::build(&parameters, &host(), &mut |_, text: &str| messages.push(text.to_owned()))
        .expect("a camera");
    messages
}

#[test]
fn film_that_is_mostly_dark_is_reported_with_the_film_that_fits() {
    let [dark] = &warnings(&[("lens_file", "phone.4mm")])[..] else { panic!("one warning") };
    assert!(dark.starts_with("most of the film is dark: light reaches it up to 3."), "{dark}");
    // f tan(37 degrees) is 3.09 mm, and the corner of this lens's film is lit.
    let words: Vec<&str> = dark.split(' ').collect();
    let fits = words[words.len() - 4].parse::<f64>().expect("a number");
    assert!((6.1..7.0).contains(&fits), "{dark}");
    for lit in [
        &[("lens_file", "phone.4mm"), ("film_diagonal", &fits.to_string()[..])][..],
        &[("lens_file", "dgauss.50mm")],
        // The film's corners are dark, but little of its area is.
        &[("lens_file", "fisheye.10mm")],
        // Few samples pass, but the film is lit.
        &[("lens_file", "dgauss.50mm"), ("pupil", "rear"), ("fnumber", "16")],
        &[("lens_file", "phone.4mm"), ("model", "thick")],
    ] {
        assert_eq!(warnings(lit), [""; 0], "{lit:?}");
    }
}

#[test]
fn film_without_a_plane_of_focus_warns_with_its_unit() {
    for (film, words) in [
        ("0.03", "even infinity is blurred to 17.89"),
        ("20", "even infinity is blurred"),
        ("5000", "what would be lies in the lens"),
    ] {
        let messages = warnings(&[("film_distance", film)]);
        let [message] = &messages[..] else { panic!("{messages:?}") };
        assert!(
            message
                .starts_with(&format!("with \"film_distance\" {film} mm nothing can be in focus: {words}")),
            "{message}"
        );
        assert!(message.contains("infinity needs 36.1") && message.contains("is in mm"), "{message}");
    }
    for film in ["36", "36.2", "40", "80"] {
        assert_eq!(warnings(&[("film_distance", film)]), [""; 0]);
    }
}

#[test]
fn film_that_the_lens_file_puts_far_from_any_focus_is_reported() {
    // The focal length is 20.87 mm; paraxial rays from infinity meet 19.13 mm behind the last vertex, and the best
    // focus of the whole beam is at 18.94 mm.
    let warnings = |film: &str, given: &[(&str, &str)]| {
        build(&host_with(&format!("20 5 1.5 4\n-20 {film} 1 4\n")), given).expect("a camera").1
    };
    for film in ["5", "16"] {
        let messages = warnings(film, &[]);
        let message = messages
            .iter()
            .find(|text| text.contains("nothing can be in focus"))
            .unwrap_or_else(|| panic!("{messages:?}"));
        assert!(
            message.starts_with(&format!(
                "with the lens file's film distance {film} mm nothing can be in focus: even infinity is blurred"
            )),
            "{message}"
        );
        assert!(
            message.contains("infinity needs 18.9") && message.contains("\"focus_distance\""),
            "{message}"
        );
        // A user who focuses the lens gets no such warning.
        let focused = warnings(film, &[("focus_distance", "1000")]);
        assert!(focused.iter().all(|text| !text.contains("in focus")), "{focused:?}");
    }
    for film in ["19", "19.13", "25"] {
        let messages = warnings(film, &[]);
        assert!(messages.iter().all(|text| !text.contains("in focus")), "{film}: {messages:?}");
    }
}

#[test]
fn a_column_headed_as_radii_is_read_as_radii() {
    let rows = "0.0    2.0   0.0   9.0\n65.0   6.0   1.6   11.0\n-65.0  52.0  1.0   11.0\n";
    let fnumber = |heading: &str| {
        let (camera, warnings) = build(&host_with(&format!("{heading}\n{rows}")), &[]).expect("a camera");
        (camera.facts().expect("a lens").fnumber(), camera.facts().expect("a lens").focal_length(), warnings)
    };
    // 1/f = (n - 1) (2/R - (n - 1) d/(n R²)), and the stop in front, which is the entrance pupil, is 18 mm wide.
    let focal = f64::recip(0.6 * (2.0 / 65.0 - 0.6 * 6.0 / (1.6 * 65.0 * 65.0)));
    assert!((focal - 55.12).abs() < 5e-3);
    for heading in [
        "# radius    thickness   eta/material   aperture_radius",
        "# Radius, thickness, index, semi-diameter (mm)",
        "# r d n semi aperture",
        "# radius | sep | n | half_diameter |",
    ] {
        let (found, length, warnings) = fnumber(heading);
        assert!((found - focal / 18.0).abs() < 1e-9 && (length - focal).abs() < 1e-9, "{heading}: {found}");
        let about_radii: Vec<_> = warnings.iter().filter(|text| text.contains("taken for radii")).collect();
        assert!(
            about_radii.len() == 1 && about_radii[0].starts_with("own.dat:1:1: the last column is headed"),
            "{warnings:?}"
        );
    }
    for heading in [
        "# radius thickness n aperture",
        "# radius thickness index clear diameter",
        "# Radius 65, semi aperture",
    ] {
        let (found, _, warnings) = fnumber(heading);
        assert!((found - focal / 9.0).abs() < 1e-9, "{heading}: {found}");
        assert!(!warnings.iter().any(|text| text.contains("radii")), "{warnings:?}");
    }
    let error = build(&host_with(&format!("radius thickness index aperture_radius\n{rows}")), &[])
        .expect_err("no mark");
    assert!(error.to_string().contains("a heading begins with #"), "{error}");
}

#[test]
fn many_equal_warnings_are_shown_once() {
    let rows: String = (0..16).map(|_| "20 5 1.5 41\n-20 5 1 10\n").collect();
    let (_, warnings) = build(&host_with(&rows), &[("film_distance", "10")]).expect("a camera");
    let wide: Vec<_> = warnings.iter().filter(|text| text.contains("the whole sphere")).collect();
    assert!(
        wide.len() == 1
            && wide[0].ends_with(
                "(and 15 more such warnings, on lines 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25 and 3 more)"
            ),
        "{warnings:?}"
    );
}

#[test]
fn json_is_refused_by_its_name() {
    for text in ["{\"radius\": 3}", "\u{feff}\n  {\n}"] {
        let error = build(&host_with(text), &[]).expect_err("no lens").to_string();
        assert!(error.contains("JSON without the keys of a known lens format; read are a table"), "{error}");
    }
}
