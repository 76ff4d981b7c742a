//! The plugin in a host that behaves like pbrt 1.05, for both `std::string` ABIs.
//!
//! With `REALISTIC_VALGRIND=1`, the first run of each action, in any host, uses valgrind.

use super::harness;

use std::fs;
use std::path::Path;

use harness::{Abi, Got, Run, installed};

/// A small lens of our own: biconvex, and a stop behind it.
const LENS: &str = "# biconvex\n60 6 1.5 20\n-60 3 1 20\n0 0 0 12\n";

fn run(abi: Abi, action: &str, arguments: &[&str]) -> harness::Report {
    let (_directory, plugin) = installed("realistic.so");
    Run::new(abi, &plugin, action).with_all(arguments).run()
}

/// Returns film points and lens samples all over a 30x20 film, on its edges and beyond them.
fn samples() -> Vec<String> {
    let lens = ["0,0", "1,1", "0,1", "1,0", "0.5,0.5", "0.25,0.75", "0.9,0.1", "0.03,0.4"];
    let film = ["15,10", "0,0", "30,20", "7.5,3.25", "-2,-2", "33,23", "15,0", "29.9,10"];
    let times = ["0", "1", "0.5"];
    let mut samples = Vec::new();
    for (i, point) in film.iter().enumerate() {
        for (j, numbers) in lens.iter().enumerate() {
            samples.push(format!("sample={point},{numbers},{}", times[(i + j) % 3]));
        }
    }
    samples
}

fn near(a: [f64; 3], b: [f64; 3], tolerance: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= tolerance * (1.0 + b.abs()))
}

#[test]
fn a_scene_with_defaults_renders_and_ends_cleanly() {
    for abi in Abi::BOTH {
        let report = run(abi, "render", &[]);
        report.clean();
        assert_eq!(report.number("bad"), 0.0, "a ray without unit direction or clip range");
    }
}

#[test]
fn the_members_a_host_may_read_are_set() {
    for abi in Abi::BOTH {
        let report = run(
            abi,
            "members",
            &[
                "w2c=0,1,0,5, 1,0,0,-6, 0,0,1,7, 0,0,0,1",
                "float:hither=0.5",
                "float:yon=2000",
                "float:shutter_open=0.25",
                "float:shutter_close=0.75",
            ],
        );
        report.clean();
        assert_eq!(report.one("film"), "1");
        let matrix = [0, 1, 0, 5, 1, 0, 0, -6, 0, 0, 1, 7, 0, 0, 0, 1].map(f64::from);
        let inverse = [0, 1, 0, 6, 1, 0, 0, -5, 0, 0, 1, -7, 0, 0, 0, 1].map(f64::from);
        assert_eq!(report.numbers("w2c"), matrix);
        assert_eq!(report.numbers("c2w"), inverse);
        assert_eq!(report.one("crossed"), "1");
        assert_eq!(report.numbers("clip"), [0.5, 2000.0, 0.25, 0.75]);
    }
}

#[test]
fn a_blocked_ray_is_zero_outside_and_tiny_in_the_vtable() {
    for abi in Abi::BOTH {
        let report = run(abi, "rays", &samples().iter().map(String::as_str).collect::<Vec<_>>());
        report.clean();
        let (vtable, exported) = (report.rays("vtable"), report.rays("exported"));
        assert_eq!(vtable.len(), samples().len());
        let mut passed = 0;
        for (inside, outside) in vtable.iter().zip(&exported) {
            if inside.is_blocked() {
                assert_eq!(inside.weight as f32, f32::MIN_POSITIVE);
                assert_eq!(outside.weight, 0.0);
            } else {
                assert_eq!(inside, outside);
                passed += 1;
            }
        }
        assert!(passed > 0);
    }
}

