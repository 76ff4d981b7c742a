//! The ray map: how far each way to take a ray through a lens is from the reference, and what it costs.

use crate::{
    bench::{Effort, Timing, interleaved},
    compiled,
    reference::{DoubleDouble, ExactRay, Reference},
    statistics::{pareto_front, quantile},
    subject::Subject,
    table::Table,
};
use realistic::{
    lens::refraction::Refraction,
    trace::{Direction, Path, Ray, Real, polynomial::Polynomial},
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
    /// The compiled kernels: one ray or three.
    Kernel,
    /// The compiled kernels in batches.
    KernelBatch,
    /// Every surface, with any of the lecture's refractions, and the reference.
    Walk,
}

impl Family {
    /// Every family with its name.
    pub const NAMES: [(&'static str, Self); 6] = [
        ("first-order optics", Self::Gaussian),
        ("polynomials", Self::Polynomial),
        ("polynomials in batches", Self::PolynomialBatch),
        ("kernel, single rays", Self::Kernel),
        ("kernel in batches", Self::KernelBatch),
        ("walk", Self::Walk),
    ];

    /// The name.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, family)| *family == self).map_or("", |(name, _)| name)
    }

    /// Whether it needs many rays at once.
    pub fn in_batches(self) -> bool {
        matches!(self, Self::PolynomialBatch | Self::KernelBatch)
    }
}

/// A method at work on a block of rays, which it holds in a form of its own.
pub trait Runner {
    /// Takes the whole block through the lens.
    fn run(&mut self);
    /// A ray of the last run, if it got through.
    fn ray(&self, index: usize) -> Option<Ray>;
}

/// A method ready for a block of rays; `None` where the processor lacks the instructions.
pub type Prepared = Option<Box<dyn Runner>>;

/// A way to take rays through a lens.
#[derive(Clone, Copy, Debug)]
pub struct Method {
    /// Short name.
    pub name: &'static str,
    /// What kind it is.
    pub family: Family,
    /// Makes it ready for a block of rays.
    pub prepare: fn(&Subject, &[Ray]) -> Prepared,
}

/// Every method that is compared.
pub const METHODS: &[Method] = &[
    Method { name: "thin lens", family: Family::Gaussian, prepare: thin },
    Method { name: "thick lens", family: Family::Gaussian, prepare: thick },
    Method { name: "order 3", family: Family::Polynomial, prepare: compiled::polynomial::<3> },
    Method { name: "order 5", family: Family::Polynomial, prepare: compiled::polynomial::<5> },
    Method { name: "order 7", family: Family::Polynomial, prepare: compiled::polynomial::<7> },
    Method { name: "order 9", family: Family::Polynomial, prepare: compiled::polynomial::<9> },
    Method { name: "order 11", family: Family::Polynomial, prepare: compiled::polynomial::<11> },
    Method {
        name: "order 3, f32",
        family: Family::PolynomialBatch,
        prepare: compiled::polynomials::<f32, 3>,
    },
    Method {
        name: "order 5, f32",
        family: Family::PolynomialBatch,
        prepare: compiled::polynomials::<f32, 5>,
    },
    Method {
        name: "order 7, f32",
        family: Family::PolynomialBatch,
        prepare: compiled::polynomials::<f32, 7>,
    },
    Method {
        name: "order 9, f32",
        family: Family::PolynomialBatch,
        prepare: compiled::polynomials::<f32, 9>,
    },
    Method {
        name: "order 11, f32",
        family: Family::PolynomialBatch,
        prepare: compiled::polynomials::<f32, 11>,
    },
    Method {
        name: "order 11, f64",
        family: Family::PolynomialBatch,
        prepare: compiled::polynomials::<f64, 11>,
    },
    Method { name: "one f32", family: Family::Kernel, prepare: compiled::one::<f32> },
    Method { name: "one f64", family: Family::Kernel, prepare: compiled::one::<f64> },
    Method { name: "three f32", family: Family::Kernel, prepare: compiled::three::<f32> },
    Method { name: "three f64", family: Family::Kernel, prepare: compiled::three::<f64> },
    Method { name: "f32 portable", family: Family::KernelBatch, prepare: compiled::portable::<f32> },
    Method { name: "f64 portable", family: Family::KernelBatch, prepare: compiled::portable::<f64> },
    Method { name: "f32x8", family: Family::KernelBatch, prepare: compiled::avx2::<f32> },
    Method { name: "f64x4", family: Family::KernelBatch, prepare: compiled::avx2::<f64> },
    Method { name: "f32x16", family: Family::KernelBatch, prepare: compiled::avx512::<f32> },
    Method { name: "f64x8", family: Family::KernelBatch, prepare: compiled::avx512::<f64> },
    Method { name: "walk f32", family: Family::Walk, prepare: walk::<f32> },
    Method { name: YARDSTICK, family: Family::Walk, prepare: walk::<f64> },
    Method { name: "heckbert", family: Family::Walk, prepare: |s, r| refracted(s, r, Refraction::Heckbert) },
    Method { name: "whitted", family: Family::Walk, prepare: |s, r| refracted(s, r, Refraction::Whitted) },
    Method { name: "other", family: Family::Walk, prepare: |s, r| refracted(s, r, Refraction::Other) },
    Method { name: "reference", family: Family::Walk, prepare: walk::<DoubleDouble> },
];

