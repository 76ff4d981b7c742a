//! The point spread function: the power per area of film around an image point.

use std::f64::consts::TAU;

use crate::{
    fourier::{Wave, field},
    wavefront::Wavefront,
};

/// The point spread function at the centres of square pixels, about the image point of the chief ray.
#[derive(Clone, Debug)]
pub struct Psf {
    /// Number of pixels along a side.
    pub size: usize,
    /// Side of a pixel, mm.
    pub pitch: f64,
    /// Power per area, 1/mm², if a power of 1 reaches the film; in rows, with y on the film growing.
    pub values: Vec<f64>,
    /// The largest power per area that this pupil gives without path differences, 1/mm².
    pub perfect_peak: f64,
}

impl Psf {
    /// Computes the power at the centres of `size` × `size` pixels of `pitch` mm.
    pub fn new(wavefront: &Wavefront, size: usize, pitch: f64) -> Self {
        let k = TAU / wavefront.wavelength;
        let waves: Vec<Wave> = (wavefront.nodes.iter())
            .map(|node| {
                let (sin, cos) = (k * node.w).sin_cos();
                Wave {
                    per_pixel: node.q.map(|q| k * pitch * q),
                    amplitude: [node.amplitude * cos, node.amplitude * sin],
                }
            })
            .collect();
        let scale = (wavefront.wavelength.powi(2) * wavefront.power()).recip();
        let whole: f64 = wavefront.nodes.iter().map(|node| node.amplitude).sum();
        let values = field(&waves, size).into_iter().map(|[re, im]| scale * (re * re + im * im)).collect();
        Self { size, pitch, values, perfect_peak: scale * whole * whole }
    }

    /// Returns the share of the power that falls on the pixels, by their centres.
    pub fn share(&self) -> f64 {
        self.values.iter().sum::<f64>() * self.pitch * self.pitch
    }

    /// Returns the largest value, 1/mm².
    pub fn peak(&self) -> f64 {
        self.values.iter().copied().fold(0.0, f64::max)
    }

    /// Returns the largest difference from another function on the same pixels, relative to this one's peak.
    pub fn difference(&self, other: &Self) -> f64 {
        let each = self.values.iter().zip(&other.values).map(|(a, b)| (a - b).abs());
        each.fold(0.0, f64::max) / self.peak()
    }

    /// Returns the distance of the centre of pixel `i` from the image point along an axis, mm.
    pub fn place(&self, i: usize) -> f64 {
        (i as f64 - (self.size as f64 - 1.0) / 2.0) * self.pitch
    }

    /// Adds another function on the same pixels, with factors: a sum over wavelengths.
    #[must_use]
    pub fn mixed(parts: &[(f64, Self)]) -> Option<Self> {
        let ((_, first), whole) = (parts.first()?, parts.iter().map(|(weight, _)| weight).sum::<f64>());
        let mut all = Self { values: vec![0.0; first.values.len()], perfect_peak: 0.0, ..first.clone() };
        for (weight, part) in parts {
            let weight = weight / whole;
            all.perfect_peak += weight * part.perfect_peak;
            all.values.iter_mut().zip(&part.values).for_each(|(sum, value)| *sum += weight * value);
        }
        Some(all)
    }
}
