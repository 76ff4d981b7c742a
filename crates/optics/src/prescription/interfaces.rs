//! A lens as a table of interfaces: the model that the reader of every format fills and [`crate::lens`] is built from.
//!
//! Lengths are in millimetres. Interfaces run from the scene side to the film, and each holds the medium behind it, on
//! the film's side. An aspheric figure is a conic plus a polynomial, as in patents, Optical Bench text and Zemax files.
//! [`Stated`] holds the facts that a file states beside the table. No optics is computed from them; reports and tests
//! compare with them, and the command line sizes its film by the field of view.

use std::{ops::Range, sync::Arc};

use super::{
    blades::Blades,
    coating::SurfaceCoating,
    findings::Finding,
    glass::{InternalTransmittance, formula::Formula},
    positions::Positions,
};

/// The medium behind an interface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Medium {
    /// Refractive index exactly 1.
    Air,
    /// A glass known by n_d and its Abbe number.
    Glass {
        /// Refractive index at the d line, 587.56 nm; more than 1.
        n_d: f64,
        /// Abbe number (n_d - 1)/(n_F - n_C); positive. `None`: the index is the same at every wavelength.
        abbe: Option<f64>,
    },
    /// A glass known by Sellmeier's formula with three terms, n² = 1 + Σ B λ²/(λ² - C), λ in µm (W. Sellmeier 1871; in
    /// this form in every glass maker's catalogue).
    Sellmeier {
        /// B1, B2, B3.
        b: [f64; 3],
        /// C1, C2, C3 in µm².
        c: [f64; 3],
    },
    /// A glass known by another formula.
    Formula(Formula),
}

impl Medium {
    /// Whether the index depends on the wavelength.
    pub fn is_dispersive(&self) -> bool {
        match self {
            Self::Air => false,
            Self::Glass { abbe, .. } => abbe.is_some(),
            Self::Sellmeier { .. } | Self::Formula(_) => true,
        }
    }
}

/// A glass that a file names.
#[derive(Clone, Debug, PartialEq)]
pub struct Glass {
    /// The medium of the glass.
    pub medium: Medium,
    /// The shortest and longest wavelength, nm, of its index data, if known.
    pub range: Option<[f64; 2]>,
    /// The internal transmittance of the glass, if its catalogue states it.
    pub transmittance: Option<Arc<InternalTransmittance>>,
}

impl Glass {
    /// Returns a glass with unknown transmittance.
    pub fn new(medium: Medium, range: Option<[f64; 2]>) -> Self {
        Self { medium, range, transmittance: None }
    }
}

/// The figure of an interface.
#[allow(
    clippy::large_enum_variant,
    reason = "in a box it could not be copied, and a lens has few interfaces"
)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A sphere. Its radius in mm is not 0, and is positive if the centre lies on the film's side.
    Sphere {
        /// Signed radius of curvature, mm.
        radius: f64,
    },
    /// Another surface of revolution.
    Asphere(Asphere),
    /// A plane; in air it only limits rays, as the aperture stop or a flare stop.
    Plane,
}

impl Shape {
    /// Returns its largest possible clear semi-diameter, mm.
    pub fn widest(&self) -> f64 {
        match self {
            Self::Sphere { radius } => radius.abs(),
            Self::Asphere(asphere) => asphere.widest(),
            Self::Plane => f64::INFINITY,
        }
    }
}

/// One interface of a lens: a row of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interface {
    /// The figure of the interface.
    pub shape: Shape,
    /// Distance along the axis to the next vertex, mm. Negative only next to a plane that only limits rays, which may
    /// lie within its neighbour's sagitta. 0 for the last interface: see [`Prescription::nominal_film_distance`].
    pub thickness: f64,
    /// The medium on the film's side.
    pub medium: Medium,
    /// Index of its glass in [`Prescription::glasses`], if the file names it. The medium alone is not enough:
    /// glasses of one formula may absorb differently.
    pub glass: Option<usize>,
    /// Clear semi-diameter, mm, positive.
    pub semi_diameter: f64,
    /// Whether this is the aperture stop; at most one interface of a lens is.
    pub is_stop: bool,
}

