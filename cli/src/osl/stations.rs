//! A lens whose groups move, at the focal lengths between which a shader interpolates.
//!
//! A prescription and what is asked of it in; a lens for each of an odd number of focal lengths, one for a lens that does not
//! zoom, out. Those of even number are the zoom's nodes, the positions of the lens file among them; those between are in the
//! middle, by the focal length's logarithm.

use realistic::unstable::camera::Zoom;
use realistic::unstable::imaging::focus::AxialImage;
use realistic::unstable::imaging::moving::{FocusTravel, MovingError, MovingGroups};
use realistic::unstable::imaging::open::{OpenLens, StopSize, set_up};
use realistic::unstable::lens::first_order::FirstOrder;
use realistic::unstable::lens::{Lens, LensError};
use realistic::unstable::numeric::root;
use realistic::unstable::prescription::Prescription;

/// The largest step of the zoom, by the focal length's logarithm, and the most steps.
const STEP: f64 = 0.14;
const MOST_STEPS: f64 = 12.0;

/// A lens at one focal length.
#[derive(Debug)]
pub struct Station {
    /// Focal length by which it is asked for, mm.
    pub zoom: f64,
    /// Focused at the farthest object that its file has.
    pub lens: Lens,
    focusing: Option<Focusing>,
}

/// How the groups move to focus.
#[derive(Debug)]
struct Focusing {
    travel: FocusTravel,
    wavelength: f64,
    stop: StopSize,
}

/// What groups are to do.
#[derive(Clone, Copy, Debug)]
pub struct Asked<'a> {
    /// As it is at the focal length, if any, that is asked for.
    pub lens: &'a Lens,
    pub stop: StopSize,
    /// The position, or the focal length, that the shader is for alone.
    pub zoom: Option<&'a Zoom>,
    /// Whether the groups focus, or else the whole lens moves.
    pub by_groups: bool,
}

impl Station {
    /// A lens that does not move.
    pub fn fixed(lens: &Lens, zoom: f64) -> Self {
        Self { zoom, lens: lens.clone(), focusing: None }
    }

    fn of(travel: FocusTravel, zoom: f64, asked: Asked<'_>) -> Result<Self, LensError> {
        let wavelength = asked.lens.wavelength;
        let lens = set_up(&travel.at(travel.start()), wavelength, asked.stop, &mut |_, _| ())?.lens;
        let focusing = asked.by_groups.then_some(Focusing { travel, wavelength, stop: asked.stop });
        Ok(Self { zoom, lens, focusing })
    }

    /// Whether groups move to focus.
    pub fn focuses_by_groups(&self) -> bool {
        self.focusing.is_some()
    }

    /// The lens as its groups focus on an object 1/`vergence` mm in front of it, with the film where the file has it.
    pub fn focused(&self, vergence: f64) -> Option<Lens> {
        let Focusing { travel, wavelength, stop } = self.focusing.as_ref()?;
        let at = |place: f64| {
            let prescription = travel.at(place);
            let opened = set_up(&prescription, *wavelength, *stop, &mut |_, _| ()).ok()?;
            Some((prescription.nominal_film_distance, opened))
        };
        let off = |place: f64| match at(place) {
            Some((Some(film), OpenLens { lens, beam, .. })) => {
                AxialImage::of(&lens, beam.entrance).best(vergence).distance - film
            }
            _ => f64::NAN,
        };
        let [far, near] = travel.range();
        let place = match [off(far), off(near)] {
            [before, behind] if before * behind < 0.0 => root(far, near, off),
            [before, behind] if before.abs() < behind.abs() => far,
            [_, behind] if behind.is_finite() => near,
            // No film is stated: as the table has it for this object.
            _ => vergence.clamp(far, near),
        };
        at(place).map(|(_, opened)| opened.lens)
    }
}

/// The stations of a lens in rising order of the focal length, and the number of the one at which its file begins.
///
/// # Errors
/// The lens does not zoom as asked.
pub fn stations(prescription: &Prescription, asked: Asked<'_>) -> Result<(Vec<Station>, usize), MovingError> {
    let own = |lens: &Lens| FirstOrder::of(lens).map_or(0.0, |optics| optics.focal_length.abs());
    let unmoved = || (vec![Station::fixed(asked.lens, own(asked.lens))], 0);
    let Some(groups) = MovingGroups::of(prescription) else { return Ok(unmoved()) };
    // Groups focus on the film in its own place, which follows the image as the lens zooms.
    let image = |prescription: &Prescription, vergence: f64| {
        let OpenLens { lens, beam, .. } = OpenLens::new(Lens::at_own_wavelength(prescription));
        Some(AxialImage::of(&lens, beam.entrance).best(vergence).distance)
            .filter(|distance| distance.is_finite())
    };
    let zoomed = |focal_length: f64| groups.zoomed(focal_length, image);
    let one = |travel: FocusTravel| {
        Station::of(travel, own(asked.lens), asked).map_or_else(|_| unmoved(), |station| (vec![station], 0))
    };
    match asked.zoom {
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
        let way = (pair[1].0 / pair[0].0).ln();
        // Two, the second of them a node, for each step.
        let parts = 2 * (way / step).ceil().max(1.0) as usize;
        for part in 1..parts {
            let focal_length = pair[0].0 * (way * part as f64 / parts as f64).exp();
            travels.push((focal_length, zoomed(focal_length)?));
        }
        travels.push(pair[1].clone());
    }
    let start = travels.iter().position(|(focal_length, _)| *focal_length == first).unwrap_or(0);
    let all: Result<Vec<Station>, LensError> =
        travels.into_iter().map(|(zoom, travel)| Station::of(travel, zoom, asked)).collect();
    Ok(all.map_or_else(|_| unmoved(), |all| (all, start)))
}
