//! The parts of the realistic camera: the rear element's disk, the pupil sampler, the factor of the weights,
//! and the tracers. Each is built once from the set-up, with warnings for the user.

use std::{f64::consts::PI, sync::Arc};

use crate::{
    film::Film,
    host::{Level, Log},
    parameters::{CameraError, Pupil, Weighting},
    pipeline::{
        body::CameraBody,
        compile::compile,
        ghosts::{GhostRays, GhostTracer},
        tracer::LensTracer,
    },
    plan::{
        Decision, Kernels, Plan, Precision, Requests, Task, Tracing, describe_requests, describe_sampling,
    },
    sampling::{GivenUp, MapFailure, PosedPupil, PupilDisk, PupilSampler, WarpedPupil},
    setup::{Facts, Setup},
};
use realistic_light::{FilmGhosts, Surfaces};
use realistic_optics::{
    imaging::irradiance::{on_axis, survey},
    prescription::SurfaceCoating,
    trace::Path,
};

/// Fraction of the irradiance that sampling the thick-lens exit pupil may miss without a warning.
const MISSED_SHARE: f64 = 1e-3;
/// Number of rays across the rear element in the survey that estimates this fraction.
const SURVEY_RAYS: u32 = 64;

/// Returns the disk that contains every ray from the film through the rear surface.
pub(super) fn rear_disk(setup: &Setup, film_z: f64) -> Result<PupilDisk, CameraError> {
    let Facts { lens, film, film_distance, .. } = &setup.facts;
    let rear = PupilDisk::rear_of_depth(lens, film_z, film.reach(), film.depth())
        .ok_or_else(|| CameraError::film_in_lens(lens, *film_distance))?;
    // If the film is so near the glass that the pupil fills a hemisphere to the last digit, or if the film is
    // correspondingly large, the pupil's area in slopes, on which the weights are based, leaves the number
    // range.
    representable(rear.slope_area())?;
    Ok(rear)
}

/// Returns the sampler that maps lens samples to the pupil.
pub(super) fn pupil_sampler(
    setup: &Setup,
    path: &Path,
    film_z: f64,
    [rear, exit]: [PupilDisk; 2],
    log: Log<'_>,
) -> PupilSampler {
    let film = &setup.facts.film;
    let of_disk = |disk| match film.is_round() {
        true => PupilSampler::Disk(disk),
        false => PupilSampler::Posed(Arc::new(PosedPupil::of_disk(film.surface(), disk))),
    };
    match setup.pupil {
        Pupil::Rear => {
            if setup.weighting == Weighting::Assignment {
                report_enlarged(rear, clear_area(setup), log);
            }
            of_disk(rear)
        }
        Pupil::Disk => {
            warn_of_missed_share(path, film_z, film, rear, exit, log);
            of_disk(exit)
        }
        Pupil::Warped if film.is_round() => {
            let pupil = WarpedPupil::new(path, film_z, film.reach(), [rear, exit]);
            report_given_up(&pupil, film, log);
            PupilSampler::Warped(Arc::new(pupil))
        }
        Pupil::Warped => {
            let pupil = PosedPupil::new(path, film_z, film.surface(), film.rectangle(), [rear, exit]);
            report_covered(pupil.covered(), log);
            PupilSampler::Posed(Arc::new(pupil))
        }
    }
}

/// Returns the area of the rear element's clear aperture as given in the lens table, mm².
fn clear_area(setup: &Setup) -> f64 {
    PI * setup.facts.lens.rear().semi_diameter.powi(2)
}

/// Reports the factor by which the sampled disk exceeds the rear element's disk, because a reader of the
/// assignment expects the rear element's disk.
fn report_enlarged(rear: PupilDisk, clear_area: f64, log: Log<'_>) {
    let ratio = rear.area().map_or(1.0, |area| area / clear_area);
    if ratio > 1.0 + 1e-12 {
        log(
            Level::Info,
            &format!(
                "pupil \"rear\": a disk of {ratio:.4} times the rear element's area is sampled, so that no ray of this film is \
                 missed, and a weight of \"assignment\" is {ratio:.4} cos⁴/Z²; divide by {ratio:.4} for the formula itself"
            ),
        );
    }
}

