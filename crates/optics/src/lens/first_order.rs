//! First-order (Gaussian) optics: represents the lens as a thick lens, by products of ray-transfer (ABCD) matrices (M.
//! Born and E. Wolf, *Principles of Optics*, §4.4). Kolb, Mitchell and Hanrahan 1995, §3.2, use the same thick lens.
//! Computes the cardinal points of a lens, and transfers rays from one side to the other. A test compares the results
//! with the lecture's recipe, which traces exact rays very near the axis.

use super::{Lens, LensError, Ray};
use crate::{prescription::Meridian, trace::Path};

/// A ray-transfer matrix, which acts on (height y, optical slope n dy/ds), where s is counted from scene to film. The
/// determinant of the matrix is 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Abcd {
    /// Coefficient of the incoming height in the outgoing height.
    pub a: f64,
    /// Coefficient of the incoming slope in the outgoing height, mm.
    pub b: f64,
    /// Coefficient of the incoming height in the outgoing slope, 1/mm.
    pub c: f64,
    /// Coefficient of the incoming slope in the outgoing slope.
    pub d: f64,
}

impl Abcd {
    const IDENTITY: Self = Self { a: 1.0, b: 0.0, c: 0.0, d: 1.0 };

    /// Returns this matrix followed by the refraction at a surface with the power (n' - n)/R.
    fn refracted(self, power: f64) -> Self {
        Self { c: self.c - power * self.a, d: self.d - power * self.b, ..self }
    }

    /// Returns this matrix followed by a reduced distance: the thickness divided by the index.
    fn transferred(self, reduced: f64) -> Self {
        Self { a: self.a + reduced * self.c, b: self.b + reduced * self.d, ..self }
    }

    /// Returns the matrix, in a meridian, from the vertex of surface `from` to the vertex of surface `to`. The matrix
    /// includes the refraction at `from` only if `refract_first`, and always includes the refraction at the surfaces
    /// after `from` up to `to`. Surfaces are counted from the scene. Changes of frame are left out.
    fn between(lens: &Lens, meridian: Meridian, from: usize, refract_first: bool, to: usize) -> Self {
        let mut matrix = Self::IDENTITY;
        for (number, surface) in lens.surfaces.iter().enumerate().take(to + 1).skip(from) {
            if number > from {
                // The difference between the vertices would lose digits far from the first vertex.
                matrix = matrix.transferred(lens.surfaces[number - 1].distance_behind() / surface.n_scene);
            }
            if number > from || refract_first {
                matrix = matrix.refracted(surface.power(meridian));
            }
        }
        matrix
    }

    /// Returns the matrix of the whole lens in a meridian, from the front vertex to the rear vertex. For surfaces that do
    /// not share an axis it is that of rays beside the ray which enters along the axis (parabasal rays).
    pub fn of_lens(lens: &Lens, meridian: Meridian) -> Self {
        let is_turned = lens.film_break.is_some()
            || lens.surfaces.iter().any(|surface| surface.coordinate_break.is_some());
        let parabasal = if is_turned { Self::parabasal(lens, meridian) } else { None };
        parabasal.unwrap_or_else(|| Self::between(lens, meridian, 0, true, lens.surfaces.len() - 1))
    }

    /// Returns the matrix by differences of exact rays, of fourth order in their distance; `None` if such a ray misses a
    /// surface.
    fn parabasal(lens: &Lens, meridian: Meridian) -> Option<Self> {
        let path = Path::<f64>::scene_to_film(lens).without_edges();
        let i = usize::from(meridian == Meridian::Y);
        let [n_scene, n_film] = lens.outer_indices();
        // The height in the plane of the rear vertex, and the optical slope there.
        let trace = |height: f64, slope: f64| {
            let (mut origin, mut direction) = ([0.0; 3], [0.0, 0.0, -1.0]);
            (origin[i], direction[i]) = (height, slope);
            let Ray { origin, direction } = path.trace(Ray { origin, direction }).ok()?;
            let slope = direction[i] / -direction[2];
            Some([origin[i] + slope * (origin[2] - path.exit()), n_film * slope])
        };
        let sizes = lens.surfaces.iter().map(|surface| surface.semi_diameter);
        let step = PARABASAL * sizes.fold(f64::INFINITY, f64::min);
        let derivative = |ray: &dyn Fn(f64) -> Option<[f64; 2]>, step: f64| {
            let [far_below, below, above, far_above] =
                [ray(-2.0 * step)?, ray(-step)?, ray(step)?, ray(2.0 * step)?];
            let four =
                |i: usize| (8.0 * (above[i] - below[i]) - (far_above[i] - far_below[i])) / (12.0 * step);
            Some([four(0), four(1)])
        };
        let [a, c] = derivative(&|height| trace(height, 0.0), step)?;
        let [b, d] = derivative(&|slope| trace(0.0, slope), PARABASAL)?;
        Some(Self { a, b: b / n_scene, c, d: d / n_scene })
    }

