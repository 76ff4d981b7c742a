//! Samples and rays as columns of one's own.

use std::array;

use realistic::{Camera, Rays, Sample, Samples, WorldRay};

/// Samples, as columns.
#[derive(Clone, Debug)]
pub struct SampleColumns([Vec<f32>; 5]);

impl SampleColumns {
    /// Room for so many, all 0.
    pub fn new(count: usize) -> Self {
        Self(array::from_fn(|_| vec![0.0; count]))
    }

    /// Samples that there are already.
    pub fn of(samples: &[Sample]) -> Self {
        let mut columns = Self::new(samples.len());
        samples.iter().enumerate().for_each(|(i, sample)| columns.set(i, sample));
        columns
    }

    /// Puts a sample at an index.
    ///
    /// # Panics
    /// There is no such index.
    pub fn set(&mut self, i: usize, sample: &Sample) {
        let Sample { image_x, image_y, lens_u, lens_v, time } = *sample;
        for (column, number) in self.0.iter_mut().zip([image_x, image_y, lens_u, lens_v, time]) {
            column[i] = number;
        }
    }

    /// The sample at an index.
    ///
    /// # Panics
    /// There is no such index.
    pub fn get(&self, i: usize) -> Sample {
        self.all().get(i)
    }

    /// All of them, for a camera.
    pub fn all(&self) -> Samples<'_> {
        self.first(self.0[0].len())
    }

    /// The first `count`.
    ///
    /// # Panics
    /// There are fewer.
    pub fn first(&self, count: usize) -> Samples<'_> {
        Samples::columns(self.0.each_ref().map(|column| &column[..count]))
    }
}

/// Room for rays with their ranges and times, as columns.
#[derive(Clone, Debug)]
pub struct RayColumns([Vec<f32>; 10]);

impl RayColumns {
    /// Room for so many, without a ray.
    pub fn new(count: usize) -> Self {
        Self(array::from_fn(|_| vec![0.0; count]))
    }

    /// All of it, for a camera.
    pub fn all(&mut self) -> Rays<'_> {
        self.first(self.0[0].len())
    }

    /// Room for the first `count`.
    ///
    /// # Panics
    /// There are fewer.
    pub fn first(&mut self, count: usize) -> Rays<'_> {
        let [ox, oy, oz, dx, dy, dz, weight, mint, maxt, time] =
            self.0.each_mut().map(|column| &mut column[..count]);
        Rays::columns([ox, oy, oz], [dx, dy, dz], weight).with_range([mint, maxt]).with_time(time)
    }

    /// Room for as many neighbours, without ranges and times.
    pub fn neighbours(&mut self) -> Rays<'_> {
        let [ox, oy, oz, dx, dy, dz, weight, ..] = self.0.each_mut().map(Vec::as_mut_slice);
        Rays::columns([ox, oy, oz], [dx, dy, dz], weight)
    }

    /// The weight at an index: 0 where there is no ray.
    ///
    /// # Panics
    /// There is no such index.
    pub fn weight(&self, i: usize) -> f32 {
        self.0[6][i]
    }

    /// The ray at an index, with its weight.
    ///
    /// # Panics
    /// There is no such index.
    pub fn get(&self, i: usize) -> Option<(WorldRay, f32)> {
        let (ray, weight) = self.numbers(i);
        (weight > 0.0).then_some((ray, weight))
    }

    /// What stands at an index, whether it is a ray or not.
    ///
    /// # Panics
    /// There is no such index.
    pub fn numbers(&self, i: usize) -> (WorldRay, f32) {
        let [ox, oy, oz, dx, dy, dz, weight, mint, maxt, time] = self.0.each_ref().map(|column| column[i]);
        (WorldRay { origin: [ox, oy, oz], direction: [dx, dy, dz], mint, maxt, time }, weight)
    }

    /// Puts a ray, or none, at an index.
    ///
    /// # Panics
    /// There is no such index.
    pub fn set(&mut self, i: usize, ray: Option<(WorldRay, f32)>) {
        let (WorldRay { origin: [ox, oy, oz], direction: [dx, dy, dz], mint, maxt, time }, weight) =
            ray.unwrap_or_default();
        for (column, number) in self.0.iter_mut().zip([ox, oy, oz, dx, dy, dz, weight, mint, maxt, time]) {
            column[i] = number;
        }
    }
}

/// A ray at a wavelength.
pub trait RayAt {
    /// The ray of a sample at a wavelength, nm, with its weight; `None` where there is none.
    fn ray_at(&self, sample: &Sample, wavelength: f32) -> Option<(WorldRay, f32)>;
}

impl RayAt for Camera {
    fn ray_at(&self, sample: &Sample, wavelength: f32) -> Option<(WorldRay, f32)> {
        let (mut ray, mut weight) = Default::default();
        let samples = Samples::of(sample);
        self.trace(&samples.at(&[wavelength]), &mut Rays::of(&mut ray, &mut weight));
        (weight > 0.0).then_some((ray, weight))
    }
}
