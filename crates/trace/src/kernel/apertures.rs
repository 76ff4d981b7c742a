//! Treatment of rays at apertures. Rays outside an aperture are either blocked ([`Blocking`]) or traced further. In the
//! second case, the kernel records how near to an edge each ray passes, inside or outside ([`Nearest`]). The same loop
//! traces rays through a lens in both cases.

use realistic_base::numeric::Real;
use realistic_simd::{Cpu, Lanes};

/// The treatment of a vector of rays at apertures.
pub trait Apertures<L: Lanes>: Copy {
    /// Whether rays outside an aperture are blocked.
    const BLOCK: bool;
    /// Returns the state of rays that have met no aperture yet.
    fn new(cpu: Cpu<L>) -> Self;
    /// Handles rays at the squared distance `height_squared` from the axis; `aperture` is the square of the aperture's
    /// radius. Both may be scaled by the same positive number. `passed` marks the rays that have not been blocked so
    /// far. Returns the subset of these rays that is traced further.
    fn meet(&mut self, cpu: Cpu<L>, passed: L::Mask, height_squared: L, aperture: L) -> L::Mask;
    /// Returns the rays that must be traced at any cost; `None` means all rays.
    fn worth(&self, cpu: Cpu<L>) -> Option<L::Mask>;
}

/// Treatment that blocks rays outside an aperture.
#[derive(Clone, Copy)]
pub struct Blocking;

impl<L: Lanes> Apertures<L> for Blocking {
    const BLOCK: bool = true;

    #[inline(always)]
    fn new(_: Cpu<L>) -> Self {
        Self
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn meet(&mut self, _: Cpu<L>, passed: L::Mask, height_squared: L, aperture: L) -> L::Mask {
        L::both(passed, height_squared.less_equal(aperture))
    }

    #[inline(always)]
    fn worth(&self, _: Cpu<L>) -> Option<L::Mask> {
        None
    }
}

/// Treatment that records how near each ray passes to the edge of an aperture, inside or outside.
#[derive(Clone, Copy)]
pub struct Nearest<L> {
    /// The largest ratio, over all apertures, of the squared distance of the ray from the axis to that of the
    /// aperture's edge.
    pub ratio: L,
}

/// Squared ratio, as in [`Nearest::ratio`], above which rays that the lanes leave open are no longer passed to the
/// walk. Such rays count as lost, which suffices for a search for edges.
const WORTH: f64 = 1.2 * 1.2;

impl<L: Lanes<Scalar = f64>> Apertures<L> for Nearest<L> {
    const BLOCK: bool = false;

    #[inline(always)]
    fn new(cpu: Cpu<L>) -> Self {
        Self { ratio: L::splat(cpu, f64::ZERO) }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn meet(&mut self, _: Cpu<L>, passed: L::Mask, height_squared: L, aperture: L) -> L::Mask {
        let ratio = height_squared / aperture;
        self.ratio = L::select(L::both(passed, self.ratio.less(ratio)), ratio, self.ratio);
        passed
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn worth(&self, cpu: Cpu<L>) -> Option<L::Mask> {
        Some(self.ratio.less_equal(L::splat(cpu, WORTH)))
    }
}
