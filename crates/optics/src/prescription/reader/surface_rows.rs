//! A surface as its row states it, in any format. This module also builds the interfaces of a lens from its rows, with
//! the checks that need a row's neighbours.

use super::{ledger::Ledger, text::Location};
use crate::prescription::{
    Fate, LensFileError, MAX_INTERFACES,
    aperture::Aperture,
    coordinate_break::CoordinateBreak,
    interfaces::{Asphere, Glass, Interface, Medium, Shape, spans},
    positions::Positions,
    unsymmetric::Unsymmetric,
};
use realistic_base::message::{as_given, short};

/// The role that a row states for its surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// No role: a plane in air is the stop, or a flare stop if another row is the stop.
    Any,
    /// The aperture stop.
    Stop,
    /// A flare stop: a plane in air that is not the aperture stop.
    FlareStop,
}

/// The medium behind a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MediumBehind {
    pub medium: Medium,
    /// The index of the glass in the list of glasses that the file names.
    pub glass: Option<usize>,
}

impl From<Medium> for MediumBehind {
    fn from(medium: Medium) -> Self {
        Self { medium, glass: None }
    }
}

impl MediumBehind {
    /// Returns the medium of a named glass, and adds the glass to `glasses` if it is new.
    pub(super) fn named(name: &str, glass: Glass, glasses: &mut Vec<(String, Glass)>) -> Self {
        let medium = glass.medium;
        let known = glasses.iter().position(|(known, other)| known == name && *other == glass);
        let number = known.unwrap_or_else(|| {
            glasses.push((name.to_owned(), glass));
            glasses.len() - 1
        });
        Self { medium, glass: Some(number) }
    }
}

/// The values of a row. The medium in front of the row is not known yet.
#[derive(Clone, Debug)]
pub(super) struct SurfaceRow {
    /// Signed radius, mm; infinite for a plane.
    pub radius: f64,
    pub role: Role,
    pub thickness: f64,
    pub behind: MediumBehind,
    pub diameter: f64,
    /// The aspheric figure, if the row has more than a radius. The radius of the figure is that of the row.
    pub asphere: Option<Asphere>,
    /// Apertures and obstructions inside the clear aperture, with lengths in mm.
    pub apertures: Vec<Aperture>,
    pub general: General,
}

/// The properties of a surface that is not a refracting surface of revolution on the axis.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct General {
    /// The figure, if it is not symmetric about its axis. The row's radius is then infinite.
    pub unsymmetric: Option<Unsymmetric>,
    /// Whether the surface reflects; the medium behind it is then that in front of it.
    pub is_mirror: bool,
    /// The change of frame in front of the surface.
    pub coordinate_break: Option<CoordinateBreak>,
}

/// A function that returns the error for a row's number, counted from 0, and the fault in that row.
pub(super) type AtRow<'a> = &'a dyn Fn(usize, &str) -> LensFileError;

/// Indices from this value up to 1 are read as the index of vacuum relative to air, 0.9997. An index as close to 1 from
/// above is hardly that of a glass.
const NEARLY_AIR: f64 = 0.999;
/// Range of V-numbers of glasses, crystals and plastics. ZnSe has 8 and CaF2 has 95; the rest of the range is a margin
/// for rounding.
const V_NUMBERS: [f64; 2] = [5.0, 200.0];

