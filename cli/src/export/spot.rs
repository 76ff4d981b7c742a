//! Spots: the spread of a point's image on the film, from traced rays.

use super::field::{ChiefField, Ring};
use realistic_base::numeric::{edge, gauss_legendre};
use realistic_optics::lens::{Lens, Ray};
use realistic_optics::trace::Path;
use serde_json::{Value, json};

/// The image of one object point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Distance from the centre at which the chief ray meets the film, pixels.
    pub radius: f64,
    /// Angle from the axis at which the pinhole sees the point, degrees.
    pub angle: f64,
    /// Number of rays traced for the spot.
    pub rays: usize,
    /// Mean distance of the rays from the film's centre minus the distance of the chief ray, mm.
    pub offset: f64,
    /// RMS distance from the mean in the radial and in the tangential direction, mm.
    pub rms: [f64; 2],
    /// Radii of the circles about the mean that hold 50 % and 80 % of the light, mm.
    pub encircled: [f64; 2],
    /// Radius of the Airy disk that a perfect lens with as large a cone of light makes at this point, mm.
    pub airy: f64,
}

/// Radius of the Airy disk over wavelength times f-number: the first zero of the Bessel function J1, over π.
const AIRY: f64 = 1.219_67;

/// Object points, by the film radii of their chief rays as shares of the lit radius.
const FIELDS: [f64; 7] = [0.0, 0.2, 0.4, 0.6, 0.8, 0.9, 1.0];
/// Number of rays across the front in the search for the beam.
const GRID: u32 = 64;
/// Number of arms from the beam's middle to its edge. Rays lie along the arms at the 16 nodes of Gauss-Legendre
/// quadrature, which makes RMS radii accurate to 0.1 %.
const ARMS: u32 = 96;

/// Returns the spots of object points in focus, from the axis to the edge of the light.
pub fn spots(lens: &Lens, field: &ChiefField) -> Vec<Spot> {
    let path = Path::<f64>::scene_to_film(lens);
    let last = (field.rings.len() - 1) as f64;
    let ring = |share: &f64| field.rings[(share * last).round() as usize];
    FIELDS.iter().map(ring).filter_map(|ring| Spot::of(&path, lens, field, &ring)).collect()
}

/// A ray through the lens: its position in the beam, its position on the film, its direction cosines there, and the
/// light that it carries.
struct Landed {
    across: [f64; 2],
    film: [f64; 2],
    cosines: [f64; 2],
    weight: f64,
}

