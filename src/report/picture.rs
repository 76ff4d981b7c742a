//! Rendered pictures: RMS error to a long reference, against time on one core.

use super::{
    clock::now,
    ray_map::FIT_RAYS,
    sampler::{PUPILS, Shot, camera, shoot},
    scene::Scene,
    sequence::Sequence,
    statistics::{log_slope, median},
    subject::{FILM_DIAGONAL, Subject},
    table::Table,
};
use crate::{
    camera::{
        CameraError, DiskMapping, Film, Parameters, Raster, Sample,
        irradiance::{cos4, film_ray},
    },
    trace::{Ray, polynomial::Polynomial},
};

/// How much is measured.
#[derive(Clone, Copy, Debug)]
pub struct Size {
    /// Pixels of the picture.
    pub raster: Raster,
    /// Samples a pixel are 4 to the powers from 0 to this.
    pub exponent: u32,
    /// Samples a pixel of each half of the reference.
    pub reference: usize,
    /// Renders of each picture, the median of whose times counts.
    pub repeats: u32,
}

/// A sample in, a ray and its weight out.
type Shoot = Box<dyn Fn(&Sample) -> Option<Shot>>;

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
    Renderer { name: "f64, rear", prepare: |s, r| built(s, r, &[("pupil", "rear")]) },
    Renderer { name: "f32, rear", prepare: |s, r| built(s, r, &[("pupil", "rear"), ("precision", "f32")]) },
    Renderer { name: "f64, disk", prepare: |s, r| built(s, r, &[("pupil", "disk")]) },
    Renderer { name: "f32, disk", prepare: |s, r| built(s, r, &[("pupil", "disk"), ("precision", "f32")]) },
    Renderer {
        name: "heckbert, rear",
        prepare: |s, r| built(s, r, &[("pupil", "rear"), ("refraction", "heckbert")]),
    },
    Renderer {
        name: "whitted, rear",
        prepare: |s, r| built(s, r, &[("pupil", "rear"), ("refraction", "whitted")]),
    },
    Renderer { name: "thick lens", prepare: thick },
    Renderer { name: "order 5, disk", prepare: polynomial::<5> },
    Renderer { name: "order 9, disk", prepare: polynomial::<9> },
];

/// A camera with text parameters.
fn built(subject: &Subject, raster: Raster, given: &[(&str, &str)]) -> Result<Shoot, CameraError> {
    let mut parameters = Parameters::default();
    for (name, value) in given {
        parameters.set(name, crate::camera::Value::Text(value))?;
    }
    let camera = camera(&subject.lens.name, raster, parameters)?;
    Ok(Box::new(move |sample| shoot(&camera, sample)))
}

/// A model that blocks no ray, over the thick lens's exit pupil.
fn modelled(subject: &Subject, raster: Raster, map: impl Fn(Ray) -> Ray + 'static) -> Shoot {
    let (pupil, film_z, film) = (subject.exit, subject.film_z, Film::new(raster, FILM_DIAGONAL));
    Box::new(move |sample| {
        let point = film.point(sample.image_x.into(), sample.image_y.into());
        let [u, v] = DiskMapping::Concentric.map(sample.lens_u.into(), sample.lens_v.into())?;
        let disk = pupil.seen_from(point);
        let slopes = [disk.center[0] + disk.radius * u, disk.center[1] + disk.radius * v];
        let ray = map(film_ray(point, film_z, slopes));
        let narrow = |vector: [f64; 3]| vector.map(|x| x as f32);
        Some((narrow(ray.origin), narrow(ray.direction), (pupil.slope_area() * cos4(slopes)) as f32))
    })
}

fn thick(subject: &Subject, raster: Raster) -> Result<Shoot, CameraError> {
    let lens = subject.first_order;
    Ok(modelled(subject, raster, move |ray| lens.transfer(ray)))
}

fn polynomial<const ORDER: usize>(subject: &Subject, raster: Raster) -> Result<Shoot, CameraError> {
    let model = Polynomial::fit(&subject.lens, subject.film_z, &subject.rays(FIT_RAYS, 0), ORDER)
        .expect("the subject's rays are spread over film and pupil");
    Ok(modelled(subject, raster, move |ray| model.transfer(ray)))
}

