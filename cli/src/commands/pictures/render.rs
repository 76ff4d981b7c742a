//! `realistic render`: the built-in scene through a lens, whole or a tile of it, or a slide of the lecture.

use super::origin::origin;
use crate::failure::Failure;
use crate::host::plugin::{Camera, Plugin};
use crate::host::render::Integrator;
use crate::host::scene::effects::Effects;
use crate::host::scene::{night, props};
use crate::host::studio::{Method, Options, Order, Shot, Slide, Studio, parameter_help, stopped_down};
use crate::image::{Format, picture_path, tile, writable};
use realistic::camera::autofocus::Rule;
use realistic::message::fixed;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::PathBuf;

/// The options of `render`.
#[derive(clap::Args, Debug)]
#[command(after_help = parameter_help())]
pub struct Args {
    #[command(flatten)]
    pub options: Options,
    /// Picture to write: .png (8-bit sRGB) or .exr (linear irradiance on the film; of a slide, as shown)
    #[arg(long, value_name = "FILE", default_value = "realistic.png", value_parser = picture_path)]
    out: PathBuf,
    /// Render only the pixels from column X0 to before X1 and from row Y0 to before Y1, as a tile for `merge`
    #[arg(long, value_name = "X0,Y0,X1,Y1", conflicts_with = "slide")]
    crop: Option<String>,
    /// Effects with commas between them: gloss, translucency, soft-shadow, dof, motion; or none, or all
    #[arg(long, value_name = "NAMES", default_value = "soft-shadow,dof", conflicts_with = "slide")]
    effects: Effects,
    /// A slide of the lecture instead of one picture: an effect off, with few samples and with many
    #[arg(long, value_name = "NAME")]
    slide: Option<Slide>,
    /// The built-in scene by day, or at night, lit by lamps alone
    #[arg(long, value_name = "NAME", default_value = "day", conflicts_with = "slide")]
    scene: Stage,
    /// From where light is followed: path, from the camera, or light, from the lamps of --scene night
    #[arg(long, value_name = "NAME", default_value = "path", conflicts_with = "slide")]
    integrator: Integrator,
    /// Trace this many wavelengths, 3 or more, and show the lens' colour errors
    #[arg(long, value_name = "N", conflicts_with = "slide", value_parser = clap::value_parser!(u32).range(3..=256))]
    wavelengths: Option<u32>,
    /// Focus on a zone of the picture, in pixels; may be given again for others [default: the middle]
    #[arg(long, value_name = "X,Y,W,H", num_args = 0..=1, conflicts_with = "slide", value_parser = zone,
          default_missing_value = MIDDLE)]
    autofocus: Vec<Option<[f32; 4]>>,
    /// Which of several autofocus zones counts: the one that sees what is nearest, the one in the centre of the picture,
    /// or the average of their film distances
    #[arg(long, value_name = "nearest|centre|average", default_value = "nearest", requires = "autofocus", value_parser = rule)]
    autofocus_rule: Rule,
    /// What the plugin asks this program for
    #[arg(long, value_name = "METHOD", default_value = "distance", requires = "autofocus")]
    autofocus_by: Method,
}

/// When the built-in scene is rendered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Stage {
    /// In the light of sun and sky
    Day,
    /// In that of lamps alone
    Night,
}

/// Stands for a zone in the middle of the picture.
const MIDDLE: &str = "middle";

const SPP: u32 = 128;

