//! Benchmarks directions toward the lens from scene points, for each lens of the catalogue (or the given ones), wide
//! open and stopped down, for far and near points. It reports the cost of the directions, the share that passes and the
//! light that they miss: `cargo bench --bench scene_points -- [LENS]...`. The points lie on the camera's own rays, all
//! over the picture. The camera keeps its lens's own focus, or with `--focused` is focused at the points' distance.
//! Each figure is the worst over its lens's cases, except the mean, which is taken over the cases' means. `--part N`
//! uses an Nth of the samples; `--test` makes a minimal run.

use std::{f64::consts::TAU, hint::black_box, time::Duration};

use realistic_base::numeric::{cross, dot, unit};
use realistic_camera::{
    AdjointCamera, Aimed, Camera, Host, Importance, Parameters, Raster, Sample, ScenePoint, WorldRay,
};
use realistic_lab::{
    render::sequence::{Point, Sequence},
    timing::{Effort, interleaved, repeated},
};
use realistic_optics::prescription::catalogue;

const RASTER: Raster = Raster { xres: 640, yres: 480 };
const STOPS: [Option<f64>; 3] = [None, Some(4.0), Some(8.0)];
/// Directions per batch, each from another point.
const BATCH: usize = 1024;
/// Number of points at which the share of passing directions is measured, and number of directions from each.
const POINTS: usize = 256;
/// Number of points at which the light is measured; number of sample sets; and numbers of directions in a set, toward
/// the lens and anywhere.
const LIT: usize = 16;
const SETS: usize = 8;
const AIMED: usize = 2048;
const ANYWHERE: usize = 32_768;

/// A figure whose ideal is 0, its standard error and its case.
type Figure = (f64, f64, String);
/// Time of the first direction, ms; time of each direction of a batch, ns; the share of directions that are blocked, as
/// the mean over points and at the worst point; and the share of light missed, over all points and at the worst point,
/// which is negative if the estimate exceeds the whole.
type Figures = [Figure; 6];

/// Returns the figure farther from 0.
fn worse(a: Figure, b: Figure) -> Figure {
    if b.0.abs() > a.0.abs() { b } else { a }
}

fn worst(figures: impl Iterator<Item = Figures>) -> Figures {
    figures.reduce(|a, b| std::array::from_fn(|i| worse(a[i].clone(), b[i].clone()))).expect("a case or more")
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let is_given = |name: &str| arguments.iter().any(|argument| argument == name);
    let (test, focused) = (is_given("--test"), is_given("--focused"));
    let mut part = if test { 16 } else { 1 };
    let mut lenses: Vec<&str> = Vec::new();
    let mut words = arguments.iter().map(String::as_str);
    while let Some(word) = words.next() {
        match word {
            "--part" => {
                part = words.next().and_then(|part| part.parse().ok()).expect("--part takes a number")
            }
            lens if !lens.starts_with('-') => lenses.push(lens),
            _ => {}
        }
    }
    if lenses.is_empty() {
        lenses = catalogue::round().take(if test { 1 } else { usize::MAX }).collect();
    }
    println!(
        "| lens | first direction, ms | each of a batch, ns | pass, mean over points and cases | over points | of one point | \
         light left out | of one point |\n|---|---|---|---|---|---|---|---|"
    );
    let cases: Vec<Vec<Figures>> = lenses.iter().map(|lens| measure(lens, focused, part)).collect();
    print("all", &cases.concat());
}

fn print(name: &str, cases: &[Figures]) {
    let mean = cases.iter().map(|case| 1.0 - case[2].0).sum::<f64>() / cases.len() as f64;
    let figures = worst(cases.iter().cloned());
    let [first, each, blocked @ .., left_out, of_one] = &figures;
    let pass = blocked.each_ref().map(|(share, _, case)| format!("{:.3} ({case})", 1.0 - share));
    let light = [left_out, of_one].map(|(share, error, case)| format!("{share:.1e} ± {error:.0e} ({case})"));
    let times = format!("{:.0} | {:.0} ({})", first.0, each.0, each.2);
    println!("| {name} | {times} | {mean:.3} | {} | {} |", pass.join(" | "), light.join(" | "));
}

