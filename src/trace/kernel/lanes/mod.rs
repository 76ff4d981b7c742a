//! The vector that the algorithm is written over.
//!
//! Every operation is correctly rounded (IEEE 754), fused multiply-add included, so an algorithm
//! over [`Lanes`] gives the same bits in every instance of one precision.

#[cfg(target_arch = "x86_64")]
pub mod avx2;
#[cfg(target_arch = "x86_64")]
pub mod avx512;
mod portable;
mod scalar;
mod unrolled;

use std::{
    marker::PhantomData,
    ops::{Add, Div, Mul, Sub},
};

pub use portable::Portable;
pub use scalar::Scalar;
pub(in crate::trace) use unrolled::each_further;

use super::simd::Compiled;

/// The knowledge that this processor has the instructions of `L`, without which no vector is made.
pub struct Cpu<L>(PhantomData<fn() -> L>);

impl<L> Clone for Cpu<L> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<L> Copy for Cpu<L> {}

impl<L> Cpu<L> {
    /// States that the processor has them.
    ///
    /// # Safety
    /// It does. For speed, but not for safety, what uses the vectors is inlined into a function
    /// compiled for those instructions.
    #[inline(always)]
    pub unsafe fn assume() -> Self {
        Self(PhantomData)
    }
}

/// A vector of `WIDTH` numbers.
pub trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// What it is made of.
    type Scalar: Scalar;
    /// A truth value for each lane.
    type Mask: Copy;
    /// A place in a table for each lane.
    type Places;
    /// How many lanes.
    const WIDTH: usize;

    /// The same number in every lane.
    fn splat(cpu: Cpu<Self>, number: Self::Scalar) -> Self;
    /// The first `WIDTH` numbers, with zeros where there are fewer.
    fn load(cpu: Cpu<Self>, from: &[Self::Scalar]) -> Self;
    /// Writes the first lanes, as many as there is room for.
    fn store(self, to: &mut [Self::Scalar]);
    /// `self * b + c`, rounded once.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// `self * b - c`, rounded once.
    fn mul_sub(self, b: Self, c: Self) -> Self;
    /// `c - self * b`, rounded once.
    fn neg_mul_add(self, b: Self, c: Self) -> Self;
    /// The square roots of two vectors; NaN below 0. Of numbers at most [`Scalar::NO_SQUARE`] above
    /// 0, of 0 and of infinity it may be NaN.
    fn sqrt_pair(a: Self, b: Self) -> [Self; 2];
    /// The square root; NaN below 0.
    fn sqrt(self) -> Self;
    /// Without the sign.
    fn abs(self) -> Self;
    /// Without the digits behind the point.
    fn trunc(self) -> Self;
    /// The larger of the two; `b` where either is NaN.
    fn larger(self, b: Self) -> Self;
    /// The smaller of the two; `b` where either is NaN.
    fn smaller(self, b: Self) -> Self;
    /// `self < b`, false for NaN.
    fn less(self, b: Self) -> Self::Mask;
    /// `self <= b`, false for NaN.
    fn less_equal(self, b: Self) -> Self::Mask;
    /// Lanes true in both.
    fn both(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// `yes` where the mask is true, else `no`.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// The number where the mask is true, else +0.
    fn or_zero(self, mask: Self::Mask) -> Self;
    /// The lanes where the mask is true as bits, the first lowest.
    fn bits(mask: Self::Mask) -> u32;

    /// [`Lanes::load`] of single-precision numbers.
    fn load_single(cpu: Cpu<Self>, from: &[f32]) -> Self;
    /// [`Lanes::store`] rounded to single precision.
    fn store_single(self, to: &mut [f32]);
    /// [`Lanes::store_single`] of the lanes where the mask is true.
    fn store_single_where(self, mask: Self::Mask, to: &mut [f32]);
    /// Two pairs of a table one after the other for each lane, `K` times: as vectors of their numbers. The first
    /// pair is `STEP` (1 or 2) times the whole part of `at` and `K` numbers more; where there is none, any. By loads
    /// and shuffles: the instructions that gather are slow on some processors.
    ///
    /// # Panics
    /// The table has not so many pairs that there is one for `at` = 0.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn look_up<const K: usize, const STEP: usize>(
        table: &[[f32; 2]],
        at: Self,
        further: [usize; K],
    ) -> [[Self; 4]; K] {
        let places = at.places::<STEP>(last_place(table, further));
        let (mut found, mut k) = ([[at; 4]; K], 0);
        while k < K {
            // SAFETY: up to the last place, and `further` on, the table has two pairs.
            found[k] = unsafe { Self::pairs(table.as_ptr().add(further[k]), &places) };
            k += 1;
        }
        found
    }
    /// `STEP` (1 or 2) times the whole parts, or `last` where that is less; of what has no whole part up to 2^31, any place
    /// up to `last`.
    fn places<const STEP: usize>(self, last: usize) -> Self::Places;
    /// Two pairs of a table at each place: as vectors of their numbers.
    ///
    /// # Safety
    /// There are two pairs from each place on.
    unsafe fn pairs(table: *const [f32; 2], places: &Self::Places) -> [Self; 4];

    /// Does work in a function of its own, compiled for these vectors' instructions once for all who call it. Where
    /// vectors have no instructions of their own, it is inlined.
    fn apart(cpu: Cpu<Self>, work: impl Compiled);

    /// Whether the mask is true in every lane.
    #[inline(always)]
    fn all(mask: Self::Mask) -> bool {
        Self::bits(mask) == u32::MAX >> (32 - Self::WIDTH)
    }
}

