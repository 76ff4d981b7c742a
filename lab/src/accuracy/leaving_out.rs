//! The time saved by the simplifications that a tolerance permits: times per ray of the same camera with everything
//! kept and with a tolerance, for which the planner may choose another model. The two cameras are timed in turns.

use realistic_camera::{
    Camera, CameraError, Host, Parameters, Precision,
    plan::{Choice, Entry, Tracing},
};

use crate::{
    BLOCK,
    results::{
        statistics::median,
        table::{Table, row},
    },
    subject::{FILM_DIAGONAL, PIXELS, STOPPED_DOWN},
    timing::{
        Effort, Timing,
        camera_calls::{in_one_call, one_by_one, samples},
        interleaved, repeated,
    },
};

/// Tolerances of the cameras, pixels.
pub const TOLERANCES: [f64; 3] = [1.0, 0.1, 0.01];

/// The saving of one camera with one kind of call.
#[derive(Clone, Debug)]
pub struct Saving {
    /// The lens.
    pub lens: String,
    /// Whether the stop is at f/8 ([`STOPPED_DOWN`]) rather than wide open.
    pub stopped_down: bool,
    /// The kind of call.
    pub entry: Entry,
    /// The precision or the tolerance requested.
    pub request: Asked,
    /// The model and the precision with which the camera traces.
    pub tracing: Tracing,
    /// The plan's estimate of the 99.9 % quantile of the error, an upper bound, pixels; `None` if single precision was
    /// requested.
    pub pixels: Option<f64>,
    /// Time per ray with everything kept, seconds: in the precision requested, or in double precision if a tolerance
    /// was requested.
    pub kept: Timing,
    /// Time per ray of the camera that follows its plan.
    pub left_out: Timing,
    /// Repeated timing of the camera with everything kept, as another task of the same run.
    pub again: Timing,
    /// Times, seconds, to build the camera that follows its plan and the camera with everything kept.
    pub build: [f64; 2],
}

/// The request made of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Asked {
    /// A precision.
    Precision(Precision),
    /// A tolerance, pixels.
    Tolerance(f64),
}

impl std::fmt::Display for Asked {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Precision(precision) => write!(f, "{precision}"),
            Self::Tolerance(pixels) => write!(f, "tolerance {pixels}"),
        }
    }
}

impl Saving {
    /// Returns the share of the time that is saved, at the lower quartile, the median and the upper quartile, the least
    /// first; a negative share is a loss.
    pub fn share(&self) -> [f64; 3] {
        [self.left_out.high, self.left_out.median, self.left_out.low]
            .map(|time| 1.0 - time / self.kept.median)
    }

    /// Returns a description of the stop.
    pub fn stop(&self) -> String {
        if self.stopped_down { format!("f/{STOPPED_DOWN}") } else { "wide open".to_owned() }
    }
}

/// Builds a camera focused at infinity on the film of every subject.
fn camera(lens: &str, fnumber: Option<f64>, request: Asked, leave_out: bool) -> Result<Camera, CameraError> {
    let (precision, tolerance) = match request {
        Asked::Precision(precision) => (Some(Some(precision)), None),
        Asked::Tolerance(tolerance) => (None, Some(tolerance)),
    };
    let parameters = Parameters {
        lens_file: Some(lens.to_owned()),
        film_diagonal: Some(FILM_DIAGONAL),
        focus_distance: Some(f64::INFINITY),
        precision,
        tolerance,
        fnumber,
        ..Parameters::default()
    };
    let host = Host { leave_out, ..Host::new(PIXELS, None) };
    Camera::build(&parameters, &host, &mut |_, _| {})
}

/// Number of builds of a camera; the median of their times is reported.
const BUILDS: usize = 5;

