//! The media before and behind a surface, as a step uses them: either at the lens's own wavelength, with constants from
//! the table ([`Own`]), or at the wavelength of each lane, with a table whose constants are per n² ([`AtWavelengths`]).

use realistic_simd::{Cpu, Lanes};

/// The media at a surface.
pub trait Media<L: Lanes>: Copy {
    /// Returns `number`, which is proportional to the table's constants, times n² if the constants are per n².
    fn times_square(self, number: L) -> L;
    /// Returns a constant of the table, divided by n² if the constants are per n².
    fn per_square(self, cpu: Cpu<L>, number: L::Scalar) -> L;
    /// Returns n'² - n²; `own` is its value at the lens's own wavelength.
    fn index_step(self, cpu: Cpu<L>, own: L::Scalar) -> L;
    /// Returns the lesser of (n cos I)² and (n' cos I')². `rarer` is whether n' < n at the lens's own wavelength.
    fn lesser(self, rarer: bool, before: L, after: L) -> L;
}

/// Media at the lens's own wavelength.
#[derive(Clone, Copy, Debug)]
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

/// Media at the wavelength of each lane.
#[derive(Clone, Copy)]
pub struct AtWavelengths<L> {
    /// n² before the surface.
    pub square: L,
    /// 1/n².
    pub inverse: L,
    /// Change of n'² - n² from the lens's own wavelength.
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

    /// Takes the minimum, because which medium is rarer may depend on the wavelength.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn lesser(self, _: bool, before: L, after: L) -> L {
        before.smaller(after)
    }
}
