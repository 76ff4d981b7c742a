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
//! [`run`] goes through all of it. The figure to read is [`CaseResult::ratio`]: the error over what a
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

use std::ops::ControlFlow;

pub use case::{Case, CaseResult, MARGIN};
pub use tracers::{BOUND, Tracer, tracers};

/// How much of the random part is run; the rest is the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extent {
    /// Random lenses that are compared with the reference, a hundred rays each.
    pub lenses: usize,
    /// Rays through random lenses in cameras, about.
    pub rays: u64,
}

impl Extent {
    /// A few seconds.
    pub const QUICK: Self = Self { lenses: 300, rays: 1_000_000 };
    /// A few minutes.
    pub const FULL: Self = Self { lenses: 10_000, rays: 100_000_000 };
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
const PARTS: usize = 50;
/// Rays through each random camera.
const RAYS_EACH: usize = 2000;

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
        for part in 0..PARTS {
            let done = 0.05 + 0.225 * (number as f64 + part as f64 / PARTS as f64);
            progress(Progress { name: "random lenses against the reference", done })?;
            for found in on_all_cores(part, |seed, workers| {
                random::against_reference(kind, seed, extent.lenses.div_ceil(PARTS * workers), &tracers)
            }) {
                against.iter_mut().zip(&found).for_each(|(all, part)| all.merge(part));
            }
        }
        results.extend(against);
    }

    let mut survey = random::Survey::default();
    let lenses = extent.rays.div_ceil((PARTS * RAYS_EACH) as u64) as usize;
    for part in 0..PARTS {
        let done = 0.5 + 0.5 * part as f64 / PARTS as f64;
        progress(Progress { name: "rays through random cameras", done })?;
        for found in on_all_cores(PARTS + part, |seed, workers| {
            random::through_cameras(seed, lenses.div_ceil(workers), RAYS_EACH)
        }) {
            survey.add(found);
        }
    }
    results.push(survey.result());
    ControlFlow::Continue(())
}

/// `work` on every core, each with a seed of its own, and the number of cores.
fn on_all_cores<T: Send>(part: usize, work: impl Fn(u64, usize) -> T + Sync) -> Vec<T> {
    let workers = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let work = &work;
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..workers)
            .map(|worker| scope.spawn(move || work((1 + part * workers + worker) as u64, workers)))
            .collect();
        threads.into_iter().map(|thread| thread.join().expect("the work does not panic")).collect()
    })
}
