//! Samples and rays in columns that own their memory.

use std::array;

use realistic::{Camera, Rays, Sample, Samples, WorldRay};

/// Samples in columns.
#[derive(Clone, Debug)]
pub struct SampleColumns([Vec<f32>; 5]);

impl SampleColumns {
    /// Allocates `count` samples, all 0.
    pub fn new(count: usize) -> Self {
        Self(array::from_fn(|_| vec![0.0; count]))
    }

    /// Copies existing samples into columns.
    pub fn of(samples: &[Sample]) -> Self {
        let mut columns = Self::new(samples.len());
        samples.iter().enumerate().for_each(|(i, sample)| columns.set(i, sample));
        columns
    }

    /// Writes a sample at an index.
    ///
    /// # Panics
    /// The index is out of range.
    pub fn set(&mut self, i: usize, sample: &Sample) {
        let Sample { image_x, image_y, lens_u, lens_v, time } = *sample;
        for (column, number) in self.0.iter_mut().zip([image_x, image_y, lens_u, lens_v, time]) {
            column[i] = number;
        }
    }

    /// Returns the sample at an index.
    ///
    /// # Panics
    /// The index is out of range.
    pub fn get(&self, i: usize) -> Sample {
        self.all().get(i)
    }

    /// Returns all samples, to pass to a camera.
    pub fn all(&self) -> Samples<'_> {
        self.first(self.0[0].len())
    }

    /// Returns the first `count` samples.
    ///
    /// # Panics
    /// `count` exceeds the length.
    pub fn first(&self, count: usize) -> Samples<'_> {
        Samples::columns(self.0.each_ref().map(|column| &column[..count]))
    }
}

/// Rays with their ranges and times, in columns.
#[derive(Clone, Debug)]
pub struct RayColumns([Vec<f32>; 10]);

impl RayColumns {
    /// Allocates `count` rays, all empty.
    pub fn new(count: usize) -> Self {
        Self(array::from_fn(|_| vec![0.0; count]))
    }

    /// Returns all columns, to pass to a camera.
    pub fn all(&mut self) -> Rays<'_> {
        self.first(self.0[0].len())
    }

    /// Returns the first `count` rays.
    ///
    /// # Panics
    /// `count` exceeds the length.
    pub fn first(&mut self, count: usize) -> Rays<'_> {
        let [ox, oy, oz, dx, dy, dz, weight, mint, maxt, time] =
            self.0.each_mut().map(|column| &mut column[..count]);
        Rays::columns([ox, oy, oz], [dx, dy, dz], weight).with_range([mint, maxt]).with_time(time)
    }

    /// Returns the columns of neighbouring rays, without ranges and times.
    pub fn neighbours(&mut self) -> Rays<'_> {
        let [ox, oy, oz, dx, dy, dz, weight, ..] = self.0.each_mut().map(Vec::as_mut_slice);
        Rays::columns([ox, oy, oz], [dx, dy, dz], weight)
    }

    /// Returns the weight at an index: 0 if there is no ray.
    ///
    /// # Panics
    /// The index is out of range.
    pub fn weight(&self, i: usize) -> f32 {
        self.0[6][i]
    }

    /// Returns the ray at an index, with its weight.
    ///
    /// # Panics
    /// The index is out of range.
    pub fn get(&self, i: usize) -> Option<(WorldRay, f32)> {
        let (ray, weight) = self.numbers(i);
        (weight > 0.0).then_some((ray, weight))
    }

    /// Returns the values at an index, even if they are not a ray.
    ///
    /// # Panics
    /// The index is out of range.
    pub fn numbers(&self, i: usize) -> (WorldRay, f32) {
        let [ox, oy, oz, dx, dy, dz, weight, mint, maxt, time] = self.0.each_ref().map(|column| column[i]);
        (WorldRay { origin: [ox, oy, oz], direction: [dx, dy, dz], mint, maxt, time }, weight)
    }

    /// Writes a ray, or none, at an index.
    ///
    /// # Panics
    /// The index is out of range.
    pub fn set(&mut self, i: usize, ray: Option<(WorldRay, f32)>) {
        let (WorldRay { origin: [ox, oy, oz], direction: [dx, dy, dz], mint, maxt, time }, weight) =
            ray.unwrap_or_default();
        for (column, number) in self.0.iter_mut().zip([ox, oy, oz, dx, dy, dz, weight, mint, maxt, time]) {
            column[i] = number;
        }
    }
}

/// A source of rays at a given wavelength.
pub trait RayAt {
    /// Returns the ray of a sample at a wavelength, nm, with its weight; `None` if it is blocked.
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
