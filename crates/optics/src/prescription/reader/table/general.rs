//! Lines about surfaces that are no refracting surfaces of revolution on the axis: `toroid ROW …`, `biconic ROW …`,
//! `mirror ROW` and `break ROW …`.

use super::lines::{Line, Lines};
use crate::prescription::{
    CoordinateBreak, LensFileError, MAX_INTERFACES, PROFILE_TERMS,
    reader::{surface_rows::SurfaceRow, text::Cell},
    unsymmetric::{Biconic, Meridian, Toroid, Unsymmetric},
};

const TOROID: &str = "a toroid is: toroid ROW rotation=RADIUS profile=y conic=… A2=… … A14=…; the row's radius is that of its \
     profile, and rotation is the radius about which the profile turns, inf (or left out) for a cylinder; profile=x for one \
     that lies in x";
const BICONIC: &str = "a biconic is: biconic ROW x=RADIUS conic_x=… conic_y=…; the row's radius is that in y";
const MIRROR: &str = "a mirror is: mirror ROW";
const BREAK: &str = "a change of frame is: break ROW x=… y=… z=… tilt_x=… tilt_y=… tilt_z=… (mm and degrees; 0 where left out), in \
     front of the row, or \"break film …\" in front of the film; first=tilt for tilts in the order z, y, x before the decentre";

/// The lines of a table about surfaces that are not round.
#[derive(Debug)]
pub(super) struct GeneralLines<'t> {
    figures: Vec<Line<'t>>,
    mirrors: Vec<Line<'t>>,
    breaks: Vec<Line<'t>>,
}

impl<'t> GeneralLines<'t> {
    /// Takes the lines out of `lines`.
    pub(super) fn take(lines: &mut Lines<'t>) -> Result<Self, LensFileError> {
        let all = Self {
            figures: lines.take(&["toroid", "biconic"]),
            mirrors: lines.take(&["mirror"]),
            breaks: lines.take(&["break"]),
        };
        for taken in [&all.figures, &all.mirrors, &all.breaks] {
            lines.at_most(taken, MAX_INTERFACES, "a lens has at most as many such lines as interfaces")?;
        }
        Ok(all)
    }

    /// Gives the rows what the lines state. Returns the change of frame in front of the film, if there is one.
    pub(super) fn give(
        &self,
        lines: &Lines<'_>,
        rows: &mut [SurfaceRow],
    ) -> Result<Option<CoordinateBreak>, LensFileError> {
        for line in &self.figures {
            let [keyword, row, words @ ..] = line.as_slice() else {
                return Err(lines.error(&line[0], if line[0].is("toroid") { TOROID } else { BICONIC }));
            };
            let form = if keyword.is("toroid") { TOROID } else { BICONIC };
            let index = lines.row_number(row, rows.len(), form)?;
            let radius = std::mem::replace(&mut rows[index].radius, f64::INFINITY);
            let figure = match form {
                TOROID => toroid(lines, words, radius)?,
                _ => biconic(lines, words, radius)?,
            };
            if rows[index].asphere.is_some() || rows[index].general.unsymmetric.replace(figure).is_some() {
                return Err(lines.error(row, &format!("the figure of row {row} is given twice; {form}")));
            }
        }
        for line in &self.mirrors {
            let [_, row] = line.as_slice() else { return Err(lines.error(&line[0], MIRROR)) };
            let index = lines.row_number(row, rows.len(), MIRROR)?;
            rows[index].general.is_mirror = true;
        }
        let mut film = None;
        for line in &self.breaks {
            let [_, row, words @ ..] = line.as_slice() else { return Err(lines.error(&line[0], BREAK)) };
            let change = coordinate_break(lines, words)?;
            let own = if row.is("film") {
                &mut film
            } else {
                let index = lines.row_number(row, rows.len(), BREAK)?;
                &mut rows[index].general.coordinate_break
            };
            *own = Some(own.map_or(change, |before| before.then(&change)));
        }
        Ok(film)
    }
}

/// Takes the constant `NAME=WORD`, whose value is no finite number, out of `words`.
fn choice<'t>(words: &mut Vec<Cell<'t>>, name: &str, values: &[&str]) -> Option<&'t str> {
    let is_it = |word: &Cell<'t>| {
        let (own, value) = word.text.split_once('=')?;
        let is_value = values.iter().any(|known| known.eq_ignore_ascii_case(value));
        (own.eq_ignore_ascii_case(name) && is_value).then_some(value)
    };
    let at = words.iter().position(|word| is_it(word).is_some())?;
    is_it(&words.remove(at))
}

fn names<const N: usize>(names: [&str; N]) -> Vec<String> {
    names.map(str::to_owned).to_vec()
}

/// Returns the radius that a constant states: infinite where it is not given; 0 means infinite, as in a row.
fn radius(constant: Option<f64>) -> f64 {
    constant.filter(|radius| *radius != 0.0).unwrap_or(f64::INFINITY)
}

fn toroid(lines: &Lines<'_>, words: &[Cell<'_>], profile: f64) -> Result<Unsymmetric, LensFileError> {
    let mut words = words.to_vec();
    let is_in_x =
        choice(&mut words, "profile", &["x", "y"]).is_some_and(|value| value.eq_ignore_ascii_case("x"));
    let _ = choice(&mut words, "rotation", &["inf", "infinity"]);
    let mut all = names(["rotation", "conic"]);
    all.extend((1..=PROFILE_TERMS).map(|i| format!("A{}", 2 * i)));
    let constants = lines.constants(&words, &all, "rotation=80", TOROID)?;
    Ok(Unsymmetric::Toroid(Toroid {
        meridian: if is_in_x { Meridian::X } else { Meridian::Y },
        radius: profile,
        conic: constants[1].unwrap_or(0.0),
        terms: std::array::from_fn(|i| constants[i + 2].unwrap_or(0.0)),
        rotation_radius: radius(constants[0]),
    }))
}

fn biconic(lines: &Lines<'_>, words: &[Cell<'_>], in_y: f64) -> Result<Unsymmetric, LensFileError> {
    let mut words = words.to_vec();
    let _ = choice(&mut words, "x", &["inf", "infinity"]);
    let constants = lines.constants(&words, &names(["x", "conic_x", "conic_y"]), "x=80", BICONIC)?;
    let conics = [constants[1], constants[2]].map(|conic| conic.unwrap_or(0.0));
    Ok(Unsymmetric::Biconic(Biconic { radii: [radius(constants[0]), in_y], conics }))
}

fn coordinate_break(lines: &Lines<'_>, words: &[Cell<'_>]) -> Result<CoordinateBreak, LensFileError> {
    let mut words = words.to_vec();
    let tilts_first = choice(&mut words, "first", &["tilt"]).is_some();
    let all = names(["x", "y", "z", "tilt_x", "tilt_y", "tilt_z"]);
    let constants = lines.constants(&words, &all, "tilt_x=5", BREAK)?;
    let [x, y, z, a, b, c] = std::array::from_fn(|i| constants[i].unwrap_or(0.0));
    let change = CoordinateBreak::zemax([x, y], [a, b, c], tilts_first);
    Ok(change.then(&CoordinateBreak::shifted([0.0, 0.0, z])))
}
