//! Lanes in plain arrays, for any processor; with one lane, the scalar instance. A fused multiply-add is an instruction
//! if the caller is compiled for it, else a function call with the same bits as result.

use std::ops::{Add, Div, Mul, Sub};

use super::{Compiled, Cpu, Indexed, Lanes, LookUp, Scalar, store_bits};
use crate::Simd;

/// A vector of `N` lanes in an array. `SMALL` marks code that should be small and compile quickly rather than run fast.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Portable<S, const N: usize, const SMALL: bool = false>(pub [S; N]);

/// A vector of one lane.
pub type OneLane<S> = Portable<S, 1, false>;

impl<S: Scalar, const N: usize, const SMALL: bool> Portable<S, N, SMALL> {
    /// Returns the proof that the processor has the instructions of this vector; every processor has them.
    #[inline(always)]
    pub fn cpu() -> Cpu<Self> {
        // SAFETY: only instructions that the library is compiled for are used.
        unsafe { Cpu::assume() }
    }
}

/// Does the same work for each lane. The macro expands to a loop rather than to calls of a closure: a closure that is
/// not inlined would be compiled without the instructions that its enclosing function may use.
///
/// With one lane there is no loop: a lens would give thousands of loops of one iteration, and the compiler takes minutes to
/// remove them.
macro_rules! each_lane {
    ($i:ident => $work:expr) => {
        if N == 1 {
            let $i = 0;
            $work;
        } else {
            let mut $i = 0;
            while $i < N {
                $work;
                $i += 1;
            }
        }
    };
}

/// Makes an array with a value for each lane.
macro_rules! lanes {
    ($first:expr, $i:ident => $value:expr) => {{
        let mut lanes = $first;
        each_lane!($i => lanes[$i] = $value);
        lanes
    }};
}

/// Defines methods that do the same in each lane, one method per line.
macro_rules! methods {
    ($(fn $method:ident $(<const $number:ident: usize>)? ($($parameters:tt)*) -> $result:ty = $value:expr;)*) => {$(
        #[cfg_attr(not(debug_assertions), inline(always))]
        fn $method$(<const $number: usize>)?($($parameters)*) -> $result {
            $value
        }
    )*};
}

/// Reads a single-precision number. For one lane the read is volatile: the compiler would otherwise merge the reads of
/// a sample's numbers into one load, and that load would stall if a caller has just stored the numbers one by one.
#[cfg_attr(not(debug_assertions), inline(always))]
fn single<S: Scalar, const N: usize>(from: &f32) -> S {
    // SAFETY: the reference is valid.
    let number = if N == 1 { unsafe { (&raw const *from).read_volatile() } } else { *from };
    S::from_f64(number.into())
}

macro_rules! operators {
    ($($trait:ident $method:ident $operator:tt),*) => {$(
        impl<S: Scalar, const N: usize, const SMALL: bool> $trait for Portable<S, N, SMALL> {
            type Output = Self;
            methods! { fn $method(self, b: Self) -> Self = Self(lanes!(self.0, i => self.0[i] $operator b.0[i])); }
        }
    )*};
}

operators!(Add add +, Sub sub -, Mul mul *, Div div /);

impl<S: Scalar, const N: usize, const SMALL: bool> Lanes for Portable<S, N, SMALL> {
    type Scalar = S;
    type Mask = [bool; N];
    type Single = Portable<f32, N, SMALL>;
    const WIDTH: usize = N;
    const SHARED: bool = SMALL;

