//! A lens for the film's rays, with a shorter way for those that the plan was made for.
//!
//! A plan holds for film points up to some radius. Rays from within take the short way (a kernel without tests that
//! none of them can fail, or polynomials); a host that asks for points farther out gets the
//! whole lens there.

use crate::trace::{
    Blocked, Ray,
    kernel::{Batch, Grouping, Kernel, Precision},
    polynomial::PolynomialLens,
};

/// A lens in numbers of type `S`.
#[derive(Clone, Debug)]
pub(crate) struct Shortened<S> {
    whole: Kernel<S>,
    short: Option<Short<S>>,
}

/// What serves film points up to a radius.
#[derive(Clone, Debug)]
struct Short<S> {
    /// Its square, mm².
    within: S,
    way: Way<S>,
}

/// A shorter way through the lens.
#[derive(Clone, Debug)]
pub(crate) enum Way<S> {
    /// Every surface, with fewer tests.
    Kernel(Kernel<S>),
    /// The lens as polynomials.
    Polynomials(Box<PolynomialLens<S>>),
}

impl<S: Precision> Shortened<S> {
    /// The whole lens for all rays.
    pub fn whole(kernel: Kernel<S>) -> Self {
        Self { whole: kernel, short: None }
    }

    /// A short way for film points up to `reach` mm from the axis.
    pub fn with(self, reach: f64, way: Way<S>) -> Self {
        Self { short: Some(Short { within: S::from_f64(reach * reach), way }), ..self }
    }

    /// The square of the film radius up to which [`Shortened::trace`] serves, mm²; `None` for any.
    pub fn within(&self) -> Option<S> {
        self.short.as_ref().map(|short| short.within)
    }

    /// Traces rays from film points within, by the short way if there is one.
    #[inline(always)]
    pub fn trace(&self, grouping: Grouping, batch: &mut impl Batch<S>) {
        match self.short.as_ref().map(|short| &short.way) {
            None => self.trace_whole(grouping, batch),
            Some(Way::Kernel(kernel)) => kernel.trace(grouping, batch),
            Some(Way::Polynomials(lens)) => lens.trace(grouping, batch),
        }
    }

    /// Traces rays from any film points.
    #[inline(always)]
    pub fn trace_whole(&self, grouping: Grouping, batch: &mut impl Batch<S>) {
        self.whole.trace(grouping, batch);
    }

    /// Why a ray that does not get through is blocked.
    pub fn reason(&self, ray: Ray) -> Blocked {
        self.whole.reason(ray)
    }
}
