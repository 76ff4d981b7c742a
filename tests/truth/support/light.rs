//! The light that passes a stop of any shape, by brute force and by a camera's samples, and the fates of two cameras'
//! samples.

use ::realistic_camera::{Camera, Outcome, sampling::DiskMapping};
use realistic_optics::{
    lens::Lens,
    trace::{Path, Ray},
};

use super::{Random, ray, sample};

/// Returns the lens behind its stop, with the stop as the last surface.
fn to_stop(lens: &Lens) -> Path {
    let stop = lens.stop_index().expect("a stop");
    let front = lens.surfaces[stop].vertex;
    let mut behind = Lens { surfaces: lens.surfaces[stop..].to_vec(), ..lens.clone() };
    for surface in &mut behind.surfaces {
        surface.vertex -= front;
    }
    Path::film_to_scene(&behind)
}

/// Returns the mean weight over the rear element's disk, with its standard error, of the rays that pass both the round
/// lens and `transmission`. That function gets the point in the stop, in clear semi-diameters.
pub fn through_stop(
    round: &Camera,
    transmission: impl Fn([f64; 2]) -> f64,
    image: [f32; 2],
    seed: u64,
) -> [f64; 2] {
    let facts = round.facts().expect("a lens");
    let lens = &facts.lens;
    let (path, to_stop) = (Path::<f64>::film_to_scene(lens), to_stop(lens));
    let stop = &lens.surfaces[lens.stop_index().expect("a stop")];
    let film = lens.rear().vertex - facts.film_distance;
    let [x, y] = facts.film.point(image[0].into(), image[1].into());
    let distance = lens.rear().vertex - film;
    let radius = 1.05 * lens.rear().semi_diameter;
    let mut random = Random::new(seed);
    mean(400, 128, || {
        let [px, py] =
            DiskMapping::Concentric.map(random.next(), random.next()).expect("a point").map(|x| radius * x);
        let direction = [px - x, py - y, distance];
        let ray = Ray { origin: [x, y, film], direction };
        let from_stop = Ray { origin: [x, y, film - stop.vertex], direction };
        let passed = match (path.trace(ray), to_stop.trace(from_stop)) {
            (Ok(_), Ok(at)) => transmission([0, 1].map(|axis| at.origin[axis] / stop.semi_diameter)),
            _ => 0.0,
        };
        let cosine = distance / direction.iter().map(|d| d * d).sum::<f64>().sqrt();
        let area = std::f64::consts::PI * radius * radius;
        passed * area * cosine.powi(4) / (distance * distance)
    })
}

/// Returns the mean weight of a camera's samples at a film point, with its standard error.
pub fn of_camera(camera: &Camera, image: [f32; 2], seed: u64) -> [f64; 2] {
    let mut random = Random::new(seed);
    mean(400, 128, || {
        match camera.generate(&sample(image, [random.next() as f32, random.next() as f32]), None) {
            Outcome::Ray(_, weight) => weight.into(),
            _ => 0.0,
        }
    })
}

fn mean(groups: u32, each: u32, mut draw: impl FnMut() -> f64) -> [f64; 2] {
    let means: Vec<f64> =
        (0..groups).map(|_| (0..each).map(|_| draw()).sum::<f64>() / f64::from(each)).collect();
    let mean = means.iter().sum::<f64>() / f64::from(groups);
    let square = means.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
    [mean, (square / f64::from(groups * (groups - 1))).sqrt()]
}

/// Returns the share of a camera's samples in the picture's centre that have a ray.
pub fn acceptance(camera: &Camera, tries: u32, seed: u64) -> f64 {
    let mut random = Random::new(seed);
    let passes =
        |_: &u32| ray(camera, [200.0, 150.0], [random.next() as f32, random.next() as f32]).is_some();
    f64::from((0..tries).filter(passes).count() as u32) / f64::from(tries)
}

/// Returns the numbers of samples over the whole picture that pass the first camera, that it blocks, and whose fate
/// differs in the second camera.
pub fn fates([first, second]: [&Camera; 2], tries: u32) -> [u32; 3] {
    let mut random = Random::new(1);
    let [mut passed, mut blocked, mut differ] = [0; 3];
    for _ in 0..tries {
        let image = [400.0 * random.next() as f32, 300.0 * random.next() as f32];
        let lens = [random.next() as f32, random.next() as f32];
        let [a, b] = [first, second].map(|camera| ray(camera, image, lens).is_some());
        *(if a { &mut passed } else { &mut blocked }) += 1;
        differ += u32::from(a != b);
    }
    [passed, blocked, differ]
}
