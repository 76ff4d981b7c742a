//! Rendered pictures: RMS error relative to a long reference, against time on one core.

use crate::{
    accuracy::cameras::PUPILS,
    accuracy::curve::{Curve, Estimate},
    accuracy::ray_sources::{RENDERERS, Source, single},
    render::sequence::{Point, Sequence},
    render::{Integrand, Window, render},
    results::{
        statistics::median,
        table::{Table, row},
    },
    subject::Subject,
    timing::repeated,
};
use realistic::ffi::{realistic_ray, realistic_sample};
use realistic_camera::{CameraError, Raster};

/// Errors relative to the mean at which renderers are compared.
pub const NEEDS: [f64; 2] = [0.2, 0.1];

/// A function that returns the radiance of a scene along a ray in lens space, mm; the scene stands in front of a lens
/// of the given focal length, mm.
pub type Scene = fn(focal_length: f64, ray: &realistic_ray) -> f32;

/// The size of a measurement.
#[derive(Clone, Copy, Debug)]
pub struct Size {
    /// The scene, which is cheap to evaluate, so that the camera's time is visible.
    pub scene: Scene,
    /// Pixels of the picture.
    pub raster: Raster,
    /// Exponent k of the largest number of samples per pixel; the numbers of samples are the powers of 4 from 4^0 to
    /// 4^k.
    pub exponent: u32,
    /// Samples per pixel of each half of the reference.
    pub reference: usize,
    /// Number of renders of each picture; the median of their times is reported.
    pub repeats: u32,
}

/// A scene as the renderer's integrand.
struct Pictured<F> {
    scene: F,
    sequence: Sequence,
    seed: u32,
    width: u32,
    points: Vec<Point>,
}

impl<F: Fn(&realistic_ray) -> f32> Integrand<1> for Pictured<F> {
    fn place(&mut self, [x, y]: [u32; 2], _: usize, samples: &mut [realistic_sample]) {
        let seed = self.seed.wrapping_mul(0x9e37_79b9) ^ (y * self.width + x);
        self.points.resize(samples.len(), Point::default());
        self.sequence.fill(seed, 4, &mut self.points);
        for (sample, &[lens_u, lens_v, px, py]) in samples.iter_mut().zip(&self.points) {
            let [image_x, image_y] = [x as f32 + px, y as f32 + py];
            *sample = realistic_sample { image_x, image_y, lens_u, lens_v, time: 0.0 };
        }
    }

    fn radiance(&self, _: usize, ray: &realistic_ray) -> [f32; 1] {
        [(self.scene)(ray)]
    }
}

/// Renders a picture's pixels, row by row.
fn picture(
    camera: &mut Source,
    scene: impl Fn(&realistic_ray) -> f32,
    raster: Raster,
    sequence: Sequence,
    samples: usize,
    seed: u32,
) -> Vec<f64> {
    let mut pictured = Pictured { scene, sequence, seed, width: raster.xres, points: Vec::new() };
    let window = Window { corner: [0; 2], size: [raster.xres, raster.yres] };
    let Ok((pixels, _)) = render(camera, &mut pictured, window, samples);
    pixels.into_iter().flatten().collect()
}

fn rms(a: &[f64], b: &[f64]) -> f64 {
    (a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.len() as f64).sqrt()
}

/// The pictures of one lens.
#[derive(Clone, Debug, PartialEq)]
pub struct Pictures {
    /// Curves by sampler and sequence.
    pub estimators: Vec<Curve>,
    /// Curves by renderer; renderers whose pictures are identical share one.
    pub renderers: Vec<Curve>,
    /// Repeats of one curve of either kind, with other random numbers.
    pub again: Vec<Curve>,
    /// RMS error of the reference itself, relative to its mean, estimated from the reference's two halves.
    pub floor: f64,
}

