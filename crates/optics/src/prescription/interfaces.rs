//! A lens as a table of interfaces. The readers of all formats fill this model, and [`crate::lens`] is built from it.
//!
//! Lengths are in millimetres. Interfaces run from the scene side to the film, and each interface holds the medium
//! behind it, on the film's side. An aspheric figure is a conic plus a polynomial, as in patents, Optical Bench text
//! and Zemax files. [`Stated`] holds the facts that a file states beside the table. No optics is computed from these
//! facts; reports and tests compare their results with them, and the command line sizes its film by the stated field of
//! view.

use std::{ops::Range, sync::Arc};

use super::{
    aperture::Aperture,
    blades::Blades,
    coating::SurfaceCoating,
    coordinate_break::CoordinateBreak,
    findings::Finding,
    glass::{InternalTransmittance, formula::Formula},
    positions::Positions,
    unsymmetric::Unsymmetric,
};

/// The medium behind an interface, or in front of the lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Medium {
    /// Refractive index exactly 1.
    Air,
    /// A glass of which n_d and the Abbe number are known.
    Glass {
        /// Refractive index at the d line, 587.56 nm; more than 1.
        n_d: f64,
        /// Abbe number (n_d - 1)/(n_F - n_C); positive. `None` means that the index is the same at every wavelength.
        abbe: Option<f64>,
    },
    /// A glass of which Sellmeier's formula with three terms is known, n² = 1 + Σ B λ²/(λ² - C), with λ in µm (W.
    /// Sellmeier 1871; this form is used in every glass maker's catalogue).
    Sellmeier {
        /// B1, B2, B3.
        b: [f64; 3],
        /// C1, C2, C3 in µm².
        c: [f64; 3],
    },
    /// A glass of which another formula is known.
    Formula(Formula),
}

impl Medium {
    /// Returns whether the index depends on the wavelength.
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
    /// The shortest and the longest wavelength, nm, of the glass's index data, if known.
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
    /// A sphere. Its radius, mm, is not 0; it is positive if the centre lies on the film's side.
    Sphere {
        /// Signed radius of curvature, mm.
        radius: f64,
    },
    /// Another surface of revolution.
    Asphere(Asphere),
    /// A surface that is not symmetric about its axis, and no plane.
    Unsymmetric(Unsymmetric),
    /// A plane. In air a plane only limits rays, as the aperture stop or a flare stop does.
    Plane,
}

impl Shape {
    /// Returns the largest possible clear semi-diameter of the shape, mm.
    pub fn widest(&self) -> f64 {
        match self {
            Self::Sphere { radius } => radius.abs(),
            Self::Asphere(asphere) => asphere.widest(),
            Self::Unsymmetric(_) | Self::Plane => f64::INFINITY,
        }
    }
}

/// One interface of a lens: a row of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Interface {
    /// The figure of the interface.
    pub shape: Shape,
    /// Distance along the axis to the next vertex, mm. The distance is negative behind an odd number of mirrors, next to
    /// a coordinate break, and next to a plane that only limits rays, because such a plane may lie within its neighbour's
    /// sagitta. It is 0 for the last interface: see
    /// [`Prescription::nominal_film_distance`].
    pub thickness: f64,
    /// The medium on the film's side.
    pub medium: Medium,
    /// Index in [`Prescription::glasses`] of the glass behind the interface, if the file names that glass. The medium
    /// alone is not enough, because glasses with the same formula may absorb differently.
    pub glass: Option<usize>,
    /// Clear semi-diameter, mm, positive.
    pub semi_diameter: f64,
    /// Whether this is the aperture stop; at most one interface of a lens is the stop.
    pub is_stop: bool,
    /// Apertures and obstructions inside the clear aperture, with lengths in mm.
    pub apertures: Arc<[Aperture]>,
    /// Whether the interface reflects. The medium behind it is then that in front of it, and light goes back: behind an
    /// odd number of mirrors, thicknesses are negative.
    pub is_mirror: bool,
    /// The change of frame in front of the interface, behind the thickness in front of it; `None` on the axis. In front
    /// of the first interface, the old frame is that of the camera.
    pub coordinate_break: Option<CoordinateBreak>,
}

