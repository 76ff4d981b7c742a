//! `realistic flare`: the ghosts of a lamp on film, in W/m² per W/m², and the pairs of surfaces that cause them.

mod splat;
mod table;

use self::{
    splat::Target,
    table::{Ghost, GhostTable},
};
use crate::{
    arguments::{FilmSize, LensChoice, OpenedLens, STOP_SHAPE, finite, whole},
    console,
    failure::Failure,
    host::render::spectrum,
    image::{Curve, Format, Picture, Tone, check_memory},
};
use glam::Vec3;
use rayon::prelude::*;
use realistic_base::message::as_given;
use realistic_camera::{CameraError, Transmission, coatings};
use realistic_light::{GhostSpectrum, Ghosts, Lamp, Pair, Surfaces, beyond_pairs, paraxial_focus};
use realistic_optics::{
    lens::Lens,
    prescription::{Prescription, SurfaceCoating},
};
use std::path::{Path, PathBuf};

/// The options of `flare`.
#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(flatten)]
    lens: LensChoice,
    /// The lamp: X,Y, degrees to the image's right (to 180, straight behind) and up (to 90), infinitely far away; or X,Y,Z, a
    /// point in mm from the front vertex, right, up and toward the scene
    #[arg(long, value_name = "X,Y[,Z]", allow_hyphen_values = true, value_parser = lamp)]
    light: Lamp,
    /// Coating of the surfaces between air and glass: bare, quarter-wave (MgF2), v-coat, three-layer, or file for the lens
    /// file's
    #[arg(long, value_name = "NAME", default_value = "quarter-wave", value_parser = coating)]
    coating: Transmission,
    /// Number of wavelengths between 420 and 680 nm; 1 traces the lens's own alone
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = wavelengths)]
    wavelengths: u32,
    /// Cells of the grid of rays along a side, for each pair of surfaces and wavelength
    #[arg(long, value_name = "N", default_value_t = 96, value_parser = whole(8_usize, 2048))]
    rays: usize,
    /// Add the direct light: the lamp's image
    #[arg(long)]
    direct: bool,
    /// Irradiance shown as white in the PNG, W/m² per W/m²; levels above 0.45 of it are compressed [default: the level that one
    /// pixel in a hundred exceeds]
    #[arg(long, value_name = "E", value_parser = white)]
    white: Option<f32>,
    #[command(flatten)]
    film: FilmSize,
    /// Pictures to write: this file, and beside it the same as .exr (W/m² per W/m²) or .png [default: the lens's name with
    /// -flare.exr]
    #[arg(short, long, value_name = "FILE", value_parser = crate::image::picture_path)]
    out: Option<PathBuf>,
    /// Write the table only, and all of it, as JSON
    #[arg(long)]
    json: bool,
}

/// Parses X,Y or X,Y,Z.
fn lamp(text: &str) -> Result<Lamp, String> {
    let numbers: Option<Vec<f64>> =
        text.split(',').map(|part| part.trim().parse().ok().filter(|x: &f64| x.is_finite())).collect();
    Ok(match numbers.as_deref() {
        Some([right, up]) if right.abs() <= 180.0 && up.abs() <= 90.0 => {
            let ((sin_x, cos_x), (sin_y, cos_y)) = (right.to_radians().sin_cos(), up.to_radians().sin_cos());
            Lamp::Distant([sin_x * cos_y, sin_y, cos_x * cos_y])
        }
        Some(&[right, up]) => {
            let [right, up] = [right, up].map(as_given);
            return Err(format!(
                "{right},{up} degrees are no direction: write -180 to 180 degrees to the right, and -90 to 90 up"
            ));
        }
        Some(&[x, y, z]) => Lamp::Point([x, y, z]),
        _ => return Err("write two numbers of degrees, or three of mm, with commas between them".to_owned()),
    })
}

