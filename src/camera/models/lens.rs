//! The realistic camera: a sample in, a ray through every interface of the lens out.

use crate::sampling::film_rays::FilmRays;
use std::{f64::consts::PI, sync::Arc};

use crate::{
    camera::{
        builder::CameraBuilder,
        film::Film,
        host::{Host, Level},
        parameters::{CameraError, Model, ParameterError, Parameters, Pupil, Weighting},
        pipeline::{
            compiled::Pipeline,
            few::{Three, Together},
            film_rays::{Drawing, Sampler},
            tracer::{Tracer, Walk, Walked},
        },
        placement::Placement,
        planning::{self, Route},
        sample::{Outcome, Sample, WorldRay},
        setup::{Focusing, Setup},
    },
    imaging::irradiance::{film_ray, on_axis, survey},
    sampling::{DiskMapping, PupilDisk, WarpedPupil},
};
use crate::{
    lens::{
        Lens,
        first_order::FirstOrder,
        pupil::{EntrancePupil, limiting_surface},
    },
    plan::Plan,
    trace::{Blocked, Direction, Path, Ray, Real, kernel::Grouping},
};

/// A camera with a real lens. Immutable, and may be shared between threads.
#[derive(Clone, Debug)]
pub struct RealisticCamera {
    lens: Lens,
    /// `None` for an afocal lens.
    first_order: Option<FirstOrder>,
    fnumber: f64,
    film: Film,
    film_z: f64,
    focus_distance: Option<f64>,
    pub(crate) tracer: Tracer,
    /// The disk that holds every pupil.
    rear: PupilDisk,
    mapping: DiskMapping,
    /// The weight of a ray is this times cos⁴ and the slope area it stands for; `None`: it is 1.
    weight: Option<f64>,
    units_per_mm: f64,
    placement: Placement,
    plan: Plan,
}

/// Share of the irradiance that the thick-lens exit pupil may miss without a warning.
const MISSED_SHARE: f64 = 1e-3;
/// Rays across the rear element in measuring that share.
const SURVEY_RAYS: u32 = 64;

impl RealisticCamera {
    /// A camera of the model "lens" to be described by methods and then built.
    pub fn builder() -> CameraBuilder<Self> {
        CameraBuilder::new(Self::build)
    }

    /// Builds a camera of the model "lens". `log` receives warnings.
    ///
    /// # Errors
    /// What is wrong, and what to give instead.
    pub fn build(
        parameters: &Parameters,
        host: &Host,
        log: &mut dyn FnMut(Level, &str),
    ) -> Result<Self, CameraError> {
        let model = parameters.model();
        if model != Model::Lens {
            let (value, range) = (format!("\"{model}\""), "\"lens\"".to_owned());
            return Err(ParameterError::Range { name: "model", value, range }.into());
        }
        Self::from_setup(Setup::of(parameters, host, Focusing::Exact, log)?, log)
    }

    /// Builds the camera of a checked set-up. `log` receives warnings.
    fn from_setup(setup: Setup, log: &mut dyn FnMut(Level, &str)) -> Result<Self, CameraError> {
        let (lens, film, film_distance) = (setup.lens.clone(), setup.film, setup.film_distance);
        let first_order = FirstOrder::of(&lens).ok();
        let film_z = lens.rear().vertex - film_distance;
        let rear = PupilDisk::rear(&lens, film_z, film.reach())
            .ok_or_else(|| CameraError::film_in_lens(&lens, film_distance))?;
        // So near the glass that the pupil fills a hemisphere to the last digit, or on film that large, the pupil's
        // area in slopes, of which the weights are made, leaves the number range.
        representable(rear.slope_area())?;
        let path = Path::new(&lens, Direction::FilmToScene, setup.refraction);
        let exit = PupilDisk::exit(&lens, film_z);
        let sampler = match setup.pupil {
            Pupil::Rear => Sampler::Disk(rear),
            Pupil::Disk => {
                warn_of_missed_share(&path, film_z, &film, rear, exit, log);
                Sampler::Disk(exit)
            }
            Pupil::Warped => {
                let drift = exit.seen_from([1.0, 0.0]).center[0];
                let pupil = WarpedPupil::new(&path, film_z, film.reach(), rear, drift);
                tell_of_cover(&pupil, log);
                Sampler::Warped(Arc::new(pupil))
            }
        };
        let weight = match setup.weighting {
            Weighting::Radiometric => Some(1.0),
            Weighting::Assignment => {
                let disk = if let Sampler::Disk(disk) = &sampler { disk } else { &exit };
                Some(disk.area().ok_or(CameraError::PupilAtInfinity)?.recip())
            }
            Weighting::Relative => {
                // Over the disk in use, so that the mean on the axis is 1 with either pupil.
                let reach = if let Sampler::Disk(disk) = &sampler { disk } else { &rear };
                let mean = on_axis(&path, film_z, reach.seen_from([0.0; 2]).radius);
                if mean <= 0.0 {
                    return Err(CameraError::DarkAxis { lens: lens.name });
                }
                Some(mean.recip())
            }
            Weighting::None => None,
        };
        let largest = if let Sampler::Disk(disk) = &sampler { disk } else { &rear }.slope_area();
        // The factor by itself, too, times π: single precision multiplies areas over π by it.
        representable(weight.map_or(1.0, |weight| (weight * largest).max(weight * PI)))?;
        let entrance = EntrancePupil::of_surface(&lens, limiting_surface(&lens));
        let units_per_mm = setup.mm_per_unit.recip();
        let side = planning::FilmSide { film: &film, film_z, sampler: &sampler };
        let (route, mut plan) = planning::plan(&setup, &lens, &side, log);
        planning::describe_drawing(&mut plan, &side, setup.mapping, lens.wavelength);
        setup.placement.describe(&mut plan);
        let (drawn, placed) = ((&film, setup.mapping, &sampler), (&setup.placement, units_per_mm));
        let drawing = || Drawing::new(&film, setup.mapping, &sampler);
        let tracer = match route {
            Route::Double(lens) => {
                Tracer::Double(Pipeline::new((lens, film_z), drawn, weight, placed).into())
            }
            Route::Single(lens) => {
                Tracer::Single(Pipeline::new((lens, film_z), drawn, weight, placed).into())
            }
            Route::Walk(path) => Tracer::Walk(Walk { drawing: drawing(), path }.into()),
            Route::WalkSingle(path) => Tracer::WalkSingle(Walk { drawing: drawing(), path }.into()),
        };
        Ok(Self {
            fnumber: focal_length(first_order).abs() / entrance.diameter(),
            lens,
            first_order,
            film,
            film_z,
            focus_distance: setup.focus_distance,
            tracer,
            rear,
            mapping: setup.mapping,
            weight,
            units_per_mm,
            placement: setup.placement,
            plan,
        })
    }

