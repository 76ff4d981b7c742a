//! The pupil of a lens as seen from points of the scene: the table from which directions toward the lens and
//! their densities are sampled.
//!
//! Seen from a point E on the axis, a point P of the scene lies at the angle θ to the axis. The rays from P
//! are identified by the points where they cross the plane through E perpendicular to PE ([`SeenPoint`]). The
//! rays that pass the lens form a figure in this plane. It is symmetric about the plane that contains P and
//! the axis, just as the pupil of a film point is symmetric in slopes. So the same kind of map takes the unit
//! disk to this figure ([`crate::sampling::pupil_map`]), with
//!
//! ```text
//! h = tan(θ/2)     instead of the film radius: needs no arc tangent; up to where no light gets through;
//! n = D(θ)/|PE|    as the second parameter: 0 at infinity, and 1 on the glass, which is D(θ) away from E.
//! ```
//!
//! The whole pupil is sampled. Directions whose rays miss the film or hit the blades are blocked.

use super::{
    block::{ArrivingRays, BlockStep, load, store},
    front::Front,
    seen_point::{OneSeenPoint, SeenPoint},
};
use crate::sampling::{
    DiskMapping,
    pupil_map::{Family, Grid, MapConstants, Pencil, PupilMap, intervals},
};
use realistic_base::numeric::{dot, on_broken_line};
use realistic_optics::{
    lens::{
        Ray,
        pupil::{EntrancePupil, SlopeDisk},
    },
    trace::Path,
};
use realistic_simd::{Available, Cpu, Lanes, OneLane, Portable};
use realistic_trace::kernel::{ClearanceTracer, LensRays};

/// n of the last column, just below 1, the value on the glass.
const NEAREST: f64 = 0.998;
/// Largest θ/2, radians, at which light is searched for; this covers fields of view up to 275°.
const WIDEST: f64 = 1.2;
/// Number of heights on the front surface, from vertex to edge, at which the distance from E is tabulated.
const PROFILE: u32 = 64;
/// Number of heights on the front surface, and of azimuths over half a turn, at the points whose bounding
/// disk covers the surface.
const MESH: u32 = 16;

/// A lens as seen from points of the scene, with the parameters h and nearness n.
struct SceneSide<'a> {
    clearances: ClearanceTracer,
    front: &'a Front,
    /// Heights on the front surface, and z at each height.
    profile: Vec<[f64; 2]>,
    center: ProjectionCenter,
    /// The radius of the paraxial entrance pupil, mm.
    pupil_radius: f64,
    /// A length greater than the distance from E to any point of the front, mm.
    lead: f64,
    intervals: [usize; 2],
}

impl<'a> SceneSide<'a> {
    /// Prepares the path from scene to film, without blades, for the film at z = `film` and E at
    /// z = `reference`.
    fn new(path: &Path, front: &'a Front, film: f64, pupil: &EntrancePupil, reference: f64) -> Self {
        let [low, high] = front.surface.sagitta_range();
        let fine = intervals(path);
        Self {
            clearances: ClearanceTracer::new(path, film),
            front,
            profile: front.profile(MESH),
            center: ProjectionCenter::new(reference, front),
            pupil_radius: pupil.diameter() / 2.0,
            lead: 2.0 * (front.surface.semi_diameter + reference.abs() + high - low),
            // Coarser than the map over the film, because the total number of nodes is the product of both
            // parameters' numbers.
            intervals: [fine / 4, (3 * fine / 16).max(1)],
        }
    }

    /// Returns n at a column or halfway between two columns. Column k lies at n proportional to k², so
    /// columns are denser far from the lens; n is linear between columns.
    fn nearness(&self, column: f64) -> f64 {
        let (before, columns) = (column.floor(), self.intervals[1] as f64);
        let square = before * before + (column - before) * (2.0 * before + 1.0);
        NEAREST * square / (columns * columns)
    }
}

