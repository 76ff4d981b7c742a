//! Whether a pupil is more, or less, than what its outline encloses: an outline in, whether there are holes within it or
//! light that gets through beside it out.

use super::{
    outline::{Outline, direction},
    view::{Excess, View},
};
use crate::lens::pupil::SlopeDisk;

/// Half-lines that are looked along.
const RAYS: usize = 12;
/// Looks along each of them within the outline, and from there to the cover's edge.
const WITHIN: usize = 5;
const BEYOND: usize = 8;
/// Distance from the centre over the edge's from which light that gets through is another piece's.
pub(crate) const BESIDE: f64 = 1.001;
/// Excess from which no piece is expected within a look's neighbourhood.
const FAR_OUTSIDE: f64 = 1.0;
/// Part of the pupil's area up to which a piece may be missed.
const SMALL: f64 = 5e-5;
/// Steps of a search for a piece between the looks.
const STEPS: u32 = 12;

/// A coarse look for holes inside the outline, and for light that gets through outside it: also between the looks,
/// wherever one of them is nearer to getting through than its neighbours. `cover` holds all of the light; the outline
/// encloses `area`, slope².
pub(crate) fn is_in_pieces(view: &View<'_>, outline: &Outline, area: f64, cover: SlopeDisk) -> bool {
    let place = |k: usize, n: usize| (k as f64 + 0.5) / n as f64;
    let mut cursor = 0;
    let half_lines: Vec<HalfLine> = (0..RAYS)
        .map(|i| HalfLine::new(view, outline, cover, std::f64::consts::PI * place(i, RAYS), &mut cursor))
        .collect();
    let within = half_lines
        .iter()
        .flat_map(|half_line| (0..WITHIN).map(|k| half_line.at(half_line.edge * place(k, WITHIN))));
    let mut looks: Vec<[f64; 2]> = within.collect();
    for half_line in &half_lines {
        looks.extend((0..BEYOND).map(|k| half_line.beyond(outward(k))));
    }
    let mut found = Vec::with_capacity(looks.len());
    view.excesses(&looks, &mut found);
    let (within, beyond) = found.split_at(RAYS * WITHIN);
    if within.iter().any(|excess| excess.value > 0.0) {
        return true;
    }
    let beside = |i: usize, k: usize| {
        let HalfLine { edge, end, .. } = half_lines[i];
        edge + (end - edge) * outward(k) > BESIDE * edge
    };
    let looks = (0..RAYS * BEYOND).map(|look| (look / BEYOND, look % BEYOND));
    if looks.clone().any(|(i, k)| beyond[i * BEYOND + k].value <= 0.0 && beside(i, k)) {
        return true;
    }
    let descents = looks
        .filter(|&(i, k)| is_least(beyond, i, k))
        .map(|(i, k)| Descent::new(half_lines[i], outward(k), beyond[i * BEYOND + k].value));
    Beside { view, outline, cover }.piece(descents.collect(), |point| !is_small(view, point, area))
}

/// Which part of the way from the outline to the cover's edge look `k` lies at: the looks are denser near the outline.
fn outward(k: usize) -> f64 {
    ((k as f64 + 0.5) / BEYOND as f64).powf(1.5)
}

/// Whether a piece is too small to count: none of the points about one of its own at the distance at which a disk has
/// [`SMALL`] of the pupil's area is in it.
fn is_small(view: &View<'_>, [x, y]: [f64; 2], area: f64) -> bool {
    let radius = (SMALL * area / (std::f64::consts::PI * view.width_scale)).sqrt();
    let around: Vec<[f64; 2]> = (0..8)
        .map(|i| direction(std::f64::consts::FRAC_PI_4 * f64::from(i)))
        .map(|[dx, dy]| [x + radius * dx, y + radius * dy])
        .collect();
    !view.pass(&around).contains(&true)
}

/// A half-line from the outline's centre.
#[derive(Clone, Copy)]
struct HalfLine {
    center: f64,
    angle: f64,
    direction: [f64; 2],
    /// Distances from the centre of the outline's edge, and of the cover's, if that lies farther out.
    edge: f64,
    end: f64,
}

impl HalfLine {
    fn new(view: &View<'_>, outline: &Outline, cover: SlopeDisk, angle: f64, cursor: &mut usize) -> Self {
        let [dx, dy] = direction(angle);
        let edge = outline.radius(angle, cursor);
        let (offset, x) = (view.width_scale * outline.center - cover.center[0], view.width_scale * dx);
        let (along, square) = (offset * x, x * x + dy * dy);
        let inside = cover.radius.powi(2) - offset * offset;
        let end = ((along * along + square * inside).max(0.0).sqrt() - along) / square;
        Self { center: outline.center, angle, direction: [dx, dy], edge, end: end.max(edge) }
    }

    fn at(&self, radius: f64) -> [f64; 2] {
        [self.center + radius * self.direction[0], radius * self.direction[1]]
    }

    /// The point at `part` of the way from the outline to the cover's edge.
    fn beyond(&self, part: f64) -> [f64; 2] {
        self.at(self.edge + (self.end - self.edge) * part)
    }
}

