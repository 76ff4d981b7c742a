//! The pupil of a lens as points of the scene see it: points in, directions toward the lens and their densities out.
//!
//! A point P of the scene, as a point E of the axis sees it, lies at the angle θ to the axis and sees the lens through the
//! plane across PE at E, by the points of which its rays are named ([`SeenPoint`]). Those that get through make a figure that is
//! symmetric about the plane of P and the axis: what a film point's pupil is in slopes. So the same map takes the unit disk
//! to it ([`crate::sampling::warped`]), with
//!
//! ```text
//! h = tan(θ/2)     in the place of the film radius, without an angle's arc tangent, up to where no light gets through;
//! n = D(θ)/|PE|    in the place of the wavelength, 0 infinitely far away, and 1 on the glass, D(θ) away from E.
//! ```
//!
//! Of a pupil only what lands on film is sampled ([`CutPupil`]). What blades cover is blocked.

use super::{
    block::{Columns, Rays, Step, load, store},
    front::Front,
    seen_point::{OneSeenPoint, SeenPoint},
};
use crate::{
    lens::{Ray, pupil::SlopeDisk},
    numeric::{dot, on_broken_line},
    sampling::{
        PupilDisk,
        warped::{
            Builder, Course, CutPupil, Excess, Family, Knots, Landing, LanePupil, Layout, Pencil, Query,
            RayBudget, Stack, alike, made_of_each,
        },
    },
    trace::{
        Path,
        kernel::{Available, Clearance, ClearanceTracer, Cpu, Lanes, LensRays, OneLane, Portable},
    },
};

/// Intervals between rows of one nearness each: more take longer to build; fewer leave out light where, between two of them, an
/// aperture begins to cut.
const ROWS: usize = 20;
/// By how much maps are larger than what was found: more is blocked, less leaves out light between two rows.
const MARGIN: f64 = 8e-3;
/// n of the last row: hardly before the glass.
const NEAREST: f64 = 0.998;
/// θ/2 up to which rows are followed at most, radians.
const WIDEST: f64 = 1.45;
/// Places in a row, from the axis to its end, less one, at which it is known where rays land.
const NODES: usize = 32;
/// Of the samples of a map, every which is traced to know it: fewer take less time, and may miss how far off the fit is.
const EVERY: usize = 4;
/// Rays by which it is found anew where some of a pupil's rays land beside the film: their square.
const SIDE: usize = 4;
/// Places on the front surface from vertex to rim, by which its distance is known.
const PROFILE: u32 = 64;
/// Places on it from vertex to rim, and around over half a turn, by which a disk is known that holds it.
const MESH: u32 = 16;
/// [`Family::loose`] of a row: twice that is a tenth faster at the first direction and leaves out 3e-3 of a jumping edge's light.
const LOOSE: f64 = 1.5e-2;
/// [`Family::finest`] of a row.
const FINEST: usize = 32;
/// [`Pencil::accuracy`] of a row: as much as [`MARGIN`] allows, with a fifth fewer rays than at 1e-4.
const ACCURACY: f64 = 1e-3;

/// n of a row: denser far away.
fn nearness(row: usize) -> f64 {
    NEAREST * squared(row) / squared(ROWS)
}

fn squared(row: usize) -> f64 {
    (row as f64).powi(2)
}

/// A lens as it is seen from the scene.
struct View<'a> {
    clearances: ClearanceTracer,
    front: &'a Front,
    center: &'a ProjectionCenter,
    /// The film's corners' distance from the axis, mm.
    corner: f64,
    /// Longer than anything before E.
    lead: f64,
}

/// Where E is, and how far from it the front.
#[derive(Clone, Debug)]
struct ProjectionCenter {
    reference: f64,
    /// D at even h from vertex to rim, mm, and its step to the next.
    distances: Vec<[f32; 2]>,
    /// How many of them h grows by 1 over.
    per_height: f64,
}

