//! Random lenses that pass the checks of a lens file, and rays from anywhere behind them. Each number makes one lens
//! and its rays, whatever other numbers run. [`against_reference`] returns the worst error of every tracer against the
//! reference; [`through_cameras`] returns the invalid rays of whole cameras with such lenses.

use std::{fmt::Write, ops::Range};

use crate::BLOCK;
use crate::columns::{RayColumns, SampleColumns};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus as Random;
use realistic_camera::{Camera, Host, Parameters, Precision, Pupil, Raster, Rays, Sample, Samples, WorldRay};
use realistic_optics::{
    lens::{Lens, UnsymmetricFigure},
    prescription::{
        Asphere, Biconic, CoordinateBreak, FIRST_POWER, Interface, Medium, Meridian, NO_TERMS, PROFILE_TERMS,
        Shape, Toroid, Unsymmetric, read,
    },
    trace::{
        Direction::{self, FilmToScene, SceneToFilm},
        Path, Ray,
    },
};

use super::{
    case::{Case, CaseResult, Failure, Reason, is_sound},
    tracers::TracerUnderTest,
};

/// Returns a number with a uniform logarithm in [from, to).
pub fn scaled(random: &mut Random, from: f64, to: f64) -> f64 {
    random.random_range(from.ln()..to.ln()).exp()
}

/// Returns the text of a random lens of 1 to 16 interfaces: planes, and radii from the clear semi-diameter, which makes
/// a hemisphere, to 1e5 mm; glass of any index, touching elements, and at most one stop.
pub fn lens_text(random: &mut Random) -> String {
    let count = 1 + (random.random::<f64>().powi(2) * 16.0) as usize;
    let mut text = String::new();
    let mut in_air = true;
    let mut may_stop = true;
    let widest = scaled(random, 2.0, 30.0);
    for number in 0..count {
        let semi = widest * random.random_range(0.4..1.0);
        let last = number + 1 == count;
        let air_behind = last || random.random_bool(if in_air { 0.1 } else { 0.7 });
        let radius = match random.random::<f64>() {
            flat if flat < 0.12 => 0.0,
            hemisphere if hemisphere < 0.15 => semi,
            strong if strong < 0.6 => semi * random.random_range(1.05..6.0),
            _ => semi * scaled(random, 1.5, 1e5),
        };
        let is_stop = radius == 0.0 && in_air && air_behind;
        let radius = if is_stop && !may_stop { 5.0 * semi } else { radius };
        may_stop &= !is_stop;
        let radius = if random.random_bool(0.5) { radius } else { -radius };
        let thickness = match random.random::<f64>() {
            _ if last => 0.0,
            none if none < 0.1 => 0.0,
            small if small < 0.2 => scaled(random, 1e-9, 1e-2),
            _ => scaled(random, 0.3, 12.0),
        };
        let index = if air_behind {
            1.0
        } else if random.random_bool(0.1) {
            1.0 + scaled(random, 1e-7, 3.0)
        } else {
            random.random_range(1.4..2.0)
        };
        in_air = air_behind;
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{radius:e} {thickness:e} {index:e} {:e}", 2.0 * semi);
    }
    text
}

/// Returns a random lens, whose text has passed the checks of a lens file.
pub fn random_lens(random: &mut Random) -> Lens {
    let text = lens_text(random);
    let prescription = read("random lens", text.as_bytes());
    Lens::at_d_line(&prescription.unwrap_or_else(|error| panic!("{error}\n{text}")))
}

