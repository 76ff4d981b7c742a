//! The pupils of the points of a rectangle of film, tabulated by x and y, for lenses and films without
//! rotational symmetry.

use super::{
    Grid, GridLocation, MapConstants, MapFailure, PupilFilmSide, PupilMap,
    pencil::{Family, Pencil},
};
use crate::sampling::{film_surface::FilmSurface, pupil_disk::PupilDisk};
use realistic_base::numeric::Real;
use realistic_optics::trace::Path;
use realistic_simd::{Cpu, Lanes, Scalar};

/// Least number of intervals along x and along y.
const LEAST_INTERVALS: usize = 4;

/// The true pupil of every point of a rectangle of film. Immutable once built.
#[derive(Clone, Debug)]
pub struct RectanglePupil {
    corner: [f64; 2],
    size: [f64; 2],
    /// Number of columns per mm.
    per_mm: f64,
    map: PupilMap,
    covered: f64,
}

/// Film points identified by x and y of the flat film.
struct Rectangle {
    side: PupilFilmSide,
    surface: FilmSurface,
    corner: [f64; 2],
    size: [f64; 2],
}

impl Family for Rectangle {
    const SYMMETRIC: bool = false;
    const ENDS: bool = false;

    fn pencil(&self, x: f64, column: f64) -> impl Pencil + '_ {
        let columns = self.intervals()[1] as f64;
        let flat = [self.corner[0] + x, self.corner[1] + self.size[1] * column / columns];
        let (point, ahead) = self.surface.point(flat);
        self.side.at(point, ahead)
    }

    fn reach(&self) -> f64 {
        self.size[0]
    }

    fn intervals(&self) -> [usize; 2] {
        // Half as many as over film radii: the table stays in a second-level cache, and is built in a quarter
        // of the time.
        [(self.side.intervals() / 2).max(LEAST_INTERVALS); 2]
    }
}

impl RectanglePupil {
    /// Tabulates the pupils of the points of a rectangle of the flat film. `corner` is the rectangle's corner
    /// with the smallest x and y, mm; `size` is its extent along x and y. `surface` places the flat film in
    /// space, about z = `film`. `cover` is a disk that contains all pupils; `exit` is the paraxial exit
    /// pupil.
    pub fn new(
        path: &Path,
        film: f64,
        surface: &FilmSurface,
        [corner, size]: [[f64; 2]; 2],
        [cover, exit]: [PupilDisk; 2],
    ) -> Self {
        let side = PupilFilmSide::new(path, film, [cover, exit]);
        let family = Rectangle { side, surface: *surface, corner, size };
        let [along, columns] = family.intervals();
        let grid = Grid::new(&family);
        let covered = grid.gaps.iter().filter(|gap| gap.reason != MapFailure::Gaps).count();
        Self {
            corner,
            size,
            per_mm: columns as f64 / size[1],
            map: PupilMap::new(&grid, Rectangle::SYMMETRIC),
            covered: covered as f64 / (along * columns) as f64,
        }
    }

    /// Returns the fraction of the rectangle for which `cover` is sampled instead of the pupil, because light
    /// gets through in several components or not at all.
    pub fn covered(&self) -> f64 {
        self.covered
    }

    /// Returns the constants of look-ups.
    pub(crate) fn constants<S: Scalar>(&self) -> MapConstants<S> {
        self.map.constants()
    }

    /// Locates points of the flat film, mm. Points outside the rectangle are located at its edge.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn locate<L: Lanes>(
        &self,
        cpu: Cpu<L>,
        constants: &MapConstants<L::Scalar>,
        [x, y]: [L; 2],
    ) -> GridLocation<L> {
        let number = |number: f64| L::splat(cpu, L::Scalar::from_f64(number));
        let (zero, [width, height]) = (number(0.0), self.size.map(number));
        let (along, up) = (x - number(self.corner[0]), y - number(self.corner[1]));
        let is_across = L::both(zero.less_equal(along), along.less_equal(width));
        let inside = L::both(is_across, L::both(zero.less_equal(up), up.less_equal(height)));
        // In this order NaN becomes 0.
        let along = along.larger(zero).smaller(width);
        let location = self.map.locate_in_rectangle(cpu, constants, along, up * number(self.per_mm));
        GridLocation { inside, ..location }
    }

    /// Returns the slopes that correspond to points of the unit disk, at located points of the film, and the
    /// area per sample divided by π.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn at<L: Lanes>(&self, cpu: Cpu<L>, location: &GridLocation<L>, disk: [L; 2]) -> ([L; 2], L) {
        self.map.at(cpu, location, disk)
    }

    /// Returns the areas per sample, divided by π, of rays with these slopes from located points of the film;
    /// NaN outside the pupil.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn areas<L: Lanes, const U: usize>(
        &self,
        cpu: Cpu<L>,
        locations: &[GridLocation<L>; U],
        slopes: &[[L; 2]; U],
    ) -> [L; U] {
        self.map.areas(cpu, locations, slopes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{WarpedPupil, posed_pupil::PosedPupil};
    use realistic_base::numeric::STEPS;
    use realistic_optics::{
        lens::{Lens, film_ray, first_order::FirstOrder},
        prescription::catalogue,
    };

    #[test]
    fn a_film_moved_aside_has_the_pupils_of_the_symmetric_grid() {
        let lens = Lens::at_d_line(&catalogue::find("dgauss.50mm").expect("listed"));
        let film = FirstOrder::of(&lens).expect("not afocal").rear_focal_point;
        let (path, reach) = (Path::film_to_scene(&lens), 18.0);
        let disks = [PupilDisk::rear(&lens, film, reach).expect("behind"), PupilDisk::exit(&lens, film)];
        let symmetric = WarpedPupil::new(&path, film, reach, disks);
        let rectangle = PosedPupil::new(&path, film, &FilmSurface::FLAT, [[1.0, -8.0], [13.0, 12.0]], disks);
        let passes = |point, slopes| path.trace(film_ray(point, film, slopes)).is_ok();
        for k in 0..20_u32 {
            let at = |step: f64| (0.5 + f64::from(k) * step).fract();
            let point = [1.0 + 13.0 * at(STEPS[0]), -8.0 + 12.0 * at(STEPS[1])];
            // The area of the pupil, and the number of samples that pass, for each of the two maps.
            const SAMPLES: u32 = 4000;
            let (mut areas, mut passing) = ([0.0; 2], [0; 2]);
            for i in 0..SAMPLES {
                let at = |step: f64| (0.5 + f64::from(i) * step).fract();
                let (radius, angle) = (at(STEPS[2]).sqrt(), std::f64::consts::TAU * at(STEPS[3]));
                let disk = [radius * angle.cos(), radius * angle.sin()];
                let samples = [
                    symmetric.sample(point, disk).expect("lit"),
                    rectangle.sample(point, disk).expect("lit").1,
                ];
                for (which, sample) in samples.iter().enumerate() {
                    if passes(point, sample.slopes) {
                        areas[which] += sample.area / f64::from(SAMPLES);
                        passing[which] += 1;
                    }
                }
            }
            assert!((areas[1] / areas[0] - 1.0).abs() < 2e-3, "{point:?}: {areas:?}");
            assert!(passing[1] > SAMPLES * 98 / 100, "{point:?}: {passing:?}");
        }
    }
}
