//! The lens of a command: its name, its settings and the position of its film. The library defines the parameters and
//! the camera that they make.

use super::film::OwnFilm;
use super::parameters::{ParameterFlags, capitalised, long_help};
use crate::console::{note, warn};
use crate::failure::Failure;
use clap::{ArgMatches, Command};
use realistic_camera::{
    FilmSurface, Host, Level, PARAMETERS, Parameters, Raster, blades, coatings, film_distance, film_surface,
    group_reach, open_lens, stop_picture,
};
use realistic_optics::imaging::{focus::Conjugates, open::StopSize};
use realistic_optics::lens::Lens;
use realistic_optics::prescription::{MAX_ARCHIVE_BYTES, Prescription, SurfaceCoating};
use std::io::{self, Read as _};
use std::sync::OnceLock;

/// The lens and every parameter, for commands whose cameras use them all.
#[derive(clap::Args, Clone, Debug)]
pub struct CameraChoice {
    /// Lens: a file, - for standard input, or a catalogue name; NAME@35mm scales it
    #[arg(value_name = "LENS")]
    lens: Option<String>,
    #[command(flatten)]
    flags: ParameterFlags,
}

/// The lens and its parameters for commands that analyse a lens and need no camera.
#[derive(Clone, Debug)]
pub struct LensChoice(CameraChoice);

/// Camera parameters that apply to a lens without a camera.
const LENS_PARAMETERS: [&str; 12] = [
    "lens_file",
    "glass_catalog",
    "strict",
    "film_distance",
    "focus_distance",
    "focus_by",
    "zoom",
    "aperture_diameter",
    "fnumber",
    "film_diagonal",
    "wavelength",
    "mm_per_unit",
];

/// Parameters of the shape of the stop's opening, which some commands use, too.
pub const STOP_SHAPE: &[&str] =
    &["blades", "blade_rotation", "blade_curvature", "stop_picture", "stop_picture_gain"];

/// Parameter of the light that surfaces transmit, which some commands use, too.
pub const TRANSMISSION: &[&str] = &["transmission"];

/// Parameters of film that is not flat and centred on the axis, which some commands use, too.
pub const POSED_FILM: &[&str] =
    &["film_shift_x", "film_shift_y", "film_tilt_x", "film_tilt_y", "film_curvature_radius"];

