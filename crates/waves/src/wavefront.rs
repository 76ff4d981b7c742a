//! The wavefront of an object point at an image point, as rays with path differences, and its measures.

use std::f64::consts::TAU;

use crate::{
    object::ObjectPoint,
    pupil::{Beam, Passed, nodes},
    zernike::{self, Ordering},
};
use realistic_base::numeric::dot;
use realistic_light::{LitPath, Surfaces};
use realistic_optics::{
    imaging::{axial_beam::stop_or_limiting, chief::ChiefRays},
    lens::{Lens, Ray, film_ray, pupil::EntrancePupil, refraction::Refraction},
    trace::{Direction, Path, Walk},
};
use realistic_trace::kernel::PathKernel;
use thiserror::Error;

/// A plane of film: a point of it, in image space, mm, and two perpendicular unit vectors in it, along which pixels are
/// counted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmPlane {
    /// A point of the plane, mm.
    pub point: [f64; 3],
    /// The axes of the picture.
    pub axes: [[f64; 3]; 2],
}

impl FilmPlane {
    /// Returns the plane z = `film` with the axes x and y.
    pub fn across(film: f64) -> Self {
        Self { point: [0.0, 0.0, film], axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] }
    }

    /// Returns where a ray meets the plane.
    fn meeting(&self, origin: [f64; 3], direction: [f64; 3]) -> [f64; 3] {
        let [a, b] = self.axes;
        let normal = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        let along = dot(normal, between(self.point, origin)) / dot(normal, direction);
        std::array::from_fn(|i| origin[i] + along * direction[i])
    }

    /// Returns the components of a vector along the axes.
    pub fn within(&self, vector: [f64; 3]) -> [f64; 2] {
        self.axes.map(|axis| dot(axis, vector))
    }
}

/// The number of rays by which a wavefront is sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampling {
    /// Number of rows of rays, and of rays in each row, 8 or more.
    pub across: usize,
}

impl Sampling {
    /// 256 rays in each of 256 rows.
    pub const DEFAULT: Self = Self { across: 256 };

    /// Returns the sampling with which another is compared: three quarters as many rays across.
    #[must_use]
    pub fn coarser(self) -> Self {
        Self { across: self.across * 3 / 4 }
    }
}

/// The reason why an object point has no wavefront.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum WaveError {
    /// No ray of the point passes the lens.
    #[error(
        "no ray of the object point passes the lens: it lies outside the field; choose a point nearer the axis"
    )]
    Dark,
    /// No ray of the point meets the centre of the stop, even without apertures.
    #[error(
        "the object point has no chief ray through the centre of the stop; choose a point nearer the axis"
    )]
    NoChiefRay,
}

/// A ray of the object point.
#[derive(Clone, Copy, Debug)]
pub struct Node {
    /// The components of n' d along the film's axes.
    pub q: [f64; 2],
    /// Path difference to the chief ray at the image point, mm.
    pub w: f64,
    /// Power that the ray represents.
    pub power: f64,
    /// Amplitude times the area of q that the ray represents: a d²q.
    pub amplitude: f64,
    /// The point at which the ray meets the film, relative to the image point, mm along the film's axes.
    pub landing: [f64; 2],
}

/// The wavefront of an object point at an image point.
#[derive(Clone, Debug)]
pub struct Wavefront {
    /// The rays.
    pub nodes: Vec<Node>,
    /// Wavelength in vacuum, mm.
    pub wavelength: f64,
    /// The image point, where the chief ray meets the film, image space, mm.
    pub image: [f64; 3],
    /// The number of rays traced.
    pub sampling: Sampling,
}

/// Differences of a ray's coordinates for derivatives, relative to the front semi-diameter.
const DIFFERENCE: f64 = 1e-6;

impl Wavefront {
    /// Traces the rays of an object point to the film, where their chief ray meets it.
    ///
    /// # Errors
    /// The point has no chief ray, or no ray that passes.
    pub fn new(
        lens: &Lens,
        object: ObjectPoint,
        film: &FilmPlane,
        sampling: Sampling,
    ) -> Result<Self, WaveError> {
        Self::about(lens, None, object, film, sampling, None)
    }

