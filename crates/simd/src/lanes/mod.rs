//! The vector that the algorithm is written over.
//!
//! Every operation is correctly rounded (IEEE 754), fused multiply-add included, so an algorithm
//! over [`Lanes`] gives the same bits in every instance of one precision.

mod angle;
#[cfg(target_arch = "x86_64")]
pub mod avx2;
#[cfg(target_arch = "x86_64")]
pub mod avx512;
mod look_up;
mod portable;
mod scalar;

use std::{
    marker::PhantomData,
    ops::{Add, Div, Mul, Sub},
};

use crate::instruction_sets::Compiled;
pub use angle::{cos_sin, cos_sin_over, turned};
pub use look_up::{Indexed, LookUp};
pub use portable::{OneLane, Portable};
pub use scalar::Scalar;

/// The proof that this processor has the instructions of `L`, without which no vector is made.
pub struct Cpu<L>(PhantomData<fn() -> L>);

impl<L> Clone for Cpu<L> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<L> Copy for Cpu<L> {}

impl<L> Cpu<L> {
    /// States that the processor has the instructions.
    ///
    /// # Safety
    /// The processor must have them. For speed, but not for safety, the code that uses the vectors should be
    /// inlined into a function compiled for those instructions.
    #[inline(always)]
    pub unsafe fn assume() -> Self {
        Self(PhantomData)
    }
}

/// A vector of `WIDTH` numbers.
pub trait Lanes:
    LookUp + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// Type of the numbers.
    type Scalar: Scalar;
    /// A truth value for each lane.
    type Mask: Copy;
    /// The vector of as many numbers in single precision.
    type Single: Lanes<Scalar = f32>;
    /// Number of lanes.
    const WIDTH: usize;
    /// Whether a single vector, too, goes through the steps of a lens in a function that all callers share. False for
    /// the vectors of single rays, which would take 4 to 20 % longer.
    const SHARED: bool = true;
    /// Whether rays are prepared for several vectors at once. False for 512-bit vectors, each of which keeps the
    /// processor busy while it prepares the next one. Narrower vectors take 10 to 17 % longer one after another.
    const PREPARED_TOGETHER: bool = true;

    /// Returns a vector with the same number in every lane.
    fn splat(cpu: Cpu<Self>, number: Self::Scalar) -> Self;
    /// Loads the first `WIDTH` numbers, with zeros for missing ones.
    fn load(cpu: Cpu<Self>, from: &[Self::Scalar]) -> Self;
    /// Writes the first lanes, as far as `to` has room.
    fn store(self, to: &mut [Self::Scalar]);
    /// `self * b + c`, rounded once.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// `self * b - c`, rounded once.
    fn mul_sub(self, b: Self, c: Self) -> Self;
    /// `c - self * b`, rounded once.
    fn neg_mul_add(self, b: Self, c: Self) -> Self;
    /// Does work in a separate function, compiled once for these vectors' instructions and shared by all callers.
    /// Inlined if the vectors have no instructions of their own and are not [`Lanes::SHARED`].
    fn apart(cpu: Cpu<Self>, work: impl Compiled);
    /// Returns the square roots of two vectors; NaN below 0. May return NaN for numbers at most [`Scalar::NO_SQUARE`]
    /// above 0, for 0 and for infinity.
    #[inline(always)]
    fn sqrt_pair(a: Self, b: Self) -> [Self; 2] {
        [a.sqrt(), b.sqrt()]
    }
    /// Returns the square root; NaN below 0.
    fn sqrt(self) -> Self;
    /// Returns the absolute value.
    fn abs(self) -> Self;
    /// Rounds toward 0 to an integer.
    fn trunc(self) -> Self;
    /// The larger of the two; `b` where either is NaN.
    fn larger(self, b: Self) -> Self;
    /// The smaller of the two; `b` where either is NaN.
    fn smaller(self, b: Self) -> Self;
    /// `self < b`, false for NaN.
    fn less(self, b: Self) -> Self::Mask;
    /// `self <= b`, false for NaN.
    fn less_equal(self, b: Self) -> Self::Mask;
    /// Returns the lanes that are true in both masks.
    fn both(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// `yes` where the mask is true, else `no`.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// The number where the mask is true, else +0.
    fn or_zero(self, mask: Self::Mask) -> Self;
    /// The lanes where the mask is true as bits, the first lowest.
    fn bits(mask: Self::Mask) -> u32;

    /// Returns the proof for [`Lanes::Single`], whose instructions are among those of this vector.
    fn single_cpu(cpu: Cpu<Self>) -> Cpu<Self::Single>;
    /// Rounds to single precision.
    fn single(self) -> Self::Single;
    /// Widens from single precision.
    fn widened(single: Self::Single) -> Self;
    /// [`Lanes::load`] of single-precision numbers.
    fn load_single(cpu: Cpu<Self>, from: &[f32]) -> Self;
    /// [`Lanes::store`] rounded to single precision.
    fn store_single(self, to: &mut [f32]);
    /// [`Lanes::store_single`] of the lanes where the mask is true.
    fn store_single_where(self, mask: Self::Mask, to: &mut [f32]);

    /// Returns the integer parts, as indices of a table; arbitrary for numbers outside [0, 2^31).
    fn whole(self) -> Self::Places;

    /// Whether the mask is true in every lane.
    #[inline(always)]
    fn all(mask: Self::Mask) -> bool {
        Self::bits(mask) == u32::MAX >> (32 - Self::WIDTH)
    }
}

