//! Many samples at once: blocks that fit the first cache, as structure of arrays.

use super::{Sample, WorldRay};

/// Samples of a block.
pub const BLOCK: usize = 256;

/// A block of samples, as structure of arrays.
#[derive(Clone, Debug)]
pub struct SampleBlock {
    /// Raster x.
    pub image_x: [f32; BLOCK],
    /// Raster y.
    pub image_y: [f32; BLOCK],
    /// First lens number.
    pub lens_u: [f32; BLOCK],
    /// Second lens number.
    pub lens_v: [f32; BLOCK],
    /// Time number.
    pub time: [f32; BLOCK],
}

impl SampleBlock {
    /// A block of zeros.
    pub const fn new() -> Self {
        let zero = [0.0; BLOCK];
        Self { image_x: zero, image_y: zero, lens_u: zero, lens_v: zero, time: zero }
    }

    /// Puts a sample at a place below [`BLOCK`].
    #[inline]
    pub fn set(&mut self, i: usize, sample: &Sample) {
        let Sample { image_x, image_y, lens_u, lens_v, time } = *sample;
        self.image_x[i] = image_x;
        self.image_y[i] = image_y;
        self.lens_u[i] = lens_u;
        self.lens_v[i] = lens_v;
        self.time[i] = time;
    }

    /// The sample at a place below [`BLOCK`].
    #[inline]
    pub fn get(&self, i: usize) -> Sample {
        Sample {
            image_x: self.image_x[i],
            image_y: self.image_y[i],
            lens_u: self.lens_u[i],
            lens_v: self.lens_v[i],
            time: self.time[i],
        }
    }
}

impl Default for SampleBlock {
    fn default() -> Self {
        Self::new()
    }
}

/// What becomes of a block of samples, as structure of arrays.
#[derive(Clone, Debug)]
pub struct RayBlock {
    /// Origins, world units: x, y and z.
    pub origin: [[f32; BLOCK]; 3],
    /// Unit directions.
    pub direction: [[f32; BLOCK]; 3],
    /// Where each begins.
    pub mint: [f32; BLOCK],
    /// Where each ends.
    pub maxt: [f32; BLOCK],
    /// When each is.
    pub time: [f32; BLOCK],
    /// Weights: positive, or 0 where there is no ray and the other numbers mean nothing.
    pub weight: [f32; BLOCK],
}

impl RayBlock {
    /// A block without rays.
    pub const fn new() -> Self {
        let zero = [0.0; BLOCK];
        Self { origin: [zero; 3], direction: [zero; 3], mint: zero, maxt: zero, time: zero, weight: zero }
    }

    /// Puts a ray, or none, at a place below [`BLOCK`].
    #[inline]
    pub fn set(&mut self, i: usize, ray: Option<(WorldRay, f32)>) {
        let Some((WorldRay { origin, direction, mint, maxt, time }, weight)) = ray else {
            self.weight[i] = 0.0;
            return;
        };
        for axis in 0..3 {
            self.origin[axis][i] = origin[axis];
            self.direction[axis][i] = direction[axis];
        }
        self.mint[i] = mint;
        self.maxt[i] = maxt;
        self.time[i] = time;
        self.weight[i] = weight;
    }

    /// The ray at a place below [`BLOCK`], with its weight.
    #[inline]
    pub fn get(&self, i: usize) -> Option<(WorldRay, f32)> {
        let ray = WorldRay {
            origin: [0, 1, 2].map(|axis| self.origin[axis][i]),
            direction: [0, 1, 2].map(|axis| self.direction[axis][i]),
            mint: self.mint[i],
            maxt: self.maxt[i],
            time: self.time[i],
        };
        (self.weight[i] > 0.0).then_some((ray, self.weight[i]))
    }
}

impl Default for RayBlock {
    fn default() -> Self {
        Self::new()
    }
}
