//! Builds the table: a path and the film's place in; maps of outlines out, at as many film radii as it takes for the ones between
//! to be interpolated. The *first row* is the pupil's extent on the meridian, which `follow` takes outward.
//!
//! ```text
//! follow the first row outward to the image's end or the film's
//! from the axis on, with steps that are twice as wide after each that was easy:
//!     find the outline there, each edge expected where the outlines before lead
//!     see how far the outline before lies outside the map interpolated over it, from the one before that to this one, and count
//!     a part of that where an edge only bends; if it is too much, or there is no outline, try again with half the step
//! make each map larger by what was counted
//! ```
//!
//! What lies between two slices is held by that last step. Where an edge has a kink anywhere between them, the line past the slice
//! from neighbour to neighbour is as far off there as it is anywhere between; where it bends, four times as far. Which of the two it
//! is, is told by the apertures that limit it. And what is no line (γ) is checked over twice the way, where it is off by more.

use std::{collections::BTreeMap, sync::OnceLock};

use super::{
    components::has_components,
    follow::{Trail, half_disk},
    outline::{Frame, HALF_LINES, Outline, first_row},
    pencil::{Family, Limit, Pencil},
    report::{GivenUp, MapFailure},
    slice::{KNOTS, Knots, MARGIN, Slice, growth},
    threads::made_of_each,
};
use crate::lens::pupil::SlopeDisk;

/// Smallest intervals of film radius: more follow jumps closer, and make the table of cells larger.
pub(crate) const FINE: usize = 1024;
/// The widest, and the first: narrower ones take more rays, wider ones may lose the way.
const COARSE: usize = FINE / 8;
/// The part of what may lie outside below which the next step is twice as wide: at kinks it goes with the step, at bends with its
/// square. Less takes more slices, more tries more that are too far.
const EASY: f64 = 0.5;
/// A kink in an interval twice as wide as the next is off by so much more than the line past the slice between them:
/// (w₁ + w₂)/(2 min(w₁, w₂)).
const UNEVEN: f64 = 1.5;
/// What of that a bend counts, which between two slices is off by a quarter as long as it does not change: less misses light where it
/// does, more takes more slices.
const BENDS: f64 = 0.35;
/// Outlines by which the next is expected: more follow curves closer, and kinks worse.
const EXPECTED_BY: usize = 3;
/// Share of the samples that may be blocked at a slice without a word.
const UNNAMED: f64 = 0.01;
/// Sixteen roundings of the table's numbers: a pupil whose radius on the axis is less of how far its centre moves over the
/// film cannot be followed, and τ is no less where a pupil vanishes, for rounding would make a negative density of it.
const ROUNDINGS: f64 = 8.0 * f32::EPSILON as f64;

/// What the table is built from.
pub(crate) struct Builder<F> {
    pub side: F,
    /// Whether what is given up is named, with the share of samples that get through, which takes some hundred rays for each.
    names: bool,
    knots: Knots,
    /// The first row, once it has been followed.
    trail: OnceLock<Option<Trail>>,
}

/// A stretch of film radius between two slices.
pub(crate) struct Interval {
    /// In units of the smallest interval.
    pub from: usize,
    pub to: usize,
    pub slices: [Slice; 2],
}

impl Interval {
    /// Its cells, each of so many smallest intervals.
    pub fn cells(&self, grain: usize) -> usize {
        (self.to - self.from) / grain
    }
}

/// Everything that the table keeps.
pub(crate) struct Layout {
    pub scale: Scale,
    pub intervals: Vec<Interval>,
    pub given_up: Vec<GivenUp>,
}

impl Layout {
    /// The map at s, from 0 at the axis to 1 at the end.
    pub fn slice(&self, s: f64) -> Slice {
        let Interval { from, to, slices: [low, high] } = self.interval(s);
        let part = (FINE as f64 * s - *from as f64) / (to - from) as f64;
        low.toward(high, part, self.scale.at(s))
    }

    /// C/h there.
    pub fn center(&self, s: f64) -> f64 {
        let [low, high] = &self.interval(s).slices;
        low.center_toward(high, self.scale.at(s))
    }

    fn interval(&self, s: f64) -> &Interval {
        let next = self.intervals.partition_point(|interval| interval.to as f64 <= FINE as f64 * s);
        &self.intervals[next.min(self.intervals.len() - 1)]
    }

