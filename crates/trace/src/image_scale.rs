//! The scale of the image over the film, which converts the error of a ray in the scene to a distance on the film.
//!
//! Only near the axis is this distance the angle of the error times the focal length. Toward the corner of the film,
//! the scale of a wide-angle lens grows by 1/cos² of the field angle and more; the scale of a fisheye shrinks. The
//! scale is therefore measured by the turn of the chief ray: the meridional scale as the film point moves away from the
//! axis, the sagittal scale as the film point moves around the axis.

use super::field::Field;
use realistic_base::numeric::dot;
use realistic_optics::lens::{Lens, Ray};

/// The scale of the image as a function of the distance from the axis, for one film and one plane in focus.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageScale {
    /// z of the plane in focus, lens space, mm; may be infinite.
    in_focus: f64,
    /// Step between two entries, mm.
    spacing: f64,
    /// Scales, mm on the film per rad in the scene, in the direction away from the axis and in the direction around it.
    scales: Vec<[f64; 2]>,
}

/// Number of entries from the axis to the largest distance.
const ENTRIES: u32 = 17;
/// Rotation about the axis that measures the sagittal scale, rad.
const TURN: f64 = 1e-3;

impl ImageScale {
    /// Measures the scale for a film at `film` (z in lens space, mm, behind the lens) with points up to `reach` mm from
    /// the axis, and a plane in focus at `in_focus` (z in lens space, mm; infinite for a distant object). Beyond the
    /// lit radius the scale stays constant. `None` if the film is dark on the axis.
    pub fn new(lens: &Lens, film: f64, reach: f64, in_focus: f64) -> Option<Self> {
        let spacing = reach / f64::from(ENTRIES - 1);
        let chief = Field::new(lens, film).chief_rays(spacing, ENTRIES);
        let seen = |exact: &Ray, other: &Ray| length(offset(exact, other, in_focus));
        // The meridional scales halfway between entries. On both sides of the axis the scale is the same.
        let between: Vec<f64> = chief.windows(2).map(|pair| spacing / seen(&pair[0].1, &pair[1].1)).collect();
        let (first, last) = (*between.first()?, *between.last()?);
        let scales = chief.iter().enumerate().map(|(i, (height, ray))| {
            let before = if i == 0 { first } else { between[i - 1] };
            let meridional = f64::midpoint(before, between.get(i).copied().unwrap_or(last));
            let sagittal = if i == 0 { first } else { height * TURN / seen(ray, &turned(ray)) };
            [meridional, sagittal]
        });
        Some(Self { in_focus, spacing, scales: scales.collect() })
    }

    /// Returns the scale, mm on the film per rad in the scene, at `radius` mm from the axis: away from the axis
    /// (meridional) and around it (sagittal). On the axis of a lens focused at infinity both are the focal
    /// length.
    pub fn at(&self, radius: f64) -> [f64; 2] {
        let last = self.scales.len() - 1;
        let at = (radius / self.spacing).clamp(0.0, last as f64);
        let below = at as usize;
        let (a, b) = (self.scales[below], self.scales[(below + 1).min(last)]);
        [0, 1].map(|i| a[i] + (at - below as f64) * (b[i] - a[i]))
    }

    /// Returns the error on the film, mm, of a ray that leaves the lens as `other` instead of `exact`. It is the
    /// distance between the intersections of both rays with the plane in focus, measured perpendicular to the exact ray
    /// and scaled to the film. For a plane at infinity, the angle between the rays takes the place of this distance.
    /// Directions are unit vectors; the origins may lie anywhere on their rays. A ray that leaves backward never meets
    /// the plane; its error is also computed from the angle.
    pub fn film_error(&self, film_point: [f64; 2], exact: &Ray, other: &Ray) -> f64 {
        let [x, y] = film_point;
        let radius = (x * x + y * y).sqrt();
        let error = offset(exact, other, self.in_focus);
        let around = if radius > 0.0 { (x * error[1] - y * error[0]) / radius } else { error[0] };
        let away = (dot(error, error) - around * around).max(0.0);
        let [meridional, sagittal] = self.at(radius);
        (away * meridional * meridional + (around * sagittal).powi(2)).sqrt()
    }
}

/// Returns the offset of another ray from the exact ray in the plane z = `in_focus`, measured perpendicular to the
/// exact ray and divided by the distance to the plane: the tangent of an angle.
fn offset(exact: &Ray, other: &Ray, in_focus: f64) -> [f64; 3] {
    let difference = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|i| a[i] - b[i]);
    let across = |vector: [f64; 3], along: f64| [0, 1, 2].map(|i| vector[i] - along * exact.direction[i]);
    let turn = difference(other.direction, exact.direction);
    let shift = difference(other.origin, exact.origin);
    let (turn_along, shift_along) = (dot(turn, exact.direction), dot(shift, exact.direction));
    // The reciprocal of the distance to the plane.
    let nearness = exact.direction[2].max(0.0) / (in_focus - exact.origin[2]);
    let (turn, shift) = (across(turn, turn_along), across(shift, shift_along));
    let stretch = (1.0 - nearness * shift_along) / (1.0 + turn_along);
    [0, 1, 2].map(|i| nearness * shift[i] + stretch * turn[i])
}

