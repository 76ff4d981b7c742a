//! Adjoint cameras: importance against the camera's own rays, for each ray and in integrals; and the share of
//! directions toward a lens that pass.

mod acceptance;
mod front;
mod integrals;
mod long;
mod odd;
mod round_trip;
mod scene;

use ::realistic_camera::{Camera, Host, Parameters};

use super::support;
pub use integrals::disagreements;

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

/// Parameters of cameras, which include each kind of lens, pupil, weighting, stop and focus.
const CAMERAS: [&[(&str, &str)]; 27] = [
    &[],
    &[("weighting", "assignment")],
    &[("weighting", "relative"), ("pupil", "rear")],
    &[("weighting", "none")],
    &[("pupil", "disk"), ("weighting", "none"), ("fnumber", "4")],
    &[("fnumber", "8"), ("focus_distance", "800"), ("mm_per_unit", "10")],
    &[("blades", "6"), ("fnumber", "5.6")],
    &[("precision", "f32"), ("tolerance", "0.05")],
    &[("lens_file", "wide.22mm"), ("film_diagonal", "30")],
    &[("lens_file", "wide.22mm"), ("film_diagonal", "30"), ("focus_distance", "500"), ("pupil", "rear")],
    &[("lens_file", "telephoto.250mm"), ("film_diagonal", "26"), ("focus_distance", "4000")],
    &[("lens_file", "fisheye.10mm"), ("film_diagonal", "22")],
    &[("lens_file", "fisheye.10mm"), ("film_diagonal", "40"), ("weighting", "relative")],
    &[("lens_file", "dgauss.100mm"), ("film_diagonal", "60"), ("fnumber", "2.8"), ("weighting", "none")],
    &[("disk", "polar"), ("focus_distance", "600")],
    &[("film_shift_x", "6"), ("film_shift_y", "-4"), ("focus_distance", "900")],
    &[("film_tilt_x", "8"), ("film_tilt_y", "-5"), ("film_shift_y", "3"), ("focus_distance", "900")],
    &[("film_curvature_radius", "-60"), ("film_tilt_x", "4"), ("weighting", "relative")],
    &[("film_curvature_radius", "80"), ("pupil", "rear"), ("film_tilt_y", "10")],
    &[("model", "thick"), ("film_shift_x", "5"), ("fnumber", "4")],
    &[("model", "thick"), ("fnumber", "2")],
    &[("model", "thin"), ("weighting", "assignment"), ("focus_distance", "700")],
    &[("model", "thick"), ("lens_file", "fisheye.10mm"), ("weighting", "relative"), ("film_diagonal", "16")],
    &[("model", "perspective"), ("lens_radius", "8"), ("focal_distance", "900"), ("fov", "50")],
    &[
        ("model", "perspective"),
        ("lens_radius", "8"),
        ("focal_distance", "900"),
        ("lens_plane", "hither"),
        ("hither", "20"),
    ],
    &[
        ("model", "perspective"),
        ("lens_radius", "5"),
        ("focal_distance", "700"),
        ("screen_window", "-0.3,1,-0.5,0.4"),
    ],
    &[
        ("model", "orthographic"),
        ("lens_radius", "20"),
        ("focal_distance", "900"),
        ("screen_window", "-200,200,-150,150"),
    ],
];
