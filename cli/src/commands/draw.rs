//! `realistic draw`: the cross-section of a lens.

use crate::arguments::{LensChoice, OpenedLens, whole};
use crate::console;
use crate::drawing::{output, positions, section, shapes::Page};
use crate::failure::Failure;
use realistic_base::message::fixed;
use realistic_camera::CameraError;
use realistic_optics::imaging::{moving::MovingGroups, open::set_up};
use realistic_optics::lens::{Lens, first_order::FirstOrder};
use std::path::PathBuf;

/// The options of `draw`.
#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(flatten)]
    lens: LensChoice,
    /// Rays per bundle, spread over the beam that gets through and a little beyond
    #[arg(long, value_name = "N", default_value_t = 11, allow_hyphen_values = true, value_parser = whole(1_u32, 999))]
    rays: u32,
    /// Draw the light that two surfaces reflect, counted from 1 at the scene side, instead of the image's
    #[arg(long, value_name = "I,J", allow_hyphen_values = true, value_parser = pair)]
    ghost: Option<[usize; 2]>,
    /// Meridian of the section of a lens that is not symmetric: y, up, or x, across
    #[arg(long, value_name = "MERIDIAN", default_value = "y", value_parser = ["x", "y"])]
    section: String,
    /// Drawing to write, .svg or .png; - for an .svg on standard output [default: the lens's name with .svg]
    #[arg(short, long, value_name = "FILE", value_parser = output::path)]
    out: Option<PathBuf>,
}

/// Draws the lens and reports the path of the drawing.
///
/// # Errors
/// There is no such lens, or the file cannot be written.
pub fn run(args: &Args) -> Result<(), Failure> {
    let opened = args.lens.open()?;
    let diagonal = opened.film_diagonal();
    if let Some([near, far]) = args.ghost {
        check_pair(&opened.lens, [near, far])?;
    }
    let page = match at_all_positions(args, &opened, diagonal).filter(|_| args.ghost.is_none()) {
        Some(page) => page,
        None => at_one(args, &opened, diagonal)?,
    };
    let out = args.out.clone().unwrap_or_else(|| {
        let name = opened.prescription.name.rsplit('/').next().unwrap_or_default();
        PathBuf::from(format!("{name}.svg"))
    });
    output::write(&page, &out)?;
    Ok(console::report(&format!("{}\n", out.display()), &out)?)
}

/// Parses the two surfaces of a flag, and puts the surface nearer the scene first.
fn pair(text: &str) -> Result<[usize; 2], String> {
    let numbers: Option<Vec<usize>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[a, b]) if a > 0 && b > 0 && a != b => Ok([a.min(b), a.max(b)]),
        _ => {
            Err("write the numbers of two surfaces, counted from 1 at the scene side, such as 2,7".to_owned())
        }
    }
}

/// Checks that a lens has these surfaces and that both of them reflect.
fn check_pair(lens: &Lens, pair: [usize; 2]) -> Result<(), Failure> {
    for number in pair {
        let Some(surface) = lens.surfaces.get(number - 1) else {
            let surfaces = lens.surfaces.len();
            return Err(Failure::Usage(format!(
                "--ghost: there is no surface {number}; the lens has {surfaces}"
            )));
        };
        if surface.n_scene == surface.n_film {
            return Err(Failure::Usage(format!(
                "--ghost: surface {number} has one medium on both sides and reflects nothing; give two others"
            )));
        }
    }
    Ok(())
}

/// Draws the lens as requested.
fn at_one(args: &Args, opened: &OpenedLens, diagonal: f64) -> Result<Page, Failure> {
    let OpenedLens { prescription, lens, .. } = opened;
    let film_distance = opened.film_distance_if_any()?.unwrap_or_else(|| fallback_film_distance(lens));
    let turned = (args.section == "x" && !lens.is_centred()).then(|| lens.turned());
    let lens = turned.as_ref().unwrap_or(lens);
    if args.ghost.is_some() {
        Failure::unless_round(lens, "--ghost")?;
    }
    let [edge_sagitta, _] = lens.rear().sagitta_range();
    if film_distance + edge_sagitta <= 0.0 && !lens.has_mirror() {
        return Err(CameraError::film_in_lens(lens, film_distance).into());
    }
    let options = section::SectionOptions {
        title: prescription.title.as_deref(),
        film_distance,
        film_diagonal: diagonal,
        rays: args.rays,
        // The flag counts from 1, and the library counts from 0.
        ghost: args.ghost.map(|pair| pair.map(|surface| surface - 1)),
    };
    Ok(section::draw(lens, &options))
}

/// Draws a lens that has positions, at each of them; `None` if the user requests a single one.
fn at_all_positions(args: &Args, opened: &OpenedLens, diagonal: f64) -> Option<Page> {
    let OpenedLens { prescription, lens, .. } = opened;
    if opened.parameters().zoom.is_some() || opened.is_placed() {
        return None;
    }
    let listed = prescription.positions.as_ref().filter(|positions| positions.columns.len() > 1)?;
    let (groups, layout) = (MovingGroups::of(prescription)?, listed.layout());
    let panel = |(column, position): (usize, &realistic_optics::prescription::Position)| {
        let placed = groups.position(column % layout.zooms).at(position.vergence());
        // Warnings about the stop were already printed.
        let lens = set_up(&placed, lens.wavelength, opened.stop(), &mut |_, _| ()).ok()?.lens;
        let image = || FirstOrder::of(&lens).ok().map(|optics| optics.image_distance(position.vergence()));
        let film_distance =
            lens.nominal_film_distance.or_else(image).filter(|film| *film > 0.0 && film.is_finite());
        let object = position
            .object_distance
            .map_or_else(|| "infinity".to_owned(), |distance| format!("{} mm before it", fixed(distance, 0)));
        let name = position.name.clone().unwrap_or_else(|| format!("position {}", column + 1));
        Some(positions::PositionPanel {
            film_distance: film_distance.unwrap_or_else(|| fallback_film_distance(&lens)),
            name: format!("{name}, object at {object}"),
            lens,
        })
    };
    let panels: Option<Vec<positions::PositionPanel>> =
        listed.columns.iter().enumerate().map(panel).collect();
    let options = positions::PositionsOptions {
        title: prescription.title.as_deref(),
        gaps: &listed.gaps,
        film_diagonal: diagonal,
        rays: args.rays,
    };
    Some(positions::draw(&panels?, &options))
}

/// Returns a film distance for a lens that makes no image: the lens still lets light through to a film behind it.
fn fallback_film_distance(lens: &Lens) -> f64 {
    let rear = lens.rear();
    let room = -2.0 * rear.sagitta_range()[0];
    let size = FirstOrder::of(lens).map_or(2.0 * rear.semi_diameter, |optics| optics.focal_length.abs());
    size.min(4.0 * rear.semi_diameter).max(room)
}
