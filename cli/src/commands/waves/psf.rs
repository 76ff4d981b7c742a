//! `realistic psf`: the picture of a point, with diffraction.

use super::{ImagePoint, PointArgs, warn_unless_valid};
use crate::arguments::{positive, whole};
use crate::console;
use crate::export::Map;
use crate::failure::Failure;
use crate::files;
use crate::image::{Picture, Tone};
use realistic_base::message::fixed;
use realistic_waves::{Psf, Wavefront};
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// The options of `psf`.
#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(flatten)]
    point: PointArgs,
    /// Number of pixels along a side of the square
    #[arg(long, value_name = "COUNT", default_value_t = 128, value_parser = whole(8_usize, 1024))]
    pixels: usize,
    /// Side of a pixel, micrometres [default: a quarter of the wavelength times the f-number]
    #[arg(long, value_name = "UM", value_parser = positive)]
    pitch: Option<f64>,
    /// File to write: .exr or .npy with the energy of each pixel, .csv, or .png, a picture of its square root
    #[arg(short, long, value_name = "FILE", value_parser = output)]
    out: Option<PathBuf>,
    /// Write the report as JSON
    #[arg(long)]
    json: bool,
}

fn output(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let ending = path.extension().and_then(|ending| ending.to_str()).map(str::to_ascii_lowercase);
    match ending.as_deref() {
        Some("exr" | "npy" | "csv" | "png") => Ok(path),
        _ => Err("the file must end in .exr, .npy, .csv or .png".to_owned()),
    }
}

/// Computes the function, writes it and reports on it.
///
/// # Errors
/// As for [`ImagePoint::of`]; no light arrives at the point, or the file cannot be written.
pub fn run(args: &Args) -> Result<(), Failure> {
    if let Some(out) = &args.out {
        files::make_parent(out)?;
    }
    let point = ImagePoint::of(&args.point)?;
    let wavefronts = point.wavefronts(point.sampling, 0.0)?;
    let first = &wavefronts[0].1;
    let pitch = args.pitch.map_or(first.wavelength / (8.0 * first.circle().1), |um| um * 1e-3);
    let of = |wavefronts: &[(f64, Wavefront)]| -> Psf {
        let parts: Vec<(f64, Psf)> =
            wavefronts.iter().map(|(weight, wave)| (*weight, Psf::new(wave, args.pixels, pitch))).collect();
        Psf::mixed(&parts).expect("at least one wavelength")
    };
    let psf = of(&wavefronts);
    let error = psf.difference(&of(&point.wavefronts(point.sampling.coarser(), 0.0)?));
    warn_unless_valid(error, point.sampling.across);
    if let Some(out) = &args.out {
        write(&psf, out)?;
    }
    let text = if args.json {
        let mut json = point.json(first);
        let own = json!({
            "pixels": psf.size,
            "pitch_mm": psf.pitch,
            "energy_on_pixels": psf.share(),
            "peak_per_mm2": psf.peak(),
            "peak_of_perfect_lens_per_mm2": psf.perfect_peak,
            "error": error,
        });
        let (Value::Object(all), Value::Object(own)) = (&mut json, own) else { unreachable!("objects") };
        all.extend(own);
        format!("{json:#}\n")
    } else {
        let mut text = point.text(first);
        let _ = writeln!(
            text,
            "pixels            {} x {} of {} um, which hold {} % of the energy",
            psf.size,
            psf.size,
            fixed(1e3 * psf.pitch, 4),
            fixed(100.0 * psf.share(), 2)
        );
        let _ = writeln!(
            text,
            "peak              {} of a perfect lens's",
            fixed(psf.peak() / psf.perfect_peak, 4)
        );
        let _ = writeln!(text, "error             {error:.1e} of the peak, by three quarters of the rays");
        if let Some(out) = &args.out {
            let _ = writeln!(text, "written           {}", out.display());
        }
        text
    };
    Ok(console::answer(&text, None)?)
}

/// Smallest side of a picture, pixels.
const PICTURE: usize = 512;

/// Writes the energy of each pixel, in rows from the top, where y of the film is largest.
fn write(psf: &Psf, out: &Path) -> Result<(), Failure> {
    let size = psf.size;
    let energy: Vec<f32> = (0..size)
        .rev()
        .flat_map(|row| &psf.values[row * size..][..size])
        .map(|value| (value * psf.pitch * psf.pitch) as f32)
        .collect();
    let side = u32::try_from(size).expect("at most 1024");
    let save = |bytes: &[u8]| files::save(out, bytes).map_err(|error| Failure::cannot_write(out, &error));
    match out.extension().and_then(|ending| ending.to_str()).map(str::to_ascii_lowercase).as_deref() {
        Some("csv") => {
            let mut text = "x_mm,y_mm,energy\n".to_owned();
            for (at, energy) in energy.iter().enumerate() {
                let (x, y) = (psf.place(at % size), psf.place(size - 1 - at / size));
                let _ = writeln!(text, "{x:.9},{y:.9},{energy:e}");
            }
            save(text.as_bytes())
        }
        Some("png") => {
            let times = PICTURE.div_ceil(size);
            let most = energy.iter().copied().fold(0.0, f32::max);
            let wide = size * times;
            let pixels = (0..wide * wide).map(|at| {
                let value = energy[(at / wide / times) * size + (at % wide) / times];
                [(value / most).sqrt(); 3]
            });
            let side = u32::try_from(wide).expect("small");
            let picture = Picture { size: [side; 2], pixels: pixels.collect() };
            picture.write(out, Tone::SHOWN)
        }
        _ => Map { size: [side; 2], channels: vec!["Y"], values: energy }.write(out),
    }
}
