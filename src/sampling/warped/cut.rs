//! Pupils of points of the scene, cut by the film: samples of the part of a pupil whose rays land on a rectangle.
//!
//! A point's ray through the point (ξ, η) of the plane that its rays are named by lands on film, along the meridian and across
//! it, within r of
//!
//! ```text
//! (L + b ξ, b' η):
//! ```
//!
//! b and b' are the blur's sizes over the pupil's, 0 in focus. The four are a [`Landing`], tabulated. The map takes a radius of
//! the disk, from its centre to its edge, to a straight line on the plane, and so to one on film, of which the rectangle, larger
//! by r, holds the part from t₀ to t₁. So a sample (u, v) chooses
//!
//! ```text
//! a direction by u, with a density that goes with t₁² - t₀² at [`SECTORS`] directions, linear in the pseudo-angle within each;
//! a radius t by v, t² even from t₀² to t₁² of that direction.
//! ```
//!
//! Both densities are known exactly, whatever the tables, and nothing is tried twice. Where about all of a pupil lands on film
//! there is nothing to choose, and (u, v) goes to the whole disk, in half the time.

use std::f64::consts::PI;

use super::{
    Heading, Knots, LanePupil, Stack, product,
    slice::{CELLS, SECTORS, WIDE},
    stack::Between,
    toward,
};
use crate::{
    sampling::{disk::DiskMapping, film_rays::FilmRays},
    trace::kernel::{Cpu, Lanes},
};

/// What is added to a sector's share of t² for what lies between the directions that are looked at: less may leave a corner of
/// film with few samples, more sends them beside the film.
const FLOOR: f64 = 0.001;
/// Rays by which a landing is found at least: more leave more pupils to go on as the ones before, three would have no error to tell.
const FEWEST: usize = 4;
/// Fits of a landing: more make r smaller, and take longer to build.
const FITS: usize = 5;
/// How much larger than found r is, for what lies between the rays.
const LOOSE: f64 = 1.25;

/// Where the rays of a point of the scene land.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Landing {
    /// L, mm.
    pub along: f64,
    /// b and b'.
    pub factors: [f64; 2],
    /// r, mm.
    pub rest: f64,
    /// About how far from their middle rays land at most, mm.
    pub spread: f64,
}

impl Landing {
    /// Anywhere.
    pub const UNKNOWN: Self = Self { along: 0.0, factors: [0.0; 2], rest: 1e9, spread: 1e9 };

    /// Of rays through points of the plane that land at others; `None` of too few. The largest error counts, so rays far
    /// off weigh more from one fit by least squares to the next (C. Lawson's algorithm).
    pub fn of(rays: &[[[f64; 2]; 2]]) -> Option<Self> {
        if rays.len() < FEWEST {
            return None;
        }
        let mut weights = vec![1.0; rays.len()];
        let mut best: Option<Self> = None;
        for _ in 0..FITS {
            let found = Self::by_least_squares(rays, &weights);
            let [b, c] = found.factors;
            // Not where all rays are on one line, nor where the last fit was exact.
            if ![found.along, b, c].iter().all(|number| number.is_finite()) {
                break;
            }
            let off = |[at, [x, y]]: &[[f64; 2]; 2]| {
                let [along, aside] = found.at(*at);
                // No `hypot`: it takes ten times as long, for numbers that film does not have.
                ((x - along).powi(2) + (y - aside).powi(2)).sqrt()
            };
            let mut most = 0.0_f64;
            for (weight, ray) in weights.iter_mut().zip(rays) {
                let off = off(ray);
                most = most.max(off);
                *weight *= off;
            }
            let rest = LOOSE * most;
            if best.is_none_or(|best| rest < best.rest) {
                best = Some(Self { rest, ..found });
            }
        }
        let sides = [0, 1].map(|axis| {
            let parts = rays.iter().map(|[_, land]| land[axis]);
            let [low, high] =
                parts.fold([f64::MAX, f64::MIN], |[low, high], part| [low.min(part), high.max(part)]);
            // Rays are those of one side of the meridian.
            if axis == 0 { high - low } else { 2.0 * low.abs().max(high.abs()) }
        });
        best.map(|best| Self { spread: sides[0].hypot(sides[1]) / 2.0, ..best })
    }