    /// The ray of a sample, or why there is none. Finding out why costs more than a ray does; where
    /// nobody asks, [`RealisticCamera::ray`] spares it.
    pub fn generate(&self, sample: &Sample) -> Outcome {
        if let Some((ray, weight)) = self.ray(sample) {
            return Outcome::Ray(ray, weight);
        }
        let FilmRays { point, disk, slopes, area_per_pi } = self.tracer.film_ray(sample);
        if self.asks_again(disk) {
            Outcome::Redraw
        } else if area_per_pi.is_nan() {
            Outcome::Blocked(Blocked::Clipped)
        } else {
            Outcome::Blocked(self.tracer.reason(self.film_z, point, slopes))
        }
    }

    /// The ray of a sample with its weight, positive; `None` where there is none.
    #[inline(always)]
    pub fn ray(&self, sample: &Sample) -> Option<(WorldRay, f32)> {
        let (asked, mut numbers) = (Together::from(sample), [[0.0]; 7]);
        match &self.tracer {
            Tracer::Double(pipeline) => pipeline.few(Grouping::One, &asked, &mut numbers),
            Tracer::Single(pipeline) => pipeline.few(Grouping::One, &asked, &mut numbers),
            Tracer::Walk(walk) => return self.walk(walk, &{ *sample }),
            Tracer::WalkSingle(walk) => return self.walk(walk, &{ *sample }),
        }
        let [ox, oy, oz, dx, dy, dz, weight] = numbers.map(|[number]| number);
        let ([mint, maxt], time) = (self.placement.clip, self.placement.time(sample.time));
        let (origin, direction) = ([ox, oy, oz], [dx, dy, dz]);
        (weight > 0.0).then_some((WorldRay { origin, direction, mint, maxt, time }, weight))
    }

    /// [`RealisticCamera::ray`] of three film points with the lens and time numbers of `sample`, traced
    /// side by side.
    #[inline]
    pub fn three(&self, sample: &Sample, image: [[f32; 2]; 3], rays: &mut Three) {
        let [a, b, c] = image;
        let four = [a, b, c, c];
        let asked = Together {
            image_x: four.map(|[x, _]| x),
            image_y: four.map(|[_, y]| y),
            lens: [sample.lens_u, sample.lens_v],
            time: [sample.time; 4],
        };
        (rays.clip, rays.time) = (self.placement.clip, self.placement.time(sample.time));
        match &self.tracer {
            Tracer::Double(pipeline) => pipeline.few(Grouping::Quad, &asked, &mut rays.numbers),
            Tracer::Single(pipeline) => pipeline.few(Grouping::Quad, &asked, &mut rays.numbers),
            Tracer::Walk(_) | Tracer::WalkSingle(_) => {
                for (i, [image_x, image_y]) in image.into_iter().enumerate() {
                    rays.set(i, self.ray(&Sample { image_x, image_y, ..*sample }));
                }
            }
        }
    }

    /// The ray that a walk has found, in world space and with its weight.
    #[inline(never)]
    fn walk<R: Real>(&self, walk: &Walk<R>, sample: &Sample) -> Option<(WorldRay, f32)> {
        let Walked { ray, share } = walk.one(self.film_z, sample)?;
        let weight = self.weight.map_or(1.0, |weight| weight * share) as f32;
        // However small, it is not that of a blocked ray.
        Some((self.to_world(ray, sample.time), weight.max(f32::MIN_POSITIVE)))
    }

