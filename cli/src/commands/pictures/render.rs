//! `realistic render`: renders the built-in scene through a lens, as a whole picture or as a tile, or renders a slide
//! of the lecture.

use super::origin::origin;
use crate::arguments::{CameraChoice, whole};
use crate::console;
use crate::failure::Failure;
use crate::files;
use crate::host::plugin::{Camera, Plugin};
use crate::host::render::Integrator;
use crate::host::scene::effects::Effects;
use crate::host::scene::{chess, night, props};
use crate::host::studio::{Method, Options, Shot, ShotOptions, Slide, Studio, stopped_down};
use crate::image::{Filter, Format, Tone, picture_path, tile};
use clap::ValueEnum;
use realistic_base::message::fixed;
use realistic_camera::autofocus::Rule;
use std::fmt::Write as _;
use std::path::PathBuf;

/// The options of `render`.
#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(flatten)]
    pub camera: CameraChoice,
    #[command(flatten)]
    pub picture: PictureArgs,
}

/// The picture to render, and its file.
#[derive(clap::Args, Debug)]
pub struct PictureArgs {
    #[command(flatten)]
    pub options: Options,
    /// Picture, .png or .exr; - for a .png on standard output
    ///
    /// A .png is 8-bit sRGB, an .exr has the linear irradiance on the film; of a slide both are as shown.
    #[arg(short, long, value_name = "FILE", default_value = "realistic.png", value_parser = picture_path)]
    out: PathBuf,
    /// Effects, or none, or all
    ///
    /// They are gloss, translucency, soft-shadow, dof and motion, with commas between them. All but dof are the test card's.
    #[arg(long, value_name = "NAMES", default_value = "soft-shadow,dof", conflicts_with = "slide")]
    effects: Effects,
    /// A slide of the lecture instead of one picture
    ///
    /// It shows an effect off, with few samples and with many.
    #[arg(long, value_name = "NAME", hide_possible_values = true, long_help = slide_help())]
    slide: Option<Slide>,
    /// The built-in scene: chess, day or night
    ///
    /// A game of chess at dusk, or the test card, in the light of sun and sky or of lamps alone.
    #[arg(
        long,
        value_name = "NAME",
        hide_possible_values = true,
        default_value = "chess",
        conflicts_with = "slide"
    )]
    scene: Stage,
    /// Start of light paths: path or light
    ///
    /// path starts them at the camera, light at the lamps of --scene night.
    #[arg(
        long,
        value_name = "NAME",
        hide_possible_values = true,
        default_value = "path",
        conflicts_with = "slide"
    )]
    integrator: Integrator,
    /// Reconstruction filter: box or smooth [default: smooth; for the test card box]
    ///
    /// box averages over the pixel. smooth includes an eighth of the neighbour on either side, which is as sharp as a
    /// Gaussian filter with a standard deviation of half a pixel, and has 0.6 times the noise.
    #[arg(long, value_name = "NAME", hide_possible_values = true, conflicts_with = "slide")]
    filter: Option<Filter>,
    /// Stretch the picture of an anamorphic lens to its true proportions
    ///
    /// --size is that of the squeezed picture on the film. The picture is as many times as wide as the lens's focal length in
    /// y is that in x.
    #[arg(long, conflicts_with_all = ["slide", "noise", "crop"])]
    desqueeze: bool,
    /// Measure the picture's noise instead, in parts of two pictures
    ///
    /// The RMS error of a pixel over the mean of all pixels, in linear light as displayed. The two pictures use this seed and
    /// the next, and one in 37 of their blocks of 16 x 16 pixels.
    #[arg(long, conflicts_with_all = ["slide", "out", "crop"])]
    noise: bool,
    /// Trace this many wavelengths, and show colour errors
    ///
    /// 3 or more, for a lens with V-numbers or dispersion formulas.
    #[arg(long, value_name = "N", conflicts_with = "slide", allow_hyphen_values = true, value_parser = whole(3_u32, 256))]
    wavelengths: Option<u32>,
    /// Focus on a zone of the picture [default: the middle]
    ///
    /// In pixels, from the left and the top; repeat for other zones.
    #[arg(long, value_name = "X,Y,W,H", num_args = 0..=1, conflicts_with = "slide", value_parser = zone,
          default_missing_value = MIDDLE)]
    autofocus: Vec<Option<[f32; 4]>>,
    /// Rule for several zones: nearest, centre or average
    ///
    /// The zone with the nearest object, the zone at the picture's centre, or the average of their film distances.
    #[arg(long, value_name = "NAME", default_value = "nearest", requires = "autofocus", value_parser = rule)]
    autofocus_rule: Rule,
    /// Method of focusing: by distance or contrast
    ///
    /// The plugin requests distances along a few rays, or the contrast of trial pictures.
    #[arg(
        long,
        value_name = "NAME",
        hide_possible_values = true,
        default_value = "distance",
        requires = "autofocus"
    )]
    autofocus_by: Method,
}

/// Lighting of the built-in scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Stage {
    /// A game of chess at dusk, before a street with its lamps
    Chess,
    /// The test card, in the light of sun and sky
    Day,
    /// The test card, in the light of lamps alone
    Night,
}

impl Stage {
    /// Returns the default samples per pixel.
    fn spp(self) -> u32 {
        match self {
            Self::Chess => 48,
            Self::Day | Self::Night => 128,
        }
    }

    /// Returns the default reconstruction filter.
    fn filter(self) -> Filter {
        match self {
            Self::Chess => Filter::Smooth,
            Self::Day | Self::Night => Filter::Box,
        }
    }
}

/// Value of the flag that stands for a zone in the middle of the picture.
const MIDDLE: &str = "middle";

