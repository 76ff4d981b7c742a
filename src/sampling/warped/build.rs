//! Builds the table: a path and the film's place in; outlines at as many film radii as it takes for the ones between to
//! be interpolated out. Intervals of film radius are halved until the middle is predicted by its ends (adaptive
//! subdivision), also toward a radius whose pupil has no outline that fits; there the rear element's disk stands in.

use std::{cell::Cell, collections::BTreeMap, rc::Rc};

use super::{
    meridian::first_look,
    outline::{Guess, Outline},
    pieces::{BESIDE, Shape, are_in_pieces, half_disk},
    report::{GivenUp, NoFan},
    search::{Crossing, EdgeFinder, HalfLine, Hints},
    slice::{CELLS, Knots, Places, Slice, TRACE_EVERY},
    vanishing::{Field, Vanishing},
    view::{Limit, Tracer, View},
};
use crate::{lens::pupil::SlopeDisk, sampling::pupil_disk::PupilDisk, trace::Path};

/// Intervals of film radius that the table begins with.
pub(crate) const COARSE: usize = 8;
/// Times that each of them may be halved.
pub(crate) const DEPTH: u32 = 6;
/// Smallest intervals.
pub(crate) const FINE: usize = COARSE << DEPTH;

/// What may be left of a misfit in an interval's middle when that is made a slice: a quarter for smooth
/// outlines, a little more where a corner moves along.
const AFTER_HALVING: f64 = 0.3;
/// The same where a corner comes or goes anywhere within the interval, a quarter of it from the end
/// at worst.
const WITH_NEW_CORNERS: f64 = 1.0;
/// Share of the pupil that interpolation may then miss before the halves are halved again.
const MISSED: f64 = 4.5e-5;
/// The same where halves cannot be halved again, nor the map be made as much larger as it takes: a bound, for where a corner
/// comes or goes within the halves most of it is not missed. Beyond, the rear disk stands in.
const MISSED_AT_LAST: f64 = 3e-4;
/// The same for what the interpolated shape has too much, which costs acceptance.
const EXCESS: f64 = 3e-3;
/// How much larger than interpolated a map may be made, relative, where the pupil changes faster than the narrowest
/// intervals.
const MOST_GROWTH: f64 = 3.0;
/// Share of the samples that may be lost there without a word, or what the margin costs, if that is more.
const UNNAMED: f64 = 0.004;

/// Part of the pupil on the axis below which a pupil about to vanish is no longer worth an outline.
const SLIVER: f64 = 1e-3;

/// Radius of the pupil on the axis over how far its centre moves over the film, in slope, below which the table, which has
/// the centre in single precision, cannot follow it: sixteen of its roundings.
const NARROWEST: f64 = 1e-6;

/// τ where the pupil vanishes: not 0, which rounding in single precision would make a negative density of.
const LEAST_WIDTH: f64 = 1e-6;

/// Width, in smallest intervals, up to which nothing is sought between two radii that have no map.
const BLIND: usize = FINE / 32;

/// What the table is built from.
pub(crate) struct Builder {
    pub tracer: Tracer,
    /// Largest film radius asked for, mm.
    pub reach: f64,
    /// A disk that holds every pupil.
    pub cover: PupilDisk,
    /// Film radius times this is about the slope to the pupil's centre.
    pub shift: f64,
    hints: Hints,
    knots: Knots,
    /// The film radius at which the pupil vanishes, mm; infinite where that lies beyond reach.
    vanishing: Cell<f64>,
    /// Area of the pupil on the axis, slope²; 0 until it is known.
    axis_area: Cell<f64>,
}

/// A stretch of film radius between two slices.
pub(crate) struct Interval {
    /// In units of the smallest interval.
    pub from: usize,
    pub to: usize,
    pub slices: [Rc<Slice>; 2],
}

/// Everything that the table keeps.
pub(crate) struct Layout {
    /// Film radius at the table's end, mm.
    pub end: f64,
    /// Whether no light reaches the film beyond the end.
    pub dark_beyond: bool,
    pub intervals: Vec<Interval>,
    pub given_up: Vec<GivenUp>,
}

/// A film radius's map, or why it has none.
type Node = Result<Rc<Slice>, NoFan>;

/// A stretch of film radius that is not filled yet, between two radii that may have maps.
struct Gap {
    ends: [usize; 2],
    nodes: [Node; 2],
}