    /// L, b and b' of rays with weights.
    fn by_least_squares(rays: &[[[f64; 2]; 2]], weights: &[f64]) -> Self {
        let total: f64 = weights.iter().sum();
        let mean = |of: &dyn Fn([[f64; 2]; 2]) -> f64| {
            rays.iter().zip(weights).map(|(ray, weight)| weight * of(*ray)).sum::<f64>() / total
        };
        let (p, x) = (mean(&|[[p, _], _]| p), mean(&|[_, [x, _]]| x));
        let square = mean(&|[[own, _], _]| (own - p).powi(2));
        let across = mean(&|[[_, q], _]| q * q);
        let b = mean(&|[[own, _], [land, _]]| (own - p) * (land - x)) / square;
        let factors = [b, mean(&|[[_, q], [_, y]]| q * y) / across];
        Self { along: x - b * p, factors, rest: 0.0, spread: 0.0 }
    }

    /// Where the ray through a point of the plane lands, about.
    pub fn at(&self, [p, q]: [f64; 2]) -> [f64; 2] {
        [self.along + self.factors[0] * p, self.factors[1] * q]
    }

    /// `part` of the way to another.
    pub fn toward(&self, other: &Self, part: f64) -> Self {
        let at = |a: f64, b: f64| a + part * (b - a);
        Self {
            along: at(self.along, other.along),
            factors: [0, 1].map(|i| at(self.factors[i], other.factors[i])),
            rest: at(self.rest, other.rest),
            spread: at(self.spread, other.spread),
        }
    }

    /// What another says otherwise of the ray through a point of the plane, mm.
    pub fn off(&self, other: &Self, at: [f64; 2]) -> f64 {
        let ([x, y], [u, v]) = (self.at(at), other.at(at));
        (x - u).hypot(y - v)
    }
}

/// Pupils at places of a second parameter, and where their rays land.
#[derive(Clone, Debug)]
pub(crate) struct CutPupil {
    stack: Stack,
    /// Even places from the axis to each table's end, less one.
    nodes: usize,
    /// Table by table, node by node: L and b, b' and r.
    landings: Vec<[f32; 2]>,
    /// The same: the spreads at a node and at the next.
    spreads: Vec<[f32; 2]>,
    /// Half the film's sides, mm.
    film: [f64; 2],
    /// The directions between the sectors, and the angle from each to the next.
    bounds: [([f64; 2], f64); SECTORS + 1],
}

/// The way from a point of the scene to the film's axes and numbers, in lanes.
#[derive(Clone, Copy)]
pub(crate) struct Query<L> {
    /// h.
    pub height: L,
    /// The place among the tables.
    pub place: L,
    /// Unit vector across the axis toward the point, in the film's axes.
    pub azimuth: [L; 2],
    /// From 0 to 1.
    pub numbers: [L; 2],
}

impl CutPupil {
    /// Of pupils, and the landings of each table at even places from the axis to its end, for film of these half sides, mm.
    pub fn new(stack: Stack, landings: &[Vec<Landing>], film: [f64; 2]) -> Self {
        let nodes = landings[0].len() - 1;
        let pairs = |landing: &Landing| {
            let Landing { along, factors: [b, c], rest, .. } = *landing;
            [[along as f32, b as f32], [c as f32, rest as f32]]
        };
        let to_next = |k: usize, of: &[Landing]| [k, (k + 1).min(nodes)].map(|node| of[node].spread as f32);
        let spreads = landings.iter().flat_map(|of| (0..=nodes).map(move |k| to_next(k, of))).collect();
        let landings = landings.iter().flatten().flat_map(pairs).collect();
        let knots = Knots::new();
        let angle = |bound: usize| PI * knots.parts[bound * WIDE];
        let span = |k: usize| angle((k + 1).min(SECTORS)) - angle(k);
        let bounds = std::array::from_fn(|k| (knots.directions[k * WIDE], span(k)));
        Self { stack, nodes, landings, spreads, film, bounds }
    }