/// Renders, writes the picture and reports what lens it was.
///
/// # Errors
/// Bad parameters, no plugin, or a file that cannot be written.
pub fn run(args: &Args) -> Result<(), Failure> {
    writable(&args.out)?;
    let studio = Studio::open(&args.options)?;
    if let Some(slide) = args.slide {
        let (picture, text) = slide.take(&studio, &args.options)?;
        picture.write(&args.out, 1.0)?;
        let text = format!("{text}picture  {}\n", args.out.display());
        return Ok(std::io::stdout().write_all(text.as_bytes())?);
    }
    let mut parameters = stopped_down(&studio.parameters, &args.effects)?;
    if let Some(crop) = &args.crop {
        if parameters.crop.is_some() {
            return Err(Failure::Usage(
                "--crop and parameter \"crop\" say the same thing; give one of them".to_owned(),
            ));
        }
        parameters.set_from_text("crop", crop)?;
    }
    let scene = match args.scene {
        Stage::Day => props::scene(),
        Stage::Night => night::scene(),
    };
    let scene = scene.with(&args.effects);
    if !args.autofocus.is_empty() {
        let zones: Vec<[f32; 4]> =
            args.autofocus.iter().map(|zone| zone.unwrap_or_else(|| middle(studio.size))).collect();
        let (rule, method) = (args.autofocus_rule, args.autofocus_by);
        parameters.filmdistance = Some(studio.autofocus(&parameters, &scene, &zones, rule, method)?);
    }
    let order = Order {
        spp: args.options.spp.unwrap_or(SPP),
        wavelengths: args.wavelengths,
        whole: None,
        integrator: args.integrator,
    };
    let shot = studio.take(&parameters, &scene, &order)?;
    let mut text = describe(&studio.plugin, &shot.camera, studio.size)?;
    if parameters.crop.is_some() {
        let shown = format!("{:?}, {}", args.scene, args.effects);
        let format = Format::of(&args.out).map_err(Failure::Usage)?;
        let origin = origin(&args.options, &shown, format, &studio, &order, &shot)?;
        tile::write(&shot.picture, &args.out, shot.scale, &origin)?;
        let ([x0, y0, ..], [width, height]) = (origin.crop, origin.whole);
        let _ = writeln!(text, "tile     at {x0},{y0} of {width}x{height}, for `realistic merge`");
    } else {
        shot.picture.write(&args.out, shot.scale)?;
    }
    let _ = writeln!(text, "picture  {}", timing(&order, &shot, studio.threads()));
    let _ = writeln!(text, "         {}", args.out.display());
    Ok(std::io::stdout().write_all(text.as_bytes())?)
}

fn describe(plugin: &Plugin, camera: &Camera, size: [u32; 2]) -> Result<String, Failure> {
    let (lens, info) = (camera.lens_name()?, camera.info()?);
    let [width, height] = size.map(f64::from);
    let pixel = info.film_diagonal_mm / width.hypot(height);
    Ok(format!(
        "plugin   {}, version {}\n\
         lens     {lens}: {} mm, f/{}, {} interfaces with the stop\n\
         film     {} x {} mm (diagonal {} mm), {} mm behind the last vertex\n\
         focus    {}\n",
        plugin.path().display(),
        plugin.version(),
        fixed(info.focal_length_mm, 2),
        fixed(info.fnumber, 2),
        info.interfaces,
        fixed(width * pixel, 2),
        fixed(height * pixel, 2),
        fixed(info.film_diagonal_mm, 1),
        fixed(info.film_distance_mm, 3),
        if info.focus_distance_mm.is_finite() {
            format!("{} mm from the film", fixed(info.focus_distance_mm, 1))
        } else if info.focus_distance_mm.is_nan() {
            "on nothing in front of the lens".to_owned()
        } else {
            "infinity".to_owned()
        },
    ))
}

fn timing(order: &Order, shot: &Shot, threads: usize) -> String {
    let [width, height] = shot.picture.size;
    let tally = &shot.tally;
    let rays = tally.rays as f64;
    let colours = order.wavelengths.map_or(String::new(), |count| format!(" at each of {count} wavelengths"));
    format!(
        "{width}x{height}, {} samples per pixel{colours}, in {:.2} s on {threads} thread{}: {:.2} million rays per \
         second,\n         {:.0} ns per ray in the lens, {:.1} % of the rays got through it",
        order.spp,
        shot.took.as_secs_f64(),
        if threads == 1 { "" } else { "s" },
        rays / shot.took.as_secs_f64() / 1e6,
        tally.in_camera.as_nanos() as f64 / rays,
        100.0 * tally.passed as f64 / rays,
    )
}

/// A zone of a tenth of the picture each way, at least a pixel, in its middle.
fn middle(size: [u32; 2]) -> [f32; 4] {
    let [width, height] = size.map(|side| (side as f32 / 10.0).ceil());
    let [left, top] = [(size[0], width), (size[1], height)].map(|(side, part)| (side as f32 - part) / 2.0);
    [left.floor(), top.floor(), width, height]
}

fn rule(text: &str) -> Result<Rule, String> {
    let named = Rule::NAMES.iter().find(|(name, _)| *name == text).map(|(_, rule)| *rule);
    named.ok_or_else(|| "the rules are nearest, centre and average".to_owned())
}

fn zone(text: &str) -> Result<Option<[f32; 4]>, String> {
    if text == MIDDLE {
        return Ok(None);
    }
    let numbers: Vec<f32> = text.split(',').filter_map(|part| part.trim().parse().ok()).collect();
    match <[f32; 4]>::try_from(numbers) {
        Ok(zone) if text.split(',').count() == 4 && zone[2] > 0.0 && zone[3] > 0.0 => Ok(Some(zone)),
        _ => Err("write LEFT,TOP,WIDTH,HEIGHT in pixels of the picture, as in 200,140,80,40".to_owned()),
    }
}
