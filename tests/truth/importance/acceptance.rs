//! How many of the directions toward a lens get through.

use realistic::camera::{Aimed, Camera, ScenePoint};

use super::{
    CAMERAS, camera,
    scene::{numbers, rays},
    support::RASTER,
};

/// The share of directions that count something, of points on the camera's rays at distances in world units.
fn share(camera: &Camera, distance: impl Fn(f64) -> f64) -> (f64, usize) {
    let backward = camera.backward().expect("defined");
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
    backward.aim(&points, &mut aimed);
    let asked = aimed.iter().filter(|aim| aim.density > 0.0).count();
    let passed = aimed.iter().filter(|aim| aim.importance.importance > 0.0).count();
    (passed as f64 / asked as f64, points.len() - asked)
}

/// The nearest distance of focus, mm from the front vertex, of a camera with a lens.
fn nearest_focus(camera: &Camera) -> f64 {
    let Some(facts) = camera.facts() else { return 50.0 };
    let nearest = facts.focus().expect("it focuses").nearest();
    nearest.object_distance - nearest.film_distance + facts.lens.rear().vertex
}

#[test]
fn most_directions_toward_a_lens_get_through() {
    let mut wrong = Vec::new();
    for given in CAMERAS {
        let camera = camera(given);
        let unit = if given.iter().any(|(name, _)| *name == "mmperunit") { 0.1 } else { 1.0 };
        let nearest = nearest_focus(&camera);
        let (far, unseen) = share(&camera, |number| unit * nearest / number.max(1e-6));
        let (near, unseen_near) = share(&camera, |number| unit * nearest * (0.1 + 0.9 * number));
        let text =
            format!("{given:?} {nearest:.0} mm: {far:.3} ({unseen} unseen), near {near:.3} ({unseen_near})");
        eprintln!("{text}");
        let has = |part: &str| given.iter().any(|(name, value)| *name == part || *value == part);
        // What the blades cover of the stop is sampled, too. Of a fisheye's pupil, seen from points near by and far from
        // the axis, a table knows little.
        let (least, least_near, most_unseen) = match () {
            () if has("fisheye.10mm") && !has("thick") => (0.7, 0.1, 2500),
            () if has("blades") => (0.75, 0.5, 3),
            () => (0.88, 0.5, 3),
        };
        if unseen + unseen_near > most_unseen || far < least || near < least_near {
            wrong.push(text);
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
