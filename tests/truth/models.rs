//! The models without interfaces (perspective, orthographic, environment, thick, thin) against independent formulas in
//! double precision: by single calls and batches, for every disk mapping, for cameras at rest, in motion and with a
//! shutter, and with any instructions of the processor.

use std::f64::consts::{FRAC_PI_4, PI};

use crate::support::columns::{RayColumns, SampleColumns};
use ::realistic_camera::{Camera, CameraMotion, CameraToWorld, Host, Outcome, Parameters, Sample, WorldRay};
use glam::{DMat3, DQuat, DVec3};

use super::support::{RASTER, Random};

/// Numbers of samples in a batch: near multiples of the vector widths, up to four of the widest vectors.
const SIZES: [usize; 15] = [0, 1, 2, 3, 4, 5, 7, 8, 9, 15, 16, 17, 63, 64, 257];
/// The largest batch.
const MOST: usize = 257;

/// The ray that the formulas give, in camera space, with its weight.
#[derive(Clone, Copy, Debug)]
struct Expected {
    origin: DVec3,
    direction: DVec3,
    range: [f64; 2],
    weight: f64,
}

/// A function that maps the sample's image point (pixels) and the point of the unit disk to a ray.
type Formula = Box<dyn Fn([f64; 2], [f64; 2]) -> Expected>;

fn camera(host: &Host, given: &[(&str, &str)]) -> Camera {
    let mut parameters = Parameters::default();
    for (name, text) in given {
        parameters.set_from_text(name, text).expect("valid");
    }
    Camera::build(&parameters, host, &mut |_, _| ()).unwrap_or_else(|error| panic!("{given:?}: {error}"))
}

/// Returns Shirley and Chiu's map, by angles.
fn concentric([u, v]: [f64; 2]) -> [f64; 2] {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    if a == 0.0 && b == 0.0 {
        return [0.0; 2];
    }
    let (radius, angle) =
        if a.abs() > b.abs() { (a, FRAC_PI_4 * b / a) } else { (b, FRAC_PI_4 * (2.0 - a / b)) };
    [radius * angle.cos(), radius * angle.sin()]
}

fn disk(mapping: &str, [u, v]: [f64; 2]) -> Option<[f64; 2]> {
    match mapping {
        "concentric" => Some(concentric([u, v])),
        "polar" => Some([u.sqrt() * (2.0 * PI * v).cos(), u.sqrt() * (2.0 * PI * v).sin()]),
        "rejection" => {
            let point = [2.0 * u - 1.0, 2.0 * v - 1.0];
            (point[0].hypot(point[1]) <= 1.0).then_some(point)
        }
        other => panic!("{other}"),
    }
}

/// Returns the screen coordinates in a raster of 400 x 300 pixels whose shorter side spans [-1, 1].
fn screen([x, y]: [f64; 2]) -> [f64; 2] {
    [(x - 200.0) / 150.0, (150.0 - y) / 150.0]
}

/// Returns a pinhole, or a thin lens focused on z = `focus`, with the near plane at 0.5 and the far plane at 20.
fn projective(fov: Option<f64>, radius: f64, focus: f64) -> Formula {
    let (hither, yon) = (0.5, 20.0);
    Box::new(move |image, disk| {
        let [x, y] = screen(image);
        let (origin, toward) = match fov {
            Some(fov) => {
                let tangent = (fov / 2.0).to_radians().tan();
                let toward = DVec3::new(x * tangent, y * tangent, 1.0);
                (toward * hither, toward)
            }
            None => (DVec3::new(x, y, hither), DVec3::Z),
        };
        let in_focus = origin + toward * (focus - hither);
        let lens = DVec3::new(disk[0], disk[1], 0.0) * radius * (focus - hither) / focus;
        let origin = origin + lens;
        let direction = if radius > 0.0 { (in_focus - origin).normalize() } else { toward.normalize() };
        let end = if fov.is_some() { (yon - hither) / direction.z } else { yon - hither };
        Expected { origin, direction, range: [0.0, end], weight: 1.0 }
    })
}

fn environment() -> Formula {
    Box::new(|[x, y], _| {
        let ((sin_theta, cos_theta), (sin_phi, cos_phi)) =
            ((PI * y / 300.0).sin_cos(), (2.0 * PI * x / 400.0).sin_cos());
        let direction = DVec3::new(sin_theta * cos_phi, cos_theta, sin_theta * sin_phi);
        Expected { origin: DVec3::ZERO, direction, range: [0.5, 20.0], weight: 1.0 }
    })
}

