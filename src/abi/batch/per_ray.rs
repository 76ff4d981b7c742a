//! What any call may ask of each ray: its wavelength, its weight and why it is blocked.

use super::{
    super::{
        boundary::{self, Failure, memory},
        object::Handle,
        types::{realistic_reason, realistic_request},
    },
    strided::{Strided, numbers, room},
};

/// What any call may ask of its rays, for many samples or one.
#[derive(Clone, Copy)]
pub(in super::super) struct PerRay {
    /// So many are the samples' rays together.
    pub rays: usize,
    pub per_sample: usize,
    pub wavelengths: Strided,
    pub weights: Strided,
    pub reasons: Strided<realistic_reason>,
}

impl PerRay {
    /// That of a request for `n` samples.
    ///
    /// # Errors
    /// An array cannot be, or is missing; there is no memory for what a first wavelength builds.
    #[inline(always)]
    pub fn of(request: &realistic_request, handle: &Handle, n: usize) -> Result<Self, Failure> {
        let per_sample = request.wavelengths_per_sample.max(1) as usize;
        let rays = n
            .checked_mul(per_sample)
            .ok_or_else(|| boundary::too_many(n, size_of::<f32>().saturating_mul(per_sample)))?;
        let wavelengths = numbers("wavelength", rays, &request.wavelength)?;
        if wavelengths.is_there() {
            if !handle.camera().is_ready_for_wavelengths() {
                memory::to_build()?;
            }
        } else if per_sample > 1 {
            return Err(boundary::null("request.wavelength.x"));
        }
        let reasons = if request.reason.is_null() {
            Strided::NONE
        } else {
            Strided::new(["reason", ""], rays, request.reason, request.reason_stride, false)?
        };
        let weights = room("weight", rays, &request.weight)?;
        Ok(Self { rays, per_sample, wavelengths, weights, reasons })
    }
}

impl Strided<realistic_reason> {
    /// Puts why the samples from number `first` on have these weights, if that is asked for; `reason` says it of one that
    /// has no ray. Found out apart, because it costs more than a ray.
    ///
    /// # Safety
    /// There is room for so many.
    #[inline(always)]
    pub(in super::super) unsafe fn give(
        self,
        first: usize,
        weights: &[f32],
        reason: impl Fn(usize) -> realistic_reason,
    ) {
        if !self.is_there() {
            return;
        }
        for (i, weight) in weights.iter().enumerate() {
            let reason = if *weight > 0.0 { realistic_reason::Ok } else { reason(i) };
            // SAFETY: the caller's promise.
            unsafe { self.put(first + i, reason) };
        }
    }
}
