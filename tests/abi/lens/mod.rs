//! A lens without a film through the C ABI.

mod points;

use std::ffi::{CStr, CString, c_char, c_void};
use std::mem::MaybeUninit;
use std::ptr::{null, null_mut};

use realistic::ffi::*;

fn options() -> realistic_options {
    let mut options = MaybeUninit::<realistic_options>::zeroed();
    // SAFETY: there is room for the whole structure.
    unsafe {
        let size = size_of::<realistic_options>() as u32;
        assert_eq!(realistic_options_init(options.as_mut_ptr(), size), realistic_status::Ok);
        options.assume_init()
    }
}

fn last_error() -> String {
    // SAFETY: the message lives until this thread's next failure.
    unsafe { CStr::from_ptr(realistic_last_error()) }.to_str().expect("UTF-8").to_owned()
}

/// Describes rays in columns, x, y, z, dx, dy, dz, with their reasons.
fn lens_rays(columns: &mut [Vec<f64>; 6], reasons: &mut [realistic_reason]) -> realistic_lens_rays {
    let [ox, oy, oz, dx, dy, dz] = columns.each_mut().map(|column| column.as_mut_ptr());
    realistic_lens_rays {
        struct_size: size_of::<realistic_lens_rays>() as u32,
        origin: realistic_vectors::columns([ox, oy, oz]),
        direction: realistic_vectors::columns([dx, dy, dz]),
        reason: reasons.as_mut_ptr(),
        reason_stride: size_of::<realistic_reason>() as isize,
        optical_path: null_mut(),
        optical_path_stride: 0,
    }
}

/// A lens that is freed on drop.
struct Lens(*mut realistic_lens);

impl Lens {
    fn open(options: &realistic_options) -> Result<Self, (realistic_status, String)> {
        let mut lens = null_mut();
        // SAFETY: the options' pointers are the tests' own.
        match unsafe { realistic_lens_new(options, &mut lens) } {
            realistic_status::Ok => Ok(Self(lens)),
            status => {
                assert!(lens.is_null(), "touched");
                Err((status, last_error()))
            }
        }
    }

    fn named(name: &CStr) -> Self {
        Self::open(&realistic_options { lens_file: name.as_ptr(), ..options() }).expect("of the catalogue")
    }

    fn of_text(
        text: &str,
        set: impl FnOnce(&mut realistic_options),
    ) -> Result<Self, (realistic_status, String)> {
        let mut options = options();
        (options.lens_text, options.lens_text_size) = (text.as_ptr().cast::<c_char>(), text.len());
        set(&mut options);
        Self::open(&options)
    }

    fn info(&self) -> realistic_lens_info {
        // SAFETY: zeros are a valid structure of this kind, whose size is set.
        unsafe {
            let mut info = MaybeUninit::<realistic_lens_info>::zeroed().assume_init();
            info.struct_size = size_of::<realistic_lens_info>() as u32;
            assert_eq!(realistic_lens_get_info(self.0, &mut info), realistic_status::Ok);
            info
        }
    }

    fn surface(&self, number: u32) -> Result<realistic_lens_surface, String> {
        // SAFETY: zeros are a valid structure of this kind, whose size is set.
        unsafe {
            let mut surface = MaybeUninit::<realistic_lens_surface>::zeroed().assume_init();
            surface.struct_size = size_of::<realistic_lens_surface>() as u32;
            match realistic_lens_get_surface(self.0, number, &mut surface) {
                realistic_status::Ok => Ok(surface),
                _ => Err(last_error()),
            }
        }
    }