/// Returns a lens of two refracting surfaces, the rear one being the stop, modelled by similar triangles. The thick
/// lens's exit pupil lies in the rear vertex plane, where it is as wide as the cone from the film's centre through the
/// surface's edge.
fn single_lens(thin: bool) -> Formula {
    // Radii, thickness and index of `LENS`, and the lensmaker's equation.
    let (r1, r2, t, n, film, edge) = (60.0_f64, -80.0_f64, 8.0, 1.5, 90.0, 4.0_f64);
    // Sagitta of the surface's edge, measured from the vertex toward the scene.
    let sagitta = -r2 - (r2 * r2 - edge * edge).sqrt();
    let pupil = edge * film / (film + sagitta);
    let power = (n - 1.0) * (1.0 / r1 - 1.0 / r2 + (n - 1.0) * t / (n * r1 * r2));
    let f = 1.0 / power;
    // Distances of the principal planes: from the front vertex toward the film, and from the rear vertex.
    let front = f * (n - 1.0) * t / (n * r2);
    let rear = f * (n - 1.0) * t / (n * r1);
    let front_plane = front;
    let rear_plane = -t + rear;
    let film_z = -t - film;
    Box::new(move |[x, y], disk| {
        let pixel = 35.0 / 500.0;
        let point = DVec3::new((200.0 - x) * pixel, (y - 150.0) * pixel, film_z);
        // The thin lens has the same image-side cone of light.
        let image_distance = rear_plane - film_z;
        let (film_z, rear_plane, pupil_distance, pupil) = if thin {
            (front_plane - image_distance, front_plane, image_distance, pupil * image_distance / film)
        } else {
            (film_z, rear_plane, film, pupil)
        };
        let through = [disk[0] * pupil, disk[1] * pupil];
        let slopes = [0, 1].map(|i| (through[i] - point[i]) / pupil_distance);
        let heights = [0, 1].map(|i| point[i] + slopes[i] * (rear_plane - film_z));
        let bent = [0, 1].map(|i| slopes[i] - heights[i] / f);
        let origin = DVec3::new(heights[0] - bent[0] * front_plane, heights[1] - bent[1] * front_plane, 0.0);
        let direction = DVec3::new(bent[0], bent[1], 1.0).normalize();
        let cos2 = 1.0 / (1.0 + slopes[0].powi(2) + slopes[1].powi(2));
        let weight = PI * pupil.powi(2) / pupil_distance.powi(2) * cos2.powi(2);
        Expected { origin, direction, range: [0.5, 20.0], weight }
    })
}

/// Radius, thickness, index behind, diameter: the rear surface's aperture is by far the smallest.
const LENS: &str = "60 8 1.5 40\n-80 0 1 8\n";

/// The placement of the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Placement {
    World,
    Turned,
    Scaled,
    Moving,
}

impl Placement {
    fn linear(self, time: f64) -> DMat3 {
        let turn = |angle: f64| DMat3::from_quat(DQuat::from_axis_angle(DVec3::Y, angle));
        match self {
            Self::World => DMat3::IDENTITY,
            // A mirror as well, as in a host's look-at transform.
            Self::Turned => turn(0.7) * DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0)),
            Self::Scaled => turn(0.7) * DMat3::from_diagonal(DVec3::new(2.0, 3.0, 0.5)),
            Self::Moving => turn(0.9 * time),
        }
    }

    fn origin(self, time: f64) -> DVec3 {
        match self {
            Self::World => DVec3::ZERO,
            Self::Turned | Self::Scaled => DVec3::new(3.0, -2.0, 5.0),
            Self::Moving => DVec3::new(4.0, 0.0, -1.0) * time,
        }
    }

    fn motion(self) -> CameraMotion {
        let at = |time: f64| {
            let (m, o) = (self.linear(time).as_mat3(), self.origin(time).as_vec3());
            let row = |i: usize| [m.col(0)[i], m.col(1)[i], m.col(2)[i], o[i]];
            let rows = [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]];
            CameraToWorld::from_rows(rows.as_flattened().try_into().expect("16")).expect("affine")
        };
        if self == Self::Moving {
            CameraMotion::between((at(0.0), 0.0), (at(1.0), 1.0)).expect("a motion")
        } else {
            at(0.0).into()
        }
    }
}

/// Returns the ray in the world, with a host's quantities.
fn placed(expected: Expected, placement: Placement, time: f64) -> ([f64; 3], [f64; 3], [f64; 2], bool) {
    let linear = placement.linear(time);
    let direction = linear * expected.direction;
    let origin = linear * expected.origin + placement.origin(time);
    let unit = direction.normalize();
    (origin.to_array(), unit.to_array(), expected.range, placement == Placement::Scaled)
}

