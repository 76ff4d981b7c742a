//! Work at aspheres that the number of rays does not tell: how often a surface was evaluated for one ray by itself, where
//! the steps that all rays take leave it open. Such a ray may cost a hundred times another, so that whoever traces rays
//! until a budget is spent asks here, before and after.
//!
//! Counted, not timed, and the same on every processor. Of a thread, so that no ray has to hand a count on.

use std::cell::Cell;

thread_local! {
    static EVALUATIONS: Cell<u64> = const { Cell::new(0) };
}

/// How often that was so far on this thread.
pub fn evaluations() -> u64 {
    EVALUATIONS.get()
}

/// Counts evaluations that were done.
pub(super) fn count(evaluations: u32) {
    EVALUATIONS.set(EVALUATIONS.get() + u64::from(evaluations));
}
