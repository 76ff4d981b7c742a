//! Hosts with a non-default floating-point environment: trapped exceptions, observed flags, other rounding modes.

use super::harness;

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use harness::{Abi, C99, Report, Run, c_compiler, compile_with, installed};

fn run(action: &str, rays: &str) -> Report {
    static HOST: OnceLock<PathBuf> = OnceLock::new();
    let host = HOST.get_or_init(|| {
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/abi/hosts/float_host.c");
        compile_with(&c_compiler(), &C99, &source, "float_host", &["-ldl", "-lm"])
    });
    Run::bare(host, &harness::plugin(), action).with(rays).run()
}

#[track_caller]
fn untouched(report: &Report) {
    assert_eq!([report.number("control"), report.number("flags")], [0.0; 2]);
    assert!(report.number("blocked") > 1000.0 && report.number("passed") > 1000.0, "{report:?}");
}

#[test]
fn a_host_in_which_exceptions_trap_lives() {
    let report = run("traps", "3000");
    untouched(&report);
    assert_eq!(report.one("traps"), "1");
}

#[test]
fn a_hosts_floating_point_flags_are_its_own() {
    let report = run("flags", "3000");
    untouched(&report);
    assert_eq!(report.one("kept"), "1");
}

#[test]
fn rounding_and_subnormal_numbers_are_the_hosts_own_business() {
    let report = run("modes", "0");
    let expected = report.one("nearest").to_owned();
    for name in ["down", "up", "zero", "flushed", "flushed-zero"] {
        assert_eq!(report.one(name), expected, "{name}");
    }
    assert!(expected.ends_with(" 1"));
}

#[test]
fn a_pbrt_host_in_which_exceptions_trap_renders() {
    let (_directory, plugin) = installed("realistic.so");
    for model in ["lens", "thick", "perspective", "environment"] {
        // The rear element's disk is wider than the pupil: most rays are blocked, and the host receives substitute
        // rays.
        let model = format!("string:model={model}");
        let arguments = ["traps=1", "string:pupil=rear", &model];
        let report = Run::bare(harness::host(Abi::New), &plugin, "render").with_all(arguments).run();
        assert_eq!(report.number("bad"), 0.0);
        assert_eq!(report.number("zero"), 0.0);
        report.ended();
    }
}
