//! Tiles of a picture from several processes, and the whole picture joined from them.

use super::realistic;
use std::path::Path;
use std::process::{Command, Stdio};

/// Parts of a 50 x 34 picture with odd sizes, one of them a single pixel.
const CROPS: [&str; 5] = ["0,0,17,34", "17,0,50,9", "17,9,18,10", "18,9,50,34", "17,10,18,34"];
const SMALL: [&str; 5] = ["render", "--size", "50x34", "--spp", "3"];

fn run(directory: &Path, arguments: &[&str]) -> String {
    let output = realistic(directory, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Runs a command that must fail and write nothing, and checks its message.
#[track_caller]
fn refused(directory: &Path, arguments: &[&str], words: &[&str]) {
    let files = || std::fs::read_dir(directory).unwrap().count();
    let before = files();
    let output = realistic(directory, arguments);
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success() && files() == before, "{arguments:?}");
    for word in words {
        assert!(text.contains(word), "{arguments:?}: no {word:?} in {text}");
    }
}

/// Renders the tiles at the same time, each in its own process, and returns their files, the last file first.
fn tiles(directory: &Path, ending: &str, more: &[&str]) -> Vec<String> {
    let tile = |(number, crop): (usize, &&str)| {
        let file = format!("tile{number}.{ending}");
        let child = Command::new(env!("CARGO_BIN_EXE_realistic"))
            .current_dir(directory)
            .args(SMALL)
            .args(more)
            .args(["--threads", if number == 0 { "2" } else { "1" }, "--crop", crop, "--out", &file])
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        (file, child)
    };
    let started: Vec<_> = CROPS.iter().enumerate().map(tile).collect();
    let ended = started.into_iter().rev().map(|(file, mut child)| {
        assert!(child.wait().unwrap().success(), "{file}");
        file
    });
    ended.collect()
}

#[test]
fn a_picture_made_of_tiles_is_the_whole_byte_for_byte() {
    let dir = tempfile::tempdir().unwrap();
    let cases: [(&str, &[&str]); 5] = [
        ("png", &[]),
        (
            "exr",
            &["--lens", "wide.22mm", "--param", "weighting=relative", "--scene", "day", "--effects", "all"],
        ),
        ("png", &["--param", "tolerance=0.5", "--compensation", "0.5"]),
        ("exr", &["--param", "tolerance=0.05", "--seed", "9", "--autofocus"]),
        ("exr", &["--lens", "dgauss.100mm", "--wavelengths", "3"]),
    ];
    for (ending, more) in cases {
        let [whole, merged] = ["whole", "merged"].map(|name| format!("{name}.{ending}"));
        run(dir.path(), &[&SMALL[..], &["--out", &whole], more].concat());
        let files = tiles(dir.path(), ending, more);
        let files: Vec<&str> = files.iter().map(String::as_str).collect();
        let stdout = run(dir.path(), &[&["merge"], &files[..], &["--out", &merged]].concat());
        assert!(stdout.contains("50x34, of 5 tiles"), "{stdout}");
        let [whole, merged] = [whole, merged].map(|file| std::fs::read(dir.path().join(file)).unwrap());
        assert!(whole == merged, "{ending} {more:?}");
    }
}

#[test]
fn a_tile_states_its_position_to_other_programs() {
    let dir = tempfile::tempdir().unwrap();
    let take = |file: &str| run(dir.path(), &[&SMALL[..], &["--crop", "17,9,30,34", "--out", file]].concat());
    assert!(take("tile.png").contains("at 17,9 of 50x34"));
    let png = std::fs::read(dir.path().join("tile.png")).unwrap();
    let chunk = png.windows(4).position(|name| name == b"oFFs").expect("a place");
    assert_eq!(png[chunk + 4..chunk + 13], [0, 0, 0, 17, 0, 0, 0, 9, 0]);
    take("tile.exr");
    let meta = exr::meta::MetaData::read_from_file(dir.path().join("tile.exr"), false).unwrap();
    let header = &meta.headers[0];
    let [data, display] = [header.data_window(), header.shared_attributes.display_window];
    assert_eq!((data.position.0, data.position.1, data.size.0, data.size.1), (17, 9, 13, 25));
    assert_eq!((display.position.0, display.position.1, display.size.0, display.size.1), (0, 0, 50, 34));
}

#[test]
fn a_crop_outside_the_picture_is_refused_with_its_size() {
    let dir = tempfile::tempdir().unwrap();
    for crop in ["0,0,51,34", "0,0,0,34", "5,5,4,6", "-1,0,5,5", "0.5,0,5,5"] {
        let crop = format!("--crop={crop}");
        refused(dir.path(), &[&SMALL[..], &[&crop]].concat(), &["\"crop\" is", "50 x 34", "y to <= 34"]);
    }
    for crop in ["1,2,3", "a,b,c,d", ""] {
        let crop = format!("--crop={crop}");
        refused(dir.path(), &[&SMALL[..], &[&crop]].concat(), &["\"crop\" takes four numbers"]);
    }
    let both = ["--crop", "0,0,5,5", "--param", "crop=0,0,5,5"];
    refused(dir.path(), &[&SMALL[..], &both].concat(), &["\"crop\" is given twice"]);
    refused(dir.path(), &["render", "--slide", "dof", "--crop", "0,0,5,5"], &["whole ones"]);
    refused(dir.path(), &["render", "--slide", "dof", "--param", "crop=0,0,5,5"], &["whole ones"]);
    let stack = ["focus-stack", "--from", "700", "--to", "inf", "--param", "crop=0,0,5,5"];
    refused(dir.path(), &stack, &["whole ones"]);
}

#[test]
fn tiles_that_make_no_picture_are_refused_by_name() {
    let dir = tempfile::tempdir().unwrap();
    let take = |file: &str, crop: &str, more: &[&str]| {
        run(dir.path(), &[&SMALL[..], &["--crop", crop, "--out", file], more].concat());
    };
    take("left.png", "0,0,25,34", &[]);
    take("right.png", "25,0,50,34", &[]);
    take("corner.png", "25,0,50,20", &[]);
    let merge = |files: &[&str], words: &[&str]| {
        refused(dir.path(), &[&["merge"], files, &["--out", "no.png"]].concat(), words);
    };
    merge(&["left.png", "right.png", "corner.png"], &["right.png (25,0,50,34)", "corner.png (25,0,50,20)"]);
    merge(&["left.png", "left.png"], &["left.png (0,0,25,34) and left.png", "overlap"]);
    merge(&["left.png"], &["left.png", "pixels 25,0,50,34 of the 50x34", "--crop 25,0,50,34"]);
    merge(&["left.png", "corner.png"], &["left.png, corner.png", "--crop 25,20,50,34"]);
    for (size, spp, more, words) in [
        ("50x34", "4", &[][..], &["samples per pixel", "\"3\"", "\"4\""][..]),
        ("60x34", "3", &[], &["50x34", "60x34", "--size"]),
        ("50x34", "3", &["--seed", "5"], &["seed"]),
        ("50x34", "3", &["--lens", "wide.22mm"], &["lens", "\"dgauss.50mm\"", "\"wide.22mm\""]),
        ("50x34", "3", &["--param", "pupil=rear"], &["parameters", "pupil=rear"]),
        ("50x34", "3", &["--effects", "dof"], &["effects"]),
        ("50x34", "3", &["--compensation", "1"], &["brightness"]),
        ("50x34", "3", &["--wavelengths", "3"], &["wavelengths"]),
    ] {
        let right = ["render", "--size", size, "--spp", spp, "--crop", "25,0,50,34", "--out", "other.png"];
        run(dir.path(), &[&right[..], more].concat());
        merge(&["left.png", "other.png"], &[&["left.png", "other.png"], words].concat());
    }
    // For both scenes, the lens has the same focus.
    for (file, crop, scene) in [("day.png", "0,0,25,34", "day"), ("night.png", "25,0,50,34", "night")] {
        take(file, crop, &["--scene", scene]);
    }
    merge(&["day.png", "night.png"], &["day.png", "night.png", "scene", "Day", "Night"]);
    // Different lenses with the same file name.
    for (folder, radius) in [("a", "50"), ("b", "51")] {
        std::fs::create_dir(dir.path().join(folder)).unwrap();
        let text = format!("{radius} 5 1.5 10\n-50 40 1 10\n");
        std::fs::write(dir.path().join(folder).join("one.dat"), text).unwrap();
        let crop = if folder == "a" { "0,0,25,34" } else { "25,0,50,34" };
        let lens = format!("{folder}/one.dat");
        take(&format!("{folder}.png"), crop, &["--lens", &lens, "--param", "film_distance=60"]);
    }
    merge(&["a.png", "b.png"], &["a.png and b.png", "different pictures", "focal length"]);
    take("tile.exr", "25,0,50,34", &[]);
    merge(&["left.png", "tile.exr"], &["tile.exr", "no.png", "different formats"]);
    merge(&["left.png", "gone.png"], &["cannot read gone.png"]);
    run(dir.path(), &[&SMALL[..], &["--out", "whole.png"]].concat());
    merge(&["whole.png"], &["whole.png is no tile", "--crop"]);
    let png = std::fs::read(dir.path().join("left.png")).unwrap();
    std::fs::write(dir.path().join("half.png"), &png[..png.len() / 2]).unwrap();
    merge(&["half.png", "right.png"], &["half.png is no whole PNG file"]);
    std::fs::write(dir.path().join("text.exr"), "no picture").unwrap();
    refused(dir.path(), &["merge", "text.exr", "--out", "no.exr"], &["text.exr is no whole EXR file"]);
    refused(dir.path(), &["merge", "left.jpg", "--out", "no.png"], &[".png"]);
    refused(dir.path(), &["merge", "--out", "no.png"], &["TILE"]);
}

#[test]
fn a_tile_of_a_huge_picture_allocates_no_memory_for_it() {
    let dir = tempfile::tempdir().unwrap();
    for ending in ["png", "exr"] {
        let file = format!("tile.{ending}");
        let huge = [
            "render",
            "--scene",
            "day",
            "--size",
            "16384x16384",
            "--spp",
            "1",
            "--threads",
            "1",
            "--crop",
            "0,0,8,6",
        ];
        run(dir.path(), &[&huge[..], &["--out", &file]].concat());
        let output = Command::new("sh")
            .current_dir(dir.path())
            .arg("-c")
            .arg("ulimit -v 1500000; exec \"$@\"")
            .args(["sh", env!("CARGO_BIN_EXE_realistic"), "merge", &file, "--out", &format!("no.{ending}")])
            .output()
            .unwrap();
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{}: {text}", output.status);
        assert!(text.contains("has the pixels 8,0,16384,16384 of the 16384x16384 picture"), "{text}");
    }
}
