//! Cameras of an animation with moving focus, built in two ways: each from scratch, and each from the previous one.

use realistic_camera::{Camera, Host, Parameters};
use realistic_lab::timing::{BenchArguments, Contest};
use realistic_optics::prescription::catalogue;

use super::RASTER;

/// Number of frames, which last ten seconds.
const FRAMES: u16 = 240;
/// Distance from the film to the nearest plane in focus, in focal lengths.
const NEAREST: f64 = 50.0;

/// Prints the table.
pub fn print(arguments: &BenchArguments) {
    println!(
        "\n## {FRAMES} cameras of a lens that differ in focus, by themselves and each from the one before"
    );
    for name in catalogue::round().filter(|name| arguments.wants(name)) {
        let frames = if arguments.effort.rounds == 1 { 2 } else { FRAMES };
        let mut contest = Contest::default();
        for (label, shares) in [("by themselves", false), ("from the one before", true)] {
            contest.enter(label, Box::new(move || take(name, frames, shares)) as Box<dyn FnMut()>);
        }
        println!("\n{name}\n");
        contest.print("ns per camera", frames.into(), arguments.effort);
    }
}

fn take(name: &str, frames: u16, shares: bool) {
    let host = Host::new(RASTER, None);
    let build = |donor: Option<&Camera>, focus_distance: Option<f64>| {
        let parameters =
            Parameters { lens_file: Some(name.to_owned()), focus_distance, ..Parameters::default() };
        Camera::build_from(donor, &parameters, &host, &mut |_, _| ()).expect("a camera")
    };
    let mut camera = build(None, None);
    let focal_length = camera.facts().expect("a lens").focal_length();
    for frame in 1..frames {
        let distance = focal_length * (NEAREST + f64::from(frame));
        camera = build(shares.then_some(&camera), Some(distance));
    }
}
