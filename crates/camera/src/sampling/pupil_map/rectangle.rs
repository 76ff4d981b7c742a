//! The pupils of the points of a rectangle of film, tabulated by x and y, for lenses and films without
//! rotational symmetry. Where both are symmetric in x, only points with x >= 0 are tabulated; a point on the
//! other side has the reflected pupil. The same holds for y.

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
    /// Whether points with negative x, and y, are reflected.
    reflects: [bool; 2],
    /// The tabulated rectangle.
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
    intervals: [usize; 2],
}

/// Points of the film in the tabulated rectangle.
#[derive(Clone, Copy)]
pub struct RectangleLocation<L: Lanes> {
    /// The points in the grid.
    grid: GridLocation<L>,
    /// -1 where x, and y, was reflected, else 1.
    signs: [L; 2],
}

impl<L: Lanes> RectangleLocation<L> {
    /// Lanes whose points lie inside the rectangle.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn inside(&self) -> L::Mask {
        self.grid.inside
    }

    /// Reflects vectors as the points were.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn reflected(&self, [x, y]: [L; 2]) -> [L; 2] {
        [x * self.signs[0], y * self.signs[1]]
    }
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
        self.intervals
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
        [mut corner, mut size]: [[f64; 2]; 2],
        [cover, exit]: [PupilDisk; 2],
    ) -> Self {
        let side = PupilFilmSide::new(path, film, [cover, exit]);
        // Half as many as over film radii: the table stays in a second-level cache, and is built in a quarter
        // of the time.
        let whole = (side.intervals() / 2).max(LEAST_INTERVALS);
        let (of_lens, of_film) = (path.symmetries(), surface.symmetries());
        let (mut reflects, mut intervals) = ([false; 2], [whole; 2]);
        for axis in 0..2 {
            let [low, high] = [corner[axis], corner[axis] + size[axis]];
            if of_lens[axis] && of_film[axis] && low < 0.0 && 0.0 < high {
                (reflects[axis], corner[axis]) = (true, 0.0);
                let part = high.max(-low) / size[axis];
                size[axis] *= part;
                intervals[axis] = (part * whole as f64).ceil() as usize;
            }
        }
        let family = Rectangle { side, surface: *surface, corner, size, intervals };
        let [along, columns] = intervals;
        let grid = Grid::new(&family);
        let covered = grid.gaps.iter().filter(|gap| gap.reason != MapFailure::Gaps).count();
        Self {
            reflects,
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
        [mut x, mut y]: [L; 2],
    ) -> RectangleLocation<L> {
        let number = |number: f64| L::splat(cpu, L::Scalar::from_f64(number));
        let (zero, one, [width, height]) = (number(0.0), number(1.0), self.size.map(number));
        let mut signs = [one; 2];
        if self.reflects[0] {
            (x, signs[0]) = (x.abs(), L::select(x.less(zero), zero - one, one));
        }
        if self.reflects[1] {
            (y, signs[1]) = (y.abs(), L::select(y.less(zero), zero - one, one));
        }
        let (along, up) = (x - number(self.corner[0]), y - number(self.corner[1]));
        let is_across = L::both(zero.less_equal(along), along.less_equal(width));
        let inside = L::both(is_across, L::both(zero.less_equal(up), up.less_equal(height)));
        // In this order NaN becomes 0.
        let along = along.larger(zero).smaller(width);
        let location = self.map.locate_in_rectangle(cpu, constants, along, up * number(self.per_mm));
        RectangleLocation { grid: GridLocation { inside, ..location }, signs }
    }

    /// Returns the slopes that correspond to points of the unit disk, at located points of the film, and the
    /// area per sample divided by π.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn at<L: Lanes>(
        &self,
        cpu: Cpu<L>,
        location: &RectangleLocation<L>,
        disk: [L; 2],
    ) -> ([L; 2], L) {
        let (slopes, area) = self.map.at(cpu, &location.grid, location.reflected(disk));
        (location.reflected(slopes), area)
    }

    /// Returns the areas per sample, divided by π, of rays with these slopes from located points of the film;
    /// NaN outside the pupil.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn areas<L: Lanes, const U: usize>(
        &self,
        cpu: Cpu<L>,
        locations: &[RectangleLocation<L>; U],
        slopes: &[[L; 2]; U],
    ) -> [L; U] {
        let (mut grid, mut points) = ([locations[0].grid; U], [locations[0].reflected(slopes[0]); U]);
        for u in 1..U {
            (grid[u], points[u]) = (locations[u].grid, locations[u].reflected(slopes[u]));
        }
        self.map.areas(cpu, &grid, &points)
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

    #[test]
    fn reflected_points_have_reflected_samples_where_lens_and_film_are_symmetric() {
        // A film that is tilted about the x axis is symmetric in x alone.
        let tilted = FilmSurface::new([0.0; 2], [4.0, 0.0], f64::INFINITY);
        for (name, surface, is_even) in
            [("dgauss.50mm", tilted, [true, false]), ("anamorphic.129mm", FilmSurface::FLAT, [true, true])]
        {
            let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
            let film = FirstOrder::of(&lens).expect("not afocal").rear_focal_point;
            let path = Path::film_to_scene(&lens);
            let disks = [PupilDisk::rear(&lens, film, 12.0).expect("behind"), PupilDisk::exit(&lens, film)];
            let pupil = PosedPupil::new(&path, film, &surface, [[-10.0, -6.0], [20.0, 14.0]], disks);
            let (mut passing, mut all) = (0, 0);
            for i in 0..2000_u32 {
                let at = |step: usize| (0.5 + f64::from(i) * STEPS[step]).fract();
                let (radius, angle) = (at(2).sqrt(), std::f64::consts::TAU * at(3));
                let disk = [radius * angle.cos(), radius * angle.sin()];
                let flat = [10.0 * at(0), 6.0 * at(1)];
                let (point, sample) = pupil.sample(flat, disk).expect("lit");
                for axis in 0..2 {
                    let reflected = |mut pair: [f64; 2]| {
                        pair[axis] = -pair[axis];
                        pair
                    };
                    let (other, image) = pupil.sample(reflected(flat), reflected(disk)).expect("lit");
                    let same = (reflected(other), reflected(image.slopes), image.area)
                        == (point, sample.slopes, sample.area);
                    assert_eq!(same, is_even[axis], "{name} {flat:?} {disk:?} {axis}");
                    all += 1;
                    passing += u32::from(path.trace(film_ray(other, film, image.slopes)).is_ok());
                }
            }
            assert!(passing > all * 95 / 100, "{name}: {passing} of {all}");
        }
    }
}
