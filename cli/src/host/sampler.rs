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

/// Numbers in [0, 1), one anywhere in each of as many equal strata, in random order: times.
pub fn strata(numbers: &mut [f32], rng: &mut impl Rng) {
    let count = numbers.len() as f32;
    for (index, number) in (0_u32..).zip(numbers.iter_mut()) {
        // Rounding may reach the next stratum.
        let end = ((index + 1) as f32 / count).next_down();
        *number = ((index as f32 + unit(rng.next_u32())) / count).min(end);
    }
    for last in (1..numbers.len()).rev() {
        numbers.swap(last, below(last as u32 + 1, rng) as usize);
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
    fn every_stratum_of_time_has_one_number_and_their_order_is_not_time() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(5);
        for count in [1, 4, 7, 64, 1000] {
            let mut times = vec![0.0; count];
            strata(&mut times, &mut rng);
            assert!(count < 7 || !times.is_sorted());
            times.sort_by(f32::total_cmp);
            let stratum = |time: f32| (f64::from(time) * count as f64) as usize;
            assert!(times.iter().enumerate().all(|(index, time)| stratum(*time) == index), "{times:?}");
        }
    }

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
