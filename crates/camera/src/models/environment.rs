//! The environment camera: all directions from a point, in spherical coordinates about the y axis.
//!
//! It reproduces pbrt-v1's stock camera of this name (M. Pharr and G. Humphreys, *Physically Based
//! Rendering*, 1st ed. 2004, §6.3): θ = π y/yres from straight up, φ = 2π x/xres from +x toward +z, weight 1,
//! and `hither` and `yon` as distances from the point. The angles are bit-identical to the stock camera's;
//! their sines and cosines are computed by series that give the same result for one sample and for many. If
//! the camera transform scales or shears, directions are normalised, unlike in the stock camera, and the clip
//! range is adjusted accordingly.

use std::f32::consts::{PI, TAU};

use crate::{
    film::Raster,
    pipeline::{film_sampling::SampleLanes, stock::View},
    placement::RangedRays,
};
use realistic_simd::{Cpu, Lanes, cos_sin};

/// A view of all directions.
pub struct Environment {
    resolution: [f32; 2],
    clip: [f32; 2],
}

impl Environment {
    pub fn new(raster: Raster, clip: [f32; 2]) -> Self {
        Self { resolution: [raster.xres as f32, raster.yres as f32], clip }
    }
}

impl View for Environment {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn lanes<L: Lanes<Scalar = f32>>(&self, cpu: Cpu<L>, samples: &SampleLanes<L>) -> RangedRays<L> {
        let [x, y] = samples.image;
        let theta = L::splat(cpu, PI) * y / L::splat(cpu, self.resolution[1]);
        let phi = L::splat(cpu, TAU) * x / L::splat(cpu, self.resolution[0]);
        let ([cos_theta, sin_theta], [cos_phi, sin_phi]) = (cos_sin(cpu, theta), cos_sin(cpu, phi));
        RangedRays {
            origin: [L::splat(cpu, 0.0); 3],
            direction: [sin_theta * cos_phi, cos_theta, sin_theta * sin_phi],
            range: [L::splat(cpu, self.clip[0]), L::splat(cpu, self.clip[1])],
        }
    }
}
