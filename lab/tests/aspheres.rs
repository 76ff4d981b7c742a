//! Aspheric lenses in every tracer against the extended-precision reference.

use realistic::{
    lens::{Lens, first_order::FirstOrder},
    prescription::catalogue,
    trace::{Direction::FilmToScene, Ray},
};
use realistic_lab::stability::{Case, tracers};

fn phone_lens() -> Lens {
    Lens::at_d_line(&catalogue::find("phone.4mm").expect("listed"))
}

#[test]
fn a_telephones_lens_has_the_focal_length_that_its_patent_states() {
    let optics = FirstOrder::of(&phone_lens()).expect("focal");
    assert!((optics.focal_length - 4.104_34).abs() < 1e-4, "{}", optics.focal_length);
    assert!((optics.back_focal_distance() - 0.102_77).abs() < 1e-4, "{}", optics.back_focal_distance());
}

#[test]
fn every_tracer_keeps_its_bound_in_a_telephones_lens() {
    let lens = phone_lens();
    let film = lens.rear().vertex - 0.1;
    let at = |i: u32, n: u32| f64::from(i * n % 101) / 50.0 - 1.0;
    let rays = (0..2000).map(|i| {
        let point = [3.0 * at(i, 13), 0.5 * at(i, 37)];
        let slopes = [0.6 * at(i, 29) - 0.1 * point[0], 0.4 * at(i, 53)];
        Ray { origin: [point[0], point[1], film], direction: [slopes[0], slopes[1], 1.0] }
    });
    let case = Case::new("aspheres", "a telephone's lens", &lens, FilmToScene, rays.collect());
    let trails = case.trails();
    let passed = trails.iter().filter(|trail| trail.exact.is_ok()).count();
    println!("{passed} pass");
    for tracer in tracers() {
        println!("{:?}", case.run(&tracer, &trails));
    }
}
