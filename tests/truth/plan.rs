//! The plan: leaving out changes no bit without a tolerance; if a tolerance permits errors, they stay below the stated
//! bound, on rays that the planner has not used.

use super::support;

use crate::support::columns::{RayColumns, SampleColumns};
use ::realistic_camera::{
    Camera, CameraMotion, CameraToWorld, Host, Sample, WorldRay,
    plan::{Entry, Precision, Tracing, choice::Verdict},
};
use realistic_optics::trace::Ray;
use realistic_simd::Simd;
use realistic_trace::image_scale::ImageScale;
use support::{LENSES, Random, build, host, host_with};

/// Builds a camera, with or without warnings.
fn camera(host: &Host, given: &[(&str, &str)]) -> Camera {
    build(host, given).unwrap_or_else(|error| panic!("{given:?}: {error}")).0
}

fn random_sample(random: &mut Random, margin: f64) -> Sample {
    let mut across = |size: f64| (random.next() * (size + 2.0 * margin) - margin) as f32;
    let (image_x, image_y) = (across(400.0), across(300.0));
    let mut number = || random.next() as f32;
    Sample { image_x, image_y, lens_u: number(), lens_v: number(), time: number() }
}

/// Returns the results of samples that are requested one by one, or in batches.
fn results(entry: Entry, camera: &Camera, samples: &[Sample]) -> Vec<Option<(WorldRay, f32)>> {
    match entry {
        Entry::One => samples.iter().map(|sample| camera.ray(sample)).collect(),
        Entry::Many => rays(camera, samples),
    }
}

fn rays(camera: &Camera, samples: &[Sample]) -> Vec<Option<(WorldRay, f32)>> {
    const BLOCK: usize = 384;
    let (mut block, mut out) = (SampleColumns::new(BLOCK), RayColumns::new(BLOCK));
    let mut found = Vec::with_capacity(samples.len());
    for some in samples.chunks(BLOCK) {
        some.iter().enumerate().for_each(|(i, sample)| block.set(i, sample));
        camera.trace(&block.first(some.len()), &mut out.first(some.len()));
        found.extend((0..some.len()).map(|i| out.get(i)));
    }
    found
}

/// Returns the 99.9 % quantile of the errors on fresh rays, pixels; the error of a ray that passes only one of the two
/// cameras counts as infinite.
fn quantile_of_errors(entry: Entry, exact: &Camera, model: &Camera, seed: u64) -> f64 {
    const RAYS: usize = 40_000;
    let mut random = Random::new(seed);
    let samples: Vec<Sample> = (0..RAYS).map(|_| random_sample(&mut random, 0.0)).collect();
    let lens = &exact.facts().expect("a lens").lens;
    let film = lens.rear().vertex - exact.facts().expect("a lens").film_distance;
    let in_focus = film + exact.facts().expect("a lens").focus_distance_mm.unwrap_or(f64::INFINITY);
    let scale =
        ImageScale::new(lens, film, exact.facts().expect("a lens").film.reach(), in_focus).expect("lit");
    let ray = |ray: &WorldRay| {
        let direction = ray.direction.map(f64::from);
        let norm = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
        Ray { origin: ray.origin.map(f64::from), direction: direction.map(|x| x / norm) }
    };
    let mut errors: Vec<f64> = rays(exact, &samples)
        .iter()
        .zip(results(entry, model, &samples))
        .zip(&samples)
        .filter_map(|((exact_ray, other), sample)| match (exact_ray, other) {
            (Some((a, _)), Some((b, _))) => {
                let point =
                    exact.facts().expect("a lens").film.point(sample.image_x.into(), sample.image_y.into());
                Some(scale.film_error(point, &ray(a), &ray(&b)) / exact.facts().expect("a lens").film.pixel())
            }
            (None, None) => None,
            _ => Some(f64::INFINITY),
        })
        .collect();
    assert!(errors.len() > 5000, "too few rays to tell");
    errors.sort_by(f64::total_cmp);
    errors[(0.999 * errors.len() as f64) as usize]
}

