//! Film that is moved aside, tilted or curved, and its exposure, against brute force, closed forms and flat film.

use std::f64::consts::PI;

use ::realistic_camera::Camera;
use realistic_optics::{
    imaging::{focus::Focus, plane_of_focus::FocusedFilm},
    trace::{Path, Ray},
};

use super::support::{Random, build, camera, host, ray};

/// Pixels of the host's raster.
const RASTER: [f64; 2] = [400.0, 300.0];

/// A film with geometry of its own: centre, shift, tilt in degrees, and curvature in 1/mm.
struct PosedFilm {
    centre: f64,
    shift: [f64; 2],
    tilt: [f64; 2],
    curvature: f64,
}

impl PosedFilm {
    /// Returns the point and the unit normal of flat film coordinates, by rotating vectors about the film's own axes.
    fn at(&self, [u, v]: [f64; 2]) -> ([f64; 3], [f64; 3]) {
        let turn = |[x, y, z]: [f64; 3]| {
            let [a, b] = self.tilt.map(f64::to_radians);
            // The vector is rotated about y, and then about x in the fixed frame; in the film's own frame, the rotation
            // about y is the later one.
            let [x, z] = [x * b.cos() + z * b.sin(), z * b.cos() - x * b.sin()];
            [x, y * a.cos() - z * a.sin(), z * a.cos() + y * a.sin()]
        };
        let radius = self.curvature.recip();
        let (z, normal) = if self.curvature == 0.0 {
            (0.0, [0.0, 0.0, 1.0])
        } else {
            let depth = (radius * radius - u * u - v * v).sqrt();
            (depth * radius.signum() - radius, [u / radius, v / radius, depth / radius.abs()])
        };
        let [x, y, z] = turn([u, v, z]);
        ([x + self.shift[0], y + self.shift[1], z + self.centre], turn(normal))
    }
}

/// Integrates ∫ cos θ_f dω over the rays from a film point that pass, over a square about the rear vertex.
fn irradiance(camera: &Camera, film: &PosedFilm, flat: [f64; 2]) -> f64 {
    const N: u32 = 700;
    let lens = &camera.facts().expect("a lens").lens;
    let (path, half) = (Path::<f64>::film_to_scene(lens), 1.7 * lens.rear().semi_diameter);
    let (origin, normal) = film.at(flat);
    let (mut random, mut sum) = (Random::new(7), 0.0);
    for (i, j) in (0..N).flat_map(|i| (0..N).map(move |j| (i, j))) {
        let mut at = |k: u32| 2.0 * half * (f64::from(k) + random.next()) / f64::from(N) - half;
        let target = [at(i), at(j), lens.rear().vertex];
        let direction = [0, 1, 2].map(|axis| target[axis] - origin[axis]);
        if path.trace(Ray { origin, direction }).is_err() {
            continue;
        }
        let square: f64 = direction.iter().map(|part| part * part).sum();
        let facing: f64 = direction.iter().zip(normal).map(|(part, own)| part * own).sum();
        sum += facing.max(0.0) * direction[2] / (square * square);
    }
    sum * (2.0 * half / f64::from(N)).powi(2)
}

fn mean_weight(camera: &Camera, image: [f64; 2]) -> f64 {
    const N: u32 = 400;
    let (mut random, mut sum) = (Random::new(3), 0.0);
    for (i, j) in (0..N).flat_map(|i| (0..N).map(move |j| (i, j))) {
        let lens = [i, j].map(|k| ((f64::from(k) + random.next()) / f64::from(N)) as f32);
        sum += ray(camera, image.map(|x| x as f32), lens).map_or(0.0, |(_, weight)| f64::from(weight));
    }
    sum / f64::from(N * N)
}