    /// The same over h in units of its end, with maps larger by a margin, relative.
    pub fn in_units_of_its_end(mut self, margin: f64) -> Self {
        for slice in self.intervals.iter_mut().flat_map(|interval| &mut interval.slices) {
            *slice = slice.in_units_of(self.scale.end);
            slice.grow(&[0.0; KNOTS], margin);
        }
        self.scale.end = 1.0;
        self
    }
}

/// The scale of film radius.
#[derive(Clone, Copy)]
pub(crate) struct Scale {
    /// Film radius at the table's end, mm.
    pub end: f64,
    /// Whether no light reaches the film beyond the end.
    pub dark_beyond: bool,
    /// Whether the pupil shrinks to nothing toward the end.
    vanishes: bool,
}

impl Scale {
    /// The film radius of a number of smallest intervals: even, or ever denser toward the image's end, where pupils shrink as
    /// the root of what is left.
    fn height(&self, place: usize) -> f64 {
        self.at(place as f64 / FINE as f64)
    }

    /// The smallest intervals up to h.
    fn place(&self, height: f64) -> f64 {
        let part = (height / self.end).min(1.0);
        FINE as f64 * if self.dark_beyond { 1.0 - (1.0 - part).sqrt() } else { part }
    }

    /// h at s.
    fn at(&self, s: f64) -> f64 {
        self.end * if self.dark_beyond { s * (2.0 - s) } else { s }
    }

    /// What heights of pupils shrink by toward the image's end, about.
    fn shrunk(&self, place: usize) -> f64 {
        if self.vanishes { (FINE - place) as f64 / FINE as f64 } else { 1.0 }
    }

    /// 1 - h²/H², twice the square of that near the end.
    fn crescent(&self, place: usize) -> f64 {
        if self.vanishes { 1.0 - (self.height(place) / self.end).powi(2) } else { 1.0 }
    }
}

impl<F: Family> Builder<F> {
    /// For tables of a stack.
    pub fn new(side: F) -> Self {
        Self { side, names: false, knots: Knots::new(), trail: OnceLock::new() }
    }

    /// For a table that tells what it gives up.
    pub fn naming(side: F) -> Self {
        Self { names: true, ..Self::new(side) }
    }

    /// Disks that hold the pupils of a stretch of smallest intervals.
    fn cover_intervals(&self, scale: Scale, from: usize, to: usize) -> Vec<Interval> {
        let mut intervals = Vec::new();
        let mut from = from;
        while from < to {
            let width = widest(from).min(1 << (to - from).ilog2());
            let slices = [from, from + width].map(|place| self.cover_slice(scale.height(place)));
            intervals.push(Interval { from, to: from + width, slices });
            from += width;
        }
        intervals
    }

    fn cover_slice(&self, height: f64) -> Slice {
        // On the axis as hardly beside it.
        let beside = height.max(1e-6 * self.side.reach());
        let SlopeDisk { center: [center, _], radius } = self.side.cover(beside);
        Slice::disk(height, center / beside, radius, false)
    }

    pub fn layout(&self) -> Layout {
        self.march().map_or_else(|reason| self.covered(reason), |march| march.layout(&[]))
    }

    /// The first row; `None` where no light gets through on the axis.
    fn trail(&self) -> Option<&Trail> {
        self.trail.get_or_init(|| Trail::new(&self.side)).as_ref()
    }

    /// Whether the image ends within reach, or hardly beyond.
    pub fn ends(&self) -> bool {
        self.trail().is_some_and(|trail| trail.end.is_some())
    }

    /// Looks at every pencil.
    fn march(&self) -> Result<March<'_, F>, MapFailure> {
        let side = &self.side;
        let trail = self.trail().cloned().ok_or(MapFailure::NoLight)?;
        // No farther than the rear element is wide, however large the film.
        let moved = (side.shift() * side.reach()).abs().min(side.cover(0.0).radius);
        if trail.axial_radius() < ROUNDINGS * moved {
            return Err(MapFailure::TooNarrow);
        }
        let vanishes = trail.end.is_some();
        let end = trail.end.unwrap_or(side.reach());
        let scale = Scale { end, dark_beyond: vanishes || F::ENDS, vanishes };
        let mut march = March {
            builder: self,
            trail,
            scale,
            tried: BTreeMap::new(),
            runs: Vec::new(),
            components: Vec::new(),
        };
        march.outward();
        Ok(march)
    }

    /// Gives everything up.
    fn covered(&self, reason: MapFailure) -> Layout {
        let radii = [0.0, self.side.reach()];
        let slices = radii.map(|height| self.cover_slice(height));
        let given_up = |reason| {
            let acceptance = self.cover_acceptance(self.side.reach() / 2.0);
            GivenUp { radii, reason, acceptance }
        };
        Layout {
            scale: Scale { end: self.side.reach(), dark_beyond: false, vanishes: false },
            intervals: vec![Interval { from: 0, to: FINE, slices }],
            given_up: self.names.then(|| given_up(reason)).into_iter().collect(),
        }
    }

    /// Share of the cover's disk that gets through, by a grid.
    fn cover_acceptance(&self, height: f64) -> f64 {
        let points = half_disk(28, self.side.cover(height));
        self.share_through(height, &points)
    }
}