/// Writes the lanes of `bits` that `to` has room for, one by one.
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

/// Methods of one or two intrinsics each, one per line; only intrinsics that are safe on any processor that has them.
#[cfg(target_arch = "x86_64")]
macro_rules! methods {
    ($(fn $method:ident $(<const $number:ident: usize>)? ($($parameters:tt)*) -> $result:ty = $value:expr;)*) => {$(
        #[inline(always)]
        fn $method$(<const $number: usize>)?($($parameters)*) -> $result {
            // SAFETY: `Cpu` proves that the instructions are there; a vector, and a mask from comparing vectors,
            // exists only where a `Cpu` did.
            unsafe { $value }
        }
    )*};
}

/// A vector in one register, with its operators.
#[cfg(target_arch = "x86_64")]
macro_rules! register {
    ($name:ident, $width:literal lanes of $scalar:ident in $register:ident:
     $($trait:ident $method:ident $intrinsic:ident),*) => {
        #[doc = concat!(stringify!($width), " lanes of ", stringify!($scalar), " in one register.")]
        #[derive(Clone, Copy)]
        #[repr(transparent)]
        pub struct $name(pub(super) $register);

        $(impl $trait for $name {
            type Output = Self;
            methods! { fn $method(self, b: Self) -> Self = Self($intrinsic(self.0, b.0)); }
        })*
    };
}

