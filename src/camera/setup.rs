//! From parameters to a checked set-up: the lens, the film in its place, and what the camera is to be.

use super::{
    CameraError, DEFAULT_INTERVAL, Film, Host, Level, ParameterError, Parameters, Raster,
    focusing::{Focusing, place_film},
    lens_setup::{LensSetup, open_lens, set_up_lens},
    parameters::{
        check::{choice, clip_range, finite_float, out_of_range, positive},
        choices::{Precision, PupilChoice, Weighting},
    },
    placement::Placement,
};
use crate::sampling::DiskMapping;
use crate::{
    lens::{Lens, refraction::Refraction},
    prescription::{SourceError, catalogue, read},
};

/// Between an electron and the known universe; beyond, a ray's origin could leave the range of floats.
const MM_PER_UNIT: std::ops::RangeInclusive<f64> = 1e-15..=1e30;

/// Everything that a camera is made of.
#[derive(Clone, Debug)]
pub(crate) struct Setup {
    pub lens: Lens,
    pub film: Film,
    pub film_distance: f64,
    pub focus_distance: Option<f64>,
    pub refraction: Refraction,
    pub pupil: PupilChoice,
    pub mapping: DiskMapping,
    pub weighting: Weighting,
    pub precision: Precision,
    /// Pixels; 0: exact.
    pub tolerance: f64,
    pub leave_out: bool,
    pub mm_per_unit: f64,
    pub placement: Placement,
}

impl Setup {
    /// Reads and checks every parameter once.
    pub fn of(
        parameters: &Parameters,
        host: &Host,
        focusing: Focusing,
        log: &mut dyn FnMut(Level, &str),
    ) -> Result<Self, CameraError> {
        let given = parameters;
        if given.af_zones.is_some() {
            log(
                Level::Warning,
                "\"af_zones\" is not used: this host offers no autofocus; give \"focusdistance\" (world \
                 units from the film) or \"filmdistance\" (mm)",
            );
        }
        let Raster { xres, yres } = host.raster;
        if xres == 0 || yres == 0 {
            return Err(CameraError::Raster { xres: xres as i32, yres: yres as i32 });
        }
        let diagonal = given.filmdiag.unwrap_or(Film::DEFAULT_DIAGONAL);
        positive("filmdiag", diagonal, "mm")?;
        let film = Film::new(host.raster, diagonal);
        let mm_per_unit = given.mmperunit.unwrap_or(1.0);
        positive("mmperunit", mm_per_unit, "mm a world unit")?;
        if !MM_PER_UNIT.contains(&mm_per_unit) {
            let (from, to) = (MM_PER_UNIT.start(), MM_PER_UNIT.end());
            let range = format!("from {from:e} to {to:e} mm a world unit");
            return Err(out_of_range("mmperunit", mm_per_unit, &range));
        }
        let lens = lens_of(given, host, log)?;
        let (film_distance, focus_distance) = place_film(given, &lens, mm_per_unit, focusing)?;
        let mapping = disk_mapping(given, host)?;
        Ok(Self {
            lens,
            film,
            film_distance,
            focus_distance,
            refraction: choice("refraction", given.refraction.as_deref(), &Refraction::NAMES)?,
            pupil: choice("pupil", given.pupil.as_deref(), &PupilChoice::NAMES)?,
            mapping,
            weighting: weighting(given)?,
            precision: choice("precision", given.precision.as_deref(), &Precision::NAMES)?,
            tolerance: tolerance(given)?,
            leave_out: host.leave_out,
            mm_per_unit,
            placement: placement(given, host)?,
        })
    }
}

/// The camera's place, clip range and shutter interval.
pub(crate) fn placement(given: &Parameters, host: &Host) -> Result<Placement, CameraError> {
    let [open, close] = DEFAULT_INTERVAL;
    let clip = clip_range(("hither", given.hither.unwrap_or(1e-3)), ("yon", given.yon.unwrap_or(1e30)))?;
    // In either order, as pbrt's stock cameras take them: time then runs backward.
    let shutter = [
        finite_float("shutteropen", given.shutteropen.unwrap_or(open))?,
        finite_float("shutterclose", given.shutterclose.unwrap_or(close))?,
    ];
    let to_world = match host.to_world.at(shutter[0]) {
        // A moving camera seen at one moment stands still.
        at_once if host.leave_out && shutter[0] == shutter[1] => at_once.into_owned().into(),
        _ => host.to_world.clone(),
    };
    Ok(Placement { to_world, clip, shutter })
}

/// How lens numbers map to the disk, for a host that may not be able to draw again.
pub(crate) fn disk_mapping(given: &Parameters, host: &Host) -> Result<DiskMapping, CameraError> {
    let mapping = choice("disk", given.disk.as_deref(), &DiskMapping::NAMES)?;
    if mapping == DiskMapping::Rejection && !host.can_redraw {
        return Err(ParameterError::Range {
            name: "disk",
            value: "\"rejection\"".to_owned(),
            range: "\"concentric\" or \"polar\" with a host that cannot draw lens numbers again".to_owned(),
        }
        .into());
    }
    Ok(mapping)
}

fn lens_of(given: &Parameters, host: &Host, log: &mut dyn FnMut(Level, &str)) -> Result<Lens, CameraError> {
    let setup = LensSetup {
        wavelength: given.wavelength,
        aperture_diameter: given.aperture_diameter,
        fnumber: given.fnumber,
    };
    if let Some((name, text)) = &host.lens_text {
        if given.specfile.is_some() {
            return Err(ParameterError::Both { first: "specfile", second: "lens_text" }.into());
        }
        let prescription = read(name, text).map_err(SourceError::from)?;
        return set_up_lens(&prescription, setup, log);
    }
    let name = given.specfile.as_deref().unwrap_or(catalogue::DEFAULT);
    open_lens(name, &host.search, setup, log).map(|(_, lens)| lens)
}

fn tolerance(given: &Parameters) -> Result<f64, CameraError> {
    let tolerance = given.tolerance.unwrap_or(0.0);
    if tolerance >= 0.0 && tolerance.is_finite() {
        Ok(tolerance)
    } else {
        Err(out_of_range("tolerance", tolerance, "0 (exact) or more, in pixels, and finite"))
    }
}

fn weighting(given: &Parameters) -> Result<Weighting, CameraError> {
    match (given.weighting.as_deref(), given.simpleweighting) {
        (Some(_), Some(_)) => {
            Err(ParameterError::Both { first: "weighting", second: "simpleweighting" }.into())
        }
        (None, Some(true)) => Ok(Weighting::Relative),
        (None, Some(false)) => Ok(Weighting::Radiometric),
        (name, None) => choice("weighting", name, &Weighting::NAMES),
    }
}
