//! Sample numbers of one pixel: well spread over the pixel, the lens and the light, each
//! pair by itself, and independent of each other.

use rand::Rng;

/// A set of points in the unit square whose first 2^k are one to every elementary interval
/// of area 2^-k: the radical inverse and Sobol's second dimension, scrambled by xor.
pub fn fill(points: &mut [[f32; 2]], rng: &mut impl Rng) {
    let (scramble_x, scramble_y) = (rng.next_u32(), rng.next_u32());
    for (index, point) in (0_u32..).zip(points.iter_mut()) {
        *point = [unit(index.reverse_bits() ^ scramble_x), unit(sobol(index) ^ scramble_y)];
    }
    // Without this the pixel's n-th point would always meet the lens' n-th point.
    for last in (1..points.len()).rev() {
        points.swap(last, below(last as u32 + 1, rng) as usize);
    }
}

fn sobol(mut index: u32) -> u32 {
    let mut column = 1_u32 << 31;
    let mut sum = 0;
    while index != 0 {
        if index & 1 != 0 {
            sum ^= column;
        }
        index >>= 1;
        column ^= column >> 1;
    }
    sum
}

fn unit(bits: u32) -> f32 {
    (bits >> 8) as f32 / (1 << 24) as f32
}

fn below(end: u32, rng: &mut impl Rng) -> u32 {
    ((u64::from(rng.next_u32()) * u64::from(end)) >> 32) as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_xoshiro::Xoshiro256PlusPlus;

    #[test]
    fn sixteen_points_fill_every_stratum() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(5);
        let mut points = [[0.0; 2]; 16];
        fill(&mut points, &mut rng);
        for (columns, rows) in [(16.0, 1.0), (8.0, 2.0), (4.0, 4.0), (2.0, 8.0), (1.0, 16.0)] {
            let mut seen = [false; 16];
            for [x, y] in points {
                seen[((x * columns).floor() * rows + (y * rows).floor()) as usize] = true;
            }
            assert_eq!(seen, [true; 16], "{columns} x {rows}");
        }
    }
}