#[test]
fn every_ray_in_the_vtable_is_complete() {
    // Film points beyond the film, lens samples and times exactly 0 and 1.
    for abi in Abi::BOTH {
        let shutter = ["float:shutter_open=2", "float:shutter_close=6", "float:hither=0.125"];
        let samples = samples();
        let arguments: Vec<&str> = samples.iter().map(String::as_str).chain(shutter).collect();
        let report = run(abi, "rays", &arguments);
        report.clean();
        for (sample, ray) in samples.iter().zip(report.rays("vtable")) {
            assert!(ray.weight > 0.0 && ray.weight.is_finite(), "{sample} {ray:?}");
            assert!((ray.length() - 1.0).abs() < 1e-6, "{sample} {ray:?}");
            assert!(ray.o.iter().all(|part| part.is_finite()), "{sample} {ray:?}");
            assert!(ray.d[2] > 0.0, "{sample} {ray:?}");
            let time: f64 = sample.rsplit(',').next().unwrap().parse().unwrap();
            assert_eq!((ray.mint, ray.maxt as f32, ray.time), (0.125, 1e30, 2.0 + 4.0 * time));
        }
    }
}

#[test]
fn vignetting_is_not_applied_twice() {
    // With uniform radiance 1, a pixel is the irradiance. If blocked samples had alpha 0, and the film multiplied by
    // alpha, the pixel would be the irradiance times the share that passes.
    for abi in Abi::BOTH {
        let report = run(abi, "render", &["string:pupil=rear", "spp=64"]);
        report.clean();
        let image = report.numbers("image");
        let irradiance = report.number("irradiance");
        assert!(report.number("blocked") > 0.0, "nothing was vignetted");
        assert_eq!(report.number("zero"), 0.0);
        assert_eq!(report.number("differentials"), report.number("samples"));
        assert_eq!(image[1], 1.0, "alpha is the scene's");
        assert!((image[2] / irradiance - 1.0).abs() < 1e-5, "{image:?} {irradiance}");
    }
}

#[test]
fn exported_generate_ray_refuses_what_is_not_ours() {
    for abi in Abi::BOTH {
        let report = run(abi, "refusals", &[]);
        report.clean();
        let refused = report.rays("refused")[0];
        // The ray is as the host passed it.
        let mint = f64::from(1e-3_f32);
        assert_eq!((refused.weight, refused.time, refused.maxt), (0.0, 0.0, f64::INFINITY));
        assert_eq!((refused.o, refused.d), ([0.0; 3], [0.0; 3]));
        assert!((refused.mint - mint).abs() < 1e-9);
    }
}

#[test]
fn two_cameras_do_not_know_each_other() {
    for abi in Abi::BOTH {
        let samples = samples();
        let arguments: Vec<&str> = samples.iter().map(String::as_str).collect();
        let alone = run(abi, "rays", &arguments).rays("vtable");
        let both = run(abi, "two", &arguments);
        assert_eq!(both.all("films"), ["1", "2"]);
        let rays = both.rays("vtable");
        let (in_turns, after) = rays.split_at(2 * samples.len());
        let first: Vec<Got> = in_turns.iter().copied().step_by(2).collect();
        assert_eq!(first, alone);
        assert_eq!(after, alone);
        let second: Vec<Got> = in_turns.iter().copied().skip(1).step_by(2).collect();
        assert_ne!(second, alone, "its film has another resolution");
    }
}

#[test]
fn a_tolerance_is_a_float_of_the_scene_and_is_met() {
    // Lens samples of 0 and 1 lie on the edge of the map, slightly outside the pupil: there a ray that passes in one
    // model may be blocked in the other. Slightly inside the edge, no ray passes in one model only.
    let inside = |number: &str| match number {
        "0" => "0.005".to_owned(),
        "1" => "0.995".to_owned(),
        other => other.to_owned(),
    };
    let on_edge = samples();
    let inward = on_edge.iter().map(|sample| {
        let parts = sample.split(',').enumerate();
        let moved = parts.map(|(i, part)| if i == 2 || i == 3 { inside(part) } else { part.to_owned() });
        moved.collect::<Vec<String>>().join(",")
    });
    let samples: Vec<String> = inward.chain(on_edge.iter().cloned()).collect();
    let plain: Vec<&str> = samples.iter().map(String::as_str).collect();
    for abi in Abi::BOTH {
        let exact = run(abi, "rays", &plain).rays("vtable");
        let mut arguments = plain.clone();
        arguments.extend(["float:tolerance=0.1", "string:precision=auto"]);
        let report = run(abi, "rays", &arguments);
        report.clean();
        let cheaper = report.rays("vtable");
        assert_ne!(cheaper, exact, "no cheaper model was taken");
        for (i, (cheaper, exact)) in cheaper.iter().zip(&exact).enumerate() {
            let agree = cheaper.is_blocked() == exact.is_blocked();
            assert!(agree || i >= on_edge.len(), "{}: {cheaper:?} {exact:?}", samples[i]);
            // The substitute for a blocked ray has nearly the same direction.
            let off = if agree { 1e-3 } else { 1e-2 };
            assert!(near(cheaper.d, exact.d, off), "{}: {cheaper:?} {exact:?}", samples[i]);
        }
        run(abi, "rays", &["float:tolerance=-1"]).refused(&["tolerance", "pixels"]);
    }
}

