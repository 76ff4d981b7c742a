//! The number of cases of a property test.

use proptest::test_runner::{Config, RngSeed};

/// Returns the configuration for a number of cases, which are the same in every run; `PROPTEST_RNG_SEED` gives other
/// cases.
pub fn cases(cases: u32) -> Config {
    let default = Config::default();
    let rng_seed = if default.rng_seed == RngSeed::Random { RngSeed::Fixed(1) } else { default.rng_seed };
    Config { cases, rng_seed, failure_persistence: None, ..default }
}
