//! The ray map: the error of each tracing method against the reference, and its cost.

use realistic_optics::trace::{Direction, Ray};

use crate::{
    methods::{Family, METHODS, Method, block},
    reference::{ExactRay, Reference},
    results::{
        statistics::{Spread, pareto_front},
        table::{Cell, Table, row},
    },
    subject::{CameraSamples, Subject},
    timing::{Effort, Timing, interleaved},
};

/// The errors and times of one method on one lens.
#[derive(Clone, Debug)]
pub struct RayErrors {
    /// The lens.
    pub lens: String,
    /// The method.
    pub method: Method,
    /// Time per sample, passed or blocked, seconds.
    pub time: Timing,
    /// Repeated timing of the same method, as another task of the same run.
    pub again: Timing,
    /// Angle to the exact direction, rad, over the rays that both the method and the reference pass.
    pub direction: Spread,
    /// Distance of the exact point on the front surface from the ray, mm.
    pub position: Spread,
    /// Distance on film, pixels, between the ray's own film point and the film point that the method's ray images: see
    /// [`ImageScale`](realistic_trace::image_scale::ImageScale).
    pub pixels: Spread,
    /// Samples tested.
    pub samples: usize,
    /// Rays that the reference passes and this method blocks.
    pub lost: usize,
    /// Rays that the reference blocks and this method passes.
    pub leaked: usize,
}

impl RayErrors {
    /// Returns the share of samples that are wrongly passed or blocked.
    pub fn wrong_fates(&self) -> f64 {
        (self.lost + self.leaked) as f64 / self.samples as f64
    }

    /// Whether `other` has exactly the same errors, because it traces the same rays by other instructions or other
    /// calls.
    pub fn is_equal(&self, other: &Self) -> bool {
        let errors = |m: &Self| {
            let spreads = [m.direction, m.position, m.pixels];
            let numbers = spreads.map(|s| [s.median, s.most, s.worst].map(f64::to_bits));
            (m.lens.clone(), m.lost, m.leaked, numbers)
        };
        errors(self) == errors(other)
    }
}

/// Numbers of rays, and the duration of the timing.
#[derive(Clone, Copy, Debug)]
pub struct RayCounts {
    /// Rays whose errors are measured.
    pub rays: usize,
    /// Rays in the block that is timed.
    pub block: usize,
    /// Duration of the timing.
    pub effort: Effort,
}

/// Measures errors and times of every method on one lens. Without `with_walks` it skips the slow walks, except the
/// exact walk, to which all times are relative. The samples are a camera's, including blocked ones; polynomials test
/// the apertures that block them.
pub fn measure(subject: &Subject, counts: RayCounts, with_walks: bool) -> Vec<RayErrors> {
    let samples = CameraSamples::of_warped(subject);
    let rays = samples.rays(counts.rays, 1);
    let reference = Reference::new(&subject.lens, Direction::FilmToScene);
    let exact: Vec<_> = rays.iter().map(|ray| reference.trace(*ray).ok()).collect();
    let timed = &rays[..counts.block.min(rays.len())];
    let ready = |method: &Method, rays: &[Ray]| block::prepare(method, subject, &samples.apertures, rays);
    let chosen = METHODS
        .iter()
        .enumerate()
        .filter(|(number, method)| with_walks || *number == 0 || method.family() != Family::Walk)
        .map(|(_, method)| method);
    let (methods, runners): (Vec<_>, Vec<_>) =
        chosen.filter_map(|method| Some((*method, ready(method, timed)?))).unzip();
    let again = methods.iter().map(|method| ready(method, timed).expect("prepared before"));
    let tasks =
        runners.into_iter().chain(again).map(|mut runner| Box::new(move || runner.run()) as Box<dyn FnMut()>);
    let timings = interleaved(tasks, counts.effort);
    let (first, second) = timings.split_at(methods.len());
    let errors = |(method, (timing, again)): (Method, (&Timing, &Timing))| {
        let mut runner = ready(&method, &rays).expect("prepared before");
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
            again: again.per(timed.len()),
            direction: spread(|_, _, exact, ray| exact.direction_error(ray)),
            position: spread(|_, _, exact, ray| exact.distance_from_line(ray)),
            pixels: spread(|subject, from, exact, ray| subject.pixels(from, &exact.nearest(), ray)),
            samples: rays.len(),
            lost: passing().filter(|((i, _), _)| runner.ray(*i).is_none()).count(),
            leaked: (0..rays.len()).filter(|&i| exact[i].is_none() && runner.ray(i).is_some()).count(),
        }
    };
    methods.into_iter().zip(first.iter().zip(second)).map(errors).collect()
}

/// Returns the results as a table named `name`. The table marks the Pareto front of time and the 99.9 % quantile of the
/// direction error: the methods that no other method beats in both by more than a tie.
pub fn table(name: &'static str, results: &[RayErrors], tie: f64) -> Table {
    table_of(name, results.iter().map(|m| (m.method.name.to_owned(), m)), results, tie)
}

/// Returns the table in which all methods with exactly the same errors and the same kind of call share one row: the row
/// of the fastest, whose name lists the times of the others.
pub fn summary(name: &'static str, results: &[RayErrors], tie: f64) -> Table {
    let in_batches = |m: &RayErrors| m.method.family().in_batches();
    let same = |a: &RayErrors, b: &RayErrors| in_batches(a) == in_batches(b) && a.is_equal(b);
    let fastest = results.iter().filter(|m| {
        let faster = |other: &&RayErrors| other.time.median < m.time.median;
        !results.iter().filter(faster).any(|other| same(m, other))
    });
    let named = fastest.map(|m| {
        let others = results.iter().filter(|other| other.method != m.method && same(m, other));
        let others: Vec<String> =
            others.map(|other| format!("{}: {:.1} ns", other.method.name, other.time.median * 1e9)).collect();
        let name = m.method.name;
        let name = if others.is_empty() {
            name.to_owned()
        } else {
            format!("{name} (same rays: {})", others.join(", "))
        };
        (name, m)
    });
    table_of(name, named, results, tie)
}

fn table_of<'a>(
    name: &'static str,
    shown: impl Iterator<Item = (String, &'a RayErrors)>,
    all: &[RayErrors],
    tie: f64,
) -> Table {
    let columns = "lens method family time_ns time_low_ns time_high_ns time_again_ns direction_median_rad direction_999_rad \
                   direction_max_rad position_median_mm position_999_mm position_max_mm median_pixels \
                   error_999_pixels max_pixels samples lost_rays leaked_rays on_front";
    let on_front = |m: &RayErrors| {
        let own: Vec<&RayErrors> = all.iter().filter(|other| other.lens == m.lens).collect();
        let points: Vec<_> = own.iter().map(|m| (m.time.median, m.direction.most)).collect();
        let front = pareto_front(&points, tie);
        own.iter().zip(front).any(|(other, on)| on && other.method == m.method)
    };
    let rows = shown.map(|(name, m)| {
        let spread = |s: Spread| row![s.median, s.most, s.worst];
        let times = [m.time.median, m.time.low, m.time.high, m.again.median];
        let times: Vec<Cell> = times.map(|time| (time * 1e9).into()).into();
        let names = row![m.lens.as_str(), name.as_str(), m.method.family().name()];
        let errors = [m.direction, m.position, m.pixels].map(spread).concat();
        [names, times, errors, row![m.samples, m.lost, m.leaked, on_front(m)]].concat()
    });
    Table::of(name, columns, rows)
}
