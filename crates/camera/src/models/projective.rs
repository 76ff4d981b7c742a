//! The orthographic and the perspective camera, with an optional thin lens for depth of field.
//!
//! They reproduce pbrt-v1's stock cameras of these names (M. Pharr and G. Humphreys, *Physically Based
//! Rendering*, 1st ed. 2004, §6.2): the parameters and defaults are the same, the ray begins on the near
//! plane and ends at the far plane (perspective) or after the distance between the planes (orthographic), the
//! weight is 1, and, except for the sines and cosines of lens points, the single-precision arithmetic is the
//! same, operation for operation. If the camera transform scales or shears, directions are normalised, unlike
//! in the stock cameras, and the clip range is adjusted accordingly.

use super::spaces::{NearPlane, Projection, ScreenWindow};
use crate::{
    film::Raster,
    parameters::LensPlane,
    pipeline::{film_sampling::SampleLanes, stock::View},
    placement::RangedRays,
    sampling::DiskMapping,
};
use realistic_simd::{Cpu, Lanes};

/// The two projections.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projecting {
    /// Parallel rays along z.
    Orthographic,
    /// Rays from the eye; the angle `fov`, in degrees, spans [-1, 1] on the screen.
    Perspective { fov: f32 },
}

/// A thin lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinLens {
    /// Radius, world units, positive.
    pub radius: f32,
    /// Distance from the eye to the plane of focus, world units; greater than `hither`.
    pub focal_distance: f32,
    pub plane: LensPlane,
    pub mapping: DiskMapping,
}

/// The rays of a projection, which begin on the near plane.
#[derive(Clone, Debug)]
pub struct Projective {
    near: NearPlane,
    perspective: bool,
    lens: Option<ThinLens>,
    hither: f32,
    /// Distance from the near plane to the far one, world units.
    depth: f32,
    /// A power of two that keeps the squares of directions in the number range if the planes are very far or
    /// very near.
    scale: Option<f32>,
}

impl Projective {
    pub fn new(
        projecting: Projecting,
        window: ScreenWindow,
        raster: Raster,
        lens: Option<ThinLens>,
        [hither, yon]: [f32; 2],
    ) -> Self {
        let to_camera = match projecting {
            Projecting::Orthographic => Projection::of_orthographic_screen(hither, yon),
            Projecting::Perspective { fov } => Projection::of_perspective_screen(fov, hither, yon),
        };
        let near = Projection::of_raster(window, raster).then(&to_camera).near_plane();
        let perspective = projecting != Projecting::Orthographic;
        // The length of a direction vector is the distance from the near plane to the plane of focus, or from
        // the eye to the near plane.
        let length = lens.map_or(if perspective { hither } else { 1.0 }, |lens| lens.focal_distance);
        let scale = (!(1e-10..1e10).contains(&length)).then(|| (-length.log2().floor()).exp2());
        Self { near, perspective, lens, hither, depth: yon - hither, scale }
    }
}

impl View for Projective {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn lanes<L: Lanes<Scalar = f32>>(&self, cpu: Cpu<L>, samples: &SampleLanes<L>) -> RangedRays<L> {
        let mut origin = self.near.lanes(cpu, samples.image);
        let (zero, one) = (L::splat(cpu, 0.0), L::splat(cpu, 1.0));
        let mut direction = if self.perspective { origin } else { [zero, zero, one] };
        if let Some(ThinLens { radius, focal_distance, plane, mapping }) = self.lens {
            let [u, v] = mapping.lanes(cpu, samples.lens);
            let (radius, near_to_focus) =
                (L::splat(cpu, radius), L::splat(cpu, focal_distance - self.hither));
            let (mut u, mut v) = (u * radius, v * radius);
            if plane == LensPlane::Eye {
                let focal_distance = L::splat(cpu, focal_distance);
                (u, v) = (u * near_to_focus / focal_distance, v * near_to_focus / focal_distance);
            }
            let along = near_to_focus / direction[2];
            let [x, y, z] = origin;
            let focus = [x + direction[0] * along, y + direction[1] * along, z + direction[2] * along];
            origin = [x + u, y + v, z];
            direction = [focus[0] - origin[0], focus[1] - origin[1], focus[2] - z];
        }
        if self.perspective || self.lens.is_some() {
            direction = unit(cpu, direction, self.scale);
        }
        let depth = L::splat(cpu, self.depth);
        let end = if self.perspective { depth / direction[2] } else { depth };
        RangedRays { origin, direction, range: [zero, end] }
    }
}