    /// Traces rays, each given as x, y, z, dx, dy, dz.
    fn trace(&self, from: realistic_side, rays: &[[f64; 6]]) -> (Vec<[f64; 6]>, Vec<realistic_reason>) {
        let mut columns: [Vec<f64>; 6] = std::array::from_fn(|c| rays.iter().map(|ray| ray[c]).collect());
        let mut reasons = vec![realistic_reason::Shut; rays.len()];
        let arrays = lens_rays(&mut columns, &mut reasons);
        // SAFETY: the arrays have one element per ray.
        let status = unsafe { realistic_lens_trace(self.0, from as i32, rays.len(), &arrays, null()) };
        assert_eq!(status, realistic_status::Ok, "{}", last_error());
        ((0..rays.len()).map(|i| columns.each_ref().map(|column| column[i])).collect(), reasons)
    }

    /// Traces as [`Lens::trace`] does, and returns the points where rays end and their optical paths.
    fn trace_paths(&self, from: realistic_side, rays: &[[f64; 6]]) -> (Vec<[f64; 6]>, Vec<f64>) {
        let mut columns: [Vec<f64>; 6] = std::array::from_fn(|c| rays.iter().map(|ray| ray[c]).collect());
        let (mut reasons, mut paths) = (vec![realistic_reason::Shut; rays.len()], vec![f64::NAN; rays.len()]);
        let mut arrays = lens_rays(&mut columns, &mut reasons);
        (arrays.optical_path, arrays.optical_path_stride) = (paths.as_mut_ptr(), size_of::<f64>() as isize);
        // SAFETY: the arrays have one element per ray.
        let status = unsafe { realistic_lens_trace(self.0, from as i32, rays.len(), &arrays, null()) };
        assert_eq!(status, realistic_status::Ok, "{}", last_error());
        ((0..rays.len()).map(|i| columns.each_ref().map(|column| column[i])).collect(), paths)
    }

    /// Traces as [`Lens::trace`] does, and also returns the intersections with every surface, scene side first, and the
    /// number of intersections.
    fn trace_points(&self, from: realistic_side, rays: &[[f64; 6]]) -> Vec<Traced> {
        let (n, surfaces) = (rays.len(), self.info().surfaces as usize);
        let mut columns: [Vec<f64>; 6] = std::array::from_fn(|c| rays.iter().map(|ray| ray[c]).collect());
        let mut coordinates = [(); 3].map(|()| vec![7.0; n * surfaces]);
        let (mut reasons, mut met) = (vec![realistic_reason::Shut; n], vec![99; n]);
        let arrays = lens_rays(&mut columns, &mut reasons);
        let [x, y, z] = coordinates.each_mut().map(|column| column.as_mut_ptr());
        let struct_size = size_of::<realistic_lens_points>() as u32;
        let points = realistic_lens_points {
            struct_size,
            point: realistic_vectors::columns([x, y, z]),
            met: met.as_mut_ptr(),
            met_stride: size_of::<u32>() as isize,
        };
        // SAFETY: the arrays have one element per ray, or per point.
        let status = unsafe { realistic_lens_trace(self.0, from as i32, n, &arrays, &points) };
        assert_eq!(status, realistic_status::Ok, "{}", last_error());
        let point = |i: usize, k: usize| coordinates.each_ref().map(|column| column[i * surfaces + k]);
        (0..n)
            .map(|i| Traced {
                ray: columns.each_ref().map(|column| column[i]),
                reason: reasons[i],
                met: met[i] as usize,
                points: (0..surfaces).map(|k| point(i, k)).collect(),
            })
            .collect()
    }
}

/// A ray traced through a lens.
struct Traced {
    ray: [f64; 6],
    reason: realistic_reason,
    met: usize,
    /// Intersections by surface; NaN if the ray does not reach the surface.
    points: Vec<[f64; 3]>,
}

impl Drop for Lens {
    fn drop(&mut self) {
        // SAFETY: the lens is freed once.
        unsafe { realistic_lens_free(self.0) }
    }
}

/// A biconvex lens of 50 mm radii, 6 mm thick, n = 1.5, and a stop 4 mm in front of it.
const SINGLET: &str = "0 4 1 8\n50 6 1.5 20\n-50 0 1 20\n";

