//! The camera that a host holds: one of the models, with its shutter.

use std::sync::Arc;

use super::{
    differentials::{self, AT_ONCE, Moved, RayDifferential, Side},
    host::{Host, Level, Log},
    importance::{AdjointCamera, ImportanceError},
    model::Model,
    models::{
        ideal::IdealCamera,
        lens::RealisticCamera,
        stock_cameras::{self, StockCamera},
    },
    parameters::{CameraError, Parameters},
    pipeline::{
        arrays::{BLOCK, RayArrays, RayBlock, SampleArrays, SampleStore},
        on_demand::OnDemand,
        ray_maker::RayMaker,
        spectral::Spectral,
    },
    placement::shutter::Shutter,
    ray::{Outcome, Sample, WorldRay},
    setup::{self, Crop, Facts, warn_of_darkness},
};
use crate::{
    plan::Plan,
    sampling::DiskMapping,
    trace::{Blocked, kernel::Simd},
};

/// The camera itself, of any model.
#[derive(Clone, Debug)]
enum AnyModel {
    Lens(Box<RealisticCamera>),
    Ideal(Box<IdealCamera>),
    Stock(Box<StockCamera>),
}

/// A camera of any model. Immutable, and may be shared between threads.
#[derive(Clone, Debug)]
pub struct Camera {
    model: AnyModel,
    rays: RayMaker,
    shutter: Shutter,
    /// Width and height of the image, pixels.
    resolution: [f32; 2],
    crop: Crop,
    /// The adjoint camera, once a call has requested it.
    adjoint: OnDemand<Result<Arc<AdjointCamera>, ImportanceError>>,
}

impl AnyModel {
    fn ray_maker(&self) -> &RayMaker {
        match self {
            Self::Lens(camera) => camera.ray_maker(),
            Self::Ideal(camera) => camera.ray_maker(),
            Self::Stock(camera) => &camera.rays,
        }
    }

    /// How lens samples map to the disk, in a model that blocks no rays; `None` where there is no disk.
    fn mapping(&self) -> Option<DiskMapping> {
        match self {
            Self::Lens(_) => None,
            Self::Ideal(camera) => Some(camera.mapping()),
            Self::Stock(camera) => camera.mapping,
        }
    }
}

impl Camera {
    /// Builds a camera of the model that the parameters name. `log` receives warnings, among them the
    /// parameters that the model does not use.
    ///
    /// # Errors
    /// What is wrong, and what to give instead.
    pub fn build(parameters: &Parameters, host: &Host, log: Log<'_>) -> Result<Self, CameraError> {
        Self::build_from(None, parameters, host, log)
    }

    /// [`Camera::build`], the same to the last bit, at another focus, stop, zoom or place than a camera that there is: what
    /// follows from the same parameters as there is taken over, and not computed again. A lens file of the same name is
    /// not read again. Of models other than "lens" nothing is taken over.
    ///
    /// # Errors
    /// As of [`Camera::build`].
    pub fn build_from(
        donor: Option<&Self>,
        parameters: &Parameters,
        host: &Host,
        log: Log<'_>,
    ) -> Result<Self, CameraError> {
        let (model, shutter) = (parameters.model(), setup::shutter(parameters)?);
        setup::warn_of_unused(model, shutter, parameters, log);
        if let Err(text) = Simd::limit() {
            log(Level::Warning, &text);
        }
        let model = match model {
            Model::Lens => {
                let donor = donor.and_then(Self::as_lens);
                AnyModel::Lens(RealisticCamera::build_from(donor, parameters, host, log)?.into())
            }
            Model::Thick | Model::Thin => {
                AnyModel::Ideal(IdealCamera::build(parameters, host, model, log)?.into())
            }
            Model::Perspective => AnyModel::Stock(stock_cameras::perspective(parameters, host, log)?.into()),
            Model::Orthographic => {
                AnyModel::Stock(stock_cameras::orthographic(parameters, host, log)?.into())
            }
            Model::Environment => AnyModel::Stock(stock_cameras::environment(parameters, host, log)?.into()),
        };
        let resolution = [host.raster.xres, host.raster.yres].map(|side| side as f32);
        let crop = Crop::of(parameters, host.raster)?;
        let rays = model.ray_maker().clone();
        let camera = Self { rays, model, shutter, resolution, crop, adjoint: OnDemand::new() };
        let lens = camera.as_lens().map(|lens| (&lens.facts().film, || lens.lit_radius()));
        warn_of_darkness(host.raster, &camera.rays, lens, |sample| camera.why_none(sample), log);
        Ok(camera)
    }

