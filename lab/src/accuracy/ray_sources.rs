//! Sources of camera rays, which are compared by the pictures rendered with them: cameras of the library, and models of
//! a lens with a sampled pupil.

use crate::columns::{RayColumns, SampleColumns};
use crate::{
    BLOCK,
    accuracy::cameras::{Shot, Single, camera},
    render::Rays,
    subject::{CameraSamples, FILM_DIAGONAL, Subject},
};
use realistic::ffi::realistic_sample;
use realistic_camera::{
    CameraError, Film, Parameters, Raster, Sample,
    sampling::{DiskMapping, PupilDisk, PupilSample},
};
use realistic_optics::{
    lens::{cos4, film_ray},
    trace::Ray,
};
use realistic_trace::{kernel::Traced, polynomial::PolynomialLens};
use std::convert::Infallible;

/// A source of camera rays of any kind.
pub type Source = Box<dyn FnMut(Rays<'_>) -> Result<(), Infallible>>;

fn sample(of: &realistic_sample) -> Sample {
    let realistic_sample { image_x, image_y, lens_u, lens_v, time } = *of;
    Sample { image_x, image_y, lens_u, lens_v, time }
}

/// A named source of a picture's camera rays.
#[derive(Clone, Copy, Debug)]
pub struct Renderer {
    /// Short name.
    pub name: &'static str,
    /// Builds the source for a lens.
    pub prepare: fn(&Subject, Raster) -> Result<Source, CameraError>,
}

/// All renderers that are compared, to be run with Sobol' samples.
pub const RENDERERS: &[Renderer] = &[
    Renderer { name: "blocks, 0.1 pixel", prepare: |s, r| blocks(s, r, "tolerance=0.1") },
    Renderer { name: "blocks f32, warped", prepare: |s, r| blocks(s, r, "precision=f32") },
    Renderer { name: "blocks f64, warped", prepare: |s, r| blocks(s, r, "precision=f64") },
    Renderer { name: "f32, warped", prepare: |s, r| single(s, r, "pupil=warped precision=f32") },
    Renderer { name: "f64, warped", prepare: |s, r| single(s, r, "pupil=warped precision=f64") },
    Renderer { name: "f64, rear", prepare: |s, r| single(s, r, "pupil=rear precision=f64") },
    Renderer { name: "f64, disk", prepare: |s, r| single(s, r, "pupil=disk precision=f64") },
    Renderer { name: "heckbert, rear", prepare: |s, r| single(s, r, "pupil=rear refraction=heckbert") },
    Renderer { name: "whitted, rear", prepare: |s, r| single(s, r, "pupil=rear refraction=whitted") },
    Renderer { name: "thick lens, disk", prepare: thick },
    Renderer { name: "order 5, disk", prepare: |s, r| polynomial::<5>(s, r, disk(s)) },
    Renderer { name: "order 5, warped", prepare: |s, r| polynomial::<5>(s, r, warped(s)) },
    Renderer { name: "order 9, warped", prepare: |s, r| polynomial::<9>(s, r, warped(s)) },
];

/// Builds a camera for the lens from parameters in the form `name=value`, separated by spaces.
fn camera_of(subject: &Subject, raster: Raster, given: &str) -> Result<Single, CameraError> {
    let mut parameters = Parameters::default();
    for (name, value) in given.split(' ').filter_map(|one| one.split_once('=')) {
        parameters.set_from_text(name, value)?;
    }
    camera(&subject.lens.name, raster, parameters)
}

/// Returns a camera with these parameters as a source that traces one ray per call.
pub fn single(subject: &Subject, raster: Raster, given: &str) -> Result<Source, CameraError> {
    let camera = camera_of(subject, raster, given)?;
    Ok(each(move |sample| camera.shoot(sample)))
}

/// Returns a camera with these parameters as a source that traces blocks.
fn blocks(subject: &Subject, raster: Raster, given: &str) -> Result<Source, CameraError> {
    let camera = camera_of(subject, raster, given)?;
    let (mut block, mut traced) = (SampleColumns::new(BLOCK), RayColumns::new(BLOCK));
    Ok(Box::new(move |Rays { samples, rays, weights }| {
        let out = rays.chunks_mut(BLOCK).zip(weights.chunks_mut(BLOCK));
        for (samples, (rays, weights)) in samples.chunks(BLOCK).zip(out) {
            samples.iter().enumerate().for_each(|(i, of)| block.set(i, &sample(of)));
            camera.trace(&block.first(samples.len()), &mut traced.first(samples.len()));
            for (i, (ray, weight)) in rays.iter_mut().zip(weights).enumerate() {
                let shot = traced.get(i).map(|(ray, weight)| (ray.origin, ray.direction, weight));
                (ray.o, ray.d, *weight) = shot.unwrap_or_default();
            }
        }
        Ok(())
    }))
}

fn each(shoot: impl Fn(&Sample) -> Option<Shot> + 'static) -> Source {
    Box::new(move |rays| {
        rays.fill(|of, ray| {
            let weight;
            (ray.o, ray.d, weight) = shoot(&sample(of)).unwrap_or_default();
            weight
        });
        Ok(())
    })
}

/// A function that maps a film point and a lens sample to a pupil sample of a model.
type PupilSampler = Box<dyn Fn([f64; 2], [f64; 2]) -> Option<PupilSample>>;

/// Returns the thick lens's exit pupil.
fn disk(subject: &Subject) -> PupilSampler {
    let disk: PupilDisk = subject.exit;
    Box::new(move |film, unit| Some(disk.sample(film, unit)))
}

/// Returns the true pupil.
fn warped(subject: &Subject) -> PupilSampler {
    let pupil = subject.warped_pupil();
    Box::new(move |film, unit| pupil.sample(film, unit))
}

/// Combines a pupil with a model of the lens, which maps a film point and slopes to a ray.
fn modelled(
    raster: Raster,
    pupil: PupilSampler,
    map: impl Fn([f64; 2], [f64; 2]) -> Option<Ray> + 'static,
) -> Source {
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

fn thick(subject: &Subject, raster: Raster) -> Result<Source, CameraError> {
    let (lens, film_z) = (subject.first_order, subject.film_z);
    let map = move |point, slopes| Some(lens.transfer(film_ray(point, film_z, slopes)));
    Ok(modelled(raster, disk(subject), map))
}

fn polynomial<const ORDER: usize>(
    subject: &Subject,
    raster: Raster,
    pupil: PupilSampler,
) -> Result<Source, CameraError> {
    let apertures = CameraSamples::of_warped(subject).apertures;
    let model = PolynomialLens::<f64>::new(&subject.fit(ORDER, &apertures));
    Ok(modelled(raster, pupil, move |point, slopes| model.trace_one(point, slopes).as_ref().map(Traced::ray)))
}
