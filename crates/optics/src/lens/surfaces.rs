//! A lens at one wavelength and one stop: the surfaces that rays intersect.
//!
//! A prescription and a wavelength are converted to vertices, curvatures, figures, refractive indices and clear
//! apertures in lens space. All modules that build on [`crate::lens`] use these values and not the glasses.

use std::sync::Arc;

use thiserror::Error;

use super::{figure::Figure, unsymmetric::UnsymmetricFigure};
use crate::prescription::{
    Aperture, Blades, CoordinateBreak, Meridian, Outline, Prescription, Shape, StopPicture,
    glass::{D_LINE, refractive_index},
};
use realistic_base::{
    message::{as_given, short},
    numeric::root,
};

/// One surface of a lens at a given wavelength.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// The z coordinate of the vertex in lens space, mm; 0 for the first surface.
    pub vertex: f64,
    /// Radius in mm, infinite for a plane; positive if the centre lies on the film's side. For an asphere, the radius
    /// at the vertex.
    pub radius: f64,
    /// 1/radius in 1/mm, 0 for a plane.
    pub curvature: f64,
    /// Aspheric figure; `None` for a sphere or a plane, and for a surface that is not symmetric.
    pub figure: Option<Figure>,
    /// The figure of a surface that is not symmetric about its axis; radius and curvature are then those in the meridian
    /// y.
    pub unsymmetric: Option<Arc<UnsymmetricFigure>>,
    /// Distance to the next vertex, mm, along z toward the film; 0 for the last surface. Negative only beside a plane
    /// that only limits rays, and where light travels back between mirrors. This distance keeps digits that a
    /// difference between vertices would lose.
    pub thickness: f64,
    /// Refractive index on the scene's side.
    pub n_scene: f64,
    /// Refractive index on the film's side.
    pub n_film: f64,
    /// Absorption coefficient α of the medium on the film's side, 1/mm: the medium transmits exp(-α l) along a path of
    /// length l. 0 if unknown.
    pub absorption: f64,
    /// Clear semi-diameter, mm.
    pub semi_diameter: f64,
    /// Whether this is the aperture stop.
    pub is_stop: bool,
    /// Whether the surface reflects.
    pub is_mirror: bool,
    /// Whether light from the scene travels toward +z in front of the surface, behind an odd number of mirrors.
    pub is_reversed: bool,
    /// The change of frame in front of the surface; `None` on the axis.
    pub coordinate_break: Option<CoordinateBreak>,
    /// Apertures and obstructions inside the clear aperture, with lengths in clear semi-diameters. First-order optics,
    /// focusing, beams on the axis and the tables of pupils use the clear aperture alone; rays are also tested against
    /// these.
    pub apertures: Arc<[Aperture]>,
    /// Whether the surface touches the surface before it on the scene's side, not counting planes that only limit rays.
    /// With rounded radii and thicknesses the two surfaces may overlap a little; rays then intersect this surface
    /// slightly behind the other ([`Crossing`]).
    pub is_contact: bool,
}

/// Two neighbouring surfaces that overlap inside both their clear apertures. Planes that only limit rays do not count
/// as neighbours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Indices of the two surfaces, counted from the scene.
    pub surfaces: [usize; 2],
    /// Distance from the axis at which the surfaces begin to overlap, mm.
    pub height: f64,
    /// Maximum overlap along the axis, mm.
    pub overlap: f64,
    /// Whether the two surfaces touch: they cross at so small an angle that rounded data explain the overlap. Rays are
    /// then traced from one surface to the other as if they did not overlap. If the surfaces do not touch, rays that
    /// meet the second in front of the first are blocked.
    pub is_contact: bool,
    /// Whether floating-point rounding explains the overlap.
    pub is_rounding: bool,
}

impl Surface {
    /// Returns whether this is a plane in one medium, such as a stop or a flare stop, which limits rays and does not
    /// refract them.
    pub fn only_limits(&self) -> bool {
        let is_plane = self.curvature == 0.0 && self.figure.is_none() && self.unsymmetric.is_none();
        is_plane && self.n_scene == self.n_film && !self.is_mirror
    }