/// Returns the factor from the product of a ray's cos⁴ and slope area to its weight; `None` for weight 1.
pub(super) fn weight_factor(
    setup: &Setup,
    path: &Path,
    film_z: f64,
    sampler: &PupilSampler,
    [rear, exit]: [PupilDisk; 2],
) -> Result<Option<f64>, CameraError> {
    let radiance_factor = setup.facts.lens.radiance_factor();
    let weight = match setup.weighting {
        Weighting::Radiometric => Some(setup.exposure * radiance_factor),
        Weighting::Assignment => {
            let area = match setup.pupil {
                // The sampled disk grows with the film, but exposure must not depend on the film's size.
                Pupil::Rear => clear_area(setup),
                Pupil::Disk | Pupil::Warped => exit.area().ok_or(CameraError::PupilAtInfinity)?,
            };
            Some(radiance_factor / area)
        }
        Weighting::Relative => {
            // Averaging over the disk in use makes the mean weight on the axis 1 for either pupil.
            let reach = sampler.disk().unwrap_or(&rear).seen_from([0.0; 2]).radius;
            let mean = on_axis(path, film_z, reach);
            if mean <= 0.0 {
                return Err(CameraError::DarkAxis { lens: setup.facts.lens.name.clone() });
            }
            Some(mean.recip())
        }
        Weighting::None => None,
    };
    let largest = sampler.disk().unwrap_or(&rear).slope_area();
    // The factor times π must fit by itself, too, because single precision multiplies it by areas over π.
    representable(weight.map_or(1.0, |weight| (weight * largest).max(weight * PI)))?;
    Ok(weight)
}

/// Returns the coatings of the surfaces if weights include the lens's transmission.
pub(super) fn weighted_coatings(setup: &Setup, log: Log<'_>) -> Option<Arc<[SurfaceCoating]>> {
    let coatings = setup.coatings.as_ref()?;
    if setup.weighting == Weighting::None {
        log(Level::Warning, "\"transmission\" changes nothing where \"weighting\" is \"none\"");
        return None;
    }
    Some(coatings.as_slice().into())
}

/// The tracers of a camera's rays.
#[derive(Clone, Debug)]
pub(super) struct Tracers {
    /// Traces rays one by one, or with their differentials.
    pub one: Arc<dyn LensTracer>,
    /// Traces batches with the same tracer, unless a tolerance allows a faster one.
    pub many: Arc<dyn LensTracer>,
    /// Precision of rays with wavelengths of their own, which are traced exactly.
    pub exact: Precision,
}

impl Tracers {
    /// Adds ghosts, which a share of the samples follows.
    pub fn with_ghosts(self, ghosts: &Arc<GhostRays>) -> Self {
        let [one, many] = [self.one, self.many].map(|direct| -> Arc<dyn LensTracer> {
            Arc::new(GhostTracer::new(direct, ghosts.clone(), None))
        });
        Self { one, many, ..self }
    }
}

/// Returns the ghost rays, whose paths have two reflections, if a share of the samples is to follow them.
pub(super) fn ghost_rays(
    setup: &Setup,
    rear: PupilDisk,
    body: &CameraBody,
    log: Log<'_>,
) -> Option<Arc<GhostRays>> {
    let (Facts { lens, film, .. }, coatings) = (&setup.facts, setup.coatings.as_ref()?);
    if setup.ghosts == 0.0 {
        return None;
    }
    if body.weight.is_none() {
        log(
            Level::Warning,
            "\"ghosts\" changes nothing where \"weighting\" is \"none\": they would weigh as much as the direct light",
        );
        return None;
    }
    let surfaces = Surfaces::of_each(lens, coatings);
    let cover = |point| rear.seen_from(point);
    let ghosts = FilmGhosts::new(lens, &surfaces, body.film_side.z, film.reach(), cover)?;
    let [pairs, surveyed] = [ghosts.count(), ghosts.surveyed()];
    let alike = percent(ghosts.alike());
    let rays = GhostRays::new(setup.ghosts, ghosts, rear, body);
    let passed = percent(rays.acceptance());
    log(
        Level::Info,
        &if surveyed < pairs {
            format!(
                "\"ghosts\": {pairs} pairs of surfaces, of which {surveyed} are as many as building a camera looks for; \
                 {alike} % of their samples go to all pairs alike, and {passed} % get through: the picture is right, but noisier"
            )
        } else {
            format!("\"ghosts\": {pairs} pairs of surfaces; of their samples {passed} % get through")
        },
    );
    Some(Arc::new(rays))
}

/// Decides how rays are traced, compiles the tracers, and returns them with the plan.
pub(super) fn plan_and_compile(
    setup: &Setup,
    path: &Path,
    body: &CameraBody,
    log: Log<'_>,
) -> (Tracers, Plan) {
    let (lens, kernels) = (&setup.facts.lens, Kernels::new(path));
    let mut plan = Plan::default();
    let task = Task {
        lens,
        path,
        kernels: &kernels,
        film_side: &body.film_side,
        in_focus: body.film_side.z + setup.facts.focus_distance_mm.unwrap_or(f64::INFINITY),
        refraction: setup.refraction,
        precision: setup.precision,
        tolerance: setup.tolerance,
        leave_out: setup.leave_out,
        carries_light: body.coatings.is_some(),
    };
    let decision = Decision::of(&task, &mut plan);
    for warning in &decision.warnings {
        log(Level::Warning, warning);
    }
    if let Some(choice) = plan.choice() {
        log(Level::Info, &choice.sentence());
    }
    let traces = |tracing| compile(tracing, lens, path, &kernels, body);
    let one = traces(&decision.one);
    let many = decision.many.as_ref().map_or_else(|| one.clone(), traces);
    describe_sampling(&body.film_side, &mut plan);
    let requests = Requests {
        wavelength: setup.is_dispersive().then_some(lens.wavelength),
        transmission: setup.coatings.is_some(),
        ghosts: setup.ghosts > 0.0,
        picture: lens.picture().is_some(),
    };
    describe_requests(&requests, &mut plan);
    body.placement.describe(&mut plan);
    let exact = match decision.many.as_ref().unwrap_or(&decision.one) {
        // The error of polynomials in single precision does not predict the error of an exact trace in single
        // precision.
        Tracing::Polynomials { .. } => Precision::F64,
        Tracing::Exact(precision) | Tracing::Refracted(_, precision) => *precision,
    };
    (Tracers { one, many, exact }, plan)
}

