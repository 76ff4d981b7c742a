//! Run times on a machine that does other things, too.
//!
//! Every task is timed in pairs with one yardstick task, right after it, in rounds that go forward and
//! backward through the tasks; its time is the median of the ratios times the median of the
//! yardstick. Times are those for which this thread had the processor. A clock that drifts or a neighbour that
//! comes and goes changes both of a pair. Each measurement repeats its task until it lasts a given least time,
//! found in a warm-up.

use std::time::Duration;

use crate::clock::now;
use crate::statistics::{median, quantile};

/// How long to measure.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Pairs a task.
    pub rounds: usize,
    /// Least time of one measurement.
    pub least: Duration,
}

/// What one call of a task takes, seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// The median.
    pub median: f64,
    /// Lower quartile.
    pub low: f64,
    /// Upper quartile.
    pub high: f64,
}

/// A task and how often one measurement calls it.
struct Measured<'a> {
    task: &'a mut dyn FnMut(),
    calls: u32,
}

impl Measured<'_> {
    fn seconds(&mut self) -> f64 {
        let start = now();
        (0..self.calls).for_each(|_| (self.task)());
        (now() - start).as_secs_f64() / f64::from(self.calls)
    }

    /// Calls the task until the caches and the clock are warm and `calls` lasts long enough.
    fn warm_up(&mut self, least: Duration) {
        self.calls = 1;
        loop {
            let took = self.seconds() * f64::from(self.calls);
            if took >= least.as_secs_f64() {
                return;
            }
            let factor = (1.2 * least.as_secs_f64() / took.max(1e-9)).clamp(1.5, 100.0);
            self.calls = (f64::from(self.calls) * factor).ceil() as u32;
        }
    }
}

/// Times every task against the yardstick.
pub fn interleaved<'a>(
    yardstick: &'a mut dyn FnMut(),
    tasks: &'a mut [&'a mut dyn FnMut()],
    effort: Effort,
) -> Vec<Timing> {
    let mut yardstick = Measured { task: yardstick, calls: 1 };
    yardstick.warm_up(effort.least);
    let mut tasks: Vec<_> = tasks.iter_mut().map(|task| Measured { task: &mut **task, calls: 1 }).collect();
    tasks.iter_mut().for_each(|task| task.warm_up(effort.least));
    let mut standards = Vec::new();
    let mut ratios = vec![Vec::with_capacity(effort.rounds); tasks.len()];
    for round in 0..effort.rounds {
        for turn in 0..tasks.len() {
            let number = if round % 2 == 0 { turn } else { tasks.len() - 1 - turn };
            let standard = yardstick.seconds();
            ratios[number].push(tasks[number].seconds() / standard);
            standards.push(standard);
        }
    }
    let standard = median(&standards);
    let timing = |ratios: Vec<f64>| Timing {
        median: standard * median(&ratios),
        low: standard * quantile(&ratios, 0.25),
        high: standard * quantile(&ratios, 0.75),
    };
    ratios.into_iter().map(timing).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_task_is_called_and_gets_a_positive_time_between_its_quartiles() {
        let (mut a, mut b, mut c) = (0_u32, 0_u32, 0_u32);
        let effort = Effort { rounds: 3, least: Duration::from_micros(20) };
        let timings = interleaved(&mut || a += 1, &mut [&mut || b += 1, &mut || c += 1], effort);
        assert!(a > 6 && b > 3 && c > 3);
        assert_eq!(timings.len(), 2);
        for timing in timings {
            assert!(timing.low > 0.0 && timing.low <= timing.median && timing.median <= timing.high);
        }
    }
}
