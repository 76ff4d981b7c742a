//! The warped pupil: lens samples (u, v) mapped to the true pupil of each film point.
//!
//! The pupil of a film point at distance h from the axis, in slopes at the film and turned so that the
//! point lies on the +x axis, is the image of the unit disk under
//!
//! ```text
//! d -> C + M(direction of d) d        (complex numbers)
//! ```
//!
//! C = c h lies inside, and M takes each half-line from the disk's centre to one from C, its end to
//! the pupil's edge. M is tabulated so that equal areas of the disk go to equal areas of the pupil (an
//! equal-area fan), at knots in a pseudo-angle q and at film radii chosen so that interpolation between
//! them fits. It is linear in q, and along the film in s = h/end; where the film is dark beyond the
//! table's end, in s = 1 - √(1 - h/end). c alone is linear in h. Written in the film's own frame, at the
//! film point p = h e,
//!
//! ```text
//! slope = c(h) p + M(q, h) d,   q = 1 - a/(|a| + |b|),   a + i b = d * conj(p),
//! ```
//!
//! with the conjugate of M where b < 0, the pupil being symmetric: turning the film point turns the
//! pupil under a disk that stays, so that for fixed lens samples the slope is continuous over
//! the film, through the axis too, where M is the same in every direction. A round pupil is exactly
//! round. The map's Jacobian is
//!
//! ```text
//! J = |M|² + Im(conj(M) dM/dφ),   dM/dφ = dM/dq dq/dφ,   dq/dφ = (a² + b²)/(|a| + |b|)²,
//! ```
//!
//! φ being the angle of a + i b. π J is the slope area that a sample stands for, and 1/(π J) the density of
//! the samples: exact, whatever the table, so that the only bias is the share of the pupil that the map does
//! not reach.
//!
//! Toward the radius at which it vanishes a pupil becomes a crescent ever higher than wide, between whose knots the map
//! would bulge by a part of its height. There M takes the disk to a pupil as wide as high, which is then narrowed along
//! p to τ = 1 - γ(h) h² of its size: M d - γ (M d · p) p in the place of M d, τ times the area. And it is bent along the arc of a
//! circle: β(h) w² (1 + t²) p is added, t = β w h², w = |M d × p| being h times the point's distance from p's line, a shear that
//! keeps areas. γ (`narrowing`) and β (`bow`) are tabulated, too. τ vanishes about as a power of 1 - h²/end²; so between two slices γ is
//! a parabola in s, which halfway has the τ of the power law through both.
//!
//! Names. A *slice* is the map at one tabulated film radius; its *knots* are the directions at which it
//! has M. s is cut into `FINE` *smallest intervals*, and two neighbouring slices are a power of 2 of them
//! apart; `build` counts film radii in them and calls the number a place. The table's *cells* are as wide as the narrowest of them. `height` is h, but a `Frame`'s
//! height and width are half those of a pupil. A pupil's *first row* is its extent on the meridian; a `Row`
//! is what the table has at a film radius. The *cover* is a disk that holds every pupil: on the film's side
//! the rear element's.
//!
//! How the table is made: `pencil` traces the rays of a film point and tells how far outside every aperture they are; `outline`
//! finds the pupil's edge by that, in a frame that makes the pupil about round; `components` looks for light beside it; `follow`
//! goes along the film to the image's end; `slice` makes the map of an outline; and `build` chooses the film radii. `inverse`
//! is the way back. Tables over a second parameter are a `stack`: of wavelengths in `spectral`, or of how near points of the scene
//! are, where `cut` keeps to what lands on film; `threads` has them made side by side.
//!
//! One evaluation takes one or two roots, a division, no trigonometry and three times four neighbouring
//! floats, five times with γ and β. It is written once, over lanes of either precision: a single sample has the bits of a
//! batch's.
//!
//! Where no such map fits the table holds the rear element's disk, and what falls beside the pupil is
//! blocked: where the pupil has several components or holes, where it is not star-shaped or jumps, where no
//! light is found on the meridian within the image, and from where the table's budget of rays is spent
//! (`RayBudget`). The disk serves for the whole film where no light gets through on the axis, or where the
//! pupil is too narrow for single precision. Where a pupil changes faster than the slices can follow, the
//! map is only larger than the pupil. `MapFailure` has all these cases. Beyond the table's end the film is
//! dark and a sample has the area NaN, or the film is lit and the disk is sampled (`WarpedPupil::cover`).

