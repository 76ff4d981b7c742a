//! All measurements of a report, at two sizes.

use std::{ops::ControlFlow, time::Duration};

use thiserror::Error;

use realistic_camera::{CameraError, Raster};
use realistic_optics::{imaging::focus::FocusError, prescription::catalogue};

use super::{
    curve::Curve,
    irradiance::{self, SampleCounts},
    leaving_out::{self, Asked},
    pupils::{self, PupilCounts},
    ray_map::{self, RayCounts},
    set_up::{self, FitCounts},
    vignetting,
};
use crate::{
    accuracy::pictures,
    results::{
        statistics::quantile,
        table::{Table, row},
    },
    stability::{self, CaseResult, Reason, tracers},
    subject::Subject,
    timing::Effort,
};

/// The lenses of a report.
pub const LENSES: [&str; 4] = ["dgauss.50mm", "wide.22mm", "telephoto.250mm", "fisheye.10mm"];

/// The extent of every measurement of a report.
#[derive(Clone, Debug)]
pub struct Suite {
    /// Lenses, by their names in the catalogue.
    pub lenses: Vec<&'static str>,
    /// Extent of the ray map.
    pub ray_map: RayCounts,
    /// Extent of the film irradiance.
    pub irradiance: SampleCounts,
    /// Extent of the rendered pictures.
    pub picture: pictures::Size,
    /// Extent of the set-up.
    pub set_up: FitCounts,
    /// Extent of the pupil tables.
    pub pupils: PupilCounts,
    /// Extent of the stability cases.
    pub stability: stability::Extent,
}

impl Suite {
    /// Returns the extent of a run for published figures, which takes minutes. The pictures show `scene`.
    pub fn full(scene: pictures::Scene) -> Self {
        let effort = Effort { rounds: 31, least: Duration::from_millis(3) };
        let raster = Raster { xres: 72, yres: 48 };
        Self {
            lenses: LENSES.to_vec(),
            ray_map: RayCounts { rays: 20_000, block: 2048, effort },
            irradiance: SampleCounts { exponent: 7, repeats: 24, survey: 2000, effort },
            picture: pictures::Size { scene, raster, exponent: 4, reference: 4096, repeats: 3 },
            set_up: FitCounts { rays: 5000, repeats: 9 },
            pupils: PupilCounts { points: 48, repeats: 5 },
            stability: stability::Extent::FULL,
        }
    }

    /// Returns the extent of a quick run, which takes less than a minute. The pictures show `scene`.
    pub fn quick(scene: pictures::Scene) -> Self {
        let effort = Effort { rounds: 7, least: Duration::from_micros(400) };
        let raster = Raster { xres: 36, yres: 24 };
        Self {
            lenses: LENSES.to_vec(),
            ray_map: RayCounts { rays: 3000, block: 1024, effort },
            irradiance: SampleCounts { exponent: 5, repeats: 8, survey: 500, effort },
            picture: pictures::Size { scene, raster, exponent: 3, reference: 512, repeats: 1 },
            set_up: FitCounts { rays: 600, repeats: 2 },
            pupils: PupilCounts { points: 8, repeats: 1 },
            stability: stability::Extent::QUICK,
        }
    }

