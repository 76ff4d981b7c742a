//! A lens whose groups move, at the focal lengths between which a shader interpolates.
//!
//! The input is a prescription and a request; the output is a lens for each of an odd number of focal lengths, or a
//! single lens if it does not zoom. Stations of even index are the nodes of the zoom, which include the positions in
//! the lens file. A station of odd index is halfway between two nodes by the logarithm of the focal length.

use realistic_base::numeric::root;
use realistic_camera::Zoom;
use realistic_optics::imaging::focus::AxialImage;
use realistic_optics::imaging::moving::{FocusTravel, MovingError, MovingGroups};
use realistic_optics::imaging::open::{OpenLens, StopSize, set_up};
use realistic_optics::lens::first_order::FirstOrder;
use realistic_optics::lens::{Lens, LensError};
use realistic_optics::prescription::Prescription;

/// Largest step of the zoom, in the logarithm of the focal length, and largest number of steps.
const STEP: f64 = 0.14;
const MOST_STEPS: f64 = 12.0;

/// A lens at one focal length.
#[derive(Debug)]
pub struct Station {
    /// Requested focal length, mm.
    pub zoom: f64,
    /// The lens focused on the farthest object in its file.
    pub lens: Lens,
    focusing: Option<Focusing>,
}

/// The movement of groups that focus.
#[derive(Debug)]
struct Focusing {
    travel: FocusTravel,
    wavelength: f64,
    stop: StopSize,
}

/// The requested lens and movement.
#[derive(Clone, Copy, Debug)]
pub struct StationRequest<'a> {
    /// The lens at the requested focal length, if any. Every station has the shape of its stop's opening.
    pub lens: &'a Lens,
    pub stop: StopSize,
    /// Position or focal length, if the shader is for a single one.
    pub zoom: Option<&'a Zoom>,
    /// Whether groups focus; otherwise the whole lens moves.
    pub by_groups: bool,
}

impl Station {
    /// Makes the station of a lens that does not move.
    pub fn fixed(lens: &Lens, zoom: f64) -> Self {
        Self { zoom, lens: lens.clone(), focusing: None }
    }

    fn of(travel: FocusTravel, zoom: f64, request: StationRequest<'_>) -> Result<Self, LensError> {
        let wavelength = request.lens.wavelength;
        let mut lens = set_up(&travel.at(travel.start()), wavelength, request.stop, &mut |_, _| ())?.lens;
        if let Some(stop) = lens.stop_index() {
            lens.surfaces[stop].apertures = request.lens.surfaces[stop].apertures.clone();
        }
        let focusing = request.by_groups.then_some(Focusing { travel, wavelength, stop: request.stop });
        Ok(Self { zoom, lens, focusing })
    }

    /// Whether groups move to focus.
    pub fn focuses_by_groups(&self) -> bool {
        self.focusing.is_some()
    }

    /// Returns the lens with its groups focused on an object 1/`vergence` mm in front of it, and with the film at the
    /// position that the file gives.
    pub fn focused(&self, vergence: f64) -> Option<Lens> {
        let Focusing { travel, wavelength, stop } = self.focusing.as_ref()?;
        let at = |position: f64| {
            let prescription = travel.at(position);
            let opened = set_up(&prescription, *wavelength, *stop, &mut |_, _| ()).ok()?;
            Some((prescription.nominal_film_distance, opened))
        };
        let off = |position: f64| match at(position) {
            Some((Some(film), OpenLens { lens, beam, .. })) => {
                AxialImage::of(&lens, beam.entrance).best(vergence).distance - film
            }
            _ => f64::NAN,
        };
        let [far, near] = travel.range();
        let position = match [off(far), off(near)] {
            [before, behind] if before * behind < 0.0 => root(far, near, off),
            [before, behind] if before.abs() < behind.abs() => far,
            [_, behind] if behind.is_finite() => near,
            // Without a stated film distance, the position is the one in the table for this object.
            _ => vergence.clamp(far, near),
        };
        at(position).map(|(_, opened)| opened.lens)
    }
}

/// Returns the stations of a lens in order of rising focal length, and the index of the station that is initial in
/// the file.
///
/// # Errors
/// The lens does not zoom as requested.
pub fn stations(
    prescription: &Prescription,
    request: StationRequest<'_>,
) -> Result<(Vec<Station>, usize), MovingError> {
    let own = |lens: &Lens| FirstOrder::of(lens).map_or(0.0, |optics| optics.focal_length.abs());
    let unmoved = || (vec![Station::fixed(request.lens, own(request.lens))], 0);
    let Some(groups) = MovingGroups::of(prescription) else { return Ok(unmoved()) };
    // Groups focus on the film at its position in the file, which follows the image as the lens zooms.
    let image = |prescription: &Prescription, vergence: f64| {
        let OpenLens { lens, beam, .. } = OpenLens::new(Lens::at_own_wavelength(prescription));
        Some(AxialImage::of(&lens, beam.entrance).best(vergence).distance)
            .filter(|distance| distance.is_finite())
    };
    let zoomed = |focal_length: f64| groups.zoomed(focal_length, image);
    let one = |travel: FocusTravel| {
        Station::of(travel, own(request.lens), request)
            .map_or_else(|_| unmoved(), |station| (vec![station], 0))
    };
    match request.zoom {
        Some(Zoom::FocalLength(focal_length)) => return Ok(one(zoomed(*focal_length)?)),
        Some(Zoom::Position(name)) => return Ok(one(groups.named(name)?)),
        None if !groups.is_zoom() => return Ok(one(groups.position(0))),
        None => {}
    }
    let count = prescription.positions.as_ref().map_or(1, |positions| positions.layout().zooms);
    let listed = |zoom: usize| {
        let travel = groups.position(zoom);
        let focal_length = own(&Lens::at_d_line(&travel.at(travel.start())));
        (focal_length, travel)
    };
    let mut listed: Vec<(f64, FocusTravel)> = (0..count).map(listed).collect();
    let first = listed[0].0;
    listed.sort_by(|a, b| a.0.total_cmp(&b.0));
    let whole = (listed[count - 1].0 / listed[0].0).ln();
    let step = STEP.max(whole / MOST_STEPS);
    let mut travels = vec![listed[0].clone()];
    for pair in listed.windows(2) {
        let log_ratio = (pair[1].0 / pair[0].0).ln();
        // Each step has two stations, and the second of them is a node.
        let parts = 2 * (log_ratio / step).ceil().max(1.0) as usize;
        for part in 1..parts {
            let focal_length = pair[0].0 * (log_ratio * part as f64 / parts as f64).exp();
            travels.push((focal_length, zoomed(focal_length)?));
        }
        travels.push(pair[1].clone());
    }
    let start = travels.iter().position(|(focal_length, _)| *focal_length == first).unwrap_or(0);
    let all: Result<Vec<Station>, LensError> =
        travels.into_iter().map(|(zoom, travel)| Station::of(travel, zoom, request)).collect();
    Ok(all.map_or_else(|_| unmoved(), |all| (all, start)))
}
