//! Tables of pupils at several values of a second parameter, one after the other, interpolated: a wavelength, or how near
//! points of the scene are.
//!
//! Each table is over h in units of its own end. Between two of them the end, C, γ, β and M are interpolated, at the same part of
//! the end. What comes out is again a map of the disk, with the Jacobian of its own: the area that a sample stands for is exact
//! whatever the tables.
//!
//! Near the image's end a crescent is narrower than its middle is known by two tables' straight line. So there, where tables
//! lie evenly, the end and C go from one to the next along a cubic, by the second differences δ² at both (Everett's formula:
//! -t (1 - t) ((2 - t) δ₀² + (1 + t) δ₁²)/6 is added at the part t of the way).

use std::iter::repeat_n;

use super::{
    Heading, LanePupil, Radius, Row, WarpedPupil,
    build::{Builder, Course, FINE, Layout, Layouts, cover_alike},
    grain,
    pencil::Family,
    toward,
};
use crate::{
    numeric::Real,
    sampling::{film_rays::FilmRays, pupil_disk::PupilDisk},
    trace::kernel::{Cpu, Lanes, Scalar},
};

/// Second differences of numbers; those at both ends as the parabola through the next three, or as many as there are, leads to.
fn second_differences(numbers: &[f64]) -> Vec<f64> {
    let mut all: Vec<f64> = numbers.windows(3).map(|of| of[0] - 2.0 * of[1] + of[2]).collect();
    let beyond = |near: [Option<&f64>; 3]| match near.map(Option::<&f64>::copied) {
        [Some(a), Some(b), Some(c)] => 3.0 * (a - b) + c,
        [Some(a), Some(b), None] => 2.0 * a - b,
        [a, ..] => a.unwrap_or(0.0),
    };
    let first = beyond([0, 1, 2].map(|k| all.get(k)));
    let last = beyond([1, 2, 3].map(|k| all.len().checked_sub(k).and_then(|k| all.get(k))));
    all.insert(0, first);
    all.push(last);
    all
}

/// What Everett's formula multiplies t (1 - t) (2 - t) and t (1 - t) (1 + t) by, of numbers at tables one after the other.
fn bends(numbers: &[f64]) -> Vec<f64> {
    second_differences(numbers).into_iter().map(|second| second / -6.0).collect()
}

/// Everett's factors ([`bends`]) of C in each cell of one of some tables: at the slice below, and the step to the next slice.
fn bends_of_center(layouts: &[Layout], number: usize, grain: usize) -> impl Iterator<Item = [f32; 2]> + '_ {
    let at = move |place: f64| {
        let centers: Vec<f64> = layouts.iter().map(|layout| layout.center(place)).collect();
        bends(&centers)[number] as f32
    };
    // Just within the interval, for the next may be given up.
    let inside = |place: usize, inward: f64| (place as f64 + 1e-6 * inward) / FINE as f64;
    layouts[number].intervals.iter().flat_map(move |interval| {
        let [low, high] = [at(inside(interval.from, 1.0)), at(inside(interval.to, -1.0))];
        repeat_n([low, high - low], interval.cells(grain))
    })
}

/// Tables one after the other.
#[derive(Clone, Debug)]
pub(crate) struct Stack {
    /// Intervals between the tables.
    intervals: f64,
    /// Two pairs of each table: its end and the step to the next; the bends of both.
    ends: Vec<[f32; 2]>,
    /// Of each cell of each table, and one more: what C bends by toward the next table, at the slice below, and the step to the
    /// next slice; none where C goes straight from table to table.
    center_bends: Vec<[f32; 2]>,
    /// All of them, over h in units of each one's end.
    tables: WarpedPupil,
}

