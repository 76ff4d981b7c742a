//! `realistic focus`: the film distance for an object distance or the reverse, and the depth of field.

use crate::arguments::{LensChoice, OpenedLens, positive};
use crate::console;
use crate::drawing::{depth, output};
use crate::failure::Failure;
use realistic_base::message::{as_given, fixed, short};
use realistic_camera::{FocusBy, ParameterError};
use realistic_optics::{
    imaging::{
        axial_beam::AxialBeam,
        focus::{Conjugates, DepthOfField, Focus, FocusError},
    },
    lens::{Lens, first_order::FirstOrder},
};
use serde_json::json;
use std::path::PathBuf;

/// The options of `focus`.
#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(flatten)]
    lens: LensChoice,
    /// Circle of confusion: the blur on film, in mm, that still counts as sharp
    /// [default: the film's diagonal / 1442]
    #[arg(long, value_name = "MM", allow_hyphen_values = true, value_parser = positive)]
    coc: Option<f64>,
    /// Draw the depth of field to this file, .svg or .png; - for an .svg on standard output
    #[arg(short, long, value_name = "FILE", value_parser = output::path)]
    out: Option<PathBuf>,
    /// Write JSON; null means infinite or absent
    #[arg(long)]
    json: bool,
}

/// Prints the plane in focus.
///
/// # Errors
/// The lens cannot focus on this plane; the message states the lens's nearest distance.
pub fn run(args: &Args) -> Result<(), Failure> {
    let opened = args.lens.open()?;
    let lens = &opened.lens;
    let given = opened.parameters();
    let diagonal = opened.film_diagonal();
    let scale = FilmScale { diagonal, confusion: args.coc.unwrap_or(diagonal / PER_DIAGONAL) };
    let by_groups = given.focus_by == Some(FocusBy::Group);
    let answer = match (given.focus_distance, given.film_distance) {
        (Some(_), Some(_)) => {
            return Err(ParameterError::Both { first: "film_distance", second: "focus_distance" }.into());
        }
        (None, None) => {
            return Err(Failure::Usage(
                "focused where? Give --focus-distance MM, from the film to the object (or inf), or --film-distance MM, \
                 from the last vertex to the film, to learn what is in focus"
                    .to_owned(),
            ));
        }
        (Some(distance), None) => {
            let object_distance = distance * given.mm_per_unit.unwrap_or(1.0);
            if by_groups {
                let [nearest, _] = opened.group_reach()?;
                let focused = Conjugates { object_distance, film_distance: opened.film_distance()? };
                FocusAnswer::by_groups(&opened, scale, focused, nearest)
            } else {
                FocusAnswer::of(lens, scale, |focus| {
                    Ok(Conjugates { object_distance, film_distance: focus.film_distance(object_distance)? })
                })
            }
        }
        (None, Some(film_distance)) => FocusAnswer::of(lens, scale, |focus| in_focus(focus, film_distance)),
    };
    let answer = answer.map_err(|error| Failure::Other(error.to_string()))?;
    let mut text = if args.json { format!("{:#}\n", answer.json(lens)) } else { answer.text() };
    if let Some(out) = &args.out {
        let depth = answer.depth.ok_or_else(|| {
            Failure::Other(
                "there is no depth of field to draw: leave out --out, or focus on an object".to_owned(),
            )
        })?;
        let drawing = depth::DepthDrawing {
            title: format!("{}: depth of field", lens.name),
            focus: answer.focused.object_distance,
            nearest: answer.nearest.object_distance,
            depth,
            confusion: answer.scale.confusion,
        };
        output::write(&depth::draw(&drawing), out)?;
        if !args.json {
            text += &format!("drawn            {}\n", out.display());
        }
    }
    Ok(console::answer(&text, args.out.as_deref())?)
}

/// Number of circles of confusion in the film diagonal, by the photographers' convention of 0.03 mm on 24 x 36 mm.
const PER_DIAGONAL: f64 = 1442.0;

/// The film's diagonal and the circle of confusion, mm.
#[derive(Clone, Copy, Debug)]
struct FilmScale {
    diagonal: f64,
    confusion: f64,
}

