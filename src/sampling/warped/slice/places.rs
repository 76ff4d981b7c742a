//! Where on an outline the knots of its map lie: an outline in, points between which it encloses equal areas out. Numbers are
//! in columns, of which the compiler takes several knots at a time.

use std::f64::consts::PI;

use super::{
    super::{
        arc::{Piece, direction},
        outline::Outline,
    },
    knots::{CELLS, KNOTS, Knots},
};
use crate::trace::kernel::{Compiled, Simd};

/// Points of the outline at the knots, about its centre.
#[derive(Clone, Debug)]
pub(crate) struct Places {
    pub angle: [f64; KNOTS],
    /// The angle's unit vector.
    cos: [f64; KNOTS],
    sin: [f64; KNOTS],
    pub radius: [f64; KNOTS],
}

impl Places {
    /// Between which the outline encloses areas in proportion to the knots' angles; and the area in all.
    pub fn of_equal_areas(outline: &Outline, knots: &Knots) -> (Box<Self>, f64) {
        let mut sectors = Vec::with_capacity(outline.pieces.len());
        let mut total = 0.0;
        for &piece in &outline.pieces {
            let sector = Sector::new(piece, total);
            total += sector.area;
            sectors.push(sector);
        }
        let mut columns = [[0.0; KNOTS]; SHARE];
        let mut number = 0;
        for (knot, &part) in knots.parts.iter().enumerate() {
            let target = total * part;
            while number + 1 < sectors.len() && target > sectors[number].before + sectors[number].area {
                number += 1;
            }
            for (column, number) in columns.iter_mut().zip(sectors[number].share(target)) {
                column[knot] = number;
            }
        }
        Simd::best().run(EqualAreas { columns: &mut columns });
        let [radius, mut angle, turn, mut cos, mut sin, ..] = columns;
        for knot in 0..CELLS {
            if turn[knot] >= SMALL {
                [cos[knot], sin[knot]] = direction(angle[knot]);
            }
        }
        // The other end is exact by itself.
        (angle[CELLS], cos[CELLS], sin[CELLS]) = (PI, -1.0, 0.0);
        (Box::new(Self { angle, cos, sin, radius }), total)
    }

    /// Turns points, columns of x and y about as far around as these are, into angles in [0, π], NaN where one is far from
    /// the place of its knot, and distances.
    pub fn polar(&self, points: &mut [[f64; KNOTS]; 2]) {
        Simd::best().run(Polar { points, places: self });
    }

    pub fn direction(&self, knot: usize) -> [f64; 2] {
        [self.cos[knot], self.sin[knot]]
    }
}

/// Finds where an outline encloses shares of its area: in place, column by column, the compiler then being free to do
/// several knots at once.
struct EqualAreas<'a> {
    /// What [`Sector::share`] has in; distance from the centre, angle, angle from the sector's beginning, and unit vector
    /// out.
    columns: &'a mut [[f64; KNOTS]; SHARE],
}

impl Compiled for EqualAreas<'_> {
    #[inline(always)]
    fn run(self) {
        let [share, from, width, cos, sin, a, p, q, c0, c1, c2, c3] = self.columns;
        for knot in 0..KNOTS {
            let (a, p, q) = (a[knot], p[knot], q[knot]);
            let mut x = share[knot].clamp(0.0, 1.0);
            // The density as a parabola, a + p x + q x², x in [0, 1].
            let wanted = x * (a + p / 2.0 + q / 3.0);
            for _ in 0..2 {
                let area = x * (a + x * (p / 2.0 + x * q / 3.0));
                x = (x - (area - wanted) / (a + x * (p + x * q))).clamp(0.0, 1.0);
            }
            let turn = width[knot] * x;
            share[knot] = (c0[knot] + turn * (c1[knot] + turn * (c2[knot] + turn * c3[knot]))).recip();
            from[knot] += turn;
            width[knot] = turn;
            [cos[knot], sin[knot]] = turned([cos[knot], sin[knot]], turn);
        }
    }
}

/// [`Places::polar`], in place.
struct Polar<'a> {
    points: &'a mut [[f64; KNOTS]; 2],
    places: &'a Places,
}

impl Compiled for Polar<'_> {
    #[inline(always)]
    fn run(self) {
        /// Tangent up to which four terms of the arctangent's series are as good as the function.
        const NEAR: f64 = 0.1;
        let Self { points: [xs, ys], places } = self;
        for knot in 0..KNOTS {
            let (x, y) = (xs[knot], ys[knot].max(0.0));
            let (cos, sin) = (places.cos[knot], places.sin[knot]);
            let (across, along) = (cos * y - sin * x, cos * x + sin * y);
            let t = across / along;
            let square = t * t;
            let turn = t * (1.0 - square * (1.0 / 3.0 - square * (0.2 - square * (1.0 / 7.0))));
            let angle = (places.angle[knot] + turn).clamp(0.0, PI);
            ys[knot] = (x * x + ys[knot] * ys[knot]).sqrt();
            xs[knot] = if across.abs() < NEAR * along { angle } else { f64::NAN };
        }
    }
}

/// A piece of the outline with what it encloses.
struct Sector {
    piece: Piece,
    /// Where it begins, as a unit vector.
    start: [f64; 2],
    /// radius²/2 at both ends and in the middle.
    density: [f64; 3],
    /// Area up to its beginning, and its own.
    before: f64,
    area: f64,
    per_area: f64,
}

/// Numbers of a share.
const SHARE: usize = 12;

impl Sector {
    /// dA = radius²/2 d(angle), by Simpson's rule.
    fn new(piece: Piece, before: f64) -> Self {
        let Piece { from, to, .. } = piece;
        let density = [from, f64::midpoint(from, to), to].map(|angle| piece.radius(angle).powi(2) / 2.0);
        let area = (to - from) * (density[0] + 4.0 * density[1] + density[2]) / 6.0;
        Self { piece, start: direction(from), density, before, area, per_area: area.recip() }
    }

    /// What [`EqualAreas`] takes: the part of the area that makes the whole outline's up to there `target`; where the
    /// sector begins, its angle, and the beginning as a unit vector; its density's coefficients, and its cubic's.
    fn share(&self, target: f64) -> [f64; SHARE] {
        let Self { piece: Piece { from, to, cubic: [c0, c1, c2, c3] }, start: [cos, sin], .. } = *self;
        let [a, m, b] = self.density;
        let (p, q) = (4.0 * m - 3.0 * a - b, 2.0 * a + 2.0 * b - 4.0 * m);
        [(target - self.before) * self.per_area, from, to - from, cos, sin, a, p, q, c0, c1, c2, c3]
    }
}

/// Angle up to which the terms that the series of [`turned`] leave out are below 1e-15.
const SMALL: f64 = 0.22;

/// A unit vector turned by an angle from 0 to [`SMALL`], by the series of cosine and sine.
#[inline(always)]
fn turned([x, y]: [f64; 2], angle: f64) -> [f64; 2] {
    const COSINE: [f64; 5] = [1.0 / 2.0, 1.0 / 24.0, 1.0 / 720.0, 1.0 / 40_320.0, 1.0 / 3_628_800.0];
    const SINE: [f64; 4] = [1.0 / 6.0, 1.0 / 120.0, 1.0 / 5040.0, 1.0 / 362_880.0];
    let square = angle * angle;
    let series = |terms: &[f64]| terms.iter().rev().fold(0.0, |sum, term| square * (term - sum));
    let cos = 1.0 - series(&COSINE);
    let sin = angle * (1.0 - series(&SINE));
    [x * cos - y * sin, x * sin + y * cos]
}
