//! Adjoint cameras: importance against the camera's own rays, ray by ray and as integrals, and the share of directions
//! toward a lens that pass.

mod acceptance;
mod front;
mod integrals;
mod long;
mod odd;
mod round_trip;
mod scene;

use ::realistic_camera::{Camera, Host, Parameters};

use super::support;

/// Builds a camera from parameters in command-line syntax.
#[track_caller]
fn camera(given: &[(&str, &str)]) -> Camera {
    camera_of(&support::host(), given)
}

#[track_caller]
fn camera_of(host: &Host, given: &[(&str, &str)]) -> Camera {
    let mut parameters = Parameters::default();
    for (name, text) in given {
        parameters.set_from_text(name, text).unwrap_or_else(|error| panic!("{given:?}: {error}"));
    }
    Camera::build(&parameters, host, &mut |_, _| ()).unwrap_or_else(|error| panic!("{given:?}: {error}"))
}

/// Parameters of cameras: each kind of lens, pupil, weighting, stop and focus.
const CAMERAS: [&[(&str, &str)]; 22] = [
    &[],
    &[("weighting", "assignment")],
    &[("weighting", "relative"), ("pupil", "rear")],
    &[("weighting", "none")],
    &[("pupil", "disk"), ("weighting", "none"), ("fnumber", "4")],
    &[("fnumber", "8"), ("focusdistance", "800"), ("mmperunit", "10")],
    &[("blades", "6"), ("fnumber", "5.6")],
    &[("precision", "f32"), ("tolerance", "0.05")],
    &[("specfile", "wide.22mm"), ("filmdiag", "30")],
    &[("specfile", "wide.22mm"), ("filmdiag", "30"), ("focusdistance", "500"), ("pupil", "rear")],
    &[("specfile", "telephoto.250mm"), ("filmdiag", "26"), ("focusdistance", "4000")],
    &[("specfile", "fisheye.10mm"), ("filmdiag", "22")],
    &[("specfile", "fisheye.10mm"), ("filmdiag", "40"), ("weighting", "relative")],
    &[("specfile", "dgauss.100mm"), ("filmdiag", "60"), ("fnumber", "2.8"), ("weighting", "none")],
    &[("disk", "polar"), ("focusdistance", "600")],
    &[("model", "thick"), ("fnumber", "2")],
    &[("model", "thin"), ("weighting", "assignment"), ("focusdistance", "700")],
    &[("model", "thick"), ("specfile", "fisheye.10mm"), ("weighting", "relative"), ("filmdiag", "16")],
    &[("model", "perspective"), ("lensradius", "8"), ("focaldistance", "900"), ("fov", "50")],
    &[
        ("model", "perspective"),
        ("lensradius", "8"),
        ("focaldistance", "900"),
        ("lensplane", "hither"),
        ("hither", "20"),
    ],
    &[
        ("model", "perspective"),
        ("lensradius", "5"),
        ("focaldistance", "700"),
        ("screenwindow", "-0.3,1,-0.5,0.4"),
    ],
    &[
        ("model", "orthographic"),
        ("lensradius", "20"),
        ("focaldistance", "900"),
        ("screenwindow", "-200,200,-150,150"),
    ],
];
