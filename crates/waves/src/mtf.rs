//! The modulation transfer function (MTF): the contrast of the image of a sinusoidal grating, which is the Fourier transform
//! of the point spread function; and that of rays alone.

use std::f64::consts::{PI, TAU};

use crate::{psf::Psf, wavefront::Wavefront};

/// The optical transfer function at several frequencies in one direction. Its values are complex numbers, and the MTF is
/// their absolute value. The functions of several wavelengths are added as complex numbers.
#[derive(Clone, Debug)]
pub struct Mtf {
    /// With diffraction.
    pub with_diffraction: Vec<[f64; 2]>,
    /// By rays alone.
    pub geometric: Vec<[f64; 2]>,
}

/// Least and greatest number of pixels along a side of the point spread function from which contrasts are computed.
const PIXELS: [usize; 2] = [32, 512];

/// The point spread function in as many pixels as its contrasts need.
#[derive(Clone, Debug)]
pub struct Contrast {
    psf: Psf,
    /// Landings of the rays with their share of the power.
    rays: Vec<([f64; 2], f64)>,
    /// Frequency, 1/mm, beyond which there is no contrast in any direction.
    pub cutoff: f64,
}

impl Contrast {
    /// Prepares a wavefront. The pixels are half as large as the finest detail of the image requires, and as many along a
    /// side as there are rays across: at the edge of that square, the phase between neighbouring rays in the middle of the
    /// pupil changes by 2.5 rad, and farther out the rays could no longer be told from others.
    pub fn new(wavefront: &Wavefront) -> Self {
        let width = wavefront.extent().map(|[low, high]| high - low).into_iter().fold(0.0, f64::max);
        let cutoff = width / wavefront.wavelength;
        let power = wavefront.power();
        let rays = wavefront.nodes.iter().map(|node| (node.landing, node.power / power)).collect();
        let size = wavefront.sampling.across.clamp(PIXELS[0], PIXELS[1]);
        Self { psf: Psf::new(wavefront, size, (2.0 * cutoff).recip()), rays, cutoff }
    }

    /// Returns the share of the power that the pixels hold: the contrast at the frequency 0.
    pub fn share(&self) -> f64 {
        self.psf.share()
    }

    /// Returns the transfer function at frequencies in cycles per mm along a unit vector of the film.
    pub fn along(&self, direction: [f64; 2], frequencies: &[f64]) -> Mtf {
        let with_diffraction = |frequency: f64| {
            let at = direction.map(|part| TAU * frequency * part);
            let (size, area) = (self.psf.size, self.psf.pitch.powi(2));
            let phasors = [0, 1].map(|axis| -> Vec<[f64; 2]> {
                (0..size)
                    .map(|i| -> [f64; 2] {
                        let (sin, cos) = (at[axis] * self.psf.place(i)).sin_cos();
                        [cos, -sin]
                    })
                    .collect()
            });
            let mut sum = [0.0; 2];
            for (row, [c, d]) in self.psf.values.chunks_exact(size).zip(&phasors[1]) {
                let [a, b] = row
                    .iter()
                    .zip(&phasors[0])
                    .fold([0.0; 2], |[re, im], (value, [cos, sin])| [re + value * cos, im + value * sin]);
                sum = [sum[0] + a * c - b * d, sum[1] + a * d + b * c];
            }
            sum.map(|part| area * part)
        };
        let geometric = |frequency: f64| {
            self.rays.iter().fold([0.0; 2], |[re, im], ([x, y], share)| {
                let (sin, cos) = (TAU * frequency * (x * direction[0] + y * direction[1])).sin_cos();
                [re + share * cos, im - share * sin]
            })
        };
        Mtf {
            with_diffraction: frequencies.iter().map(|f| with_diffraction(*f)).collect(),
            geometric: frequencies.iter().map(|f| geometric(*f)).collect(),
        }
    }
}

/// Returns the contrast of a perfect lens with a round pupil at a frequency as a fraction of the cutoff, which is
/// 1/(λ N).
pub fn airy_mtf(fraction: f64) -> f64 {
    if fraction >= 1.0 {
        return 0.0;
    }
    2.0 / PI * (fraction.acos() - fraction * (1.0 - fraction * fraction).sqrt())
}
