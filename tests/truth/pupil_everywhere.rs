//! The warped pupil on cameras that it was not tuned to: random ones, and difficult ones.

use super::{
    pupil_fit,
    support::{Random, build, host, on_all_cores},
};

use ::realistic_camera::{Camera, Host, Level, Parameters, Raster, Value};
use pupil_fit::{
    Case, lens_at, lenses,
    survey::{Pupil, Survey},
};
use realistic_optics::{
    lens::Lens,
    prescription::{catalogue, read},
};

/// Random cameras; `lab/examples/pupil_gate.rs` measures more.
const CAMERAS: u64 = 60;
/// Field points of each camera, from the axis to the corner.
const FIELDS: u32 = 7;
/// Minimum share of samples that pass where a twentieth of the axis's light or more arrives; and maximum of the light
/// missed, relative to the axis's light.
const LEAST: f64 = 0.93;
const MISSED: f64 = 2e-3;

fn is_named(case: &Case, height: f64) -> bool {
    case.pupil.given_up().iter().any(|given_up| (given_up.radii[0]..=given_up.radii[1]).contains(&height))
}

#[test]
fn random_cameras_pass_samples_or_name_the_radius() {
    let numbers: Vec<u64> = (0..CAMERAS).collect();
    let counts = on_all_cores(&numbers, |number| passes_or_names(*number));
    let [points, named, dark] =
        counts.iter().fold([0; 3], |sums, counts| std::array::from_fn(|i| sums[i] + counts[i]));
    let counts = format!("{points} field points, {named} named, {dark} dark");
    println!("{counts}");
    assert!(points > 250 && 20 * named < points, "{counts}");
}

/// Returns the numbers of field points of a random camera that pass samples, are reported, and are dark.
fn passes_or_names(number: u64) -> [u32; 3] {
    let [mut points, mut named, mut dark] = [0; 3];
    let random = lenses::camera(number);
    let case = Case::with_reach(&random.lens, random.distance, random.corner);
    let (axis, _) = case.weight([0.0; 2], 60);
    for k in 0..FIELDS {
        let height = 0.995 * random.corner * f64::from(k) / f64::from(FIELDS - 1);
        let point = [height, 0.0];
        let what = format!("{} at {height} mm of {:?}", random.name, case.pupil.image_radius());
        let Some(acceptance) = case.acceptance(point, 60) else {
            assert_eq!(Survey::of(&case, height).pupil(), Pupil::Dark, "{what}");
            dark += 1;
            continue;
        };
        // A pupil with gaps has no single edge along a half-line; a finer grid is used instead.
        let is_named = is_named(&case, height);
        let mean = if is_named { case.weight(point, 400).0 } else { case.expected_weight(point, 400) };
        // An irradiance from lines has an error of a thousandth if the pupil fills most of the lines; few lines across
        // the whole rear element cross a narrow pupil.
        let near = case.irradiance(point, case.surroundings(point), 200, 100);
        let most = MISSED * axis + 5e-3 * near;
        assert!((mean - near).abs() <= most, "{what}: {mean} is not {near}");
        // The rear element transmits no light outside the map's surroundings.
        let whole = case.irradiance(point, case.cover.seen_from(point), 300, 150);
        assert!(whole - mean <= MISSED * axis + 5e-2 * whole, "{what}: {mean} of {whole}");
        if is_named {
            named += 1;
            continue;
        }
        assert!(acceptance >= LEAST || mean < 0.05 * axis, "{what}: {acceptance} pass");
        points += 1;
    }
    [points, named, dark]
}

#[test]
fn pupils_with_gaps_report_what_passes() {
    let random = lenses::camera(411);
    let case = Case::with_reach(&random.lens, random.distance, random.corner);
    for k in 0..120 {
        let height = random.corner * (f64::from(k) + 0.5) / 120.0;
        let acceptance = case.acceptance([height, 0.0], 40).expect("lit");
        assert!(
            acceptance > 0.85 || is_named(&case, height),
            "{} at {height} mm: {acceptance} pass",
            random.name
        );
    }
}

#[test]
fn film_close_behind_the_glass_gets_its_pupil() {
    let mut points = 0;
    for name in catalogue::round() {
        let lens = lens_at(name, None);
        for (distance, reach) in [0.5, 1.0, 2.0, 3.0].into_iter().flat_map(|d| [(d, 8.5), (d, 18.0)]) {
            let case = Case::with_reach(&lens, distance, reach);
            for k in 0..7 {
                let height = 0.99 * reach * f64::from(k) / 6.0;
                let what =
                    format!("{name}, film at {distance} mm, {height} mm of {:?}", case.pupil.image_radius());
                let Some(acceptance) = case.acceptance([height, 0.0], 30) else {
                    assert_eq!(Survey::of(&case, height).pupil(), Pupil::Dark, "{what}");
                    continue;
                };
                assert!(acceptance >= 0.9 || is_named(&case, height), "{what}: {acceptance} pass");
                points += 1;
            }
        }
    }
    assert!(points > 200, "{points}");
}

