//! Dispersion: the refractive index of a medium at a wavelength (nm), by Cauchy's formula from n_d and the Abbe number, or by Sellmeier's (M. Born and E. Wolf, *Principles of Optics*, §2.3.4).

use super::interfaces::{Medium, Sellmeier};

/// Wavelength of the helium d line, nm, at which n_d is given.
pub const D_LINE: f64 = 587.56;
/// Wavelength of the hydrogen F line, nm.
pub const F_LINE: f64 = 486.13;
/// Wavelength of the hydrogen C line, nm.
pub const C_LINE: f64 = 656.27;

/// The wavelengths, nm, at which the formulas are used.
pub const VALID_WAVELENGTHS: std::ops::RangeInclusive<f64> = 300.0..=2000.0;

/// Refractive index of `medium` at `wavelength` nm (within [`VALID_WAVELENGTHS`]).
///
/// A glass with an Abbe number V follows Cauchy's two-term formula n(λ) = A + B/λ², the
/// curve through n_d whose F and C values differ by (n_d - 1)/V, which is what V means
/// (Born and Wolf, *Principles of Optics*, 7th ed., §2.3.4 and §4.7.1). It says nothing of partial dispersion, and so is the
/// farther from a real glass the more the glass disperses and the farther the wavelength is from the d line. Between F and
/// C the index of Schott's N-BK7 is met within 6e-5 and that of the dense flint N-SF11 within 4.4e-4; at 400 nm N-BK7 is
/// 1e-4 off and N-SF11 7e-3, at 1000 nm each some 1.5e-3. A glass with Sellmeier's constants follows their formula, which
/// catalogues fit to some 1e-5.
pub fn refractive_index(medium: Medium, wavelength: f64) -> f64 {
    match medium {
        Medium::Air => 1.0,
        Medium::Glass { n_d, abbe: None } => n_d,
        Medium::Glass { n_d, abbe: Some(abbe) } => {
            let inverse_square = |length: f64| (length * length).recip();
            let slope = (n_d - 1.0) / abbe / (inverse_square(F_LINE) - inverse_square(C_LINE));
            n_d + slope * (inverse_square(wavelength) - inverse_square(D_LINE))
        }
        Medium::Sellmeier(constants) => sellmeier(constants, wavelength),
    }
}

/// n² = 1 + Σ B λ²/(λ² - C) with λ in µm; not a number where the sum has no root.
fn sellmeier(Sellmeier { b, c }: Sellmeier, wavelength: f64) -> f64 {
    let square = (wavelength * 1e-3).powi(2);
    let sum: f64 = b.iter().zip(c).map(|(b, c)| b * square / (square - c)).sum();
    (1.0 + sum).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_formula_returns_n_d_and_the_abbe_number() {
        let glass = Medium::Glass { n_d: 1.699, abbe: Some(30.1) };
        let [d, f, c] = [D_LINE, F_LINE, C_LINE].map(|line| refractive_index(glass, line));
        assert_eq!(d, 1.699);
        assert!(((d - 1.0) / (f - c) - 30.1).abs() < 1e-10);
        assert_eq!(refractive_index(Medium::Air, F_LINE), 1.0);
        assert_eq!(refractive_index(Medium::Glass { n_d: 1.5, abbe: None }, F_LINE), 1.5);
    }

    /// The constants of Schott's data sheets (517642.251 and 785257.322).
    const N_BK7: Sellmeier = Sellmeier {
        b: [1.039_612_12, 0.231_792_344, 1.010_469_45],
        c: [0.006_000_698_67, 0.020_017_914_4, 103.560_653],
    };
    const N_SF11: Sellmeier = Sellmeier {
        b: [1.737_596_95, 0.313_747_346, 1.898_781_01],
        c: [0.013_188_707, 0.062_306_814_2, 155.236_29],
    };

    #[test]
    fn a_real_glass_is_met_between_f_and_c() {
        // Schott N-BK7: n_d 1.51680, V_d 64.17; its data sheet's n_e (546.07 nm) is 1.51872.
        let glass = Medium::Glass { n_d: 1.51680, abbe: Some(64.17) };
        assert!((refractive_index(glass, 546.07) - 1.51872).abs() < 1e-4);
    }

    #[test]
    fn two_numbers_of_a_glass_are_as_far_off_as_is_said() {
        // At F, C, 400 and 1000 nm, as the documentation of `refractive_index` has them.
        for (n_d, abbe, formula, stated) in [
            (1.51680, 64.17, N_BK7, [6e-5, 6e-5, 1e-4, 1.5e-3]),
            (1.78472, 25.68, N_SF11, [4.4e-4, 4.4e-4, 7.1e-3, 1.6e-3]),
        ] {
            for (wavelength, stated) in [F_LINE, C_LINE, 400.0, 1000.0].into_iter().zip(stated) {
                let of = |medium| refractive_index(medium, wavelength);
                let off = of(Medium::Glass { n_d, abbe: Some(abbe) }) - of(Medium::Sellmeier(formula));
                assert!((0.8 * stated..stated).contains(&off.abs()), "{n_d}, {wavelength} nm: {off}");
            }
        }
    }

    #[test]
    fn sellmeiers_formula_gives_a_data_sheets_indices() {
        // Schott N-BK7: the indices of its data sheet, which has five decimals.
        let glass = Medium::Sellmeier(N_BK7);
        for (line, expected) in [
            (F_LINE, 1.52238),
            (546.07, 1.51872),
            (D_LINE, 1.51680),
            (C_LINE, 1.51432),
            (404.66, 1.53024),
            (1013.98, 1.50731),
        ] {
            let index = refractive_index(glass, line);
            assert!((index - expected).abs() < 6e-6, "{line} nm: {index}");
        }
        let [d, f, c] = [D_LINE, F_LINE, C_LINE].map(|line| refractive_index(glass, line));
        assert!(((d - 1.0) / (f - c) - 64.17).abs() < 6e-3);
    }
}
