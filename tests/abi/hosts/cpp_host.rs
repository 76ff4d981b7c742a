//! `include/realistic.hpp` in a C++11 program, linked with the library and loading it at run time.
//!
//! With `REALISTIC_VALGRIND=1`, the first run of each action, in any host, uses valgrind.

use super::harness;

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use harness::{CXX11, Report, Run, compile_with, compiler};

/// Returns the host that loads the library, and the one that is linked with it.
fn hosts() -> &'static [PathBuf; 2] {
    static HOSTS: OnceLock<[PathBuf; 2]> = OnceLock::new();
    HOSTS.get_or_init(|| {
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/abi/hosts/cpp_host.cpp");
        let linking = harness::linking();
        let linking: Vec<&str> = linking.iter().map(String::as_str).collect();
        let linked: Vec<&str> = CXX11.into_iter().chain(["-DREALISTIC_LINKED"]).collect();
        [
            compile_with(&compiler(), &CXX11, &source, "cpp_host_loading", &["-ldl", "-lpthread"]),
            compile_with(&compiler(), &linked, &source, "cpp_host_linked", &linking),
        ]
    })
}

fn runs(action: &str) -> [Report; 2] {
    hosts().each_ref().map(|host| Run::of(host, &harness::plugin(), action).run())
}

#[test]
fn what_the_library_refuses_is_thrown_with_status_and_message() {
    for report in runs("refusals") {
        for (what, status, words) in [
            ("lens", 4, "no lens file \"nolens\""),
            ("range", 3, "\"film_diagonal\" is -1"),
            ("near", 5, "cannot focus at 10 mm"),
            ("text", 4, "lens_text:1:1: 2 value(s)"),
            ("both", 3, "\"weighting\" and \"simple_weighting\""),
            ("pixels", 3, "0 x 30 pixels"),
        ] {
            let line = report.one(what);
            assert!(line.starts_with(&format!("{status} ")) && line.contains(words), "{what}: {line}");
        }
        assert_eq!(report.all("built"), [""; 0]);
    }
}

#[test]
fn a_camera_is_owned_moved_called_and_released() {
    for report in runs("cameras") {
        assert_eq!(report.one("moved"), "1 1");
        let info: Vec<&str> = report.one("info").split(' ').collect();
        assert_eq!((info[0], info[2]), ("wide.22mm@35mm", "13"));
        assert!((info[1].parse::<f64>().unwrap() / 35.0 - 1.0).abs() < 1e-14);
        assert_eq!(report.one("crop"), "8 0 16 30 of 40 30");
        assert_eq!(report.one("corner"), "-3 2");
        assert_eq!(report.one("plan"), "1");
        assert_eq!(report.one("logged"), "1");
        assert!(report.one("log").contains("faster than the lens"));
        let [different, passed] = report.numbers("rays")[..] else { panic!("two numbers") };
        assert!(different == 0.0 && passed > 100.0 && passed < 1990.0, "{different} {passed}");
        let [unlike, both] = report.numbers("differentials")[..] else { panic!("two numbers") };
        assert!(unlike == 0.0 && both > 100.0 && both <= passed, "{unlike} {both}");
        assert_eq!(report.one("null"), "1 request.image.x is NULL");
        assert_eq!(report.one("released"), "1");
        assert_eq!(report.one("through"), "thrown by the log");
    }
}

#[test]
fn rays_at_wavelengths_are_the_same_by_every_member() {
    for report in runs("wavelengths") {
        let [different, passed, none] = report.numbers("wavelengths")[..] else { panic!("three numbers") };
        assert!(different == 0.0 && passed > 60.0 && none >= 5.0, "{different} {passed} {none}");
        assert_eq!(report.one("capable"), "1");
    }
}

#[test]
fn a_lens_traces_without_a_film_and_autofocus_takes_a_function() {
    for report in runs("lenses") {
        let lens: Vec<&str> = report.one("lens").split(' ').collect();
        assert_eq!((lens[0], lens[3]), ("wide.22mm", "13"));
        let number = |at: usize| lens[at].parse::<f64>().unwrap();
        assert!((number(1) - 22.0).abs() < 0.5 && (number(2) - 8.0).abs() < 1e-9, "{lens:?}");
        assert_eq!(report.one("stop"), "1");
        assert!((report.number("focus") - 1000.0).abs() < 1e-6);
        assert_eq!(report.one("points"), "13 1 0");
        assert_eq!(report.numbers("axis"), [0.0, 0.0, -1.0]);
        assert!(report.one("none").starts_with("3 surface 99: the lens has 13"));
        // The plane lies 800 mm in front of the lens, and the film behind the lens.
        let focused = report.number("autofocus");
        assert!((800.0..1000.0).contains(&focused), "{focused}");
        assert_eq!(report.one("refused"), "for its film distance");
        assert_eq!(report.one("through"), "thrown by the callback");
    }
}

#[test]
fn a_camera_has_importance() {
    for report in runs("importance") {
        let [first, ratio, image_x, unseen] = report.numbers("importance")[..] else {
            panic!("four numbers")
        };
        // The first value is 1 over the area of the film, 28 x 21 mm.
        assert!((first * 28.0 * 21.0 - 1.0).abs() < 1e-5 && (ratio - 1.0).abs() < 1e-6, "{first} {ratio}");
        assert!((image_x - 20.0).abs() < 1.0 && unseen == 0.0, "{image_x} {unseen}");
        assert!(report.one("environment").starts_with("3 model \"environment\""));
    }
}

#[test]
fn a_linked_host_names_no_library_and_a_loading_one_does() {
    let [loading, linked] = runs("none");
    assert_eq!(linked.one("linked"), "dgauss.50mm");
    assert_eq!(loading.one("missing"), "10 the library has no function realistic_abi_version");
}