    /// The ray of a sample with its weight, or why there is none. The weight is the model's times what the
    /// shutter lets through to the film point at the sample's time.
    pub fn generate(&self, sample: &Sample) -> Outcome {
        if self.share(sample.image_y, sample.time).is_none() {
            return Outcome::Shut;
        }
        self.ray(sample).map_or_else(|| self.why_none(sample), |(ray, weight)| Outcome::Ray(ray, weight))
    }

    /// Why the model makes no ray of a sample.
    fn why_none(&self, sample: &Sample) -> Outcome {
        if let AnyModel::Lens(camera) = &self.model {
            return camera.generate(sample);
        }
        let disk = |mapping: DiskMapping| mapping.map(sample.lens_u.into(), sample.lens_v.into());
        match self.model.mapping() {
            Some(mapping) if disk(mapping).is_none() => Outcome::Redraw,
            _ => Outcome::Blocked(Blocked::Missed),
        }
    }

    /// [`Camera::generate`] without the reason where there is no ray, which is faster.
    pub fn ray(&self, sample: &Sample) -> Option<(WorldRay, f32)> {
        let (mut ray, mut weight) = Default::default();
        self.trace_one(sample, &mut ray, &mut weight);
        (weight > 0.0).then_some((ray, weight))
    }

    /// [`Camera::ray`] of many samples, the same to the last bit; with a tolerance, each within it. Where there is no ray
    /// the weight is 0, and the other numbers are left as they are.
    ///
    /// # Panics
    /// The arrays differ in length.
    pub fn rays(&self, samples: &SampleArrays<'_>, rays: &mut RayArrays<'_>) {
        let n = samples.checked_len();
        assert_eq!(n, rays.checked_len(), "a batch needs as much room as it has samples");
        if self.shutter == Shutter::Global {
            self.rays.many(samples, rays);
        } else {
            self.through_shutter(samples, rays);
        }
    }

    /// [`Camera::generate`] at a wavelength, nm, from 380 to 780.
    ///
    /// The index of each glass is that of its own formula. Lens, film and stop stand where the camera's own wavelength put
    /// them. What `weighting` divides by is that of the camera's own wavelength, too. A lens file without dispersion data,
    /// and every model but "lens", have the camera's own rays at every wavelength.
    pub fn generate_at(&self, sample: &Sample, wavelength: f32) -> Outcome {
        if self.share(sample.image_y, sample.time).is_none() {
            return Outcome::Shut;
        }
        if !self.rays.has_wavelength(wavelength) {
            return Outcome::Wavelength;
        }
        if let Some((ray, weight)) = self.ray_at(sample, wavelength) {
            return Outcome::Ray(ray, weight);
        }
        match self.rays.spectral() {
            Some(spectral) => spectral.why_none(sample, wavelength),
            None => self.why_none(sample),
        }
    }

    /// [`Camera::generate_at`] without the reason where there is no ray, which is faster.
    pub fn ray_at(&self, sample: &Sample, wavelength: f32) -> Option<(WorldRay, f32)> {
        let (mut ray, mut weight) = Default::default();
        self.trace_one_at(sample, wavelength, &mut ray, &mut weight);
        (weight > 0.0).then_some((ray, weight))
    }

