//! Ill-conditioned lenses whose answer the reference gives: telescopes in a row, and balls in a row, which amplify
//! small changes of a ray a million times and more.

use realistic_optics::trace::{Direction::SceneToFilm, Ray};

use super::{
    case::Case,
    lenses::{Row, SIDES, lens, parallel},
};

/// Telescopes in a row. Each magnifies angles ten times and is a tenth of the size of the previous one: three reach a
/// magnification of 1e3, eight 1e8.
pub fn telescopes() -> Vec<Case> {
    let mut cases = Vec::new();
    for stages in [1, 3, 6, 8] {
        let mut rows: Vec<Row> = Vec::new();
        let mut scale = 1.0;
        for _ in 0..stages {
            // Two plano-convex lenses of f = 100 and 10 (index 1.5) with a common focal point.
            let at = |length: f64| scale * length;
            rows.extend([
                (at(50.0), at(2.0), 1.5, at(4.0)),
                (f64::INFINITY, at(100.0 + 10.0 - 2.5 / 1.5), 1.0, at(4.0)),
                (f64::INFINITY, at(0.5), 1.5, at(0.6)),
                (at(-5.0), at(12.0), 1.0, at(0.6)),
            ]);
            scale /= 10.0;
        }
        rows.last_mut().expect("four rows or more").1 = 0.0;
        let name = format!("{stages} telescopes in a row");
        let mut rays = parallel([0.0, 1e-9, 1e-4, 1e-3, 5e-3, 1e-2]);
        for field in [1.0, -0.7] {
            let angle = 0.01 * field / 10.0_f64.powi(stages - 1);
            rays.extend((-2..=2).map(|i| Ray {
                origin: [5e-3 * f64::from(i), 2e-3, 10.0],
                direction: [angle, 0.5 * angle, -1.0],
            }));
        }
        cases.push(Case::new("stiff", name.as_str(), &lens(&name, &rows), SceneToFilm, rays));
    }
    cases
}

/// Balls in a row, an unstable resonator: neighbouring rays diverge at every ball.
pub fn balls() -> Vec<Case> {
    let mut cases = Vec::new();
    for (count, gap) in [(4, 4.0), (8, 4.0), (12, 4.0), (16, 4.0)] {
        let ball = [(1.0, 2.0, 1.8, 0.95), (-1.0, gap, 1.0, 0.95)];
        let mut rows: Vec<Row> = ball.into_iter().cycle().take(2 * count).collect();
        rows.last_mut().expect("two rows or more").1 = 0.0;
        for (side, direction) in SIDES {
            let sign = if direction == SceneToFilm { -1.0 } else { 1.0 };
            let name = format!("{count} balls in a row, gap {gap}, from the {side}");
            let shape = lens(&name, &rows);
            let start = if sign < 0.0 { 2.0 } else { shape.rear().vertex - 2.0 };
            let rays = (0..12)
                .map(|i| {
                    let height = 10.0_f64.powi(-i);
                    Ray { origin: [0.3 * height, 0.2 * height, start], direction: [-0.1 * height, 0.0, sign] }
                })
                .collect();
            cases.push(Case::new("resonator", name, &shape, direction, rays));
        }
    }
    cases
}
