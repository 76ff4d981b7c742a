//! Lenses whose rays are known in closed form, evaluated in extended precision.

use realistic_optics::trace::{
    Direction::{FilmToScene, SceneToFilm},
    Ray, Real,
};

use super::{
    case::Case,
    lenses::{Row, lens},
};
use crate::reference::{DoubleDouble, ExactRay};

fn exact(number: f64) -> DoubleDouble {
    DoubleDouble::from_f64(number)
}

const ZERO: DoubleDouble = DoubleDouble::ZERO;
const ONE: DoubleDouble = DoubleDouble::ONE;

fn cosine(sine: DoubleDouble) -> DoubleDouble {
    ((ONE - sine) * (ONE + sine)).sqrt()
}

/// A plane-parallel plate: the direction is unchanged, and the point moves by d tan θ' inside.
pub fn plates() -> Vec<Case> {
    let mut cases = Vec::new();
    for (thickness, n) in [(1e-9, 1.5), (10.0, 1.5), (10.0, 4.0), (1e6, 1.0 + 1e-7)] {
        let plane = |behind: f64, n: f64| (f64::INFINITY, behind, n, 20.0 * thickness + 2e3);
        // Slopes from Pythagorean triples make the sine a ratio of small integers.
        let triples =
            [(0.0, 1.0, 1.0), (3.0, 4.0, 5.0), (4.0, 3.0, 5.0), (20.0, 21.0, 29.0), (1023.0, 64.0, 1025.0)];
        let (mut rays, mut answers) = (Vec::new(), Vec::new());
        for (opposite, adjacent, hypotenuse) in triples {
            let sine = exact(opposite) / exact(hypotenuse);
            let inside = sine / exact(n);
            let x = exact(opposite) + exact(thickness) * (inside / cosine(inside));
            rays.push(Ray { origin: [0.0, 0.5, adjacent], direction: [opposite, 0.0, -adjacent] });
            let direction = [sine, ZERO, -(exact(adjacent) / exact(hypotenuse))];
            answers.push(ExactRay { point: [x, exact(0.5), ZERO], direction });
        }
        let name = format!("plate of {thickness:e} mm, n = {n}");
        let rows = [plane(thickness, n), plane(0.0, 1.0)];
        cases.push(Case {
            closed_form: Some(answers),
            ..Case::new("closed form", name.as_str(), &lens(&name, &rows), SceneToFilm, rays)
        });
    }
    cases
}

/// An aplanatic meniscus. Its inner surface is concentric with the object. Its outer surface, from whose centre the
/// object is R/n away, images the object without error to the distance n R (M. Born and E. Wolf, *Principles of
/// Optics*, section 4.2.3).
pub fn aplanatic_meniscus() -> Vec<Case> {
    // R/n and n R are multiples of a quarter.
    let (radius, n, inner) = (7.5, 1.5, 2.0);
    let rows = [(radius, radius + radius / n - inner, n, radius), (inner, 0.0, 1.0, inner)];
    let object = -radius - radius / n;
    let image = exact(-radius - radius * n);
    let (mut rays, mut answers) = (Vec::new(), Vec::new());
    for (opposite, adjacent, hypotenuse) in
        [(0.0, 1.0, 1.0), (3.0, 4.0, 5.0), (4.0, 3.0, 5.0), (20.0, 21.0, 29.0), (7.0, 24.0, 25.0)]
    {
        rays.push(Ray { origin: [0.0, 0.0, object], direction: [opposite, 0.0, adjacent] });
        // From the image, at the distance n R from the centre, sin U' = sin U/n; the ray meets the sphere at that
        // line's second intersection with it.
        let sine = exact(opposite) / exact(hypotenuse) / exact(n);
        let direction = [sine, ZERO, cosine(sine)];
        let along = exact(n * radius) * direction[2];
        let aside = exact(n * radius) * sine;
        let to_sphere = along + (exact(radius * radius) - aside * aside).sqrt();
        let point = [to_sphere * sine, ZERO, image + to_sphere * direction[2]];
        answers.push(ExactRay { point, direction });
    }
    let name = "aplanatic meniscus";
    let case = Case::new("closed form", name, &lens(name, &rows), FilmToScene, rays);
    vec![Case { closed_form: Some(answers), ..case }]
}

/// Concentric shells: n r sin I is constant (Bouguer's formula, Born and Wolf, section 3.2.1), and each
/// shell turns the direction by I - I'.
pub fn shells() -> Vec<Case> {
    // The shells are Luneburg's n² = 2 - r² in many thin steps (R. K. Luneburg, *Mathematical Theory of Optics*,
    // section 28), and a few strong shells; all outer radii are distances from the centre.
    let luneburg = |count: u32, radius: f64| -> Vec<(f64, f64)> {
        (0..count)
            .map(|i| {
                let outer = 1.0 - f64::from(i) / f64::from(count);
                let middle = outer - 0.5 / f64::from(count);
                (radius * outer, (2.0 - middle * middle).sqrt())
            })
            .collect()
    };
    vec![
        shell_case("4 strong shells", &[(8.0, 1.5), (6.0, 2.0), (5.0, 1.25), (4.0, 3.0)], 3.9),
        shell_case("Luneburg's lens in 32 steps", &luneburg(32, 16.0), 0.4),
        shell_case("Luneburg's lens in 128 steps", &luneburg(128, 16.0), 0.1),
        shell_case("Luneburg's lens in 128 steps, 1e-6 times the size", &luneburg(128, 16e-6), 0.1e-6),
    ]
}

/// Builds a case from the front halves of shells of these (outer radius, index), with rays parallel to the
/// axis up to `reach` from it.
fn shell_case(name: &str, shells: &[(f64, f64)], reach: f64) -> Case {
    let rows: Vec<Row> = shells
        .iter()
        .enumerate()
        .map(|(i, &(radius, n))| (radius, shells.get(i + 1).map_or(0.0, |next| radius - next.0), n, radius))
        .collect();
    let lens = lens(name, &rows);
    let (mut rays, mut answers) = (Vec::new(), Vec::new());
    for i in 0..8 {
        let height = reach * f64::from(i) / 8.0;
        rays.push(Ray { origin: [height, 0.0, 2.0 * shells[0].0], direction: [0.0, 0.0, -1.0] });
        // Sine and cosine of the direction's angle to -z, toward the axis, turned by I - I' at each shell.
        let (mut sine, mut cos) = (ZERO, ONE);
        let mut before = ONE;
        let (mut incidence, mut radius_last) = ((ZERO, ONE), exact(0.0));
        for &(radius, n) in shells {
            let (radius, n) = (exact(radius), exact(n));
            let [i, i_after] = [before, n].map(|index| exact(height) / (index * radius));
            let (ci, ci_after) = (cosine(i), cosine(i_after));
            let (turn_sine, turn_cos) = (i * ci_after - ci * i_after, ci * ci_after + i * i_after);
            (sine, cos) = (sine * turn_cos + cos * turn_sine, cos * turn_cos - sine * turn_sine);
            (incidence, radius_last, before) = ((i_after, ci_after), radius, n);
        }
        // The normal lies at the angle I' to the ray: its angle to the axis is the direction's plus I'.
        let (si, ci) = incidence;
        let (normal_sine, normal_cos) = (sine * ci + cos * si, cos * ci - sine * si);
        let sag = radius_last * (normal_cos - ONE);
        let point = [radius_last * normal_sine, ZERO, sag];
        answers.push(ExactRay { point, direction: [-sine, ZERO, -cos] });
    }
    Case { closed_form: Some(answers), ..Case::new("closed form", name, &lens, SceneToFilm, rays) }
}
