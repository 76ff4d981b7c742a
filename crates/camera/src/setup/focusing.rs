//! The film's position: at a given distance, or focused on a plane.

use super::{facts::Facts, shared::FocusableLens};
use crate::parameters::CameraError;
use realistic_base::message::{Level, Log, short};
use realistic_optics::{
    imaging::{
        focus::{Focus, FocusError},
        open::OpenLens,
    },
    lens::{Lens, LensError, first_order::FirstOrder},
};

/// The kind of optics by which the film position that focuses the lens is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Focusing {
    /// Exact rays.
    Exact,
    /// First-order optics.
    Paraxial,
}

/// The requested position of the film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum FilmPosition {
    /// The position that the lens file gives or, if it gives none, the focus at infinity.
    Nominal,
    /// A given distance behind the last vertex, mm.
    At(f64),
    /// The focus on a plane at this distance in front of the film, mm; the distance may be infinite.
    FocusedOn(f64),
}

/// Smallest number of glass elements of a lens that is assumed to be corrected for axial points, unlike a
/// reading glass.
const CORRECTED: usize = 3;
/// Largest RMS radius of the best image of an axial point, relative to the radius of the bundle of rays and
/// relative to the focal length. A corrected lens that exceeds both limits is not a real design. The lenses
/// of the catalogue reach 0.0057 and 0.0007; lenses with one wrong sign usually reach several times these
/// values.
const MOST_BLUR: [f64; 2] = [0.015, 0.0015];

/// Returns the film distance and the distance in focus, both in mm. `log` receives a warning if the lens
/// forms no sharp image anywhere.
pub(super) fn place_film(
    optics: &FocusableLens,
    position: FilmPosition,
    focusing: Focusing,
    log: Log<'_>,
) -> Result<(f64, Option<f64>), CameraError> {
    let OpenLens { lens, first_order, .. } = &optics.lens;
    let mut focus = || {
        let focus = optics.focus()?;
        warn_of_blur(lens, focus, log);
        Ok(focus)
    };
    let object = match (position, lens.nominal_film_distance) {
        (FilmPosition::At(distance), _) | (FilmPosition::Nominal, Some(distance)) => {
            let in_focus = match focusing {
                // A lens that cannot focus can still take pictures with its film at the distance that the
                // caller gives.
                Focusing::Exact => focus().ok().and_then(|focus| focus.object_distance(distance)),
                Focusing::Paraxial => first_order.clone()?.object_distance(distance),
            };
            return Ok((distance, in_focus));
        }
        (FilmPosition::FocusedOn(distance), _) => distance,
        (FilmPosition::Nominal, None) => f64::INFINITY,
    };
    let focus = focus().map_err(|error| match (focusing, &error) {
        // The thick and the thin lens are undefined without a focal length.
        (Focusing::Paraxial, FocusError::Lens(LensError::Afocal { .. })) => error.into(),
        _ => CameraError::NoFilmDistance(error),
    })?;
    let film_distance = match focusing {
        Focusing::Exact => focus.film_distance(object)?,
        Focusing::Paraxial => paraxial_film_distance(&lens.name, &first_order.clone()?, focus, object)?,
    };
    Ok((film_distance, Some(object)))
}

/// Largest blur of the sharpest point without a warning, relative to the film's diagonal, for film that is
/// placed at a given distance and not focused: about ten circles of confusion.
const MOST_DEFOCUS: f64 = 0.01;

/// Warns of film so near to the lens, or so far from it, that nothing in front of the lens can be in focus.
/// `is_given` is true for film placed by the caller and false for film placed by the lens file.
pub(super) fn warn_of_blurred_film(facts: &Facts, optics: &FocusableLens, is_given: bool, log: Log<'_>) {
    let in_focus = facts.focus_distance_mm;
    if in_focus.is_some_and(f64::is_finite) {
        return;
    }
    // Lenses that cannot focus can still take pictures.
    let Ok((focus, infinity)) =
        optics.focus().and_then(|focus| focus.film_distance(f64::INFINITY).map(|infinity| (focus, infinity)))
    else {
        return;
    };
    let (distance, diagonal) = (facts.film_distance, facts.film.diagonal());
    let why = match in_focus {
        Some(_) => {
            let blur = (infinity - distance) / (facts.fnumber() * facts.lens.rear().n_film);
            if blur <= MOST_DEFOCUS * diagonal {
                return;
            }
            let [blur, diagonal] = [blur, diagonal].map(short);
            format!("even infinity is blurred to {blur} mm on a film of {diagonal} mm")
        }
        None => "what would be lies in the lens".to_owned(),
    };
    let nearest = focus.nearest();
    let (source, advice) = match is_given {
        true => ("\"film_distance\"", "\"film_distance\" is in mm whatever the world's units are"),
        false => (
            "the lens file's film distance",
            "give \"film_distance\", or \"focus_distance\" for what is to be sharp",
        ),
    };
    log(
        Level::Warning,
        &format!(
            "with {source} {} mm nothing can be in focus: {why}; infinity needs {} mm, and the nearest plane in focus, {} mm from \
             the film, {} mm ({advice})",
            short(distance),
            short(infinity),
            short(nearest.object_distance),
            short(nearest.film_distance)
        ),
    );
}

/// Warns of a lens of several elements whose axial image is worse than that of any real design, because the
/// lens's description is then probably wrong.
fn warn_of_blur(lens: &Lens, focus: &Focus, log: Log<'_>) {
    // The medium behind the last surface is that of the film.
    let before_last = &lens.surfaces[..lens.surfaces.len() - 1];
    let elements = before_last.iter().filter(|surface| surface.n_film > 1.0).count();
    let [spot, bundle] = focus.axial_spot();
    if elements >= CORRECTED && spot > MOST_BLUR[0] * bundle && spot > MOST_BLUR[1] * focus.focal_length() {
        log(
            Level::Warning,
            &format!(
                "lens \"{}\" makes no sharp image even on the axis: at its best a distant point becomes a spot {} mm wide \
                 (RMS diameter, bundle {} mm wide, focal length {} mm), which no lens of {elements} elements is designed to \
                 do; is a radius, a sign, a thickness or an index misprinted?",
                lens.name,
                short(2.0 * spot),
                short(2.0 * bundle),
                short(focus.focal_length())
            ),
        );
    }
}

fn paraxial_film_distance(
    lens: &str,
    first_order: &FirstOrder,
    focus: &Focus,
    distance: f64,
) -> Result<f64, FocusError> {
    if let Some(film_distance) = focus.paraxial_film_distance(distance) {
        return Ok(film_distance);
    }
    // In air the distance between object and image is smallest at magnification -1.
    let focal_length = first_order.mean_focal_length();
    let film_distance = first_order.back_focal_distance() + focal_length;
    let object = first_order.front_focal_point + focal_length;
    let nearest = object - first_order.rear_vertex + film_distance;
    Err(FocusError::TooNear { lens: lens.to_owned(), distance, nearest, film_distance })
}
