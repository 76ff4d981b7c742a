//! From samples to rays at the film, in lanes of either precision.

use crate::sampling::film_rays::FilmRays;
use std::sync::Arc;

use crate::trace::kernel::{Compiled, Cpu, Lanes, Portable, Simd};
use crate::{
    camera::{Film, Sample},
    sampling::{
        DiskMapping, PupilDisk, PupilSample, WarpedPupil, disk::Turns, pupil_disk::LaneDisk,
        warped::LanePupil,
    },
};

/// Where lens samples are drawn.
#[derive(Clone, Debug)]
pub(crate) enum Sampler {
    /// A disk about the axis.
    Disk(PupilDisk),
    /// The true pupil of each film point.
    Warped(Arc<WarpedPupil>),
}

impl Sampler {
    /// The slope for a point of the unit disk; `None` where the film is dark.
    pub fn draw(&self, film: [f64; 2], disk: [f64; 2]) -> Option<PupilSample> {
        match self {
            Self::Disk(pupil) => Some(pupil.sample(film, disk)),
            Self::Warped(pupil) => pupil.sample(film, disk),
        }
    }
}

/// A film and a sampler, ready for drawing in the precision `S`.
#[derive(Clone, Debug)]
pub(crate) struct Drawing<S> {
    /// Raster coordinates of the axis, in mm.
    middle: [S; 2],
    pixel: S,
    mapping: DiskMapping,
    pupil: Pupil<S>,
}

#[derive(Clone, Debug)]
enum Pupil<S> {
    Disk(LaneDisk<S>),
    Warped(Arc<WarpedPupil>, LanePupil<S>),
}

/// Samples.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Asked<L> {
    /// Raster points.
    pub image: [L; 2],
    /// Lens numbers.
    pub numbers: [L; 2],
}

impl<S: Turns> Drawing<S> {
    pub fn new(film: &Film, mapping: DiskMapping, sampler: &Sampler) -> Self {
        let pupil = match sampler {
            Sampler::Disk(disk) => Pupil::Disk(disk.lane_disk()),
            Sampler::Warped(pupil) => Pupil::Warped(pupil.clone(), pupil.lane_pupil()),
        };
        Self {
            middle: film.middle().map(|x| S::from_f64(x * film.pixel())),
            pixel: S::from_f64(film.pixel()),
            mapping,
            pupil,
        }
    }

    /// The film rays of `U` vectors of samples, side by side, so that one's look-ups overlap another's arithmetic.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn lanes<L: Lanes<Scalar = S>, const U: usize>(
        &self,
        cpu: Cpu<L>,
        asked: &[Asked<L>; U],
    ) -> [FilmRays<L>; U] {
        let mut rays = [self.unaimed(cpu, &asked[0]); U];
        for u in 1..U {
            rays[u] = self.unaimed(cpu, &asked[u]);
        }
        match &self.pupil {
            Pupil::Disk(pupil) => {
                for ray in &mut rays {
                    (ray.slopes, ray.area_per_pi) = pupil.lanes(cpu, ray.point, ray.disk);
                }
            }
            Pupil::Warped(pupil, frame) => pupil.lanes(cpu, frame, &mut rays),
        }
        rays
    }

    /// All of a film ray but its direction.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn unaimed<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, asked: &Asked<L>) -> FilmRays<L> {
        let pixel = L::splat(cpu, self.pixel);
        let [x, y] = asked.image;
        // `Film::point`.
        let point = [
            x.neg_mul_add(pixel, L::splat(cpu, self.middle[0])),
            y.mul_sub(pixel, L::splat(cpu, self.middle[1])),
        ];
        let disk = self.mapping.lanes(cpu, asked.numbers);
        FilmRays { point, disk, slopes: disk, area_per_pi: pixel }
    }

    /// The square of a sample's film radius, mm², as [`FilmRays::radius_squared`] has it.
    pub fn radius_squared(&self, sample: &Sample) -> S {
        let mut square = S::ZERO;
        Simd::best().run(Radius { drawing: self, sample, square: &mut square });
        square
    }

    /// The film ray of one sample, by the processor's own fused multiplications.
    pub fn one(&self, sample: &Sample) -> FilmRays<f64> {
        let none = [f64::NAN; 2];
        let mut ray = FilmRays { point: none, disk: none, slopes: none, area_per_pi: f64::NAN };
        Simd::best().run(One { drawing: self, sample, ray: &mut ray });
        ray
    }
}

impl Sample {
    /// One lane.
    fn lane<S: Turns>(&self) -> Asked<Portable<S, 1>> {
        let Self { image_x, image_y, lens_u, lens_v, .. } = *self;
        let [x, y, u, v] =
            [image_x, image_y, lens_u, lens_v].map(|number| Portable([S::from_f64(number.into())]));
        Asked { image: [x, y], numbers: [u, v] }
    }
}

struct Radius<'a, S> {
    drawing: &'a Drawing<S>,
    sample: &'a Sample,
    square: &'a mut S,
}

impl<S: Turns> Compiled for Radius<'_, S> {
    #[inline(always)]
    fn run(self) {
        let asked = self.sample.lane();
        let Portable([square]) = self.drawing.unaimed(Portable::cpu(), &asked).radius_squared();
        *self.square = square;
    }
}

struct One<'a, S> {
    drawing: &'a Drawing<S>,
    sample: &'a Sample,
    ray: &'a mut FilmRays<f64>,
}

impl<S: Turns> Compiled for One<'_, S> {
    #[inline(always)]
    fn run(self) {
        let asked = self.sample.lane();
        let [FilmRays { point, disk, slopes, area_per_pi }] = self.drawing.lanes(Portable::cpu(), &[asked]);
        let wide = |pair: [Portable<S, 1>; 2]| pair.map(|Portable([number])| number.to_f64());
        *self.ray = FilmRays {
            point: wide(point),
            disk: wide(disk),
            slopes: wide(slopes),
            area_per_pi: area_per_pi.0[0].to_f64(),
        };
    }
}
