//! What the glasses of a lens absorb of light at any wavelength: rays' ways in each glass by a polynomial, the absorption
//! coefficients by a table, and exp(-Σ α l) of both.
//!
//! A glass absorbs exp(-α l) along a way l. Of a ray, l is as smooth as the ray's own way through the lens, and hardly
//! depends on the wavelength. α depends on the wavelength alone, and steeply: through dense flint it grows a hundredfold from
//! 420 to 380 nm, by a curve that is smooth between two rows of a catalogue and not beyond. One polynomial of rays and
//! wavelengths for the product follows that within 1 %. Apart from each other both are followed within 1e-5.

use std::sync::Arc;

use super::{
    coated::LitPath,
    ray_polynomials::{RayPolynomial, RayVariables},
};
use crate::{
    lens::Ray,
    prescription::glass::InternalTransmittance,
    trace::{
        Blocked,
        kernel::{Cpu, Lanes, Scalar},
    },
};

/// The glasses of a lens that absorb, each once; by default none.
#[derive(Clone, Debug, Default)]
pub struct Absorbers {
    curves: Vec<Arc<InternalTransmittance>>,
    /// Which of them is behind each surface, counted from the scene.
    behind: Vec<Option<usize>>,
}

impl Absorbers {
    /// Of a lens behind whose surfaces, from the scene on, are glasses with these transmittances, where they are known.
    pub fn new(transmittances: &[Option<Arc<InternalTransmittance>>]) -> Self {
        let mut curves: Vec<Arc<InternalTransmittance>> = Vec::new();
        let behind = transmittances.iter().map(|own| {
            let own = own.as_ref()?;
            let known = curves.iter().position(|known| known == own);
            Some(known.unwrap_or_else(|| {
                curves.push(own.clone());
                curves.len() - 1
            }))
        });
        let behind = behind.collect();
        Self { curves, behind }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.curves.len()
    }

    /// What each absorbs.
    pub fn curves(&self) -> &[Arc<InternalTransmittance>] {
        &self.curves
    }

    /// Which of them is behind the surface of this number, counted from the scene; `None` where nothing absorbs.
    pub fn behind(&self, surface: usize) -> Option<usize> {
        *self.behind.get(surface)?
    }

    /// The absorption coefficient of each at a wavelength, nm, in 1/mm.
    pub fn coefficients(&self, wavelength: f64) -> impl Iterator<Item = f64> {
        self.curves.iter().map(move |curve| curve.coefficient(wavelength))
    }

    /// What is left of a ray's light along a path without mirrors ([`LitPath::trace`]), and how far the ray travels in each, mm.
    ///
    /// # Errors
    /// The reason why it does not get through.
    pub(super) fn trace(&self, lit: &LitPath, ray: Ray) -> Result<(f64, Vec<f64>), Blocked> {
        let mut ways = vec![0.0; self.count()];
        let (_, left) = lit.trace_with_ways(ray, |surface, way| {
            if let Some(glass) = self.behind(surface) {
                ways[glass] += way;
            }
        })?;
        Ok((left, ways))
    }
}

/// nm between the wavelengths at which a coefficient is tabulated. Between them goes the cubic that meets it at four places,
/// which is the curve itself where no row of the catalogue lies between: catalogues state wavelengths to the nanometre or a
/// tenth of it. Where one does, 1/mm of the steepest glass is off by less than 1e-6.
const CELL: f64 = 0.25;
/// An exponent of which nothing is left: larger ones need no accuracy, which single precision would pay for with that of small
/// ones.
pub(super) const NOTHING: f64 = 64.0;
/// The largest exponent of which the series is used: its terms up to [`LAST_POWER`] leave 1e-7 there. Larger ones are halved
/// so far, and the result squared as often.
const LARGEST: f64 = 0.5;
const LAST_POWER: u32 = 7;

/// [`Absorbers`] of rays from a film, as [`RayPolynomial`]s, for lanes of a precision.
#[derive(Clone, Debug)]
pub(super) struct LaneAbsorption<S> {
    /// The way in each glass, mm.
    ways: Vec<RayPolynomial<S>>,
    /// The first wavelength of the table, nm, and 1 over its step.
    from: S,
    per_cell: S,
    /// The terms of each cell's cubic, lowest first: all cells of the first glass, then those of the next.
    table: Vec<[f32; 2]>,
    /// How many cells a glass has.
    cells: usize,
    /// How often exponents are halved, and the factor that does it.
    halvings: u32,
    halved: S,
}

impl<S: Scalar> LaneAbsorption<S> {
    /// `ways` are those in the glasses; wavelengths, nm, are within `range`, and exponents mostly up to `largest`.
    pub fn new(absorbers: &Absorbers, ways: Vec<RayPolynomial<S>>, range: [f64; 2], largest: f64) -> Self {
        let [from, to] = range;
        // The last wavelength begins a cell of its own.
        let cells = ((to - from) / CELL).ceil() as usize + 1;
        let mut table = Vec::with_capacity(2 * cells * absorbers.count());
        for curve in &absorbers.curves {
            for cell in 0..cells {
                let at = |third: u32| curve.coefficient(from + CELL * (cell as f64 + f64::from(third) / 3.0));
                let [a, b, c, d] = [0, 1, 2, 3].map(at);
                // Newton's differences, in thirds of a cell.
                let [first, second, third] =
                    [b - a, (c - 2.0 * b + a) / 2.0, (d - 3.0 * c + 3.0 * b - a) / 6.0];
                table.push([a, 3.0 * (first - second + 2.0 * third)].map(|term| term as f32));
                table.push([9.0 * (second - 3.0 * third), 27.0 * third].map(|term| term as f32));
            }
        }
        let halvings = (largest.min(NOTHING) / LARGEST).log2().ceil().max(0.0) as u32;
        Self {
            ways,
            from: S::from_f64(from),
            per_cell: S::from_f64(CELL.recip()),
            table,
            cells,
            halvings,
            halved: S::from_f64(0.5_f64.powi(halvings as i32)),
        }
    }

    /// What is left of the light of rays with these variables at these wavelengths, nm.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn lanes<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, rays: RayVariables<L>, wavelengths: L) -> L {
        let at = (wavelengths - L::splat(cpu, self.from)) * L::splat(cpu, self.per_cell);
        let (places, t) = (at.whole(), at - at.trunc());
        let zero = L::splat(cpu, S::ZERO);
        let one = L::splat(cpu, S::ONE);
        let mut exponent = zero;
        for (glass, way) in self.ways.iter().enumerate() {
            let [[a, b, c, d]] = L::look_up::<1, 2>(&self.table, places, [2 * self.cells * glass]);
            let coefficient = d.mul_add(t, c).mul_add(t, b).mul_add(t, a);
            let [way] = way.lanes(cpu, &[rays]);
            exponent = coefficient.mul_add(way, exponent);
        }
        // Far outside the film polynomials mean nothing.
        let x = (exponent * L::splat(cpu, self.halved)).larger(zero).smaller(one);
        // exp(-x) = 1 - x (1 - x/2 (1 - x/3 …)).
        let mut left = one;
        for power in (1..=LAST_POWER).rev() {
            left = (x * L::splat(cpu, S::from_f64(f64::from(power).recip()))).neg_mul_add(left, one);
        }
        for _ in 0..self.halvings {
            left = left * left;
        }
        left
    }
}
