//! The ray map: how far each way to take a ray through a lens is from the reference, and what it costs.

use realistic::trace::{Direction, Ray};

use crate::{
    methods::{METHODS, Method, block},
    reference::{ExactRay, Reference},
    results::{
        statistics::{Spread, pareto_front},
        table::{Cell, Table, row},
    },
    subject::Subject,
    timing::{Effort, Timing, interleaved},
};

/// What was measured of one method on one lens.
#[derive(Clone, Debug)]
pub struct RayErrors {
    /// The lens.
    pub lens: String,
    /// The method.
    pub method: Method,
    /// Time per ray, seconds.
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
pub struct RayCounts {
    /// Rays whose errors are taken.
    pub rays: usize,
    /// Rays in the block that is timed.
    pub block: usize,
    /// How long to time.
    pub effort: Effort,
}

/// Errors and times of every method on one lens.
pub fn measure(subject: &Subject, counts: RayCounts) -> Vec<RayErrors> {
    let rays = subject.rays(counts.rays, 1);
    let reference = Reference::new(&subject.lens, Direction::FilmToScene);
    let exact: Vec<_> = rays.iter().map(|ray| reference.trace(*ray).ok()).collect();
    let timed = &rays[..counts.block.min(rays.len())];
    let (methods, runners): (Vec<_>, Vec<_>) =
        METHODS.iter().filter_map(|method| Some((*method, block::prepare(method, subject, timed)?))).unzip();
    let tasks = runners.into_iter().map(|mut runner| Box::new(move || runner.run()) as Box<dyn FnMut()>);
    let timings = interleaved(tasks, counts.effort);
    let errors = |(method, timing): (Method, Timing)| {
        let mut runner = block::prepare(&method, subject, &rays).expect("prepared before");
        runner.run();
        let passing =
            || rays.iter().enumerate().zip(&exact).filter_map(|(ray, exact)| Some((ray, exact.as_ref()?)));
        let spread = |measure: fn(&Subject, &Ray, &ExactRay, &Ray) -> f64| {
            let error = |((i, from), exact)| Some(measure(subject, from, exact, &runner.ray(i)?));
            Spread::of(&passing().filter_map(error).collect::<Vec<_>>())
        };
        RayErrors {
            lens: subject.lens.name.clone(),
            method,
            time: timing.per(timed.len()),
            direction: spread(|_, _, exact, ray| exact.direction_error(ray)),
            position: spread(|_, _, exact, ray| exact.distance_from_line(ray)),
            pixels: spread(|subject, from, exact, ray| subject.pixels(from, &exact.nearest(), ray)),
            lost: passing().filter(|((i, _), _)| runner.ray(*i).is_none()).count(),
            on_front: false,
        }
    };
    let mut all: Vec<RayErrors> = methods.into_iter().zip(timings).map(errors).collect();
    let points: Vec<_> = all.iter().map(|m| (m.time.median, m.direction.most)).collect();
    all.iter_mut().zip(pareto_front(&points)).for_each(|(m, on)| m.on_front = on);
    all
}

/// The results as a table.
pub fn table(results: &[RayErrors]) -> Table {
    let columns = "lens method family time_ns time_low_ns time_high_ns direction_median_rad direction_999_rad \
                   direction_max_rad position_median_mm position_999_mm position_max_mm median_pixels \
                   error_999_pixels max_pixels lost_rays on_front";
    let rows = results.iter().map(|m| {
        let spread = |s: Spread| row![s.median, s.most, s.worst];
        let time: Vec<Cell> = [m.time.median, m.time.low, m.time.high].map(|time| (time * 1e9).into()).into();
        let names = row![m.lens.as_str(), m.method.name, m.method.family().name()];
        let errors = [m.direction, m.position, m.pixels].map(spread).concat();
        [names, time, errors, row![m.lost, m.on_front]].concat()
    });
    Table::of("ray-map", columns, rows)
}