/// The widest interval from a place on: at a multiple of its width, a power of two.
fn widest(from: usize) -> usize {
    if from == 0 { COARSE } else { COARSE.min(1 << from.trailing_zeros()) }
}

/// What was found at a film radius.
#[derive(Clone)]
struct Node {
    place: usize,
    slice: Slice,
    /// None where the pupil has vanished.
    outline: Option<Outline>,
    /// What limits that along each half-line and those beside.
    limits: Vec<Option<Limit>>,
    /// By how much more the map is to be made larger for what lies between it and those beside, once they are known.
    growth: Vec<f64>,
}

impl Node {
    /// The map interpolated from the two beside it.
    fn interpolated(&self, before: &Self, next: &Self) -> Slice {
        let part = (self.place - before.place) as f64 / (next.place - before.place) as f64;
        before.slice.toward(&next.slice, part, self.slice.height)
    }

    /// Whether one aperture limits it and two others about a half-line.
    fn is_limited_as(&self, others: [&Self; 2], k: usize) -> bool {
        let is_aperture = matches!(self.limits[k], Some(Limit::Aperture(_)));
        is_aperture && others.iter().all(|other| other.limits.get(k) == Some(&self.limits[k]))
    }
}

/// The way outward.
struct March<'a, F> {
    builder: &'a Builder<F>,
    trail: Trail,
    scale: Scale,
    /// Nodes found too far out, for later.
    tried: BTreeMap<usize, Node>,
    /// Runs of nodes, between which nothing was found.
    runs: Vec<Vec<Node>>,
    /// Places at which pupils are in components.
    components: Vec<usize>,
}

