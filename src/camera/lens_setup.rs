//! The lens that a caller names: found, scaled, at its wavelength and stopped down.

use super::{
    CameraError, Level, ParameterError,
    parameters::check::{out_of_range, positive},
};
use crate::{
    lens::{
        Lens, LensError,
        first_order::FirstOrder,
        pupil::{EntrancePupil, limiting_surface},
    },
    message::short,
    prescription::{
        LensSource, Prescription, SearchPath,
        glass::{D_LINE, VALID_WAVELENGTHS},
    },
};

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
pub(crate) fn set_up_lens(
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
    if let Some(([first, second], height)) = lens.crossed_surfaces() {
        let text = format!(
            "lens \"{}\": the surfaces of rows {} and {} cross {} mm from the axis, inside their clear diameters, as no \
             lens's do; check their radii, diameters and the thickness between them",
            lens.name,
            first + 1,
            second + 1,
            short(height)
        );
        log(Level::Warning, &text);
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