#[test]
fn weights_on_any_film_average_to_the_irradiance_found_by_brute_force() {
    for (lens, tilt, shift, radius) in [
        ("dgauss.50mm", [12.0, 0.0], [0.0, 0.0], f64::INFINITY),
        ("dgauss.50mm", [-7.0, 9.0], [3.0, -2.0], f64::INFINITY),
        ("wide.22mm", [0.0, 6.0], [0.0, 0.0], -70.0),
        ("telephoto.250mm", [15.0, -10.0], [0.0, 4.0], 90.0),
    ] {
        for pupil in ["warped", "rear"] {
            let mut given = vec![
                ("lens_file".to_owned(), lens.to_owned()),
                ("pupil".to_owned(), pupil.to_owned()),
                ("film_diagonal".to_owned(), "24".to_owned()),
                ("film_tilt_x".to_owned(), tilt[0].to_string()),
                ("film_tilt_y".to_owned(), tilt[1].to_string()),
                ("film_shift_x".to_owned(), shift[0].to_string()),
                ("film_shift_y".to_owned(), shift[1].to_string()),
            ];
            if radius.is_finite() {
                given.push(("film_curvature_radius".to_owned(), radius.to_string()));
            }
            let given: Vec<(&str, &str)> =
                given.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect();
            let camera = camera(&given);
            let facts = camera.facts().expect("a lens");
            let film = PosedFilm { centre: facts.film_z(), shift, tilt, curvature: radius.recip() };
            for image in [[200.0, 150.0], [90.0, 220.0], [330.0, 40.0]] {
                let pixel = 24.0 / RASTER[0].hypot(RASTER[1]);
                let flat = [(RASTER[0] / 2.0 - image[0]) * pixel, (image[1] - RASTER[1] / 2.0) * pixel];
                let (exact, found) = (irradiance(&camera, &film, flat), mean_weight(&camera, image));
                assert!(
                    (found / exact - 1.0).abs() < 4e-3,
                    "{lens} {pupil} {tilt:?} {image:?}: {found:e} {exact:e}"
                );
            }
        }
    }
}

#[test]
fn nearly_every_sample_of_a_tilted_film_passes() {
    let camera =
        camera(&[("film_tilt_x", "10"), ("film_tilt_y", "6"), ("film_diagonal", "30"), ("fnumber", "4")]);
    let mut random = Random::new(5);
    let mut number = |most: f64| (most * random.next()) as f32;
    let passed = (0..4000)
        .filter(|_| ray(&camera, [number(400.0), number(300.0)], [number(1.0), number(1.0)]).is_some())
        .count();
    assert!(passed > 3920, "{passed}");
}

#[test]
fn a_shifted_film_has_the_rays_of_film_that_lies_there() {
    let pixel = 30.0 / RASTER[0].hypot(RASTER[1]);
    let (shift, moved) = ([4.0_f64, -2.5], [4.0 / pixel, 2.5 / pixel]);
    let (right, up) = (shift[0].to_string(), shift[1].to_string());
    for model in ["lens", "thick", "thin"] {
        let still = camera(&[("model", model), ("film_diagonal", "30"), ("weighting", "radiometric")]);
        let shifted = camera(&[
            ("model", model),
            ("film_diagonal", "30"),
            ("film_shift_x", &right),
            ("film_shift_y", &up),
        ]);
        for (image, lens) in [([120.0, 90.0], [0.3, 0.6]), ([260.0, 170.0], [0.7, 0.2])] {
            // The film point is farther right and lower, so raster x and raster y are smaller.
            let other = [image[0] - moved[0], image[1] - moved[1]];
            let [own, there] = [(&shifted, image), (&still, other)]
                .map(|(camera, image)| ray(camera, image.map(|x: f64| x as f32), lens).expect("a ray"));
            for axis in 0..3 {
                let off = (own.0.direction[axis] - there.0.direction[axis]).abs();
                assert!(off < 2e-4, "{model}: {own:?} {there:?}");
            }
            assert!((own.1 / there.1 - 1.0).abs() < 2e-3, "{model}: {own:?} {there:?}");
        }
    }
}