/// Checks a camera's errors against its tolerance on fresh rays; returns how single calls and batches are traced.
fn stay_within(host: &Host, given: &[(&str, &str)], exact: &Camera, tolerance: &str) -> [Tracing; 2] {
    // The error that rounding to floats alone causes in world rays, pixels.
    const FLOATS: f64 = 3e-4;
    let model = camera(host, &[given, &[("tolerance", tolerance)]].concat());
    let plan = model.plan();
    let choice = plan.choice().expect("a tolerance is given");
    Entry::ALL.map(|entry| {
        let (candidate, errors) = choice.chosen(entry);
        assert!(errors.pixels <= tolerance.parse::<f64>().expect("a number"), "{given:?}");
        for other in &choice.candidates {
            let is_exact = matches!(other.tracing, Tracing::Exact(_));
            if is_exact && matches!(other.verdict, Verdict::Within(_)) {
                assert!(candidate.cost(entry) <= other.cost(entry), "{given:?}: {choice}");
            }
        }
        if candidate.tracing != Tracing::Exact(Precision::F64) {
            let fresh = quantile_of_errors(entry, exact, &model, 7);
            assert!(
                fresh <= errors.pixels + FLOATS,
                "{given:?}, tolerance {tolerance}, {entry}: {}: {fresh} is more than {}",
                candidate.tracing,
                errors.pixels
            );
        }
        candidate.tracing
    })
}

/// Checks that polynomials that replace the surfaces end on the front surface, whatever its figure.
#[test]
fn aspheric_lenses_stay_within_the_stated_error() {
    // The lens is the double Gauss with an asphere at the front, and another at the rear.
    let rows = "29.475 3.76 1.67 25.2\n84.83 0.12 1 25.2\n19.275 4.025 1.67 23\n40.77 3.275 1.699 23\n12.75 5.705 1 18\n\
                0 4.5 0 17.1\n-14.495 1.18 1.603 17\n40.77 6.065 1.658 20\n-20.385 0.19 1 20\n437.065 3.22 1.717 20\n\
                -39.73 0 1 20\nasphere 1 conic=-0.5 A4=-1e-6 A6=1e-9\nasphere 11 conic=-0.5 A4=4e-6 A6=-4e-9\n";
    let phone = [("lens_file", "phone.4mm"), ("film_diagonal", "5")];
    let mut models = Vec::new();
    for (host, given) in [(host_with(rows), &[("fnumber", "8")][..]), (host(), &phone)] {
        let exact = camera(&host, given);
        for tolerance in ["0.05", "0.5", "3"] {
            models.extend(stay_within(&host, given, &exact, tolerance));
        }
    }
    if Simd::best() != Simd::Portable {
        let polynomials = models.iter().filter(|model| matches!(model, Tracing::Polynomials { .. })).count();
        assert!(polynomials > 3, "{models:?}");
    }
}

#[test]
fn fresh_rays_stay_within_the_stated_error() {
    let mut models: [Vec<Tracing>; 2] = Default::default();
    for (name, diagonal) in LENSES {
        let lens = [("lens_file", name), ("film_diagonal", diagonal)];
        for more in [&[][..], &[("fnumber", "8")], &[("focus_distance", "1500")], &[("pupil", "rear")]] {
            let given = [&lens[..], more].concat();
            let exact = camera(&host(), &given);
            for tolerance in ["0.003", "0.05", "0.5", "3"] {
                let chosen = stay_within(&host(), &given, &exact, tolerance);
                chosen.into_iter().zip(&mut models).for_each(|(tracing, models)| models.push(tracing));
            }
        }
    }
    // The models must vary, or the test covers too little. Without vector instructions, few models are cheaper than the
    // exact trace.
    if Simd::best() != Simd::Portable {
        let [one, many] = &models;
        let polynomials = |order| Tracing::Polynomials { order, precision: Precision::F32, fit: () };
        for models in [one, many] {
            assert!(models.contains(&Tracing::Exact(Precision::F32)) && models.contains(&polynomials(5)));
        }
        assert!(one.contains(&polynomials(7)));
        // The fastest model in batches differs from the fastest model one by one.
        let apart = one.iter().zip(many).filter(|(one, many)| one != many).count();
        assert!(apart > 5, "{apart}");
    }
}

#[test]
fn the_light_is_the_exact_cameras_to_a_thousandth() {
    let given = [("lens_file", "dgauss.50mm"), ("fnumber", "5.6")];
    let exact = camera(&host(), &given);
    let model = camera(&host(), &[given[0], given[1], ("tolerance", "1")]);
    let mut random = Random::new(3);
    let samples: Vec<Sample> = (0..100_000).map(|_| random_sample(&mut random, 0.0)).collect();
    for entry in Entry::ALL {
        let light = |camera: &Camera| {
            let found = results(entry, camera, &samples);
            found.iter().flatten().map(|(_, weight)| f64::from(*weight)).sum::<f64>()
        };
        let ratio = light(&model) / light(&exact);
        assert!((ratio - 1.0).abs() < 1e-3, "{entry}: {ratio}");
    }
}

