//! The session of every command that takes pictures. Options determine a loaded plugin, parameters and threads;
//! together with a scene, these determine a picture.

use super::autofocus::{Autofocus, Method};
use super::focus::{self, AxialRays};
use crate::arguments::{CameraChoice, finite, host, size, size_film, whole};
use crate::console;
use crate::failure::Failure;
use crate::host::plugin::{self, Camera, Connections, Plugin, ScenePoints};
use crate::host::render::{
    AdaptiveSampling, Dusk, EmitterPicture, Integrator, REACH, Settings, lamplight, noise, render, spectrum,
    trace,
};
use crate::host::scene::effects::{Effect, Effects};
use crate::host::scene::{Light, Scene};
use crate::image::{Curve, Filter, LARGEST_SIDE, Picture, Tone, check_memory};
use indicatif::{ProgressBar, ProgressStyle};
use rayon::ThreadPool;
use realistic_base::message::{as_given, short};
use realistic_camera::{
    CameraError, Exposure, Model, Parameters, Raster, Weighting, autofocus::Rule, film_distance, open_lens,
};
use realistic_lab::render::{Rays, Tally};
use realistic_optics::lens::first_order::FirstOrder;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Options common to the commands that render pictures.
#[derive(clap::Args, Debug)]
pub struct Options {
    /// Size of the picture in pixels
    #[arg(long, value_name = "WxH", default_value = "480x320", value_parser = size)]
    pub size: [u32; 2],
    /// Samples per pixel [default: 48; of the test card 128]
    ///
    /// This is a scale at dusk: a pixel takes 0.5 to 0.7 times as many on average, and more where their noise shows.
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = whole(1_u32, 16_384))]
    pub spp: Option<u32>,
    /// Threads [default: one per core]
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = whole(1_u16, 1024))]
    threads: Option<u16>,
    /// Exposure compensation of a .png in stops
    ///
    /// 0 shows a white card on the axis as white, or radiance 1 with --iso, --exposure-time, --exposure or
    /// --responsivity. At dusk it also changes which pixels get more samples.
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, allow_hyphen_values = true, value_parser = finite)]
    compensation: f32,
    /// The plugin to load
    ///
    /// [default: the file named by REALISTIC_PLUGIN, else that of this program's build, else the one beside this program or in
    /// ../lib]
    #[arg(long, value_name = "FILE")]
    plugin: Option<PathBuf>,
    /// Seed of the random numbers
    ///
    /// The same seed gives the same picture with any number of threads.
    #[arg(long, value_name = "N", default_value_t = 1, allow_hyphen_values = true, value_parser = whole(0, u64::MAX))]
    seed: u64,
}

/// All parts of a session except the scene and the camera.
pub struct Studio {
    /// Plugin that makes the cameras.
    pub plugin: Arc<Plugin>,
    /// Camera parameters given by the user.
    pub parameters: Parameters,
    /// Facts of the lens; `None` if only the plugin can find the lens.
    pub lens: Option<LensFacts>,
    /// Width and height of a picture in pixels.
    pub size: [u32; 2],
    pool: ThreadPool,
    progress: ProgressBar,
    messages: Mutex<Vec<String>>,
    compensation: f32,
    seed: u64,
}

/// Facts of a lens.
#[derive(Clone, Copy, Debug)]
pub struct LensFacts {
    /// Whether the lens has an index for each wavelength.
    pub is_dispersive: bool,
    /// Its squeeze ratio: focal length in y over that in x; 1 for a model without cylinders, NaN for an afocal lens.
    squeeze: f64,
}

/// The settings of one picture.
#[derive(Clone, Copy, Debug)]
pub struct ShotOptions {
    /// Samples per pixel.
    pub spp: u32,
    /// Number of wavelengths that make up the picture, each with its own samples; `None` for only the lens's own
    /// wavelength.
    pub wavelengths: Option<u32>,
    /// Width and height of the picture before the parameter `crop` cuts it; `None` for the session's.
    pub whole: Option<[u32; 2]>,
    /// Start of light paths.
    pub integrator: Integrator,
    /// Reconstruction filter.
    pub filter: Filter,
    /// Seed for a measurement of noise, in place of the session's; only the parts of the picture needed for it are
    /// rendered.
    pub probe: Option<u64>,
}

