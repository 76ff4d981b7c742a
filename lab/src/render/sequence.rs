//! Samples in the unit cube from four sequences, for comparing estimators and rendering pictures.

use rand::{Rng, RngExt, SeedableRng, seq::SliceRandom};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::subject::quasirandom::steps;

/// Maximum number of coordinates of a sample: two for the lens, two for the pixel.
pub const DIMENSIONS: usize = 4;

/// A sequence of samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sequence {
    /// Independent random numbers.
    Random,
    /// Pairs of coordinates, each pair jittered in its own square strata; the pairs are shuffled against each other.
    /// The points are independent random ones if their number is not a square.
    Stratified,
    /// Sobol's sequence with Owen's scrambling by hashes (B. Burley, "Practical Hash-based Owen
    /// Scrambling", *JCGT* 9(4), 2020; directions by S. Joe and F. Kuo, 2008).
    Sobol,
    /// Additive recurrence by powers of the generalised golden ratio, with a random shift (M. Roberts,
    /// "The Unreasonable Effectiveness of Quasirandom Sequences", 2018).
    Recurrence,
}

/// A sample: the lens sample (u, v), then the position in the pixel.
pub type Point = [f32; DIMENSIONS];

impl Sequence {
    /// Every sequence with its name.
    pub const NAMES: [(&'static str, Self); 4] = [
        ("random", Self::Random),
        ("stratified", Self::Stratified),
        ("Sobol'", Self::Sobol),
        ("R2", Self::Recurrence),
    ];

    /// Fills the first `dimensions` (2 or 4) coordinates of every point; another `seed` gives points independent of
    /// these.
    pub fn fill(self, seed: u32, dimensions: usize, points: &mut [Point]) {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed.into());
        match self {
            Self::Random => points.iter_mut().for_each(|p| p[..dimensions].fill_with(|| random.random())),
            Self::Stratified => stratify(&mut random, dimensions, points),
            Self::Sobol => sobol_from(0, seed, dimensions, points),
            Self::Recurrence => {
                let steps = if dimensions == 2 { &steps::<2>()[..] } else { &steps::<DIMENSIONS>()[..] };
                let shift: [f64; DIMENSIONS] = random.random();
                for (index, point) in points.iter_mut().enumerate() {
                    for (d, step) in steps.iter().enumerate() {
                        point[d] = (((index as f64 * step + shift[d]).fract()) as f32).min(BELOW_ONE);
                    }
                }
            }
        }
    }
}

/// Generates points of [`Sequence::Sobol`], starting with number `first`.
pub fn sobol_from(first: u32, seed: u32, dimensions: usize, points: &mut [Point]) {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed.into());
    let shuffle = random.next_u32();
    let seeds: [u32; DIMENSIONS] = std::array::from_fn(|_| random.next_u32());
    for (index, point) in (first..).zip(points) {
        let index = scramble(index, shuffle);
        for d in 0..dimensions {
            point[d] = unit(scramble(sobol(index, d), seeds[d]));
        }
    }
}

const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

/// Converts the upper bits of a fraction to a number below 1.
fn unit(bits: u32) -> f32 {
    (bits >> 8) as f32 / (1 << 24) as f32
}

fn stratify(random: &mut impl Rng, dimensions: usize, points: &mut [Point]) {
    let side = points.len().isqrt();
    let square = side * side == points.len();
    for pair in (0..dimensions).step_by(2) {
        let mut order: Vec<usize> = (0..points.len()).collect();
        if pair > 0 {
            order.shuffle(random);
        }
        for (point, cell) in points.iter_mut().zip(order) {
            let offset: [f32; 2] = random.random();
            let cell = [cell % side, cell / side].map(|cell| cell as f32);
            for axis in 0..2 {
                let jittered = ((cell[axis] + offset[axis]) / side as f32).min(BELOW_ONE);
                point[pair + axis] = if square { jittered } else { offset[axis] };
            }
        }
    }
}

/// Fills `numbers` with jittered numbers in [0, 1), in random order: one in each of `numbers.len()` equal strata.
/// Another `seed` gives independent numbers.
pub fn strata(seed: u32, numbers: &mut [f32]) {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed.into());
    let count = numbers.len() as f32;
    for (index, number) in numbers.iter_mut().enumerate() {
        // Rounding might move a number into the next stratum.
        let end = ((index + 1) as f32 / count).next_down();
        *number = ((index as f32 + random.random::<f32>()) / count).min(end);
    }
    numbers.shuffle(&mut random);
}

/// Direction numbers of Joe and Kuo's dimensions 2 to 4: degree of the primitive polynomial, its inner coefficients,
/// and the initial numbers.
const DIRECTIONS: [(usize, u32, [u32; 3]); 3] = [(1, 0, [1, 0, 0]), (2, 1, [1, 3, 0]), (3, 1, [1, 3, 1])];

const MATRICES: [[u32; 32]; DIMENSIONS] = matrices();

