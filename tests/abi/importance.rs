//! Importance through the C ABI: the library's values, refused input, and arbitrary bits.

use std::{
    ffi::{CStr, CString},
    ptr::null,
};

use ::realistic_camera::{
    Aimed, Camera as Built, Host, Importance, Parameters, Raster, ScenePoint, WorldRay,
};
use realistic::ffi::*;

use super::{
    abi_camera::{Camera, camera},
    fuzz_bodies::c_abi::importance::{aimed, points, rays, room as importance},
};

const N: usize = 700;

fn of_model(model: &str) -> Camera {
    let model = CString::new(model).expect("no zero");
    camera(|options| (options.xres, options.yres, options.model) = (60, 40, model.as_ptr()))
}

fn last_error() -> String {
    // SAFETY: the message lives until this thread's next failure.
    unsafe { CStr::from_ptr(realistic_last_error()) }.to_str().expect("UTF-8").to_owned()
}

/// Columns of numbers.
type Columns<const C: usize> = [Vec<f32>; C];

fn columns<const C: usize>() -> Columns<C> {
    std::array::from_fn(|_| vec![f32::NAN; N])
}

/// Returns numbers that fill [0, 1) evenly.
fn even(index: usize, axis: usize) -> f32 {
    const STEPS: [f64; 5] = [0.8566749, 0.7338919, 0.6287067, 0.5385973, 0.6180340];
    (0.5 + index as f64 * STEPS[axis]).fract() as f32
}

/// Returns points in front of the camera, with their samples.
fn scene() -> Columns<6> {
    let mut columns = columns();
    for i in 0..N {
        let z = 200.0 + 5000.0 * even(i, 2);
        let numbers = [z * (even(i, 0) - 0.5), z * 0.6 * (even(i, 1) - 0.5), z, even(i, 3), even(i, 4), 0.5];
        columns.iter_mut().zip(numbers).for_each(|(column, number)| column[i] = number);
    }
    columns
}

fn same(columns: &Columns<6>, i: usize, found: &Importance) {
    let Importance { raster: [x, y], importance, density, area_density, solid_angle_density } = *found;
    let numbers = [x, y, importance, density, area_density, solid_angle_density];
    for (column, number) in columns.iter().zip(numbers) {
        assert_eq!(column[i], number as f32, "{i}: {found:?}");
    }
}

#[test]
fn the_numbers_are_the_librarys() {
    for model in ["lens", "thick"] {
        let handle = of_model(model);
        let parameters = Parameters { model: Some(model.parse().expect("a model")), ..Parameters::default() };
        let host = Host::new(Raster { xres: 60, yres: 40 }, None);
        let camera = Built::build(&parameters, &host, &mut |_, _| ()).expect("built");
        let adjoint = camera.adjoint().expect("defined");
        let scene_columns = scene();
        let (mut toward, mut counted) = (columns::<7>(), columns::<6>());
        let (inputs, room, found) = (points(&scene_columns), aimed(&mut toward), importance(&mut counted));
        // SAFETY: the columns have N numbers.
        let status = unsafe { realistic_camera_sample_importance(handle.0, N, &inputs, &room, &found) };
        assert_eq!(status, realistic_status::Ok, "{}", last_error());
        let [x, y, z, u, v, time] = &scene_columns;
        let scene_points: Vec<ScenePoint> = (0..N)
            .map(|i| ScenePoint { point: [x[i], y[i], z[i]], sample: [u[i], v[i]], time: time[i] })
            .collect();
        let mut expected = vec![Aimed::default(); N];
        adjoint.aim(&scene_points, &mut expected);
        assert!(expected.iter().filter(|aim| aim.importance.importance > 0.0).count() > N / 4);
        for (i, aim) in expected.iter().enumerate() {
            let ([ox, oy, oz], [dx, dy, dz]) = (aim.origin, aim.direction);
            for (column, number) in toward.iter().zip([ox, oy, oz, dx, dy, dz, aim.density]) {
                assert_eq!(column[i], number as f32, "{model} {i}: {aim:?}");
            }
            same(&counted, i, &aim.importance);
        }
        // The same rays are requested without times of their own.
        let [ox, oy, oz, dx, dy, dz, _] = toward;
        let along = [ox, oy, oz, dx, dy, dz, vec![0.5; N]];
        let mut again = columns::<6>();
        let (mut rays, found) = (rays(&along), importance(&mut again));
        rays.time = realistic_input::NONE;
        // SAFETY: the columns have N numbers.
        let status = unsafe { realistic_camera_importance(handle.0, N, &rays, &found) };
        assert_eq!(status, realistic_status::Ok, "{}", last_error());
        let ray = |i: usize| WorldRay {
            origin: [along[0][i], along[1][i], along[2][i]],
            direction: [along[3][i], along[4][i], along[5][i]],
            time: 0.5,
            ..WorldRay::default()
        };
        let world_rays: Vec<WorldRay> = (0..N).map(ray).collect();
        let mut expected = vec![Importance::default(); N];
        adjoint.arrive(&world_rays, &mut expected);
        expected.iter().enumerate().for_each(|(i, expected)| same(&again, i, expected));
    }
}

