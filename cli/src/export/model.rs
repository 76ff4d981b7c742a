//! The models of other programs, and their fits to a lens.

use super::field::ChiefField;
use super::fit::fit;
use super::law::{Law, LawShape, Quantity};
use serde_json::{Value, json};

/// A camera model of other programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Model {
    /// No distortion, with the image scale of the middle.
    Pinhole,
    /// Brown's polynomial in the tangent, k1, k2, k3 (`OpenCV`).
    OpenCv,
    /// The quotient k1 to k6 (`OpenCV`'s rational model).
    OpenCvRational,
    /// A polynomial in the angle, k1 to k4 (Kannala and Brandt; `OpenCV`'s fisheye).
    KannalaBrandt,
    /// The angle as a polynomial of the radius, k1 to k4 (NVIDIA).
    FTheta,
    /// The undistorted radius as a quotient of the distorted one, l1 to l6 (`OpenTrackIO`'s Brown-Conrady D-U).
    OpenTrackIo,
}

/// A model fitted to a lens.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// The model.
    pub model: Model,
    /// The fitted law.
    pub law: Law,
    /// The rays of the fit: all rays, or for a model that cannot see sideways the rays that it can represent.
    pub held: ChiefField,
}

/// Angle from the axis up to which models that project onto a plane are fitted: tan 80° is 5.7, and a polynomial in
/// the tangent that is fitted beyond this angle is bad everywhere.
pub const PLANE_REACH: f64 = 80.0_f64.to_radians();

impl Model {
    /// Returns the name that `--as` uses.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pinhole => "usd",
            Self::OpenCv => "opencv",
            Self::OpenCvRational => "opencv-rational",
            Self::KannalaBrandt => "kannala-brandt",
            Self::FTheta => "ftheta",
            Self::OpenTrackIo => "opentrackio",
        }
    }

    fn shape(self) -> LawShape {
        use Quantity::{Angle, Radius, Tangent};
        let (from, to, power, terms) = match self {
            Self::Pinhole => (Tangent, Radius, 2, [0, 0]),
            Self::OpenCv => (Tangent, Radius, 2, [3, 0]),
            Self::OpenCvRational => (Tangent, Radius, 2, [3, 3]),
            Self::KannalaBrandt => (Angle, Radius, 2, [4, 0]),
            Self::FTheta => (Radius, Angle, 1, [3, 0]),
            Self::OpenTrackIo => (Radius, Tangent, 2, [3, 3]),
        };
        LawShape { from, to, power, terms }
    }

    /// Whether the model projects onto a plane, and so sees less than 90 degrees from the axis.
    pub fn is_planar(self) -> bool {
        let LawShape { from, to, .. } = self.shape();
        from == Quantity::Tangent || to == Quantity::Tangent
    }

    /// Fits the model to these rays.
    pub fn fitted(self, field: &ChiefField) -> Fitted {
        let held = if self.is_planar() { field.within(PLANE_REACH) } else { field.clone() };
        let scale = match self {
            Self::Pinhole => Some(field.central_scale()),
            // Both directions share one focal length.
            Self::OpenTrackIo => Some(fit(Self::OpenCvRational.shape(), &held, None).scale.recip()),
            _ => None,
        };
        let law = fit(self.shape(), &held, scale);
        Fitted { model: self, law, held }
    }
}

impl Fitted {
    /// Returns the focal length in the middle of the image, pixels.
    pub fn focal_length(&self) -> f64 {
        let Law { shape, scale, .. } = self.law;
        if shape.to == Quantity::Radius { scale } else { scale.recip() }
    }

    /// Returns the parameters under the names of the model's own programs, in pixels and radians.
    pub fn parameters(&self) -> Value {
        let [cx, cy] = self.held.film.principal_point();
        let Law { scale, numerator: n, denominator: d, .. } = &self.law;
        match self.model {
            Model::Pinhole | Model::OpenCv | Model::OpenCvRational | Model::KannalaBrandt => json!({
                "fx_px": scale, "fy_px": scale,
                "cx_px": cx, "cy_px": cy,
                "distortion": self.distortion(),
            }),
            Model::FTheta => json!({
                "k": self.distortion(),
                "optical_center_px": self.held.film.half(),
                "max_fov_deg": self.full_field(),
            }),
            Model::OpenTrackIo => json!({
                "pinhole_focal_length_mm": self.focal_length() * self.held.film.pixel(),
                "radial_per_mm": self.radial(n, d),
            }),
        }
    }

    /// Returns the coefficients in the order that the model's own programs use, in pixels and radians.
    pub fn distortion(&self) -> Vec<f64> {
        let Law { scale, numerator: n, denominator: d, .. } = &self.law;
        match self.model {
            Model::Pinhole => vec![],
            // Symmetry makes p1 and p2 0.
            Model::OpenCv | Model::OpenCvRational => [&[n[0], n[1], 0.0, 0.0, n[2]], &d[..]].concat(),
            Model::KannalaBrandt => n.clone(),
            Model::FTheta => [0.0, *scale].into_iter().chain(n.iter().map(|k| scale * k)).collect(),
            Model::OpenTrackIo => self.radial(n, d),
        }
    }

    /// Returns the coefficients of numerator and denominator alternately, for radii in mm.
    fn radial(&self, numerator: &[f64], denominator: &[f64]) -> Vec<f64> {
        let Law { shape, scale, .. } = &self.law;
        // The argument is the radius in pixels, or the tangent, which is the undistorted radius divided by the focal
        // length.
        let unit = if shape.from == Quantity::Radius { 1.0 } else { *scale } * self.held.film.pixel();
        let pairs = (1..).zip(numerator.iter().zip(denominator));
        pairs.flat_map(|(i, (n, d))| [n, d].map(|a| a / unit.powi(2 * i))).collect()
    }

    /// Returns the coefficients of a quotient in the tangent, in the same order: `OpenTrackIO`'s U-D.
    pub fn radial_from_undistorted(&self) -> Vec<f64> {
        self.radial(&self.law.numerator, &self.law.denominator)
    }

    /// Returns the full field that the model represents, degrees.
    pub fn full_field(&self) -> f64 {
        2.0 * self.held.extent().0.to_degrees()
    }
}
