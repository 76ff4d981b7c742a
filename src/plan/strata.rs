//! Numbers spread over the four-dimensional unit cube for evaluating a way to trace: one at random in each of equal
//! cells, so that each is independent of the others and together they leave no part out.

use rand_xoshiro::{
    SplitMix64,
    rand_core::{Rng, SeedableRng},
};

/// Cells along each of the four axes.
const SIDE: u32 = 11;
/// How many there are.
pub const COUNT: u32 = SIDE * SIDE * SIDE * SIDE;

/// The numbers; another seed gives others.
pub fn numbers(seed: u64) -> impl Iterator<Item = [f64; 4]> {
    let mut random = SplitMix64::seed_from_u64(seed);
    let mut unit = move || (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
    (0..COUNT).map(move |cell| {
        let mut rest = cell;
        [0; 4].map(|_: u8| {
            let along = rest % SIDE;
            rest /= SIDE;
            (f64::from(along) + unit()) / f64::from(SIDE)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_holds_one_point_and_seeds_differ() {
        let cell = |point: [f64; 4]| point.map(|x| (x * f64::from(SIDE)) as u32);
        let mut cells: Vec<_> = numbers(3).map(cell).collect();
        cells.sort_unstable();
        cells.dedup();
        assert_eq!(cells.len(), COUNT as usize);
        assert!(numbers(3).zip(numbers(4)).all(|(a, b)| a != b));
    }
}
