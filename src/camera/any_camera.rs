//! The camera that a host holds: one of the models, with its shutter.

use super::{
    differentials::{self, AT_ONCE, Moved, NeighbourArrays, RayDifferential, Side},
    first_look::warn_of_darkness,
    host::{Host, Log},
    model::Model,
    models::{
        environment::EnvironmentCamera, ideal::IdealCamera, lens::RealisticCamera,
        projective::ProjectiveCamera, stock_cameras,
    },
    parameters::{CameraError, Parameters},
    pipeline::arrays::{BLOCK, RayArrays, RayBlock, SampleArrays, SampleBlock, SampleStore},
    placement::{Placement, shutter::Shutter},
    ray::{Outcome, Sample, WorldRay},
    setup::{self, Facts},
};
use crate::{plan::Plan, trace::Blocked};

/// The camera itself, of any model.
#[derive(Clone, Debug)]
enum AnyModel {
    Lens(Box<RealisticCamera>),
    Ideal(Box<IdealCamera>),
    Projective(Box<ProjectiveCamera>),
    Environment(Box<EnvironmentCamera>),
}

/// A camera of any model. Immutable, and may be shared between threads.
#[derive(Clone, Debug)]
pub struct Camera {
    optics: AnyModel,
    shutter: Shutter,
    yres: f32,
}

impl Camera {
    /// Builds a camera of the model that the parameters name. `log` receives warnings, among them the
    /// parameters that the model does not use.
    ///
    /// # Errors
    /// What is wrong, and what to give instead.
    pub fn build(parameters: &Parameters, host: &Host, log: Log<'_>) -> Result<Self, CameraError> {
        let (model, shutter) = (parameters.model(), setup::shutter(parameters)?);
        setup::warn_of_unused(model, shutter, parameters, log);
        let optics = match model {
            Model::Lens => AnyModel::Lens(RealisticCamera::build(parameters, host, log)?.into()),
            Model::Thick | Model::Thin => {
                AnyModel::Ideal(IdealCamera::build(parameters, host, model, log)?.into())
            }
            Model::Perspective => {
                AnyModel::Projective(stock_cameras::perspective(parameters, host, log)?.into())
            }
            Model::Orthographic => {
                AnyModel::Projective(stock_cameras::orthographic(parameters, host, log)?.into())
            }
            Model::Environment => {
                AnyModel::Environment(stock_cameras::environment(parameters, host, log)?.into())
            }
        };
        let camera = Self { optics, shutter, yres: host.raster.yres as f32 };
        warn_of_darkness(host.raster, |sample| camera.through_optics(sample), log);
        Ok(camera)
    }

    /// The ray of a sample with its weight, or why there is none. The weight is the model's times what the
    /// shutter lets through to the film point at the sample's time.
    pub fn generate(&self, sample: &Sample) -> Outcome {
        let Some(share) = self.share(sample.image_y, sample.time) else {
            return Outcome::Shut;
        };
        match self.through_optics(sample) {
            Outcome::Ray(ray, weight) => Outcome::Ray(ray, dimmed(weight, share)),
            other => other,
        }
    }

    /// [`Camera::generate`] without the reason where there is no ray, which is faster.
    pub fn ray(&self, sample: &Sample) -> Option<(WorldRay, f32)> {
        match &self.optics {
            AnyModel::Lens(camera) if self.shutter == Shutter::Global => camera.ray(sample),
            _ => self.any_ray(sample),
        }
    }

    /// [`Camera::ray`] of many samples, the same to the last bit; with a tolerance, each within it. Where there is no ray
    /// the weight is 0, and the other numbers are left as they are.
    ///
    /// # Panics
    /// The arrays differ in length.
    pub fn rays(&self, samples: &SampleArrays<'_>, rays: &mut RayArrays<'_>) {
        let n = samples.checked_len();
        assert_eq!(n, rays.checked_len(), "a batch needs as much room as it has samples");
        match self.as_lens() {
            Some(camera) if self.shutter == Shutter::Global => camera.trace_arrays(samples, rays),
            Some(camera) => self.through_shutter(camera, samples, rays),
            None => (0..n).for_each(|i| rays.set(i, self.any_ray(&samples.get(i)))),
        }
    }

