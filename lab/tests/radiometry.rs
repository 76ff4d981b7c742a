//! The figures that `examples/radiometry` prints, against the laws of optics.

#[path = "../examples/radiometry/main.rs"]
#[allow(dead_code)]
mod radiometry;

use radiometry::{EXPOSURE, against_field, against_fnumber};

#[test]
fn exposure_follows_one_over_the_square_of_the_fnumber() {
    let stops = against_fnumber("dgauss.100mm@50mm", &[4.0, 5.6, 8.0, 11.0, 16.0]).expect("a built-in lens");
    for stop in &stops {
        assert!((stop.against_rule() - 1.0).abs() < 0.01, "{stop:?}: {}", stop.against_rule());
    }
    let first = &stops[0];
    for stop in &stops {
        let ratio = (stop.energy / first.energy) * (stop.fnumber / first.fnumber).powi(2);
        assert!((ratio - 1.0).abs() < 0.01, "{stop:?}: {ratio}");
    }
}

#[test]
fn the_energy_on_a_pixel_is_irradiance_times_area_times_time() {
    let stop = &against_fnumber("wide.22mm", &[8.0]).expect("a built-in lens")[0];
    // A pixel of a film of 35 mm diagonal with 301 x 201 pixels, in m.
    let pixel = 35e-3 / 301.0_f64.hypot(201.0);
    let expected = stop.irradiance * pixel * pixel * EXPOSURE;
    assert!((stop.energy / expected - 1.0).abs() < 1e-6, "{stop:?}");
}

#[test]
fn the_eyes_response_turns_energy_into_luminous_exposure() {
    let stop = &against_fnumber("dgauss.100mm@50mm", &[8.0]).expect("a built-in lens")[0];
    // The middles of the bands are 425, 475, …, 675 nm, half way between the rows of the table.
    let v = [0.0004, 0.038, 0.323, 0.995, 0.631, 0.107, 0.0041];
    let mean = v.windows(2).map(|pair| f64::midpoint(pair[0], pair[1])).sum::<f64>() / 6.0;
    let expected = stop.irradiance * EXPOSURE * 683.0 * mean;
    assert!((stop.luminous / expected - 1.0).abs() < 5e-3, "{stop:?} {expected}");
}

#[test]
fn exposure_falls_toward_the_edge_as_the_computed_vignetting() {
    // Stopped down, few rays from the wide angle's rear element pass, so the results are noisy.
    for (lens, fnumber, noise) in [("dgauss.100mm@50mm", 2.8, 0.01), ("wide.22mm", 5.6, 0.04)] {
        let points = against_field(lens, fnumber, 4).expect("a built-in lens");
        for point in &points {
            assert!((point.measured / point.computed - 1.0).abs() < noise, "{lens}: {point:?}");
        }
        let edge = points.last().expect("the edge");
        assert!(edge.height > 14.0 && edge.computed < 0.9, "{lens}: nothing falls: {edge:?}");
    }
}
