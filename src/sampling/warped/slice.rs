//! One slice of a table: the map of the unit disk onto one outline, at knots; and how far an outline lies outside a map.

use std::{f64::consts::PI, ops::Range};

use super::outline::{self, HALF_LINES, Outline, bend, sector};

/// Intervals between the knots, from the lens direction along the film point's to the opposite one. The `cells` of a
/// `WarpedPupil` are others, of film radius.
pub(crate) const CELLS: usize = 128;
/// Knots.
pub(crate) const KNOTS: usize = CELLS + 1;
/// Sectors of half a disk by which what lands on film is chosen: more follow the cut closer, and take longer.
pub(super) const SECTORS: usize = 8;
/// Intervals of a sector.
pub(super) const WIDE: usize = CELLS / SECTORS;

/// By how much maps are larger than what was found, relative: for what edges are off, and what lies between.
pub(super) const MARGIN: f64 = 3e-4;

/// The disk's directions at the knots: pseudo-angles q = 1 - cos/(|cos| + sin) in equal steps from 0 to 2.
pub(crate) struct Knots {
    /// Angles over π.
    pub(super) parts: [f64; KNOTS],
    pub(super) directions: [[f64; 2]; KNOTS],
}

impl Knots {
    pub fn new() -> Self {
        let angle = |knot: usize| {
            let q = 2.0 * knot as f64 / CELLS as f64;
            (if q <= 1.0 { q } else { 2.0 - q }).atan2(1.0 - q)
        };
        let direction = |knot: usize| {
            let (sin, cos) = angle(knot).sin_cos();
            if knot == CELLS { [-1.0, 0.0] } else { [cos, sin] }
        };
        Self {
            parts: std::array::from_fn(|knot| angle(knot) / PI),
            directions: std::array::from_fn(direction),
        }
    }
}

/// The map d -> C + B(N(M(direction of d) d)) at one parameter h: N narrows x to τ of its size, and B is [`bend`].
#[derive(Clone, Debug)]
pub(crate) struct Slice {
    /// h: of a film point, its distance from the axis. A `Frame`'s height is the pupil's own.
    pub height: f64,
    /// C/h.
    pub center: f64,
    /// γ = (1 - τ)/h².
    pub narrowing: f64,
    /// 1 - s, which is √(1 - h/H), H being the end; 1 where the pupil does not vanish there, and of disks, which are not narrowed.
    pub left: f64,
    /// β = bow/h³, the bow being that of the outline's `Frame`.
    pub bow: f64,
    /// M at the knots, as complex numbers.
    pub factors: Vec<[f64; 2]>,
    /// Whether the pupil fills the map; else the map only covers it.
    pub fitted: bool,
}

impl Slice {
    /// A whole disk.
    pub fn disk(height: f64, center: f64, radius: f64, fitted: bool) -> Self {
        let factors = vec![[radius, 0.0]; KNOTS];
        Self { height, center, narrowing: 0.0, left: 1.0, bow: 0.0, factors, fitted }
    }

    /// The map onto an outline that takes equal areas of the disk to equal areas, narrowed to `width` of its size and bent.
    pub fn fit(outline: &Outline, height: f64, left: f64, [width, bow]: [f64; 2], knots: &Knots) -> Self {
        let frame = outline.frame;
        let total = outline.half_area();
        let radius = |k: usize| outline.edges[k].radius;
        let (mut k, mut before) = (0, 0.0);
        let mut area = sector(radius(0), radius(1));
        let factor = |(&part, direction): (&f64, &[f64; 2])| {
            let target = part * total;
            while k + 2 < HALF_LINES + 1 && target > before + area {
                before += area;
                k += 1;
                area = sector(radius(k), radius(k + 1));
            }
            let along = ((target - before) / area).clamp(0.0, 1.0);
            let far = radius(k) + along * (radius(k + 1) - radius(k));
            let (from, to) = (outline::direction(k), outline::direction(k + 1));
            let [u, v] = [0, 1].map(|i| from[i] + along * (to[i] - from[i]));
            let far = far / (u * u + v * v).sqrt();
            let y = far * v * frame.height;
            let x = (far * u * frame.width + bend(frame.bow, y) - bend(bow, y)) / width;
            turned_back(([x, y], direction))
        };
        let mut factors: Vec<[f64; 2]> = knots.parts.iter().zip(&knots.directions).map(factor).collect();
        // On the plane of symmetry they stay there.
        factors[0][1] = 0.0;
        factors[CELLS][1] = 0.0;
        let (narrowing, bow) = ((1.0 - width) / (height * height), bow / height.powi(3));
        let center = frame.center / height;
        let mut slice = Self { height, center, narrowing, left, bow, factors, fitted: true };
        slice.grow(&growth(&slice.outside(outline, knots)), MARGIN);
        slice
    }