    /// What sampling computes with.
    pub fn lane_pupil(&self) -> LanePupil<f64> {
        self.stack.lane_pupil()
    }

    /// Points (ξ, η) of the plane for points of the scene, and the areas that they stand for over π, all of a pupil being sampled;
    /// the fourth number is 0 or less where that is right, because all of it lands on film. NaN where there is nothing to sample.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn aim_whole<L: Lanes<Scalar = f64>>(
        &self,
        cpu: Cpu<L>,
        constants: &LanePupil<f64>,
        query: &Query<L>,
    ) -> [L; 4] {
        let (zero, nan) = (L::splat(cpu, 0.0), L::splat(cpu, f64::NAN));
        let place = self.place(cpu, constants, query);
        let beyond = place.cut.beyond;
        if L::all(zero.less(beyond)) {
            return [zero, zero, nan, beyond];
        }
        let Place { mut ray, between, .. } = place;
        ray.disk = DiskMapping::Concentric.lanes(cpu, query.numbers);
        let heading = Heading::of(cpu, &ray);
        let knots = self.stack.knots_between(&between, &heading);
        self.stack.aim_between(cpu, &between, &heading, knots, &mut ray);
        let [p, q] = ray.slopes;
        [p, q, L::select(between.radius.inside, ray.area_per_pi, nan), beyond]
    }

    /// Where in the tables points lie, and what of their pupils lands on film.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn place<L: Lanes<Scalar = f64>>(
        &self,
        cpu: Cpu<L>,
        constants: &LanePupil<f64>,
        query: &Query<L>,
    ) -> Place<L> {
        let (zero, one) = (L::splat(cpu, 0.0), L::splat(cpu, 1.0));
        let mut ray =
            FilmRays { point: [query.height, zero], disk: [one, zero], slopes: [zero; 2], area_per_pi: one };
        let between = self.stack.between(cpu, constants, query.place, &mut ray);
        let cut = self.cut(cpu, query, &between, ray.point[0]);
        Place { ray, between, cut }
    }

    /// The same of what of a pupil lands on film, for any point.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn aim_part<L: Lanes<Scalar = f64>>(
        &self,
        cpu: Cpu<L>,
        constants: &LanePupil<f64>,
        query: &Query<L>,
    ) -> [L; 4] {
        let Place { mut ray, ref between, ref cut } = self.place(cpu, constants, query);
        let number = |number: f64| L::splat(cpu, number);
        let (zero, one) = (number(0.0), number(1.0));
        // Of the sectors of the upper half and those of the lower one, from the point's side on.
        let mut shares = [zero; 2 * SECTORS];
        let (mut total, mut most) = (zero, zero);
        let (mut before, mut before_span) = ([zero; 2], zero);
        let mut factors = [[zero; 2]; SECTORS + 2];
        let mut k = 0;
        while k <= SECTORS {
            let [re, im, re_next, im_next] = self.stack.bounds_between(cpu, between, k);
            (factors[k], factors[k + 1]) = ([re, im], [re_next, im_next]);
            k += 2;
        }
        let mut k = 0;
        while k <= SECTORS {
            let [re, im] = factors[k];
            let ([u, v], span) = self.bounds[k];
            let (u, v) = (number(u), number(v));
            let edge = product([re, im], [u, v]);
            let both = cut.held_mirrored(cpu, edge);
            let mut half = 0;
            while half < 2 {
                let [from, to] = both[half];
                let held = (to - from).larger(zero);
                most = most.larger(held);
                if k > 0 {
                    let share = (held.larger(before[half]) + number(FLOOR)) * before_span;
                    shares[half * SECTORS + k - 1] = share;
                    total = total + share;
                }
                before[half] = held;
                half += 1;
            }
            before_span = number(span);
            k += 1;
        }
        // The sector, and where it begins.
        let target = query.numbers[0] * total;
        let (mut sector, mut start, mut share) = (zero, zero, shares[0]);
        let mut sum = shares[0];
        let mut k = 1;
        while k < 2 * SECTORS {
            let farther = sum.less(target);
            sector = L::select(farther, number(k as f64), sector);
            start = L::select(farther, sum, start);
            share = L::select(farther, shares[k], share);
            sum = sum + shares[k];
            k += 1;
        }
        let within = ((target - start) / share).larger(zero).smaller(one);
        let below = number(SECTORS as f64 - 0.5).less(sector);
        let sector = L::select(below, sector - number(SECTORS as f64), sector);
        let place = (sector + within) * number(WIDE as f64);
        let knot = place.smaller(number((CELLS - 1) as f64)).trunc();
        // q, and the direction of |a| + |b| = 1 there.
        let q = place * number(2.0 / CELLS as f64);
        let (a, b) = (one - q, q.smaller(number(2.0) - q));
        let square = b.mul_add(b, a * a);
        let heading =
            Heading { knot, offset: place - knot, turn: square * number(CELLS as f64 / 2.0), below };
        let knots = self.stack.knots_between(between, &heading);
        let [re, im, re_next, im_next] = knots;
        let (re, im) = (heading.offset.mul_add(re_next - re, re), heading.offset.mul_add(im_next - im, im));
        let per_length = one / square.sqrt();
        let (u, v) = (a * per_length, b * per_length);
        let edge = product([re, im], [u, v]);
        let [from, to] = cut.held(cpu, [edge[0], L::select(below, zero - edge[1], edge[1])]);
        // Of a direction that lands beside the film all, that it is blocked as any other.
        let lands = from.less(to);
        let [from, to] = [L::select(lands, from, zero), L::select(lands, to, one)];
        let radius = query.numbers[1].mul_add(to - from, from).larger(zero).sqrt();
        ray.disk = [radius * u, radius * L::select(below, zero - v, v)];
        self.stack.aim_between(cpu, between, &heading, knots, &mut ray);
        // t dt dφ of a disk of area π, where φ goes with q as 1 over the square.
        let per_number = total / share * number(2.0 / SECTORS as f64 / (2.0 * PI)) * (to - from) / square;
        let is_seen = L::both(between.radius.inside, zero.less(most));
        let area = L::select(is_seen, ray.area_per_pi * per_number, number(f64::NAN));
        [ray.slopes[0], ray.slopes[1], area, zero]
    }

    /// What the film holds of half-lines from the pupil's centre.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn cut<L: Lanes<Scalar = f64>>(
        &self,
        cpu: Cpu<L>,
        query: &Query<L>,
        between: &Between<L>,
        h: L,
    ) -> Cut<L> {
        let number = |number: f64| L::splat(cpu, number);
        let (part, row) = (between.part, &between.row);
        let place = between.radius.s * number(self.nodes as f64 / self.stack.cells() as f64);
        let node = place.smaller(number((self.nodes - 1) as f64)).trunc();
        let along = place - node;
        let next = self.nodes + 1;
        let at = node + between.table * number(next as f64);
        let [low, after, above, above_after] =
            L::look_up::<4, 2>(&self.landings, at.whole(), [0, 2, 2 * next, 2 * next + 2]);
        let (own, other) = (toward(along, low, after), toward(along, above, above_after));
        let [middle, b, c, rest] = toward(part, own, other);
        let [[spread, spread_next, ..], [above_spread, above_next, ..]] =
            L::look_up::<2, 1>(&self.spreads, at.whole(), [0, next]);
        let [spread] =
            toward(part, toward(along, [spread], [spread_next]), toward(along, [above_spread], [above_next]));
        let [ex, ey] = query.azimuth;
        // Of a half-line's part across what it is after narrowing.
        let middle = b.mul_add(row.center * h, middle);
        let narrow = b * row.narrowing.neg_mul_add(h * h, number(1.0));
        // What bends is no line: it is within that.
        let turn = row.bow * h * h * h;
        let bow = (b * turn).abs();
        let [fx, fy] = self.film.map(|half| number(half) + rest);
        let (zero, middles) = (number(0.0), [ex * middle, ey * middle]);
        let beyond = |axis: usize| middles[axis].abs() + spread - number(self.film[axis]);
        let turned = [[ex * narrow, zero - ey * c], [ey * narrow, ex * c]];
        Cut {
            beyond: beyond(0).larger(beyond(1)),
            back: [zero - middles[0], zero - middles[1]],
            turned,
            half: [fx, fy],
            bow: [ex.abs() * bow, ey.abs() * bow],
            turn: turn * turn,
        }
    }
}