    /// Runs all measurements. `progress` receives the name of each step.
    ///
    /// # Errors
    /// A lens cannot be focused, or a camera cannot be built.
    pub fn run(&self, progress: &mut dyn FnMut(&str)) -> Result<Results, SuiteError> {
        let mut results = Results::default();
        for &name in &self.lenses {
            let mut tell = |what: &str| progress(&format!("{name}: {what}"));
            let prescription = catalogue::find(name).ok_or(SuiteError::Unknown(name))?;
            let subject = Subject::new(&prescription)?;
            tell("ray map");
            results.ray_map.extend(ray_map::measure(&subject, self.ray_map, true));
            tell("ray map, stopped down");
            let stopped_down = Subject::stopped_down(&prescription)?;
            results.stopped_down.extend(ray_map::measure(&stopped_down, self.ray_map, false));
            tell("vignetting");
            results.vignetting.extend(vignetting::measure(&subject, self.ray_map));
            tell("leaving out");
            results.leaving_out.extend(leaving_out::measure(name, self.ray_map.effort)?);
            tell("film irradiance");
            let (curves, again) = irradiance::measure(&subject, self.irradiance)?;
            results.irradiance.extend(curves);
            results.irradiance_again.extend(again);
            tell("pictures");
            let pictures = pictures::measure(&subject, self.picture)?;
            results.estimators.extend(pictures.estimators);
            results.renderers.extend(pictures.renderers);
            results.renderers_again.extend(pictures.again);
            results.floors.push((name, pictures.floor));
            tell("set-up");
            results.set_up.extend(set_up::measure(&subject, self.set_up));
            tell("pupils");
            results.pupils.extend(pupils::measure(&subject, self.pupils));
            results.lenses.push(name);
        }
        results.stability = stability::run(self.stability, &mut |at| {
            progress(&format!("stability: {} ({:.0} %)", at.name, 100.0 * at.done));
            ControlFlow::Continue(())
        });
        Ok(results)
    }
}