    /// τ.
    fn width(&self) -> f64 {
        1.0 - self.narrowing * self.height * self.height
    }

    /// The slice that the table's interpolation makes at `part` of the way from this to another, at the parameter `height`.
    pub fn toward(&self, other: &Self, part: f64, height: f64) -> Self {
        let at = |a: f64, b: f64| a + part * (b - a);
        let factors = self.factors.iter().zip(&other.factors);
        Self {
            height,
            center: self.center_toward(other, height),
            narrowing: at(self.narrowing, other.narrowing) + part * (1.0 - part) * self.narrowing_bend(other),
            left: at(self.left, other.left),
            bow: at(self.bow, other.bow),
            factors: factors.map(|(a, b)| [at(a[0], b[0]), at(a[1], b[1])]).collect(),
            fitted: self.fitted && other.fitted,
        }
    }

    /// What γ bends by on the way to another slice of the table: it is γ₀ + t (γ₁ - γ₀) + t (1 - t) bend at the part t of the way
    /// in s. For τ vanishes about as a power of 1 - h²/H², H being the end: so γ is a parabola, which halfway has the τ of the
    /// power law through both.
    pub fn narrowing_bend(&self, other: &Self) -> f64 {
        if !(0.0 < other.left && other.left < self.left) {
            return 0.0;
        }
        let left = f64::midpoint(self.left, other.left);
        let [from, halfway, to] = [self.left, left, other.left].map(|left| left * left * (2.0 - left * left));
        let power = (other.width() / self.width()).ln() / (to / from).ln();
        let width = self.width() * (halfway / from).powf(power);
        let along = 1.0 - other.left * other.left;
        let height = other.height * (1.0 - left * left) / along;
        let bend = 4.0 * ((1.0 - width) / (height * height) - f64::midpoint(self.narrowing, other.narrowing));
        // More would have τ grow at the other slice, and so be less than there, perhaps below 0, before it.
        let growing = 4.0 * other.left * (self.left - other.left) / along;
        bend.min((1.0 + growing) * other.narrowing - self.narrowing)
    }

    /// The same with M larger by a factor.
    pub fn scaled(&self, by: f64) -> Self {
        Self { factors: self.factors.iter().map(|factor| factor.map(|x| by * x)).collect(), ..self.clone() }
    }

    /// The height of the map beyond this slice, over this one's, on the straight line from another slice through this one, `part` of
    /// that way farther.
    pub fn height_beyond(&self, before: &Self, part: f64) -> f64 {
        let [own, before] =
            [self, before].map(|slice| slice.factors[CELLS / 2].map(|x| x * x).iter().sum::<f64>().sqrt());
        (1.0 + part * (1.0 - before / own)).max(0.0)
    }

    /// C/h of that slice: straight in h, not in s.
    pub fn center_toward(&self, other: &Self, height: f64) -> f64 {
        let along = (height - self.height) / (other.height - self.height);
        self.center + along * (other.center - self.center)
    }

