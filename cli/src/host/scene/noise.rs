//! Patterns computed by formula: pseudo-random numbers that depend on the position.

use glam::Vec3;

/// Returns a number in [0, 1) for a cell of a grid.
pub fn hash(x: i32, y: i32, z: i32) -> f32 {
    let mut bits = (x as u32).wrapping_mul(0x8da6_b343)
        ^ (y as u32).wrapping_mul(0xd816_3841)
        ^ (z as u32).wrapping_mul(0xcb1a_b31f);
    bits ^= bits >> 16;
    bits = bits.wrapping_mul(0x7feb_352d);
    bits ^= bits >> 15;
    bits = bits.wrapping_mul(0x846c_a68b);
    bits ^= bits >> 16;
    (bits >> 8) as f32 / (1 << 24) as f32
}

/// Returns noise in [0, 1) with features of a size of about 1: random values on a grid, interpolated smoothly.
pub fn value(point: Vec3) -> f32 {
    let cell = point.floor();
    let part = point - cell;
    let blend = part * part * (3.0 - 2.0 * part);
    let [x, y, z] = cell.to_array().map(|at| at as i32);
    let mix = |a: f32, b: f32, part: f32| a + (b - a) * part;
    let row = |dy: i32, dz: i32| mix(hash(x, y + dy, z + dz), hash(x + 1, y + dy, z + dz), blend.x);
    let sheet = |dz: i32| mix(row(0, dz), row(1, dz), blend.y);
    mix(sheet(0), sheet(1), blend.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_spread_over_their_range_and_change_smoothly() {
        let point = |index: u16| {
            Vec3::new(f32::from(index) * 0.61, f32::from(index) * 0.27 - 90.0, f32::from(index) * 0.113)
        };
        let values: Vec<f32> = (0..4000).map(|index| value(point(index))).collect();
        let mean = values.iter().sum::<f32>() / 4000.0;
        assert!((mean - 0.5).abs() < 0.02 && values.iter().all(|value| (0.0..1.0).contains(value)), "{mean}");
        assert!(values.iter().any(|value| *value < 0.1) && values.iter().any(|value| *value > 0.9));
        let steepest = (0..4000)
            .map(|index| (value(point(index) + 0.001) - value(point(index))).abs())
            .fold(0.0, f32::max);
        assert!(steepest < 0.006, "{steepest}");
    }
}
