//! The camera that a host holds: one of the models, with its shutter.

use std::{slice, sync::Arc};

use super::{
    columns::{BLOCK, Columns},
    host::{Host, Level, Log},
    importance::{AdjointCamera, ImportanceError},
    model::Model,
    models::{
        ideal::IdealCamera,
        lens::RealisticCamera,
        stock_cameras::{self, StockCamera},
    },
    parameters::{CameraError, Parameters},
    pipeline::{on_demand::OnDemand, ray_maker::RayMaker, spectral::Spectral},
    placement::shutter::Shutter,
    rays::{FourRays, Outcome, RayDifferential, Rays, WEIGHT, WorldRay},
    samples::{Sample, Samples, at_points},
    setup::{self, Crop, Facts, warn_of_darkness},
};
use crate::{
    plan::{Entry, Plan},
    sampling::DiskMapping,
};
use realistic_optics::trace::Blocked;
use realistic_simd::Simd;

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
    /// The adjoint camera, which is built when a call first requests it.
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

    /// Returns how lens samples map to the disk, for a model that blocks no rays; `None` without a disk.
    fn mapping(&self) -> Option<DiskMapping> {
        match self {
            Self::Lens(_) => None,
            Self::Ideal(camera) => Some(camera.mapping()),
            Self::Stock(camera) => camera.mapping,
        }
    }
}

impl Camera {
    /// Builds a camera of the model that the parameters name. `log` receives warnings, for example about
    /// parameters that the model does not use.
    ///
    /// # Errors
    /// A parameter or the lens file is invalid; the message names the error and what to give instead.
    pub fn build(parameters: &Parameters, host: &Host, log: Log<'_>) -> Result<Self, CameraError> {
        Self::build_from(None, parameters, host, log)
    }

    /// Builds the same camera as [`Camera::build`], bit for bit, in less time. `donor` is a camera that
    /// differs only in focus, stop, zoom or placement; the new camera reuses the parts of `donor` whose
    /// parameters are the same. A lens file of the same name is not read again. Only cameras of the model
    /// "lens" reuse parts.
    ///
    /// # Errors
    /// The errors of [`Camera::build`].
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

    /// Traces a ray for each sample. The number of samples in the call does not change any bit of a ray if
    /// the tolerance is 0; otherwise each ray is within the tolerance.
    ///
    /// For samples with wavelengths, the glasses have the refractive indices at those wavelengths, from their
    /// own dispersion formulas; the lens positions, the film, the stop and the divisor of `weighting` stay
    /// those of the camera's own wavelength. Such rays are traced exactly, even with a tolerance. For a lens
    /// file without dispersion data, and for every model but "lens", the rays are the same at every
    /// wavelength from 380 to 780 nm.
    ///
    /// A ray's neighbours are the rays with the same lens sample and time at image x + 1 and at image y + 1.
    /// They depend on the lens only: they are traced even if the shutter is closed at their own image point.
    ///
    /// # Panics
    /// `rays` differs in length from `samples`.
    pub fn trace(&self, samples: &Samples<'_>, rays: &mut Rays<'_>) {
        self.trace_as(Entry::Many, samples, rays);
    }

    /// [`Camera::trace`] for a single call or a batch; with a tolerance, the two may use different tracers.
    #[inline(always)]
    pub fn trace_as(&self, entry: Entry, samples: &Samples<'_>, rays: &mut Rays<'_>) {
        assert_eq!(samples.len(), rays.len(), "room for as many rays as there are samples");
        let is_plain = self.shutter == Shutter::Global
            && samples.are_slices()
            && rays.are_slices()
            && !rays.have_neighbours()
            && (!samples.have_wavelengths() || self.rays.has_all(samples));
        if is_plain {
            self.rays.trace(entry, samples, rays);
        } else {
            self.trace_in_blocks(entry, samples, rays);
        }
    }

