//! The cheapest way to trace a lens whose error stays below a tolerance: measured, not assumed.
//!
//! Candidates are tried from the cheapest on. Each is evaluated on rays all over the film and its pupil as the
//! camera samples them, against the exact trace in double precision: by the distance on the film by which a ray
//! is off ([`film_error`](crate::imaging::image_scale::ImageScale::film_error)), where a ray that one of the two
//! blocks and the other lets through counts as infinitely far off. What is held below the tolerance is an upper
//! bound of the 99.9 % quantile (by order statistics), and the sum of the weights' errors may be no more than a
//! thousandth of the light.

use std::fmt;

use super::{
    cost,
    evaluate::{Errors, Evaluation, fit_rays},
    quantile::QUANTILE,
    task::Task,
    tracing::{Precision, Tracing},
};
use crate::{
    lens::single_precision::f32_is_fit,
    message::short,
    trace::{
        kernel::Simd,
        polynomial::{ORDERS, Polynomial, monomials},
    },
};

/// What was found out about a candidate.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// The cheapest that is good enough.
    Chosen(Errors),
    /// Its errors are too large.
    Rejected(Errors),
    /// It is not to be had for this lens; why.
    Excluded(String),
    /// One that costs no more was chosen.
    Untried,
}

/// A way to trace, and what became of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// The way.
    pub tracing: Tracing,
    /// What it costs, ns per ray, by which the candidates are ordered.
    pub cost: f64,
    /// What became of it.
    pub verdict: Verdict,
}

/// The candidates in the order in which they were tried.
#[derive(Clone, Debug)]
pub struct Choice {
    /// What a ray's error may be, pixels.
    pub tolerance: f64,
    /// Every way that is cheaper than the exact trace in double precision, and that.
    pub candidates: Vec<Candidate>,
}

/// Rays that polynomials are fitted to, for each of a polynomial's monomials.
const RAYS_PER_MONOMIAL: usize = 6;
/// What the weights' errors may sum up to, as a part of the light.
const LIGHT: f64 = 1e-3;

impl Choice {
    /// Tries the candidates from the cheapest on; the exact trace in double precision is the last.
    pub(crate) fn of(task: &Task<'_>) -> (Self, Tracing<Polynomial>) {
        let unfit = f32_is_fit(task.lens).err().map(|unfit| unfit.to_string());
        let evaluation = Evaluation::new(task);
        let apertures = evaluation.as_ref().map_or(0, |evaluation| evaluation.blocking.len());
        let mut candidates = candidates(task, unfit.is_none(), apertures);
        let mut chosen = Tracing::Exact(Precision::F64);
        for candidate in &mut candidates {
            let found = match (candidate.tracing, &evaluation) {
                (Tracing::Exact(Precision::F64), _) => Ok((Tracing::Exact(Precision::F64), Errors::NONE)),
                (_, Err(why)) => Err(why.clone()),
                (Tracing::Exact(Precision::F32), Ok(evaluation)) => match &unfit {
                    Some(unfit) => Err(unfit.clone()),
                    None => Ok((Tracing::Exact(Precision::F32), evaluation.single())),
                },
                (Tracing::Polynomials { order, precision, .. }, Ok(evaluation)) => {
                    let rays = fit_rays(task.film_side, RAYS_PER_MONOMIAL * monomials(order) + 50);
                    evaluation
                        .polynomials(order, &rays, precision)
                        .map(|(fit, errors)| (Tracing::Polynomials { order, precision, fit }, errors))
                }
                (Tracing::Refracted(..), _) => unreachable!("a named refraction is no candidate"),
            };
            candidate.verdict = match found {
                Err(why) => Verdict::Excluded(why),
                Ok((tracing, errors)) if errors.pixels <= task.tolerance && errors.light <= LIGHT => {
                    chosen = tracing;
                    Verdict::Chosen(errors)
                }
                Ok((_, errors)) => Verdict::Rejected(errors),
            };
            if matches!(candidate.verdict, Verdict::Chosen(_)) {
                break;
            }
        }
        (Self { tolerance: task.tolerance, candidates }, chosen)
    }

    /// The candidate that was chosen, and its errors.
    pub fn chosen(&self) -> Option<(&Candidate, Errors)> {
        self.candidates.iter().find_map(|candidate| match candidate.verdict {
            Verdict::Chosen(errors) => Some((candidate, errors)),
            _ => None,
        })
    }

    /// What was chosen and how far off it is, as a sentence.
    pub fn sentence(&self) -> String {
        let Some((candidate, errors)) = self.chosen() else {
            return String::new();
        };
        let tracing = candidate.tracing;
        if tracing == Tracing::Exact(Precision::F64) {
            return format!(
                "tolerance {} pixels: {tracing}, for no cheaper model stays below it",
                short(self.tolerance)
            );
        }
        format!(
            "tolerance {} pixels: {tracing}; {} % of the rays are within {:.2e} pixels of the exact ones, as measured \
             on {} rays",
            short(self.tolerance),
            100.0 * QUANTILE,
            errors.pixels,
            errors.rays
        )
    }
}

/// Every candidate by its cost: polynomials in single precision where that is `fit` for the lens, with so many
/// apertures that block rays, and the kernel in either precision.
fn candidates(task: &Task<'_>, fit: bool, apertures: usize) -> Vec<Candidate> {
    let (simd, surfaces) = (Simd::best(), task.lens.surfaces.len());
    let precision = if fit { Precision::F32 } else { Precision::F64 };
    let exact = cost::kernel(simd, Precision::F64, surfaces);
    let polynomials = ORDERS.iter().map(|&order| {
        let cost = cost::polynomials(simd, precision, monomials(order), apertures);
        (Tracing::Polynomials { order, precision, fit: () }, cost)
    });
    let single = (Tracing::Exact(Precision::F32), cost::kernel(simd, Precision::F32, surfaces));
    let mut candidates: Vec<Candidate> = polynomials
        .chain([single])
        .filter(|(_, cost)| *cost < exact)
        .chain([(Tracing::Exact(Precision::F64), exact)])
        .map(|(tracing, cost)| Candidate { tracing, cost, verdict: Verdict::Untried })
        .collect();
    candidates.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    candidates
}

impl Verdict {
    /// In words.
    pub fn text(&self) -> String {
        let measured = |errors: &Errors| {
            if errors.pixels.is_finite() {
                format!("{:.2e} pixels", errors.pixels)
            } else {
                format!("{} of {} rays blocked by one only", errors.mismatches, errors.rays)
            }
        };
        match self {
            Self::Chosen(errors) if errors.rays == 0 => {
                "chosen: it is what the others are measured by".to_owned()
            }
            Self::Chosen(errors) => format!("chosen: {}", measured(errors)),
            Self::Rejected(errors) => format!("not good enough: {}", measured(errors)),
            Self::Excluded(why) => format!("excluded: {why}"),
            Self::Untried => "not tried: costs no less than the chosen one".to_owned(),
        }
    }
}

/// The sentence, then a table of the candidates.
impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}\n", self.sentence())?;
        writeln!(f, "{:<32}{:>9}  error: 99.9 % of the rays below", "model", "ns/ray*")?;
        for Candidate { tracing, cost, verdict } in &self.candidates {
            writeln!(f, "{tracing:<32}{cost:>9.1}  {}", verdict.text())?;
        }
        writeln!(f, "* the figure they are ordered by, of another machine")
    }
}
