//! Reflection and transmission of a lens surface as a table over the cosine of incidence. There is one table for each
//! distinct combination of two media and a stack, at one wavelength. A lens at another wavelength has its own tables,
//! so nothing is interpolated between wavelengths.
//!
//! The cosine is measured in the medium with the lower index. Every entry is a smooth function of this cosine up to
//! grazing incidence. One table serves rays of both directions: at angles that are related by Snell's law, R and T are
//! equal from both sides, and only the phases of the reflection differ. The table is interpolated by the cubic through
//! four entries.

use super::stack::{Share, Split, split, split_from_behind};
use realistic_optics::prescription::Layer;

/// Number of table intervals per wavelength of optical thickness. The interpolation error is below 2e-7 for a bare
/// surface, and below 2e-6 for stacks, whose phases make one turn per wavelength. Four times as many intervals would
/// reduce the error by a factor of 256.
const INTERVALS: usize = 128;

/// The cosine used for grazing incidence.
const GRAZING: f64 = 1e-9;

/// Table entry: transmission, reflection on the rarer side, and reflection on the denser side. Each consists of s, p,
/// and the real and the imaginary part of the cross term.
type Entry = [[f64; 4]; 3];

/// A surface between two media, coated or not, at a wavelength.
#[derive(Clone, Debug)]
pub struct Boundary {
    /// Refractive indices of the first and the second medium.
    media: [f64; 2],
    /// The layers of the stack, in the order in which light from `media[0]` meets them.
    layers: Vec<Layer>,
    wavelength: f64,
    /// Number of table intervals.
    intervals: usize,
    entries: Vec<Entry>,
}

impl Boundary {
    /// Builds the boundary between media with these refractive indices at a wavelength, nm; `layers` are listed from
    /// the first medium to the second.
    pub fn new(media: [f64; 2], layers: &[Layer], wavelength: f64) -> Self {
        Self::untabulated(media, layers, wavelength).tabulated()
    }

    /// Returns this boundary with a table.
    pub(super) fn tabulated(mut self) -> Self {
        if !self.is_none() {
            // With one extrapolated entry at each end, every interval has the four entries that the cubic needs.
            // Grazing incidence itself, where p has no admittance, is replaced by a cosine near 0.
            let intervals = self.intervals;
            let at = |i: usize| self.entry((i as f64 / intervals as f64).max(GRAZING));
            let mut entries: Vec<Entry> = (0..=intervals).map(at).collect();
            let beyond = |near: [usize; 4]| {
                let [a, b, c, d] = near.map(|i| entries[i]);
                let value = |i: usize, k: usize| 4.0 * a[i][k] - 6.0 * b[i][k] + 4.0 * c[i][k] - d[i][k];
                std::array::from_fn(|i| std::array::from_fn(|k| value(i, k)))
            };
            let (below, above) = (beyond([0, 1, 2, 3]), beyond([0, 1, 2, 3].map(|i| intervals - i)));
            entries.insert(0, below);
            entries.push(above);
            self.entries = entries;
        }
        self
    }

    /// Builds the boundary without a table; each angle is computed when it is needed.
    pub fn untabulated(media: [f64; 2], layers: &[Layer], wavelength: f64) -> Self {
        let thickness: f64 = layers.iter().map(|layer| layer.index * layer.thickness).sum();
        let intervals = INTERVALS * (thickness / wavelength).ceil().max(1.0) as usize;
        Self { media, layers: layers.to_vec(), wavelength, intervals, entries: Vec::new() }
    }

    /// Returns the number of transfer matrices that are computed for one angle, from one side: one per layer, and one
    /// for the media.
    pub(super) fn matrices(&self) -> u64 {
        self.layers.len() as u64 + 1
    }

    /// Returns the number of entries that the boundary's table has, or would have if it were built.
    pub(super) fn table_size(&self) -> u64 {
        if self.is_none() { 0 } else { self.intervals as u64 + 3 }
    }

    /// Whether there is no table, so that each angle is computed when it is needed.
    pub(super) fn is_untabulated(&self) -> bool {
        self.entries.is_empty() && !self.is_none()
    }

    /// Whether both media are the same and there is no coating.
    pub fn is_none(&self) -> bool {
        self.media[0] == self.media[1] && self.layers.is_empty()
    }

    /// Whether the boundary has these media and layers.
    pub fn is(&self, media: [f64; 2], layers: &[Layer]) -> bool {
        self.media == media && self.layers == layers
    }

    /// Computes the table entry for a cosine of incidence in the rarer medium.
    fn entry(&self, cosine: f64) -> Entry {
        let [low, high] = self.ordered();
        let ratio = low / high;
        let denser = (1.0 - ratio * ratio * (1.0 - cosine * cosine)).sqrt();
        let (rarer, denser) = (self.computed(low, cosine), self.computed(high, denser));
        [rarer.transmitted, rarer.reflected, Share { cross: denser.reflected.cross, ..rarer.reflected }]
            .map(|Share { s, p, cross: [re, im] }| [s, p, re, im])
    }

    /// Returns the refractive indices of the media, the lower index first.
    pub(super) fn ordered(&self) -> [f64; 2] {
        let [a, b] = self.media;
        [a.min(b), a.max(b)]
    }

    /// Computes [`Boundary::split`] without the table, by the transfer matrix.
    pub fn computed(&self, n: f64, cosine: f64) -> Split {
        let [first, last] = self.media;
        if n == first {
            return split(&self.layers, self.media, cosine, self.wavelength);
        }
        split_from_behind(self.layers.iter(), [last, first], cosine, self.wavelength)
    }

    /// Returns the shares of light that meets the surface from the medium of index `n` at this cosine of incidence.
    pub fn split(&self, n: f64, cosine: f64) -> Split {
        let [reflected, transmitted] = [true, false].map(|is_reflected| self.share(n, cosine, is_reflected));
        Split { reflected, transmitted }
    }

    /// Returns one part of [`Boundary::split`].
    #[inline]
    pub fn share(&self, n: f64, cosine: f64, is_reflected: bool) -> Share {
        if self.is_none() {
            return if is_reflected { Share::default() } else { Share::WHOLE };
        }
        if self.entries.is_empty() {
            return self.computed(n, cosine).share(is_reflected);
        }
        let [low, high] = self.ordered();
        let is_rarer = n == low;
        let rarer = if is_rarer {
            cosine
        } else {
            let ratio = high / low;
            let square = 1.0 - ratio * ratio * (1.0 - cosine * cosine);
            if square < 0.0 {
                // Total reflection.
                return self.computed(n, cosine).share(is_reflected);
            }
            square.sqrt()
        };
        let at = rarer.clamp(0.0, 1.0) * self.intervals as f64;
        let i = (at as usize).min(self.intervals - 1);
        let t = at - i as f64;
        let (a, b) = (t + 1.0, t - 1.0);
        let c = t - 2.0;
        let weights = [-t * b * c / 6.0, a * b * c / 2.0, -a * t * c / 2.0, a * t * b / 6.0];
        let kind = match (is_reflected, is_rarer) {
            (false, _) => 0,
            (true, true) => 1,
            (true, false) => 2,
        };
        let mut sum = [0.0; 4];
        for (near, weight) in self.entries[i..i + 4].iter().zip(weights) {
            sum.iter_mut().zip(near[kind]).for_each(|(sum, value)| *sum += weight * value);
        }
        let [s, p, re, im] = sum;
        Share { s, p, cross: [re, im] }
    }
}
