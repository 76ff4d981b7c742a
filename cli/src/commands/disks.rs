//! `realistic disks`: compares the mappings from the square to a disk side by side.

use crate::arguments::whole;
use crate::console;
use crate::drawing::shapes::{Anchor, Page};
use crate::failure::Failure;
use crate::image::{Picture, Sheet, SrgbImage, Tone, hex, picture_path};
use glam::Vec3;
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use realistic_camera::sampling::DiskMapping;
use realistic_lab::pupil::disk_statistics::{ChiSquared, EdgeDiscrepancy};
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::PathBuf;

/// The options of `disks`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Picture to write, .png or .exr; - for a .png on standard output
    #[arg(short, long, value_name = "FILE", default_value = "disks.png", value_parser = picture_path)]
    out: PathBuf,
    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 1, allow_hyphen_values = true, value_parser = whole(0, u64::MAX))]
    seed: u64,
}

/// Maps a sample (u, v) to a point of the unit disk; `None` rejects the sample.
type DiskMap = fn(f64, f64) -> Option<[f64; 2]>;

/// The camera's three mappings, and a wrong mapping, which crowds points in the middle.
const MAPPINGS: [(&str, DiskMap); 4] = [
    ("concentric", |u, v| DiskMapping::Concentric.map(u, v)),
    ("polar, r = sqrt(u)", |u, v| DiskMapping::Polar.map(u, v)),
    ("rejection", |u, v| DiskMapping::Rejection.map(u, v)),
    ("wrong: polar, r = u", |u, v| Some([u * (TAU * v).cos(), u * (TAU * v).sin()])),
];

/// Number of strata along u and along v; each stratum of the square has one point.
const STRATA: u32 = 16;
/// Number of sets of strata over which the discrepancy is averaged.
const SETS: u32 = 32;
/// Number of independent points in the test of uniformity.
const POINTS: usize = 20_000;

/// Draws the sets of points and measures them.
///
/// # Errors
/// The picture cannot be written.
pub fn run(args: &Args) -> Result<(), Failure> {
    let mut sheet = Sheet::new(PANEL, MAPPINGS.len() as u32, 2);
    let mut text = format!(
        "{:<20}  edge discrepancy of {} stratified points   chi-squared of {POINTS}\n\
         {:<20}  {:>12} {:>12}   {:>21} {:>12} {:>9}\n",
        "",
        STRATA * STRATA,
        "",
        "rms",
        "largest",
        "independent points",
        "statistic",
        "p"
    );
    for (name, map) in MAPPINGS {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(args.seed);
        let (rms, largest) = discrepancy(map, &mut rng);
        let test = ChiSquared::of(&independent(map, &mut rng));
        let _ = writeln!(
            text,
            "{name:<20}  {rms:>12.5} {largest:>12.5}   {:>21} {:>12.1} {:>9.3e}",
            format!("{} cells", test.degrees_of_freedom + 1),
            test.statistic,
            test.p_value
        );
        let p = if test.p_value < 1e-3 { "< 0.001".to_owned() } else { format!("= {:.2}", test.p_value) };
        let lines = [format!("discrepancy {rms:.4}"), format!("chi-squared p {p}")];
        let points = stratified(map, &mut Xoshiro256PlusPlus::seed_from_u64(args.seed));
        if let Some(panel) = drawn(&points, &lines) {
            sheet.add(name, &Picture::from(&panel), 1.0);
        }
    }
    sheet.into_picture().write(&args.out, Tone::SHOWN)?;
    let _ = writeln!(text, "{}", args.out.display());
    Ok(console::answer(&text, Some(&args.out))?)
}

/// A point, and the stratum of its sample as column and row; `None` for a replacement of a rejected sample.
type DiskPoint = ([f64; 2], Option<[u32; 2]>);

/// Returns one point for each stratum of the square. As in a host, a rejected sample is replaced by a sample of the
/// whole square.
fn stratified(map: DiskMap, rng: &mut impl Rng) -> Vec<DiskPoint> {
    let cells = (0..STRATA * STRATA).map(|cell| [cell % STRATA, cell / STRATA]);
    cells
        .map(|stratum| {
            let [u, v] = stratum.map(|at| (f64::from(at) + rng.random::<f64>()) / f64::from(STRATA));
            match map(u, v) {
                Some(point) => (point, Some(stratum)),
                None => (again(map, rng), None),
            }
        })
        .collect()
}

