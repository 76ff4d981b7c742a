//! Chooses the cheapest tracing of a lens whose measured error stays below a tolerance.
//!
//! The search is made separately for rays one by one and for rays in batches. It tries the candidates in
//! order of increasing cost, and each candidate only once: `evaluate` measures its errors on rays from all
//! over the film and its pupil, sampled as the camera samples them. A candidate is accepted if the upper
//! bound of the 99.9 % quantile of its errors is below the tolerance and the sum of the weights' errors is at
//! most a thousandth of the light.

use std::fmt;

use super::{
    cost,
    evaluate::{Errors, Evaluation, QUANTILE, TooFarOff},
    task::{Entry, Precision, Task, Tracing},
};
use realistic_base::message::short;
use realistic_optics::lens::single_precision::f32_is_fit;
use realistic_simd::Simd;
use realistic_trace::polynomial::{Fits, ORDERS, Polynomial, monomials};

/// The result of trying a candidate.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// Accepted, with these errors.
    Within(Errors),
    /// Rejected: too many rays exceed the tolerance.
    TooFarOff(TooFarOff),
    /// Rejected: the weights' errors exceed a thousandth of the light.
    WrongLight(Errors),
    /// Not available for this lens, with the reason.
    Excluded(String),
    /// Not tried, because a candidate that costs no more was chosen.
    Untried,
}

/// A method of tracing, with its cost and its verdict.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// The method of tracing.
    pub tracing: Tracing,
    /// Costs of a ray through the lens, ns, for rays one by one and in batches.
    pub costs: [f64; 2],
    /// The result of trying the method.
    pub verdict: Verdict,
}

/// The candidates and the choice among them.
#[derive(Clone, Debug)]
pub struct Choice {
    /// Tolerated error of a ray, pixels.
    pub tolerance: f64,
    /// Every method of tracing, with the exact methods last.
    pub candidates: Vec<Candidate>,
    /// Indices of the chosen candidates, for rays one by one and in batches.
    chosen: [usize; 2],
}

/// Number of rays in a fit, per monomial of the largest polynomial that may be chosen.
const RAYS_PER_MONOMIAL: usize = 4;
/// Tolerated sum of the weights' errors, as a fraction of the light.
const LIGHT: f64 = 1e-3;
/// Factor by which polynomials must be cheaper than the exact trace. The relative speeds of the two differ by
/// about this factor between processors of the same kind.
const MARGIN: f64 = 1.15;

impl Candidate {
    /// Returns the cost of a ray through the lens, ns.
    pub fn cost(&self, entry: Entry) -> f64 {
        self.costs[entry as usize]
    }

    /// Returns the sort key of the candidate: the cost, with polynomials multiplied by [`MARGIN`].
    fn rank(&self, entry: Entry) -> f64 {
        let margin = if matches!(self.tracing, Tracing::Polynomials { .. }) { MARGIN } else { 1.0 };
        margin * self.cost(entry)
    }
}

impl Choice {
    /// Tries the candidates in order of increasing cost. Returns the choice, and the tracings for rays one by
    /// one and in batches.
    pub fn of(task: &Task<'_>) -> (Self, [Tracing<Polynomial>; 2]) {
        let unfit = f32_is_fit(task.lens).err();
        let evaluation = Evaluation::new(task);
        let apertures = evaluation.as_ref().map_or(0, |evaluation| evaluation.blocking.len());
        let mut candidates = candidates(task, unfit.is_none(), apertures);
        let rays = RAYS_PER_MONOMIAL * monomials(largest_order(&candidates, unfit.is_none())) + 50;
        let mut trial = Trial { unfit, evaluation, rays, fits: None };
        let mut tracings: Vec<Option<Tracing<Polynomial>>> = vec![None; candidates.len()];
        let chosen = Entry::ALL.map(|entry| {
            let mut order: Vec<usize> = (0..candidates.len()).collect();
            order.sort_by(|&a, &b| candidates[a].rank(entry).total_cmp(&candidates[b].rank(entry)));
            let good_enough = |&number: &usize| {
                let Candidate { tracing, verdict, .. } = &mut candidates[number];
                if *verdict == Verdict::Untried {
                    (*verdict, tracings[number]) = trial.of(*tracing, task.tolerance);
                }
                tracings[number].is_some()
            };
            order.into_iter().find(good_enough).expect("the exact trace in double precision is good enough")
        });
        let chosen_tracings = chosen.map(|number| tracings[number].clone().expect("it is good enough"));
        (Self { tolerance: task.tolerance, candidates, chosen }, chosen_tracings)
    }

