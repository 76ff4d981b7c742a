//! The axial beam reaches as far as exact rays do, and the quantities derived from it agree with it: f-number, pupils,
//! the stop of an f-number, and irradiance.

use super::support;

use ::realistic_camera::sampling::PupilDisk;
use realistic_optics::{
    imaging::{axial_beam::AxialBeam, focus::Focus, irradiance::on_axis},
    lens::{Lens, first_order::FirstOrder},
    prescription::{catalogue, read},
    trace::{Blocked, Path, Ray},
};
use support::{Random, build, host, host_with, lens, lens_of};

/// US 4,123,144, example 8 (Summicron-R 50 mm f/2).
const SUMMICRON: &str = "\
42.71 3.99 1.7343 28.19 28.94
195.38 0.2 1 - 27.06
20.5 7.18 1.67133 41.64 24.02
inf 1.29 1.7919 25.55 21.49
14.94 5.35 1 - 18.39
stop 7.61 18.059
-14.94 1 1.65222 33.6 17.5
inf 5.22 1.79227 47.15 19.27
-20.5 0.2 1 - 20.38
inf 3.69 1.79227 47.15 22.96
-42.71 37.32 1 - 23.97
";

/// Two spheres of 20 mm that cross 9.682458 mm from the axis, well inside their clear diameters.
const CROSSED: &str = "20 5 1.5168 - 40\n-20 30 1 - 40\n";

/// Two faces at distance 0 of radii 70.25 and 70.15, which overlap by 0.0023 mm at their edges (CN 209606699).
const TOUCHING: &str = "\
63 7.3 1.9 30
-70.25 0 1 30
-70.15 1.5 1.5 30
19.75 20 1 25
60 6 1.7 25
-30 40 1 25
";

fn focal_length(lens: &Lens) -> f64 {
    FirstOrder::of(lens).expect("focal").focal_length
}

fn fnumber(lens: &Lens) -> f64 {
    AxialBeam::of(lens).fnumber(focal_length(lens))
}

fn parallel(height: f64) -> Ray {
    Ray { origin: [0.0, height, 1e3], direction: [0.0, 0.0, -1.0] }
}

/// Returns the height of the outermost ray that passes, mm, by a separate search with finer steps and bisection; 0 if
/// no ray passes.
fn outermost(lens: &Lens) -> f64 {
    let path = Path::<f64>::scene_to_film(lens);
    let passes = |height: f64| path.walk(parallel(height)).blocked.is_none();
    const STEPS: u32 = 2560;
    let most = 1.001 * lens.front().semi_diameter;
    let at = |i: u32| most * f64::from(i) / f64::from(STEPS);
    let Some(last) = (0..STEPS).rev().find(|&i| passes(at(i))) else { return 0.0 };
    let (mut inside, mut outside) = (at(last), at(last + 1));
    for _ in 0..60 {
        let middle = 0.5 * (inside + outside);
        if passes(middle) { inside = middle } else { outside = middle }
    }
    inside
}

#[test]
fn fast_lenses_have_the_f_numbers_of_their_names() {
    for (name, expected) in [
        ("planar.50mm", 1.4000),
        ("biotar.100mm", 1.399),
        ("portrait.85mm", 1.400),
        ("macro.105mm", 2.800),
        ("tele.135mm", 2.800),
        ("telephoto.300mm", 2.880),
        ("retrofocus.35mm", 2.800),
    ] {
        let lens = lens(name);
        let beam = AxialBeam::of(&lens);
        let own = beam.fnumber(focal_length(&lens));
        assert!((own - expected).abs() < 6e-4, "{name}: f/{own}");
        assert_eq!(Some(beam.limiting), lens.stop_index(), "{name}");
        assert!(beam.paraxial_fnumber(focal_length(&lens)) > 1.02 * own, "{name}: {beam:?}");
    }
}