mod build;
mod components;
mod cut;
mod follow;
mod inverse;
mod outline;
mod pencil;
mod report;
mod slice;
mod spectral;
mod stack;
mod threads;

pub(crate) use build::{Builder, Course, Layout, alike};
pub(crate) use cut::{CutPupil, Landing, Query};
pub(crate) use pencil::{Excess, Family, FilmPencils, Pencil, RayBudget};
pub use report::{BuildReport, GivenUp, MapFailure};
pub(crate) use slice::Knots;
pub(crate) use spectral::{LaneSpectralPupil, SpectralPupil};
pub(crate) use stack::Stack;
pub(crate) use threads::made_of_each;

use std::{f64::consts::PI, iter::repeat_n};

use self::{
    build::{FINE, Interval, Scale},
    slice::{CELLS, KNOTS, SECTORS, WIDE},
};
use super::{
    film_rays::FilmRays,
    pupil_disk::{LaneDisk, PupilDisk, PupilSample},
};
use crate::trace::{
    Path, Real,
    kernel::{Compiled, Cpu, Indexed, Lanes, OneLane, Portable, Scalar, Simd},
};

/// The true pupil of every point of a film. Immutable once built.
#[derive(Clone, Debug)]
pub struct WarpedPupil {
    /// Film radius at the table's end, mm.
    end: f64,
    /// Whether film is dark beyond the end, mostly because the pupil vanishes there; film radius is then tabulated in
    /// s = 1 - sqrt(1 - h/end), in which a shrinking outline is smooth.
    dark_beyond: bool,
    /// How many cells there are: intervals of s as wide as the narrowest between two slices.
    fine: usize,
    /// Of each cell: where in the table the slice below it begins; the reciprocal of the way to the next
    /// slice, in cells; c there, and c's step to the next slice.
    cells: Vec<Indexed>,
    /// Two pairs of each cell where the pupil vanishes, else none: γ at the slice below and its step to the next slice; its bend
    /// between them, and c's, for in h that goes straight and in s it does not.
    narrowings: Vec<[f32; 2]>,
    /// The same: β at the slice below and its step; what c is more than its float, of which the last crescents are few; and 0.
    bows: Vec<[f32; 2]>,
    /// Slices of [`STRIDE`]: M at the knots, and once more, side by side, at those between sectors.
    table: Vec<[f32; 2]>,
    cover: PupilDisk,
    build: BuildReport,
    given_up: Vec<GivenUp>,
}

/// Its square is half the knots' intervals: those that pass while q grows by 1.
const ROOT: f64 = 8.0;
const _: () = assert!((ROOT * ROOT) as usize == CELLS / 2);

/// Pairs per slice. The last one only stands behind another.
const STRIDE: usize = KNOTS + SECTORS + 2;
// Sums of places are as lanes have them.
const _: () = assert!(2 * FINE * STRIDE < 1 << 31);

impl WarpedPupil {
    /// Tabulates the pupils of film points up to `reach` mm from the axis, on film at `film` (z in
    /// lens space). `cover` is a disk that holds them all; `shift` an estimate of the slope to the
    /// pupil's centre over the film radius, 1/mm.
    pub fn new(path: &Path, film: f64, reach: f64, cover: PupilDisk, shift: f64) -> Self {
        let builder = Builder::naming(FilmPencils::new(path, film, reach, cover, shift));
        let layout = builder.layout();
        let grain = grain(&layout.intervals);
        Self::pack(layout, grain, cover, builder.side.work().rays())
    }