#[test]
fn optical_paths_are_returned_on_request_with_the_same_rays() {
    // A plane plate of glass: 20 mm of air, 5 mm of n = 1.5, along the axis and at an angle.
    let plate = Lens::of_text("inf 5 1.5 40\ninf 0 1 40\n", |_| ()).expect("a lens");
    let rays = [
        [0.0, 0.0, 20.0, 0.0, 0.0, -1.0],
        [1.0, 2.0, 20.0, 0.3, 0.0, -1.0],
        [90.0, 0.0, 20.0, 0.0, 0.0, -1.0],
    ];
    let (ends, paths) = plate.trace_paths(realistic_side::Scene, &rays);
    let (plain, _) = plate.trace(realistic_side::Scene, &rays);
    assert_eq!(ends, plain);
    let sine = 0.3 / 1.09_f64.sqrt();
    let inclined = 20.0 * 1.09_f64.sqrt() + 1.5 * 5.0 / (1.0 - (sine / 1.5).powi(2)).sqrt();
    for (own, expected) in paths.iter().zip([27.5, inclined, 20.0]) {
        // The third ray ends at the first surface, outside its rim.
        assert!((own - expected).abs() < 1e-12, "{own} {expected}");
    }
}

#[test]
fn a_singlets_facts_are_the_thick_lens_formulas() {
    let lens = Lens::of_text(SINGLET, |_| ()).expect("a lens");
    let info = lens.info();
    // 1/f = (n - 1)(1/R1 - 1/R2 + (n - 1) d/(n R1 R2)); E. Hecht, *Optics*, 6.1.
    let power = 0.5 * (2.0 / 50.0 - 0.5 * 6.0 / (1.5 * 2500.0));
    let near = |got: f64, expected: f64| assert!((got - expected).abs() < 1e-11, "{got} {expected}");
    near(info.focal_length_mm, 1.0 / power);
    let back = (1.0 - 0.5 * 6.0 / (1.5 * 50.0)) / power;
    near(info.back_focal_distance_mm, back);
    near(info.rear_focal_point_mm, -10.0 - back);
    near(info.rear_principal_plane_mm, -10.0 - back + 1.0 / power);
    near(info.front_focal_point_mm, -4.0 + back);
    // In air, nodal points are principal points.
    assert_eq!((info.index_scene, info.index_film), (1.0, 1.0));
    assert_eq!(info.front_nodal_point_mm, info.front_principal_plane_mm);
    assert_eq!(info.rear_nodal_point_mm, info.rear_principal_plane_mm);
    assert_eq!((info.surfaces, info.stop, info.limiting, info.wavelength), (3, 0, 0, 587.56));
    // The stop is the first surface.
    near(info.entrance_pupil_mm, 0.0);
    near(info.entrance_pupil_diameter_mm, 8.0);
    near(info.fnumber, 1.0 / power / 8.0);
    near(info.fnumber_paraxial, info.fnumber);
    assert!(info.stated_focal_length_mm.is_nan() && info.nominal_film_distance_mm.is_nan());
    // A steep beam loses slightly more than 2 (n - 1)²/(n + 1)² of its light.
    let left = (info.fnumber / info.tnumber_bare).powi(2);
    assert!((left - 0.96 * 0.96).abs() < 1e-4 && info.tnumber_quarter_wave < info.tnumber_bare, "{left}");
    let second = lens.surface(1).expect("there");
    assert_eq!((second.vertex_mm, second.radius_mm, second.thickness_mm), (-4.0, 50.0, 6.0));
    assert_eq!((second.index_scene, second.index_film, second.semi_diameter_mm), (1.0, 1.5, 10.0));
    assert_eq!((lens.surface(0).expect("there").is_stop, second.is_stop), (1, 0));
    assert!(lens.surface(3).expect_err("none").contains("the lens has 3"));
}