impl<F: Family> March<'_, F> {
    fn outward(&mut self) {
        let axis = self.axis();
        self.runs.push(vec![axis]);
        // Steps get no wider again before where one was too wide.
        let (mut step, mut reached) = (COARSE, 0);
        let loose = self.builder.side.loose();
        let mut looked = None;
        loop {
            let last = self.last().place;
            if last.is_multiple_of(COARSE) && last < FINE && looked.is_none_or(|looked| last > looked) {
                looked = Some(last);
                if self.are_components(self.last()) {
                    let Some(next) = self.pass_components() else { return };
                    // The first step from there is not checked, so it is the narrowest.
                    (looked, step) = (Some(next), self.finest());
                    continue;
                }
            }
            // On film that is lit to its end one more tells what the last interval holds.
            let is_done = if self.scale.dark_beyond { last == FINE } else { last > FINE };
            if is_done || self.builder.side.work().is_spent() {
                return;
            }
            step = step.min(widest(last));
            let node = self.node(last + step);
            let outside = node.as_ref().map(|node| self.outside(node));
            let differing = outside.as_deref().map_or(f64::INFINITY, share);
            match node {
                Some(node) if differing <= loose || step <= self.finest() => {
                    let may_double = step < COARSE && node.place % (2 * step) == 0 && node.place >= reached;
                    if (differing <= EASY * loose || step < self.finest()) && may_double {
                        step *= 2;
                    }
                    self.take(node, &outside.unwrap_or_default());
                }
                None if step <= self.finest() => match self.anew(last) {
                    Some(node) => self.runs.push(vec![node]),
                    None => return,
                },
                node => {
                    self.tried.extend(node.map(|node| (node.place, node)));
                    step /= 2;
                    // Neighbours stay within a factor of two: what is found at one end of an interval speaks for all of it.
                    while let [.., before, last] = self.run()
                        && last.place - before.place > 2 * step
                    {
                        (step, reached) = ((last.place - before.place) / 2, reached.max(last.place));
                        self.step_back();
                    }
                }
            }
        }
    }

    /// Whether a pupil is in components.
    fn are_components(&self, node: &Node) -> bool {
        let Some(outline) = node.outline.as_ref().filter(|_| self.builder.side.probes_components()) else {
            return false;
        };
        has_components(&self.pencil(node.place), outline, self.builder.side.cover(node.slice.height))
    }

    /// Gives up what lies about the last pupil, which is in components: back to where that begins in its run, from the last look on,
    /// and on to the next look at one that is not; its place, if there is one.
    fn pass_components(&mut self) -> Option<usize> {
        let run = self.run();
        let found = self.last().place;
        let looked = run.partition_point(|node| node.place + COARSE <= found);
        let whole =
            looked + run[looked..].partition_point(|node| node.place < found && !self.are_components(node));
        let (last, earlier) = self.runs.split_last_mut().expect("there is a run");
        last.truncate(whole);
        for run in earlier {
            run.retain(|node| node.place + COARSE <= found);
        }
        self.runs.retain(|run| !run.is_empty());
        self.components.push(found);
        // Outward by whole looks, not by halving: where pieces have just come together a look may miss one.
        let mut next = (found + COARSE..FINE).step_by(COARSE).filter_map(|place| self.anew_at(place));
        let next = next.find(|node| !self.are_components(node))?;
        let place = next.place;
        self.runs.push(vec![next]);
        Some(place)
    }

    /// The narrowest step: wider when the rays get short, for a loose map is better than none.
    fn finest(&self) -> usize {
        if self.builder.side.work().is_short() { COARSE } else { self.builder.side.finest() }
    }

    /// Takes the last node back, for later.
    fn step_back(&mut self) {
        let last = self.runs.last_mut().and_then(Vec::pop).expect("a run has a node");
        self.tried.insert(last.place, last);
    }

    fn last(&self) -> &Node {
        self.run().last().expect("a run has a node")
    }

    fn run(&self) -> &[Node] {
        self.runs.last().expect("there is a run")
    }

    /// Goes on to a node, by which it is known what lies outside the last map between those beside it.
    fn take(&mut self, node: Node, outside: &[(usize, f64)]) {
        let run = self.runs.last_mut().expect("there is a run");
        let last = run.last_mut().expect("a run has a node");
        last.growth = growth(outside);
        if last.place == 0 {
            // On both sides of it the next map lies.
            let most = last.growth.iter().copied().fold(0.0, f64::max);
            last.growth.fill(most);
        }
        if let [axis @ Node { place: 0, .. }] = run.as_mut_slice() {
            let Slice { center, narrowing, bow, .. } = node.slice;
            axis.slice = Slice { center, narrowing, bow, ..axis.slice.clone() };
        }
        run.push(node);
    }

    /// The pupil on the axis, a disk.
    fn axis(&self) -> Node {
        let radius = self.trail.axial_radius();
        let frame = Frame::round([-radius, radius]);
        let slice = Slice::disk(0.0, 0.0, radius * (1.0 + MARGIN), true);
        let outline = Outline::ellipse(frame);
        let limits = outline.limits();
        Node { place: 0, slice, outline: Some(outline), limits, growth: Vec::new() }
    }

    /// The pupil at a place, expected to be as the last ones lead to.
    fn node(&mut self, place: usize) -> Option<Node> {
        if let Some(node) = self.tried.remove(&place) {
            return Some(node);
        }
        if self.scale.vanishes && place == FINE {
            return Some(self.vanished());
        }
        // The last ones, and the weights by which the polynomial through them goes on to here.
        let run = self.run();
        let before = &run[run.len().saturating_sub(EXPECTED_BY)..];
        let weight = |own: &Node| {
            let others = before.iter().filter(|other| other.place != own.place);
            let of = |from: usize, to: usize| to as f64 - from as f64;
            others.map(|other| of(other.place, place) / of(other.place, own.place)).product()
        };
        let known: Vec<(&Outline, f64, f64)> = before
            .iter()
            .filter_map(|node| Some((node.outline.as_ref()?, weight(node), self.scale.shrunk(node.place))))
            .collect();
        let (pencil, row) = self.with_row(place)?;
        let expected = Outline::expected(&known, row, self.scale.shrunk(place));
        let mut outline = Outline::trace(&pencil, &expected)?;
        if outline.is_askew() {
            outline = outline.found_again(&pencil)?;
        }
        Some(self.known(place, outline))
    }

    fn pencil(&self, place: usize) -> impl Pencil + '_ {
        self.builder.side.pencil(self.scale.height(place))
    }

    /// A pencil and its first row.
    fn with_row(&self, place: usize) -> Option<(impl Pencil + '_, [f64; 2])> {
        let pencil = self.pencil(place);
        let row = first_row(&pencil, self.trail.at(self.scale.height(place)))?;
        Some((pencil, row))
    }

    /// The next pupil beyond a place that is found without others to go by.
    fn anew(&self, place: usize) -> Option<Node> {
        let farther = |k: u32| place + (1 << k);
        (0..).map(farther).take_while(|&place| place < FINE).find_map(|place| self.anew_at(place))
    }

    fn anew_at(&self, place: usize) -> Option<Node> {
        let (pencil, row) = self.with_row(place)?;
        let rough = Outline::trace(&pencil, &Outline::ellipse(Frame::round(row)))?;
        Some(self.known(place, rough.found_again(&pencil)?))
    }

    /// An outline with its map.
    fn known(&self, place: usize, mut outline: Outline) -> Node {
        let corners = outline.clone();
        let limits = outline.limits();
        outline.hold_corners(&limits);
        let fitting = outline.fitting;
        let (width, bow) = if self.scale.dark_beyond {
            // On film that is all but infinite a crescent has no width in doubles.
            let width = (fitting.width / fitting.height).max(self.scale.crescent(place).powi(2)).min(1.0);
            // Where nothing is narrowed nothing is bent.
            (width, (1.0 - width) * fitting.bow)
        } else {
            (1.0, 0.0)
        };
        let (height, left) = (self.scale.height(place), self.scale.shrunk(place));
        let slice = Slice::fit(&outline, height, left, [width, bow], &self.builder.knots);
        Node { place, slice, outline: Some(corners), limits, growth: Vec::new() }
    }

    /// The end of the image, where nothing is left of the width. Of the height nothing is left, either, but that a crescent's tips
    /// may come together faster than the narrowest step tells: then it is as the last two maps lead to.
    fn vanished(&self) -> Node {
        let height = self.scale.end;
        let [low, high] = self.trail.at(height);
        let center = f64::midpoint(low, high) / height;
        // Narrowed to almost nothing.
        let narrowing = (1.0 - ROUNDINGS) / (height * height);
        let part = match self.run() {
            [.., before, last] if FINE - last.place <= self.builder.side.finest() => {
                let part = (FINE - last.place) as f64 / (last.place - before.place) as f64;
                last.slice.height_beyond(&before.slice, part)
            }
            _ => 0.0,
        };
        let slice = Slice { height, center, narrowing, left: 0.0, ..self.last().slice.scaled(part) };
        Node { place: FINE, slice, outline: None, limits: Vec::new(), growth: Vec::new() }
    }

    /// How far the last outline counts as outside the map that is interpolated over it, from the one before to the next, along each
    /// half-line, relative (below 0 it is inside), and the first of the two knots beside.
    fn outside(&self, next: &Node) -> Vec<(usize, f64)> {
        let knots = &self.builder.knots;
        let (own, before, interpolated) = match self.run() {
            [.., before, own] => (own, before, own.interpolated(before, next)),
            // Beyond the axis the next one lies, too.
            [axis] if axis.place == 0 => (axis, next, next.slice.about_axis(knots)),
            _ => return Vec::new(),
        };
        let outline = own.outline.as_ref().expect("nothing comes after where the pupil has vanished");
        let mut outside = interpolated.outside(outline, knots);
        // What of that is a bend: all where one aperture limits the three; beside those half-lines as much as theirs, if that is
        // inward, for it hides a part of a kink. Two passes carry it there from both sides.
        let mut bends = vec![0.0_f64; outside.len()];
        let mut beside = 0.0_f64;
        for k in (0..outside.len()).chain((0..outside.len()).rev()) {
            if own.is_limited_as([before, next], k) {
                beside = outside[k].1;
                bends[k] = beside;
            } else {
                bends[k] = bends[k].min(beside);
            }
        }
        // Between unequal intervals the line past the slice is nearer to it than what the wider one may hold.
        let is_even = before.place == next.place || 2 * own.place == before.place + next.place;
        let uneven = if is_even { 1.0 } else { UNEVEN };
        for (k, (_, more)) in outside.iter_mut().enumerate() {
            *more = uneven * (*more - (1.0 - BENDS) * bends[k]);
            // The corners of the maps beside are held, and lie outside.
            if own.limits[k].is_none() {
                *more = more.max(0.0);
            }
        }
        outside
    }

    /// By how much maps are to be made larger for what lies between this table and those beside it.
    fn between(&self, before: &Self, next: &Self, part: f64, course: Course) -> Vec<Growth> {
        let [from, to] = [before, next].map(|march| march.scale.end);
        let end = match course {
            Course::Straight => from + part * (to - from),
            Course::Curved => self.scale.end,
        };
        let at = |node: &Node| {
            let outline = node.outline.as_ref()?;
            let height = self.scale.height(node.place) / end;
            let [low, high] = [before, next].map(|march| march.slice(height * march.scale.end));
            let slice = low?.across(&high?, part, [from, to]);
            let mut slice = Slice { height, ..slice }.in_units_of(end.recip());
            if course == Course::Curved && self.scale.dark_beyond {
                slice.center = node.slice.center;
            }
            let growth = growth(&slice.outside(outline, &self.builder.knots));
            Some((node.place, growth.into_iter().map(|more| more.min(1.0)).collect()))
        };
        self.runs.iter().flatten().filter_map(at).collect()
    }

    /// The map that the table will have at h, as far as it is known.
    fn slice(&self, height: f64) -> Option<Slice> {
        let place = self.scale.place(height);
        let run = self.runs.iter().find(|run| place <= run[run.len() - 1].place as f64)?;
        let next = run.partition_point(|node| (node.place as f64) < place).max(1);
        let [before, next] = [run.get(next - 1)?, run.get(next)?];
        let part = (place - before.place as f64) / (next.place - before.place) as f64;
        (part >= 0.0).then(|| before.slice.toward(&next.slice, part, height))
    }

    /// Everything found, as intervals with maps that hold what lies between.
    fn layout(self, between: &[Growth]) -> Layout {
        let Self { builder, scale, runs, components, .. } = self;
        let (mut intervals, mut given_up) = (Vec::new(), Vec::new());
        let starts = runs.first().is_some_and(|run| run[0].place == 0);
        let mut covered_from = (!starts).then_some(0);
        let cover = |from: usize, to: usize, intervals: &mut Vec<Interval>, given_up: &mut Vec<GivenUp>| {
            intervals.extend(builder.cover_intervals(scale, from, to));
            if !builder.names {
                return;
            }
            let radii = [from, to].map(|place| scale.height(place));
            let acceptance = builder.cover_acceptance(f64::midpoint(radii[0], radii[1]));
            let reason = if components.iter().any(|place| (from..=to).contains(place)) {
                MapFailure::Components
            } else if to == FINE && builder.side.work().is_spent() {
                MapFailure::RaysSpent
            } else if acceptance > 0.0 {
                MapFailure::NotStarShaped
            } else {
                MapFailure::NoLight
            };
            given_up.push(GivenUp { radii, reason, acceptance });
        };
        for mut run in runs {
            if let Some(from) = covered_from.replace(run[run.len() - 1].place) {
                cover(from, run[0].place, &mut intervals, &mut given_up);
            }
            // At the end as beside it, where nothing beyond has told.
            if let [.., before, last] = run.as_mut_slice()
                && last.growth.is_empty()
            {
                last.growth.clone_from(&before.growth);
            }
            for node in &mut run {
                node.slice.grow(&node.growth, 0.0);
                if let Some((_, growth)) = between.iter().min_by_key(|(place, _)| place.abs_diff(node.place))
                {
                    node.slice.grow(growth, 0.0);
                }
            }
            for pair in run.windows(2).filter(|pair| pair[0].place < FINE) {
                let [from, to] = [pair[0].place, pair[1].place];
                given_up.extend(builder.named(scale, pair));
                intervals.push(Interval { from, to, slices: [pair[0].slice.clone(), pair[1].slice.clone()] });
            }
        }
        if let Some(from) = covered_from.filter(|&from| from < FINE) {
            cover(from, FINE, &mut intervals, &mut given_up);
        }
        Layout { scale, intervals, given_up: joined(given_up) }
    }
}

