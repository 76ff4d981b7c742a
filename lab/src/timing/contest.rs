//! A bench's table: contestants that do the same amount of work, and their times in Markdown.

use std::time::Duration;

use super::bench::{Effort, Timing, interleaved};

/// Contestants that do the same amount of work, timed in turns against the first.
#[derive(Default)]
pub struct Contest<'a> {
    names: Vec<String>,
    tasks: Vec<Box<dyn FnMut() + 'a>>,
}

impl<'a> Contest<'a> {
    /// Adds a contestant, unless this processor cannot run it.
    pub fn enter(&mut self, name: impl Into<String>, task: impl Into<Option<Box<dyn FnMut() + 'a>>>) {
        if let Some(task) = task.into() {
            self.names.push(name.into());
            self.tasks.push(task);
        }
    }

    /// Prints each contestant's median and lower quartile of the time per unit of work, in ns, and its speed-up over
    /// the first contestant; each contestant does `work` units. Returns the times per unit.
    pub fn print(self, unit: &str, work: usize, effort: Effort) -> Vec<Timing> {
        println!("| {unit} | median | lower quartile | times the first |\n|---|---|---|---|");
        let timings: Vec<Timing> =
            interleaved(self.tasks, effort).into_iter().map(|timing| timing.per(work)).collect();
        for (name, timing) in self.names.iter().zip(&timings) {
            let times = timings[0].median / timing.median;
            println!("| {name} | {:.2} | {:.2} | {times:.2} |", timing.median * 1e9, timing.low * 1e9);
        }
        timings
    }
}

/// Lenses of realistic size that supplement the catalogue: each has a name and a lens file, which states its source. Of
/// 1,300 patent lenses in an open collection, half have at most 21 interfaces, and nine in ten at most 33.
pub const LARGE_LENSES: [(&str, &str); 2] = [
    ("21 interfaces", concat!(env!("CARGO_MANIFEST_DIR"), "/../benches/lenses/split-gauss-21.dat")),
    ("33 interfaces", concat!(env!("CARGO_MANIFEST_DIR"), "/../benches/lenses/split-gauss-33.dat")),
];

/// Command-line arguments of a bench: `--test` for a minimal run, and a part of a lens's name.
#[derive(Clone, Debug)]
pub struct BenchArguments {
    /// Duration of the timing.
    pub effort: Effort,
    filter: Option<String>,
}

impl BenchArguments {
    /// Parses the command line; `rounds` applies to a full run.
    pub fn from_command_line(rounds: usize) -> Self {
        let arguments: Vec<_> = std::env::args().skip(1).collect();
        let rounds = if arguments.iter().any(|argument| argument == "--test") { 1 } else { rounds };
        Self {
            effort: Effort { rounds, least: Duration::from_micros(200) },
            filter: arguments.into_iter().find(|argument| !argument.starts_with('-')),
        }
    }

    /// Whether the arguments select a lens.
    pub fn wants(&self, lens: &str) -> bool {
        self.filter.as_ref().is_none_or(|filter| lens.contains(filter.as_str()))
    }
}
