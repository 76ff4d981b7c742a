//! Error of an estimator of light against its run time, at several numbers of samples: computes slope and bias from the
//! measured points.

use crate::results::statistics::log_slope;

/// One estimator at one number of samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Samples per estimate: of a film point, or of each pixel.
    pub samples: usize,
    /// Time per estimate on one core, seconds.
    pub time: f64,
    /// RMS of the relative error; for a picture, relative to its mean.
    pub error: f64,
    /// RMS of the deviation from the estimator's own mean; the error itself if no mean is formed.
    pub noise: f64,
}

/// One estimator on one lens.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The lens.
    pub lens: String,
    /// The sampling of the pupil, or a renderer's name.
    pub pupil: &'static str,
    /// The mapping to the disk.
    pub disk: &'static str,
    /// The source of the samples.
    pub sequence: &'static str,
    /// Points by increasing number of samples; at least one.
    pub points: Vec<Estimate>,
}

impl Curve {
    /// Returns time, seconds, and error of every point.
    pub fn errors(&self) -> Vec<(f64, f64)> {
        self.points.iter().map(|p| (p.time, p.error)).collect()
    }

    /// Returns the time, seconds, from which the error stays below `error`, interpolated by a power law between the
    /// points; `None` if the error does not stay below it.
    pub fn time_to(&self, error: f64) -> Option<f64> {
        let last_above = self.points.iter().rposition(|point| point.error > error);
        let Some(above) = last_above else {
            return self.points.first().map(|point| point.time);
        };
        let (before, after) = (self.points.get(above)?, self.points.get(above + 1)?);
        let share = (before.error / error).ln() / (before.error / after.error).ln();
        Some(before.time * (after.time / before.time).powf(share))
    }

    /// Whether `other` is the same estimator on the same lens.
    pub fn is_like(&self, other: &Self) -> bool {
        let named = |curve: &Self| (curve.lens.clone(), curve.pupil, curve.disk, curve.sequence);
        named(self) == named(other)
    }

    /// Returns, for each error that both curves reach, the ratio of the longer time to the shorter.
    pub fn apart(&self, other: &Self, errors: &[f64]) -> Vec<f64> {
        let ratio = |error: &f64| Some(self.time_to(*error)? / other.time_to(*error)?);
        errors.iter().filter_map(ratio).map(|ratio| ratio.max(ratio.recip())).collect()
    }

    /// Returns the exponent of the noise as a power of the number of samples.
    pub fn slope(&self) -> f64 {
        let noise: Vec<_> = self.points.iter().map(|p| (p.samples as f64, p.noise)).collect();
        log_slope(&noise).unwrap_or(f64::NAN)
    }

    /// Returns the RMS over the film points of the mean relative error that remains with many samples.
    pub fn bias(&self) -> f64 {
        self.points.last().map_or(f64::NAN, |p| (p.error.powi(2) - p.noise.powi(2)).max(0.0).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(points: &[(f64, f64)]) -> Curve {
        let point = |&(time, error): &(f64, f64)| Estimate { samples: 1, time, error, noise: error };
        let points = points.iter().map(point).collect();
        Curve { lens: String::new(), pupil: "rear", disk: "concentric", sequence: "random", points }
    }

    #[test]
    fn the_time_to_an_error_lies_on_the_power_law_between_points() {
        let own = curve(&[(1.0, 1.0), (4.0, 0.5), (16.0, 0.25)]);
        assert!((own.time_to(0.3535533905932738).expect("reached") - 8.0).abs() < 1e-9);
        assert_eq!(own.time_to(2.0), Some(1.0));
        assert_eq!(own.time_to(0.1), None);
        // The time is the one from which the curve stays below the error.
        assert!(curve(&[(1.0, 0.1), (2.0, 1.0), (4.0, 0.1)]).time_to(0.2).expect("reached") > 2.0);
    }

    #[test]
    fn the_ratio_of_two_runs_is_that_of_their_times_to_an_error() {
        let own = curve(&[(1.0, 1.0), (4.0, 0.5), (16.0, 0.25)]);
        let slower = curve(&[(2.0, 1.0), (8.0, 0.5), (32.0, 0.25)]);
        for ratio in [own.apart(&slower, &[0.5, 0.3]), slower.apart(&own, &[0.5, 0.3])].concat() {
            assert!((ratio - 2.0).abs() < 1e-9, "{ratio}");
        }
        // An error that one of the curves does not reach gives no ratio.
        assert!(own.apart(&slower, &[0.1]).is_empty());
    }
}
