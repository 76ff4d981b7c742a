//! `realistic mtf`: the contrast of fine detail at an image point, with diffraction and by rays alone.

use super::{ImagePoint, PointArgs, warn_unless_valid};
use crate::console;
use crate::failure::Failure;
use crate::files;
use realistic_waves::{Sampling, WaveError, Wavefront, mtf::Contrast};
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::path::PathBuf;

/// The options of `mtf`.
#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(flatten)]
    point: PointArgs,
    /// Frequencies, cycles per mm
    #[arg(long, value_name = "F,...", value_delimiter = ',', default_value = "10,20,30,40,50,60,80,100,150,200", value_parser = crate::arguments::positive)]
    frequencies: Vec<f64>,
    /// Distances by which the film is moved away from the lens, mm: a table for each, through focus
    #[arg(long, value_name = "MM,...", value_delimiter = ',', default_value = "0", allow_hyphen_values = true, value_parser = finite)]
    defocus: Vec<f64>,
    /// File to write, .csv; - for standard output
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Write JSON
    #[arg(long)]
    json: bool,
}

fn finite(text: &str) -> Result<f64, String> {
    text.trim()
        .parse()
        .ok()
        .filter(|number: &f64| number.is_finite())
        .ok_or_else(|| format!("{text:?} is not a number"))
}

/// Largest number of tables.
const MOST_TABLES: usize = 101;

/// Contrasts at one place of the film.
struct Table {
    defocus: f64,
    /// Tangential and sagittal, each with diffraction, by rays alone, and of a perfect lens with the same pupil.
    contrasts: [[Vec<f64>; 3]; 2],
    error: f64,
}

impl Table {
    fn of(point: &ImagePoint, frequencies: &[f64], defocus: f64) -> Result<Self, WaveError> {
        let (radial, length) = (point.at, point.at[0].hypot(point.at[1]));
        let radial = if length > 0.0 { radial.map(|part| part / length) } else { [0.0, 1.0] };
        let directions = [radial, [-radial[1], radial[0]]];
        let own = point.wavefronts(point.sampling, defocus)?;
        let coarse = point.wavefronts(Sampling::coarser(point.sampling), defocus)?;
        let contrasts = |wavefronts: &[(f64, Wavefront)]| Mixed::of(wavefronts);
        let (fine, coarse, perfect) = (
            contrasts(&own),
            contrasts(&coarse),
            contrasts(&own.iter().map(|(weight, wave)| (*weight, wave.perfect())).collect::<Vec<_>>()),
        );
        let mut error = 0.0;
        let contrasts = directions.map(|direction| {
            let [own, rays] = fine.along(direction, frequencies);
            let [other, _] = coarse.along(direction, frequencies);
            let [limit, _] = perfect.along(direction, frequencies);
            error = own.iter().zip(&other).map(|(a, b)| (a - b).abs()).fold(error, f64::max);
            [own, rays, limit]
        });
        Ok(Self { defocus, contrasts, error })
    }
}

/// Contrasts of several wavelengths.
struct Mixed(Vec<(f64, Contrast)>);

impl Mixed {
    fn of(wavefronts: &[(f64, Wavefront)]) -> Self {
        let whole: f64 = wavefronts.iter().map(|(weight, _)| weight).sum();
        Self(wavefronts.iter().map(|(weight, wave)| (weight / whole, Contrast::new(wave))).collect())
    }

    /// Returns the contrasts with diffraction and by rays alone.
    fn along(&self, direction: [f64; 2], frequencies: &[f64]) -> [Vec<f64>; 2] {
        let parts: Vec<_> = self
            .0
            .iter()
            .map(|(weight, contrast)| (*weight, contrast.along(direction, frequencies)))
            .collect();
        [true, false].map(|waves| {
            (0..frequencies.len())
                .map(|i| {
                    let sum = parts.iter().fold([0.0; 2], |[re, im], (weight, mtf)| {
                        let [a, b] = if waves { mtf.with_diffraction[i] } else { mtf.geometric[i] };
                        [re + weight * a, im + weight * b]
                    });
                    sum[0].hypot(sum[1])
                })
                .collect()
        })
    }
}