impl Family for SceneSide<'_> {
    const SYMMETRIC: bool = true;
    const ENDS: bool = true;

    fn pencil(&self, height: f64, column: f64) -> impl Pencil + '_ {
        let Portable([distance]) = self.center.distance(OneLane::cpu(), Portable([height]));
        let vergence = self.nearness(column) / distance;
        ScenePencil {
            side: self,
            seen_point: OneSeenPoint::on_meridian(self.center.reference, height, vergence),
        }
    }

    fn reach(&self) -> f64 {
        WIDEST.tan()
    }

    fn intervals(&self) -> [usize; 2] {
        self.intervals
    }
}

/// The rays of one scene point, identified by points of its plane through E.
struct ScenePencil<'a> {
    side: &'a SceneSide<'a>,
    seen_point: OneSeenPoint,
}

impl Pencil for ScenePencil<'_> {
    /// Returns infinity for rays that do not meet the front from outside.
    fn excesses(&self, points: &[[f64; 2]]) -> Vec<f64> {
        let SceneSide { clearances, front, lead, .. } = self.side;
        let rays: Vec<Ray> = points.iter().map(|&at| self.seen_point.one_ray(at, *lead)).collect();
        let mut found = clearances.excesses(rays.iter().copied());
        let strays = |(excess, ray): &(&mut f64, &Ray)| excess.is_finite() && !front.meets(ray);
        for (excess, _) in found.iter_mut().zip(&rays).filter(strays) {
            *excess = f64::INFINITY;
        }
        found
    }

    /// Returns a disk that contains the front surface.
    fn cover(&self) -> SlopeDisk {
        let most = 4.0 * self.side.lead;
        let ring = |&[height, z]: &[f64; 2]| -> Vec<[f64; 2]> {
            let point = |turn: u32| {
                let (aside, along) = (std::f64::consts::PI * f64::from(turn) / f64::from(MESH)).sin_cos();
                self.seen_point.seen([height * along, height * aside, z]).map(|part| part.clamp(-most, most))
            };
            (0..=MESH).map(point).collect()
        };
        let points: Vec<[f64; 2]> = self.side.profile.iter().flat_map(ring).collect();
        let low = points.iter().fold(f64::MAX, |low, point| low.min(point[0]));
        let high = points.iter().fold(f64::MIN, |high, point| high.max(point[0]));
        let middle = f64::midpoint(low, high);
        let radius = points.iter().fold(0.0_f64, |most, [a, b]| most.max((a - middle).hypot(*b)));
        SlopeDisk { center: [middle, 0.0], radius: 1.02 * radius }
    }

    fn guess(&self) -> SlopeDisk {
        SlopeDisk { center: [0.0; 2], radius: self.side.pupil_radius }
    }
}

/// The projection centre E and the distances from it to the points of the front surface.
#[derive(Clone, Debug)]
struct ProjectionCenter {
    reference: f64,
    /// D at equal steps of h from vertex to edge, mm, each with the difference to the next value.
    distances: Vec<[f32; 2]>,
    /// Number of these steps per unit of h.
    per_height: f64,
}

impl ProjectionCenter {
    fn new(reference: f64, front: &Front) -> Self {
        let height_and_distance = |[height, z]: [f64; 2]| {
            let point = [height, 0.0, z].map(|part| Portable([part]));
            let seen_point = OneSeenPoint::of_point(OneLane::cpu(), point, reference);
            [seen_point.half_tangent(OneLane::cpu()).0[0], seen_point.vergence.0[0].recip()]
        };
        let profile: Vec<[f64; 2]> = front.profile(PROFILE).into_iter().map(height_and_distance).collect();
        let edge = profile[profile.len() - 1][0];
        let distance =
            |k: u32| on_broken_line(&profile, edge * f64::from(k.min(PROFILE)) / f64::from(PROFILE));
        let pair = |k: u32| [distance(k), distance(k + 1) - distance(k)].map(|number| number as f32);
        let per_height = f64::from(PROFILE) / edge;
        Self { reference, distances: (0..=PROFILE).map(pair).collect(), per_height }
    }

