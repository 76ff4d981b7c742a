//! The error of a model against the exact chief rays, and the lens properties that no model can represent.

use super::field::ChiefField;
use super::law::Quantity;
use super::model::{Fitted, PLANE_REACH};
use realistic_base::message::{fixed, short};
use serde_json::{Value, json};
use std::fmt::Write as _;

/// Distances on the film between chief rays and a model's predictions, pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Largest error.
    pub worst: f64,
    /// Distance of the largest error from the centre.
    pub at: f64,
    /// RMS error over the part of the film that the model covers.
    pub rms: f64,
    /// Share of the film's area that the model covers.
    pub share: f64,
}

impl Errors {
    /// Returns the fields as an array.
    pub fn numbers(&self) -> [f64; 4] {
        [self.worst, self.at, self.rms, self.share]
    }

    /// Combines the errors at several distances from the centre, with their shares of the film.
    fn of(each: impl Iterator<Item = (f64, f64, f64)>) -> Self {
        let mut errors = Self { worst: 0.0, at: 0.0, rms: 0.0, share: 0.0 };
        for (radius, error, share) in each {
            if !(error <= errors.worst) {
                (errors.worst, errors.at) = (error, radius);
            }
            errors.rms += share * error * error;
            errors.share += share;
        }
        errors.rms = (errors.rms / errors.share).sqrt();
        errors.share = errors.share.min(1.0);
        errors
    }

    /// Compares a model with rays, up to the distance from the centre that the model covers.
    pub fn of_model(model: &Fitted, rays: &ChiefField) -> Self {
        // The inverse of the law is searched even beyond the film.
        let reach = model.law.grows_to(2.0 * rays.film.corner());
        let held = rays.rings.iter().take_while(|ring| ring.radius <= model.held.lit * (1.0 + 1e-9));
        Self::of(held.map(|ring| {
            let found = model.law.project(ring.angle, reach).unwrap_or(f64::INFINITY);
            (ring.radius, (found - ring.radius).abs(), ring.share)
        }))
    }

    /// Returns the errors of a map that has the quantity at the centres of pixels, when it is interpolated halfway
    /// between two centres.
    pub fn of_map(quantity: Quantity, rays: &ChiefField) -> Self {
        let rays = if quantity == Quantity::Tangent { rays.within(PLANE_REACH) } else { rays.clone() };
        let table = rays.odd(|ring| quantity.of(ring.radius, ring.angle));
        let share = rays.share();
        let pixels = rays.lit as u32;
        Self::of((0..pixels).map(|i| {
            let [a, b, c] = [0.0, 0.5, 1.0].map(|by| table.at(f64::from(i) + by));
            // The weight of every step is the share of the film that its ring covers.
            let ring = f64::from(2 * i + 1) / f64::from(pixels).powi(2);
            (f64::from(i), ((a + c) / 2.0 - b).abs() / (c - a), ring * share)
        }))
    }

    /// Formats the errors as JSON.
    pub fn json(&self) -> Value {
        json!({
            "worst_px": finite(self.worst),
            "worst_at_px": self.at,
            "rms_px": finite(self.rms),
            "share_of_film": self.share,
        })
    }
}

fn finite(value: f64) -> Option<f64> {
    Some(value).filter(|value| value.is_finite())
}

/// The lens focused at another distance, on the same film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Focus {
    /// Distance from the film to the plane in focus, mm.
    pub distance: f64,
    /// Distance from the last vertex to the film, mm.
    pub film_distance: f64,
    /// Pixels per unit of the tangent, in the middle of the film.
    pub scale: f64,
    /// Largest angle from the axis.
    pub half_field: f64,
    /// Distance from the film to the entrance pupil, mm.
    pub pupil: f64,
    /// Error of the model, which is fitted at another focus.
    pub errors: Option<Errors>,
}

impl Focus {
    /// Measures the lens at this focus by its rays.
    pub fn of(distance: f64, film_distance: f64, rays: &ChiefField, model: Option<&Fitted>) -> Self {
        Self {
            distance,
            film_distance,
            scale: rays.central_scale(),
            half_field: rays.extent().0,
            pupil: rays.pinhole - rays.film.z,
            errors: model.map(|model| Errors::of_model(model, rays)),
        }
    }
}

