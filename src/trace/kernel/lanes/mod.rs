//! The vector that the algorithm is written over.
//!
//! Every operation is correctly rounded (IEEE 754), fused multiply-add included, so an algorithm
//! over [`Lanes`] gives the same bits in every instance of one precision.

#[cfg(target_arch = "x86_64")]
pub mod avx2;
#[cfg(target_arch = "x86_64")]
pub mod avx512;
mod portable;

use std::{
    marker::PhantomData,
    ops::{Add, Div, Mul, Sub},
};

pub use portable::{Portable, Scalar};

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

impl<S: Scalar, const N: usize> Cpu<Portable<S, N>> {
    /// Every processor has what this one needs.
    #[inline(always)]
    pub fn any() -> Self {
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
    /// The square root, as in [`Lanes::sqrt_pair`].
    fn sqrt(self) -> Self;
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

    /// The larger of the two; `b` where either is NaN.
    #[inline(always)]
    fn larger(self, b: Self) -> Self {
        Self::select(b.less(self), self, b)
    }
}

/// What the three families of registers have in common: wrappers of one instruction each.
#[cfg(target_arch = "x86_64")]
macro_rules! register {
    ($name:ident, $scalar:ty, $register:ty, $width:literal, $set:ident, $load:ident, $store:ident,
     $add:ident, $sub:ident, $mul:ident, $div:ident, $fmadd:ident, $fmsub:ident, $fnmadd:ident,
     $mask:ty, { $($rest:item)* }) => {
        #[doc = concat!(stringify!($width), " lanes of ", stringify!($scalar), " in one register.")]
        #[derive(Clone, Copy)]
        #[repr(transparent)]
        pub struct $name($register);

        register!(@operator $name, Add, add, $add);
        register!(@operator $name, Sub, sub, $sub);
        register!(@operator $name, Mul, mul, $mul);
        register!(@operator $name, Div, div, $div);

        impl Lanes for $name {
            type Scalar = $scalar;
            type Mask = $mask;
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
                let mut padded = [0.0; $width];
                padded[..from.len()].copy_from_slice(from);
                // SAFETY: as above; the array is long enough.
                Self(unsafe { $load(padded.as_ptr()) })
            }
            #[inline(always)]
            fn store(self, to: &mut [$scalar]) {
                if to.len() >= $width {
                    // SAFETY: a vector exists only where `Cpu` did; the slice is long enough.
                    return unsafe { $store(to.as_mut_ptr(), self.0) };
                }
                let mut whole = [0.0; $width];
                // SAFETY: as above; the array is long enough.
                unsafe { $store(whole.as_mut_ptr(), self.0) };
                to.copy_from_slice(&whole[..to.len()]);
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
