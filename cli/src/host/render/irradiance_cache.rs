//! An irradiance cache: a table of the light that a scene at rest receives from its surfaces, windows and sky.
//!
//! The light that a matte surface reflects from these sources changes slowly from point to point, but a single path
//! samples it by chance. It accounts for three fifths of the variance of a path tracer's picture, mostly because of
//! windows that one ray in twenty meets. The light is therefore gathered once for a small part of a surface (G. J.
//! Ward, F. M. Rubinstein and R. D. Clear, "A Ray Tracing Solution for Diffuse Interreflection", SIGGRAPH 1988), by
//! hundreds of rays with well spread directions, and every path that reaches the part reads the light from the table.
//! Lamps are not in the table, because their shadows have edges.
//!
//! A part of a surface lies in one cell of a cubic grid and has its normal in one of 96 cones. Cells grow with the
//! distance from the camera. The light is gathered at one point that depends only on the part: the point where a line
//! through the cell's middle along the cone's axis meets a surface. Neither the number of threads nor their order
//! therefore changes any bit, and a part is gathered on first use. For a nearby point with the normal **n**, the
//! irradiance is **n · V**, with the vector **V** = ∫ L **ω** dω over the half space in front of the gathering point.
//! For the gathering point's own normal, both this value and its derivative are exact (G. J. Ward and P. S. Heckbert,
//! "Irradiance Gradients", EGWR 1992). A point looks up the part at a random position up to half a cell beside it, so
//! the mean over samples is linear between cells. If the line meets no surface with such a normal, the part does not
//! exist, and paths sample the light instead.

use super::lamplight::START;
use super::shade::ShadingSample;
use crate::host::scene::shapes::{Hit, Ray};
use glam::{IVec3, Vec3};
use rand::{Rng as _, SeedableRng as _};
use rand_xoshiro::SplitMix64;
use realistic_lab::render::sequence::{Point, Sequence, strata};
use std::collections::HashMap;
use std::f32::consts::{PI, TAU};
use std::hash::{BuildHasher as _, RandomState};
use std::sync::{PoisonError, RwLock};

/// Largest side of a cell, as a multiple of the cell's distance from the camera; the smallest side is half of that. A
/// smaller cell gives sharper indirect shadows and a larger table.
const COARSE: f32 = 0.04;
/// Number of cones of normals along an edge of a cube's face.
const CONES: f32 = 4.0;
/// Smallest cosine of the angle between a gathering point's normal and its cone's axis.
const ALIKE: f32 = 0.8;
/// Number of samples of a picture for which a part gathers one ray, then the smallest and the largest number of rays.
/// With these values, tens of thousands of parts cost a tenth of a picture. The largest number limits the accuracy of
/// a part: the error of a part remains, however many samples the picture has.
const SAMPLES: u64 = 1 << 19;
const FEWEST: u64 = 16;
const MOST: u64 = 4096;
/// Smallest cosine by which the component of the vector along the surface is divided; otherwise, rays along the
/// surface would have no bound.
const LEVEL: f32 = 0.1;
/// Number of sections of the table, each with its own lock.
const SHARDS: usize = 64;

/// A cell and a cone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Part {
    /// Binary logarithm of the cell's side in mm.
    level: i32,
    cell: IVec3,
    cone: u8,
}

/// For each colour, the vector whose product with the normal is the irradiance.
type Irradiance = [Vec3; 3];
type Shard = RwLock<HashMap<Part, Option<Irradiance>>>;

/// A table that is filled on demand.
pub struct IrradianceCache {
    eye: Vec3,
    rays: u32,
    seed: u64,
    shards: [Shard; SHARDS],
    choose: RandomState,
}

impl IrradianceCache {
    /// Makes an empty table for a camera at `eye`, and a picture of this number of samples.
    pub fn new(eye: Vec3, samples: u64, seed: u64) -> Self {
        let rays = (samples / SAMPLES).clamp(FEWEST, MOST).next_power_of_two() as u32;
        Self {
            eye,
            rays,
            seed,
            shards: std::array::from_fn(|_| Shard::default()),
            choose: RandomState::new(),
        }
    }

