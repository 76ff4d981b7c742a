//! The cheapest model of a lens whose error stays below a tolerance: measured, not assumed.
//!
//! Candidates are tried from the cheapest on. Each is judged by rays all over the film and its pupil as the
//! camera draws them, against the exact trace in double precision: by the distance on the film by which a ray
//! is off ([`film_error`](crate::imaging::image_scale::ImageScale::film_error)), where a ray that one of the two
//! blocks and the other lets through counts as infinitely far off. What is held below the tolerance is an upper
//! bound of the 99.9 % quantile (by order statistics), and the sum of the weights' errors may be no more than a
//! thousandth of the light.

use std::fmt;

use super::{
    cost,
    judge::{Judge, fit_rays},
    quantile::QUANTILE,
};
use crate::{
    lens::{Lens, single_precision::f32_is_fit},
    message::short,
    trace::polynomial::{ORDERS, Polynomial, monomials},
};

/// A slope and the area in slopes that it stands for.
pub(crate) type Drawn = ([f64; 2], f64);

/// A point of the film, mm, and one of the unit disk.
pub(crate) type Asked = ([f64; 2], [f64; 2]);

/// What a model is wanted for.
pub(crate) struct Task<'a> {
    /// The lens.
    pub lens: &'a Lens,
    /// z of the film, lens space, mm.
    pub film: f64,
    /// Largest film radius in use, mm.
    pub reach: f64,
    /// z of the plane in focus, lens space, mm; may be infinite.
    pub in_focus: f64,
    /// Width of a pixel, mm.
    pub pixel: f64,
    /// The error that is tolerated, pixels; positive.
    pub tolerance: f64,
    /// The film point and the point of the unit disk that a sample's numbers, in [0, 1], stand for.
    pub sample: &'a dyn Fn([f64; 4]) -> Option<Asked>,
    /// What is drawn for them; `None` where the film is dark.
    pub draw: &'a dyn Fn([f64; 2], [f64; 2]) -> Option<Drawn>,
}

/// A way to take rays through the lens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Model {
    /// Every surface, in double precision.
    Double,
    /// Every surface, in single precision.
    Single,
    /// Polynomials of this order; of order 1, the thick lens.
    Polynomials {
        /// The order.
        order: usize,
        /// Evaluated in single precision.
        single: bool,
    },
}

/// The model chosen, ready to be used.
#[derive(Clone, Debug)]
pub(crate) enum Chosen {
    /// Every surface, in double precision.
    Double,
    /// Every surface, in single precision.
    Single,
    /// Polynomials, to be evaluated in single precision or not.
    Polynomials(Polynomial, bool),
}

/// What was found out about a model.
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

/// A model's measured errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Bound of the 99.9 % quantile, pixels; infinite where too many rays are blocked by one and not by the other.
    pub pixels: f64,
    /// Rays looked at.
    pub rays: usize,
    /// Rays that it lets through and the lens does not, or the other way round.
    pub mismatches: usize,
    /// Sum of the errors of the weights over the sum of the weights.
    pub light: f64,
}

/// A model and what became of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// The model.
    pub model: Model,
    /// What a ray costs, ns, by which the candidates are ordered.
    pub cost: f64,
    /// What became of it.
    pub verdict: Verdict,
}

/// The models in the order in which they were tried.
#[derive(Clone, Debug)]
pub struct Choice {
    /// What a ray's error may be, pixels.
    pub tolerance: f64,
    /// Every model that is cheaper than the exact one, and that.
    pub candidates: Vec<Candidate>,
}

/// Rays that polynomials are fitted to, for each of a polynomial's monomials.
const RAYS_A_MONOMIAL: usize = 6;

impl Model {
    /// Its name.
    pub fn name(self) -> String {
        match self {
            Self::Double => "exact, f64".to_owned(),
            Self::Single => "exact, f32".to_owned(),
            Self::Polynomials { order, single } => {
                let numbers = if single { "f32" } else { "f64" };
                match order {
                    1 => format!("thick lens, {numbers}"),
                    _ => format!("polynomials of order {order}, {numbers}"),
                }
            }
        }
    }
}

