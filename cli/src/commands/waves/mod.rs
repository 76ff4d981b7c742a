//! Commands with diffraction: `psf` and `mtf`, and what they have in common: an image point, the object point that is
//! imaged there, and the wavelengths.

pub mod mtf;
pub mod psf;

use crate::arguments::{LensChoice, POSED_FILM, STOP_SHAPE, TRANSMISSION, distance, whole};
use crate::failure::Failure;
use realistic_base::message::{as_given, fixed};
use realistic_light::Surfaces;
use realistic_optics::{imaging::focus::Focus, lens::Lens};
use realistic_waves::{
    FilmPlane, ObjectPoint, Sampling, WaveError, Wavefront, seidel, wavefront::object_of, zernike::Ordering,
};
use serde_json::{Value, json};

/// The groups of parameters that these commands use.
pub const GROUPS: &[&[&str]] = &[STOP_SHAPE, TRANSMISSION, POSED_FILM];

/// The options of a command about one image point.
#[derive(clap::Args, Debug)]
pub struct PointArgs {
    #[command(flatten)]
    lens: LensChoice,
    /// Image point: x,y on the film in lens space, mm from its centre; the picture is upside down there
    #[arg(long, value_name = "X,Y", default_value = "0,0", allow_hyphen_values = true, value_parser = pair)]
    at: [f64; 2],
    /// Distance of the object from the film, mm, or inf [default: that of the plane in focus]
    #[arg(long, value_name = "MM", value_parser = distance)]
    object_distance: Option<f64>,
    /// Wavelengths in nm with their weights, such as 486:1,588:2,656:1 [default: the lens's own]
    #[arg(long, value_name = "NM:WEIGHT,...", value_parser = spectrum)]
    spectrum: Option<Spectrum>,
    /// Number of rows of rays, and of rays in each row
    #[arg(long, value_name = "COUNT", default_value_t = Sampling::DEFAULT.across, value_parser = whole(16_usize, 2048))]
    rays: usize,
}

/// Wavelengths, nm, with their weights.
#[derive(Clone, Debug)]
struct Spectrum(Vec<(f64, f64)>);

fn pair(text: &str) -> Result<[f64; 2], String> {
    let numbers: Vec<f64> = text.split(',').filter_map(|part| part.trim().parse().ok()).collect();
    match numbers[..] {
        [x, y] if x.is_finite() && y.is_finite() => Ok([x, y]),
        _ => Err(format!("{text:?} is not X,Y: two numbers of mm, as in 0,10")),
    }
}

fn spectrum(text: &str) -> Result<Spectrum, String> {
    let part = |part: &str| {
        let (wavelength, weight) = part.split_once(':').unwrap_or((part, "1"));
        let numbers = (wavelength.trim().parse::<f64>().ok()?, weight.trim().parse::<f64>().ok()?);
        (numbers.0 > 0.0 && numbers.1 > 0.0 && numbers.1.is_finite()).then_some(numbers)
    };
    match text.split(',').map(part).collect::<Option<Vec<_>>>() {
        Some(lines) if lines.len() <= MOST_WAVELENGTHS => Ok(Spectrum(lines)),
        Some(_) => Err(format!("more than {MOST_WAVELENGTHS} wavelengths; give fewer")),
        None => Err(format!("{text:?} is not a list of NM:WEIGHT, positive numbers, as in 486:1,588:2")),
    }
}

/// Largest number of wavelengths.
const MOST_WAVELENGTHS: usize = 64;

/// An image point of a lens, with the object point that is imaged there.
struct ImagePoint {
    /// The lens at each wavelength, and the weights.
    lenses: Vec<(Lens, f64)>,
    /// The optical properties of each lens's surfaces; `None` if transmission is ignored.
    surfaces: Option<Vec<Surfaces>>,
    name: String,
    film_distance: f64,
    object_distance: f64,
    object: ObjectPoint,
    /// The point on the film, mm from its centre, and the plane that touches the film there.
    at: [f64; 2],
    film: FilmPlane,
    sampling: Sampling,
}

impl From<WaveError> for Failure {
    fn from(error: WaveError) -> Self {
        Self::Other(error.to_string())
    }
}

impl ImagePoint {
    /// Opens the lens and finds the object point.
    ///
    /// # Errors
    /// There is no such lens, it makes no image, or the point has no chief ray.
    fn of(args: &PointArgs) -> Result<Self, Failure> {
        let opened = args.lens.open_with(GROUPS)?;
        let film_distance = opened.film_distance()?;
        let lens = &opened.lens;
        let ([x, y], ahead, axes) = opened.film_surface()?.tangent(args.at);
        if !(ahead < film_distance) {
            let reason = if ahead.is_nan() {
                "lies beyond the sphere along which the film is curved"
            } else {
                "lies in the lens, into which the film is tilted or curved"
            };
            return Err(Failure::Other(format!(
                "the image point {reason}; give --at a point nearer the film's centre, or a flatter film"
            )));
        }
        // Object distances are from the plane through the film's centre; film that is tilted or curved is in focus at
        // another distance at each of its points.
        let in_focus = || {
            let distance = Focus::new(lens).ok()?.object_distance(film_distance - ahead)?;
            Some(distance + ahead)
        };
        let object_distance = args.object_distance.or_else(in_focus).unwrap_or(f64::INFINITY);
        // Rounding makes of an object at infinity one that is very far away.
        let object_distance =
            if object_distance > FAR * film_distance { f64::INFINITY } else { object_distance };
        let film = lens.rear().vertex - film_distance;
        if !(object_distance > -film) {
            return Err(Failure::Other(format!(
                "the object, {} mm from the film, is not in front of the lens, which begins {} mm from the film; give another \
                 --object-distance or --film-distance",
                fixed(object_distance, 3),
                fixed(-film, 3)
            )));
        }
        let point = [x, y, film + ahead];
        let object = object_of(lens, point, object_distance - ahead)?;
        let lenses = match &args.spectrum {
            None => vec![(opened.lens.clone(), 1.0)],
            Some(Spectrum(lines)) => {
                let at =
                    |(wavelength, weight): &(f64, f64)| Ok((opened.at_wavelength(*wavelength)?, *weight));
                lines.iter().map(at).collect::<Result<_, Failure>>()?
            }
        };
        let surfaces = opened
            .coatings()?
            .map(|coatings| lenses.iter().map(|(lens, _)| Surfaces::of_each(lens, &coatings)).collect());
        Ok(Self {
            lenses,
            surfaces,
            name: lens.name.clone(),
            film_distance,
            object_distance,
            object,
            at: args.at,
            film: FilmPlane { point, axes },
            sampling: Sampling { across: args.rays },
        })
    }

