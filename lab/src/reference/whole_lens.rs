//! The reference for a whole lens. Centred lenses of spheres and planes use the walk in double-double numbers,
//! which needs no search and is fast; other lenses are traced interface by interface, independent of the walk.

use realistic_base::numeric::in_range;
use realistic_optics::{
    lens::{Lens, refraction::Refraction},
    trace::{Blocked, Direction, Path, Ray},
};

use super::{
    condition::Conditioned,
    double_double::DoubleDouble,
    exact::{ExactRay, vector},
};

/// A lens prepared for exact rays.
#[derive(Clone, Debug)]
pub enum Reference {
    /// Spheres and planes only.
    Walk(Path<DoubleDouble>),
    /// Other lenses.
    Interfaces(Conditioned),
}

impl Reference {
    /// Builds the reference for a lens and a direction of travel.
    pub fn new(lens: &Lens, direction: Direction) -> Self {
        if !lens.is_round() || lens.surfaces.iter().any(|surface| surface.figure.is_some()) {
            Self::Interfaces(Conditioned::new(lens, direction))
        } else {
            Self::Walk(Path::new(lens, direction, Refraction::Fused))
        }
    }

    /// Traces a ray whose components are taken as exact; the direction may have any length.
    ///
    /// # Errors
    /// The reason why the ray is blocked.
    pub fn trace(&self, ray: Ray) -> Result<ExactRay, Blocked> {
        match self {
            Self::Walk(path) => {
                let (point, direction, _) =
                    path.trace_in_full(vector(ray.origin), vector(in_range(ray.direction)))?;
                Ok(ExactRay { point, direction })
            }
            Self::Interfaces(interfaces) => interfaces.follow(ray).exact,
        }
    }
}