/// An error that prevents a report.
#[derive(Debug, Error)]
pub enum SuiteError {
    /// A lens is not in the catalogue.
    #[error("the catalogue has no lens \"{0}\"")]
    Unknown(&'static str),
    /// A lens cannot be focused at infinity.
    #[error(transparent)]
    Focus(#[from] FocusError),
    /// A camera cannot be built.
    #[error(transparent)]
    Camera(#[from] CameraError),
}

/// Results of all measurements, lens after lens.
#[derive(Clone, Debug, Default)]
pub struct Results {
    /// The lenses.
    pub lenses: Vec<&'static str>,
    /// Errors and times of rays.
    pub ray_map: Vec<ray_map::RayErrors>,
    /// Errors and times of rays with the stop at f/8 ([`STOPPED_DOWN`](crate::subject::STOPPED_DOWN)), without the slow
    /// walks.
    pub stopped_down: Vec<ray_map::RayErrors>,
    /// Errors of vignetting.
    pub vignetting: Vec<vignetting::Vignetting>,
    /// Time saved by plans.
    pub leaving_out: Vec<leaving_out::Saving>,
    /// Estimates of film irradiance.
    pub irradiance: Vec<Curve>,
    /// Repeats of some estimates of film irradiance.
    pub irradiance_again: Vec<Curve>,
    /// Pictures by sampler and sequence.
    pub estimators: Vec<Curve>,
    /// Pictures by renderer.
    pub renderers: Vec<Curve>,
    /// Repeats of some pictures by renderer.
    pub renderers_again: Vec<Curve>,
    /// Errors of the reference pictures themselves.
    pub floors: Vec<(&'static str, f64)>,
    /// Accuracy and build times of polynomials.
    pub set_up: Vec<set_up::Fit>,
    /// Coverage and build times of pupils.
    pub pupils: Vec<pupils::Coverage>,
    /// Results of the stability cases.
    pub stability: Vec<CaseResult>,
}

impl Results {
    /// Returns every table, in the order of the report.
    pub fn tables(&self) -> Vec<Table> {
        vec![
            ray_map::table("ray-map", &self.ray_map, self.ties().times.ratio),
            ray_map::table("stopped-down", &self.stopped_down, self.ties().times.ratio),
            vignetting::table(&self.vignetting),
            leaving_out::table(&self.leaving_out),
            irradiance::table(&self.irradiance),
            pictures::table(
                "estimators",
                "lens pupil sequence samples time_ms rms_error slope",
                &self.estimators,
            ),
            set_up::table(&self.set_up),
            pupils::table(&self.pupils),
            pictures::table(
                "renderers",
                "lens renderer sequence samples time_ms rms_error slope",
                &self.renderers,
            ),
            stability_table(&self.stability),
            failures_table(&self.stability),
        ]
    }

    /// Returns the ratios below which two results are a tie; they follow from the differences between two measurements
    /// of the same method in this run.
    pub fn ties(&self) -> Ties {
        let ratio = |a: f64, b: f64| (a / b).max(b / a);
        let rays = self.ray_map.iter().chain(&self.stopped_down);
        let rays = rays.map(|m| ratio(m.time.median, m.again.median));
        let cameras = self.leaving_out.iter().filter(|saving| matches!(saving.request, Asked::Precision(_)));
        let cameras = cameras.map(|saving| ratio(saving.kept.median, saving.again.median));
        let apart = |first: &[Curve], again: &[Curve], needs: &[f64]| {
            let first = |curve: &Curve| first.iter().find(|first| first.is_like(curve));
            let pairs = again.iter().filter_map(|curve| Some(first(curve)?.apart(curve, needs)));
            pairs.flatten().collect::<Vec<f64>>()
        };
        Ties {
            times: Tie::of(&rays.chain(cameras).collect::<Vec<_>>(), 0.99),
            irradiance: Tie::of(&apart(&self.irradiance, &self.irradiance_again, &irradiance::NEEDS), 0.9),
            pictures: Tie::of(&apart(&self.renderers, &self.renderers_again, &pictures::NEEDS), 0.9),
        }
    }

    /// Returns the stability results by group: for each tracer, the worst of the group's cases.
    pub fn stability_by_group(&self) -> Vec<CaseResult> {
        let mut groups: Vec<CaseResult> = Vec::new();
        for case in &self.stability {
            match groups.iter_mut().find(|g| (g.group, g.tracer) == (case.group, case.tracer)) {
                Some(group) => group.merge(case),
                None => groups.push(CaseResult { name: "all of the group".to_owned(), ..case.clone() }),
            }
        }
        groups
    }

    /// Returns the stability table by group, in which tracers that return the same bits share one row, under all their
    /// names.
    pub fn stability_summary(&self) -> Table {
        let mut rows: Vec<(String, CaseResult)> = Vec::new();
        for group in self.stability_by_group() {
            let like = |tracer: &str| tracers().iter().find(|t| t.name == tracer).map(|t| t.like);
            let same = |first: &CaseResult| {
                let alike = like(first.tracer).is_some() && like(first.tracer) == like(group.tracer);
                alike && *first == CaseResult { tracer: first.tracer, ..group.clone() }
            };
            match rows.iter_mut().find(|(_, first)| same(first)) {
                Some((names, _)) => *names = format!("{names}; {}", group.tracer),
                None => rows.push((group.tracer.to_owned(), group)),
            }
        }
        stability_rows(rows.iter().map(|(names, result)| (names.as_str(), result)))
    }
}

/// Thresholds below which two results are a tie, as ratios.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ties {
    /// Threshold for times per ray.
    pub times: Tie,
    /// Threshold for times to reach an error of film irradiance.
    pub irradiance: Tie,
    /// Threshold for times to reach an error of a picture.
    pub pictures: Tie,
}

/// A threshold, and the number of repeated measurements behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tie {
    /// Quantile of the ratios between repeated measurements, at the probability `share`; infinite if there are no
    /// repeated measurements, so that everything is a tie.
    pub ratio: f64,
    /// Probability of the quantile. It is lower for light than for times, since an estimate occasionally reaches an
    /// error by luck.
    pub share: f64,
    /// Number of repeated measurements.
    pub pairs: usize,
}

impl Tie {
    fn of(ratios: &[f64], share: f64) -> Self {
        let ratio = if ratios.is_empty() { f64::INFINITY } else { quantile(ratios, share) };
        Self { ratio, share, pairs: ratios.len() }
    }
}

/// Returns stability cases as a table.
pub fn stability_table(cases: &[CaseResult]) -> Table {
    stability_rows(cases.iter().map(|case| (case.tracer, case)))
}

fn stability_rows<'a>(cases: impl Iterator<Item = (&'a str, &'a CaseResult)>) -> Table {
    let columns = "group kernel case worst_direction_rad worst_position_mm condition ratio bound rays undecided holds \
                   fails_because";
    let rows = cases.map(|(tracer, c)| {
        let names = row![c.group, tracer, c.name.as_str()];
        let numbers = row![c.worst_error_rad, c.worst_error_mm, c.condition, c.ratio, c.bound];
        [names, numbers, row![c.rays, c.undecided, c.holds(), c.fails_because().as_str()]].concat()
    });
    Table::of("stability", columns, rows)
}

/// Returns a table of every ray that fails in the stability cases, with its result.
pub fn failures_table(cases: &[CaseResult]) -> Table {
    let columns = "kernel case ray fails_because found rerun";
    let rows = cases.iter().flat_map(|c| {
        c.failures.iter().map(|failure| {
            let reason = Reason::NAMES.iter().find(|(_, reason)| *reason == failure.reason);
            let reason = reason.map_or("", |(name, _)| name);
            let rerun = format!("realistic report --case \"{}\"", failure.case);
            row![c.tracer, failure.case.as_str(), failure.ray, reason, failure.what.as_str(), rerun.as_str()]
        })
    });
    Table::of("stability-failures", columns, rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        accuracy::{curve::Estimate, ray_map::RayErrors},
        methods::METHODS,
        results::statistics::Spread,
        stability::{Failure, Reason},
        timing::Timing,
    };

    #[test]
    fn a_tie_is_what_the_same_methods_measured_twice_are_apart() {
        let none = Results::default().ties();
        assert!(none.times.ratio.is_infinite() && none.times.pairs == 0);
        let spread = Spread { median: 1.0, most: 1.0, worst: 1.0 };
        let timed = |median: f64| Timing { median, low: median, high: median };
        let method = |number: usize, again: f64| RayErrors {
            lens: "a lens".to_owned(),
            method: METHODS[number],
            time: timed(1.0),
            again: timed(again),
            direction: spread,
            position: spread,
            pixels: spread,
            samples: 1,
            lost: 0,
            leaked: 0,
        };
        let point = |time| Estimate { samples: 1, time, error: 2e-3, noise: 0.1 };
        let curve = |time| Curve {
            lens: "a lens".to_owned(),
            pupil: "rear",
            disk: "concentric",
            sequence: "random",
            points: vec![point(time)],
        };
        let results = Results {
            ray_map: vec![method(1, 0.8), method(2, 1.01)],
            irradiance: vec![curve(1.0)],
            irradiance_again: vec![curve(1.5)],
            ..Results::default()
        };
        let ties = results.ties();
        assert!(ties.times.pairs == 2 && (1.24..=1.25).contains(&ties.times.ratio), "{ties:?}");
        assert_eq!(ties.irradiance, Tie { ratio: 1.5, share: 0.9, pairs: 2 });
        assert!(ties.pictures.ratio.is_infinite());
    }

    #[test]
    fn equal_tracers_are_one_row_and_failures_can_be_repeated() {
        let same: Vec<&'static str> =
            tracers().iter().filter(|tracer| tracer.like == "one f64").map(|tracer| tracer.name).collect();
        assert!(same.len() > 1);
        let result = |tracer| CaseResult {
            ratio: 2.0,
            ..CaseResult::new("a case".to_owned(), "radius", tracer, 16.0)
        };
        let mut results =
            Results { stability: same.iter().map(|&name| result(name)).collect(), ..Results::default() };
        assert_eq!(results.stability_summary().rows.len(), 1);
        let failure =
            Failure { case: "a case".to_owned(), ray: 7, reason: Reason::Fate, what: "blocked".to_owned() };
        results.stability[1].failures.push(failure);
        let summary = results.stability_summary();
        assert_eq!(summary.rows.len(), 2);
        assert!(summary.to_csv().contains("no,fate (1)"), "{}", summary.to_csv());
        let failures = failures_table(&results.stability).to_csv();
        assert!(failures.contains("a case,7,fate,blocked,"), "{failures}");
        assert!(failures.contains("realistic report --case") && failures.lines().count() == 2, "{failures}");
    }
}