#[test]
fn transforms_place_the_rays() {
    let samples = samples();
    let plain: Vec<&str> = samples.iter().map(String::as_str).collect();
    for abi in Abi::BOTH {
        let reference = run(abi, "rays", &plain).rays("vtable");
        // The world-to-camera transform; and the camera-to-world transform as rows of three, and the position.
        type Rows = [[f64; 3]; 3];
        let cases: [(&str, Rows, [f64; 3]); 3] = [
            // A mirrored transform with determinant -1, as the host's LookAt makes it.
            (
                "w2c=-1,0,0,2, 0,1,0,-3, 0,0,1,4, 0,0,0,1",
                [[-1., 0., 0.], [0., 1., 0.], [0., 0., 1.]],
                [2., 3., -4.],
            ),
            // World units are half as long.
            (
                "w2c=0.5,0,0,0, 0,0.5,0,0, 0,0,0.5,0, 0,0,0,1",
                [[2., 0., 0.], [0., 2., 0.], [0., 0., 2.]],
                [0., 0., 0.],
            ),
            // The scale differs on each axis.
            (
                "w2c=1,0,0,0, 0,0.5,0,0, 0,0,4,8, 0,0,0,1",
                [[1., 0., 0.], [0., 2., 0.], [0., 0., 0.25]],
                [0., 0., -2.],
            ),
        ];
        for (argument, rows, at) in cases {
            let mut arguments = plain.clone();
            arguments.push(argument);
            let report = run(abi, "rays", &arguments);
            report.clean();
            for (got, plain) in report.rays("vtable").iter().zip(&reference) {
                let apply = |v: [f64; 3]| rows.map(|row| (0..3).map(|i| row[i] * v[i]).sum::<f64>());
                let (o, d) = (apply(plain.o), apply(plain.d));
                let length = d.iter().map(|part| part * part).sum::<f64>().sqrt();
                let o: [f64; 3] = std::array::from_fn(|i| o[i] + at[i]);
                assert!(near(got.o, o, 2e-6), "{argument}: {got:?} {o:?}");
                assert!(near(got.d, d.map(|part| part / length), 2e-6), "{argument}: {got:?} {d:?}");
                assert!((got.length() - 1.0).abs() < 1e-6, "{argument}: {got:?}");
                assert!((got.weight - plain.weight).abs() <= 1e-6 * plain.weight, "{argument}");
            }
        }
    }
}

#[test]
fn every_matrix_places_a_camera_though_its_inverse_is_rounded() {
    // The models use both transforms to the world: that of stock cameras and that of lenses. A lens takes longer to
    // build.
    for (model, count) in [("environment", 10_000), ("thick", 500), ("lens", 12)] {
        let arguments = [format!("string:model={model}"), format!("placements={count}")];
        let report = run(Abi::New, "placements", &arguments.each_ref().map(String::as_str));
        let [requested, refused, rounded, direction, origin] = report.numbers("placements")[..] else {
            panic!("{}", report.one("placements"))
        };
        assert_eq!(
            (requested, refused),
            (f64::from(count), 0.0),
            "{model}: {:?}",
            report.all("error").first()
        );
        assert!(rounded > 0.2 * requested, "{model}: of {requested} only {rounded} are off an affine matrix");
        println!("{model}: directions within {direction} rad, origins within {origin} of their distance");
        assert!(direction < 1e-6 && origin < 1e-6, "{model}: {direction} {origin}");
    }
}