/// Returns the conjugates of a film at this distance.
fn in_focus(focus: &Focus, film_distance: f64) -> Result<Conjugates, Unfocused> {
    let object_distance = match focus.object_distance(film_distance) {
        Some(distance) => distance,
        None => {
            let infinity = focus.film_distance(f64::INFINITY)?;
            let Conjugates { object_distance: near, film_distance: nearest } = focus.nearest();
            return Err(Unfocused::NoObject { film_distance, infinity, near, nearest });
        }
    };
    Ok(Conjugates { object_distance, film_distance })
}

struct FocusAnswer {
    focused: Conjugates,
    by_groups: bool,
    /// Whether the film lies in front of the image of infinity, so that nothing is quite sharp.
    beyond_infinity: bool,
    paraxial: Option<f64>,
    nearest: Conjugates,
    scale: FilmScale,
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

/// Returns the first-order film distance for the plane in focus. There are two such film distances for a plane; the
/// one behind the film distance of the nearest plane gives an image larger than the object.
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
        // Newton's equation: the product of the conjugates' distances from the focal points is n n'/φ².
        let is_other = focused.film_distance > nearest.film_distance;
        if is_other { infinity + optics.mean_focal_length().powi(2) / (film - infinity) } else { film }
    }))
}

fn depth_of_field(
    lens: &Lens,
    focused: Conjugates,
    confusion: f64,
) -> Result<Option<DepthOfField>, FocusError> {
    let entrance = AxialBeam::of(lens).entrance;
    let Conjugates { object_distance, film_distance } = focused;
    Ok(DepthOfField::of(lens, &entrance, film_distance, object_distance, confusion)?)
}

impl FocusAnswer {
    /// Makes the answer for a lens that moves as a whole and is focused at the conjugates `focused`.
    fn of(
        lens: &Lens,
        scale: FilmScale,
        focused: impl FnOnce(&Focus) -> Result<Conjugates, Unfocused>,
    ) -> Result<Self, Unfocused> {
        let focus = Focus::new(lens)?;
        let nearest = focus.nearest();
        let infinity = focus.film_distance(f64::INFINITY)?;
        let focused = focused(&focus)?;
        let beyond_infinity = focused.film_distance < infinity * (1.0 - 1e-9);
        Ok(Self {
            beyond_infinity,
            by_groups: false,
            paraxial: paraxial_film_distance(lens, &focus, focused, nearest)?,
            focused,
            nearest,
            scale,
            // First-order depth of field requires a plane in focus, and here there is none.
            depth: depth_of_field(lens, focused, scale.confusion)?.filter(|_| !beyond_infinity),
        })
    }

    /// Makes the answer for a lens whose groups are placed to focus at the conjugates `focused` and can focus as near
    /// as `nearest`.
    fn by_groups(
        opened: &OpenedLens,
        scale: FilmScale,
        focused: Conjugates,
        nearest: Conjugates,
    ) -> Result<Self, Unfocused> {
        let lens = &opened.lens;
        let object = focused.object_distance + lens.rear().vertex - focused.film_distance;
        Ok(Self {
            beyond_infinity: false,
            by_groups: true,
            paraxial: Some(FirstOrder::of(lens).map_err(FocusError::Lens)?.image_distance(object.recip())),
            focused,
            nearest,
            scale,
            depth: depth_of_field(lens, focused, scale.confusion)?,
        })
    }

    fn json(&self, lens: &Lens) -> serde_json::Value {
        // An infinite number becomes null.
        json!({
            "name": lens.name,
            "wavelength": lens.wavelength,
            "film_diagonal": self.scale.diagonal,
            "focus_distance_mm": self.focused.object_distance,
            "film_distance": self.focused.film_distance,
            "film_distance_paraxial_mm": self.paraxial,
            "nearest_focus_distance_mm": self.nearest.object_distance,
            "nearest_film_distance_mm": self.nearest.film_distance,
            "circle_of_confusion_mm": self.scale.confusion,
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
             confusion        {} mm on a film of diagonal {} mm\n",
            from_film(object_distance),
            fixed(film_distance, 6),
            fixed(self.nearest.object_distance, 3),
            fixed(self.nearest.film_distance, 6),
            fixed(self.scale.confusion, 6),
            short(self.scale.diagonal),
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
