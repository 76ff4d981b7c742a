//! Cameras with lenses that are not round: their weights against brute force, importance against rays from the film, the
//! share of samples that pass, and what is refused by name.

use realistic_camera::{Camera, Outcome};
use realistic_optics::{
    prescription::read,
    trace::{Blocked, Path, Ray},
};

use super::{
    importance::disagreements,
    support::{Random, build, host_with, on_all_cores, ray, sample},
};

/// Pixels of the host's raster.
const RASTER: [f64; 2] = [400.0, 300.0];

/// A biconvex element in front of a stop and a weak doublet: sharp enough for a picture.
const ROWS: &str =
    "60 6 1.6 24\n-90 4 1 24\nstop 4 1 12\n-70 3 1.7 18\n200 1 1 18\n120 5 1.6 20\n-40 70 1 20\n";

/// Lenses of every kind, each with the share of the samples that must pass.
fn lenses() -> Vec<(&'static str, String, f64)> {
    let with = |lines: &str| format!("{ROWS}{lines}");
    let anamorphic = "-100 2 1.5 46\ninf 50 1 46\n150 4 1.5 46\ninf 10 1 46\n80 5 1.5 24\n-80 4 1 24\nstop 66 1 14\n\
                      toroid 1 profile=x\ntoroid 3 profile=x\n";
    let cassegrain = "-300 -100 1 100\n-142.857142857142857 150 1 40\nmirror 1\nmirror 2\nasphere 1 conic=-1\n\
                      asphere 2 conic=-3.4489795918367347\nobstruction 1 circle 15\n";
    let fold = "60 6 1.6 24\n-90 4 1 24\nstop 20 1 12\ninf -50 1 26\nmirror 4\nbreak 4 tilt_x=45\nbreak film tilt_x=45\n";
    vec![
        ("cylinders", anamorphic.to_owned(), 0.95),
        ("toroid", with("toroid 1 rotation=45 conic=-0.5 A4=1e-6\n"), 0.95),
        ("biconic", with("biconic 1 x=75 conic_x=0.3 conic_y=-0.8\nbiconic 7 x=-35\n"), 0.95),
        ("decentred", with("break 4 x=1.5 y=-0.8\nbreak 6 x=-1.5 y=0.8\n"), 0.95),
        (
            "tilted",
            with(
                "break 1 tilt_x=4 tilt_y=-3\nbreak 3 first=tilt tilt_x=-4 tilt_y=3\nbreak film tilt_x=3 x=0.5\n",
            ),
            0.9,
        ),
        // The hole in the middle of the pupil is sampled, too.
        ("mirrors", cassegrain.to_owned(), 0.7),
        ("fold", fold.to_owned(), 0.95),
    ]
}

fn camera(text: &str, more: &[(&str, &str)]) -> Camera {
    let given = [&[("film_diagonal", "14")], more].concat();
    build(&host_with(text), &given).unwrap_or_else(|error| panic!("{error}\n{text}")).0
}

/// Integrates ∫ cos²θ dA/d² over the rays from a film point that pass, over a square about the rear vertex.
fn irradiance(camera: &Camera, point: [f64; 2]) -> f64 {
    const N: u32 = 300;
    let facts = camera.facts().expect("a lens");
    let (lens, film) = (&facts.lens, facts.film_z());
    let path = Path::<f64>::film_to_scene(lens).with_apertures(lens);
    let half = 1.3 * lens.rear().semi_diameter;
    let (mut random, mut sum) = (Random::new(7), 0.0);
    for (i, j) in (0..N).flat_map(|i| (0..N).map(move |j| (i, j))) {
        let mut at = |k: u32| 2.0 * half * (f64::from(k) + random.next()) / f64::from(N) - half;
        let target = [at(i), at(j), lens.rear().vertex];
        let origin = [point[0], point[1], film];
        let direction = [0, 1, 2].map(|axis| target[axis] - origin[axis]);
        if path.trace(Ray { origin, direction }).is_err() {
            continue;
        }
        let square: f64 = direction.iter().map(|part| part * part).sum();
        sum += (direction[2] / square).powi(2);
    }
    sum * (2.0 * half / f64::from(N)).powi(2)
}

/// Returns the mean weight of a film point, and the share of its samples that pass.
fn mean_weight(camera: &Camera, image: [f64; 2]) -> [f64; 2] {
    const N: u32 = 150;
    let (mut random, mut sum, mut passed) = (Random::new(3), 0.0, 0);
    for (i, j) in (0..N).flat_map(|i| (0..N).map(move |j| (i, j))) {
        let lens = [i, j].map(|k| ((f64::from(k) + random.next()) / f64::from(N)) as f32);
        if let Some((_, weight)) = ray(camera, image.map(|x| x as f32), lens) {
            sum += f64::from(weight);
            passed += 1;
        }
    }
    [sum / f64::from(N * N), f64::from(passed) / f64::from(N * N)]
}

