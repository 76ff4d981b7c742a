//! Samples whose numbers are none, or beyond every range.

use super::support;

use realistic::camera::{Camera, Outcome, Parameters, Sample};
use support::host;

#[test]
fn numbers_that_are_none_make_no_ray_of_any_model() {
    for model in ["lens", "thick", "thin", "perspective", "orthographic", "environment"] {
        for more in [None, Some(("lensradius", "2"))] {
            let mut parameters = Parameters::default();
            for (name, value) in [("model", model)].into_iter().chain(more) {
                parameters.set_from_text(name, value).expect("valid");
            }
            let camera = Camera::build(&parameters, &host(), &mut |_, _| {}).expect(model);
            let whole = Sample { image_x: 200.0, image_y: 150.0, lens_u: 0.5, lens_v: 0.5, time: 0.5 };
            assert!(matches!(camera.generate(&whole), Outcome::Ray(..)), "{model}");
            for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 3e38] {
                for sample in [
                    Sample { image_x: bad, ..whole },
                    Sample { image_y: bad, ..whole },
                    Sample { lens_u: bad, ..whole },
                    Sample { lens_v: bad, ..whole },
                    Sample { time: bad, ..whole },
                ] {
                    let found = camera.ray(&sample);
                    assert_eq!(found.is_some(), matches!(camera.generate(&sample), Outcome::Ray(..)));
                    let Some((ray, weight)) = found else { continue };
                    let square: f32 = ray.direction.iter().map(|x| x * x).sum();
                    assert!((square - 1.0).abs() < 1e-5 && weight > 0.0, "{model} {sample:?}: {ray:?}");
                    assert!(ray.origin.iter().all(|x| x.is_finite()), "{model} {sample:?}: {ray:?}");
                    assert!((0.0..=1.0).contains(&ray.time), "{model} {sample:?}: {ray:?}");
                }
            }
        }
    }
}