impl Interface {
    /// Returns an interface that is not the stop, with its clear aperture alone and a medium without a name.
    pub fn new(shape: Shape, thickness: f64, medium: Medium, semi_diameter: f64) -> Self {
        Self {
            shape,
            thickness,
            medium,
            glass: None,
            semi_diameter,
            is_stop: false,
            apertures: Arc::default(),
            is_mirror: false,
            coordinate_break: None,
        }
    }
}

/// Returns whether each interface, scene side first, has air on one side and glass on the other, as coated surfaces do.
/// `object` is the medium in front of the lens.
pub(super) fn has_coating(object: Medium, interfaces: &[Interface]) -> impl Iterator<Item = bool> {
    let mut in_front = object;
    interfaces.iter().map(move |interface| {
        let before = std::mem::replace(&mut in_front, interface.medium);
        (before == Medium::Air) != (interface.medium == Medium::Air)
    })
}

/// Returns, for each surface that bends rays, the rows from that surface to just before the next such surface. The
/// thicknesses of these rows add up to the distance between the two vertices, which is 0 or more along the light. The planes between
/// the two surfaces only limit rays, and may lie within the sagitta of a neighbour. `object` is the medium in front of
/// the lens.
pub(super) fn spans(object: Medium, interfaces: &[Interface]) -> impl Iterator<Item = Range<usize>> {
    let media = std::iter::once(object).chain(interfaces.iter().map(|interface| interface.medium));
    let bends = |&(row, in_front): &(usize, Medium)| {
        let Interface { shape, medium, is_mirror, .. } = &interfaces[row];
        *shape != Shape::Plane || in_front != *medium || *is_mirror
    };
    let rows: Vec<usize> = (0..interfaces.len()).zip(media).filter(bends).map(|(row, _)| row).collect();
    (1..rows.len()).map(move |next| rows[next - 1]..rows[next])
}

/// A lens as a table of interfaces, which have been checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Prescription {
    /// A short name: the name in the catalogue, or the name of the file.
    pub name: String,
    /// The title of the lens, if the file has one. The title of a table is its first comment.
    pub title: Option<String>,
    /// The medium in front of the lens, in which the scene lies. The film lies in the medium behind the last
    /// interface.
    pub object_medium: Medium,
    /// Index in [`Prescription::glasses`] of the glass in front of the lens, if the file names that glass.
    pub object_glass: Option<usize>,
    /// The interfaces, scene side first; at least one.
    pub interfaces: Vec<Interface>,
    /// Distance along the light from the last vertex to the film that the file proposes, mm: the magnitude of the
    /// thickness of the last row, if that is not 0.
    pub nominal_film_distance: Option<f64>,
    /// The change of frame behind the last interface, in front of the distance to the film; `None` on the axis.
    pub film_break: Option<CoordinateBreak>,
    /// The focal length that the file states, mm; for a lens with positions, the focal length of the first position.
    /// Reports and warnings compare the computed focal length with it.
    pub stated_focal_length: Option<f64>,
    /// Other facts that the file states about the lens.
    pub stated: Stated,
    /// The glasses that the file names, each listed once. An interface refers to its glass by the position in this
    /// list.
    pub glasses: Vec<(String, Glass)>,
    /// The wavelength for which the file describes the lens, nm, if the file states one. The lens is traced at this
    /// wavelength unless the user sets another, and its glasses have indices there.
    pub wavelength: Option<f64>,
    /// The coatings of the interfaces, one for each, if the file has any. Interfaces for which the file gives no
    /// coating are bare, as are cemented interfaces.
    pub coatings: Option<Vec<SurfaceCoating>>,
    /// The positions of the moving groups, if the lens has any; the interfaces have the gaps of the first position.
    pub positions: Option<Positions>,
    /// Warnings for the user: one sentence, with its location in the file, for each statement that the reader did not
    /// use as written.
    pub remarks: Vec<String>,
    /// The fate of every statement of the file; empty if the lens comes from no file.
    pub findings: Arc<[Finding]>,
}