impl ProjectionCenter {
    fn new(reference: f64, front: &Front) -> Self {
        let place = |[height, z]: [f64; 2]| {
            let point = [height, 0.0, z].map(|part| Portable([part]));
            let seen_point = OneSeenPoint::of_point(OneLane::cpu(), point, reference);
            [seen_point.half_tangent(OneLane::cpu()).0[0], seen_point.vergence.0[0].recip()]
        };
        let profile: Vec<[f64; 2]> = front.profile(PROFILE).into_iter().map(place).collect();
        let rim = profile[profile.len() - 1][0];
        let distance =
            |k: u32| on_broken_line(&profile, rim * f64::from(k.min(PROFILE)) / f64::from(PROFILE));
        let pair = |k: u32| [distance(k), distance(k + 1) - distance(k)].map(|number| number as f32);
        let per_height = f64::from(PROFILE) / rim;
        Self { reference, distances: (0..=PROFILE).map(pair).collect(), per_height }
    }

    /// D, beyond the rim as there.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn distance<L: Lanes<Scalar = f64>>(&self, cpu: Cpu<L>, half_tangent: L) -> L {
        let number = |number: f64| L::splat(cpu, number);
        let most = f64::from(PROFILE);
        let place = (half_tangent * number(self.per_height)).larger(number(0.0)).smaller(number(most));
        let knot = place.smaller(number(most - 1.0)).trunc();
        let [[distance, step, ..]] = L::look_up::<1, 1>(&self.distances, knot.whole(), [0]);
        (place - knot).mul_add(step, distance)
    }
}

/// The points of one nearness.
struct Row<'a> {
    view: &'a View<'a>,
    nearness: f64,
    work: RayBudget,
}

impl<'a> Row<'a> {
    fn new(view: &'a View<'a>, number: usize, path: &Path) -> Self {
        Self { view, nearness: nearness(number), work: RayBudget::new(path) }
    }

    fn seen_point(&self, height: f64) -> OneSeenPoint {
        let center = self.view.center;
        let Portable([distance]) = center.distance(OneLane::cpu(), Portable([height]));
        OneSeenPoint::on_meridian(center.reference, height, self.nearness / distance)
    }

    /// Where rays land at even places from the axis to the row's end.
    fn landings(&self, layout: &Layout) -> Vec<Node> {
        let knots = Knots::new();
        let mut landings: Vec<Node> = Vec::with_capacity(NODES + 1);
        for node in 0..=NODES {
            let slice = layout.slice(node as f64 / NODES as f64);
            let points: Vec<[f64; 2]> = slice.samples(&knots).into_iter().step_by(EVERY).collect();
            let found = self.landing(slice.height, &points);
            // Where the pupil vanishes it goes on as it did before.
            landings.push(found.unwrap_or_else(|| match landings[..] {
                [.., before, last] => Node { landing: before.landing.toward(&last.landing, 2.0), ..last },
                _ => Node { landing: Landing::UNKNOWN, corners: [[0.0; 2]; 4] },
            }));
        }
        landings
    }