/// Returns a random lens most of whose spheres and planes have become aspheres: conics of every kind, with terms whose
/// size at the clear edge is up to a seventh of the clear semi-diameter. A third of the aspheres with a radius have a
/// semi-diameter of 0.5 to 1.2 times that of their half ellipsoid, limited to the whole half as in a lens file.
pub fn random_aspheric_lens(random: &mut Random) -> Lens {
    let text = lens_text(random);
    let mut prescription =
        read("random lens", text.as_bytes()).unwrap_or_else(|error| panic!("{error}\n{text}"));
    for interface in &mut prescription.interfaces {
        let radius = match interface.shape {
            Shape::Sphere { radius } => radius,
            Shape::Plane if !interface.is_stop => f64::INFINITY,
            Shape::Asphere(_) | Shape::Unsymmetric(_) | Shape::Plane => continue,
        };
        if random.random_bool(0.3) {
            continue;
        }
        let mut asphere = Asphere { radius, conic: 0.0, terms: NO_TERMS };
        asphere.conic = match random.random::<f64>() {
            sphere if sphere < 0.2 => 0.0,
            paraboloid if paraboloid < 0.3 => -1.0,
            _ => random.random_range(-6.0..2.0),
        };
        if radius.is_finite() && random.random_bool(1.0 / 3.0) {
            asphere.conic = random.random_range(-0.9..3.0);
            interface.semi_diameter = asphere.widest() * random.random_range(0.5_f64..1.2).min(1.0);
        } else if asphere.widest() < interface.semi_diameter {
            asphere.conic = -asphere.conic.abs() - 1.0;
        }
        for _ in 0..random.random_range(0..6) {
            let even = random.random_bool(0.8);
            let power = if even { 2 * random.random_range(2..=10) } else { random.random_range(2..=20) };
            let size = scaled(random, 1e-5, 0.15);
            let sign = if random.random_bool(0.5) { 1.0 } else { -1.0 };
            let term = sign * size * interface.semi_diameter.powi(1 - power as i32);
            asphere.terms[power - FIRST_POWER] = term;
        }
        interface.shape = Shape::Asphere(asphere);
    }
    Lens::at_d_line(&prescription)
}

/// Returns a random number with a uniform logarithm in [from, to) and a random sign.
fn signed(random: &mut Random, from: f64, to: f64) -> f64 {
    let size = scaled(random, from, to);
    if random.random_bool(0.5) { size } else { -size }
}

/// Returns a random cylinder, toroid or biconic that does not end within its clear aperture.
fn random_unsymmetric(random: &mut Random, semi_diameter: f64) -> Unsymmetric {
    let radius = |random: &mut Random| semi_diameter * signed(random, 1.2, 1e4);
    let conic =
        |random: &mut Random| if random.random_bool(0.4) { 0.0 } else { random.random_range(-4.0..1.5) };
    loop {
        let meridian = if random.random_bool(0.5) { Meridian::X } else { Meridian::Y };
        let surface = match random.random_range(0..3) {
            0 => {
                let cylinder = Toroid::cylinder(meridian, radius(random));
                Unsymmetric::Toroid(Toroid { conic: conic(random), ..cylinder })
            }
            1 => {
                let mut terms = [0.0; PROFILE_TERMS];
                for (i, term) in (1..).zip(&mut terms) {
                    if random.random_bool(0.3) {
                        *term = signed(random, 1e-5, 0.1) * semi_diameter.powi(1 - 2 * i);
                    }
                }
                let straight = random.random_bool(0.2);
                let rotation_radius = if straight { f64::INFINITY } else { radius(random) };
                let (radius, conic) = (radius(random), conic(random));
                Unsymmetric::Toroid(Toroid { meridian, radius, conic, terms, rotation_radius })
            }
            _ => {
                let radii =
                    [0, 1].map(|_| if random.random_bool(0.1) { f64::INFINITY } else { radius(random) });
                Unsymmetric::Biconic(Biconic { radii, conics: [0, 1].map(|_| conic(random)) })
            }
        };
        let figure = UnsymmetricFigure::new(&surface, semi_diameter);
        if !surface.is_plane() && figure.inside.is_finite() {
            return surface;
        }
    }
}