/// The methods common to all families of registers, over the names of the intrinsics. The expressions after `else`
/// handle fewer numbers than there are lanes: they access no others, and load zeros instead.
#[cfg(target_arch = "x86_64")]
macro_rules! intrinsics {
    ($width:literal lanes of $scalar:ident: splat $set:ident;
     load $load:ident, else $from:ident => $load_first:expr;
     store $store:ident, else $to:ident, $lanes:ident => $store_first:expr;
     mul_add $fmadd:ident, mul_sub $fmsub:ident, neg_mul_add $fnmadd:ident;
     sqrt $sqrt:ident, trunc $round:ident, larger $max:ident, smaller $min:ident, compare $compare:ident;) => {
        type Scalar = $scalar;
        const WIDTH: usize = $width;

        methods! {
            fn splat(_: Cpu<Self>, number: $scalar) -> Self = Self($set(number));
            fn mul_add(self, b: Self, c: Self) -> Self = Self($fmadd(self.0, b.0, c.0));
            fn mul_sub(self, b: Self, c: Self) -> Self = Self($fmsub(self.0, b.0, c.0));
            fn neg_mul_add(self, b: Self, c: Self) -> Self = Self($fnmadd(self.0, b.0, c.0));
            fn sqrt(self) -> Self = Self($sqrt(self.0));
            fn trunc(self) -> Self = Self($round::<{ _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC }>(self.0));
            fn larger(self, b: Self) -> Self = Self($max(self.0, b.0));
            fn smaller(self, b: Self) -> Self = Self($min(self.0, b.0));
            fn less(self, b: Self) -> Self::Mask = $compare::<_CMP_LT_OQ>(self.0, b.0);
            fn less_equal(self, b: Self) -> Self::Mask = $compare::<_CMP_LE_OQ>(self.0, b.0);
        }
        #[inline(always)]
        fn load(_: Cpu<Self>, $from: &[$scalar]) -> Self {
            if $from.len() >= $width {
                // SAFETY: `Cpu` proves that the instruction is there; the slice is long enough and need not be
                // aligned.
                return Self(unsafe { $load($from.as_ptr()) });
            }
            // SAFETY: as above; no number beyond the slice is read.
            Self(unsafe { $load_first })
        }
        #[inline(always)]
        fn store(self, $to: &mut [$scalar]) {
            let $lanes = self.0;
            if $to.len() >= $width {
                // SAFETY: a vector exists only where a `Cpu` did; the slice is long enough.
                return unsafe { $store($to.as_mut_ptr(), $lanes) };
            }
            // SAFETY: as above; no number beyond the slice is written.
            unsafe { $store_first };
        }
    };
}

/// Conversion of single-precision numbers to and from single-precision vectors.
#[cfg(target_arch = "x86_64")]
macro_rules! single_precision {
    (whole $truncated:ident) => {
        type Single = Self;
        methods! { fn whole(self) -> Self::Places = $truncated(self.0); }
        #[inline(always)]
        fn single_cpu(cpu: Cpu<Self>) -> Cpu<Self> {
            cpu
        }
        #[inline(always)]
        fn single(self) -> Self {
            self
        }
        #[inline(always)]
        fn widened(single: Self) -> Self {
            single
        }
        #[inline(always)]
        fn load_single(cpu: Cpu<Self>, from: &[f32]) -> Self {
            Self::load(cpu, from)
        }
        #[inline(always)]
        fn store_single(self, to: &mut [f32]) {
            self.store(to);
        }
    };
}

/// Conversion of single-precision numbers to and from double-precision vectors, through `$single`, which is half as
/// wide.
#[cfg(target_arch = "x86_64")]
macro_rules! double_precision {
    (whole $truncated:ident; $single:ident widened $widened:ident, rounded $rounded:ident) => {
        type Single = $single;
        methods! {
            fn whole(self) -> Self::Places = $truncated(self.0);
            fn single(self) -> $single = $single($rounded(self.0));
            fn widened(single: $single) -> Self = Self($widened(single.0));
        }
        #[inline(always)]
        fn single_cpu(_: Cpu<Self>) -> Cpu<$single> {
            // SAFETY: `Cpu` proves the instructions of this vector, which include those of the narrower one.
            unsafe { Cpu::assume() }
        }
        #[inline(always)]
        fn load_single(cpu: Cpu<Self>, from: &[f32]) -> Self {
            Self::widened($single::load(Self::single_cpu(cpu), from))
        }
        #[inline(always)]
        fn store_single(self, to: &mut [f32]) {
            self.single().store(to);
        }
    };
}

/// [`Lanes::apart`] for the given instructions.
#[cfg(target_arch = "x86_64")]
macro_rules! apart {
    ($features:literal) => {
        #[inline(always)]
        fn apart(_: Cpu<Self>, work: impl Compiled) {
            #[inline(never)]
            #[target_feature(enable = $features)]
            fn run(work: impl Compiled) {
                work.run();
            }
            // SAFETY: `Cpu` proves that the instructions are there.
            unsafe { run(work) };
        }
    };
}
#[cfg(target_arch = "x86_64")]
use {apart, double_precision, intrinsics, methods, register, single_precision};