    /// Where the rays of a point land that get through, by points all over the pupil; if some of them land beside the film, by
    /// others that do not.
    fn landing(&self, height: f64, points: &[[f64; 2]]) -> Option<Node> {
        let pencil = ScenePencil { row: self, seen_point: self.seen_point(height) };
        let rays = |points: &[[f64; 2]]| -> Vec<[[f64; 2]; 2]> {
            let found = pencil.clearances(points).into_iter();
            let passing = found.map(|found| found.filter(|found| found.ratio <= 1.0)?.landing);
            points.iter().zip(passing).filter_map(|(at, landing)| Some([*at, landing?])).collect()
        };
        let whole = rays(points);
        let mut landing = Landing::of(&whole)?;
        let [p, q] = [0, 1].map(|axis| {
            let parts = whole.iter().map(|ray| ray[0][axis]);
            parts.fold([f64::MAX, f64::MIN], |[low, high], part| [low.min(part), high.max(part)])
        });
        let corners = |[low, high]: [f64; 2], tall: f64| [[low, 0.0], [high, 0.0], [low, tall], [high, tall]];
        let mut known = corners(p, q[1]);
        let reach = self.view.corner + landing.rest;
        let back = |factor: f64, middle: f64| {
            let [a, b] = [-reach, reach].map(|end| (end - middle) / factor);
            [a.min(b), a.max(b)]
        };
        let [along, aside] = [back(landing.factors[0], landing.along), back(landing.factors[1], 0.0)];
        let (low, high, tall) = (along[0].max(p[0]), along[1].min(p[1]), aside[1].min(q[1]));
        if low < high && (high - low) * tall < (p[1] - p[0]) * q[1] {
            let part = |k: usize| (k as f64 + 0.5) / SIDE as f64;
            let at = |k: usize| [low + part(k / SIDE) * (high - low), part(k % SIDE) * tall];
            let nearer = rays(&(0..SIDE * SIDE).map(at).collect::<Vec<_>>());
            if let Some(nearer) = Landing::of(&nearer) {
                (landing, known) = (nearer, corners([low, high], tall));
            }
        }
        Some(Node { landing, corners: known })
    }
}

impl Family for Row<'_> {
    const ENDS: bool = true;

    fn loose(&self) -> f64 {
        LOOSE
    }

    fn finest(&self) -> usize {
        FINEST
    }

    /// Only of the farthest points: components come and go slowly with distance.
    fn probes_components(&self) -> bool {
        self.nearness == 0.0
    }

    fn pencil(&self, height: f64) -> impl Pencil + '_ {
        ScenePencil { row: self, seen_point: self.seen_point(height) }
    }

    /// Holds the front surface.
    fn cover(&self, height: f64) -> SlopeDisk {
        let (seen_point, most) = (self.seen_point(height), 4.0 * self.view.lead);
        let ring = |place: &[f64; 2]| -> Vec<[f64; 2]> {
            let [height, z] = *place;
            let point = |turn: u32| {
                let (aside, along) = (std::f64::consts::PI * f64::from(turn) / f64::from(MESH)).sin_cos();
                seen_point.seen([height * along, height * aside, z]).map(|part| part.clamp(-most, most))
            };
            (0..=MESH).map(point).collect()
        };
        let points: Vec<[f64; 2]> = self.view.front.profile(MESH).iter().flat_map(ring).collect();
        let low = points.iter().fold(f64::MAX, |low, point| low.min(point[0]));
        let high = points.iter().fold(f64::MIN, |high, point| high.max(point[0]));
        let middle = f64::midpoint(low, high);
        let radius = points.iter().fold(0.0_f64, |most, [a, b]| most.max((a - middle).hypot(*b)));
        SlopeDisk { center: [middle, 0.0], radius: 1.02 * radius }
    }

    fn reach(&self) -> f64 {
        WIDEST.tan()
    }

    /// Pupils move little about the paraxial one.
    fn shift(&self) -> f64 {
        0.0
    }

    fn work(&self) -> &RayBudget {
        &self.work
    }
}

/// The rays of one point, named by points of its plane.
struct ScenePencil<'a> {
    row: &'a Row<'a>,
    seen_point: OneSeenPoint,
}

impl ScenePencil<'_> {
    /// What becomes of rays through points of the plane; `None` also of those that do not meet the front from outside.
    fn clearances(&self, points: &[[f64; 2]]) -> Vec<Option<Clearance>> {
        let View { clearances, front, lead, .. } = self.row.view;
        let rays: Vec<Ray> = points.iter().map(|&at| self.seen_point.one_ray(at, *lead)).collect();
        let mut found = Vec::with_capacity(rays.len());
        self.row.work.count(rays.len(), || {
            clearances.trace(rays.iter().copied(), |clearance| found.push(clearance));
        });
        for (clearance, _) in found.iter_mut().zip(&rays).filter(|(_, ray)| !front.meets(ray)) {
            *clearance = None;
        }
        found
    }
}

