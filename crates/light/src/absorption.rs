//! Absorption by the glasses of a lens: the glass behind each surface, and absorption coefficients in lanes at any
//! wavelength.
//!
//! A glass transmits exp(-α l) along a path length l. α depends on the wavelength alone, and steeply: in dense flint it
//! grows a hundredfold from 420 to 380 nm. The curve is smooth only between two neighbouring rows of a catalogue.

use std::sync::Arc;

use realistic_optics::prescription::glass::InternalTransmittance;
use realistic_simd::{Cpu, Lanes};

/// The distinct absorbing glasses of a lens; by default none.
#[derive(Clone, Debug, Default)]
pub struct Absorbers {
    curves: Vec<Arc<InternalTransmittance>>,
    /// Index of the glass behind each surface; surfaces are counted from the scene.
    behind: Vec<Option<usize>>,
}

impl Absorbers {
    /// Collects the distinct glasses of a lens. `transmittances` lists, from the scene on, the transmittance of the
    /// glass behind each surface, where it is known.
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

    /// Returns the index of the glass behind a surface, which is counted from the scene; `None` if nothing absorbs
    /// there.
    pub fn behind(&self, surface: usize) -> Option<usize> {
        *self.behind.get(surface)?
    }
}

/// Step of the coefficient table, nm. A cubic through four points interpolates within a step. It is exact if no
/// catalogue row lies inside the step, as is the case for rows at whole nanometres. Otherwise the error is below 1e-6
/// of the coefficient, 1/mm, of the steepest glass.
const CELL: f64 = 0.25;
/// The absorption coefficients of [`Absorbers`], for lanes of single precision.
#[derive(Clone, Debug)]
pub(super) struct AbsorptionCurves {
    /// First wavelength of the table, nm.
    from: f32,
    /// Coefficients of the cubic of each cell, the lowest power first. All cells of the first glass come before those
    /// of the next glass.
    table: Vec<[f32; 2]>,
    /// Number of cells per glass.
    cells: usize,
}

impl AbsorptionCurves {
    /// Builds the table for wavelengths, nm, within `range`.
    pub fn new(absorbers: &Absorbers, [from, to]: [f64; 2]) -> Self {
        // If the range is a whole number of cells, the last wavelength is the start of one more cell.
        let cells = ((to - from) / CELL).ceil() as usize + 1;
        let mut table = Vec::with_capacity(2 * cells * absorbers.count());
        for curve in &absorbers.curves {
            for cell in 0..cells {
                let at = |third: u32| curve.coefficient(from + CELL * (cell as f64 + f64::from(third) / 3.0));
                let [a, b, c, d] = [0, 1, 2, 3].map(at);
                // Newton's divided differences, with a third of a cell as the unit.
                let [first, second, third] =
                    [b - a, (c - 2.0 * b + a) / 2.0, (d - 3.0 * c + 3.0 * b - a) / 6.0];
                table.push([a, 3.0 * (first - second + 2.0 * third)].map(|term| term as f32));
                table.push([9.0 * (second - 3.0 * third), 27.0 * third].map(|term| term as f32));
            }
        }
        Self { from: from as f32, table, cells }
    }

    /// Returns the absorption coefficient of a glass, 1/mm, at wavelengths, nm, within the range of the table; an
    /// arbitrary number for other wavelengths.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn coefficient<L: Lanes<Scalar = f32>>(&self, cpu: Cpu<L>, glass: usize, wavelengths: L) -> L {
        let at = (wavelengths - L::splat(cpu, self.from)) * L::splat(cpu, CELL.recip() as f32);
        let (indices, t) = (at.whole(), at - at.trunc());
        let [[a, b, c, d]] = L::look_up::<1, 2>(&self.table, indices, [2 * self.cells * glass]);
        d.mul_add(t, c).mul_add(t, b).mul_add(t, a)
    }
}