fn camera(lens: &str, stop: Option<f64>, focus: Option<f64>) -> Camera {
    let film = if lens.starts_with("phone") { 6.0 } else { 30.0 };
    let mut parameters = Parameters::default();
    parameters.set_from_text("lens_file", lens).expect("a text");
    for (name, number) in [("film_diagonal", Some(film)), ("fnumber", stop), ("focus_distance", focus)] {
        let set = number.map(|number| parameters.set_from_text(name, &number.to_string()));
        set.transpose().expect("a number");
    }
    let host = Host::new(RASTER, None);
    Camera::build(&parameters, &host, &mut |_, _| ()).unwrap_or_else(|error| panic!("{lens}: {error}"))
}

/// Evaluates a lens at all stops and distances with a fraction of the samples, then prints and returns the figures.
fn measure(lens: &str, focused: bool, part: usize) -> Vec<Figures> {
    let open = camera(lens, None, None);
    let facts = open.facts().expect("a lens has them");
    let nearest = facts.focus().expect("it focuses").nearest();
    let behind = nearest.film_distance - facts.lens.rear().vertex;
    let stops = STOPS.into_iter().filter(|stop| stop.is_none_or(|stop| stop > facts.fnumber()));
    let distances = [1e7, 1000.0, (nearest.object_distance - behind).max(1.0)];
    let cases = stops.flat_map(|stop| distances.map(|far| (stop, far))).map(|(stop, far)| {
        // At some stops the nearest focus is a little farther.
        let focus = (1.01 * nearest.object_distance).max(far + behind);
        let camera = camera(lens, stop, focused.then_some(focus));
        let stop = stop.map_or("open".to_owned(), |stop| format!("f/{stop}"));
        figures(&camera, far, part, &format!("{stop}, {far:.0} mm"))
    });
    let cases: Vec<Figures> = cases.collect();
    print(lens, &cases);
    cases
}

/// A scene point, and the origin of the camera's ray to it.
type Target = ([f32; 3], [f64; 3]);

/// Computes the figures of a camera for points at the distance `far` from its lens, all over picture and pupil.
fn figures(camera: &Camera, far: f64, part: usize, case: &str) -> Figures {
    let adjoint = camera.adjoint().expect("a lens has importance");
    let name = |figure: f64| (figure, 0.0, case.to_owned());
    let points = samples(0, 4, 16 * POINTS).into_iter().filter_map(|at| target(camera, far, at));
    let targets: Vec<Target> = points.take(POINTS / part).collect();
    let batch = targets.iter().cycle().zip(samples(0, 2, BATCH));
    let batch: Vec<ScenePoint> = batch.map(|(target, at)| toward(target, at)).collect();
    let mut found = vec![Aimed::default(); BATCH];
    let (_, first) = repeated(1, || adjoint.aim(&batch[..1], &mut found[..1]));
    let effort = Effort { rounds: 8 / part + 1, least: Duration::from_millis(1) };
    let task: Box<dyn FnMut()> = Box::new(|| adjoint.aim(black_box(&batch), &mut found));
    let each = interleaved([task], effort)[0].per(BATCH).median;
    let (mut mean, mut most) = (0.0, 0.0_f64);
    for target in &targets {
        let aimed = aimed(adjoint, target, 0, POINTS / part);
        let blocked = aimed.iter().filter(|aimed| aimed.importance.importance == 0.0).count();
        let share = blocked as f64 / aimed.len() as f64;
        (mean, most) = (mean + share / targets.len() as f64, most.max(share));
    }
    let (mut all, mut one) = ([[0.0; 2]; SETS], Figure::default());
    for target in targets.iter().take(LIT / part) {
        let sets = std::array::from_fn(|set| light(camera, target, set as u32, part));
        let whole = sets.iter().map(|[_, whole]| whole).sum::<f64>() / SETS as f64;
        all = std::array::from_fn(|set| {
            [0, 1].map(|estimate| all[set][estimate] + sets[set][estimate] / whole)
        });
        one = worse(one, left_out(&sets, case));
    }
    let [first, each, mean, most] = [first[0] * 1e3, each * 1e9, mean, most].map(name);
    [first, each, mean, most, left_out(&all, case), one]
}

fn target(camera: &Camera, far: f64, [x, y, lens_u, lens_v]: Point) -> Option<Target> {
    let [image_x, image_y] = [RASTER.xres as f32 * x, RASTER.yres as f32 * y];
    let (ray, _) = camera.ray(&Sample { image_x, image_y, lens_u, lens_v, time: 0.5 })?;
    let [origin, direction] = [ray.origin, ray.direction].map(|vector| vector.map(f64::from));
    Some((std::array::from_fn(|axis| (origin[axis] + far * direction[axis]) as f32), origin))
}

