//! Absorption by the glasses of a lens at any wavelength: a polynomial for a ray's path length in each glass, a table
//! of absorption coefficients, and exp(-Σ α l).
//!
//! A glass transmits exp(-α l) along a path length l. l varies over rays as smoothly as the ray itself and hardly
//! depends on the wavelength. α depends on the wavelength alone, and steeply: in dense flint it grows a hundredfold
//! from 420 to 380 nm, by a curve that is smooth only between two rows of a catalogue. A single polynomial of rays and
//! wavelengths fits the product within 1 %; two separate fits reach 1e-5.

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

/// The distinct absorbing glasses of a lens; by default none.
#[derive(Clone, Debug, Default)]
pub struct Absorbers {
    curves: Vec<Arc<InternalTransmittance>>,
    /// Index of the glass behind each surface, counted from the scene.
    behind: Vec<Option<usize>>,
}

impl Absorbers {
    /// Collects the glasses of a lens from their transmittances, where known, behind each surface from the scene on.
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

    /// Returns the number of glasses.
    pub fn count(&self) -> usize {
        self.curves.len()
    }

    /// Returns the transmittance curve of each glass.
    pub fn curves(&self) -> &[Arc<InternalTransmittance>] {
        &self.curves
    }

    /// Returns the index of the glass behind a surface, counted from the scene; `None` if nothing absorbs there.
    pub fn behind(&self, surface: usize) -> Option<usize> {
        *self.behind.get(surface)?
    }

    /// Returns each glass's absorption coefficient at a wavelength, nm, in 1/mm.
    pub fn coefficients(&self, wavelength: f64) -> impl Iterator<Item = f64> {
        self.curves.iter().map(move |curve| curve.coefficient(wavelength))
    }

    /// Traces a ray along a path without mirrors ([`LitPath::trace`]). Returns the remaining share of its light and its
    /// path length in each glass, mm.
    ///
    /// # Errors
    /// Returns the reason if the ray is blocked.
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

/// Step of the coefficient table, nm. A cubic through four points interpolates within a step. It is exact if no
/// catalogue row lies inside, which holds for rows at whole nanometres; otherwise the error is below 1e-6 of the
/// steepest glass's 1/mm.
const CELL: f64 = 0.25;
/// Exponent beyond which the light counts as absorbed. Accuracy there would cost single precision accuracy at small
/// exponents.
pub(super) const NOTHING: f64 = 64.0;
/// Largest exponent at which the series is used: the terms up to [`LAST_POWER`] leave an error of 1e-7 there. Larger
/// exponents are halved repeatedly, and the result squared as often.
const LARGEST: f64 = 0.5;
const LAST_POWER: u32 = 7;

/// [`Absorbers`] for rays from a film, as [`RayPolynomial`]s for lanes of a precision.
#[derive(Clone, Debug)]
pub(super) struct LaneAbsorption<S> {
    /// Path length in each glass, mm.
    ways: Vec<RayPolynomial<S>>,
    /// First wavelength of the table, nm, and the reciprocal of its step.
    from: S,
    per_cell: S,
    /// Coefficients of each cell's cubic, lowest first: all cells of the first glass, then those of the next.
    table: Vec<[f32; 2]>,
    /// Number of cells per glass.
    cells: usize,
    /// Number of halvings of an exponent, and the factor that they amount to.
    halvings: u32,
    halved: S,
}

impl<S: Scalar> LaneAbsorption<S> {
    /// Builds the tables. `ways` are the path lengths in the glasses; wavelengths, nm, are within `range`, and
    /// exponents mostly at most `largest`.
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

    /// Returns the share of light that remains of rays with these variables at these wavelengths, nm.
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
        // Far outside the film the polynomials are meaningless.
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
