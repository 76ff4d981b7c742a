//! `realistic focus`: film distance for an object distance or the other way, and depth of field.

use crate::drawing::{depth, picture};
use crate::failure::Failure;
use crate::lens_and_film::{FilmChoice, FilmPlace, LensChoice, distance, focus_by, help, positive};
use realistic::camera::FocusBy;
use realistic::message::{as_given, fixed};
use realistic::{
    imaging::{
        depth_of_field::DepthOfField,
        focus::{Conjugates, Focus, FocusError},
    },
    lens::{
        Lens,
        first_order::FirstOrder,
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
    #[arg(long = "focusby", value_name = "film|group", help = help("focusby"), value_parser = focus_by,
          conflicts_with = "film_distance")]
    focus_by: Option<FocusBy>,
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
    let place = FilmPlace::new(None, args.distance, args.focus_by);
    let (_, lens) = args.lens.open(&place)?;
    let answer = match (args.focus_by, args.distance) {
        (Some(FocusBy::Group), Some(object_distance)) => {
            let [nearest, _] = args.lens.group_reach(&place)?;
            let focused = Conjugates { object_distance, film_distance: place.film_distance(&lens)? };
            Answer::by_groups(&lens, args, focused, nearest)
        }
        _ => Answer::of(&lens, args),
    };
    let answer = answer.map_err(|error| Failure::Other(error.to_string()))?;
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
    by_groups: bool,
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
        "with the film {} mm behind the last vertex nothing in front of the lens is in focus; \
         infinity needs {} mm, the nearest plane in focus ({} mm from the film) {} mm",
        as_given(*film_distance), fixed(*infinity, 4), fixed(*near, 2), fixed(*nearest, 4)
    )]
    NoObject { film_distance: f64, infinity: f64, near: f64, nearest: f64 },
}

/// Where first-order optics puts the film for the plane in focus. Two places serve a plane; the one behind that of the
/// nearest plane makes an image larger than the object.
fn paraxial_film_distance(
    lens: &Lens,
    focus: &Focus,
    focused: Conjugates,
    nearest: Conjugates,
) -> Result<Option<f64>, FocusError> {
    let optics = FirstOrder::of(lens)?;
    let infinity = optics.back_focal_distance();
    let near_infinity = focus.paraxial_film_distance(focused.object_distance);
    Ok(near_infinity.map(|film| {
        // Of Newton's equation: their distances from the focal point have the product f².
        let is_other = focused.film_distance > nearest.film_distance;
        if is_other { infinity + optics.focal_length.powi(2) / (film - infinity) } else { film }
    }))
}

/// The blur that counts as sharp, mm.
fn confusion(args: &Args) -> f64 {
    args.coc.unwrap_or_else(|| args.film.film().pixel())
}

fn depth_of_field(
    lens: &Lens,
    focused: Conjugates,
    confusion: f64,
) -> Result<Option<DepthOfField>, FocusError> {
    let entrance = EntrancePupil::of_surface(lens, limiting_surface(lens));
    let Conjugates { object_distance, film_distance } = focused;
    Ok(DepthOfField::of(lens, &entrance, film_distance, object_distance, confusion)?)
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
        let confusion = confusion(args);
        let beyond_infinity = focused.film_distance < infinity * (1.0 - 1e-9);
        Ok(Self {
            beyond_infinity,
            by_groups: false,
            paraxial: paraxial_film_distance(lens, &focus, focused, nearest)?,
            focused,
            nearest,
            confusion,
            // First-order depth of field is about a plane in focus, and here is none.
            depth: depth_of_field(lens, focused, confusion)?.filter(|_| !beyond_infinity),
        })
    }

    /// Of a lens whose groups stand where they focus on `focused`, and can focus as near as `nearest`.
    fn by_groups(
        lens: &Lens,
        args: &Args,
        focused: Conjugates,
        nearest: Conjugates,
    ) -> Result<Self, Unfocused> {
        let confusion = confusion(args);
        let object = focused.object_distance + lens.rear().vertex - focused.film_distance;
        Ok(Self {
            beyond_infinity: false,
            by_groups: true,
            paraxial: Some(FirstOrder::of(lens).map_err(FocusError::Lens)?.image_distance(object.recip())),
            focused,
            nearest,
            confusion,
            depth: depth_of_field(lens, focused, confusion)?,
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
        } else if film_distance > self.nearest.film_distance {
            ", its image larger than itself"
        } else {
            ""
        };
        let moved = if self.by_groups { "with its groups in place" } else { "by exact rays" };
        let paraxial =
            self.paraxial.map_or_else(|| "none".to_owned(), |paraxial| format!("{} mm", fixed(paraxial, 6)));
        let mut text = format!(
            "in focus         {}{beyond}\n\
             film distance    {} mm {moved}, {paraxial} by first-order optics\n\
             nearest in focus {} mm from the film, with the film at {} mm\n\
             confusion        {} mm\n",
            from_film(object_distance),
            fixed(film_distance, 6),
            fixed(self.nearest.object_distance, 3),
            fixed(self.nearest.film_distance, 6),
            fixed(self.confusion, 6),
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
    if distance.is_finite() {
        format!("{} mm from the film", fixed(distance, 3))
    } else {
        "infinity".to_owned()
    }
}