/// Returns whether each interface, scene side first, has air on one side and glass on the other, as coated surfaces do.
pub(super) fn has_coating(interfaces: &[Interface]) -> impl Iterator<Item = bool> {
    let mut in_front = Medium::Air;
    interfaces.iter().map(move |interface| {
        let before = std::mem::replace(&mut in_front, interface.medium);
        (before == Medium::Air) != (interface.medium == Medium::Air)
    })
}

/// Returns, for each surface that bends rays, the rows from it to just before the next such surface. The thicknesses of
/// these rows add up to the distance between the two vertices, which is 0 or more. The planes between the two only
/// limit rays, and may lie within a neighbour's sagitta.
pub(super) fn spans(interfaces: &[Interface]) -> impl Iterator<Item = Range<usize>> {
    let media = std::iter::once(Medium::Air).chain(interfaces.iter().map(|interface| interface.medium));
    let bends = |&(row, in_front): &(usize, Medium)| {
        interfaces[row].shape != Shape::Plane || in_front != interfaces[row].medium
    };
    let rows: Vec<usize> = (0..interfaces.len()).zip(media).filter(bends).map(|(row, _)| row).collect();
    (1..rows.len()).map(move |next| rows[next - 1]..rows[next])
}

/// A lens as a table of interfaces, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Prescription {
    /// A short name: that in the catalogue, or the file's name.
    pub name: String,
    /// The title of the lens, if the file has one; that of a table is its first comment.
    pub title: Option<String>,
    /// The interfaces, scene side first; at least one.
    pub interfaces: Vec<Interface>,
    /// Distance from the last vertex to the film that the file proposes, mm: the last row's thickness, if it is not 0.
    pub nominal_film_distance: Option<f64>,
    /// The focal length that the file states, mm; that of the first position, if the lens has positions. Reports and
    /// warnings compare with it.
    pub stated_focal_length: Option<f64>,
    /// Other facts that the file states about the lens.
    pub stated: Stated,
    /// The glasses that the file names, each once; an interface refers to its own by position.
    pub glasses: Vec<(String, Glass)>,
    /// The wavelength that the file is for, nm, if it states one: the lens is traced at it unless the user sets
    /// another. Its glasses have indices there.
    pub wavelength: Option<f64>,
    /// The blades in its stop, if the file has them; otherwise the stop is round.
    pub blades: Option<Blades>,
    /// The coatings of its interfaces, one each, if the file has any. Interfaces that the file leaves out are bare, as
    /// are cemented ones.
    pub coatings: Option<Vec<SurfaceCoating>>,
    /// The positions of its moving groups, if it has any; the interfaces have the gaps of the first position.
    pub positions: Option<Positions>,
    /// Warnings for the user: one sentence, with its location, for each statement that the reader did not use as
    /// written.
    pub remarks: Vec<String>,
    /// The fate of every statement of its file; empty if it comes from no file.
    pub findings: Arc<[Finding]>,
}

impl Prescription {
    /// Returns a lens of these interfaces, at least one, without any other facts. Readers check the interfaces first.
    pub fn new(interfaces: Vec<Interface>) -> Self {
        Self {
            name: String::new(),
            title: None,
            interfaces,
            nominal_film_distance: None,
            stated_focal_length: None,
            stated: Stated::default(),
            glasses: Vec::new(),
            wavelength: None,
            blades: None,
            coatings: None,
            positions: None,
            remarks: Vec::new(),
            findings: Arc::default(),
        }
    }

    /// Returns the rows from each surface that bends rays to just before the next one.
    pub fn spans(&self) -> impl Iterator<Item = Range<usize>> {
        spans(&self.interfaces)
    }

    /// Returns the transmittance of the medium behind each interface, where known.
    pub fn transmittances(&self) -> Vec<Option<Arc<InternalTransmittance>>> {
        let own = |interface: &Interface| self.glass_behind(interface)?.1.transmittance.clone();
        self.interfaces.iter().map(own).collect()
    }

    /// Returns the name and the glass behind an interface, if the file names the glass.
    pub fn glass_behind(&self, interface: &Interface) -> Option<&(String, Glass)> {
        self.glasses.get(interface.glass?)
    }

    /// Returns the row of the stop, counted from 0 at the scene side.
    pub fn stop_index(&self) -> Option<usize> {
        self.interfaces.iter().position(|interface| interface.is_stop)
    }

