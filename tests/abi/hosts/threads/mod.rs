//! A host that forks while its threads are at work, and one whose threads have small stacks.

use super::harness;

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use harness::{Report, Run, c_compiler, compile_with};

fn run(arguments: &[&str]) -> Report {
    static HOST: OnceLock<PathBuf> = OnceLock::new();
    let host = HOST.get_or_init(|| {
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/abi/hosts/threads/threads_host.c");
        let flags = ["-std=gnu99", "-Wall", "-Wextra", "-Werror", "-O1", "-g"];
        compile_with(&c_compiler(), &flags, &source, "threads_host", &["-ldl", "-lpthread"])
    });
    let (action, more) = arguments.split_first().expect("an action");
    Run::bare(host, &harness::plugin(), action).with_all(more).run()
}

#[test]
fn a_child_forked_while_a_thread_builds_a_table_builds_its_own() {
    let mut early = 0.0;
    for action in ["importance", "wavelengths"] {
        let report = run(&[action]);
        assert_eq!(report.all("child"), [""; 0], "{action}: it waits for a thread that it does not have");
        early += report.number("early");
        for answers in report.all("answers") {
            let (thread, child) = answers.split_once(' ').expect("two answers");
            assert!(thread == child && thread.parse::<f64>().is_ok_and(|answer| answer > 0.0), "{answers}");
        }
    }
    assert!(early >= 1.0, "no child was forked in time");
}

#[test]
fn a_stack_of_128_kilobytes_is_enough() {
    let lenses = ["dgauss.50mm", "phone.4mm"];
    let report = run(&[&["stack", "131072"][..], &lenses].concat());
    let done = lenses.map(|lens| format!("{lens} 1"));
    assert_eq!(report.all("done"), done.each_ref().map(String::as_str));
}
