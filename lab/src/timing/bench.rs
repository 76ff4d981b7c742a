//! Tasks timed in turns.
//!
//! Each task is timed in pairs with the first task, right after it, in rounds that alternate between forward and
//! backward order. The time of a task is the median of its ratios to the first task times the median of the first
//! task's times. All times are CPU times of this thread. A drifting clock rate or a temporary load affects both
//! measurements of a pair. In each measurement, the task is repeated for at least a given time; a warm-up determines
//! the number of repetitions.

use std::time::Duration;

use super::clock::now;
use crate::results::statistics::{median, quantile};

/// Duration of a timing.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Pairs per task.
    pub rounds: usize,
    /// Minimum time of one measurement.
    pub least: Duration,
}

/// Time of one call of a task, seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// The median.
    pub median: f64,
    /// Lower quartile.
    pub low: f64,
    /// Upper quartile.
    pub high: f64,
}

impl Timing {
    /// Returns the time of one part, if a call consists of `count` equal parts.
    pub fn per(self, count: usize) -> Self {
        let [median, low, high] = [self.median, self.low, self.high].map(|time| time / count as f64);
        Self { median, low, high }
    }
}

/// A task and the number of calls per measurement.
struct Repeated<'a> {
    task: Box<dyn FnMut() + 'a>,
    calls: u32,
}

impl<'a> Repeated<'a> {
    /// Calls the task until the caches and the clock rate are warm and a measurement lasts long enough.
    fn warmed_up(task: Box<dyn FnMut() + 'a>, least: Duration) -> Self {
        let mut own = Self { task, calls: 1 };
        loop {
            let took = own.seconds() * f64::from(own.calls);
            if took >= least.as_secs_f64() {
                return own;
            }
            let factor = (1.2 * least.as_secs_f64() / took.max(1e-9)).clamp(1.5, 100.0);
            own.calls = (f64::from(own.calls) * factor).ceil() as u32;
        }
    }

    fn seconds(&mut self) -> f64 {
        let start = now();
        (0..self.calls).for_each(|_| (self.task)());
        (now() - start).as_secs_f64() / f64::from(self.calls)
    }
}

/// Times every task against the first, which is also timed against itself; without tasks, returns no timings.
pub fn interleaved<'a>(
    tasks: impl IntoIterator<Item = Box<dyn FnMut() + 'a>>,
    effort: Effort,
) -> Vec<Timing> {
    interleaved_within(tasks, effort, Duration::MAX)
}

/// Times tasks as [`interleaved`] does, but starts no further round after `most`; runs at least one round.
pub fn interleaved_within<'a>(
    tasks: impl IntoIterator<Item = Box<dyn FnMut() + 'a>>,
    effort: Effort,
    most: Duration,
) -> Vec<Timing> {
    let start = now();
    let mut tasks: Vec<_> = tasks.into_iter().map(|task| Repeated::warmed_up(task, effort.least)).collect();
    let mut standards = Vec::new();
    let mut ratios = vec![Vec::with_capacity(effort.rounds); tasks.len()];
    for round in 0..effort.rounds {
        if round > 0 && now() - start > most {
            break;
        }
        for turn in 0..tasks.len() {
            let number = if round % 2 == 0 { turn } else { tasks.len() - 1 - turn };
            let standard = tasks[0].seconds();
            ratios[number].push(tasks[number].seconds() / standard);
            standards.push(standard);
        }
    }
    let standard = median(&standards);
    let timing = |ratios: Vec<f64>| {
        let [low, median, high] = [0.25, 0.5, 0.75].map(|q| standard * quantile(&ratios, q));
        Timing { median, low, high }
    };
    ratios.into_iter().map(timing).collect()
}

/// Calls a task `times` (1 or more) times, and returns its last result and the seconds of every call.
pub fn repeated<T>(times: usize, mut task: impl FnMut() -> T) -> (T, Vec<f64>) {
    let mut seconds = Vec::with_capacity(times);
    let mut timed = || {
        let start = now();
        let result = task();
        seconds.push((now() - start).as_secs_f64());
        result
    };
    let mut last = timed();
    (1..times).for_each(|_| last = timed());
    (last, seconds)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_task_gets_a_positive_time_between_its_quartiles() {
        let (mut a, mut b) = (0_u32, 0_u32);
        let effort = Effort { rounds: 3, least: Duration::from_micros(20) };
        let tasks: [Box<dyn FnMut() + '_>; 2] = [Box::new(|| a += 1), Box::new(|| b += 1)];
        let timings = interleaved(tasks, effort);
        assert!(a > 6 && b > 3);
        assert_eq!(timings.len(), 2);
        for timing in timings {
            assert!(timing.low > 0.0 && timing.low <= timing.median && timing.median <= timing.high);
        }
        assert!(interleaved([], effort).is_empty());
    }

    #[test]
    fn every_call_is_timed() {
        let mut calls = 0;
        let (last, seconds) = repeated(3, || {
            calls += 1;
            calls
        });
        assert_eq!((last, seconds.len()), (3, 3));
        assert!(seconds.iter().all(|&time| time >= 0.0));
    }
}
