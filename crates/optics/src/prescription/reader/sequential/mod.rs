//! Surfaces in sequence, as designers' programs write them: with semi-diameters that may be missing, and with surfaces
//! that bend no ray.
//!
//! `paraxial` derives the size of the stop and missing sizes from the file's aperture and field. `frames` composes the
//! changes of frame. `lens` builds the prescription of a file with one configuration.

mod frames;
mod lens;
mod paraxial;

use super::{
    surface_rows::{General, MediumBehind, Role, SurfaceRow},
    text::{Location, Text},
};
use crate::prescription::{
    Aperture as Outline, CoordinateBreak, LensFileError,
    glass::VALID_WAVELENGTHS,
    interfaces::{Asphere, AsphereTerms, FIRST_POWER, LAST_POWER, Medium, NO_TERMS, Prescription, Shape},
    positions::{Position, Positions},
    unsymmetric::{Meridian, PROFILE_TERMS, Unsymmetric},
};
pub(super) use frames::{Behind, Frames, decentre_and_tilts};
pub(super) use lens::{SequentialLens, SurfacePlaces};
pub(super) use paraxial::{Aperture, Field, FieldKind, Paraxial};
use realistic_base::message::{as_given, short};

/// Object distances from this value on, in the file's unit, mean infinity: programs write 1e10.
const FAR: f64 = 1e9;

/// The reason recorded for an image that is not a plane.
pub(super) const CURVED_IMAGE: &str = "the image is curved; the film is flat";

/// Negative thicknesses of a magnitude below this value, mm, are rounding errors and are set to 0.
pub(super) const ROUNDING: f64 = 1e-4;

/// A surface, with lengths in the file's unit.
#[derive(Clone, Debug)]
pub(super) struct SequentialSurface {
    /// 1/R. The radius in `asphere` stays infinite.
    pub curvature: f64,
    pub asphere: Option<Asphere>,
    /// The medium behind the surface.
    pub behind: MediumBehind,
    /// The semi-diameter in use: that of the circle around the aperture or, without an aperture, that which the file
    /// states.
    pub semi_diameter: Option<f64>,
    /// The semi-diameter that the file states.
    pub listed: Option<f64>,
    /// The semi-diameter of the circle around the aperture.
    pub clip: Option<f64>,
    /// Apertures and obstructions other than a circle about the axis.
    pub apertures: Vec<Outline>,
    /// Whether the file fixes the semi-diameter or states an aperture. Otherwise the file's program computed the
    /// semi-diameter from rays.
    pub is_fixed: bool,
    pub is_stop: bool,
    pub general: General,
    /// The change of frame behind the surface, in front of its thickness.
    pub break_behind: Option<CoordinateBreak>,
}

/// Returns a wavelength in nm, rounded to the intended decimal number, because 0.58756 times 1000 is not exactly 587.56.
///
/// # Errors
/// Lenses are not traced at this wavelength; the text says so.
pub(super) fn nanometres(micrometres: f64) -> Result<f64, String> {
    let wavelength = format!("{:.12e}", micrometres * 1e3).parse().unwrap_or(f64::NAN);
    if VALID_WAVELENGTHS.contains(&wavelength) {
        return Ok(wavelength);
    }
    let (first, last) = (VALID_WAVELENGTHS.start(), VALID_WAVELENGTHS.end());
    Err(format!(
        "the primary wavelength is {} nm; lenses are traced from {first} to {last} nm",
        as_given(wavelength)
    ))
}

/// Returns a figure whose base is that of its surface; `None` for a sphere.
pub(super) fn asphere(conic: f64, terms: AsphereTerms) -> Option<Asphere> {
    let asphere = Asphere { radius: f64::INFINITY, conic, terms };
    (conic != 0.0 || terms != NO_TERMS).then_some(asphere)
}

/// Sets the term of r^`power` of a figure.
///
/// # Errors
/// Tracing does not support the power; the text says so.
pub(super) fn set_term(terms: &mut AsphereTerms, power: usize, value: f64) -> Result<(), String> {
    match power.checked_sub(FIRST_POWER).and_then(|index| terms.get_mut(index)) {
        Some(term) => *term = value,
        None if value == 0.0 => {}
        None => {
            return Err(format!(
                "has a term of r^{power}; terms of r^{FIRST_POWER} to r^{LAST_POWER} are traced: write 0 to trace the \
                 surface without this one, or fit it by others"
            ));
        }
    }
    Ok(())
}

/// Returns whether a surface leaves rays as they are: the media on its sides are the same, and it is no mirror. `object` is the medium in front of the lens.
pub(super) fn is_idle(object: MediumBehind, surfaces: &[SequentialSurface], i: usize) -> bool {
    let in_front = if i == 0 { object } else { surfaces[i - 1].behind };
    in_front == surfaces[i].behind && !surfaces[i].general.is_mirror
}

