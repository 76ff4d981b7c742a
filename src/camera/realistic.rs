//! The realistic camera: a sample in, a ray through every interface of the lens out.

use glam::DVec3;

use super::{
    CameraError, CameraToWorld, DiskMapping, Film, PupilDisk,
    irradiance::{cos4, film_ray, on_axis, survey},
    setup::{Level, Setup, Weighting},
};
use crate::{
    optics::{
        Lens,
        first_order::FirstOrder,
        pupil::{EntrancePupil, limiting_surface},
    },
    trace::{Blocked, Direction, Path, Ray},
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
}

/// The lens made ready in the precision asked for.
#[derive(Clone, Debug)]
enum Tracer {
    F64(Path<f64>),
    F32(Path<f32>),
}

/// A camera with a real lens. Immutable, and may be shared between threads.
#[derive(Clone, Debug)]
pub struct RealisticCamera {
    lens: Lens,
    first_order: FirstOrder,
    fnumber: f64,
    film: Film,
    film_z: f64,
    focus_distance: Option<f64>,
    tracer: Tracer,
    pupil: PupilDisk,
    mapping: DiskMapping,
    /// The weight of a ray is this times cos⁴, or this alone.
    weight: f64,
    weight_falls_off: bool,
    units_per_mm: f64,
    to_world: CameraToWorld,
    clip: [f32; 2],
    shutter: [f32; 2],
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
            .ok_or(CameraError::FilmInLens { film_distance, rim: rim.max(0.0) })?;
        let path = Path::new(&lens, Direction::FilmToScene, setup.refraction);
        let pupil = if setup.exit_pupil {
            let disk = PupilDisk::exit(&lens, film_z);
            warn_of_missed_share(&path, film_z, &film, rear, disk, log);
            disk
        } else {
            rear
        };
        let (weight, weight_falls_off) = match setup.weighting {
            Weighting::Radiometric => (pupil.slope_area(), true),
            Weighting::Assignment => {
                let area = pupil.area().ok_or(CameraError::PupilAtInfinity)?;
                (pupil.slope_area() / area, true)
            }
            Weighting::Relative => {
                let mean = on_axis(&path, film_z, rear.seen_from([0.0; 2]).radius);
                if mean <= 0.0 {
                    return Err(CameraError::DarkAxis { lens: lens.name });
                }
                (pupil.slope_area() / mean, true)
            }
            Weighting::None => (1.0, false),
        };
        // So near the glass that the pupil fills a hemisphere to the last digit and its area in slopes, which
        // the weight is made of, leaves the number range.
        if !(weight as f32).is_finite() {
            return Err(CameraError::FilmInLens { film_distance, rim: rim.max(0.0) });
        }
        let entrance = EntrancePupil::of_surface(&lens, limiting_surface(&lens));
        let tracer = if setup.single_precision {
            Tracer::F32(Path::new(&lens, Direction::FilmToScene, setup.refraction))
        } else {
            Tracer::F64(path)
        };
        Ok(Self {
            fnumber: first_order.focal_length / entrance.diameter(),
            lens,
            first_order,
            film,
            film_z,
            focus_distance: setup.focus_distance,
            tracer,
            pupil,
            mapping: setup.mapping,
            weight,
            weight_falls_off,
            units_per_mm: setup.mm_per_unit.recip(),
            to_world: setup.to_world,
            clip: setup.clip,
            shutter: setup.shutter,
        })
    }

    /// The ray of a sample, or why there is none.
    pub fn generate(&self, sample: &Sample) -> Outcome {
        let Some((point, slopes)) = self.film_side(sample) else {
            return Outcome::Redraw;
        };
        let ray = film_ray(point, self.film_z, slopes);
        let traced = match &self.tracer {
            Tracer::F64(path) => path.trace(ray),
            Tracer::F32(path) => path.trace(ray),
        };
        match traced {
            Ok(ray) => {
                let falloff = if self.weight_falls_off { cos4(slopes) } else { 1.0 };
                Outcome::Ray(self.to_world(ray, sample.time), (self.weight * falloff) as f32)
            }
            Err(reason) => Outcome::Blocked(reason),
        }
    }

    /// A ray that stands in for a blocked one where a host needs a complete ray all the same:
    /// the thick lens's ray of the same film point and lens numbers.
    pub fn substitute(&self, sample: &Sample) -> WorldRay {
        let axial = Ray { origin: [0.0; 3], direction: [0.0, 0.0, 1.0] };
        let (point, slopes) = self.film_side(sample).unwrap_or_default();
        let ray = self.first_order.transfer(film_ray(point, self.film_z, slopes));
        let finite = ray.origin.iter().chain(&ray.direction).all(|x| x.is_finite());
        self.to_world(if finite { ray } else { axial }, sample.time)
    }

    /// Film point and slopes of the ray that a sample asks for; `None` to draw again.
    fn film_side(&self, sample: &Sample) -> Option<([f64; 2], [f64; 2])> {
        let point = self.film.point(sample.image_x.into(), sample.image_y.into());
        let [u, v] = self.mapping.map(sample.lens_u.into(), sample.lens_v.into())?;
        let disk = self.pupil.seen_from(point);
        Some((point, [disk.center[0] + disk.radius * u, disk.center[1] + disk.radius * v]))
    }

    fn to_world(&self, ray: Ray, time: f32) -> WorldRay {
        let origin = self.to_world.point(DVec3::from(ray.origin) * self.units_per_mm);
        let direction = self.to_world.direction(DVec3::from(ray.direction));
        let [open, close] = self.shutter;
        WorldRay {
            origin: origin.as_vec3().into(),
            direction: direction.as_vec3().into(),
            mint: self.clip[0],
            maxt: self.clip[1],
            // In this form both ends are met exactly.
            time: (1.0 - time) * open + time * close,
        }
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

    /// Where rays begin and end along themselves (`hither` and `yon`), world units.
    pub fn clip(&self) -> [f32; 2] {
        self.clip
    }

    /// When the shutter opens and closes.
    pub fn shutter(&self) -> [f32; 2] {
        self.shutter
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
                 half way to the corner, {:.1} % in the corner; pupil \"rear\" misses none",
                100.0 * axis,
                100.0 * middle,
                100.0 * edge
            ),
        );
    }
}