#[test]
fn what_single_precision_cannot_hold_counts_nothing() {
    // We is 1 over the film's area, 565e24 square units, times the transmission of a leaf shutter, which is 4e-20 just
    // after it opens.
    let camera = camera(|options| {
        (options.xres, options.yres, options.mm_per_unit) = (60, 40, 1e-12);
        options.shutter = c"leaf".as_ptr();
    });
    let sample = realistic_sample { image_x: 31.0, image_y: 19.0, lens_u: 0.5, lens_v: 0.5, time: 0.5 };
    let mut ray = realistic_ray::default();
    // SAFETY: the camera is live.
    let weight = unsafe { realistic_generate_ray(camera.0, &sample, null(), &mut ray) };
    assert!(weight > 0.0);
    let [[ox, oy, oz], [dx, dy, dz]] = [ray.o, ray.d.map(|part| -part)];
    let along: Columns<7> = [ox, oy, oz, dx, dy, dz, 0.5].map(|number| vec![number; 2]);
    let mut counted: Columns<6> = std::array::from_fn(|_| vec![f32::NAN; 2]);
    let mut inputs = rays(&along);
    let times = [0.5, 1e-20];
    inputs.time = realistic_input::columns([times.as_ptr()]);
    // SAFETY: the columns have two numbers.
    let status = unsafe { realistic_camera_importance(camera.0, 2, &inputs, &importance(&mut counted)) };
    assert_eq!(status, realistic_status::Ok, "{}", last_error());
    assert!(counted.iter().all(|column| column[0] > 0.0), "{counted:?}");
    assert!(counted.iter().all(|column| column[1] == 0.0), "{counted:?}");
}