/// The last number for which a look-up finds all its pairs.
#[inline(always)]
fn last_place<const K: usize>(table: &[[f32; 2]], further: [usize; K]) -> usize {
    let (mut most, mut k) = (0, 0);
    while k < K {
        most = if further[k] > most { further[k] } else { most };
        k += 1;
    }
    assert!(table.len() >= most + 2, "a table too short to look anything up in");
    table.len() - (most + 2)
}

/// Writes the lanes of `bits` that there is room for, one by one.
#[inline(always)]
fn store_bits(lanes: &[f32], mut bits: u32, to: &mut [f32]) {
    while bits != 0 {
        let lane = bits.trailing_zeros() as usize;
        if lane < to.len() {
            to[lane] = lanes[lane];
        }
        bits &= bits - 1;
    }
}

/// What the three families of registers have in common: wrappers of one instruction each.
#[cfg(target_arch = "x86_64")]
macro_rules! register {
    ($name:ident, $scalar:ty, $register:ty, $width:literal, $set:ident, $load:ident, $store:ident,
     $add:ident, $sub:ident, $mul:ident, $div:ident, $fmadd:ident, $fmsub:ident, $fnmadd:ident,
     $mask:ty, $places:ty, $features:literal, { $($rest:item)* }) => {
        #[doc = concat!(stringify!($width), " lanes of ", stringify!($scalar), " in one register.")]
        #[derive(Clone, Copy)]
        #[repr(transparent)]
        pub struct $name(pub(super) $register);

        register!(@operator $name, Add, add, $add);
        register!(@operator $name, Sub, sub, $sub);
        register!(@operator $name, Mul, mul, $mul);
        register!(@operator $name, Div, div, $div);

        impl Lanes for $name {
            type Scalar = $scalar;
            type Mask = $mask;
            type Places = $places;
            const WIDTH: usize = $width;

            #[inline(always)]
            fn splat(_: Cpu<Self>, number: $scalar) -> Self {
                // SAFETY: `Cpu` says that the instruction is there.
                Self(unsafe { $set(number) })
            }
            #[inline(always)]
            fn load(_: Cpu<Self>, from: &[$scalar]) -> Self {
                if from.len() >= $width {
                    // SAFETY: as above; the slice is long enough and need not be aligned.
                    return Self(unsafe { $load(from.as_ptr()) });
                }
                // SAFETY: as above; not one number more is read than there are.
                unsafe { Self::load_first(from) }
            }
            #[inline(always)]
            fn store(self, to: &mut [$scalar]) {
                if to.len() >= $width {
                    // SAFETY: a vector exists only where `Cpu` did; the slice is long enough.
                    return unsafe { $store(to.as_mut_ptr(), self.0) };
                }
                // SAFETY: as above; nothing is written but what there is room for.
                unsafe { self.store_first(to) };
            }
            #[inline(always)]
            fn mul_add(self, b: Self, c: Self) -> Self {
                // SAFETY: a vector exists only where `Cpu` did.
                Self(unsafe { $fmadd(self.0, b.0, c.0) })
            }
            #[inline(always)]
            fn mul_sub(self, b: Self, c: Self) -> Self {
                // SAFETY: a vector exists only where `Cpu` did.
                Self(unsafe { $fmsub(self.0, b.0, c.0) })
            }
            #[inline(always)]
            fn neg_mul_add(self, b: Self, c: Self) -> Self {
                // SAFETY: a vector exists only where `Cpu` did.
                Self(unsafe { $fnmadd(self.0, b.0, c.0) })
            }
            #[inline(always)]
            fn apart(_: Cpu<Self>, work: impl Compiled) {
                #[inline(never)]
                #[target_feature(enable = $features)]
                fn run(work: impl Compiled) {
                    work.run();
                }
                // SAFETY: `Cpu` says that the instructions are there.
                unsafe { run(work) };
            }
            $($rest)*
        }
    };
    (@operator $name:ident, $trait:ident, $method:ident, $instruction:ident) => {
        impl $trait for $name {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: a vector exists only where `Cpu` did.
                Self(unsafe { $instruction(self.0, other.0) })
            }
        }
    };
}
#[cfg(target_arch = "x86_64")]
use register;