#[test]
fn a_projective_matrix_places_no_camera() {
    for last_row in ["0,0,1,0", "0,0,0.01,1", "0,1e-4,0,1", "0,0,0,2"] {
        let matrix = format!("w2c=1,0,0,3, 0,1,0,-4, 0,0,1,5, {last_row}");
        run(Abi::New, "rays", &[&matrix]).refused(&["transform is not affine", "last row must be 0 0 0 1"]);
    }
}

#[test]
fn raster_right_and_down_are_right_and_down_in_the_scene() {
    // The lens samples are the same, so that only the film point differs.
    for abi in Abi::BOTH {
        let lens = "0.5,0.5,0";
        let points = ["15,10", "25,10", "15,17"].map(|point| format!("sample={point},{lens}"));
        let report = run(abi, "rays", &points.iter().map(String::as_str).collect::<Vec<_>>());
        let rays = report.rays("vtable");
        let difference = |a: usize, axis: usize| rays[a].d[axis] - rays[0].d[axis];
        assert!(difference(1, 0) > 0.01, "to the right of the image is +x: {rays:?}");
        assert!(difference(2, 1) < -0.01, "towards the image's foot is -y: {rays:?}");
    }
}

#[test]
fn a_parameter_of_a_kind_that_no_camera_has_is_an_error() {
    let cases = [
        ("film_distance", "a number", "float film_distance"),
        ("lens_file", "a string", "string lens_file"),
        ("lensfile", "a string", "string lensfile"),
        ("simple_weighting", "true or false", "bool simple_weighting"),
        ("crop", "four numbers", "float crop"),
    ];
    for abi in Abi::BOTH {
        for kind in ["point", "vector", "normal", "color", "texture"] {
            for (name, takes, write) in cases {
                let message = format!("parameter \"{name}\" takes {takes}, not a {kind}; write \"{write}\"");
                run(abi, "rays", &[&format!("{kind}:{name}=1,2,3")]).refused(&[&message]);
            }
        }
        // The parameter of another camera is not an error.
        assert_eq!(run(abi, "rays", &["texture:bump=1,2,3"]).one("camera"), "made");
    }
}

#[test]
fn a_value_of_another_kind_with_one_meaning_is_taken() {
    let samples = samples();
    let rays = |abi: Abi, given: &str| {
        let arguments: Vec<&str> = samples.iter().map(String::as_str).chain(given.split(' ')).collect();
        let report = run(abi, "rays", &arguments);
        report.clean();
        format!("{:?}", report.rays("vtable"))
    };
    let zoom = "string:lens_file=zoom.24-70mm ";
    for abi in Abi::BOTH {
        for (other, usual) in [
            ("integer:blades=7 integer:fnumber=4", "float:blades=7 float:fnumber=4"),
            (
                "string:film_diagonal=24 string:simple_weighting=true",
                "float:film_diagonal=24 bool:simple_weighting=true",
            ),
            (&format!("{zoom}float:zoom=35"), &format!("{zoom}string:zoom=35")),
            (&format!("{zoom}integer:zoom=35"), &format!("{zoom}string:zoom=35mm")),
            (
                "string:model=perspective integer:screen_window=-3,3,-2,2",
                "string:model=perspective float:screen_window=-3,3,-2,2",
            ),
        ] {
            assert_eq!(rays(abi, other), rays(abi, usual), "{other}");
        }
        let twice = run(abi, "rays", &["float:fnumber=4", "integer:fnumber=4"]);
        twice.refused(&["\"fnumber\" is given as \"float\" and as \"integer\""]);
    }
}

#[test]
fn every_error_about_parameters_is_reported() {
    let given = ["bool:film_distance=true", "float:film_diagonal=1,2", "texture:lens_file=dgauss.50mm"];
    let report = run(Abi::New, "rays", &given);
    assert_eq!(report.one("camera"), "null");
    assert_eq!(report.all("error").len(), 3);
}

/// The world-to-camera transform of the course's scenes, which begin with `Scale 5000 5000 5000`, and then look
/// from (0, 0.03, -0.4) along +z.
const COURSE: &str = "w2c=5000,0,0,0, 0,5000,0,-150, 0,0,5000,2000, 0,0,0,1";
/// The camera of such a scene.
const COURSE_CAMERA: [&str; 4] = [
    "string:lens_file=dgauss.50mm.dat",
    "float:film_distance=36.77",
    "float:aperture_diameter=17.1",
    "float:film_diagonal=35",
];