type Bits = Option<[u32; 10]>;

fn bits(found: &Option<(WorldRay, f32)>) -> Bits {
    found.map(|(ray, weight)| {
        let WorldRay { origin: [ox, oy, oz], direction: [dx, dy, dz], mint, maxt, time } = ray;
        [ox, oy, oz, dx, dy, dz, mint, maxt, time, weight].map(f32::to_bits)
    })
}

#[test]
fn without_a_tolerance_the_plan_changes_no_bit() {
    let turned = CameraToWorld::from_rows(&[
        0.6, 0.0, 0.8, 3.0, 0.0, 1.0, 0.0, -1.0, -0.8, 0.0, 0.6, 5.0, 0.0, 0.0, 0.0, 1.0,
    ])
    .expect("rigid");
    let motion = CameraMotion::between((CameraToWorld::IDENTITY, 0.0), (turned, 1.0)).expect("one motion");
    let hosts = [host(), Host { to_world: motion, ..host() }];
    let mut left_out = 0;
    for (name, diagonal) in LENSES {
        for (host, more) in [
            (&hosts[0], &[][..]),
            (&hosts[0], &[("fnumber", "11")]),
            (&hosts[0], &[("fnumber", "11"), ("precision", "single")]),
            (&hosts[0], &[("fnumber", "11"), ("pupil", "disk")]),
            (&hosts[0], &[("pupil", "rear")]),
            (&hosts[1], &[("fnumber", "16"), ("shutter_open", "0.3"), ("shutter_close", "0.3")]),
        ] {
            let given = [&[("lens_file", name), ("film_diagonal", diagonal)][..], more].concat();
            let planned = camera(host, &given);
            let unplanned = camera(&Host { leave_out: false, ..host.clone() }, &given);
            let count = |camera: &Camera| camera.plan().items().iter().filter(|item| !item.kept).count();
            left_out += count(&planned) - count(&unplanned);
            let mut random = Random::new(11);
            // Some samples lie far outside the raster, which the plan does not cover.
            let samples: Vec<Sample> = (0..6000)
                .map(|i| random_sample(&mut random, if i % 10 == 0 { 200.0 } else { 2.0 }))
                .collect();
            let pairs = rays(&planned, &samples).into_iter().zip(rays(&unplanned, &samples));
            for ((a, b), sample) in pairs.zip(&samples) {
                assert_eq!(bits(&a), bits(&b), "{given:?} {sample:?}");
                let one = planned.ray(sample);
                assert_eq!(bits(&one), bits(&a), "{given:?} {sample:?}, one by one");
            }
        }
    }
    assert_eq!(left_out, LENSES.len(), "of each lens the motion in a closed shutter");
}

#[test]
fn one_and_many_rays_have_the_same_bits_with_every_model() {
    let mut compared = 0;
    for given in [
        [("fnumber", "8"), ("tolerance", "0.1")],
        [("fnumber", "22"), ("tolerance", "1")],
        [("fnumber", "1"), ("tolerance", "0.01")],
        [("fnumber", "8"), ("precision", "f32")],
        [("precision", "f32"), ("tolerance", "0.1")],
        [("fnumber", "8"), ("tolerance", "0")],
    ] {
        let camera = camera(&host(), &given);
        let chosen = |entry| camera.plan().choice().map(|choice| choice.chosen(entry).0.tracing);
        if chosen(Entry::One) != chosen(Entry::Many) {
            continue;
        }
        compared += 1;
        let mut random = Random::new(2);
        let samples: Vec<Sample> =
            (0..3001).map(|i| random_sample(&mut random, if i % 50 == 0 { 300.0 } else { 1.0 })).collect();
        for (sample, many) in samples.iter().zip(rays(&camera, &samples)) {
            assert_eq!(bits(&camera.ray(sample)), bits(&many), "{given:?}: {sample:?}");
        }
    }
    assert!(compared >= 5, "{compared}");
}

const SINGLET: &str = "30 2 1.6 16\nDUMMY-60 2 1 16\n0 3 1 6\n80 4 1.5 14\n-50 0 1 14\n";

