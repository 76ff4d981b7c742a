//! What becomes of rays at apertures: blocked where they pass one outside ([`Blocking`]), or followed on, with note taken of how
//! near they come to being blocked, or how far beyond ([`Nearest`]). One loop takes rays through a lens either way.

use super::lanes::{Cpu, Lanes};
use crate::numeric::Real;

/// What a vector of rays does at apertures.
pub trait Apertures<L: Lanes>: Copy {
    /// Whether rays outside an aperture are blocked.
    const BLOCK: bool;
    /// Of rays that have met no aperture.
    fn new(cpu: Cpu<L>) -> Self;
    /// Rays at this squared distance from the axis, where that of the aperture's edge is `aperture`, both times any positive
    /// number. Which of `passed`, those that came here, go on.
    fn meet(&mut self, cpu: Cpu<L>, passed: L::Mask, height_squared: L, aperture: L) -> L::Mask;
    /// Which rays are to be traced at any cost; `None`: all.
    fn worth(&self, cpu: Cpu<L>) -> Option<L::Mask>;
}

/// Rays outside an aperture are blocked.
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

/// How near each ray comes to an aperture's edge, or how far outside one it passes.
#[derive(Clone, Copy)]
pub struct Nearest<L> {
    /// The largest square of the ray's distance from the axis over that of an aperture's edge.
    pub ratio: L,
}

/// The ratio, squared as [`Nearest::ratio`] is, from which on rays that lanes leave open are no longer walked: they count as
/// lost, which is all that a search of edges asks of them.
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
