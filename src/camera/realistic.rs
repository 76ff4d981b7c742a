//! The realistic camera: a sample in, a ray through every interface of the lens out.

use super::{
    CameraError, DiskMapping, Drawn, Film, PupilDisk, WarpedPupil,
    irradiance::{film_ray, on_axis, survey},
    placement::Placement,
    setup::{Level, PupilChoice, Setup, Weighting},
    tracer::Tracer,
};
use crate::{
    optics::{
        Lens,
        first_order::FirstOrder,
        pupil::{EntrancePupil, limiting_surface},
    },
    trace::{Blocked, Direction, Path, Ray, kernel::Traced},
};

/// What a host asks with.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Raster x, pixels, growing to the right; may lie outside the raster.
    pub image_x: f32,
    /// Raster y, pixels, growing downward; may lie outside the raster.
    pub image_y: f32,
    /// First lens number, in [0, 1].
    pub lens_u: f32,
    /// Second lens number, in [0, 1].
    pub lens_v: f32,
    /// Time number, in [0, 1].
    pub time: f32,
}

/// A ray in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldRay {
    /// Origin, world units.
    pub origin: [f32; 3],
    /// Unit direction.
    pub direction: [f32; 3],
    /// Where along the ray it begins.
    pub mint: f32,
    /// Where along the ray it ends.
    pub maxt: f32,
    /// Time.
    pub time: f32,
}

/// What becomes of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// A ray and its weight, positive.
    Ray(WorldRay, f32),
    /// The lens blocks it: weight 0.
    Blocked(Blocked),
    /// The lens numbers fell outside the disk ([`DiskMapping::Rejection`]): draw new ones.
    Redraw,
    /// The shutter is closed over the film point at this time: weight 0.
    Shut,
}

/// Where lens samples are drawn.
#[derive(Clone, Debug)]
pub(super) enum Sampler {
    /// A disk about the axis.
    Disk(PupilDisk),
    /// The true pupil of each film point.
    Warped(Box<WarpedPupil>),
}

impl Sampler {
    /// The slope for a point of the unit disk; `None` where the film is dark.
    #[inline(always)]
    fn draw(&self, film: [f64; 2], disk: [f64; 2]) -> Option<Drawn> {
        match self {
            Self::Disk(pupil) => Some(pupil.draw(film, disk)),
            Self::Warped(pupil) => pupil.draw(film, disk),
        }
    }
}

/// What a sample asks of the film's side.
pub(super) enum FilmSide {
    /// A ray from the film point.
    Ray([f64; 2], Drawn),
    /// A film point beyond the image circle.
    Dark([f64; 2]),
    /// New lens numbers.
    Redraw,
}

/// A camera with a real lens. Immutable, and may be shared between threads.
#[derive(Clone, Debug)]
pub struct RealisticCamera {
    lens: Lens,
    first_order: FirstOrder,
    fnumber: f64,
    pub(super) film: Film,
    pub(super) film_z: f64,
    focus_distance: Option<f64>,
    pub(super) tracer: Tracer,
    pub(super) sampler: Sampler,
    /// The disk that holds every pupil.
    rear: PupilDisk,
    pub(super) mapping: DiskMapping,
    /// The weight of a ray is this times cos⁴ and the slope area it stands for; `None`: it is 1.
    weight: Option<f64>,
    pub(super) units_per_mm: f64,
    pub(super) placement: Placement,
}

/// Share of the irradiance that the thick-lens exit pupil may miss without a warning.
const MISSED_SHARE: f64 = 1e-3;
/// Rays across the rear element in measuring that share.
const SURVEY_RAYS: u32 = 64;

