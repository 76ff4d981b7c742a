//! The background of the scenes: a dusk sky, two ranges of hills, and the low sun behind the camera
//! that lights the scene.

use glam::Vec3;

/// Irradiance of a surface that faces the sun.
pub const SUNLIGHT: Vec3 = Vec3::new(3.3, 2.6, 1.9);
/// Sine of the smallest angular radius of the sun in mirrors; as a point, the sun would have no image there.
const HIGHLIGHT: f32 = 0.035;
const HORIZON: Vec3 = Vec3::new(0.93, 0.42, 0.23);
const MIDDLE: Vec3 = Vec3::new(0.09, 0.14, 0.38);
const ZENITH: Vec3 = Vec3::new(0.06, 0.10, 0.26);
/// Colour of far objects in haze.
pub const MIST: Vec3 = Vec3::new(0.26, 0.19, 0.27);

/// Returns the radiance from a direction (unit length), without the sun.
pub fn radiance(direction: Vec3) -> Vec3 {
    let level = direction.x.hypot(direction.z).max(1e-6);
    let slope = direction.y / level;
    let azimuth = direction.x.atan2(direction.z);
    let near = 0.036 + 0.014 * (5.0 * azimuth + 1.2).sin() + 0.007 * (14.0 * azimuth).sin();
    let far = 0.074 + 0.024 * (4.0 * azimuth - 0.9).sin() + 0.009 * (17.0 * azimuth + 2.0).sin();
    if slope < near {
        let depth = (slope.max(0.0) / near).sqrt();
        return MIST.lerp(Vec3::new(0.035, 0.04, 0.085), depth);
    }
    if slope < far {
        return Vec3::new(0.25, 0.21, 0.32).lerp(Vec3::new(0.13, 0.13, 0.25), slope / far);
    }
    gradient(direction.y)
}

fn gradient(height: f32) -> Vec3 {
    let low = HORIZON.lerp(MIDDLE, 1.0 - (-6.5 * height.max(0.0)).exp());
    low.lerp(ZENITH, (1.6 * height).clamp(0.0, 1.0))
}

/// Returns the radiance of a sky after sunset from a direction (unit length).
pub fn dusk(direction: Vec3) -> Vec3 {
    const GLOW: Vec3 = Vec3::new(0.70, 0.29, 0.17);
    const BLUE: Vec3 = Vec3::new(0.095, 0.17, 0.42);
    const NIGHT: Vec3 = Vec3::new(0.028, 0.052, 0.155);
    let height = direction.y.max(0.0);
    let west = 0.6 + 0.4 * (direction.z - 0.4 * direction.x);
    NIGHT.lerp(BLUE, (-2.2 * height).exp()) + GLOW * west * (-9.0 * height).exp()
}

/// The sun: a distant disk, so that shadows have a penumbra.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// Direction toward the centre of the sun, of any length.
    pub towards: Vec3,
    /// Sine of the angular radius; 0 for a point.
    pub radius: f32,
}

impl Sun {
    /// A sun low behind the camera, large enough for soft shadows.
    pub const EVENING: Self = Self { towards: Vec3::new(-0.55, 0.52, -0.75), radius: 0.035 };

    /// Returns the radiance of the sun in mirrors. It is far below the true radiance, which would cause noise at few
    /// samples per pixel.
    pub fn mirrored(&self, direction: Vec3) -> Vec3 {
        let cosine = direction.dot(self.towards.normalize());
        let radius = self.radius.max(HIGHLIGHT);
        let outside = (1.0 - cosine * cosine).max(0.0).sqrt() / radius;
        // To give the same amount of light, a larger sun has a fainter disk.
        let share = (HIGHLIGHT / radius).powi(2);
        if cosine > 0.0 && outside < 1.0 { SUNLIGHT * 12.0 * share } else { Vec3::ZERO }
    }

    /// Returns a direction to a point of the sun, for a sample (u, v).
    pub fn direction(&self, [u, v]: [f32; 2]) -> Vec3 {
        let centre = self.towards.normalize();
        let (side, up) = centre.any_orthonormal_pair();
        let (sine, cosine) = (std::f32::consts::TAU * v).sin_cos();
        let radius = self.radius * u.sqrt();
        (centre + radius * (cosine * side + sine * up)).normalize()
    }
}

/// Returns the irradiance from sky and ground together, on a surface with this normal.
pub fn ambient(normal: Vec3) -> Vec3 {
    const FROM_ABOVE: Vec3 = Vec3::new(0.72, 0.72, 1.02);
    const FROM_BELOW: Vec3 = Vec3::new(0.42, 0.34, 0.32);
    FROM_BELOW.lerp(FROM_ABOVE, 0.5 + 0.5 * normal.y)
}
