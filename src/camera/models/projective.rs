//! The orthographic and the perspective camera, with a thin lens for depth of field where one is asked for.
//!
//! They are pbrt-v1's stock cameras of these names (M. Pharr and G. Humphreys, *Physically Based
//! Rendering*, 1st ed. 2004, §6.2): the same parameters and defaults, the ray's origin on the near plane,
//! its end at the far plane (perspective) or at the length between the planes (orthographic), weight 1,
//! and the stock cameras' single-precision arithmetic, operation for operation. Where the camera transform scales or
//! shears, directions are made unit vectors, which the stock cameras' are not then, and the clip range follows.

use super::spaces::{Projection, ScreenWindow};
use crate::{
    camera::{
        film::Raster,
        parameters::LensPlane,
        placement::Placement,
        ray::{Outcome, Sample, WorldRay},
    },
    sampling::{DiskMapping, disk::concentric_single},
};

/// Which of the two projections.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Projecting {
    /// Parallel rays along z.
    Orthographic,
    /// Rays from the eye; the angle, in degrees, spans [-1, 1] on the screen.
    Perspective { fov: f32 },
}

/// A thin lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ThinLens {
    /// World units, positive.
    pub radius: f32,
    /// From the eye to the plane of focus, world units, more than `hither`.
    pub focal_distance: f32,
    pub plane: LensPlane,
    pub mapping: DiskMapping,
}

/// A camera with a projection matrix. Immutable, and may be shared between threads.
#[derive(Clone, Debug)]
pub struct ProjectiveCamera {
    projecting: Projecting,
    raster_to_camera: Projection,
    lens: Option<ThinLens>,
    placement: Placement,
}

impl ProjectiveCamera {
    pub(crate) fn new(
        projecting: Projecting,
        window: ScreenWindow,
        raster: Raster,
        lens: Option<ThinLens>,
        placement: Placement,
    ) -> Self {
        let [near, far] = placement.clip;
        let to_screen = match projecting {
            Projecting::Orthographic => Projection::orthographic(near, far),
            Projecting::Perspective { fov } => Projection::perspective(fov, near, far),
        };
        let raster_to_camera = Projection::raster_to_camera(&to_screen, window, raster);
        Self { projecting, raster_to_camera, lens, placement }
    }

    pub(crate) fn placement(&self) -> &Placement {
        &self.placement
    }

    /// The ray of a sample, with weight 1.
    pub fn generate(&self, sample: &Sample) -> Outcome {
        let Some(lens) = &self.lens else {
            return Outcome::Ray(self.ray(sample, None), 1.0);
        };
        let point = match lens.mapping {
            DiskMapping::Concentric => Some(concentric_single(sample.lens_u, sample.lens_v)),
            other => other
                .map(sample.lens_u.into(), sample.lens_v.into())
                .map(|point| point.map(|part| part as f32)),
        };
        match point {
            Some(point) => Outcome::Ray(self.ray(sample, Some((lens, point))), 1.0),
            None => Outcome::Redraw,
        }
    }

    /// The ray through the middle of the lens.
    pub(crate) fn central(&self, sample: &Sample) -> WorldRay {
        self.ray(sample, None)
    }

    fn ray(&self, sample: &Sample, lens: Option<(&ThinLens, [f32; 2])>) -> WorldRay {
        let [hither, yon] = self.placement.clip;
        let mut o = self.raster_to_camera.point([sample.image_x, sample.image_y, 0.0]);
        let mut d = match self.projecting {
            Projecting::Orthographic => [0.0, 0.0, 1.0],
            Projecting::Perspective { .. } => o,
        };
        if let Some((&ThinLens { radius, focal_distance, plane, .. }, point)) = lens {
            let [u, v] = point.map(|part| part * radius);
            let along = (focal_distance - hither) / d[2];
            let focus: [f32; 3] = std::array::from_fn(|i| o[i] + d[i] * along);
            let shift = match plane {
                LensPlane::Eye => [u, v].map(|part| part * (focal_distance - hither) / focal_distance),
                LensPlane::Hither => [u, v],
            };
            o[0] += shift[0];
            o[1] += shift[1];
            d = std::array::from_fn(|i| focus[i] - o[i]);
        }
        let d = unit(d);
        let end = match self.projecting {
            Projecting::Orthographic => yon - hither,
            Projecting::Perspective { .. } => (yon - hither) / d[2],
        };
        self.placement.world_ray_single(o, d, [0.0, end], sample.time)
    }
}