    /// Returns the row of the stop, if the stop is a plane in air, where blades can be.
    pub fn stop_in_air(&self) -> Option<usize> {
        self.stop_index().filter(|&row| {
            let media = [row.checked_sub(1), Some(row)];
            let is_air =
                |row: &Option<usize>| row.is_none_or(|row| self.interfaces[row].medium == Medium::Air);
            self.interfaces[row].shape == Shape::Plane && media.iter().all(is_air)
        })
    }

    /// Returns the lens with other gaps behind some of its rows, mm. The last row's gap, before the film, is not part
    /// of the lens and stays unchanged.
    pub fn with_gaps(&self, rows: &[usize], gaps: &[f64]) -> Self {
        let mut placed = self.clone();
        let last = placed.interfaces.len() - 1;
        for (&row, gap) in rows.iter().zip(gaps).filter(|(row, _)| **row < last) {
            placed.interfaces[row].thickness = *gap;
        }
        placed
    }

    /// Returns the lens with every length multiplied by `factor` (positive and finite).
    pub fn scaled(&self, factor: f64) -> Self {
        let mut scaled = self.clone();
        for interface in &mut scaled.interfaces {
            interface.thickness *= factor;
            interface.semi_diameter *= factor;
            match &mut interface.shape {
                Shape::Sphere { radius } => *radius *= factor,
                Shape::Asphere(asphere) => *asphere = asphere.scaled(factor),
                Shape::Plane => {}
            }
        }
        scaled.nominal_film_distance = self.nominal_film_distance.map(|length| length * factor);
        scaled.positions = self.positions.as_ref().map(|positions| positions.scaled(factor));
        scaled.stated_focal_length = self.stated_focal_length.map(|length| length * factor);
        scaled
    }

    /// Whether any glass has an Abbe number or a dispersion formula, so that the wavelength matters.
    pub fn is_dispersive(&self) -> bool {
        self.interfaces.iter().any(|interface| interface.medium.is_dispersive())
    }
}

/// The lowest power of r in [`Asphere::terms`].
pub const FIRST_POWER: usize = 2;
/// The highest power of r in [`Asphere::terms`].
pub const LAST_POWER: usize = 30;
/// The coefficients of the terms, lowest power first.
pub type Terms = [f64; LAST_POWER - FIRST_POWER + 1];
/// The terms of a pure conic: all 0.
pub const NO_TERMS: Terms = [0.0; LAST_POWER - FIRST_POWER + 1];

/// A surface of revolution: z = c r²/(1 + √(1 - (1 + k) c² r²)) + Σ `A_i` r^i, with c = 1/radius, z the distance from
/// the vertex plane toward the film and r the distance from the axis (W. J. Smith, *Modern Optical Engineering*, on
/// aspheric surfaces).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Asphere {
    /// Signed vertex radius of the conic, mm; infinite if the base is a plane, never 0.
    pub radius: f64,
    /// The conic constant k: 0 for a sphere, -1 for a paraboloid, less for a hyperboloid, between -1 and 0 for a
    /// prolate ellipsoid, more than 0 for an oblate one.
    pub conic: f64,
    /// A2, A3, … A30, in mm^(1 - i).
    pub terms: Terms,
}

impl Asphere {
    /// Returns the semi-diameter at which the conic ends, mm: half the width of an ellipsoid, infinite for an open
    /// surface.
    pub fn widest(&self) -> f64 {
        if self.conic > -1.0 { self.radius.abs() / (1.0 + self.conic).sqrt() } else { f64::INFINITY }
    }

    /// Returns the figure with every length multiplied by `factor`, positive and finite.
    pub fn scaled(&self, factor: f64) -> Self {
        let mut terms = self.terms;
        for (power, term) in (FIRST_POWER..).zip(&mut terms) {
            *term *= factor.powi(1 - power as i32);
        }
        Self { radius: self.radius * factor, conic: self.conic, terms }
    }
}

/// Facts as stated by the file, or by the patent that it is taken from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stated {
    /// The year of the patent or book.
    pub year: Option<u16>,
    /// F-number of a lens without positions; with positions, each [`Position`](super::Position) has its own.
    pub fnumber: Option<f64>,
    /// Full field of view in degrees, of the lens or of each of its positions in order; empty if the file states none.
    pub fields: Vec<Option<f64>>,
}
