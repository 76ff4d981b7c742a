//! The warped pupil on cameras that nobody tuned it to: random ones, and such as give it trouble.

use super::{pupil_fit, support::Random};

use pupil_fit::{
    Case, lenses,
    survey::{Pupil, Survey},
};
use realistic::{
    camera::{Host, Level, Parameters, Raster, RealisticCamera, Value},
    lens::Lens,
    prescription::read,
};

/// Random cameras; `cargo bench --bench pupil_sweep` looks at more.
const CAMERAS: u64 = 60;
/// Field points of each, from the axis to the corner.
const FIELDS: u32 = 7;

#[test]
fn samples_get_through_and_miss_nothing_on_random_cameras_or_their_radius_is_named() {
    let (mut points, mut missing, mut named, mut dark) = (0, 0, 0, 0);
    for number in 0..CAMERAS {
        let random = lenses::camera(number);
        let case = Case::with_reach(&random.lens, random.distance, random.corner);
        for k in 0..FIELDS {
            let height = 0.995 * random.corner * f64::from(k) / f64::from(FIELDS - 1);
            let point = [height, 0.0];
            if case
                .pupil
                .given_up()
                .iter()
                .any(|given_up| (given_up.radii[0]..=given_up.radii[1]).contains(&height))
            {
                named += 1;
                continue;
            }
            let what = format!("{} at {height} mm of {:?}", random.name, case.pupil.image_radius());
            let Some(mut acceptance) = case.acceptance(point, 20) else {
                assert_eq!(Survey::of(&case, height).pupil(), Pupil::Dark, "{what}");
                dark += 1;
                continue;
            };
            if acceptance < 0.996 {
                acceptance = case.acceptance(point, 100).expect("lit");
            }
            assert!(acceptance >= 0.99, "{what}: {acceptance} pass");
            let (_, missed) = case.fit(point, 120);
            assert!(missed <= 5e-4, "{what}: misses {missed:e}");
            missing += u32::from(missed > 1e-4);
            points += 1;
        }
    }
    let counts = format!("{points} field points, {missing} miss more than 1e-4, {named} named, {dark} dark");
    println!("{counts}");
    assert!(points > 250 && 50 * missing < points && 50 * named < points, "{counts}");
}

/// A stop, and a short lens beside whose stop light gets through, too: a disk with a ring about it.
const RING: &str = "0 60 0 6\n10 20 1.5 19\n-10 0 1 19\n";

#[test]
fn a_warning_names_the_radii_at_which_the_pupil_was_given_up_why_and_what_is_left() {
    let mut given = Parameters::default();
    given.set("filmdistance", Value::Float(5.0)).expect("a parameter");
    given.set("filmdiag", Value::Float(35.0)).expect("a parameter");
    let mut host = Host::new(Raster { xres: 300, yres: 200 }, None);
    host.lens_text = Some(("ring".to_owned(), RING.as_bytes().to_vec()));
    let mut warnings = Vec::new();
    let mut log = |level: Level, text: &str| {
        if level == Level::Warning && text.contains("\"warped\"") {
            warnings.push(text.to_owned());
        }
    };
    RealisticCamera::build(&given, &host, &mut log).expect("built");
    let all = warnings.join("\n");
    for part in ["from 0.00 to ", "mm from the axis", "in several pieces", "get through", "samples per pixel"]
    {
        assert!(all.contains(part), "{part}: {all}");
    }
}

/// `interfaces` weak surfaces at random, neighbours of which cross within their apertures.
fn relay(interfaces: usize) -> Lens {
    let mut random = Random::new(interfaces as u64);
    let text: String = (0..interfaces)
        .map(|i| {
            let radius = 80.0 * 25.0_f64.powf(random.next()) * if random.next() < 0.5 { 1.0 } else { -1.0 };
            let index = if i.is_multiple_of(2) { 1.4 + 0.4 * random.next() } else { 1.0 };
            format!("{radius} {} {index} {}\n", 0.02 + 0.6 * random.next(), 16.0 + 8.0 * random.next())
        })
        .collect();
    Lens::at_d_line(&read("relay", text.as_bytes()).expect("a lens"))
}

#[test]
fn however_many_surfaces_a_lens_has_its_table_takes_no_more_rays_than_it_may() {
    // 12,000 groups of eight, and the searches for where the image ends.
    const MOST: u32 = 130_000;
    for interfaces in [100, 300, 1000] {
        let lens = relay(interfaces);
        for distance in [40.0, 300.0] {
            let case = Case::with_reach(&lens, distance, 17.6);
            let (report, given_up) = (case.pupil.build_report(), case.pupil.given_up());
            println!("{interfaces} interfaces, film at {distance} mm: {report:?}, {given_up:?}");
            assert!(report.rays < MOST, "{interfaces}, {distance}: {report:?}");
            // Where that was not enough the radii are named.
            for height in [0.0, 1.7, 3.9, 8.8, 17.0] {
                let acceptance = case.acceptance([height, 0.0], 12).filter(|&share| share > 0.0);
                let named =
                    given_up.iter().any(|given_up| (given_up.radii[0]..=given_up.radii[1]).contains(&height));
                assert!(named || acceptance.is_none_or(|share| share > 0.98), "{interfaces} at {height}");
            }
        }
    }
}