    methods! {
        fn splat(_: Cpu<Self>, number: S) -> Self = Self([number; N]);
        fn load(_: Cpu<Self>, from: &[S]) -> Self =
            Self(lanes!([S::ZERO; N], i => if i < from.len() { from[i] } else { S::ZERO }));
        fn mul_add(self, b: Self, c: Self) -> Self =
            Self(lanes!(self.0, i => self.0[i].fused(b.0[i], c.0[i])));
        fn mul_sub(self, b: Self, c: Self) -> Self =
            Self(lanes!(self.0, i => self.0[i].fused(b.0[i], -c.0[i])));
        fn neg_mul_add(self, b: Self, c: Self) -> Self =
            Self(lanes!(self.0, i => (-self.0[i]).fused(b.0[i], c.0[i])));
        fn sqrt(self) -> Self = Self(lanes!(self.0, i => self.0[i].sqrt()));
        fn less(self, b: Self) -> Self::Mask = lanes!([false; N], i => self.0[i] < b.0[i]);
        fn less_equal(self, b: Self) -> Self::Mask = lanes!([false; N], i => self.0[i] <= b.0[i]);
        fn both(a: Self::Mask, b: Self::Mask) -> Self::Mask = lanes!(a, i => a[i] & b[i]);
        fn select(mask: Self::Mask, yes: Self, no: Self) -> Self =
            Self(lanes!(no.0, i => if mask[i] { yes.0[i] } else { no.0[i] }));
        fn or_zero(self, mask: Self::Mask) -> Self =
            Self(lanes!(self.0, i => if mask[i] { self.0[i] } else { S::ZERO }));
        fn abs(self) -> Self =
            Self(lanes!(self.0, i => if S::ZERO < self.0[i] { self.0[i] } else { S::ZERO - self.0[i] }));
        fn trunc(self) -> Self = Self(lanes!(self.0, i => self.0[i].whole()));
        fn larger(self, b: Self) -> Self =
            Self(lanes!(b.0, i => if b.0[i] < self.0[i] { self.0[i] } else { b.0[i] }));
        fn smaller(self, b: Self) -> Self =
            Self(lanes!(b.0, i => if self.0[i] < b.0[i] { self.0[i] } else { b.0[i] }));
        fn whole(self) -> Self::Places = lanes!([0; N], i => self.0[i].index());
        fn single_cpu(_: Cpu<Self>) -> Cpu<Self::Single> = Portable::cpu();
        fn single(self) -> Self::Single = Portable(lanes!([0.0; N], i => self.0[i].to_f64() as f32));
        fn widened(single: Self::Single) -> Self =
            Self(lanes!([S::ZERO; N], i => S::from_f64(single.0[i].into())));
        fn load_single(_: Cpu<Self>, from: &[f32]) -> Self =
            Self(lanes!([S::ZERO; N], i => if i < from.len() { single::<S, N>(&from[i]) } else { S::ZERO }));
    }
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn store(self, to: &mut [S]) {
        let n = to.len().min(N);
        to[..n].copy_from_slice(&self.0[..n]);
    }
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn apart(_: Cpu<Self>, work: impl Compiled) {
        #[inline(never)]
        fn run(work: impl Compiled) {
            work.run();
        }
        if SMALL { run(work) } else { work.run() }
    }
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn far_apart(_: Cpu<Self>, work: impl Compiled) {
        // The processor's fused multiply-add is found anew, because this function is compiled without it.
        #[inline(never)]
        fn run(work: impl Compiled) {
            Simd::best().run(work);
        }
        run(work);
    }
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn sqrt_pair(mut a: Self, mut b: Self) -> [Self; 2] {
        each_lane!(i => [a.0[i], b.0[i]] = S::sqrt_pair(a.0[i], b.0[i]));
        [a, b]
    }
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn bits(mask: Self::Mask) -> u32 {
        let mut bits = 0;
        each_lane!(i => bits |= u32::from(mask[i]) << i);
        bits
    }
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn store_single(self, to: &mut [f32]) {
        let n = to.len().min(N);
        let mut i = 0;
        while i < n {
            to[i] = self.0[i].to_f64() as f32;
            i += 1;
        }
    }
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn store_single_where(self, mask: Self::Mask, to: &mut [f32]) {
        let mut single = [0.0; N];
        self.store_single(&mut single);
        store_bits(&single, Self::bits(mask), to);
    }
}

impl<S: Scalar, const N: usize, const SMALL: bool> LookUp for Portable<S, N, SMALL> {
    type Places = [usize; N];

    methods! {
        fn add_places(a: Self::Places, b: Self::Places) -> Self::Places = lanes!(a, i => a[i] + b[i]);
        fn up_to<const STEP: usize>(indices: Self::Places, last: usize) -> Self::Places =
            lanes!(indices, i => (STEP * indices[i]).min(last));
    }
    #[cfg_attr(not(debug_assertions), inline(always))]
    unsafe fn pairs(table: *const [f32; 2], indices: Self::Places) -> [Self; 4] {
        let mut numbers = [Self([S::ZERO; N]); 4];
        each_lane!(i => {
            // SAFETY: the caller ensures that the indices are valid.
            let [[a, b], [c, d]] = unsafe { table.add(indices[i]).cast::<[[f32; 2]; 2]>().read() };
            numbers[0].0[i] = S::from_f64(a.into());
            numbers[1].0[i] = S::from_f64(b.into());
            numbers[2].0[i] = S::from_f64(c.into());
            numbers[3].0[i] = S::from_f64(d.into());
        });
        numbers
    }
    #[cfg_attr(not(debug_assertions), inline(always))]
    unsafe fn indexed(table: *const Indexed, indices: Self::Places) -> (Self::Places, [Self; 3]) {
        let (mut found, mut numbers) = ([0; N], [Self([S::ZERO; N]); 3]);
        each_lane!(i => {
            // SAFETY: the caller ensures that the indices are valid.
            let Indexed { index, numbers: [a, b, c] } = unsafe { table.add(indices[i] / 2).read() };
            found[i] = index as usize;
            numbers[0].0[i] = S::from_f64(a.into());
            numbers[1].0[i] = S::from_f64(b.into());
            numbers[2].0[i] = S::from_f64(c.into());
        });
        (found, numbers)
    }
}
