//! Error against run time of a way to estimate light by samples, by the number of samples: measured points in, their
//! slope and bias out.

use crate::results::statistics::log_slope;

/// One estimator at one number of samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Samples per estimate: of a film point, or of each pixel.
    pub samples: usize,
    /// Time per estimate on one core, seconds.
    pub time: f64,
    /// RMS of the relative error: of a picture, over its mean.
    pub error: f64,
    /// RMS of the deviation from the estimator's own mean; the error itself where that is not formed.
    pub noise: f64,
}

/// One estimator on one lens.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The lens.
    pub lens: String,
    /// How the pupil is sampled, or a renderer's name.
    pub pupil: &'static str,
    /// How the disk is.
    pub disk: &'static str,
    /// Where the samples come from.
    pub sequence: &'static str,
    /// By rising number of samples; one or more.
    pub points: Vec<Estimate>,
}

impl Curve {
    /// Time, seconds, and error of every point.
    pub fn errors(&self) -> Vec<(f64, f64)> {
        self.points.iter().map(|p| (p.time, p.error)).collect()
    }

    /// Exponent of the noise as a power of the number of samples.
    pub fn slope(&self) -> f64 {
        let noise: Vec<_> = self.points.iter().map(|p| (p.samples as f64, p.noise)).collect();
        log_slope(&noise).unwrap_or(f64::NAN)
    }

    /// RMS over the film points of the mean relative error that is left with many samples.
    pub fn bias(&self) -> f64 {
        self.points.last().map_or(f64::NAN, |p| (p.error.powi(2) - p.noise.powi(2)).max(0.0).sqrt())
    }
}
