//! Fit of the polynomials to a lens. The coefficients are computed by linear least squares over rays from the film that
//! get through.

use std::sync::Arc;

use thiserror::Error;

use super::{
    least_squares::LeastSquares,
    terms::{Scaling, exponents},
};
use realistic_optics::{
    lens::{Lens, Ray, Surface},
    prescription::Aperture,
    trace::Path,
};

/// The orders that can be fitted.
pub const ORDERS: [usize; 7] = [1, 3, 5, 7, 9, 11, 13];

/// The reason why no polynomials can be fitted.
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
        /// Number of the given rays that get through.
        passing: usize,
        /// Number of rays that suffices if they are well spread.
        needed: usize,
    },
}

/// A lens as polynomials of one order, from film to scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Polynomial {
    pub(super) order: usize,
    pub(super) scaling: Scaling,
    /// A, B, C, D for each monomial, in Horner's order.
    pub(super) terms: Vec<[f64; 4]>,
    pub(super) front: Surface,
    pub(super) apertures: Vec<AperturePolynomial>,
}

/// The point where a ray passes a surface, as polynomials: E x + F p, in units of the clear semi-diameter.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct AperturePolynomial {
    /// E and F for each monomial.
    pub terms: Vec<[f64; 2]>,
    /// The apertures and obstructions inside the clear aperture.
    pub shapes: Arc<[Aperture]>,
}

impl Polynomial {
    /// Fits the polynomials to those of `rays` that pass `lens`. The rays are in lens space and start at the film plane
    /// z = `film`, mm, or cross it. They should evenly cover the part of film and pupil that is in use; outside the
    /// range that the rays cover, the polynomials are meaningless.
    ///
    /// # Errors
    /// Returns an error if the order is not supported, or if the rays do not determine the coefficients.
    pub fn fit(lens: &Lens, film: f64, rays: &[Ray], order: usize) -> Result<Self, FitError> {
        Self::with_apertures(lens, film, rays, order, &[])
    }

    /// Fits the polynomials as [`Polynomial::fit`] does, and also fits the points where rays pass the surfaces
    /// `apertures`, counted from the scene. [`PolynomialLens`](super::PolynomialLens) tests these points against the
    /// apertures of the surfaces. The aperture of the front surface needs no polynomials.
    ///
    /// # Errors
    /// Returns the same errors as [`Polynomial::fit`].
    pub fn with_apertures(
        lens: &Lens,
        film: f64,
        rays: &[Ray],
        order: usize,
        apertures: &[usize],
    ) -> Result<Self, FitError> {
        Fits::new(lens, &Path::film_to_scene(lens), film, rays, apertures).order(order)
    }

    /// Returns the total number of coefficients, including those of the apertures.
    pub fn coefficients(&self) -> usize {
        (4 + 2 * self.apertures.len()) * self.terms.len()
    }
}

/// Polynomials of every order fitted to one set of rays, each order building on the lower orders.
pub struct Fits {
    scaling: Scaling,
    front: Surface,
    /// Variables of every ray that gets through: scaled film and pupil position, and their invariants.
    variables: Vec<([f64; 2], [f64; 2], [f64; 3])>,
    /// Equations for the points where those rays leave the lens, for their directions, and for the points where they
    /// pass each aperture.
    equations: LeastSquares,
    /// The apertures and obstructions inside the clear aperture of each surface in `apertures`.
    shapes: Vec<Arc<[Aperture]>>,
    /// The exponents of the monomials that have been added so far, in ascending total degree; each monomial has two
    /// columns.
    exponents: Vec<[usize; 3]>,
    /// The largest total degree that has been added so far; `None` before the first.
    degree: Option<usize>,
}

impl Fits {
    /// Traces the rays, as defined in [`Polynomial::with_apertures`]. `path` is the path through the lens from film to
    /// scene.
    pub fn new(lens: &Lens, path: &Path, film: f64, rays: &[Ray], apertures: &[usize]) -> Self {
        let last = lens.surfaces.len() - 1;
        // The start, the exit, and the points at each aperture, of every ray that gets through.
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
        // A vector gives one equation for each of its two components.
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
            front: lens.front().clone(),
            variables: inputs.iter().map(|&(x, slopes)| scaling.variables(x, slopes)).collect(),
            equations: LeastSquares::new(sides),
            shapes: apertures.iter().map(|&surface| lens.surfaces[surface].apertures.clone()).collect(),
            exponents: Vec::new(),
            degree: None,
        }
    }

    /// Returns the polynomials of an order.
    ///
    /// # Errors
    /// Returns the same errors as [`Polynomial::fit`].
    pub fn order(&mut self, order: usize) -> Result<Polynomial, FitError> {
        if !ORDERS.contains(&order) {
            return Err(FitError::Order(order));
        }
        let degree = (order - 1) / 2;
        let required = exponents(degree);
        for degree in self.degree.map_or(0, |done| done + 1)..=degree {
            for &[i, j, k] in required.iter().filter(|exponents| exponents.iter().sum::<usize>() == degree) {
                let undetermined = |_| FitError::Undetermined {
                    order,
                    passing: self.variables.len(),
                    needed: 4 * required.len(),
                };
                for column in self.columns([i, j, k].map(|exponent| exponent as i32)) {
                    self.equations.add(column).map_err(undetermined)?;
                }
                self.exponents.push([i, j, k]);
            }
            self.degree = Some(degree);
        }
        let solved = self.equations.solve(2 * required.len());
        let column_of = |exponents: &[usize; 3]| {
            2 * self.exponents.iter().position(|other| other == exponents).expect("a column has been added")
        };
        let terms = required.iter().map(column_of).map(|at| {
            let [origin, direction] = [&solved[0], &solved[1]];
            [origin[at], origin[at + 1], direction[at], direction[at + 1]]
        });
        let aperture = |(solved, shapes): (&Vec<f64>, &Arc<[Aperture]>)| AperturePolynomial {
            terms: required.iter().map(column_of).map(|at| [solved[at], solved[at + 1]]).collect(),
            shapes: shapes.clone(),
        };
        Ok(Polynomial {
            order,
            scaling: self.scaling,
            terms: terms.collect(),
            front: self.front.clone(),
            apertures: solved[2..].iter().zip(&self.shapes).map(aperture).collect(),
        })
    }

    /// Returns two columns: a monomial times the film position, and the same monomial times the pupil position.
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