/// Returns the unit vectors along `d`, with the squares summed in pbrt's order.
#[cfg_attr(not(debug_assertions), inline(always))]
fn unit<L: Lanes<Scalar = f32>>(cpu: Cpu<L>, [mut x, mut y, mut z]: [L; 3], scale: Option<f32>) -> [L; 3] {
    if let Some(scale) = scale {
        let scale = L::splat(cpu, scale);
        (x, y, z) = (x * scale, y * scale, z * scale);
    }
    let inverse = L::splat(cpu, 1.0) / (x * x + y * y + z * z).sqrt();
    [x * inverse, y * inverse, z * inverse]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    use crate::{
        CameraToWorld, Sample, WorldRay,
        pipeline::{ray_maker::RayMaker, stock::StockTracer},
        placement::Placement,
    };

    const RASTER: Raster = Raster { xres: 200, yres: 100 };

    fn camera(projecting: Projecting, lens: Option<ThinLens>, clip: [f32; 2]) -> RayMaker {
        let placement = Placement { to_world: CameraToWorld::IDENTITY.into(), clip, shutter: [0.0, 1.0] };
        let window = ScreenWindow::of_aspect(2.0);
        let view = Projective::new(projecting, window, RASTER, lens, clip);
        let tracer = Arc::new(StockTracer::new(view, &placement));
        RayMaker::new(tracer.clone(), tracer, placement)
    }

    fn ray(camera: &RayMaker, image: [f32; 2], lens: [f32; 2]) -> WorldRay {
        let [[image_x, image_y], [lens_u, lens_v]] = [image, lens];
        let (ray, weight) =
            camera.ray(&Sample { image_x, image_y, lens_u, lens_v, time: 0.5 }).expect("a ray");
        assert_eq!(weight, 1.0);
        ray
    }

    /// Returns the point where a ray meets the plane z = `depth`.
    fn at_depth(ray: &WorldRay, depth: f32) -> [f32; 2] {
        let t = (depth - ray.origin[2]) / ray.direction[2];
        [0, 1].map(|i| ray.origin[i] + t * ray.direction[i])
    }

    #[track_caller]
    fn near(a: [f32; 2], b: [f32; 2]) {
        assert!((a[0] - b[0]).abs() < 2e-6 && (a[1] - b[1]).abs() < 2e-6, "{a:?} is not {b:?}");
    }

    const LENS: ThinLens = ThinLens {
        radius: 0.25,
        focal_distance: 4.0,
        plane: LensPlane::Eye,
        mapping: DiskMapping::Concentric,
    };
    const NUMBERS: [[f32; 2]; 4] = [[0.5, 0.5], [0.0, 0.3], [1.0, 1.0], [0.7, 0.1]];

    #[test]
    fn perspective_rays_pass_the_eye_from_hither_to_yon() {
        let camera = camera(Projecting::Perspective { fov: 90.0 }, None, [0.5, 20.0]);
        for (image, slope) in
            [([100.0, 50.0], [0.0, 0.0]), ([200.0, 0.0], [2.0, 1.0]), ([0.0, 75.0], [-2.0, -0.5])]
        {
            let ray = ray(&camera, image, [0.5, 0.5]);
            near(at_depth(&ray, 0.0), [0.0, 0.0]);
            near(at_depth(&ray, 1.0), slope);
            assert!((ray.origin[2] - 0.5).abs() < 1e-6 && ray.mint == 0.0);
            assert!((ray.origin[2] + ray.maxt * ray.direction[2] - 20.0).abs() < 1e-4);
        }
    }

    #[test]
    fn a_lens_focused_at_infinity_sends_parallel_rays() {
        for projecting in [Projecting::Perspective { fov: 60.0 }, Projecting::Orthographic] {
            let far = ThinLens { focal_distance: 1e30, ..LENS };
            let [pinhole, lens] = [None, Some(far)].map(|lens| camera(projecting, lens, [0.5, 20.0]));
            for numbers in NUMBERS {
                let (a, b) = (ray(&pinhole, [20.0, 90.0], numbers), ray(&lens, [20.0, 90.0], numbers));
                let apart: f32 = a.direction.iter().zip(b.direction).map(|(a, b)| (a - b).abs()).sum();
                assert!(apart < 1e-6 && b.maxt.is_finite(), "{a:?} {b:?}");
            }
        }
    }

    #[test]
    fn orthographic_rays_are_parallel() {
        let camera = camera(Projecting::Orthographic, None, [0.5, 20.0]);
        for (image, expected) in [([100.0, 50.0], [0.0, 0.0]), ([200.0, 0.0], [2.0, 1.0])] {
            let ray = ray(&camera, image, [0.1, 0.9]);
            assert_eq!(ray.direction, [0.0, 0.0, 1.0]);
            near(at_depth(&ray, 7.0), expected);
            assert_eq!((ray.origin[2], ray.maxt), (0.5, 19.5));
        }
    }

    #[test]
    fn rays_of_a_pixel_meet_in_the_plane_of_focus() {
        for projecting in [Projecting::Perspective { fov: 60.0 }, Projecting::Orthographic] {
            for plane in [LensPlane::Eye, LensPlane::Hither] {
                let pinhole = camera(projecting, None, [0.5, 20.0]);
                let camera = camera(projecting, Some(ThinLens { plane, ..LENS }), [0.5, 20.0]);
                for image in [[100.0, 50.0], [20.0, 90.0]] {
                    let expected = at_depth(&ray(&pinhole, image, [0.5; 2]), 4.0);
                    for lens in NUMBERS {
                        near(at_depth(&ray(&camera, image, lens), 4.0), expected);
                    }
                }
            }
        }
    }

    #[test]
    fn the_lens_lies_in_the_requested_plane() {
        for (plane, depth) in [(LensPlane::Eye, 0.0), (LensPlane::Hither, 0.5)] {
            let lens = ThinLens { plane, ..LENS };
            let camera = camera(Projecting::Perspective { fov: 60.0 }, Some(lens), [0.5, 20.0]);
            for numbers in NUMBERS {
                let [u, v] = numbers.map(f64::from);
                let unit = DiskMapping::Concentric.map(u, v).expect("never rejects");
                let point = unit.map(|part| part as f32 * 0.25);
                near(at_depth(&ray(&camera, [100.0, 50.0], numbers), depth), point);
            }
        }
    }

    #[test]
    fn a_rejected_lens_sample_has_no_ray() {
        let lens = ThinLens { mapping: DiskMapping::Rejection, ..LENS };
        let camera = camera(Projecting::Orthographic, Some(lens), [0.5, 20.0]);
        assert_eq!(camera.ray(&Sample::default()), None);
    }

    #[test]
    fn rays_far_from_the_image_are_finite() {
        let lens = |radius: f32, focal_distance: f32| Some(ThinLens { radius, focal_distance, ..LENS });
        let narrow = Projecting::Perspective { fov: 1e-3 };
        let wide = Projecting::Perspective { fov: 179.99 };
        for projecting in [Projecting::Orthographic, narrow, wide] {
            for lens in
                [None, LENS.into(), lens(1e-20, 1e30), lens(1e18, 1e4), lens(1e18, 1e30), lens(1e34, 2.0)]
            {
                for clip in [[1e-4, 1e30], [0.5, 1.0], [1e3, 1e30]] {
                    if lens.is_some_and(|lens| lens.focal_distance <= clip[0]) {
                        continue;
                    }
                    let camera = camera(projecting, lens, clip);
                    let mut rays = 0;
                    for exponent in 0..128 {
                        for sign in [-1.0, 1.0] {
                            let far = sign * 1.9 * 2.0_f32.powi(exponent);
                            for [image_x, image_y] in [[far, 50.0], [100.0, far], [far, far]] {
                                let sample = Sample { image_x, image_y, lens_u: 1.0, lens_v: 0.3, time: 0.0 };
                                let Some((ray, _)) = camera.ray(&sample) else { continue };
                                let square: f32 = ray.direction.iter().map(|x| x * x).sum();
                                let finite = ray.origin.iter().all(|x| x.is_finite());
                                assert!(finite && (square - 1.0).abs() < 1e-5, "{sample:?}: {ray:?}");
                                rays += 1;
                            }
                        }
                    }
                    // A lens larger than any world has no rays; any other lens has rays for image points and
                    // for points far around the image.
                    let odd = |lens: ThinLens| {
                        lens.radius > 1e33 || lens.radius > 1e17 && lens.focal_distance > 1e20
                    };
                    let least = if lens.is_some_and(odd) { 0 } else { 60 };
                    assert!(rays >= least, "{projecting:?} {lens:?} {clip:?}: {rays}");
                }
            }
        }
    }
}