fn coating(text: &str) -> Result<Transmission, String> {
    let known = || Transmission::NAMES.into_iter().filter(|(_, own)| *own != Transmission::None);
    known().find(|(name, _)| *name == text).map(|(_, own)| own).ok_or_else(|| {
        let names: Vec<&str> = known().map(|(name, _)| name).collect();
        format!("write one of {}", names.join(", "))
    })
}

/// Returns the coatings of a lens's surfaces.
fn coatings_of(coating: Transmission, lens: &Prescription) -> Result<Vec<SurfaceCoating>, Failure> {
    coatings(coating, lens).ok().flatten().ok_or_else(|| {
        Failure::Usage(format!(
            "--coating file: lens \"{}\" names no coatings; give it lines \"coating ROW NAME\", or another --coating",
            lens.name
        ))
    })
}

/// Parses a positive number with a finite reciprocal.
fn white(text: &str) -> Result<f32, String> {
    let number = finite(text).ok().filter(|number| number.is_normal() && *number > 0.0);
    number.ok_or_else(|| "write a number above 0".to_owned())
}

fn wavelengths(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(count @ (1 | 3..=200)) => Ok(count),
        _ => Err("write 1, or 3 to 200: fewer than 3 make no colours".to_owned()),
    }
}

/// Number of cells along a side of the grid that ranks the pairs.
const RANKING: usize = 32;
/// Largest share of the ghosts' watts that all pairs left out of the picture may have together.
const LEFT_OUT: f64 = 1e-4;

/// The groups of parameters that the command uses.
pub const GROUPS: &[&[&str]] = &[STOP_SHAPE];

/// Writes the pictures and prints the table.
///
/// # Errors
/// There is no such lens, the film distance lies inside the lens, or a file cannot be written.
pub fn run(args: &Args) -> Result<(), Failure> {
    let opened = args.lens.open_with(GROUPS)?;
    let film_distance = opened.film_distance()?;
    let [edge_sagitta, _] = opened.lens.rear().sagitta_range();
    if film_distance + edge_sagitta <= 0.0 {
        return Err(CameraError::film_in_lens(&opened.lens, film_distance).into());
    }
    args.light.check(&opened.lens).map_err(|why| Failure::Usage(format!("--light: {why}")))?;
    let setup = FlareSetup {
        film: opened.lens.rear().vertex - film_distance,
        lamp: args.light,
        coatings: coatings_of(args.coating, &opened.prescription)?,
    };
    if !args.json {
        let raster = args.film.raster();
        // Each thread has a picture of four doubles per pixel, and the file is made from a single picture.
        let threads = rayon::current_num_threads() as u64;
        check_memory([raster.xres, raster.yres], 32 * (threads + 2) + 40)?;
    }
    let ranked = setup.rank(&opened.lens);
    let coating = args.coating.to_string();
    let mut text = if args.json { format!("{:#}\n", ranked.json(&coating)) } else { ranked.text(&coating) };
    let mut written = None;
    if !args.json {
        let (picture, watts) = setup.picture(args, &opened, &ranked.brightest_pairs());
        let out = args.out.clone().unwrap_or_else(|| {
            let name = opened.prescription.name.rsplit('/').next().unwrap_or_default();
            PathBuf::from(format!("{name}-flare.exr"))
        });
        let white = args.white.unwrap_or_else(|| automatic_white(&picture));
        for path in both(&out)? {
            picture.write(&path, Tone { scale: white.recip(), curve: Curve::Film })?;
            if !crate::files::is_stdout(&path) {
                text += &format!("{}\n", path.display());
            }
        }
        text += &format!(
            "on the film {watts:.4e} W of ghosts per W/m²; white in the PNG is {white:.3e} W/m² per W/m² (--white)\n"
        );
        written = Some(out);
    }
    Ok(console::answer(&text, written.as_deref())?)
}

/// Share of the pixels that are brighter than white, as 1 in N, unless white is given: a ghost in focus near the film
/// is thousands of times as bright as the others, but covers few pixels.
const ABOVE_WHITE: usize = 100;