/// Where in the tables points lie, and what of their pupils lands on film.
struct Place<L: Lanes> {
    ray: FilmRays<L>,
    between: Between<L>,
    cut: Cut<L>,
}

/// Where half-lines from the pupil's centre land, and the rectangle that is to hold them.
struct Cut<L> {
    /// About how far beyond it the pupil's rays land, mm: 0 or less where all land in it.
    beyond: L,
    /// The way from where the centre's ray lands to the film's middle.
    back: [L; 2],
    /// Where points of a half-line land from there: a matrix, by rows.
    turned: [[L; 2]; 2],
    /// Half the rectangle's sides.
    half: [L; 2],
    /// How much farther off a point may land over the square of its part across, and how much more than that it is, relative,
    /// over the same square.
    bow: [L; 2],
    turn: L,
}

impl<L: Lanes<Scalar = f64>> Cut<L> {
    /// The squares of the parts of the way to an edge point between which the rectangle holds it; the second is less where it
    /// holds nothing.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn held(&self, cpu: Cpu<L>, edge: [L; 2]) -> [L; 2] {
        let [a, b] = self.ways(cpu, edge);
        let per_both = L::splat(cpu, 1.0) / (a * b);
        self.held_by(cpu, self.halves(cpu, edge[1]), [per_both * b, per_both * a])
    }

    /// The same of an edge point and of its mirror image. One quotient serves for all four ways: quotients were most of the time.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn held_mirrored(&self, cpu: Cpu<L>, [x, y]: [L; 2]) -> [[L; 2]; 2] {
        let ([a, b], [c, d]) = (self.ways(cpu, [x, y]), self.ways(cpu, [x, L::splat(cpu, 0.0) - y]));
        let (ab, cd) = (a * b, c * d);
        let per_all = L::splat(cpu, 1.0) / (ab * cd);
        let (per_ab, per_cd, halves) = (per_all * cd, per_all * ab, self.halves(cpu, y));
        let [own, image] = [[per_ab * b, per_ab * a], [per_cd * d, per_cd * c]];
        [self.held_by(cpu, halves, own), self.held_by(cpu, halves, image)]
    }

    /// How far an edge point lands from where the centre does, along the film's sides.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn ways(&self, cpu: Cpu<L>, edge: [L; 2]) -> [L; 2] {
        // With this added they are not 0, for 0 times infinity is no number; and the product of four is not, either.
        let tiny = L::splat(cpu, 1e-60);
        let [[p, q], [r, s]] = self.turned;
        [q.mul_add(edge[1], p * edge[0]) + tiny, s.mul_add(edge[1], r * edge[0]) + tiny]
    }

    /// Half the rectangle's sides for an edge point at a distance from the meridian.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn halves(&self, cpu: Cpu<L>, aside: L) -> [L; 2] {
        let square = aside * aside;
        let square = square * square.mul_add(self.turn, L::splat(cpu, 1.0));
        [square.mul_add(self.bow[0], self.half[0]), square.mul_add(self.bow[1], self.half[1])]
    }

    /// [`Cut::held`] by the rectangle's half sides and 1 over each way.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn held_by(&self, cpu: Cpu<L>, halves: [L; 2], per_way: [L; 2]) -> [L; 2] {
        let (mut from, mut to) = (L::splat(cpu, 0.0), L::splat(cpu, 1.0));
        let mut axis = 0;
        while axis < 2 {
            let (middle, half) = (self.back[axis] * per_way[axis], halves[axis] * per_way[axis].abs());
            from = from.larger(middle - half);
            to = to.smaller(middle + half);
            axis += 1;
        }
        [from * from, L::select(from.less(to), to * to, L::splat(cpu, -1.0))]
    }
}
