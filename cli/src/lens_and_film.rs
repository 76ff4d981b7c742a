//! What several commands are told in the same words: the lens, and the film. What they take, and the camera that they
//! make of it, are the library's to say.

use crate::failure::Failure;
use crate::image::LARGEST_SIDE;
use realistic::camera::{
    CameraError, Film, FocusBy, Host, Level, Parameter, Parameters, Raster, UnknownName, film_distance,
    group_reach, open_lens,
};
use realistic::imaging::focus::Conjugates;
use realistic::lens::{Lens, open::StopSize};
use realistic::message::cut;
use realistic::prescription::{MAX_FILE_BYTES, Prescription};
use std::io::{self, Read as _, Write as _};
use std::sync::OnceLock;

/// Which lens, at which stop and wavelength.
#[derive(clap::Args, Debug)]
pub struct LensChoice {
    /// Lens: a file, - for standard input, or a name of the catalogue; NAME@35mm scales it to that focal length
    #[arg(value_name = "LENS")]
    lens: String,
    #[arg(long, value_name = "FILE", help = glasscatalog_help())]
    glasscatalog: Option<String>,
    #[arg(long, value_name = "NM", allow_negative_numbers = true, help = help("wavelength"))]
    wavelength: Option<f64>,
    #[arg(long, value_name = "MM", allow_negative_numbers = true, help = help("aperture_diameter"),
          conflicts_with = "fnumber")]
    aperture_diameter: Option<f64>,
    #[arg(long, value_name = "N", allow_negative_numbers = true, help = help("fnumber"))]
    fnumber: Option<f64>,
    #[arg(long, value_name = "MM or NAME", allow_negative_numbers = true, help = help("zoom"))]
    zoom: Option<String>,
}

/// The lens that stands for standard input.
pub const PIPED: &str = "-";

/// The lens file that comes by standard input, as far as one may be long; read once.
///
/// # Errors
/// It cannot be read.
pub fn standard_input() -> Result<&'static [u8], String> {
    static READ: OnceLock<io::Result<Vec<u8>>> = OnceLock::new();
    let read = READ.get_or_init(|| {
        let mut bytes = Vec::new();
        // One more than there may be tells that it is too large.
        io::stdin().lock().take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes).map(|_| bytes)
    });
    read.as_deref().map_err(|error| format!("cannot read a lens from standard input: {error}"))
}

/// The table's row of a parameter that is a flag, too.
fn row(name: &str) -> &'static Parameter {
    Parameters::find(name).expect("a parameter of the table")
}

/// What the table says about it, as help on the flag.
pub fn help(name: &str) -> String {
    let text = row(name).description().replace('`', "");
    let (first, rest) = text.split_at(1);
    first.to_uppercase() + rest
}

/// The help on `--glasscatalog`.
pub fn glasscatalog_help() -> String {
    help("glasscatalog")
}

/// Gives a camera a lens: a name, or [`PIPED`].
fn give_lens(
    lens: &str,
    glasscatalog: Option<&str>,
    parameters: &mut Parameters,
    host: &mut Host,
) -> Result<(), Failure> {
    if lens == PIPED {
        host.lens_text =
            Some(("standard input".to_owned(), standard_input().map_err(Failure::Other)?.to_vec()));
    } else {
        parameters.specfile = Some(lens.to_owned());
    }
    parameters.glasscatalog = glasscatalog.map(str::to_owned);
    Ok(())
}

/// Finds a lens, with what else `more` asks for; warnings go to standard error.
///
/// # Errors
/// As [`open_lens`].
pub fn open(
    lens: &str,
    glasscatalog: Option<&str>,
    more: impl FnOnce(&mut Parameters),
) -> Result<(Prescription, Lens), Failure> {
    let mut parameters = Parameters::default();
    // A lens needs no film.
    let mut host = Host::new(Raster { xres: 1, yres: 1 }, None);
    give_lens(lens, glasscatalog, &mut parameters, &mut host)?;
    more(&mut parameters);
    open_lens(&parameters, &host, &mut |_: Level, message: &str| warn(message))
        .map_err(|error| Failure::Other(error.to_string()))
}

impl LensChoice {
    /// Whether the lens comes by standard input.
    pub fn is_piped(&self) -> bool {
        self.lens == PIPED
    }

    /// How far it is to be stopped down.
    pub fn stop(&self) -> StopSize {
        match (self.aperture_diameter, self.fnumber) {
            (Some(diameter), _) => StopSize::Diameter(diameter),
            (None, Some(number)) => StopSize::FNumber(number),
            (None, None) => StopSize::Listed,
        }
    }

    /// Whether it is to be zoomed.
    pub fn is_zoomed(&self) -> bool {
        self.zoom.is_some()
    }

    /// Gives a camera this lens.
    ///
    /// # Errors
    /// Standard input cannot be read, or the lens be zoomed so.
    pub fn give(&self, parameters: &mut Parameters, host: &mut Host) -> Result<(), Failure> {
        give_lens(&self.lens, self.glasscatalog.as_deref(), parameters, host)?;
        parameters.wavelength = self.wavelength;
        parameters.aperture_diameter = self.aperture_diameter;
        parameters.fnumber = self.fnumber;
        if let Some(zoom) = &self.zoom {
            parameters.set_from_text("zoom", zoom)?;
        }
        Ok(())
    }