/// Returns a random lens without an axis: cylinders, toroids, biconics and some aspheres on changes of frame, and up to
/// two mirrors.
pub fn random_lens_without_axis(random: &mut Random) -> Lens {
    let text = lens_text(random);
    let mut prescription =
        read("random lens", text.as_bytes()).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let mirrors = random.random_range(0..3);
    let (mut mirrors_left, mut before) = (mirrors, Medium::Air);
    let last = prescription.interfaces.len() - 1;
    for (number, interface) in prescription.interfaces.iter_mut().enumerate() {
        let Interface { semi_diameter, .. } = *interface;
        if !interface.is_stop && random.random_bool(0.5) {
            interface.shape = Shape::Unsymmetric(random_unsymmetric(random, semi_diameter));
        } else if let Shape::Sphere { radius } = interface.shape
            && random.random_bool(0.2)
        {
            let conic = random.random_range(-3.0..0.0);
            interface.shape = Shape::Asphere(Asphere { radius, conic, terms: NO_TERMS });
        }
        if random.random_bool(0.4) {
            let [x, y] = [0, 1].map(|_| semi_diameter * random.random_range(-0.2..0.2));
            let degrees = [0, 1, 2].map(|_| 6.0 * random.random_range(-1.0_f64..1.0).powi(3));
            let change = CoordinateBreak::zemax([x, y], degrees, random.random_bool(0.5));
            interface.coordinate_break = Some(change);
        }
        // The film lies in air, and so must be what is in front of a mirror before it.
        let may_reflect = !interface.is_stop && (number < last || before == Medium::Air);
        if mirrors_left > 0 && may_reflect && random.random_bool(0.3) {
            (interface.is_mirror, interface.medium) = (true, before);
            mirrors_left -= 1;
        }
        if (mirrors - mirrors_left) % 2 == 1 {
            interface.thickness = -interface.thickness;
        }
        before = interface.medium;
    }
    if random.random_bool(0.3) {
        let change = CoordinateBreak::zemax([0.1, -0.2], [random.random_range(-3.0..3.0), 1.0, 0.0], false);
        prescription.film_break = Some(change);
    }
    Lens::at_d_line(&prescription)
}

/// Returns the text of a short lens whose aspheres are often missed by rays. Of its 6 to 12 interfaces, about 3 to 6
/// are aspheres; their terms reach up to a seventh of the semi-diameter at the edge, and about half of them extend
/// close to their conic's equator. The same seed gives the same lens.
pub fn aspheric_lens_text(seed: u64) -> String {
    let random = &mut Random::seed_from_u64(seed);
    let rows = random.random_range(6..=12_usize);
    let aspheres = random.random_range(3..=6_usize);
    let widest = scaled(random, 2.0, 20.0);
    let mut text = String::new();
    let mut figures = String::new();
    for row in 0..rows {
        let semi = widest * random.random_range(0.5..1.0);
        let is_asphere = random.random_bool(aspheres as f64 / rows as f64);
        let steepest = if is_asphere && random.random_bool(0.5) { 0.9 } else { 1.05 };
        let radius = semi * scaled(random, steepest, 8.0);
        let radius = if random.random_bool(0.5) { radius } else { -radius };
        let index = if row % 2 == 0 { random.random_range(1.4..1.9) } else { 1.0 };
        let thickness = if row + 1 == rows { 0.0 } else { widest * random.random_range(0.05..0.8) };
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{radius:e} {thickness:e} {index:e} {:e}", 2.0 * semi);
        if !is_asphere {
            continue;
        }
        let _ = write!(figures, "asphere {} conic={:e}", row + 1, random.random_range(-2.0..1.0));
        for power in [3, 4, 6, 8, 10, 12] {
            if random.random_bool(0.6) {
                let size = scaled(random, 1e-4, 0.15) * if random.random_bool(0.5) { 1.0 } else { -1.0 };
                let _ = write!(figures, " A{power}={:e}", size * semi.powi(1 - power));
            }
        }
        figures.push('\n');
    }
    text + &figures
}

/// The kind of surfaces in random lenses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Spheres and planes.
    Spheres,
    /// Mostly aspheres.
    Aspheres,
    /// Cylinders, toroids and biconics, decentred and tilted surfaces, and mirrors.
    WithoutAxis,
}

impl Kind {
    /// Every kind.
    pub const ALL: [Self; 3] = [Self::Spheres, Self::Aspheres, Self::WithoutAxis];

    fn lens(self, random: &mut Random) -> Lens {
        match self {
            Self::Spheres => random_lens(random),
            Self::Aspheres => random_aspheric_lens(random),
            Self::WithoutAxis => random_lens_without_axis(random),
        }
    }