    /// [`Camera::ray_at`] of many samples, each at its own wavelength, the same to the last bit. Where there is no ray the
    /// weight is 0, and the other numbers are left as they are.
    ///
    /// # Panics
    /// The arrays differ in length.
    pub fn rays_at(&self, samples: &SampleArrays<'_>, wavelengths: &[f32], rays: &mut RayArrays<'_>) {
        let n = samples.checked_len();
        assert_eq!([n; 2], [rays.checked_len(), wavelengths.len()], "a batch has one length");
        if self.shutter == Shutter::Global {
            return self.rays.many_at(samples, wavelengths, rays);
        }
        self.in_blocks_through_shutter(samples, rays, |first, part, block| {
            let wavelengths = &wavelengths[first..first + part.image_x.len()];
            self.rays.many_at(part, wavelengths, block);
        });
    }

    /// The rays of one sample at four wavelengths, traced side by side: the bits of [`Camera::ray_at`].
    pub fn hero_rays(&self, sample: &Sample, wavelengths: &[f32; 4]) -> [Option<(WorldRay, f32)>; 4] {
        let Some(share) = self.share(sample.image_y, sample.time) else { return [None; 4] };
        let mut rays = RayBlock::new();
        let Sample { image_x, image_y, lens_u, lens_v, time } = *sample;
        let samples = [image_x, image_y, lens_u, lens_v, time].map(|number| [number; 4]).into();
        self.rays.four_at(&samples, wavelengths, &mut rays);
        let behind = |(ray, weight)| (ray, if share < 1.0 { dimmed(weight, share) } else { weight });
        [0, 1, 2, 3].map(|i| rays.get(i).map(behind))
    }

    /// Whether wavelengths have been asked for before, or do not matter: a first request takes memory.
    pub(crate) fn is_ready_for_wavelengths(&self) -> bool {
        self.rays.spectral().is_none_or(Spectral::is_built)
    }

    /// Writes a sample's ray at a wavelength and its weight; 0, and no ray, where there is none.
    pub(crate) fn trace_one_at(
        &self,
        sample: &Sample,
        wavelength: f32,
        ray: &mut WorldRay,
        weight: &mut f32,
    ) {
        *weight = 0.0;
        if let Some(share) = self.share(sample.image_y, sample.time) {
            self.rays.one_at(sample, wavelength, ray, weight);
            if *weight > 0.0 && self.shutter != Shutter::Global {
                *weight = dimmed(*weight, share);
            }
        }
    }

    /// Writes a sample's ray and its weight; 0, and no ray, where there is none.
    #[inline(always)]
    pub(crate) fn trace_one(&self, sample: &Sample, ray: &mut WorldRay, weight: &mut f32) {
        if self.shutter == Shutter::Global {
            self.rays.one(sample, ray, weight);
        } else {
            self.one_through_shutter(sample, ray, weight);
        }
    }

    /// [`Camera::trace_one`] through any shutter.
    #[inline(never)]
    fn one_through_shutter(&self, sample: &Sample, ray: &mut WorldRay, weight: &mut f32) {
        *weight = 0.0;
        if let Some(share) = self.share(sample.image_y, sample.time) {
            self.rays.one(sample, ray, weight);
            if *weight > 0.0 {
                *weight = dimmed(*weight, share);
            }
        }
    }

    /// [`Camera::ray`] of four samples of one time, traced side by side; `false`, and nothing done, where that
    /// takes as long as one after the other.
    #[inline]
    #[cfg(realistic_shim)] // Only a pbrt-v1 host asks for any three at once.
    pub(crate) fn trace_side_by_side(&self, samples: &super::SampleBlock<4>, rays: &mut RayBlock<4>) -> bool {
        let traced = self.rays.four(samples, rays);
        if traced && self.shutter != Shutter::Global {
            for (i, weight) in rays.arrays(4).weight.iter_mut().enumerate() {
                let Sample { image_y, time, .. } = samples.sample(i);
                let share = self.share(image_y, time).filter(|_| *weight > 0.0);
                *weight = share.map_or(0.0, |share| dimmed(*weight, share));
            }
        }
        traced
    }

