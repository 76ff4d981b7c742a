//! What a plan says of sampling, and of what a camera makes only when asked for.

use super::{items::Plan, task::FilmSide};
use crate::{
    message::fixed,
    sampling::{DiskMapping, PupilSampler},
};

/// Adds to a plan what is kept and left out of sampling, and what is made only when asked for. The wavelength in nm.
pub(crate) fn describe_sampling(side: &FilmSide, wavelength: f64, plan: &mut Plan) {
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
                format!("{} film radii, {} rays", report.slices, report.rays),
            );
            if pupil.image_radius().is_some_and(|end| end < side.film.reach()) {
                plan.left_out(
                    &format!("pupil of film beyond {} mm", fixed(end, 3)),
                    "no light reaches it",
                    "weight 0 for the price of a comparison",
                );
            }
        }
        PupilSampler::Disk(_) => {
            plan.left_out("pupil table", "a disk is sampled", "no time to build it");
        }
    }
    if side.mapping == DiskMapping::Rejection {
        plan.kept("asking again", "disk \"rejection\"", "some samples are asked for twice");
    }
    plan.left_out(
        "dispersion",
        format!("one wavelength, {wavelength} nm, is asked for"),
        "each surface has one index",
    );
    plan.left_out("differentials", "traced only for a host that asks three times per sample", "no time");
    plan.left_out(
        "reasons of blocked rays",
        "found by a second trace of those that a caller asks about",
        "no time",
    );
    plan.left_out("statistics", "nothing counts rays", "no time");
}
