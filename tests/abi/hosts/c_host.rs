//! The C ABI from a C99 program that uses only `include/realistic.h`.
//!
//! With `REALISTIC_VALGRIND=1`, the first run of each action, in any host, uses valgrind.

use super::harness;

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use harness::{C99, CXX11, Report, Run, c_compiler, compile_with, compiler};

fn source(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

const LIBRARIES: [&str; 3] = ["-ldl", "-lpthread", "-lm"];

fn run(action: &str) -> Report {
    static HOST: OnceLock<PathBuf> = OnceLock::new();
    let host = HOST.get_or_init(|| {
        compile_with(&c_compiler(), &C99, &source("tests/abi/hosts/c_host.c"), "c_host", &LIBRARIES)
    });
    Run::of(host, &harness::plugin(), action).run()
}

/// Checks that a line of `what STATUS MESSAGE` has this status and a message with all of the words.
#[track_caller]
fn assert_status(report: &Report, what: &str, status: i32, words: &[&str]) {
    let line = report.one(what);
    let (number, message) = line.split_once(' ').unwrap_or((line, ""));
    assert_eq!(number, status.to_string(), "{what}: {line}");
    assert_eq!(status == 0, message.is_empty(), "{what}: {line}");
    for word in words {
        assert!(message.contains(word), "{what}: no {word:?} in: {message}");
    }
    assert_eq!(report.all("touched").iter().filter(|&&touched| touched == what).count(), 0);
}

const NULL: i32 = 1;
const SIZE: i32 = 2;
const PARAMETER: i32 = 3;
const LENS: i32 = 4;
const UNREACHABLE: i32 = 5;
const IO: i32 = 6;
const PANIC: i32 = 7;
const NOT_OURS: i32 = 8;
const MEMORY: i32 = 9;
const NOT_A_LENS: i32 = 11;

#[test]
fn the_library_says_what_it_is() {
    let report = run("library");
    assert_eq!(report.numbers("abi"), [1.0, 1.0]);
    assert_eq!(report.one("version"), env!("CARGO_PKG_VERSION"));
    // The test hosts load the plugin, which serves pbrt.
    assert_eq!(report.number("capabilities"), 1.0);
    assert_eq!(report.one("empty"), "[]");
    let names = report.all("name");
    assert_eq!(names[1], "0 ok");
    assert_eq!(names.iter().filter(|name| name.ends_with("unknown status")).count(), 2);
    assert_eq!(names.iter().collect::<std::collections::HashSet<_>>().len(), 14);
}

#[test]
fn numbers_of_elements_that_no_memory_holds_are_refused() {
    let report = run("counts");
    assert_status(&report, "soa-endless", PARAMETER, &["n is 4611686018427387902", "elements of request."]);
    for what in ["soa-many", "many"] {
        assert_status(&report, what, PARAMETER, &["n is 1125899906842624", "no memory holds", "request."]);
    }
    assert_status(&report, "wide", PARAMETER, &["n is 2", "request.origin", "9223372036854775807 bytes"]);
    assert_status(
        &report,
        "wide-back",
        PARAMETER,
        &["n is 2", "request.origin", "-9223372036854775808 bytes"],
    );
    assert_status(&report, "below", PARAMETER, &["n is 2", "request.time, at a stride of -8192 bytes"]);
    assert_status(&report, "wavelengths", PARAMETER, &["no memory holds"]);
    assert_status(&report, "zones-endless", PARAMETER, &["n is 4611686018427387902", "elements of 16 bytes"]);
    assert_status(&report, "zones-many", MEMORY, &["memory is out"]);
    assert_status(&report, "zones-null", NULL, &["zones is NULL"]);
    assert_eq!(report.one("kept"), "7 7");
    assert_eq!(report.all("asked"), [""; 0]);
}

#[test]
fn every_status_of_the_header_is_returned_or_reserved() {
    let header = std::fs::read_to_string(source("include/realistic.h")).unwrap();
    let listed = header.split("enum realistic_status\n").nth(1).and_then(|rest| rest.split("};").next());
    let (mut is_reserved, mut returned) = (false, Vec::new());
    for line in listed.expect("the enumeration").lines() {
        if let Some((name, number)) = line.trim().strip_suffix(',').and_then(|line| line.split_once(" = ")) {
            if !is_reserved {
                returned.push((number.parse::<i32>().unwrap(), name));
            }
            is_reserved = false;
        }
        is_reserved |= line.contains("Reserved");
    }
    let reports = ["refusals", "null", "counts", "lens"].map(run);
    let seen = |number: i32| {
        let is_it = |line: &str| line.split(' ').nth(1) == Some(&number.to_string());
        reports.iter().any(|report| report.out.lines().any(is_it))
    };
    assert_eq!(returned.len(), 11, "{returned:?}");
    for (number, name) in returned {
        // Only a defect causes this status: a unit test of the boundary provokes one.
        assert!(number == PANIC || seen(number), "{name} is never returned");
    }
}

#[test]
fn no_call_prints() {
    for action in ["library", "refusals", "info", "plan", "log", "rays", "null", "threads", "counts", "lens"]
    {
        assert_eq!(run(action).err, "", "{action}");
    }
}

#[test]
fn each_kind_of_error_has_its_status_and_a_message_that_helps() {
    let report = run("refusals");
    assert_status(&report, "init-null", NULL, &["options is NULL"]);
    assert_status(&report, "init-small", SIZE, &["struct_size is 4", "sizeof(realistic_options)"]);
    assert_status(&report, "init-large", SIZE, &["older than the header"]);
    assert_status(&report, "options-null", NULL, &["options is NULL"]);
    assert_status(&report, "out-null", NULL, &["out is NULL"]);
    assert_status(&report, "size-small", SIZE, &["struct_size is 8"]);
    assert_status(&report, "size-large", SIZE, &["older than the header"]);
    assert_status(&report, "size-zero", SIZE, &["struct_size is 0"]);
    assert_status(&report, "no-pixels", PARAMETER, &["0 x 30 pixels", "1 or more"]);
    assert_status(&report, "negative-pixels", PARAMETER, &["40 x -3 pixels"]);
    assert_status(&report, "no-lens", LENS, &["no/such/lens.dat", "dgauss.50mm"]);
    assert_status(&report, "no-picture", IO, &["\"stop_picture\"", "no picture \"no/such/picture.png\""]);
    assert_status(&report, "not-utf8", PARAMETER, &["\"lens_file\"", "UTF-8"]);
    assert_status(&report, "bad-text", LENS, &["lens_text:2:5:", "\"x\" is not a number"]);
    assert_status(&report, "no-text", LENS, &["lens_text:1:1:", "at least one interface"]);
    assert_status(&report, "endless-text", LENS, &["lens_text_size is 18446744073709551615", "at most"]);
    assert_status(&report, "two-lenses", PARAMETER, &["\"lens_file\"", "\"lens_text\""]);
    assert_status(&report, "too-near", UNREACHABLE, &["cannot focus at 10 mm", "nearest"]);
    assert_status(&report, "range", PARAMETER, &["\"film_diagonal\" is -1", "positive, in mm"]);
    assert_status(&report, "choice", PARAMETER, &["\"heavy\"", "\"radiometric\""]);
    assert_status(&report, "both", PARAMETER, &["\"weighting\"", "\"simple_weighting\""]);
    assert_status(&report, "boolean", PARAMETER, &["\"simple_weighting\" is 7", "-1, 0 or 1"]);
    assert_status(&report, "singular", PARAMETER, &["transform", "singular"]);
    assert_status(&report, "info-small", SIZE, &["struct_size is 4"]);
    assert_status(&report, "info-large", SIZE, &["older than the header"]);
    assert_status(&report, "info-null", NULL, &["info is NULL"]);
    assert_status(&report, "info-no-camera", NOT_OURS, &["no camera of this library"]);
    assert_status(&report, "name-null", NULL, &["buffer is NULL"]);
    assert_status(&report, "plan-null", NULL, &["buffer is NULL"]);
    assert_status(&report, "plan-no-camera", NOT_OURS, &["no camera of this library"]);
    assert_eq!(report.all("touched"), [""; 0]);
}

#[test]
fn info_and_lens_name_are_the_cameras() {
    let report = run("info");
    assert_status(&report, "status", 0, &[]);
    let info = report.numbers("info");
    assert_eq!((info[0], info[1]), (1.0, 13.0));
    for (got, expected) in [(info[2], 35.0), (info[3], 8.0), (info[4], 40.0), (info[6], 20.0)] {
        assert!((got / expected - 1.0).abs() < 1e-12, "{info:?}");
    }
    assert!(info[5] > 40.0, "{info:?}");
    // "wide.22mm@35mm" has 14 bytes; the text is truncated to fit, and always ends in NUL.
    assert_eq!(report.all("name"), ["0 14 ", "5 14 wide", "10 14 wide.22mm", "15 14 wide.22mm@35mm"]);
    assert_eq!(report.all("overrun"), [""; 0]);
    assert_eq!(report.one("text"), "lens_text 2 30");
}

#[test]
fn the_plan_says_what_a_tolerance_chose_and_how_far_off_it_is() {
    let report = run("plan");
    assert_status(&report, "negative", PARAMETER, &["\"tolerance\" is -1", "0 (exact) or more"]);
    for what in ["length", "text", "cut"] {
        assert_status(&report, what, 0, &[]);
    }
    assert_eq!(report.one("lengths"), "1 1");
    assert_eq!(report.one("little"), "3");
    let lines = report.all("line");
    assert!(lines.iter().any(|line| line.starts_with("kept")), "{lines:?}");
    assert!(lines.iter().any(|line| line.starts_with("left out")), "{lines:?}");
    assert!(lines.iter().any(|line| line.contains("99.9 % of the rays are within")), "{lines:?}");
    assert!(report.one("log").starts_with("0 tolerance 0.5 pixels: "), "told as information");
}

#[test]
fn the_callback_gets_the_warnings_and_nothing_else() {
    let report = run("log");
    let logged = report.all("log");
    assert_eq!(report.number("calls"), 2.0);
    assert_eq!(logged.len(), 2, "{logged:?}");
    assert!(logged[0].starts_with("1 ") && logged[0].contains("aperture_diameter"), "{logged:?}");
    assert!(logged[1].starts_with("1 ") && logged[1].contains("\"disk\" misses"), "{logged:?}");
    assert_eq!(report.err, "", "nothing is printed");
}

#[test]
fn a_ray_with_differentials_is_three_rays() {
    let report = run("differentials");
    assert_eq!(report.one("differences"), "0 0 0 0");
    for what in ["many", "soa"] {
        assert_eq!(report.all(what), ["0 "], "{what}");
    }
    // Counts of rays by their neighbours: none, one to the right, one below, both; and the count of blocked rays.
    let counts: Vec<u32> = report.numbers("neighbours").into_iter().map(|count| count as u32).collect();
    assert_eq!(counts.iter().sum::<u32>(), 3000);
    assert!(counts[1] > 0 && counts[2] > 0 && counts[3] > 2000 && counts[4] > 0, "{counts:?}");
    assert_eq!(report.one("zero"), "0 0 0 0");
    assert_eq!(report.one("touched"), "0");
    assert_status(&report, "no-rx", NULL, &["request.rx_origin.x is NULL"]);
    assert_status(&report, "no-ry-dz", NULL, &["request.ry_direction.z is NULL"]);
    assert_status(&report, "size", SIZE, &["realistic_ray_differential.struct_size is 91", "92"]);
    assert_status(&report, "no-wavelengths", NULL, &["request.wavelength.x is NULL"]);
}

#[test]
fn every_kind_of_request_gives_the_same_bits() {
    let report = run("rays");
    for differences in report.all("differences") {
        assert_eq!(differences, "0 0 0 0 0 0");
    }
    for what in ["tight", "strides", "odd", "soa", "sparse"] {
        assert_eq!(report.all(what), ["0 "; 3], "{what}");
    }
    assert_eq!(report.all("sparse-weights"), ["0"; 3]);
    let counts: Vec<Vec<u32>> = report
        .all("reasons")
        .into_iter()
        .map(|line| line.split(' ').map(|word| word.parse().unwrap()).collect())
        .collect();
    // The reasons are ok, missed, clipped, reflected, turned back and redraw: each occurs.
    for reason in 0..6 {
        assert!(counts.iter().any(|count| count[reason] > 0), "{reason}: {counts:?}");
    }
    for count in &counts {
        assert_eq!(count.iter().sum::<u32>(), 3000);
    }
    // The area of a square is 4/π times that of its inscribed disk.
    assert!((f64::from(counts[1][5]) / 3000.0 - 0.2146).abs() < 0.02, "{counts:?}");
}

#[test]
fn null_foreign_and_empty_are_answered() {
    let report = run("null");
    assert_eq!(report.one("zero"), "0 0 0 0");
    assert_eq!(report.one("zero-plain"), "0 0 0 0");
    assert_eq!(report.all("touched"), ["0"]);
    assert_status(&report, "no-camera", NOT_OURS, &["no camera of this library"]);
    assert_status(&report, "foreign", NOT_OURS, &[]);
    assert_status(&report, "misaligned", NOT_OURS, &[]);
    assert_status(&report, "no-samples", NULL, &["request.image.x is NULL"]);
    assert_status(&report, "no-rays", NULL, &["request.origin.x is NULL"]);
    assert_status(&report, "no-weights", NULL, &["request.weight.x is NULL"]);
    // The structures overlap.
    assert_status(&report, "short-stride", PARAMETER, &["request.image.stride is 1", "at least 4 bytes"]);
    assert_status(&report, "short-ray", PARAMETER, &["request.origin.stride is 1", "at least 4 bytes"]);
    assert_status(&report, "overflow", PARAMETER, &["n is ", "no memory holds so many", "at a stride of"]);
    assert_eq!(report.one("kept"), "7");
    assert_status(&report, "none", 0, &[]);
    assert_status(&report, "soa-none", 0, &[]);
    assert_status(&report, "soa-no-camera", NOT_OURS, &[]);
    assert_status(&report, "soa-no-samples", NULL, &["request.image.x is NULL"]);
    assert_status(&report, "soa-no-rays", NULL, &["request.origin.x is NULL"]);
    assert_status(&report, "soa-no-lens-v", NULL, &["request.lens.y is NULL"]);
    assert_status(&report, "soa-no-dy", NULL, &["request.direction.y is NULL"]);
    assert!(report.one("free-foreign").contains("no camera of this library"));
}

#[test]
fn pointers_to_no_lens_are_refused() {
    let report = run("lens");
    assert_status(&report, "no-lens", NOT_A_LENS, &["no lens of this library"]);
    assert_status(&report, "null-lens", NOT_A_LENS, &["NULL"]);
    assert_eq!(report.one("kept"), "7");
}

#[test]
fn threads_share_a_camera_and_keep_their_own_last_error() {
    let report = run("threads");
    let threads = report.all("thread");
    assert_eq!(threads.len(), 4);
    for (number, line) in threads.iter().enumerate() {
        let (hash, message) = line.split_once(' ').unwrap();
        assert_eq!(hash, threads[0].split(' ').next().unwrap());
        assert!(message.contains(&format!("\"lens-of-thread-{number}\"")), "{message}");
    }
    assert_eq!(report.one("main"), "[]");
}

#[test]
fn the_header_compiles_twice_beside_a_hosts_own_types() {
    let text = "#include \"realistic.h\"\n#include \"realistic.h\"\n\
                struct Camera { int own; }; struct Sample { int own; }; struct Ray { int own; };\n\
                int main(void) { return (int)sizeof(struct Ray) - (int)sizeof(int); }\n";
    let directory = tempfile::tempdir().unwrap();
    for (define, text) in [("", text.to_owned()), ("entry", format!("#define REALISTIC_PBRT_ENTRY\n{text}"))]
    {
        for (extension, flags, compiler) in [("c", C99, c_compiler()), ("cpp", CXX11, compiler())] {
            let file = directory.path().join(format!("header{define}.{extension}"));
            std::fs::write(&file, &text).unwrap();
            compile_with(&compiler, &flags, &file, &format!("header_{extension}"), &[]);
        }
    }
}