    /// With cells of so many smallest intervals.
    fn pack(layout: Layout, grain: usize, cover: PupilDisk, rays: u32) -> Self {
        let Layout { scale: Scale { end, dark_beyond, .. }, intervals, given_up } = layout;
        let mut table: Vec<[f32; 2]> = Vec::with_capacity((intervals.len() + 1) * STRIDE);
        let fine = FINE / grain;
        let mut cells = Vec::with_capacity(fine);
        let (mut narrowings, mut bows) = (Vec::new(), Vec::new());
        let mut covered = 0.0;
        let mut joined: Option<bool> = None;
        for interval in &intervals {
            let [low, high] = &interval.slices;
            // A slice serves the intervals on both its sides, unless only one of them is covered.
            if joined == Some(low.fitted) {
                table.truncate(table.len() - STRIDE);
            }
            let width = interval.cells(grain);
            let [from, to] = [low, high].map(|slice| slice.center as f32);
            // Where the rest below is added, too, else without a jump to the next slice's float.
            let step = if dark_beyond { (high.center - low.center) as f32 } else { to - from };
            let numbers = [(width as f32).recip(), from, step];
            cells.extend(repeat_n(Indexed { index: table.len() as u32, numbers }, width));
            if dark_beyond {
                let [narrowing, next] = [low, high].map(|slice| slice.narrowing as f32);
                // h is s (2 - s) of the end: (h - h₀)/(h₁ - h₀) of an interval is t + t (1 - t) width/(2 - s₀ - s₁).
                let smallest = interval.to - interval.from;
                let bend = smallest as f32 / (2 * FINE - interval.from - interval.to) as f32;
                let [bow, next_bow] = [low, high].map(|slice| slice.bow as f32);
                let bends = [low.narrowing_bend(high) as f32, bend * step];
                narrowings.extend(repeat_n([[narrowing, next - narrowing], bends], width).flatten());
                let rest = (low.center - f64::from(from)) as f32;
                bows.extend(repeat_n([[bow, next_bow - bow], [rest, 0.0]], width).flatten());
            }
            for slice in [low, high] {
                let (knots, bounds) = (slice.factors.iter(), slice.factors.iter().step_by(WIDE));
                let behind = slice.factors.last().into_iter();
                table.extend(knots.chain(bounds).chain(behind).map(|factor| factor.map(|x| x as f32)));
            }
            joined = Some(high.fitted);
            if !low.fitted {
                covered += (high.height - low.height) / end;
            }
        }
        let build = BuildReport { slices: table.len() / STRIDE, rays, covered };
        Self { end, dark_beyond, fine, cells, narrowings, bows, table, cover, build, given_up }
    }

    /// What building the table took.
    pub fn build_report(&self) -> BuildReport {
        self.build
    }

    /// The film radii, outward, at which the rear element's disk is sampled instead of the pupil.
    pub fn given_up(&self) -> &[GivenUp] {
        &self.given_up
    }

    /// The film radius from which on no light arrives, mm, where that lies within reach or at most an eighth beyond.
    pub fn image_radius(&self) -> Option<f64> {
        self.dark_beyond.then_some(self.end)
    }

    /// The disk that holds every pupil.
    pub(crate) fn cover_disk(&self) -> PupilDisk {
        self.cover
    }

    /// The slope that the point `disk` of the unit disk stands for at a film point, mm; `None` where the
    /// film is dark.
    pub fn sample(&self, film: [f64; 2], disk: [f64; 2]) -> Option<PupilSample> {
        let mut sample = PupilSample { slopes: [0.0; 2], area: f64::NAN };
        Simd::best().run(OneSample { pupil: self, film, disk, found: &mut sample });
        (!sample.area.is_nan()).then_some(sample)
    }

