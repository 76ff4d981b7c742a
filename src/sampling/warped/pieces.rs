//! Whether pupils are more, or less, than what their outlines enclose: outlines in, whether there are holes within each or
//! light that gets through beside it out.

use std::f64::consts::PI;

use super::{
    arc::direction,
    outline::Outline,
    view::{Excess, Tracer, View},
};
use crate::{lens::pupil::SlopeDisk, trace::kernel::MeridianRay};

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

/// An outline that is looked at.
#[derive(Clone, Copy)]
pub(crate) struct Shape<'a> {
    pub view: View<'a>,
    pub outline: &'a Outline,
    /// What the outline encloses, slope².
    pub area: f64,
    /// Holds all of the light.
    pub cover: SlopeDisk,
}

/// A coarse look for holes inside each of several outlines, and for light that gets through outside it: also between the
/// looks, wherever one of them is nearer to getting through than its neighbours. Side by side, because rays are traced in
/// packets.
pub(crate) fn are_in_pieces(tracer: &Tracer, shapes: &[Shape<'_>]) -> Vec<bool> {
    const LOOKS: usize = RAYS * (WITHIN + BEYOND);
    let place = |k: usize, n: usize| (k as f64 + 0.5) / n as f64;
    let mut half_lines = Vec::with_capacity(RAYS * shapes.len());
    let mut rays = Vec::with_capacity(LOOKS * shapes.len());
    for shape in shapes {
        let mut cursor = 0;
        let first = half_lines.len();
        half_lines.extend((0..RAYS).map(|i| shape.half_line(PI * place(i, RAYS), &mut cursor)));
        let own = &half_lines[first..];
        let within = own
            .iter()
            .flat_map(|half_line| (0..WITHIN).map(|k| half_line.at(half_line.edge * place(k, WITHIN))));
        let beyond = own.iter().flat_map(|half_line| (0..BEYOND).map(|k| half_line.beyond(outward(k))));
        rays.extend(within.chain(beyond).map(|slopes| shape.view.ray(slopes)));
    }
    let mut found = Vec::with_capacity(rays.len());
    tracer.excesses(rays.into_iter(), &mut found);
    let mut in_pieces = Vec::with_capacity(shapes.len());
    let mut descents = Vec::new();
    let looks = found.as_chunks::<LOOKS>().0.iter().zip(half_lines.as_chunks::<RAYS>().0);
    for (number, (found, half_lines)) in looks.enumerate() {
        let (within, beyond) = found.split_at(RAYS * WITHIN);
        let beside = |i: usize, k: usize| half_lines[i].distance(outward(k)) > BESIDE * half_lines[i].edge;
        let looks = (0..RAYS * BEYOND).map(|look| (look / BEYOND, look % BEYOND));
        let has_hole = within.iter().any(|excess| excess.value > 0.0);
        let is_seen =
            has_hole || looks.clone().any(|(i, k)| beyond[i * BEYOND + k].value <= 0.0 && beside(i, k));
        in_pieces.push(is_seen);
        if !is_seen {
            let least = looks.filter(|&(i, k)| is_least(beyond, i, k));
            descents.extend(least.map(|(i, k)| {
                let point = Point { half_line: half_lines[i], part: outward(k) };
                Descent::new(number, point, beyond[i * BEYOND + k].value)
            }));
        }
    }
    look_beside(tracer, shapes, descents, &mut in_pieces);
    in_pieces
}

/// Which part of the way from the outline to the cover's edge look `k` lies at: the looks are denser near the outline.
fn outward(k: usize) -> f64 {
    ((k as f64 + 0.5) / BEYOND as f64).powf(1.5)
}

/// Whether a piece is too small to count: none of the points about one of its own at the distance at which a disk has
/// [`SMALL`] of the pupil's area is in it. Light at a point that the outline encloses is the pupil's own: where its edge
/// jumps the outline may end a little too early.
fn is_small(Shape { view, outline, area, .. }: &Shape<'_>, [x, y]: [f64; 2]) -> bool {
    let radius = (SMALL * area / (PI * view.width_scale)).sqrt();
    let around = (0..8)
        .map(|i| direction(std::f64::consts::FRAC_PI_4 * f64::from(i)))
        .map(|[dx, dy]| [x + radius * dx, y + radius * dy])
        .filter(|&[x, y]| {
            let (x, y) = (x - outline.center, y.abs());
            x.hypot(y) > BESIDE * outline.radius(y.atan2(x), &mut 0)
        });
    !view.pass(&around.collect::<Vec<_>>()).contains(&true)
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

impl Shape<'_> {
    fn half_line(&self, angle: f64, cursor: &mut usize) -> HalfLine {
        let Self { view, outline, cover, .. } = self;
        let [dx, dy] = direction(angle);
        let edge = outline.radius(angle, cursor);
        let (offset, x) = (view.width_scale * outline.center - cover.center[0], view.width_scale * dx);
        let (along, square) = (offset * x, x * x + dy * dy);
        let inside = cover.radius.powi(2) - offset * offset;
        let end = ((along * along + square * inside).max(0.0).sqrt() - along) / square;
        HalfLine { center: outline.center, angle, direction: [dx, dy], edge, end: end.max(edge) }
    }
}

impl HalfLine {
    fn at(&self, radius: f64) -> [f64; 2] {
        [self.center + radius * self.direction[0], radius * self.direction[1]]
    }

    /// The point at `part` of the way from the outline to the cover's edge.
    fn beyond(&self, part: f64) -> [f64; 2] {
        self.at(self.distance(part))
    }

    /// Its distance from the centre.
    fn distance(&self, part: f64) -> f64 {
        self.edge + (self.end - self.edge) * part
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

/// A descent of the excess from a point beside an outline.
struct Descent {
    /// The outline's number.
    shape: usize,
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

/// Follows the descents, side by side, and marks the shapes of which one ends at light beside the outline.
fn look_beside(tracer: &Tracer, shapes: &[Shape<'_>], mut descents: Vec<Descent>, in_pieces: &mut [bool]) {
    let mut found = Vec::with_capacity(4 * descents.len());
    for _ in 0..STEPS {
        descents.retain(|descent| !in_pieces[descent.shape]);
        if descents.is_empty() {
            return;
        }
        for descent in &mut descents {
            descent.neighbours = descent.around(&shapes[descent.shape]);
        }
        let rays: Vec<MeridianRay> = descents
            .iter()
            .flat_map(|Descent { shape, neighbours, .. }| {
                neighbours.map(|point| shapes[*shape].view.ray(point.slopes()))
            })
            .collect();
        tracer.excesses(rays.into_iter(), &mut found);
        let mut found = found.as_chunks::<4>().0.iter();
        descents.retain_mut(|descent| match found.next().map(|excesses| descent.follow(excesses)) {
            Some(Led::On) => true,
            Some(Led::ToPiece(slopes)) => {
                in_pieces[descent.shape] |= !is_small(&shapes[descent.shape], slopes);
                false
            }
            Some(Led::Nowhere) | None => false,
        });
    }
}

impl Point {
    fn slopes(&self) -> [f64; 2] {
        self.half_line.beyond(self.part)
    }
}

impl Descent {
    fn new(shape: usize, point: Point, least: f64) -> Self {
        let step = [PI / (2 * RAYS) as f64, 0.5 / BEYOND as f64];
        Self { shape, point, least, step, neighbours: [point; 4] }
    }

    /// The neighbours that are to be looked at.
    fn around(&self, shape: &Shape<'_>) -> [Point; 4] {
        let Point { half_line, part } = self.point;
        let turned = |turn: f64| {
            let angle = (half_line.angle + turn).clamp(0.0, PI);
            Point { half_line: shape.half_line(angle, &mut 0), part }
        };
        let farther = |way: f64| Point { half_line, part: (part + way).clamp(0.0, 1.0) };
        [turned(self.step[0]), turned(-self.step[0]), farther(self.step[1]), farther(-self.step[1])]
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
            let Point { half_line, part } = self.point;
            let is_beside = half_line.distance(part) > BESIDE * half_line.edge;
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