/// Returns the z at which two rays cross; they lie in one plane x = constant and begin at the same z.
fn crossing(a: &Got, b: &Got) -> f64 {
    a.o[2] + (b.o[1] - a.o[1]) / (a.d[1] / a.d[2] - b.d[1] / b.d[2])
}

#[test]
fn a_scene_that_scales_the_world_has_the_lens_in_millimetres() {
    let samples = samples();
    let plain: Vec<&str> = samples.iter().map(String::as_str).chain(COURSE_CAMERA).collect();
    let with = |abi, more: &[&str]| run(abi, "rays", &[&plain[..], more].concat());
    for abi in Abi::BOTH {
        let (own, scene) = (with(abi, &[]), with(abi, &[COURSE]));
        own.clean();
        scene.clean();
        let notice =
            "the camera transform scales: a world unit is 5000 units of camera space of 1 mm each, 5000 mm";
        assert!(scene.all("notice").iter().any(|text| text.contains(notice)), "{}", scene.out);
        assert!(!own.out.contains("transform scales"), "{}", own.out);
        for (got, own) in scene.rays("vtable").iter().zip(own.rays("vtable")) {
            let [x, y, z] = own.o.map(|part| part / 5000.0);
            assert!(near(got.o, [x, y + 0.03, z - 0.4], 1e-6) && near(got.d, own.d, 1e-6), "{got:?} {own:?}");
            assert!((got.weight - own.weight).abs() <= 1e-6 * own.weight);
            // The ray's range has the units of the lens, too.
            assert!((got.mint * 5000.0 / own.mint - 1.0).abs() < 1e-6, "{got:?}");
        }
    }
}

#[test]
fn lengths_that_do_not_fit_a_scene_that_scales_are_reported() {
    let unscaled = run;
    let run = |given: &[&str]| unscaled(Abi::New, "rays", &[given, &[COURSE]].concat());
    // A fifth of a world unit is a metre: with the value that the message suggests, the camera is in focus at that
    // distance.
    run(&["float:focus_distance=0.2"]).refused(&[
        "cannot focus at 0.2 mm",
        "\"focus_distance\" 0.2 is in units of camera space",
        "a world unit is 5000 units of camera space of 1 mm each, 5000 mm",
        "for 0.2 world units give \"focus_distance\" 1000",
    ]);
    let axis = ["sample=15,10,0.5,0.2,0", "sample=15,10,0.5,0.8,0"];
    let film = ["float:focus_distance=1000", "float:fnumber=16"];
    let report = run(&[&film[..], &axis].concat());
    report.clean();
    assert!(
        report.all("notice").iter().any(|text| text.ends_with("\"focus_distance\" 1000 is 0.2 world units"))
    );
    let rays = report.rays("vtable");
    // The distance is a metre from the film, which is 71 mm behind the front vertex at z = -0.4.
    let z = 5.0 * (crossing(&rays[0], &rays[1]) + 0.4);
    assert!((0.927..0.932).contains(&z), "{z} m");

    // The length of a world unit is given twice.
    let twice = run(&["float:mm_per_unit=5000", "float:focus_distance=0.2"]);
    for words in [
        "a world unit is 5000 units of camera space of 5000 mm each, 2.5e7 mm",
        "leave \"mm_per_unit\" out if a world unit is 5000 mm",
    ] {
        assert!(twice.one("warning").contains(words), "{}", twice.out);
    }
    // This unit changes nothing.
    run(&["integer:mm_per_unit=1", "float:focus_distance=1000"]).clean();

    // Clip distances in world units would hide everything.
    run(&["float:focus_distance=1000", "float:hither=1", "float:yon=100000"]).clean();
    for (given, name) in [("float:yon=20", "yon"), ("float:hither=5000", "hither")] {
        let hidden = run(&["float:focus_distance=1000", given]);
        let message = hidden.one("warning");
        assert!(
            message.contains(&format!("\"{name}\" ")) && message.contains("hides the plane in focus"),
            "{message}"
        );
    }
    // Rotated, moved and mirrored cameras do not scale.
    let turned = "w2c=0,-1,0,5, 1,0,0,6, 0,0,-1,7, 0,0,0,1";
    let report = unscaled(Abi::New, "rays", &["float:mm_per_unit=1000", turned]);
    report.clean();
    assert!(!report.out.contains("transform scales"), "{}", report.out);
}

