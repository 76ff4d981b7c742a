//! The warped pupil at any wavelength of a range: tables at a few wavelengths in, the map between them out.
//!
//! As the wavelength changes the pupil of a film point moves and grows a little, and with it the image on the film. At a
//! given part of the image's radius it changes almost in proportion to the glasses' indices, which themselves change almost
//! in proportion to w = 1/(λ² - 0.028), λ in µm (M. Herzberger, *Optica Acta* 6, 1959). So the tables lie evenly in w, each
//! over film radii in units of its own end; between two of them the end, C, λ and M are interpolated in w. What comes out is
//! again a map of the disk, with the Jacobian of its own: the density is exact whatever the tables.

use super::{Heading, LanePupil, Row, STRIDE, WarpedPupil, build::FINE};
use crate::{
    numeric::Real,
    prescription::glass::HERZBERGER,
    sampling::{film_rays::FilmRays, pupil_disk::PupilDisk},
    trace::kernel::{Cpu, Lanes, Scalar},
};

/// The true pupil of every point of a film, at every wavelength of a range. Immutable once built.
#[derive(Clone, Debug)]
pub(crate) struct SpectralPupil {
    /// w of the first table.
    first: f64,
    /// Tables per w.
    per_w: f64,
    /// Intervals between the tables.
    intervals: f64,
    /// 1/end of each table, 1/mm, and its step to the next.
    per_end: Vec<[f32; 2]>,
    /// All tables one after the other, over film radii in units of each one's end.
    tables: WarpedPupil,
}

/// Intervals between the tables.
const INTERVALS: usize = 4;
/// The same where the image ends within reach: a crescent is so narrow there that its place in the image has to be known
/// better than its width.
const WITH_END: usize = 16;
/// By how much a table's maps are larger than the pupil at its wavelength, relative to what they are: for the curvature in
/// between.
const MARGIN: f64 = 6e-4;
/// How much farther out the image is followed where it ends within reach at some wavelengths and not at others.
const FARTHER: [f64; 3] = [1.02, 1.1, 1.5];

/// w of a wavelength, nm.
fn w(wavelength: f64) -> f64 {
    ((wavelength * 1e-3).powi(2) - HERZBERGER).recip()
}

impl SpectralPupil {
    /// For wavelengths from `shortest` to `longest`, nm, and film points up to `reach` mm from the axis: `table` is the
    /// pupil at a wavelength as far out as a reach. `None` where the images at these wavelengths are not alike.
    pub fn new(
        [shortest, longest]: [f64; 2],
        reach: f64,
        table: impl Fn(f64, f64) -> Option<WarpedPupil>,
    ) -> Option<Self> {
        let (first, last) = (w(longest), w(shortest));
        // Numbered as those of the finest division.
        let wavelength = |number: usize| {
            let w = first + (last - first) * number as f64 / WITH_END as f64;
            1e3 * (w.recip() + HERZBERGER).sqrt()
        };
        let mut tables = Vec::with_capacity(WITH_END + 1);
        for number in (0..=WITH_END).step_by(WITH_END / INTERVALS) {
            tables.push((number, table(wavelength(number), reach)?));
        }
        let mut intervals = INTERVALS;
        // An image ends everywhere or nowhere.
        if tables.iter().any(|(_, table)| table.dark_beyond) {
            intervals = WITH_END;
            for number in (0..=WITH_END).filter(|number| number % (WITH_END / INTERVALS) != 0) {
                tables.push((number, table(wavelength(number), reach)?));
            }
            tables.sort_by_key(|(number, _)| *number);
            for (number, table_at) in &mut tables {
                let mut farther = FARTHER.iter();
                while !table_at.dark_beyond {
                    *table_at = table(wavelength(*number), reach * farther.next()?)?;
                }
            }
        }
        let tables: Vec<WarpedPupil> = tables.into_iter().map(|(_, table)| table).collect();
        let ends: Vec<f64> = tables.iter().map(|table| table.end.recip()).collect();
        let next = |number: usize| ends[(number + 1).min(intervals)];
        let per_end = ends.iter().enumerate();
        let per_end = per_end.map(|(number, end)| [*end as f32, (next(number) - end) as f32]).collect();
        let cover = tables[0].cover;
        Some(Self {
            first,
            per_w: intervals as f64 / (last - first),
            intervals: intervals as f64,
            per_end,
            tables: joined(tables, cover),
        })
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
        let (zero, one) = (L::splat(cpu, L::Scalar::ZERO), L::splat(cpu, L::Scalar::ONE));
        let micrometres = wavelength * number(1e-3);
        let w = one / micrometres.mul_sub(micrometres, number(HERZBERGER));
        // In this order what is no number becomes 0.
        let place = ((w - L::splat(cpu, constants.first)) * L::splat(cpu, constants.per_w)).larger(zero);
        let place = place.smaller(number(self.intervals));
        let table = place.smaller(number(self.intervals - 1.0)).trunc();
        let part = place - table;
        let [[per_end, step, ..]] = L::look_up::<1, 1>(&self.per_end, table.whole(), [0]);
        let per_end = part.mul_add(step, per_end);
        let point = ray.point;
        ray.point = [point[0] * per_end, point[1] * per_end];
        let radius = self.tables.radius(cpu, &constants.pupil, ray);
        let heading = Heading::of(cpu, ray);
        let fine = number(FINE as f64);
        let below = L::add_places((table * fine).whole(), radius.place.whole());
        let mut row = self.tables.row(cpu, below, &radius);
        let mut knots = self.tables.knots(&row, &heading);
        let above: Row<L> = self.tables.row(cpu, L::add_places(below, fine.whole()), &radius);
        let knots_above = self.tables.knots(&above, &heading);
        row.center = part.mul_add(above.center - row.center, row.center);
        row.narrowing = part.mul_add(above.narrowing - row.narrowing, row.narrowing);
        row.bow = part.mul_add(above.bow - row.bow, row.bow);
        let mut k = 0;
        while k < 4 {
            knots[k] = part.mul_add(knots_above[k] - knots[k], knots[k]);
            k += 1;
        }
        self.tables.aim_at(cpu, &row, &heading, knots, ray);
        ray.point = point;
        if !L::all(radius.inside) {
            self.tables.cover(cpu, &constants.pupil, radius.inside, ray);
        }
    }
}