    /// Returns the candidate chosen for a kind of call, with its errors.
    pub fn chosen(&self, entry: Entry) -> (&Candidate, Errors) {
        let candidate = &self.candidates[self.chosen[entry as usize]];
        match candidate.verdict {
            Verdict::Within(errors) => (candidate, errors),
            _ => unreachable!("only what is good enough is chosen"),
        }
    }

    /// Describes the choice and its errors in a sentence.
    pub fn sentence(&self) -> String {
        let described = |entry| {
            let (Candidate { tracing, .. }, errors) = self.chosen(entry);
            if *tracing == Tracing::Exact(Precision::F64) {
                return format!("{tracing}, for nothing cheaper stays below it");
            }
            format!(
                "{tracing}; {} % of the rays are within {:.2e} pixels of the exact ones, as measured on {} rays",
                100.0 * QUANTILE,
                errors.pixels,
                errors.rays
            )
        };
        let tolerance = short(self.tolerance);
        let [one, many] = self.chosen;
        if one == many {
            return format!("tolerance {tolerance} pixels: {}", described(Entry::One));
        }
        let [one, many] = Entry::ALL.map(|entry| format!("{entry}: {}", described(entry)));
        format!("tolerance {tolerance} pixels, {one}; {many}")
    }
}

/// State shared by the trials of all candidates.
struct Trial<'a> {
    /// Reason why single precision cannot trace this lens.
    unfit: Option<String>,
    evaluation: Result<Evaluation<'a>, String>,
    /// Number of rays in a fit.
    rays: usize,
    /// Built when the first polynomials are tried.
    fits: Option<Fits>,
}

impl Trial<'_> {
    /// Tries a candidate. Returns its verdict and, if it is accepted, the compiled tracing.
    fn of(&mut self, tracing: Tracing, tolerance: f64) -> (Verdict, Option<Tracing<Polynomial>>) {
        if tracing == Tracing::Exact(Precision::F64) {
            return (Verdict::Within(Errors::NONE), Some(Tracing::Exact(Precision::F64)));
        }
        let evaluation = match &self.evaluation {
            Ok(evaluation) => evaluation,
            Err(why) => return (Verdict::Excluded(why.clone()), None),
        };
        let (compiled, errors) = match (tracing, &self.unfit) {
            (Tracing::Polynomials { order, precision, .. }, _) => {
                let fits = self.fits.get_or_insert_with(|| evaluation.fits(self.rays));
                match fits.order(order) {
                    Err(why) => return (Verdict::Excluded(why.to_string()), None),
                    Ok(fit) => {
                        let errors = evaluation.polynomials(&fit, precision, tolerance);
                        (Tracing::Polynomials { order, precision, fit }, errors)
                    }
                }
            }
            (Tracing::Exact(precision), None) => (Tracing::Exact(precision), evaluation.single(tolerance)),
            (Tracing::Exact(_), Some(unfit)) => return (Verdict::Excluded(unfit.clone()), None),
            (Tracing::Refracted(..), _) => unreachable!("a named refraction is no candidate"),
        };
        match errors {
            Err(too_far_off) => (Verdict::TooFarOff(too_far_off), None),
            Ok(errors) if errors.light > LIGHT => (Verdict::WrongLight(errors), None),
            Ok(errors) => (Verdict::Within(errors), Some(compiled)),
        }
    }
}