    /// The ray of a sample with its weight, and those of the same lens and time sample one pixel to the right and one
    /// pixel down: the bits of [`Camera::ray`] for samples at image x + 1 and at y + 1. There is a neighbour where the
    /// lens lets it through, whether the shutter is open there or not. `None` where the sample has no ray.
    pub fn ray_differential(&self, sample: &Sample) -> Option<(RayDifferential, f32)> {
        let mut rays = RayBlock::new();
        self.trace_neighbours(sample, &mut rays);
        let [own, rx, ry] = [0, 1, 2].map(|index| rays.get(index));
        let [rx, ry] = [rx, ry].map(|found| found.map(|(ray, _)| ray));
        own.map(|(ray, weight)| (RayDifferential { ray, rx, ry }, weight))
    }

    /// [`Camera::ray_differential`] of many samples, the same to the last bit. Where there is no ray the three weights
    /// are 0, and the other numbers are left as they are; where a neighbour is missing its weight is 0, and the
    /// ray's own origin and direction stand in its place. Range and time of neighbours are those of their rays: arrays for
    /// them are left as they are.
    ///
    /// # Panics
    /// The arrays differ in length.
    pub fn ray_differentials(
        &self,
        samples: &SampleArrays<'_>,
        rays: &mut RayArrays<'_>,
        rx: &mut RayArrays<'_>,
        ry: &mut RayArrays<'_>,
    ) {
        self.rays(samples, rays);
        let trace = |_, moved: &SampleArrays<'_>, to: &mut RayArrays<'_>| self.rays.many(moved, to);
        Self::neighbours(Side::Right, samples, rays, rx, trace);
        Self::neighbours(Side::Below, samples, rays, ry, trace);
    }

    /// [`Camera::ray_differentials`] of rays and neighbours each at the sample's own wavelength, nm: the bits of
    /// [`Camera::ray_at`] for samples at image x + 1 and at y + 1.
    ///
    /// # Panics
    /// The arrays differ in length.
    pub fn ray_differentials_at(
        &self,
        samples: &SampleArrays<'_>,
        wavelengths: &[f32],
        rays: &mut RayArrays<'_>,
        rx: &mut RayArrays<'_>,
        ry: &mut RayArrays<'_>,
    ) {
        self.rays_at(samples, wavelengths, rays);
        let trace = |first: usize, moved: &SampleArrays<'_>, to: &mut RayArrays<'_>| {
            self.rays.many_at(moved, &wavelengths[first..first + moved.image_x.len()], to);
        };
        Self::neighbours(Side::Right, samples, rays, rx, trace);
        Self::neighbours(Side::Below, samples, rays, ry, trace);
    }

    /// The neighbours of rays on one side; `trace` makes rays of the samples from an index on.
    #[inline(always)]
    fn neighbours(
        side: Side,
        samples: &SampleArrays<'_>,
        rays: &RayArrays<'_>,
        to: &mut RayArrays<'_>,
        trace: impl Fn(usize, &SampleArrays<'_>, &mut RayArrays<'_>),
    ) {
        let n = samples.checked_len();
        assert_eq!(to.checked_len(), n, "a batch needs as much room as it has samples");
        let (mut moved, mut room) = (Moved::new(), None);
        for first in (0..n).step_by(AT_ONCE) {
            let count = AT_ONCE.min(n - first);
            let moved = moved.to(side, &samples.part(first, count));
            if differentials::are_rays(&rays.weight[first..first + count]) {
                trace(first, &moved, &mut differentials::part(to, first, count));
                differentials::complete(to, first, count, rays);
            } else {
                let found = room.get_or_insert_with(RayBlock::new);
                let mut rays_alone = RayArrays { mint: None, maxt: None, time: None, ..found.arrays(count) };
                trace(first, &moved, &mut rays_alone);
                differentials::take(to, first, count, rays, found);
            }
        }
    }

