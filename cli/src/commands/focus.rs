//! `realistic focus`: film distance for an object distance or the other way, and depth of field.

use crate::drawing::{depth, picture};
use crate::failure::Failure;
use crate::lens_and_film::{FilmChoice, LensChoice, distance, positive};
use realistic::{
    imaging::{
        depth_of_field::DepthOfField,
        focus::{Conjugates, Focus, FocusError},
    },
    lens::{
        Lens,
        pupil::{EntrancePupil, limiting_surface},
    },
};
use serde_json::json;
use std::io::Write as _;
use std::path::PathBuf;

/// What `focus` can be told.
#[derive(clap::Args, Debug)]
#[command(group = clap::ArgGroup::new("where").required(true))]
pub struct Args {
    #[command(flatten)]
    lens: LensChoice,
    /// Distance in mm from the film to the object, along the axis, or inf
    #[arg(long, value_name = "MM", allow_negative_numbers = true, group = "where", value_parser = distance)]
    distance: Option<f64>,
    /// Distance in mm from the last vertex to the film, to learn what is in focus
    #[arg(long, value_name = "MM", allow_negative_numbers = true, group = "where", value_parser = positive)]
    film_distance: Option<f64>,
    /// Circle of confusion: the blur on film, in mm, that still counts as sharp
    /// [default: a pixel of the film]
    #[arg(long, value_name = "MM", allow_negative_numbers = true, value_parser = positive)]
    coc: Option<f64>,
    #[command(flatten)]
    film: FilmChoice,
    /// Draw the depth of field to this file, .svg or .png
    #[arg(long, value_name = "FILE", value_parser = picture::path)]
    out: Option<PathBuf>,
    /// Write JSON; null stands for infinity, and for what does not exist
    #[arg(long)]
    json: bool,
}

/// Prints what is in focus.
///
/// # Errors
/// The lens cannot focus there; the message says how near it can.
pub fn run(args: &Args) -> Result<(), Failure> {
    let (_, lens) = args.lens.open()?;
    let answer = Answer::of(&lens, args).map_err(|error| Failure::Other(error.to_string()))?;
    let mut text = if args.json { format!("{:#}\n", answer.json()) } else { answer.text() };
    if let Some(out) = &args.out {
        let depth = answer.depth.ok_or_else(|| {
            Failure::Other(
                "there is no depth of field to draw: leave out --out, or focus on an object".to_owned(),
            )
        })?;
        let drawing = depth::Drawing {
            title: format!("{}: depth of field", lens.name),
            focus: answer.focused.object_distance,
            nearest: answer.nearest.object_distance,
            depth,
            confusion: answer.confusion,
        };
        picture::write(&depth::draw(&drawing), out)?;
        if !args.json {
            text += &format!("drawn            {}\n", out.display());
        }
    }
    Ok(std::io::stdout().write_all(text.as_bytes())?)
}

struct Answer {
    focused: Conjugates,
    /// Where the film lies before the image of infinity nothing is quite sharp.
    beyond_infinity: bool,
    paraxial: Option<f64>,
    nearest: Conjugates,
    confusion: f64,
    depth: Option<DepthOfField>,
}

#[derive(Debug, thiserror::Error)]
enum Unfocused {
    #[error(transparent)]
    Focus(#[from] FocusError),
    #[error(
        "with the film {film_distance} mm behind the last vertex nothing in front of the lens is in focus; \
         infinity needs {infinity:.4} mm, the nearest plane in focus ({near:.2} mm from the film) {nearest:.4} mm"
    )]
    NoObject { film_distance: f64, infinity: f64, near: f64, nearest: f64 },
}

impl Answer {
    fn of(lens: &Lens, args: &Args) -> Result<Self, Unfocused> {
        let focus = Focus::new(lens)?;
        let nearest = focus.nearest();
        let infinity = focus.film_distance(f64::INFINITY)?;
        let focused = match (args.distance, args.film_distance) {
            (_, Some(film_distance)) => {
                let object_distance = focus.object_distance(film_distance).ok_or(Unfocused::NoObject {
                    film_distance,
                    infinity,
                    near: nearest.object_distance,
                    nearest: nearest.film_distance,
                })?;
                Conjugates { object_distance, film_distance }
            }
            (object, None) => {
                let object_distance = object.unwrap_or(f64::INFINITY);
                Conjugates { object_distance, film_distance: focus.film_distance(object_distance)? }
            }
        };
        let confusion = args.coc.unwrap_or_else(|| args.film.film().pixel());
        let entrance = EntrancePupil::of_surface(lens, limiting_surface(lens));
        let depth =
            DepthOfField::of(lens, &entrance, focused.film_distance, focused.object_distance, confusion);
        let beyond_infinity = focused.film_distance < infinity * (1.0 - 1e-9);
        Ok(Self {
            beyond_infinity,
            paraxial: focus.paraxial_film_distance(focused.object_distance),
            focused,
            nearest,
            confusion,
            // First-order depth of field is about a plane in focus, and here is none.
            depth: depth.map_err(FocusError::Lens)?.filter(|_| !beyond_infinity),
        })
    }

    fn json(&self) -> serde_json::Value {
        // An infinite number becomes null.
        json!({
            "object_distance_mm": self.focused.object_distance,
            "film_distance_mm": self.focused.film_distance,
            "film_distance_paraxial_mm": self.paraxial,
            "nearest_object_distance_mm": self.nearest.object_distance,
            "nearest_film_distance_mm": self.nearest.film_distance,
            "circle_of_confusion_mm": self.confusion,
            "near_limit_mm": self.depth.map(|depth| depth.near),
            "far_limit_mm": self.depth.map(|depth| depth.far),
            "hyperfocal_distance_mm": self.depth.map(|depth| depth.hyperfocal),
            "film_before_image_of_infinity": self.beyond_infinity,
        })
    }

    fn text(&self) -> String {
        let Conjugates { object_distance, film_distance } = self.focused;
        let beyond = if self.beyond_infinity {
            "\n                 (the film lies before the image of infinity: nothing is quite sharp)"
        } else {
            ""
        };
        let paraxial =
            self.paraxial.map_or_else(|| "none".to_owned(), |paraxial| format!("{paraxial:.6} mm"));
        let mut text = format!(
            "in focus         {}{beyond}\n\
             film distance    {film_distance:.6} mm by exact rays, {paraxial} by first-order optics\n\
             nearest in focus {:.3} mm from the film, with the film at {:.6} mm\n\
             confusion        {:.6} mm\n",
            from_film(object_distance),
            self.nearest.object_distance,
            self.nearest.film_distance,
            self.confusion,
        );
        text += &match self.depth {
            _ if self.beyond_infinity => String::new(),
            None => "depth of field   none: the entrance pupil is at infinity\n".to_owned(),
            Some(depth) => format!(
                "sharp            from {} to {}\nhyperfocal       {}\n",
                from_film(depth.near),
                from_film(depth.far),
                from_film(depth.hyperfocal),
            ),
        };
        text
    }
}

fn from_film(distance: f64) -> String {
    if distance.is_finite() { format!("{distance:.3} mm from the film") } else { "infinity".to_owned() }
}