#[test]
fn a_plane_that_neither_bends_nor_clips_changes_nothing() {
    // A plane with glass on both sides cuts the glass in two.
    let with = SINGLET.replace("DUMMY", "0 2 1.6 60\n");
    let without = SINGLET.replace("30 2", "30 4").replace("DUMMY", "");
    let given = [("film_distance", "40"), ("film_diagonal", "16")];
    let with = camera(&host_with(&with), &given);
    let without = camera(&host_with(&without), &given);
    let mut random = Random::new(4);
    let samples: Vec<Sample> = (0..5000).map(|_| random_sample(&mut random, 2.0)).collect();
    let found = rays(&with, &samples);
    assert!(found.iter().flatten().count() > 1000);
    for (a, b) in found.iter().zip(rays(&without, &samples)) {
        assert_eq!(bits(a), bits(&b));
    }
}

#[test]
fn film_beyond_the_image_is_left_out_only_where_there_is_some() {
    // The fisheye's image has a radius of 13.4 mm; the table extends to the end of the image from slightly inside.
    for (diagonal, beyond) in [("20", false), ("26", false), ("30", true)] {
        let camera = camera(&host(), &[("lens_file", "fisheye.10mm"), ("film_diagonal", diagonal)]);
        let plan = camera.plan();
        let mut items = plan.items().iter();
        let found = items.any(|item| item.what.starts_with("pupil of film beyond") && !item.kept);
        assert_eq!(found, beyond, "{diagonal}: {}", camera.plan());
    }
}

#[test]
fn what_single_precision_cannot_hold_is_not_given_to_it() {
    let rows = |first: &str| format!("{first}\n60 4 1.6 16\n-60 3 1 16\n0 3 1 6\n80 4 1.5 14\n-50 0 1 14\n");
    for (why, text) in [
        ("index", rows("100 2 1.00002 20")),
        ("rim", rows("9 12 1.2 17.9999\n-200 3 1 16")),
        ("factor", rows("").replace("0 3 1 6", "0 3 1 0.0012")),
    ] {
        let given = [("film_distance", "40"), ("film_diagonal", "6"), ("precision", "f32")];
        let (_, warnings) = build(&host_with(&text), &given).unwrap_or_else(|error| panic!("{why}: {error}"));
        assert!(
            warnings.iter().any(|text| text.contains("\"f32\"") && text.contains("use f64")),
            "{why}: {warnings:?}"
        );
        for tolerance in ["0.01", "1", "100"] {
            let given = [("film_distance", "40"), ("film_diagonal", "6"), ("tolerance", tolerance)];
            let Ok((camera, _)) = build(&host_with(&text), &given) else { panic!("{why}: {text}") };
            let plan = camera.plan();
            let choice = plan.choice().expect("a tolerance is given");
            for (chosen, _) in Entry::ALL.map(|entry| choice.chosen(entry)) {
                assert!(
                    !matches!(
                        chosen.tracing,
                        Tracing::Exact(Precision::F32)
                            | Tracing::Polynomials { precision: Precision::F32, .. }
                    ),
                    "{why}: {choice}"
                );
            }
            let single = Tracing::Exact(Precision::F32);
            for candidate in choice.candidates.iter().filter(|candidate| candidate.tracing == single) {
                assert!(
                    matches!(candidate.verdict, Verdict::Excluded(_) | Verdict::Untried),
                    "{why}: {choice}"
                );
            }
        }
    }
}

#[test]
fn a_tolerance_that_is_none_is_refused_with_the_range() {
    for bad in ["-1", "-1e-9", "inf"] {
        let error = build(&host(), &[("tolerance", bad)]).expect_err(bad);
        assert!(error.contains("tolerance") && error.contains("0 (exact) or more"), "{error}");
    }
    for bad in ["nan", "small"] {
        let error = build(&host(), &[("tolerance", bad)]).expect_err(bad);
        assert!(error.contains("tolerance") && error.contains("number"), "{error}");
    }
}

#[test]
fn a_tolerance_beside_a_named_precision_warns() {
    let (camera, warnings) =
        build(&host(), &[("tolerance", "1"), ("precision", "double")]).expect("a camera");
    assert!(camera.plan().choice().is_none());
    assert!(warnings.iter().any(|text| text.contains("\"tolerance\" is not used")), "{warnings:?}");
    let (_, warnings) = build(&host(), &[("tolerance", "1")]).expect("a camera");
    assert!(warnings.iter().any(|text| text.contains("99.9 %")), "{warnings:?}");
}