    /// Writes a sample's ray and its weight; 0, and no ray, where there is none.
    #[inline(always)]
    pub(crate) fn trace_one(&self, sample: &Sample, ray: &mut WorldRay, weight: &mut f32) {
        match &self.optics {
            AnyModel::Lens(camera) if self.shutter == Shutter::Global => {
                camera.trace_one(sample, ray, weight)
            }
            _ => match self.any_ray(sample) {
                Some(found) => (*ray, *weight) = found,
                None => *weight = 0.0,
            },
        }
    }

    /// [`Camera::ray`] through any optics and shutter.
    #[inline(never)]
    fn any_ray(&self, sample: &Sample) -> Option<(WorldRay, f32)> {
        match &self.optics {
            AnyModel::Lens(camera) => {
                let share = self.share(sample.image_y, sample.time)?;
                camera.ray(sample).map(|(ray, weight)| (ray, dimmed(weight, share)))
            }
            AnyModel::Ideal(_) | AnyModel::Projective(_) | AnyModel::Environment(_) => {
                match self.generate(sample) {
                    Outcome::Ray(ray, weight) => Some((ray, weight)),
                    Outcome::Blocked(_) | Outcome::Redraw | Outcome::Shut => None,
                }
            }
        }
    }

    /// [`Camera::ray`] of four samples of one time, traced side by side; `false`, and nothing done, where that
    /// takes as long as one after the other.
    #[inline]
    #[cfg_attr(
        not(realistic_shim),
        expect(dead_code, reason = "only a pbrt-v1 host asks for any three at once")
    )]
    pub(crate) fn trace_side_by_side(&self, samples: &SampleBlock<4>, rays: &mut RayBlock<4>) -> bool {
        let traced = self.as_lens().is_some_and(|camera| camera.trace_side_by_side(samples, rays));
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
        let [own, rx, ry] = [0, 1, 2].map(|place| rays.get(place));
        let [rx, ry] = [rx, ry].map(|found| found.map(|(ray, _)| ray));
        own.map(|(ray, weight)| (RayDifferential { ray, rx, ry }, weight))
    }

    /// [`Camera::ray_differential`] of many samples, the same to the last bit. Where there is no ray the three weights
    /// are 0, and the other numbers are left as they are; where a neighbour is missing its weight is 0, and the
    /// ray's own origin and direction stand in its place.
    ///
    /// # Panics
    /// The arrays differ in length.
    pub fn ray_differentials(
        &self,
        samples: &SampleArrays<'_>,
        rays: &mut RayArrays<'_>,
        rx: &mut NeighbourArrays<'_>,
        ry: &mut NeighbourArrays<'_>,
    ) {
        self.rays(samples, rays);
        let n = samples.checked_len();
        let same = [&*rx, ry].iter().all(|neighbours| neighbours.checked_len() == n);
        assert!(same, "a batch needs as much room as it has samples");
        let (mut moved, mut found) = (Moved::new(), RayBlock::new());
        for first in (0..n).step_by(AT_ONCE) {
            let count = AT_ONCE.min(n - first);
            let part = samples.part(first, count);
            self.rays_of_optics(&moved.to(Side::Right, &part), &mut found.arrays(count));
            rx.take(first, count, rays, &mut found);
            self.rays_of_optics(&moved.to(Side::Below, &part), &mut found.arrays(count));
            ry.take(first, count, rays, &mut found);
        }
    }

    /// Traces a sample and its neighbours, into places 0, 1 (right) and 2 (below); the weight is 0 where there is no ray.
    pub(crate) fn trace_neighbours(&self, sample: &Sample, rays: &mut RayBlock<4>) {
        let samples @ [own, right, below] = differentials::samples_of(sample);
        let block = differentials::at_points(
            &own,
            [own.image_x, right.image_x, own.image_x, own.image_x],
            [own.image_y, own.image_y, below.image_y, own.image_y],
        );
        let traced = self.as_lens().is_some_and(|camera| camera.trace_side_by_side(&block, rays));
        if !traced {
            for (place, sample) in samples.iter().enumerate() {
                rays.arrays(4).set(place, self.ray_of_optics(sample));
            }
        }
        if self.shutter != Shutter::Global {
            let share = self.share(own.image_y, own.time);
            let weight = &mut rays.arrays(4).weight[0];
            *weight = share.filter(|_| *weight > 0.0).map_or(0.0, |share| dimmed(*weight, share));
        }
    }

    /// [`Camera::ray`] with the shutter open.
    fn ray_of_optics(&self, sample: &Sample) -> Option<(WorldRay, f32)> {
        if let AnyModel::Lens(camera) = &self.optics {
            return camera.ray(sample);
        }
        match self.through_optics(sample) {
            Outcome::Ray(ray, weight) => Some((ray, weight)),
            Outcome::Blocked(_) | Outcome::Redraw | Outcome::Shut => None,
        }
    }

    /// [`Camera::rays`] with the shutter open, of arrays that have one length.
    fn rays_of_optics(&self, samples: &SampleArrays<'_>, rays: &mut RayArrays<'_>) {
        match &self.optics {
            AnyModel::Lens(camera) => camera.trace_arrays(samples, rays),
            _ => (0..samples.len()).for_each(|i| rays.set(i, self.ray_of_optics(&samples.get(i)))),
        }
    }

    /// [`Camera::rays`] by blocks, of which only what the shutter lets through is handed on.
    fn through_shutter(
        &self,
        camera: &RealisticCamera,
        samples: &SampleArrays<'_>,
        rays: &mut RayArrays<'_>,
    ) {
        let mut block = RayBlock::<BLOCK>::new();
        let n = samples.image_x.len();
        for first in (0..n).step_by(BLOCK) {
            let count = BLOCK.min(n - first);
            camera.trace_arrays(&samples.part(first, count), &mut block.arrays(count));
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
        let share = self.shutter.transmission(image_y / self.yres, time);
        (share != 0.0).then_some(share)
    }

    fn through_optics(&self, sample: &Sample) -> Outcome {
        let outcome = match &self.optics {
            AnyModel::Lens(camera) => return camera.generate(sample),
            AnyModel::Ideal(camera) => camera.generate(sample),
            AnyModel::Projective(camera) => camera.generate(sample),
            AnyModel::Environment(camera) => Outcome::Ray(camera.ray(sample), 1.0),
        };
        match outcome {
            // The real lens blocks these as well.
            Outcome::Ray(ray, weight) if !(ray.is_sound() && weight > 0.0 && weight.is_finite()) => {
                Outcome::Blocked(Blocked::Missed)
            }
            sound => sound,
        }
    }

    /// A ray that stands in where there is none and a host needs a complete ray all the same: of the
    /// same film point, by the thick lens or through the middle of the lens; where the film point is none, straight ahead.
    pub fn substitute(&self, sample: &Sample) -> WorldRay {
        let ray = match &self.optics {
            AnyModel::Lens(camera) => camera.substitute(sample),
            AnyModel::Ideal(camera) => camera.central(sample),
            AnyModel::Projective(camera) => camera.central(sample),
            AnyModel::Environment(camera) => camera.ray(sample),
        };
        if ray.is_sound() { ray } else { self.placement().axial_ray(sample.time) }
    }

    fn placement(&self) -> &Placement {
        match &self.optics {
            AnyModel::Lens(camera) => camera.placement(),
            AnyModel::Ideal(camera) => camera.placement(),
            AnyModel::Projective(camera) => camera.placement(),
            AnyModel::Environment(camera) => camera.placement(),
        }
    }

    /// What the camera keeps and leaves out.
    pub fn plan(&self) -> Plan {
        match &self.optics {
            AnyModel::Lens(camera) => camera.plan().clone(),
            AnyModel::Ideal(_) | AnyModel::Projective(_) | AnyModel::Environment(_) => {
                let mut plan = Plan::default();
                self.placement().describe(&mut plan);
                plan
            }
        }
    }

    /// When the shutter begins to open and has closed, in the host's unit of time.
    pub fn shutter_interval(&self) -> [f32; 2] {
        self.placement().shutter
    }

    /// `hither` and `yon` as they are in use, world units.
    pub fn clip(&self) -> [f32; 2] {
        self.placement().clip
    }

    /// The camera of [`Model::Lens`].
    pub fn as_lens(&self) -> Option<&RealisticCamera> {
        match &self.optics {
            AnyModel::Lens(camera) => Some(camera),
            AnyModel::Ideal(_) | AnyModel::Projective(_) | AnyModel::Environment(_) => None,
        }
    }

    /// The lens and the film, and what is known of them; `None` for a model without a prescription.
    pub fn facts(&self) -> Option<&Facts> {
        match &self.optics {
            AnyModel::Lens(camera) => Some(camera.facts()),
            AnyModel::Ideal(camera) => Some(camera.facts()),
            AnyModel::Projective(_) | AnyModel::Environment(_) => None,
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
