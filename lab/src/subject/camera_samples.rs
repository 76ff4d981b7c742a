//! Rays as a camera requests them: from anywhere on the camera's film to its sampled pupil, including rays that an
//! aperture blocks.

use std::collections::BTreeMap;

use realistic_camera::sampling::{DiskMapping, PupilDisk, PupilSample, WarpedPupil};
use realistic_optics::{
    lens::film_ray,
    trace::{Blocked, Ray},
};

use super::{PIXELS, Subject, quasirandom::spread};

/// The region that a camera samples as the pupil.
#[derive(Clone, Debug)]
enum SampledPupil {
    Rear(PupilDisk),
    Warped(Box<WarpedPupil>),
}

/// A film and a pupil to sample.
#[derive(Clone, Debug)]
pub struct CameraSamples<'a> {
    subject: &'a Subject,
    pupil: SampledPupil,
    /// Surfaces whose apertures block samples and must be part of polynomials, numbered from the scene; the front
    /// surface is not among them.
    pub apertures: Vec<usize>,
}

/// Number of rays used to find the apertures.
const LOOKED_AT: usize = 20_000;
/// Share of rays that an aperture may block without being listed; the planner uses the same value.
const OVERLOOKED: f64 = 5e-5;
/// Maximum samples tried per ray.
const PATIENCE: usize = 1000;

impl<'a> CameraSamples<'a> {
    /// Samples the true pupil, a camera's default: very few rays are blocked.
    pub fn of_warped(subject: &'a Subject) -> Self {
        Self::of(subject, SampledPupil::Warped(Box::new(subject.warped_pupil())))
    }

    /// Samples the rear element's disk, as a camera with `pupil=rear` does, so that the lens's own apertures cause the
    /// vignetting.
    pub fn of_rear(subject: &'a Subject) -> Self {
        Self::of(subject, SampledPupil::Rear(subject.rear))
    }

    fn of(subject: &'a Subject, pupil: SampledPupil) -> Self {
        let mut own = Self { subject, pupil, apertures: Vec::new() };
        let last = subject.lens.surfaces.len() - 1;
        let mut blocked = BTreeMap::<usize, usize>::new();
        for ray in own.rays(LOOKED_AT, 2) {
            let walk = subject.path.walk(ray);
            if walk.blocked == Some(Blocked::Clipped) && walk.surfaces_met > 0 {
                *blocked.entry(last + 1 - walk.surfaces_met).or_default() += 1;
            }
        }
        // The front's aperture can be tested at no extra cost.
        blocked.remove(&0);
        let overlooked = OVERLOOKED * LOOKED_AT as f64;
        own.apertures =
            blocked.into_iter().filter(|(_, count)| *count as f64 > overlooked).map(|(at, _)| at).collect();
        own
    }

    /// Returns rays from all over the film's pixels. Another `seed` gives other rays. Returns fewer than `count` if
    /// most of the film is dark.
    pub fn rays(&self, count: usize, seed: u32) -> Vec<Ray> {
        let pixels = [PIXELS.xres, PIXELS.yres].map(f64::from);
        spread::<4>(f64::from(seed) * 0.618_033_988_749_894_9)
            .take(PATIENCE * count)
            .filter_map(|[x, y, u, v]| {
                self.ray(self.subject.film.point(x * pixels[0], y * pixels[1]), [u, v])
            })
            .take(count)
            .collect()
    }

    /// Returns rays from one film point, mm.
    pub fn rays_from(&self, point: [f64; 2], count: usize) -> Vec<Ray> {
        spread::<2>(0.0).take(count).filter_map(|uv| self.ray(point, uv)).collect()
    }

    fn ray(&self, point: [f64; 2], [u, v]: [f64; 2]) -> Option<Ray> {
        let disk = DiskMapping::Concentric.map(u, v)?;
        let PupilSample { slopes, .. } = match &self.pupil {
            SampledPupil::Rear(rear) => rear.sample(point, disk),
            SampledPupil::Warped(warped) => warped.sample(point, disk)?,
        };
        Some(film_ray(point, self.subject.film_z, slopes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_optics::prescription::catalogue;

    #[test]
    fn camera_samples_reach_the_corners_and_are_blocked_rightly() {
        let subject = Subject::new(&catalogue::find("wide.22mm").expect("listed")).expect("focuses");
        let (warped, rear) = (CameraSamples::of_warped(&subject), CameraSamples::of_rear(&subject));
        let passing = |samples: &CameraSamples<'_>| {
            let rays = samples.rays(2000, 1);
            assert_eq!(rays.len(), 2000);
            let reach = rays.iter().map(|ray| ray.origin[0].hypot(ray.origin[1])).fold(0.0, f64::max);
            assert!(reach > 0.95 * subject.film.diagonal() / 2.0, "{reach}");
            rays.iter().filter(|ray| subject.path.trace(**ray).is_ok()).count()
        };
        assert!(passing(&warped) > 1950);
        // The lens blocks most of the rear element's disk.
        let through = passing(&rear);
        assert!((20..1500).contains(&through), "{through}");
        assert!(!rear.apertures.is_empty() && warped.apertures.len() <= rear.apertures.len());
        assert!(rear.apertures.iter().all(|&at| at > 0 && at < subject.lens.surfaces.len()));
    }
}
