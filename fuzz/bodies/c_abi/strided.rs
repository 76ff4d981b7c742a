//! Batches with arrays of any strides: they have the bits of single calls, and nothing is written outside the elements.

use std::array;

use super::{MARK, bytes::Bytes};
use realistic::ffi::*;

/// Initial content of output arrays.
const BEFORE: f32 = -7.0;

/// An array of `N` components per sample, which may be interleaved, planar, or interleaved in reverse order, and has
/// gaps.
struct Strided<const N: usize> {
    floats: Vec<f32>,
    first: isize,
    stride: isize,
    component_stride: isize,
}

impl<const N: usize> Strided<N> {
    fn new(count: usize, bytes: &mut Bytes<'_>) -> Self {
        let gap = bytes.choice(3);
        let floats = vec![BEFORE; (N + gap) * (count + gap)];
        let (width, height) = ((N + gap) as isize, (count + gap) as isize);
        let (first, stride, component_stride) = match bytes.choice(3) {
            0 => (0, width, 1),
            1 => (0, 1, height),
            _ => (width * height - width, -width, 1),
        };
        Self { floats, first, stride, component_stride }
    }

    fn of(numbers: impl ExactSizeIterator<Item = [f32; N]>, bytes: &mut Bytes<'_>) -> Self {
        let mut all = Self::new(numbers.len(), bytes);
        for (i, numbers) in numbers.enumerate() {
            for (k, number) in numbers.into_iter().enumerate() {
                let index = all.index(i, k);
                all.floats[index] = number;
            }
        }
        all
    }

    fn index(&self, i: usize, component: usize) -> usize {
        let index = self.first + i as isize * self.stride + component as isize * self.component_stride;
        usize::try_from(index).expect("inside")
    }

    fn get(&self, i: usize) -> [f32; N] {
        array::from_fn(|component| self.floats[self.index(i, component)])
    }

    /// Returns the offsets of the first element's components from the beginning of the array, counted in numbers, and
    /// the stride between elements, in bytes.
    fn layout(&self) -> ([isize; 3], isize) {
        let offsets = [0, 1, 2].map(|k| self.first + k * self.component_stride);
        (offsets, self.stride * size_of::<f32>() as isize)
    }

    fn input(&self) -> realistic_input {
        let (offsets, stride) = self.layout();
        let [x, y, z] = offsets.map(|offset| self.floats.as_ptr().wrapping_offset(offset));
        realistic_input { x, y, z, stride }
    }

    fn output(&mut self) -> realistic_output {
        let (offsets, stride) = self.layout();
        let [x, y, z] = offsets.map(|offset| self.floats.as_mut_ptr().wrapping_offset(offset));
        realistic_output { x, y, z, stride }
    }

    /// Returns the count of written numbers, including those in gaps.
    fn written(&self) -> usize {
        self.floats.iter().filter(|number| number.to_bits() != BEFORE.to_bits()).count()
    }
}

/// A ray, its weight, and its neighbours if they were requested: origin, direction and weight.
pub type Found = ((realistic_ray, f32), Option<[([f32; 3], [f32; 3], f32); 2]>);

/// Returns the rays of samples through arrays whose layout depends on `bytes`; if there are wavelengths, each sample
/// has its own. Blocked rays equal [`MARK`].
pub fn rays(
    camera: *const realistic_camera,
    samples: &[realistic_sample],
    wavelengths: Option<&[f32]>,
    bytes: &mut Bytes<'_>,
) -> Vec<(realistic_ray, f32)> {
    found(camera, samples, wavelengths, false, bytes).into_iter().map(|(ray, _)| ray).collect()
}

/// Returns the rays of [`rays`], with neighbours if they are requested.
pub fn found(
    camera: *const realistic_camera,
    samples: &[realistic_sample],
    wavelengths: Option<&[f32]>,
    with_neighbours: bool,
    bytes: &mut Bytes<'_>,
) -> Vec<Found> {
    let n = samples.len();
    let image = Strided::of(samples.iter().map(|sample| [sample.image_x, sample.image_y]), bytes);
    let lens = Strided::of(samples.iter().map(|sample| [sample.lens_u, sample.lens_v]), bytes);
    let time = Strided::of(samples.iter().map(|sample| [sample.time]), bytes);
    let wavelengths = wavelengths.map(|all| Strided::of(all.iter().map(|one| [*one]), bytes));
    let [mut origin, mut direction] = [(); 2].map(|()| Strided::<3>::new(n, bytes));
    let [mut weight, mut mint, mut maxt, mut ray_time] = [(); 4].map(|()| Strided::<1>::new(n, bytes));
    let mut beside: Option<[_; 2]> = with_neighbours.then(|| {
        array::from_fn(|_| {
            let [origin, direction] = [(); 2].map(|()| Strided::<3>::new(n, bytes));
            (origin, direction, Strided::<1>::new(n, bytes))
        })
    });
    let [[rx_origin, rx_direction, rx_weight], [ry_origin, ry_direction, ry_weight]] = match &mut beside {
        Some(beside) => beside
            .each_mut()
            .map(|(origin, direction, weight)| [origin.output(), direction.output(), weight.output()]),
        None => [[realistic_output::NONE; 3]; 2],
    };
    let mut reasons = vec![realistic_reason::Ok; n];
    let request = realistic_request {
        image: image.input(),
        lens: lens.input(),
        time: time.input(),
        wavelength: wavelengths.as_ref().map_or(realistic_input::NONE, Strided::input),
        origin: origin.output(),
        direction: direction.output(),
        weight: weight.output(),
        mint: mint.output(),
        maxt: maxt.output(),
        ray_time: ray_time.output(),
        reason: reasons.as_mut_ptr(),
        reason_stride: size_of::<realistic_reason>() as isize,
        rx_origin,
        rx_direction,
        rx_weight,
        ry_origin,
        ry_direction,
        ry_weight,
        ..realistic_request::default()
    };
    // SAFETY: the camera is live, and the arrays have room for `n` elements at these strides.
    let status = unsafe { realistic_camera_generate_batch(camera, n, &request) };
    assert_eq!(status, realistic_status::Ok);
    let found: Vec<_> = (0..n)
        .map(|i| {
            let [[mint], [maxt], [time], [weight]] =
                [mint.get(i), maxt.get(i), ray_time.get(i), weight.get(i)];
            assert_eq!(reasons[i] == realistic_reason::Ok, weight > 0.0, "{:?}", samples[i]);
            let ray = realistic_ray { o: origin.get(i), d: direction.get(i), mint, maxt, time };
            let beside = beside.as_ref().map(|beside| {
                beside.each_ref().map(|(origin, direction, weight)| {
                    let [weight] = weight.get(i);
                    (origin.get(i), direction.get(i), weight)
                })
            });
            ((ray, weight), beside)
        })
        .collect();
    // No array of origins or directions has more numbers than this.
    let three = 3 * n;
    assert!(origin.written() <= three && direction.written() <= three, "wrote between two rays");
    assert!(
        [&weight, &mint, &maxt, &ray_time].iter().all(|room| room.written() <= n),
        "wrote between two rays"
    );
    assert!(
        beside.iter().flatten().all(|(origin, direction, weight)| {
            [origin.written(), direction.written()].iter().all(|written| *written <= three)
                && weight.written() <= n
        }),
        "wrote between two neighbours"
    );
    assert!(
        found.iter().all(|((ray, weight), _)| *weight > 0.0 || *ray == MARK),
        "a blocked ray wrote to its place"
    );
    found
}