    /// What sampling computes with, in the precision of the lanes.
    pub(crate) fn lane_pupil<S: Scalar>(&self) -> LanePupil<S> {
        let fine = self.fine as f64;
        let scale = if self.dark_beyond { fine * fine } else { fine } / self.end;
        LanePupil { scale: S::from_f64(scale), fine: S::from_f64(fine), cover: self.cover.lane_disk() }
    }

    /// [`WarpedPupil::sample`] in lanes: gives rays their slopes and area. Where there is nothing to sample the area is
    /// NaN.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn lanes<L: Lanes, const U: usize>(
        &self,
        cpu: Cpu<L>,
        constants: &LanePupil<L::Scalar>,
        rays: &mut [FilmRays<L>; U],
    ) {
        let mut radii = [self.radius(cpu, constants, &rays[0]); U];
        for u in 1..U {
            radii[u] = self.radius(cpu, constants, &rays[u]);
        }
        let mut places = [self.place(cpu, &rays[0], &radii[0]); U];
        for u in 1..U {
            places[u] = self.place(cpu, &rays[u], &radii[u]);
        }
        let mut all_inside = true;
        for u in 0..U {
            self.aim(cpu, &places[u], &mut rays[u]);
            all_inside &= L::all(radii[u].inside);
        }
        if !all_inside {
            for u in 0..U {
                self.cover(cpu, constants, radii[u].inside, &mut rays[u]);
            }
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn radius<L: Lanes>(
        &self,
        cpu: Cpu<L>,
        constants: &LanePupil<L::Scalar>,
        ray: &FilmRays<L>,
    ) -> Radius<L> {
        let [x, y] = ray.point;
        let height = y.mul_add(y, x * x).sqrt();
        let [scale, fine] = [L::splat(cpu, constants.scale), L::splat(cpu, constants.fine)];
        let s = if self.dark_beyond {
            fine - height.neg_mul_add(scale, fine * fine).sqrt()
        } else {
            height * scale
        };
        // `smaller` leaves no NaN.
        let place = s.smaller(fine - L::splat(cpu, L::Scalar::ONE));
        Radius { inside: s.less(fine), s, place }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn place<L: Lanes>(&self, cpu: Cpu<L>, ray: &FilmRays<L>, radius: &Radius<L>) -> Place<L> {
        let (row, heading) = (self.row(cpu, radius.place.whole(), radius), Heading::of(cpu, ray));
        Place { row, heading }
    }

    /// What stands in the table for a cell and a place in it.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn row<L: Lanes>(&self, cpu: Cpu<L>, cell: L::Places, radius: &Radius<L>) -> Row<L> {
        let (slice, [per_width, center, center_step]) = L::look_up_indexed(&self.cells, cell);
        // A slice begins at a multiple of its width, a power of 2.
        let part = radius.s.mul_sub(per_width, (radius.place * per_width).trunc());
        let mut center = part.mul_add(center_step, center);
        let mut narrowing = L::splat(cpu, L::Scalar::ZERO);
        let mut bow = narrowing;
        if !self.narrowings.is_empty() {
            let [[at, step, bend, center_bend]] = L::look_up::<1, 2>(&self.narrowings, cell, [0]);
            let [[bow_at, bow_step, rest, _]] = L::look_up::<1, 2>(&self.bows, cell, [0]);
            let curve = part.neg_mul_add(part, part);
            narrowing = curve.mul_add(bend, part.mul_add(step, at));
            bow = part.mul_add(bow_step, bow_at);
            center = center + curve.mul_add(center_bend, rest);
        }
        Row { slice, part, center, narrowing, bow }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn aim<L: Lanes>(&self, cpu: Cpu<L>, Place { row, heading }: &Place<L>, ray: &mut FilmRays<L>) {
        let knots = self.knots(row, heading);
        self.aim_at(cpu, row, heading, knots, ray);
    }

    /// M at the two knots beside a direction, interpolated between two slices.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn knots<L: Lanes>(&self, row: &Row<L>, heading: &Heading<L>) -> [L; 4] {
        self.knots_from(row, L::add_places(heading.knot.whole(), row.slice))
    }

    /// M at the bounds of the sector with this number, interpolated between two slices.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn bounds<L: Lanes>(&self, cpu: Cpu<L>, row: &Row<L>, sector: usize) -> [L; 4] {
        let first = L::splat(cpu, L::Scalar::from_f64((KNOTS + sector) as f64));
        self.knots_from(row, L::add_places(first.whole(), row.slice))
    }

    /// M at a place in the slice before and at the next knot, interpolated to the slice after.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn knots_from<L: Lanes>(&self, row: &Row<L>, first: L::Places) -> [L; 4] {
        let [below, above] = L::look_up::<2, 1>(&self.table, first, [0, STRIDE]);
        toward(row.part, below, above)
    }

    /// Gives rays their slopes and area by what stands in the table for them.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn aim_at<L: Lanes>(
        &self,
        cpu: Cpu<L>,
        &Row { center, narrowing, bow, .. }: &Row<L>,
        &Heading { offset, turn, below, .. }: &Heading<L>,
        [re, im, re_next, im_next]: [L; 4],
        ray: &mut FilmRays<L>,
    ) {
        let ([x, y], [u, v]) = (ray.point, ray.disk);
        let (re_step, im_step) = (re_next - re, im_next - im);
        let (re, im) = (offset.mul_add(re_step, re), offset.mul_add(im_step, im));
        let twist = im.neg_mul_add(re_step, re * im_step);
        let jacobian = twist.mul_add(turn, im.mul_add(im, re * re));
        let im = L::select(below, L::splat(cpu, L::Scalar::ZERO) - im, im);
        if self.narrowings.is_empty() {
            ray.slopes =
                [im.neg_mul_add(v, re.mul_add(u, center * x)), im.mul_add(u, re.mul_add(v, center * y))];
            ray.area_per_pi = jacobian;
            return;
        }
        let [across, up] = product([re, im], [u, v]);
        let aside = up.mul_add(x, (L::splat(cpu, L::Scalar::ZERO) - across) * y);
        let straight = narrowing.neg_mul_add(up.mul_add(y, across * x), center);
        let (square, one) = (ray.radius_squared(), L::splat(cpu, L::Scalar::ONE));
        let shift = bend(bow, aside, square, one) + straight;
        ray.slopes = [shift.mul_add(x, across), shift.mul_add(y, up)];
        ray.area_per_pi = jacobian * narrowing.neg_mul_add(square, one);
    }

    /// Samples the cover what film points beyond the table ask for, or nothing where film is dark there.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn cover<L: Lanes>(
        &self,
        cpu: Cpu<L>,
        constants: &LanePupil<L::Scalar>,
        inside: L::Mask,
        ray: &mut FilmRays<L>,
    ) {
        if self.dark_beyond {
            ray.area_per_pi =
                L::select(inside, ray.area_per_pi, L::splat(cpu, L::Scalar::from_f64(f64::NAN)));
            return;
        }
        let (slopes, area) = constants.cover.lanes(cpu, ray.point, ray.disk);
        for (to, slope) in ray.slopes.iter_mut().zip(slopes) {
            *to = L::select(inside, *to, slope);
        }
        ray.area_per_pi = L::select(inside, ray.area_per_pi, area);
    }
}

