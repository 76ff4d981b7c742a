//! Rendered pictures: RMS error to a long reference, against time on one core.

use crate::{
    renderers::{RENDERERS, Shoot, built},
    results::{
        statistics::{log_slope, median},
        table::{Table, row},
    },
    sampler::PUPILS,
    scene::Scene,
    sequence::Sequence,
    subject::Subject,
    timing::repeated,
};
use realistic::camera::{BLOCK, CameraError, Raster, Sample, SampleBlock};

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

/// A picture's pixels, row by row.
fn render(
    shoot: &mut Shoot,
    scene: Scene,
    raster: Raster,
    sequence: Sequence,
    samples: usize,
    seed: u32,
) -> Vec<f64> {
    let mut pixels = vec![0.0; (raster.xres * raster.yres) as usize];
    let mut points = vec![[0.0; 4]; samples];
    let mut block = Box::new(SampleBlock::new());
    let (mut owners, mut shots, mut count) = ([0; BLOCK], [None; BLOCK], 0);
    let mut flush = |block: &SampleBlock, owners: &[usize; BLOCK], count: usize| {
        shoot(block, count, &mut shots);
        for (owner, shot) in owners.iter().zip(&shots[..count]) {
            if let Some((origin, direction, weight)) = *shot
                && weight > 0.0
            {
                pixels[*owner] += f64::from(weight * scene.radiance(origin, direction));
            }
        }
    };
    let places = (0..raster.yres).flat_map(|y| (0..raster.xres).map(move |x| (x, y)));
    for (number, (x, y)) in places.enumerate() {
        sequence.fill(seed.wrapping_mul(0x9e37_79b9) ^ number as u32, 4, &mut points);
        for &[lens_u, lens_v, px, py] in &points {
            let sample = Sample { image_x: x as f32 + px, image_y: y as f32 + py, lens_u, lens_v, time: 0.0 };
            block.set(count, &sample);
            owners[count] = number;
            count += 1;
            if count == BLOCK {
                flush(&block, &owners, count);
                count = 0;
            }
        }
    }
    flush(&block, &owners, count);
    pixels.iter().map(|sum| sum / samples as f64).collect()
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

impl Curve {
    /// Time, seconds, and error of every point.
    pub fn errors(&self) -> Vec<(f64, f64)> {
        self.points.iter().map(|p| (p.time, p.error)).collect()
    }
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
    let mut exact = built(subject, raster, &[("pupil", "rear")])?;
    let mut half = |seed| render(&mut exact, scene, raster, Sequence::Sobol, size.reference, seed);
    let (one, two) = (half(1001), half(1002));
    let reference: Vec<f64> = one.iter().zip(&two).map(|(a, b)| f64::midpoint(*a, *b)).collect();
    let mean = reference.iter().sum::<f64>() / reference.len() as f64;
    let curve = |shoot: &mut Shoot, first: &'static str, second: &'static str, sequence: Sequence| {
        let points: Vec<_> = (0..=size.exponent)
            .map(|power| {
                let samples = 4_usize.pow(power);
                let (mut times, mut errors) = (Vec::new(), Vec::new());
                for repeat in 0..size.repeats {
                    let (picture, took) =
                        repeated(1, || render(shoot, scene, raster, sequence, samples, repeat + 1));
                    times.extend(took);
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
        let mut shoot = built(subject, raster, &[("pupil", pupil)])?;
        for (name, sequence) in Sequence::NAMES {
            estimators.push(curve(&mut shoot, pupil, name, sequence));
        }
    }
    let mut renderers = Vec::new();
    for renderer in RENDERERS {
        let mut shoot = (renderer.prepare)(subject, raster)?;
        renderers.push(curve(&mut shoot, renderer.name, "Sobol'", Sequence::Sobol));
    }
    Ok(Pictures { estimators, renderers, floor: rms(&one, &two) / 2.0 / mean })
}

/// Curves as a table, whose second heading is what tells them apart.
pub fn table(name: &'static str, columns: &'static str, curves: &[Curve]) -> Table {
    let points = curves.iter().flat_map(|curve| curve.points.iter().map(move |point| (curve, point)));
    let rows = points
        .map(|(c, p)| row![c.lens.as_str(), c.first, c.second, p.samples, p.time * 1e3, p.error, c.slope]);
    Table::of(name, columns, rows)
}
