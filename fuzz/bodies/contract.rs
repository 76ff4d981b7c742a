//! The header's promises for every ray, for any bits of the sample.

use realistic::ffi::{realistic_ray, realistic_sample};

/// Maximum deviation of a direction's length from 1.
const UNIT: f64 = 1e-6;

/// Describes the fault of a weight and its ray, if there is one; `before` is the previous content of the ray, which
/// must remain if the ray is blocked.
pub fn broken(
    sample: &realistic_sample,
    ray: &realistic_ray,
    weight: f32,
    before: &realistic_ray,
) -> Option<String> {
    let wrong = if weight == 0.0 {
        let bits = |ray: &realistic_ray| {
            [ray.o[0], ray.o[1], ray.o[2], ray.d[0], ray.d[1], ray.d[2], ray.mint, ray.maxt, ray.time]
                .map(f32::to_bits)
        };
        if bits(ray) == bits(before) { return None } else { "a blocked ray wrote to its place" }
    } else if !(weight > 0.0 && weight.is_finite()) {
        "the weight is neither 0 nor positive and finite"
    } else if !ray.o.iter().chain([&ray.mint, &ray.time]).all(|x| x.is_finite()) {
        "origin, mint or time is not finite"
    } else if !(ray.maxt >= ray.mint) {
        "the ray ends before it begins"
    } else {
        let length = ray.d.iter().map(|&d| f64::from(d).powi(2)).sum::<f64>().sqrt();
        if (length - 1.0).abs() <= UNIT { return None } else { "the direction is not unit" }
    };
    Some(format!("{wrong}: {sample:?} weight {weight} {ray:?}"))
}