impl ShotOptions {
    /// Makes settings of a whole picture by paths from the camera, with `spp` samples per pixel.
    pub fn plain(spp: u32) -> Self {
        let (integrator, filter) = (Integrator::Path, Filter::Box);
        Self { spp, wavelengths: None, whole: None, integrator, filter, probe: None }
    }
}

/// Number of tiles per tile that measures the noise: a prime, so that the measured tiles are spread over the picture.
const PROBED: u32 = 37;

/// A finished picture.
pub struct Shot {
    /// The camera at the lens's own wavelength.
    pub camera: Camera,
    /// Irradiance on the film, in the part selected by `crop`.
    pub picture: Picture,
    /// Conversion to the screen's values.
    pub tone: Tone,
    /// Tally of the rays.
    pub tally: Tally,
    /// Time that the picture took.
    pub took: Duration,
}

/// Bytes per pixel during rendering and writing: in the tiles, in the whole picture, in the filter, and in a file.
const PER_PIXEL: u64 = 80;

impl Studio {
    /// Loads the plugin and reads the parameters. Unless given, the lens is the default one, and the film is that of
    /// the lens's own image.
    ///
    /// # Errors
    /// The parameters are invalid, or there is no plugin.
    pub fn open(camera: &CameraChoice, options: &Options) -> Result<Self, Failure> {
        let mut parameters = camera.parameters()?;
        let lens = examine_lens(&mut parameters)?;
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(options.threads.map_or(0, usize::from))
            .build()
            .map_err(|error| Failure::Other(format!("{error}; give fewer --threads")))?;
        Ok(Self {
            plugin: Arc::new(Plugin::load(&plugin::find(options.plugin.as_deref())?)?),
            parameters,
            lens,
            size: options.size,
            pool,
            progress: progress_bar(),
            messages: Mutex::default(),
            compensation: options.compensation,
            seed: options.seed,
        })
    }

    /// Prints a warning only once, because several pictures may cause the same one.
    pub fn warn(&self, message: &str) {
        self.once(message, console::warn);
    }

    /// Prints a note only once.
    fn note(&self, message: &str) {
        self.once(message, console::note);
    }

    fn once(&self, message: &str, print: fn(&str)) {
        let mut messages = self.messages.lock().unwrap_or_else(PoisonError::into_inner);
        if messages.iter().any(|before| before == message) {
            return;
        }
        messages.push(message.to_owned());
        self.progress.suspend(|| print(message));
    }

    /// Returns the width, in pixels, of a picture without the lens's squeeze, and the squeeze ratio.
    ///
    /// # Errors
    /// The lens does not squeeze the picture by as much as a pixel, or the picture is too large.
    pub fn desqueezed(&self) -> Result<(u32, f64), Failure> {
        let squeeze = self.lens.map_or(f64::NAN, |lens| lens.squeeze);
        let [width, height] = self.size;
        let wide = (f64::from(width) * squeeze).round();
        if !(wide > 0.0) || wide == f64::from(width) {
            return Err(Failure::Other(
                "--desqueeze needs a lens that squeezes the picture, such as anamorphic.42mm".to_owned(),
            ));
        }
        if wide > f64::from(LARGEST_SIDE) {
            return Err(Failure::Usage(format!(
                "without the squeeze of {} the picture is {wide} pixels wide, and {LARGEST_SIDE} is the limit; give a smaller \
                 --size",
                short(squeeze)
            )));
        }
        check_memory([wide as u32, height], PER_PIXEL)?;
        Ok((wide as u32, squeeze))
    }

    /// Returns the seed of the random numbers.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Returns the number of threads that render.
    pub fn threads(&self) -> usize {
        self.pool.current_num_threads()
    }

    /// Returns the film distance, mm, that focuses zones of the picture, each given as left, top, width and height.
    ///
    /// # Errors
    /// The plugin's error.
    pub fn autofocus(
        &self,
        parameters: &Parameters,
        scene: &Scene,
        zones: &[[f32; 4]],
        rule: Rule,
        method: Method,
    ) -> Result<f64, Failure> {
        let autofocus =
            Autofocus { plugin: &self.plugin, pool: &self.pool, scene, parameters, size: self.size };
        Ok(autofocus.film_distance(zones, rule, method, &|message| self.warn(message))?)
    }