    /// Traces a sample and its neighbours, to index 0, 1 (right) and 2 (below); the weight is 0 where there is no ray.
    pub(crate) fn trace_neighbours(&self, sample: &Sample, rays: &mut RayBlock<4>) {
        let block = differentials::block_of(sample);
        let traced = self.rays.four(&block, rays);
        if !traced {
            for index in 0..3 {
                rays.arrays(4).set(index, self.rays.ray(&block.sample(index)));
            }
        }
        self.dim_first(sample, rays);
    }

    /// [`Camera::trace_neighbours`] at a wavelength, nm.
    pub(crate) fn trace_neighbours_at(&self, sample: &Sample, wavelength: f32, rays: &mut RayBlock<4>) {
        self.rays.four_at(&differentials::block_of(sample), &[wavelength; 4], rays);
        self.dim_first(sample, rays);
    }

    /// What the shutter lets through of the first ray, which is a sample's.
    #[inline(always)]
    fn dim_first(&self, sample: &Sample, rays: &mut RayBlock<4>) {
        if self.shutter != Shutter::Global {
            let share = self.share(sample.image_y, sample.time);
            let weight = &mut rays.arrays(4).weight[0];
            *weight = share.filter(|_| *weight > 0.0).map_or(0.0, |share| dimmed(*weight, share));
        }
    }

    /// [`Camera::rays`] by blocks, of which only what the shutter lets through is handed on.
    fn through_shutter(&self, samples: &SampleArrays<'_>, rays: &mut RayArrays<'_>) {
        self.in_blocks_through_shutter(samples, rays, |_, part, block| self.rays.many(part, block));
    }

    /// The same of rays that `trace` makes of the samples from a place on.
    #[inline(always)]
    fn in_blocks_through_shutter(
        &self,
        samples: &SampleArrays<'_>,
        rays: &mut RayArrays<'_>,
        trace: impl Fn(usize, &SampleArrays<'_>, &mut RayArrays<'_>),
    ) {
        let mut block = RayBlock::<BLOCK>::new();
        let n = samples.image_x.len();
        for first in (0..n).step_by(BLOCK) {
            let count = BLOCK.min(n - first);
            trace(first, &samples.part(first, count), &mut block.arrays(count));
            for i in 0..count {
                let share = self.share(samples.image_y[first + i], samples.time[first + i]);
                let ray = block.get(i).and_then(|(ray, weight)| Some((ray, dimmed(weight, share?))));
                rays.set(first + i, ray);
            }
        }
    }

    /// What the shutter lets through; `None` where it is closed.
    fn share(&self, image_y: f32, time: f32) -> Option<f32> {
        if self.shutter == Shutter::Global {
            return Some(1.0);
        }
        let share = self.shutter.transmission(image_y / self.resolution[1], time);
        (share != 0.0).then_some(share)
    }

    /// A ray that stands in where there is none and a host needs a complete ray all the same: of the
    /// same film point, by the thick lens or through the middle of the lens; where the film point is none, straight ahead.
    pub fn substitute(&self, sample: &Sample) -> WorldRay {
        let ray = match &self.model {
            AnyModel::Lens(camera) => Some(camera.substitute(sample)).filter(WorldRay::is_sound),
            AnyModel::Ideal(_) | AnyModel::Stock(_) => {
                let [lens_u, lens_v] = self.model.mapping().map_or([0.5; 2], DiskMapping::of_middle);
                self.rays.ray(&Sample { lens_u, lens_v, ..*sample }).map(|(ray, _)| ray)
            }
        };
        ray.unwrap_or_else(|| self.rays.placement().axial_ray(sample.time))
    }

