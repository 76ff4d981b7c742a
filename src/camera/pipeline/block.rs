//! Many samples at once, as structure of arrays: a caller's own, and blocks that fit the first cache.

use crate::camera::{Sample, WorldRay};

/// Samples of a block: as many as fill three of any vectors a whole number of times.
pub const BLOCK: usize = 384;

/// Samples, as structure of arrays of one length.
#[derive(Clone, Copy, Debug)]
pub struct SampleArrays<'a> {
    /// Raster x.
    pub image_x: &'a [f32],
    /// Raster y.
    pub image_y: &'a [f32],
    /// First lens numbers.
    pub lens_u: &'a [f32],
    /// Second lens numbers.
    pub lens_v: &'a [f32],
    /// Time numbers.
    pub time: &'a [f32],
}

impl SampleArrays<'_> {
    /// The number of samples.
    ///
    /// # Panics
    /// The arrays differ in length.
    pub(crate) fn checked_len(&self) -> usize {
        let n = self.image_x.len();
        let same = [self.image_y, self.lens_u, self.lens_v, self.time].iter().all(|array| array.len() == n);
        assert!(same, "the arrays of a batch must have one length");
        n
    }

    /// The sample at a place.
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

    /// Those from `first` on, `count` of them.
    ///
    /// # Panics
    /// There are not so many.
    pub fn part(&self, first: usize, count: usize) -> Self {
        let Self { image_x, image_y, lens_u, lens_v, time } = *self;
        let [image_x, image_y, lens_u, lens_v, time] =
            [image_x, image_y, lens_u, lens_v, time].map(|array| &array[first..first + count]);
        Self { image_x, image_y, lens_u, lens_v, time }
    }
}

/// What becomes of samples, as structure of arrays of one length. Where there is no ray only the weight is written.
#[derive(Debug)]
pub struct RayArrays<'a> {
    /// Origins, world units: x, y and z.
    pub origin: [&'a mut [f32]; 3],
    /// Unit directions.
    pub direction: [&'a mut [f32]; 3],
    /// Where each begins, if asked for.
    pub mint: Option<&'a mut [f32]>,
    /// Where each ends, if asked for.
    pub maxt: Option<&'a mut [f32]>,
    /// When each is, if asked for.
    pub time: Option<&'a mut [f32]>,
    /// Weights: positive, or 0 where there is no ray.
    pub weight: &'a mut [f32],
}

impl RayArrays<'_> {
    /// The number of rays.
    ///
    /// # Panics
    /// The arrays differ in length.
    pub(crate) fn checked_len(&self) -> usize {
        let n = self.weight.len();
        let given = [&self.mint, &self.maxt, &self.time];
        let same = self.origin.iter().chain(&self.direction).all(|array| array.len() == n)
            && given.into_iter().flatten().all(|array| array.len() == n);
        assert!(same, "the arrays of a batch must have one length");
        n
    }

    /// Puts a ray, or none, at a place.
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
        for (array, number) in [(&mut self.mint, mint), (&mut self.maxt, maxt), (&mut self.time, time)] {
            if let Some(array) = array {
                array[i] = number;
            }
        }
        self.weight[i] = weight;
    }
}

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

    /// The first `n` samples.
    ///
    /// # Panics
    /// `n` is more than [`BLOCK`].
    pub fn arrays(&self, n: usize) -> SampleArrays<'_> {
        let Self { image_x, image_y, lens_u, lens_v, time } = self;
        let [image_x, image_y, lens_u, lens_v, time] =
            [image_x, image_y, lens_u, lens_v, time].map(|array| &array[..n]);
        SampleArrays { image_x, image_y, lens_u, lens_v, time }
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

    /// Room for `n` rays.
    ///
    /// # Panics
    /// `n` is more than [`BLOCK`].
    pub fn arrays(&mut self, n: usize) -> RayArrays<'_> {
        RayArrays {
            origin: self.origin.each_mut().map(|array| &mut array[..n]),
            direction: self.direction.each_mut().map(|array| &mut array[..n]),
            mint: Some(&mut self.mint[..n]),
            maxt: Some(&mut self.maxt[..n]),
            time: Some(&mut self.time[..n]),
            weight: &mut self.weight[..n],
        }
    }

    /// The ray at a place below [`BLOCK`], with its weight.
    #[inline]
    pub fn get(&self, i: usize) -> Option<(WorldRay, f32)> {
        (self.weight[i] > 0.0).then(|| (self.ray(i), self.weight[i]))
    }

    /// The numbers at a place below [`BLOCK`], which mean nothing where the weight is 0.
    #[inline(always)]
    pub fn ray(&self, i: usize) -> WorldRay {
        let Self { origin: [ox, oy, oz], direction: [dx, dy, dz], mint, maxt, time, .. } = self;
        let (origin, direction) = ([ox[i], oy[i], oz[i]], [dx[i], dy[i], dz[i]]);
        WorldRay { origin, direction, mint: mint[i], maxt: maxt[i], time: time[i] }
    }
}

impl Default for RayBlock {
    fn default() -> Self {
        Self::new()
    }
}