    /// Takes a picture with the camera of these parameters, focused on the scene's subject unless the parameters give
    /// a focus.
    ///
    /// # Errors
    /// The plugin's error.
    pub fn take(
        &self,
        parameters: &Parameters,
        scene: &Scene,
        options: &ShotOptions,
    ) -> Result<Shot, Failure> {
        self.take_after(None, parameters, scene, options)
    }

    /// Measures the noise of a picture from parts of two pictures: the RMS error of a pixel divided by the mean of
    /// all pixels, both in linear light as displayed. Also returns the second picture.
    ///
    /// # Errors
    /// The plugin's error.
    pub fn noise(
        &self,
        parameters: &Parameters,
        scene: &Scene,
        options: &ShotOptions,
    ) -> Result<(f64, Shot), Failure> {
        let taken = |seed: u64| {
            let shot = self.take(parameters, scene, &ShotOptions { probe: Some(seed), ..*options })?;
            let shown = |colour: &[f32; 3]| colour.map(|value| shot.tone.shown(value));
            let pixels = shot.picture.pixels.iter().map(shown).collect();
            Ok::<_, Failure>((Picture { size: shot.picture.size, pixels }, shot))
        };
        let (one, _) = taken(self.seed)?;
        let (other, shot) = taken(self.seed.wrapping_add(1))?;
        let [noise, mean] = noise(&one, &other, PROBED);
        Ok((noise / mean, shot))
    }

    /// Takes a picture as [`Studio::take`] does. After another picture, whose camera is `before`, the lens need not
    /// be read and set up again.
    ///
    /// # Errors
    /// The plugin's error.
    pub fn take_after(
        &self,
        before: Option<&Camera>,
        parameters: &Parameters,
        scene: &Scene,
        options: &ShotOptions,
    ) -> Result<Shot, Failure> {
        if options.integrator == Integrator::Light {
            is_lamplit(parameters, scene, options)?;
        }
        if let (Some(wavelength), Some(count)) = (parameters.wavelength.map(as_given), options.wavelengths) {
            return Err(Failure::Usage(format!(
                "a picture in {count} wavelengths has no single \"wavelength\" ({wavelength} nm); leave \
                 --wavelength out, or --wavelengths"
            )));
        }
        let whole = options.whole.unwrap_or(self.size);
        let warn = |message: &str| self.warn(message);
        let (camera, back) = focus::build(&self.plugin, before, parameters, whole, scene, &warn)?;
        let scene = &scene.moved_back(back);
        if back > 0.0 {
            self.note(&format!(
                "the lens cannot focus so near as the scene's subject: the camera stands {} mm farther back",
                short(f64::from(back))
            ));
        }
        let [x0, y0, x1, y1] = options.filter.around(camera.info()?.crop, whole);
        let reach = if scene.light == Light::Dusk { REACH } else { 0 };
        let [x0, y0] = [x0, y0].map(|at| at.saturating_sub(reach));
        let [x1, y1] = [(x1 + reach).min(whole[0]), (y1 + reach).min(whole[1])];
        let settings = Settings {
            corner: [x0, y0],
            mm_per_unit: parameters.mm_per_unit.unwrap_or(1.0) as f32,
            stride: options.probe.map_or(1, |_| PROBED),
            ..Settings::plain([x1 - x0, y1 - y0], options.spp, options.probe.unwrap_or(self.seed))
        };
        check_memory(settings.size, PER_PIXEL)?;
        let shutter = [parameters.shutter_open.unwrap_or(0.0), parameters.shutter_close.unwrap_or(1.0)];
        let shutter = shutter.map(|time| time as f32);
        let joined =
            |scene_points: &ScenePoints, found: &mut Connections| camera.connect(scene_points, found);
        let scale = self.compensation.exp2() / white_level(&camera, parameters, whole)?;
        let curve = if scene.light == Light::Dusk { Curve::Film } else { Curve::Straight };
        let tone = Tone { scale, curve };
        let start = Instant::now();
        let (picture, tally) = match options.wavelengths {
            None if options.integrator == Integrator::Light => {
                self.pool.install(|| trace(joined, scene, &settings, shutter, &self.progress))?
            }
            None => {
                let rays = |rays: Rays<'_>| camera.rays(rays);
                let taken = || -> Result<_, plugin::PluginError> {
                    if !are_lamps_joined(scene, &camera) {
                        return render(rays, scene, &settings, &self.progress);
                    }
                    let dusk = Dusk::of(scene, &[]);
                    let eye = [3, 7, 11].map(|at| scene.pose[at]).into();
                    let emitter_picture =
                        EmitterPicture { dusk: &dusk, settings: &settings, whole, shutter, eye };
                    let plans = emitter_picture.plan(joined)?;
                    let emitters: Vec<usize> = plans.iter().map(|plan| plan.emitter).collect();
                    let (emitted, _) = emitter_picture.take(&plans, joined)?;
                    let adaptive =
                        Some(AdaptiveSampling { tone, beside: &emitted, corner: settings.corner, whole });
                    let settings = Settings { joined: &emitters, adaptive, ..settings };
                    render(rays, scene, &settings, &self.progress)
                };
                self.pool.install(taken)?
            }
            Some(count) => {
                let mut sum = (Picture::plain(settings.size, [0.0; 3]), Tally::default());
                for (wavelength, band) in spectrum::bands(count) {
                    // First-order models have one fixed wavelength.
                    let there = match parameters.model.unwrap_or_default() {
                        Model::Lens => None,
                        _ => Some(at_wavelength(parameters, &camera, wavelength)?),
                    };
                    // Warnings were already printed for the first camera.
                    let new = |there| Camera::new(&self.plugin, None, &there, whole, &scene.pose, &|_| ());
                    let there = there.map(new).transpose()?;
                    let rays = |rays: Rays<'_>| match &there {
                        Some(camera) => camera.rays(rays),
                        None => camera.rays_at(wavelength as f32, rays),
                    };
                    let (picture, tally) =
                        self.pool.install(|| render(rays, scene, &settings, &self.progress))?;
                    spectrum::add(&mut sum.0, band, &picture);
                    sum.1.add(&tally);
                }
                sum
            }
        };
        let picture = options.filter.applied(&picture, [x0, y0], camera.info()?.crop);
        let took = start.elapsed();
        self.progress.finish_and_clear();
        Ok(Shot { camera, picture, tone, tally, took })
    }
}