/// Measures both precisions and every tolerance on a lens, wide open and stopped down, in blocks and one by one.
///
/// # Errors
/// A camera cannot be built.
pub fn measure(lens: &str, effort: Effort) -> Result<Vec<Saving>, CameraError> {
    use Asked::{Precision as In, Tolerance};
    let samples = samples(BLOCK, PIXELS, 0.5);
    let mut savings = Vec::new();
    for (stopped_down, fnumber) in [(false, None), (true, Some(STOPPED_DOWN))] {
        // Cameras with everything kept are measured twice in each precision; the difference shows the uncertainty of a
        // time.
        let references = [Precision::F64, Precision::F64, Precision::F32, Precision::F32].map(In);
        let requested = [Precision::F64, Precision::F32].map(In).into_iter().chain(TOLERANCES.map(Tolerance));
        let requests: Vec<(Asked, bool)> =
            references.into_iter().map(|of| (of, false)).chain(requested.map(|of| (of, true))).collect();
        let built = requests.iter().map(|&(request, leave_out)| {
            let (camera, times) = repeated(BUILDS, || camera(lens, fnumber, request, leave_out));
            Ok((camera?, median(&times)))
        });
        let built: Vec<(Camera, f64)> = built.collect::<Result<_, CameraError>>()?;
        for entry in Entry::ALL {
            let work = |camera: &Camera| match entry {
                Entry::Many => in_one_call(&samples, |samples, rays| camera.trace(samples, rays)),
                Entry::One => one_by_one(&samples, |sample| camera.ray(sample).map(|(_, weight)| weight)),
            };
            let tasks = built.iter().map(|(camera, _)| Box::new(move || work(camera)) as Box<dyn FnMut()>);
            let times: Vec<Timing> =
                interleaved(tasks, effort).into_iter().map(|time| time.per(BLOCK)).collect();
            for (number, &(request, _)) in requests.iter().enumerate().skip(references.len()) {
                let (camera, build) = &built[number];
                let (tracing, pixels) = traced(camera.plan().choice(), request, entry);
                let first = if request == In(Precision::F32) { 2 } else { 0 };
                savings.push(Saving {
                    lens: lens.to_owned(),
                    stopped_down,
                    entry,
                    request,
                    tracing,
                    pixels,
                    kept: times[first],
                    left_out: times[number],
                    again: times[first + 1],
                    build: [*build, built[first].1],
                });
            }
        }
    }
    Ok(savings)
}

/// Returns the tracing of a camera, and the bound of its error.
fn traced(choice: Option<&Choice>, request: Asked, entry: Entry) -> (Tracing, Option<f64>) {
    match (choice, request) {
        (Some(choice), Asked::Tolerance(_)) => {
            let (candidate, errors) = choice.chosen(entry);
            (candidate.tracing, Some(errors.pixels))
        }
        (_, Asked::Precision(Precision::F32)) => (Tracing::Exact(Precision::F32), None),
        _ => (Tracing::Exact(Precision::F64), Some(0.0)),
    }
}

/// Returns the results as a table.
pub fn table(results: &[Saving]) -> Table {
    let columns = "lens stop called asked_for traced_by stated_error_pixels kept_ns left_out_ns saved_low saved saved_high \
                   build_ms build_kept_ms";
    let rows = results.iter().map(|saving| {
        let names =
            [saving.stop(), saving.entry.to_string(), saving.request.to_string(), saving.tracing.to_string()];
        let mut cells = row![saving.lens.as_str()];
        cells.extend(names.iter().map(|name| name.as_str().into()));
        cells.push(saving.pixels.map_or_else(|| "not stated".into(), Into::into));
        cells.extend([saving.kept, saving.left_out].map(|time| (time.median * 1e9).into()));
        cells.extend(saving.share().map(Into::into));
        cells.extend(saving.build.map(|time| (time * 1e3).into()));
        cells
    });
    Table::of("leaving-out", columns, rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn every_camera_says_what_it_traces_by_and_keeps_its_tolerance() {
        let effort = Effort { rounds: 1, least: Duration::from_micros(20) };
        let savings = measure("dgauss.50mm", effort).expect("cameras");
        assert_eq!(savings.len(), 2 * 2 * (2 + TOLERANCES.len()));
        for saving in &savings {
            let [low, median, high] = saving.share();
            assert!(low <= median && median <= high && high < 1.0, "{saving:?}");
            assert!(saving.again.median > 0.0 && saving.build.iter().all(|&time| time > 0.0));
            match saving.request {
                Asked::Tolerance(pixels) => {
                    assert!(saving.pixels.is_some_and(|error| error <= pixels), "{saving:?}")
                }
                Asked::Precision(precision) => assert_eq!(saving.tracing, Tracing::Exact(precision)),
            }
        }
        // The table must agree with the planner for the same lens, film and stop.
        let parameters = Parameters {
            lens_file: Some("dgauss.50mm".to_owned()),
            film_diagonal: Some(FILM_DIAGONAL),
            focus_distance: Some(f64::INFINITY),
            fnumber: Some(STOPPED_DOWN),
            tolerance: Some(1.0),
            ..Parameters::default()
        };
        let camera = Camera::build(&parameters, &Host::new(PIXELS, None), &mut |_, _| {}).expect("a camera");
        let plan = camera.plan();
        let (candidate, _) = plan.choice().expect("a tolerance").chosen(Entry::One);
        let own = savings.iter().find(|saving| {
            saving.stopped_down && saving.entry == Entry::One && saving.request == Asked::Tolerance(1.0)
        });
        assert_eq!(own.expect("measured").tracing, candidate.tracing);
    }
}
