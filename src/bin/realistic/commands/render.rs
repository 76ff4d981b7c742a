//! `realistic render`: the built-in scene through a lens.

use crate::choice::size;
use crate::failure::Failure;
use crate::host::camera::Camera;
use crate::host::focus::{self, AxialRays};
use crate::host::image::Format;
use crate::host::plugin::{self, Plugin};
use crate::host::render::{Settings, Tally, render};
use crate::host::scene::Scene;
use indicatif::{ProgressBar, ProgressStyle};
use realistic::abi::realistic_camera_info;
use realistic::camera::{PARAMETERS, Parameters};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// What `render` can be told.
#[derive(clap::Args, Debug)]
#[command(after_help = parameter_help())]
pub struct Args {
    /// Lens: a file, or a name of the catalogue; NAME@35mm scales it to that focal length
    /// [default: dgauss.50mm]
    #[arg(long, value_name = "LENS")]
    lens: Option<String>,
    /// Picture to write: .png (8-bit sRGB) or .exr (linear irradiance on the film)
    #[arg(long, value_name = "FILE", default_value = "realistic.png", value_parser = picture_path)]
    out: PathBuf,
    /// Size of the picture in pixels
    #[arg(long, value_name = "WxH", default_value = "480x320", value_parser = size)]
    size: [u32; 2],
    /// Samples a pixel
    #[arg(long, value_name = "N", default_value_t = 128,
          value_parser = clap::value_parser!(u32).range(1..=16_384))]
    pub spp: u32,
    /// A camera parameter; may be given again for others (names and units below)
    #[arg(long = "param", value_name = "NAME=VALUE")]
    parameters: Vec<String>,
    /// Threads to render with [default: one a core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Brightness of the .png in stops; 0 shows a white card on the axis as it is
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, allow_negative_numbers = true)]
    exposure: f32,
    /// The plugin to load [default: the one built with this program]
    #[arg(long, value_name = "FILE")]
    plugin: Option<PathBuf>,
    /// Random numbers; the same seed gives the same picture with any number of threads
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
}

