//! `realistic focus-stack`: the same picture focused at several distances, from near to far.

use crate::arguments::{CameraChoice, distance, whole};
use crate::console;
use crate::failure::Failure;
use crate::files;
use crate::host::scene::effects::{Effect, Effects};
use crate::host::scene::props;
use crate::host::studio::{Options, ShotOptions, Studio, whole_only};
use crate::image::{Sheet, Tone, check_memory};
use realistic_base::message::fixed;
use std::fmt::Write as _;
use std::path::PathBuf;

/// The options of `focus-stack`.
#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(flatten)]
    camera: CameraChoice,
    /// Nearest distance in focus, mm from the film
    #[arg(long, value_name = "MM", allow_hyphen_values = true, value_parser = distance)]
    from: f64,
    /// Farthest distance in focus, mm from the film; may be inf
    #[arg(long, value_name = "MM", allow_hyphen_values = true, value_parser = distance)]
    to: f64,
    /// Number of pictures
    #[arg(long, value_name = "N", default_value_t = 6, allow_hyphen_values = true, value_parser = whole(2_u32, 999))]
    count: u32,
    /// Folder for focus-01.png and so on, and contact.png with all of them; created if missing
    #[arg(short, long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
    #[command(flatten)]
    options: Options,
}

const SPP: u32 = 64;
/// Number of columns of pictures on the contact sheet.
const COLUMNS: u32 = 3;

/// Takes the pictures at evenly spaced reciprocal distances, which move the film in even steps.
///
/// # Errors
/// A parameter is invalid, there is no plugin, a distance is too near for the lens, or a file cannot be written.
pub fn run(args: &Args) -> Result<(), Failure> {
    if !(args.from < args.to) {
        return Err(Failure::Usage(format!(
            "--from {} mm must be nearer than --to {} mm",
            args.from, args.to
        )));
    }
    let studio = Studio::open(&args.camera, &args.options)?;
    whole_only(&studio.parameters)?;
    if studio.parameters.focus_distance.is_some() || studio.parameters.film_distance.is_some() {
        return Err(Failure::Usage(
            "--from and --to say where the focus is; leave out \"focus_distance\" and \"film_distance\""
                .to_owned(),
        ));
    }
    check_memory([studio.size[0] * COLUMNS, studio.size[1] * args.count.div_ceil(COLUMNS)], PER_PIXEL)?;
    files::make_folder(&args.out)?;
    let scene = props::scene().with(&Effects::only(&[Effect::SoftShadow, Effect::Dof]));
    let options = ShotOptions::plain(args.options.spp.unwrap_or(SPP));
    let mut sheet = Sheet::new(studio.size, args.count, COLUMNS);
    let mut text = String::new();
    let mut before = None;
    for (index, distance) in (1..).zip(distances(args.from, args.to, args.count)) {
        let mut parameters = studio.parameters.clone();
        parameters.focus_distance = Some(distance / parameters.mm_per_unit.unwrap_or(1.0));
        let shot = studio.take_after(before.as_ref(), &parameters, &scene, &options)?;
        let film = shot.camera.info()?.film_distance;
        let digits = args.count.to_string().len().max(2);
        let path = args.out.join(format!("focus-{index:0digits$}.png"));
        shot.picture.write(&path, shot.tone)?;
        sheet.add(&label(distance), &shot.picture, shot.tone.scale);
        let _ = writeln!(text, "{}  focus {}, film {} mm", path.display(), label(distance), fixed(film, 3));
        before = Some(shot.camera);
    }
    let contact = args.out.join("contact.png");
    sheet.into_picture().write(&contact, Tone::SHOWN)?;
    let _ = writeln!(text, "{}", contact.display());
    Ok(console::report(&text, &contact)?)
}

/// Bytes per pixel of the sheet while it is made and written.
const PER_PIXEL: u64 = 40;

fn distances(from: f64, to: f64, count: u32) -> impl Iterator<Item = f64> {
    let step = (to.recip() - from.recip()) / f64::from(count - 1);
    // The last distance is exactly the given one, which may be infinite.
    (0..count).map(move |k| if k + 1 == count { to } else { (from.recip() + step * f64::from(k)).recip() })
}

fn label(distance: f64) -> String {
    match distance {
        f64::INFINITY => "infinity".to_owned(),
        far if far >= 10_000.0 => format!("{} m", fixed(far / 1000.0, 1)),
        near => format!("{} mm", fixed(near, 0)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_of_a_focus_stack_are_even_in_their_reciprocals() {
        let stack: Vec<f64> = distances(500.0, f64::INFINITY, 5).collect();
        assert_eq!(stack, [500.0, 1.0 / 0.0015, 1000.0, 2000.0, f64::INFINITY]);
        assert_eq!(distances(700.0, 900.0, 2).collect::<Vec<_>>(), [700.0, 900.0]);
    }
}
