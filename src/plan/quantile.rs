//! What a sample says of a high quantile, with confidence.

/// The quantile that errors are held to: one ray in a thousand may be worse.
pub const QUANTILE: f64 = 0.999;
/// How likely a bound may turn out too low.
const RISK: f64 = 2e-3;

/// A number that the [`QUANTILE`] of what independent samples are drawn from exceeds with a probability
/// of at most 1 in 500: infinity where the samples are too few for one. Reorders the samples.
///
/// It is the k-th largest, with the largest k that fewer than k of n samples lie beyond the quantile
/// so rarely (H. A. David and H. N. Nagaraja, *Order Statistics*, 2003, §7.1). Their number is binomial; its lower
/// tail is no heavier than Poisson's (T. Anderson and S. Samuels, "Some Inequalities Among Binomial and Poisson
/// Probabilities", 1967), and lighter still where the samples are spread over strata (W. Hoeffding, "On the
/// Distribution of the Number of Successes in Independent Trials", 1956).
pub fn upper_bound(samples: &mut [f64]) -> f64 {
    let Some(from_the_top) = worst(samples.len()).checked_sub(1) else {
        return f64::INFINITY;
    };
    let place = samples.len() - 1 - from_the_top;
    *samples.select_nth_unstable_by(place, f64::total_cmp).1
}

/// Which of so many samples, counted from the largest on, is the bound: the k of [`upper_bound`]; 0 where they are too few.
pub fn worst(samples: usize) -> usize {
    rare_counts(samples as f64 * (1.0 - QUANTILE))
}

/// The largest k such that a number with Poisson's distribution of this mean (at most some 700, where e^-mean still is
/// a number) is less than k with a probability of at most [`RISK`]: P(fewer than k) = Σ e^-mean mean^i/i! over i < k.
fn rare_counts(mean: f64) -> usize {
    let (mut term, mut sum, mut k) = ((-mean).exp(), 0.0, 0);
    while sum + term <= RISK {
        sum += term;
        k += 1;
        term *= mean / k as f64;
    }
    k
}

#[cfg(test)]
mod tests {
    use rand_xoshiro::{
        SplitMix64,
        rand_core::{Rng, SeedableRng},
    };

    use super::*;

    #[test]
    fn the_bound_is_the_order_statistic_of_the_tables() {
        // Poisson's P(fewer than 9 | 20) = 0.00209, P(fewer than 8 | 20) = 0.00078.
        let mut samples: Vec<f64> = (0..20_000).map(f64::from).collect();
        samples.reverse();
        assert_eq!(upper_bound(&mut samples), 19_992.0);
    }

    #[test]
    fn few_samples_bound_nothing() {
        assert_eq!(upper_bound(&mut [0.0; 6000]), f64::INFINITY);
        assert_eq!(upper_bound(&mut []), f64::INFINITY);
    }

    #[test]
    fn it_is_too_low_as_rarely_as_it_says() {
        // The quantile of uniform numbers is known.
        let mut random = SplitMix64::seed_from_u64(1);
        let mut uniform = || (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        let too_low = (0..1000)
            .filter(|_| {
                let mut samples: Vec<f64> = (0..9000).map(|_| uniform()).collect();
                upper_bound(&mut samples) < QUANTILE
            })
            .count();
        assert!(too_low <= 8, "{too_low} of 1000");
    }
}