    /// Whether a point of the unit disk, which is none, asks for new lens numbers.
    fn asks_again(&self, disk: [f64; 2]) -> bool {
        self.mapping == DiskMapping::Rejection && disk.iter().any(|x| x.is_nan())
    }

    /// A ray that stands in for a blocked one where a host needs a complete ray all the same:
    /// the thick lens's ray of the same film point and lens numbers, or the straight one where the lens is afocal.
    pub fn substitute(&self, sample: &Sample) -> WorldRay {
        let axial = Ray { origin: [0.0; 3], direction: [0.0, 0.0, 1.0] };
        let FilmRays { point, disk, slopes, area_per_pi } = self.tracer.film_ray(sample);
        let (point, slopes) = if self.asks_again(disk) {
            Default::default()
        } else if area_per_pi.is_nan() {
            (point, self.rear.seen_from(point).center)
        } else {
            (point, slopes)
        };
        let ray = film_ray(point, self.film_z, slopes);
        let ray = self.first_order.map_or_else(|| straight(ray), |lens| lens.transfer(ray));
        let finite = ray.origin.iter().chain(&ray.direction).all(|x| x.is_finite());
        self.to_world(if finite { ray } else { axial }, sample.time)
    }

    #[inline(always)]
    fn to_world(&self, ray: Ray, time: f32) -> WorldRay {
        self.placement.world_ray(ray, self.units_per_mm, time)
    }

    /// What the camera keeps and leaves out.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The lens, at the wavelength and stop in use.
    pub fn lens(&self) -> &Lens {
        &self.lens
    }

    /// The film.
    pub fn film(&self) -> &Film {
        &self.film
    }

    /// Last vertex to film, mm.
    pub fn film_distance(&self) -> f64 {
        self.lens.rear().vertex - self.film_z
    }

    /// Film plane to the plane in focus, mm; infinity when focused there or beyond, `None` when no
    /// object in front of the lens is in focus.
    pub fn focus_distance(&self) -> Option<f64> {
        self.focus_distance
    }

    pub(crate) fn placement(&self) -> &Placement {
        &self.placement
    }

    /// Effective focal length, mm; infinite for an afocal lens.
    pub fn focal_length(&self) -> f64 {
        focal_length(self.first_order)
    }

    /// Focal length over entrance pupil diameter at the stop in use; infinite for an afocal lens.
    pub fn fnumber(&self) -> f64 {
        self.fnumber
    }
}

fn focal_length(lens: Option<FirstOrder>) -> f64 {
    lens.map_or(f64::INFINITY, |lens| lens.focal_length)
}

/// A ray as it reaches the front vertex plane where nothing bends it, with a unit direction.
fn straight(Ray { origin: [x, y, z], direction: [dx, dy, dz] }: Ray) -> Ray {
    let (sx, sy) = (dx / dz, dy / dz);
    let norm = (1.0 + sx * sx + sy * sy).sqrt();
    Ray { origin: [x - sx * z, y - sy * z, 0.0], direction: [sx / norm, sy / norm, 1.0 / norm] }
}

/// Whether a weight can be told to a host, which takes floats.
fn representable(weight: f64) -> Result<(), CameraError> {
    if (weight as f32).is_finite() { Ok(()) } else { Err(CameraError::Weight { weight }) }
}

/// Says where the warped pupil had to be given up.
fn tell_of_cover(pupil: &WarpedPupil, log: &mut dyn FnMut(Level, &str)) {
    let covered = pupil.build_report().covered;
    if covered > 0.0 {
        log(
            Level::Info,
            &format!(
                "pupil \"warped\": over {:.1} % of the film's radius the pupil is in pieces, or of no shape that \
                 a fan of straight lines reaches, and samples are drawn from the rear element's disk there: \
                 unbiased, with more of them blocked",
                100.0 * covered
            ),
        );
    }
}

fn warn_of_missed_share(
    path: &Path,
    film_z: f64,
    film: &Film,
    rear: PupilDisk,
    disk: PupilDisk,
    log: &mut dyn FnMut(Level, &str),
) {
    let missed = |height: f64| {
        let point = [0.0, height];
        let cover = rear.seen_from(point);
        let survey = survey(path, film_z, point, cover, disk.seen_from(point), SURVEY_RAYS);
        if survey.irradiance > 0.0 { 1.0 - survey.inside / survey.irradiance } else { 0.0 }
    };
    let corner = film.diagonal() / 2.0;
    let [axis, middle, edge] = [0.0, 0.5, 1.0].map(|field| missed(field * corner));
    if axis.max(middle).max(edge) > MISSED_SHARE {
        log(
            Level::Warning,
            &format!(
                "pupil \"disk\" misses part of the true pupil: {:.1} % of the light on the axis, {:.1} % \
                 half way to the corner, {:.1} % in the corner; pupil \"warped\" misses none",
                100.0 * axis,
                100.0 * middle,
                100.0 * edge
            ),
        );
    }
}
