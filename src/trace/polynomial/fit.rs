//! Fitting the polynomials: a lens and rays from its film in; their coefficients out, by linear least squares over the
//! rays that get through.

use thiserror::Error;

use super::{
    least_squares::LeastSquares,
    terms::{Scaling, exponents},
};
use crate::{
    lens::{Lens, Ray, Surface},
    prescription::Blades,
    trace::Path,
};

/// The orders that can be fitted.
pub const ORDERS: [usize; 7] = [1, 3, 5, 7, 9, 11, 13];

/// Why no polynomials can be fitted.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FitError {
    /// The order is not one of [`ORDERS`].
    #[error("polynomial order {0} is not supported; use an odd order from 1 to 13")]
    Order(usize),
    /// The rays do not determine the coefficients.
    #[error(
        "{passing} passing rays do not determine the polynomials of order {order}; give at least \
         {needed}, spread over film and pupil"
    )]
    Undetermined {
        /// The order.
        order: usize,
        /// Rays given that get through.
        passing: usize,
        /// Rays that suffice where they are well spread.
        needed: usize,
    },
}

/// A lens as polynomials of one order, film to scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Polynomial {
    pub(super) order: usize,
    pub(super) scaling: Scaling,
    /// A, B, C, D by monomial, in Horner's order.
    pub(super) terms: Vec<[f64; 4]>,
    pub(super) front: Surface,
    pub(super) apertures: Vec<AperturePolynomial>,
}

/// Where a ray passes a surface, as polynomials: E x + F p, in units of the clear semi-diameter.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct AperturePolynomial {
    /// E and F by monomial.
    pub terms: Vec<[f64; 2]>,
    /// The blades in it.
    pub blades: Option<Blades>,
}

impl Polynomial {
    /// Fits the polynomials to those of `rays` that pass `lens`: rays in lens space that start at or cross
    /// the film plane `film` (z, mm). They are to cover the film and pupil in use evenly; outside
    /// what they cover the polynomials mean nothing.
    ///
    /// # Errors
    /// An order that does not exist, or rays that do not determine the coefficients.
    pub fn fit(lens: &Lens, film: f64, rays: &[Ray], order: usize) -> Result<Self, FitError> {
        Self::with_apertures(lens, film, rays, order, &[])
    }

    /// [`Polynomial::fit`] with where rays pass the surfaces `apertures`, counted from the scene: what
    /// [`PolynomialLens`](super::PolynomialLens) blocks rays by. The front surface's needs none.
    ///
    /// # Errors
    /// As [`Polynomial::fit`].
    pub fn with_apertures(
        lens: &Lens,
        film: f64,
        rays: &[Ray],
        order: usize,
        apertures: &[usize],
    ) -> Result<Self, FitError> {
        Fits::new(lens, &Path::film_to_scene(lens), film, rays, apertures).order(order)
    }

    /// Coefficients in all, those of the apertures included.
    pub fn coefficients(&self) -> usize {
        (4 + 2 * self.apertures.len()) * self.terms.len()
    }
}

/// Polynomials of every order fitted to one set of rays, each from the work of those below it.
pub(crate) struct Fits {
    scaling: Scaling,
    front: Surface,
    /// Of every ray that gets through: scaled film and pupil position, and their invariants.
    variables: Vec<([f64; 2], [f64; 2], [f64; 3])>,
    /// Where those rays leave the lens, in which direction, and where they pass each aperture.
    equations: LeastSquares,
    /// The blades in each.
    apertures: Vec<Option<Blades>>,
    /// The exponents that the columns have so far, by total degree; two columns each.
    exponents: Vec<[usize; 3]>,
    /// The total degree up to which they go.
    degree: Option<usize>,
}