    /// Returns the matrix from the front vertex to the vertex plane of surface `index`, including the refraction there.
    pub(super) fn in_front_of(lens: &Lens, index: usize) -> Self {
        Self::between(lens, Meridian::Y, 0, true, index)
    }

    /// Returns the matrix from the vertex plane of surface `index`, without the refraction there, to the rear vertex.
    pub(super) fn behind(lens: &Lens, index: usize) -> Self {
        Self::between(lens, Meridian::Y, index, false, lens.surfaces.len() - 1)
    }
}

/// The cardinal points of a lens. All positions are z in lens space, mm.
///
/// With the power φ, the index n of the scene's medium and the index n' of the film's, the distances from the principal
/// planes to the focal points are the focal lengths f = n/φ and f' = n'/φ. The nodal points coincide with the principal
/// points if n = n', as in air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstOrder {
    /// Effective focal length 1/φ, mm; negative for a diverging lens. In air this is the distance from a principal
    /// plane to its focal point.
    pub focal_length: f64,
    /// Refractive index n of the medium in front of the lens.
    pub n_scene: f64,
    /// Refractive index n' of the medium behind the lens.
    pub n_film: f64,
    /// Scene-side focal point F.
    pub front_focal_point: f64,
    /// Film-side focal point F'.
    pub rear_focal_point: f64,
    /// Scene-side principal plane P.
    pub front_principal_plane: f64,
    /// Film-side principal plane P'.
    pub rear_principal_plane: f64,
    /// The z coordinate of the last vertex.
    pub rear_vertex: f64,
}

/// Distance of parabasal rays in the smallest semi-diameter, and their slope. The differences are then exact to 1e-11.
const PARABASAL: f64 = 2e-3;

/// Power below which the lens is afocal, as a fraction of the sum of the magnitudes of the surfaces' powers.
const AFOCAL: f64 = 1e-12;

impl FirstOrder {
    /// Computes the cardinal points by ABCD matrices, in the meridian y for a lens that is not symmetric.
    ///
    /// # Errors
    /// The lens is afocal.
    pub fn of(lens: &Lens) -> Result<Self, LensError> {
        Self::in_meridian(lens, Meridian::Y)
    }

    /// Returns the ratio of the focal length in y to that in x: 1 for a lens with an axis, 2 for an anamorphic lens that
    /// doubles the field in x.
    ///
    /// # Errors
    /// The lens is afocal in a meridian.
    pub fn squeeze(lens: &Lens) -> Result<f64, LensError> {
        let focal_length = |meridian| Ok(Self::in_meridian(lens, meridian)?.focal_length);
        Ok(focal_length(Meridian::Y)? / focal_length(Meridian::X)?)
    }

    /// Computes the cardinal points in a meridian. The film's side is image space (see `trace::path`).
    ///
    /// # Errors
    /// The lens is afocal in this meridian.
    pub fn in_meridian(lens: &Lens, meridian: Meridian) -> Result<Self, LensError> {
        let matrix = Abcd::of_lens(lens, meridian);
        let powers: f64 = lens.surfaces.iter().map(|surface| surface.power(meridian).abs()).sum();
        if !(matrix.c.abs() > AFOCAL * powers) {
            return Err(LensError::Afocal { lens: lens.name.clone() });
        }
        let focal_length = -1.0 / matrix.c;
        let [n_scene, n_film] = lens.outer_indices();
        let (front, rear) = (focal_length * n_scene, focal_length * n_film);
        let rear_vertex = lens.rear().vertex;
        let front_focal_point = matrix.d * front;
        let rear_focal_point = rear_vertex - matrix.a * rear;
        Ok(Self {
            focal_length,
            n_scene,
            n_film,
            front_focal_point,
            rear_focal_point,
            front_principal_plane: front_focal_point - front,
            rear_principal_plane: rear_focal_point + rear,
            rear_vertex,
        })
    }

    /// Returns the focal length n/φ on the scene's side, mm: the distance from F to P.
    pub fn front_focal_length(&self) -> f64 {
        self.focal_length * self.n_scene
    }

    /// Returns the focal length n'/φ on the film's side, mm: the distance from P' to F'.
    pub fn rear_focal_length(&self) -> f64 {
        self.focal_length * self.n_film
    }

    /// Returns √(n n')/φ, mm: the distances of a point from F and of its image from F' have the square of this length as
    /// their product (Newton's equation).
    pub fn mean_focal_length(&self) -> f64 {
        self.focal_length * (self.n_scene * self.n_film).sqrt()
    }