/// Returns the semi-diameter of a stop that states none: that of the widest beam that passes the other surfaces.
pub(super) fn let_through(
    object: MediumBehind,
    surfaces: &[SequentialSurface],
    stop: usize,
    paraxial: &Paraxial,
) -> Option<f64> {
    let counts = |&i: &usize| i != stop && (!is_idle(object, surfaces, i) || surfaces[i].is_fixed);
    let others = (0..surfaces.len()).filter(counts).filter_map(|i| Some((i, surfaces[i].semi_diameter?)));
    paraxial.let_through(stop, others)
}

/// The surfaces of a file, told apart by their effect.
#[derive(Debug)]
pub(super) struct Effective {
    /// The surfaces that bend rays, are the stop, or have an aperture that the file fixes.
    pub kept: Vec<usize>,
    /// The other surfaces that change no frame, each with the reason why it has no effect.
    pub left_out: Vec<(usize, &'static str)>,
}

impl Effective {
    /// Tells the surfaces apart. `thicknesses` are those behind the surfaces. Planes behind the image limit no ray that
    /// reaches the image.
    pub(super) fn of(object: MediumBehind, surfaces: &[SequentialSurface], thicknesses: &[f64]) -> Self {
        let limits = |i: usize| surfaces[i].is_fixed && surfaces[i].semi_diameter.is_some();
        let bends = |i: usize| !is_idle(object, surfaces, i) || surfaces[i].is_stop;
        let last_bending = (0..surfaces.len()).rev().find(|&i| bends(i));
        let mut all = Self { kept: Vec::new(), left_out: Vec::new() };
        let mut to_image = thicknesses.to_vec();
        for i in (1..to_image.len()).rev() {
            to_image[i - 1] += to_image[i];
        }
        let sign = light_sign(surfaces);
        for (i, to_image) in to_image.into_iter().enumerate() {
            let turns = surfaces[i].general.coordinate_break.or(surfaces[i].break_behind).is_some();
            if bends(i) {
                all.kept.push(i);
            } else if turns && !limits(i) {
                // Its change of frame is that of the next surface.
            } else if sign * to_image < 0.0 && last_bending.is_none_or(|last| last < i) {
                let reason = "a plane behind the image, which limits no ray that reaches it";
                all.left_out.push((i, reason));
            } else if limits(i) {
                all.kept.push(i);
            } else {
                let reason = "a surface that bends no ray and whose size the file's program computed";
                all.left_out.push((i, reason));
            }
        }
        all
    }
}

/// Returns the sign of the light's travel along z behind all surfaces: -1 behind an odd number of mirrors.
pub(super) fn light_sign(surfaces: &[SequentialSurface]) -> f64 {
    let mirrors = surfaces.iter().filter(|surface| surface.general.is_mirror).count();
    if mirrors.is_multiple_of(2) { 1.0 } else { -1.0 }
}

/// The share of the paraxial beam's height that a derived semi-diameter has. In the programs that leave sizes out, such a
/// surface limits no ray. Exact rays are some percent higher than paraxial ones on fast surfaces; the rest of the margin
/// costs samples of the pupil, which the stop then blocks.
const DERIVED_MARGIN: f64 = 1.1;

/// Derives the missing semi-diameters by paraxial rays of the stop's size and the field, if the stop has a size. Each
/// leaves a margin, up to the hemisphere. `thicknesses` begins with the distance of the object. Returns the surfaces whose sizes were derived.
pub(super) fn derive_missing(
    object: MediumBehind,
    surfaces: &mut [SequentialSurface],
    thicknesses: &[f64],
    field: Field,
    wavelength: f64,
) -> Vec<usize> {
    let stop = surfaces.iter().position(|surface| surface.is_stop);
    let Some((stop, size)) = stop.and_then(|stop| Some((stop, surfaces[stop].semi_diameter?))) else {
        return Vec::new();
    };
    let meridians = [Meridian::X, Meridian::Y]
        .map(|own| Paraxial::of(object.medium, surfaces, &thicknesses[1..], own, wavelength));
    let reach = |i: usize| {
        let of = |own: &Paraxial| own.reach(i, stop, size, own.field(field, stop, thicknesses[0]));
        meridians.iter().filter_map(of).max_by(f64::total_cmp)
    };
    let is_missing = |&i: &usize| surfaces[i].semi_diameter.is_none() && !is_idle(object, surfaces, i);
    let missing: Vec<usize> = (0..surfaces.len()).filter(is_missing).collect();
    let found: Vec<(usize, f64)> = missing.into_iter().filter_map(|i| Some((i, reach(i)?))).collect();
    let mut derived = Vec::new();
    for (i, reach) in found {
        let hemisphere = surfaces[i].curvature.abs().recip();
        surfaces[i].semi_diameter = Some((DERIVED_MARGIN * reach).min(hemisphere));
        derived.push(i);
    }
    derived
}

/// Returns the row of a surface, with the thickness behind it and the change of frame in front of it; `None` if the
/// surface has no size.
pub(super) fn surface_row(
    object: MediumBehind,
    surfaces: &[SequentialSurface],
    i: usize,
    (thickness, coordinate_break): (f64, Option<CoordinateBreak>),
) -> Option<SurfaceRow> {
    let surface = &surfaces[i];
    let is_plane = surface.curvature == 0.0
        && surface.asphere.is_none_or(|asphere| asphere.terms == NO_TERMS)
        && surface.general.unsymmetric.is_none_or(|figure| figure.is_plane());
    let is_in_air = is_idle(object, surfaces, i) && surface.behind.medium == Medium::Air;
    let role = match surface.is_stop {
        true => Role::Stop,
        false if is_plane && is_in_air => Role::FlareStop,
        false => Role::Any,
    };
    Some(SurfaceRow {
        // A curvature of 0 means a plane.
        radius: if surface.curvature == 0.0 { f64::INFINITY } else { surface.curvature.recip() },
        role,
        thickness,
        behind: surface.behind,
        diameter: 2.0 * surface.semi_diameter?,
        asphere: surface.asphere.filter(|_| !is_plane),
        apertures: surface.apertures.clone(),
        general: General { coordinate_break, ..surface.general },
    })
}

/// Returns the configurations as positions, each with the distance of its object from the first surface that has an effect;
/// `None` if the file has a single configuration with the object at infinity.
pub(super) fn positions(
    text: &Text<'_>,
    objects: &[f64],
    gaps: &[Vec<f64>],
    stop_sizes: &[Option<f64>],
    object: Location,
) -> Result<Option<Positions>, LensFileError> {
    let distance = |distance: &f64| Some(*distance).filter(|distance| distance.abs() < FAR);
    if let Some(behind) = objects.iter().filter_map(distance).find(|distance| *distance <= 0.0) {
        let message = format!(
            "the object lies {} in front of the first surface; expected a positive distance",
            short(behind)
        );
        return Err(text.error(object, message));
    }
    if objects.len() == 1 && distance(&objects[0]).is_none() {
        return Ok(None);
    }
    let moving: Vec<usize> =
        (0..gaps[0].len()).filter(|&row| gaps.iter().any(|column| column[row] != gaps[0][row])).collect();
    let column = |i: usize| Position {
        name: None,
        gaps: moving.iter().map(|&row| gaps[i][row]).collect(),
        stop_diameter: stop_sizes.get(i).copied().flatten().map(|size| 2.0 * size),
        focal_length: None,
        fnumber: None,
        object_distance: distance(&objects[i]),
    };
    let columns = (0..gaps.len()).map(column).collect();
    Ok(Some(Positions { gaps: moving, columns }))
}

/// Returns whether all lengths are finite, and whether all lengths except thicknesses and gaps are also positive. Units
/// and sums may cause overflow or underflow.
pub(super) fn has_range(lens: &Prescription) -> bool {
    let is_length = |length: f64| length > 0.0 && length.is_finite();
    let interfaces = lens.interfaces.iter().all(|interface| {
        let shape = match interface.shape {
            Shape::Sphere { radius } => is_length(radius.abs()) && interface.semi_diameter <= radius.abs(),
            Shape::Asphere(asphere) => {
                asphere.radius != 0.0 && asphere.terms.iter().all(|term| term.is_finite())
            }
            Shape::Unsymmetric(figure) => {
                let has_range = |radius: f64| radius != 0.0 && !radius.is_nan();
                let terms = match figure {
                    Unsymmetric::Toroid(toroid) => toroid.terms,
                    Unsymmetric::Biconic(_) => [0.0; PROFILE_TERMS],
                };
                figure.radii().into_iter().all(has_range) && terms.iter().all(|term| term.is_finite())
            }
            Shape::Plane => true,
        };
        let is_finite = interface.coordinate_break.is_none_or(|change| change.is_finite());
        shape && is_finite && interface.thickness.is_finite() && is_length(interface.semi_diameter)
    });
    let mut columns = lens.positions.iter().flat_map(|positions| &positions.columns);
    let columns = columns.all(|column| {
        let lengths = [column.stop_diameter, column.object_distance, column.focal_length];
        column.gaps.iter().all(|gap| gap.is_finite()) && lengths.into_iter().flatten().all(is_length)
    });
    let film = lens.film_break.is_none_or(|change| change.is_finite());
    interfaces && columns && film && lens.nominal_film_distance.is_none_or(is_length)
}
