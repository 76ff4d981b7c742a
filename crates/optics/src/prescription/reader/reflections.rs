//! Mirrors as Optical Bench text writes them, and files converted from it: a row whose index is -1.
//!
//! A mirror behind glass has three rows of one radius with no distance between them: from the glass to air, the row of
//! index -1, and back to the glass, whose index is positive and whose thickness is negative. This is the mirror that
//! reflects within the glass. A plane in air that is as large as the secondary mirror and stands beside it is no aperture:
//! it would pass exactly the light that the mirror blocks.

use super::surface_rows::{MediumBehind, Role, SurfaceRow};
use crate::prescription::{Aperture, Medium, Outline};
use realistic_base::message::short;

/// The index by which a row states that it reflects.
pub(super) const MIRROR_INDEX: f64 = -1.0;

/// A row as it was before mirrors were joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Joined {
    /// The number of the row.
    pub row: usize,
    /// The number of the row behind which its thickness lies.
    pub gap: usize,
}

/// Makes one row of the three rows of a mirror behind glass. Returns the origin of each row. `object` is the medium in
/// front of the lens. Rows behind which the thickness varies (`moving`) are not joined to the next.
pub(super) fn join(
    rows: &mut Vec<SurfaceRow>,
    object: MediumBehind,
    moving: impl Fn(usize) -> bool,
) -> Vec<Joined> {
    let old = std::mem::take(rows);
    let mut joined = Vec::with_capacity(old.len());
    let mut in_front = object;
    let mut i = 0;
    while i < old.len() {
        let is_one = |three: &[SurfaceRow]| is_mirror_behind(in_front, three) && !moving(i) && !moving(i + 1);
        match old.get(i..i + 3).filter(|three| is_one(three)) {
            Some([first, mirror, last]) => {
                let diameter = first.diameter.min(mirror.diameter).min(last.diameter);
                let apertures = [&*first.apertures, &*mirror.apertures, &*last.apertures].concat();
                let thickness = last.thickness;
                rows.push(SurfaceRow { thickness, diameter, apertures, behind: in_front, ..mirror.clone() });
                joined.push(Joined { row: i + 1, gap: i + 2 });
                i += 3;
            }
            _ => {
                if !old[i].general.is_mirror {
                    in_front = old[i].behind;
                }
                rows.push(old[i].clone());
                joined.push(Joined { row: i, gap: i });
                i += 1;
            }
        }
    }
    joined
}

/// Returns whether three rows are a mirror behind the glass in front of them.
fn is_mirror_behind(in_front: MediumBehind, rows: &[SurfaceRow]) -> bool {
    let [first, mirror, last] = rows else { return false };
    let is_one = |other: &SurfaceRow| {
        other.radius == mirror.radius
            && other.asphere == mirror.asphere
            && !other.general.is_mirror
            && other.role != Role::Stop
    };
    mirror.general.is_mirror
        && is_one(first)
        && is_one(last)
        && first.thickness == 0.0
        && mirror.thickness == 0.0
        && [mirror, last].iter().all(|row| row.general.coordinate_break.is_none())
        && in_front.medium != Medium::Air
        && first.behind.medium == Medium::Air
        && last.behind.medium == in_front.medium
}

/// The largest distance of a secondary mirror from the plane that stands for it, as a fraction of its diameter.
const BESIDE: f64 = 0.3;
/// The largest difference between their diameters, as a fraction.
const AS_LARGE: f64 = 0.01;

/// Makes obstructions of the planes in air in front of the first mirror that are as large as a later mirror beside them.
/// Returns the numbers of these rows, each with the reason for a warning. `object` is the medium in front of the lens.
pub(super) fn obstructions(rows: &mut [SurfaceRow], object: MediumBehind) -> Vec<(usize, String)> {
    let is_folded = rows.iter().any(|row| row.general.coordinate_break.is_some());
    let Some(primary) = rows.iter().position(|row| row.general.is_mirror).filter(|_| !is_folded) else {
        return Vec::new();
    };
    let vertices: Vec<f64> =
        rows.iter().scan(0.0, |next, row| Some(std::mem::replace(next, *next + row.thickness))).collect();
    let largest = rows[..=primary].iter().map(|row| row.diameter).fold(0.0, f64::max);
    let mut found = Vec::new();
    for plane in 0..primary {
        let in_front = if plane == 0 { object } else { rows[plane - 1].behind };
        let row = &rows[plane];
        let is_plane = row.radius.is_infinite() && row.asphere.is_none() && row.general.unsymmetric.is_none();
        let in_air = in_front.medium == Medium::Air && row.behind.medium == Medium::Air;
        let diameter = row.diameter;
        let is_beside = |&other: &usize| {
            rows[other].general.is_mirror
                && (rows[other].diameter - diameter).abs() <= AS_LARGE * diameter
                && (vertices[other] - vertices[plane]).abs() <= BESIDE * diameter
        };
        let Some(_) = (primary + 1..rows.len()).find(is_beside).filter(|_| is_plane && in_air) else {
            continue;
        };
        let outline = Outline::Ellipse([diameter / 2.0; 2]);
        let row = &mut rows[plane];
        row.apertures.push(Aperture { is_obstruction: true, ..Aperture::centered(outline) });
        row.diameter = largest;
        row.role = Role::FlareStop;
        let reason = format!(
            "a plane in air of diameter {} mm, as large as the secondary mirror beside it, is taken for an obstruction and not \
             for an aperture, which would pass only what that mirror blocks",
            short(diameter)
        );
        found.push((plane, reason));
    }
    found
}