#[test]
fn rays_go_through_as_snell_says_and_back_the_same_way() {
    let lens = Lens::of_text("0 0 1 18\n50 6 1.5 20\n-50 0 1 20\n", |_| ()).expect("a lens");
    // A ray parallel to the axis meets a sphere of radius R at height h: sin I = h/R, sin I' = sin I/n.
    let (h, radius) = (5.0_f64, 50.0_f64);
    let slope = (h / radius).asin() - (h / radius / 1.5).asin();
    let (out, reasons) = lens.trace(realistic_side::Scene, &[[0.0, h, 30.0, 0.0, 0.0, -2.0]]);
    assert_eq!(reasons, [realistic_reason::Ok]);
    let [x, y, z, dx, dy, dz] = out[0];
    // The ray travels in the glass from the first sphere to the second.
    let sag = radius - (radius * radius - h * h).sqrt();
    let at = |z: f64| h - slope.tan() * (-z - sag);
    assert!((y - at(z)).abs() < 1e-12, "{y} {z}");
    assert!((z - (-6.0 + radius - (radius * radius - y * y).sqrt())).abs() < 1e-12, "{y} {z}");
    let incidence = slope + (y / radius).asin();
    let behind = (1.5 * incidence.sin()).asin() - (y / radius).asin();
    assert!((dy / dz - behind.tan()).abs() < 1e-12 && x == 0.0 && dx == 0.0, "{dy} {dz} {behind}");
    assert!((dy.hypot(dz) - 1.0).abs() < 1e-15);
    let (back, reasons) = lens.trace(realistic_side::Film, &[[x, y + 3.0 * dy, z + 3.0 * dz, -dx, -dy, -dz]]);
    assert_eq!(reasons, [realistic_reason::Ok]);
    let [_, y, _, _, dy, _] = back[0];
    assert!((y - h).abs() < 1e-12 && dy.abs() < 1e-14, "{y} {dy}");
}

#[test]
fn blocked_rays_say_why_and_end_where_they_were_stopped() {
    let lens = Lens::of_text(SINGLET, |_| ()).expect("a lens");
    let rays = [
        // This ray passes outside the stop, which comes first.
        [0.0, 5.0, 10.0, 0.0, 0.0, -1.0],
        // This ray passes the stop, and meets the first sphere outside its clear aperture.
        [0.0, 0.0, 1.0, 0.0, 4.0, -1.0],
        [f64::NAN, 0.0, 10.0, 0.0, 0.0, -1.0],
        [0.0, 0.0, 10.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 10.0, 0.0, 0.0, -3.0],
    ];
    let (out, reasons) = lens.trace(realistic_side::Scene, &rays);
    use realistic_reason::{Clipped, Missed, Ok};
    assert_eq!(reasons[0], Clipped);
    assert_eq!(out[0], [0.0, 5.0, 0.0, 0.0, 0.0, -1.0]);
    assert!(reasons[1] == Clipped || reasons[1] == Missed);
    assert_eq!(reasons[2..], [Missed, Missed, Ok]);
    assert!(out[2][0].is_nan() && out[2][2] == 10.0);
    assert_eq!(out[3], rays[3]);
    assert_eq!(out[4][3..5], [0.0, 0.0]);
    assert!((out[4][5] + 1.0).abs() <= f64::EPSILON);
}

#[test]
fn a_batch_of_any_size_gives_each_ray_what_it_gets_alone() {
    let lens = Lens::named(c"wide.22mm");
    let rays: Vec<[f64; 6]> = (0..700)
        .map(|i| {
            let part = |step: f64| (f64::from(i) * step).fract() - 0.5;
            [14.0 * part(0.618), 14.0 * part(0.754), -60.0, 0.5 * part(0.569), 0.5 * part(0.831), 1.0]
        })
        .collect();
    let (batch, reasons) = lens.trace(realistic_side::Film, &rays);
    for (i, ray) in rays.iter().enumerate() {
        let (alone, reason) = lens.trace(realistic_side::Film, &[*ray]);
        assert_eq!((alone[0], reason[0]), (batch[i], reasons[i]));
    }
    let passed = reasons.iter().filter(|reason| **reason == realistic_reason::Ok).count();
    assert!((50..650).contains(&passed), "{passed}");
}