impl Stack {
    /// Of two tables or more, of which all end or none, and what they were built from. Their maps are made larger by `margin`,
    /// relative, for what lies between two tables. `beyond` is what is sampled beyond tables that do not end.
    pub fn of<F: Family>(
        builders: &[Builder<F>],
        Layouts { tables: mut layouts, course }: Layouts,
        margin: f64,
        beyond: PupilDisk,
    ) -> Self {
        cover_alike(&mut layouts, builders);
        let ends: Vec<f64> = layouts.iter().map(|layout| layout.scale.end).collect();
        let layouts: Vec<Layout> =
            layouts.into_iter().map(|layout| layout.in_units_of_its_end(margin)).collect();
        let grain = layouts.iter().map(|layout| grain(&layout.intervals)).min().unwrap_or(FINE);
        let (mut center_bends, mut end_bends) = (Vec::new(), vec![0.0; ends.len()]);
        if course == Course::Curved && layouts[0].scale.dark_beyond {
            end_bends = bends(&ends);
            center_bends =
                (0..ends.len()).flat_map(|number| bends_of_center(&layouts, number, grain)).collect();
            // A look-up reads two.
            center_bends.push([0.0; 2]);
        }
        let last = ends.len() - 1;
        let pairs = |number: usize| {
            let both = [number, (number + 1).min(last)];
            let ([from, to], bends) = (both.map(|number| ends[number]), both.map(|number| end_bends[number]));
            [[from, to - from], bends].map(|pair| pair.map(|number| number as f32))
        };
        let ends = (0..=last).flat_map(pairs).collect();
        let tables = layouts.into_iter().zip(builders);
        let tables = tables
            .map(|(layout, builder)| WarpedPupil::pack(layout, grain, beyond, builder.side.work().rays()));
        Self { intervals: last as f64, ends, center_bends, tables: joined(tables) }
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
        // t (1 - t) (2 - t) and t (1 - t) (1 + t).
        let curve = part.neg_mul_add(part, part);
        let (curve, next_curve) = (part.neg_mul_add(curve, curve + curve), part.mul_add(curve, curve));
        let [[end, step, bend, next_bend]] = L::look_up::<1, 2>(&self.ends, table.whole(), [0]);
        let end = next_curve.mul_add(next_bend, curve.mul_add(bend, part.mul_add(step, end)));
        let per_end = number(1.0) / end;
        ray.point = [ray.point[0] * per_end, ray.point[1] * per_end];
        let radius = self.tables.radius(cpu, constants, ray);
        let fine = L::splat(cpu, constants.fine);
        let below = L::add_places((table * fine).whole(), radius.place.whole());
        let beyond = L::add_places(below, fine.whole());
        let (mut row, above) = (self.tables.row(cpu, below, &radius), self.tables.row(cpu, beyond, &radius));
        [row.center, row.narrowing, row.bow] =
            toward(part, [row.center, row.narrowing, row.bow], [above.center, above.narrowing, above.bow]);
        if !self.center_bends.is_empty() {
            for (curve, cell, part) in [(curve, below, row.part), (next_curve, beyond, above.part)] {
                let [[bend, step, ..]] = L::look_up::<1, 1>(&self.center_bends, cell, [0]);
                row.center = curve.mul_add(part.mul_add(step, bend), row.center);
            }
        }
        Between { table, part, radius, row, above }
    }

    /// M at the two knots beside a direction, interpolated between slices and tables.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn knots_between<L: Lanes>(&self, between: &Between<L>, heading: &Heading<L>) -> [L; 4] {
        let below = self.tables.knots(&between.row, heading);
        toward(between.part, below, self.tables.knots(&between.above, heading))
    }

    /// M at the bounds of the sector with this number, interpolated between slices and tables.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn bounds_between<L: Lanes>(
        &self,
        cpu: Cpu<L>,
        between: &Between<L>,
        sector: usize,
    ) -> [L; 4] {
        let below = self.tables.bounds(cpu, &between.row, sector);
        toward(between.part, below, self.tables.bounds(cpu, &between.above, sector))
    }

    /// Cells of each table.
    pub(super) fn cells(&self) -> usize {
        self.tables.fine
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
    /// Of the table before, but for c, γ and β, which are those in between.
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
        all.bows.extend(table.bows);
        all.table.extend(table.table);
    }
    all
}