impl RealisticCamera {
    /// Builds the camera of a checked set-up. `log` receives warnings.
    pub(super) fn from_setup(setup: Setup, log: &mut dyn FnMut(Level, &str)) -> Result<Self, CameraError> {
        let Setup { lens, film, film_distance, .. } = setup;
        let first_order = FirstOrder::of(&lens)?;
        let film_z = lens.rear().vertex - film_distance;
        let rim = -lens.rear().sagitta(lens.rear().semi_diameter);
        let rear = PupilDisk::rear(&lens, film_z, film.reach())
            // So near the glass that the pupil fills a hemisphere to the last digit, its area in slopes, of
            // which the weights are made, leaves the number range.
            .filter(|disk| (disk.slope_area() as f32).is_finite())
            .ok_or(CameraError::FilmInLens { film_distance, rim: rim.max(0.0) })?;
        let path = Path::new(&lens, Direction::FilmToScene, setup.refraction);
        let exit = PupilDisk::exit(&lens, film_z);
        let sampler = match setup.pupil {
            PupilChoice::Rear => Sampler::Disk(rear),
            PupilChoice::Disk => {
                warn_of_missed_share(&path, film_z, &film, rear, exit, log);
                Sampler::Disk(exit)
            }
            PupilChoice::Warped => {
                let drift = exit.seen_from([1.0, 0.0]).center[0];
                let pupil = WarpedPupil::new(&path, film_z, film.reach(), rear, drift);
                tell_of_cover(&pupil, log);
                Sampler::Warped(Box::new(pupil))
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
        let heaviest = weight.map_or(1.0, |weight| weight * largest);
        if !(heaviest as f32).is_finite() {
            return Err(CameraError::Weight { weight: heaviest });
        }
        let entrance = EntrancePupil::of_surface(&lens, limiting_surface(&lens));
        let tracer = Tracer::new(&lens, setup.refraction, setup.single_precision);
        Ok(Self {
            fnumber: first_order.focal_length.abs() / entrance.diameter(),
            lens,
            first_order,
            film,
            film_z,
            focus_distance: setup.focus_distance,
            tracer,
            sampler,
            rear,
            mapping: setup.mapping,
            weight,
            units_per_mm: setup.mm_per_unit.recip(),
            placement: setup.placement,
        })
    }

    /// The ray of a sample, or why there is none. Finding out why costs more than a ray does; where
    /// nobody asks, [`RealisticCamera::ray`] spares it.
    pub fn generate(&self, sample: &Sample) -> Outcome {
        let (point, drawn) = match self.film_side(sample) {
            FilmSide::Ray(point, drawn) => (point, drawn),
            FilmSide::Dark(_) => return Outcome::Blocked(Blocked::Clipped),
            FilmSide::Redraw => return Outcome::Redraw,
        };
        match self.tracer.one(self.film_z, point, drawn.slopes) {
            Some(traced) => {
                let (ray, weight) = self.finish(&traced, drawn.area, sample.time);
                Outcome::Ray(ray, weight)
            }
            None => Outcome::Blocked(self.tracer.reason(self.film_z, point, drawn.slopes)),
        }
    }

    /// The ray of a sample with its weight, positive; `None` where there is none.
    #[inline]
    pub fn ray(&self, sample: &Sample) -> Option<(WorldRay, f32)> {
        let FilmSide::Ray(point, Drawn { slopes, area }) = self.film_side(sample) else {
            return None;
        };
        let traced = self.tracer.one(self.film_z, point, slopes)?;
        Some(self.finish(&traced, area, sample.time))
    }

    /// [`RealisticCamera::ray`] of three film points with the lens and time numbers of `sample`, traced
    /// side by side.
    #[inline]
    pub fn three(&self, sample: &Sample, image: [[f32; 2]; 3]) -> [Option<(WorldRay, f32)>; 3] {
        let Some(disk) = self.mapping.map(sample.lens_u.into(), sample.lens_v.into()) else {
            return [None; 3];
        };
        let points = image.map(|[x, y]| self.film.point(x.into(), y.into()));
        // NaN where the film is dark.
        let none = Drawn { slopes: [0.0; 2], area: f64::NAN };
        let drawn = points.map(|point| self.sampler.draw(point, disk).unwrap_or(none));
        let traced = self.tracer.three(self.film_z, points, drawn.map(|drawn| drawn.slopes));
        [0, 1, 2].map(|i| {
            let traced = traced[i].as_ref().filter(|_| !drawn[i].area.is_nan())?;
            Some(self.finish(traced, drawn[i].area, sample.time))
        })
    }

    #[inline(always)]
    fn finish(&self, traced: &Traced<f64>, area: f64, time: f32) -> (WorldRay, f32) {
        let Traced { origin, direction, weight } = *traced;
        (self.to_world(Ray { origin, direction }, time), self.weigh(area, weight))
    }

    /// The weight of a ray that gets through. However small, it is not that of a blocked one.
    #[inline(always)]
    pub(super) fn weigh(&self, area: f64, cos4: f64) -> f32 {
        (self.weight.map_or(1.0, |weight| weight * area * cos4) as f32).max(f32::MIN_POSITIVE)
    }

    /// A ray that stands in for a blocked one where a host needs a complete ray all the same:
    /// the thick lens's ray of the same film point and lens numbers.
    pub fn substitute(&self, sample: &Sample) -> WorldRay {
        let axial = Ray { origin: [0.0; 3], direction: [0.0, 0.0, 1.0] };
        let (point, slopes) = match self.film_side(sample) {
            FilmSide::Ray(point, drawn) => (point, drawn.slopes),
            FilmSide::Dark(point) => (point, self.rear.seen_from(point).center),
            FilmSide::Redraw => Default::default(),
        };
        let ray = self.first_order.transfer(film_ray(point, self.film_z, slopes));
        let finite = ray.origin.iter().chain(&ray.direction).all(|x| x.is_finite());
        self.to_world(if finite { ray } else { axial }, sample.time)
    }

    /// Film point and slopes of the ray that a sample asks for.
    #[inline(always)]
    pub(super) fn film_side(&self, sample: &Sample) -> FilmSide {
        let point = self.film.point(sample.image_x.into(), sample.image_y.into());
        let Some(disk) = self.mapping.map(sample.lens_u.into(), sample.lens_v.into()) else {
            return FilmSide::Redraw;
        };
        match self.sampler.draw(point, disk) {
            Some(drawn) => FilmSide::Ray(point, drawn),
            None => FilmSide::Dark(point),
        }
    }

    #[inline(always)]
    fn to_world(&self, ray: Ray, time: f32) -> WorldRay {
        self.placement.world_ray(ray, self.units_per_mm, time)
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

    pub(super) fn placement(&self) -> &Placement {
        &self.placement
    }

    /// Effective focal length, mm.
    pub fn focal_length(&self) -> f64 {
        self.first_order.focal_length
    }

    /// Focal length over entrance pupil diameter at the stop in use.
    pub fn fnumber(&self) -> f64 {
        self.fnumber
    }
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