impl Prescription {
    /// Returns a lens with these interfaces, of which there is at least one, and without any other facts. Readers check
    /// the interfaces first.
    pub fn new(interfaces: Vec<Interface>) -> Self {
        Self {
            name: String::new(),
            title: None,
            object_medium: Medium::Air,
            object_glass: None,
            interfaces,
            nominal_film_distance: None,
            film_break: None,
            stated_focal_length: None,
            stated: Stated::default(),
            glasses: Vec::new(),
            wavelength: None,
            coatings: None,
            positions: None,
            remarks: Vec::new(),
            findings: Arc::default(),
        }
    }

    /// Returns, for each surface that bends rays, the rows from that surface to just before the next such surface.
    pub fn spans(&self) -> impl Iterator<Item = Range<usize>> {
        spans(self.object_medium, &self.interfaces)
    }

    /// Returns the transmittance of the medium behind each interface, where known.
    pub fn transmittances(&self) -> Vec<Option<Arc<InternalTransmittance>>> {
        let own = |interface: &Interface| self.glass_behind(interface)?.1.transmittance.clone();
        self.interfaces.iter().map(own).collect()
    }

    /// Returns the name of the glass behind an interface, and the glass itself, if the file names the glass.
    pub fn glass_behind(&self, interface: &Interface) -> Option<&(String, Glass)> {
        self.glasses.get(interface.glass?)
    }

    /// Returns the row of the stop, counted from 0 at the scene side.
    pub fn stop_index(&self) -> Option<usize> {
        self.interfaces.iter().position(|interface| interface.is_stop)
    }

    /// Returns the row of the stop, if the stop is a plane in air; only such a stop can have blades.
    pub fn stop_in_air(&self) -> Option<usize> {
        self.stop_index().filter(|&row| {
            let in_front = row.checked_sub(1).map_or(self.object_medium, |row| self.interfaces[row].medium);
            let Interface { shape, medium, .. } = self.interfaces[row];
            shape == Shape::Plane && in_front == Medium::Air && medium == Medium::Air
        })
    }

    /// Returns the blades of the stop, if it has any.
    pub fn blades(&self) -> Option<Blades> {
        self.interfaces[self.stop_index()?].apertures.iter().find_map(Aperture::blades)
    }

    /// Sets or removes the blades of the stop, if the lens has a stop; its other apertures stay.
    pub fn set_blades(&mut self, blades: Option<Blades>) {
        if let Some(stop) = self.stop_index() {
            Aperture::set_blades(&mut self.interfaces[stop].apertures, blades);
        }
    }

    /// Returns the medium behind the last interface, in which the film lies.
    pub fn image_medium(&self) -> Medium {
        self.interfaces.last().map_or(self.object_medium, |interface| interface.medium)
    }

    /// Returns the media from the scene to the film, each with the glass's position in [`Prescription::glasses`], if
    /// the file names the glass. There is one medium more than interfaces.
    pub fn media(&self) -> impl Iterator<Item = (Medium, Option<usize>)> {
        let behind = self.interfaces.iter().map(|interface| (interface.medium, interface.glass));
        std::iter::once((self.object_medium, self.object_glass)).chain(behind)
    }

    /// Returns whether the lens, with its apertures, is symmetric about its axis.
    pub fn is_symmetric(&self) -> bool {
        let mut apertures = self.interfaces.iter().flat_map(|interface| interface.apertures.iter());
        self.is_centred() && apertures.all(Aperture::is_symmetric)
    }

