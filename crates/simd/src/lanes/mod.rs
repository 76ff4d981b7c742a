//! Vectors of numbers: the trait [`Lanes`], which algorithms are written over, and its implementations.
//!
//! Every operation is correctly rounded (IEEE 754), fused multiply-add included, so an algorithm over [`Lanes`] gives
//! the same bits in all instances of the same precision.

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

/// A proof that this processor has the instructions of `L`; making a vector requires it.
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
    /// The processor must have the instructions. For speed, but not for safety, the code that uses the vectors should
    /// be inlined into a function compiled for those instructions.
    #[inline(always)]
    pub unsafe fn assume() -> Self {
        Self(PhantomData)
    }
}

/// A vector of `WIDTH` numbers.
pub trait Lanes:
    LookUp + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// Type of the number in a lane.
    type Scalar: Scalar;
    /// A truth value for each lane.
    type Mask: Copy;
    /// The vector type with the same number of lanes in single precision.
    type Single: Lanes<Scalar = f32>;
    /// Number of lanes.
    const WIDTH: usize;
    /// Whether a vector that is traced alone also passes the steps of a lens in a function that all callers share.
    /// False for the vector types that trace single rays: with a shared function they would take 4 to 20 % longer.
    const SHARED: bool = true;
    /// Whether rays are prepared for several vectors at once. False for 512-bit vectors: the work on one vector keeps
    /// the processor busy while the next vector is prepared. Narrower vectors take 10 to 17 % longer if they are
    /// prepared one after another.
    const PREPARED_TOGETHER: bool = true;

    /// Returns a vector with the same number in every lane.
    fn splat(cpu: Cpu<Self>, number: Self::Scalar) -> Self;
    /// Loads the first `WIDTH` numbers, with zeros in place of missing numbers.
    fn load(cpu: Cpu<Self>, from: &[Self::Scalar]) -> Self;
    /// Writes as many lanes, from the first on, as `to` has room for.
    fn store(self, to: &mut [Self::Scalar]);
    /// Returns `self * b + c`, rounded once.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// Returns `self * b - c`, rounded once.
    fn mul_sub(self, b: Self, c: Self) -> Self;
    /// Returns `c - self * b`, rounded once.
    fn neg_mul_add(self, b: Self, c: Self) -> Self;
    /// Does work in a separate function that is compiled once for the instructions of this vector type and shared by
    /// all callers. The work is inlined instead if the type needs no special instructions and is not [`Lanes::SHARED`].
    fn apart(cpu: Cpu<Self>, work: impl Compiled);
    /// Does work as [`Lanes::apart`] does, also for types whose work is inlined there: for rare work, which would make
    /// the functions that it is inlined into large.
    #[inline(always)]
    fn far_apart(cpu: Cpu<Self>, work: impl Compiled) {
        Self::apart(cpu, work);
    }
    /// Returns the square roots of two vectors; NaN for negative numbers. May also return NaN for 0, for positive
    /// numbers up to [`Scalar::NO_SQUARE`], and for infinity.
    #[inline(always)]
    fn sqrt_pair(a: Self, b: Self) -> [Self; 2] {
        [a.sqrt(), b.sqrt()]
    }
    /// Returns the square root; NaN for negative numbers.
    fn sqrt(self) -> Self;
    /// Returns the absolute value.
    fn abs(self) -> Self;
    /// Rounds toward 0 to an integer.
    fn trunc(self) -> Self;
    /// Returns the larger of `self` and `b`; `b` where either is NaN.
    fn larger(self, b: Self) -> Self;
    /// Returns the smaller of `self` and `b`; `b` where either is NaN.
    fn smaller(self, b: Self) -> Self;
    /// Returns the mask of `self < b`, false where either is NaN.
    fn less(self, b: Self) -> Self::Mask;
    /// Returns the mask of `self <= b`, false where either is NaN.
    fn less_equal(self, b: Self) -> Self::Mask;
    /// Returns a mask of the lanes that are true in both masks.
    fn both(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Returns `yes` where the mask is true, else `no`.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// Returns `self` where the mask is true, else +0.
    fn or_zero(self, mask: Self::Mask) -> Self;
    /// Returns the mask as bits, one per lane; the first lane is the lowest bit.
    fn bits(mask: Self::Mask) -> u32;

    /// Returns the proof for [`Lanes::Single`], whose instructions are among those of this vector.
    fn single_cpu(cpu: Cpu<Self>) -> Cpu<Self::Single>;
    /// Rounds to single precision.
    fn single(self) -> Self::Single;
    /// Widens from single precision.
    fn widened(single: Self::Single) -> Self;
    /// Loads single-precision numbers as [`Lanes::load`] does.
    fn load_single(cpu: Cpu<Self>, from: &[f32]) -> Self;
    /// Rounds the lanes to single precision and writes them as [`Lanes::store`] does.
    fn store_single(self, to: &mut [f32]);
    /// Writes only the lanes where the mask is true, as [`Lanes::store_single`] does.
    fn store_single_where(self, mask: Self::Mask, to: &mut [f32]);

    /// Returns the integer parts as indices of a table; arbitrary indices for numbers outside [0, 2^31).
    fn whole(self) -> Self::Places;

    /// Whether the mask is true in every lane.
    #[inline(always)]
    fn all(mask: Self::Mask) -> bool {
        Self::bits(mask) == u32::MAX >> (32 - Self::WIDTH)
    }
}

/// Writes the lanes whose bit in `bits` is set, one by one, as far as `to` has room for them.
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

/// Defines methods of one or two intrinsics, one method per line. The intrinsics must be safe on any processor that has
/// them.
#[cfg(target_arch = "x86_64")]
macro_rules! methods {
    ($(fn $method:ident $(<const $number:ident: usize>)? ($($parameters:tt)*) -> $result:ty = $value:expr;)*) => {$(
        #[inline(always)]
        fn $method$(<const $number: usize>)?($($parameters)*) -> $result {
            // SAFETY: `Cpu` proves that the processor has the instructions. A vector, or a mask from a comparison of
            // vectors, exists only if a `Cpu` existed.
            unsafe { $value }
        }
    )*};
}

/// Defines a vector type that is one register, with its operators.
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

/// Implements the methods that all families of registers have in common, given the names of the intrinsics. The
/// expressions after `else` handle slices that have fewer numbers than the vector has lanes: they access no number
/// beyond the slice, and load zeros in place of missing numbers.
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
                // SAFETY: `Cpu` proves that the processor has the instruction; the slice is long enough and need not be
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
                // SAFETY: a vector exists only if a `Cpu` existed; the slice is long enough.
                return unsafe { $store($to.as_mut_ptr(), $lanes) };
            }
            // SAFETY: as above; no number beyond the slice is written.
            unsafe { $store_first };
        }
    };
}

/// Implements the conversion of single-precision numbers to and from single-precision vectors.
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

/// Implements the conversion of single-precision numbers to and from double-precision vectors, through the vector type
/// `$single`, whose register is half as wide.
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
            // SAFETY: `Cpu` proves that the processor has the instructions of this vector, which include those of the
            // narrower vector.
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

/// Implements [`Lanes::apart`] for the given instructions.
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
            // SAFETY: `Cpu` proves that the processor has the instructions.
            unsafe { run(work) };
        }
    };
}
#[cfg(target_arch = "x86_64")]
use {apart, double_precision, intrinsics, methods, register, single_precision};