    /// Returns z of the nodal points, scene side first: a ray toward the first leaves the lens from the second, parallel
    /// to its own direction.
    pub fn nodal_points(&self) -> [f64; 2] {
        let shift = (self.n_film - self.n_scene) * self.focal_length;
        [self.front_principal_plane - shift, self.rear_principal_plane - shift]
    }

    /// Returns the back focal distance: from the last vertex to the film-side focal point, mm.
    pub fn back_focal_distance(&self) -> f64 {
        self.rear_vertex - self.rear_focal_point
    }

    /// Returns the thin lens of the same focal length in the plane z = `plane` of lens space.
    #[must_use]
    pub fn thin_at(&self, plane: f64) -> Self {
        Self {
            front_principal_plane: plane,
            rear_principal_plane: plane,
            front_focal_point: plane + self.front_focal_length(),
            rear_focal_point: plane - self.rear_focal_length(),
            ..*self
        }
    }

    /// Returns the ray-transfer matrix, for heights and slopes dx/dz, from a film in the plane z = `film` of lens space
    /// to the front vertex plane. The first row gives the height from the height and from the slope (mm); the second
    /// row gives the slope from the height (1/mm) and from the slope. The determinant is n'/n.
    pub fn from_film(&self, film: f64) -> [[f64; 2]; 2] {
        let power = self.focal_length.recip();
        // The distances from the film to the film-side principal plane, and from the other principal plane to the front
        // vertex.
        let (before, after) = (self.rear_principal_plane - film, -self.front_principal_plane);
        let slope = [-power / self.n_scene, (self.n_film - before * power) / self.n_scene];
        let height = [1.0 + after * slope[0], before + after * slope[1]];
        [height, slope]
    }

    /// Returns the distance, mm, from a film `film_distance` mm behind the last vertex to the plane in focus, by
    /// Newton's equation. The distance is infinite if the film is at or before the focal point. The result is `None` if
    /// the plane in focus lies behind the front vertex.
    pub fn object_distance(&self, film_distance: f64) -> Option<f64> {
        let beyond = film_distance - self.back_focal_distance();
        if beyond <= 0.0 {
            return Some(f64::INFINITY);
        }
        let object = self.front_focal_point + self.front_focal_length() * self.rear_focal_length() / beyond;
        (object > 0.0).then_some(object - (self.rear_vertex - film_distance))
    }

    /// Returns the distance from the last vertex to the image of the axial point 1/`vergence` mm in front of the first
    /// vertex, by Newton's equation. A vergence of 0 stands for a point at infinity. The distance is infinite if there
    /// is no image, and negative if the image is virtual.
    pub fn image_distance(&self, vergence: f64) -> f64 {
        let beyond_focus = 1.0 - vergence * self.front_focal_point;
        self.back_focal_distance()
            + self.front_focal_length() * self.rear_focal_length() * vergence / beyond_focus
    }

    /// Returns the scene-side ray that a film-side ray becomes through the thick lens (Kolb et al., §3.2). The ray
    /// crosses from principal plane to principal plane at equal height, and its slope times the index changes by the
    /// height times the power. The result starts in the front vertex plane.
    pub fn transfer(&self, ray: Ray) -> Ray {
        let planes = [self.rear_principal_plane, self.front_principal_plane];
        self.carry(ray, planes, [self.n_film, self.n_scene], 0.0, 1.0)
    }

    /// Returns the film-side ray that a scene-side ray becomes. The result starts in the rear vertex plane.
    pub fn transfer_to_film(&self, ray: Ray) -> Ray {
        let planes = [self.front_principal_plane, self.rear_principal_plane];
        self.carry(ray, planes, [self.n_scene, self.n_film], self.rear_vertex, -1.0)
    }