/// What is expected at a film radius.
struct Expected<'a, 'b> {
    view: View<'a>,
    /// A slope on the meridian that the pupil is expected to hold, and how far around that it is sought, in units of τ.
    around: [f64; 2],
    like: &'b Slice,
}

/// What was found there: the outline, its map, and where on the outline the map's knots lie.
type Traced = (Outline, Rc<Slice>, Box<Places>);

/// The table as it grows.
struct Table<H> {
    /// Film radius, mm, of a number of smallest intervals.
    height: H,
    intervals: Vec<Interval>,
    given_up: Vec<GivenUp>,
    /// How much larger than the pupil the maps at numbers of smallest intervals are to be made, relative, by knot.
    growth: BTreeMap<usize, Vec<f64>>,
}

impl Builder {
    pub fn new(path: &Path, film: f64, reach: f64, cover: PupilDisk, shift: f64) -> Self {
        Self {
            tracer: Tracer::new(path, film),
            reach,
            cover,
            shift,
            hints: Hints::new(path.surfaces()),
            knots: Knots::new(),
            vanishing: Cell::new(f64::INFINITY),
            axis_area: Cell::new(0.0),
        }
    }

    fn view(&self, height: f64, width_scale: f64) -> View<'_> {
        View { tracer: &self.tracer, height, width_scale }
    }

    fn finder(&self) -> EdgeFinder<'_> {
        EdgeFinder { tracer: &self.tracer, hints: &self.hints }
    }

    fn cover_at(&self, height: f64) -> SlopeDisk {
        self.cover.seen_from([height, 0.0])
    }

    fn cover_slice(&self, height: f64) -> Slice {
        let center = self.cover.seen_from([1.0, 0.0]).center[0];
        Slice::disk(height, center, self.cover_at(height).radius, false)
    }

    pub fn layout(&self) -> Layout {
        let Self { tracer, reach, cover, shift, .. } = self;
        let axis = self.axial_slice();
        // No farther than the rear element is wide, however large the film.
        let moved = (shift * reach).abs().min(self.cover_at(0.0).radius);
        if axis.as_ref().is_ok_and(|axis| axis.factors[0][0] < NARROWEST * moved) {
            return self.narrow();
        }
        let radius = axis.as_ref().map_or(f64::INFINITY, |axis| axis.factors[0][0]);
        let field = Field { tracer, reach: *reach, cover: *cover, shift: *shift, radius };
        let vanishing = field.vanishing().map(|Vanishing { height, center }| {
            self.vanishing.set(height);
            // Narrowed to almost nothing.
            let narrowing = (1.0 - LEAST_WIDTH) / (height * height);
            Slice { narrowing, ..Slice::disk(height, center, 0.0, true) }
        });
        let dark_beyond = vanishing.is_some();
        let end = vanishing.as_ref().map_or(self.reach, |slice| slice.height);
        let height = |place: usize| {
            let s = place as f64 / FINE as f64;
            end * if dark_beyond { s * (2.0 - s) } else { s }
        };
        let coarse = self.coarse_slices(&height, axis, vanishing);
        let mut table =
            Table { height, intervals: Vec::new(), given_up: Vec::new(), growth: BTreeMap::new() };
        let gap = |(number, pair): (usize, &[Node])| Gap {
            ends: [number << DEPTH, (number + 1) << DEPTH],
            nodes: [pair[0].clone(), pair[1].clone()],
        };
        let mut gaps: Vec<Gap> = coarse.windows(2).enumerate().map(gap).collect();
        drop(coarse);
        // All gaps of a width at once, so that their rays are traced side by side.
        while !gaps.is_empty() {
            gaps = self.halve(gaps, &mut table);
        }
        let Table { mut intervals, mut given_up, growth, .. } = table;
        intervals.sort_by_key(|interval| interval.from);
        for Interval { from, to, slices } in &mut intervals {
            for (slice, place) in slices.iter_mut().zip([*from, *to]) {
                if let (Some(growth), true) = (growth.get(&place), slice.fitted) {
                    Rc::make_mut(slice).grow(growth);
                }
            }
        }
        given_up.sort_by(|a, b| a.radii[0].total_cmp(&b.radii[0]));
        center_on_axis(&mut intervals);
        Layout { end, dark_beyond, intervals, given_up: self.joined(given_up) }
    }

    /// Gives everything up.
    fn narrow(&self) -> Layout {
        let radii = [0.0, self.reach];
        let slices = radii.map(|height| Rc::new(self.cover_slice(height)));
        Layout {
            end: self.reach,
            dark_beyond: false,
            intervals: vec![Interval { from: 0, to: FINE, slices }],
            given_up: vec![GivenUp { radii, reason: NoFan::Narrow, acceptance: 0.0 }],
        }
    }

    /// Gives an interval up.
    fn cover<H: Fn(usize) -> f64>(&self, [from, to]: [usize; 2], reason: NoFan, table: &mut Table<H>) {
        let radii = [from, to].map(&table.height);
        table.intervals.push(Interval {
            from,
            to,
            slices: radii.map(|height| Rc::new(self.cover_slice(height))),
        });
        table.given_up.push(GivenUp { radii, reason, acceptance: 0.0 });
    }

    /// Neighbours given up for the same reason as one, with what is left of the acceptance.
    fn joined(&self, given_up: Vec<GivenUp>) -> Vec<GivenUp> {
        let mut joined: Vec<GivenUp> = Vec::new();
        for new in given_up {
            match joined.last_mut() {
                Some(last) if last.reason == new.reason && last.radii[1] == new.radii[0] => {
                    last.radii[1] = new.radii[1];
                    last.acceptance = last.acceptance.min(new.acceptance);
                }
                _ => joined.push(new),
            }
        }
        let covered = joined.iter_mut().filter(|given_up| given_up.reason != NoFan::Fast);
        for GivenUp { radii: [from, to], acceptance, .. } in covered {
            let shares = [*from, f64::midpoint(*from, *to), *to].map(|height| self.cover_acceptance(height));
            let least = shares.into_iter().filter(|&share| share > 0.0).fold(f64::INFINITY, f64::min);
            *acceptance = if least.is_finite() { least } else { 0.0 };
        }
        joined
    }

    /// Share of the cover's disk that gets through, by a grid.
    fn cover_acceptance(&self, height: f64) -> f64 {
        let cover = self.cover_at(height);
        let slopes = half_disk(28, cover);
        let passed = self.view(height, 1.0).pass(&slopes).into_iter().filter(|&passes| passes).count();
        passed as f64 / slopes.len() as f64
    }

    /// The maps at the ends of the coarse intervals, each sought from the nearest one found, first from the axis outward
    /// and then back.
    fn coarse_slices(
        &self,
        height: &impl Fn(usize) -> f64,
        axis: Result<Slice, NoFan>,
        vanishing: Option<Slice>,
    ) -> Vec<Node> {
        let axis = axis.map(Rc::new);
        self.axis_area.set(axis.as_ref().map_or(0.0, |slice| slice.area));
        let ends = if vanishing.is_some() { COARSE - 1 } else { COARSE };
        let mut nodes = self.outward(height, axis, ends);
        nodes.extend(vanishing.map(|slice| Ok(Rc::new(slice))));
        for number in (1..=ends).rev() {
            let beyond = nodes[number + 1..].iter().find_map(|node| node.clone().ok());
            if let (Err(NoFan::Shape | NoFan::NoLight), Some(beyond)) = (&nodes[number], beyond) {
                let height = height(number << DEPTH);
                let before = nodes[..number]
                    .iter()
                    .enumerate()
                    .rev()
                    .find_map(|(i, node)| Some((i, node.as_ref().ok()?)));
                let like = match before {
                    // A pupil that vanishes shrinks evenly.
                    Some((place, before)) if beyond.area == 0.0 => {
                        before.toward(&beyond, (number - place) as f64 / (COARSE - place) as f64, height)
                    }
                    _ => Slice::clone(&beyond),
                };
                if like.area > 0.0 {
                    nodes[number] = self.slice_like(height, &like);
                }
            }
        }
        if let [Ok(axis), Ok(next), ..] = nodes.as_mut_slice() {
            let axis = Rc::make_mut(axis);
            (axis.center, axis.narrowing) = (next.center, next.narrowing);
        }
        nodes
    }

    /// The axis's map and those at the ends of the first coarse intervals, each sought from the nearest one before.
    fn outward(&self, height: &impl Fn(usize) -> f64, axis: Node, ends: usize) -> Vec<Node> {
        let mut nodes: Vec<Node> = vec![axis];
        // The looks for pieces go side by side.
        let mut traced = Vec::with_capacity(ends);
        let like = |nodes: &[Node], height: f64| {
            let before = nodes.iter().rev().find_map(|node| node.as_ref().ok().cloned());
            before.unwrap_or_else(|| Rc::new(self.cover_slice(height)))
        };
        for number in 1..=ends {
            let height = height(number << DEPTH);
            let (node, outline) = self.traced_like(height, &like(&nodes, height));
            nodes.push(node);
            traced.push(outline);
        }
        let (numbers, shapes): (Vec<usize>, Vec<Shape<'_>>) = (1..)
            .zip(&traced)
            .zip(&nodes[1..])
            .filter_map(|((number, traced), node)| {
                let (view, outline) = traced.as_ref()?;
                Some((number, self.shape(*view, outline, node.as_ref().ok()?)))
            })
            .unzip();
        let in_pieces = are_in_pieces(&self.tracer, &shapes);
        let Some(first) = numbers.into_iter().zip(in_pieces).find_map(|(number, is)| is.then_some(number))
        else {
            return nodes;
        };
        // What was sought from a pupil in pieces is sought from the one before that.
        nodes.truncate(first);
        nodes.push(Err(NoFan::InPieces));
        for number in first + 1..=ends {
            let height = height(number << DEPTH);
            nodes.push(self.slice_like(height, &like(&nodes, height)));
        }
        nodes
    }

    /// The map at a film radius, sought from one at another, with a look for other pieces.
    fn slice_like(&self, height: f64, like: &Slice) -> Node {
        let (node, outline) = self.traced_like(height, like);
        let (slice, (view, outline)) = (node?, outline.expect("a map has an outline"));
        let in_pieces = are_in_pieces(&self.tracer, &[self.shape(view, &outline, &slice)]);
        if in_pieces[0] { Err(NoFan::InPieces) } else { Ok(slice) }
    }

    /// The same without the look, and the outline.
    fn traced_like(&self, height: f64, like: &Slice) -> (Node, Option<(View<'_>, Outline)>) {
        match self.traced(&[self.expected_like(height, like)]).remove(0) {
            Ok((outline, slice, _)) => (Ok(slice), Some((self.view(height, like.width_scale()), outline))),
            Err(reason) => (Err(reason), None),
        }
    }

    fn shape<'b>(&'b self, view: View<'b>, outline: &'b Outline, slice: &Slice) -> Shape<'b> {
        Shape { view, outline, area: slice.area, cover: self.cover_at(view.height) }
    }

    fn expected_like<'b>(&self, height: f64, like: &'b Slice) -> Expected<'_, 'b> {
        let view = self.view(height, like.width_scale());
        // On the axis itself the direction in which the centre moves is not known.
        let shift = if like.height > 0.0 { like.center } else { self.shift };
        let around = [shift * height, self.cover_at(height).radius].map(|x| x / view.width_scale);
        Expected { view, around, like }
    }

    /// What is found at several film radii.
    fn traced(&self, expected: &[Expected<'_, '_>]) -> Vec<Result<Traced, NoFan>> {
        let mut inside = Vec::with_capacity(expected.len());
        let centers = expected.iter().map(|Expected { view, around, .. }| view.ray([around[0], 0.0]));
        self.tracer.excesses(centers, &mut inside);
        let inside: Vec<Option<f64>> = expected
            .iter()
            .zip(inside)
            .map(|(&Expected { view, around: [guess, reach], like }, at_guess)| {
                if at_guess.value < 0.0 {
                    return Some(guess);
                }
                let width = first_look(reach, like.area.sqrt() / view.width_scale);
                let near = view.innermost(guess, width, reach, true);
                let (inside, excess) = if near.1 < 0.0 { near } else { view.scanned(guess, reach, true) };
                (excess < 0.0).then_some(inside)
            })
            .collect();
        let mut guesses = Vec::with_capacity(expected.len());
        for (&Expected { view, like, .. }, &inside) in expected.iter().zip(&inside) {
            guesses.extend(inside.map(|inside| Guess { view, inside, points: self.half_lines(like) }));
        }
        let mut outlines = Outline::trace(self.finder(), &guesses).into_iter();
        let result = |(expected, inside): (&Expected<'_, '_>, Option<f64>)| {
            let outline = match inside {
                Some(_) => outlines.next().flatten().ok_or(NoFan::Shape),
                None => Err(NoFan::NoLight),
            };
            let outline =
                outline.map_err(|reason| if self.tracer.is_spent() { NoFan::Spent } else { reason })?;
            let (slice, places) = self.fit(&expected.view, &outline);
            Ok((outline, Rc::new(slice), places))
        };
        expected.iter().zip(inside).map(result).collect()
    }

    /// The pupil on the axis: a disk, if it is whole.
    fn axial_slice(&self) -> Result<Slice, NoFan> {
        const SCAN: u32 = 32;
        let view = self.view(0.0, 1.0);
        let reach = self.cover_at(0.0).radius;
        let passes = |from: f64, to: f64| {
            let place = |i: u32| (f64::from(i) + 0.5) / f64::from(SCAN);
            view.pass(&(0..SCAN).map(|i| [from + (to - from) * place(i), 0.0]).collect::<Vec<_>>())
        };
        if !(view.excess([0.0, 0.0]).value <= 0.0) {
            return Err(NoFan::NoLight);
        }
        // From far outside a search may end where rays are lost.
        let lit = passes(0.0, reach).iter().position(|passes| !passes);
        let radius = reach * lit.map_or(1.0, |dark| (dark as f64 + 0.5) / f64::from(SCAN));
        let guess = Crossing { radius, limit: Limit::Optics, steepness: 1.0 };
        let half_line = HalfLine { view: &view, center: 0.0, direction: [1.0, 0.0], guess };
        let edge = self.finder().crossings(std::iter::once(half_line))[0].ok_or(NoFan::Shape)?.radius;
        let beyond = BESIDE * edge;
        let hole = passes(0.0, edge).contains(&false);
        let ring = beyond < reach && passes(beyond, reach).contains(&true);
        if hole || ring { Err(NoFan::InPieces) } else { Ok(Slice::disk(0.0, 0.0, edge, true)) }
    }

    /// Angles and distances at which an outline that looks like `like` is traced.
    fn half_lines(&self, like: &Slice) -> Vec<(f64, f64)> {
        let points: Vec<(f64, f64)> = (0..=CELLS)
            .step_by(TRACE_EVERY)
            .map(|knot| {
                let [x, y] = like.point(knot, self.knots.directions[knot]);
                let angle = match knot {
                    0 => 0.0,
                    CELLS => std::f64::consts::PI,
                    _ => y.atan2(x),
                };
                (angle, (x * x + y * y).sqrt())
            })
            .collect();
        let rising = points.windows(2).all(|pair| pair[0].0 < pair[1].0);
        if rising {
            return points;
        }
        (0..=CELLS).step_by(TRACE_EVERY).map(|knot| (self.knots.angles[knot], points[0].1)).collect()
    }

    fn fit(&self, view: &View<'_>, outline: &Outline) -> (Slice, Box<Places>) {
        let crescent = (1.0 - (view.height / self.vanishing.get()).powi(2)).max(0.0).sqrt();
        Slice::fit(view, outline, &self.knots, crescent, self.axis_area.get())
    }

    /// Fills gaps, or halves them: between two maps until these predict the one in the middle, else until what has no map
    /// is narrowed down. The halves that are left.
    fn halve<H: Fn(usize) -> f64>(&self, gaps: Vec<Gap>, table: &mut Table<H>) -> Vec<Gap> {
        let gaps: Vec<Gap> = gaps.into_iter().filter_map(|gap| self.unless_done(gap, table)).collect();
        let middles: Vec<f64> =
            gaps.iter().map(|gap| (table.height)(usize::midpoint(gap.ends[0], gap.ends[1]))).collect();
        let like: Vec<Slice> =
            gaps.iter().zip(&middles).map(|(gap, &middle)| self.predicted(gap, middle)).collect();
        let expected: Vec<Expected<'_, '_>> = gaps
            .iter()
            .zip(&middles)
            .zip(&like)
            .map(|((gap, &middle), like)| {
                if let [Ok(_), Ok(_)] = gap.nodes {
                    let view = self.view(middle, like.width_scale());
                    let around = [like.center * middle / view.width_scale, like.factors[0][0].abs()];
                    Expected { view, around, like }
                } else {
                    self.expected_like(middle, like)
                }
            })
            .collect();
        let found = self.in_one_piece(&gaps, &expected, self.traced(&expected));
        let mut left = Vec::new();
        for ((gap, expected), found) in gaps.into_iter().zip(&expected).zip(found) {
            let Expected { view, like, .. } = expected;
            let Gap { ends: [from, to], nodes: [a, b] } = gap;
            let place = usize::midpoint(from, to);
            let middle = match (found, &a, &b) {
                (Ok((outline, slice, places)), Ok(a), Ok(b)) => {
                    if self.fits([from, to], [a, b], (&slice, like, &outline, &places), table) {
                        continue;
                    }
                    Ok(slice)
                }
                (Ok((_, slice, _)), ..) => Ok(slice),
                (Err(NoFan::InPieces), ..) => Err(NoFan::InPieces),
                (Err(_), Ok(a), Ok(b)) if b.area == 0.0 && a.area < SLIVER * self.axis_area.get() => {
                    table.intervals.push(last_sliver([from, to], a, b));
                    continue;
                }
                (Err(reason), Ok(a), Ok(b)) => {
                    // The prediction may be at fault.
                    let mut found = Err(reason);
                    for known in [a, b] {
                        if found.is_err() && known.area > 0.0 {
                            found = self.slice_like(view.height, known);
                        }
                    }
                    found
                }
                (Err(reason), ..) => Err(reason),
            };
            left.push(Gap { ends: [from, place], nodes: [a, middle.clone()] });
            left.push(Gap { ends: [place, to], nodes: [middle, b] });
        }
        left
    }

    /// What was found in the middles of gaps, but where the pupil is in pieces. Where both ends have maps only the middles of
    /// the widest are looked at, as their ends were.
    fn in_one_piece(
        &self,
        gaps: &[Gap],
        expected: &[Expected<'_, '_>],
        mut found: Vec<Result<Traced, NoFan>>,
    ) -> Vec<Result<Traced, NoFan>> {
        let is_looked_at = |Gap { ends: [from, to], nodes }: &Gap| {
            to - from == FINE / COARSE || nodes.iter().any(Result::is_err)
        };
        let (numbers, shapes): (Vec<usize>, Vec<Shape<'_>>) = gaps
            .iter()
            .zip(expected)
            .zip(&found)
            .enumerate()
            .filter_map(|(number, ((gap, expected), found))| {
                let (outline, slice, _) = found.as_ref().ok().filter(|_| is_looked_at(gap))?;
                Some((number, self.shape(expected.view, outline, slice)))
            })
            .unzip();
        let in_pieces = are_in_pieces(&self.tracer, &shapes);
        for (number, _) in numbers.into_iter().zip(in_pieces).filter(|&(_, is)| is) {
            found[number] = Err(NoFan::InPieces);
        }
        found
    }

    /// Fills a gap that is not to be halved.
    fn unless_done<H: Fn(usize) -> f64>(&self, gap: Gap, table: &mut Table<H>) -> Option<Gap> {
        let Gap { ends: [from, to], nodes } = &gap;
        let width = to - from;
        let reason = match nodes {
            [Ok(a), Ok(b)] if width == 1 => {
                let slices = [a.clone(), b.clone()];
                table.intervals.push(Interval { from: *from, to: *to, slices });
                return None;
            }
            _ if self.tracer.is_spent() => NoFan::Spent,
            [Err(reason), Err(_)] if width <= BLIND => *reason,
            [Err(reason), _] | [_, Err(reason)] if width == 1 => *reason,
            _ => return Some(gap),
        };
        self.cover(gap.ends, reason, table);
        None
    }

    /// What the middle of a gap is expected to look like.
    fn predicted(&self, gap: &Gap, middle: f64) -> Slice {
        match &gap.nodes {
            [Ok(a), Ok(b)] => a.toward(b, 0.5, middle),
            [Ok(known), _] | [_, Ok(known)] if known.area > 0.0 => Slice::clone(known),
            _ => self.cover_slice(middle),
        }
    }

    /// Fills an interval whose ends predict its middle well enough, or whose middle nothing predicts. Of the middle its map
    /// and what was predicted, its outline, and where on that the map's knots lie.
    fn fits<H: Fn(usize) -> f64>(
        &self,
        [from, to]: [usize; 2],
        [a, b]: [&Rc<Slice>; 2],
        (slice, predicted, outline, places): (&Rc<Slice>, &Slice, &Outline, &Places),
        table: &mut Table<H>,
    ) -> bool {
        let same_corners = a.corners == b.corners && a.corners == slice.corners;
        let part = if same_corners { AFTER_HALVING } else { WITH_NEW_CORNERS };
        let (missed, excess) = slice.misfit(predicted, outline, places, &self.knots, part);
        let good = missed <= MISSED && excess <= EXCESS.max(4.0 * slice.margin);
        if !good && (to - from > 2 || b.area == 0.0) {
            return false;
        }
        let place = usize::midpoint(from, to);
        // What the shape has too much where halves cannot be halved again.
        let mut blocked = if good { 0.0 } else { excess / (1.0 + excess) };
        if !good && missed > MISSED {
            // What the halves would miss is sampled with some that is blocked.
            let (growth, outside) = slice.growth(predicted, outline, places, &self.knots, part);
            let most = growth.iter().copied().fold(0.0, f64::max);
            if most <= MOST_GROWTH {
                for place in [from, place, to] {
                    let all = table.growth.entry(place).or_insert_with(|| vec![0.0; CELLS + 1]);
                    // The same all around on the axis, across which the map is continuous.
                    let around = if place == 0 { most } else { 0.0 };
                    all.iter_mut().zip(&growth).for_each(|(all, new)| *all = new.max(*all).max(around));
                }
                blocked = outside.max(blocked);
            } else if missed > MISSED_AT_LAST {
                self.cover([from, to], NoFan::Shape, table);
                return true;
            }
        }
        if blocked > UNNAMED.max(2.0 * slice.margin) {
            let radii = [from, to].map(&table.height);
            table.given_up.push(GivenUp { radii, reason: NoFan::Fast, acceptance: 1.0 - blocked });
        }
        table.intervals.push(Interval { from, to: place, slices: [a.clone(), slice.clone()] });
        table.intervals.push(Interval { from: place, to, slices: [slice.clone(), b.clone()] });
        true
    }
}

