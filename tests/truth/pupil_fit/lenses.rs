//! Random cameras to which nothing is tuned: the catalogue's designs with other radii, thicknesses and apertures, and
//! arbitrary lenses that pass the checks of a lens file; with films, stops and focus distances of any kind.

use std::fmt::Write;

use rand::{RngExt, SeedableRng};
use rand_xoshiro::SplitMix64;
use realistic_optics::{imaging::focus::Focus, lens::Lens, prescription::read};

use super::lens_at;

/// Designs that are modified.
const DESIGNS: [&str; 4] = ["dgauss.50mm", "wide.22mm", "telephoto.250mm", "fisheye.10mm"];

/// A random lens with its film.
pub struct RandomCamera {
    /// A description, for messages.
    pub name: String,
    pub lens: Lens,
    /// Distance from the last vertex to the film, mm.
    pub distance: f64,
    /// Half the film's diagonal, mm.
    pub corner: f64,
}

/// Returns the camera of a number; the same number gives the same camera.
pub fn camera(number: u64) -> RandomCamera {
    let mut random = SplitMix64::seed_from_u64(number);
    loop {
        let designed = random.random_bool(0.75);
        let text = if designed { changed_design(&mut random) } else { anything(&mut random) };
        let Ok(prescription) = read("random", text.as_bytes()) else { continue };
        let mut lens = Lens::at_d_line(&prescription);
        if let (Some(stop), true) = (lens.stop_index(), random.random_bool(0.6)) {
            lens.surfaces[stop].semi_diameter *= scaled(&mut random, 0.05, 1.0);
        }
        let Ok(focus) = Focus::new(&lens) else { continue };
        let object = if random.random_bool(0.3) { f64::INFINITY } else { scaled(&mut random, 300.0, 1e5) };
        let Ok(distance) = focus.film_distance(object) else { continue };
        let corner = distance * scaled(&mut random, 0.1, 0.9);
        return RandomCamera { name: format!("camera {number}\n{text}"), lens, distance, corner };
    }
}

/// Returns a number with a uniform logarithm in [from, to).
fn scaled(random: &mut SplitMix64, from: f64, to: f64) -> f64 {
    random.random_range(from.ln()..to.ln()).exp()
}

/// Returns the text of a catalogue lens of another size, with each number slightly changed.
fn changed_design(random: &mut SplitMix64) -> String {
    let lens = lens_at(DESIGNS[random.random_range(0..DESIGNS.len())], None);
    let size = scaled(random, 0.4, 2.5);
    let strength = scaled(random, 0.002, 0.05);
    let mut change = |by: f64| size * (1.0 + by * random.random_range(-1.0..1.0));
    let mut text = String::new();
    for surface in &lens.surfaces {
        let radius = if surface.radius.is_finite() { change(strength) * surface.radius } else { 0.0 };
        let thickness = change(2.0 * strength) * surface.thickness;
        let semi_diameter = change(4.0 * strength) * surface.semi_diameter;
        let widest = if radius == 0.0 { f64::INFINITY } else { 0.999 * radius.abs() };
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{radius} {thickness} {} {}", surface.n_film, 2.0 * semi_diameter.min(widest));
    }
    text
}

/// Returns the text of one to four elements of any shape, with or without a stop.
fn anything(random: &mut SplitMix64) -> String {
    let elements = random.random_range(1..=4);
    let stop = random.random_range(0..2 * elements);
    let semi = scaled(random, 3.0, 30.0);
    let mut text = String::new();
    for element in 0..elements {
        let mut radius = || {
            let radius = semi * scaled(random, 1.2, 30.0);
            if random.random_bool(0.6) { radius } else { -radius }
        };
        let (front, back) = (radius(), -radius());
        let (thickness, gap) = (semi * random.random_range(0.1..0.5), semi * random.random_range(0.1..1.0));
        let (own, index) = (semi * random.random_range(0.7..1.0), random.random_range(1.45..1.9));
        let _ = writeln!(text, "{front} {thickness} {index} {}\n{back} {gap} 1 {}", 2.0 * own, 2.0 * own);
        if element == stop {
            let _ = writeln!(text, "0 {gap} 1 {}", semi * random.random_range(0.3..1.2));
        }
    }
    text
}
