//! Error against time of estimators of film irradiance in a uniform field of radiance 1.

use realistic_camera::{CameraError, Parameters, Sample, Value};
use realistic_optics::imaging::irradiance::survey;

use crate::{
    accuracy::cameras::{DISKS, PUPILS, Single, camera},
    accuracy::curve::{Curve, Estimate},
    render::sequence::Sequence,
    results::table::{Table, row},
    subject::{PIXELS, Subject},
    timing::{Effort, interleaved},
};

/// Film points, as fractions of the half-diagonal toward a corner.
pub const FIELDS: [f64; 5] = [0.0, 0.3, 0.55, 0.75, 0.95];

/// Relative errors at which estimators are compared.
pub const NEEDS: [f64; 2] = [1e-2, 2e-3];

/// Numbers of samples and repetitions of a measurement.
#[derive(Clone, Copy, Debug)]
pub struct SampleCounts {
    /// Exponent k of the largest number of samples, 4^k.
    pub exponent: u32,
    /// Independent repetitions.
    pub repeats: u32,
    /// Rays across the rear element for the exact values.
    pub survey: u32,
    /// Duration of the timing.
    pub effort: Effort,
}

/// Returns the raster coordinates of a film point.
pub(super) fn raster(field: f64) -> [f32; 2] {
    [PIXELS.xres, PIXELS.yres].map(|side| (f64::from(side) / 2.0 * (1.0 + field)) as f32)
}

/// Returns the lit film points, with their irradiance by brute force.
fn exact(subject: &Subject, rays: u32) -> Vec<(f64, f64)> {
    let at = |field: f64| {
        let [x, y] = raster(field);
        let point = subject.film.point(x.into(), y.into());
        let cover = subject.rear.seen_from(point);
        survey(&subject.path, subject.film_z, point, cover, cover, rays).irradiance
    };
    FIELDS.map(|field| (field, at(field))).into_iter().filter(|(_, irradiance)| *irradiance > 0.0).collect()
}

fn estimate(camera: &Single, [image_x, image_y]: [f32; 2], points: &[[f32; 4]]) -> f64 {
    let (mut sum, mut count) = (0.0, 0_u32);
    for &[lens_u, lens_v, ..] in points {
        let sample = Sample { image_x, image_y, lens_u, lens_v, time: 0.0 };
        if let Some((.., weight)) = camera.shoot(&sample) {
            sum += f64::from(weight);
            count += 1;
        }
    }
    sum / f64::from(count.max(1))
}

/// Measures every estimator on one lens, and some estimators a second time with other random numbers.
///
/// # Errors
/// A camera cannot be built.
pub fn measure(subject: &Subject, counts: SampleCounts) -> Result<(Vec<Curve>, Vec<Curve>), CameraError> {
    let exact = exact(subject, counts.survey);
    let mut curves = Vec::new();
    let mut again = Vec::new();
    let mut cameras = Vec::new();
    for &pupil in PUPILS {
        for &disk in DISKS {
            let mut given = Parameters::default();
            given.set("pupil", Value::Text(pupil))?;
            given.set("disk", Value::Text(disk))?;
            let camera = camera(&subject.lens.name, PIXELS, given)?;
            for (sequence, placed) in Sequence::NAMES {
                let curve = |seed: u32| {
                    let samples = (1..=counts.exponent).map(|power| 4_usize.pow(power));
                    let points = samples
                        .map(|samples| precision(&camera, placed, &exact, samples, counts.repeats, seed))
                        .collect();
                    Curve { lens: subject.lens.name.clone(), pupil, disk, sequence, points }
                };
                // Unbiased estimators are measured again with other random numbers.
                again.extend((disk == DISKS[0] && pupil != "disk").then(|| curve(counts.repeats)));
                curves.push(curve(0));
            }
            cameras.push(camera);
        }
    }
    time(&cameras, counts.effort, &mut curves);
    for curve in &mut again {
        let first = curves.iter().find(|first| first.is_like(curve)).expect("measured with it");
        curve.points.iter_mut().zip(&first.points).for_each(|(point, first)| point.time = first.time);
    }
    Ok((curves, again))
}