#[test]
fn pupils_are_images_of_the_aperture_that_stops_the_next_ray() {
    let lens = lens_of(SUMMICRON);
    let beam = AxialBeam::of(&lens);
    let near =
        |got: f64, expected: f64, most: f64| assert!((got - expected).abs() < most, "{got} {expected}");
    near(beam.diameter() / 2.0, 12.9993, 6e-4);
    near(beam.fnumber(focal_length(&lens)), 2.0007, 1e-4);
    near(beam.paraxial_fnumber(focal_length(&lens)), 2.0740, 1e-4);
    assert_eq!(beam.limiting, 5);
    // Ray-optics has the exact pupils of f/2.
    near(-beam.entrance.position().expect("finite"), 20.21, 0.005);
    near(beam.entrance.diameter() / 2.0, 13.00, 0.005);
    near(beam.exit.position().expect("finite") - lens.rear().vertex, 23.96, 0.05);
    near(beam.exit.diameter() / 2.0, 15.34, 0.01);
    // The light on the axis is that of f/1.9996.
    let film = FirstOrder::of(&lens).expect("focal").rear_focal_point;
    let irradiance = on_axis(&Path::<f64>::film_to_scene(&lens), film, 1.0);
    near((std::f64::consts::PI / irradiance).sqrt() / 2.0, 1.9996, 2e-3);
    let stopped = build(&host_with(SUMMICRON), &[("fnumber", "2.0008")]).expect("a camera");
    assert!(stopped.1.iter().all(|text| !text.contains("fnumber")), "{:?}", stopped.1);
    near(stopped.0.facts().expect("a lens").fnumber(), 2.0008, 1e-12);
}

#[test]
fn where_surfaces_cross_the_beam_that_can_exist_counts() {
    let lens = lens_of(CROSSED);
    let beam = AxialBeam::of(&lens);
    // At that height, the sagitta of both spheres is half the thickness: h² = 20² - 17.5².
    let height = (400.0_f64 - 17.5 * 17.5).sqrt();
    assert!((beam.diameter() / 2.0 / height - 1.0).abs() < 1e-9, "{beam:?}");
    assert!((beam.fnumber(focal_length(&lens)) - 1.0437).abs() < 1e-4);
    let (camera, warnings) = build(&host_with(CROSSED), &[]).expect("a camera");
    let crossing: Vec<_> = warnings.iter().filter(|text| text.contains("cross 9.68246 mm")).collect();
    assert_eq!(crossing.len(), 1, "{warnings:?}");
    assert!((camera.facts().expect("a lens").fnumber() - 1.0437).abs() < 1e-4);
    let (camera, warnings) = build(&host_with(CROSSED), &[("fnumber", "4")]).expect("a camera");
    assert!((camera.facts().expect("a lens").fnumber() - 4.0).abs() < 1e-12, "{warnings:?}");
}

#[test]
fn faces_that_touch_pass_rays_as_a_tracer_without_the_test() {
    let lens = lens_of(TOUCHING);
    assert!(fnumber(&lens) < 1.4, "f/{}", fnumber(&lens));
    // The ray is refracted at each sphere in turn, from its current point: the algorithm of every sequential tracer.
    let sequential = |height: f64| {
        let ([mut y, mut z], [mut dy, mut dz]) = ([height, 50.0], [0.0, -1.0]);
        for surface in &lens.surfaces {
            let centre = surface.vertex - surface.radius;
            let (along, square) =
                (y * dy + (z - centre) * dz, y * y + (z - centre).powi(2) - surface.radius.powi(2));
            let root = (along * along - square).sqrt();
            // The intersection is that on the vertex's side of the sphere.
            let t = if surface.radius > 0.0 { -along - root } else { -along + root };
            (y, z) = (y + t * dy, z + t * dz);
            let normal = [y / surface.radius, (z - centre) / surface.radius];
            let cosine = -(dy * normal[0] + dz * normal[1]);
            let ratio = surface.n_scene / surface.n_film;
            let gain = ratio * cosine - (1.0 - ratio * ratio * (1.0 - cosine * cosine)).sqrt();
            (dy, dz) = (ratio * dy + gain * normal[0], ratio * dz + gain * normal[1]);
        }
        ([y, z], [dy, dz])
    };
    let path = Path::<f64>::scene_to_film(&lens);
    let widest = AxialBeam::of(&lens).diameter() / 2.0;
    for i in 0..=20 {
        let height = widest * f64::from(i) / 20.0;
        let got = path.trace(parallel(height)).expect("through");
        let ([y, z], [dy, dz]) = sequential(height);
        let off = (got.origin[1] - y).hypot(got.origin[2] - z);
        assert!(
            off < 1e-12 && (got.direction[1] - dy).hypot(got.direction[2] - dz) < 1e-13,
            "{height}: {off}"
        );
    }
    // Traced from the film, the fast kernel illuminates every point.
    let (camera, warnings) = build(&host_with(TOUCHING), &[("film_diagonal", "20")]).expect("a camera");
    assert!(warnings.iter().all(|text| !text.contains("dark")), "{warnings:?}");
    assert!(
        camera.facts().expect("a lens").fnumber() < 1.4
            && camera.facts().expect("a lens").focus_distance_mm.is_some(),
        "{warnings:?}"
    );
    // Faces that cross at a larger angle block all light except on the axis, with a warning.
    let crossed = TOUCHING.replace("-70.15", "-60");
    let (_, warnings) = build(&host_with(&crossed), &[]).expect("a camera");
    assert!(warnings.iter().any(|text| text.contains("rows 2 and 3 cross 0 mm")), "{warnings:?}");
}