impl Pencil for ScenePencil<'_> {
    fn excesses(&self, points: &[[f64; 2]]) -> Vec<Excess> {
        self.clearances(points).into_iter().map(Excess::of).collect()
    }

    fn accuracy(&self) -> f64 {
        ACCURACY
    }

    fn is_spent(&self) -> bool {
        self.row.work.is_spent()
    }
}

/// The pupil of a lens as points of the scene see it. Immutable once built.
#[derive(Clone, Debug)]
pub(super) struct SeenPupil {
    center: ProjectionCenter,
    lead: f64,
    /// How many rows of one nearness.
    rows: usize,
    pupil: CutPupil,
    simd: Available,
}

impl SeenPupil {
    /// Of the lens along a path from scene to film without blades, the film being at z = `film` and half as large as `half`, mm; E is at z =
    /// `reference`. `None` for a lens that no light gets through to such film.
    pub fn build(path: &Path, front: &Front, film: f64, half: [f64; 2], reference: f64) -> Option<Self> {
        let [low, high] = front.surface.sagitta_range();
        let lead = 2.0 * (front.surface.semi_diameter + reference.abs() + high - low);
        let center = ProjectionCenter::new(reference, front);
        let clearances = ClearanceTracer::new(path, film);
        let view = View { clearances, front, center: &center, corner: half[0].hypot(half[1]), lead };
        let mut rows: Vec<f64> = (0..=ROWS).map(nearness).collect();
        let builders: Vec<Builder<Row<'_>>> =
            (0..=ROWS).map(|row| Builder::new(Row::new(&view, row, path))).collect();
        let layouts = alike(&builders, &rows, Course::Straight);
        rows.truncate(layouts.tables.len());
        if rows.len() < 2 {
            return None;
        }
        let tables: Vec<(&Builder<Row<'_>>, &Layout)> = builders.iter().zip(&layouts.tables).collect();
        let landings = made_of_each(&tables, |(builder, layout)| builder.side.landings(layout));
        // Nothing is sampled beyond tables that end.
        let stack = Stack::of(&builders, layouts, MARGIN, PupilDisk::about_axis(1.0, 0.0));
        let pupil = CutPupil::new(stack, &widened(&landings, &rows), half);
        Some(Self { pupil, lead, rows: rows.len(), simd: Available::best(), center })
    }

    /// Directions toward the lens from points before it, lens space, mm, each for two numbers in [0, 1]; of points that are NaN
    /// none. What is traced are those directions' rays as they begin before the lens.
    pub fn aim(&self, front: &Front, points: [&mut [f64]; 5], rays: &mut Rays) {
        let [x, y, z, u, v] = points;
        for i in 0..x.len() {
            if !front.is_before([x[i], y[i], z[i]]) {
                x[i] = f64::NAN;
            }
        }
        let points: [&[f64]; 5] = [x, y, z, u, v];
        let mut seen_points = Columns::new(points[0].len());
        See { pupil: self, points, seen_points: seen_points.each_mut() }.take(self.simd);
        let chosen = self.choose(&seen_points, points);
        let [p, q, area, _] = chosen.each();
        let mut aimed = Aim {
            pupil: self,
            front,
            points,
            seen_points: seen_points.each(),
            chosen: [p, q, area],
            traced: rays.traced.rays(),
            toward_lens: rays.toward_lens.each_mut(),
        };
        aimed.take(self.simd);
        if front.surface.figure.is_some() {
            aimed.begin_on_front();
        }
    }

    /// Points of the planes across the ways to E, and the areas that they stand for over π. Those whose pupils the film cuts are
    /// taken together, for a vector with one of them takes as long as if it had no others.
    fn choose(&self, seen_points: &Columns<7>, points: [&[f64]; 5]) -> Columns<4> {
        let constants = self.pupil.lane_pupil();
        let ([ex, ey, .., height, place], [.., u, v]) = (seen_points.each(), points);
        let queries = [ex, ey, height, place, u, v];
        let mut chosen = Columns::new(u.len());
        let pupil = &self.pupil;
        Choose::<'_, false> { pupil, constants, queries, chosen: chosen.each_mut() }.take(self.simd);
        let [.., beyond] = chosen.each();
        let cut: Vec<usize> = (0..u.len()).filter(|&i| !(beyond[i] <= 0.0)).collect();
        let (mut asked, mut found) = (Columns::new(cut.len()), Columns::new(cut.len()));
        for (to, &i) in cut.iter().enumerate() {
            asked.put(to, queries.map(|column| column[i]));
        }
        Choose::<'_, true> { pupil, constants, queries: asked.each(), chosen: found.each_mut() }
            .take(self.simd);
        for (from, &i) in cut.iter().enumerate() {
            chosen.put(i, found.each().map(|column| column[from]));
        }
        chosen
    }
}

/// Where rays land, and the corners of the part of the plane of which that is known.
#[derive(Clone, Copy)]
struct Node {
    landing: Landing,
    corners: [[f64; 2]; 4],
}

/// The landings by rows, with an r that holds what lies between them: of what a node is off from the line past it a quarter,
/// doubled.
fn widened(nodes: &[Vec<Node>], rows: &[f64]) -> Vec<Vec<Landing>> {
    let landing = |row: usize, node: usize| nodes[row].get(node).map(|node| node.landing);
    let widened = |row: usize, k: usize| {
        let Node { landing: own, corners } = nodes[row][k];
        let off = |before: Option<Landing>, next: Option<Landing>, part: f64| {
            let line = before.zip(next).map(|(before, next)| before.toward(&next, part));
            line.map_or(0.0, |line| corners.iter().map(|&at| own.off(&line, at)).fold(0.0, f64::max))
        };
        let in_row = off(k.checked_sub(1).and_then(|k| landing(row, k)), landing(row, k + 1), 0.5);
        let across = (row > 0 && row + 1 < rows.len()).then(|| {
            let part = (rows[row] - rows[row - 1]) / (rows[row + 1] - rows[row - 1]);
            off(landing(row - 1, k), landing(row + 1, k), part)
        });
        Landing { rest: own.rest + (in_row + across.unwrap_or(0.0)) / 2.0, ..own }
    };
    (0..rows.len()).map(|row| (0..nodes[row].len()).map(|k| widened(row, k)).collect()).collect()
}

/// Sees points from E: [`SeenPoint::numbers`], h, and the place among the rows.
struct See<'a> {
    pupil: &'a SeenPupil,
    points: [&'a [f64]; 5],
    seen_points: [&'a mut [f64]; 7],
}

impl Step for See<'_> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.points[0].len()
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn vector<L: Lanes<Scalar = f64>>(&mut self, cpu: Cpu<L>, at: usize) {
        let SeenPupil { center, rows, .. } = self.pupil;
        let number = |number: f64| L::splat(cpu, number);
        let [x, y, z, ..] = load(cpu, &self.points, at);
        let seen_point = SeenPoint::of_point(cpu, [x, y, z], center.reference);
        let height = seen_point.half_tangent(cpu);
        // The row before, and of the way to the next: rows lie at squares.
        let near = seen_point.vergence * center.distance(cpu, height) * number(squared(ROWS) / NEAREST);
        let row = near.larger(number(f64::MIN_POSITIVE)).sqrt().smaller(number((rows - 2) as f64)).trunc();
        let place = row + (near - row * row) / (row + row + number(1.0));
        let [ex, ey, sin, cos, vergence] = seen_point.numbers();
        store([ex, ey, sin, cos, vergence, height, place], &mut self.seen_points, at);
    }
}

/// [`CutPupil::aim_whole`] of azimuths, h, places among the rows and numbers, or [`CutPupil::aim_part`].
struct Choose<'a, const PART: bool> {
    pupil: &'a CutPupil,
    constants: LanePupil<f64>,
    queries: [&'a [f64]; 6],
    chosen: [&'a mut [f64]; 4],
}

impl<const PART: bool> Step for Choose<'_, PART> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.queries[0].len()
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn vector<L: Lanes<Scalar = f64>>(&mut self, cpu: Cpu<L>, at: usize) {
        let [ex, ey, height, place, u, v] = load(cpu, &self.queries, at);
        let query = Query { height, place, azimuth: [ex, ey], numbers: [u, v] };
        let chosen = if PART {
            self.pupil.aim_part(cpu, &self.constants, &query)
        } else {
            self.pupil.aim_whole(cpu, &self.constants, &query)
        };
        store(chosen, &mut self.chosen, at);
    }
}

/// Makes rays through what was chosen.
struct Aim<'a> {
    pupil: &'a SeenPupil,
    front: &'a Front,
    points: [&'a [f64]; 5],
    seen_points: [&'a [f64]; 7],
    chosen: [&'a [f64]; 3],
    traced: LensRays<'a, f64>,
    toward_lens: [&'a mut [f64]; 7],
}

impl Aim<'_> {
    /// Moves where rays begin to an aspheric front. Nothing is left of those that meet it behind their scene point.
    fn begin_on_front(&mut self) {
        let [x, y, z, dx, dy, dz, density] = &mut self.toward_lens;
        let [px, py, pz, ..] = self.points;
        for i in 0..x.len() {
            if !(density[i] > 0.0) {
                continue;
            }
            let ray = Ray { origin: [x[i], y[i], z[i]], direction: [dx[i], dy[i], dz[i]] };
            [x[i], y[i], z[i]] = self.front.point(&ray);
            let way = [x[i] - px[i], y[i] - py[i], z[i] - pz[i]];
            if !(dot(way, ray.direction) > 0.0) {
                density[i] = 0.0;
            }
        }
    }
}

impl Step for Aim<'_> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.points[0].len()
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn vector<L: Lanes<Scalar = f64>>(&mut self, cpu: Cpu<L>, at: usize) {
        let number = |number: f64| L::splat(cpu, number);
        let far = number(f64::INFINITY);
        let [x, y, z, ..] = load(cpu, &self.points, at);
        let [ex, ey, sin, cos, vergence, ..] = load(cpu, &self.seen_points, at);
        let [p, q, area] = load(cpu, &self.chosen, at);
        let reference = self.pupil.center.reference;
        let seen_point = SeenPoint::of_numbers(reference, [ex, ey, sin, cos, vergence]);
        let ray = seen_point.ray(cpu, [p, q], self.pupil.lead);
        let cube = ray.stretch * ray.stretch * ray.stretch;
        let density = cube / (vergence * vergence * number(std::f64::consts::PI) * area);
        let is_one = L::both(number(0.0).less(density), density.less(far));
        let is_met = self.front.are_met(cpu, [x, y, z], ray.direction);
        let ([mut ox, mut oy, mut oz], [dx, dy, dz]) = (ray.origin, ray.direction);
        store(ray.origin, &mut self.traced.origin, at);
        store(ray.direction, &mut self.traced.direction, at);
        if self.front.surface.figure.is_none() {
            let length = self.front.length(cpu, ray.origin, ray.direction);
            let length = length.or_zero(length.abs().less(far));
            [ox, oy, oz] = [length.mul_add(dx, ox), length.mul_add(dy, oy), length.mul_add(dz, oz)];
        }
        let density = density.or_zero(L::both(is_met, is_one));
        store([ox, oy, oz, dx, dy, dz, density], &mut self.toward_lens, at);
    }
}
