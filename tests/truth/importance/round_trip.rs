//! Every ray of a camera, traced back into it.

use ::realistic_camera::{
    Camera, CameraMotion, CameraToWorld, Host, Importance, Raster, ScenePoint, WorldRay,
};

use super::{
    CAMERAS, camera, camera_of,
    scene::{rays, turned},
    support::{RASTER, host},
};

const SIZE: [u32; 2] = [RASTER.xres, RASTER.yres];

/// Returns the largest distance of a returning ray from its film point, pixels; the largest relative difference between
/// We over density and the weight, leaving out one ray in a thousand; and the numbers of lost rays and of all rays.
///
/// The warped pupil's density jumps slightly at the knots of its table, and rounding may have moved a ray across a
/// knot; even then, no weight is off by more than a hundredth.
fn come_back(camera: &Camera, size: [u32; 2]) -> (f64, f64, usize, usize) {
    let adjoint = camera.adjoint().expect("defined");
    let rays = rays(camera, size, 6000, 1);
    let back: Vec<WorldRay> = rays.iter().map(|(_, ray, _)| turned(ray)).collect();
    let mut found = vec![Importance::default(); rays.len()];
    adjoint.arrive(&back, &mut found);
    let (mut off, mut weights, mut lost) = (0.0_f64, Vec::new(), 0);
    for ((sample, _, weight), found) in rays.iter().zip(&found) {
        if found.importance == 0.0 {
            lost += 1;
            continue;
        }
        let [x, y] = found.raster;
        off = off.max((x - f64::from(sample.image_x)).hypot(y - f64::from(sample.image_y)));
        weights.push((found.importance / found.density / f64::from(*weight) - 1.0).abs());
    }
    weights.sort_by(f64::total_cmp);
    assert!(weights[weights.len() - 1] < 1e-2, "{:?}", weights.last());
    (off, weights[weights.len() - 1 - weights.len() / 1000], lost, rays.len())
}

#[test]
fn rays_come_back_to_their_film_point_with_their_weight() {
    for given in CAMERAS {
        let camera = camera(given);
        let (off, weights, lost, all) = come_back(&camera, SIZE);
        // Rays are rounded to single precision on output; with a tolerance, they are also traced in single precision.
        let approximate = given.iter().any(|(name, _)| *name == "tolerance");
        let (most, relative) = if approximate { (0.1, 1e-3) } else { (0.01, 1e-4) };
        eprintln!("{given:?}: {off:.2e} pixels, {weights:.1e}, {lost} of {all} lost");
        assert!(all > 300, "{given:?}: {all} rays");
        assert!(off < most, "{given:?}: {off} pixels");
        assert!(weights < relative, "{given:?}: {weights}");
        // The lost rays pass within rounding of an aperture's edge.
        assert!(lost <= all / 2000 + if approximate { all / 200 } else { 0 }, "{given:?}: {lost} of {all}");
    }
}

/// Returns a camera that moves and turns, is stretched and mirrored, and has a shutter.
fn moving(given: &[(&str, &str)]) -> Camera {
    let pose = |turn: f32, away: f32| {
        let (sin, cos) = turn.sin_cos();
        let rows = [
            -2.0 * cos,
            0.3,
            2.0 * sin,
            100.0 + away, //
            0.0,
            1.5,
            0.2,
            -30.0, //
            2.0 * sin,
            0.0,
            2.0 * cos,
            700.0, //
            0.0,
            0.0,
            0.0,
            1.0,
        ];
        CameraToWorld::from_rows(&rows).expect("affine")
    };
    let motion = CameraMotion::between((pose(0.2, 0.0), 3.0), (pose(0.5, 50.0), 5.0)).expect("a motion");
    let host = Host { to_world: motion, ..host() };
    camera_of(&host, given)
}

#[test]
fn a_moving_stretching_camera_has_its_rays_back() {
    let times = [("shutter_open", "3"), ("shutter_close", "5")];
    for shutter in [&[("shutter", "leaf")][..], &[("shutter", "focal-plane"), ("shutter_slit", "0.6")]] {
        for model in ["lens", "thick"] {
            let given = [&[("model", model)], &times[..], shutter].concat();
            let (off, weights, lost, all) = come_back(&moving(&given), SIZE);
            eprintln!("{given:?}: {off:.2e} pixels, {weights:.1e}, {lost} of {all} lost");
            assert!(all > 2000 && off < 0.05 && weights < 2e-3 && lost <= all / 500, "{given:?}");
        }
    }
}

