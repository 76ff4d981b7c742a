//! Tables of pupils at several values of a second parameter, one after the other, interpolated: a wavelength, or how near
//! points of the scene are.
//!
//! Each table is over h in units of its own end. Between two of them the end, C, λ, β and M are interpolated, at the same part of
//! the end. What comes out is again a map of the disk, with the Jacobian of its own: the density is exact whatever the
//! tables.
//!
//! As the wavelength changes the pupil of a film point moves and grows a little, and with it the image on the film. At a
//! given part of the image's radius it changes almost in proportion to the glasses' indices, which themselves change almost
//! in proportion to w = 1/(λ² - 0.028), λ in µm (M. Herzberger, *Optica Acta* 6, 1959). So a [`SpectralPupil`]'s tables lie
//! evenly in w.

use super::{
    Heading, LanePupil, Radius, Row, WarpedPupil,
    build::{Builder, FINE, Layout, cover_alike},
    pencil::{Family, FilmPencils},
    toward,
};
use crate::{
    numeric::Real,
    prescription::glass::HERZBERGER,
    sampling::{film_rays::FilmRays, pupil_disk::PupilDisk},
    trace::kernel::{Cpu, Lanes, Scalar},
};

/// Tables one after the other.
#[derive(Clone, Debug)]
pub(crate) struct Stack {
    /// Intervals between the tables.
    intervals: f64,
    /// Each table's end, and its step to the next.
    ends: Vec<[f32; 2]>,
    /// All of them, over h in units of each one's end.
    tables: WarpedPupil,
}

impl Stack {
    /// Of two tables or more, of which all end or none, and what they were built from. Their maps are made larger by `margin`,
    /// relative, for what lies between two tables. `beyond` is what is sampled beyond tables that do not end.
    pub fn of<F: Family>(
        builders: &[Builder<F>],
        mut layouts: Vec<Layout>,
        margin: f64,
        beyond: PupilDisk,
    ) -> Self {
        cover_alike(&mut layouts, builders);
        let ends: Vec<f64> = layouts.iter().map(|layout| layout.scale.end).collect();
        let tables = layouts.into_iter().zip(builders);
        let tables = tables.map(|(layout, builder)| {
            WarpedPupil::pack(layout.in_units_of_its_end(margin), beyond, builder.side.work().rays())
        });
        let last = ends.len() - 1;
        let next = |number: usize| ends[(number + 1).min(last)];
        let steps = ends.iter().enumerate();
        let ends = steps.map(|(number, end)| [*end as f32, (next(number) - end) as f32]).collect();
        Self { intervals: last as f64, ends, tables: joined(tables) }
    }

    /// What sampling computes with, in the precision of the lanes.
    pub fn lane_pupil<S: Scalar>(&self) -> LanePupil<S> {
        self.tables.lane_pupil()
    }

    /// Gives rays at a place, a number of tables, their slopes and area. Where there is nothing to sample the area is NaN.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn aim<L: Lanes>(
        &self,
        cpu: Cpu<L>,
        constants: &LanePupil<L::Scalar>,
        place: L,
        ray: &mut FilmRays<L>,
    ) {
        let point = ray.point;
        let between = self.between(cpu, constants, place, ray);
        let heading = Heading::of(cpu, ray);
        let knots = self.knots_between(&between, &heading);
        self.aim_between(cpu, &between, &heading, knots, ray);
        ray.point = point;
        let inside = between.radius.inside;
        if !L::all(inside) {
            self.tables.cover(cpu, constants, inside, ray);
        }
    }

    /// Between which maps rays at a place lie; takes their points to units of the end there.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn between<L: Lanes>(
        &self,
        cpu: Cpu<L>,
        constants: &LanePupil<L::Scalar>,
        place: L,
        ray: &mut FilmRays<L>,
    ) -> Between<L> {
        let number = |number: f64| L::splat(cpu, L::Scalar::from_f64(number));
        // In this order what is no number becomes 0.
        let place = place.larger(number(0.0)).smaller(number(self.intervals));
        let table = place.smaller(number(self.intervals - 1.0)).trunc();
        let part = place - table;
        let [[end, step, ..]] = L::look_up::<1, 1>(&self.ends, table.whole(), [0]);
        let per_end = number(1.0) / part.mul_add(step, end);
        ray.point = [ray.point[0] * per_end, ray.point[1] * per_end];
        let radius = self.tables.radius(cpu, constants, ray);
        let fine = number(FINE as f64);
        let below = L::add_places((table * fine).whole(), radius.place.whole());
        let mut row = self.tables.row(cpu, below, &radius);
        let above: Row<L> = self.tables.row(cpu, L::add_places(below, fine.whole()), &radius);
        [row.center, row.narrowing, row.bow] =
            toward(part, [row.center, row.narrowing, row.bow], [above.center, above.narrowing, above.bow]);
        Between { table, part, radius, row, above }
    }

    /// M at the two knots beside a direction, interpolated between slices and tables.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn knots_between<L: Lanes>(&self, between: &Between<L>, heading: &Heading<L>) -> [L; 4] {
        let below = self.tables.knots(&between.row, heading);
        toward(between.part, below, self.tables.knots(&between.above, heading))
    }

    /// Gives rays their slopes and area by what stands in the tables for them, over units of the end.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn aim_between<L: Lanes>(
        &self,
        cpu: Cpu<L>,
        between: &Between<L>,
        heading: &Heading<L>,
        knots: [L; 4],
        ray: &mut FilmRays<L>,
    ) {
        self.tables.aim_at(cpu, &between.row, heading, knots, ray);
    }
}