impl Spot {
    /// Integrates over the beam from the object of a ring: the light of a point that radiates equally in all
    /// directions.
    fn of(path: &Path, lens: &Lens, field: &ChiefField, ring: &Ring) -> Option<Self> {
        let front = lens.front().semi_diameter;
        let object = field.point(ring);
        let shoot = |[a, b]: [f64; 2]| {
            let ([h, z], [dh, dz]) = (ring.origin, ring.direction);
            // One of the two directions lies in the plane through the axis, and the other is x.
            let through = [b, h + a * dz, z - a * dh];
            let (origin, direction, weight) = match object {
                Some([y, z]) => {
                    let toward = [through[0], through[1] - y, through[2] - z];
                    let length = toward.iter().map(|d| d * d).sum::<f64>().sqrt();
                    let cosine = -(toward[1] * dh + toward[2] * dz) / length;
                    ([0.0, y, z], toward, cosine / (length * length))
                }
                None => {
                    let back = [0.0, dh, dz].map(|d| 4.0 * front * d);
                    let origin = [0, 1, 2].map(|i| through[i] + back[i]);
                    (origin, [0.0, -dh, -dz], 1.0)
                }
            };
            let out = path.trace(Ray { origin, direction }).ok()?;
            let along = (field.film.z - out.origin[2]) / out.direction[2];
            let [x, y] = [0, 1].map(|i| out.origin[i] + along * out.direction[i]);
            let length = out.direction.iter().map(|d| d * d).sum::<f64>().sqrt();
            let cosines = [0, 1].map(|i| out.direction[i] / length);
            // The image is upside down.
            Some(Landed { across: [a, b], film: [-y, x], cosines, weight })
        };
        let grid = |[a0, a1]: [f64; 2], [b0, b1]: [f64; 2]| -> Vec<Landed> {
            let at = |from: f64, to: f64, i: u32| from + (to - from) * (f64::from(i) + 0.5) / f64::from(GRID);
            let all = (0..GRID).flat_map(|i| (0..GRID).map(move |j| [i, j]));
            all.filter_map(|[i, j]| shoot([at(a0, a1, i), at(b0, b1, j)])).collect()
        };
        // The beam may fill a small part of the front, so the search narrows about the chief ray until it covers only
        // the beam.
        let mut reach = 2.0 * (front + ring.origin[0].abs());
        let mut found = Vec::new();
        for _ in 0..8 {
            found = grid([-reach, reach], [-reach, reach]);
            if found.len() >= 16 {
                break;
            }
            reach /= 4.0;
        }
        let part = f64::from(found.len() as u32).recip();
        let mean = [0, 1].map(|axis| part * found.iter().map(|ray| ray.across[axis]).sum::<f64>());
        let away = |ray: &Landed| (ray.across[0] - mean[0]).hypot(ray.across[1] - mean[1]);
        let middle = found.iter().min_by(|a, b| away(a).total_cmp(&away(b)))?.across;
        let outside = found.iter().map(away).fold(0.0, f64::max) + 4.0 * reach / f64::from(GRID);
        // Along each arm, the nodes lie between the middle and the edge of the beam; each arm crosses the edge once.
        let mut rays = Vec::new();
        let mut rim = Vec::new();
        for arm in 0..ARMS {
            let (sine, cosine) = (std::f64::consts::TAU * f64::from(arm) / f64::from(ARMS)).sin_cos();
            let at = |radius: f64| shoot([middle[0] + radius * cosine, middle[1] + radius * sine]);
            let end = edge(0.0, outside, 1e-6 * outside, |radius| at(radius).is_some());
            rim.extend(at(end).map(|ray| ray.cosines));
            rays.extend(gauss_legendre().into_iter().filter_map(|(node, share)| {
                let ray = at(node * end)?;
                Some(Landed { weight: ray.weight * share * node * end * end, ..ray })
            }));
        }
        let light: f64 = rays.iter().map(|ray| ray.weight).sum();
        if !(light > 0.0) {
            return None;
        }
        let mean = |value: &dyn Fn(&Landed) -> f64| {
            rays.iter().map(|ray| ray.weight * value(ray)).sum::<f64>() / light
        };
        let centre = [0, 1].map(|axis| mean(&|ray| ray.film[axis]));
        let rms = [0, 1].map(|axis| mean(&|ray| (ray.film[axis] - centre[axis]).powi(2)).sqrt());
        let mut radii: Vec<(f64, f64)> = rays
            .iter()
            .map(|ray| ((ray.film[0] - centre[0]).hypot(ray.film[1] - centre[1]), ray.weight))
            .collect();
        radii.sort_by(|a, b| a.0.total_cmp(&b.0));
        let encircled = [0.5, 0.8].map(|share| {
            let mut held = 0.0;
            let holds = |(_, weight): &&(f64, f64)| {
                held += weight;
                held >= share * light
            };
            radii.iter().find(holds).map_or(0.0, |(radius, _)| *radius)
        });
        let airy = AIRY * lens.wavelength * 1e-6 * fnumber(&rim, lens.outer_indices()[1]);
        Some(Self {
            radius: ring.radius,
            angle: ring.angle.to_degrees(),
            rays: rays.len(),
            offset: centre[0] - ring.radius * field.film.pixel(),
            rms,
            encircled,
            airy,
        })
    }

    /// Formats the spot as JSON.
    pub fn json(&self, pixel: f64) -> Value {
        json!({
            "film_radius_px": self.radius,
            "angle_deg": self.angle,
            "rays": self.rays,
            "offset_mm": self.offset,
            "rms_radial_mm": self.rms[0],
            "rms_tangential_mm": self.rms[1],
            "encircled_50_mm": self.encircled[0],
            "encircled_80_mm": self.encircled[1],
            "rms_px": self.rms[0].hypot(self.rms[1]) / pixel,
            "airy_radius_mm": self.airy,
        })
    }

    /// Formats the spot as a line of CSV.
    pub fn line(&self) -> String {
        let numbers =
            [self.offset, self.rms[0], self.rms[1], self.encircled[0], self.encircled[1], self.airy];
        let numbers = numbers.map(|number| format!("{number:.6}")).join(",");
        format!("{:.3},{:.4},{},{numbers}\n", self.radius, self.angle, self.rays)
    }

    /// Names of the columns.
    pub const HEADER: &'static str = "film_radius_px,angle_deg,rays,offset_mm,rms_radial_mm,rms_tangential_mm,encircled_50_mm,encircled_80_mm,airy_radius_mm\n";
}

/// Returns the f-number of the round cone of light that has the area of a pupil in direction cosines times the index
/// of the medium; `rim` are the cosines around the pupil.
fn fnumber(rim: &[[f64; 2]], index: f64) -> f64 {
    let next = rim.iter().cycle().skip(1);
    let area = 0.5 * rim.iter().zip(next).map(|([x, y], [u, v])| x * v - u * y).sum::<f64>().abs();
    0.5 * (std::f64::consts::PI / area).sqrt() / index
}
