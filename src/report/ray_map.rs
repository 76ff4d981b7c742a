//! The ray map: how far each way to take a ray through a lens is from the reference, and what it costs.

use super::{
    bench::{Effort, Timing, interleaved},
    reference::{DoubleDouble, ExactRay, Reference},
    statistics::{pareto_front, quantile},
    subject::Subject,
    table::Table,
};
use crate::{
    optics::{first_order::FirstOrder, refraction::Refraction},
    trace::{
        Direction, Path, Ray, Real,
        polynomial::{Fused, Polynomial, PolynomialBatch, RayColumns},
    },
};

/// What kind of map a method is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// First-order optics.
    Gaussian,
    /// Polynomials, one ray at a time.
    Polynomial,
    /// Polynomials, many rays at once.
    PolynomialBatch,
    /// Every surface, one ray at a time.
    Exact,
    /// Every surface with one of the lecture's refractions.
    Lecture,
}

impl Family {
    /// Every family with its name.
    pub const NAMES: [(&'static str, Self); 5] = [
        ("first-order optics", Self::Gaussian),
        ("polynomials", Self::Polynomial),
        ("polynomials in batches", Self::PolynomialBatch),
        ("exact walk", Self::Exact),
        ("exact walk, other refractions", Self::Lecture),
    ];

    /// The name.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, family)| *family == self).map_or("", |(name, _)| name)
    }
}

/// A method at work on a block of rays, which it holds in a form of its own.
pub trait Runner {
    /// Takes the whole block through the lens.
    fn run(&mut self);
    /// A ray of the last run, if it got through.
    fn ray(&self, index: usize) -> Option<Ray>;
}

/// A way to take rays through a lens.
#[derive(Clone, Copy, Debug)]
pub struct Method {
    /// Short name.
    pub name: &'static str,
    /// What kind it is.
    pub family: Family,
    /// Makes it ready for a block of rays.
    pub prepare: fn(&Subject, &[Ray]) -> Box<dyn Runner>,
}

/// Every method that is compared.
pub const METHODS: &[Method] = &[
    Method { name: "thin lens", family: Family::Gaussian, prepare: thin },
    Method { name: "thick lens", family: Family::Gaussian, prepare: thick },
    Method { name: "order 3", family: Family::Polynomial, prepare: polynomial::<3> },
    Method { name: "order 5", family: Family::Polynomial, prepare: polynomial::<5> },
    Method { name: "order 7", family: Family::Polynomial, prepare: polynomial::<7> },
    Method { name: "order 9", family: Family::Polynomial, prepare: polynomial::<9> },
    Method { name: "order 11", family: Family::Polynomial, prepare: polynomial::<11> },
    Method { name: "order 3, f32", family: Family::PolynomialBatch, prepare: polynomials::<f32, 3> },
    Method { name: "order 5, f32", family: Family::PolynomialBatch, prepare: polynomials::<f32, 5> },
    Method { name: "order 7, f32", family: Family::PolynomialBatch, prepare: polynomials::<f32, 7> },
    Method { name: "order 9, f32", family: Family::PolynomialBatch, prepare: polynomials::<f32, 9> },
    Method { name: "order 11, f32", family: Family::PolynomialBatch, prepare: polynomials::<f32, 11> },
    Method { name: "order 11, f64", family: Family::PolynomialBatch, prepare: polynomials::<f64, 11> },
    Method { name: "f32", family: Family::Exact, prepare: walk::<f32> },
    Method { name: YARDSTICK, family: Family::Exact, prepare: walk::<f64> },
    Method {
        name: "heckbert",
        family: Family::Lecture,
        prepare: |s, r| refracted(s, r, Refraction::Heckbert),
    },
    Method { name: "whitted", family: Family::Lecture, prepare: |s, r| refracted(s, r, Refraction::Whitted) },
    Method { name: "other", family: Family::Lecture, prepare: |s, r| refracted(s, r, Refraction::Other) },
    Method { name: "double-double", family: Family::Exact, prepare: walk::<DoubleDouble> },
];

