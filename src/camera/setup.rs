//! From parameters to a checked set-up: the lens found, scaled and stopped down, the film in place.

use std::path::PathBuf;

use super::{
    CameraError, CameraMotion, CameraToWorld, DEFAULT_INTERVAL, DiskMapping, Film, IdealCamera,
    ParameterError, Parameters, Raster, RealisticCamera,
    check::{choice, interval, out_of_range, positive},
    choices::{Precision, PupilChoice, Weighting},
    focusing::{Focusing, place_film},
    placement::Placement,
};
use crate::{
    message::short,
    optics::{
        Lens, LensError,
        first_order::FirstOrder,
        pupil::{EntrancePupil, limiting_surface},
        refraction::Refraction,
    },
    prescription::{
        LensSource, Prescription, SearchPath, catalogue,
        glass::{D_LINE, VALID_WAVELENGTHS},
        read,
    },
};

/// How serious a message is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Worth knowing.
    Info,
    /// The camera is built, and something is not as asked.
    Warning,
    /// The camera is not built.
    Error,
}

/// What a host brings besides parameters.
#[derive(Clone, Debug)]
pub struct Host {
    /// Pixels of the image.
    pub raster: Raster,
    /// Camera space to world space, at any time.
    pub to_world: CameraMotion,
    /// Where lens files are looked for after the working directory.
    pub search: SearchPath,
    /// A lens file's text in the place of `specfile`, with the name it goes by in messages.
    pub lens_text: Option<(String, Vec<u8>)>,
    /// Whether the host can draw new lens numbers for a sample.
    pub can_redraw: bool,
    /// Whether the camera leaves out what its film and place do not need; false is for comparisons. Without
    /// a tolerance the rays have the same bits.
    pub leave_out: bool,
}

impl Host {
    /// A host whose camera space is its world space, and which looks for lens files along
    /// `PBRT_SEARCHPATH` and in the directory `beside`.
    pub fn new(raster: Raster, beside: Option<PathBuf>) -> Self {
        Self {
            raster,
            to_world: CameraToWorld::IDENTITY.into(),
            search: SearchPath::from_environment().then(beside.as_deref()),
            lens_text: None,
            can_redraw: true,
            leave_out: true,
        }
    }
}