    /// Transfers a ray from the principal plane `from` to the principal plane `to`, in media of these indices, and then
    /// to the plane `out`. Light travels toward +z (`travel_sign` 1) or -z (-1).
    fn carry(&self, ray: Ray, [from, to]: [f64; 2], [n, n_out]: [f64; 2], out: f64, travel_sign: f64) -> Ray {
        let [x, y, z] = ray.origin;
        let [dx, dy, dz] = ray.direction;
        let leave = |height: f64, slope: f64| {
            let height = height + slope * (from - z);
            let slope = (n * slope - travel_sign * height / self.focal_length) / n_out;
            (height + slope * (out - to), slope)
        };
        let (px, sx) = leave(x, dx / dz);
        let (py, sy) = leave(y, dy / dz);
        let norm = travel_sign * (1.0 + sx * sx + sy * sy).sqrt();
        Ray { origin: [px, py, out], direction: [sx / norm, sy / norm, 1.0 / norm] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prescription::{catalogue, read};

    #[test]
    fn the_thick_lens_traces_a_ray_back_along_its_path() {
        for name in catalogue::round() {
            let lens =
                FirstOrder::of(&Lens::at_d_line(&catalogue::find(name).expect("listed"))).expect("focal");
            for optics in [lens, lens.thin_at(lens.rear_principal_plane)] {
                let film = optics.rear_focal_point - 3.0;
                let start = Ray { origin: [1.0, -2.0, film], direction: [0.1, 0.05, 1.0] };
                let out = optics.transfer(start);
                let back =
                    optics.transfer_to_film(Ray { origin: out.origin, direction: out.direction.map(|x| -x) });
                let t = (film - back.origin[2]) / back.direction[2];
                for i in 0..2 {
                    let at_film = back.origin[i] + t * back.direction[i];
                    assert!((at_film - start.origin[i]).abs() < 1e-10, "{name}: {back:?}");
                }
            }
        }
    }

    /// Returns the optics of a surface of radius 5 mm between water and a glass of index 1.6, behind a plate of water.
    fn one_surface() -> FirstOrder {
        let text = b"medium 1.33\nstop 2 1.33 9\n5 0 1.6 4\n";
        FirstOrder::of(&Lens::at_d_line(&read("surface", text).expect("a lens"))).expect("focal")
    }

    #[test]
    fn a_surface_between_two_media_has_two_focal_lengths_and_its_centre_as_nodal_point() {
        let optics = one_surface();
        let power = (1.6 - 1.33) / 5.0;
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12 * b.abs(), "{a} {b}");
        near(optics.focal_length, 1.0 / power);
        near(optics.front_focal_length(), 1.33 / power);
        near(optics.rear_focal_length(), 1.6 / power);
        near(optics.front_focal_point, -2.0 + 1.33 / power);
        near(optics.rear_focal_point, -2.0 - 1.6 / power);
        // The surface is both principal planes; rays toward its centre are not refracted.
        near(optics.front_principal_plane, -2.0);
        near(optics.rear_principal_plane, -2.0);
        optics.nodal_points().into_iter().for_each(|z| near(z, -7.0));
        // n'/s' = n/s + φ, with s in front of the surface.
        let image = 1.6 / (power - 1.33 / 100.0);
        near(optics.image_distance(1.0 / 98.0), image);
        near(optics.object_distance(image).expect("in front"), 100.0 + image);
    }

    #[test]
    fn the_thick_lens_refracts_between_media_by_its_power() {
        let optics = one_surface();
        let film = optics.rear_vertex - 40.0;
        let start = Ray { origin: [1.0, -2.0, film], direction: [0.1, 0.05, 1.0] };
        let out = optics.transfer(start);
        let slope = |ray: &Ray, axis: usize| ray.direction[axis] / ray.direction[2];
        let [[a, b], [c, d]] = optics.from_film(film);
        assert!((a * d - b * c - 1.6 / 1.33).abs() < 1e-12);
        for axis in 0..2 {
            let (y, s) = (start.origin[axis], start.direction[axis]);
            let height = y + 40.0 * s;
            let behind = (1.6 * s - height / optics.focal_length) / 1.33;
            assert!((slope(&out, axis) - behind).abs() < 1e-12);
            assert!((c * y + d * s - behind).abs() < 1e-12);
            assert!((a * y + b * s - out.origin[axis]).abs() < 1e-12);
        }
        let back = optics.transfer_to_film(Ray { origin: out.origin, direction: out.direction.map(|x| -x) });
        let at_film = back.origin[0] - 40.0 * slope(&back, 0);
        assert!((at_film - 1.0).abs() < 1e-12, "{back:?}");
    }

    #[test]
    fn a_thin_lens_keeps_the_film_side_and_directions() {
        let lens = FirstOrder::of(&Lens::at_d_line(&catalogue::find("wide.22mm").expect("listed")));
        let lens = lens.expect("focal");
        let thin = lens.thin_at(lens.rear_principal_plane);
        assert_eq!(thin.back_focal_distance(), lens.back_focal_distance());
        let ray = Ray { origin: [2.0, 1.0, lens.rear_focal_point], direction: [0.02, -0.1, 1.0] };
        let (thick_out, thin_out) = (lens.transfer(ray), thin.transfer(ray));
        for i in 0..3 {
            assert!((thick_out.direction[i] - thin_out.direction[i]).abs() < 1e-14);
        }
        // The gap between the principal planes shifts the ray along the axis by exactly that gap.
        let gap = lens.front_principal_plane - lens.rear_principal_plane;
        let slope = thick_out.direction[1] / thick_out.direction[2];
        assert!((thin_out.origin[1] - thick_out.origin[1] - slope * gap).abs() < 1e-10);
    }
}