/// Returns a lens of a few random elements, with or without a stop between them, and perhaps an asphere.
fn random_lens(random: &mut Random) -> Lens {
    let elements = 1 + (4.0 * random.next()) as usize;
    let stop = (5.0 * random.next()) as usize;
    let mut text = String::new();
    let mut sign = || if random.next() < 0.5 { -1.0 } else { 1.0 };
    let signs: Vec<f64> = (0..2 * elements).map(|_| sign()).collect();
    for element in 0..elements {
        let [front, rear] = [0, 1].map(|side| signs[2 * element + side] * (12.0 + 60.0 * random.next()));
        let wide = || 14.0 + 8.0 * f64::from(element as u8 % 2);
        text += &format!(
            "{front:.4} {:.4} {:.5} {:.3}\n",
            1.0 + 5.0 * random.next(),
            1.45 + 0.5 * random.next(),
            wide()
        );
        text += &format!("{rear:.4} {:.4} 1 {:.3}\n", 1.0 + 6.0 * random.next(), wide());
        if element == stop {
            text += &format!("0 {:.4} 0 {:.3}\n", 2.0 + 8.0 * random.next(), 3.0 + 12.0 * random.next());
        }
    }
    Lens::at_d_line(&read("random", text.as_bytes()).expect("a lens"))
}

#[test]
fn the_beam_ends_where_an_independent_search_ends() {
    let mut random = Random::new(11);
    let mut lenses: Vec<Lens> = catalogue::round().map(lens).collect();
    lenses.extend([SUMMICRON, CROSSED, TOUCHING].map(lens_of));
    lenses.extend((0..400).map(|_| random_lens(&mut random)));
    let (mut rings, mut other) = (0, 0);
    for (number, lens) in lenses.iter().enumerate() {
        let beam = AxialBeam::of(lens);
        let (own, found) = (beam.diameter() / 2.0, outermost(lens));
        assert!(own <= found * (1.0 + 1e-9), "{number}: {own} {found}");
        // A search with ten times finer steps may find a narrow annulus outside.
        if own < found * (1.0 - 1e-9) {
            rings += 1;
            continue;
        }
        // The next ray is blocked by the surface that limits the beam.
        let walk = Path::<f64>::scene_to_film(lens).walk(parallel(own * (1.0 + 1e-9)));
        match walk.blocked {
            Some(Blocked::Clipped | Blocked::Reflected) => assert_eq!(walk.surfaces_met, beam.limiting + 1),
            Some(_) => assert_eq!(walk.surfaces_met, beam.limiting),
            None => assert_eq!(own, 0.0, "{number}"),
        }
        let images =
            |surface| realistic_optics::lens::pupil::EntrancePupil::of_surface(lens, surface).diameter();
        other += usize::from(images(beam.limiting) > beam.paraxial_diameter);
    }
    assert!(rings <= 4 && other >= 10, "{rings} {other}");
}

