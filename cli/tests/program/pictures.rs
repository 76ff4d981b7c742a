//! The commands that take pictures and draw the pictures of the lecture.

use super::realistic;
use std::path::Path;

fn picture(directory: &Path, arguments: &[&str]) -> Vec<u8> {
    let output = realistic(directory, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    let out = arguments.iter().position(|argument| *argument == "--out").unwrap();
    std::fs::read(directory.join(arguments[out + 1])).unwrap()
}

#[test]
fn every_lens_of_the_catalogue_renders_the_default_scene() {
    let dir = tempfile::tempdir().unwrap();
    let names = realistic_optics::prescription::catalogue::round();
    // Lenses that cannot focus on the scene's subject are moved back.
    let mut moved = Vec::new();
    for name in names.chain(["dgauss.50mm@2000mm"]) {
        let command = ["render", name, "--size", "6x4", "--spp", "1", "--out", "picture.png"];
        let output = realistic(dir.path(), &command);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{name}: {stderr}");
        if stderr.contains("mm farther back") {
            moved.push(name);
        }
    }
    let expected = ["telephoto.250mm", "triplet.210mm", "telephoto.300mm", "dgauss.50mm@2000mm"];
    assert_eq!(moved, expected);
}

#[test]
fn a_desqueezed_picture_has_the_proportions_of_the_scene() {
    let dir = tempfile::tempdir().unwrap();
    let command =
        ["render", "anamorphic.42mm", "--focus-distance", "20000", "--film-diagonal", "24", "--spp", "1"];
    let command = [&command[..], &["--size", "60x40"]].concat();
    let [squeezed, true_width] = [&[][..], &["--desqueeze"]]
        .map(|more| pixels(dir.path(), &[&command[..], more, &["--out", "picture.exr"]].concat()));
    // 60 pixels times 42.479 mm over 21.483 mm.
    assert_eq!([squeezed.len(), true_width.len()], [60 * 40, 119 * 40]);
    // Both hold the same light.
    let mean = |pixels: &[[f32; 3]]| {
        pixels.as_flattened().iter().map(|value| f64::from(*value)).sum::<f64>() / pixels.len() as f64
    };
    let means = [&squeezed, &true_width].map(|pixels| mean(pixels));
    assert!((means[1] / means[0] - 1.0).abs() < 0.02, "{means:?}");
    for more in [&["dgauss.50mm"][..], &["mirror.500mm"], &["anamorphic.42mm", "--model", "thin"]] {
        let command =
            [&["render", "--desqueeze", "--size", "6x4", "--spp", "1", "--out", "none.png"][..], more]
                .concat();
        let output = realistic(dir.path(), &command);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{more:?}: {stderr}");
        assert!(stderr.contains("--desqueeze needs a lens that squeezes the picture"), "{more:?}: {stderr}");
        assert!(!dir.path().join("none.png").exists(), "{more:?}");
    }
}

#[test]
fn a_lens_that_is_moved_back_has_the_subject_in_focus() {
    let dir = tempfile::tempdir().unwrap();
    let command = ["render", "telephoto.300mm", "--size", "6x4", "--spp", "1", "--out", "picture.png"];
    let output = realistic(dir.path(), &command);
    let (stderr, stdout) =
        (String::from_utf8(output.stderr).unwrap(), String::from_utf8(output.stdout).unwrap());
    assert!(stderr.contains("the camera stands 649.805 mm farther back"), "{stderr}");
    // The focus is twice 649.8 mm in front of the front vertex, plus the lens and its film distance of 560 to 570 mm.
    let focus = stdout.lines().find_map(|line| line.strip_prefix("focus")).unwrap().trim();
    let focus: f64 = focus.split(' ').next().unwrap().parse().unwrap();
    assert!((focus - 2.0 * 649.8 - 450.0).abs() < 200.0, "{focus}");
}

#[test]
fn an_orthographic_camera_sees_the_scene() {
    let dir = tempfile::tempdir().unwrap();
    for scene in ["day", "chess"] {
        let seen = |more: &[&str]| {
            let command =
                ["render", "--model", "orthographic", "--scene", scene, "--size", "36x24", "--spp", "1"];
            pixels(dir.path(), &[&command[..], &["--out", "seen.exr"], more].concat())
        };
        let colours = |picture: &[[f32; 3]]| {
            let mut colours: Vec<_> = picture.iter().map(|pixel| pixel.map(|x| (20.0 * x) as i32)).collect();
            colours.sort_unstable();
            colours.dedup();
            colours.len()
        };
        let default = seen(&[]);
        assert!(colours(&default) > 40, "{scene}: {} colours", colours(&default));
        if scene == "day" {
            assert_eq!(default, seen(&["--screen-window", "-450,450,-300,300"]));
        }
    }
}

#[test]
fn every_slide_is_the_same_with_any_number_of_threads() {
    let dir = tempfile::tempdir().unwrap();
    for slide in ["gloss", "translucency", "soft-shadow", "dof", "motion", "lenses", "colour"] {
        let take = |threads: &str, out: &str| {
            let command = ["render", "--slide", slide, "--size", "36x24", "--spp", "8"];
            picture(dir.path(), &[&command[..], &["--threads", threads, "--out", out]].concat())
        };
        assert_eq!(take("1", "one.png"), take("2", "two.png"), "{slide}");
    }
}

#[test]
fn every_set_of_instructions_makes_the_same_picture() {
    let dir = tempfile::tempdir().unwrap();
    let small = ["render", "--scene", "day", "--size", "36x24", "--spp", "4"];
    for more in [
        &["--lens", "fisheye.10mm", "--param", "precision=f32"][..],
        // Lenses with aspheres, at one wavelength and at several. The table of the phone's pupil would take half a
        // minute in portable code.
        &["--lens", "zoom.24-70mm"],
        &["--lens", "phone.4mm", "--wavelengths", "3", "--pupil", "disk"],
        &["--lens", "dgauss.100mm", "--wavelengths", "3", "--param", "precision=f32"],
    ] {
        // Instructions that the processor does not have are not used.
        let taken = ["portable", "avx2", "avx512"].map(|instructions| {
            let command = std::process::Command::new(env!("CARGO_BIN_EXE_realistic"))
                .current_dir(dir.path())
                .env("REALISTIC_SIMD", instructions)
                .args([&small[..], more, &["--out", "picture.png"]].concat())
                .output()
                .unwrap();
            assert!(command.status.success(), "{}", String::from_utf8_lossy(&command.stderr));
            std::fs::read(dir.path().join("picture.png")).unwrap()
        });
        assert!(taken[0] == taken[1] && taken[0] == taken[2], "{more:?}");
    }
}

#[test]
fn the_default_effects_are_those_of_the_plain_picture() {
    let dir = tempfile::tempdir().unwrap();
    let small = ["render", "--scene", "day", "--size", "36x24", "--spp", "4", "--out"];
    let taken = |more: &[&str]| picture(dir.path(), &[&small[..], more].concat());
    let plain = taken(&["plain.exr"]);
    assert_eq!(plain, taken(&["same.exr", "--effects", "soft-shadow,dof"]));
    for effects in ["none", "dof", "soft-shadow,dof,gloss", "soft-shadow,dof,motion"] {
        assert_ne!(plain, taken(&["other.exr", "--effects", effects]), "{effects}");
    }
}

/// Renders a picture of 36 x 24 pixels, linear.
fn pixels(directory: &Path, arguments: &[&str]) -> Vec<[f32; 3]> {
    picture(directory, arguments);
    let out = arguments.iter().position(|argument| *argument == "--out").unwrap();
    exr::prelude::read_first_rgba_layer_from_file(
        directory.join(arguments[out + 1]),
        |size, _| vec![vec![[0.0_f32; 3]; size.width()]; size.height()],
        |rows, at, (r, g, b, _): (f32, f32, f32, f32)| rows[at.y()][at.x()] = [r, g, b],
    )
    .unwrap()
    .layer_data
    .channel_data
    .pixels
    .concat()
}

#[test]
fn a_lens_without_v_numbers_has_no_colour_errors() {
    let dir = tempfile::tempdir().unwrap();
    let small =
        ["render", "--scene", "day", "--size", "36x24", "--spp", "4", "--lens", "dgauss.50mm", "--out"];
    let taken = |out: &str, more: &[&str]| pixels(dir.path(), &[&small[..], &[out], more].concat());
    let plain = taken("plain.exr", &[]);
    let spectral = taken("spectral.exr", &["--wavelengths", "5"]);
    for (a, b) in plain.as_flattened().iter().zip(spectral.as_flattened()) {
        assert!((a - b).abs() < 1e-3 * (a.abs() + 0.1), "{a} and {b}");
    }
}

#[test]
fn ghosts_add_their_light_to_the_picture() {
    let dir = tempfile::tempdir().unwrap();
    let small = [
        "render",
        "dgauss.50mm",
        "--scene",
        "day",
        "--size",
        "36x24",
        "--spp",
        "64",
        "--transmission",
        "bare",
    ];
    let mean = |ghosts: &str| {
        let taken = pixels(dir.path(), &[&small[..], &["--ghosts", ghosts, "--out", "ghosts.exr"]].concat());
        taken.as_flattened().iter().sum::<f32>() / taken.as_flattened().len() as f32
    };
    let [without, with, alone] = ["0", "0.3", "1"].map(mean);
    assert!(alone > 0.02 * without && alone < 0.2 * without, "{alone} {without}");
    assert!((with - without - alone).abs() < 0.2 * alone, "{with} is not {without} and {alone}");
}

#[test]
fn a_focus_stack_is_numbered_and_has_a_contact_sheet() {
    let dir = tempfile::tempdir().unwrap();
    let stack =
        ["focus-stack", "--from", "700", "--to", "inf", "--count", "3", "--size", "36x24", "--spp", "2"];
    let output = realistic(dir.path(), &stack);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    for file in ["focus-01.png", "focus-02.png", "focus-03.png", "contact.png"] {
        assert!(dir.path().join(file).is_file(), "{file}");
    }
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("700 mm") && text.contains("infinity"), "{text}");
}