    /// [`Camera::trace`] for any columns and any shutter, through buffers. Samples that the shutter or their wavelength
    /// blocks get NaN for their image point.
    #[inline(never)]
    fn trace_in_blocks(&self, entry: Entry, samples: &Samples<'_>, rays: &mut Rays<'_>) {
        let n = samples.len();
        let (has_shutter, are_slices) = (self.shutter != Shutter::Global, rays.are_slices());
        // Rays need no buffers if the caller's columns are slices.
        let used = if are_slices { 0 } else { n };
        let (mut requested, mut found) = (Columns::<6>::zeros(n), Columns::<10>::zeros(used));
        let used = if rays.have_neighbours() { used } else { 0 };
        let mut neighbours = [Columns::<10>::zeros(used), Columns::<10>::zeros(used)];
        for first in (0..n).step_by(BLOCK) {
            let count = BLOCK.min(n - first);
            let mut columns = requested.first_mut(count);
            samples.copy(first, &mut columns);
            let [x, y, _, _, time, wavelengths] = columns;
            if has_shutter {
                for i in (0..count).filter(|&i| self.share(y[i], time[i]).is_none()) {
                    x[i] = f32::NAN;
                }
            }
            if samples.have_wavelengths() {
                for i in (0..count).filter(|&i| !self.rays.has_wavelength(wavelengths[i])) {
                    x[i] = f32::NAN;
                }
            }
            let requested = requested.samples(count, samples.have_wavelengths());
            let (mut to, mut sides) = rays.part_with_sides(first, count);
            if are_slices {
                self.trace_block(entry, &requested, &mut to, sides.as_mut());
                continue;
            }
            let mut targets = neighbours.each_mut().map(|buffer| buffer.neighbours(count));
            let targets = sides.is_some().then_some(&mut targets);
            self.trace_block(entry, &requested, &mut found.rays(count), targets);
            let found = found.first(count);
            to.copy_from(&found, found[WEIGHT]);
            for (side, buffer) in sides.iter_mut().flatten().zip(&neighbours) {
                side.copy_from(&buffer.first(count), found[WEIGHT]);
            }
        }
    }

