//! Lenses whose scene or film is in another medium than air: against closed forms, published lenses, exact walks and
//! brute force.

mod cameras;
mod first_order;
mod importance;
mod kernel;

/// The eye of R. Navarro, J. Santamaría and J. Bescós (1985), with the retina of I. Escudero-Sanz and R. Navarro
/// (1999), at 543 nm. The clear diameters are not theirs.
const EYE: &str = "7.72 0.55 1.3777 11\n6.5 3.05 1.3391 11\nstop 0 1.3391 4\n10.2 4 1.4222 9\n-6 16.32 1.3377 9\n\
    asphere 1 conic=-0.26\nasphere 4 conic=-3.1316\nasphere 5 conic=-1\n";

/// US 5,579,169, example 1: a fisheye that water touches. The place of the stop and the clear diameters are not the
/// patent's.
const FISHEYE: &str = "medium 1.33306\n54.988 8 1.5168 64.1 89\n39.999 20 - - 72\n107.519 3 1.67025 57.5 40\n\
    17.841 12 - - 32\n62.107 2.3 1.6968 55.6 22\n17.236 2.4 - - 18\n30.492 10.9 1.59507 35.5 22\n\
    -16.104 13.5 1.79668 45.4 22\n-37.279 8.8 - - 26\nstop 1.5 13.26\n77.9174 1.5 1.79631 40.9 19\n\
    20.537 4.7 1.5186 69.9 19\n-50.576 1 - - 21\n76.226 5.2 1.5168 69.9 21\n-16.237 1.5 1.80518 25.3 21\n\
    -23.312 1.5 - - 23\ninf 1.2 1.5168 64.1 24\ninf 39.34 - - 24\n";

/// A lens in water with its film in a glass; air is inside. Every medium but air disperses.
const IMMERSED: &str = "medium 1.33306 55.8\n60 8 1.88 40.8 40\n-300 6 - - 38\nstop 6 - - 20\n200 6 1.65 33.8 30\n\
    -60 64.7 1.45 68 30\n";

#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} is not {expected}");
}
