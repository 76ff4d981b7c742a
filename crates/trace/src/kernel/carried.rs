//! Data that rays carry from surface to surface in addition to their geometry: the media at the wavelength of each ray,
//! and the remaining share of the ray's light.
//!
//! A kernel's loop is generic over [`Carried`]. [`Own`] carries nothing; it is for rays at the lens's own wavelength.
//! [`Dispersed`](super::dispersion::Dispersed) carries media. `light::Transmission` adds light to either of them;
//! without it, all light remains. [`OpticalPath`](super::optical_path::OpticalPath) carries the optical path.

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
    /// Returns the data of rays before the lens. `wavelengths`, nm, are arbitrary if the rays do not have their own
    /// wavelengths.
    fn start<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, wavelengths: L) -> Self::State<L>;
    /// Advances to the step of this number. Steps follow in order, from 0 on.
    fn go_to<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, number: usize, state: &mut Self::State<L>);
    /// Returns the media at the current step.
    fn media<L: Lanes<Scalar = S>>(&self, state: &Self::State<L>) -> Self::Media<L>;
    /// Takes note of the distance, in units of V, that rays have come from their origins to the vertex plane of the first
    /// surface, or to where they start.
    #[inline(always)]
    fn depart<L: Lanes<Scalar = S>>(&self, _: &mut Self::State<L>, _: L) {}
    /// Takes the data of rays across the surface of the current step.
    #[inline(always)]
    fn cross<L: Lanes<Scalar = S>>(&self, _: Cpu<L>, _: usize, _: &mut Self::State<L>, _: &Crossing<L>) {}
    /// Takes the data of rays to a frame that is turned by a rotation, given by rows.
    #[inline(always)]
    fn enter_frame<L: Lanes<Scalar = S>>(&self, _: Cpu<L>, _: &mut Self::State<L>, _: &[[S; 3]; 3]) {}
    /// Takes the data of rays to the frame behind a mirror, whose z axis is reversed.
    #[inline(always)]
    fn turn_round<L: Lanes<Scalar = S>>(&self, _: Cpu<L>, _: &mut Self::State<L>) {}
    /// Returns n² before and behind the surface of the current step, and the wavelengths, nm, if each ray has its own
    /// wavelength.
    #[inline(always)]
    fn light<L: Lanes<Scalar = S>>(&self, _: &Self::State<L>) -> Option<([L; 2], L)> {
        None
    }
    /// Returns n of the medium before the first surface, to which all other indices are relative. `None` if that medium
    /// is air, or if the rays do not have their own wavelengths.
    #[inline(always)]
    fn first_index<L: Lanes<Scalar = S>>(&self, _: Cpu<L>, _: &Self::State<L>) -> Option<L> {
        None
    }
    /// Returns the ratio of the last medium's index at the lens's own wavelength to that at the wavelength of each ray,
    /// behind the last surface; `None` if all ratios are 1.
    #[inline(always)]
    fn per_last_index<L: Lanes<Scalar = S>>(&self, _: Cpu<L>, _: &Self::State<L>) -> Option<L> {
        None
    }
    /// Returns the optical path of the rays from their origins to the last surface, mm, if they carry it.
    #[inline(always)]
    fn optical_path<L: Lanes<Scalar = S>>(&self, _: Cpu<L>, _: &Self::State<L>) -> Option<L> {
        None
    }
    /// Returns the share of the light that remains, times the change of the radiance factor (n'/n)² of the media at both
    /// ends from the lens's own wavelength.
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