#[test]
fn focus_is_the_cameras_and_its_own_inverse() {
    let lens = Lens::named(c"dgauss.50mm");
    let [mut film, mut object] = [0.0; 2];
    for distance in [600.0, 2000.0, f64::INFINITY] {
        // SAFETY: writable numbers.
        unsafe {
            assert_eq!(realistic_lens_focus(lens.0, distance, &mut film), realistic_status::Ok);
            assert_eq!(realistic_lens_focused_on(lens.0, film, &mut object), realistic_status::Ok);
        }
        assert!(object == distance || (object / distance - 1.0).abs() < 1e-9, "{object} {distance}");
        let mut camera = null_mut();
        let mut info = realistic_camera_info {
            struct_size: size_of::<realistic_camera_info>() as u32,
            interfaces: 0,
            focal_length_mm: 0.0,
            fnumber: 0.0,
            film_distance: 0.0,
            focus_distance_mm: 0.0,
            film_diagonal: 0.0,
            crop: [0; 4],
        };
        let options = realistic_options { xres: 4, yres: 3, focus_distance: distance, ..options() };
        // SAFETY: the camera is freed once.
        unsafe {
            assert_eq!(realistic_camera_new(&options, &mut camera), realistic_status::Ok);
            assert_eq!(realistic_camera_get_info(camera, &mut info), realistic_status::Ok);
            realistic_camera_free(camera);
        }
        assert!((info.film_distance / film - 1.0).abs() < 1e-12);
        assert!((info.fnumber - lens.info().fnumber).abs() < 1e-12);
    }
    // SAFETY: as above.
    unsafe {
        film = 7.0;
        assert_eq!(realistic_lens_focus(lens.0, 20.0, &mut film), realistic_status::UnreachableFocus);
        assert!(last_error().contains("nearest") && film == 7.0, "{}", last_error());
        assert_eq!(realistic_lens_focus(lens.0, f64::NAN, &mut film), realistic_status::InvalidParameter);
        assert_eq!(realistic_lens_focus(lens.0, 900.0, null_mut()), realistic_status::NullPointer);
    }
}

#[test]
fn a_lens_takes_wavelength_and_stop_and_no_camera_parameters() {
    // n_d 1.6, V 40: n_F - n_C = 0.6/40.
    let text = "50 5 1.6 40 20\n-50 0 20\n";
    let focal_length = |wavelength: f64| {
        Lens::of_text(text, |options| options.wavelength = wavelength).expect("a lens").info().focal_length_mm
    };
    assert!(focal_length(450.0) < focal_length(587.56) && focal_length(587.56) < focal_length(650.0));
    let stopped = Lens::of_text(SINGLET, |options| options.aperture_diameter = 4.0).expect("a lens");
    assert!((stopped.info().entrance_pupil_diameter_mm - 4.0).abs() < 1e-12);
    let (status, message) =
        Lens::of_text(SINGLET, |options| options.film_diagonal = 24.0).err().expect("refused");
    assert_eq!(status, realistic_status::InvalidParameter);
    assert!(message.contains("\"film_diagonal\" is a camera's") && message.contains("fnumber"), "{message}");
    let (status, message) = Lens::of_text("20 5\n", |_| ()).err().expect("refused");
    assert_eq!(status, realistic_status::LensFile);
    assert!(message.starts_with("lens_text:1:1:"), "{message}");
}

