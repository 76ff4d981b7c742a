//! What a plan is made for: a lens, the film behind it, where its pupil is sampled, and the error that is tolerated.

use super::tracing::Precision;
use crate::{
    lens::{Lens, refraction::Refraction},
    sampling::{Band, DiskMapping, PupilSample, PupilSampler},
    trace::Path,
};

/// Rings of the film that a disk's proof is cut into.
const RINGS: u32 = 4;

/// Where rays begin and how they are sampled.
pub(crate) struct FilmSide<'a> {
    /// z of the film, lens space, mm.
    pub z: f64,
    /// The largest distance from the axis at which rays are asked for, mm.
    pub reach: f64,
    /// The film point of the raster's corner (0, 0), mm.
    pub corner: [f64; 2],
    /// Width of a pixel, mm.
    pub pixel: f64,
    /// From lens samples to the unit disk.
    pub mapping: DiskMapping,
    /// From the unit disk to slopes.
    pub sampler: &'a PupilSampler,
}

/// What rays are wanted for.
pub(crate) struct Task<'a> {
    /// The lens.
    pub lens: &'a Lens,
    /// The lens from film to scene, by `refraction`.
    pub path: &'a Path,
    /// The film's side.
    pub film: FilmSide<'a>,
    /// z of the plane in focus, lens space, mm; may be infinite.
    pub in_focus: f64,
    /// The method of refraction asked for.
    pub refraction: Refraction,
    /// The precision asked for; `None` leaves it to the tolerance.
    pub precision: Option<Precision>,
    /// The error that is tolerated, pixels; 0 for none.
    pub tolerance: f64,
    /// Whether anything may be left out.
    pub leave_out: bool,
}

impl FilmSide<'_> {
    /// The film point, mm, and the pupil sample that four numbers in [0, 1] stand for; `None` where there is none.
    pub fn sample(&self, [x, y, u, v]: [f64; 4]) -> Option<([f64; 2], PupilSample)> {
        let point = [(1.0 - 2.0 * x) * self.corner[0], (1.0 - 2.0 * y) * self.corner[1]];
        let sample = self.sampler.sample(point, self.mapping.map(u, v)?)?;
        Some((point, sample))
    }

    /// Rings of the film with the slopes that are sampled there.
    pub fn bands(&self) -> Vec<Band> {
        match self.sampler {
            PupilSampler::Warped(pupil) => pupil.bands(),
            PupilSampler::Disk(disk) => {
                let center = disk.seen_from([1.0, 0.0]).center[0];
                let at = |ring: u32| self.reach * f64::from(ring) / f64::from(RINGS);
                let band = |ring| Band {
                    radii: [at(ring), at(ring + 1)],
                    center: [center; 2],
                    radius: disk.slope_radius(),
                };
                (0..RINGS).map(band).collect()
            }
        }
    }
}