/// The report of an export.
#[derive(Debug)]
pub struct Report<'a> {
    /// Name that `--as` uses.
    pub format: &'a str,
    /// The lens's name.
    pub name: &'a str,
    /// Wavelength, nm.
    pub wavelength: f64,
    /// Distance from the last vertex to the film, mm.
    pub film_distance: f64,
    /// The exact rays.
    pub rays: &'a ChiefField,
    /// The model, if the format is one.
    pub model: Option<&'a Fitted>,
    /// The error on the film.
    pub errors: Option<Errors>,
    /// The lens at other distances.
    pub breathing: &'a [Focus],
    /// Entries that the format adds to the JSON.
    pub more: &'a [(&'static str, Value)],
    /// Lines that the format adds to the text: names and values.
    pub lines: &'a [(&'static str, String)],
}

impl Report<'_> {
    /// Returns the z of the objects for which parallax is reported: 20 focal lengths in front of the pinhole.
    fn near(&self) -> f64 {
        self.rays.pinhole + 20.0 * self.rays.central_scale() * self.rays.film.pixel()
    }

    /// Returns the limits up to which the model's law grows with its argument, as an angle and as a film radius, and
    /// whether the range includes all of the fitted rays.
    fn monotonic(model: &Fitted) -> (f64, f64, bool) {
        let (law, [angle, radius]) = (&model.law, [model.held.extent().0, model.held.lit]);
        let reach = match law.shape.from {
            Quantity::Radius => 2.0 * model.held.film.corner(),
            Quantity::Angle => 3.2_f64.min(2.0 * angle),
            Quantity::Tangent => (0.5 * (angle + 1.57)).tan(),
        };
        let end = law.grows_to(reach);
        let (angle_there, radius_there) = match law.shape.from {
            Quantity::Radius => (law.unproject(end, 3.2).unwrap_or(angle), end),
            Quantity::Angle => (end, law.at(end)),
            Quantity::Tangent => (end.atan(), law.at(end)),
        };
        (angle_there, radius_there, angle_there >= angle * (1.0 - 1e-3) && radius_there >= 0.99 * radius)
    }

    /// Formats the report as JSON.
    pub fn json(&self) -> Value {
        let rays = self.rays;
        let (film, (half_field, walk)) = (rays.film, rays.extent());
        let distance = rays.in_focus - film.z;
        let step = (rays.rings.len() - 1) / 16;
        let walks: Vec<Value> = (0..=16)
            .map(|i| rays.rings[i * step])
            .map(|ring| {
                json!({
                    "film_radius_px": ring.radius,
                    "angle_deg": ring.angle.to_degrees(),
                    "pupil_walk_mm": ring.pupil - rays.pinhole,
                })
            })
            .collect();
        let mut value = json!({
            "as": self.format,
            "ray": "chief",
            "name": self.name,
            "wavelength": self.wavelength,
            "film_distance": self.film_distance,
            "film_diagonal": film.diagonal,
            "film_size_mm": film.sides(),
            "focus_distance_mm": finite(distance),
            "size_px": film.size,
            "pixel_mm": film.pixel(),
            "half_field_deg": half_field.to_degrees(),
            "lit_radius_px": rays.lit,
            "lit_share_of_film": rays.share(),
            "entrance_pupil_mm": rays.pinhole,
            "entrance_pupil_from_film_mm": rays.pinhole - film.z,
            "pupil_walk_mm": walk,
            "pupil_walks": walks,
            "errors": self.errors.map(|errors| errors.json()),
            "breathing": self.breathing.iter().map(|focus| self.focus_json(focus)).collect::<Vec<_>>(),
        });
        if let Some(model) = self.model {
            let (angle, radius, whole) = Self::monotonic(model);
            let near = Errors::of_model(model, &rays.looking_at(self.near()));
            value["parameters"] = model.parameters();
            value["held_half_field_deg"] = json!(model.held.extent().0.to_degrees());
            value["monotonic"] =
                json!({ "to_deg": angle.to_degrees(), "to_px": radius, "over_the_fit": whole });
            value["near_object"] = json!({ "distance_mm": self.near() - film.z, "errors": near.json() });
        }
        for (key, more) in self.more {
            value[*key] = more.clone();
        }
        value
    }

    fn focus_json(&self, focus: &Focus) -> Value {
        json!({
            "focus_distance_mm": finite(focus.distance),
            "film_distance": focus.film_distance,
            "image_scale_px": focus.scale,
            "image_scale_change": focus.scale / self.rays.central_scale() - 1.0,
            "half_field_deg": focus.half_field.to_degrees(),
            "entrance_pupil_from_film_mm": focus.pupil,
            "errors": focus.errors.map(|errors| errors.json()),
        })
    }

    /// Formats the report as text.
    pub fn text(&self) -> String {
        let rays = self.rays;
        let (half_field, walk) = rays.extent();
        let [width, height] = rays.film.size;
        let mut text = format!("lens              {} as {}\n", self.name, self.format);
        let mut line = |name: &str, words: String| {
            let _ = writeln!(text, "{name:<17} {words}");
        };
        line(
            "film",
            format!(
                "{width}x{height} pixels of {} mm, {} mm behind the last vertex, focused {}",
                short(rays.film.pixel()),
                fixed(self.film_distance, 4),
                far(rays.in_focus - rays.film.z)
            ),
        );
        let lit = rays.share();
        let dark = if lit < 0.9995 {
            format!(
                "; light ends {} pixels from the centre, {:.1} % of the film have it",
                fixed(rays.lit, 1),
                100.0 * lit
            )
        } else {
            String::new()
        };
        line("field", format!("{} degrees from the axis{dark}", fixed(half_field.to_degrees(), 3)));
        if let Some(errors) = self.errors {
            line(
                "error",
                format!(
                    "worst {} pixels, {} from the centre; RMS {} pixels",
                    digits(errors.worst),
                    fixed(errors.at, 0),
                    digits(errors.rms)
                ),
            );
        }
        if let Some(model) = self.model {
            let held = model.held.extent().0;
            if held < half_field {
                line(
                    "held",
                    format!(
                        "{} degrees from the axis: a model that projects onto a plane holds no more, and the other {:.1} % of \
                         the lit film have no part in the fit; kannala-brandt and ftheta hold all",
                        fixed(held.to_degrees(), 2),
                        100.0 * (1.0 - model.held.share() / rays.share())
                    ),
                );
            }
            let (angle, radius, whole) = Self::monotonic(model);
            let words = if whole { "over the whole fit, to" } else { "only to" };
            line(
                "inverse",
                format!(
                    "monotonic {words} {} degrees, {} pixels",
                    fixed(angle.to_degrees(), 2),
                    fixed(radius, 0)
                ),
            );
            let near = Errors::of_model(model, &rays.looking_at(self.near()));
            line(
                "parallax",
                format!(
                    "an object {} in front of the film: worst {} pixels",
                    far(self.near() - rays.film.z),
                    digits(near.worst)
                ),
            );
        }
        line(
            "pupil",
            format!(
                "{} mm in front of the film; walks {} mm over the field, which no model with one projection centre holds",
                fixed(rays.pinhole - rays.film.z, 4),
                fixed(walk, 4)
            ),
        );
        for (name, words) in self.lines {
            line(name, words.clone());
        }
        for focus in self.breathing {
            let errors = focus.errors.map_or_else(String::new, |errors| {
                format!(", this model's worst error {} pixels", digits(errors.worst))
            });
            line(
                "focused",
                format!(
                    "{}: image scale {:+.3} %{errors}",
                    far(focus.distance),
                    100.0 * (focus.scale / rays.central_scale() - 1.0)
                ),
            );
        }
        text
    }
}

fn far(distance: f64) -> String {
    if distance.is_finite() { format!("at {} mm", fixed(distance, 1)) } else { "at infinity".to_owned() }
}

/// Formats small errors with their significant digits, large ones with four decimals.
fn digits(error: f64) -> String {
    if error.is_finite() && error < 1e-3 { format!("{error:.1e}") } else { fixed(error, 4) }
}
