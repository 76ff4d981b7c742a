//! The pupils of the points of a rectangle of film, by x and y: for lenses and films without an axis of symmetry.

use std::f64::consts::PI;

use super::{
    Grid, PupilFilmSide, PupilMap,
    pencil::{Family, Pencil},
};
use crate::sampling::pupil_disk::{PupilDisk, PupilSample};
use realistic_base::numeric::Real;
use realistic_optics::trace::Path;
use realistic_simd::{Compiled, Cpu, Lanes, OneLane, Portable, Simd};

/// The true pupil of every point of a rectangle of film. Immutable once built.
#[derive(Clone, Debug)]
pub struct RectanglePupil {
    corner: [f64; 2],
    /// Columns per mm.
    per_mm: f64,
    map: PupilMap,
}

/// Film points by x and y.
struct Rectangle {
    side: PupilFilmSide,
    corner: [f64; 2],
    size: [f64; 2],
}

impl Family for Rectangle {
    const SYMMETRIC: bool = false;
    const ENDS: bool = false;

    fn pencil(&self, x: f64, column: f64) -> impl Pencil + '_ {
        let columns = self.intervals()[1] as f64;
        self.side.at([self.corner[0] + x, self.corner[1] + self.size[1] * column / columns])
    }

    fn reach(&self) -> f64 {
        self.size[0]
    }

    fn intervals(&self) -> [usize; 2] {
        [self.side.intervals(); 2]
    }
}

impl RectanglePupil {
    /// Tabulates the pupils of film points from `corner` on, mm, up to `size` farther along x and y, on film at z =
    /// `film`. `cover` is a disk that holds all of them, `exit` the paraxial exit pupil.
    pub fn new(path: &Path, film: f64, [corner, size]: [[f64; 2]; 2], [cover, exit]: [PupilDisk; 2]) -> Self {
        let family = Rectangle { side: PupilFilmSide::new(path, film, [cover, exit]), corner, size };
        let per_mm = family.intervals()[1] as f64 / size[1];
        Self { corner, per_mm, map: PupilMap::new(&Grid::new(&family), Rectangle::SYMMETRIC) }
    }

    /// Returns the slope at a film point of the rectangle, mm, of the point `disk` of the unit disk.
    pub fn sample(&self, film: [f64; 2], disk: [f64; 2]) -> PupilSample {
        let mut found = PupilSample { slopes: [0.0; 2], area: f64::NAN };
        Simd::best().run(RectangleSample { pupil: self, film, disk, found: &mut found });
        found
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn at<L: Lanes<Scalar = f64>>(&self, cpu: Cpu<L>, [x, y]: [L; 2], disk: [L; 2]) -> ([L; 2], L) {
        let number = |number: f64| L::splat(cpu, f64::from_f64(number));
        let (along, column) =
            (x - number(self.corner[0]), (y - number(self.corner[1])) * number(self.per_mm));
        let location = self.map.locate_in_columns(cpu, &self.map.constants(), along, column);
        self.map.at(cpu, &location, disk)
    }
}

/// Computes one sample with the processor's own fused multiplications.
struct RectangleSample<'a> {
    pupil: &'a RectanglePupil,
    film: [f64; 2],
    disk: [f64; 2],
    found: &'a mut PupilSample,
}

impl Compiled for RectangleSample<'_> {
    #[inline(always)]
    fn run(self) {
        let [point, disk] = [self.film, self.disk].map(|pair| pair.map(|number| Portable([number])));
        let ([Portable([x]), Portable([y])], Portable([area])) = self.pupil.at(OneLane::cpu(), point, disk);
        *self.found = PupilSample { slopes: [x, y], area: PI * area };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::WarpedPupil;
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
        let rectangle = RectanglePupil::new(&path, film, [[1.0, -8.0], [13.0, 12.0]], disks);
        let passes = |point, slopes| path.trace(film_ray(point, film, slopes)).is_ok();
        for k in 0..20_u32 {
            let at = |step: f64| (0.5 + f64::from(k) * step).fract();
            let point = [1.0 + 13.0 * at(STEPS[0]), -8.0 + 12.0 * at(STEPS[1])];
            // Area of the pupil, and number of samples that pass, by either map.
            const SAMPLES: u32 = 4000;
            let (mut areas, mut passing) = ([0.0; 2], [0; 2]);
            for i in 0..SAMPLES {
                let at = |step: f64| (0.5 + f64::from(i) * step).fract();
                let (radius, angle) = (at(STEPS[2]).sqrt(), std::f64::consts::TAU * at(STEPS[3]));
                let disk = [radius * angle.cos(), radius * angle.sin()];
                let samples = [symmetric.sample(point, disk).expect("lit"), rectangle.sample(point, disk)];
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
