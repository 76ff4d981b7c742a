//! A bound on the work of building a camera's ghosts. The unit is the work for one ray, with its light, at one surface:
//! some 50 ns. No lens exceeds the bound, however many surfaces, aspheres or layers it has.

use std::cell::Cell;

/// The remaining work.
#[derive(Debug)]
pub(super) struct Work {
    left: Cell<u64>,
}

thread_local! {
    static SPENT: Cell<u64> = const { Cell::new(0) };
}

/// Returns the units of work spent on this thread so far, for tests of the bound.
pub fn work_spent() -> u64 {
    SPENT.get()
}

/// Number of surfaces that rays traced in lanes, without their light, intersect in the time of one unit.
const SIDE_BY_SIDE: u64 = 24;

impl Work {
    /// Returns a budget of the given units.
    pub fn new(units: u64) -> Self {
        Self { left: Cell::new(units) }
    }

    /// Spends units. Returns whether so many units were left.
    pub fn spend(&self, units: u64) -> bool {
        let left = self.left.get().checked_sub(units);
        SPENT.set(SPENT.get().saturating_add(if left.is_some() { units } else { 0 }));
        self.left.set(left.unwrap_or(0));
        left.is_some()
    }

    /// Spends the work of rays that are traced in lanes without their light, as [`Work::spend`] does. A ray intersects
    /// `each` surfaces ([`realistic_optics::trace::Path::work`]).
    pub fn spend_rays(&self, rays: usize, each: usize) -> bool {
        self.spend((rays as u64).saturating_mul(each as u64) / SIDE_BY_SIDE)
    }

    /// Returns whether some work is left.
    pub fn is_left(&self) -> bool {
        self.left.get() > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_spent_is_spent() {
        let work = Work::new(100);
        assert!(work.spend(60) && work.spend_rays(24, 30) && work.is_left());
        assert!(!work.spend(11) && !work.is_left() && !work.spend(1));
        assert!(!Work::new(5).spend_rays(usize::MAX, usize::MAX));
    }
}