    /// Returns the curvature in a meridian, 1/mm; positive if the centre lies ahead of light from the scene.
    pub fn curvature_ahead(&self, meridian: Meridian) -> f64 {
        let curvature = match (&self.unsymmetric, meridian) {
            (Some(figure), Meridian::X) => figure.surface.radii()[0].recip(),
            _ => self.curvature,
        };
        if self.is_reversed { -curvature } else { curvature }
    }

    /// Returns the power of the surface in a meridian, 1/mm: (n' - n)/R, and -2 n/R for a mirror.
    pub fn power(&self, meridian: Meridian) -> f64 {
        let step = if self.is_mirror { -2.0 * self.n_scene } else { self.n_film - self.n_scene };
        step * self.curvature_ahead(meridian)
    }

    /// Returns whether light from the scene travels toward +z behind the surface.
    pub fn is_reversed_behind(&self) -> bool {
        self.is_reversed != self.is_mirror
    }

    /// Returns the distance to the next vertex along light from the scene, mm.
    pub fn distance_behind(&self) -> f64 {
        if self.is_reversed_behind() { -self.thickness } else { self.thickness }
    }

    /// Returns the sagitta, mm: the z of the surface at the distance `height` from the axis minus the z of the vertex,
    /// positive toward the scene, in the meridian y. For a sphere, `height` is at most the radius of curvature.
    pub fn sagitta(&self, height: f64) -> f64 {
        if let Some(figure) = &self.figure {
            return -figure.sagitta(height);
        }
        if let Some(figure) = &self.unsymmetric {
            return -figure.sagitta([0.0, height]);
        }
        let c = self.curvature;
        let root = (1.0 - (c * height).powi(2)).max(0.0).sqrt();
        -c * height * height / (1.0 + root)
    }

    /// Returns [`sagitta`](Self::sagitta) at the point (x, y).
    fn sagitta_at(&self, [x, y]: [f64; 2]) -> f64 {
        match &self.unsymmetric {
            Some(figure) => -figure.sagitta([x, y]),
            None => self.sagitta(x.hypot(y)),
        }
    }

    /// Returns the minimum and maximum sagitta inside the clear aperture, mm. For an asphere these are bounds, which
    /// form a slightly wider range.
    pub fn sagitta_range(&self) -> [f64; 2] {
        if let Some(figure) = &self.figure {
            let [low, high] = figure.bounds.sagitta;
            return [-high, -low];
        }
        if let Some(figure) = &self.unsymmetric {
            let [low, high] = figure.inside.sagitta;
            return [-high, -low];
        }
        let edge = self.sagitta(self.semi_diameter);
        [edge.min(0.0), edge.max(0.0)]
    }

    /// Returns the squared cosine of the largest angle between the axis and a normal inside the clear aperture. For an
    /// asphere this is a slightly smaller bound.
    pub fn least_cosine_squared(&self) -> f64 {
        let slope = match (&self.figure, &self.unsymmetric) {
            (Some(figure), _) => Some(figure.bounds.slope),
            (None, Some(figure)) => Some(figure.inside.slope),
            (None, None) => None,
        };
        match slope {
            Some(slope) => 1.0 / (1.0 + slope.powi(2)),
            None => 1.0 - (self.semi_diameter * self.curvature).powi(2),
        }
    }
}

/// Number of annuli at whose edges the gap between two surfaces is tested, if one of the surfaces is an asphere.
const ANNULI: u32 = 256;
/// Maximum overlap of touching surfaces, divided by the width of the annulus in which they overlap. The quotient is
/// roughly the tangent of the angle between the surfaces.
const CONTACT: f64 = 0.01;
/// Maximum overlap due to floating-point rounding, divided by the clear radius.
const ROUNDING: f64 = 1e-6;

/// A lens at one wavelength and one stop.
#[derive(Clone, Debug, PartialEq)]
pub struct Lens {
    /// The prescription's name.
    pub name: String,
    /// The surfaces, scene side first; at least one.
    pub surfaces: Vec<Surface>,
    /// The wavelength at which the indices hold, nm.
    pub wavelength: f64,
    /// Distance from the last vertex to the film, mm, as the lens file proposes it.
    pub nominal_film_distance: Option<f64>,
    /// The change of frame behind the last surface; `None` on the axis.
    pub film_break: Option<CoordinateBreak>,
}