impl clap::Args for LensChoice {
    fn augment_args(command: Command) -> Command {
        // Other parameters are accepted with a warning, so that the same arguments work for every command.
        let unused = |id: &str| PARAMETERS.iter().any(|row| row.name == id) && !LENS_PARAMETERS.contains(&id);
        CameraChoice::augment_args(command).mut_args(|arg| {
            match arg.get_id().as_str() {
                id if unused(id) => arg.hide(true),
                // Without a lens, a camera uses the default one; these commands require a lens.
                "lens_file" => {
                    let help = Parameters::find("lens_file").map_or("", |row| row.help);
                    arg.long_help(format!("{}; no default", capitalised(help)))
                }
                _ => arg,
            }
        })
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl clap::FromArgMatches for LensChoice {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        CameraChoice::from_arg_matches(matches).map(Self)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        self.0.update_from_arg_matches(matches)
    }
}

/// Returns the arguments of a command that uses groups of parameters besides those of every lens; its help lists them.
pub fn with_groups(command: Command, groups: &[&[&'static str]]) -> Command {
    groups.concat().into_iter().fold(command, |command, name| command.mut_arg(name, |arg| arg.hide(false)))
}

/// Returns the arguments of a command that renders one scene and focuses and places the camera for it.
pub fn with_scene_defaults(command: Command) -> Command {
    const FOCUS: &str = "focused on the scene's subject; a lens that cannot focus so near is moved back";
    const WINDOW: &str = "the width that a 40 mm lens sees at the scene's subject";
    with_defaults(command, [("film_distance", FOCUS), ("focus_distance", FOCUS), ("screen_window", WINDOW)])
}

/// Returns the arguments of a command whose pictures each have their own focus.
pub fn with_stack_defaults(command: Command) -> Command {
    const FOCUS: &str = "the range of --from and --to, which replace it";
    with_defaults(command, [("film_distance", FOCUS), ("focus_distance", FOCUS)])
}

fn with_defaults<const N: usize>(command: Command, defaults: [(&str, &'static str); N]) -> Command {
    defaults.into_iter().fold(command, |command, (name, default)| {
        let row = Parameters::find(name).expect("a parameter of the table");
        command.mut_arg(name, |arg| arg.long_help(long_help(row, default)))
    })
}

/// The lens name for standard input.
pub const PIPED: &str = "-";

/// Reads the lens file from standard input, once and up to the largest allowed size.
///
/// # Errors
/// It cannot be read.
pub fn standard_input() -> Result<&'static [u8], String> {
    static READ: OnceLock<io::Result<Vec<u8>>> = OnceLock::new();
    let read = READ.get_or_init(|| {
        let mut bytes = Vec::new();
        // One byte more than the limit of the largest kind shows that the file is too large.
        io::stdin().lock().take(MAX_ARCHIVE_BYTES + 1).read_to_end(&mut bytes).map(|_| bytes)
    });
    read.as_deref().map_err(|error| format!("cannot read a lens from standard input: {error}"))
}

impl CameraChoice {
    /// Makes a choice from flags alone.
    pub fn of_flags(flags: &ParameterFlags) -> Self {
        Self { lens: None, flags: flags.clone() }
    }

    /// Returns all parameters given, including the lens.
    ///
    /// # Errors
    /// Two lenses are given.
    pub fn parameters(&self) -> Result<Parameters, Failure> {
        let mut parameters = self.flags.parameters().clone();
        if let Some(lens) = &self.lens {
            if let Some(other) = &parameters.lens_file {
                return Err(Failure::Usage(format!(
                    "the lens is given twice, as \"{lens}\" and by its flag as \"{other}\"; give it once"
                )));
            }
            parameters.lens_file = Some(lens.clone());
        }
        Ok(parameters)
    }

    /// Returns [`CameraChoice::parameters`] for a command that requires a lens.
    ///
    /// # Errors
    /// Two lenses are given, or none.
    pub fn with_a_lens(&self) -> Result<Parameters, Failure> {
        let parameters = self.parameters()?;
        match parameters.lens_file {
            Some(_) => Ok(parameters),
            None => Err(Failure::Usage(
                "which lens? Give a file, - for standard input, or a name that `realistic lens --list` shows, \
                 such as dgauss.50mm"
                    .to_owned(),
            )),
        }
    }

    /// Returns names and values as they were written, without the lens.
    pub fn given(&self) -> impl Iterator<Item = (&'static str, &str)> {
        self.flags.given().filter(|(name, _)| *name != "lens_file")
    }

    /// Whether a lens is given.
    pub fn has_lens(&self) -> bool {
        self.lens.is_some() || self.flags.parameters().lens_file.is_some()
    }
}

/// Makes the host of a camera with these parameters; a piped lens moves from the parameters to the host.
///
/// # Errors
/// Standard input cannot be read.
pub fn host(parameters: &mut Parameters, raster: Raster) -> Result<Host, Failure> {
    let mut host = Host::new(raster, None);
    if parameters.lens_file.as_deref() == Some(PIPED) {
        parameters.lens_file = None;
        let text = standard_input().map_err(Failure::Other)?;
        host.lens_text = Some(("standard input".to_owned(), text.to_vec()));
    }
    Ok(host)
}

/// Sizes the film to the lens's own image if no size is given, and prints a note if this size is not the library's
/// default.
pub fn size_film(parameters: &mut Parameters, host: &Host) {
    let has_film = |model| Parameters::find("film_diagonal").is_some_and(|row| row.models.contains(&model));
    if parameters.film_diagonal.is_some() || !has_film(parameters.model.unwrap_or_default()) {
        return;
    }
    // Without a lens, building the camera reports the reason.
    if let Some(own) = OwnFilm::of(parameters, host) {
        if !own.is_default() {
            note(&own.to_string());
        }
        parameters.film_diagonal = Some(own.diagonal);
    }
}

/// A lens that was found and set up.
pub struct OpenedLens {
    /// Description of the lens.
    pub prescription: Prescription,
    /// The lens, focused by its groups if requested.
    pub lens: Lens,
    /// The requested parameters.
    parameters: Parameters,
    host: Host,
}

impl LensChoice {
    /// Whether a lens or any of its parameters is given.
    pub fn is_given(&self) -> bool {
        self.0.has_lens() || self.0.given().next().is_some()
    }

    /// Whether the lens comes from standard input.
    pub fn is_piped(&self) -> bool {
        self.0.parameters().is_ok_and(|parameters| parameters.lens_file.as_deref() == Some(PIPED))
    }

    /// Removes the positional word from the choice and returns it for another use, if a flag gives the lens.
    pub fn word_beside_a_flag(&mut self) -> Option<String> {
        self.0.flags.parameters().lens_file.as_ref()?;
        self.0.lens.take()
    }

    /// Finds the lens; warnings go to standard error.
    ///
    /// # Errors
    /// As for [`open_lens`].
    pub fn open(&self) -> Result<OpenedLens, Failure> {
        self.open_with(&[])
    }

    /// Finds the lens as [`LensChoice::open`] does, for a command that uses groups of parameters besides those of every lens.
    ///
    /// # Errors
    /// As for [`open_lens`], and with [`STOP_SHAPE`] as for [`blades`] and [`stop_picture`].
    pub fn open_with(&self, groups: &[&[&str]]) -> Result<OpenedLens, Failure> {
        let mut opened = self.open_using(&[&LENS_PARAMETERS, &groups.concat()[..]].concat())?;
        if groups.contains(&STOP_SHAPE) {
            let OpenedLens { prescription, lens, parameters, host } = &mut opened;
            lens.set_blades(blades(parameters, prescription)?);
            if let Some(picture) = stop_picture(parameters, prescription, host, &mut log)? {
                lens.add_picture(picture);
            }
        }
        Ok(opened)
    }

    /// Finds the lens as its file describes it, without any other setting.
    ///
    /// # Errors
    /// As for [`open_lens`].
    pub fn open_as_it_is(&self) -> Result<OpenedLens, Failure> {
        self.open_using(&["glass_catalog", "strict"])
    }

    /// Finds the lens with the parameters in `used` and warns of others. Film that is shifted, tilted or curved is
    /// refused by commands that place a film: their film is flat and centred on the axis.
    fn open_using(&self, used: &[&str]) -> Result<OpenedLens, Failure> {
        let places_film = used.contains(&"film_distance");
        let lens_file = self.0.with_a_lens()?.lens_file;
        let mut parameters = Parameters { lens_file, ..Parameters::default() };
        let mut posed = Parameters::default();
        for (name, value) in self.0.given() {
            if used.contains(&name) {
                parameters.set_from_text(name, value)?;
            } else if places_film && POSED_FILM.contains(&name) {
                posed.set_from_text(name, value)?;
                let film = film_surface(&posed)?;
                if !film.is_across() || film.shift() != [0.0; 2] {
                    return Err(Failure::Usage(format!(
                        "this command has flat film, centred on the axis: leave out \"{name}\", or use `realistic \
                         render`, `plan`, `psf` or `mtf`"
                    )));
                }
            } else {
                warn(&format!("\"{name}\" changes nothing here; leave it out"));
            }
        }
        let host = host(&mut parameters, Raster { xres: 1, yres: 1 })?;
        let (prescription, lens) = open_lens(&parameters, &host, &mut log)?;
        Ok(OpenedLens { prescription, lens, parameters, host })
    }
}

/// Prints a message of the library.
fn log(level: Level, message: &str) {
    match level {
        Level::Info => note(message),
        Level::Warning | Level::Error => warn(message),
    }
}

impl OpenedLens {
    /// Returns the requested parameters.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// Returns the requested size of the stop.
    pub fn stop(&self) -> StopSize {
        match (self.parameters.aperture_diameter, self.parameters.fnumber) {
            (Some(diameter), _) => StopSize::Diameter(diameter),
            (None, Some(number)) => StopSize::FNumber(number),
            (None, None) => StopSize::Listed,
        }
    }

    /// Whether the film's position or the plane in focus is given.
    pub fn is_placed(&self) -> bool {
        let Parameters { film_distance, focus_distance, focus_by, .. } = &self.parameters;
        film_distance.is_some() || focus_distance.is_some() || focus_by.is_some()
    }

    /// Returns the coatings of the surfaces, from the scene on; `None` if transmission is ignored.
    ///
    /// # Errors
    /// As for [`coatings`].
    pub fn coatings(&self) -> Result<Option<Vec<SurfaceCoating>>, Failure> {
        Ok(coatings(self.parameters.transmission.unwrap_or_default(), &self.prescription)?)
    }

    /// Returns the distance from last vertex to film, mm.
    ///
    /// # Errors
    /// As for [`film_distance`].
    pub fn film_distance(&self) -> Result<f64, Failure> {
        Ok(film_distance(&self.parameters, &self.lens)?)
    }

    /// Returns the surface of the film.
    ///
    /// # Errors
    /// As for [`film_surface`].
    pub fn film_surface(&self) -> Result<FilmSurface, Failure> {
        Ok(film_surface(&self.parameters)?)
    }

    /// Returns the film distance, mm; `None` for a lens that makes no image, if no position was requested.
    ///
    /// # Errors
    /// As for [`film_distance`], if a position was requested.
    pub fn film_distance_if_any(&self) -> Result<Option<f64>, Failure> {
        match self.film_distance() {
            Err(failure) if self.is_placed() => Err(failure),
            distance => Ok(distance.ok()),
        }
    }

    /// Returns the lens focused on a plane `distance` mm in front of the film instead, and its film distance, mm.
    ///
    /// # Errors
    /// As for [`open_lens`] and [`film_distance`].
    pub fn focused_on(&self, distance: f64) -> Result<(Lens, f64), Failure> {
        let mut parameters = Parameters { film_distance: None, ..self.parameters.clone() };
        parameters.focus_distance = Some(distance / parameters.mm_per_unit.unwrap_or(1.0));
        let (_, lens) = open_lens(&parameters, &self.host, &mut |_, _| ())?;
        let film_distance = film_distance(&parameters, &lens)?;
        Ok((lens, film_distance))
    }

    /// Returns the lens with the same settings at another wavelength, nm.
    ///
    /// # Errors
    /// As for [`open_lens`].
    pub fn at_wavelength(&self, wavelength: f64) -> Result<Lens, Failure> {
        let parameters = Parameters { wavelength: Some(wavelength), ..self.parameters.clone() };
        Ok(open_lens(&parameters, &self.host, &mut |_, _| ())?.1)
    }

    /// Returns the film's diagonal, mm: the given one, or else the one that [`size_film`] chooses.
    pub fn film_diagonal(&self) -> f64 {
        let mut parameters = self.parameters.clone();
        size_film(&mut parameters, &self.host);
        parameters.film_diagonal.unwrap_or(OwnFilm::DEFAULT.diagonal)
    }

    /// Returns the nearest and the farthest plane that the groups focus on.
    ///
    /// # Errors
    /// As for [`group_reach`].
    pub fn group_reach(&self) -> Result<[Conjugates; 2], Failure> {
        Ok(group_reach(&self.parameters, &self.host)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Parses the command line of a command with a lens.
    fn choice(words: &[&str]) -> CameraChoice {
        #[derive(clap::Parser)]
        struct Command {
            #[command(flatten)]
            camera: CameraChoice,
        }
        <Command as clap::Parser>::try_parse_from([&["test"], words].concat()).unwrap().camera
    }

    #[test]
    fn the_lens_is_a_word_or_a_flag_and_given_once() {
        let lens =
            |words: &[&str]| choice(words).parameters().ok().and_then(|parameters| parameters.lens_file);
        for words in
            [&["a.dat"][..], &["--lens", "a.dat"], &["--lens-file", "a.dat"], &["--param", "lensfile=a.dat"]]
        {
            assert_eq!(lens(words).as_deref(), Some("a.dat"), "{words:?}");
            assert!(choice(words).has_lens() && choice(words).with_a_lens().is_ok());
        }
        assert_eq!(lens(&["a.dat", "--lens", "b.dat"]), None);
        assert!(matches!(choice(&[]).with_a_lens(), Err(Failure::Usage(_))));
    }
}