/// What β bends a point by, over h: [`outline::bend`] in units of p. `aside` is w, `square` h².
#[cfg_attr(not(debug_assertions), inline(always))]
fn bend<L: Lanes>(bow: L, aside: L, square: L, one: L) -> L {
    let curve = bow * aside;
    let turn = curve * square;
    curve * aside * turn.mul_add(turn, one)
}

/// Smallest intervals of the narrowest interval.
fn grain(intervals: &[Interval]) -> usize {
    intervals.iter().map(|interval| interval.to - interval.from).min().unwrap_or(FINE)
}

/// `part` of the way from some numbers to others.
#[cfg_attr(not(debug_assertions), inline(always))]
fn toward<L: Lanes, const N: usize>(part: L, mut from: [L; N], to: [L; N]) -> [L; N] {
    let mut k = 0;
    while k < N {
        from[k] = part.mul_add(to[k] - from[k], from[k]);
        k += 1;
    }
    from
}

/// The product of complex numbers.
#[cfg_attr(not(debug_assertions), inline(always))]
fn product<L: Lanes>([a, b]: [L; 2], [c, d]: [L; 2]) -> [L; 2] {
    [b.neg_mul_add(d, a * c), b.mul_add(c, a * d)]
}

/// Where along the film radius points lie.
#[derive(Clone, Copy)]
struct Radius<L: Lanes> {
    /// Whether the table reaches so far.
    inside: L::Mask,
    /// In cells.
    s: L,
    /// Its whole part is the number of one of them.
    place: L,
}