    /// Finds the lens, focused by its groups where `place` says so; warnings go to standard error.
    ///
    /// # Errors
    /// As [`open_lens`].
    pub fn open(&self, place: &FilmPlace) -> Result<(Prescription, Lens), Failure> {
        let (parameters, host) = self.camera(place)?;
        open_lens(&parameters, &host, &mut |_: Level, message: &str| warn(message))
            .map_err(|error| in_flags(&error))
    }

    /// The nearest plane and the farthest that its groups focus on.
    ///
    /// # Errors
    /// As [`group_reach`].
    pub fn group_reach(&self, place: &FilmPlace) -> Result<[Conjugates; 2], Failure> {
        let (parameters, host) = self.camera(place)?;
        group_reach(&parameters, &host).map_err(|error| in_flags(&error))
    }

    fn camera(&self, place: &FilmPlace) -> Result<(Parameters, Host), Failure> {
        let mut parameters = Parameters::default();
        // A lens needs no film.
        let mut host = Host::new(Raster { xres: 1, yres: 1 }, None);
        self.give(&mut parameters, &mut host)?;
        place.give(&mut parameters);
        Ok((parameters, host))
    }
}

/// Sets what `--param NAME=VALUE` says, each name once.
///
/// # Errors
/// No `=`, a name twice, or what [`Parameters::set_from_text`] refuses.
pub fn set_parameters(parameters: &mut Parameters, given: &[String]) -> Result<(), Failure> {
    let mut seen: Vec<&str> = Vec::new();
    for text in given {
        let Some((name, value)) = text.split_once('=') else {
            return Err(Failure::Usage(format!(
                "--param \"{}\" has no \"=\"; write --param NAME=VALUE, as in pupil=rear",
                cut(text)
            )));
        };
        if seen.contains(&name) {
            return Err(Failure::Usage(format!("parameter \"{name}\" is given twice; give it once")));
        }
        parameters.set_from_text(name, value)?;
        seen.push(name);
    }
    Ok(())
}

/// A warning on standard error.
pub fn warn(message: &str) {
    // A closed standard error leaves nobody to tell.
    let _ = writeln!(std::io::stderr(), "realistic: warning: {message}");
}

/// How large the film is.
#[derive(clap::Args, Debug)]
pub struct FilmSize {
    /// Diagonal of the film in mm
    #[arg(
        long = "filmdiag",
        value_name = "MM",
        allow_negative_numbers = true,
        default_value = row("filmdiag").default,
        value_parser = positive
    )]
    pub diagonal: f64,
}

/// The film behind the lens, and its pixels.
#[derive(clap::Args, Debug)]
pub struct FilmChoice {
    #[command(flatten)]
    extent: FilmSize,
    /// Pixels of the film
    #[arg(long, value_name = "WxH", default_value = "480x320", value_parser = size)]
    pub size: [u32; 2],
}

impl FilmChoice {
    /// Gives a camera's parameters this diagonal.
    pub fn give(&self, parameters: &mut Parameters) {
        parameters.filmdiag = Some(self.extent.diagonal);
    }

    /// The film.
    pub fn film(&self) -> Film {
        let [xres, yres] = self.size;
        Film::new(Raster { xres, yres }, self.extent.diagonal)
    }
}

/// Where the film is, and what moves to focus.
#[derive(clap::Args, Clone, Copy, Debug, Default)]
pub struct FilmPlace {
    /// Distance in mm from the last vertex to the film [default: the file's, or focused at infinity]
    #[arg(long, value_name = "MM", allow_negative_numbers = true, value_parser = positive, conflicts_with = "distance")]
    film_distance: Option<f64>,
    /// Focus here instead: distance in mm from the film to the object, or inf
    #[arg(long, value_name = "MM", allow_negative_numbers = true, value_parser = distance)]
    distance: Option<f64>,
    #[arg(long = "focusby", value_name = "film|group", help = help("focusby"), value_parser = focus_by)]
    focus_by: Option<FocusBy>,
}

impl FilmPlace {
    /// A place by the flags that a command names in its own way.
    pub fn new(film_distance: Option<f64>, distance: Option<f64>, focus_by: Option<FocusBy>) -> Self {
        Self { film_distance, distance, focus_by }
    }

    /// Whether anything of it is given.
    pub fn is_given(&self) -> bool {
        self.film_distance.is_some() || self.distance.is_some() || self.focus_by.is_some()
    }

    /// Gives a camera's parameters this place, in world units of a millimetre.
    pub fn give(&self, parameters: &mut Parameters) {
        parameters.filmdistance = self.film_distance;
        parameters.focusdistance = self.distance;
        parameters.focusby = self.focus_by;
    }