/// Whether lamps are connected to a camera: in scenes at dusk, if the camera has importance.
fn are_lamps_joined(scene: &Scene, camera: &Camera) -> bool {
    let mut scene_points = ScenePoints::default();
    scene_points.push([0.0, 0.0, 1000.0], [0.5; 2], 0.5);
    let has_importance = || camera.connect(&scene_points, &mut Connections::default()).is_ok();
    scene.light == Light::Dusk && has_importance()
}

/// Checks that paths from the lamps can show everything in a scene.
fn is_lamplit(parameters: &Parameters, scene: &Scene, options: &ShotOptions) -> Result<(), Failure> {
    let what = if scene.light != Light::Lamps {
        "sun and sky, which have no place to begin paths at; give --scene night".to_owned()
    } else if let Some(finish) = lamplight::not_matte(scene) {
        format!("surfaces with the finish {finish:?}, which no path from a lamp to the lens meets")
    } else if parameters.crop.is_some() {
        "a \"crop\", and paths from the lamps lead to the whole picture".to_owned()
    } else if options.wavelengths.is_some() {
        "several wavelengths, and rays from the scene have the camera's own".to_owned()
    } else {
        return Ok(());
    };
    Err(Failure::Usage(format!("--integrator light cannot render this scene: it has {what}")))
}

/// Returns the parameters of the camera at another wavelength, with the film where the camera's own wavelength is in
/// focus.
fn at_wavelength(parameters: &Parameters, camera: &Camera, wavelength: f64) -> Result<Parameters, Failure> {
    let film_distance = Some(camera.info()?.film_distance);
    let wavelength = Some(wavelength);
    Ok(Parameters { wavelength, focus_distance: None, film_distance, ..parameters.clone() })
}