/// Checks that a weight fits in a float, the type that hosts accept.
pub(super) fn representable(weight: f64) -> Result<(), CameraError> {
    if (weight as f32).is_finite() { Ok(()) } else { Err(CameraError::Weight { weight }) }
}

/// Width of a ring of film, relative to the film's radius, below which noise in the ring goes unnoticed.
const NARROW: f64 = 1e-3;

/// Reports the ranges of film radii for which the warped pupil was given up, with the reason and the share of
/// samples that still pass.
fn report_given_up(pupil: &WarpedPupil, film: &Film, log: Log<'_>) {
    let lit_radius = pupil.image_radius().unwrap_or(film.reach());
    let corner = film.corner();
    for &GivenUp { radii: [from, to], reason, acceptance } in pupil.given_up() {
        let (what, why) = match reason {
            MapFailure::LightBeside => {
                ("the rear element's disk", "light gets through there in pieces far apart")
            }
            MapFailure::NoLight => ("the rear element's disk", "no light was found there"),
            MapFailure::Gaps => ("a larger shape", "the pupil there has gaps, or changes fast"),
        };
        let left = if acceptance > 0.0 {
            let share = percent(acceptance);
            format!("of its samples {share} % or more get through: the picture is right, but noisier there")
        } else {
            "of its samples none of those tried got through: the film is dark there, or speckled".to_owned()
        };
        let diagonal = film.diagonal_within(from);
        let advice = match acceptance > 0.0 {
            false if diagonal > 0.0 => format!("\"film_diagonal\" up to {diagonal:.2} avoids it"),
            true if diagonal > 0.0 => {
                format!("more samples per pixel there, or \"film_diagonal\" up to {diagonal:.2}, avoid it")
            }
            _ => "more samples per pixel make up for it".to_owned(),
        };
        // Noise goes unnoticed in so narrow a ring. It also does in a ring outside the picture, where only
        // the reconstruction filter requests rays: the ring is a few pixels wide, which is a large width only
        // if the image has few pixels.
        let level = if to.min(corner) - from < NARROW * lit_radius { Level::Info } else { Level::Warning };
        log(
            level,
            &format!(
                "pupil \"warped\": from {from:.2} to {to:.2} mm from the axis {what} is sampled in the pupil's place, \
                 because {why}; {left}; {advice}"
            ),
        );
    }
}

/// Reports the fraction of a tilted or curved film for which the rear element's disk is sampled.
fn report_covered(covered: f64, log: Log<'_>) {
    if covered > 0.0 {
        log(
            Level::Info,
            &format!(
                "pupil \"warped\": over {} % of the film the rear element's disk is sampled in the pupil's place, because it \
                 is dark there, or light gets through in pieces far apart; the picture is right, but noisier there",
                percent(covered)
            ),
        );
    }
}

/// Formats a share as a percentage, with two decimals if it is less than 1 %.
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent < 1.0 { format!("{percent:.2}") } else { format!("{percent:.0}") }
}

fn warn_of_missed_share(
    path: &Path,
    film_z: f64,
    film: &Film,
    rear: PupilDisk,
    disk: PupilDisk,
    log: Log<'_>,
) {
    let missed = |height: f64| {
        let point = [0.0, height];
        let cover = rear.seen_from(point);
        let survey = survey(path, film_z, point, cover, disk.seen_from(point), SURVEY_RAYS);
        if survey.irradiance > 0.0 { 1.0 - survey.inside / survey.irradiance } else { 0.0 }
    };
    let corner = film.corner();
    let [axis, middle, edge] = [0.0, 0.5, 1.0].map(|field| missed(field * corner));
    if axis.max(middle).max(edge) > MISSED_SHARE {
        log(
            Level::Warning,
            &format!(
                "pupil \"disk\" misses part of the true pupil: {:.1} % of the light on the axis, {:.1} % \
                 half way to the corner, {:.1} % in the corner; pupil \"warped\" misses none",
                100.0 * axis,
                100.0 * middle,
                100.0 * edge
            ),
        );
    }
}
