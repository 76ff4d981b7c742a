//! Everything that a report measures, at two sizes.

use std::{ops::ControlFlow, time::Duration};

use thiserror::Error;

use realistic::{
    camera::{CameraError, Raster},
    imaging::focus::FocusError,
    prescription::catalogue,
};

use super::{
    curve::Curve,
    irradiance::{self, SampleCounts},
    pupils::{self, PupilCounts},
    ray_map::{self, RayCounts},
    set_up::{self, FitCounts},
};
use crate::{
    accuracy::pictures,
    results::table::{Table, row},
    stability::{self, CaseResult},
    subject::Subject,
    timing::Effort,
};

/// The lenses that a report is about.
pub const LENSES: [&str; 4] = ["dgauss.50mm", "wide.22mm", "telephoto.250mm", "fisheye.10mm"];

/// What is measured, and how long.
#[derive(Clone, Debug)]
pub struct Suite {
    /// Names in the catalogue.
    pub lenses: Vec<&'static str>,
    /// The ray map.
    pub ray_map: RayCounts,
    /// Film irradiance.
    pub irradiance: SampleCounts,
    /// Rendered pictures.
    pub picture: pictures::Size,
    /// Set-up.
    pub set_up: FitCounts,
    /// The pupil's tables.
    pub pupils: PupilCounts,
    /// Stability.
    pub stability: stability::Extent,
}

impl Suite {
    /// Minutes: for figures to keep. The pictures are of `scene`.
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

    /// Under a minute, likewise.
    pub fn quick(scene: pictures::Scene) -> Self {
        let effort = Effort { rounds: 9, least: Duration::from_millis(1) };
        let raster = Raster { xres: 36, yres: 24 };
        Self {
            lenses: LENSES.to_vec(),
            ray_map: RayCounts { rays: 4000, block: 2048, effort },
            irradiance: SampleCounts { exponent: 5, repeats: 12, survey: 800, effort },
            picture: pictures::Size { scene, raster, exponent: 3, reference: 1024, repeats: 2 },
            set_up: FitCounts { rays: 1000, repeats: 3 },
            pupils: PupilCounts { points: 12, repeats: 1 },
            stability: stability::Extent::QUICK,
        }
    }

    /// Measures. `progress` hears what is being done.
    ///
    /// # Errors
    /// A lens cannot be focused, or a camera not be built.
    pub fn run(&self, progress: &mut dyn FnMut(&str)) -> Result<Results, SuiteError> {
        let mut results = Results::default();
        for &name in &self.lenses {
            let mut tell = |what: &str| progress(&format!("{name}: {what}"));
            let prescription = catalogue::find(name).ok_or(SuiteError::Unknown(name))?;
            let subject = Subject::new(&prescription)?;
            tell("ray map");
            results.ray_map.extend(ray_map::measure(&subject, self.ray_map));
            tell("film irradiance");
            results.irradiance.extend(irradiance::measure(&subject, self.irradiance)?);
            tell("pictures");
            let pictures = pictures::measure(&subject, self.picture)?;
            results.estimators.extend(pictures.estimators);
            results.renderers.extend(pictures.renderers);
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

/// Why there is no report.
#[derive(Debug, Error)]
pub enum SuiteError {
    /// A lens that the catalogue does not have.
    #[error("the catalogue has no lens \"{0}\"")]
    Unknown(&'static str),
    /// A lens that cannot be focused at infinity.
    #[error(transparent)]
    Focus(#[from] FocusError),
    /// A camera that cannot be built.
    #[error(transparent)]
    Camera(#[from] CameraError),
}

/// What was measured, lens after lens.
#[derive(Clone, Debug, Default)]
pub struct Results {
    /// The lenses.
    pub lenses: Vec<&'static str>,
    /// Errors and times of rays.
    pub ray_map: Vec<ray_map::RayErrors>,
    /// Estimates of film irradiance.
    pub irradiance: Vec<Curve>,
    /// Pictures by sampler and sequence.
    pub estimators: Vec<Curve>,
    /// Pictures by renderer.
    pub renderers: Vec<Curve>,
    /// The reference pictures' own errors.
    pub floors: Vec<(&'static str, f64)>,
    /// Build times.
    pub set_up: Vec<set_up::Fit>,
    /// Pupils.
    pub pupils: Vec<pupils::Coverage>,
    /// Extreme cases.
    pub stability: Vec<CaseResult>,
}

impl Results {
    /// Every table, in the order of the report.
    pub fn tables(&self) -> Vec<Table> {
        vec![
            ray_map::table(&self.ray_map),
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
        ]
    }

    /// The stability cases by group and tracer: the worst of each.
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
}

/// Stability cases as a table.
pub fn stability_table(cases: &[CaseResult]) -> Table {
    let columns = "group kernel case worst_direction_rad worst_position_mm condition ratio bound rays disagreements \
                   undecided holds";
    let rows = cases.iter().map(|c| {
        let names = row![c.group, c.tracer, c.name.as_str()];
        let numbers = row![c.worst_error_rad, c.worst_error_mm, c.condition, c.ratio, c.bound];
        [names, numbers, row![c.rays, c.disagreements, c.undecided, c.holds]].concat()
    });
    Table::of("stability", columns, rows)
}