#[test]
fn weights_average_to_the_irradiance_at_twelve_azimuths() {
    let wrong = on_all_cores(&lenses(), |(name, text, least)| {
        let mut wrong = String::new();
        for pupil in ["warped", "rear"] {
            let camera = camera(text, &[("pupil", pupil)]);
            let pixel = 14.0 / RASTER[0].hypot(RASTER[1]);
            for azimuth in 0..12 {
                let (sin, cos) = f64::from(azimuth * 30).to_radians().sin_cos();
                let reach = [0.3, 0.9][azimuth as usize % 2];
                let image = [200.0 + 150.0 * reach * cos, 150.0 + 140.0 * reach * sin];
                let point = [(RASTER[0] / 2.0 - image[0]) * pixel, (image[1] - RASTER[1] / 2.0) * pixel];
                let (exact, [found, passed]) = (irradiance(&camera, point), mean_weight(&camera, image));
                if !((found / exact - 1.0).abs() < 5e-3) || pupil == "warped" && passed < *least {
                    wrong += &format!("{name} {pupil} {image:?}: {found:e} {exact:e}, {passed} pass\n");
                }
            }
        }
        wrong
    });
    let wrong = wrong.concat();
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn importance_is_that_of_rays_from_the_film() {
    let wrong: Vec<String> = lenses()
        .iter()
        .flat_map(|(name, text, _)| disagreements(name, &camera(text, &[]), 3000.0, [2e-3, 1e-3]))
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn rays_trace_back_to_their_film_points() {
    for (name, text, _) in lenses() {
        let camera = camera(&text, &[]);
        let lens = &camera.facts().expect("a lens").lens;
        let back = Path::<f64>::scene_to_film(lens).with_apertures(lens);
        let film = camera.facts().expect("a lens").film_z();
        let pixel = 14.0 / RASTER[0].hypot(RASTER[1]);
        let (mut random, mut traced) = (Random::new(5), 0);
        for _ in 0..300 {
            let mut number = |most: f64| (most * random.next()) as f32;
            let image = [number(400.0), number(300.0)];
            let Some((out, _)) = ray(&camera, image, [number(1.0), number(1.0)]) else { continue };
            let [direction, from] = [out.direction, out.origin].map(|v| v.map(f64::from));
            // Camera space is lens space; the ray begins on the front surface.
            let origin = [0, 1, 2].map(|axis| from[axis] + 10.0 * direction[axis]);
            let Ok(end) = back.trace(Ray { origin, direction: direction.map(|part| -part) }) else {
                continue;
            };
            let along = (film - end.origin[2]) / end.direction[2];
            let point = [0, 1].map(|axis| end.origin[axis] + along * end.direction[axis]);
            let own = [(200.0 - f64::from(image[0])) * pixel, (f64::from(image[1]) - 150.0) * pixel];
            let off = (point[0] - own[0]).hypot(point[1] - own[1]);
            assert!(off < 2e-3, "{name}: {point:?} {own:?}");
            traced += 1;
        }
        assert!(traced > 150, "{name}: {traced}");
    }
}

#[test]
fn every_ray_of_a_mirror_lens_has_its_transmission_and_reason() {
    let [_, .., (_, text, _), _] = &lenses()[..] else { panic!("the last but one has mirrors") };
    let camera = camera(text, &[("transmission", "bare")]);
    let own = ray(&camera, [200.0, 150.0], [0.9, 0.5]).expect("a ray beside the obstruction").1;
    let plain = self::camera(text, &[]);
    let other = ray(&plain, [200.0, 150.0], [0.9, 0.5]).expect("a ray").1;
    assert!((own / other - 1.0).abs() < 1e-5, "mirrors lose no light: {own} {other}");
    let mut blocked = 0;
    for i in 0..400_u16 {
        let lens = [f32::from(i % 20) / 20.0, f32::from(i / 20) / 20.0];
        match plain.generate(&sample([200.0, 150.0], lens), None) {
            Outcome::Ray(..) => {}
            Outcome::Blocked(Blocked::Clipped) => blocked += 1,
            other => panic!("{lens:?}: {other:?}"),
        }
    }
    assert!(blocked > 10, "{blocked}");
}

#[test]
fn what_needs_an_axis_is_refused_by_name() {
    for (name, text, _) in lenses() {
        let given = [("ghosts", "0.3"), ("transmission", "bare")];
        let error = build(&host_with(&text), &given).err().unwrap_or_else(|| panic!("{name} was built"));
        assert!(
            error.contains("\"ghosts\" are traced between surfaces that are symmetric about one axis"),
            "{error}"
        );
        read(name, text.as_bytes()).expect("a lens");
    }
}
