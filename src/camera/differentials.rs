//! Rays with differentials (H. Igehy, "Tracing Ray Differentials", SIGGRAPH 1999): beside the ray of a sample those of the
//! same lens and time sample one pixel to the right and one pixel down, whose distance tells a renderer how large a
//! footprint to filter textures over. Here is what goes in and comes out; the camera traces all three as one.

use glam::Vec4;

use super::{
    pipeline::arrays::{RayArrays, RayBlock, SampleArrays, SampleBlock},
    ray::{Sample, WorldRay},
};
use crate::trace::kernel::{Compiled, Simd};

/// A ray and its neighbours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayDifferential {
    /// The ray of the sample.
    pub ray: WorldRay,
    /// The ray of image x + 1; `None` where the lens blocks it.
    pub rx: Option<WorldRay>,
    /// The ray of image y + 1; `None` where the lens blocks it.
    pub ry: Option<WorldRay>,
}

/// Rays that are traced at once: few enough for the first cache, and eight times the widest vectors.
pub(super) const AT_ONCE: usize = 128;

/// The samples of a ray and its neighbours, and of the ray once more.
#[inline(always)]
pub(super) fn block_of(sample: &Sample) -> SampleBlock<4> {
    let Sample { image_x: x, image_y: y, .. } = *sample;
    at_points(sample, [x, x + 1.0, x, x], [y, y, y + 1.0, y])
}

/// A lens and time sample at four image points, stored as the vectors that lanes will load: loads of what was just stored
/// number by number would have to wait.
#[inline(always)]
pub(crate) fn at_points(sample: &Sample, image_x: [f32; 4], image_y: [f32; 4]) -> SampleBlock<4> {
    let vectors = [
        Vec4::from_array(image_x),
        Vec4::from_array(image_y),
        Vec4::splat(sample.lens_u),
        Vec4::splat(sample.lens_v),
        Vec4::splat(sample.time),
    ];
    vectors.map(|vector| vector.to_array()).into()
}

/// Which neighbour.
#[derive(Clone, Copy)]
pub(super) enum Side {
    Right,
    Below,
}

/// Up to [`AT_ONCE`] samples moved by a pixel.
pub(super) struct Moved([f32; AT_ONCE]);

impl Moved {
    pub const fn new() -> Self {
        Self([0.0; AT_ONCE])
    }

    /// The samples, of which there are at most so many, moved to a side.
    pub fn to<'a>(&'a mut self, side: Side, samples: &SampleArrays<'a>) -> SampleArrays<'a> {
        let from = match side {
            Side::Right => samples.image_x,
            Side::Below => samples.image_y,
        };
        let moved = &mut self.0[..from.len()];
        moved.iter_mut().zip(from).for_each(|(to, from)| *to = from + 1.0);
        match side {
            Side::Right => SampleArrays { image_x: moved, ..*samples },
            Side::Below => SampleArrays { image_y: moved, ..*samples },
        }
    }
}

/// Room for `count` neighbours from `first` on. Their range and time are the rays'.
pub(super) fn part<'a>(neighbours: &'a mut RayArrays<'_>, first: usize, count: usize) -> RayArrays<'a> {
    let part = first..first + count;
    let [origin, direction] = [&mut neighbours.origin, &mut neighbours.direction]
        .map(|axes| axes.each_mut().map(|axis| &mut axis[part.clone()]));
    RayArrays { origin, direction, mint: None, maxt: None, time: None, weight: &mut neighbours.weight[part] }
}

/// Puts the ray itself in the place of each neighbour that is missing, of `count` rays from `first` on.
pub(super) fn complete(neighbours: &mut RayArrays<'_>, first: usize, count: usize, rays: &RayArrays<'_>) {
    let part = first..first + count;
    if are_rays(&neighbours.weight[part.clone()]) {
        return;
    }
    for i in part.filter(|&i| neighbours.weight[i] == 0.0) {
        for axis in 0..3 {
            neighbours.origin[axis][i] = rays.origin[axis][i];
            neighbours.direction[axis][i] = rays.direction[axis][i];
        }
    }
}

/// Takes the neighbours `found` of `count` rays from `first` on: of a ray without one the ray itself, with weight 0; of no
/// ray only the weight 0.
pub(super) fn take(
    neighbours: &mut RayArrays<'_>,
    first: usize,
    count: usize,
    rays: &RayArrays<'_>,
    found: &mut RayBlock<AT_ONCE>,
) {
    Simd::best().run(Take { neighbours, first, count, rays, found: found.arrays(count) });
}

/// [`take`] by the processor's own vectors.
struct Take<'a, 'b, 'c> {
    neighbours: &'a mut RayArrays<'b>,
    first: usize,
    count: usize,
    rays: &'a RayArrays<'c>,
    found: RayArrays<'a>,
}

impl Compiled for Take<'_, '_, '_> {
    #[inline(always)]
    fn run(self) {
        let Self { neighbours, first, count, rays, found: RayArrays { origin, direction, weight, .. } } =
            self;
        let part = first..first + count;
        let own = &rays.weight[part.clone()];
        for axis in 0..3 {
            let (to, of_ray) = (&mut neighbours.origin[axis][part.clone()], &rays.origin[axis][part.clone()]);
            choose(to, origin[axis], of_ray, weight, own);
            let (to, of_ray) =
                (&mut neighbours.direction[axis][part.clone()], &rays.direction[axis][part.clone()]);
            choose(to, direction[axis], of_ray, weight, own);
        }
        for ((to, weight), own) in neighbours.weight[part].iter_mut().zip(&*weight).zip(own) {
            *to = if *own > 0.0 { *weight } else { 0.0 };
        }
    }
}

/// Whether all weights are those of rays. Without a branch, so that the compiler makes vectors of it.
#[inline(always)]
pub(super) fn are_rays(weight: &[f32]) -> bool {
    weight.iter().fold(true, |all, weight| all & (*weight > 0.0))
}

/// Writes the neighbour's number where there is one, else the ray's; where there is no ray either, nothing. Without a
/// branch, so that the compiler makes vectors of it.
#[inline(always)]
fn choose(to: &mut [f32], neighbour: &[f32], ray: &[f32], weight: &[f32], own: &[f32]) {
    for ((((to, neighbour), ray), weight), own) in to.iter_mut().zip(neighbour).zip(ray).zip(weight).zip(own)
    {
        *to = either(*own > 0.0, either(*weight > 0.0, *neighbour, *ray), *to);
    }
}

/// One of two numbers, by their bits: of `if` the compiler makes a choice between two places to load from, one by one.
#[inline(always)]
fn either(first: bool, a: f32, b: f32) -> f32 {
    let mask = u32::from(first).wrapping_neg();
    f32::from_bits(a.to_bits() & mask | b.to_bits() & !mask)
}