/// Computes error and noise; the time follows later, for all curves together.
fn precision(
    camera: &Single,
    placed: Sequence,
    exact: &[(f64, f64)],
    samples: usize,
    repeats: u32,
    first: u32,
) -> Estimate {
    let mut points = vec![[0.0; 4]; samples];
    let (mut error, mut noise) = (0.0, 0.0);
    for (number, (field, exact)) in exact.iter().enumerate() {
        let relative: Vec<f64> = (0..repeats)
            .map(|repeat| {
                placed.fill((first + repeat) * FIELDS.len() as u32 + number as u32 + 1, 2, &mut points);
                estimate(camera, raster(*field), &points) / exact - 1.0
            })
            .collect();
        let count = f64::from(repeats);
        let mean = relative.iter().sum::<f64>() / count;
        error += relative.iter().map(|e| e * e).sum::<f64>() / count;
        noise += relative.iter().map(|e| (e - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
    }
    let root = |sum: f64| (sum / exact.len() as f64).sqrt();
    Estimate { samples, time: f64::NAN, error: root(error), noise: root(noise) }
}

/// Times a sample of every curve, including the generation of its lens sample.
fn time(cameras: &[Single], effort: Effort, curves: &mut [Curve]) {
    const BLOCK: usize = 1024;
    let pairs = cameras.iter().flat_map(|camera| Sequence::NAMES.map(|(_, placed)| (camera, placed)));
    let tasks = pairs.map(|(camera, placed)| {
        let (mut points, mut turn) = (vec![[0.0; 4]; BLOCK], 0);
        let task = move || {
            turn += 1;
            placed.fill(turn, 2, &mut points);
            let field = FIELDS[turn as usize % FIELDS.len()];
            std::hint::black_box(estimate(camera, raster(field), &points));
        };
        Box::new(task) as Box<dyn FnMut()>
    });
    for (curve, timing) in curves.iter_mut().zip(interleaved(tasks, effort)) {
        for point in &mut curve.points {
            point.time = timing.median / BLOCK as f64 * point.samples as f64;
        }
    }
}

/// Returns the results as a table.
pub fn table(curves: &[Curve]) -> Table {
    let points = curves.iter().flat_map(|curve| curve.points.iter().map(move |point| (curve, point)));
    let rows = points.map(|(c, p)| {
        let names = row![c.lens.as_str(), c.pupil, c.disk, c.sequence];
        [names, row![p.samples, p.time * 1e6, p.error, p.noise, c.slope(), c.bias()]].concat()
    });
    Table::of("irradiance", "lens pupil disk sequence samples time_us rms_error noise slope bias", rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_optics::prescription::catalogue;
    use std::time::Duration;

    #[test]
    fn the_rear_disk_is_unbiased_and_random_noise_falls_as_the_root() {
        let subject = Subject::new(&catalogue::find("dgauss.50mm").expect("listed")).expect("focuses");
        let effort = Effort { rounds: 1, least: Duration::from_micros(10) };
        let counts = SampleCounts { exponent: 5, repeats: 8, survey: 300, effort };
        let (curves, again) = measure(&subject, counts).expect("cameras");
        for curve in &again {
            let first = curves.iter().find(|first| first.is_like(curve)).expect("measured with it");
            assert_ne!(first.points, curve.points);
            let error = first.points[2].error;
            assert!(
                first.apart(curve, &[error]).iter().all(|ratio| (1.0..4.0).contains(ratio)),
                "{first:?} {curve:?}"
            );
        }
        assert_eq!(again.len(), 2 * Sequence::NAMES.len());
        assert_eq!(curves.len(), PUPILS.len() * DISKS.len() * Sequence::NAMES.len());
        for curve in &curves {
            assert!(curve.points.iter().all(|p| p.time > 0.0));
            if curve.sequence == "random" {
                assert!((curve.slope() + 0.5).abs() < 0.1, "{curve:?}");
            }
            // Wide open, the thick lens's pupil misses about a tenth of the light on the axis.
            let last = curve.points.last().expect("some");
            match curve.pupil {
                "disk" => assert!(curve.bias() > 0.01, "{curve:?}"),
                _ => assert!(last.error < 1.5 * last.noise, "{curve:?}"),
            }
        }
        let noise = |sequence| {
            let curve =
                curves.iter().find(|c| (c.pupil, c.disk, c.sequence) == ("rear", "concentric", sequence));
            curve.expect("measured").points.last().expect("some").noise
        };
        assert!(noise("Sobol'") < noise("random") / 2.0);
    }
}