    /// Returns D; beyond the edge of the front surface, the value at the edge.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn distance<L: Lanes<Scalar = f64>>(&self, cpu: Cpu<L>, half_tangent: L) -> L {
        let number = |number: f64| L::splat(cpu, number);
        let most = f64::from(PROFILE);
        let position = (half_tangent * number(self.per_height)).larger(number(0.0)).smaller(number(most));
        let knot = position.smaller(number(most - 1.0)).trunc();
        let [[distance, step, ..]] = L::look_up::<1, 1>(&self.distances, knot.whole(), [0]);
        (position - knot).mul_add(step, distance)
    }
}

/// The pupil of a lens as seen from points of the scene. Immutable once built.
#[derive(Clone, Debug)]
pub(super) struct SeenPupil {
    center: ProjectionCenter,
    lead: f64,
    columns: usize,
    map: PupilMap,
    simd: Available,
}

impl SeenPupil {
    /// Tabulates a lens: see [`SceneSide::new`].
    pub fn build(path: &Path, front: &Front, film: f64, pupil: &EntrancePupil, reference: f64) -> Self {
        let side = SceneSide::new(path, front, film, pupil, reference);
        let map = PupilMap::new(&Grid::new(&side), SceneSide::SYMMETRIC);
        let SceneSide { center, lead, intervals: [_, columns], .. } = side;
        Self { center, lead, columns, map, simd: Available::best() }
    }

    /// Samples directions toward the lens from points in front of it (lens space, mm), by two numbers in [0,
    /// 1] per point. A point that is NaN gets no direction. The rays to trace begin in front of the lens
    /// along these directions.
    pub fn aim(&self, front: &Front, points: [&mut [f64]; 5], rays: &mut ArrivingRays) {
        let [x, y, z, u, v] = points;
        for i in 0..x.len() {
            if !front.is_before([x[i], y[i], z[i]]) {
                x[i] = f64::NAN;
            }
        }
        let mut aimed = Aim {
            pupil: self,
            constants: self.map.constants(),
            front,
            points: [x, y, z, u, v],
            traced: rays.traced.rays(),
            toward_lens: rays.toward_lens.each_mut(),
        };
        aimed.take(self.simd);
        if front.surface.figure.is_some() {
            aimed.begin_on_front();
        }
    }

    /// Samples points in the planes of scene points by two numbers in [0, 1] each. Returns the sampled points
    /// and, for each, the area that it represents divided by π; the area is NaN if there is nothing to
    /// sample. For fixed numbers the ray varies continuously with the scene point, also across the axis.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn choose<L: Lanes<Scalar = f64>>(
        &self,
        cpu: Cpu<L>,
        constants: &MapConstants<f64>,
        seen_point: &SeenPoint<L>,
        numbers: [L; 2],
    ) -> ([L; 2], L) {
        let number = |number: f64| L::splat(cpu, number);
        let height = seen_point.half_tangent(cpu);
        // The index of the preceding column, plus the interpolation parameter toward the next column.
        let columns = self.columns as f64;
        let near =
            seen_point.vergence * self.center.distance(cpu, height) * number(columns * columns / NEAREST);
        let before = near.larger(number(0.0)).sqrt().smaller(number(columns - 1.0)).trunc();
        let column = before + (near - before * before) / (before + before + number(1.0));
        let location = self.map.locate_in_columns(cpu, constants, height, column);
        let disk = seen_point.turned(DiskMapping::Concentric.lanes(cpu, numbers));
        let (at, area) = self.map.at(cpu, &location, disk);
        (at, L::select(location.inside, area, number(f64::NAN)))
    }
}

