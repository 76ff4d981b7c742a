//! A smooth function of the distance from the axis, tabulated at even steps.

/// Values at 0, one step, two steps and so on, with cubic interpolation (E. Catmull and R. Rom, "A class of local
/// interpolating splines", 1974).
#[derive(Clone, Debug)]
pub struct RadialFunction {
    step: f64,
    values: Vec<f64>,
    /// Parity of the function, which continues it beyond the axis: 1 for even, -1 for odd.
    parity: f64,
}

impl RadialFunction {
    /// Makes an even function of the distance.
    pub fn even(step: f64, values: Vec<f64>) -> Self {
        Self { step, values, parity: 1.0 }
    }

    /// Makes an odd function of the distance.
    pub fn odd(step: f64, values: Vec<f64>) -> Self {
        Self { step, values, parity: -1.0 }
    }

    /// Returns the value at `x`, which is 0 or more; beyond the last value, the last cubic is continued as a straight
    /// line.
    pub fn at(&self, x: f64) -> f64 {
        let last = self.values.len() - 1;
        let at = x / self.step;
        let below = (at as usize).min(last.saturating_sub(1));
        let t = at - below as f64;
        let value = |i: isize| match usize::try_from(i) {
            Err(_) => self.parity * self.values[i.unsigned_abs().min(last)],
            Ok(i) if i > last => 2.0 * self.values[last] - self.values[last - 1.min(last)],
            Ok(i) => self.values[i],
        };
        let below = below as isize;
        let [a, b, c, d] = [below - 1, below, below + 1, below + 2].map(value);
        let [start, end] = [0.5 * (c - a), 0.5 * (d - b)];
        if t > 1.0 {
            return c + (t - 1.0) * (c - b);
        }
        let (square, cube) = (t * t, t * t * t);
        (2.0 * cube - 3.0 * square + 1.0) * b
            + (cube - 2.0 * square + t) * start
            + (3.0 * square - 2.0 * cube) * c
            + (cube - square) * end
    }

    /// Returns the inverse of an increasing function, as `count` values at even steps over the function's range.
    pub fn inverse(&self, count: usize) -> Self {
        let end = self.step * (self.values.len() - 1) as f64;
        let most = self.at(end);
        let step = most / (count - 1) as f64;
        let value = |i: usize| {
            let target = step * i as f64;
            let (mut low, mut high) = (0.0, end);
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                if self.at(middle) < target { low = middle } else { high = middle }
            }
            0.5 * (low + high)
        };
        Self { step, values: (0..count).map(value).collect(), parity: self.parity }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smooth_functions_come_back_and_so_do_their_inverses() {
        let values = |f: fn(f64) -> f64| (0..65).map(|i| f(f64::from(i) / 64.0)).collect();
        let (odd, even) = (
            RadialFunction::odd(1.0 / 64.0, values(f64::sin)),
            RadialFunction::even(1.0 / 64.0, values(f64::cos)),
        );
        let inverse = odd.inverse(65);
        for i in 0..=1000 {
            let x = f64::from(i) / 1000.0;
            assert!((odd.at(x) - x.sin()).abs() < 2e-5 && (even.at(x) - x.cos()).abs() < 2e-5, "{x}");
            assert!((inverse.at(x.sin()) - x).abs() < 1e-4, "{x}");
        }
        assert!((odd.at(1.1) - 1.1_f64.sin()).abs() < 0.01);
    }
}
