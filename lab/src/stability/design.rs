//! Quantities derived from a lens without exact rays: focal length, pupil and focus, compared with first-order optics
//! in extended precision. The ray-transfer matrices of that reference are products of shears, through which
//! disturbances are propagated (N. J. Higham, *Accuracy and Stability of Numerical Algorithms*, 2002, section 3.8).

use realistic_optics::{
    imaging::focus::Focus,
    lens::{Lens, first_order::FirstOrder, pupil::ExitPupil},
    trace::Real,
};

use super::{
    assemblies,
    case::{CaseResult, Failure, Reason},
    lenses::{catalogue, lens},
    stiff,
    tracers::BOUND,
};
use crate::reference::DoubleDouble;

type Coefficients = [[DoubleDouble; 2]; 2];

/// A ray-transfer matrix on (height, n x slope) in extended precision, factored into shears.
struct RayTransferMatrix {
    exact: Coefficients,
    /// Shears as (row, factor, product before): each adds `factor` times the other row to `row`.
    shears: Vec<(usize, DoubleDouble, Coefficients)>,
}

impl RayTransferMatrix {
    /// Builds the matrix from the vertex of surface `from`, after its refraction unless `refract_first`, to the rear
    /// vertex.
    fn behind(lens: &Lens, from: usize, refract_first: bool) -> Self {
        let exact = DoubleDouble::from_f64;
        let mut matrix = Self { exact: IDENTITY, shears: Vec::new() };
        for (number, surface) in lens.surfaces.iter().enumerate().skip(from) {
            if number > from {
                matrix.shear(0, exact(lens.surfaces[number - 1].thickness) / exact(surface.n_scene));
            }
            if surface.curvature != 0.0 && (number > from || refract_first) {
                matrix.shear(1, (exact(surface.n_scene) - exact(surface.n_film)) / exact(surface.radius));
            }
        }
        matrix
    }

    fn shear(&mut self, row: usize, factor: DoubleDouble) {
        self.shears.push((row, factor, self.exact));
        for column in 0..2 {
            self.exact[row][column] = self.exact[row][column] + factor * self.exact[1 - row][column];
        }
    }

    /// Returns the change of a coefficient, mm or 1/mm, for a relative disturbance of 1 of every power, every distance
    /// and the coefficient itself: the sum of the absolute derivatives, each times its value.
    fn spread(&self, row: usize, column: usize) -> f64 {
        let mut after = IDENTITY[row];
        let mut spread = self.exact[row][column].to_f64().abs();
        for &(to, factor, before) in self.shears.iter().rev() {
            spread += (after[to] * factor * before[1 - to][column]).to_f64().abs();
            after[1 - to] = after[1 - to] + after[to] * factor;
        }
        spread
    }

    /// Returns the spread relative to the coefficient.
    fn condition(&self, row: usize, column: usize) -> f64 {
        self.spread(row, column) / self.exact[row][column].to_f64().abs()
    }
}

const IDENTITY: Coefficients =
    [[DoubleDouble::ONE, DoubleDouble::ZERO], [DoubleDouble::ZERO, DoubleDouble::ONE]];

fn evaluated(name: String, what: &'static str, got: f64, exact: DoubleDouble, condition: f64) -> CaseResult {
    let mut result = CaseResult::new(name, "design", what, BOUND);
    let error = (DoubleDouble::from_f64(got) - exact).to_f64().abs();
    result.rays = 1;
    result.worst_error_mm = error;
    result.condition = condition;
    result.ratio = error / (f64::EPSILON * condition * exact.to_f64().abs());
    // A NaN fails, too.
    if !(result.ratio <= result.bound) {
        let (case, what) = (result.name.clone(), format!("{got} in the place of {}", exact.to_f64()));
        result.failures.push(Failure { case, ray: 0, reason: Reason::Error, what });
    }
    result
}

/// Returns lenses that are difficult for first-order optics.
fn lenses() -> Vec<Lens> {
    let mut lenses: Vec<Lens> =
        ["dgauss.50mm", "telephoto.250mm", "fisheye.10mm"].map(|name| catalogue(name, 1.0)).into();
    // A ball of 1 um lies behind a weak lens and a kilometre of air: the ball's thickness is below the rounding of its
    // vertices' positions.
    let rows = [
        (2e6, 5.0, 1.5, 40.0),
        (f64::INFINITY, 1e6, 1.0, 40.0),
        (5e-4, 1e-3, 1.6, 4e-4),
        (-5e-4, 0.0, 1.0, 4e-4),
    ];
    lenses.push(lens("a ball of 1 um behind 1 km of air", &rows));
    let weak = [(12.0, 4.0, 1.0 + 1e-7, 5.0), (-15.0, 0.0, 1.0, 5.0)];
    lenses.push(lens("singlet of index 1 + 1e-7", &weak));
    let touching =
        [(30.0, 3.0, 1.5, 5.0), (-30.0, 1e-9, 1.0, 5.0), (30.0, 3.0, 1.6, 5.0), (-200.0, 0.0, 1.0, 5.0)];
    lenses.push(lens("gap of 1e-9 mm", &touching));
    let cases = [assemblies::counts(), assemblies::telecentric(), stiff::telescopes(), stiff::balls()];
    lenses.extend(cases.into_iter().flatten().step_by(2).map(|case| case.lens));
    lenses.retain(|lens| FirstOrder::of(lens).is_ok());
    lenses
}