    /// Traces the rays as [`Wavefront::new`] does, but with the light that `surfaces` transmit and glasses do not absorb, and
    /// about a given image point, mm, such as that of another wavelength. Phases of coatings are left out.
    ///
    /// # Errors
    /// As for [`Wavefront::new`].
    pub fn about(
        lens: &Lens,
        surfaces: Option<&Surfaces>,
        object: ObjectPoint,
        film: &FilmPlane,
        sampling: Sampling,
        image: Option<[f64; 3]>,
    ) -> Result<Self, WaveError> {
        let chief_rays = ChiefRays::new(lens, Direction::SceneToFilm);
        let (aimed, chief) = chief_ray(lens, &chief_rays, object)?;
        let image = image.unwrap_or_else(|| film.meeting(chief.origin, chief.direction));
        let [_, n] = lens.outer_indices();
        // The optical path of a ray to the foot of the perpendicular from the image point.
        let path_of = |ray: &Passed| ray.path + n * dot(between(image, ray.origin), ray.direction);
        let q_of = |ray: &Passed| film.within(ray.direction).map(|part| n * part);
        let whole = path_of(&chief);
        let path = Path::new(lens, Direction::SceneToFilm, Refraction::default()).with_apertures(lens);
        let kernel = PathKernel::along(&path);
        let lit = surfaces.map(|surfaces| LitPath::new(path, surfaces));
        let beam = Beam { kernel: &kernel, object };
        let points = nodes(&beam, lens, Some(aimed), sampling.across);
        let rays = beam.trace(&points.iter().map(|(point, _)| *point).collect::<Vec<_>>());
        // The area of q per area of the plane z = 0, from rays beside each ray. They are traced without apertures.
        let open = PathKernel::along(chief_rays.path());
        let h = DIFFERENCE * lens.front().semi_diameter;
        let beside = |axis: usize| {
            let moved = |([x, y], _): &([f64; 2], f64)| if axis == 0 { [x + h, *y] } else { [*x, y + h] };
            Beam { kernel: &open, object }.trace(&points.iter().map(moved).collect::<Vec<_>>())
        };
        let [along_x, along_y] = [beside(0), beside(1)];
        let mut nodes = Vec::with_capacity(points.len());
        for (i, (point, area)) in points.iter().enumerate() {
            let (Some(ray), Some(a), Some(b)) = (&rays[i], &along_x[i], &along_y[i]) else { continue };
            let (q, [a, b]) = (q_of(ray), [a, b].map(q_of));
            let [ax, ay, bx, by] = [a[0] - q[0], a[1] - q[1], b[0] - q[0], b[1] - q[1]];
            let stretch = (ax * by - ay * bx).abs() / (h * h);
            // With its surfaces, a path has the light of pictures in the stop, too.
            let light = match &lit {
                None => ray.light,
                Some(lit) => lit.trace(object.ray(*point)).map_or(0.0, |(_, light)| light),
            };
            let density = object.power(*point) * light;
            nodes.push(Node {
                q,
                w: path_of(ray) - whole,
                power: density * area,
                amplitude: (density * stretch).sqrt() * area,
                landing: film.within(between(film.meeting(ray.origin, ray.direction), image)),
            });
        }
        if nodes.is_empty() {
            return Err(WaveError::Dark);
        }
        Ok(Self { nodes, wavelength: lens.wavelength * 1e-6, image, sampling })
    }

    /// Returns the same pupil without path differences: that of a perfect lens.
    #[must_use]
    pub fn perfect(&self) -> Self {
        let mut perfect = self.clone();
        for node in &mut perfect.nodes {
            (node.w, node.landing) = (0.0, [0.0; 2]);
        }
        perfect
    }

    /// Returns the power of all rays.
    pub fn power(&self) -> f64 {
        self.nodes.iter().map(|node| node.power).sum()
    }