/// The unit vector along `d`, in the order of pbrt's sums.
fn unit(d: [f32; 3]) -> [f32; 3] {
    let square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    let largest = d[0].abs().max(d[1].abs()).max(d[2].abs());
    if square == f32::INFINITY && largest.is_finite() {
        // Toward a plane of focus so far away that its square is no float.
        return unit(d.map(|part| part / largest));
    }
    let inverse = 1.0 / square.sqrt();
    d.map(|part| part * inverse)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::CameraToWorld;

    const RASTER: Raster = Raster { xres: 200, yres: 100 };

    fn camera(projecting: Projecting, lens: Option<ThinLens>, clip: [f32; 2]) -> ProjectiveCamera {
        let placement = Placement { to_world: CameraToWorld::IDENTITY.into(), clip, shutter: [0.0, 1.0] };
        ProjectiveCamera::new(projecting, ScreenWindow::of_aspect(2.0), RASTER, lens, placement)
    }

    fn ray(camera: &ProjectiveCamera, image: [f32; 2], lens: [f32; 2]) -> WorldRay {
        let [[image_x, image_y], [lens_u, lens_v]] = [image, lens];
        match camera.generate(&Sample { image_x, image_y, lens_u, lens_v, time: 0.5 }) {
            Outcome::Ray(ray, 1.0) => ray,
            other => panic!("{other:?}"),
        }
    }

    /// Where a ray meets the plane z = `depth`.
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
    fn perspective_rays_pass_through_the_eye_and_run_from_hither_to_yon() {
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
        for (image, place) in [([100.0, 50.0], [0.0, 0.0]), ([200.0, 0.0], [2.0, 1.0])] {
            let ray = ray(&camera, image, [0.1, 0.9]);
            assert_eq!(ray.direction, [0.0, 0.0, 1.0]);
            near(at_depth(&ray, 7.0), place);
            assert_eq!((ray.origin[2], ray.maxt), (0.5, 19.5));
        }
    }

    #[test]
    fn every_ray_of_a_pixel_meets_the_same_point_in_the_plane_of_focus() {
        for projecting in [Projecting::Perspective { fov: 60.0 }, Projecting::Orthographic] {
            for plane in [LensPlane::Eye, LensPlane::Hither] {
                let camera = camera(projecting, Some(ThinLens { plane, ..LENS }), [0.5, 20.0]);
                for image in [[100.0, 50.0], [20.0, 90.0]] {
                    let expected = at_depth(
                        &camera.central(&Sample {
                            image_x: image[0],
                            image_y: image[1],
                            ..Sample::default()
                        }),
                        4.0,
                    );
                    for lens in NUMBERS {
                        near(at_depth(&ray(&camera, image, lens), 4.0), expected);
                    }
                }
            }
        }
    }

    #[test]
    fn the_lens_lies_in_the_plane_that_is_asked_for() {
        for (plane, depth) in [(LensPlane::Eye, 0.0), (LensPlane::Hither, 0.5)] {
            let lens = ThinLens { plane, ..LENS };
            let camera = camera(Projecting::Perspective { fov: 60.0 }, Some(lens), [0.5, 20.0]);
            for numbers in NUMBERS {
                let unit = concentric_single(numbers[0], numbers[1]);
                near(at_depth(&ray(&camera, [100.0, 50.0], numbers), depth), unit.map(|part| part * 0.25));
            }
        }
    }

    #[test]
    fn rejected_lens_numbers_are_asked_for_again() {
        let lens = ThinLens { mapping: DiskMapping::Rejection, ..LENS };
        let camera = camera(Projecting::Orthographic, Some(lens), [0.5, 20.0]);
        assert_eq!(camera.generate(&Sample::default()), Outcome::Redraw);
    }
}
