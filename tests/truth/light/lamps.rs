//! Lamps at any position: more than 90 degrees from the axis, near the lens, and where the lens does not see them.

use super::super::support::{Random, lens};
use realistic_light::{Ghosts, Lamp, LampError, Surfaces};
use realistic_optics::{
    lens::{Lens, Ray},
    prescription::Coating,
    trace::Path,
};

fn ghosts(lens: &Lens, film: f64) -> Ghosts {
    Ghosts::new(lens, &Surfaces::new(lens, Coating::Bare), film)
}

/// Returns a lamp at an angle from the axis, degrees.
fn at(degrees: f64) -> Lamp {
    let (sin, cos) = degrees.to_radians().sin_cos();
    Lamp::Distant([sin, 0.0, cos])
}

#[test]
fn a_fisheye_sees_lamps_behind_itself() {
    let lens = lens("fisheye.6mm");
    let film = lens.rear().vertex - lens.nominal_film_distance.expect("the patent's");
    let ghosts = ghosts(&lens, film);
    let path: Path = Path::film_to_scene(&lens);
    let mut looked = 0;
    for radius in [9.0, 9.5, 10.0, 10.5] {
        // The directions of the bundle of rays from a film point lie about one direction; a lamp in that direction
        // illuminates the point.
        let rays = (-400..400).filter_map(|slope| {
            let direction = [f64::from(slope) / 1000.0, 0.0, 1.0];
            path.trace(Ray { origin: [-radius, 0.0, film], direction }).ok()
        });
        let directions: Vec<[f64; 3]> = rays.map(|ray| ray.direction).collect();
        let angles: Vec<f64> = directions.iter().map(|[x, _, z]| x.atan2(*z).to_degrees()).collect();
        let Some(middle) = angles.get(angles.len() / 2) else { continue };
        let angle = middle.abs();
        if angle <= 92.0 {
            continue;
        }
        looked += 1;
        assert_eq!(at(*middle).check(&lens), Ok(()));
        let spray = ghosts.spray(ghosts.direct(), at(*middle), 64);
        let ([x, y], _) = spray.spot().expect("light");
        assert!((x + radius).abs() < 0.05 && y.abs() < 1e-6, "{angle} degrees: {x}, {y} and not {radius}");
    }
    assert!(looked >= 2, "{looked}");
}

#[test]
fn a_front_surface_faces_lamps_up_to_90_degrees_and_its_slope() {
    let fisheye = lens("fisheye.6mm");
    let front = fisheye.front();
    let limit = 90.0 + (front.semi_diameter / front.radius).asin().to_degrees();
    assert_eq!(at(limit - 1.0).check(&fisheye), Ok(()));
    let Err(LampError::Behind { limit: reported, .. }) = at(limit + 0.1).check(&fisheye) else { panic!() };
    assert!((reported - limit).abs() < 1.0, "{reported} {limit}");
    // A concave front surface sees no lamp more than 90 degrees from the axis.
    let text = "-50 2 1.5 - 30\n50 0 1 - 30\n";
    let concave = Lens::at_d_line(&realistic::read("concave", text.as_bytes()).expect("a lens"));
    assert_eq!(at(85.0).check(&concave), Ok(()));
    assert!(matches!(at(90.1).check(&concave), Err(LampError::Behind { limit: 90.0, .. })));
    // Points behave like directions; a point inside the glass is on no side of the surface.
    assert_eq!(Lamp::Point([1000.0, 0.0, -100.0]).check(&fisheye), Ok(()));
    assert!(matches!(Lamp::Point([0.0, 0.0, -5.0]).check(&fisheye), Err(LampError::Behind { .. })));
    assert!(matches!(Lamp::Point([0.0, 0.0, 5.0]).check(&fisheye), Err(LampError::TooNear { .. })));
}

#[test]
fn a_near_lamps_watts_are_those_of_all_directions() {
    // The points lie in front of the surface and beside it. Seen from there, the sphere that contains the surface is
    // wider than the surface's disk perpendicular to the light.
    for (name, point) in [("dgauss.50mm", [10.0, 0.0, 30.0]), ("fisheye.10mm", [30.0, 5.0, 8.0])] {
        let lens = lens(name);
        let ghosts = ghosts(&lens, lens.rear().vertex - 40.0);
        let lamp = Lamp::Point(point);
        assert_eq!(lamp.check(&lens), Ok(()), "{name}");
        let found = ghosts.spray(ghosts.direct(), lamp, 128).watts();
        // Rays leave the lamp uniformly over a cone that contains the front surface; the lamp's intensity gives 1 W/m²
        // in the middle of the front.
        let [low, high] = lens.front().sagitta_range();
        let away = [-point[0], -point[1], f64::midpoint(low, high) - point[2]];
        let squared: f64 = away.iter().map(|x| x * x).sum();
        let axis = away.map(|x| x / squared.sqrt());
        let across = [axis[1], -axis[0], 0.0].map(|x| x / axis[0].hypot(axis[1]));
        let up = [-axis[2] * across[1], axis[2] * across[0], axis[0] * across[1] - axis[1] * across[0]];
        let least = (1.0 - (lens.front().semi_diameter.hypot(high - low)).powi(2) / squared).sqrt();
        let mut random = Random::new(3);
        let count = 200_000;
        let passed: f64 = (0..count)
            .map(|_| {
                let cosine = least + (1.0 - least) * random.next();
                let sine = (1.0 - cosine * cosine).sqrt();
                let (y, x) = (std::f64::consts::TAU * random.next()).sin_cos();
                let direction =
                    std::array::from_fn(|k| cosine * axis[k] + sine * (x * across[k] + y * up[k]));
                ghosts.direct().trace(Ray { origin: point, direction }).map_or(0.0, |(_, left)| left)
            })
            .sum();
        let cone = std::f64::consts::TAU * (1.0 - least);
        let expected = squared * 1e-6 * cone * passed / f64::from(count);
        let error = expected / passed.sqrt();
        assert!((found - expected).abs() < 4.0 * error, "{name}: {found} {expected} within {error}");
        assert!(error < 0.08 * expected, "{name}: {error} of {expected}");
    }
}
