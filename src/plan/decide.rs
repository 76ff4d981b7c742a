//! Makes the decision: how rays are traced.
//!
//! In goes a [`Task`]; out come the [`Decision`] and, in the plan, the reasons. Without a tolerance
//! every surface is met; with one, rays go the cheapest way that stays within it ([`Choice`]).

use super::{
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
    pub one: Tracing<Polynomial>,
    /// How those in batches are, where that is another way.
    pub many: Option<Tracing<Polynomial>>,
    /// What the user should know, line by line.
    pub warnings: Vec<String>,
}

impl Decision {
    /// Decides, and writes into `plan` what is kept and left out, and why.
    pub fn of(task: &Task<'_>, plan: &mut Plan) -> Self {
        let mut warnings = Vec::new();
        let single = task.precision == Some(Precision::F32);
        if single && let Err(unfit) = f32_is_fit(task.lens) {
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
        match &many {
            None => describe(&one, "", task, plan),
            Some(many) => {
                for (entry, tracing) in Entry::ALL.into_iter().zip([&one, many]) {
                    describe(tracing, &format!(", for rays {entry}"), task, plan);
                }
            }
        }
        Self { one, many, warnings }
    }
}

/// Writes into `plan` what a way of tracing, for the rays named, keeps and leaves out.
fn describe(tracing: &Tracing<Polynomial>, rays: &str, task: &Task<'_>, plan: &mut Plan) {
    match tracing {
        Tracing::Exact(precision) => {
            let error = if *precision == Precision::F64 { "1e-15" } else { "1e-7" };
            plan.kept(
                &format!("exact trace in {precision}{rays}"),
                "every surface is met and every aperture tested",
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
        }
        Tracing::Polynomials { order, fit, .. } => plan.left_out(
            &format!("the surfaces, one by one{rays}"),
            "polynomials take their place within the tolerance",
            format!("order {order}, {} coefficients", fit.coefficients()),
        ),
        Tracing::Refracted(..) => {
            plan.kept("every surface and aperture test", "the method of tracing is named", "exact");
        }
    }
}