/// Renders, writes the picture and reports the lens.
///
/// # Errors
/// A parameter is invalid, there is no plugin, or a file cannot be written.
pub fn run(camera: &CameraChoice, args: &PictureArgs) -> Result<(), Failure> {
    files::make_parent(&args.out)?;
    let studio = Studio::open(camera, &args.options)?;
    let desqueezed = args.desqueeze.then(|| studio.desqueezed()).transpose()?;
    if let Some(slide) = args.slide {
        let (picture, text) = slide.take(&studio, camera.has_lens(), args.options.spp)?;
        picture.write(&args.out, Tone::SHOWN)?;
        let text = format!("{text}picture  {}\n", args.out.display());
        return Ok(console::report(&text, &args.out)?);
    }
    if let (Some(count), Some(false)) = (args.wavelengths, studio.lens.map(|lens| lens.is_dispersive)) {
        studio.warn(&format!(
            "the lens has neither V-numbers nor dispersion formulas: rays of all {count} wavelengths take the same way, and \
             the picture shows no colour errors; leave out --wavelengths, or give a lens that has them"
        ));
    }
    let mut parameters = stopped_down(&studio.parameters, &args.effects)?;
    let scene = match args.scene {
        Stage::Chess => chess::scene(),
        Stage::Day => props::scene().with(&args.effects),
        Stage::Night => night::scene().with(&args.effects),
    };
    if !args.autofocus.is_empty() {
        let zones: Vec<[f32; 4]> =
            args.autofocus.iter().map(|zone| zone.unwrap_or_else(|| middle(studio.size))).collect();
        let (rule, method) = (args.autofocus_rule, args.autofocus_by);
        parameters.film_distance = Some(studio.autofocus(&parameters, &scene, &zones, rule, method)?);
    }
    let options = ShotOptions {
        wavelengths: args.wavelengths,
        integrator: args.integrator,
        filter: args.filter.unwrap_or(args.scene.filter()),
        ..ShotOptions::plain(args.options.spp.unwrap_or(args.scene.spp()))
    };
    if args.noise {
        let (noise, shot) = studio.noise(&parameters, &scene, &options)?;
        let mut text = describe(&studio.plugin, &shot.camera, studio.size)?;
        let _ = writeln!(text, "noise    {} % of the picture's mean", fixed(100.0 * noise, 2));
        let _ = writeln!(text, "parts    {}", timing(&options, &shot, studio.threads()));
        return Ok(console::report(&text, &args.out)?);
    }
    let shot = studio.take(&parameters, &scene, &options)?;
    let mut text = describe(&studio.plugin, &shot.camera, studio.size)?;
    if parameters.crop.is_some() {
        let shown = format!("{:?}, {}", args.scene, args.effects);
        let format = Format::of(&args.out).map_err(Failure::Usage)?;
        let origin = origin(camera, &shown, format, &studio, &options, &shot)?;
        tile::write(&shot.picture, &args.out, shot.tone, &origin)?;
        let ([x0, y0, ..], [width, height]) = (origin.crop, origin.whole);
        let _ = writeln!(text, "tile     at {x0},{y0} of {width}x{height}, for `realistic merge`");
    } else if let Some((width, squeeze)) = desqueezed {
        shot.picture.at_width(width).write(&args.out, shot.tone)?;
        let _ = writeln!(text, "squeeze  {} undone: {width}x{} pixels", fixed(squeeze, 4), studio.size[1]);
    } else {
        shot.picture.write(&args.out, shot.tone)?;
    }
    let _ = writeln!(text, "picture  {}", timing(&options, &shot, studio.threads()));
    let _ = writeln!(text, "         {}", args.out.display());
    Ok(console::report(&text, &args.out)?)
}

/// Lists the slides, one per line.
fn slide_help() -> String {
    let mut text = String::from("A slide of the lecture instead of one picture:");
    for value in Slide::value_variants().iter().filter_map(ValueEnum::to_possible_value) {
        let _ = write!(text, "\n- {}: {}", value.get_name(), value.get_help().unwrap_or_default());
    }
    text
}

fn describe(plugin: &Plugin, camera: &Camera, size: [u32; 2]) -> Result<String, Failure> {
    let (lens, info) = (camera.lens_name()?, camera.info()?);
    if info.interfaces == 0 {
        return Ok(format!("plugin   {}, version {}\n", plugin.path().display(), plugin.version()));
    }
    let [width, height] = size.map(f64::from);
    let pixel = info.film_diagonal / width.hypot(height);
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
        fixed(info.film_diagonal, 1),
        fixed(info.film_distance, 3),
        if info.focus_distance_mm.is_finite() {
            format!("{} mm from the film", fixed(info.focus_distance_mm, 1))
        } else if info.focus_distance_mm.is_nan() {
            "on nothing in front of the lens".to_owned()
        } else {
            "infinity".to_owned()
        },
    ))
}

fn timing(options: &ShotOptions, shot: &Shot, threads: usize) -> String {
    let [width, height] = shot.picture.size;
    let tally = &shot.tally;
    let rays = tally.rays as f64;
    let colours =
        options.wavelengths.map_or(String::new(), |count| format!(" at each of {count} wavelengths"));
    format!(
        "{width}x{height}, {} samples per pixel{colours}, in {:.2} s on {threads} thread{}: {:.2} million rays per \
         second,\n         {:.0} ns per ray in the lens, {:.1} % of the rays got through it",
        options.spp,
        shot.took.as_secs_f64(),
        if threads == 1 { "" } else { "s" },
        rays / shot.took.as_secs_f64() / 1e6,
        tally.in_camera.as_nanos() as f64 / rays,
        100.0 * tally.passed as f64 / rays,
    )
}

/// Returns a zone in the middle of the picture, with a tenth of the picture's width and height but at least one
/// pixel.
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
