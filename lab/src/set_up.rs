//! Set-up: what it costs to make a model of a lens, by the size of its tables, and what it is worth.

use crate::{
    clock::now, ray_map::Spread, reference::Reference, statistics::median, subject::Subject, table::Table,
};
use realistic::trace::{
    Direction, Ray,
    kernel::Traced,
    polynomial::{Polynomial, PolynomialLens},
};

/// How much is measured.
#[derive(Clone, Copy, Debug)]
pub struct Size {
    /// Rays whose errors are taken.
    pub rays: usize,
    /// Builds whose median time counts.
    pub repeats: usize,
}

/// A model ready for rays.
type Map = Box<dyn Fn(Ray) -> Option<Ray>>;

/// A kind of model with a size that can be chosen.
#[derive(Clone, Copy, Debug)]
pub struct Family {
    /// Short name.
    pub name: &'static str,
    /// The sizes tried, in what [`Family::unit`] says.
    pub sizes: &'static [usize],
    /// What a size counts.
    pub unit: &'static str,
    /// Builds the model; says also how many numbers it keeps. Nothing where the size does not suffice.
    pub build: fn(&Subject, usize) -> Option<(Map, usize)>,
}

/// Rays traced for a fit.
const FITS: &[usize] = &[125, 250, 500, 1000, 2000, 4000];

/// Every kind of model whose size is a choice.
pub const FAMILIES: &[Family] = &[
    Family { name: "order 3", sizes: FITS, unit: "rays", build: polynomial::<3> },
    Family { name: "order 5", sizes: FITS, unit: "rays", build: polynomial::<5> },
    Family { name: "order 7", sizes: FITS, unit: "rays", build: polynomial::<7> },
    Family { name: "order 9", sizes: FITS, unit: "rays", build: polynomial::<9> },
    Family { name: "order 11", sizes: FITS, unit: "rays", build: polynomial::<11> },
];

fn polynomial<const ORDER: usize>(subject: &Subject, rays: usize) -> Option<(Map, usize)> {
    let model = Polynomial::fit(&subject.lens, subject.film_z, &subject.rays(rays, 0), ORDER).ok()?;
    let kept = model.coefficients();
    let lens = PolynomialLens::<f64>::new(&model);
    let map = move |Ray { origin: [x, y, _], direction: [dx, dy, dz] }: Ray| {
        let Traced { origin, direction, .. } = lens.trace_one([x, y], [dx / dz, dy / dz])?;
        Some(Ray { origin, direction })
    };
    Some((Box::new(map), kept))
}

/// One model at one size.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// The lens.
    pub lens: String,
    /// The kind.
    pub family: &'static str,
    /// Its size.
    pub size: usize,
    /// What the size counts.
    pub unit: &'static str,
    /// Numbers that it keeps.
    pub kept: usize,
    /// Time to build it, seconds.
    pub time: f64,
    /// Angle to the exact direction on fresh rays, rad.
    pub direction: Spread,
}

/// Every size of every kind on one lens.
pub fn measure(subject: &Subject, size: Size) -> Vec<Measured> {
    let reference = Reference::new(&subject.lens, Direction::FilmToScene);
    let rays = subject.rays(size.rays, 1);
    let pairs: Vec<_> = rays.iter().filter_map(|ray| Some((*ray, reference.trace(*ray).ok()?))).collect();
    let mut all = Vec::new();
    for family in FAMILIES {
        for &entries in family.sizes {
            let mut times = Vec::new();
            let mut model = None;
            for _ in 0..size.repeats {
                let start = now();
                model = (family.build)(subject, entries);
                times.push((now() - start).as_secs_f64());
            }
            let Some((map, kept)) = model else { continue };
            let errors: Vec<f64> =
                pairs.iter().filter_map(|(ray, exact)| Some(exact.direction_error(&map(*ray)?))).collect();
            all.push(Measured {
                lens: subject.lens.name.clone(),
                family: family.name,
                size: entries,
                unit: family.unit,
                kept,
                time: median(&times),
                direction: Spread::of(&errors),
            });
        }
    }
    all
}

/// The results as a table.
pub fn table(results: &[Measured]) -> Table {
    let mut table = Table::new(
        "set-up",
        &[
            "lens",
            "model",
            "size",
            "unit",
            "numbers_kept",
            "build_ms",
            "direction_median_rad",
            "direction_999_rad",
            "direction_max_rad",
        ],
    );
    for m in results {
        table.rows.push(vec![
            m.lens.as_str().into(),
            m.family.into(),
            m.size.into(),
            m.unit.into(),
            m.kept.into(),
            (m.time * 1e3).into(),
            m.direction.median.into(),
            m.direction.most.into(),
            m.direction.worst.into(),
        ]);
    }
    table
}