/// A stop, and a short lens that also transmits light outside the stop: its pupil is a disk with an annulus around it.
const RING: &str = "0 60 0 6\n10 20 1.5 19\n-10 0 1 19\n";

#[test]
fn a_warning_states_where_and_why_the_map_fails() {
    let mut given = Parameters::default();
    given.set("film_distance", Value::Float(5.0)).expect("a parameter");
    given.set("film_diagonal", Value::Float(35.0)).expect("a parameter");
    let mut host = Host::new(Raster { xres: 300, yres: 200 }, None);
    host.lens_text = Some(("ring".to_owned(), RING.as_bytes().to_vec()));
    let mut warnings = Vec::new();
    let mut log = |level: Level, text: &str| {
        if level == Level::Warning && text.contains("\"warped\"") {
            warnings.push(text.to_owned());
        }
    };
    Camera::build(&given, &host, &mut log).expect("built");
    let all = warnings.join("\n");
    for part in ["from ", "mm from the axis", "in the pupil's place", "get through", "samples per pixel"] {
        assert!(all.contains(part), "{part}: {all}");
    }
}

#[test]
fn a_stop_too_narrow_for_a_table_is_reported() {
    for (diameter, is_narrow) in [("1e-9", true), ("1e-8", true), ("1e-3", false)] {
        let (_, warnings) = build(&host(), &[("aperture_diameter", diameter)]).expect("built");
        let is_warned = |part: &str| warnings.iter().any(|text| text.contains(part));
        assert_eq!(is_warned("no light was found"), is_narrow, "{diameter} mm: {warnings:?}");
        assert_eq!(is_warned("none of those tried got through"), is_narrow, "{diameter} mm: {warnings:?}");
    }
}

/// Returns `interfaces` random weak surfaces, aspheres or spheres, of which neighbouring ones cross within their
/// apertures.
fn relay(interfaces: usize, aspheric: bool) -> Lens {
    let mut random = Random::new(interfaces as u64);
    let mut text: String = (0..interfaces)
        .map(|i| {
            let radius = 80.0 * 25.0_f64.powf(random.next()) * if random.next() < 0.5 { 1.0 } else { -1.0 };
            let index = if i.is_multiple_of(2) { 1.4 + 0.4 * random.next() } else { 1.0 };
            format!("{radius} {} {index} {}\n", 0.02 + 0.6 * random.next(), 16.0 + 8.0 * random.next())
        })
        .collect();
    if aspheric {
        text.extend((1..=interfaces).map(|row| {
            let [a4, a6] = [1e-6, 1e-8].map(|size| size * random.signed());
            format!("asphere {row} conic={} A4={a4:e} A6={a6:e}\n", random.signed())
        }));
    }
    Lens::at_d_line(&read("relay", text.as_bytes()).expect("a lens"))
}

#[test]
fn the_table_of_any_lens_takes_a_bounded_number_of_rays() {
    // Bounds on the rays per node, and on the additional searches for the end of the light.
    const PER_NODE: u32 = 9_000;
    const END: u32 = 150_000;
    for (interfaces, aspheric) in
        [(100, false), (300, false), (1000, false), (30, true), (100, true), (1000, true)]
    {
        let lens = relay(interfaces, aspheric);
        for distance in [40.0, 300.0] {
            let what = format!("{interfaces} interfaces, aspheric: {aspheric}, film at {distance} mm");
            let case = Case::with_reach(&lens, distance, 17.6);
            let report = case.pupil.build_report();
            println!("{what}: {report:?}");
            let many = interfaces == 1000 || aspheric && interfaces == 100;
            assert!(report.nodes <= if many { 33 } else { 65 }, "{what}: {report:?}");
            assert!(report.rays < PER_NODE * report.nodes as u32 + END, "{what}: {report:?}");
            for height in [0.0, 1.7, 3.9, 8.8, 17.0] {
                let acceptance = case.acceptance([height, 0.0], 12).filter(|&share| share > 0.0);
                // The most expensive lens has few nodes over the film.
                let least = if interfaces == 1000 && aspheric { 0.6 } else { 0.85 };
                let is_right = acceptance.is_none_or(|share| share > least);
                assert!(is_right || is_named(&case, height), "{what}, at {height}: {acceptance:?}");
            }
        }
    }
}