/// Reason why a lens cannot be built as requested, or lacks a property that was requested.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum LensError {
    /// A stop size was requested, but the lens has no stop.
    #[error(
        "lens \"{lens}\" has no stop row, so \"aperture_diameter\" has nothing to set; \
         give \"fnumber\", which narrows the interface that limits the beam"
    )]
    NoStop {
        /// The lens.
        lens: String,
    },
    /// The requested stop is numerically indistinguishable from a point.
    #[error(
        "\"{name}\" is {}; it must be {} {}, at which the stop of lens \"{lens}\" is 1e-12 times as wide as it can be",
        short(*given), if *name == "fnumber" { "at most" } else { "at least" }, short(*limit)
    )]
    StopTooSmall {
        /// The lens.
        lens: String,
        /// The name of the parameter.
        name: &'static str,
        /// The value of the parameter.
        given: f64,
        /// The lower limit of the value; for an f-number, the upper limit.
        limit: f64,
    },
    /// The V-number of a glass gives the glass an index below that of air.
    #[error(
        "lens \"{lens}\", {}: at {} nm the V-number gives index {}, which is \
         below 1; correct the V-number, or ask for a \"wavelength\" nearer 587.56 nm",
        if *row == 0 { "in front of it".to_owned() } else { format!("interface {row}") },
        as_given(*wavelength), short(*index)
    )]
    Index {
        /// The lens.
        lens: String,
        /// The interface, counted from 1 at the scene side; 0 for the medium in front of the lens.
        row: usize,
        /// The index of the glass at the wavelength.
        index: f64,
        /// The wavelength, nm.
        wavelength: f64,
    },
    /// A glass has no data at the wavelength.
    #[error("lens \"{lens}\": {why}; give a \"wavelength\" at which every glass has an index")]
    Wavelength {
        /// The lens.
        lens: String,
        /// The glass, and the wavelengths of its data.
        why: String,
    },
    /// Parallel rays leave the lens parallel, so that the lens has no focal length, principal planes or focus.
    #[error("lens \"{lens}\" is afocal: it has no focal length and cannot focus")]
    Afocal {
        /// The lens.
        lens: String,
    },
    /// The request needs a lens that forms a real image.
    #[error(
        "lens \"{lens}\" has focal length {} mm: it makes no real image of a distant object",
        short(*focal_length)
    )]
    Diverging {
        /// The lens.
        lens: String,
        /// The focal length of the lens, mm.
        focal_length: f64,
    },
}

impl Lens {
    /// Builds the lens of a prescription at `wavelength` nm.
    pub fn new(prescription: &Prescription, wavelength: f64) -> Self {
        let mut vertex = 0.0;
        let mut is_reversed = false;
        let mut n_scene = refractive_index(prescription.object_medium, wavelength);
        let surfaces = prescription
            .interfaces
            .iter()
            .zip(prescription.transmittances())
            .map(|(interface, transmittance)| {
                let n_film = if interface.is_mirror {
                    n_scene
                } else {
                    refractive_index(interface.medium, wavelength)
                };
                let mut unsymmetric = None;
                let (radius, figure) = match interface.shape {
                    Shape::Sphere { radius } => (radius, None),
                    Shape::Unsymmetric(surface) => {
                        unsymmetric =
                            Some(Arc::new(UnsymmetricFigure::new(&surface, interface.semi_diameter)));
                        (surface.radii()[1], None)
                    }
                    Shape::Asphere(asphere) => {
                        let figure = Figure::new(&asphere, interface.semi_diameter);
                        // A2 contributes to the vertex curvature.
                        let bent = |figure: &Figure| figure.asphere.term(2) != 0.0;
                        let radius = match figure.filter(bent) {
                            Some(figure) => figure.vertex_curvature().recip(),
                            None => asphere.radius,
                        };
                        (radius, figure)
                    }
                    Shape::Plane => (f64::INFINITY, None),
                };
                let surface = Surface {
                    vertex,
                    radius,
                    curvature: radius.recip(),
                    figure,
                    unsymmetric,
                    thickness: interface.thickness,
                    n_scene,
                    n_film,
                    absorption: transmittance.map_or(0.0, |own| own.coefficient(wavelength)),
                    semi_diameter: interface.semi_diameter,
                    is_stop: interface.is_stop,
                    is_mirror: interface.is_mirror,
                    is_reversed,
                    coordinate_break: interface.coordinate_break,
                    apertures: interface
                        .apertures
                        .iter()
                        .map(|aperture| aperture.scaled(interface.semi_diameter.recip()))
                        .collect(),
                    is_contact: false,
                };
                vertex -= interface.thickness;
                n_scene = n_film;
                is_reversed ^= interface.is_mirror;
                surface
            })
            .collect();
        let mut lens = Self {
            name: prescription.name.clone(),
            surfaces,
            wavelength,
            nominal_film_distance: prescription.nominal_film_distance,
            film_break: prescription.film_break,
        };
        for Crossing { surfaces: [_, behind], is_contact, .. } in lens.crossings() {
            lens.surfaces[behind].is_contact = is_contact;
        }
        lens
    }