    /// Returns the name of this kind's cases, before their number.
    const fn name(self) -> &'static str {
        match self {
            Self::Spheres => "random lens",
            Self::Aspheres => "random aspheric lens",
            Self::WithoutAxis => "random lens without an axis",
        }
    }

    /// Returns the random lens of this number, with a hundred rays; the same number gives the same case.
    pub fn case(self, number: u64) -> Case {
        let mut random = Random::seed_from_u64(number);
        let lens = self.lens(&mut random);
        let direction = if number % 4 == 3 { SceneToFilm } else { FilmToScene };
        let rays = rays(&mut random, &lens, direction, 100);
        Case::new(GROUP, format!("{} {number}", self.name()), &lens, direction, rays)
    }

    /// Returns the case of this name, if it is a random case.
    pub fn find(name: &str) -> Option<Case> {
        let number = |kind: Self| name.strip_prefix(kind.name())?.trim().parse().ok();
        Self::ALL.into_iter().find_map(|kind| Some(kind.case(number(kind)?)))
    }
}

/// The group of all random cases.
const GROUP: &str = "random";

/// Returns rays that start in a few planes and meet the first surface of a random lens; most of them enter the lens.
fn rays(random: &mut Random, lens: &Lens, direction: Direction, count: usize) -> Vec<Ray> {
    let (surface, sign) = match direction {
        FilmToScene => (lens.rear(), 1.0),
        SceneToFilm => (lens.front(), -1.0),
    };
    let edge_sagitta = surface.sagitta(surface.semi_diameter);
    let mut distance = 0.0;
    (0..count)
        .map(|number| {
            let semi = surface.semi_diameter;
            if number % PLANE == 0 {
                distance = edge_sagitta.abs() + scaled(random, 0.1, 200.0);
            }
            let field = 0.5 * distance * random.random_range(-1.0_f64..1.0).powi(3);
            let at = |random: &mut Random| semi * random.random_range(-0.8..0.8);
            let target = [at(random), at(random)];
            let origin = [field, field * random.random_range(-1.0..1.0), surface.vertex - sign * distance];
            let direction = [target[0] - origin[0], target[1] - origin[1], sign * distance];
            Ray { origin, direction }
        })
        .collect()
}

/// Rays from one plane: enough to fill the widest registers and leave a remainder.
const PLANE: usize = 20;

/// Returns empty results of the random lenses, one per tracer.
pub fn none_yet(kind: Kind, tracers: &[TracerUnderTest]) -> Vec<CaseResult> {
    let name = match kind {
        Kind::Spheres => "random lenses, a hundred rays each",
        Kind::Aspheres => "random aspheric lenses, a hundred rays each",
        Kind::WithoutAxis => "random lenses without an axis, a hundred rays each",
    };
    let result =
        |tracer: &TracerUnderTest| CaseResult::new(name.to_owned(), GROUP, tracer.name, tracer.bound);
    tracers.iter().map(result).collect()
}

/// Compares the rays of the random lenses of these numbers, a hundred rays each, with the reference, for every tracer.
pub fn against_reference(kind: Kind, numbers: Range<u64>, tracers: &[TracerUnderTest]) -> Vec<CaseResult> {
    let mut worst = none_yet(kind, tracers);
    for case in numbers.map(|number| kind.case(number)) {
        let trails = case.trails();
        for (tracer, worst) in tracers.iter().zip(&mut worst) {
            worst.merge(&case.run(tracer, &trails).expect("a lens file's lens ends in air"));
        }
    }
    worst
}

/// The results of rays through random lenses in a camera.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Survey {
    /// Samples requested.
    pub rays: u64,
    /// Rays that passed.
    pub passed: u64,
    /// Rays that are not finite, that have a direction of another length than 1, or that have a weight that is not
    /// finite and positive.
    pub unsound: Vec<Failure>,
}

impl Survey {
    /// Adds another survey.
    pub fn add(&mut self, other: Self) {
        self.rays += other.rays;
        self.passed += other.passed;
        self.unsound.extend(other.unsound);
    }

    /// Converts the survey to the result of a case.
    pub fn result(self) -> CaseResult {
        let name = format!("{} rays through random cameras, {} pass", self.rays, self.passed);
        CaseResult {
            rays: usize::try_from(self.rays).unwrap_or(usize::MAX),
            failures: self.unsound,
            ..CaseResult::new(name, GROUP, "camera, f64 and f32", 0.0)
        }
    }
}

/// Name of random cameras, before their number.
const CAMERA: &str = "random camera";