/// Samples rays from points toward the lens.
struct Aim<'a> {
    pupil: &'a SeenPupil,
    constants: MapConstants<f64>,
    front: &'a Front,
    points: [&'a [f64]; 5],
    traced: LensRays<'a, f64>,
    toward_lens: [&'a mut [f64]; 7],
}

impl Aim<'_> {
    /// Moves the origins of rays to an aspheric front surface. Removes rays that meet this surface behind
    /// their scene point.
    fn begin_on_front(&mut self) {
        let [x, y, z, dx, dy, dz, density] = &mut self.toward_lens;
        let [px, py, pz, ..] = self.points;
        for i in 0..x.len() {
            if !(density[i] > 0.0) {
                continue;
            }
            let ray = Ray { origin: [x[i], y[i], z[i]], direction: [dx[i], dy[i], dz[i]] };
            [x[i], y[i], z[i]] = self.front.point(&ray);
            let offset = [x[i] - px[i], y[i] - py[i], z[i] - pz[i]];
            if !(dot(offset, ray.direction) > 0.0) {
                density[i] = 0.0;
            }
        }
    }
}

impl BlockStep for Aim<'_> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.points[0].len()
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn vector<L: Lanes<Scalar = f64>>(&mut self, cpu: Cpu<L>, at: usize) {
        let number = |number: f64| L::splat(cpu, number);
        let far = number(f64::INFINITY);
        let [x, y, z, u, v] = load(cpu, &self.points, at);
        let seen_point = SeenPoint::of_point(cpu, [x, y, z], self.pupil.center.reference);
        let (through, area) = self.pupil.choose(cpu, &self.constants, &seen_point, [u, v]);
        let ray = seen_point.ray(cpu, through, self.pupil.lead);
        let (vergence, cube) = (seen_point.vergence, ray.stretch * ray.stretch * ray.stretch);
        let density = cube / (vergence * vergence * number(std::f64::consts::PI) * area);
        let is_one = L::both(number(0.0).less(density), density.less(far));
        let is_met = self.front.are_met(cpu, [x, y, z], ray.direction);
        let ([mut ox, mut oy, mut oz], [dx, dy, dz]) = (ray.origin, ray.direction);
        store(ray.origin, &mut self.traced.origin, at);
        store(ray.direction, &mut self.traced.direction, at);
        let mut is_ahead = is_met;
        if self.front.surface.figure.is_none() {
            let length = self.front.length(cpu, ray.origin, ray.direction);
            let length = length.or_zero(length.abs().less(far));
            [ox, oy, oz] = [length.mul_add(dx, ox), length.mul_add(dy, oy), length.mul_add(dz, oz)];
            let along = (oz - z).mul_add(dz, (oy - y).mul_add(dy, (ox - x) * dx));
            is_ahead = L::both(is_ahead, number(0.0).less(along));
        }
        let density = density.or_zero(L::both(is_ahead, is_one));
        store([ox, oy, oz, dx, dy, dz, density], &mut self.toward_lens, at);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::MapFailure;
    use realistic_optics::{
        imaging::axial_beam::AxialBeam,
        lens::{Lens, first_order::FirstOrder},
        prescription::catalogue,
    };

    #[test]
    fn light_is_found_from_infinity_to_the_glass() {
        for name in ["dgauss.50mm", "fisheye.10mm", "phone.4mm", "telephoto.250mm"] {
            let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
            let film = FirstOrder::of(&lens).expect("not afocal").rear_focal_point;
            let (front, pupil) = (Front::of(&lens), AxialBeam::of(&lens).entrance);
            let reference = pupil.position().expect("in the lens");
            let side = SceneSide::new(&Path::scene_to_film(&lens), &front, film, &pupil, reference);
            let grid = Grid::new(&side);
            assert!(grid.dark_beyond, "{name}");
            // The last cells before the limit of the light may hold hardly any light.
            let last = grid.intervals[0] - 2;
            for gap in &grid.gaps {
                assert!(gap.reason == MapFailure::Gaps || gap.cell[0] >= last, "{name} {gap:?}");
            }
        }
    }
}