/// Everything that a camera is made of.
#[derive(Clone, Debug)]
pub(super) struct Setup {
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

/// What decides which lens is used and at which stop.
#[derive(Clone, Copy, Debug, Default)]
pub struct LensSetup {
    /// nm; `None` for the d line.
    pub wavelength: Option<f64>,
    /// Diameter of the stop, mm.
    pub aperture_diameter: Option<f64>,
    /// Focal length over entrance pupil diameter.
    pub fnumber: Option<f64>,
}

/// Finds, reads, scales and stops down the lens that a caller names.
///
/// # Errors
/// No such lens, a file that is not a lens, a lens that cannot be scaled or stopped down as asked.
pub fn open_lens(
    name: &str,
    search: &SearchPath,
    setup: LensSetup,
    log: &mut dyn FnMut(Level, &str),
) -> Result<(Prescription, Lens), CameraError> {
    let source = LensSource::parse(name, search)?;
    let mut prescription = source.load(search)?;
    if let Some(focal_length) = source.focal_length() {
        let own = FirstOrder::of(&Lens::at_d_line(&prescription))?.focal_length;
        prescription = prescription.scaled(focal_length / own.abs());
        prescription.name = name.to_owned();
    }
    let lens = set_up_lens(&prescription, setup, log)?;
    Ok((prescription, lens))
}

/// A prescription at a wavelength and stop.
fn set_up_lens(
    prescription: &Prescription,
    setup: LensSetup,
    log: &mut dyn FnMut(Level, &str),
) -> Result<Lens, CameraError> {
    let wavelength = setup.wavelength.unwrap_or(D_LINE);
    if !VALID_WAVELENGTHS.contains(&wavelength) {
        let (from, to) = (VALID_WAVELENGTHS.start(), VALID_WAVELENGTHS.end());
        return Err(out_of_range("wavelength", wavelength, &format!("from {from} to {to} nm")));
    }
    if wavelength != D_LINE && !prescription.is_dispersive() {
        let name = &prescription.name;
        let text = format!(
            "lens \"{name}\" has neither V-numbers nor Sellmeier constants: wavelength {wavelength} nm changes nothing"
        );
        log(Level::Warning, &text);
    }
    let mut lens = Lens::new(prescription, wavelength);
    if let Some(row) = lens.surfaces.iter().position(|surface| !(surface.n_film >= 1.0)) {
        let (lens, index) = (lens.name, lens.surfaces[row].n_film);
        return Err(LensError::Index { lens, row: row + 1, index, wavelength }.into());
    }
    match (setup.aperture_diameter, setup.fnumber) {
        (Some(_), Some(_)) => {
            Err(ParameterError::Both { first: "fnumber", second: "aperture_diameter" }.into())
        }
        (Some(diameter), None) => stop_to_diameter(&mut lens, diameter, log).map(|()| lens),
        (None, Some(number)) => stop_to_fnumber(&mut lens, number, log).map(|()| lens),
        (None, None) => Ok(lens),
    }
}

fn stop_to_diameter(
    lens: &mut Lens,
    diameter: f64,
    log: &mut dyn FnMut(Level, &str),
) -> Result<(), CameraError> {
    let Some(stop) = lens.stop_index() else {
        return Err(LensError::NoStop { lens: lens.name.clone() }.into());
    };
    positive("aperture_diameter", diameter, "mm")?;
    let widest = 2.0 * lens.surfaces[stop].semi_diameter;
    if diameter > widest {
        let text = format!(
            "\"aperture_diameter\" {diameter} mm is wider than the lens's stop; {} mm is used",
            short(widest)
        );
        log(Level::Warning, &text);
    } else {
        lens.surfaces[stop].semi_diameter = diameter / 2.0;
    }
    Ok(())
}

fn stop_to_fnumber(
    lens: &mut Lens,
    number: f64,
    log: &mut dyn FnMut(Level, &str),
) -> Result<(), CameraError> {
    positive("fnumber", number, "")?;
    let focal_length = FirstOrder::of(lens)?.focal_length.abs();
    let widest = focal_length / EntrancePupil::of_surface(lens, limiting_surface(lens)).diameter();
    if number < widest {
        log(
            Level::Warning,
            &format!("\"fnumber\" {number} is faster than the lens; f/{} is used", short(widest)),
        );
        return Ok(());
    }
    let surface = lens.stop_index().unwrap_or_else(|| limiting_surface(lens));
    // The entrance pupil grows in proportion to the aperture that it images.
    let imaged = EntrancePupil::of_surface(lens, surface).diameter();
    lens.surfaces[surface].semi_diameter *= focal_length / number / imaged;
    Ok(())
}

impl RealisticCamera {
    /// Builds a camera of the model "lens". `log` receives warnings.
    ///
    /// # Errors
    /// What is wrong, and what to give instead.
    pub fn build(
        parameters: &Parameters,
        host: &Host,
        log: &mut dyn FnMut(Level, &str),
    ) -> Result<Self, CameraError> {
        choice("model", parameters.model.as_deref(), &[("lens", ())])?;
        let setup = Setup::of(parameters, host, Focusing::Exact, log)?;
        Self::from_setup(setup, log)
    }
}

/// Between an electron and the known universe; beyond, a ray's origin could leave the range of floats.
const MM_PER_UNIT: std::ops::RangeInclusive<f64> = 1e-15..=1e30;

impl IdealCamera {
    /// Builds the thick lens of the parameters' lens, or its thin one. `log` receives warnings.
    ///
    /// # Errors
    /// What is wrong, and what to give instead.
    pub fn build(
        parameters: &Parameters,
        host: &Host,
        thin: bool,
        log: &mut dyn FnMut(Level, &str),
    ) -> Result<Self, CameraError> {
        let setup = Setup::of(parameters, host, Focusing::Paraxial, log)?;
        Self::from_setup(setup, thin)
    }
}

impl Setup {
    fn of(
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
pub(super) fn placement(given: &Parameters, host: &Host) -> Result<Placement, CameraError> {
    let [open, close] = DEFAULT_INTERVAL;
    let clip = interval(("hither", given.hither, 1e-3), ("yon", given.yon, 1e30), Some(0.0), true)?;
    let shutter = interval(
        ("shutteropen", given.shutteropen, open),
        ("shutterclose", given.shutterclose, close),
        None,
        false,
    )?;
    let to_world = match host.to_world.at(shutter[0]) {
        // A moving camera seen at one moment stands still.
        at_once if host.leave_out && shutter[0] == shutter[1] => at_once.into_owned().into(),
        _ => host.to_world.clone(),
    };
    Ok(Placement { to_world, clip, shutter })
}

/// How lens numbers map to the disk, for a host that may not be able to draw again.
pub(super) fn disk_mapping(given: &Parameters, host: &Host) -> Result<DiskMapping, CameraError> {
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
        let prescription = read(name, text).map_err(crate::prescription::SourceError::from)?;
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