/// Checks the focal length, the back focal distance and the angle of the exit pupil of every difficult lens.
pub fn first_order() -> Vec<CaseResult> {
    let mut results = Vec::new();
    for lens in lenses() {
        // An afocal lens has no focal length.
        let Ok(own) = FirstOrder::of(&lens) else { continue };
        let matrix = RayTransferMatrix::behind(&lens, 0, true);
        let power = -matrix.exact[1][0];
        let named = |what: &str| format!("{what}: {}", lens.name);
        let one = DoubleDouble::from_f64(1.0);
        let condition = matrix.condition(1, 0);
        results.push(evaluated(
            named("focal length"),
            "first order",
            own.focal_length,
            one / power,
            condition,
        ));
        // The library keeps the focal point's position in lens space, so the distance inherits the rounding of the
        // last vertex's position.
        let back = matrix.exact[0][0] * DoubleDouble::from_f64(lens.rear().n_film) / power;
        let position = own.rear_vertex.abs() / back.to_f64().abs();
        let condition = condition + matrix.condition(0, 0) + position;
        let (name, got) = (named("back focal distance"), own.back_focal_distance());
        results.push(evaluated(name, "first order", got, back, condition));
        let Some(stop) = lens.stop_index() else { continue };
        let pupil = ExitPupil::of_surface(&lens, stop);
        let film = lens.rear().vertex - 60.0;
        let to_film = DoubleDouble::from_f64(lens.rear().vertex) - DoubleDouble::from_f64(film);
        let matrix = RayTransferMatrix::behind(&lens, stop, false);
        let spread = matrix.exact[0][1] + matrix.exact[1][1] * to_film;
        let size = matrix.spread(0, 1) + matrix.spread(1, 1) * 60.0;
        let radius = DoubleDouble::from_f64(lens.surfaces[stop].semi_diameter) / spread;
        let radius = if radius < DoubleDouble::ZERO { -radius } else { radius };
        let condition = 1.0 + size / spread.to_f64().abs();
        let got = pupil.slopes(0.0, 0.0, film).radius;
        results.push(evaluated(named("exit pupil's angle"), "first order", got, radius, condition));
    }
    results
}

/// Checks the film distance for objects at infinity, 10 km and 1 m, with a stop so small that the best focus is the
/// paraxial one.
pub fn focus() -> Vec<CaseResult> {
    let mut results = Vec::new();
    for name in ["dgauss.50mm", "telephoto.250mm", "wide.22mm", "fisheye.10mm"] {
        let mut lens = catalogue(name, 1.0);
        let stop = lens.stop_index().expect("it has a stop");
        lens.surfaces[stop].semi_diameter *= 1e-8;
        let Ok(focus) = Focus::new(&lens) else { continue };
        let exact = DoubleDouble::from_f64;
        let matrix = RayTransferMatrix::behind(&lens, 0, true);
        let focal_length = exact(-1.0) / matrix.exact[1][0];
        let (back, front) = (matrix.exact[0][0] * focal_length, matrix.exact[1][1] * focal_length);
        let length: f64 = lens.surfaces.iter().map(|surface| surface.thickness).sum();
        for distance in [f64::INFINITY, 1e7, 2e3] {
            let Ok(got) = focus.film_distance(distance) else { continue };
            let answer = if distance.is_finite() {
                // f² u² - p u + 1 = 0, where p is the object's distance from the film minus the distance between the
                // focal points.
                let between = front + exact(length) + back;
                let p = exact(distance) - between;
                let square = focal_length * focal_length;
                let root = (p * p - exact(4.0) * square).sqrt();
                back + square * (exact(2.0) / (p + root))
            } else {
                back
            };
            let condition = matrix.condition(0, 0) + matrix.condition(1, 0) + length / answer.to_f64().abs();
            let name = format!("focus at {distance:e} mm: {name}");
            results.push(evaluated(name, "focus", got, answer, condition));
        }
    }
    results
}