    /// The adjoint camera: importance of rays from the scene, and directions toward the lens. It is made when it is
    /// first asked for; a lens is looked at from everywhere when a direction is.
    ///
    /// # Errors
    /// It is a stock camera without a lens, for which importance is not defined.
    pub fn adjoint(&self) -> Result<&AdjointCamera, ImportanceError> {
        let made = self.adjoint.get_or_make(|| {
            let adjoint = match &self.model {
                AnyModel::Lens(camera) => camera.adjoint(),
                AnyModel::Ideal(camera) => camera.adjoint(),
                AnyModel::Stock(camera) => camera.adjoint()?,
            };
            Ok(Arc::new(adjoint.with_shutter(self.shutter, self.resolution[1])))
        });
        made.as_deref().map_err(Clone::clone)
    }

    /// Whether the camera has been asked for directions toward the lens before, so that nothing more is made when it is again.
    pub(crate) fn has_adjoint(&self) -> bool {
        matches!(self.adjoint.get(), Some(Ok(adjoint)) if adjoint.is_complete())
    }

    /// What the camera keeps and leaves out.
    pub fn plan(&self) -> Plan {
        if let AnyModel::Lens(camera) = &self.model {
            return camera.plan().clone();
        }
        let mut plan = Plan::default();
        self.rays.placement().describe(&mut plan);
        plan
    }

    /// When the shutter begins to open and has closed, in the host's unit of time.
    pub fn shutter_interval(&self) -> [f32; 2] {
        self.rays.placement().shutter
    }

    /// The part of the picture that the host is asked to render. Samples outside have their rays, too.
    pub fn crop(&self) -> Crop {
        self.crop
    }

    /// `hither` and `yon` as they are in use, world units.
    pub fn clip(&self) -> [f32; 2] {
        self.rays.placement().clip
    }

    /// Where all rays begin and end, world units; `None` where each has a range of its own.
    #[inline]
    pub(crate) fn range(&self) -> Option<[f32; 2]> {
        self.rays.range()
    }

    /// The camera of [`Model::Lens`], whose parts are no part of the stable face.
    #[doc(hidden)]
    pub fn as_lens(&self) -> Option<&RealisticCamera> {
        match &self.model {
            AnyModel::Lens(camera) => Some(camera),
            AnyModel::Ideal(_) | AnyModel::Stock(_) => None,
        }
    }

    /// The lens and the film, and what is known of them; `None` for a model without a prescription.
    pub fn facts(&self) -> Option<&Facts> {
        match &self.model {
            AnyModel::Lens(camera) => Some(camera.facts()),
            AnyModel::Ideal(camera) => Some(camera.facts()),
            AnyModel::Stock(_) => None,
        }
    }
}

/// A positive weight behind the shutter. However small, it is not that of a blocked ray.
fn dimmed(weight: f32, share: f32) -> f32 {
    (weight * share).max(f32::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Raster;

    #[test]
    fn what_is_no_image_point_makes_no_ray_of_any_model() {
        for (name, model) in Model::NAMES {
            let parameters = Parameters { model: Some(model), ..Parameters::default() };
            let host = Host::new(Raster { xres: 40, yres: 30 }, None);
            let camera = Camera::build(&parameters, &host, &mut |_, text| panic!("{text}")).expect("built");
            let sample = Sample { image_x: 20.0, image_y: 15.0, lens_u: 0.5, lens_v: 0.5, time: 0.0 };
            assert!(matches!(camera.generate(&sample), Outcome::Ray(..)), "{name}");
            for number in [f32::NAN, f32::INFINITY, -f32::INFINITY] {
                for strange in [Sample { image_x: number, ..sample }, Sample { image_y: number, ..sample }] {
                    let outcome = camera.generate(&strange);
                    assert!(matches!(outcome, Outcome::Blocked(_)), "{name} {strange:?}: {outcome:?}");
                    assert_eq!(camera.ray(&strange), None, "{name} {strange:?}");
                }
            }
        }
    }
}
