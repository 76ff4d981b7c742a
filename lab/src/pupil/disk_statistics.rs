//! Uniformity of points in the unit disk: a chi-squared test for independent points, and a discrepancy
//! for stratified and quasi-random points.

use std::f64::consts::{PI, TAU};

use statrs::distribution::{self, ContinuousCDF};

/// Pearson's test of points against the uniform distribution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChiSquared {
    /// Σ (found - expected)²/expected over cells of equal area.
    pub statistic: f64,
    /// Number of cells minus one.
    pub degrees_of_freedom: u32,
    /// Share of uniform point sets whose statistic is larger. Near 0, the points are not uniform; near
    /// 1, they are more even than independent points.
    pub p_value: f64,
}

const RINGS: usize = 8;
const SECTORS: usize = 16;

impl ChiSquared {
    /// Tests points of the unit disk, at least a thousand, in 128 cells: 16 sectors of 8 rings.
    pub fn of(points: &[[f64; 2]]) -> Self {
        let mut found = [0_u32; RINGS * SECTORS];
        for [x, y] in points {
            let ring = (x * x + y * y) * RINGS as f64;
            let sector = (y.atan2(*x) / TAU).rem_euclid(1.0) * SECTORS as f64;
            found[(ring as usize).min(RINGS - 1) * SECTORS + (sector as usize).min(SECTORS - 1)] += 1;
        }
        let expected = points.len() as f64 / found.len() as f64;
        let statistic =
            found.iter().map(|count| (f64::from(*count) - expected).powi(2)).sum::<f64>() / expected;
        let degrees_of_freedom = found.len() as u32 - 1;
        let p_value = p_value(degrees_of_freedom.into(), statistic);
        Self { statistic, degrees_of_freedom, p_value }
    }
}

/// Returns the upper tail of the chi-squared distribution.
fn p_value(degrees_of_freedom: f64, statistic: f64) -> f64 {
    distribution::ChiSquared::new(degrees_of_freedom).expect("more than none").sf(statistic)
}

/// The difference between the share of the points on one side of a straight edge and the share of the disk on that
/// side. This difference determines how well a defocused edge of the scene is rendered (D. Dobkin and D. Mitchell,
/// "Random-Edge Discrepancy of Supersampling Patterns", Graphics Interface 1993).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeDiscrepancy {
    /// Root mean square over edges: the L2 discrepancy.
    pub rms: f64,
    /// Largest difference.
    pub largest: f64,
}

impl EdgeDiscrepancy {
    /// Computes the discrepancy over edges of 180 directions. The maximum is exact for each direction; the mean is
    /// taken over 256 positions of the edge, evenly spaced across the disk's diameter. `points` is not empty.
    pub fn of(points: &[[f64; 2]]) -> Self {
        const DIRECTIONS: u32 = 180;
        const POSITIONS: u32 = 256;
        let share = |count: usize| count as f64 / points.len() as f64;
        let (mut largest, mut squares) = (0.0_f64, 0.0);
        for direction in 0..DIRECTIONS {
            let (sine, cosine) = (TAU * f64::from(direction) / f64::from(DIRECTIONS)).sin_cos();
            let mut projections: Vec<f64> = points.iter().map(|[x, y]| x * cosine + y * sine).collect();
            projections.sort_by(f64::total_cmp);
            for (before, projection) in projections.iter().enumerate() {
                let area = segment(*projection);
                largest = largest.max((area - share(before)).abs()).max((share(before + 1) - area).abs());
            }
            for step in 0..POSITIONS {
                let edge = (2.0 * f64::from(step) + 1.0) / f64::from(POSITIONS) - 1.0;
                let before = projections.partition_point(|projection| *projection < edge);
                squares += (share(before) - segment(edge)).powi(2);
            }
        }
        Self { rms: (squares / f64::from(DIRECTIONS * POSITIONS)).sqrt(), largest }
    }
}

/// Returns the share of the unit disk with x < edge.
fn segment(edge: f64) -> f64 {
    let edge = edge.clamp(-1.0, 1.0);
    1.0 - (edge.acos() - edge * (1.0 - edge * edge).sqrt()) / PI
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_xoshiro::Xoshiro256PlusPlus;
    use realistic_camera::sampling::DiskMapping;

    fn independent(map: impl Fn(f64, f64) -> Option<[f64; 2]>, seed: u64) -> Vec<[f64; 2]> {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        let points = std::iter::repeat_with(|| map(rng.random(), rng.random())).flatten();
        points.take(20_000).collect()
    }

    #[test]
    fn every_mapping_of_the_camera_is_uniform_and_r_uniform_is_not() {
        for (name, mapping) in DiskMapping::NAMES {
            for seed in 1..4 {
                let test = ChiSquared::of(&independent(|u, v| mapping.map(u, v), seed));
                assert!((1e-3..1.0 - 1e-3).contains(&test.p_value), "{name}: {test:?}");
            }
        }
        let wrong = |u: f64, v: f64| Some([u * (TAU * v).cos(), u * (TAU * v).sin()]);
        let test = ChiSquared::of(&independent(wrong, 1));
        assert!(test.p_value < 1e-12 && test.statistic > 5000.0, "{test:?}");
    }

    #[test]
    fn the_p_value_is_that_of_the_tables() {
        // NIST handbook, table 1.3.6.7.4: upper critical values of the chi-squared distribution.
        for (degrees, critical, p) in [(1.0, 3.841, 0.05), (10.0, 18.307, 0.05), (100.0, 135.807, 0.01)] {
            let found = p_value(degrees, critical);
            assert!((found / p - 1.0).abs() < 1e-3, "{found} for {p}");
        }
    }

    #[test]
    fn strata_lower_the_discrepancy_of_disk_samples() {
        let spread = |map: &dyn Fn(f64, f64) -> Option<[f64; 2]>| {
            let mut rng = Xoshiro256PlusPlus::seed_from_u64(7);
            let mut points = Vec::new();
            for k in 0..256_u16 {
                let mut jittered = |at: u16| (f64::from(at) + rng.random::<f64>()) / 16.0;
                points.extend(map(jittered(k % 16), jittered(k / 16)));
            }
            EdgeDiscrepancy::of(&points)
        };
        let concentric = spread(&|u, v| DiskMapping::Concentric.map(u, v));
        let polar = spread(&|u, v| DiskMapping::Polar.map(u, v));
        let random = independent(|u, v| DiskMapping::Polar.map(u, v), 3);
        let random = EdgeDiscrepancy::of(&random[..256]);
        assert!(concentric.rms < polar.rms && polar.rms < random.rms, "{concentric:?} {polar:?} {random:?}");
        assert!(concentric.largest < random.largest && concentric.rms < concentric.largest);
    }

    #[test]
    fn one_point_in_the_middle_is_as_uneven_as_can_be() {
        assert!((EdgeDiscrepancy::of(&[[0.0; 2]]).largest - 0.5).abs() < 1e-12);
        assert!((segment(-1.0), segment(0.0), segment(1.0)) == (0.0, 0.5, 1.0));
    }
}
