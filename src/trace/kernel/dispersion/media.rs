//! What a step asks of the media before and behind its surface: those of the lens's own wavelength, whose numbers the table
//! has ready ([`Own`]), or those of each lane's ([`AtWavelengths`]), for which the table has its numbers per n².

use super::super::lanes::{Cpu, Lanes};

/// The media at a surface.
pub trait Media<L: Lanes>: Copy {
    /// A product of the table's numbers times n².
    fn times_square(self, number: L) -> L;
    /// A number of the table over n².
    fn per_square(self, cpu: Cpu<L>, number: L::Scalar) -> L;
    /// n'² - n², `own` being that of the lens's own wavelength.
    fn index_step(self, cpu: Cpu<L>, own: L::Scalar) -> L;
    /// The lesser of (n cos I)² and (n' cos I')², where the lens's own wavelength has `rarer`: n' < n.
    fn lesser(self, rarer: bool, before: L, after: L) -> L;
}

/// The media of vectors of rays on their way.
pub trait MediaOnWay<L: Lanes> {
    /// Those at a surface.
    type Media: Media<L>;
    /// Goes on to the step of this number. Steps follow in their order, from 0 on.
    fn go_to(&mut self, cpu: Cpu<L>, number: usize);
    /// Those at that step of the vector at a place.
    fn media(&self, vector: usize) -> Self::Media;
}

/// Media of the lens's own wavelength.
#[derive(Clone, Copy)]
pub struct Own;

impl<L: Lanes> Media<L> for Own {
    #[inline(always)]
    fn times_square(self, number: L) -> L {
        number
    }

    #[inline(always)]
    fn per_square(self, cpu: Cpu<L>, number: L::Scalar) -> L {
        L::splat(cpu, number)
    }

    #[inline(always)]
    fn index_step(self, cpu: Cpu<L>, own: L::Scalar) -> L {
        L::splat(cpu, own)
    }

    #[inline(always)]
    fn lesser(self, rarer: bool, before: L, after: L) -> L {
        if rarer { after } else { before }
    }
}

impl<L: Lanes> MediaOnWay<L> for Own {
    type Media = Self;

    #[inline(always)]
    fn go_to(&mut self, _: Cpu<L>, _: usize) {}

    #[inline(always)]
    fn media(&self, _: usize) -> Self {
        Self
    }
}

/// Media of a wavelength per lane.
#[derive(Clone, Copy)]
pub struct AtWavelengths<L> {
    /// n² before the surface.
    pub square: L,
    /// 1/n².
    pub inverse: L,
    /// By how much n'² - n² is more than at the lens's own wavelength.
    pub change: L,
}

impl<L: Lanes> Media<L> for AtWavelengths<L> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn times_square(self, number: L) -> L {
        number * self.square
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn per_square(self, cpu: Cpu<L>, number: L::Scalar) -> L {
        self.inverse * L::splat(cpu, number)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn index_step(self, cpu: Cpu<L>, own: L::Scalar) -> L {
        self.change + L::splat(cpu, own)
    }

    /// The two media may change places from one wavelength to another.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn lesser(self, _: bool, before: L, after: L) -> L {
        before.smaller(after)
    }
}