    /// Returns the irradiance at a point of a surface with this normal. `aside` selects the position in the cells
    /// around the point. `nearest` finds the surface that a ray meets, and `radiance` returns the light along a ray
    /// that starts at a surface.
    pub fn irradiance(
        &self,
        point: Vec3,
        normal: Vec3,
        aside: [f32; 2],
        nearest: impl Fn(&Ray) -> Option<Hit>,
        radiance: impl Fn(&Ray, ShadingSample) -> Vec3,
    ) -> Option<Vec3> {
        let level = (COARSE * point.distance(self.eye).max(1.0)).log2().floor();
        let side = level.exp2();
        let (across, up) = normal.any_orthonormal_pair();
        let beside = point + side * ((aside[0] - 0.5) * across + (aside[1] - 0.5) * up);
        let part = |position: Vec3| Part {
            level: level as i32,
            cell: (position / side).floor().as_ivec3(),
            cone: cone(normal),
        };
        let (other, own) = (part(beside), part(point));
        let found = self.part(other, &nearest, &radiance);
        let found =
            found.or_else(|| (own != other).then(|| self.part(own, &nearest, &radiance)).flatten())?;
        Some(Vec3::from(found.map(|vector| vector.dot(normal).max(0.0))))
    }

    /// Looks up the irradiance of a part, or gathers it if the table does not have it yet.
    fn part(
        &self,
        part: Part,
        nearest: &impl Fn(&Ray) -> Option<Hit>,
        radiance: &impl Fn(&Ray, ShadingSample) -> Vec3,
    ) -> Option<Irradiance> {
        let hash = self.choose.hash_one(part);
        let shard = &self.shards[(hash >> 32) as usize % SHARDS];
        if let Some(known) = shard.read().unwrap_or_else(PoisonError::into_inner).get(&part) {
            return *known;
        }
        // Two threads that arrive here at once compute the same value.
        let found = gathering_point(part, nearest)
            .map(|(point, normal)| self.gather(point, normal, self.seed_of(part), radiance));
        shard.write().unwrap_or_else(PoisonError::into_inner).insert(part, found);
        found
    }

    /// Returns the seed of a part's random numbers.
    fn seed_of(&self, part: Part) -> u32 {
        let IVec3 { x, y, z } = part.cell;
        let numbers =
            [part.level, x, y, z, i32::from(part.cone)].map(|number| u64::from(number.cast_unsigned()));
        let mix = |sum: u64, number: u64| SplitMix64::seed_from_u64(sum ^ number).next_u64();
        let mixed = numbers.into_iter().fold(self.seed, mix);
        (mixed >> 32) as u32
    }

    /// Gathers the light that reaches a surface at a point.
    fn gather(
        &self,
        point: Vec3,
        normal: Vec3,
        seed: u32,
        radiance: &impl Fn(&Ray, ShadingSample) -> Vec3,
    ) -> Irradiance {
        let count = self.rays as usize;
        let [mut directions, mut facets] = [vec![Point::default(); count], vec![Point::default(); count]];
        Sequence::Sobol.fill(seed, 4, &mut directions);
        Sequence::Sobol.fill(!seed, 2, &mut facets);
        let mut fates = vec![0.0; count];
        strata(seed, &mut fates);
        let (side, up) = normal.any_orthonormal_pair();
        // The components along the normal and along the surface, by colour.
        let mut sum = [Vec3::ZERO; 3];
        for ((direction, facet), fate) in directions.iter().zip(&facets).zip(&fates) {
            let [u, v, light @ ..] = *direction;
            let (sin, cos) = (TAU * v).sin_cos();
            let (level, height) = (u.sqrt(), (1.0 - u).max(0.0).sqrt());
            let (x, y) = (level * cos, level * sin);
            let ray = Ray { origin: point, direction: x * side + y * up + height * normal, time: 0.0 };
            let sample = ShadingSample { light, facet: [facet[0], facet[1]], fate: *fate, aside: [0.5; 2] };
            let light = radiance(&ray, sample);
            let steep = height.max(LEVEL);
            let axes = [x / steep, y / steep, 1.0];
            for (sum, axis) in sum.iter_mut().zip(axes) {
                *sum += axis * light;
            }
        }
        let [x, y, z] = sum.map(|sum| sum * (PI / count as f32));
        [0, 1, 2].map(|colour| x[colour] * side + y[colour] * up + z[colour] * normal)
    }
}