#[test]
fn a_wrong_parameter_is_refused_with_what_to_do() {
    let cases: [(&[&str], &[&str]); 21] = [
        // Wrong types.
        (
            &["string:film_distance=far"],
            &["parameter \"", "not the string \"far\"", "write \"float film_distance\""],
        ),
        (
            &["bool:film_diagonal=true"],
            &["parameter \"", "not the boolean true", "write \"float film_diagonal\""],
        ),
        (&["float:lens_file=1"], &["parameter \"", "not the number 1", "write \"string lens_file\""]),
        (
            &["integer:simple_weighting=1"],
            &["parameter \"", "not the number 1", "write \"bool simple_weighting\""],
        ),
        (&["string:crop=1,2"], &["parameter \"", "not the string \"1,2\"", "write \"float crop\""]),
        // Wrong numbers of values.
        (&["float:film_distance=50,60"], &["film_distance", "2 values"]),
        (&["string:lens_file=wide.22mm|dgauss.50mm"], &["lens_file", "2 values"]),
        (&["float:film_diagonal="], &["film_diagonal", "0 values"]),
        // Two names of one parameter.
        (&["string:lens_file=dgauss.50mm", "string:lensfile=dgauss.50mm"], &["lens_file", "lensfile"]),
        (
            &["float:aperture_diameter=4", "float:aperturediameter=4"],
            &["aperture_diameter", "aperturediameter"],
        ),
        (&["float:film_distance=40", "float:focus_distance=1000"], &["film_distance", "focus_distance"]),
        (&["float:fnumber=8", "float:aperture_diameter=4"], &["fnumber", "aperture_diameter"]),
        (&["string:weighting=relative", "bool:simple_weighting=true"], &["weighting", "simple_weighting"]),
        // Wrong values; text from a scene is never a format string.
        (&["string:lens_file=nolens.1mm"], &["nolens.1mm", "dgauss.50mm"]),
        (&["string:lens_file=dgaus.50mm.dat"], &["dgaus.50mm.dat", "; did you mean \"dgauss.50mm\"?"]),
        (&["string:lens_file=dgaus.50mm"], &["dgaus.50mm", "; did you mean \"dgauss.50mm\"?"]),
        (
            &["string:lens_file=lenses/dgauss50mm.dat"],
            &["lenses/dgauss50mm.dat", "; did you mean \"dgauss.50mm\"?"],
        ),
        (&["string:lens_file=100%s%n%s.dat"], &["100%s%n%s.dat"]),
        (&["float:film_diagonal=-1"], &["film_diagonal", "-1"]),
        (&["string:weighting=heavy"], &["weighting", "heavy"]),
        (&["res=0x20"], &["0"]),
    ];
    for (number, (arguments, words)) in cases.into_iter().enumerate() {
        run(Abi::BOTH[number % 2], "rays", arguments).refused(words);
    }
}

#[test]
fn a_bad_lens_file_is_reported_with_file_and_line() {
    let (_installed, plugin) = installed("realistic.so");
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("bad.dat"), "# a lens\n60 6 1.5 20\n-60 x 1 20\n").unwrap();
    for abi in Abi::BOTH {
        Run::new(abi, &plugin, "rays")
            .with("string:lens_file=bad.dat")
            .in_directory(directory.path())
            .run()
            .refused(&["bad.dat:3:"]);
    }
}

#[test]
fn a_lens_file_is_found_on_the_path_and_beside_the_plugin() {
    let (plugins, plugin) = installed("realistic.so");
    let (here, there) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    fs::write(here.path().join("here.dat"), LENS).unwrap();
    fs::write(there.path().join("there.dat"), LENS).unwrap();
    fs::write(plugins.path().join("beside.dat"), LENS).unwrap();
    let search = format!("/nonexistent:{}", there.path().display());
    for abi in Abi::BOTH {
        let run_with = |file: &str| {
            Run::new(abi, &plugin, "rays")
                .with(format!("string:lens_file={file}"))
                .with("float:film_distance=58")
                .with("sample=15,10,0.5,0.5,0")
                .in_directory(here.path())
                .env("PBRT_SEARCHPATH", Path::new(&search))
                .run()
        };
        for file in ["here.dat", "there.dat", "beside.dat"] {
            run_with(file).clean();
        }
        run_with("nowhere.dat").refused(&["nowhere.dat"]);
    }
}