/// Returns the value that one pixel in a hundred exceeds; if that value is 0, the value of the brightest pixel; 1 if
/// all pixels are dark.
fn automatic_white(picture: &Picture) -> f32 {
    let mut most: Vec<f32> = picture.pixels.iter().map(|[r, g, b]| r.max(*g).max(*b)).collect();
    most.sort_by(f32::total_cmp);
    let [.., brightest] = most[..] else { return 1.0 };
    let here = most[most.len() - 1 - most.len() / ABOVE_WHITE];
    [here, brightest].into_iter().find(|value| value.is_normal() && *value > 0.0).unwrap_or(1.0)
}

/// Returns the path of a picture, and the path beside it for the other format.
fn both(out: &Path) -> Result<Vec<PathBuf>, Failure> {
    if crate::files::is_stdout(out) {
        return Ok(vec![out.to_owned()]);
    }
    let other = match Format::of(out).map_err(Failure::Usage)? {
        Format::Png => "exr",
        Format::Exr => "png",
    };
    Ok(vec![out.to_owned(), out.with_extension(other)])
}

/// Quantities that do not depend on the wavelength.
struct FlareSetup {
    /// z of the film, mm.
    film: f64,
    lamp: Lamp,
    /// Coatings of the surfaces, from the scene on.
    coatings: Vec<SurfaceCoating>,
}

impl FlareSetup {
    fn surfaces(&self, lens: &Lens) -> Surfaces {
        Surfaces::of_each(lens, &self.coatings)
    }

    fn ghosts(&self, lens: &Lens) -> Ghosts {
        Ghosts::new(lens, &self.surfaces(lens), self.film)
    }

    /// Ranks all pairs by their watts at the lens's own wavelength.
    fn rank(&self, lens: &Lens) -> GhostTable {
        let ghosts = self.ghosts(lens);
        let front = lens.front().semi_diameter;
        let mut found: Vec<Ghost> = ghosts
            .chosen()
            .par_iter()
            .map(|&pair| {
                let path = ghosts.lit(pair);
                let spray = ghosts.spray(&path, self.lamp, RANKING);
                let (middle, radius) = spray.spot().unwrap_or_default();
                let focus = paraxial_focus(path.path(), front).map(|z| z - self.film);
                Ghost { pair, watts: spray.watts(), middle, radius, focus }
            })
            .collect();
        found.sort_by(|a, b| b.watts.total_cmp(&a.watts));
        let direct = ghosts.spray(ghosts.direct(), self.lamp, 2 * RANKING);
        let beyond = beyond_pairs(&self.surfaces(lens), lens);
        GhostTable {
            ghosts: found,
            direct: direct.watts(),
            wavelength: lens.wavelength,
            beyond,
            left_out: LEFT_OUT,
            not_traced: ghosts.left_out(),
        }
    }