/// Whether look `k` along half-line `i` is nearer to getting through than its neighbours; the outline's own excess is 0.
fn is_least(beyond: &[Excess], i: usize, k: usize) -> bool {
    let at = |i: usize, k: usize| beyond[i * BEYOND + k].value;
    let own = at(i, k);
    own < FAR_OUTSIDE
        && k > 0
        && own < at(i, k - 1)
        && (k + 1 == BEYOND || own <= at(i, k + 1))
        && (i == 0 || own <= at(i - 1, k))
        && (i + 1 == RAYS || own <= at(i + 1, k))
}

/// What lies beside an outline.
struct Beside<'a> {
    view: &'a View<'a>,
    outline: &'a Outline,
    cover: SlopeDisk,
}

/// A descent of the excess from a point beside an outline.
struct Descent {
    point: Point,
    least: f64,
    /// Angle, and part of the way, to the neighbours that are looked at.
    step: [f64; 2],
    neighbours: [Point; 4],
}

/// A point beside an outline: the half-line on which it lies, and its part of the way from the outline to the cover's edge.
#[derive(Clone, Copy)]
struct Point {
    half_line: HalfLine,
    part: f64,
}

/// Where a descent leads.
enum Led {
    On,
    Nowhere,
    /// To light that gets through beside the outline, at these slopes.
    ToPiece([f64; 2]),
}

impl Beside<'_> {
    /// Whether one of the descents, side by side, ends at light that `counts`.
    fn piece(&self, mut descents: Vec<Descent>, counts: impl Fn([f64; 2]) -> bool) -> bool {
        let (mut looks, mut found) = (Vec::new(), Vec::new());
        for _ in 0..STEPS {
            looks.clear();
            for descent in &mut descents {
                descent.neighbours = self.neighbours(descent);
                looks.extend(descent.neighbours.map(|point| point.slopes()));
            }
            if looks.is_empty() {
                return false;
            }
            self.view.excesses(&looks, &mut found);
            let mut found = found.as_chunks::<4>().0.iter();
            let mut pieces = Vec::new();
            descents.retain_mut(|descent| match found.next().map(|excesses| descent.follow(excesses)) {
                Some(Led::On) => true,
                Some(Led::ToPiece(slopes)) => {
                    pieces.push(slopes);
                    false
                }
                Some(Led::Nowhere) | None => false,
            });
            if pieces.into_iter().any(&counts) {
                return true;
            }
        }
        false
    }

    fn neighbours(&self, Descent { point, step, .. }: &Descent) -> [Point; 4] {
        let Point { half_line, part } = *point;
        let turned = |turn: f64| {
            let angle = (half_line.angle + turn).clamp(0.0, std::f64::consts::PI);
            Point { half_line: self.half_line(angle), part }
        };
        let farther = |way: f64| Point { half_line, part: (part + way).clamp(0.0, 1.0) };
        [turned(step[0]), turned(-step[0]), farther(step[1]), farther(-step[1])]
    }

    fn half_line(&self, angle: f64) -> HalfLine {
        HalfLine::new(self.view, self.outline, self.cover, angle, &mut 0)
    }
}

impl Point {
    fn slopes(&self) -> [f64; 2] {
        self.half_line.beyond(self.part)
    }
}

impl Descent {
    fn new(half_line: HalfLine, part: f64, least: f64) -> Self {
        let point = Point { half_line, part };
        let step = [std::f64::consts::PI / (2 * RAYS) as f64, 0.5 / BEYOND as f64];
        Self { point, least, step, neighbours: [point; 4] }
    }

    /// Goes to the least of the neighbours, whose excesses these are.
    fn follow(&mut self, excesses: &[Excess; 4]) -> Led {
        let before = self.least;
        for (neighbour, excess) in self.neighbours.iter().zip(excesses) {
            if excess.value < self.least {
                (self.point, self.least) = (*neighbour, excess.value);
            }
        }
        if self.least <= 0.0 {
            // Toward the outline everything leads inside.
            let Point { half_line: HalfLine { edge, end, .. }, part } = self.point;
            let is_beside = edge + (end - edge) * part > BESIDE * edge;
            return if is_beside { Led::ToPiece(self.point.slopes()) } else { Led::Nowhere };
        }
        if self.least == before {
            self.step = self.step.map(|width| width / 2.0);
        }
        Led::On
    }
}

/// A grid of `across` by `across` on a disk's upper half, the disk's centre being on the sx axis.
pub(crate) fn half_disk(across: u32, disk: SlopeDisk) -> Vec<[f64; 2]> {
    let at = |k: u32| 2.0 * (f64::from(k) + 0.5) / f64::from(across) - 1.0;
    let grid = (0..across).flat_map(|i| (across / 2..across).map(move |j| [at(i), at(j)]));
    let within = grid.filter(|[x, y]| x * x + y * y <= 1.0);
    within.map(|[x, y]| [disk.center[0] + disk.radius * x, disk.radius * y]).collect()
}