impl Fits {
    /// Traces the rays, as [`Polynomial::with_apertures`] takes them. `path` is the lens from film to scene.
    pub fn new(lens: &Lens, path: &Path, film: f64, rays: &[Ray], apertures: &[usize]) -> Self {
        let last = lens.surfaces.len() - 1;
        // Of every ray that gets through where it starts, where it leaves, and where it passes each aperture.
        let (mut inputs, mut targets, mut passes) = (Vec::new(), Vec::new(), Vec::new());
        for ray in rays {
            let begun = passes.len();
            passes.resize(begun + apertures.len(), [0.0; 2]);
            let walk = path.walk_by(*ray, |surface, [x, y, _]| {
                if let Some(aperture) = apertures.iter().position(|&aperture| aperture == last - surface) {
                    let scale = lens.surfaces[apertures[aperture]].semi_diameter.recip();
                    passes[begun + aperture] = [x * scale, y * scale];
                }
            });
            if walk.blocked.is_none() {
                inputs.push(Scaling::at_film(ray, film));
                targets.push(walk.ray);
            } else {
                passes.truncate(begun);
            }
        }
        let scaling = Scaling::of(film, &inputs);
        let blades_in = |aperture: usize| {
            path.blades().filter(|(along, _)| aperture == last - along).map(|(_, blades)| blades)
        };
        // A vector gives an equation for each of its two components.
        let origins = targets.iter().flat_map(|target: &Ray| [target.origin[0], target.origin[1]]);
        let directions = targets.iter().flat_map(|target| {
            let [dx, dy, dz] = target.direction;
            [dx / (1.0 + dz), dy / (1.0 + dz)]
        });
        let mut sides: Vec<Vec<f64>> = vec![origins.collect(), directions.collect()];
        sides.extend((0..apertures.len()).map(|aperture| {
            passes.iter().skip(aperture).step_by(apertures.len()).copied().flatten().collect()
        }));
        Self {
            scaling,
            front: *lens.front(),
            variables: inputs.iter().map(|&(x, slopes)| scaling.variables(x, slopes)).collect(),
            equations: LeastSquares::new(sides),
            apertures: apertures.iter().copied().map(blades_in).collect(),
            exponents: Vec::new(),
            degree: None,
        }
    }

    /// The polynomials of an order.
    ///
    /// # Errors
    /// As [`Polynomial::fit`].
    pub fn order(&mut self, order: usize) -> Result<Polynomial, FitError> {
        if !ORDERS.contains(&order) {
            return Err(FitError::Order(order));
        }
        let degree = (order - 1) / 2;
        let wanted = exponents(degree);
        for degree in self.degree.map_or(0, |done| done + 1)..=degree {
            for &[i, j, k] in wanted.iter().filter(|exponents| exponents.iter().sum::<usize>() == degree) {
                let undetermined = |_| FitError::Undetermined {
                    order,
                    passing: self.variables.len(),
                    needed: 4 * wanted.len(),
                };
                for column in self.columns([i, j, k].map(|exponent| exponent as i32)) {
                    self.equations.add(column).map_err(undetermined)?;
                }
                self.exponents.push([i, j, k]);
            }
            self.degree = Some(degree);
        }
        let solved = self.equations.solve(2 * wanted.len());
        let place = |exponents: &[usize; 3]| {
            2 * self.exponents.iter().position(|other| other == exponents).expect("a column has been added")
        };
        let terms = wanted.iter().map(place).map(|at| {
            let [origin, direction] = [&solved[0], &solved[1]];
            [origin[at], origin[at + 1], direction[at], direction[at + 1]]
        });
        let aperture = |(solved, blades): (&Vec<f64>, &Option<Blades>)| AperturePolynomial {
            terms: wanted.iter().map(place).map(|at| [solved[at], solved[at + 1]]).collect(),
            blades: *blades,
        };
        Ok(Polynomial {
            order,
            scaling: self.scaling,
            terms: terms.collect(),
            front: self.front,
            apertures: solved[2..].iter().zip(&self.apertures).map(aperture).collect(),
        })
    }

    /// A monomial times the film position, and times the pupil position.
    fn columns(&self, [i, j, k]: [i32; 3]) -> [Vec<f64>; 2] {
        let mut columns = [0, 1].map(|_| Vec::with_capacity(2 * self.variables.len()));
        for (x, p, [u, v, w]) in &self.variables {
            let monomial = u.powi(i) * v.powi(j) * w.powi(k);
            for (column, position) in columns.iter_mut().zip([x, p]) {
                column.extend(position.map(|part| monomial * part));
            }
        }
        columns
    }
}
