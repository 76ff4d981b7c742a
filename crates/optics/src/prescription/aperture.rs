//! Apertures and obstructions of any shape inside the round clear aperture of a surface.
//!
//! A surface passes a ray that lies inside the clear aperture, inside every aperture and outside every obstruction of
//! the surface. Lengths are in mm in a prescription's [`Interface`](super::Interface), and in units of the clear
//! semi-diameter in a lens's [`Surface`](crate::lens::Surface), so that a stop which is narrowed keeps its shape. A ring
//! is a round aperture with a round obstruction.

use std::sync::Arc;

use super::{blades::Blades, picture::StopPicture};

/// An aperture or an obstruction of a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Aperture {
    /// The outline around the centre.
    pub outline: Outline,
    /// x (image right) and y (image up) of the centre.
    pub center: [f64; 2],
    /// Rotation of the outline about its centre, in degrees from +x toward +y.
    pub rotation: f64,
    /// Whether rays inside the outline are blocked, and not those outside.
    pub is_obstruction: bool,
}

/// The outline of an aperture.
#[derive(Clone, Debug, PartialEq)]
pub enum Outline {
    /// An ellipse, or a circle, with these positive semi-axes along x and y.
    Ellipse([f64; 2]),
    /// A rectangle with these positive half widths along x and y.
    Rectangle([f64; 2]),
    /// A polygon, possibly concave, with at least three vertices and at most [`MAX_VERTICES`]. Where its edges cross
    /// each other, a point counts as inside if a ray from it crosses an odd number of edges.
    Polygon(Arc<[[f64; 2]]>),
    /// The opening that blades leave in a circle.
    Blades(Blades),
    /// The transmission of a picture, as wide as the clear aperture. Light passes where it is more than 0.
    Picture(Arc<StopPicture>),
}

/// Maximum number of vertices of a polygon. Every ray is tested against every edge.
pub const MAX_VERTICES: usize = 256;

impl Aperture {
    /// Returns an aperture with this outline, centred on the axis and not rotated.
    pub fn centered(outline: Outline) -> Self {
        Self { outline, center: [0.0; 2], rotation: 0.0, is_obstruction: false }
    }

    /// Sets or removes the blades among the apertures of a stop; the other apertures stay.
    pub fn set_blades(apertures: &mut Arc<[Self]>, blades: Option<Blades>) {
        let others = apertures.iter().filter(|aperture| aperture.blades().is_none()).cloned();
        let opening = blades.map(|blades| Self::centered(Outline::Blades(blades)));
        *apertures = others.chain(opening).collect();
    }

    /// Returns the blades, if this is the opening of blades.
    pub fn blades(&self) -> Option<Blades> {
        match self.outline {
            Outline::Blades(blades) => Some(blades),
            _ => None,
        }
    }

    /// Returns whether the aperture is a circle around the axis.
    pub fn is_symmetric(&self) -> bool {
        let is_round = matches!(self.outline, Outline::Ellipse([x, y]) if x == y);
        is_round && self.center == [0.0; 2]
    }

    /// Returns the distance from the axis to the farthest point inside the outline, in the unit of the outline; that of
    /// blades and of a picture is the clear semi-diameter. A clear semi-diameter of this distance clips nothing of the
    /// outline.
    pub fn reach(&self) -> f64 {
        match &self.outline {
            Outline::Ellipse(semi_axes) => {
                self.center[0].hypot(self.center[1]) + semi_axes[0].max(semi_axes[1])
            }
            Outline::Rectangle([x, y]) => self.farthest(&[[*x, *y], [-x, *y], [-x, -y], [*x, -y]]),
            Outline::Polygon(vertices) => self.farthest(vertices),
            Outline::Blades(_) => 1.0,
            Outline::Picture(picture) => picture.reach(),
        }
    }

    /// Returns the aperture with every length multiplied by `factor`. The blades and the picture of a stop stay, because
    /// their circle is the clear aperture.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let scaled = |point: &[f64; 2]| point.map(|part| part * factor);
        let outline = match &self.outline {
            Outline::Ellipse(semi_axes) => Outline::Ellipse(scaled(semi_axes)),
            Outline::Rectangle(half_widths) => Outline::Rectangle(scaled(half_widths)),
            Outline::Polygon(vertices) => Outline::Polygon(vertices.iter().map(scaled).collect()),
            Outline::Blades(_) | Outline::Picture(_) => self.outline.clone(),
        };
        Self { outline, center: scaled(&self.center), ..*self }
    }

    /// Returns points of the outline, given around its centre, as points of the surface.
    pub fn placed(&self, points: &[[f64; 2]]) -> impl Iterator<Item = [f64; 2]> {
        let (sine, cosine) = self.rotation.to_radians().sin_cos();
        let [cx, cy] = self.center;
        points.iter().map(move |[x, y]| [cx + x * cosine - y * sine, cy + x * sine + y * cosine])
    }

    fn farthest(&self, points: &[[f64; 2]]) -> f64 {
        self.placed(points).map(|[x, y]| x.hypot(y)).fold(0.0, f64::max)
    }
}