    /// Builds the lens of a prescription at the wavelength that it is designed for.
    pub fn at_own_wavelength(prescription: &Prescription) -> Self {
        Self::new(prescription, prescription.own_wavelength())
    }

    /// Builds the lens of a prescription at the d line.
    pub fn at_d_line(prescription: &Prescription) -> Self {
        Self::new(prescription, D_LINE)
    }

    /// Returns whether all surfaces are symmetric about one axis, whatever the apertures.
    pub fn is_centred(&self) -> bool {
        let is_round =
            |surface: &Surface| surface.coordinate_break.is_none() && surface.unsymmetric.is_none();
        self.film_break.is_none() && self.surfaces.iter().all(is_round)
    }

    /// Returns whether all surfaces are symmetric about one axis and refract.
    pub fn is_round(&self) -> bool {
        self.is_centred() && !self.has_mirror()
    }

    /// Returns whether the lens has a mirror.
    pub fn has_mirror(&self) -> bool {
        self.surfaces.iter().any(|surface| surface.is_mirror)
    }

    /// Returns the surface nearest the film.
    pub fn rear(&self) -> &Surface {
        self.surfaces.last().expect("a lens has at least one surface")
    }

    /// Returns the surface nearest the scene.
    pub fn front(&self) -> &Surface {
        self.surfaces.first().expect("a lens has at least one surface")
    }

    /// Returns the frames of the surfaces and then that of the film, as changes from the camera's frame, in which z points
    /// toward the film. The film's frame has its origin where the film distance begins.
    pub fn frames(&self) -> Vec<CoordinateBreak> {
        let mut frame = CoordinateBreak::NONE;
        let next = |(gap, own): (CoordinateBreak, Option<CoordinateBreak>)| {
            frame = frame.then(&gap);
            frame = own.map_or(frame, |own| frame.then(&own));
            frame
        };
        self.gaps_and_breaks().map(next).collect()
    }

    /// Returns, for each surface and then for the film, the shift along z from the previous vertex and the change of
    /// frame behind that shift.
    pub(crate) fn gaps_and_breaks(&self) -> impl Iterator<Item = (CoordinateBreak, Option<CoordinateBreak>)> {
        let breaks = self.surfaces.iter().map(|surface| surface.coordinate_break).chain([self.film_break]);
        let gaps = std::iter::once(0.0).chain(self.surfaces.iter().map(|surface| surface.thickness));
        gaps.map(|gap| CoordinateBreak::shifted([0.0, 0.0, gap])).zip(breaks)
    }

    /// Returns a point of image space in lens space.
    pub fn from_image_space(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let film = self.frames().pop().unwrap_or(CoordinateBreak::NONE);
        let [x, y, z] = film.point([x, y, self.rear_sagitta(self.rear().vertex - z)]);
        [x, y, -z]
    }

    /// Returns the lens turned by 90 degrees about the camera's axis, with its film: its section in the meridian y is that
    /// of this lens in x.
    #[must_use]
    pub fn turned(&self) -> Self {
        let turn = CoordinateBreak::tilted([0.0, 0.0, 90.0]);
        let mut lens = self.clone();
        let first = lens.surfaces[0].coordinate_break.unwrap_or(CoordinateBreak::NONE);
        lens.surfaces[0].coordinate_break = Some(turn.then(&first));
        let film = lens.film_break.unwrap_or(CoordinateBreak::NONE);
        lens.film_break = Some(film.then(&turn.inverse()));
        lens
    }

