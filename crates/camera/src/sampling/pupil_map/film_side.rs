//! The rays of film points, from which the maps of the pupils are built.

use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use super::pencil::{Family, Pencil};
use crate::sampling::pupil_disk::PupilDisk;
use realistic_optics::{lens::pupil::SlopeDisk, trace::Path};
use realistic_trace::kernel::{ClearanceTracer, FilmRay};

/// Smallest film radius that a map covers, mm. It is much less than a wavelength, yet large enough for finite
/// differences on film of zero width.
const LEAST_REACH: f64 = 1e-6;

/// The rays on the film's side of a lens.
pub struct PupilFilmSide {
    clearances: ClearanceTracer,
    intervals: usize,
    cover: PupilDisk,
    exit: PupilDisk,
    rays: AtomicU32,
}

impl PupilFilmSide {
    /// Prepares film at z = `film`, behind the lens. `cover` is a disk that contains every pupil; `exit` is
    /// the paraxial exit pupil.
    pub fn new(path: &Path, film: f64, [cover, exit]: [PupilDisk; 2]) -> Self {
        let path = path.clone().with_circles();
        let (clearances, intervals) = (ClearanceTracer::new(&path, film), intervals(&path));
        Self { clearances, intervals, cover, exit, rays: AtomicU32::new(0) }
    }

    /// Returns the number of rays traced so far.
    pub fn rays(&self) -> u32 {
        self.rays.load(Relaxed)
    }

    /// Returns the number of intervals of a grid over film points.
    pub fn intervals(&self) -> usize {
        self.intervals
    }

    /// Returns the pencil of a film point, mm, that lies `ahead` mm in front of the plane through the film's
    /// centre perpendicular to the axis.
    pub fn at(&self, point: [f64; 2], ahead: f64) -> FilmPencil<'_> {
        FilmPencil { side: self, point, ahead }
    }
}

/// Returns the number of intervals of film radius. Fewer intervals block more samples and miss more light;
/// more intervals take longer to build.
///
/// Each interval takes about 5,000 rays. A table for a path through 1,000 interfaces takes less than a
/// second.
pub fn intervals(path: &Path) -> usize {
    match path.work() {
        0..=240 => 32,
        241..=1200 => 16,
        _ => 4,
    }
}

/// Film points identified by their distance from the axis of a rotationally symmetric lens, mm.
pub struct FilmRadii {
    side: PupilFilmSide,
    reach: f64,
}

impl FilmRadii {
    /// Prepares film points up to `reach` mm from the axis.
    pub fn new(side: PupilFilmSide, reach: f64) -> Self {
        Self { side, reach: reach.max(LEAST_REACH) }
    }

    /// Returns the number of rays traced so far.
    pub fn rays(&self) -> u32 {
        self.side.rays()
    }
}

impl Family for FilmRadii {
    const SYMMETRIC: bool = true;
    const ENDS: bool = true;

    fn pencil(&self, radius: f64, _: f64) -> impl Pencil + '_ {
        self.side.at([radius, 0.0], 0.0)
    }

    fn reach(&self) -> f64 {
        self.reach
    }

    fn intervals(&self) -> [usize; 2] {
        [self.side.intervals, 0]
    }
}

/// The rays of a film point, identified by their slopes.
pub struct FilmPencil<'a> {
    side: &'a PupilFilmSide,
    point: [f64; 2],
    ahead: f64,
}

impl Pencil for FilmPencil<'_> {
    fn excesses(&self, slopes: &[[f64; 2]]) -> Vec<f64> {
        let ([x, y], ahead) = (self.point, self.ahead);
        let on_plane = |[sx, sy]: [f64; 2]| [x - ahead * sx, y - ahead * sy];
        let rays = slopes.iter().map(|&slopes| FilmRay { point: on_plane(slopes), slopes });
        self.side.rays.fetch_add(slopes.len() as u32, Relaxed);
        self.side.clearances.excesses(rays)
    }

    fn cover(&self) -> SlopeDisk {
        self.side.cover.seen_from_ahead(self.point, self.ahead)
    }

    fn guess(&self) -> SlopeDisk {
        let guess = self.side.exit.seen_from_ahead(self.point, self.ahead);
        // Film may extend as far as an exit pupil that lies behind the lens.
        if guess.radius > 0.0 { guess } else { self.cover() }
    }
}
