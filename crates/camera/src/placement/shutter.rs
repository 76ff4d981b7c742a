//! The shutter function S(x, t): the fraction of the light that the shutter transmits to film point x at time
//! t.
//!
//! Times are fractions of the interval from `shutter_open` to `shutter_close`, which a host samples
//! uniformly. The efficiency of the shutter is the mean of S over these times: 1 for a global shutter,
//! 1 - ramp for a leaf shutter, and the slit's share of the interval for a focal-plane shutter. The
//! efficiency times the interval is the effective exposure time (S. F. Ray, *Applied Photographic Optics*,
//! 3rd ed. 2002, ch. 61). If `shutter_close` is earlier than `shutter_open`, time and its fractions run
//! backward, as in pbrt's stock cameras.

/// A kind of shutter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Shutter {
    /// A shutter that opens and closes everywhere at once: S = 1.
    #[default]
    Global,
    /// Blades in the aperture that open during the first fraction `ramp` of the interval and close during the
    /// last: S grows from 0 to 1, stays at 1, and falls again, the same for the whole film.
    Leaf {
        /// Fraction of the interval that opening takes, in (0, 0.5]; closing takes the same time.
        ramp: f32,
    },
    /// A slit in front of the film that travels down the picture, from the top row to the bottom row: S is 1
    /// while a row lies in the slit. This is also the rolling shutter of an electronic sensor.
    FocalPlane {
        /// Share of the interval for which each row is exposed, in (0, 1].
        slit: f32,
    },
}

impl Shutter {
    /// Every shutter with its name and its default share of the interval.
    pub const NAMES: [(&'static str, Self); 3] = [
        ("global", Self::Global),
        ("leaf", Self::Leaf { ramp: 0.25 }),
        ("focal-plane", Self::FocalPlane { slit: 0.25 }),
    ];

    /// Returns S, 0 to 1, at the fraction `time` of the interval for a film point at the fraction `down` of
    /// the way from the picture's top to its bottom. Fractions of the interval outside [0, 1] are clamped.
    pub fn transmission(&self, down: f32, time: f32) -> f32 {
        let time = time_number(time);
        match *self {
            Self::Global => 1.0,
            Self::Leaf { ramp } => (time.min(1.0 - time) / ramp).min(1.0),
            Self::FocalPlane { slit } => {
                let opens = down.clamp(0.0, 1.0) * (1.0 - slit);
                if (opens..=opens + slit).contains(&time) { 1.0 } else { 0.0 }
            }
        }
    }
}

/// Clamps a host's fraction of the shutter's interval to [0, 1]; NaN counts as 0.
pub fn time_number(number: f32) -> f32 {
    if number > 0.0 { number.min(1.0) } else { 0.0 }
}

/// Returns the time at a fraction of the shutter's interval; the fraction is first clamped to [0, 1]. The
/// formula is exact at both ends.
#[inline(always)]
pub fn time_at([open, close]: [f32; 2], number: f32) -> f32 {
    if open == close {
        return open;
    }
    let number = time_number(number);
    (1.0 - number) * open + number * close
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Shutters with their efficiencies.
    const ALL: [(Shutter, f64); 4] = [
        (Shutter::Global, 1.0),
        (Shutter::Leaf { ramp: 0.2 }, 0.8),
        (Shutter::Leaf { ramp: 0.5 }, 0.5),
        (Shutter::FocalPlane { slit: 0.1 }, 0.1),
    ];

    #[test]
    fn the_efficiency_is_the_mean_over_time_at_every_film_point() {
        let n = 20_000_u16;
        for (shutter, efficiency) in ALL {
            for down in [-0.1, 0.0, 0.37, 1.0, 1.2] {
                let times = (0..n).map(|i| (f32::from(i) + 0.5) / f32::from(n));
                let sum: f64 = times.map(|time| f64::from(shutter.transmission(down, time))).sum();
                let mean = sum / f64::from(n);
                assert!((mean - efficiency).abs() < 1e-4, "{shutter:?} at {down}: {mean}");
            }
        }
    }

    #[test]
    fn a_leaf_opens_and_closes_alike_for_the_whole_film() {
        let leaf = Shutter::Leaf { ramp: 0.25 };
        for (time, expected) in [(0.0, 0.0), (0.125, 0.5), (0.25, 1.0), (0.6, 1.0), (0.875, 0.5), (1.0, 0.0)]
        {
            assert_eq!(leaf.transmission(0.1, time), expected);
            assert_eq!(leaf.transmission(0.9, time), expected);
        }
    }

    #[test]
    fn a_slit_travels_from_the_top_row_to_the_bottom_row() {
        let slit = Shutter::FocalPlane { slit: 0.2 };
        for (down, open, shut) in [(0.0, 0.1, 0.3), (0.5, 0.5, 0.1), (1.0, 0.9, 0.7)] {
            assert_eq!(slit.transmission(down, open), 1.0);
            assert_eq!(slit.transmission(down, shut), 0.0);
        }
        assert_eq!([slit.transmission(0.0, 0.0), slit.transmission(1.0, 1.0)], [1.0, 1.0]);
    }
}
