//! Decides how rays are traced: computes a [`Decision`] from a [`Task`] and explains it in a [`Plan`].
//!
//! Without a tolerance every surface is intersected; with a tolerance, rays are traced by the cheapest method
//! that stays within it ([`Choice`]). A plan lists what is kept and what is left out in tracing, in sampling
//! ([`describe_sampling`]) and among the features that a camera builds only on request
//! ([`describe_requests`]), each with the reason and the effect.

use std::fmt;

use super::{
    choice::Choice,
    task::{Entry, FilmSide, Precision, Task, Tracing},
};
use crate::sampling::{DiskMapping, PupilSampler};
use realistic_base::message::{as_given, fixed};
use realistic_optics::lens::{refraction::Refraction, single_precision::f32_is_fit};
use realistic_trace::polynomial::Polynomial;

/// One item of a plan.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Item {
    /// Subject of the item.
    pub what: String,
    /// Whether the subject is kept; otherwise it is left out.
    pub kept: bool,
    /// Reason.
    pub why: String,
    /// Effect on the camera.
    pub effect: String,
}

/// The items that a camera keeps and leaves out.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    items: Vec<Item>,
    choice: Option<Choice>,
}

impl Plan {
    /// Returns all items in the order of the data flow.
    pub fn items(&self) -> &[Item] {
        &self.items
    }

    /// Returns the choice of the lens model; `None` without a tolerance.
    pub fn choice(&self) -> Option<&Choice> {
        self.choice.as_ref()
    }

    /// Adds an item that is kept, with the reason and its effect on rays.
    pub fn kept(&mut self, what: &str, why: impl Into<String>, effect: impl Into<String>) {
        self.add(what, true, why.into(), effect.into());
    }

    /// Adds an item that is left out, with the reason and its effect on rays.
    pub fn left_out(&mut self, what: &str, why: impl Into<String>, effect: impl Into<String>) {
        self.add(what, false, why.into(), effect.into());
    }

    fn add(&mut self, what: &str, kept: bool, why: String, effect: String) {
        self.items.push(Item { what: what.to_owned(), kept, why, effect });
    }

    pub(crate) fn set_choice(&mut self, choice: Choice) {
        self.choice = Some(choice);
    }
}

/// Writes two lines per item, then the choice of the lens model.
impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for Item { what, kept, why, effect } in &self.items {
            let verdict = if *kept { "kept" } else { "left out" };
            writeln!(f, "{verdict:<10}{what}\n{:10}{why}; {effect}", "")?;
        }
        self.choice.as_ref().map_or(Ok(()), |choice| write!(f, "\n{choice}"))
    }
}

/// Outcome of planning.
pub struct Decision {
    /// The tracing of all rays or, if `many` is set, of rays requested one by one.
    pub one: Tracing<Polynomial>,
    /// The tracing of rays in batches, if it differs from `one`.
    pub many: Option<Tracing<Polynomial>>,
    /// Warnings to the user, one per line.
    pub warnings: Vec<String>,
}

impl Decision {
    /// Makes the decision, and adds to `plan` the items for tracing.
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

/// Adds to `plan` the items that a method of tracing keeps and leaves out; `rays` names the rays to which the
/// method applies.
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

/// Adds to a plan the items that sampling keeps and leaves out.
pub fn describe_sampling(side: &FilmSide, plan: &mut Plan) {
    match &side.sampler {
        PupilSampler::Warped(pupil) => {
            let report = pupil.build_report();
            let (end, why) = match pupil.image_radius() {
                Some(end) => (end, "the end of the image circle"),
                None => (side.film.reach(), "the raster's corner and its filter"),
            };
            plan.kept(
                &format!("pupil table up to {} mm from the axis", fixed(end, 3)),
                why,
                format!("{} film radii, {} rays", report.nodes, report.rays),
            );
            if pupil.image_radius().is_some_and(|end| end < side.film.reach()) {
                plan.left_out(
                    &format!("pupil of film beyond {} mm", fixed(end, 3)),
                    "no light reaches it",
                    "weight 0 for the price of a comparison",
                );
            }
        }
        PupilSampler::Posed(pupil) if pupil.disk().is_none() => plan.kept(
            "pupil table over x and y of the film",
            "the film is tilted or curved",
            "built once; samples cost a few per cent more",
        ),
        PupilSampler::Disk(_) | PupilSampler::Posed(_) => {
            plan.left_out("pupil table", "a disk is sampled", "no time to build it");
        }
    }
    if side.mapping == DiskMapping::Rejection {
        plan.kept("asking again", "disk \"rejection\"", "some samples are asked for twice");
    }
}

/// Features that a camera builds on request, by calls or parameters.
pub struct Requests {
    /// The camera's wavelength, nm, if the lens is dispersive.
    pub wavelength: Option<f64>,
    /// Whether transmission is requested.
    pub transmission: bool,
    /// Whether ghosts are requested.
    pub ghosts: bool,
    /// Whether a picture is in the stop.
    pub picture: bool,
}

/// Adds to a plan the features that are built only on request, by a call or a parameter. The command
/// `realistic plan` measures the time that each of them saves.
pub fn describe_requests(requests: &Requests, plan: &mut Plan) {
    if let Some(wavelength) = requests.wavelength {
        plan.left_out(
            "dispersion",
            format!("no call has asked for another wavelength than {} nm", as_given(wavelength)),
            "one index per surface, one pupil table",
        );
    }
    plan.left_out("differentials", "traced only by calls that ask for them", "one ray per sample, not three");
    plan.left_out("importance", "no call has asked for it", "no tables of what scene points see of the lens");
    let mut describe_feature = |what: &str, is_kept, kept: &str, left_out: &str| {
        if is_kept {
            plan.kept(what, format!("\"{what}\" asks for it"), kept);
        } else {
            plan.left_out(what, format!("\"{what}\" does not ask for it"), left_out);
        }
    };
    describe_feature(
        "transmission",
        requests.transmission,
        "each ray carries its light from surface to surface",
        "surfaces transmit all light",
    );
    describe_feature(
        "ghosts",
        requests.ghosts,
        "a share of the samples goes to pairs of surfaces",
        "no surface reflects",
    );
    if requests.picture {
        plan.kept("picture in the stop", "\"stop_picture\" asks for it", "a look-up for each ray");
    }
}
