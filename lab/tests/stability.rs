//! The stability suite's fast part, and regression tests of defects that it found.

use std::ops::ControlFlow;

use realistic_camera::{
    Camera, CameraError, Host, Outcome, Parameters, Raster, Sample, sampling::DiskMapping,
};
use realistic_lab::stability::{self, Case, CaseResult, Extent, TracerUnderTest, random, tracers};
use realistic_optics::{
    lens::{Lens, first_order::FirstOrder, refraction::Refraction, single_precision::f32_is_fit},
    prescription::{catalogue, read},
    trace::{Direction, Path, Ray},
};

fn show(result: &CaseResult) -> String {
    format!(
        "{}, {}, {}: {:.1e} rad, {:.1e} mm, condition {:.1e}, ratio {:.2e} of {}, {} rays, {} undecided, fails \
         because: {}; {:?}",
        result.group,
        result.name,
        result.tracer,
        result.worst_error_rad,
        result.worst_error_mm,
        result.condition,
        result.ratio,
        result.bound,
        result.rays,
        result.undecided,
        result.fails_because(),
        result.failures.first()
    )
}

fn all_hold(results: &[CaseResult]) {
    for result in results {
        println!("{}", show(result));
    }
    let broken: Vec<String> = results.iter().filter(|result| !result.holds()).map(show).collect();
    assert!(broken.is_empty(), "{broken:#?}");
}

fn with_every_tracer(cases: &[Case]) -> Vec<CaseResult> {
    let tracers = tracers();
    let results = |case: &Case| {
        let trails = case.trails();
        tracers.iter().filter_map(|tracer| case.run(tracer, &trails)).collect::<Vec<_>>()
    };
    cases.iter().flat_map(results).collect()
}

fn named(name: &str) -> TracerUnderTest {
    tracers().into_iter().find(|tracer| tracer.name == name).expect("one of the tracers")
}

fn lens(text: &str) -> Lens {
    Lens::at_d_line(&read("test", text.as_bytes()).expect("a lens"))
}

#[test]
fn every_tracer_keeps_its_bound_on_every_case() {
    let cases = stability::cases();
    assert!(cases.len() > 150);
    all_hold(&with_every_tracer(&cases));
}

#[test]
fn heckberts_method_stays_within_its_bound_at_grazing() {
    // Between equal media nothing is refracted, and a ray is well conditioned at any angle of incidence.
    let lens = lens("0 0 1 1e6");
    for cosine in [1e-1, 1e-2, 1e-3] {
        let rays = (0..200).map(|i| {
            let (sine, turn) = ((1.0_f64 - cosine * cosine).sqrt(), 0.1 + f64::from(i));
            let direction = [sine * turn.cos(), sine * turn.sin(), cosine * (1.0 + 1e-3 * f64::from(i))];
            Ray { origin: [0.0, 0.0, -1.0], direction }
        });
        let case = Case::new("grazing", "equal media", &lens, Direction::FilmToScene, rays.collect());
        let trails = case.trails();
        let ratio = |name: &str| {
            let result = case.run(&named(name), &trails).expect("for any lens");
            assert!(result.rays == 200 && result.condition < 2.3 && result.holds(), "{}", show(&result));
            result.ratio
        };
        assert!(ratio("walk f64") < 2.0 && ratio("other") < 2.0);
        let heckbert = ratio("heckbert");
        assert!((0.05 / cosine..0.3 / cosine).contains(&heckbert), "{heckbert} at cos I = {cosine}");
    }
}

#[test]
fn the_cases_are_decided_and_as_hard_as_they_claim() {
    let cases = stability::cases();
    for case in &cases {
        let trails = case.trails();
        let double = case.run(&named("walk f64"), &trails).expect("for any lens");
        assert!(double.rays >= 5, "{}", show(&double));
    }
    let hardest = with_every_tracer(&stability::stiff::telescopes());
    assert!(hardest.iter().any(|result| result.tracer == "walk f64" && result.condition > 1e8));
    let backward = stability::assemblies::fisheyes();
    let leaves_backward = |ray: &Ray| {
        Path::<f64>::film_to_scene(&backward[0].lens).trace(*ray).is_ok_and(|ray| ray.direction[2] < 0.0)
    };
    assert!(backward[0].rays.iter().any(leaves_backward));
}