/// The method that all others are timed against.
const YARDSTICK: &str = "f64";
/// Rays that polynomials are fitted to.
pub const FIT_RAYS: usize = 2000;

/// A map of one ray, over a block.
struct Single<F> {
    map: F,
    rays: Vec<Ray>,
    out: Vec<Option<Ray>>,
}

impl<F: Fn(Ray) -> Option<Ray>> Runner for Single<F> {
    fn run(&mut self) {
        for (ray, out) in self.rays.iter().zip(&mut self.out) {
            *out = (self.map)(*ray);
        }
    }

    fn ray(&self, index: usize) -> Option<Ray> {
        self.out[index]
    }
}

fn single(rays: &[Ray], map: impl Fn(Ray) -> Option<Ray> + 'static) -> Box<dyn Runner> {
    Box::new(Single { map, rays: rays.to_vec(), out: vec![None; rays.len()] })
}

fn thick(subject: &Subject, rays: &[Ray]) -> Box<dyn Runner> {
    let lens = subject.first_order;
    single(rays, move |ray| Some(lens.transfer(ray)))
}

/// The thick lens with both principal planes where the film's is.
fn thin(subject: &Subject, rays: &[Ray]) -> Box<dyn Runner> {
    let thick = subject.first_order;
    let lens = FirstOrder { front_principal_plane: thick.rear_principal_plane, ..thick };
    single(rays, move |ray| Some(lens.transfer(ray)))
}

fn walk<R: Real + 'static>(subject: &Subject, rays: &[Ray]) -> Box<dyn Runner> {
    let path = Path::<R>::film_to_scene(&subject.lens);
    single(rays, move |ray| path.trace(ray).ok())
}

fn refracted(subject: &Subject, rays: &[Ray], refraction: Refraction) -> Box<dyn Runner> {
    let path = Path::<f64>::new(&subject.lens, Direction::FilmToScene, refraction);
    single(rays, move |ray| path.trace(ray).ok())
}

fn fit(subject: &Subject, order: usize) -> Polynomial {
    Polynomial::fit(&subject.lens, subject.film_z, &subject.rays(FIT_RAYS, 0), order)
        .expect("the subject's rays are spread over film and pupil")
}

fn polynomial<const ORDER: usize>(subject: &Subject, rays: &[Ray]) -> Box<dyn Runner> {
    let model = fit(subject, ORDER);
    single(rays, move |ray| Some(model.transfer(ray)))
}

struct Columns<R> {
    model: PolynomialBatch<R>,
    rays: RayColumns<R>,
    out: RayColumns<R>,
}

impl<R: Fused> Runner for Columns<R> {
    fn run(&mut self) {
        self.model.transfer(&self.rays, &mut self.out);
    }

    fn ray(&self, index: usize) -> Option<Ray> {
        Some(self.out.ray(index))
    }
}

fn polynomials<R: Fused + 'static, const ORDER: usize>(subject: &Subject, rays: &[Ray]) -> Box<dyn Runner> {
    let model = PolynomialBatch::<R>::new(&fit(subject, ORDER));
    Box::new(Columns { model, rays: RayColumns::at_film(rays, subject.film_z), out: RayColumns::default() })
}

/// Median, 99.9 % quantile and maximum of an error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Half of the rays are better.
    pub median: f64,
    /// One in a thousand is worse.
    pub most: f64,
    /// The worst ray.
    pub worst: f64,
}

impl Spread {
    /// Of some errors.
    pub fn of(errors: &[f64]) -> Self {
        let [median, most, worst] = [0.5, 0.999, 1.0].map(|q| quantile(errors, q));
        Self { median, most, worst }
    }
}

/// What was measured of one method on one lens.
#[derive(Clone, Debug)]
pub struct Measured {
    /// The lens.
    pub lens: String,
    /// The method.
    pub method: Method,
    /// Time a ray, seconds.
    pub time: Timing,
    /// Angle to the exact direction, rad.
    pub direction: Spread,
    /// Distance of the exact point on the front surface from the ray, mm.
    pub position: Spread,
    /// The direction's error on the film, pixels.
    pub pixels: Spread,
    /// Rays that the reference passes and this method blocks.
    pub lost: usize,
    /// Whether no other method is both faster and nearer, by time and the 99.9 % quantile of the direction.
    pub on_front: bool,
}