    /// Renders the ghosts on film, in red, green and blue for a white lamp; also returns the watts on the film.
    fn picture(&self, args: &Args, opened: &OpenedLens, brightest: &[Pair]) -> (Picture, f64) {
        let raster = args.film.raster();
        let size = [raster.xres, raster.yres];
        let film = args.film.film(opened.film_diagonal());
        let target = Target::new(&film, size);
        let bands = match args.wavelengths {
            1 => vec![(opened.lens.wavelength, Vec3::ONE)],
            count => spectrum::bands(count).into_iter().map(|(nm, band)| (nm, band * Vec3::ONE)).collect(),
        };
        // Surfaces and stop stay the same; only the indices are those of the wavelength.
        let lens_at = |wavelength| {
            let mut lens = Lens::new(&opened.prescription, wavelength);
            for (surface, own) in lens.surfaces.iter_mut().zip(&opened.lens.surfaces) {
                surface.semi_diameter = own.semi_diameter;
                surface.apertures = own.apertures.clone();
            }
            lens
        };
        // For a given pair, a coating that reflects nothing at one wavelength may reflect most of the light at
        // another.
        let mut chosen = brightest.to_vec();
        if let [(first, _), .., (last, _)] = bands[..] {
            chosen.extend([first, last].into_iter().flat_map(|nm| self.rank(&lens_at(nm)).brightest_pairs()));
        }
        let wavelengths: Vec<f64> = bands.iter().map(|(nm, _)| *nm).collect();
        let ghosts = GhostSpectrum::new(&wavelengths, lens_at, &self.coatings, self.film);
        // Factors that convert the watts at a wavelength to a pixel's red, green and blue, W/m², and to the watts of
        // all wavelengths.
        let per_area = 1e6 / film.pixel().powi(2);
        let shares = |k: usize| {
            let [red, green, blue] = bands[k].1.to_array().map(|colour| f64::from(colour) * per_area);
            [red, green, blue, (bands.len() as f64).recip()]
        };
        let shine = |pixels: &mut Vec<[f64; 4]>, pair: Option<Pair>| {
            let mut light = target.light(pixels);
            ghosts.sprays(pair, self.lamp, args.rays, |k, spray| light.add(spray, shares(k)));
            light.spread();
        };
        let pairs: Vec<Pair> = ghosts.pairs().filter(|pair| chosen.contains(pair)).collect();
        let mut pixels = pairs
            .into_par_iter()
            .fold(
                || target.dark(),
                |mut pixels, pair| {
                    shine(&mut pixels, Some(pair));
                    pixels
                },
            )
            .reduce(
                || target.dark(),
                |mut sum, pixels| {
                    let numbers = sum.as_flattened_mut().iter_mut().zip(pixels.as_flattened());
                    numbers.for_each(|(sum, number)| *sum += number);
                    sum
                },
            );
        let watts = pixels.iter().map(|pixel| pixel[3]).sum();
        if args.direct {
            shine(&mut pixels, None);
        }
        let irradiance = |[red, green, blue, _]: [f64; 4]| [red, green, blue].map(|number| number as f32);
        (Picture { size, pixels: pixels.into_iter().map(irradiance).collect() }, watts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_optics::prescription::{Coating, catalogue};

    #[test]
    fn lamps_are_read_and_others_refused() {
        let Lamp::Distant([x, y, z]) = lamp("30,0").unwrap() else { panic!("distant") };
        assert!((x - 0.5).abs() < 1e-12 && y == 0.0 && (z - 0.75_f64.sqrt()).abs() < 1e-12);
        assert_eq!(lamp("10, -5,200").unwrap(), Lamp::Point([10.0, -5.0, 200.0]));
        for (text, part) in [
            ("1", "two numbers"),
            ("1,x", "two numbers"),
            ("200,0", "no direction"),
            ("0,-91", "-90 to 90 up"),
        ] {
            assert!(lamp(text).unwrap_err().contains(part), "{text}");
        }
        assert!(coating("five-layer").unwrap_err().contains("quarter-wave"));
        assert!(wavelengths("2").is_err() && wavelengths("1") == Ok(1));
    }

    #[test]
    fn coated_surfaces_make_weaker_ghosts() {
        let lens = Lens::at_d_line(&catalogue::find("dgauss.50mm").unwrap());
        let table = |coating: Coating| {
            let coatings = vec![coating.into(); lens.surfaces.len()];
            let setup = FlareSetup { film: lens.rear().vertex - 36.0, lamp: lamp("15,0").unwrap(), coatings };
            setup.rank(&lens)
        };
        let [bare, coated] = [Coating::Bare, Coating::QuarterWave].map(table);
        assert_eq!((bare.ghosts.len(), coated.ghosts.len()), (45, 45));
        let share = |table: &GhostTable| table.watts() / table.direct;
        assert!(share(&bare) > 0.02 && share(&coated) < 0.1 * share(&bare));
        assert!(bare.direct < 0.7 * coated.direct);
        let count = bare.brightest_pairs().len();
        assert!(count > 10 && count <= 45, "{count}");
        assert!(bare.text("bare").contains("45 pairs"));
        assert_eq!(bare.json("bare")["pairs"].as_array().unwrap().len(), 45);
    }
}