/// Returns the largest polynomial order that may be tried before the exact trace; the exact trace uses single
/// precision if the lens is `fit` for it, and otherwise double precision.
fn largest_order(candidates: &[Candidate], fit: bool) -> usize {
    let precision = if fit { Precision::F32 } else { Precision::F64 };
    let exact = candidates.iter().find(|candidate| candidate.tracing == Tracing::Exact(precision));
    let before =
        |candidate: &Candidate, entry| exact.is_some_and(|exact| candidate.rank(entry) < exact.rank(entry));
    let orders = candidates.iter().filter_map(|candidate| match candidate.tracing {
        Tracing::Polynomials { order, .. } if Entry::ALL.iter().any(|&entry| before(candidate, entry)) => {
            Some(order)
        }
        _ => None,
    });
    orders.max().unwrap_or(1)
}

/// Lists every candidate. Polynomials test the given number of apertures and use single precision if the lens
/// is `fit` for it; there are none if rays carry their light, begin on tilted or curved film, or
/// pass a lens that is not symmetric or has mirrors. The exact
/// kernel is listed in both precisions.
fn candidates(task: &Task<'_>, fit: bool, apertures: usize) -> Vec<Candidate> {
    let (simd, surfaces) = (Simd::best(), cost::in_spheres(task.lens));
    let precision = if fit { Precision::F32 } else { Precision::F64 };
    let candidate = |tracing, costs| Candidate { tracing, costs, verdict: Verdict::Untried };
    let is_round = task.film_side.film.is_round() && !task.lens.has_mirror();
    let takes_polynomials = !task.carries_light && is_round;
    let orders = ORDERS.iter().filter(|_| takes_polynomials);
    let polynomials = orders.map(|&order| {
        let cost = |entry| cost::polynomials(simd, entry, precision, monomials(order), apertures);
        candidate(Tracing::Polynomials { order, precision, fit: () }, Entry::ALL.map(cost))
    });
    // On equal costs the stable sort prefers double precision, which comes first.
    let exact = [Precision::F64, Precision::F32].map(|precision| {
        let cost = |entry| cost::exact(simd, entry, precision, surfaces);
        candidate(Tracing::Exact(precision), Entry::ALL.map(cost))
    });
    polynomials.chain(exact).collect()
}

impl Verdict {
    /// Describes the verdict in words.
    pub fn text(&self) -> String {
        match self {
            Self::Within(errors) if errors.rays == 0 => "it is what the others are measured by".to_owned(),
            Self::Within(errors) => format!("{:.2e} pixels", errors.pixels),
            Self::TooFarOff(TooFarOff { beyond, of }) => {
                format!("not good enough: {beyond} of {of} rays are further off")
            }
            Self::WrongLight(errors) => {
                format!("not good enough: {:.2} % of the light is wrong", 100.0 * errors.light)
            }
            Self::Excluded(why) => format!("excluded: {why}"),
            Self::Untried => "not tried: costs no less than the chosen ones".to_owned(),
        }
    }
}

/// Writes the sentence, then a table of the candidates.
impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}\n", self.sentence())?;
        writeln!(
            f,
            "{:<28}{:>11}{:>11}  error: 99.9 % of the rays below",
            "ns/ray*", "one by one", "in batches"
        )?;
        for (number, candidate @ Candidate { tracing, verdict, .. }) in self.candidates.iter().enumerate() {
            let [one, many] = Entry::ALL.map(|entry| {
                let mark = if self.chosen[entry as usize] == number { "> " } else { "" };
                format!("{mark}{:.1}", candidate.cost(entry))
            });
            writeln!(f, "{tracing:<28}{one:>11}{many:>11}  {}", verdict.text())?;
        }
        writeln!(f, "> chosen; * through the lens, on another machine: what they are ordered by")
    }
}