/// Returns the gathering point of a part, and the surface's normal there.
fn gathering_point(part: Part, nearest: &impl Fn(&Ray) -> Option<Hit>) -> Option<(Vec3, Vec3)> {
    let side = (part.level as f32).exp2();
    let axis = axis(part.cone);
    let origin = (part.cell.as_vec3() + 0.5) * side + side * axis;
    let ray = Ray { origin, direction: -axis, time: 0.0 };
    let hit = nearest(&ray).filter(|hit| hit.distance < 2.0 * side && hit.normal.dot(axis) > ALIKE)?;
    // The point lies slightly in front of the surface: rounding of the distance could otherwise put it behind.
    Some((ray.at(hit.distance) + 0.2 * START * hit.normal, hit.normal))
}

/// Returns the index of the cone that contains a normal; each cone is a square of a cube's face.
fn cone(normal: Vec3) -> u8 {
    let axis = normal.abs().max_position();
    let face = 2 * axis + usize::from(normal[axis] < 0.0);
    let square =
        |value: f32| ((value / normal[axis].abs() + 1.0) * 0.5 * CONES).clamp(0.0, CONES - 0.5) as usize;
    let [row, column] = [square(normal[(axis + 1) % 3]), square(normal[(axis + 2) % 3])];
    ((face * CONES as usize + row) * CONES as usize + column) as u8
}

/// Returns the axis of a cone.
fn axis(cone: u8) -> Vec3 {
    let side = CONES as u8;
    let (face, row, column) = (cone / (side * side), cone / side % side, cone % side);
    let along = usize::from(face / 2);
    let mut axis = Vec3::ZERO;
    axis[along] = if face % 2 == 0 { 1.0 } else { -1.0 };
    let middle = |number: u8| (f32::from(number) + 0.5) * 2.0 / CONES - 1.0;
    axis[(along + 1) % 3] = middle(row);
    axis[(along + 2) % 3] = middle(column);
    axis.normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::scene::shapes::{Shape as _, Sphere};

    #[test]
    fn every_normal_is_near_the_axis_of_its_cone() {
        for index in 0..2000_u16 {
            let [u, v] = [0.754_877_7, 0.569_840_3].map(|step: f32| (f32::from(index) * step).fract());
            let (sin, cos) = (TAU * v).sin_cos();
            let height = 2.0 * u - 1.0;
            let level = (1.0 - height * height).sqrt();
            let normal = Vec3::new(level * cos, height, level * sin);
            assert!(normal.dot(axis(cone(normal))) > 0.92, "{normal}");
        }
        for number in 0..96 {
            assert_eq!(cone(axis(number)), number);
        }
    }

    /// A ball in light from one side: L = 1 + cos of the angle with +x, everywhere.
    #[test]
    fn a_ball_is_lit_as_the_closed_form_has_it() {
        let ball = Sphere::resting(Vec3::new(0.0, 0.0, 500.0), 60.0);
        let cache = IrradianceCache::new(Vec3::ZERO, u64::MAX, 3);
        let mut worst: f32 = 0.0;
        for index in 0..400_u16 {
            let [u, v, a, b] = [0.754_877_7, 0.569_840_3, 0.819_172_5, 0.671_043_6]
                .map(|step: f32| (f32::from(index) * step).fract());
            let (sin, cos) = (TAU * v).sin_cos();
            let height = 2.0 * u - 1.0;
            let level = (1.0 - height * height).sqrt();
            let normal = Vec3::new(level * cos, height, level * sin);
            let nearest = |ray: &Ray| ball.intersect(ray, 0.0, f32::INFINITY);
            let light = |ray: &Ray, _: ShadingSample| Vec3::splat(1.0 + ray.direction.x);
            let found = cache.irradiance(ball.centre + 60.0 * normal, normal, [a, b], nearest, light);
            // Over the half space, the first term integrates to π, and the second to 2π/3 times the cosine.
            let expected = PI + TAU / 3.0 * normal.x;
            worst = worst.max((found.unwrap().x / expected - 1.0).abs());
        }
        // The ball has a radius of 60 mm, cells of 16 mm, and cones 20 degrees wide.
        assert!(worst < 0.12, "{worst}");
    }
}
