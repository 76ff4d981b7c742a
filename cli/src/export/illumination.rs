//! Relative illumination: the brightness of the film off the axis.

use super::field::Film;
use super::fit::polynomial;
use super::law::series;
use super::map::Map;
use super::table::RadialFunction;
use rayon::prelude::*;
use realistic_camera::sampling::PupilDisk;
use realistic_lab::pupil::Outline;
use realistic_optics::lens::Lens;
use realistic_optics::trace::Direction;
use realistic_trace::kernel::Kernel;
use serde_json::{Value, json};

/// The film's irradiance under uniform light, as a share of that in its middle.
#[derive(Clone, Debug)]
pub struct Illumination {
    film: Film,
    /// Distances from the centre, pixels, and the share at each.
    values: Vec<(f64, f64)>,
    /// Distance from the centre up to which there is light, pixels.
    lit: f64,
    /// a₁, a₂ and a₃ of 1 + a₁ρ² + a₂ρ⁴ + a₃ρ⁶, where ρ is 1 in the film's corner.
    pub polynomial: Vec<f64>,
    /// Largest and RMS error of the polynomial over the radius, as shares of the illumination in the middle.
    pub errors: [f64; 2],
}

/// Number of film points from the centre to the edge of the light.
const POINTS: u32 = 32;
/// Number of directions in which the pupil's edge is located.
const DIRECTIONS: usize = 180;
/// Number of coefficients of the polynomial.
const TERMS: usize = 3;

impl Illumination {
    /// Computes the illumination from the area of the pupil and the fourth power of the cosine. This is exact, except
    /// that transmission is ignored.
    ///
    /// Returns `None` if the film does not lie behind the lens, or is dark.
    pub fn of(lens: &Lens, film: Film, lit: f64) -> Option<Self> {
        let kernel = Kernel::new(lens, Direction::FilmToScene);
        let rear = PupilDisk::rear(lens, film.z, 0.5 * film.diagonal)?;
        let at = |i: u32| {
            let radius = lit * f64::from(i) / f64::from(POINTS);
            let point = [radius * film.pixel(), 0.0];
            let outline = Outline::of(&kernel, film.z, point, rear.seen_from(point), DIRECTIONS);
            (radius, outline.map_or(0.0, |outline| outline.irradiance))
        };
        let mut values: Vec<(f64, f64)> = (0..=POINTS).into_par_iter().map(at).collect();
        let middle = values[0].1;
        if !(middle > 0.0) {
            return None;
        }
        for (_, value) in &mut values {
            *value /= middle;
        }
        let square = |radius: f64| (radius / film.corner()).powi(2);
        let points: Vec<(f64, f64)> =
            values.iter().map(|(radius, value)| (square(*radius), *value)).collect();
        let polynomial = polynomial(&points, TERMS);
        let off = points.iter().map(|(z, value)| (series(&polynomial, *z)[0] - value).abs());
        let (worst, squares) =
            off.fold((0.0, 0.0), |(worst, sum): (f64, f64), e| (worst.max(e), sum + e * e));
        let errors = [worst, (squares / points.len() as f64).sqrt()];
        Some(Self { film, values, lit, polynomial, errors })
    }

    /// Returns the share at every pixel.
    pub fn map(&self) -> Map {
        let step = self.lit / f64::from(POINTS);
        let table = RadialFunction::even(step, self.values.iter().map(|(_, value)| *value).collect());
        Map::new(self.film.size, ["Y"], |[x, y]| {
            let radius = x.hypot(y);
            [if radius <= self.lit { table.at(radius).max(0.0) } else { 0.0 }]
        })
    }

    /// Returns α₁, α₂ and α₃ of 1 - (α₁r² + α₂r⁴ + α₃r⁶) with r in mm, as in `OpenLensIO`.
    pub fn falloff_per_mm(&self) -> Vec<f64> {
        let corner = 0.5 * self.film.diagonal;
        (1..).zip(&self.polynomial).map(|(i, a)| -a / corner.powi(2 * i)).collect()
    }

    /// Formats the illumination as JSON.
    pub fn json(&self) -> Value {
        let values = self.values.iter();
        json!({
            "polynomial": self.polynomial,
            "worst_error": self.errors[0],
            "rms_error": self.errors[1],
            "film_radius_px": values.clone().map(|(radius, _)| *radius).collect::<Vec<_>>(),
            "relative_illumination": values.map(|(_, value)| *value).collect::<Vec<_>>(),
        })
    }
}