/// Checks errors to within a few roundings of single precision; `scale` is the size of the numbers from which the
/// values are computed.
#[track_caller]
fn near(what: &str, got: &[f32], expected: &[f64], scale: f64) {
    for (got, expected) in got.iter().zip(expected) {
        let off = (f64::from(*got) - expected).abs() / f64::from(f32::EPSILON);
        assert!(
            off <= 4.0 * scale.max(expected.abs()),
            "{what}: {got} is not {expected}, by {off} roundings"
        );
    }
}

fn samples(seed: u64, count: usize) -> Vec<Sample> {
    let mut random = Random::new(seed);
    // The numbers include both ends of a lens sample's range now and then.
    let mut number = move || ((random.next() * 1.02 - 0.01) as f32).clamp(0.0, 1.0);
    (0..count)
        .map(|_| Sample {
            image_x: 406.0 * number() - 3.0,
            image_y: 306.0 * number() - 3.0,
            lens_u: number(),
            lens_v: number(),
            time: number(),
        })
        .collect()
}

/// Returns the rays of a batch; `None` for blocked rays, whose elements must be unchanged.
fn batch(camera: &Camera, samples: &[Sample]) -> Vec<Option<(WorldRay, f32)>> {
    let (mut columns, mut found) = (SampleColumns::new(MOST), RayColumns::new(MOST));
    samples.iter().enumerate().for_each(|(i, sample)| columns.set(i, sample));
    camera.trace(&columns.first(samples.len()), &mut found.first(samples.len()));
    (0..samples.len()).map(|i| found.get(i)).collect()
}

/// Parameters of a model.
type Given = Vec<(&'static str, &'static str)>;

/// Returns every model with its formula, and the permitted error of its directions in units of four roundings.
fn models() -> Vec<(Given, Formula, f64)> {
    let clip = [("hither", "0.5"), ("yon", "20")];
    let with = |more: &[(&'static str, &'static str)]| [&clip[..], more].concat();
    let lens = [("lens_radius", "0.25"), ("focal_distance", "4")];
    let film = [("film_distance", "90"), ("film_diagonal", "35")];
    vec![
        (with(&[("model", "perspective"), ("fov", "60")]), projective(Some(60.0), 0.0, 1.0), 2.0),
        (
            with(&[&[("model", "perspective"), ("fov", "60")], &lens[..]].concat()),
            projective(Some(60.0), 0.25, 4.0),
            8.0,
        ),
        (with(&[("model", "orthographic")]), projective(None, 0.0, 1.0), 2.0),
        (with(&[&[("model", "orthographic")], &lens[..]].concat()), projective(None, 0.25, 4.0), 8.0),
        // An angle up to 2 pi has three roundings of its own.
        (with(&[("model", "environment")]), environment(), 5.0),
        (with(&[&[("model", "thick")], &film[..]].concat()), single_lens(false), 1.0),
        (with(&[&[("model", "thin")], &film[..]].concat()), single_lens(true), 1.0),
    ]
}

fn host(placement: Placement) -> Host {
    let mut host = Host::new(RASTER, None);
    host.to_world = placement.motion();
    host.can_redraw = true;
    host
}