    /// Returns the wavefronts of all wavelengths about the image point of the first one, with the film moved by
    /// `defocus` mm away from the lens.
    fn wavefronts(&self, sampling: Sampling, defocus: f64) -> Result<Vec<(f64, Wavefront)>, WaveError> {
        let mut image = None;
        let at = |(i, (lens, weight)): (usize, &(Lens, f64))| {
            let [x, y, z] = self.film.point;
            let plane = FilmPlane { point: [x, y, z - defocus], ..self.film };
            let surfaces = self.surfaces.as_ref().map(|all| &all[i]);
            let wavefront = Wavefront::about(lens, surfaces, self.object, &plane, sampling, image)?;
            image = Some(wavefront.image);
            Ok((*weight, wavefront))
        };
        self.lenses.iter().enumerate().map(at).collect()
    }

    /// Returns the image point of a wavefront, mm from the film's centre.
    fn image(&self, wavefront: &Wavefront) -> [f64; 2] {
        let away = std::array::from_fn(|i| wavefront.image[i] - self.film.point[i]);
        let away = self.film.within(away);
        [self.at[0] + away[0], self.at[1] + away[1]]
    }

    /// Returns the facts of a wavefront as JSON.
    fn json(&self, wavefront: &Wavefront) -> Value {
        let (centre, radius) = wavefront.circle();
        json!({
            "name": self.name,
            "wavelengths": self.lenses.iter().map(|(lens, _)| lens.wavelength).collect::<Vec<_>>(),
            "weights": self.lenses.iter().map(|(_, weight)| weight).collect::<Vec<_>>(),
            "film_distance": self.film_distance,
            "object_distance_mm": Some(self.object_distance).filter(|distance| distance.is_finite()),
            "image_point_mm": self.image(wavefront),
            "rms_waves": wavefront.rms(),
            "peak_to_valley_waves": wavefront.peak_to_valley(),
            "strehl": wavefront.strehl(),
            "fnumber_of_cone": 0.5 / radius,
            "zernike_circle": { "centre": centre, "radius": radius },
            "zernike_noll_waves": wavefront.zernike(Ordering::Noll, ZERNIKES),
            "zernike_fringe_waves": wavefront.zernike(Ordering::Fringe, ZERNIKES),
            "seidel_waves": self.seidel(wavefront.wavelength),
        })
    }

    /// Returns the Seidel sums of each surface in waves; `None` for a lens that has none.
    fn seidel(&self, wavelength: f64) -> Option<Vec<[f64; 5]>> {
        let sums = seidel::sums(&self.lenses[0].0, &self.object)?;
        Some(sums.into_iter().map(|surface| surface.map(|sum| sum / wavelength)).collect())
    }

    /// Returns the facts of a wavefront as text.
    fn text(&self, wavefront: &Wavefront) -> String {
        let object = if self.object_distance.is_finite() {
            format!("{} mm in front of the film", fixed(self.object_distance, 1))
        } else {
            "at infinity".to_owned()
        };
        let [x, y] = self.image(wavefront).map(|part| fixed(part, 4));
        let wavelengths: Vec<String> =
            self.lenses.iter().map(|(lens, _)| as_given(lens.wavelength)).collect();
        format!(
            "image point       x {x} mm, y {y} mm, film {} mm behind the last vertex\n\
             object            {object}\n\
             wavelength        {} nm\n\
             wavefront         RMS {} waves, peak to valley {} waves at {} nm\n\
             Strehl ratio      {} at the image point\n\
             f-number          {} of the cone\n",
            fixed(self.film_distance, 4),
            wavelengths.join(", "),
            fixed(wavefront.rms(), 4),
            fixed(wavefront.peak_to_valley(), 3),
            as_given(self.lenses[0].0.wavelength),
            fixed(wavefront.strehl(), 4),
            fixed(0.5 / wavefront.circle().1, 3),
        )
    }
}

/// Object distance, in film distances, beyond which an object counts as at infinity.
const FAR: f64 = 1e9;
/// Number of Zernike coefficients.
const ZERNIKES: usize = 37;
/// Largest error of an answer, relative to its peak or as a contrast, that is not called out.
const VALID: f64 = 0.01;

/// Returns the warning of a result whose sampling does not suffice.
fn warn_unless_valid(error: f64, rays: usize) {
    if !(error <= VALID) {
        crate::console::warn(&format!(
            "the result is not valid: with three quarters of the rays it differs by {}; give --rays {}, or a point that is \
             less out of focus",
            fixed(error, 3),
            (2 * rays).min(2048)
        ));
    }
}