#[test]
fn every_name_of_the_catalogue_opens_a_lens() {
    let mut length = 0;
    // SAFETY: the first buffer has length 0, and the next has room for its capacity.
    let text = unsafe {
        assert_eq!(realistic_catalogue(null_mut(), 0, &mut length), realistic_status::Ok);
        let mut buffer = vec![0_u8; length + 1];
        let status = realistic_catalogue(buffer.as_mut_ptr().cast(), buffer.len(), null_mut());
        assert_eq!(status, realistic_status::Ok);
        buffer.truncate(length);
        String::from_utf8(buffer).expect("UTF-8")
    };
    let names: Vec<&str> = text.split('\n').collect();
    assert!(names[0] == "dgauss.50mm" && names.len() > 20, "{names:?}");
    for name in names {
        Lens::named(&CString::new(name).expect("no NUL"));
    }
}

#[test]
fn warnings_go_to_the_log() {
    unsafe extern "C" fn keep(user: *mut c_void, level: i32, message: *const c_char) {
        // SAFETY: `user` is the pointer that the test below passes.
        unsafe { (*user.cast::<Vec<(i32, CString)>>()).push((level, CStr::from_ptr(message).to_owned())) };
    }
    let mut heard: Vec<(i32, CString)> = Vec::new();
    let lens = Lens::of_text(SINGLET, |options| {
        options.aperture_diameter = 30.0;
        options.log = Some(keep);
        options.log_user = (&raw mut heard).cast();
    });
    drop(lens.expect("a lens"));
    assert_eq!(heard.len(), 1);
    assert!(heard[0].0 == 1 && heard[0].1.to_str().expect("UTF-8").contains("wider than the lens's stop"));
}

#[test]
fn pointers_that_are_no_lens_are_refused() {
    let lens = Lens::named(c"dgauss.50mm");
    let mut name = [0_u8; 8];
    let mut length = 0;
    let not = [0_u64; 4];
    let mut found = 0.0;
    let mut rays = realistic_lens_rays {
        struct_size: size_of::<realistic_lens_rays>() as u32,
        origin: realistic_vectors::columns([null_mut(); 3]),
        direction: realistic_vectors::columns([null_mut(); 3]),
        reason: null_mut(),
        reason_stride: 0,
        optical_path: null_mut(),
        optical_path_stride: 0,
    };
    use realistic_status::{InvalidParameter, NotALens, NullPointer, Ok, StructSize};
    // SAFETY: 8 bytes can be read at every pointer that is not NULL.
    unsafe {
        let none = not.as_ptr().cast::<realistic_lens>();
        for wrong in [null(), none, none.byte_add(1)] {
            assert_eq!(realistic_lens_focus(wrong, 900.0, &mut found), NotALens);
            assert_eq!(realistic_lens_get_name(wrong, null_mut(), 0, &mut length), NotALens);
            assert_eq!(realistic_lens_trace(wrong, 0, 0, &rays, null()), NotALens);
        }
        realistic_lens_free(null_mut());
        realistic_lens_free(none.cast_mut());
        let status = realistic_lens_get_name(lens.0, name.as_mut_ptr().cast(), name.len(), &mut length);
        assert_eq!(
            (status, length, CStr::from_bytes_until_nul(&name).expect("an end")),
            (Ok, 11, c"dgauss.")
        );
        assert_eq!(realistic_lens_trace(lens.0, 0, 0, &rays, null()), Ok);
        assert_eq!(realistic_lens_trace(lens.0, 0, 3, &rays, null()), NullPointer);
        assert!(last_error().contains("rays.origin.x is NULL"));
        assert_eq!(realistic_lens_trace(lens.0, 2, 0, &rays, null()), InvalidParameter);
        rays.struct_size = 8;
        assert_eq!(realistic_lens_trace(lens.0, 0, 0, &rays, null()), StructSize);
        assert_eq!(realistic_lens_trace(lens.0, 0, 0, null(), null()), NullPointer);
        assert_eq!(realistic_lens_get_info(lens.0, null_mut()), NullPointer);
        assert_eq!(realistic_lens_new(&options(), null_mut()), NullPointer);
    }
}
