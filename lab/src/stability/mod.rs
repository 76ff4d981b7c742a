//! Numerical stability: extreme cases with known answers, for every tracer.
//!
//! | part | what it holds |
//! |---|---|
//! | [`mod@tracers`] | the tracers by name; a new one is a line there |
//! | [`case`] | a case, and how a tracer is evaluated by it |
//! | [`interfaces`], [`assemblies`], [`stiff`] | cases whose answer the reference gives |
//! | [`closed_form`] | cases whose answer a formula gives |
//! | [`aspheres`] | the same of aspheres, and their rims |
//! | [`design`] | focal length, pupil and focus of stiff lenses |
//! | [`random`] | lenses and rays at random |
//!
//! [`run`] goes through all of it, and [`rerun`] through one case of it by its name, on any machine the same. The figure to read is [`CaseResult::ratio`]: the error over what a
//! perfect tracer of that precision must expect from the case's
//! [condition number](crate::reference::condition).

pub mod aspheres;
pub mod assemblies;
pub mod case;
pub mod closed_form;
pub mod design;
pub mod interfaces;
mod lenses;
pub mod random;
pub mod stiff;
pub mod tracers;

use std::ops::{ControlFlow, Range};

pub use case::{Case, CaseResult, Failure, MARGIN, Reason};
pub use tracers::{BOUND, Tracer, tracers};

/// How much of the random part is run; the rest is the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extent {
    /// Random lenses of each kind that are compared with the reference, a hundred rays each: those with the numbers from 0.
    pub lenses: u64,
    /// Random lenses in cameras, [`RAYS_EACH`] rays each, likewise.
    pub cameras: u64,
}

impl Extent {
    /// A few seconds.
    pub const QUICK: Self = Self { lenses: 300, cameras: 500 };
    /// A few minutes.
    pub const FULL: Self = Self { lenses: 10_000, cameras: 50_000 };
}

/// How far [`run`] has got.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress<'a> {
    /// What comes next.
    pub name: &'a str,
    /// Share of the work that is done, 0 to 1.
    pub done: f64,
}

/// Parts into which the random rays are divided, between which a run can be stopped.
const PARTS: u64 = 50;
/// Rays through each random camera.
pub const RAYS_EACH: usize = 2000;

/// Every case, for every tracer.
pub fn cases() -> Vec<Case> {
    [
        interfaces::radii,
        interfaces::rims,
        interfaces::grazing,
        interfaces::critical_angles,
        interfaces::index_steps,
        interfaces::gaps,
        assemblies::film_places,
        assemblies::telecentric,
        assemblies::stops,
        assemblies::fisheyes,
        assemblies::counts,
        assemblies::scales,
        assemblies::tiny_coordinates,
        stiff::telescopes,
        stiff::balls,
        closed_form::plates,
        closed_form::aplanatic_meniscus,
        closed_form::shells,
        aspheres::hyperboloids,
        aspheres::ellipsoids,
        aspheres::paraboloids,
        aspheres::planes_with_a_term,
        aspheres::rims,
        aspheres::phone,
    ]
    .into_iter()
    .flat_map(|cases| cases())
    .collect()
}

/// Runs everything on all cores. `progress` is called from this thread between parts, and ends the run with
/// [`ControlFlow::Break`]; what is done by then is returned.
pub fn run(extent: Extent, progress: &mut dyn FnMut(Progress<'_>) -> ControlFlow<()>) -> Vec<CaseResult> {
    let mut results = Vec::new();
    // A stopped run is a shorter one: the results so far are the answer either way.
    let _ = run_parts(extent, &mut results, progress);
    results
}

fn run_parts(
    extent: Extent,
    results: &mut Vec<CaseResult>,
    progress: &mut dyn FnMut(Progress<'_>) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let (cases, tracers) = (cases(), tracers());
    // The cases are a twentieth, the two random parts the rest.
    for (number, case) in cases.iter().enumerate() {
        progress(Progress { name: &case.name, done: 0.05 * number as f64 / cases.len() as f64 })?;
        let trails = case.trails();
        results.extend(tracers.iter().filter_map(|tracer| case.run(tracer, &trails)));
    }
    results.extend(design::first_order());
    results.extend(design::focus());

    for (number, kind) in random::Kind::ALL.into_iter().enumerate() {
        let mut against = random::none_yet(kind, &tracers);
        for (numbers, share) in parts(extent.lenses) {
            progress(Progress {
                name: "random lenses against the reference",
                done: 0.05 + 0.225 * (number as f64 + share),
            })?;
            for found in on_all_cores(numbers, |numbers| random::against_reference(kind, numbers, &tracers)) {
                against.iter_mut().zip(&found).for_each(|(all, part)| all.merge(part));
            }
        }
        results.extend(against);
    }

    let mut survey = random::Survey::default();
    for (numbers, share) in parts(extent.cameras) {
        progress(Progress { name: "rays through random cameras", done: 0.5 + 0.5 * share })?;
        for found in on_all_cores(numbers, |numbers| random::through_cameras(numbers, RAYS_EACH)) {
            survey.add(found);
        }
    }
    results.push(survey.result());
    ControlFlow::Continue(())
}

/// The results of one case for every tracer, by the name that a [`Failure`] gives: of a named case or a random one. None
/// where there is no such case.
pub fn rerun(name: &str) -> Vec<CaseResult> {
    if let Some(number) = random::camera_number(name) {
        return vec![random::through_cameras(number..number + 1, RAYS_EACH).result()];
    }
    let case = random::Kind::find(name).or_else(|| cases().into_iter().find(|case| case.name == name));
    if let Some(case) = case {
        let trails = case.trails();
        return tracers().iter().filter_map(|tracer| case.run(tracer, &trails)).collect();
    }
    let mut design = [design::first_order(), design::focus()].concat();
    design.retain(|result| result.name == name);
    design
}

/// The numbers below `count` in [`PARTS`] parts, each with the share of the work that lies before it.
fn parts(count: u64) -> impl Iterator<Item = (Range<u64>, f64)> {
    (0..PARTS).map(move |part| {
        let at = |part: u64| count * part / PARTS;
        (at(part)..at(part + 1), part as f64 / PARTS as f64)
    })
}

/// `work` on every core, each with its share of the numbers, by rising numbers: what is found is the same on any number of
/// cores.
fn on_all_cores<T: Send>(numbers: Range<u64>, work: impl Fn(Range<u64>) -> T + Sync) -> Vec<T> {
    let workers = std::thread::available_parallelism().map_or(1, std::num::NonZero::get) as u64;
    let (work, count) = (&work, numbers.end - numbers.start);
    let at = |worker: u64| numbers.start + count * worker / workers;
    std::thread::scope(|scope| {
        let threads: Vec<_> =
            (0..workers).map(|worker| scope.spawn(move || work(at(worker)..at(worker + 1)))).collect();
        threads.into_iter().map(|thread| thread.join().expect("the work does not panic")).collect()
    })
}
