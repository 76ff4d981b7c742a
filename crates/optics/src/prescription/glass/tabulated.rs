//! A glass of which indices at some wavelengths are known. Its formula is that of Schott with at most four constants,
//! n² = a λ² + b + c λ^-2 + d λ^-4, which follows these indices to some 1e-4 over the visible.

use std::ops::RangeInclusive;

use super::{Formula, LOWEST_POWER, VALID_WAVELENGTHS, refractive_index, usable_range};
use crate::prescription::interfaces::{Glass, Medium};
use realistic_base::message::{as_given, short};

/// Maximum number of indices of a glass. Tables of real glasses have some 20.
const MOST: usize = 100;
/// The largest number of constants, and of indices that the formula meets.
const MOST_CONSTANTS: usize = 4;
/// The wavelengths, nm, that count most where the formula cannot meet all indices.
const VISIBLE: RangeInclusive<f64> = 380.0..=780.0;
/// The weight of indices at other wavelengths. Tables there have fewer decimals than differences.
const BEYOND: f64 = 0.01;
/// The largest accepted difference between an index and the formula. Indices of one glass do not differ by more.
const APART: f64 = 2e-3;

/// Returns the glass of these wavelengths, nm, and indices, and the largest difference between the indices and its
/// formula.
///
/// # Errors
/// No glass has these indices; the text states the fault.
pub fn tabulated(points: &[[f64; 2]]) -> Result<(Glass, f64), String> {
    if points.is_empty() || points.len() > MOST {
        return Err(format!("{} indices; expected 1 to {MOST}", points.len()));
    }
    if let Some([wavelength, index]) =
        points.iter().find(|[wavelength, index]| !(*wavelength > 0.0 && (1.0..5.0).contains(index)))
    {
        let message = "expected a positive wavelength and an index from 1 to 5";
        return Err(format!("index {} at {} nm; {message}", as_given(*index), as_given(*wavelength)));
    }
    let mut points: Vec<[f64; 2]> =
        points.iter().copied().filter(|[wavelength, _]| VALID_WAVELENGTHS.contains(wavelength)).collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    if let Some([twice, _]) = points.windows(2).find(|pair| pair[0][0] == pair[1][0]).map(|pair| pair[0]) {
        return Err(format!("two indices at {} nm", as_given(twice)));
    }
    match points[..] {
        [] => {
            let (first, last) = (VALID_WAVELENGTHS.start(), VALID_WAVELENGTHS.end());
            Err(format!("no index between {first} and {last} nm, where lenses are traced"))
        }
        [[_, index], ..] if points.iter().all(|point| point[1] == index) => {
            Ok((Glass::new(Medium::Glass { n_d: index, abbe: None }, None), 0.0))
        }
        _ => {
            let ends = [points[0][0], points[points.len() - 1][0]];
            let medium = Medium::Formula(Formula::Polynomial(fitted(&points)));
            let apart =
                |[wavelength, index]: &[f64; 2]| (refractive_index(medium, *wavelength) - index).abs();
            let apart = points.iter().map(apart).fold(0.0, f64::max);
            if !(apart <= APART) {
                return Err(format!(
                    "the indices differ by up to {} from a smooth curve; expected those of one glass",
                    short(apart)
                ));
            }
            let range = usable_range(medium, Some(ends))?;
            Ok((Glass::new(medium, range), apart))
        }
    }
}

/// Returns the constants of [`Formula::Polynomial`] that fit these indices at these wavelengths: the least squares of
/// n², with as many constants as there are points, at most [`MOST_CONSTANTS`]. The visible counts most.
fn fitted(points: &[[f64; 2]]) -> [f64; 10] {
    // Fewer points get the constants of the first of these powers.
    const POWERS: [i32; MOST_CONSTANTS] = [0, -2, -4, 2];
    let count = points.len().min(MOST_CONSTANTS);
    // The normal equations, with the right-hand sides in the last column. Wavelengths in µm keep their numbers alike.
    let mut equations = [[0.0; MOST_CONSTANTS + 1]; MOST_CONSTANTS];
    for [wavelength, index] in points {
        let weight = if VISIBLE.contains(wavelength) { 1.0 } else { BEYOND };
        let mut row = [index * index; MOST_CONSTANTS + 1];
        for (number, power) in row.iter_mut().zip(POWERS) {
            *number = (wavelength * 1e-3).powi(power);
        }
        for (equation, factor) in equations.iter_mut().zip(row) {
            equation.iter_mut().zip(row).for_each(|(sum, number)| *sum += weight * factor * number);
        }
    }
    // Elimination without exchanges, as the matrix is positive definite.
    for k in 0..count {
        let pivot = equations[k];
        for (_, equation) in equations.iter_mut().enumerate().filter(|(i, _)| *i != k) {
            let factor = equation[k] / pivot[k];
            equation.iter_mut().zip(pivot).for_each(|(number, other)| *number -= factor * other);
        }
    }
    let mut by_power = [0.0; 10];
    for k in 0..count {
        by_power[((POWERS[k] - LOWEST_POWER) / 2) as usize] = equations[k][MOST_CONSTANTS] / equations[k][k];
    }
    by_power
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prescription::glass::GlassLibrary;

    #[test]
    fn indices_of_a_glass_give_the_glass() {
        for name in ["N-BK7", "N-SF11", "S-FPL51"] {
            let known = GlassLibrary::default().find(name).expect("known").expect("right").medium;
            let index = |wavelength: f64| refractive_index(known, wavelength);
            let table = |wavelengths: &[f64]| {
                let points: Vec<_> = wavelengths.iter().map(|&w| [w, index(w)]).collect();
                tabulated(&points).expect("a glass")
            };
            for (wavelengths, error) in [
                (&[656.27, 587.56, 486.13][..], 1e-4),
                (&[656.27, 587.56, 486.13, 435.8], 1e-4),
                (&[706.5, 656.27, 587.56, 546.1, 486.13, 435.8, 404.7], 1e-4),
            ] {
                let (glass, apart) = table(wavelengths);
                assert!(apart < error, "{name}: {apart}");
                for wavelength in [490.0, 520.0, 600.0, 650.0] {
                    let off = refractive_index(glass.medium, wavelength) - index(wavelength);
                    assert!(off.abs() < error, "{name} {wavelengths:?} {wavelength}: {off}");
                }
            }
            let (glass, _) = table(&[486.13, 656.27]);
            assert_eq!(glass.range, Some([486.13, 656.27]));
            assert!((refractive_index(glass.medium, 656.27) - index(656.27)).abs() < 1e-12);
        }
        let (one, _) = tabulated(&[[550.0, 1.5]]).expect("a glass");
        assert_eq!(one.medium, Medium::Glass { n_d: 1.5, abbe: None });
    }

    #[test]
    fn what_is_no_glass_is_refused_with_the_fault() {
        for (points, what) in [
            (&[][..], "0 indices"),
            (&[[550.0, 0.5]], "index 0.5 at 550 nm"),
            (&[[550.0, 1.5], [550.0, 1.6]], "two indices at 550 nm"),
            (&[[9000.0, 1.5]], "no index between 200 and 2000 nm"),
            (&[[400.0, 1.5], [450.0, 1.7], [500.0, 1.5], [550.0, 1.7], [600.0, 1.5]], "smooth curve"),
        ] {
            let error = tabulated(points).expect_err(what);
            assert!(error.contains(what), "{error}");
        }
    }
}
