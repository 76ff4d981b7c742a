//! Numerical stability: extreme cases with known answers, for every tracer.
//!
//! | module | contents |
//! |---|---|
//! | [`mod@tracers`] | the tracers by name; a new one takes one line |
//! | [`case`] | a case, and the evaluation of a tracer |
//! | [`interfaces`], [`assemblies`], [`stiff`] | cases whose answer the reference gives |
//! | [`closed_form`] | cases whose answer a formula gives |
//! | [`aspheres`] | cases of aspheres whose answer a formula gives, and of their edges |
//! | [`design`] | focal length, pupil and focus of stiff lenses |
//! | [`random`] | lenses and rays at random |
//!
//! [`run`] runs all cases, and [`rerun`] runs one case by its name, identically on any machine. The figure of merit is
//! [`CaseResult::ratio`]: the error divided by the error of a perfect tracer of the same precision, which follows from
//! the case's [condition number](crate::reference::condition).

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
pub use tracers::{BOUND, TracerUnderTest, tracers};

/// Extent of the random part; the named cases always run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extent {
    /// Number of random lenses of each kind, numbered from 0, that are compared with the reference with a hundred rays
    /// each.
    pub lenses: u64,
    /// Number of random lenses in cameras, numbered from 0, with [`RAYS_EACH`] rays each.
    pub cameras: u64,
}

impl Extent {
    /// An extent that takes a few seconds.
    pub const QUICK: Self = Self { lenses: 300, cameras: 500 };
    /// An extent that takes a few minutes.
    pub const FULL: Self = Self { lenses: 10_000, cameras: 50_000 };
}

/// Progress of [`run`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress<'a> {
    /// Name of the next step.
    pub name: &'a str,
    /// Share of the work done, 0 to 1.
    pub done: f64,
}

/// Number of parts of the random rays; a run can be stopped between parts.
const PARTS: u64 = 50;
/// Rays through each random camera.
pub const RAYS_EACH: usize = 2000;

/// Returns every case, for every tracer.
pub fn cases() -> Vec<Case> {
    [
        interfaces::radii,
        interfaces::edges,
        interfaces::grazing,
        interfaces::critical_angles,
        interfaces::index_steps,
        interfaces::gaps,
        assemblies::film_positions,
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
        aspheres::edges,
        aspheres::phone,
    ]
    .into_iter()
    .flat_map(|cases| cases())
    .collect()
}

/// Runs all cases on all cores. `progress` is called from this thread between parts, and can stop the run with
/// [`ControlFlow::Break`]; the results up to that point are returned.
pub fn run(extent: Extent, progress: &mut dyn FnMut(Progress<'_>) -> ControlFlow<()>) -> Vec<CaseResult> {
    let mut results = Vec::new();
    // A stopped run returns its results so far, so the flow value is not needed.
    let _ = run_parts(extent, &mut results, progress);
    results
}

fn run_parts(
    extent: Extent,
    results: &mut Vec<CaseResult>,
    progress: &mut dyn FnMut(Progress<'_>) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let (cases, tracers) = (cases(), tracers());
    // The named cases count as a twentieth of the work, the two random parts as the rest.
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
                done: 0.05 + 0.45 * (number as f64 + share) / random::Kind::ALL.len() as f64,
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

/// Returns the results of one case for every tracer. The name is that in a [`Failure`], of a named or a random case.
/// The results are empty if there is no such case.
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

/// Divides the numbers below `count` into [`PARTS`] parts, and returns each with the share of the work that comes
/// before it.
fn parts(count: u64) -> impl Iterator<Item = (Range<u64>, f64)> {
    (0..PARTS).map(move |part| {
        let at = |part: u64| count * part / PARTS;
        (at(part)..at(part + 1), part as f64 / PARTS as f64)
    })
}

/// Runs `work` on every core, each on a share of the numbers, and returns the results in increasing order of the
/// numbers, so that they do not depend on the number of cores.
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