/// Tables one after the other, over film radii in units of each one's end.
fn joined(tables: Vec<WarpedPupil>, cover: PupilDisk) -> WarpedPupil {
    let tables = covered_alike(tables);
    let mut tables = tables.into_iter();
    let mut all = tables.next().expect("a table").in_units_of_its_end();
    for table in tables {
        let table = table.in_units_of_its_end();
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
    WarpedPupil { cover, ..all }
}

/// The tables, each of which samples a disk wherever one of them does: between a disk and a pupil lies no map that holds the
/// pupils in between.
fn covered_alike(mut tables: Vec<WarpedPupil>) -> Vec<WarpedPupil> {
    let cells = tables[0].cells.len();
    let is_covered: Vec<bool> =
        (0..cells).map(|cell| tables.iter().any(|table| table.is_covered(cell))).collect();
    if is_covered.contains(&true) {
        for table in &mut tables {
            table.cover_cells(&is_covered);
        }
    }
    tables
}

impl WarpedPupil {
    /// Whether the rear element's disk is sampled in a smallest interval.
    fn is_covered(&self, cell: usize) -> bool {
        let slice = self.cells[cell].index as usize;
        let disk = [self.cover.slope_radius() as f32, 0.0];
        self.table[slice..slice + 2 * STRIDE].iter().all(|factor| *factor == disk)
    }

    /// Samples the rear element's disk in these smallest intervals.
    fn cover_cells(&mut self, is_covered: &[bool]) {
        let index = self.table.len() as u32;
        let center = self.cover.seen_from([1.0, 0.0]).center[0] as f32;
        self.table.extend([[self.cover.slope_radius() as f32, 0.0]; 2 * STRIDE]);
        for (cell, _) in is_covered.iter().enumerate().filter(|(_, is_covered)| **is_covered) {
            self.cells[cell].index = index;
            self.cells[cell].numbers[1..].copy_from_slice(&[center, 0.0]);
            for pairs in [&mut self.narrowings, &mut self.rests] {
                if let Some(pairs) = pairs.get_mut(2 * cell..2 * cell + 2) {
                    pairs.fill([0.0; 2]);
                }
            }
        }
    }

    /// The same over film radii in units of its end, a little larger.
    fn in_units_of_its_end(mut self) -> Self {
        let (end, grown) = (self.end as f32, 1.0 + MARGIN as f32);
        for cell in &mut self.cells {
            cell.numbers[1] *= end;
            cell.numbers[2] *= end;
        }
        for pairs in self.narrowings.chunks_exact_mut(2) {
            pairs[0] = pairs[0].map(|narrowing| narrowing * end * end);
            pairs[1] = pairs[1].map(|bow| bow * end * end * end);
        }
        for rest in &mut self.rests {
            *rest = rest.map(|center| center * end);
        }
        for factor in &mut self.table {
            *factor = factor.map(|part| part * grown);
        }
        Self { end: 1.0, ..self }
    }
}

/// What sampling computes with, in its precision.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LaneSpectralPupil<S> {
    first: S,
    per_w: S,
    pupil: LanePupil<S>,
}