/// Returns the ray rotated about the axis by [`TURN`].
fn turned(ray: &Ray) -> Ray {
    let (sin, cos) = TURN.sin_cos();
    let turn = |[x, y, z]: [f64; 3]| [x * cos - y * sin, x * sin + y * cos, z];
    Ray { origin: turn(ray.origin), direction: turn(ray.direction) }
}

fn length(vector: [f64; 3]) -> f64 {
    dot(vector, vector).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_optics::imaging::focus::Focus;
    use realistic_optics::{lens::first_order::FirstOrder, prescription::catalogue, trace::Path};

    /// Returns a lens focused on a plane at this distance from the film, mm, and z of its film.
    fn focused(name: &str, distance: f64) -> (Lens, f64) {
        let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
        let back = Focus::new(&lens).expect("focal").film_distance(distance).expect("in reach");
        let film = lens.rear().vertex - back;
        (lens, film)
    }

    #[test]
    fn the_scale_on_the_axis_at_infinity_is_the_focal_length() {
        for name in catalogue::round() {
            // The film is at the first-order focal point, because a fast lens is sharpest a little in front of its
            // focal point.
            let (lens, _) = focused(name, f64::INFINITY);
            let optics = FirstOrder::of(&lens).expect("focal");
            let f = optics.focal_length;
            let scale =
                ImageScale::new(&lens, optics.rear_focal_point, 0.05 * f, f64::INFINITY).expect("lit");
            for own in scale.at(0.0) {
                assert!((own / f - 1.0).abs() < 5e-3, "{name}: {own} is not {f}");
            }
        }
    }

    #[test]
    fn a_film_point_moved_a_little_is_as_far_off_as_it_was_moved() {
        for name in catalogue::round() {
            for distance in [f64::INFINITY, 1500.0] {
                let (lens, film) = focused(name, distance);
                let scale = ImageScale::new(&lens, film, 17.0, film + distance).expect("lit");
                let field = Field::new(&lens, film);
                for height in [0.0, 4.0, 9.0, 12.0] {
                    let (Some(here), Some(there)) = (field.chief_ray(height), field.chief_ray(height + 0.02))
                    else {
                        continue;
                    };
                    let error = scale.film_error([0.0, height], &here, &there);
                    assert!((error / 0.02 - 1.0).abs() < 0.02, "{name}, {height}: {error}");
                    let error = scale.film_error([0.0, height], &here, &turned(&here));
                    assert!(
                        (error - height * TURN).abs() <= 5e-3 * height * TURN,
                        "{name}, {height}: {error}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_ray_turned_a_little_meets_the_film_as_far_off() {
        for (name, height) in [("dgauss.50mm", 14.0), ("wide.22mm", 15.0), ("fisheye.10mm", 11.0)] {
            let (lens, film) = focused(name, f64::INFINITY);
            let scale = ImageScale::new(&lens, film, 17.0, f64::INFINITY).expect("lit");
            let out = Field::new(&lens, film).chief_ray(height).expect("lit");
            let back = |ray: &Ray| {
                let ray = Ray { origin: ray.origin, direction: ray.direction.map(|d| -d) };
                let Ray { origin, direction } = Path::<f64>::scene_to_film(&lens).trace(ray).expect("passes");
                let t = (film - origin[2]) / direction[2];
                [origin[0] + t * direction[0], origin[1] + t * direction[1]]
            };
            let from = back(&out);
            for turn in [[1e-5, 0.0], [0.0, 1e-5], [7e-6, -7e-6]] {
                let [dx, dy, dz] = out.direction;
                let direction = [dx + turn[0], dy + turn[1], dz];
                let norm = length(direction);
                let other = Ray { direction: direction.map(|d| d / norm), ..out };
                let to = back(&other);
                let met = (to[0] - from[0]).hypot(to[1] - from[1]);
                let error = scale.film_error([0.0, height], &out, &other);
                // The image point is blurred, so the ray meets the film elsewhere in the blur spot.
                assert!((error / met - 1.0).abs() < 0.1, "{name}: {error} is not {met}");
            }
        }
    }

    #[test]
    fn a_ray_from_another_point_of_its_line_has_no_error() {
        let (lens, film) = focused("wide.22mm", 700.0);
        let scale = ImageScale::new(&lens, film, 17.0, film + 700.0).expect("lit");
        let out = Field::new(&lens, film).chief_ray(10.0).expect("lit");
        let along = Ray { origin: [0, 1, 2].map(|i| out.origin[i] - 8.0 * out.direction[i]), ..out };
        assert!(scale.film_error([0.0, 10.0], &out, &along) < 1e-12);
        // Both rays meet in the plane in focus, so there is no error, although neither their origins nor their
        // directions agree.
        let t = (film + 700.0 - out.origin[2]) / out.direction[2];
        let met = [0, 1, 2].map(|i| out.origin[i] + t * out.direction[i]);
        let origin = [out.origin[0] + 1.0, out.origin[1] - 2.0, out.origin[2] + 1.0];
        let toward = [0, 1, 2].map(|i| met[i] - origin[i]);
        let other = Ray { origin, direction: toward.map(|x| x / length(toward)) };
        assert!(scale.film_error([0.0, 10.0], &out, &other) < 1e-9);
    }
}
