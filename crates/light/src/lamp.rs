//! Lamps in front of a lens, and the test of whether a lamp can light the lens.

use thiserror::Error;

use realistic_base::{message::short, numeric::dot};
use realistic_optics::lens::Lens;

/// A lamp, in lens space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lamp {
    /// A lamp infinitely far away, given by the direction from the lens toward it, a vector of any length.
    Distant([f64; 3]),
    /// A point lamp, given by its position, mm.
    Point([f64; 3]),
}

/// Reason why a lamp cannot light a lens.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum LampError {
    /// No part of the front surface faces the lamp.
    #[error(
        "the lamp is beside lens \"{lens}\" or behind it: no part of the front surface faces it; the largest angle from the \
         axis at which a far lamp lights that surface is {} degrees",
        short(*limit)
    )]
    Behind {
        /// The lens.
        lens: String,
        /// The largest angle from the axis at which the surface faces a lamp infinitely far away, degrees.
        limit: f64,
    },
    /// The lamp lies within the sphere that contains the front surface.
    #[error(
        "the lamp is {} mm from the middle of the front surface of lens \"{lens}\", which holds all within {} mm of it; \
         put the lamp farther away",
        short(*distance), short(*least)
    )]
    TooNear {
        /// The lens.
        lens: String,
        /// Distance of the lamp from the middle of the front surface, mm.
        distance: f64,
        /// Radius, mm, of the sphere that contains the front surface.
        least: f64,
    },
}

/// Number of chords that approximate the front surface from the axis to the edge.
const CHORDS: u32 = 64;

impl Lamp {
    /// Checks that some light of the lamp meets the front surface from the scene side. The lens may still block all of
    /// this light.
    ///
    /// A convex front surface also faces lamps at more than 90 degrees from the axis. A fisheye with a field of view of
    /// more than 180 degrees refracts the light of such lamps to the film.
    ///
    /// # Errors
    /// Returns an error if no part of the front surface faces the lamp, or if the lamp is within the sphere that
    /// contains that surface.
    pub fn check(self, lens: &Lens) -> Result<(), LampError> {
        let front = lens.front();
        // The test is made in the half plane, bounded by the axis, in which the lamp lies: if the lamp is beyond 90
        // degrees, the surface can face it only there.
        let at = |i: u32| {
            let height = front.semi_diameter * f64::from(i) / f64::from(CHORDS);
            [height, front.sagitta(height)]
        };
        let chords: Vec<_> = (0..CHORDS).map(|i| (at(i), at(i + 1))).collect();
        let is_faced = chords.iter().any(|([from, low], [to, high])| {
            let (along, rise) = (to - from, high - low);
            match self {
                Self::Distant([x, y, z]) => z * along > x.hypot(y) * rise,
                Self::Point([x, y, z]) => (z - low) * along > (x.hypot(y) - from) * rise,
            }
        });
        if !is_faced {
            let falls = chords.iter().map(|(a, b)| (a[1] - b[1]) / (b[0] - a[0]));
            let limit = 90.0 + falls.fold(0.0, f64::max).atan().to_degrees();
            return Err(LampError::Behind { lens: lens.name.clone(), limit });
        }
        if let Self::Point([x, y, z]) = self {
            let [middle, least] = front_sphere(lens);
            let away = [x, y, z - middle];
            let distance = dot(away, away).sqrt();
            if distance <= least {
                return Err(LampError::TooNear { lens: lens.name.clone(), distance, least });
            }
        }
        Ok(())
    }
}

/// Returns a sphere that contains the clear part of the front surface: z of the sphere's centre, and the radius, mm.
pub(super) fn front_sphere(lens: &Lens) -> [f64; 2] {
    let [low, high] = lens.front().sagitta_range();
    [f64::midpoint(low, high), lens.front().semi_diameter.hypot((high - low) / 2.0)]
}