/// How much is measured.
#[derive(Clone, Copy, Debug)]
pub struct Size {
    /// Rays whose errors are taken.
    pub rays: usize,
    /// Rays in the block that is timed.
    pub block: usize,
    /// How long to time.
    pub effort: Effort,
}

/// Errors and times of every method on one lens.
pub fn measure(subject: &Subject, size: Size) -> Vec<Measured> {
    let rays = subject.rays(size.rays, 1);
    let reference = Reference::new(&subject.lens, Direction::FilmToScene);
    let exact: Vec<_> = rays.iter().map(|ray| reference.trace(*ray).ok()).collect();
    let block = &rays[..size.block.min(rays.len())];
    let mut yardstick = walk::<f64>(subject, block);
    let mut runners: Vec<_> = METHODS.iter().map(|method| (method.prepare)(subject, block)).collect();
    let mut tasks: Vec<Box<dyn FnMut()>> = Vec::new();
    for runner in &mut runners {
        tasks.push(Box::new(|| runner.run()));
    }
    let mut tasks: Vec<&mut dyn FnMut()> = tasks.iter_mut().map(|task| &mut **task as _).collect();
    let timings = interleaved(&mut || yardstick.run(), &mut tasks, size.effort);
    let per_ray = |t: &Timing| {
        let count = block.len() as f64;
        Timing { median: t.median / count, low: t.low / count, high: t.high / count }
    };
    let mut all: Vec<Measured> = METHODS
        .iter()
        .zip(&timings)
        .map(|(method, timing)| {
            let mut runner = (method.prepare)(subject, &rays);
            runner.run();
            let pairs: Vec<_> = exact
                .iter()
                .enumerate()
                .filter_map(|(i, exact)| Some((exact.as_ref()?, runner.ray(i))))
                .collect();
            let errors = |measure: &dyn Fn(&ExactRay, &Ray) -> f64| -> Vec<f64> {
                pairs.iter().filter_map(|(exact, ray)| Some(measure(exact, ray.as_ref()?))).collect()
            };
            let direction = errors(&|exact, ray| exact.direction_error(ray));
            let position = errors(&|exact, ray| exact.distance_from_line(ray));
            let pixels: Vec<f64> = direction.iter().map(|angle| subject.pixels(*angle)).collect();
            Measured {
                lens: subject.lens.name.clone(),
                method: *method,
                time: per_ray(timing),
                direction: Spread::of(&direction),
                position: Spread::of(&position),
                pixels: Spread::of(&pixels),
                lost: pairs.len() - direction.len(),
                on_front: false,
            }
        })
        .collect();
    let points: Vec<_> = all.iter().map(|m| (m.time.median, m.direction.most)).collect();
    all.iter_mut().zip(pareto_front(&points)).for_each(|(m, on)| m.on_front = on);
    all
}

/// The results as a table.
pub fn table(results: &[Measured]) -> Table {
    let mut table = Table::new(
        "ray-map",
        &[
            "lens",
            "method",
            "family",
            "time_ns",
            "time_low_ns",
            "time_high_ns",
            "direction_median_rad",
            "direction_999_rad",
            "direction_max_rad",
            "position_median_mm",
            "position_999_mm",
            "position_max_mm",
            "median_pixels",
            "error_999_pixels",
            "max_pixels",
            "lost_rays",
            "on_front",
        ],
    );
    for m in results {
        let mut row = vec![m.lens.as_str().into(), m.method.name.into(), m.method.family.name().into()];
        row.extend([m.time.median, m.time.low, m.time.high].map(|t| (t * 1e9).into()));
        for spread in [m.direction, m.position, m.pixels] {
            row.extend([spread.median, spread.most, spread.worst].map(Into::into));
        }
        row.extend([m.lost.into(), m.on_front.into()]);
        table.rows.push(row);
    }
    table
}