    /// Last vertex to film, mm.
    ///
    /// # Errors
    /// As [`film_distance`].
    pub fn film_distance(&self, lens: &Lens) -> Result<f64, Failure> {
        let mut parameters = Parameters::default();
        self.give(&mut parameters);
        film_distance(&parameters, lens).map_err(|error| in_flags(&error))
    }

    /// The same; `None` for a lens that makes no image, where no place was asked for.
    ///
    /// # Errors
    /// As [`film_distance`], where one was.
    pub fn film_distance_if_any(&self, lens: &Lens) -> Result<Option<f64>, Failure> {
        match self.film_distance(lens) {
            Err(failure) if self.is_given() => Err(failure),
            place => Ok(place.ok()),
        }
    }

    /// The failure of film that would lie in the rear element.
    pub fn in_lens(lens: &Lens, film_distance: f64) -> Failure {
        in_flags(&CameraError::film_in_lens(lens, film_distance))
    }
}

/// A camera's error in the words of the flags.
fn in_flags(error: &CameraError) -> Failure {
    let text = error.to_string();
    Failure::Other(
        text.replace("\"filmdistance\"", "--film-distance").replace("\"focusdistance\"", "--distance"),
    )
}

/// The number of a flag if it is in the range of a parameter.
fn in_range(text: &str, parameter: &str) -> Option<f64> {
    text.parse().ok().and_then(|number| row(parameter).check(number).ok())
}

/// A finite number of a flag.
pub fn finite(text: &str) -> Result<f32, String> {
    let number = text.parse().ok().filter(|number: &f32| number.is_finite());
    number.ok_or_else(|| "write a finite number".to_owned())
}

/// A positive finite number of a flag.
pub fn positive(text: &str) -> Result<f64, String> {
    in_range(text, "filmdistance").ok_or_else(|| "write a positive number".to_owned())
}

/// A distance of a flag: positive, and `inf` for infinity.
pub fn distance(text: &str) -> Result<f64, String> {
    in_range(text, "focusdistance").ok_or_else(|| "write a positive number of mm, or inf".to_owned())
}

/// 0 or a positive finite number of a flag.
pub fn not_negative(text: &str) -> Result<f64, String> {
    in_range(text, "tolerance").ok_or_else(|| "write 0 or a positive number".to_owned())
}

/// What moves to focus.
pub fn focus_by(text: &str) -> Result<FocusBy, String> {
    text.parse().map_err(|error: UnknownName| error.to_string())
}

/// `WxH` in pixels.
pub fn size(text: &str) -> Result<[u32; 2], String> {
    let side = |text: &str| {
        let side = text.parse().ok();
        side.filter(|side| (1..=LARGEST_SIDE).contains(side))
    };
    text.split_once('x')
        .and_then(|(width, height)| Some([side(width)?, side(height)?]))
        .ok_or_else(|| format!("write WIDTHxHEIGHT in pixels, each 1 to {LARGEST_SIDE}, as in 480x320"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic::camera::Pupil;

    #[test]
    fn sizes_are_two_numbers_of_pixels() {
        assert_eq!(size("480x320"), Ok([480, 320]));
        for text in ["480", "0x3", "3x", "3x-1", "99999x3", "3x3x3"] {
            assert!(size(text).is_err(), "{text}");
        }
    }

    #[test]
    fn lengths_are_positive_and_only_distances_infinite() {
        assert_eq!((positive("2.5"), not_negative("0")), (Ok(2.5), Ok(0.0)));
        assert_eq!(distance("inf"), Ok(f64::INFINITY));
        for text in ["-1", "nan", "far", "-inf"] {
            assert!(positive(text).is_err() && distance(text).is_err() && not_negative(text).is_err());
        }
        assert!(positive("inf").is_err() && not_negative("inf").is_err() && distance("0").is_err());
    }

    #[test]
    fn what_is_added_to_is_a_finite_number() {
        assert_eq!((finite("-1.5"), finite("0")), (Ok(-1.5), Ok(0.0)));
        for text in ["nan", "inf", "-inf", "1e39", "bright"] {
            assert_eq!(finite(text), Err("write a finite number".to_owned()), "{text}");
        }
    }

    #[test]
    fn parameters_go_by_name_each_once() {
        let set = |given: &[&str]| {
            let given: Vec<String> = given.iter().map(|text| (*text).to_owned()).collect();
            let mut parameters = Parameters::default();
            set_parameters(&mut parameters, &given).map(|()| parameters)
        };
        let refusal = |given: &[&str]| match set(given) {
            Err(Failure::Usage(message)) => message,
            other => panic!("{other:?}"),
        };
        let parameters = set(&["filmdistance=40.5", "pupil=disk"]).unwrap();
        assert_eq!((parameters.filmdistance, parameters.pupil), (Some(40.5), Some(Pupil::Disk)));
        assert!(refusal(&["fokus=3"]).contains("focusdistance"));
        assert!(refusal(&["filmdiag"]).contains("NAME=VALUE"));
        assert!(refusal(&["filmdiag=large"]).contains("a number"));
        assert!(refusal(&["filmdiag=35", "filmdiag=36"]).contains("twice"));
    }
}
