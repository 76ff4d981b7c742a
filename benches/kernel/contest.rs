//! Interleaved timing.

use std::time::Instant;

/// Contestants that do the same amount of work, timed in turns.
pub struct Contest<'a> {
    work: usize,
    unit: &'static str,
    contestants: Vec<(String, Box<dyn FnMut() + 'a>)>,
}

impl<'a> Contest<'a> {
    /// Each call of a contestant does `work` pieces of it.
    pub fn new(work: usize, unit: &'static str) -> Self {
        Self { work, unit, contestants: Vec::new() }
    }

    pub fn enter(&mut self, name: &str, contestant: impl FnMut() + 'a) {
        self.contestants.push((name.to_owned(), Box::new(contestant)));
    }

    /// Enters what this processor can run.
    #[allow(dead_code)] // One of the benches has no use for it.
    pub fn enter_if(&mut self, name: &str, contestant: Option<impl FnMut() + 'a>) {
        if let Some(contestant) = contestant {
            self.enter(name, contestant);
        }
    }

    /// Prints each contestant's median and minimum, and how many times faster than the first it is. Returns the
    /// medians.
    pub fn run(mut self, rounds: usize) -> Vec<f64> {
        // A turn of a tenth of a millisecond or more; the clock and the first misses drown in it.
        const TURN: f64 = 2e-4;
        let mut turns: Vec<(usize, Vec<f64>)> = Vec::new();
        for (_, contestant) in &mut self.contestants {
            contestant();
            let start = Instant::now();
            contestant();
            let once = start.elapsed().as_secs_f64().max(1e-9);
            turns.push(((TURN / once).ceil().max(1.0) as usize, Vec::new()));
        }
        for _ in 0..rounds {
            for ((_, contestant), (repeats, times)) in self.contestants.iter_mut().zip(&mut turns) {
                contestant();
                let start = Instant::now();
                for _ in 0..*repeats {
                    contestant();
                }
                times.push(start.elapsed().as_secs_f64() * 1e9 / (*repeats * self.work) as f64);
            }
        }
        let mut reference = None;
        let mut medians = Vec::new();
        println!("| {} | median | least | times the first |\n|---|---|---|---|", self.unit);
        for ((name, _), (_, times)) in self.contestants.iter().zip(&mut turns) {
            times.sort_by(f64::total_cmp);
            let median = times[times.len() / 2];
            let first = *reference.get_or_insert(median);
            medians.push(median);
            println!("| {name} | {median:.2} | {:.2} | {:.2} |", times[0], first / median);
        }
        medians
    }
}