#[test]
fn every_ray_is_the_formulas_and_a_batchs_the_same_to_the_bit() {
    for placement in [Placement::World, Placement::Turned, Placement::Scaled, Placement::Moving] {
        for (given, formula, roundings) in models() {
            let prescription = given.iter().any(|(_, value)| ["thick", "thin"].contains(value));
            let mut host = host(placement);
            host.lens_text = prescription.then(|| ("own.dat".to_owned(), LENS.as_bytes().to_vec()));
            for mapping in ["concentric", "polar", "rejection"] {
                let given = [&given[..], &[("disk", mapping)]].concat();
                let camera = camera(&host, &given);
                let has_disk = prescription || given.iter().any(|(name, _)| *name == "lens_radius");
                let samples = samples(11, MOST);
                for sample in &samples {
                    let Sample { image_x, image_y, lens_u, lens_v, time } = *sample;
                    let point = disk(mapping, [lens_u.into(), lens_v.into()]);
                    let what = format!("{placement:?} {given:?} {sample:?}");
                    let (ray, weight) = match (camera.generate(sample, None), point) {
                        (Outcome::Ray(ray, weight), _) => (ray, weight),
                        (Outcome::Redraw, None) if has_disk => continue,
                        other => panic!("{what}: {other:?}"),
                    };
                    assert!(!has_disk || point.is_some(), "{what}: a ray of no point");
                    let expected = formula([image_x.into(), image_y.into()], point.unwrap_or_default());
                    let (origin, direction, range, stretched) = placed(expected, placement, time.into());
                    // Behind a lens, the origin is the difference of two numbers of some 20 mm: the film point, and the
                    // slope times the distance.
                    let least = if prescription { 20.0 } else { 0.0 };
                    let size = DVec3::from(origin).length().max(expected.origin.length()).max(least);
                    near(&what, &ray.origin, &origin, roundings * size);
                    near(&what, &ray.direction, &direction, roundings);
                    near(&what, &[weight], &[expected.weight], 2.0 * expected.weight);
                    assert_eq!(ray.time, time, "{what}");
                    // A stretched space scales the ranges: a stock camera's range is scaled along the ray, a lens's
                    // range along the axis.
                    let stretch = match (stretched, prescription) {
                        (_, true) => (placement.linear(0.0) * DVec3::Z).length(),
                        (true, false) => (placement.linear(time.into()) * expected.direction).length(),
                        (false, false) => 1.0,
                    };
                    let range = range.map(|end| end * stretch);
                    near(&what, &[ray.mint, ray.maxt], &range, 4.0 * range[1]);
                }
                for size in SIZES {
                    let samples = &samples[..size];
                    for (sample, found) in samples.iter().zip(batch(&camera, samples)) {
                        assert_eq!(found, camera.ray(sample), "{placement:?} {given:?} {size}: {sample:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn the_image_is_the_sphere_of_directions() {
    let camera =
        camera(&host(Placement::World), &[("model", "environment"), ("hither", "0.5"), ("yon", "8")]);
    for (image, expected) in [
        ([200.0, 150.0], [-1.0, 0.0, 0.0]),
        ([0.0, 150.0], [1.0, 0.0, 0.0]),
        ([100.0, 150.0], [0.0, 0.0, 1.0]),
        ([300.0, 150.0], [0.0, 0.0, -1.0]),
        ([130.0, 0.0], [0.0, 1.0, 0.0]),
        ([130.0, 300.0], [0.0, -1.0, 0.0]),
    ] {
        let sample = Sample { image_x: image[0], image_y: image[1], time: 0.25, ..Sample::default() };
        let (ray, weight) = camera.ray(&sample).expect("a ray");
        near(&format!("{image:?}"), &ray.direction, &expected, 1.0);
        assert_eq!((ray.origin, ray.mint, ray.maxt, ray.time, weight), ([0.0; 3], 0.5, 8.0, 0.25, 1.0));
    }
}

/// Prints the bits of all models' rays; the processes of the next test run this test.
#[test]
fn bits_of_the_models() {
    let mut sum = 0xcbf2_9ce4_8422_2325_u64;
    let mut rays = 0;
    for placement in [Placement::World, Placement::Scaled, Placement::Moving] {
        for (given, _, _) in models() {
            for mapping in ["concentric", "polar"] {
                let camera = camera(&host(placement), &[&given[..], &[("disk", mapping)]].concat());
                for (ray, weight) in batch(&camera, &samples(5, MOST)).into_iter().flatten() {
                    let WorldRay { origin, direction, mint, maxt, time } = ray;
                    let numbers = origin.into_iter().chain(direction).chain([mint, maxt, time, weight]);
                    numbers.for_each(|x| sum = (sum ^ u64::from(x.to_bits())).wrapping_mul(0x0100_0000_01b3));
                    rays += 1;
                }
            }
        }
    }
    assert!(rays > 9000, "{rays}");
    println!("bits: {sum:x}");
}

#[test]
fn every_set_of_instructions_gives_the_same_bits() {
    let this = module_path!().split_once("::").expect("a module of this program").1;
    let bits = ["portable", "avx2", "avx512"].map(|simd| {
        let output = std::process::Command::new(std::env::current_exe().expect("this program"))
            .args(["--exact", "--nocapture", &format!("{this}::bits_of_the_models")])
            .env("REALISTIC_SIMD", simd)
            .output()
            .expect("it starts");
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success() && text.contains("1 passed"), "{simd}: {text}");
        text.split("bits: ").nth(1).and_then(|rest| rest.lines().next()).expect("printed").to_owned()
    });
    assert!(bits.iter().all(|other| *other == bits[0]), "{bits:?}");
}