#[test]
fn a_plane_through_three_points_is_sharp_on_the_film_for_it() {
    let plain = camera(&[("lens_file", "dgauss.50mm"), ("fnumber", "8")]);
    let lens = &plain.facts().expect("a lens").lens;
    let focus = Focus::new(lens).expect("it focuses");
    // A table top lies 150 mm below the axis, from 700 mm to 1600 mm away.
    let points = [[-200.0, -150.0, 700.0], [250.0, -150.0, 900.0], [0.0, -150.0, 1600.0]];
    let FocusedFilm { film_distance, tilt } = FocusedFilm::on(&focus, points).expect("reachable");
    let numbers = [film_distance, tilt[0], tilt[1]].map(|number| number.to_string());
    let posed = camera(&[
        ("lens_file", "dgauss.50mm"),
        ("fnumber", "8"),
        ("film_distance", &numbers[0]),
        ("film_tilt_x", &numbers[1]),
        ("film_tilt_y", &numbers[2]),
    ]);
    let spot = |camera: &Camera, image: [f32; 2]| {
        let mut random = Random::new(11);
        let hits: Vec<[f64; 2]> = (0..400)
            .filter_map(|_| {
                let (ray, _) = ray(camera, image, [random.next() as f32, random.next() as f32])?;
                let [o, d] = [ray.origin, ray.direction].map(|part| part.map(f64::from));
                let along = (-150.0 - o[1]) / d[1];
                Some([o[0] + along * d[0], o[2] + along * d[2]])
            })
            .collect();
        let mean = [0, 1].map(|axis| hits.iter().map(|hit| hit[axis]).sum::<f64>() / hits.len() as f64);
        let square: f64 = hits.iter().map(|hit| (hit[0] - mean[0]).powi(2)).sum();
        ((square / hits.len() as f64).sqrt(), mean[1])
    };
    let mut depths = Vec::new();
    for image in [[200.0, 210.0], [150.0, 240.0], [260.0, 280.0]] {
        let (width, depth) = spot(&posed, image);
        // Without the tilt, some part of the same table is blurred ten times as much.
        assert!(width < 0.35, "{image:?}: {width} mm wide at {depth} mm");
        depths.push(depth);
    }
    let spread = depths.iter().fold([f64::MAX, 0.0_f64], |[a, b], z| [a.min(*z), b.max(*z)]);
    assert!(spread[1] - spread[0] > 200.0, "{depths:?}");
}

#[test]
fn films_out_of_range_are_refused_by_name() {
    for (given, words) in [
        (&[("film_curvature_radius", "-12")][..], "film_curvature_radius"),
        (&[("film_tilt_x", "85")], "parameter \"film_tilt_x\" is 85"),
        (
            &[("film_tilt_x", "3"), ("transmission", "bare"), ("ghosts", "0.5")],
            "\"ghosts\" are traced to flat film",
        ),
        (&[("film_tilt_y", "70"), ("film_diagonal", "110")], "film_distance"),
        (&[("iso", "200"), ("weighting", "relative")], "\"iso\" scales radiometric weights"),
        (&[("exposure_time", "-1")], "exposure_time"),
    ] {
        let error = build(&host(), given).err().unwrap_or_else(|| panic!("{given:?} was built"));
        assert!(error.contains(words), "{given:?}: {error}");
    }
}

#[test]
fn exposed_weights_are_the_linear_exposure_scale_of_the_t_number() {
    let plain = camera(&[("focus_distance", "400"), ("fnumber", "4")]);
    let exposed = camera(&[
        ("focus_distance", "400"),
        ("fnumber", "4"),
        ("iso", "400"),
        ("exposure_time", "0.02"),
        ("exposure", "1.5"),
        ("responsivity", "0.8"),
    ]);
    let axis = [200.0, 150.0];
    let irradiance = mean_weight(&plain, axis);
    let tnumber = (PI / (4.0 * irradiance)).sqrt();
    // OpenUSD computes responsivity · time · iso / 100 · 2^exposure / fStop².
    let scale = 0.8 * 0.02 * 4.0 * 1.5_f64.exp2() / (tnumber * tnumber);
    assert!((mean_weight(&exposed, axis) / scale - 1.0).abs() < 1e-6);
    // The image is farther away than for an object at infinity: the extension costs light.
    assert!(tnumber > 4.4, "{tnumber}");
}