/// Returns a point from independent samples.
fn again(map: DiskMap, rng: &mut impl Rng) -> [f64; 2] {
    loop {
        if let Some(point) = map(rng.random::<f64>(), rng.random::<f64>()) {
            return point;
        }
    }
}

fn independent(map: DiskMap, rng: &mut impl Rng) -> Vec<[f64; 2]> {
    (0..POINTS).map(|_| again(map, rng)).collect()
}

/// Returns the mean RMS discrepancy and the mean largest discrepancy of stratified sets.
fn discrepancy(map: DiskMap, rng: &mut impl Rng) -> (f64, f64) {
    let sets = (0..SETS).map(|_| {
        let points: Vec<[f64; 2]> = stratified(map, rng).into_iter().map(|(point, _)| point).collect();
        EdgeDiscrepancy::of(&points)
    });
    let (rms, largest) = sets.fold((0.0, 0.0), |(a, b), set| (a + set.rms, b + set.largest));
    (rms / f64::from(SETS), largest / f64::from(SETS))
}

const PANEL: [u32; 2] = [400, 452];
const RADIUS: f64 = 186.0;
const DOT: f64 = 4.6;
const GROUND: [f32; 3] = [0.012, 0.013, 0.016];
const DISK: [f32; 3] = [0.032, 0.035, 0.042];
const GREY: Vec3 = Vec3::splat(0.33);
const TEXT: [f32; 3] = [0.55, 0.56, 0.58];

/// Draws the points in the colours of their strata: the hue shows the row, and columns go from dark to bright.
fn drawn(points: &[DiskPoint], lines: &[String; 2]) -> Option<SrgbImage> {
    let [width, height] = PANEL.map(f64::from);
    let mut page = Page::on(hex(GROUND), width, height);
    let middle = width / 2.0;
    page.dot([middle; 2], RADIUS + DOT, &hex(DISK));
    for ([x, y], stratum) in points {
        let colour = stratum.map_or(GREY, colour).to_array();
        page.dot([middle + x * RADIUS, middle - y * RADIUS], DOT, &hex(colour));
    }
    for (line, text) in (0_u8..).zip(lines) {
        page.text(text, [middle, width + 20.0 + 22.0 * f64::from(line)], 16.0, Anchor::Middle, &hex(TEXT));
    }
    page.pixels(1.0)
}

/// Returns the colour of a stratum; strata in a block of four by four share one colour.
fn colour([column, row]: [u32; 2]) -> Vec3 {
    const HUES: [Vec3; 4] = [
        Vec3::new(0.95, 0.20, 0.09),
        Vec3::new(0.95, 0.62, 0.06),
        Vec3::new(0.09, 0.66, 0.30),
        Vec3::new(0.10, 0.38, 0.98),
    ];
    let block = STRATA / 4;
    let hue = HUES[(row / block) as usize % 4];
    let shade = (column / block) as f32 / 3.0;
    if shade < 0.5 { hue * (0.22 + 1.2 * shade) } else { hue.lerp(Vec3::ONE, (shade - 0.5) * 1.1) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_rejection_loses_strata() {
        for (name, map) in MAPPINGS {
            let points = stratified(map, &mut Xoshiro256PlusPlus::seed_from_u64(3));
            let accepted = points.iter().filter(|(_, stratum)| stratum.is_some()).count();
            assert_eq!(points.len(), 256);
            assert!(points.iter().all(|([x, y], _)| x.hypot(*y) <= 1.0 + 1e-12), "{name}");
            match name {
                // About 1 - π/4 of the samples lie in the corners.
                "rejection" => assert!((180..225).contains(&accepted), "{accepted}"),
                _ => assert_eq!(accepted, 256, "{name}"),
            }
        }
    }

    #[test]
    fn the_wrong_map_is_uneven_and_the_concentric_most_even() {
        let rms =
            |mapping: usize| discrepancy(MAPPINGS[mapping].1, &mut Xoshiro256PlusPlus::seed_from_u64(3)).0;
        let [concentric, polar, rejection, wrong] = [0, 1, 2, 3].map(rms);
        assert!(concentric < polar && polar < rejection && rejection < wrong);
    }
}