    /// Traces the rays of up to [`BLOCK`] samples, and their neighbours if there are columns for them. All columns are slices.
    fn trace_block(
        &self,
        entry: Entry,
        samples: &Samples<'_>,
        rays: &mut Rays<'_>,
        sides: Option<&mut [Rays<'_>; 2]>,
    ) {
        self.rays.trace(entry, samples, rays);
        if self.shutter != Shutter::Global {
            for (i, weight) in rays.weights().iter_mut().enumerate() {
                self.shut(samples.column(1)[i], samples.column(4)[i], weight);
            }
        }
        for (axis, side) in sides.into_iter().flatten().enumerate() {
            let mut moved = [0.0; BLOCK];
            let moved = &mut moved[..samples.len()];
            for ((to, from), weight) in moved.iter_mut().zip(samples.column(axis)).zip(&*rays.weights()) {
                *to = if *weight > 0.0 { from + 1.0 } else { f32::NAN };
            }
            self.rays.trace(entry, &samples.with_column(axis, moved), side);
            rays.stand_in(side);
        }
    }

    /// Traces the ray of a sample, with its weight; `None` if it is blocked.
    pub fn ray(&self, sample: &Sample) -> Option<(WorldRay, f32)> {
        let (mut ray, mut weight) = Default::default();
        self.trace_as(Entry::One, &Samples::of(sample), &mut Rays::of(&mut ray, &mut weight));
        (weight > 0.0).then_some((ray, weight))
    }

    /// Traces the ray of a sample and returns it with its weight; `wavelength`, nm, defaults to the camera's
    /// own. For a blocked sample it returns the reason, which takes longer to find than a ray.
    pub fn generate(&self, sample: &Sample, wavelength: Option<f32>) -> Outcome {
        if self.share(sample.image_y, sample.time).is_none() {
            return Outcome::Shut;
        }
        if wavelength.is_some_and(|wavelength| !self.rays.has_wavelength(wavelength)) {
            return Outcome::Wavelength;
        }
        let (mut ray, mut weight) = Default::default();
        let samples = Samples::of(sample);
        let samples =
            wavelength.as_ref().map_or(samples, |wavelength| samples.at(slice::from_ref(wavelength)));
        self.trace_as(Entry::One, &samples, &mut Rays::of(&mut ray, &mut weight));
        if weight > 0.0 {
            return Outcome::Ray(ray, weight);
        }
        match (self.rays.spectral(), wavelength) {
            (Some(spectral), Some(wavelength)) => spectral.why_none(sample, wavelength),
            _ => self.why_none(sample),
        }
    }

    /// Returns why the model blocks a sample.
    fn why_none(&self, sample: &Sample) -> Outcome {
        if let AnyModel::Lens(camera) = &self.model {
            return camera.why_none(sample);
        }
        let disk = |mapping: DiskMapping| mapping.map(sample.lens_u.into(), sample.lens_v.into());
        match self.model.mapping() {
            Some(mapping) if disk(mapping).is_none() => Outcome::Redraw,
            _ => Outcome::Blocked(Blocked::Missed),
        }
    }

    /// Traces the ray of a sample and its neighbours as in [`Camera::trace`], and returns them with the ray's
    /// weight; `None` if the ray is blocked.
    pub fn ray_differential(&self, sample: &Sample) -> Option<(RayDifferential, f32)> {
        let mut rays = FourRays::NONE;
        self.trace_neighbours(sample, None, &mut rays);
        let [own, rx, ry] = [0, 1, 2].map(|index| rays.get(index));
        let [rx, ry] = [rx, ry].map(|found| found.map(|(ray, _)| ray));
        own.map(|(ray, weight)| (RayDifferential { ray, rx, ry }, weight))
    }

    /// Traces the ray of a sample (index 0) and its neighbours to the right (1) and below (2) in one SIMD
    /// vector; `wavelength`, nm, defaults to the camera's own. A blocked ray has the weight 0.
    pub fn trace_neighbours(&self, sample: &Sample, wavelength: Option<f32>, rays: &mut FourRays) {
        let Sample { image_x: x, image_y: y, time, .. } = *sample;
        self.trace_four(&at_points(sample, [x, x + 1.0, x, x], [y, y, y + 1.0, y]), wavelength, rays);
        if self.shutter != Shutter::Global {
            self.shut(y, time, rays.weight_mut(0));
        }
    }

    /// Traces three rays of the same time in one SIMD vector, and applies the shutter's transmission to the
    /// weight of each. Returns `false`, and does nothing, if three separate calls take no longer.
    #[inline]
    pub fn trace_three(&self, samples: &[[f32; 4]; 5], rays: &mut FourRays) -> bool {
        if !self.rays.gains_by_four() {
            return false;
        }
        self.trace_four(samples, None, rays);
        if self.shutter != Shutter::Global {
            let [_, image_y, .., time] = samples;
            for (i, (image_y, time)) in image_y.iter().zip(time).enumerate().take(3) {
                self.shut(*image_y, *time, rays.weight_mut(i));
            }
        }
        true
    }

    /// Traces three samples and a fourth that is a copy of one of them; `wavelength`, nm, defaults to the
    /// camera's own.
    #[inline(always)]
    fn trace_four(&self, samples: &[[f32; 4]; 5], wavelength: Option<f32>, rays: &mut FourRays) {
        // Four samples fill a SIMD vector, so no mask is needed.
        let count = if self.rays.gains_by_four() { 4 } else { 3 };
        let columns = Samples::columns(samples.each_ref().map(|column| &column[..count]));
        match wavelength {
            None => self.rays.trace(Entry::One, &columns, &mut rays.first(count)),
            Some(wavelength) if self.rays.has_wavelength(wavelength) => {
                let wavelengths = [wavelength; 4];
                self.rays.trace(Entry::One, &columns.at(&wavelengths[..count]), &mut rays.first(count));
            }
            Some(_) => *rays = FourRays::NONE,
        }
    }

    /// Whether a request for wavelengths allocates nothing, because there was an earlier request or because
    /// wavelengths do not change the rays.
    pub fn is_ready_for_wavelengths(&self) -> bool {
        self.rays.spectral().is_none_or(Spectral::is_built)
    }

    /// Returns the share of the light that the shutter transmits; `None` if the shutter is closed.
    fn share(&self, image_y: f32, time: f32) -> Option<f32> {
        if self.shutter == Shutter::Global {
            return Some(1.0);
        }
        let share = self.shutter.transmission(image_y / self.resolution[1], time);
        (share != 0.0).then_some(share)
    }

    /// Multiplies a weight by the share that the shutter transmits. A positive weight stays positive, because
    /// 0 means blocked.
    fn shut(&self, image_y: f32, time: f32, weight: &mut f32) {
        let share = self.share(image_y, time).filter(|_| *weight > 0.0);
        *weight = share.map_or(0.0, |share| (*weight * share).max(f32::MIN_POSITIVE));
    }

    /// Returns a substitute for a blocked ray, for hosts that need a complete ray. The substitute starts from
    /// the same film point and follows the thick lens or passes through the centre of the lens; if the film
    /// point is not finite, it points straight ahead.
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

    /// Returns the adjoint camera, which computes the importance of rays from the scene and samples
    /// directions toward the lens. The first call builds it; the first request for a direction then tabulates
    /// the lens as seen from the scene.
    ///
    /// # Errors
    /// The camera is a stock camera without a lens, for which importance is not defined.
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

    /// Whether a direction toward the lens has already been requested, so that the next request builds
    /// nothing.
    pub fn has_adjoint(&self) -> bool {
        matches!(self.adjoint.get(), Some(Ok(adjoint)) if adjoint.is_complete())
    }

    /// Returns the plan, which lists the parts that the camera keeps and those that it leaves out.
    pub fn plan(&self) -> Plan {
        if let AnyModel::Lens(camera) = &self.model {
            return camera.plan().clone();
        }
        let mut plan = Plan::default();
        self.rays.placement().describe(&mut plan);
        plan
    }

    /// Returns the time at which the shutter begins to open and the time at which it has closed, in the
    /// host's unit of time.
    pub fn shutter_interval(&self) -> [f32; 2] {
        self.rays.placement().shutter
    }

    /// Returns the part of the picture that the host has to render. Samples outside this part have rays, too.
    pub fn crop(&self) -> Crop {
        self.crop
    }

    /// Returns the values of `hither` and `yon` in use, world units.
    pub fn clip(&self) -> [f32; 2] {
        self.rays.placement().clip
    }

    /// Returns the camera if its model is [`Model::Lens`].
    fn as_lens(&self) -> Option<&RealisticCamera> {
        match &self.model {
            AnyModel::Lens(camera) => Some(camera),
            AnyModel::Ideal(_) | AnyModel::Stock(_) => None,
        }
    }

    /// Returns the lens, the film and their computed properties; `None` for a model without a prescription.
    pub fn facts(&self) -> Option<&Facts> {
        match &self.model {
            AnyModel::Lens(camera) => Some(camera.facts()),
            AnyModel::Ideal(camera) => Some(camera.facts()),
            AnyModel::Stock(_) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Raster;

    #[test]
    fn an_invalid_image_point_has_no_ray_in_any_model() {
        for (name, model) in Model::NAMES {
            let parameters = Parameters { model: Some(model), ..Parameters::default() };
            let host = Host::new(Raster { xres: 40, yres: 30 }, None);
            let camera = Camera::build(&parameters, &host, &mut |_, text| panic!("{text}")).expect("built");
            let sample = Sample { image_x: 20.0, image_y: 15.0, lens_u: 0.5, lens_v: 0.5, time: 0.0 };
            assert!(matches!(camera.generate(&sample, None), Outcome::Ray(..)), "{name}");
            for number in [f32::NAN, f32::INFINITY, -f32::INFINITY] {
                for strange in [Sample { image_x: number, ..sample }, Sample { image_y: number, ..sample }] {
                    let outcome = camera.generate(&strange, None);
                    assert!(matches!(outcome, Outcome::Blocked(_)), "{name} {strange:?}: {outcome:?}");
                    assert_eq!(camera.ray(&strange), None, "{name} {strange:?}");
                }
            }
        }
    }
}
