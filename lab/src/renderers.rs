//! The ways to take a whole picture that are compared.

use crate::{
    ray_map::fit,
    sampler::{Shot, camera},
    subject::{FILM_DIAGONAL, Subject},
};
use realistic::{
    camera::{BLOCK, CameraError, Film, Parameters, Precision, Raster, RayBlock, Sample, SampleBlock, Value},
    imaging::irradiance::{cos4, film_ray},
    sampling::{DiskMapping, PupilDisk, PupilSample, WarpedPupil},
    trace::{Ray, kernel::Traced, polynomial::PolynomialLens},
};

/// The first so many samples of a block in, rays and weights out.
pub type Shoot = Box<dyn FnMut(&SampleBlock, usize, &mut [Option<Shot>; BLOCK])>;

/// A way to take the picture.
#[derive(Clone, Copy, Debug)]
pub struct Renderer {
    /// Short name.
    pub name: &'static str,
    /// Makes it ready for a lens.
    pub prepare: fn(&Subject, Raster) -> Result<Shoot, CameraError>,
}

/// Every way to take a whole picture that is compared, all with Sobol' numbers.
pub const RENDERERS: &[Renderer] = &[
    Renderer { name: "blocks, 0.1 pixel", prepare: |s, r| blocks(s, r, None, 0.1) },
    Renderer { name: "blocks f32, warped", prepare: |s, r| blocks(s, r, Some(Precision::Single), 0.0) },
    Renderer { name: "blocks f64, warped", prepare: |s, r| blocks(s, r, Some(Precision::Double), 0.0) },
    Renderer {
        name: "f32, warped",
        prepare: |s, r| built(s, r, &[("pupil", "warped"), ("precision", "f32")]),
    },
    Renderer {
        name: "f64, warped",
        prepare: |s, r| built(s, r, &[("pupil", "warped"), ("precision", "f64")]),
    },
    Renderer { name: "f64, rear", prepare: |s, r| built(s, r, &[("pupil", "rear"), ("precision", "f64")]) },
    Renderer { name: "f64, disk", prepare: |s, r| built(s, r, &[("pupil", "disk"), ("precision", "f64")]) },
    Renderer {
        name: "heckbert, rear",
        prepare: |s, r| built(s, r, &[("pupil", "rear"), ("refraction", "heckbert")]),
    },
    Renderer {
        name: "whitted, rear",
        prepare: |s, r| built(s, r, &[("pupil", "rear"), ("refraction", "whitted")]),
    },
    Renderer { name: "thick lens, disk", prepare: thick },
    Renderer { name: "order 5, disk", prepare: |s, r| polynomial::<5>(s, r, disk(s)) },
    Renderer { name: "order 5, warped", prepare: |s, r| polynomial::<5>(s, r, warped(s)) },
    Renderer { name: "order 9, warped", prepare: |s, r| polynomial::<9>(s, r, warped(s)) },
];

fn named(given: &[(&str, &str)]) -> Result<Parameters, CameraError> {
    let mut parameters = Parameters::default();
    for (name, value) in given {
        parameters.set(name, Value::Text(value))?;
    }
    Ok(parameters)
}

/// A camera with these text parameters, asked for ray after ray.
pub fn built(subject: &Subject, raster: Raster, given: &[(&str, &str)]) -> Result<Shoot, CameraError> {
    let camera = camera(&subject.lens.name, raster, named(given)?)?;
    Ok(each(move |sample| camera.shoot(sample)))
}

/// A camera with the warped pupil that is asked for blocks, in a precision or with a tolerance in pixels.
fn blocks(
    subject: &Subject,
    raster: Raster,
    precision: Option<Precision>,
    tolerance: f64,
) -> Result<Shoot, CameraError> {
    let given = Parameters { precision, tolerance: Some(tolerance), ..Parameters::default() };
    let camera = camera(&subject.lens.name, raster, given)?;
    let mut rays = Box::new(RayBlock::new());
    Ok(Box::new(move |samples, count, shots| {
        camera.rays(&samples.arrays(count), &mut rays.arrays(count));
        for (i, shot) in shots[..count].iter_mut().enumerate() {
            *shot = rays.get(i).map(|(ray, weight)| (ray.origin, ray.direction, weight));
        }
    }))
}

/// Sample after sample.
fn each(shoot: impl Fn(&Sample) -> Option<Shot> + 'static) -> Shoot {
    Box::new(move |samples, count, shots| {
        let samples = samples.arrays(count);
        for (i, shot) in shots[..count].iter_mut().enumerate() {
            *shot = shoot(&samples.get(i));
        }
    })
}

/// Where in the pupil a model's rays go.
type Pupil = Box<dyn Fn([f64; 2], [f64; 2]) -> Option<PupilSample>>;

/// The thick lens's exit pupil.
fn disk(subject: &Subject) -> Pupil {
    let disk: PupilDisk = subject.exit;
    Box::new(move |film, unit| Some(disk.sample(film, unit)))
}

/// The true pupil.
fn warped(subject: &Subject) -> Pupil {
    let pupil = table(subject);
    Box::new(move |film, unit| pupil.sample(film, unit))
}

/// The true pupil's table as a camera makes it.
pub fn table(subject: &Subject) -> WarpedPupil {
    let Subject { path, film_z, film, rear, exit, .. } = subject;
    WarpedPupil::new(path, *film_z, film.reach(), *rear, exit.seen_from([1.0, 0.0]).center[0])
}

/// A model of the lens, from film point and slopes to a ray, over a pupil.
fn modelled(
    raster: Raster,
    pupil: Pupil,
    map: impl Fn([f64; 2], [f64; 2]) -> Option<Ray> + 'static,
) -> Shoot {
    let film = Film::new(raster, FILM_DIAGONAL);
    each(move |sample| {
        let point = film.point(sample.image_x.into(), sample.image_y.into());
        let unit = DiskMapping::Concentric.map(sample.lens_u.into(), sample.lens_v.into())?;
        let PupilSample { slopes, area } = pupil(point, unit)?;
        let ray = map(point, slopes)?;
        let narrow = |vector: [f64; 3]| vector.map(|x| x as f32);
        Some((narrow(ray.origin), narrow(ray.direction), (area * cos4(slopes)) as f32))
    })
}

fn thick(subject: &Subject, raster: Raster) -> Result<Shoot, CameraError> {
    let (lens, film_z) = (subject.first_order, subject.film_z);
    let map = move |point, slopes| Some(lens.transfer(film_ray(point, film_z, slopes)));
    Ok(modelled(raster, disk(subject), map))
}

fn polynomial<const ORDER: usize>(
    subject: &Subject,
    raster: Raster,
    pupil: Pupil,
) -> Result<Shoot, CameraError> {
    let model = PolynomialLens::<f64>::new(&fit(subject, ORDER));
    Ok(modelled(raster, pupil, move |point, slopes| model.trace_one(point, slopes).as_ref().map(Traced::ray)))
}