#[test]
fn autofocus_on_the_card_focuses_on_the_card() {
    let dir = tempfile::tempdir().unwrap();
    let focus = |more: &[&str]| {
        let output = realistic(dir.path(), &[&["render", "--scene", "day", "--spp", "1"], more].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let text = String::from_utf8(output.stdout).unwrap();
        let line = text.lines().find(|line| line.starts_with("focus")).unwrap().to_owned();
        line.split_whitespace().nth(1).unwrap().parse::<f64>().unwrap()
    };
    // The card stands 1000 mm in front of the lens; lens and film distance together are 68 mm long.
    let card = ["--autofocus", "60,180,60,50"];
    assert!((focus(&card) - 1068.0).abs() < 5.0);
    assert!((focus(&[&card[..], &["--autofocus-by", "contrast"]].concat()) - 1068.0).abs() < 60.0);
    let both = ["--autofocus", "230,140,40,40", "--autofocus", "60,180,60,50", "--autofocus-rule"];
    assert!((focus(&[&both[..], &["nearest"]].concat()) - 1068.0).abs() < 5.0);
    assert!((focus(&[&both[..], &["centre"]].concat()) - 8068.0).abs() < 50.0);
}

#[test]
fn the_disks_are_drawn_and_the_wrong_one_is_identified() {
    let dir = tempfile::tempdir().unwrap();
    let output = realistic(dir.path(), &["disks"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(dir.path().join("disks.png").is_file());
    let p = |name: &str| {
        let line = text.lines().find(|line| line.starts_with(name)).unwrap();
        line.split_whitespace().last().unwrap().parse::<f64>().unwrap()
    };
    assert!(p("wrong") < 1e-6);
    assert!(["concentric", "polar", "rejection"].map(p).iter().all(|p| *p > 1e-3));
}

#[test]
fn what_cannot_be_is_refused_with_what_to_do() {
    let dir = tempfile::tempdir().unwrap();
    for (arguments, words) in [
        (&["render", "--slide", "glos"][..], "soft-shadow"),
        (&["render", "--slide", "gloss", "--effects", "dof"], "--effects"),
        (&["render", "--slide", "lenses", "--lens", "wide.22mm"], "leave out the lens"),
        (&["render", "--slide", "gloss", "--param", "fnumber=4"], "fnumber"),
        (&["render", "--effects", "blur"], "translucency"),
        (&["render", "--effects", "gloss", "--param", "aperture_diameter=4"], "dof"),
        (&["render", "--wavelengths", "2"], "from 3 to 256"),
        (&["render", "--wavelengths", "3", "--param", "wavelength=500"], "wavelength"),
        (&["render", "--autofocus", "1,2,3"], "LEFT,TOP,WIDTH,HEIGHT"),
        (&["render", "--autofocus", "1,2,3,0"], "LEFT,TOP,WIDTH,HEIGHT"),
        (&["render", "--autofocus", "470,2,30,10"], "0 to 480"),
        (&["render", "--autofocus", "--param", "film_distance=40"], "film_distance"),
        (&["render", "--autofocus-rule", "centre"], "--autofocus"),
        (&["render", "--autofocus", "--autofocus-rule", "best"], "nearest"),
        (&["render", "--autofocus", "--autofocus-by", "sonar"], "contrast"),
        (&["focus-stack", "--from", "900", "--to", "800"], "nearer"),
        (&["focus-stack", "--from", "0", "--to", "800"], "positive number"),
        (&["focus-stack", "--from", "50", "--to", "800"], "nearest"),
        (&["focus-stack", "--from", "500", "--to", "800", "--count", "1"], "from 2 to 999"),
        (&["focus-stack", "--from", "500", "--to", "800", "--param", "focus_distance=3"], "focus_distance"),
        (&["disks", "--out", "disks.jpg"], ".png"),
    ] {
        let output = realistic(dir.path(), arguments);
        let text = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success(), "{arguments:?}");
        assert!(text.contains(words), "{arguments:?}: {text}");
    }
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 0, "nothing was written");
}
