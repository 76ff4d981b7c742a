//! Data that rays carry from surface to surface beside their geometry: the media at a wavelength of their own, and the
//! share of their light that remains.
//!
//! A kernel's loop is generic over [`Carried`]. [`Own`] carries nothing: rays at the lens's own wavelength.
//! [`Dispersed`](super::dispersion::Dispersed) carries media. `light::Transmission` adds light to either of them;
//! without it all light remains.

use super::{
    dispersion::{Media, Own},
    ray_lanes::Crossing,
};
use realistic_simd::{Cpu, Lanes, Scalar};

/// Constants of a lens for the data that its rays carry.
pub trait Carried<S: Scalar> {
    /// The data of a vector of rays.
    type State<L: Lanes<Scalar = S>>: Copy;
    /// The media at a surface.
    type Media<L: Lanes<Scalar = S>>: Media<L>;
    /// Returns the data of rays before the lens. `wavelengths`, nm, are arbitrary if rays have none of their own.
    fn start<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, wavelengths: L) -> Self::State<L>;
    /// Advances to the step of this number. Steps follow in order, from 0 on.
    fn go_to<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, number: usize, state: &mut Self::State<L>);
    /// Returns the media at that step.
    fn media<L: Lanes<Scalar = S>>(&self, state: &Self::State<L>) -> Self::Media<L>;
    /// Takes rays across the surface of that step.
    #[inline(always)]
    fn cross<L: Lanes<Scalar = S>>(&self, _: Cpu<L>, _: usize, _: &mut Self::State<L>, _: &Crossing<L>) {}
    /// Returns n² before and behind the surface of that step and the wavelengths, nm, if rays have wavelengths of
    /// their own.
    #[inline(always)]
    fn light<L: Lanes<Scalar = S>>(&self, _: &Self::State<L>) -> Option<([L; 2], L)> {
        None
    }
    /// Returns the share of the light that remains.
    #[inline(always)]
    fn left<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, _: &Self::State<L>) -> L {
        L::splat(cpu, S::ONE)
    }
}

impl<S: Scalar> Carried<S> for Own {
    type State<L: Lanes<Scalar = S>> = ();
    type Media<L: Lanes<Scalar = S>> = Self;

    #[inline(always)]
    fn start<L: Lanes<Scalar = S>>(&self, _: Cpu<L>, _: L) {}

    #[inline(always)]
    fn go_to<L: Lanes<Scalar = S>>(&self, _: Cpu<L>, _: usize, (): &mut ()) {}

    #[inline(always)]
    fn media<L: Lanes<Scalar = S>>(&self, (): &()) -> Self {
        Self
    }
}