/// Renders all pictures of one lens.
///
/// # Errors
/// A camera cannot be built.
pub fn measure(subject: &Subject, size: Size) -> Result<Pictures, CameraError> {
    let raster = size.raster;
    let scene = |ray: &realistic_ray| (size.scene)(subject.first_order.focal_length, ray);
    let mut exact = single(subject, raster, "pupil=rear")?;
    let mut half = |seed| picture(&mut exact, scene, raster, Sequence::Sobol, size.reference, seed);
    let (one, two) = (half(1001), half(1002));
    let reference: Vec<f64> = one.iter().zip(&two).map(|(a, b)| f64::midpoint(*a, *b)).collect();
    let mean = reference.iter().sum::<f64>() / reference.len() as f64;
    let curve =
        |camera: &mut Source, pupil: &'static str, name: &'static str, sequence: Sequence, first: u32| {
            let points: Vec<_> = (0..=size.exponent)
                .map(|power| {
                    let samples = 4_usize.pow(power);
                    let (mut times, mut errors) = (Vec::new(), Vec::new());
                    for repeat in 0..size.repeats {
                        let (pixels, took) = repeated(1, || {
                            picture(camera, scene, raster, sequence, samples, first + repeat + 1)
                        });
                        times.extend(took);
                        errors.push(rms(&pixels, &reference).powi(2));
                    }
                    let error = (errors.iter().sum::<f64>() / errors.len() as f64).sqrt() / mean;
                    Estimate { samples, time: median(&times), error, noise: error }
                })
                .collect();
            Curve { lens: subject.lens.name.clone(), pupil, disk: "concentric", sequence: name, points }
        };
    let mut estimators = Vec::new();
    for &pupil in PUPILS {
        let mut camera = single(subject, raster, &format!("pupil={pupil}"))?;
        for (name, sequence) in Sequence::NAMES {
            estimators.push(curve(&mut camera, pupil, name, sequence, 0));
        }
    }
    let (mut renderers, mut again) = (Vec::new(), Vec::new());
    for renderer in RENDERERS {
        let mut camera = (renderer.prepare)(subject, raster)?;
        let mut run = |first| curve(&mut camera, renderer.name, "Sobol'", Sequence::Sobol, first);
        let own = run(0);
        again.extend(AGAIN.contains(&renderer.name).then(|| run(size.repeats)));
        match same_picture(&mut renderers, renderer.name, &own) {
            Some(first) => share_time(first, &own),
            None => renderers.push(own),
        }
    }
    Ok(Pictures { estimators, renderers, again, floor: rms(&one, &two) / 2.0 / mean })
}

/// Renderers that are run twice.
const AGAIN: [&str; 3] = ["blocks f32, warped", "f32, warped", "f64, warped"];

/// Returns the earlier renderer that also requests rays in blocks and has exactly the same errors. Its errors are the
/// same because the planner chose the exact trace, so both renderers are one method.
fn same_picture<'a>(before: &'a mut [Curve], name: &str, own: &Curve) -> Option<&'a mut Curve> {
    let errors = |curve: &Curve| curve.points.iter().map(|point| point.error.to_bits()).collect::<Vec<_>>();
    let in_blocks = |name: &str| name.starts_with("blocks");
    before.iter_mut().find(|first| in_blocks(name) && in_blocks(first.pupil) && errors(first) == errors(own))
}

/// Replaces the times of a curve that was measured twice by their geometric mean, and keeps the second name, which
/// states what is traced.
fn share_time(first: &mut Curve, own: &Curve) {
    first.pupil = own.pupil;
    for (point, other) in first.points.iter_mut().zip(&own.points) {
        point.time = (point.time * other.time).sqrt();
    }
}

/// Returns curves as a table; `columns` names the column that distinguishes them.
pub fn table(name: &'static str, columns: &'static str, curves: &[Curve]) -> Table {
    let points = curves.iter().flat_map(|curve| curve.points.iter().map(move |point| (curve, point)));
    let rows = points.map(|(c, p)| {
        row![c.lens.as_str(), c.pupil, c.sequence, p.samples, p.time * 1e3, p.error, c.slope()]
    });
    Table::of(name, columns, rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn methods_with_equal_results_in_every_digit_are_one() {
        let curve = |pupil, error: f64, time| {
            let points = vec![Estimate { samples: 1, time, error, noise: error }];
            Curve { lens: String::new(), pupil, disk: "concentric", sequence: "Sobol'", points }
        };
        let mut before = [curve("blocks, 0.1 pixel", 0.1, 1.0), curve("f64, warped", 0.2, 8.0)];
        assert!(
            same_picture(&mut before, "blocks f32, warped", &curve("blocks f32, warped", 0.1000001, 4.0))
                .is_none()
        );
        // Requests for the same rays one by one are another kind of call, with its own time.
        assert!(
            same_picture(&mut before, "blocks f64, warped", &curve("blocks f64, warped", 0.2, 4.0)).is_none()
        );
        let own = curve("blocks f32, warped", 0.1, 4.0);
        share_time(same_picture(&mut before, "blocks f32, warped", &own).expect("the same digits"), &own);
        assert_eq!((before[0].pupil, before[0].points[0].time), ("blocks f32, warped", 2.0));
    }
}
