//! Focal lengths, focus and depth of field between media.

use super::{EYE, FISHEYE, IMMERSED, near};
use crate::support::lens_of;
use realistic_optics::{
    imaging::{
        axial_beam::AxialBeam,
        focus::{DepthOfField, Focus},
        plane_of_focus::FocusedFilm,
    },
    lens::{Lens, first_order::FirstOrder},
    trace::{Path, Ray},
};

fn optics(text: &str) -> FirstOrder {
    FirstOrder::of(&lens_of(text)).expect("not afocal")
}

/// Returns a lens with its stop closed to a fraction of its diameter.
fn stopped(text: &str, fraction: f64) -> Lens {
    let mut lens = lens_of(text);
    let stop = lens.stop_index().expect("a stop");
    lens.surfaces[stop].semi_diameter *= fraction;
    lens
}

fn slope(ray: &Ray, axis: usize) -> f64 {
    ray.direction[axis] / ray.direction[2]
}

#[test]
fn the_eye_has_two_focal_lengths() {
    let eye = optics(EYE);
    near(eye.front_focal_length(), 16.46790, 5e-6);
    near(eye.rear_focal_length(), 22.02912, 5e-6);
    near(eye.back_focal_distance(), 16.32031, 5e-6);
    // The distance between principal and nodal points is f' - f on both sides.
    let [front, rear] = eye.nodal_points();
    let apart = eye.rear_focal_length() - eye.front_focal_length();
    near(eye.front_principal_plane - front, apart, 1e-12);
    near(eye.rear_principal_plane - rear, apart, 1e-12);
    // A ray from one nodal point leaves the eye as if from the other, at the same slope.
    let out = eye.transfer(Ray { origin: [0.0, 0.0, rear], direction: [0.0, 0.01, 1.0] });
    near(slope(&out, 1), 0.01, 1e-15);
    near(out.origin[1] + 0.01 * front, 0.0, 1e-14);
}

#[test]
fn the_underwater_fisheye_has_its_published_focal_length_and_film() {
    let fisheye = optics(FISHEYE);
    near(fisheye.focal_length, 12.3995, 5e-5);
    near(fisheye.back_focal_distance(), 39.339, 5e-4);
    near(fisheye.front_focal_length(), 1.33306 * fisheye.focal_length, 1e-12);
}

#[test]
fn a_dome_images_infinity_in_front_of_itself() {
    // R/(n - 1) from a thin dome.
    let thin = optics("medium 1.333\n100 0 1.49 90\n100 0 1 90\n");
    near(thin.rear_focal_point, 100.0 / 0.333, 1e-9);
    near(thin.rear_focal_point, 300.30, 5e-3);
    let text = "medium 1.333\n100 5 1.49 90\n95 0 1 90\n";
    let thick = optics(text);
    // The image of the outer surface, n' = 1.49, is the object of the inner one.
    let outer = 1.49 / ((1.49 - 1.333) / 100.0);
    let inner = 1.0 / (1.49 / (outer - 5.0) + (1.0 - 1.49) / 95.0);
    near(thick.rear_focal_point, -5.0 - inner, 1e-9);
    near(thick.rear_focal_point, 274.36, 5e-3);
    // Exact rays near the axis agree.
    let from = Ray { origin: [0.0, 1e-3, 10.0], direction: [0.0, 0.0, -1.0] };
    let out = Path::<f64>::scene_to_film(&lens_of(text)).trace(from).expect("near the axis");
    near(out.origin[2] - out.origin[1] / slope(&out, 1), thick.rear_focal_point, 1e-3);
}

#[test]
fn fnumbers_are_those_of_the_cone_at_the_film() {
    // 1/(2 n' sin U') of a small stop, by exact rays.
    for text in [EYE, FISHEYE, IMMERSED] {
        let lens = stopped(text, 0.02);
        let (beam, optics) = (AxialBeam::of(&lens), FirstOrder::of(&lens).expect("not afocal"));
        let edge = Ray { origin: [0.0, 0.499 * beam.diameter(), 100.0], direction: [0.0, 0.0, -1.0] };
        let out = Path::<f64>::scene_to_film(&lens).trace(edge).expect("in the beam");
        let number = 0.998 / (2.0 * optics.n_film * out.direction[1].abs());
        near(beam.fnumber(optics.focal_length) / number, 1.0, 1e-4);
    }
}

#[test]
fn a_focused_film_sees_the_plane_sharply() {
    for text in [EYE, FISHEYE, IMMERSED] {
        let lens = stopped(text, 0.02);
        let focus = Focus::new(&lens).expect("it focuses");
        let optics = *focus.first_order();
        for distance in [700.0, 2000.0, f64::INFINITY] {
            let film = focus.film_distance(distance).expect("in reach");
            near(film, focus.paraxial_film_distance(distance).expect("in reach"), 2e-3);
            let ahead = distance + lens.rear().vertex - film;
            near(optics.image_distance(ahead.recip()), film, 2e-3);
            if distance.is_finite() {
                near(focus.object_distance(film).expect("in front") / distance, 1.0, 1e-6);
            }
        }
        // The distance between object and image has its minimum 2 √(n n')/φ beyond that of the focal points.
        let nearest = focus.nearest().object_distance;
        let paraxial = optics.front_focal_point - optics.rear_focal_point + 2.0 * optics.mean_focal_length();
        if optics.front_focal_point + optics.mean_focal_length() > 0.0 {
            near(nearest / paraxial, 1.0, 0.02);
        }
    }
}

#[test]
fn points_at_the_ends_of_the_depth_of_field_are_circles_of_confusion() {
    const CONFUSION: f64 = 0.03;
    let lens = stopped(IMMERSED, 0.1);
    let focus = Focus::new(&lens).expect("it focuses");
    let film_distance = focus.film_distance(3000.0).expect("in reach");
    let film = lens.rear().vertex - film_distance;
    let entrance = AxialBeam::of(&lens).entrance;
    let depth = DepthOfField::of(&lens, &entrance, film_distance, 3000.0, CONFUSION)
        .expect("not afocal")
        .expect("a pupil at a finite distance");
    for end in [depth.near, depth.far] {
        let (height, slope_in) = entrance.marginal_ray(1.0 / (film + end), 1.0 - 1e-3);
        let origin = [0.0, height - 50.0 * slope_in, 50.0];
        let out = Path::<f64>::scene_to_film(&lens)
            .trace(Ray { origin, direction: [0.0, slope_in, -1.0] })
            .expect("in the beam");
        let blur = 2.0 * (out.origin[1] + (film - out.origin[2]) * slope(&out, 1)).abs();
        near(blur / CONFUSION, 1.0, 0.02);
    }
}

#[test]
fn a_tilted_film_is_in_focus_on_a_tilted_plane() {
    // A thin surface between water and glass, where Scheimpflug's rule is exact in first order.
    let lens = lens_of("medium 1.333\nstop 0 1.333 0.2\n20 0 1.5 8\n");
    let focus = Focus::new(&lens).expect("it focuses");
    let power = (1.5 - 1.333) / 20.0;
    let (object, tan) = (2000.0, 0.5);
    let image = 1.5 / (power - 1.333 / object);
    let points = [[0.0, 0.0, object], [0.0, 100.0, object + 100.0 * tan], [100.0, 0.0, object]];
    let found = FocusedFilm::on(&focus, points).expect("reachable");
    near(found.film_distance / image, 1.0, 1e-4);
    // tan a = (s'/s) tan b.
    near(found.tilt[0].to_radians().tan().abs(), image / object * tan, 1e-9);
    near(found.tilt[1], 0.0, 1e-9);
}
