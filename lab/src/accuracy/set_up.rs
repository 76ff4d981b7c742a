//! Set-up: the cost of fitting polynomials to a lens, and the polynomials' accuracy, for several numbers of rays.

use realistic_optics::trace::{Direction, Ray};
use realistic_trace::{
    kernel::Traced,
    polynomial::{Polynomial, PolynomialLens},
};

use crate::{
    reference::Reference,
    results::{
        statistics::{Spread, median},
        table::{Table, row},
    },
    subject::Subject,
    timing::repeated,
};

/// Numbers of rays and builds of a measurement.
#[derive(Clone, Copy, Debug)]
pub struct FitCounts {
    /// Rays whose errors are measured.
    pub rays: usize,
    /// Number of builds; the median of their times is reported.
    pub repeats: usize,
}

/// The orders that are fitted, with their names.
const ORDERS: [(&str, usize); 5] =
    [("order 3", 3), ("order 5", 5), ("order 7", 7), ("order 9", 9), ("order 11", 11)];
/// Numbers of rays in a fit.
const FITS: [usize; 6] = [125, 250, 500, 1000, 2000, 4000];

/// Polynomials of an order fitted to a number of rays.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// The lens.
    pub lens: String,
    /// The order's name.
    pub order: &'static str,
    /// Rays in the fit.
    pub rays: usize,
    /// Coefficients that the fit keeps.
    pub coefficients: usize,
    /// Time to build the polynomials, seconds.
    pub time: f64,
    /// Angle to the exact direction on fresh rays, rad.
    pub direction: Spread,
}

/// Measures fits of every order to every number of rays on one lens, where the rays suffice to determine the
/// coefficients.
pub fn measure(subject: &Subject, counts: FitCounts) -> Vec<Fit> {
    let reference = Reference::new(&subject.lens, Direction::FilmToScene);
    let rays = subject.rays(counts.rays, 1);
    let pairs: Vec<_> = rays.iter().filter_map(|ray| Some((*ray, reference.trace(*ray).ok()?))).collect();
    let fit = |((name, order), rays): ((&'static str, usize), usize)| {
        let (built, times) = repeated(counts.repeats, || {
            let model = Polynomial::fit(&subject.lens, subject.film_z, &subject.rays(rays, 0), order).ok()?;
            Some((PolynomialLens::<f64>::new(&model), model.coefficients()))
        });
        let (lens, coefficients) = built?;
        let error = |(ray, exact): &(Ray, crate::reference::ExactRay)| {
            let ([x, y, _], [dx, dy, dz]) = (ray.origin, ray.direction);
            Some(exact.direction_error(&Traced::ray(&lens.trace_one([x, y], [dx / dz, dy / dz])?)))
        };
        let direction = Spread::of(&pairs.iter().filter_map(error).collect::<Vec<_>>());
        Some(Fit {
            lens: subject.lens.name.clone(),
            order: name,
            rays,
            coefficients,
            time: median(&times),
            direction,
        })
    };
    ORDERS.into_iter().flat_map(|order| FITS.map(|rays| (order, rays))).filter_map(fit).collect()
}

/// Returns the results as a table.
pub fn table(results: &[Fit]) -> Table {
    let columns = "lens model size unit numbers_kept build_ms direction_median_rad direction_999_rad \
                   direction_max_rad";
    let rows = results.iter().map(|m| {
        let direction = row![m.direction.median, m.direction.most, m.direction.worst];
        [row![m.lens.as_str(), m.order, m.rays, "rays", m.coefficients, m.time * 1e3], direction].concat()
    });
    Table::of("set-up", columns, rows)
}
