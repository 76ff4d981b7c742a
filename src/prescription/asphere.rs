//! The figure of an aspheric interface: a conic and a polynomial, as patents, Optical Bench text and Zemax files give it.

/// The lowest power of a term of [`Asphere::terms`].
pub const FIRST_POWER: usize = 2;
/// The highest power of a term.
pub const LAST_POWER: usize = 20;

/// A surface of revolution: z = c r²/(1 + √(1 - (1 + k) c² r²)) + Σ `A_i` r^i, with c = 1/radius, z the distance from the
/// vertex plane toward the film and r that from the axis (W. J. Smith, *Modern Optical Engineering*, on aspheric
/// surfaces).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Asphere {
    /// Signed radius of the conic at its vertex, mm; infinite where the polynomial stands on a plane, never 0.
    pub radius: f64,
    /// The conic constant k: 0 a sphere, -1 a paraboloid, less a hyperboloid, between them an ellipsoid's pointed end, more
    /// than 0 its flat one.
    pub conic: f64,
    /// A2, A3, … A20, in mm^(1 - i).
    pub terms: [f64; LAST_POWER - FIRST_POWER + 1],
}

impl Asphere {
    /// The semi-diameter at which the conic ends, mm: half an ellipsoid's width, infinite for what opens for ever.
    pub fn widest(&self) -> f64 {
        if self.conic > -1.0 { self.radius.abs() / (1.0 + self.conic).sqrt() } else { f64::INFINITY }
    }

    /// The same figure with every length multiplied by `factor`, positive and finite.
    pub fn scaled(&self, factor: f64) -> Self {
        let mut terms = self.terms;
        for (power, term) in (FIRST_POWER..).zip(&mut terms) {
            *term *= factor.powi(1 - power as i32);
        }
        Self { radius: self.radius * factor, conic: self.conic, terms }
    }
}
