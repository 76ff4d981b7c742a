//! The absorption of a glass: converts the internal transmittances of the glass's catalogue, or a list of absorption
//! coefficients, to the absorption coefficient at a wavelength.
//!
//! A catalogue states the internal transmittance τ of a thickness d of glass. By the Beer-Lambert law τ = exp(-α d), so
//! that a row gives α = -ln(τ)/d at its wavelength. If a wavelength has several rows, the row with the largest τ d is
//! used, because its α changes least when τ is rounded. Between wavelengths, α is interpolated by a monotone cubic (F.
//! N. Fritsch and R. E. Carlson, *SIAM Journal on Numerical Analysis* 17, 1980; slopes by the harmonic mean). Outside
//! the rows, α is that of the nearest row.

/// The smallest transmittance that a row can state: catalogues round to three decimals.
const LEAST: f64 = 5e-4;

/// The longest wavelength that a file may state, nm.
pub const MOST_NM: f64 = 1e6;
/// The largest absorption coefficient that a lens table may state, 1/mm. At this value a hundredth of a millimetre is
/// opaque.
pub const MOST_PER_MM: f64 = 1e3;

/// The absorption of a glass according to its catalogue.
#[derive(Clone, Debug, PartialEq)]
pub struct InternalTransmittance {
    /// Wavelengths in ascending order, nm, each with α, 1/mm, and the slope of α, 1/mm per nm.
    knots: Vec<[f64; 3]>,
}

impl InternalTransmittance {
    /// Builds the table from rows of wavelength (nm, positive), transmittance (0 to 1) and thickness (mm, positive).
    /// Returns `None` if there are no rows.
    pub fn new(mut rows: Vec<[f64; 3]>) -> Option<Self> {
        let precision = |[_, share, thickness]: &[f64; 3]| share * thickness;
        rows.sort_by(|a, b| a[0].total_cmp(&b[0]).then(precision(b).total_cmp(&precision(a))));
        rows.dedup_by(|next, previous| next[0] == previous[0]);
        let coefficient = |[_, share, thickness]: [f64; 3]| share.max(LEAST).ln().abs() / thickness;
        Self::of_coefficients(rows.into_iter().map(|row| [row[0], coefficient(row)]))
    }

    /// Builds the table from absorption coefficients, 1/mm, from 0 to [`MOST_PER_MM`], at ascending wavelengths, nm.
    /// Returns `None` if there are no rows.
    pub fn of_coefficients(rows: impl IntoIterator<Item = [f64; 2]>) -> Option<Self> {
        let mut knots: Vec<[f64; 3]> = rows.into_iter().map(|[nm, per_mm]| [nm, per_mm, 0.0]).collect();
        // The slope is 0 at both ends, because α is constant beyond the ends.
        for i in 1..knots.len().saturating_sub(1) {
            let slope = |i: usize| (knots[i + 1][1] - knots[i][1]) / (knots[i + 1][0] - knots[i][0]);
            let (before, behind) = (slope(i - 1), slope(i));
            if before * behind > 0.0 {
                knots[i][2] = 2.0 * before * behind / (before + behind);
            }
        }
        (!knots.is_empty()).then_some(Self { knots })
    }

    /// Returns the wavelengths of the rows in ascending order, nm, each with α, 1/mm, and the slope of α, 1/mm per nm.
    /// Between two neighbouring wavelengths α is a cubic.
    pub fn knots(&self) -> &[[f64; 3]] {
        &self.knots
    }

    /// Returns α, 1/mm, at a wavelength, nm.
    pub fn coefficient(&self, wavelength: f64) -> f64 {
        let (first, last) = (self.knots[0], self.knots[self.knots.len() - 1]);
        let wavelength = wavelength.clamp(first[0], last[0]);
        let behind = self.knots.partition_point(|knot| knot[0] < wavelength);
        if behind == 0 {
            return first[1];
        }
        let ([x0, y0, slope0], [x1, y1, slope1]) = (self.knots[behind - 1], self.knots[behind]);
        let (step, t) = (x1 - x0, (wavelength - x0) / (x1 - x0));
        let u = 1.0 - t;
        // Cubic Hermite interpolation.
        u * u * ((1.0 + 2.0 * t) * y0 + t * step * slope0)
            + t * t * ((1.0 + 2.0 * u) * y1 - u * step * slope1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_met_and_between_them_nothing_overshoots() {
        // At 380 nm the transmittance is below the rounding limit. At 400 nm there are two thicknesses, of which the
        // larger counts.
        let rows = vec![
            [700.0, 0.999, 10.0],
            [380.0, 0.0, 10.0],
            [400.0, 0.9, 10.0],
            [400.0, 0.768, 25.0],
            [500.0, 0.99, 10.0],
        ];
        let glass = InternalTransmittance::new(rows).expect("rows");
        let left = |nm: f64, thickness: f64| (-glass.coefficient(nm) * thickness).exp();
        assert!((left(380.0, 10.0) - LEAST).abs() < 1e-12 && left(300.0, 10.0) == left(380.0, 10.0));
        assert!((left(400.0, 25.0) - 0.768).abs() < 1e-12, "{}", left(400.0, 25.0));
        assert!((left(500.0, 10.0) - 0.99).abs() < 1e-12 && (left(700.0, 10.0) - 0.999).abs() < 1e-12);
        assert!((left(900.0, 20.0) - 0.999 * 0.999).abs() < 1e-12, "thickness by thickness");
        let falls =
            (380..700).all(|nm| glass.coefficient(nm.into()) >= glass.coefficient(f64::from(nm) + 1.0));
        assert!(falls, "as the rows do");
        assert_eq!(InternalTransmittance::new(Vec::new()), None);
        // A single row gives a constant coefficient.
        let one = InternalTransmittance::new(vec![[500.0, 0.5, 1.0]]).expect("a row");
        assert!((one.coefficient(400.0) - 2.0_f64.ln()).abs() < 1e-15 && one.coefficient(600.0) > 0.69);
    }
}