/// Where in the table samples lie.
#[derive(Clone, Copy)]
struct Place<L: Lanes> {
    row: Row<L>,
    heading: Heading<L>,
}

/// Between which slices film radii lie.
#[derive(Clone, Copy)]
struct Row<L: Lanes> {
    /// Where in the table the slice before the film radius begins.
    slice: L::Places,
    /// Of the way from it to the next.
    part: L,
    /// c.
    center: L,
    /// γ.
    narrowing: L,
    /// β.
    bow: L,
}

/// Between which knots directions lie.
#[derive(Clone, Copy)]
struct Heading<L: Lanes> {
    /// The number of the one before.
    knot: L,
    /// From there to the direction, in knots.
    offset: L,
    /// d(knots)/dφ.
    turn: L,
    /// In the lower half, where the map is mirrored.
    below: L::Mask,
}

impl<L: Lanes> Heading<L> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn of(cpu: Cpu<L>, ray: &FilmRays<L>) -> Self {
        let ([x, y], [u, v]) = (ray.point, ray.disk);
        // The disk's point in the frame of the film point, mirrored into the upper half.
        let (a, b) = (v.mul_add(y, u * x), u.neg_mul_add(y, v * x));
        // Scaled so that squares and products count knots. On the axis, where there is no direction, any will do.
        let root = L::splat(cpu, L::Scalar::from_f64(ROOT));
        let per_span = root / (a.abs() + b.abs()).larger(L::splat(cpu, L::Scalar::NO_SQUARE));
        let (along, aside) = (a * per_span, b * per_span);
        let place = along.neg_mul_add(root, L::splat(cpu, L::Scalar::from_f64(ROOT * ROOT)));
        let knot = place.smaller(L::splat(cpu, L::Scalar::from_f64((CELLS - 1) as f64))).trunc();
        let turn = aside.mul_add(aside, along * along);
        Self { knot, offset: place - knot, turn, below: b.less(L::splat(cpu, L::Scalar::ZERO)) }
    }
}

/// What sampling computes with, in its precision.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LanePupil<S> {
    /// Cells a mm; where film is dark beyond, times their number.
    scale: S,
    /// Their number.
    fine: S,
    cover: LaneDisk<S>,
}

/// One sample by the processor's own fused multiplications.
struct OneSample<'a> {
    pupil: &'a WarpedPupil,
    film: [f64; 2],
    disk: [f64; 2],
    found: &'a mut PupilSample,
}

impl Compiled for OneSample<'_> {
    #[inline(always)]
    fn run(self) {
        let ([x, y], [u, v]) = (self.film, self.disk);
        let (point, disk) = ([Portable([x]), Portable([y])], [Portable([u]), Portable([v])]);
        let mut rays = [FilmRays { point, disk, slopes: disk, area_per_pi: Portable([0.0]) }];
        self.pupil.lanes(OneLane::cpu(), &self.pupil.lane_pupil(), &mut rays);
        let [FilmRays { slopes: [Portable([sx]), Portable([sy])], area_per_pi: Portable([area]), .. }] = rays;
        *self.found = PupilSample { slopes: [sx, sy], area: PI * area };
    }
}