/// Builds the interfaces of a lens from its rows, scene side first. `object` is the medium in front of the lens.
/// Warnings about rows that are not used as written go to `ledger`.
///
/// # Errors
/// A row cannot be an interface of a lens. The error is about the first such row.
pub(super) fn interfaces(
    rows: &[SurfaceRow],
    object: Medium,
    at: AtRow<'_>,
    ledger: &mut Ledger<'_>,
) -> Result<Vec<Interface>, LensFileError> {
    if rows.len() > MAX_INTERFACES {
        let message = format!(
            "row {} of {}; a lens has at most {MAX_INTERFACES} interfaces",
            MAX_INTERFACES + 1,
            rows.len()
        );
        return Err(at(MAX_INTERFACES, &message));
    }
    let has_stop_row = rows.iter().any(|row| row.role == Role::Stop);
    let mut in_front = MediumBehind::from(object);
    let mut stop: Option<usize> = None;
    let mut replaced = |row: usize, statement: &str, reason: String| {
        let LensFileError { line, column, message, .. } = at(row, &reason);
        ledger.warn(Fate::Replaced, Location { line, column }, statement, None, message);
    };
    let mut interfaces = Vec::with_capacity(rows.len());
    for (number, row) in rows.iter().enumerate() {
        let behind = if row.general.is_mirror { in_front } else { row.behind };
        let behind = checked(behind, |reason| replaced(number, "index", reason));
        let MediumBehind { medium, glass } = behind;
        let in_air = in_front.medium == Medium::Air && medium == Medium::Air && !row.general.is_mirror;
        let mut semi_diameter = row.diameter / 2.0;
        // Half of the smallest positive number is 0, and twice the largest is infinite.
        if !(semi_diameter > 0.0 && semi_diameter.is_finite()) {
            let diameter = short(row.diameter);
            return Err(at(number, &format!("clear diameter {diameter} mm: expected a positive number")));
        }
        let figure = row.asphere.filter(|asphere| !is_conic_alone(asphere) || asphere.conic != 0.0);
        let unsymmetric = row.general.unsymmetric.filter(|figure| !figure.is_plane());
        let is_straight = row.radius.is_infinite() && unsymmetric.is_none();
        let is_plane = is_straight && figure.is_none_or(|figure| is_conic_alone(&figure));
        if row.role == Role::FlareStop && !(is_plane && in_air) {
            return Err(at(
                number,
                "a flare stop is a plane with air on both sides; a plane of glass is written with radius inf",
            ));
        }
        let shape = match figure {
            _ if is_plane => Shape::Plane,
            _ if unsymmetric.is_some() => unsymmetric.map_or(Shape::Plane, Shape::Unsymmetric),
            Some(_) if in_air && row.radius.is_infinite() => {
                return Err(at(number, "an asphere between air and air bends no ray; give it a glass"));
            }
            Some(asphere) => Shape::Asphere(Asphere { radius: row.radius, ..asphere }),
            None => Shape::Sphere { radius: row.radius },
        };
        let widest = shape.widest();
        if semi_diameter > widest {
            let reason = too_wide(row, figure.map_or(0.0, |figure| figure.conic), widest);
            replaced(number, "clear diameter", reason);
            semi_diameter = widest;
        }
        let is_stop = match row.role {
            Role::Stop => true,
            Role::FlareStop => false,
            Role::Any => is_plane && in_air && !has_stop_row,
        };
        if let (true, Some(first)) = (is_stop, stop) {
            let first = at(first, "").line;
            let message = format!(
                "a second stop (the first is on line {first}); a plane between air and air is the stop, and a lens has at \
                 most one (\"flare\" for a plane in air that is not)"
            );
            return Err(at(number, &message));
        }
        if is_stop {
            stop = Some(number);
        }
        let thickness = row.thickness;
        let apertures = row.apertures.iter().cloned().collect();
        interfaces.push(Interface {
            shape,
            thickness,
            medium,
            glass,
            semi_diameter,
            is_stop,
            apertures,
            is_mirror: row.general.is_mirror,
            coordinate_break: row.general.coordinate_break.filter(|change| change.along_axis() != Some(0.0)),
        });
        in_front = behind;
    }
    in_order(object, &interfaces, at)?;
    Ok(interfaces)
}

/// Checks that the film is in air, for formats that cannot state another medium.
///
/// # Errors
/// The last interface has a glass behind it.
pub(super) fn film_in_air(interfaces: &[Interface], at: AtRow<'_>) -> Result<(), LensFileError> {
    match interfaces {
        [.., last] if last.medium != Medium::Air => {
            let message =
                "the last interface has glass behind it; the film is in air, so its index must be 0 or 1";
            Err(at(interfaces.len() - 1, message))
        }
        _ => Ok(()),
    }
}

/// Checks that the vertices are in order. Planes that only limit rays are exempt and may lie anywhere between the
/// surfaces around them. A stop within its neighbour's sagitta is common, and tracing decides whether rays meet the
/// stop.
///
/// # Errors
/// A row lies in front of the row before it. The error is about the first such row.
pub(super) fn in_order(object: Medium, interfaces: &[Interface], at: AtRow<'_>) -> Result<(), LensFileError> {
    let signs = light_signs(interfaces);
    let wrong = |number: usize| {
        let thickness = short(interfaces[number].thickness);
        let message = if signs[number] < 0.0 {
            format!(
                "thickness {thickness} mm: behind an odd number of mirrors light goes back, and thicknesses are 0 or less"
            )
        } else {
            format!(
                "thickness {thickness} mm: vertices stand in order, so it is 0 or more (but beside a stop, and together with \
                 the thickness on its other side)"
            )
        };
        at(number, &message)
    };
    let along = |row: usize| signs[row] * interfaces[row].thickness;
    for mut span in spans(object, interfaces) {
        let is_turned =
            interfaces[span.start + 1..=span.end].iter().any(|next| next.coordinate_break.is_some());
        let distance: f64 = span.clone().map(along).sum();
        if let Some(negative) = span.find(|&row| along(row) < 0.0).filter(|_| distance < 0.0 && !is_turned) {
            return Err(wrong(negative));
        }
    }
    let last = interfaces.len() - 1;
    if along(last) < 0.0 { Err(wrong(last)) } else { Ok(()) }
}