/// The last interval before the pupil vanishes, where nothing was found within: a map that keeps half its size covers what
/// does not shrink evenly.
fn last_sliver([from, to]: [usize; 2], a: &Rc<Slice>, b: &Slice) -> Interval {
    let mut end = b.clone();
    end.factors = a.factors.iter().map(|m| m.map(|x| x / 2.0)).collect();
    Interval { from, to, slices: [a.clone(), Rc::new(end)] }
}

/// C/h and the narrowing on the axis, where they cannot be measured: even in h, so by extrapolation in h² from the next two
/// slices.
fn center_on_axis(intervals: &mut [Interval]) {
    let [first, second, ..] = intervals else { return };
    let [axis, one] = &mut first.slices;
    let axis = Rc::make_mut(axis);
    let two = &second.slices[1];
    if axis.fitted && one.fitted && two.fitted {
        let (h1, h2) = (one.height * one.height, two.height * two.height);
        let on_axis = |one: f64, two: f64| one - (two - one) * h1 / (h2 - h1);
        // A pupil is narrowed, never widened.
        (axis.center, axis.narrowing) =
            (on_axis(one.center, two.center), on_axis(one.narrowing, two.narrowing).max(0.0));
    } else {
        (axis.center, axis.narrowing) = (one.center, one.narrowing);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        imaging::focus::Focus,
        lens::{Lens, first_order::FirstOrder},
        prescription::catalogue,
    };

    #[test]
    fn no_slice_is_narrowed_to_nothing_or_stretched() {
        for name in catalogue::names() {
            for stop in [1.0, 0.5, 0.1, 0.01] {
                let mut lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
                let stop_index = lens.stop_index().expect("a stop");
                lens.surfaces[stop_index].semi_diameter *= stop;
                let focus = Focus::new(&lens).expect("focal");
                let film = lens.rear().vertex - focus.film_distance(f64::INFINITY).expect("reachable");
                let path = Path::film_to_scene(&lens);
                // Beyond the image circle of each.
                let reach = FirstOrder::of(&lens).expect("focal").focal_length.max(100.0);
                let cover = PupilDisk::rear(&lens, film, reach).expect("behind the lens");
                let shift = PupilDisk::exit(&lens, film).seen_from([1.0, 0.0]).center[0];
                let Layout { dark_beyond, intervals, .. } =
                    Builder::new(&path, film, reach, cover, shift).layout();
                // The images of the widest end in crescents, of which warnings tell.
                let ends = !["fisheye.16mm", "fisheye.6mm"].contains(&name);
                assert!(dark_beyond || !ends, "{name} {stop}");
                for slice in intervals.iter().flat_map(|interval| &interval.slices) {
                    let narrowed = slice.narrowing >= 0.0 && slice.width_scale() > 0.0;
                    assert!(narrowed, "{name} {stop} at {}: {}", slice.height, slice.narrowing);
                }
            }
        }
    }
}