/// By how much the map at a place is made larger at each knot.
type Growth = (usize, Vec<f64>);

/// How the end and C go from one table to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Course {
    Straight,
    /// Where images end as a cubic, by second differences, for tables that lie evenly: as if they were known in between.
    Curved,
}

/// Tables for one after the other of the places of a second parameter.
pub(crate) struct Layouts {
    pub tables: Vec<Layout>,
    pub(super) course: Course,
}

/// The tables of families at places of a second parameter, `at`, up to one that nothing is known of. They hold what lies
/// between: each map is made larger by what its outline lies outside the map interpolated from the tables beside. Of an edge
/// that curves a quarter would do, of one with a kink there all of it is needed.
pub(crate) fn alike<F: Family + Sync>(builders: &[Builder<F>], at: &[f64], course: Course) -> Layouts {
    let marches = made_of_each(builders, |builder| builder.march().ok());
    let marches: Vec<March<'_, F>> = marches.into_iter().map_while(|march| march).collect();
    let beside: Vec<_> = marches.windows(3).zip(at.windows(3)).collect();
    let growths: Vec<Vec<Growth>> = made_of_each(&beside, |(marches, at)| {
        let [before, own, next] = marches else { unreachable!("windows of three") };
        own.between(before, next, (at[1] - at[0]) / (at[2] - at[0]), course)
    });
    // At the ends as beside them.
    let of = |k: usize| growths.get(k.saturating_sub(1).min(growths.len().saturating_sub(1)));
    let layout = |(k, march): (usize, March<'_, F>)| march.layout(of(k).map_or(&[][..], Vec::as_slice));
    Layouts { tables: marches.into_iter().enumerate().map(layout).collect(), course }
}

/// Gives up in every table what is given up in one of them: between a disk and a pupil lies no map that holds the pupils in
/// between.
pub(crate) fn cover_alike<F: Family>(layouts: &mut [Layout], builders: &[Builder<F>]) {
    let mut is_covered = [false; FINE];
    let mut known = usize::MAX;
    // Until no interval is given up in part.
    while known != is_covered.iter().filter(|covered| **covered).count() {
        known = is_covered.iter().filter(|covered| **covered).count();
        for Interval { from, to, slices } in layouts.iter().flat_map(|layout| &layout.intervals) {
            let cells = &mut is_covered[*from..*to];
            if !slices[0].fitted || cells.contains(&true) {
                cells.fill(true);
            }
        }
    }
    for (layout, builder) in layouts.iter_mut().zip(builders) {
        let scale = layout.scale;
        layout.intervals.retain(|interval| !is_covered[interval.from]);
        let mut from = 0;
        for cells in is_covered.chunk_by(|a, b| a == b) {
            let to = from + cells.len();
            if cells[0] {
                layout.intervals.extend(builder.cover_intervals(scale, from, to));
            }
            from = to;
        }
        layout.intervals.sort_by_key(|interval| interval.from);
    }
}

/// The share of the area that lies so far outside a map, or inside, along its half-lines.
fn share(outside: &[(usize, f64)]) -> f64 {
    2.0 * outside.iter().map(|(_, more)| more.abs()).sum::<f64>() / (HALF_LINES + 1) as f64
}

impl<F: Family> Builder<F> {
    /// Names a ring where too many samples are blocked.
    fn named(&self, scale: Scale, pair: &[Node]) -> Option<GivenUp> {
        if !self.names {
            return None;
        }
        let passing = |node: &Node| {
            let outline = node.outline.as_ref();
            outline.map_or(1.0, |outline| outline.area() / node.slice.area(&self.knots))
        };
        let at_ends = passing(&pair[0]).min(passing(&pair[1]));
        if at_ends >= 1.0 - UNNAMED {
            return None;
        }
        let places = [pair[0].place, pair[1].place];
        let radii = places.map(|place| scale.height(place));
        let s = (places[0] + places[1]) as f64 / (2 * FINE) as f64;
        let between = pair[0].slice.toward(&pair[1].slice, 0.5, scale.at(s));
        let acceptance = self.acceptance(&between).unwrap_or(1.0).min(at_ends);
        let reason = MapFailure::TooFast;
        Some(GivenUp { radii, reason, acceptance })
    }

    /// Share of a map's samples that get through, by some of them; `None` where there is nothing left.
    fn acceptance(&self, slice: &Slice) -> Option<f64> {
        let points = slice.samples(&self.knots);
        if slice.area(&self.knots) == 0.0 {
            return None;
        }
        Some(self.share_through(slice.height, &points))
    }

    /// Share of a pencil's rays that get through.
    fn share_through(&self, height: f64, points: &[[f64; 2]]) -> f64 {
        let excesses = self.side.pencil(height).excesses(points);
        excesses.iter().filter(|excess| excess.passes()).count() as f64 / points.len() as f64
    }
}

/// Rings side by side that are named for the same reason as one.
fn joined(given_up: Vec<GivenUp>) -> Vec<GivenUp> {
    let mut joined: Vec<GivenUp> = Vec::new();
    for ring in given_up {
        match joined.last_mut() {
            Some(last) if last.reason == ring.reason && last.radii[1] == ring.radii[0] => {
                last.radii[1] = ring.radii[1];
                last.acceptance = last.acceptance.min(ring.acceptance);
            }
            _ => joined.push(ring),
        }
    }
    joined
}

#[cfg(test)]
mod tests {
    use super::{
        super::pencil::{Excess, RayBudget},
        *,
    };
    use crate::{lens::Lens, prescription::catalogue, trace::Path};

    /// Two disks at h: the x of each one's centre, and its radius.
    type TwoDisks = fn(f64) -> [[f64; 2]; 2];

    /// Pupils that are what two disks have in common.
    struct Disks {
        at: TwoDisks,
        work: RayBudget,
    }

    struct Both([[f64; 2]; 2]);

    impl Pencil for Both {
        fn excesses(&self, points: &[[f64; 2]]) -> Vec<Excess> {
            let excess = |&[x, y]: &[f64; 2]| {
                let value = |[center, radius]: [f64; 2]| (x - center).hypot(y) / radius - 1.0;
                let [first, second] = self.0.map(value);
                let limit = Limit::Aperture(usize::from(second > first));
                Excess { value: first.max(second), limit, lost: false }
            };
            points.iter().map(excess).collect()
        }

        fn accuracy(&self) -> f64 {
            1e-5
        }

        fn is_spent(&self) -> bool {
            false
        }
    }

    impl Family for Disks {
        const ENDS: bool = false;

        fn loose(&self) -> f64 {
            4e-3
        }

        fn finest(&self) -> usize {
            1
        }

        fn pencil(&self, height: f64) -> impl Pencil + '_ {
            Both((self.at)(height))
        }

        fn cover(&self, _: f64) -> SlopeDisk {
            SlopeDisk { center: [0.0, 0.0], radius: 2.0 }
        }

        fn reach(&self) -> f64 {
            1.0
        }

        fn shift(&self) -> f64 {
            0.0
        }

        fn work(&self) -> &RayBudget {
            &self.work
        }
    }

    /// The shares of the area of pupils that lie outside their maps, and of maps outside their pupils: the most of many between slices.
    fn outside(at: TwoDisks) -> [f64; 2] {
        let lens = Lens::at_d_line(&catalogue::find("dgauss.50mm").expect("listed"));
        let work = RayBudget::new(&Path::film_to_scene(&lens));
        let layout = Builder::new(Disks { at, work }).layout();
        let knots = Knots::new();
        assert!(layout.intervals.iter().all(|interval| interval.slices[0].fitted));
        let shares = (1..500).map(|k| {
            let slice = layout.slice(f64::from(k) / 500.0);
            let both = at(slice.height);
            let low = both.map(|[center, radius]| center - radius);
            let high = both.map(|[center, radius]| center + radius);
            let frame = Frame::round([low[0].max(low[1]), high[0].min(high[1])]);
            let rough = Outline::trace(&Both(both), &Outline::ellipse(frame)).expect("not vanished");
            let outline = rough.found_again(&Both(both)).expect("still there");
            let outside = slice.outside(&outline, &knots);
            let beyond = |sign: f64| {
                share(&outside.iter().map(|&(knot, more)| (knot, (sign * more).max(0.0))).collect::<Vec<_>>())
            };
            [beyond(1.0), beyond(-1.0)]
        });
        shares.fold([0.0, 0.0], |most, own| [0, 1].map(|i| f64::max(most[i], own[i])))
    }

    #[test]
    fn maps_between_slices_hold_the_pupil_and_are_hardly_larger() {
        let families: [TwoDisks; 4] = [
            // A second aperture begins to cut, while the first goes on as it was,
            |h| [[0.0, 1.0], [0.9 * h, 1.2]],
            // shrinks ever more slowly, which hides a kink,
            |h| [[0.0, (1.0 + h).powi(-2)], [0.75 * h, 1.05]],
            // or ever faster.
            |h| [[0.0, 1.0 - 0.5 * h * h], [0.7 * h, 1.1]],
            // To the end of the image, through crescents.
            |h| [[0.0, 1.0], [2.5 * h, 1.2]],
        ];
        for (number, at) in families.into_iter().enumerate() {
            let [missed, blocked] = outside(at);
            assert!(missed < 1e-5, "family {number} misses {missed}");
            assert!(blocked < 6e-3, "family {number} blocks {blocked}");
        }
    }
}