#[test]
fn invalid_requests_are_refused_and_change_nothing() {
    use realistic_status::{InvalidParameter, NotACamera, NullPointer, Ok, StructSize};
    let lens = of_model("lens");
    let (scene_columns, along) = (scene(), columns::<7>());
    let (mut toward, mut counted) = (columns::<7>(), columns::<6>());
    let (points, rays) = (points(&scene_columns), rays(&along));
    let (aimed, found) = (aimed(&mut toward), importance(&mut counted));
    let sample = |camera: *const realistic_camera, n, points: &_, aimed: &_, found: &_| {
        // SAFETY: the columns have N numbers, or none where n is 0 or the call fails.
        unsafe { realistic_camera_sample_importance(camera, n, points, aimed, found) }
    };
    let count = |camera: *const realistic_camera, n, rays: &_, found: &_| {
        // SAFETY: as above.
        unsafe { realistic_camera_importance(camera, n, rays, found) }
    };
    for (model, part) in
        [("perspective", "lens_radius"), ("orthographic", "lens_radius"), ("environment", "lens")]
    {
        let stock = of_model(model);
        assert_eq!(sample(stock.0, N, &points, &aimed, &found), InvalidParameter);
        assert!(last_error().contains(model) && last_error().contains(part), "{}", last_error());
        assert_eq!(count(stock.0, 0, &rays, &found), InvalidParameter);
    }
    assert_eq!(sample(null(), N, &points, &aimed, &found), NotACamera);
    assert_eq!(count(null(), N, &rays, &found), NotACamera);
    assert_eq!(sample(lens.0, usize::MAX / 2, &points, &aimed, &found), InvalidParameter);
    assert_eq!(count(lens.0, usize::MAX / 2, &rays, &found), InvalidParameter);
    let no_x = realistic_scene_points { point: realistic_input::NONE, ..points };
    assert_eq!(sample(lens.0, N, &no_x, &aimed, &found), NullPointer);
    assert!(last_error().contains("points.point.x"), "{}", last_error());
    let no_density = realistic_aimed { density: realistic_output::NONE, ..aimed };
    assert_eq!(sample(lens.0, N, &points, &no_density, &found), NullPointer);
    let none = realistic_importance { importance: realistic_output::NONE, ..found };
    assert_eq!(count(lens.0, N, &rays, &none), NullPointer);
    for size in [0, 8, 1000] {
        assert_eq!(
            sample(lens.0, N, &realistic_scene_points { struct_size: size, ..points }, &aimed, &found),
            StructSize
        );
        assert_eq!(
            count(lens.0, N, &realistic_importance_rays { struct_size: size, ..rays }, &found),
            StructSize
        );
    }
    // SAFETY: NULL is allowed.
    let status = unsafe { realistic_camera_importance(lens.0, N, null(), &found) };
    assert_eq!(status, NullPointer);
    assert_eq!(sample(lens.0, 0, &no_x, &no_density, &none), Ok);
    assert!(counted.iter().chain(&toward).flatten().all(|number| number.is_nan()), "touched");
}

#[test]
fn any_bits_are_answered_from_any_number_of_threads() {
    let cameras = ["lens", "thick", "thin"].map(of_model);
    let mut state = 1_u64;
    let mut bits = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let number = f32::from_bits((state >> 32) as u32);
        if state & 0x300 == 0 { number } else { number % 1000.0 }
    };
    let (mut scene_columns, mut along) = (columns::<6>(), columns::<7>());
    scene_columns.iter_mut().chain(&mut along).flatten().for_each(|number| *number = bits());
    for camera in &cameras {
        let camera = camera.0 as usize;
        let all: Vec<Vec<f32>> = std::thread::scope(|scope| {
            let call = || {
                let (mut toward, mut counted, mut again) = (columns::<7>(), columns::<6>(), columns::<6>());
                let camera = camera as *const realistic_camera;
                let (toward_room, first, second) =
                    (aimed(&mut toward), importance(&mut counted), importance(&mut again));
                // SAFETY: the columns have N numbers; the camera lives until the threads have ended.
                unsafe {
                    let points = points(&scene_columns);
                    let status = realistic_camera_sample_importance(camera, N, &points, &toward_room, &first);
                    assert_eq!(status, realistic_status::Ok);
                    assert_eq!(
                        realistic_camera_importance(camera, N, &rays(&along), &second),
                        realistic_status::Ok
                    );
                }
                toward.into_iter().chain(counted).chain(again).flatten().collect::<Vec<f32>>()
            };
            let threads: Vec<_> = (0..4).map(|_| scope.spawn(call)).collect();
            threads.into_iter().map(|thread| thread.join().expect("no panic")).collect()
        });
        assert!(all[0].iter().all(|number| number.is_finite()));
        assert!(all.iter().all(|found| *found == all[0]), "threads differ");
    }
}
