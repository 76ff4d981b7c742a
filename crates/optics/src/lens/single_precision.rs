//! Limits within which single precision can trace a lens.
//!
//! The limits come from the stability cases. Within them, the error in direction of an f32 tracer stays below 1e-4 rad
//! away from total reflection, and below 1e-6 for ordinary lenses. The amplification is summed over all surfaces, so
//! that a lens with more surfaces has more of it. Rounding errors specific to the compiled kernels (growth of rounding
//! in `trace::kernel`) are bounded when a lens is compiled.

use super::{Lens, first_order::Abcd};

/// Lengths, mm, whose squares stay in the number range of single precision.
const LENGTHS: std::ops::RangeInclusive<f64> = 1e-15..=1e15;
/// Smallest nonzero step n' - n of the index: more than a thousand rounding errors.
const LEAST_INDEX_STEP: f64 = 1e-4;
/// Smallest value of 1 - (semi-diameter/|R|)². Below it, rays meet the edge of the clear aperture at grazing incidence.
const LEAST_NEARNESS: f64 = 1e-3;
/// Largest ratio of the maximum length to the minimum clear semi-diameter.
const GREATEST_RATIO: f64 = 1e4;
/// Largest error in direction on the scene's side, relative to the rounding error.
const GREATEST_AMPLIFICATION: f64 = 100.0;

/// Checks that single precision can trace rays from the film through `lens`.
///
/// # Errors
/// The lens exceeds a limit; the text states the first such limit, and a remedy.
pub fn f32_is_fit(lens: &Lens) -> Result<(), String> {
    let mut narrowest = f64::INFINITY;
    let mut longest = 0.0_f64;
    let mut amplification = 0.0;
    for (number, surface) in lens.surfaces.iter().enumerate() {
        let semi_diameter = surface.semi_diameter;
        for length in [semi_diameter, surface.thickness] {
            if length != 0.0 && !LENGTHS.contains(&length) && (length > 1.0 || length == semi_diameter) {
                return Err(format!(
                    "a length of {length:.1e} mm squares out of the range of f32; use f64, or scale the lens"
                ));
            }
        }
        let step = surface.n_film - surface.n_scene;
        if step != 0.0 && step.abs() < LEAST_INDEX_STEP {
            return Err(format!(
                "surface {number} steps the index by {step:.1e}, which f32 rounds away; use f64"
            ));
        }
        let nearness = surface.least_cosine_squared();
        if nearness < LEAST_NEARNESS {
            return Err(format!(
                "surface {number} is a hemisphere to 1 - {nearness:.1e} at the edge of its aperture, where f32 loses the \
                 angle; use f64"
            ));
        }
        narrowest = narrowest.min(semi_diameter);
        longest = longest.max(semi_diameter).max(surface.thickness);
        // Effect, on the scene side, of perturbing a ray at this surface by 1 in slope and by the semi-diameter in
        // height.
        let matrix = Abcd::in_front_of(lens, number);
        amplification += (matrix.c * semi_diameter).powi(2) + matrix.a.powi(2);
    }
    let (ratio, factor) = (longest / narrowest, amplification.sqrt());
    if ratio > GREATEST_RATIO {
        return Err(format!(
            "lengths differ by a factor of {ratio:.1e}: f32 cannot tell whether a ray passes the narrowest aperture; use f64"
        ));
    }
    if !(factor <= GREATEST_AMPLIFICATION) {
        return Err(format!("the lens amplifies rounding {factor:.1e} times; use f64"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prescription::catalogue;

    fn lens(name: &str, factor: f64) -> Lens {
        Lens::at_d_line(&catalogue::find(name).expect("in the catalogue").scaled(factor))
    }

    #[test]
    fn single_precision_suits_the_catalogue_at_sensible_sizes() {
        for name in catalogue::round() {
            for factor in [1e-6, 1.0, 1e6] {
                assert_eq!(f32_is_fit(&lens(name, factor)), Ok(()), "{name} x {factor}");
            }
        }
    }

    #[test]
    fn each_rule_refuses_what_it_is_for() {
        let refused = |lens: &Lens, words: &str| {
            let why = f32_is_fit(lens).expect_err(words);
            assert!(why.contains(words), "{why}");
        };
        let mut tiny = lens("dgauss.50mm", 1e-20);
        refused(&tiny, "squares out of the range");
        tiny = lens("dgauss.50mm", 1.0);
        tiny.surfaces[5].semi_diameter = 1e-4;
        refused(&tiny, "lengths differ by a factor");
        let mut hemisphere = lens("dgauss.50mm", 1.0);
        hemisphere.surfaces[0].semi_diameter = hemisphere.surfaces[0].radius;
        refused(&hemisphere, "surface 0 is a hemisphere");
        let mut weak = lens("dgauss.50mm", 1.0);
        weak.surfaces[0].n_film = 1.0 + 1e-6;
        refused(&weak, "surface 0 steps the index");
    }
}
