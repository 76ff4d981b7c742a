//! Makes the decision: how rays are traced, and which aperture tests none of them needs.
//!
//! In goes a [`Task`]; out come the [`Decision`] and, in the plan, the reasons. A named refraction, or a host that
//! wants nothing left out, gets every surface; a tolerance, the cheapest way that stays within it ([`Choice`]).

use super::{
    apertures::Apertures,
    choice::Choice,
    items::Plan,
    task::Task,
    tracing::{Entry, Precision, Tracing},
};
use crate::{
    lens::{refraction::Refraction, single_precision::f32_is_fit},
    trace::polynomial::Polynomial,
};

/// What was decided.
pub(crate) struct Decision {
    /// How rays are traced; where `many` is one, those that are asked for one by one.
    pub one: Way,
    /// How those in batches are, where that is another way.
    pub many: Option<Way>,
    /// What the user should know, line by line.
    pub warnings: Vec<String>,
}

/// A way to trace, as far as it serves.
pub(crate) struct Way {
    /// How.
    pub tracing: Tracing<Polynomial>,
    /// Film radius in mm up to which polynomials, or fewer tests, serve; beyond it is the whole lens.
    pub reach: f64,
    /// Which apertures are tested, by surface from the scene, where rays begin within `reach`; `None`: all.
    pub tested: Option<Vec<bool>>,
}

impl Decision {
    /// Decides, and writes into `plan` what is kept and left out, and why.
    pub fn of(task: &Task<'_>, plan: &mut Plan) -> Self {
        let mut warnings = Vec::new();
        let single = task.precision == Some(Precision::F32);
        let unfit = if single { f32_is_fit(task.lens).err() } else { None };
        if let Some(unfit) = &unfit {
            warnings.push(format!("\"precision\" \"f32\" cannot trace this lens: {unfit}"));
        }
        let is_named = task.precision.is_some() || task.refraction != Refraction::Fused;
        if task.tolerance > 0.0 && task.leave_out && is_named {
            warnings.push(
                "\"tolerance\" is not used: \"precision\" or \"refraction\" names how rays are traced; leave \
                 it at its default"
                    .to_owned(),
            );
        }
        let unfit = unfit.map(|unfit| unfit.to_string());
        let named = Tracing::Exact(task.precision.unwrap_or(Precision::F64));
        let (one, many) = match (task.refraction, task.leave_out) {
            (Refraction::Fused, true) if task.tolerance > 0.0 && !is_named => {
                let (choice, [one, many]) = Choice::of(task);
                plan.set_choice(choice);
                let many = (many != one).then_some(many);
                (one, many)
            }
            (Refraction::Fused, _) => (named, None),
            (refraction, _) => {
                (Tracing::Refracted(refraction, task.precision.unwrap_or(Precision::F64)), None)
            }
        };
        let mut way = |tracing, rays: &str| Way::of(tracing, rays, unfit.as_deref(), task, plan);
        let (one, many) = match many {
            None => (way(one, ""), None),
            Some(many) => {
                let [first, second] = Entry::ALL.map(|entry| format!(", for rays {entry}"));
                (way(one, &first), Some(way(many, &second)))
            }
        };
        Self { one, many, warnings }
    }
}

impl Way {
    /// Writes into `plan` what a way of tracing, for the rays named, keeps and leaves out. `unfit` is why `f32`, which is asked
    /// for, cannot trace the lens.
    fn of(
        tracing: Tracing<Polynomial>,
        rays: &str,
        unfit: Option<&str>,
        task: &Task<'_>,
        plan: &mut Plan,
    ) -> Self {
        let (mut reach, mut tested) = (task.film_side.film.reach(), None);
        match &tracing {
            Tracing::Exact(precision) if task.leave_out => {
                let error = if *precision == Precision::F64 { "1e-15" } else { "1e-7" };
                plan.kept(
                    &format!("exact trace in {precision}{rays}"),
                    "every surface is met",
                    format!("errors of {error} rad"),
                );
                let aspheres = task.path.aspheres();
                if aspheres > 0 {
                    plan.kept(
                        &format!("tests at {aspheres} aspheres that rays go forward and meet the near side"),
                        "of spheres and planes it is proven where no ray can fail them; of aspheres nothing is tried, for \
                         the search of the first crossing needs them",
                        "some comparisons of the hundred and more operations that an asphere takes; exact",
                    );
                }
                if let Some(unfit) = unfit {
                    plan.kept("every aperture test", unfit, "no bound holds in f32");
                } else {
                    (tested, reach) = needed_tests(task, plan);
                }
            }
            Tracing::Polynomials { order, fit, .. } => plan.left_out(
                &format!("the surfaces, one by one{rays}"),
                "polynomials take their place within the tolerance",
                format!("order {order}, {} coefficients", fit.coefficients()),
            ),
            Tracing::Exact(_) | Tracing::Refracted(..) => {
                plan.kept("every surface and aperture test", "the method of tracing is named", "exact");
            }
        }
        Self { tracing, reach, tested }
    }
}

/// Which apertures rays from the film can fail, `None` where that is all; and up to which film radius it holds, mm.
fn needed_tests(task: &Task<'_>, plan: &mut Plan) -> (Option<Vec<bool>>, f64) {
    let bands = task.film_side.bands();
    let apertures = Apertures::of(task.lens, task.path, task.film_side.z, &bands);
    let tested: Vec<bool> = (0..task.lens.surfaces.len()).map(|i| apertures.is_needed(i)).collect();
    let reach = bands.last().map_or(0.0, |band| band.radii[1]);
    if tested.iter().all(|needed| *needed) {
        plan.kept(
            "aperture tests of all surfaces",
            "rays come to the edge of each, or no bound keeps them from it",
            "exact",
        );
        return (None, reach);
    }
    let numbers = (1..).zip(&tested).filter(|(_, needed)| **needed).map(|(number, _)| number.to_string());
    let numbers: Vec<String> = numbers.collect();
    if !numbers.is_empty() {
        let surfaces = if numbers.len() == 1 { "test of surface" } else { "tests of surfaces" };
        plan.kept(
            &format!("aperture {surfaces} {}", numbers.join(", ")),
            "rays come to its edge, or no bound keeps them from it",
            "exact",
        );
    }
    for (number, bound) in (1..).zip(&apertures.redundant) {
        let Some(bound) = bound else { continue };
        plan.left_out(
            &format!("aperture test of surface {number}"),
            format!(
                "proven: no ray of this film and pupil comes beyond {:.1} % of the clear radius",
                100.0 * bound
            ),
            "no bit changes",
        );
    }
    (Some(tested), reach)
}