/// A picture's pixels, row by row.
fn render(
    shoot: &Shoot,
    scene: Scene,
    raster: Raster,
    sequence: Sequence,
    samples: usize,
    seed: u32,
) -> Vec<f64> {
    let mut points = vec![[0.0; 4]; samples];
    let pixels = (0..raster.yres).flat_map(|y| (0..raster.xres).map(move |x| (x, y)));
    pixels
        .map(|(x, y)| {
            sequence.fill(seed.wrapping_mul(0x9e37_79b9) ^ (y * raster.xres + x), 4, &mut points);
            let mut sum = 0.0;
            for &[lens_u, lens_v, px, py] in &points {
                let sample =
                    Sample { image_x: x as f32 + px, image_y: y as f32 + py, lens_u, lens_v, time: 0.0 };
                if let Some((origin, direction, weight)) = shoot(&sample)
                    && weight > 0.0
                {
                    sum += f64::from(weight * scene.radiance(origin, direction));
                }
            }
            sum / samples as f64
        })
        .collect()
}

fn rms(a: &[f64], b: &[f64]) -> f64 {
    (a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.len() as f64).sqrt()
}

/// One picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Precision {
    /// Samples a pixel.
    pub samples: usize,
    /// Time on one core, seconds.
    pub time: f64,
    /// RMS error to the reference over its mean.
    pub error: f64,
}

/// One way to render on one lens.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The lens.
    pub lens: String,
    /// The way: a sampler and a sequence, or a renderer.
    pub name: String,
    /// How the pupil is sampled, or the renderer's name.
    pub first: &'static str,
    /// Where the numbers come from.
    pub second: &'static str,
    /// By rising samples a pixel.
    pub points: Vec<Precision>,
    /// Exponent of the error as a power of the samples.
    pub slope: f64,
}

/// The pictures of one lens.
#[derive(Clone, Debug, PartialEq)]
pub struct Pictures {
    /// By sampler and sequence.
    pub estimators: Vec<Curve>,
    /// By renderer.
    pub renderers: Vec<Curve>,
    /// RMS error of the reference itself over its mean, from its two halves.
    pub floor: f64,
}

/// Renders everything for one lens.
///
/// # Errors
/// A camera cannot be built.
pub fn measure(subject: &Subject, size: Size) -> Result<Pictures, CameraError> {
    let raster = size.raster;
    let scene = Scene::new(subject.first_order.focal_length);
    let exact = built(subject, raster, &[("pupil", "rear")])?;
    let half = |seed| render(&exact, scene, raster, Sequence::Sobol, size.reference, seed);
    let (one, two) = (half(1001), half(1002));
    let reference: Vec<f64> = one.iter().zip(&two).map(|(a, b)| f64::midpoint(*a, *b)).collect();
    let mean = reference.iter().sum::<f64>() / reference.len() as f64;
    let curve = |shoot: &Shoot, first: &'static str, second: &'static str, sequence: Sequence| {
        let points: Vec<_> = (0..=size.exponent)
            .map(|power| {
                let samples = 4_usize.pow(power);
                let (mut times, mut errors) = (Vec::new(), Vec::new());
                for repeat in 0..size.repeats {
                    let start = now();
                    let picture = render(shoot, scene, raster, sequence, samples, repeat + 1);
                    times.push((now() - start).as_secs_f64());
                    errors.push(rms(&picture, &reference).powi(2));
                }
                let error = (errors.iter().sum::<f64>() / errors.len() as f64).sqrt() / mean;
                Precision { samples, time: median(&times), error }
            })
            .collect();
        let slope = log_slope(&points.iter().map(|p| (p.samples as f64, p.error)).collect::<Vec<_>>());
        Curve {
            lens: subject.lens.name.clone(),
            name: format!("{first}, {second}"),
            first,
            second,
            points,
            slope: slope.unwrap_or(f64::NAN),
        }
    };
    let mut estimators = Vec::new();
    for &pupil in PUPILS {
        let shoot = built(subject, raster, &[("pupil", pupil)])?;
        for (name, sequence) in Sequence::NAMES {
            estimators.push(curve(&shoot, pupil, name, sequence));
        }
    }
    let mut renderers = Vec::new();
    for renderer in RENDERERS {
        let shoot = (renderer.prepare)(subject, raster)?;
        renderers.push(curve(&shoot, renderer.name, "Sobol'", Sequence::Sobol));
    }
    Ok(Pictures { estimators, renderers, floor: rms(&one, &two) / 2.0 / mean })
}

/// Curves as a table, `first` being the heading of what tells them apart.
pub fn table(name: &str, first: &'static str, curves: &[Curve]) -> Table {
    let mut table =
        Table::new(name, &["lens", first, "sequence", "samples", "time_ms", "rms_error", "slope"]);
    for curve in curves {
        for p in &curve.points {
            table.rows.push(vec![
                curve.lens.as_str().into(),
                curve.first.into(),
                curve.second.into(),
                p.samples.into(),
                (p.time * 1e3).into(),
                p.error.into(),
                curve.slope.into(),
            ]);
        }
    }
    table
}