/// Returns the number of the random camera of this name; `None` if the name is not that of a random camera.
pub fn camera_number(name: &str) -> Option<u64> {
    name.strip_prefix(CAMERA)?.trim().parse().ok()
}

/// Traces `rays` samples through a camera with each of the random lenses of these numbers, alternately in single and
/// double precision, and one by one and in blocks. Every ray that leaves must be finite, with a unit direction and a
/// finite, positive weight. The same rays also go through the tracer alone, in double precision.
pub fn through_cameras(numbers: Range<u64>, rays: usize) -> Survey {
    let mut survey = Survey::default();
    let (mut samples, mut out) = (SampleColumns::new(BLOCK), RayColumns::new(BLOCK));
    for number in numbers {
        let mut random = Random::seed_from_u64(number);
        let camera = random_camera(&mut random, number);
        let path = Path::<f32>::film_to_scene(&camera.facts().expect("a lens").lens);
        let start = camera.facts().expect("a lens").lens.rear().vertex - 50.0;
        for from in (0..rays).step_by(BLOCK) {
            let count = BLOCK.min(rays - from);
            (0..count).for_each(|i| samples.set(i, &random_sample(&mut random)));
            if number / 8 % 2 == 1 {
                camera.trace(&samples.first(count), &mut out.first(count));
            } else {
                for i in 0..count {
                    let (mut ray, mut weight) = Default::default();
                    camera.trace(&Samples::of(&samples.get(i)), &mut Rays::of(&mut ray, &mut weight));
                    out.set(i, (weight > 0.0).then_some((ray, weight)));
                }
            }
            survey.rays += count as u64;
            for i in 0..count {
                // A ray of a block exists if its weight is not 0; a NaN weight must not hide the ray.
                let (WorldRay { origin, direction, .. }, weight) = out.numbers(i);
                if weight == 0.0 {
                    continue;
                }
                survey.passed += 1;
                let [x, y, z] = direction;
                let is_unit = (x * x + y * y + z * z - 1.0).abs() < 4.0 * f32::EPSILON;
                let finite = origin.iter().all(|x| x.is_finite());
                let mut fail = |what: String| {
                    survey.unsound.push(Failure {
                        case: format!("{CAMERA} {number}"),
                        ray: from + i,
                        reason: Reason::Unsound,
                        what,
                    });
                };
                if !(is_unit && finite && weight > 0.0 && weight.is_finite()) {
                    fail(format!("from {origin:?} along {direction:?} with weight {weight}"));
                }
                let [origin, direction] = [origin, direction].map(|v| v.map(f64::from));
                let onward = path.trace(Ray { origin: [origin[0], origin[1], start], direction });
                if let Some(ray) = onward.ok().filter(|ray| !is_sound(ray)) {
                    fail(format!("back through the lens in f32: {ray:?}"));
                }
            }
        }
    }
    survey
}

/// Returns a sample of random numbers from their whole ranges, including the ends.
fn random_sample(random: &mut Random) -> Sample {
    let mut number = || match random.random::<f64>() {
        zero if zero < 0.01 => 0.0,
        one if one > 0.99 => 1.0,
        other => other as f32,
    };
    let [image_x, image_y] = [number(), number()].map(|x| 70.0 * x - 3.0);
    Sample { image_x, image_y, lens_u: number(), lens_v: number(), time: number() }
}

/// Builds the next random lens that makes a camera; lenses without power, or with the film inside them, are refused.
fn random_camera(random: &mut Random, number: u64) -> Camera {
    loop {
        let text = lens_text(random);
        let mut host = Host::new(Raster { xres: 64, yres: 64 }, None);
        host.lens_text = Some(("random lens".to_owned(), text.into_bytes()));
        let parameters = Parameters {
            film_distance: Some(scaled(random, 0.1, 300.0)),
            film_diagonal: Some(scaled(random, 0.1, 100.0)),
            pupil: Some([Pupil::Rear, Pupil::Rear, Pupil::Disk, Pupil::Warped][(number % 4) as usize]),
            precision: (number / 4 % 2 == 1).then_some(Some(Precision::F32)),
            ..Parameters::default()
        };
        if let Ok(camera) = Camera::build(&parameters, &host, &mut |_, _| {}) {
            return camera;
        }
    }
}
