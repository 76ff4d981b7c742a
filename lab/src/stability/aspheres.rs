//! Aspheres whose rays are known in closed form, evaluated in extended precision, and edges where a conic ends.
//!
//! Fermat's principle gives the surface of revolution that focuses axial light without aberration: a hyperboloid, k =
//! -n², behind glass, and an ellipsoid, k = -1/n², in front of it (R. Descartes, *La dioptrique*, 1637; M. Born and E.
//! Wolf, *Principles of Optics*, section 4.2).

use realistic_optics::{
    lens::Lens,
    prescription::{Asphere, FIRST_POWER, NO_TERMS, Shape},
    trace::{
        Direction::{FilmToScene, SceneToFilm},
        Ray, Real,
    },
};

use super::{
    case::Case,
    lenses::{SIDES, bundle, catalogue, lens_of, parallel},
};
use crate::reference::{DoubleDouble, ExactRay};

const ZERO: DoubleDouble = DoubleDouble::ZERO;
const ONE: DoubleDouble = DoubleDouble::ONE;

fn exact(number: f64) -> DoubleDouble {
    DoubleDouble::from_f64(number)
}

fn asphere(radius: f64, conic: f64, terms: &[(usize, f64)]) -> Shape {
    let mut asphere = Asphere { radius, conic, terms: NO_TERMS };
    for &(power, term) in terms {
        asphere.terms[power - FIRST_POWER] = term;
    }
    Shape::Asphere(asphere)
}

/// Returns z of a conic, toward the film, at the distance r from the axis.
fn conic_height(radius: f64, conic: f64, r: DoubleDouble) -> DoubleDouble {
    let c = ONE / exact(radius);
    c * r * r / (ONE + (ONE - exact(1.0 + conic) * c * c * r * r).sqrt())
}

/// Returns rays at several heights, and their points (x, y) in the arrangement of [`parallel`].
fn heights(semi: f64) -> (Vec<Ray>, Vec<[f64; 2]>) {
    let rays = parallel((0..9).map(|i| semi * f64::from(i) / 9.0));
    let points = rays.iter().map(|ray| [ray.origin[0], ray.origin[1]]).collect();
    (rays, points)
}

fn distance([x, y]: [f64; 2]) -> DoubleDouble {
    (exact(x) * exact(x) + exact(y) * exact(y)).sqrt()
}

/// Returns the unit vector from a point to one on the axis.
fn toward(point: [DoubleDouble; 3], z: DoubleDouble) -> [DoubleDouble; 3] {
    let [x, y, from] = point;
    let to = [-x, -y, z - from];
    let length = (to[0] * to[0] + to[1] * to[1] + to[2] * to[2]).sqrt();
    to.map(|component| component / length)
}

fn known(name: String, lens: &Lens, rays: Vec<Ray>, answers: Vec<ExactRay>) -> Case {
    Case { closed_form: Some(answers), ..Case::new("closed form", name, lens, SceneToFilm, rays) }
}

/// Parallel light in glass, focused by a hyperboloid of k = -n².
pub fn hyperboloids() -> Vec<Case> {
    let case = |n: f64| {
        let (radius, thickness, semi) = (20.0, 30.0, 24.0);
        let rows = [(Shape::Plane, thickness, n, semi), (asphere(-radius, -n * n, &[]), 0.0, 1.0, semi)];
        let (rays, points) = heights(semi);
        let focus = -(exact(radius) / exact(n - 1.0));
        let answer = |&[x, y]: &[f64; 2]| {
            let point = [exact(x), exact(y), -conic_height(-radius, -n * n, distance([x, y]))];
            ExactRay { point, direction: toward(point, focus) }
        };
        let name = format!("hyperboloid behind glass of index {n}");
        known(name.clone(), &lens_of(&name, &rows), rays, points.iter().map(answer).collect())
    };
    // Indices whose squares are exact in double precision.
    [1.25, 1.5, 2.0, 3.5].map(case).into()
}

/// Parallel light into an ellipsoid of k = -1/n², and out through a sphere about its focus.
pub fn ellipsoids() -> Vec<Case> {
    let case = |n: f64| {
        let (radius, thickness, semi) = (30.0, 6.0, 16.0);
        let focus = n * radius / (n - 1.0);
        let back = Shape::Sphere { radius: focus - thickness };
        let rows = [(asphere(radius, -1.0 / (n * n), &[]), thickness, n, semi), (back, 0.0, 1.0, semi)];
        let (rays, points) = heights(semi);
        let answer = |&[x, y]: &[f64; 2]| {
            let height = conic_height(radius, -1.0 / (n * n), distance([x, y]));
            let direction = toward([exact(x), exact(y), -height], exact(-focus));
            // In the frame of the sphere's vertex the focus is one radius behind it.
            let [dx, dy, dz] = direction;
            let distance = exact(focus - thickness);
            let point = [-(distance * dx), -(distance * dy), -distance - distance * dz];
            ExactRay { point, direction }
        };
        let name = format!("ellipsoid before glass of index {n}");
        known(name.clone(), &lens_of(&name, &rows), rays, points.iter().map(answer).collect())
    };
    [2.0, 4.0].map(case).into()
}

