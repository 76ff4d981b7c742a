//! Polynomials in the variables of a ray: the three invariants of [`polynomial`](crate::trace::polynomial) and, if each
//! ray has its own wavelength, 1/λ. They are fitted to known values at rays, with the least degree that suffices, and
//! evaluated in lanes.

use super::sums::add;
use crate::trace::{
    kernel::{Cpu, Lanes, Scalar},
    polynomial::{LeastSquares, exponents, sum},
};

/// The highest total degree of polynomials in three variables.
const HIGHEST_OF_THREE: usize = 10;
/// The highest total degree of polynomials in four variables.
pub(super) const HIGHEST_OF_FOUR: usize = 8;

/// Polynomials of one degree in the variables of a ray.
#[derive(Clone, Debug)]
pub(super) struct Polynomials {
    degree: usize,
    /// Whether the wavelength is a variable.
    is_spectral: bool,
    /// Coefficients of each polynomial, by the exponent of the wavelength, the highest first, and then in the order of
    /// [`sum`].
    terms: Vec<Vec<f64>>,
}

impl Polynomials {
    /// Fits one polynomial per side by least squares. `from` holds the variables of the fitted rays, and `sides` their
    /// known values; each equation is multiplied by `over` if that is given (the sides already are). Returns the least
    /// degree for which `error`, evaluated on the values at the rays `seen`, is below `goal`; `None` if no degree
    /// suffices.
    pub fn fit(
        [from, seen]: &[Vec<[f64; 4]>; 2],
        is_spectral: bool,
        sides: Vec<Vec<f64>>,
        over: Option<&[f64]>,
        goal: f64,
        error: impl Fn(&[Vec<f64>]) -> f64,
    ) -> Option<Self> {
        let mut equations = LeastSquares::new(sides);
        let mut columns: Vec<[usize; 4]> = Vec::new();
        let highest = if is_spectral { HIGHEST_OF_FOUR } else { HIGHEST_OF_THREE };
        let [from, seen] = [from, seen].map(|rays| Powers::new(rays, highest));
        for degree in 0..=highest {
            for column in all_exponents(degree, is_spectral) {
                if column.iter().sum::<usize>() < degree {
                    continue;
                }
                let mut numbers = from.monomial(column);
                for (number, factor) in numbers.iter_mut().zip(over.into_iter().flatten()) {
                    *number *= factor;
                }
                equations.add(numbers).ok()?;
                columns.push(column);
            }
            let solved = equations.solve(columns.len());
            // Each monomial is computed again: all of them would take more memory than the equations.
            let mut values = vec![Vec::new(); solved.len()];
            for (k, column) in columns.iter().enumerate() {
                let monomial = seen.monomial(*column);
                for (values, terms) in values.iter_mut().zip(&solved) {
                    add(values, terms[k], &monomial);
                }
            }
            if error(&values) < goal {
                let place = |exponents| columns.iter().position(|other| *other == exponents);
                let order: Vec<usize> = all_exponents(degree, is_spectral)
                    .into_iter()
                    .map(|exponents| place(exponents).expect("a column of this degree"))
                    .collect();
                let sorted = |solved: Vec<f64>| order.iter().map(|place| solved[*place]).collect();
                return Some(Self { degree, is_spectral, terms: solved.into_iter().map(sorted).collect() });
            }
        }
        None
    }

    /// Returns the polynomials for rays in lanes of a precision.
    pub fn in_lanes<S: Scalar>(&self) -> Vec<RayPolynomial<S>> {
        let of = |terms: &Vec<f64>| RayPolynomial {
            degree: self.degree,
            is_spectral: self.is_spectral,
            terms: terms.iter().map(|term| [S::from_f64(*term)]).collect(),
        };
        self.terms.iter().map(of).collect()
    }
}

/// Powers of each variable, by exponent, at all rays.
struct Powers([Vec<Vec<f64>>; 4]);

impl Powers {
    fn new(rays: &[[f64; 4]], highest: usize) -> Self {
        Self(std::array::from_fn(|axis| {
            let mut powers = vec![vec![1.0; rays.len()]];
            for below in 0..highest {
                let next = powers[below].iter().zip(rays).map(|(power, ray)| power * ray[axis]);
                powers.push(next.collect());
            }
            powers
        }))
    }

    /// Returns the product of the powers with these exponents, at each ray.
    fn monomial(&self, exponents: [usize; 4]) -> Vec<f64> {
        let [u, v, w, l] = [0, 1, 2, 3].map(|axis| &self.0[axis][exponents[axis]]);
        u.iter().zip(v).zip(w.iter().zip(l)).map(|((u, v), (w, l))| u * v * (w * l)).collect()
    }
}

/// Lists the exponents of u, v, w and the wavelength up to a total degree, in the order of [`Polynomials::terms`].
fn all_exponents(degree: usize, is_spectral: bool) -> Vec<[usize; 4]> {
    let powers = (0..=if is_spectral { degree } else { 0 }).rev();
    powers.flat_map(|l| exponents(degree - l).into_iter().map(move |[i, j, k]| [i, j, k, l])).collect()
}

/// Variables of rays in lanes.
#[derive(Clone, Copy)]
pub(super) struct RayVariables<L> {
    /// u, v and w.
    pub invariants: [L; 3],
    /// 1/λ, scaled; any value if all rays have one wavelength.
    pub wavelength: L,
}

/// A polynomial in the variables of a ray, for lanes of a precision.
#[derive(Clone, Debug)]
pub(super) struct RayPolynomial<S> {
    degree: usize,
    /// Whether the wavelength is a variable.
    pub is_spectral: bool,
    terms: Vec<[S; 1]>,
}

impl<S: Scalar> RayPolynomial<S> {
    /// Evaluates the polynomial for `U` vectors of rays.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn lanes<L: Lanes<Scalar = S>, const U: usize>(
        &self,
        cpu: Cpu<L>,
        rays: &[RayVariables<L>; U],
    ) -> [L; U] {
        let zero = L::splat(cpu, S::ZERO);
        let mut invariants = [[zero; 3]; U];
        for u in 0..U {
            invariants[u] = rays[u].invariants;
        }
        let mut whole = [zero; U];
        let mut done = 0;
        for l in (0..=if self.is_spectral { self.degree } else { 0 }).rev() {
            let degree = self.degree - l;
            let count = (degree + 1) * (degree + 2) * (degree + 3) / 6;
            let values = sum(cpu, &self.terms[done..done + count], degree, &invariants);
            for u in 0..U {
                let [value] = values[u];
                whole[u] = if self.is_spectral { whole[u].mul_add(rays[u].wavelength, value) } else { value };
            }
            done += count;
        }
        whole
    }
}