#[test]
fn a_lens_file_is_found_beside_the_scene_from_anywhere() {
    let (plugins, plugin) = installed("realistic.so");
    let (here, scenes) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    fs::write(scenes.path().join("scene.dat"), LENS).unwrap();
    let search = format!("/nonexistent:{0}:{0}/", plugins.path().display());
    for abi in Abi::BOTH {
        let run_with = |scene: &Path, file: &str| {
            Run::new(abi, &plugin, "rays")
                .with(format!("file={}", scene.display()))
                .with(format!("string:lens_file={file}"))
                .with("float:film_distance=58")
                .with("sample=15,10,0.5,0.5,0")
                .in_directory(here.path())
                .env("PBRT_SEARCHPATH", Path::new(&search))
                .run()
        };
        run_with(&scenes.path().join("a.pbrt"), "scene.dat").clean();
        // The message lists each directory once, and states which directories a plugin cannot see.
        let message = format!(
            "no lens file \"none.dat\" in the working directory, {}, /nonexistent, {} (a scene's SearchPath cannot be seen \
             from a plugin), and no lens",
            scenes.path().display(),
            plugins.path().display()
        );
        run_with(&scenes.path().join("a.pbrt"), "none.dat").refused(&[&message]);
        run_with(Path::new("<standard input>"), "scene.dat")
            .refused(&["the working directory, /nonexistent, "]);
    }
}

#[test]
fn a_misspelt_parameter_is_reported_once() {
    for abi in Abi::BOTH {
        let given = ["integer:flimdistance=3", "float:foo=2", "float:film_distance=40"];
        let report = run(abi, "rays", &given);
        assert_eq!(report.one("camera"), "made");
        let ours = "realistic: no parameter is called \"flimdistance\"; did you mean \"film_distance\"?";
        // This name resembles no parameter; the host reports it.
        assert_eq!(report.all("warning"), [ours, "Parameter \"foo\" not used"]);
        report.ended();
    }
}

#[test]
fn the_default_lens_is_the_built_in_one_beside_a_file_of_its_name() {
    let (_installed, plugin) = installed("realistic.so");
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("dgauss.50mm");
    fs::write(&file, LENS).unwrap();
    for abi in Abi::BOTH {
        let run_with = |more: &[&str]| {
            let run = Run::new(abi, &plugin, "rays").with("sample=17,3,0.4,0.6,0").with_all(more);
            run.in_directory(directory.path()).run()
        };
        let default = run_with(&[]);
        default.clean();
        let elsewhere = run(abi, "rays", &["sample=17,3,0.4,0.6,0"]);
        assert_eq!(default.rays("vtable"), elsewhere.rays("vtable"));
        let named = run_with(&["string:lens_file=dgauss.50mm", "float:film_distance=58"]);
        let [message] = named.all("warning")[..] else { panic!("{}", named.out) };
        assert!(
            message.contains("lens \"dgauss.50mm\" is the file dgauss.50mm, not the built-in"),
            "{message}"
        );
    }
}

#[test]
fn a_misspelt_set_of_instructions_is_a_warning() {
    let (_directory, plugin) = installed("realistic.so");
    for (given, words) in [
        ("avx-2", "\"avx-2\", no set of instructions, and changes nothing; did you mean \"avx2\"?"),
        (
            "fast",
            "\"fast\", no set of instructions, and changes nothing; the names are portable, avx2, avx512",
        ),
    ] {
        let report = Run::new(Abi::New, &plugin, "rays").env("REALISTIC_SIMD", Path::new(given)).run();
        assert!(report.one("warning").contains(words), "{}", report.out);
    }
    for known in ["", "portable"] {
        Run::new(Abi::New, &plugin, "rays").env("REALISTIC_SIMD", Path::new(known)).run().clean();
    }
}

#[test]
fn course_scenes_autofocus_zones_are_a_warning() {
    for abi in Abi::BOTH {
        let report = run(abi, "rays", &["string:af_zones=zones.txt"]);
        assert_eq!(report.one("camera"), "made");
        assert!(report.one("warning").contains("focus_distance"));
        report.ended();
    }
}

