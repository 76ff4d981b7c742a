//! The reference for a whole lens: of spheres and planes the walk in double-double numbers, which has no search; with
//! aspheres, interface by interface, so that nothing of the walk's search is in it.

use realistic::unstable::{
    lens::{Lens, refraction::Refraction},
    numeric::in_range,
    trace::{Blocked, Direction, Path, Ray},
};

use super::{
    condition::Conditioned,
    double_double::{DoubleDouble, vector},
    exact::ExactRay,
};

/// A lens made ready for exact rays.
#[derive(Clone, Debug)]
pub enum Reference {
    /// Of spheres and planes.
    Walk(Path<DoubleDouble>),
    /// With aspheres.
    Interfaces(Conditioned),
}

impl Reference {
    /// The reference for a lens and a direction of travel.
    pub fn new(lens: &Lens, direction: Direction) -> Self {
        if lens.surfaces.iter().any(|surface| surface.figure.is_some()) {
            Self::Interfaces(Conditioned::new(lens, direction))
        } else {
            Self::Walk(Path::new(lens, direction, Refraction::Fused))
        }
    }

    /// Traces a ray whose components are taken as exact; the direction may have any length.
    ///
    /// # Errors
    /// The reason why it is blocked.
    pub fn trace(&self, ray: Ray) -> Result<ExactRay, Blocked> {
        match self {
            Self::Walk(path) => {
                let (point, direction) =
                    path.trace_in_full(vector(ray.origin), vector(in_range(ray.direction)))?;
                Ok(ExactRay { point, direction })
            }
            Self::Interfaces(interfaces) => interfaces.follow(ray).exact,
        }
    }
}
