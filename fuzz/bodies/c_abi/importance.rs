//! The adjoint camera: for any rays and points, importance is finite and not negative.

use std::array;

use super::bytes::Bytes;
use realistic::ffi::*;

const COUNT: usize = 13;

type Columns<const C: usize> = [[f32; COUNT]; C];

/// Checks importance, and panics with `what` if it is not sound or belongs to another ray.
pub fn check(
    camera: *const realistic_camera,
    rays: &[(realistic_ray, f32)],
    bytes: &mut Bytes<'_>,
    what: &dyn std::fmt::Debug,
) {
    let mut along: Columns<7> = array::from_fn(|_| array::from_fn(|_| 2.0 * bytes.float(100.0) - 100.0));
    // At most half of the rays are reversed rays of the camera.
    for (i, (ray, _)) in rays.iter().filter(|(_, weight)| *weight > 0.0).take(COUNT / 2).enumerate() {
        let realistic_ray { o: [ox, oy, oz], d: [dx, dy, dz], time, .. } = *ray;
        let numbers = [ox, oy, oz, -dx, -dy, -dz, time];
        along.iter_mut().zip(numbers).for_each(|(column, number)| column[i] = number);
    }
    let points: Columns<6> = array::from_fn(|axis| {
        array::from_fn(|_| match axis {
            0 | 1 => 2.0 * bytes.float(1000.0) - 1000.0,
            2 => bytes.float(4000.0),
            _ => bytes.float(1.0),
        })
    });
    let (mut counted, mut toward, mut found) = ([[-7.0; COUNT]; 6], [[-7.0; COUNT]; 7], [[-7.0; COUNT]; 6]);
    // SAFETY: the camera is live, and the columns have COUNT numbers.
    let status =
        unsafe { realistic_camera_importance(camera, COUNT, &self::rays(&along), &room(&mut counted)) };
    if status == realistic_status::InvalidParameter {
        return;
    }
    assert_eq!(status, realistic_status::Ok, "{what:?}");
    let (inputs, directions) = (self::points(&points), aimed(&mut toward));
    // SAFETY: as above.
    let status =
        unsafe { realistic_camera_sample_importance(camera, COUNT, &inputs, &directions, &room(&mut found)) };
    assert_eq!(status, realistic_status::Ok, "{what:?}");
    for i in 0..COUNT {
        let at = |column: &[f32; COUNT]| column[i];
        for found in [&counted, &found] {
            let numbers = found.each_ref().map(at);
            assert!(numbers.iter().all(|number| *number >= 0.0), "{numbers:?} {what:?}");
        }
        let [.., dx, dy, dz, density] = toward.each_ref().map(at);
        let length = (dx * dx + dy * dy + dz * dz).sqrt();
        assert!(
            density == 0.0 && found[2][i] == 0.0 || density > 0.0 && (length - 1.0).abs() < 1e-6,
            "{dx} {dy} {dz} {density} {what:?}"
        );
    }
}

/// Returns rays in columns: origins, directions, times.
pub fn rays(columns: &[impl AsRef<[f32]>; 7]) -> realistic_importance_rays {
    let [ox, oy, oz, dx, dy, dz, time] = columns.each_ref().map(|column| column.as_ref().as_ptr());
    let struct_size = size_of::<realistic_importance_rays>() as u32;
    realistic_importance_rays {
        struct_size,
        origin: realistic_input::columns([ox, oy, oz]),
        direction: realistic_input::columns([dx, dy, dz]),
        time: realistic_input::columns([time]),
    }
}

/// Returns scene points in columns, with their samples and times.
pub fn points(columns: &[impl AsRef<[f32]>; 6]) -> realistic_scene_points {
    let [x, y, z, u, v, time] = columns.each_ref().map(|column| column.as_ref().as_ptr());
    realistic_scene_points {
        struct_size: size_of::<realistic_scene_points>() as u32,
        point: realistic_input::columns([x, y, z]),
        lens: realistic_input::columns([u, v]),
        time: realistic_input::columns([time]),
    }
}

/// Returns columns for directions: origins, directions, densities.
pub fn aimed(columns: &mut [impl AsMut<[f32]>; 7]) -> realistic_aimed {
    let [ox, oy, oz, dx, dy, dz, density] = columns.each_mut().map(|column| column.as_mut().as_mut_ptr());
    realistic_aimed {
        struct_size: size_of::<realistic_aimed>() as u32,
        origin: realistic_output::columns([ox, oy, oz]),
        direction: realistic_output::columns([dx, dy, dz]),
        density: realistic_output::columns([density]),
    }
}

/// Returns columns for importance, in the order of its structure.
pub fn room(columns: &mut [impl AsMut<[f32]>; 6]) -> realistic_importance {
    let [image_x, image_y, importance, density, area_density, solid_angle_density] =
        columns.each_mut().map(|column| column.as_mut().as_mut_ptr());
    let struct_size = size_of::<realistic_importance>() as u32;
    realistic_importance {
        struct_size,
        image: realistic_output::columns([image_x, image_y]),
        importance: realistic_output::columns([importance]),
        density: realistic_output::columns([density]),
        area_density: realistic_output::columns([area_density]),
        solid_angle_density: realistic_output::columns([solid_angle_density]),
    }
}