#[test]
fn first_order_data_of_stiff_lenses_keep_their_digits() {
    all_hold(&stability::design::first_order());
    all_hold(&stability::design::focus());
}

#[test]
fn random_lenses_agree_with_the_reference() {
    for kind in random::Kind::ALL {
        let results = random::against_reference(kind, 0..300, &tracers());
        all_hold(&results);
        for result in &results {
            // Single precision leaves more rays undecided, because it cannot resolve whether a steep edge lies at the
            // height at which the search starts.
            let part = if result.tracer.contains("f32") { 10 } else { 20 };
            assert!(result.undecided < result.rays / part, "{}", show(result));
        }
    }
}

#[test]
fn no_ray_through_a_random_camera_is_unsound() {
    let survey = random::through_cameras(0..500, 2000);
    assert_eq!(survey.unsound, [], "{survey:?}");
    assert!(survey.rays == 1_000_000 && survey.passed > 100_000, "{survey:?}");
}

#[test]
fn a_run_reports_progress_and_stops_when_told() {
    let mut calls = 0;
    let results = stability::run(Extent::QUICK, &mut |progress| {
        assert!((0.0..1.0).contains(&progress.done));
        calls += 1;
        if calls == 4 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert_eq!(results.len(), 3 * tracers().len());
}

#[test]
fn a_failure_says_why_and_is_found_again_by_its_case_s_name() {
    // No tracer meets a bound of 0: each random lens must fail by its error, and must fail again when it is rerun by
    // name.
    let mut strict = [named("walk f64")];
    strict[0].bound = 0.0;
    for kind in random::Kind::ALL {
        let found = random::against_reference(kind, 40..42, &strict).swap_remove(0);
        assert!(!found.holds() && found.fails_because().starts_with("error ("), "{}", show(&found));
        let again: Vec<_> = (40..42)
            .flat_map(|number| {
                let case = kind.case(number);
                case.run(&strict[0], &case.trails()).expect("for any lens").failures
            })
            .collect();
        assert_eq!(found.failures, again);
        let failure = &found.failures[0];
        let own = stability::rerun(&failure.case);
        assert_eq!(own.len(), tracers().len());
        assert!(own.iter().all(|result| result.name == failure.case && result.rays > 0));
    }
    // Glass of another index sends rays elsewhere and changes whether some pass; the results are compared with the
    // truth for the right glass.
    let case = &stability::interfaces::critical_angles()[0];
    let mut wrong = case.clone();
    wrong.lens.surfaces.iter_mut().for_each(|surface| surface.n_film = 0.5 * (1.0 + surface.n_film));
    let result = wrong.run(&named("walk f64"), &case.trails()).expect("for any lens");
    assert!(result.fails_because().contains("fate (") && !result.holds(), "{}", show(&result));
}

#[test]
fn every_case_is_run_again_by_its_name() {
    let mut names: Vec<(String, &str)> =
        stability::cases().into_iter().map(|case| (case.name, case.group)).collect();
    for result in [stability::design::first_order(), stability::design::focus()].concat() {
        assert_eq!(stability::rerun(&result.name), [result]);
    }
    names.sort();
    let twice = names.windows(2).find(|pair| pair[0].0 == pair[1].0);
    assert_eq!(twice, None, "one name for two cases");
    assert!(stability::rerun("no such case").is_empty() && stability::rerun("random lens x").is_empty());
    let camera = stability::rerun("random camera 3").swap_remove(0);
    assert!(camera.holds() && camera.rays == stability::RAYS_EACH, "{}", show(&camera));
}

#[test]
fn the_pages_failing_lenses_fail_for_the_stated_reasons() {
    let page = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/accuracy.md"));
    let page = page.expect("the page");
    let named: Vec<&str> =
        page.split('`').skip(1).step_by(2).filter(|word| word.starts_with("random ")).collect();
    let failing = |name: &str, tracer: &str| {
        let own = stability::rerun(name).into_iter().find(|result| result.tracer == tracer);
        let own = own.unwrap_or_else(|| panic!("{name}, {tracer}"));
        (own.fails_because(), own.ratio)
    };
    assert_eq!(named, ["random lens 16883", "random aspheric lens 18619", "random aspheric lens 18665"]);
    let [single, double] = [failing(named[0], "one f32"), failing(named[1], "one f64")];
    assert!(single.0.starts_with("error") && (31.0..32.5).contains(&single.1), "{single:?}");
    assert!(double.0.starts_with("error (1)") && (28.0..29.0).contains(&double.1), "{double:?}");
    assert_eq!(failing(named[2], "walk f32").0, "fate (8)");
    assert_eq!(failing(named[2], "walk f64").0, "");
}

#[test]
fn an_asphere_behind_a_plane_is_searched_from_the_rays_start() {
    // The first surface of these lenses is a plane that only limits, inside the bulge of the asphere behind it.
    for number in [1985, 2793, 5932] {
        all_hold(&random::against_reference(random::Kind::Aspheres, number..number + 1, &tracers()));
    }
}

#[test]
fn the_results_do_not_depend_on_the_number_of_cores() {
    let extent = Extent { lenses: 3, cameras: 2 };
    let run = || stability::run(extent, &mut |_| ControlFlow::Continue(()));
    let results = run();
    assert_eq!(results, run());
    for kind in random::Kind::ALL {
        let alone = random::against_reference(kind, 0..3, &tracers());
        assert!(alone.iter().all(|result| results.contains(result)));
    }
    assert!(results.contains(&random::through_cameras(0..2, stability::RAYS_EACH).result()));
}

#[test]
fn where_single_precision_is_fit_its_rays_are() {
    let (mut fit, mut unfit) = (0, 0);
    for case in stability::cases() {
        // Near total reflection no fixed precision resolves an angle, in any lens.
        if f32_is_fit(&case.lens).is_err() || case.group == "critical angle" {
            unfit += 1;
            continue;
        }
        fit += 1;
        let trails = case.trails();
        for (kernel, most) in
            [("walk f32", 1e-5), ("one f32", 1e-4), ("f32 portable", 1e-4), ("f32 anywhere", 1e-4)]
        {
            let Some(single) = case.run(&named(kernel), &trails) else { continue };
            assert!(single.worst_error_rad < most, "{}", show(&single));
        }
    }
    assert!(fit > 50 && unfit > 30, "{fit} fit, {unfit} not");
    let balls = stability::stiff::balls().swap_remove(2);
    let why = f32_is_fit(&balls.lens).expect_err("unfit");
    assert!(why.contains("amplifies rounding"), "{}: {why}", balls.name);
}

#[test]
fn a_direction_may_have_any_length_that_a_double_can_hold() {
    let lens = Lens::at_d_line(&catalogue::find("dgauss.50mm").expect("in the catalogue"));
    let path = Path::<f64>::film_to_scene(&lens);
    let origin = [3.0, -5.0, -72.0];
    let [x, y, z] = [-0.125, 0.25, 1.0];
    let expected = path.trace(Ray { origin, direction: [x, y, z] }).expect("passes");
    for exponent in [-1070, -1000, -500, 500, 1000, 1023] {
        let (half, rest) = (2.0_f64.powi(exponent / 2), 2.0_f64.powi(exponent - exponent / 2));
        let direction = [x, y, z].map(|d| d * half * rest);
        assert_eq!(path.trace(Ray { origin, direction }), Ok(expected), "2^{exponent}");
    }
}

#[test]
fn every_refraction_keeps_directions_near_the_critical_angle() {
    for n in [1.1, 1.5, 2.0, 4.0] {
        let hemisphere = lens(&format!("10 20 {n} 20\n0 0 1 20"));
        for (name, refraction) in Refraction::NAMES {
            let path = Path::<f64>::new(&hemisphere, Direction::FilmToScene, refraction);
            for i in -300..300 {
                let height = 10.0 / n * (1.0 + f64::from(i) * f64::EPSILON);
                let ray = Ray { origin: [0.6 * height, 0.8 * height, -30.0], direction: [0.0, 0.0, 1.0] };
                if let Ok(ray) = path.trace(ray) {
                    let [x, y, z] = ray.direction;
                    assert!((x * x + y * y + z * z - 1.0).abs() < 1e-15, "{name}, n = {n}: {ray:?}");
                }
            }
        }
    }
}

#[test]
fn a_tiny_lens_far_behind_the_first_has_its_own_focal_length() {
    // The lens is a ball behind a kilometre of air and a window of no power, which changes nothing.
    let ball = "0.0005 0.001 1.6 0.0008\n-0.0005 0 1 0.0008";
    let alone = FirstOrder::of(&lens(ball)).expect("focal").focal_length;
    let far = FirstOrder::of(&lens(&format!("0 5 1.5 80\n0 1e6 1 80\n{ball}"))).expect("focal").focal_length;
    assert!((far / alone - 1.0).abs() < 1e-15, "{far} is not {alone}");
}

#[test]
fn lens_samples_at_the_ends_of_their_range_make_sound_rays() {
    for name in catalogue::round() {
        for disk in [DiskMapping::Concentric, DiskMapping::Polar] {
            let parameters =
                Parameters { lens_file: Some(name.to_owned()), disk: Some(disk), ..Parameters::default() };
            let host = Host::new(Raster { xres: 300, yres: 200 }, None);
            let camera = Camera::build(&parameters, &host, &mut |_, _| {}).expect("a camera");
            for lens_u in [0.0, f32::MIN_POSITIVE, 0.5, 1.0 - f32::EPSILON / 2.0, 1.0] {
                for lens_v in [0.0, 1e-45, 0.5, 1.0] {
                    for image_x in [0.0, 150.0, 300.0] {
                        let sample = Sample { image_x, image_y: 100.0, lens_u, lens_v, time: 0.0 };
                        if let Outcome::Ray(ray, weight) = camera.generate(&sample, None) {
                            let all = ray.origin.iter().chain(&ray.direction).chain([&weight]);
                            assert!(all.clone().all(|x| x.is_finite()) && weight > 0.0, "{name} {sample:?}");
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn a_near_film_is_refused_or_gives_finite_weights() {
    for film_distance in [1e-300, 1e-30, 1e-20, 1e-12, 1e-3] {
        let mut host = Host::new(Raster { xres: 3, yres: 3 }, None);
        host.lens_text = Some(("plano-convex".to_owned(), b"50 0 1.5 20\n0 0 1 20".to_vec()));
        let parameters = Parameters { film_distance: Some(film_distance), ..Parameters::default() };
        match Camera::build(&parameters, &host, &mut |_, _| {}) {
            Err(error) => {
                let named = matches!(error, CameraError::FilmInLens { .. } | CameraError::Weight { .. });
                assert!(named, "{film_distance}: {error}");
            }
            Ok(camera) => {
                for i in 0..=20_u8 {
                    let lens_u = f32::from(i) / 20.0;
                    let sample = Sample { image_x: 1.5, image_y: 1.5, lens_u, lens_v: 0.5, time: 0.0 };
                    if let Outcome::Ray(_, weight) = camera.generate(&sample, None) {
                        assert!(weight.is_finite(), "{film_distance}: weight {weight}");
                    }
                }
            }
        }
    }
}