/// Oblique rays through a paraboloid between equal media.
pub fn paraboloids() -> Vec<Case> {
    let case = |radius: f64| {
        let lens = lens_of("paraboloid", &[(asphere(radius, -1.0, &[]), 0.0, 1.0, 8.0)]);
        let triples = [(0.0, 1.0, 1.0), (3.0, 4.0, 5.0), (-4.0, 3.0, 5.0), (20.0, 21.0, 29.0)];
        let (mut rays, mut answers) = (Vec::new(), Vec::new());
        for (opposite, adjacent, hypotenuse) in triples {
            for x in [-3.0, 0.0, 1.0, 4.0] {
                // The ray starts at the point (x, y) of the vertex plane and meets z = -(x² + y²)/(2 R) at the distance
                // t.
                let (sine, cosine) =
                    (exact(opposite) / exact(hypotenuse), exact(adjacent) / exact(hypotenuse));
                let y = 1.0;
                let origin = [x - 4.0 * opposite, y, 4.0 * adjacent];
                rays.push(Ray { origin, direction: [opposite, 0.0, -adjacent] });
                // R cos t = (x² + y²)/2 + x sin t + sin² t²/2, the root that tends to the axial one as sin tends to 0.
                let square = exact(x * x + y * y) / exact(2.0);
                let b = exact(radius) * cosine - exact(x) * sine;
                let root = (b * b - exact(2.0) * sine * sine * square).sqrt();
                let t = if radius > 0.0 {
                    exact(2.0) * square / (b + root)
                } else {
                    exact(2.0) * square / (b - root)
                };
                let point = [exact(x) + t * sine, exact(y), -(t * cosine)];
                answers.push(ExactRay { point, direction: [sine, ZERO, -cosine] });
            }
        }
        known(format!("paraboloid of R = {radius}"), &lens, rays, answers)
    };
    [20.0, -20.0].map(case).into()
}

/// Parallel light into a plane with A4: Snell's law at the known slope 4 A4 r³.
pub fn planes_with_a_term() -> Vec<Case> {
    let case = |(power, term): (usize, f64)| {
        let (n, semi) = (1.5, 6.0);
        let lens =
            lens_of("a plane with a term", &[(asphere(f64::INFINITY, 0.0, &[(power, term)]), 0.0, n, semi)]);
        let (rays, points) = heights(semi);
        let answer = |&[x, y]: &[f64; 2]| {
            let r = distance([x, y]);
            let to = |power: usize| (0..power).fold(ONE, |product, _| product * r);
            let slope = exact(power as f64) * exact(term) * to(power - 1);
            // The tangent of the normal's angle to the axis is `slope`.
            let length = (ONE + slope * slope).sqrt();
            let (sine, cosine) = (slope / length, ONE / length);
            let bent = sine / exact(n);
            let bent_cosine = ((ONE - bent) * (ONE + bent)).sqrt();
            // The ray turns by I - I' toward the axis if the surface recedes from the incoming light.
            let turn = sine * bent_cosine - cosine * bent;
            let along = cosine * bent_cosine + sine * bent;
            let part = |x: f64| if r > ZERO { -(turn * exact(x) / r) } else { ZERO };
            let point = [exact(x), exact(y), -(exact(term) * to(power))];
            ExactRay { point, direction: [part(x), part(y), -along] }
        };
        let name = format!("a plane with A{power} = {term:e}");
        known(name, &lens, rays, points.iter().map(answer).collect())
    };
    [(4, 1e-4), (4, -1e-3), (3, 2e-3), (2, 0.01), (20, 1e-16), (5, -1e-4)].map(case).into()
}

/// Whole half ellipsoids, which rays meet from both sides and up to the edges; and strong conics with terms.
pub fn edges() -> Vec<Case> {
    let shapes = [
        ("an oblate half ellipsoid", asphere(10.0, 3.0, &[]), 5.0),
        ("a long half ellipsoid", asphere(4.0, -0.75, &[]), 8.0),
        ("a half ellipsoid with a term", asphere(10.0, 3.0, &[(4, 1e-4)]), 5.0),
        ("a hollow half ellipsoid with a term", asphere(-10.0, 3.0, &[(4, 1e-4)]), 5.0),
        ("a steep hyperboloid", asphere(1.0, -3.0, &[(4, 1e-5)]), 8.0),
        ("gulls' wings", asphere(12.0, -2.0, &[(4, -2e-3), (6, 1.5e-5)]), 8.0),
    ];
    let mut cases = Vec::new();
    for (name, shape, semi) in shapes {
        for (side, direction) in SIDES {
            // The film side must be air, too.
            let backed = [(shape, 30.0, 1.5, semi), (Shape::Plane, 0.0, 1.0, 60.0)];
            let lens = lens_of(name, &backed);
            let mut rays = bundle(&lens, direction, 40.0, &[0.0, 5.0], semi);
            rays.extend(bundle(&lens, direction, 40.0, &[20.0], 1.2 * semi));
            if direction == SceneToFilm {
                let near = [1e-2, 1e-4, 1e-6, 1e-9].map(|near| semi * (1.0 - near));
                rays.extend(parallel(near));
            }
            cases.push(Case::new("asphere", format!("{name} from the {side}"), &lens, direction, rays));
        }
    }
    cases
}

/// A telephone's lens, at three sizes.
pub fn phone() -> Vec<Case> {
    let case = |factor: f64| {
        let lens = catalogue("phone.4mm", factor);
        let at = |i: u32, n: u32| f64::from(i * n % 101) / 50.0 - 1.0;
        let rays = (0..400).map(|i| {
            let point = [3.0 * at(i, 13), 0.5 * at(i, 37)];
            let slopes = [0.6 * at(i, 29) - 0.1 * point[0], 0.4 * at(i, 53)];
            let origin = [factor * point[0], factor * point[1], lens.rear().vertex - 0.1 * factor];
            Ray { origin, direction: [slopes[0], slopes[1], 1.0] }
        });
        Case::new("asphere", format!("a telephone's lens x {factor:e}"), &lens, FilmToScene, rays.collect())
    };
    [1.0, 1e6, 1e-6].map(case).into()
}