/// Computes the contrasts and prints or writes them.
///
/// # Errors
/// As for [`ImagePoint::of`]; no light arrives at the point, or the file cannot be written.
pub fn run(args: &Args) -> Result<(), Failure> {
    if args.defocus.len() > MOST_TABLES {
        return Err(Failure::Usage(format!("--defocus takes at most {MOST_TABLES} numbers")));
    }
    let point = ImagePoint::of(&args.point)?;
    let tables: Vec<Table> = (args.defocus.iter())
        .map(|&defocus| Table::of(&point, &args.frequencies, defocus))
        .collect::<Result<_, WaveError>>()?;
    let error = tables.iter().map(|table| table.error).fold(0.0, f64::max);
    warn_unless_valid(error, point.sampling.across);
    if let Some(out) = args.out.as_deref().filter(|out| !files::is_stdout(out)) {
        files::make_parent(out)?;
        files::save(out, csv(&tables, &args.frequencies).as_bytes())
            .map_err(|error| Failure::cannot_write(out, &error))?;
    }
    let wavefront = &point.wavefronts(point.sampling, 0.0)?[0].1;
    let text = if args.json {
        let mut json = point.json(wavefront);
        let table = |table: &Table| {
            let [tangential, sagittal] = table
                .contrasts
                .each_ref()
                .map(|[own, rays, limit]| json!({ "mtf": own, "geometric": rays, "perfect_lens": limit }));
            json!({ "defocus_mm": table.defocus, "tangential": tangential, "sagittal": sagittal, "error": table.error })
        };
        let own = json!({
            "frequencies_per_mm": args.frequencies,
            "tables": tables.iter().map(table).collect::<Vec<_>>(),
        });
        let (Value::Object(all), Value::Object(own)) = (&mut json, own) else { unreachable!("objects") };
        all.extend(own);
        format!("{json:#}\n")
    } else if args.out.as_deref().is_some_and(files::is_stdout) {
        csv(&tables, &args.frequencies)
    } else {
        point.text(wavefront) + &tables.iter().map(|table| text(table, &args.frequencies)).collect::<String>()
    };
    Ok(console::answer(&text, None)?)
}

fn rows<'a>(table: &'a Table, frequencies: &'a [f64]) -> impl Iterator<Item = (f64, [f64; 6])> + 'a {
    frequencies.iter().enumerate().map(|(i, frequency)| {
        let [t, s] = table.contrasts.each_ref().map(|parts| parts.each_ref().map(|part| part[i]));
        (*frequency, [t[0], s[0], t[1], s[1], t[2], s[2]])
    })
}

fn text(table: &Table, frequencies: &[f64]) -> String {
    let mut text = match table.defocus {
        0.0 => String::new(),
        defocus => format!("film moved by {defocus} mm\n"),
    };
    text += "cycles per mm   tangential  sagittal   by rays: tangential  sagittal   perfect lens: tangential  sagittal\n";
    for (frequency, [t, s, rays_t, rays_s, limit_t, limit_s]) in rows(table, frequencies) {
        let _ = writeln!(
            text,
            "{frequency:13}   {t:10.4}  {s:8.4}   {rays_t:19.4}  {rays_s:8.4}   {limit_t:24.4}  {limit_s:8.4}"
        );
    }
    let _ = writeln!(text, "error           {:.1e}, by three quarters of the rays", table.error);
    text
}

fn csv(tables: &[Table], frequencies: &[f64]) -> String {
    let mut text = "defocus_mm,cycles_per_mm,tangential,sagittal,tangential_by_rays,sagittal_by_rays,tangential_perfect,sagittal_perfect\n".to_owned();
    for table in tables {
        for (frequency, numbers) in rows(table, frequencies) {
            let numbers: Vec<String> = numbers.iter().map(|number| format!("{number:.6}")).collect();
            let _ = writeln!(text, "{},{frequency},{}", table.defocus, numbers.join(","));
        }
    }
    text
}