/// Between which tables, and in each of them between which slices, rays lie.
#[derive(Clone, Copy)]
pub(super) struct Between<L: Lanes> {
    /// The number of the table before, and how far from it to the next.
    pub table: L,
    pub part: L,
    pub radius: Radius<L>,
    /// Of the table before, but for c, λ and β, which are those in between.
    pub row: Row<L>,
    /// Of the next.
    above: Row<L>,
}

/// Tables one after the other, over h in units of each one's end.
fn joined(mut tables: impl Iterator<Item = WarpedPupil>) -> WarpedPupil {
    let mut all = tables.next().expect("a table");
    for table in tables {
        let before = all.table.len() as u32;
        all.cells.extend(table.cells.iter().map(|cell| {
            let mut cell = *cell;
            cell.index += before;
            cell
        }));
        all.narrowings.extend(table.narrowings);
        all.rests.extend(table.rests);
        all.table.extend(table.table);
    }
    all
}

/// The true pupil of every point of a film, at every wavelength of a range. Immutable once built.
#[derive(Clone, Debug)]
pub(crate) struct SpectralPupil {
    /// w of the first table.
    first: f64,
    /// Tables per w.
    per_w: f64,
    tables: Stack,
}

/// Intervals between the tables.
const INTERVALS: usize = 4;
/// The same where the image ends within reach: a crescent is so narrow there that its place in the image has to be known
/// better than its width.
const WITH_END: usize = 16;
/// By how much maps are larger than what was found: more is blocked, less leaves out light between two wavelengths.
const MARGIN: f64 = 6e-4;
/// How much farther out the image is followed where it ends within reach at some wavelengths and not at others.
const FARTHER: [f64; 3] = [1.02, 1.1, 1.5];

/// w of a wavelength, nm.
fn w(wavelength: f64) -> f64 {
    ((wavelength * 1e-3).powi(2) - HERZBERGER).recip()
}

impl SpectralPupil {
    /// For wavelengths from `shortest` to `longest`, nm, and film points up to `reach` mm from the axis: `side` is the film's side
    /// of the lens at a wavelength, as far out as a reach. `None` where the images at these wavelengths are not alike.
    pub fn new(
        [shortest, longest]: [f64; 2],
        reach: f64,
        side: impl Fn(f64, f64) -> Option<FilmPencils>,
    ) -> Option<Self> {
        let (first, last) = (w(longest), w(shortest));
        // Numbered as those of the finest division.
        let wavelength = |number: usize| {
            let w = first + (last - first) * number as f64 / WITH_END as f64;
            1e3 * (w.recip() + HERZBERGER).sqrt()
        };
        let table = |number: usize, reach: f64| {
            let builder = Builder::new(side(wavelength(number), reach)?);
            let layout = builder.layout();
            Some((number, builder, layout))
        };
        let mut tables = Vec::with_capacity(WITH_END + 1);
        for number in (0..=WITH_END).step_by(WITH_END / INTERVALS) {
            tables.push(table(number, reach)?);
        }
        let mut intervals = INTERVALS;
        // An image ends everywhere or nowhere.
        if tables.iter().any(|(.., layout)| layout.scale.dark_beyond) {
            intervals = WITH_END;
            for number in (0..=WITH_END).filter(|number| number % (WITH_END / INTERVALS) != 0) {
                tables.push(table(number, reach)?);
            }
            tables.sort_by_key(|(number, ..)| *number);
            for known in &mut tables {
                let mut farther = FARTHER.iter();
                while !known.2.scale.dark_beyond {
                    *known = table(known.0, reach * farther.next()?)?;
                }
            }
        }
        let beyond = tables[0].1.side.disk();
        let (builders, layouts): (Vec<_>, Vec<_>) =
            tables.into_iter().map(|(_, builder, layout)| (builder, layout)).unzip();
        let tables = Stack::of(&builders, layouts, MARGIN, beyond);
        Some(Self { first, per_w: intervals as f64 / (last - first), tables })
    }

    /// What sampling computes with, in the precision of the lanes.
    pub fn lane_pupil<S: Scalar>(&self) -> LaneSpectralPupil<S> {
        LaneSpectralPupil {
            first: S::from_f64(self.first),
            per_w: S::from_f64(self.per_w),
            pupil: self.tables.lane_pupil(),
        }
    }

    /// Gives rays of wavelengths in nm their slopes and area. Where there is nothing to sample the area is NaN.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn lanes<L: Lanes, const U: usize>(
        &self,
        cpu: Cpu<L>,
        constants: &LaneSpectralPupil<L::Scalar>,
        wavelengths: &[L; U],
        rays: &mut [FilmRays<L>; U],
    ) {
        for u in 0..U {
            self.aim(cpu, constants, wavelengths[u], &mut rays[u]);
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn aim<L: Lanes>(
        &self,
        cpu: Cpu<L>,
        constants: &LaneSpectralPupil<L::Scalar>,
        wavelength: L,
        ray: &mut FilmRays<L>,
    ) {
        let number = |number: f64| L::splat(cpu, L::Scalar::from_f64(number));
        let one = L::splat(cpu, L::Scalar::ONE);
        let micrometres = wavelength * number(1e-3);
        let w = one / micrometres.mul_sub(micrometres, number(HERZBERGER));
        let place = (w - L::splat(cpu, constants.first)) * L::splat(cpu, constants.per_w);
        self.tables.aim(cpu, &constants.pupil, place, ray);
    }
}

/// What sampling computes with, in its precision.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LaneSpectralPupil<S> {
    first: S,
    per_w: S,
    pupil: LanePupil<S>,
}