    /// The same over h in units of an end.
    pub fn in_units_of(&self, end: f64) -> Self {
        Self {
            height: self.height / end,
            center: self.center * end,
            narrowing: self.narrowing * end * end,
            bow: self.bow * end.powi(3),
            ..self.clone()
        }
    }

    /// The slice between two of tables that end at `ends`, at `part` of the way from one table to the other, over h in units
    /// of the end between.
    pub fn across(&self, other: &Self, part: f64, ends: [f64; 2]) -> Self {
        let [own, other] = [self.in_units_of(ends[0]), other.in_units_of(ends[1])];
        let at = |a: f64, b: f64| a + part * (b - a);
        let (center, narrowing) = (at(own.center, other.center), at(own.narrowing, other.narrowing));
        // Both are at the same part of the end, so that `height` says nothing; and nothing bends on the way.
        Self { center, narrowing, ..own.toward(&other, part, own.height) }
    }

    /// The mean of this map and its mirror image, about the axis.
    pub fn about_axis(&self, knots: &Knots) -> Self {
        let (points, width) = (self.points(knots), self.width());
        let mean = points
            .iter()
            .zip(points.iter().rev())
            .map(|([x, y], [other, above])| [width * (x - other) / 2.0, f64::midpoint(*y, *above)]);
        let factors = mean.zip(&knots.directions).map(turned_back).collect();
        Self { factors, ..Self::disk(0.0, 0.0, 0.0, true) }
    }

    /// Some points that samples go to.
    pub fn samples(&self, knots: &Knots) -> Vec<[f64; 2]> {
        const RINGS: u32 = 6;
        const EVERY: usize = 8;
        let rings = (0..RINGS).map(|ring| ((f64::from(ring) + 0.5) / f64::from(RINGS)).sqrt());
        let points = self.points(knots);
        rings
            .flat_map(|part| points.iter().step_by(EVERY).map(move |&point| self.place(point, part)))
            .collect()
    }

    /// Where a part of the way to one of [`Slice::points`] goes.
    fn place(&self, [x, y]: [f64; 2], part: f64) -> [f64; 2] {
        let (x, y) = (part * x * self.width(), part * y);
        [self.center * self.height + x + bend(self.bow * self.height.powi(3), y), y]
    }

    /// The edge's points at the knots, about the centre, before they are narrowed and bent.
    fn points(&self, knots: &Knots) -> Vec<[f64; 2]> {
        let turned =
            |([re, im], [cos, sin]): (&[f64; 2], &[f64; 2])| [re * cos - im * sin, re * sin + im * cos];
        self.factors.iter().zip(&knots.directions).map(turned).collect()
    }

    /// The map's area, with what is folded back.
    pub fn area(&self, knots: &Knots) -> f64 {
        let points = self.points(knots);
        let double = points.windows(2).map(|pair| cross(pair[0], pair[1]).abs());
        // Between knots it bulges as circles do.
        self.width() * double.sum::<f64>() / BULGE
    }

    /// How far an outline lies outside the map along each of its half-lines, relative, and the first of the two knots beside.
    pub fn outside(&self, outline: &Outline, knots: &Knots) -> Vec<(usize, f64)> {
        let corners = self.points(knots);
        let own = outline.frame;
        let (width, shift) = (self.width(), own.center - self.center * self.height);
        let bow = self.bow * self.height.powi(3);
        let mut j = 0;
        let along = |[u, v]: [f64; 2]| {
            let y = own.height * v;
            let point = [(shift + own.width * u + bend(own.bow, y) - bend(bow, y)) / width, y];
            while j + 1 < CELLS && cross(corners[j + 1], point) >= 0.0 {
                j += 1;
            }
            while j > 0 && cross(corners[j], point) < 0.0 {
                j -= 1;
            }
            // Over the distance at which the chord from knot to knot crosses its direction.
            let (from, to) = (corners[j], corners[j + 1]);
            let chord = [to[0] - from[0], to[1] - from[1]];
            let more = cross(point, chord) / cross(from, chord) - 1.0;
            (j, if more.is_finite() { more } else { 0.0 })
        };
        outline.points().map(along).collect()
    }

