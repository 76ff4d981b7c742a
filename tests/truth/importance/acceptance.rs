//! The share of directions toward a lens that pass.

use ::realistic_camera::{Aimed, Camera, ScenePoint};
use realistic_optics::prescription::catalogue;

use super::{
    CAMERAS, camera,
    scene::{numbers, rays},
    support::RASTER,
};

/// Returns the share of directions that have importance, for points on the camera's rays at distances in world units;
/// the number of points from which there is no direction; and the number of points.
pub fn share(camera: &Camera, distance: impl Fn(f64) -> f64) -> (f64, usize, usize) {
    let adjoint = camera.adjoint().expect("defined");
    let points: Vec<ScenePoint> = rays(camera, [RASTER.xres, RASTER.yres], 8000, 5)
        .iter()
        .enumerate()
        .map(|(i, (_, ray, _))| {
            let [.., u, v, w, number] = numbers(3 * i, 9);
            let far = distance(number) as f32;
            let point = [0, 1, 2].map(|axis| ray.origin[axis] + far * ray.direction[axis]);
            ScenePoint { point, sample: [u as f32, v as f32], time: w as f32 }
        })
        .collect();
    let mut aimed = vec![Aimed::default(); points.len()];
    adjoint.aim(&points, &mut aimed);
    let aimed_count = aimed.iter().filter(|aim| aim.density > 0.0).count();
    let passed = aimed.iter().filter(|aim| aim.importance.importance > 0.0).count();
    (passed as f64 / aimed_count as f64, points.len() - aimed_count, points.len())
}

/// Returns the nearest distance of focus, mm from the front vertex, of a camera with a lens.
pub fn nearest_focus(camera: &Camera) -> f64 {
    let Some(facts) = camera.facts() else { return 50.0 };
    let nearest = facts.focus().expect("it focuses").nearest();
    nearest.object_distance - nearest.film_distance + facts.lens.rear().vertex
}

/// Returns the shares of a camera's directions that have importance: for points from the nearest focus to infinity, and
/// for points from a tenth of the nearest focus to the nearest focus. Nearly all points see the lens.
fn shares(given: &[(&str, &str)]) -> [f64; 2] {
    let camera = camera(given);
    let unit = if given.iter().any(|(name, _)| *name == "mm_per_unit") { 0.1 } else { 1.0 };
    let nearest = nearest_focus(&camera).max(1.0);
    let (far, unseen, all) = share(&camera, |number| unit * nearest / number.max(1e-6));
    let (near, unseen_near, _) = share(&camera, |number| unit * nearest * (0.1 + 0.9 * number));
    let text = format!(
        "{given:?} {nearest:.0} mm: {far:.3} ({unseen} of {all} unseen), near {near:.3} ({unseen_near})"
    );
    eprintln!("{text}");
    // Points that do not see the lens lie at the end of a fisheye's image, which receives hardly any light.
    assert!(unseen + unseen_near <= all / 200, "{text}");
    [far, near]
}

/// Returns the mean and the minimum.
fn mean_and_least(shares: &[f64]) -> [f64; 2] {
    [shares.iter().sum::<f64>() / shares.len() as f64, shares.iter().copied().fold(f64::MAX, f64::min)]
}

/// Checks that most directions pass. Directions whose rays miss the film are blocked: few from distant points, more
/// from near points, and most from defocused points at the edge of the film.
fn assert_most_pass(cameras: &[Vec<(&str, &str)>]) {
    let all: Vec<[f64; 2]> = cameras.iter().map(|given| shares(given)).collect();
    let [far, near] = [0, 1].map(|which| all.iter().map(|shares| shares[which]).collect::<Vec<_>>());
    let ([mean, least], [near_mean, near_least]) = (mean_and_least(&far), mean_and_least(&near));
    eprintln!("{mean:.3} in the mean, {least:.3} at least; near {near_mean:.3} and {near_least:.3}");
    assert!(mean > 0.85 && least > 0.65, "{mean:.3}, {least:.3}");
    assert!(near_mean > 0.6 && near_least > 0.2, "near {near_mean:.3}, {near_least:.3}");
}

#[test]
fn most_directions_toward_a_lens_get_through() {
    // The part of the stop's circle that is covered by blades is blocked, too: six blades transmit 0.83 of the circle.
    let cameras: Vec<Vec<(&str, &str)>> = CAMERAS.iter().map(|given| given.to_vec()).collect();
    assert_most_pass(&cameras);
}

#[test]
fn most_directions_toward_every_lens_of_the_catalogue_get_through() {
    let cameras: Vec<Vec<(&str, &str)>> = catalogue::round()
        .enumerate()
        .map(|(number, lens)| {
            let film = if lens.starts_with("phone") { "6" } else { "35" };
            let given = [("lens_file", lens), ("film_diagonal", film), ("fnumber", "8")];
            given[..2 + number % 2].to_vec()
        })
        .collect();
    assert_most_pass(&cameras);
}