const fn matrices() -> [[u32; 32]; DIMENSIONS] {
    let mut columns = [[0; 32]; DIMENSIONS];
    let mut k = 0;
    while k < 32 {
        columns[0][k] = 1 << (31 - k);
        let mut d = 1;
        while d < DIMENSIONS {
            let (degree, inner, initial) = DIRECTIONS[d - 1];
            columns[d][k] = if k < degree {
                initial[k] << (31 - k)
            } else {
                let mut column = columns[d][k - degree] ^ (columns[d][k - degree] >> degree);
                let mut i = 1;
                while i < degree {
                    if (inner >> (degree - 1 - i)) & 1 == 1 {
                        column ^= columns[d][k - i];
                    }
                    i += 1;
                }
                column
            };
            d += 1;
        }
        k += 1;
    }
    columns
}

fn sobol(mut index: u32, dimension: usize) -> u32 {
    // With their rows reversed, the first two matrices are the identity and Pascal's triangle modulo 2, the fifth
    // Kronecker power of [1 1; 0 1].
    const PASCAL: [(u32, u32); 5] =
        [(1, 0xaaaa_aaaa), (2, 0xcccc_cccc), (4, 0xf0f0_f0f0), (8, 0xff00_ff00), (16, 0xffff_0000)];
    if dimension < 2 {
        let steps = if dimension == 0 { &[][..] } else { &PASCAL };
        return steps.iter().fold(index.reverse_bits(), |x, (shift, mask)| x ^ ((x << shift) & mask));
    }
    let mut sum = 0;
    while index != 0 {
        sum ^= MATRICES[dimension][index.trailing_zeros() as usize];
        index &= index - 1;
    }
    sum
}

/// Applies Owen's nested uniform scrambling in base 2 (S. Laine and T. Karras's hash as improved in Burley 2020,
/// listing 3).
fn scramble(bits: u32, seed: u32) -> u32 {
    let mut x = bits.reverse_bits();
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^= x.wrapping_mul(0x53a2_2864);
    x.reverse_bits()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn every_sequence_integrates_what_has_a_closed_form() {
        // The mean of cos(2 pi a) + b c + d over the cube is 3/4.
        for (name, sequence) in Sequence::NAMES {
            let mut points = vec![[0.0; 4]; 4096];
            sequence.fill(3, 4, &mut points);
            let value = |p: &Point| (TAU * f64::from(p[0])).cos() + f64::from(p[1] * p[2] + p[3]);
            let mean = points.iter().map(value).sum::<f64>() / 4096.0;
            assert!((mean - 0.75).abs() < 0.04, "{name}: {mean}");
            assert!(points.as_flattened().iter().all(|x| (0.0..1.0).contains(x)), "{name}");
            let mut others = vec![[0.0; 4]; 4096];
            sequence.fill(4, 4, &mut others);
            assert_ne!(points, others, "{name}");
        }
    }

    #[test]
    fn scrambled_sobol_points_fill_every_elementary_interval() {
        for pair in [[0, 1], [0, 2], [1, 2], [0, 3]] {
            let mut points = vec![[0.0; 4]; 64];
            Sequence::Sobol.fill(9, 4, &mut points);
            // Pairs other than the first are nets of quality t > 0: 64 points fill as many strata as a (1, 6)- or (2,
            // 6)-net guarantees.
            let spare = if pair == [0, 1] { 0 } else { 2 };
            for split in 0..=(6 - spare) {
                let (columns, rows) = (1_usize << split, 1_usize << (6 - spare - split));
                let mut filled = vec![0; columns * rows];
                for point in &points {
                    let [x, y] = pair.map(|d| point[d]);
                    filled[(x * columns as f32) as usize * rows + (y * rows as f32) as usize] += 1;
                }
                assert!(filled.iter().all(|&n| n == 1 << spare), "{pair:?} {columns} x {rows}: {filled:?}");
            }
        }
    }

    #[test]
    fn points_are_those_of_the_matrices_from_any_number_on() {
        for index in (0..64).chain([0x1234_5678, 0xffff_ffff, 0x8000_0001]) {
            for (dimension, columns) in MATRICES.iter().enumerate() {
                let bits = (0..32).filter(|bit| index >> bit & 1 == 1);
                assert_eq!(sobol(index, dimension), bits.fold(0, |sum, bit| sum ^ columns[bit]));
            }
        }
        let mut all = [[0.0; 4]; 40];
        Sequence::Sobol.fill(5, 4, &mut all);
        let mut rest = [[0.0; 4]; 27];
        sobol_from(13, 5, 4, &mut rest);
        assert_eq!(rest, all[13..]);
    }

    #[test]
    fn every_stratum_has_one_number_and_their_order_is_random() {
        for count in [1, 4, 7, 64, 1000] {
            let mut numbers = vec![0.0; count];
            strata(5, &mut numbers);
            assert!(count < 7 || !numbers.is_sorted());
            numbers.sort_by(f32::total_cmp);
            let stratum = |number: f32| (f64::from(number) * count as f64) as usize;
            assert!(numbers.iter().enumerate().all(|(index, &x)| stratum(x) == index), "{numbers:?}");
        }
    }

    #[test]
    fn strata_hold_one_point_each_in_both_pairs() {
        let mut points = vec![[0.0; 4]; 49];
        Sequence::Stratified.fill(1, 4, &mut points);
        for pair in [0, 2] {
            let mut filled = [0; 49];
            for point in &points {
                filled[(point[pair] * 7.0) as usize + 7 * (point[pair + 1] * 7.0) as usize] += 1;
            }
            assert_eq!(filled, [1; 49]);
        }
    }
}
