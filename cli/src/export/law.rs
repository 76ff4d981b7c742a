//! The law of a radial distortion model: its argument, its value, and its coefficients.

use std::f64::consts::FRAC_PI_2;

/// The argument or value of a law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Distance from the film's centre, pixels.
    Radius,
    /// Angle from the axis.
    Angle,
    /// Tangent of the angle.
    Tangent,
}

impl Quantity {
    /// Returns the quantity for a film point and the direction that it sees.
    pub fn of(self, radius: f64, angle: f64) -> f64 {
        match self {
            Self::Radius => radius,
            Self::Angle => angle,
            Self::Tangent if angle < FRAC_PI_2 => angle.tan(),
            Self::Tangent => f64::INFINITY,
        }
    }
}

/// The shape of y = c x (1 + n₁ xᵖ + n₂ x²ᵖ + …)/(1 + d₁ xᵖ + d₂ x²ᵖ + …).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LawShape {
    /// x.
    pub from: Quantity,
    /// y.
    pub to: Quantity,
    /// The power p: 2 for even powers, 1 for all.
    pub power: i32,
    /// Numbers of coefficients n and d.
    pub terms: [usize; 2],
}

/// A shape with its coefficients.
#[derive(Clone, Debug, PartialEq)]
pub struct Law {
    /// The shape.
    pub shape: LawShape,
    /// c.
    pub scale: f64,
    /// n₁, n₂ and so on.
    pub numerator: Vec<f64>,
    /// d₁, d₂ and so on.
    pub denominator: Vec<f64>,
}

impl Law {
    /// Returns c and the coefficients.
    pub fn numbers(&self) -> impl Iterator<Item = f64> {
        [self.scale].into_iter().chain(self.numerator.iter().chain(&self.denominator).copied())
    }
}

/// Returns 1 + a₁ z + a₂ z² + … and its derivative by z.
pub fn series(coefficients: &[f64], z: f64) -> [f64; 2] {
    let [sum, slope] =
        coefficients.iter().rev().fold([0.0, 0.0], |[sum, slope], a| [sum * z + a, slope * z + sum]);
    // The series has one factor z more than Horner's sum of a₁ + a₂ z + …
    [1.0 + z * sum, sum + z * slope]
}

/// Number of steps in a search over a range.
const SCAN: u32 = 2000;

impl Law {
    /// Returns y at `x`.
    pub fn at(&self, x: f64) -> f64 {
        let z = x.powi(self.shape.power);
        self.scale * x * series(&self.numerator, z)[0] / series(&self.denominator, z)[0]
    }

    /// Returns dy/dx at `x`.
    pub fn slope(&self, x: f64) -> f64 {
        let power = self.shape.power;
        let z = x.powi(power);
        let ([n, dn], [d, dd]) = (series(&self.numerator, z), series(&self.denominator, z));
        // d/dx of x N(z)/D(z), where x dz/dx = p z.
        self.scale * (n / d + f64::from(power) * z * (dn * d - n * dd) / (d * d))
    }

    /// Returns the x, at most `most`, up to which the law grows from x = 0.
    pub fn grows_to(&self, most: f64) -> f64 {
        let at = |i: u32| most * f64::from(i) / f64::from(SCAN);
        let sound = |x: f64| {
            // Beyond a pole the law may grow again, with the other sign.
            self.slope(x) > 0.0 && series(&self.denominator, x.powi(self.shape.power))[0] > 0.0
        };
        (1..=SCAN).find(|&i| !sound(at(i))).map_or(most, |i| at(i - 1))
    }

    /// Returns the x below `most` at which the law reaches `y`, provided that the law grows up to `most`; `None` if
    /// it does not reach `y`.
    fn inverse(&self, y: f64, most: f64) -> Option<f64> {
        let (mut low, mut high) = (0.0, most);
        if !(self.at(high) >= y) {
            return None;
        }
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if self.at(middle) < y { low = middle } else { high = middle }
        }
        Some(high)
    }

    /// Returns the film point, pixels from the centre, that sees an object at `angle` from the axis; `None` beyond
    /// `reach`.
    pub fn project(&self, angle: f64, reach: f64) -> Option<f64> {
        let radius = if self.shape.to == Quantity::Radius {
            self.at(self.shape.from.of(0.0, angle))
        } else {
            self.inverse(self.shape.to.of(0.0, angle), reach)?
        };
        radius.is_finite().then_some(radius)
    }

    /// Returns the angle from the axis that the film point at `radius` pixels from the centre sees; `None` beyond
    /// `reach`.
    pub fn unproject(&self, radius: f64, reach: f64) -> Option<f64> {
        let angle = match (self.shape.from, self.shape.to) {
            (Quantity::Radius, Quantity::Tangent) => self.at(radius).atan(),
            (Quantity::Radius, _) => self.at(radius),
            // A projection onto a plane ends before 90 degrees.
            (Quantity::Tangent, _) => self.inverse(radius, reach.min(1.57).tan())?.atan(),
            (Quantity::Angle, _) => self.inverse(radius, reach)?,
        };
        angle.is_finite().then_some(angle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(from: Quantity, to: Quantity, power: i32) -> Law {
        let terms = [2, 1];
        let shape = LawShape { from, to, power, terms };
        Law { shape, scale: 2.0, numerator: vec![0.3, -0.02], denominator: vec![0.1] }
    }

    #[test]
    fn a_law_is_its_formula_and_its_slope_that_of_differences() {
        let law = law(Quantity::Tangent, Quantity::Radius, 2);
        for x in [0.0, 0.2, 1.0, 1.4] {
            let z: f64 = x * x;
            let expected = 2.0 * x * (1.0 + 0.3 * z - 0.02 * z * z) / (1.0 + 0.1 * z);
            assert!((law.at(x) - expected).abs() < 1e-14, "{x}");
            let difference = (law.at(x + 1e-5) - law.at(x - 1e-5)) / 2e-5;
            assert!((law.slope(x) - difference).abs() < 1e-8, "{x}: {} {difference}", law.slope(x));
        }
        let falling = Law { numerator: vec![-1.0], denominator: vec![], ..law };
        // x - x³ has its maximum at 1/√3.
        assert!((falling.grows_to(2.0) - 3.0_f64.sqrt().recip()).abs() < 2e-3);
        assert!((falling.grows_to(0.5) - 0.5).abs() < 1e-15);
    }

    #[test]
    fn what_is_projected_comes_back() {
        for (from, to, power) in [
            (Quantity::Tangent, Quantity::Radius, 2),
            (Quantity::Angle, Quantity::Radius, 2),
            (Quantity::Radius, Quantity::Angle, 1),
            (Quantity::Radius, Quantity::Tangent, 2),
        ] {
            let law = law(from, to, power);
            for angle in [0.0, 0.3, 0.9] {
                let radius = law.project(angle, 3.0).expect("within");
                let back = law.unproject(radius, 1.2).expect("within");
                assert!((back - angle).abs() < 1e-12, "{from:?} {to:?} {angle} {back}");
            }
            assert_eq!(law.unproject(1e9, 1.2).is_some(), from == Quantity::Radius);
        }
    }
}