fn aimed(adjoint: &AdjointCamera, target: &Target, set: u32, count: usize) -> Vec<Aimed> {
    let points: Vec<_> = samples(set, 2, count).into_iter().map(|at| toward(target, at)).collect();
    let mut found = vec![Aimed::default(); count];
    adjoint.aim(&points, &mut found);
    found
}

/// Estimates the integral of importance over directions from a point in two ways: by directions toward the lens, and by
/// directions independent of the pupil. The second kind of directions fills a cone that contains the whole front
/// surface, or the whole sphere; its density increases toward the camera's own ray as 1/(1 - cos θ + `narrow`).
fn light(camera: &Camera, target: &Target, set: u32, part: usize) -> [f64; 2] {
    let adjoint = camera.adjoint().expect("a lens has importance");
    let aimed = aimed(adjoint, target, set, AIMED / part);
    let light = |aimed: &Aimed| aimed.importance.importance / aimed.density.max(f64::MIN_POSITIVE);
    let by_aim: f64 = aimed.iter().map(light).sum();
    let (from, front) = (target.0.map(f64::from), target.1);
    let cone_axis = [0, 1, 2].map(|axis| front[axis] - from[axis]);
    let (distance, cone_axis) = (dot(cone_axis, cone_axis).sqrt(), unit(cone_axis));
    let facts = camera.facts().expect("a lens has them");
    let ([low, high], semi) = (facts.lens.front().sagitta_range(), facts.lens.front().semi_diameter);
    // Longer than the distance between any two points of the surface.
    let across = 1.01 * (2.0 * semi).hypot(high - low);
    let square = (across / distance).powi(2);
    let is_far = square < 0.25;
    let most = if is_far { square / (1.0 + (1.0 - square).sqrt()) } else { 2.0 };
    let narrow = 0.5 * (0.15 * facts.beam.diameter().min(semi) / (distance + semi)).powi(2);
    let span = (most / narrow).ln_1p();
    let side =
        unit(cross(cone_axis, if cone_axis[0].abs() < 0.5 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] }));
    let up = cross(side, cone_axis);
    // Rays start near the lens, where single precision resolves their positions.
    let start = if is_far { distance - 1.5 * across } else { 0.0 };
    let count = ANYWHERE / part;
    let ray = |[u, v, ..]: Point| {
        let down = narrow * (f64::from(u) * span).exp_m1();
        let (level, (sin, cos)) = ((down * (2.0 - down)).sqrt(), (TAU * f64::from(v)).sin_cos());
        let to = [0, 1, 2].map(|i| (1.0 - down) * cone_axis[i] + level * (cos * side[i] + sin * up[i]));
        let origin = [0, 1, 2].map(|axis| (from[axis] + start * to[axis]) as f32);
        let direction = to.map(|part| part as f32);
        let ray = WorldRay { origin, direction, mint: 0.0, maxt: f32::MAX, time: 0.5 };
        (ray, TAU * span * (down + narrow))
    };
    let set = samples(SETS as u32 + set, 2, count);
    let (rays, shares): (Vec<WorldRay>, Vec<f64>) = set.into_iter().map(ray).unzip();
    let mut found = vec![Importance::default(); count];
    adjoint.arrive(&rays, &mut found);
    let anywhere: f64 = found.iter().zip(shares).map(|(found, share)| found.importance * share).sum();
    [by_aim / aimed.len() as f64, anywhere / count as f64]
}

/// Returns a sample set in two or four dimensions; different sets are independent.
fn samples(set: u32, dimensions: usize, count: usize) -> Vec<Point> {
    let mut points = vec![Point::default(); count];
    Sequence::Recurrence.fill(set, dimensions, &mut points);
    points
}

fn toward(target: &Target, [u, v, ..]: Point) -> ScenePoint {
    ScenePoint { point: target.0, sample: [u, v], time: 0.5 }
}

/// Returns the shortfall of the first of two estimates, relative to the second.
fn left_out(sets: &[[f64; 2]; SETS], case: &str) -> Figure {
    let n = SETS as f64;
    let [aimed, whole] = [0, 1].map(|estimate| sets.iter().map(|set| set[estimate]).sum::<f64>() / n);
    let square: f64 = sets.iter().map(|set| (set[1] - set[0] - (whole - aimed)).powi(2)).sum();
    ((whole - aimed) / whole, (square / (n * (n - 1.0))).sqrt() / whole, case.to_owned())
}