    /// Returns the smallest and the largest q along each axis.
    pub fn extent(&self) -> [[f64; 2]; 2] {
        [0, 1].map(|axis| {
            let each = self.nodes.iter().map(|node| node.q[axis]);
            each.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], q| [low.min(q), high.max(q)])
        })
    }

    /// Returns the mean of a function of the rays, weighted by amplitude.
    fn mean(&self, of: impl Fn(&Node) -> f64) -> f64 {
        let [sum, weight] = self
            .nodes
            .iter()
            .fold([0.0; 2], |[sum, weight], node| [sum + node.amplitude * of(node), weight + node.amplitude]);
        sum / weight
    }

    /// Returns the RMS of the path difference about its mean, in wavelengths.
    pub fn rms(&self) -> f64 {
        let mean = self.mean(|node| node.w);
        self.mean(|node| (node.w - mean).powi(2)).sqrt() / self.wavelength
    }

    /// Returns the largest path difference minus the smallest, in wavelengths.
    pub fn peak_to_valley(&self) -> f64 {
        let each = self.nodes.iter().map(|node| node.w);
        let [low, high] =
            each.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], w| [low.min(w), high.max(w)]);
        (high - low) / self.wavelength
    }

    /// Returns the Strehl ratio at the image point: the ratio of the power there to that without path differences.
    pub fn strehl(&self) -> f64 {
        let k = TAU / self.wavelength;
        let [re, im, whole] = self.nodes.iter().fold([0.0; 3], |[re, im, whole], node| {
            let (sin, cos) = (k * node.w).sin_cos();
            [re + node.amplitude * cos, im + node.amplitude * sin, whole + node.amplitude]
        });
        (re * re + im * im) / (whole * whole)
    }

    /// Returns the circle of q on which Zernike polynomials are defined: its centre, in the middle of the pupil, and its
    /// radius, to the outermost ray.
    pub fn circle(&self) -> ([f64; 2], f64) {
        let centre = self.extent().map(|[low, high]| f64::midpoint(low, high));
        let distance = |node: &Node| (node.q[0] - centre[0]).hypot(node.q[1] - centre[1]);
        (centre, self.nodes.iter().map(distance).fold(0.0, f64::max))
    }

    /// Returns the coefficients of the first `count` Zernike polynomials, in wavelengths, by least squares over the pupil,
    /// on the circle of [`Wavefront::circle`].
    pub fn zernike(&self, ordering: Ordering, count: usize) -> Vec<f64> {
        let (centre, radius) = self.circle();
        let samples = self.nodes.iter().map(|node| {
            let at = [0, 1].map(|axis| (node.q[axis] - centre[axis]) / radius);
            (at, node.w / self.wavelength, node.amplitude)
        });
        zernike::fitted(ordering, count, samples)
    }
}

/// Returns where the chief ray of an object point crosses the plane z = 0, and the ray behind the lens.
fn chief_ray(
    lens: &Lens,
    chief_rays: &ChiefRays,
    object: ObjectPoint,
) -> Result<([f64; 2], Passed), WaveError> {
    let pupil = EntrancePupil::of_surface(lens, stop_or_limiting(lens)).position().unwrap_or(0.0);
    // The centre of the stop is searched from where the point sees the entrance pupil.
    let aimed = [object.seen_through([0.0, 0.0, pupil]), [0.0; 2]]
        .into_iter()
        .find_map(|start| chief_rays.aimed(|point| object.ray(point), start, lens.front().semi_diameter))
        .ok_or(WaveError::NoChiefRay)?;
    let Walk { ray, optical_path, blocked, .. } = chief_rays.path().walk(object.ray(aimed));
    if blocked.is_some() {
        return Err(WaveError::NoChiefRay);
    }
    Ok((aimed, Passed { origin: ray.origin, direction: ray.direction, path: optical_path, light: 1.0 }))
}

fn between(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

/// Returns the object point whose chief ray arrives at a point of the film, mm, given by that chief ray as it leaves the
/// lens toward the scene, at a distance along z from the film, mm; `f64::INFINITY` for a point at infinity.
pub fn object_of(lens: &Lens, film_point: [f64; 3], distance: f64) -> Result<ObjectPoint, WaveError> {
    let [x, y, z] = film_point;
    let chief = ChiefRays::new(lens, Direction::FilmToScene);
    let slopes = chief.from_film([x, y], z).ok_or(WaveError::NoChiefRay)?;
    let ray = film_ray([x, y], z, slopes);
    let Ray { origin, direction } = chief.path().trace(ray).map_err(|_| WaveError::NoChiefRay)?;
    if distance == f64::INFINITY {
        return ObjectPoint::toward(lens, direction).ok_or(WaveError::NoChiefRay);
    }
    let along = (z + distance - origin[2]) / direction[2];
    let point: [f64; 3] = std::array::from_fn(|i| origin[i] + along * direction[i]);
    (along > 0.0 && point[2] > 0.0).then_some(ObjectPoint::At(point)).ok_or(WaveError::NoChiefRay)
}