    /// Returns a sagitta of the rear surface, positive toward the scene in lens space, in image space, where z points
    /// from the film along the light's way back (see `trace::path`).
    pub fn rear_sagitta(&self, sagitta: f64) -> f64 {
        if self.rear().is_reversed_behind() { -sagitta } else { sagitta }
    }

    /// Returns, in image space, the point (x, y) of the rear surface with this sagitta, all in the surface's frame.
    pub fn rear_point(&self, [x, y]: [f64; 2], sagitta: f64) -> [f64; 3] {
        let toward_film = [x, y, -sagitta];
        let [x, y, z] = self.film_break.map_or(toward_film, |change| change.inverse().point(toward_film));
        [x, y, self.rear().vertex + self.rear_sagitta(-z)]
    }

    /// Sets or removes the blades of the stop, if the lens has a stop; its other apertures stay.
    pub fn set_blades(&mut self, blades: Option<Blades>) {
        if let Some(stop) = self.stop_index() {
            Aperture::set_blades(&mut self.surfaces[stop].apertures, blades);
        }
    }

    /// Adds a picture to the stop, if the lens has a stop.
    pub fn add_picture(&mut self, picture: StopPicture) {
        if let Some(stop) = self.stop_index() {
            let apertures = &mut self.surfaces[stop].apertures;
            let picture = Aperture::centered(Outline::Picture(Arc::new(picture)));
            *apertures = apertures.iter().cloned().chain([picture]).collect();
        }
    }

    /// Returns the picture that dims the light of rays, if there is one.
    pub fn picture(&self) -> Option<&StopPicture> {
        let mut apertures = self.surfaces.iter().flat_map(|surface| surface.apertures.iter());
        apertures.find_map(|aperture| match &aperture.outline {
            Outline::Picture(picture) => Some(&**picture),
            _ => None,
        })
    }

    /// Returns the lens with clear apertures alone.
    #[must_use]
    pub fn without_apertures(&self) -> Self {
        let mut lens = self.clone();
        lens.surfaces.iter_mut().for_each(|surface| surface.apertures = Arc::default());
        lens
    }

    /// Returns the refractive indices of the medium in front of the lens and of the medium behind it.
    pub fn outer_indices(&self) -> [f64; 2] {
        [self.front().n_scene, self.rear().n_film]
    }

    /// Returns the factor (n'/n)², where n' is the index behind the lens and n the index in front of it. Along a ray
    /// the radiance divided by n² is constant, so that the radiance at the film is the scene's times this factor.
    pub fn radiance_factor(&self) -> f64 {
        let [n_scene, n_film] = self.outer_indices();
        (n_film / n_scene).powi(2)
    }

    /// Returns the pairs of neighbouring surfaces that overlap, in order from the scene.
    pub fn crossings(&self) -> Vec<Crossing> {
        let mut crossings = Vec::new();
        let mut last: Option<usize> = None;
        let mut distance = 0.0;
        for (i, surface) in self.surfaces.iter().enumerate() {
            if surface.coordinate_break.is_some() {
                last = None;
            }
            if !surface.only_limits() {
                crossings.extend(last.and_then(|before| self.crossing([before, i], distance)));
                (last, distance) = (Some(i), 0.0);
            }
            distance += surface.thickness;
        }
        crossings
    }