/// Returns the sign of the light's travel along z behind each interface: -1 behind an odd number of mirrors.
pub(super) fn light_signs(interfaces: &[Interface]) -> Vec<f64> {
    let turned = |sign: &mut f64, interface: &Interface| {
        *sign = if interface.is_mirror { -*sign } else { *sign };
        Some(*sign)
    };
    interfaces.iter().scan(1.0, turned).collect()
}

/// Checks at each of the positions that the vertices are in order, as [`in_order`] does. Then counts the distance to the
/// film along the light, as positions have it: that of a row is negative behind an odd number of mirrors.
///
/// # Errors
/// Returns the error of [`in_order`], together with the position at which it occurs.
pub(super) fn positions_in_order(
    object: Medium,
    interfaces: &[Interface],
    positions: Option<&mut Positions>,
    at: AtRow<'_>,
) -> Result<(), LensFileError> {
    let Some(positions) = positions else { return Ok(()) };
    let last = interfaces.len() - 1;
    let sign = light_signs(interfaces)[last];
    for (number, column) in positions.columns.iter_mut().enumerate() {
        let mut placed = interfaces.to_vec();
        for (&row, &gap) in positions.gaps.iter().zip(&column.gaps) {
            placed[row].thickness = gap;
        }
        in_order(object, &placed, &|row, message| at(row, &format!("position {}: {message}", number + 1)))?;
        if let Some(at_film) = positions.gaps.iter().position(|&row| row == last) {
            column.gaps[at_film] *= sign;
        }
    }
    Ok(())
}

/// Returns the medium behind a surface, and passes one sentence about each unusual number of that medium to `remark`.
pub(super) fn checked(behind: MediumBehind, mut remark: impl FnMut(String)) -> MediumBehind {
    let Medium::Glass { n_d, abbe } = behind.medium else { return behind };
    if n_d < 1.0 {
        remark(format!("index {}, vacuum's against air; air is used, index 1", as_given(n_d)));
        return Medium::Air.into();
    }
    if n_d < 2.0 - NEARLY_AIR {
        remark(format!("index {} is nearly air's; write 1 if air is meant", as_given(n_d)));
    }
    if let Some(abbe) = abbe.filter(|abbe| !(V_NUMBERS[0]..=V_NUMBERS[1]).contains(abbe)) {
        let [low, high] = V_NUMBERS;
        remark(format!("V-number {}: those of glasses lie between {low} and {high}", as_given(abbe)));
    }
    behind
}

/// Returns the index of a medium that a file states as a number; `None` for air, written 0 or 1.
///
/// # Errors
/// No medium of a lens has this index; the text states the allowed indices.
pub(super) fn index(number: f64) -> Result<Option<f64>, &'static str> {
    match number {
        0.0 | 1.0 => Ok(None),
        _ if number >= NEARLY_AIR => Ok(Some(number)),
        _ => Err("a refractive index is 1 or more"),
    }
}

/// Returns whether a figure is a pure conic, without terms.
fn is_conic_alone(asphere: &Asphere) -> bool {
    asphere.terms.iter().all(|term| *term == 0.0)
}

/// Returns the warning that a clear diameter is larger than the whole surface. Such a diameter may be that of the
/// mount.
fn too_wide(row: &SurfaceRow, conic: f64, widest: f64) -> String {
    let [diameter, radius, used] = [row.diameter, row.radius, 2.0 * widest].map(short);
    if conic == 0.0 {
        format!(
            "clear diameter {diameter} mm on a sphere of radius {radius} mm; {used} mm is used, the whole sphere"
        )
    } else {
        format!(
            "clear diameter {diameter} mm on a conic of radius {radius} mm and constant {}; {used} mm is used, the \
             whole conic",
            short(conic)
        )
    }
}