#[test]
fn a_copy_named_after_a_model_takes_that_model() {
    let (_directory, plugin) = installed("environment.so");
    for abi in Abi::BOTH {
        let middle = "sample=15,10,0.5,0.5,0";
        let report = Run::new(abi, &plugin, "rays").with(middle).run();
        report.clean();
        let ray = report.rays("vtable")[0];
        assert!(near(ray.d, [-1.0, 0.0, 0.0], 1e-6), "{ray:?}");
        assert_eq!((ray.weight, ray.o, ray.maxt as f32), (1.0, [0.0; 3], 1e30));
        let report = Run::new(abi, &plugin, "rays").with(middle).with("string:model=lens").run();
        report.clean();
        assert!(report.rays("vtable")[0].d[2] > 0.5);
    }
}

#[test]
fn the_stock_cameras_take_a_hosts_parameters() {
    for abi in Abi::BOTH {
        let (_directory, plugin) = installed("orthographic.so");
        let window = "float:screen_window=-3,3,-2,2";
        let report = Run::new(abi, &plugin, "rays").with(window).with("sample=30,0,0.5,0.5,0").run();
        report.clean();
        let ray = report.rays("vtable")[0];
        assert!(near(ray.o, [3.0, 2.0, 1e-3], 1e-6) && ray.d == [0.0, 0.0, 1.0], "{ray:?}");
        let refused = |argument| Run::new(abi, &plugin, "rays").with(argument).run();
        refused("float:screen_window=-3,3").refused(&["screen_window", "2 values", "takes four"]);
        refused("bool:lens_radius=true").refused(&["write \"float lens_radius\""]);
        let report = Run::new(abi, &plugin, "rays").with("float:fov=60").with("float:film_distance=40").run();
        assert_eq!(report.one("camera"), "made");
        assert!(report.one("warning").contains("does not use \"film_distance\", \"fov\""), "{}", report.out);
        report.ended();
    }
}

#[test]
fn a_crop_is_the_films_and_changes_no_ray() {
    for abi in Abi::BOTH {
        let samples = ["sample=3,4,0.3,0.6,0", "sample=29,19,0.5,0.5,0"];
        let whole = run(abi, "rays", &samples);
        let part = run(abi, "rays", &[&samples[..], &["float:crop=2,3,12,9"]].concat());
        assert!(part.one("warning").contains("give it \"float cropwindow\""), "{}", part.out);
        assert_eq!(format!("{:?}", part.rays("vtable")), format!("{:?}", whole.rays("vtable")));
        assert_eq!(whole.all("warning"), [""; 0]);
        let refused = |argument| run(abi, "rays", &[argument]);
        refused("float:crop=2,3,1200,9").refused(&["\"crop\" is 2,3,1200,9", "x to <="]);
        refused("float:crop=2,3").refused(&["crop", "2 values", "takes four"]);
    }
}

#[test]
fn a_closed_shutter_is_zero_outside_and_tiny_in_the_vtable() {
    for abi in Abi::BOTH {
        let slit = ["string:shutter=focal-plane", "float:shutter_slit=0.25", "sample=15,1,0.5,0.5,0.9"];
        let report = run(abi, "rays", &slit);
        report.clean();
        assert_eq!(report.rays("vtable")[0].weight as f32, f32::MIN_POSITIVE);
        assert_eq!(report.rays("exported")[0].weight, 0.0);
    }
}

#[test]
fn without_a_film_or_a_finite_transform_there_is_a_reason() {
    for abi in Abi::BOTH {
        run(abi, "nofilm", &[]).refused(&["film"]);
        let singular = "w2c=1,0,0,0, 0,0,0,0, 0,0,1,0, 0,0,0,1";
        run(abi, "rays", &[singular]).refused(&["transform"]);
    }
}

#[test]
fn a_process_without_the_hosts_functions_gets_a_reason() {
    let (_directory, plugin) = installed("realistic.so");
    let report = Run::of(&harness::closed_host(), &plugin, "rays").run();
    assert_eq!(report.one("camera"), "null");
    assert!(report.err.contains("Error: realistic: this process exports no ParamSet"), "{}", report.err);
}