    /// Tests two surfaces, whose vertices lie `distance` apart, for an overlap.
    fn crossing(&self, surfaces: [usize; 2], distance: f64) -> Option<Crossing> {
        let [mut first, mut second] = surfaces.map(|i| &self.surfaces[i]);
        // Between mirrors light may travel toward +z: the surfaces are seen from the other side.
        let mut distance = distance;
        if second.is_reversed {
            (first, second, distance) = (second, first, -distance);
        }
        if distance + first.sagitta_range()[0] > second.sagitta_range()[1] {
            return None;
        }
        // Surfaces without symmetry are compared in both meridians.
        let is_round = first.unsymmetric.is_none() && second.unsymmetric.is_none();
        let azimuths = if is_round { &[[0.0, 1.0]][..] } else { &[[0.0, 1.0], [1.0, 0.0]] };
        let gap = |height: f64| {
            let gaps = azimuths.iter().map(|azimuth| {
                let point = azimuth.map(|part| part * height);
                distance + first.sagitta_at(point) - second.sagitta_at(point)
            });
            gaps.fold(f64::INFINITY, f64::min)
        };
        let reach = first.semi_diameter.min(second.semi_diameter);
        // Between spheres the gap is monotonic in height.
        let is_plain = is_round && first.figure.or(second.figure).is_none();
        let annuli = if is_plain { 1 } else { ANNULI };
        let heights = (0..=annuli).map(|annulus| reach * f64::from(annulus) / f64::from(annuli));
        let (mut inside, mut begin, mut overlap) = (0.0, None, 0.0_f64);
        for height in heights {
            let gap_here = gap(height);
            if gap_here < 0.0 {
                begin = begin.or_else(|| Some(root(inside, height, gap)));
                overlap = overlap.max(-gap_here);
            }
            inside = height;
        }
        let height = begin?;
        let is_rounding = overlap <= ROUNDING * reach;
        let is_contact = is_rounding || overlap <= CONTACT * (reach - height);
        Some(Crossing { surfaces, height, overlap, is_contact, is_rounding })
    }

    /// Returns the index of the stop's surface, counted from the scene side.
    pub fn stop_index(&self) -> Option<usize> {
        self.surfaces.iter().position(|surface| surface.is_stop)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prescription::{catalogue, read};

    #[test]
    fn surfaces_that_cross_are_found_where_their_sagittae_add_up() {
        // Two surfaces of 10 mm radius, 1 mm apart. They cross where each has a sagitta of 0.5 mm: h² = 2 · 10 · 0.5 -
        // 0.5².
        let crossed = |diameter: f64| {
            let text =
                format!("20 5 1.5 5\n10 0.4 1 {diameter}\n0 0.6 1 4\n-10 2 1.5 {diameter}\n20 0 1 5\n");
            Lens::at_d_line(&read("crossed", text.as_bytes()).expect("a lens")).crossings()
        };
        let [crossing] = crossed(8.0)[..] else { panic!("two surfaces cross") };
        assert_eq!((crossing.surfaces, crossing.is_contact), ([1, 3], false));
        assert!((crossing.height - 9.75_f64.sqrt()).abs() < 1e-12, "{crossing:?}");
        // The sum of both sagittae at 4 mm, minus the distance of 1 mm.
        assert!((crossing.overlap - (2.0 * (10.0 - 84.0_f64.sqrt()) - 1.0)).abs() < 1e-12, "{crossing:?}");
        assert!(crossed(2.0 * 9.75_f64.sqrt()).iter().all(|crossing| crossing.is_rounding));
        for name in catalogue::round() {
            let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
            assert!(lens.crossings().iter().all(|crossing| crossing.is_rounding), "{name}");
        }
    }

    #[test]
    fn faces_touch_where_they_cross_at_a_small_angle_in_any_unit() {
        let crossing = |radius: f64, scale: f64| {
            let rows = [(63.0, 7.3, 1.9), (-70.25, 0.0, 1.0), (radius, 1.5, 1.5), (19.75, 20.0, 1.0)];
            let row = |(radius, thickness, index): (f64, f64, f64)| {
                format!("{} {} {index} {}\n", scale * radius, scale * thickness, scale * 30.0)
            };
            let text: String = rows.map(row).concat();
            Lens::at_d_line(&read("touching", text.as_bytes()).expect("a lens")).crossings()
        };
        for scale in [1e-3, 1.0, 1e3] {
            let [touching] = crossing(-70.15, scale)[..] else { panic!("they overlap") };
            let sagitta = |radius: f64| radius - (radius * radius - 225.0).sqrt();
            let overlap = scale * (sagitta(70.15) - sagitta(70.25));
            assert!((touching.overlap - overlap).abs() < 1e-9 * scale, "{touching:?}");
            assert!(touching.is_contact && !touching.is_rounding && touching.height == 0.0, "{touching:?}");
            let [crossed] = crossing(-60.0, scale)[..] else { panic!("they overlap") };
            assert!(!crossed.is_contact, "{crossed:?}");
        }
        assert_eq!(crossing(-70.35, 1.0), []);
    }
}