    /// Returns whether all surfaces are symmetric about one axis, whatever the apertures.
    pub fn is_centred(&self) -> bool {
        let is_round = |interface: &Interface| {
            interface.coordinate_break.is_none() && !matches!(interface.shape, Shape::Unsymmetric(_))
        };
        self.film_break.is_none() && self.interfaces.iter().all(is_round)
    }

    /// Returns whether all surfaces are symmetric about one axis and refract, whatever the apertures.
    pub fn is_round(&self) -> bool {
        self.is_centred() && self.interfaces.iter().all(|interface| !interface.is_mirror)
    }

    /// Returns the lens with other gaps, mm, behind the rows `rows`. The gap of the last row, before the film, is not
    /// part of the lens and stays unchanged.
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
            interface.apertures =
                interface.apertures.iter().map(|aperture| aperture.scaled(factor)).collect();
            match &mut interface.shape {
                Shape::Sphere { radius } => *radius *= factor,
                Shape::Asphere(asphere) => *asphere = asphere.scaled(factor),
                Shape::Unsymmetric(figure) => *figure = figure.scaled(factor),
                Shape::Plane => {}
            }
            let change = &mut interface.coordinate_break;
            *change = change.map(|change| change.scaled(factor));
        }
        scaled.film_break = self.film_break.map(|change| change.scaled(factor));
        scaled.nominal_film_distance = self.nominal_film_distance.map(|length| length * factor);
        scaled.positions = self.positions.as_ref().map(|positions| positions.scaled(factor));
        scaled.stated_focal_length = self.stated_focal_length.map(|length| length * factor);
        scaled
    }

    /// Returns whether any medium has an Abbe number or a dispersion formula, so that the wavelength matters.
    pub fn is_dispersive(&self) -> bool {
        self.media().any(|(medium, _)| medium.is_dispersive())
    }
}

/// The lowest power of r in [`Asphere::terms`].
pub const FIRST_POWER: usize = 1;
/// The highest power of r in [`Asphere::terms`].
pub const LAST_POWER: usize = 30;
/// The coefficients of the terms, lowest power first.
pub type AsphereTerms = [f64; LAST_POWER - FIRST_POWER + 1];
/// The terms of a pure conic: all 0.
pub const NO_TERMS: AsphereTerms = [0.0; LAST_POWER - FIRST_POWER + 1];

/// A surface of revolution: z = c r²/(1 + √(1 - (1 + k) c² r²)) + Σ `A_i` r^i, where c = 1/radius, z is the distance
/// from the vertex plane toward the film, and r is the distance from the axis (W. J. Smith, *Modern Optical
/// Engineering*, on aspheric surfaces).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Asphere {
    /// Signed vertex radius of the conic, mm; infinite if the base is a plane, never 0.
    pub radius: f64,
    /// The conic constant k: 0 for a sphere, -1 for a paraboloid, less than -1 for a hyperboloid, between -1 and 0 for
    /// a prolate ellipsoid, more than 0 for an oblate ellipsoid.
    pub conic: f64,
    /// A1, A2, … A30, in mm^(1 - i). With A1 the vertex is the tip of a cone.
    pub terms: AsphereTerms,
}

impl Asphere {
    /// Returns the coefficient of r^`power`.
    pub fn term(&self, power: usize) -> f64 {
        self.terms[power - FIRST_POWER]
    }

    /// Returns the semi-diameter at which the conic ends, mm: half the width of an ellipsoid; infinite for an open
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

/// Facts stated by the file, or by the patent from which the file was made.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stated {
    /// The year of the patent or book.
    pub year: Option<u16>,
    /// F-number of a lens without positions. In a lens with positions, each [`Position`](super::Position) has its own
    /// f-number.
    pub fnumber: Option<f64>,
    /// Full fields of view in degrees: one for the lens, or one for each of its positions, in order. Empty if the file
    /// states none.
    pub fields: Vec<Option<f64>>,
}
