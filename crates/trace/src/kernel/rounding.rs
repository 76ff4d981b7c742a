//! Growth of rounding errors in the quantities that the kernel assumes of a ray.
//!
//! A link assumes that V has the length n, that the point is on the last sphere, and that e' = N·V' at this point.
//! These are three numbers more than a ray has, with their own rounding errors. The errors are not propagated by the
//! ray transfer matrix of the lens but by another matrix: in a row of balls two diameters apart, the error grows
//! sevenfold per ball, while the ray map grows 2.6-fold. On the axis, where neighbouring rays do not change these
//! numbers to first order, the other matrix is simple. The table multiplies these matrices along the path, and
//! renormalises V to the length n before the error matters.

/// Independent errors of N_z, Vz/n and e'/n' behind a surface, as a covariance matrix, in units of the rounding.
#[derive(Clone, Copy, Debug)]
pub struct RoundingGrowth([[f64; 3]; 3]);

/// A step on the axis: c d and n/n'.
#[derive(Clone, Copy, Debug)]
pub struct AxialStep {
    /// c d: the distance over the radius of the surface that is reached.
    pub distance: f64,
    /// n/n': the index before the surface over the index behind it.
    pub index_ratio: f64,
}

impl RoundingGrowth {
    /// Errors behind the first surface, and at every point where V has just been renormalised.
    pub const NONE: Self = Self([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);

    /// Returns the square root of the sum of the variances.
    pub fn size(&self) -> f64 {
        (0..3).map(|i| self.0[i][i]).sum::<f64>().sqrt()
    }

    /// Returns the errors behind a link with this ρ, if the rounding of the link is `noise` times that of its operands.
    pub fn through_link(self, reach: AxialStep, rho: f64, noise: f64) -> Self {
        let cd = reach.distance;
        let alpha = 1.0 + cd - rho;
        let root = [-rho * alpha, (1.0 + cd) * alpha, (1.0 + cd) * rho];
        let slope = [rho * (1.0 - alpha), cd * (alpha - 1.0), cd * rho];
        self.bent(reach, slope, root, noise)
    }

    /// Returns the errors behind a sphere that is met from any point. The step to such a sphere assumes only the length
    /// of V.
    pub fn through_sphere(self, reach: AxialStep) -> Self {
        let cd = reach.distance;
        let g = 1.0 + cd;
        self.bent(reach, [0.0, cd * cd, 0.0], [0.0, g * g, 0.0], g * g)
    }

    /// Returns the errors behind a plane: the point is on the plane, and e' is Vz.
    pub fn through_plane(self, index_ratio: f64) -> Self {
        let length = [0.0, index_ratio * index_ratio, 0.0];
        self.carried([[0.0; 3], length, length], 1.0)
    }

    /// Returns the errors behind a mirror, with the point on it and e known: Vz becomes 2 e N_z - Vz.
    pub fn through_mirror(self) -> Self {
        self.carried([[1.0, 0.0, 0.0], [2.0, -1.0, 2.0], [0.0, 0.0, 1.0]], 1.0)
    }

    /// Propagates the errors; `slope` and `root` are the derivatives of N_z and e/n at the hit with respect to N_z,
    /// Vz/n and e'/n' behind the previous surface.
    fn bent(self, reach: AxialStep, slope: [f64; 3], root: [f64; 3], noise: f64) -> Self {
        let m = reach.index_ratio;
        let mut along: [f64; 3] = std::array::from_fn(|i| m * (m - 1.0) * root[i] + (1.0 - m) * slope[i]);
        along[1] += m;
        self.carried([slope, along, root.map(|x| m * m * x)], noise)
    }

    fn carried(self, matrix: [[f64; 3]; 3], noise: f64) -> Self {
        let mut carried = [[0.0; 3]; 3];
        for i in 0..3 {
            for j in 0..3 {
                for (k, l) in (0..9).map(|number| (number / 3, number % 3)) {
                    carried[i][j] += matrix[i][k] * self.0[k][l] * matrix[j][l];
                }
            }
            carried[i][i] += noise.max(1.0).powi(2);
        }
        Self(carried)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the factors by which a step on the axis propagates small changes of N_z, Vz/n and e/n.
    fn factors(step: impl Fn([f64; 3]) -> [f64; 3]) -> [[f64; 3]; 3] {
        let small = 1e-6;
        let at = |k: usize, by: f64| step(std::array::from_fn(|i| if i == k { 1.0 + by } else { 1.0 }));
        let [columns_up, columns_down] = [small, -small].map(|by| [0, 1, 2].map(|k| at(k, by)));
        std::array::from_fn(|i| {
            std::array::from_fn(|k| (columns_up[k][i] - columns_down[k][i]) / (2.0 * small))
        })
    }

    fn assert_carries(growth: RoundingGrowth, factors: [[f64; 3]; 3], noise: f64) {
        let squares: f64 = factors.iter().flatten().map(|factor| factor * factor).sum();
        let expected = (squares + 3.0 * noise.max(1.0).powi(2)).sqrt();
        assert!((growth.size() / expected - 1.0).abs() < 1e-6, "{} is not {expected}", growth.size());
    }

    #[test]
    fn changes_grow_as_the_steps_own_arithmetic_makes_them() {
        let last: f64 = 0.2;
        for (c, d, n, n_after) in [(1.0_f64, 4.0, 1.0, 1.8), (-0.3, 2.0, 1.8, 1.0), (0.1, 0.5, 1.5, 1.7)] {
            let index_step: f64 = n_after * n_after - n * n;
            let reach = AxialStep { distance: c * d, index_ratio: n / n_after };
            let bend = |slope: f64, v: f64, root: f64| {
                let after = (root * root + index_step).sqrt();
                [slope, (v + (after - root) * slope) / n_after, after / n_after]
            };
            let rho = c / last;
            let alpha = 1.0 + c * d - rho;
            let link = |[slope, v, root]: [f64; 3]| {
                let (v, root) = (n * v, n * root);
                let phi = c * n * n * (d + c * d * d / 2.0 - alpha / last + alpha / last * slope);
                let g = alpha * v + rho * root;
                let root = (g * g - 2.0 * phi).sqrt();
                bend(alpha + rho * slope - (g - root) * v / (n * n), v, root)
            };
            assert_carries(RoundingGrowth::NONE.through_link(reach, rho, 3.0), factors(link), 3.0);
            // The error of the point itself lies along the ray.
            let sphere = |[_, v, _]: [f64; 3]| {
                let v = n * v;
                let g = v * (1.0 + c * d);
                let root = (g * g - 2.0 * c * n * n * (d + c * d * d / 2.0)).sqrt();
                let z = (g - root) / (c * n * n) * v - d;
                bend(1.0 - c * z, v, root)
            };
            let mirror = |[slope, v, root]: [f64; 3]| [slope, 2.0 * root * slope - v, root];
            assert_carries(RoundingGrowth::NONE.through_mirror(), factors(mirror), 1.0);
            assert_carries(
                RoundingGrowth::NONE.through_sphere(reach),
                factors(sphere),
                (1.0 + c * d).powi(2),
            );
        }
    }
}
