//! Numbers spread over the four-dimensional unit cube for evaluating a way to trace: one at random in each of equal
//! cells, so that each is independent of the others and together they leave no part out.

/// Cells along each of the four axes.
const SIDE: u32 = 12;
/// How many there are.
pub const COUNT: u32 = SIDE * SIDE * SIDE * SIDE;

/// The numbers; another seed gives others.
pub fn numbers(seed: u64) -> impl Iterator<Item = [f64; 4]> {
    let mut state = seed;
    (0..COUNT).map(move |cell| {
        let mut rest = cell;
        [0; 4].map(|_: u8| {
            let along = rest % SIDE;
            rest /= SIDE;
            (f64::from(along) + unit(&mut state)) / f64::from(SIDE)
        })
    })
}

/// The next of SplitMix64's numbers (G. Steele, D. Lea and C. Flood, OOPSLA 2014), in [0, 1).
fn unit(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut bits = *state;
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((bits ^ (bits >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
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