/// The method that all others are timed against.
const YARDSTICK: &str = "walk f64";
/// Rays that polynomials are fitted to.
const FIT_RAYS: usize = 2000;

/// A map of one ray, over a block: from the form in which it takes rays to the one in which it gives them.
struct Single<I, O, F> {
    map: F,
    rays: Vec<I>,
    out: Vec<Option<O>>,
    read: fn(&O) -> Ray,
}

impl<I: Copy, O, F: Fn(I) -> Option<O>> Runner for Single<I, O, F> {
    fn run(&mut self) {
        for (ray, out) in self.rays.iter().zip(&mut self.out) {
            *out = (self.map)(*ray);
        }
    }

    fn ray(&self, index: usize) -> Option<Ray> {
        self.out[index].as_ref().map(self.read)
    }
}

/// A map of one ray, for a block of them.
pub(super) fn single<I: Copy + 'static, O: Clone + 'static>(
    rays: Vec<I>,
    map: impl Fn(I) -> Option<O> + 'static,
    read: fn(&O) -> Ray,
) -> Box<dyn Runner> {
    let out = vec![None; rays.len()];
    Box::new(Single { map, rays, out, read })
}

fn mapped(rays: &[Ray], map: impl Fn(Ray) -> Option<Ray> + 'static) -> Prepared {
    Some(single(rays.to_vec(), map, |ray| *ray))
}

fn thick(subject: &Subject, rays: &[Ray]) -> Prepared {
    let lens = subject.first_order;
    mapped(rays, move |ray| Some(lens.transfer(ray)))
}

/// The thick lens with both principal planes where the film's is.
fn thin(subject: &Subject, rays: &[Ray]) -> Prepared {
    let lens = subject.first_order.thin_at(subject.first_order.rear_principal_plane);
    mapped(rays, move |ray| Some(lens.transfer(ray)))
}

fn walk<R: Real + 'static>(subject: &Subject, rays: &[Ray]) -> Prepared {
    let path = Path::<R>::film_to_scene(&subject.lens);
    mapped(rays, move |ray| path.trace(ray).ok())
}

fn refracted(subject: &Subject, rays: &[Ray], refraction: Refraction) -> Prepared {
    let path = Path::<f64>::new(&subject.lens, Direction::FilmToScene, refraction);
    mapped(rays, move |ray| path.trace(ray).ok())
}

/// Polynomials of an order fitted to the subject's own rays.
pub(super) fn fit(subject: &Subject, order: usize) -> Polynomial {
    Polynomial::fit(&subject.lens, subject.film_z, &subject.rays(FIT_RAYS, 0), order)
        .expect("the subject's rays are spread over film and pupil")
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
    /// How far from its film point the ray belongs, pixels: see
    /// [`ImageScale`](realistic::imaging::image_scale::ImageScale).
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
    let mut yardstick = walk::<f64>(subject, block).expect("for any processor");
    let (methods, mut runners): (Vec<_>, Vec<_>) =
        METHODS.iter().filter_map(|method| Some((*method, (method.prepare)(subject, block)?))).unzip();
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
    let mut all: Vec<Measured> = methods
        .into_iter()
        .zip(&timings)
        .map(|(method, timing)| {
            let mut runner = (method.prepare)(subject, &rays).expect("prepared before");
            runner.run();
            let pairs: Vec<_> = exact
                .iter()
                .enumerate()
                .filter_map(|(i, exact)| Some((&rays[i], exact.as_ref()?, runner.ray(i))))
                .collect();
            let errors = |measure: &dyn Fn(&Ray, &ExactRay, &Ray) -> f64| -> Vec<f64> {
                pairs
                    .iter()
                    .filter_map(|(from, exact, ray)| Some(measure(from, exact, ray.as_ref()?)))
                    .collect()
            };
            let direction = errors(&|_, exact, ray| exact.direction_error(ray));
            let position = errors(&|_, exact, ray| exact.distance_from_line(ray));
            let pixels = errors(&|from, exact, ray| subject.pixels(from, &exact.nearest(), ray));
            Measured {
                lens: subject.lens.name.clone(),
                method,
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