/// Returns the parameters with the lens stopped down if depth of field is off.
///
/// # Errors
/// The user also gives a stop.
pub fn stopped_down(parameters: &Parameters, effects: &Effects) -> Result<Parameters, Failure> {
    const SMALL: f64 = 22.0;
    let mut parameters = parameters.clone();
    if effects.has(Effect::Dof) {
        return Ok(parameters);
    }
    if parameters.fnumber.is_some() || parameters.aperture_diameter.is_some() {
        return Err(Failure::Usage(
            "without depth of field the lens is stopped down as far as it needs to be; leave out \
             \"fnumber\" and \"aperture_diameter\", or add dof to --effects"
                .to_owned(),
        ));
    }
    parameters.fnumber = Some(SMALL);
    Ok(parameters)
}

/// Rejects a crop, for pictures that go on a sheet.
///
/// # Errors
/// The user gives a crop.
pub fn whole_only(parameters: &Parameters) -> Result<(), Failure> {
    match parameters.crop {
        Some(_) => Err(Failure::Usage(
            "the pictures of a sheet are whole ones; leave out \"crop\", or render one picture".to_owned(),
        )),
        None => Ok(()),
    }
}

/// Returns the film's irradiance for a scene of radiance 1; 1 for a film that is exposed by its parameters.
fn white_level(camera: &Camera, parameters: &Parameters, size: [u32; 2]) -> Result<f32, Failure> {
    if Exposure::given(parameters).is_some() {
        return Ok(1.0);
    }
    let info = camera.info()?;
    let radiometric = parameters.weighting() == Ok(Weighting::Radiometric);
    // The level comes from the f-number and not from metering, so that losses in the lens are visible.
    if radiometric && info.fnumber > 0.0 && info.fnumber.is_finite() {
        let fnumber = info.fnumber as f32;
        return Ok(std::f32::consts::FRAC_PI_4 / (fnumber * fnumber));
    }
    let metered = AxialRays::of(|rays| camera.rays(rays), size)?.mean_weight();
    Ok(if metered > 0.0 { metered } else { 1.0 })
}

/// Examines the lens before rendering: sizes the film to the lens's image, and returns facts of the lens. Returns `None`
/// if no lens is given or if only the plugin can find it.
///
/// # Errors
/// A piped text is not a lens, or parameters contradict each other.
fn examine_lens(parameters: &mut Parameters) -> Result<Option<LensFacts>, Failure> {
    let mut own = parameters.clone();
    let host = host(&mut own, Raster { xres: 1, yres: 1 })?;
    let is_piped = host.lens_text.is_some();
    size_film(&mut own, &host);
    parameters.film_diagonal = own.film_diagonal;
    own.weighting()?;
    let has_lens = |model| Parameters::find("lens_file").is_some_and(|row| row.models.contains(&model));
    let model = own.model.unwrap_or_default();
    if !has_lens(model) {
        return Ok(None);
    }
    let examined = open_lens(&own, &host, &mut |_, _| ()).and_then(|(prescription, lens)| {
        film_distance(&own, &lens)?;
        // Only exact rays are squeezed: the other models have the figures in y.
        let squeeze = if model == Model::Lens { FirstOrder::squeeze(&lens).unwrap_or(f64::NAN) } else { 1.0 };
        Ok(LensFacts { is_dispersive: prescription.is_dispersive(), squeeze })
    });
    match examined {
        Ok(facts) => Ok(Some(facts)),
        // The error is reported here, because only here does the lens have the name that the user gave.
        Err(error) if is_piped || matches!(error, CameraError::Parameter(_)) => Err(error.into()),
        // The plugin also searches for files beside itself, so the decision is left to it.
        Err(_) => Ok(None),
    }
}

/// Makes a progress bar on standard error, visible only on a terminal.
fn progress_bar() -> ProgressBar {
    let style = ProgressStyle::with_template("rendering {bar:40} {percent:>3} %  {eta} left")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    // A bar of length 0 would appear full before the rendering starts.
    let bar = if console::is_quiet() { ProgressBar::hidden() } else { ProgressBar::new(1) };
    bar.with_style(style)
}