#[test]
fn the_light_on_the_axis_is_that_of_the_f_number() {
    // Abbe's sine condition: E = π sin² U' = π/(2N)², for lenses corrected on the axis.
    for name in catalogue::round() {
        let lens = lens(name);
        let optics = FirstOrder::of(&lens).expect("focal");
        let film = optics.rear_focal_point;
        let reach = PupilDisk::rear(&lens, film, 0.0).expect("behind the lens").slope_radius();
        let light = on_axis(&Path::<f64>::film_to_scene(&lens), film, reach);
        let expected = std::f64::consts::PI / (4.0 * fnumber(&lens).powi(2));
        assert!((light / expected - 1.0).abs() < 0.03, "{name}: {}", light / expected);
        // The disk of the exit pupil contains all of it.
        let slope = PupilDisk::exit(&lens, film).slope_radius();
        let disk = std::f64::consts::PI * slope * slope / (1.0 + slope * slope);
        assert!((disk / light - 1.0).abs() < 1e-6, "{name}: {disk} {light}");
    }
}

#[test]
fn an_f_number_that_is_given_is_the_one_that_is_made() {
    for name in catalogue::round() {
        for number in ["3", "5.6", "16", "128"] {
            let (camera, warnings) =
                build(&host(), &[("lens_file", name), ("fnumber", number)]).expect("a camera");
            let own = camera.facts().expect("a lens").fnumber();
            let given: f64 = number.parse().expect("a number");
            let is_faster = warnings.iter().any(|text| text.contains("is faster than the lens"));
            assert!(is_faster && own > given || (own / given - 1.0).abs() < 1e-9, "{name} {number}: f/{own}");
        }
    }
}

#[test]
fn a_stop_that_cuts_a_ring_out_of_the_beam_is_reported() {
    // A ball's outer rays cross the axis just before its focus: there some of them pass a small stop together with the
    // inner rays.
    let ball = "10 20 1.5 - 18\n-10 4 1 - 18\nstop 10 1 - 12\n";
    let lens = lens_of(ball);
    assert!((AxialBeam::of(&lens).diameter() / 2.0 - outermost(&lens)).abs() < 1e-9);
    let (camera, warnings) =
        build(&host_with(ball), &[("fnumber", "8"), ("film_distance", "9")]).expect("a camera");
    assert!(
        warnings.iter().any(|text| text.contains("cannot be reached by closing the stop")),
        "{warnings:?}"
    );
    assert!(
        (AxialBeam::of(&camera.facts().expect("a lens").lens).diameter() / 2.0
            - outermost(&camera.facts().expect("a lens").lens))
        .abs()
            < 1e-9
    );
    assert!(camera.facts().expect("a lens").fnumber() < 3.0, "{}", camera.facts().expect("a lens").fnumber());
}

#[test]
fn a_lens_that_no_ray_passes_has_no_f_number_and_does_not_focus() {
    let mut dark = lens_of("30 4 1.6 10\n-30 30 1 10\n");
    // The second surface lies in front of the first: every ray would turn back.
    dark.surfaces[0].thickness = -4.0;
    dark.surfaces[1].vertex = 4.0;
    let beam = AxialBeam::of(&dark);
    assert!(beam.is_dark() && beam.fnumber(30.0) == f64::INFINITY, "{beam:?}");
    assert_eq!(beam.exit.diameter(), 0.0);
    let error = Focus::new(&dark).expect_err("no light").to_string();
    assert!(error.contains("no light passes"), "{error}");
}

#[test]
fn a_pinhole_has_its_f_number() {
    let (camera, _) = build(&host(), &[("lens_file", "planar.50mm"), ("fnumber", "1e9")]).expect("a camera");
    assert!(
        (camera.facts().expect("a lens").fnumber() / 1e9 - 1.0).abs() < 1e-9,
        "{}",
        camera.facts().expect("a lens").fnumber()
    );
    assert_eq!(
        Some(camera.facts().expect("a lens").beam.limiting),
        camera.facts().expect("a lens").lens.stop_index()
    );
}
