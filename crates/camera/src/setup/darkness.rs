//! Warns of dark cameras, before a host renders with one for hours: cameras in which no ray gets through or
//! most of the film is dark.

use std::fmt::Write;

use crate::{
    film::{Film, Raster},
    host::{Level, Log},
    pipeline::ray_maker::RayMaker,
    rays::Outcome,
    samples::Sample,
};
use realistic_base::{message::short, numeric::STEPS};
use realistic_optics::trace::Blocked;

/// Maximum number of samples that are tried, one block at a time; the search stops after the first block in
/// which a ray passes.
const SAMPLES: usize = 4096;
const BLOCK: usize = 64;
/// Number of samples whose outcomes the warning reports; each is traced separately.
const REPORTED: usize = 256;

/// Warns if none of many samples, spread uniformly over picture and pupil, gives a ray, and reports the
/// outcomes of some samples as returned by `why_none`. If few samples give a ray, warns if most of a lens's
/// film is dark; `lens` holds the film and a function that returns the distance from the axis up to which
/// light reaches the film.
pub fn warn_of_darkness(
    raster: Raster,
    rays: &RayMaker,
    lens: Option<(&Film, impl Fn() -> Option<f64>)>,
    why_none: impl Fn(&Sample) -> Outcome,
    log: Log<'_>,
) {
    let sample = |number: usize| {
        // Sample 0 is the ray along the axis, which passes even the smallest hole.
        let [x, y, u, v] = STEPS.map(|step| (0.5 + (number + 1) as f64 * step).fract());
        Sample {
            image_x: (x * f64::from(raster.xres)) as f32,
            image_y: (y * f64::from(raster.yres)) as f32,
            lens_u: u as f32,
            lens_v: v as f32,
            time: 0.5,
        }
    };
    for first in (0..SAMPLES).step_by(BLOCK) {
        let passed = (first..first + BLOCK).filter(|&number| rays.ray(&sample(number)).is_some()).count();
        if passed > 0 {
            // Most samples get through to a lit film, unless the sampled region is much larger than the
            // pupil.
            if let Some((film, lit_radius)) = lens.filter(|_| 2 * passed < BLOCK)
                && let Some(lit) = lit_radius()
            {
                warn_of_dark_film(film, lit, sample, log);
            }
            return;
        }
    }
    // Counts of rays that missed a surface, were clipped, were totally reflected, or turned back.
    let mut counts = [0_u32; 4];
    for number in 0..REPORTED {
        if let Outcome::Blocked(reason) = why_none(&sample(number)) {
            counts[match reason {
                Blocked::Missed => 0,
                Blocked::Clipped => 1,
                Blocked::Reflected => 2,
                Blocked::TurnedBack => 3,
            }] += 1;
        }
    }
    let mut text = format!(
        "no ray gets through of {SAMPLES} over picture and pupil, and the picture will be black: of {REPORTED} of them"
    );
    let fates = ["miss a surface", "are clipped by an aperture", "are totally reflected", "are turned back"];
    for (count, fate) in counts.into_iter().zip(fates).filter(|(count, _)| *count > 0) {
        // Infallible: writing to a string never fails.
        let _ = write!(text, ", {count} {fate}");
    }
    log(Level::Warning, &(text + "; check the lens's diameters, the stop and \"film_distance\""));
}

/// Warns if light, which reaches `lit` mm from the axis, covers less than half of the film. The covered
/// fraction is measured at the film points of samples spread uniformly over the picture.
fn warn_of_dark_film(film: &Film, lit: f64, sample: impl Fn(usize) -> Sample, log: Log<'_>) {
    let is_lit = |number: &usize| {
        let Sample { image_x, image_y, .. } = sample(*number);
        let [x, y] = film.point(image_x.into(), image_y.into());
        x.hypot(y) <= lit
    };
    if 2 * (0..REPORTED).filter(is_lit).count() < REPORTED {
        let diagonal = film.diagonal_within(lit);
        let advice = if diagonal > 0.0 {
            format!("\"film_diagonal\" {} mm or less", short(diagonal))
        } else {
            "smaller \"film_shift_x\" and \"film_shift_y\"".to_owned()
        };
        let text = format!(
            "most of the film is dark: light reaches it up to {} mm from the axis, and its corners lie {} mm away; for a \
             picture without a black border give {advice}",
            short(lit),
            short(film.corner())
        );
        log(Level::Warning, &text);
    }
}
