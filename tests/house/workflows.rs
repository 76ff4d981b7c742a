//! The public forge's workflows contain no commands of their own: each job runs a script that is also run by `.ci/run`.

use std::{fs, path::Path};

#[test]
fn every_job_of_a_workflow_runs_a_script_of_ci_run() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let everything = fs::read_to_string(root.join(".ci/run")).expect("the script");
    let mut jobs = 0;
    for workflow in fs::read_dir(root.join(".github/workflows")).expect("a directory").flatten() {
        let text = fs::read_to_string(workflow.path()).expect("text");
        let (_, text) = text.split_once("\njobs:\n").expect("jobs");
        // A job's name is indented by two spaces, and its contents by more.
        let starts =
            text.match_indices("\n  ").filter(|(at, _)| !text[at + 3..].starts_with(' ')).map(|(at, _)| at);
        let starts: Vec<usize> = std::iter::once(0).chain(starts).chain([text.len()]).collect();
        for job in starts.windows(2).map(|pair| &text[pair[0]..pair[1]]).filter(|job| job.contains("runs-on"))
        {
            let scripts: Vec<&str> =
                job.lines().filter_map(|line| line.trim().strip_prefix("- run: .ci/")).collect();
            let [script] = scripts.as_slice() else { panic!("not one script in:\n{job}") };
            assert!(root.join(".ci").join(script).is_file(), ".ci/{script} is not there");
            assert!(
                *script == "run" || everything.contains(&format!(".ci/{script}")),
                ".ci/run has no {script}"
            );
            jobs += 1;
        }
    }
    assert!(jobs >= 5, "only {jobs} jobs");
}