    /// Makes the map larger at the knots, and everywhere by a margin, relative.
    pub fn grow(&mut self, growth: &[f64], margin: f64) {
        for (factor, growth) in self.factors.iter_mut().zip(growth) {
            *factor = factor.map(|x| x * (1.0 + growth) * (1.0 + margin));
        }
    }
}

/// By how much a map is to be made larger at each knot to hold what lies outside it, [`Slice::outside`]: as much as along the
/// half-lines beside it.
pub(super) fn growth(outside: &[(usize, f64)]) -> Vec<f64> {
    let mut growth = vec![0.0_f64; KNOTS];
    let mut hold = |knots: Range<usize>, more: f64| {
        for knot in knots {
            growth[knot] = growth[knot].max(more);
        }
    };
    for &(knot, more) in outside {
        hold(knot..knot + 2, more);
    }
    // Beside some knots there is none.
    for pair in outside.windows(2) {
        let [(from, more), (to, other)] = [pair[0], pair[1]];
        hold(from + 2..to, more.max(other));
    }
    growth
}

/// The cross product.
fn cross([a, b]: [f64; 2], [c, d]: [f64; 2]) -> f64 {
    a * d - b * c
}

/// What takes a direction, a unit vector, to a point: their quotient as complex numbers.
fn turned_back(([x, y], [cos, sin]): ([f64; 2], &[f64; 2])) -> [f64; 2] {
    [x * cos + y * sin, y * cos - x * sin]
}

/// Area of the polygon of points on a circle at the knots, over the circle's: about that of equal angles.
const BULGE: f64 = 1.0 - PI * PI / (6.0 * (CELLS * CELLS) as f64);

#[cfg(test)]
mod tests {
    use super::*;

    /// One of a table that ends at 10 mm, where what is left of s is `left` and the pupil is narrowed to `width`.
    fn narrowed(left: f64, width: f64) -> Slice {
        let height = 10.0 * (1.0 - left * left);
        let narrowing = (1.0 - width) / (height * height);
        Slice { height, narrowing, left, ..Slice::disk(height, 0.0, 1.0, true) }
    }

    /// `part` of the way in s from one to another.
    fn between(from: &Slice, to: &Slice, part: f64) -> Slice {
        let left = from.left + part * (to.left - from.left);
        from.toward(to, part, 10.0 * (1.0 - left * left))
    }

    #[test]
    fn widths_that_vanish_by_a_power_are_met_halfway() {
        let crescent = |left: f64| 1.0 - (1.0 - left * left).powi(2);
        for power in [0.5, 1.0, 1.7] {
            let [from, to] = [0.5_f64, 0.4].map(|left| narrowed(left, crescent(left).powf(power)));
            let halfway = between(&from, &to, 0.5).width();
            assert!((halfway / crescent(0.45).powf(power) - 1.0).abs() < 1e-12, "{power}: {halfway}");
        }
    }

    #[test]
    fn however_fast_a_pupil_narrows_something_is_left_on_the_way() {
        for to in [0.5, 0.1, 0.01, 1e-4, 1e-6] {
            let [from, to] = [narrowed(0.25, 0.9), narrowed(0.125, to)];
            for part in 0..=100 {
                let width = between(&from, &to, f64::from(part) / 100.0).width();
                assert!(width > 0.0 && width < 0.9 + 1e-12, "to {}: {width}", to.width());
            }
        }
    }

    #[test]
    fn between_tables_nothing_bends() {
        // At the same part of the end, but for rounding.
        let [from, to] = [narrowed(0.3, 0.31), narrowed(0.3_f64.next_down(), 0.3)];
        let width = from.across(&to, 0.5, [10.0, 10.0]).width();
        assert!((width - 0.305).abs() < 1e-12, "{width}");
    }
}