/// Renders, writes the picture and tells what lens it was.
///
/// # Errors
/// Bad parameters, no plugin, or a file that cannot be written.
pub fn run(args: &Args) -> Result<(), Failure> {
    let parameters = gather(args.lens.as_deref(), &args.parameters)?;
    let folder = args.out.parent().filter(|parent| !parent.as_os_str().is_empty());
    if let Some(folder) = folder
        && !folder.is_dir()
    {
        return Err(Failure::Other(format!(
            "cannot write {}: there is no directory {}; create it or give --out another path",
            args.out.display(),
            folder.display()
        )));
    }
    let plugin = Arc::new(Plugin::load(&plugin::find(args.plugin.as_deref())?)?);
    let progress = progress_bar();
    let warn = |message: &str| {
        progress.suspend(|| {
            let _ = writeln!(std::io::stderr(), "realistic: warning: {message}");
        });
    };
    let scene = Scene::new();
    let camera = focus::build(&plugin, &parameters, args.size, &warn)?;
    let info = camera.info()?;
    let settings = Settings {
        size: args.size,
        spp: args.spp,
        seed: args.seed,
        mm_per_unit: parameters.mmperunit.unwrap_or(1.0) as f32,
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(args.threads.map_or(0, usize::from))
        .build()
        .map_err(|error| Failure::Other(format!("{error}; give fewer --threads")))?;
    let start = Instant::now();
    let (picture, tally) = pool.install(|| render(&camera, &scene, &settings, &progress))?;
    let took = start.elapsed();
    progress.finish_and_clear();
    let white = white_level(&camera, &parameters, &info, args.size)?;
    let scale = args.exposure.exp2() / white;
    picture.write(&args.out, scale).map_err(Failure::Other)?;

    let mut text = describe(&plugin, &camera.lens_name()?, &info, args.size);
    let threads = pool.current_num_threads();
    let _ = writeln!(text, "picture  {}", timing(&settings, &tally, took, threads));
    let _ = writeln!(text, "         {}", args.out.display());
    Ok(std::io::stdout().write_all(text.as_bytes())?)
}

/// The film's irradiance where the scene has radiance 1.
fn white_level(
    camera: &Camera,
    parameters: &Parameters,
    info: &realistic_camera_info,
    size: [u32; 2],
) -> Result<f32, Failure> {
    let radiometric = match (&parameters.weighting, parameters.simpleweighting) {
        (Some(name), _) => name == "radiometric",
        (None, simple) => simple != Some(true),
    };
    // By the lens' own number, not by metering: what a lens loses shows.
    if radiometric && info.fnumber > 0.0 {
        let fnumber = info.fnumber as f32;
        return Ok(std::f32::consts::FRAC_PI_4 / (fnumber * fnumber));
    }
    let metered = AxialRays::of(camera, size)?.mean_weight();
    Ok(if metered > 0.0 { metered } else { 1.0 })
}

fn gather(lens: Option<&str>, given: &[String]) -> Result<Parameters, Failure> {
    let mut parameters = Parameters::default();
    let mut seen: Vec<&str> = Vec::new();
    for text in given {
        let Some((name, value)) = text.split_once('=') else {
            return Err(Failure::Usage(format!("--param \"{text}\" has no \"=\"; write --param NAME=VALUE")));
        };
        if seen.contains(&name) {
            return Err(Failure::Usage(format!("parameter \"{name}\" is given twice; give it once")));
        }
        parameters.set_from_text(name, value)?;
        seen.push(name);
    }
    match (lens, &parameters.specfile) {
        (Some(lens), Some(file)) => {
            return Err(Failure::Usage(format!(
                "--lens \"{lens}\" and parameter \"specfile\" (\"{file}\") say the same thing; give \
                 one of them"
            )));
        }
        (None, Some(_)) => {}
        (lens, None) => parameters.specfile = Some(lens.unwrap_or("dgauss.50mm").to_owned()),
    }
    Ok(parameters)
}

fn describe(plugin: &Plugin, lens: &str, info: &realistic_camera_info, size: [u32; 2]) -> String {
    let [width, height] = size.map(f64::from);
    let pixel = info.film_diagonal_mm / width.hypot(height);
    format!(
        "plugin   {}, version {}\n\
         lens     {lens}: {:.2} mm, f/{:.2}, {} interfaces with the stop\n\
         film     {:.2} x {:.2} mm (diagonal {:.1} mm), {:.3} mm behind the last vertex\n\
         focus    {}\n",
        plugin.path().display(),
        plugin.version(),
        info.focal_length_mm,
        info.fnumber,
        info.interfaces,
        width * pixel,
        height * pixel,
        info.film_diagonal_mm,
        info.film_distance_mm,
        if info.focus_distance_mm.is_finite() {
            format!("{:.1} mm from the film", info.focus_distance_mm)
        } else {
            "infinity".to_owned()
        },
    )
}

fn timing(settings: &Settings, tally: &Tally, took: Duration, threads: usize) -> String {
    let [width, height] = settings.size;
    let rays = tally.rays as f64;
    format!(
        "{width}x{height}, {} samples a pixel, in {:.2} s on {threads} thread{}: {:.2} million rays a \
         second,\n         {:.0} ns a ray in the lens, {:.1} % of the rays got through it",
        settings.spp,
        took.as_secs_f64(),
        if threads == 1 { "" } else { "s" },
        rays / took.as_secs_f64() / 1e6,
        tally.in_camera.as_nanos() as f64 / rays,
        100.0 * tally.passed as f64 / rays,
    )
}

/// Draws on standard error, and only when that is a terminal.
fn progress_bar() -> ProgressBar {
    let style = ProgressStyle::with_template("rendering {bar:40} {percent:>3} %  {eta} left")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    // Of no tiles at all it would show itself full before the rendering starts.
    ProgressBar::new(1).with_style(style)
}

fn picture_path(text: &str) -> Result<PathBuf, String> {
    Format::of(Path::new(text)).map(|_| PathBuf::from(text))
}

fn parameter_help() -> String {
    let mut text = String::from("Parameters for --param:\n");
    for row in PARAMETERS {
        let _ = writeln!(text, "  {:<18} {}", row.name, row.help);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn given(texts: &[&str]) -> Result<Parameters, Failure> {
        let texts: Vec<String> = texts.iter().map(|text| (*text).to_owned()).collect();
        gather(None, &texts)
    }

    fn refused(texts: &[&str]) -> String {
        match given(texts) {
            Err(Failure::Usage(message)) => message,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn parameters_go_by_name_and_the_lens_with_them() {
        let parameters = given(&["filmdistance=40.5", "pupil=disk"]).unwrap();
        assert_eq!(parameters.filmdistance, Some(40.5));
        assert_eq!(parameters.pupil.as_deref(), Some("disk"));
        assert_eq!(parameters.specfile.as_deref(), Some("dgauss.50mm"));
    }

    #[test]
    fn bad_parameters_say_what_to_do() {
        assert!(refused(&["fokus=3"]).contains("focusdistance"));
        assert!(refused(&["filmdiag"]).contains("NAME=VALUE"));
        assert!(refused(&["filmdiag=large"]).contains("a number"));
        assert!(refused(&["filmdiag=35", "filmdiag=36"]).contains("twice"));
        assert!(gather(Some("a.dat"), &["lensfile=b.dat".to_owned()]).is_err());
    }
}