#[test]
fn a_split_density_multiplies_to_the_whole_one() {
    let cameras = [
        (camera(&[]), true),
        (camera(&[("model", "thin"), ("mm_per_unit", "1000")]), true),
        (moving(&[("shutter_close", "5"), ("shutter_open", "3")]), false),
    ];
    for (camera, is_at_rest) in &cameras {
        let adjoint = camera.adjoint().expect("defined");
        let rays = rays(camera, SIZE, 500, 2);
        let back: Vec<WorldRay> = rays.iter().map(|(_, ray, _)| turned(ray)).collect();
        let mut found = vec![Importance::default(); rays.len()];
        adjoint.arrive(&back, &mut found);
        for (importance, (_, ray, _)) in found.iter().zip(&rays).filter(|(found, _)| found.importance > 0.0) {
            let product = importance.area_density * importance.solid_angle_density / importance.density;
            assert!(product > 0.0 && product <= 1.0 + 1e-9, "{importance:?}");
            if *is_at_rest {
                assert!((product / f64::from(ray.direction[2]) - 1.0).abs() < 1e-6, "{importance:?} {ray:?}");
            }
        }
    }
}

#[test]
fn directions_toward_the_lens_count_what_their_rays_do() {
    for given in CAMERAS {
        let camera = camera(given);
        let adjoint = camera.adjoint().expect("defined");
        let points: Vec<ScenePoint> = rays(&camera, SIZE, 400, 3)
            .iter()
            .enumerate()
            .map(|(i, (sample, ray, _))| {
                let far = 150.0 * 10.0_f32.powf(i as f32 / 100.0);
                ScenePoint {
                    point: [0, 1, 2].map(|axis| ray.origin[axis] + far * ray.direction[axis]),
                    sample: [sample.lens_u, sample.lens_v],
                    time: 0.0,
                }
            })
            .collect();
        let mut aimed = vec![Default::default(); points.len()];
        adjoint.aim(&points, &mut aimed);
        let mut same = 0;
        for aim in aimed.iter().filter(|aim| aim.importance.importance > 0.0) {
            let ray = WorldRay {
                origin: aim.origin.map(|part| part as f32),
                direction: aim.direction.map(|part| part as f32),
                ..WorldRay::default()
            };
            let mut found = [Importance::default()];
            adjoint.arrive(&[ray], &mut found);
            let [found] = found;
            if found.importance > 0.0 {
                same += 1;
                let off = (found.raster[0] - aim.importance.raster[0])
                    .hypot(found.raster[1] - aim.importance.raster[1]);
                assert!(off < 0.02, "{given:?}: {off} pixels");
                let ratio = found.importance / aim.importance.importance;
                assert!((ratio - 1.0).abs() < 1e-4, "{given:?}: {ratio}");
            }
        }
        assert!(same > 10, "{given:?}: {same}");
    }
}

#[test]
fn cameras_without_an_area_say_why_they_have_no_importance() {
    let small = Host::new(Raster { xres: 40, yres: 30 }, None);
    for (model, part) in
        [("perspective", "lens_radius"), ("orthographic", "parallel"), ("environment", "one point")]
    {
        let error = camera_of(&small, &[("model", model)]).adjoint().expect_err("undefined").to_string();
        assert!(error.contains(model) && error.contains(part), "{error}");
    }
    // A camera focused so far away that its rays are parallel in single precision has no importance either.
    let focused = |distance| [("model", "orthographic"), ("lens_radius", "20"), ("focal_distance", distance)];
    let error = camera_of(&small, &focused("1e30")).adjoint().expect_err("undefined").to_string();
    assert!(error.contains("give \"focal_distance\" up to 1e"), "{error}");
    let given = error.rsplit("up to ").next().expect("a distance");
    assert!(camera_of(&small, &focused(given)).adjoint().is_ok(), "{given}");
}