impl Choice {
    /// Tries the models from the cheapest on; the exact trace in double precision is the last.
    pub(crate) fn of(task: &Task<'_>) -> (Self, Chosen) {
        let simd = crate::trace::kernel::Simd::best();
        let unfit = f32_is_fit(task.lens).err().map(|unfit| unfit.to_string());
        let judge = Judge::new(task);
        let single = unfit.is_none();
        let surfaces = task.lens.surfaces.len();
        let rims = judge.as_ref().map_or(0, |judge| judge.rims.len());
        let exact = cost::kernel(simd, false, surfaces);
        let mut candidates: Vec<Candidate> = ORDERS
            .iter()
            .map(|&order| {
                let cost = cost::polynomials(simd, single, monomials(order), rims);
                (Model::Polynomials { order, single }, cost)
            })
            .chain([(Model::Single, cost::kernel(simd, true, surfaces))])
            .filter(|(_, cost)| *cost < exact)
            .chain([(Model::Double, exact)])
            .map(|(model, cost)| Candidate { model, cost, verdict: Verdict::Untried })
            .collect();
        candidates.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        let mut chosen = None;
        for candidate in &mut candidates {
            let (verdict, found) = match (candidate.model, &judge) {
                (Model::Double, _) => {
                    let none = Errors { pixels: 0.0, rays: 0, mismatches: 0, light: 0.0 };
                    (Verdict::Chosen(none), Some(Chosen::Double))
                }
                (_, Err(why)) => (Verdict::Excluded(why.clone()), None),
                (Model::Single, Ok(judge)) => match &unfit {
                    Some(unfit) => (Verdict::Excluded(unfit.clone()), None),
                    None => {
                        let errors = judge.single();
                        if judge.is_enough(&errors) {
                            (Verdict::Chosen(errors), Some(Chosen::Single))
                        } else {
                            (Verdict::Rejected(errors), None)
                        }
                    }
                },
                (Model::Polynomials { order, single }, Ok(judge)) => {
                    let rays = fit_rays(task, RAYS_A_MONOMIAL * monomials(order) + 50);
                    match judge.polynomials(order, &rays, single) {
                        Err(refused) => (Verdict::Excluded(refused), None),
                        Ok((polynomial, errors)) if judge.is_enough(&errors) => {
                            (Verdict::Chosen(errors), Some(Chosen::Polynomials(polynomial, single)))
                        }
                        Ok((_, errors)) => (Verdict::Rejected(errors), None),
                    }
                }
            };
            candidate.verdict = verdict;
            if found.is_some() {
                chosen = found;
                break;
            }
        }
        (Self { tolerance: task.tolerance, candidates }, chosen.unwrap_or(Chosen::Double))
    }

    /// The model that was chosen, and its errors.
    pub fn chosen(&self) -> Option<(&Candidate, Errors)> {
        self.candidates.iter().find_map(|candidate| match candidate.verdict {
            Verdict::Chosen(errors) => Some((candidate, errors)),
            _ => None,
        })
    }

    /// What was chosen and how far off it is, in a sentence.
    pub fn sentence(&self) -> String {
        let Some((candidate, errors)) = self.chosen() else {
            return String::new();
        };
        let name = candidate.model.name();
        if candidate.model == Model::Double {
            return format!(
                "tolerance {} pixels: {name}, for no cheaper model stays below it",
                short(self.tolerance)
            );
        }
        format!(
            "tolerance {} pixels: {name}; {} % of the rays are within {:.2e} pixels of the exact ones, as measured \
             on {} rays",
            short(self.tolerance),
            100.0 * QUANTILE,
            errors.pixels,
            errors.rays
        )
    }
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

/// The sentence, then a table of the models.
impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}\n", self.sentence())?;
        writeln!(f, "{:<32}{:>9}  error: 99.9 % of the rays below", "model", "ns a ray*")?;
        for Candidate { model, cost, verdict } in &self.candidates {
            writeln!(f, "{:<32}{cost:>9.1}  {}", model.name(), verdict.text())?;
        }
        writeln!(f, "* the figure they are ordered by, of another machine")
    }
}
