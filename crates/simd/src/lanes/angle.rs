//! Cosine and sine in lanes of either precision, computed by series. The results for a single angle thus have the same
//! bits as in a batch.

use std::f64::consts::FRAC_2_PI;

use super::{Cpu, Lanes, Scalar};
use realistic_base::numeric::Real;

/// Returns cosine and sine of angles, radians, of any size. The errors are at most 2 units in the last place of 1 for
/// angles up to 1000 turns; for every angle the result is a point of the unit circle.
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn cos_sin<L: Lanes>(cpu: Cpu<L>, angle: L) -> [L; 2] {
    let (zero, one, four) = (number(cpu, 0.0), number(cpu, 1.0), number(cpu, 4.0));
    let quarters = angle * number(cpu, FRAC_2_PI);
    let half = L::select(zero.less_equal(quarters), number(cpu, 0.5), number(cpu, -0.5));
    let nearest = (quarters + half).trunc();
    // The remaining angle in eighths of a turn. The factor 4/π is the sum of two parts, `high` and `low`.
    let high = L::Scalar::from_f64(2.0 * FRAC_2_PI);
    let low = L::Scalar::from_f64(2.0 * FRAC_2_PI - high.to_f64());
    let rest = angle.mul_sub(L::splat(cpu, high), nearest + nearest);
    let rest = angle.mul_add(L::splat(cpu, low), rest);
    // This order of the operands preserves NaN.
    let rest = one.smaller((zero - one).larger(rest));
    let turns = (nearest * number(cpu, 0.25)).trunc();
    let nearest = turns.neg_mul_add(four, nearest);
    turned(cpu, L::select(zero.less_equal(nearest), nearest, nearest + four), rest)
}

/// Returns cosine and sine of an angle: the sum of `nearest` quarters of a turn, an integer from 0 to 4, and `rest`
/// eighths of a turn, in [-1, 1].
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn turned<L: Lanes>(cpu: Cpu<L>, nearest: L, rest: L) -> [L; 2] {
    let [cos, sin] = cos_sin_over(cpu, rest * rest);
    let sin = rest * sin;
    let (one, half) = (number(cpu, 1.0), number(cpu, 0.5));
    let opposite = (nearest - number(cpu, 2.0)).abs();
    let odd = L::both(half.less(opposite), opposite.less(number(cpu, 1.5)));
    let left = L::both(half.less(nearest), nearest.less(number(cpu, 2.5)));
    let below = L::both(number(cpu, 1.5).less(nearest), nearest.less(number(cpu, 3.5)));
    let (x, y) = (L::select(odd, sin, cos), L::select(odd, cos, sin));
    let minus = number(cpu, -1.0);
    [x * L::select(left, minus, one), y * L::select(below, minus, one)]
}

#[cfg_attr(not(debug_assertions), inline(always))]
fn number<L: Lanes>(cpu: Cpu<L>, number: f64) -> L {
    L::splat(cpu, L::Scalar::from_f64(number))
}

/// Returns cos(π/4 √z) and sin(π/4 √z)/√z for z in [0, 1].
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn cos_sin_over<L: Lanes>(cpu: Cpu<L>, z: L) -> [L; 2] {
    let square = z * z;
    [series(cpu, z, square, L::Scalar::COS), series(cpu, z, square, L::Scalar::SIN)]
}

/// Evaluates a polynomial; even and odd powers are summed side by side.
#[cfg_attr(not(debug_assertions), inline(always))]
fn series<L: Lanes>(cpu: Cpu<L>, z: L, square: L, coefficients: &[L::Scalar]) -> L {
    let mut k = coefficients.len() - 2;
    let (mut one, mut other) = (L::splat(cpu, coefficients[k + 1]), L::splat(cpu, coefficients[k]));
    while k > 0 {
        k -= 1;
        (one, other) = (other, one.mul_add(square, L::splat(cpu, coefficients[k])));
    }
    one.mul_add(z, other)
}

#[cfg(test)]
mod tests {
    use super::{
        super::{OneLane, Portable},
        *,
    };

    #[test]
    fn cosines_and_sines_are_within_two_units_in_the_last_place() {
        let check = |angle: f32, most: f64| {
            let [Portable([cos]), Portable([sin])] = cos_sin(OneLane::cpu(), Portable([angle]));
            let (exact_sin, exact_cos) = f64::from(angle).sin_cos();
            for (got, exact) in [(cos, exact_cos), (sin, exact_sin)] {
                assert!(
                    (f64::from(got) - exact).abs() <= most * exact.abs().max(1e-7),
                    "{angle}: {got} {exact}"
                );
            }
        };
        for i in -30_000_i16..=30_000 {
            check(f32::from(i) / 4000.0, 2.0 * f64::from(f32::EPSILON));
        }
        // Near a zero of sine or cosine, where the last place is as small as the value, the relative error stays small.
        for quarters in -8_i8..=8 {
            check(f32::from(quarters) * std::f32::consts::FRAC_PI_2, 4.0 * f64::from(f32::EPSILON));
        }
        for angle in [6000.0_f32, -6000.0, 1234.567, 3.4e7, -1e10, 3e38] {
            let [Portable([cos]), Portable([sin])] = cos_sin(OneLane::cpu(), Portable([angle]));
            assert!((cos * cos + sin * sin - 1.0).abs() < 1e-6, "{angle}: {cos} {sin}");
            if angle.abs() < 1e4 {
                let (exact_sin, exact_cos) = f64::from(angle).sin_cos();
                assert!(
                    (f64::from(cos) - exact_cos).abs() + (f64::from(sin) - exact_sin).abs() < 4e-7,
                    "{angle}"
                );
            }
        }
    }
}
