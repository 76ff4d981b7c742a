//! A look through a camera that was just built, before a host renders with it for hours: whether any ray gets through.

use std::fmt::Write;

use crate::{
    camera::{
        film::Raster,
        host::{Level, Log},
        ray::{Outcome, Sample},
    },
    numeric::quasirandom::STEPS,
    trace::Blocked,
};

/// Samples that are tried at most; the first that makes a ray is the last one.
const SAMPLES: u32 = 4096;

/// Warns where no sample of many, evenly over picture and pupil, makes a ray by `generate`, and says what becomes of
/// them.
pub(crate) fn warn_of_darkness(raster: Raster, generate: impl Fn(&Sample) -> Outcome, log: Log<'_>) {
    // Missed, clipped, reflected, turned back.
    let mut counts = [0_u32; 4];
    // Number 0 is the ray along the axis, which the smallest hole lets through.
    for number in 1..=SAMPLES {
        let [x, y, u, v] = STEPS.map(|step| (0.5 + f64::from(number) * step).fract());
        let sample = Sample {
            image_x: (x * f64::from(raster.xres)) as f32,
            image_y: (y * f64::from(raster.yres)) as f32,
            lens_u: u as f32,
            lens_v: v as f32,
            time: 0.5,
        };
        match generate(&sample) {
            Outcome::Ray(..) => return,
            Outcome::Blocked(reason) => {
                counts[match reason {
                    Blocked::Missed => 0,
                    Blocked::Clipped => 1,
                    Blocked::Reflected => 2,
                    Blocked::TurnedBack => 3,
                }] += 1;
            }
            Outcome::Redraw | Outcome::Shut | Outcome::Wavelength => {}
        }
    }
    let mut text =
        format!("no ray gets through, and the picture will be black: of {SAMPLES} over picture and pupil");
    let fates = ["miss a surface", "are clipped by an aperture", "are totally reflected", "are turned back"];
    for (count, fate) in counts.into_iter().zip(fates).filter(|(count, _)| *count > 0) {
        // Infallible: a string takes whatever is written to it.
        let _ = write!(text, ", {count} {fate}");
    }
    log(Level::Warning, &(text + "; check the lens's diameters, the stop and \"filmdistance\""));
}
