//! A host whose memory runs out, and a count of the allocations by rays.

use super::harness;

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use harness::{C99, Report, Run, c_compiler, compile_with};

fn run(action: &str) -> Report {
    static HOST: OnceLock<PathBuf> = OnceLock::new();
    let host = HOST.get_or_init(|| {
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/abi/hosts/memory/memory_host.c");
        // The host exports its counting functions, so that they take precedence over the C library's functions in the
        // plugin, too.
        let flags: Vec<&str> = C99.into_iter().chain(["-rdynamic", "-fno-builtin"]).collect();
        compile_with(&c_compiler(), &flags, &source, "memory_host", &["-ldl"])
    });
    Run::bare(host, &harness::plugin(), action).run()
}

#[test]
fn a_host_whose_memory_is_out_gets_an_error_and_lives() {
    const MEMORY: &str = "9";
    let report = run("out");
    let (mut built, mut refused) = (0, 0);
    for line in report.all("built") {
        let [kilobytes, status, has_camera] = line.split(' ').collect::<Vec<_>>()[..] else {
            panic!("{line}");
        };
        assert!(["0", MEMORY].contains(&status) && (has_camera == "1") == (status == "0"), "{line}");
        // The limit rises from too little memory to build a camera to enough memory.
        assert!(kilobytes != "0" || status == MEMORY, "{line}");
        assert!(kilobytes != "65536" || status == "0", "{line}");
        *(if status == "0" { &mut built } else { &mut refused }) += 1;
    }
    assert!(built >= 1 && refused >= 20, "{built} built, {refused} refused");
    assert!(report.all("said").iter().all(|message| message.contains("memory is out")));
}

#[test]
fn a_ray_allocates_nothing() {
    let report = run("count");
    assert_eq!(report.all("allocations"), ["0"; 4]);
    assert!(report.number("all") > 100.0, "what building allocates is counted");
}
